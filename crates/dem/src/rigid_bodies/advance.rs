//! The time loop.
use super::RigidBodies;
use super::contacts::{CHUNK, Chunk, View, add_to};
use crate::DemError;
use crate::contact::ContactLaw;
use interfaces::{BodyId, Dynamics, Load, Twist, Wrench};

impl<L: ContactLaw> RigidBodies<L> {
    pub(super) fn view(&self) -> View<'_, L> {
        View {
            law: &self.law,
            bodies: &self.bodies,
            constants: &self.constants,
            walls: &self.walls,
            near: &self.near,
            properties: &self.properties,
            n_materials: self.materials.len(),
            periods: self.periods,
        }
    }

    fn drift(&mut self, dt: f64) {
        let asleep = &self.sleepers;
        for (b, body) in self.bodies.iter_mut().enumerate() {
            if asleep.n == 0 || !asleep.is_asleep(b) {
                body.before(&self.constants[b], &self.loads[b], dt);
            }
        }
    }

    /// Half a drift, contacts where the bodies then are, a kick, half a drift; answers whether it was made. A step that turns out too long
    /// for the contacts that it meets is taken back.
    fn step(&mut self, dt: f64, left: f64) -> Result<bool, DemError> {
        let half = 0.5 * dt;
        self.drift(half);
        if self.strayed() {
            self.list(left)?;
        }
        let mut pushed = self.push(dt);
        while pushed.is_ok() && self.wake_touched() {
            self.list(left)?;
            pushed = self.push(dt);
        }
        if let Err(error) = pushed {
            self.drift(-half);
            return Err(error);
        }
        if self.is_too_long(dt) {
            self.drift(-half);
            let used = self.near.len().div_ceil(CHUNK);
            self.chunks[..used].iter_mut().for_each(Chunk::undo);
            return Ok(false);
        }
        self.contact_time += if self.n_contacts() == 0 { 0.0 } else { dt };
        let (mass_of, gravity) = (|c: &super::body::Constants| c.inertia.mass, self.gravity);
        for (b, body) in self.bodies.iter_mut().enumerate() {
            let (constants, load, contact) = (&self.constants[b], &self.loads[b], &self.contact[b]);
            if self.sleepers.n > 0 && self.sleepers.is_asleep(b) {
                // Its contacts bear what pulls at it.
                let weight = Wrench { force: gravity * mass_of(constants), ..Wrench::default() };
                self.impulse[b] += (load.wrench + weight) * -dt;
                continue;
            }
            self.impulse[b] += *contact * dt;
            let mut total = load.wrench + *contact;
            total.force += gravity * mass_of(constants);
            body.after(constants, load, &total, half);
        }
        Ok(true)
    }

    /// Contact wrenches on all bodies, as things stand.
    fn push(&mut self, dt: f64) -> Result<(), DemError> {
        self.contact.fill(Wrench::default());
        self.stiffest = 0.0;
        if self.near.is_empty() {
            return Ok(());
        }
        let mut chunks = std::mem::take(&mut self.chunks);
        let mut contact = std::mem::take(&mut self.contact);
        let used = self.near.len().div_ceil(CHUNK);
        let view = self.view();
        let result = work(&view, &mut chunks[..used], &mut contact, dt);
        self.chunks = chunks;
        self.contact = contact;
        if result.is_err() {
            // What was last known.
            let mut contact = std::mem::take(&mut self.contact);
            contact.fill(Wrench::default());
            self.chunks.iter().for_each(|c| self.view().add(c, &mut contact));
            self.contact = contact;
        }
        for chunk in &mut self.chunks[..used] {
            self.stiffest = self.stiffest.max(chunk.stiffest);
            self.overlap_calls += std::mem::take(&mut chunk.overlap_calls);
        }
        result
    }
}

/// Fills the chunks, on as many threads as there are, and sums up in their order; after an error all are as they were.
fn work<L: ContactLaw>(
    view: &View<'_, L>,
    chunks: &mut [Chunk<L::Memory>],
    wrenches: &mut [Wrench],
    dt: f64,
) -> Result<(), DemError> {
    #[cfg(feature = "parallel")]
    if chunks.len() > 1 && rayon::current_num_threads() > 1 {
        use rayon::prelude::*;
        chunks
            .par_iter_mut()
            .enumerate()
            .for_each(|(i, chunk)| view.fill(i * CHUNK, chunk, dt, |_, _, _| {}));
        if let Some(error) = chunks.iter_mut().find_map(|c| c.error.take()) {
            chunks.iter_mut().for_each(Chunk::undo);
            return Err(error);
        }
        chunks.iter().for_each(|c| view.add(c, wrenches));
        return Ok(());
    }
    for i in 0..chunks.len() {
        view.fill(i * CHUNK, &mut chunks[i], dt, |pair, on_a, on_b| add_to(wrenches, pair, on_a, on_b));
        if let Some(error) = chunks[i].error.take() {
            chunks[..=i].iter_mut().for_each(Chunk::undo);
            return Err(error);
        }
    }
    Ok(())
}

impl<L: ContactLaw> Dynamics for RigidBodies<L> {
    type Error = DemError;

    /// The load is kept until another one is given.
    fn apply(&mut self, b: BodyId, load: Load) {
        if load != self.loads[b.0] {
            self.wake(self.sleepers.island[b.0]);
        }
        self.loads[b.0] = load;
    }

    /// # Errors
    /// [`DemError::TimeStep`], before anything has moved; [`DemError::SubSteps`] and those of [`OverlapSolver`](crate::OverlapSolver), with the bodies where
    /// the last sub-step left them; [`DemError::Diverged`], when a velocity is no longer finite: the bodies are then of no further use, save to restore an earlier
    /// state.
    fn advance(&mut self, dt: f64) -> Result<(), DemError> {
        if !(dt.is_finite() && dt > 0.0) {
            return Err(DemError::TimeStep { dt });
        }
        self.impulse.fill(Wrench::default());
        // For a long step all pairs that may meet within it are listed; after one, fewer are again enough.
        let foreseen = self.horizon(dt);
        if (dt > self.longest_step() && self.may_stray(dt)) || self.listed_for > 2.0 * foreseen {
            self.list(dt)?;
        }
        // Without near pairs there is nothing but loads, constant over the step.
        let alone = self.near.is_empty() && !self.may_stray(dt);
        let mut steps = if alone { 1.0 } else { self.n_steps(dt)? };
        let mut left = dt;
        while left > 0.0 {
            let sub = left / steps;
            if !self.step(sub, left)? {
                steps = self.n_steps(left)?.max(2.0 * steps);
                continue;
            }
            if steps <= 1.0 {
                break;
            }
            left -= sub;
            // Contacts may be stiffer, or softer again.
            steps = self.n_steps(left)?;
        }
        let finite = |t: &Twist| t.linear.iter().chain(&t.angular).all(|x| x.is_finite());
        match self.bodies.iter().position(|b| !finite(&b.twist)) {
            Some(b) => {
                Err(DemError::Diverged { body: BodyId(b), velocity: self.bodies[b].twist.linear.into() })
            }
            None => {
                self.fall_asleep(dt);
                Ok(())
            }
        }
    }

    fn contact_impulse(&self, b: BodyId) -> Wrench {
        self.impulse[b.0]
    }

    fn set_twist(&mut self, b: BodyId, twist: Twist) {
        if twist != self.bodies[b.0].twist {
            self.wake(self.sleepers.island[b.0]);
        }
        self.bodies[b.0].twist = twist;
    }

    /// A fixed part of the half period π√(M/k) of the stiffest contact foreseen: every body against its own kind and against the walls,
    /// overlapping by a twentieth of its radius. Stiffer contacts, and bodies so fast that they would pass through one
    /// another, are met by more sub-steps within [`advance`](Self::advance).
    fn stable_dt(&self) -> f64 {
        self.stable_dt
    }
}
