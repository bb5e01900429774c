//! The time loop.
use super::RigidBodies;
use super::body::is_finite;
use super::contacts::{CHUNK, Chunk, View};
use super::sweep;
use super::tether::pull_of;
use crate::DemError;
use crate::contact::ContactLaw;
use interfaces::{BodyId, Dynamics, Load, Renumbering, Twist, Wrench};

impl<L: ContactLaw> RigidBodies<L> {
    pub(super) fn view(&self) -> View<'_, L> {
        View {
            law: &self.law,
            loads: &self.loads,
            bodies: &self.bodies,
            constants: &self.constants,
            walls: &self.walls,
            near: &self.near,
            properties: &self.properties,
            periods: self.periods,
            last_step: self.last_step,
            time: self.time,
            surfaces: self.any_slides.then_some(&self.surfaces),
        }
    }

    /// Moves all along with their twists, as long as forces are not known; have any gone farther than foreseen?
    fn drift(&mut self, dt: f64) -> bool {
        let shared = self.is_shared();
        let Self { bodies, contact, impulse, constants, listed, loads, sleepers, .. } = self;
        sweep::any(shared, bodies, contact, impulse, |b, body, _, _| {
            if sleepers.n == 0 || !sleepers.is_asleep(b) {
                body.before(&constants[b], loads.of(b), dt);
            }
            listed[b].is_left(body)
        })
    }

    /// Half a drift, contacts where the bodies then are, a kick, half a drift; answers whether it was made. A step that turns out too long
    /// for the contacts that it meets is taken back. It is the `first` one within an advance, or not.
    fn step(&mut self, dt: f64, left: f64, first: bool) -> Result<bool, DemError> {
        let half = 0.5 * dt;
        if self.drift(half) {
            self.list(left)?;
        }
        let mut pushed = self.push(dt);
        while pushed.is_ok() && self.wake_touched() {
            self.feel_as_before();
            self.list(left)?;
            pushed = self.push(dt);
        }
        if let Err(error) = pushed {
            self.drift(-half);
            self.feel_as_before();
            return Err(error);
        }
        if self.is_too_long(dt) {
            self.drift(-half);
            let used = self.near.len().div_ceil(CHUNK);
            self.chunks[..used].iter_mut().for_each(Chunk::undo);
            self.feel_as_before();
            return Ok(false);
        }
        self.last_step = dt;
        self.time += dt;
        self.contact_time += if self.n_contacts() == 0 { 0.0 } else { dt };
        if self.kick(dt, first) { self.diverged() } else { Ok(true) }
    }

    /// Changes the twists by what the bodies feel, and moves them along for half the step; is any twist no longer finite?
    fn kick(&mut self, dt: f64, first: bool) -> bool {
        let shared = self.is_shared();
        if shared {
            self.felt.list(&self.near, self.bodies.len());
        }
        let Self {
            bodies, contact, impulse, constants, loads, sleepers, chunks, felt, gravity, tethers, ..
        } = self;
        sweep::any(shared, bodies, contact, impulse, |b, body, contact, impulse| {
            if shared {
                *contact = felt.by(b, chunks);
            }
            if first {
                *impulse = Wrench::default();
            }
            let (constants, load) = (&constants[b], loads.of(b));
            let weight = *gravity * constants.mass;
            if sleepers.n > 0 && sleepers.is_asleep(b) {
                // Its contacts bear what pulls at it.
                let weight = Wrench { force: weight, ..Wrench::default() };
                *impulse += (load.wrench + weight) * -dt;
                return false;
            }
            *impulse += *contact * dt;
            let mut total = load.wrench + *contact;
            if let Some(pull) = pull_of(tethers, b, body, dt) {
                *impulse += pull * dt;
                total += pull;
            }
            total.force += weight;
            body.after(constants, load, &total, 0.5 * dt);
            !is_finite(&body.twist)
        })
    }

    /// Do threads share the work?
    fn is_shared(&self) -> bool {
        sweep::is_shared(self.near.len(), self.all_round)
    }

    #[cold]
    fn diverged(&self) -> Result<bool, DemError> {
        match self.bodies.iter().position(|b| !is_finite(&b.twist)) {
            Some(b) => {
                Err(DemError::Diverged { body: BodyId(b), velocity: self.bodies[b].twist.linear.into() })
            }
            None => Ok(true),
        }
    }

    /// Contact wrenches on all bodies, as things stand; but where threads share the work, these are added up by [`Self::kick`].
    fn push(&mut self, dt: f64) -> Result<(), DemError> {
        self.stiffest = 0.0;
        let mut chunks = std::mem::take(&mut self.chunks);
        let mut contact = std::mem::take(&mut self.contact);
        let used = self.near.len().div_ceil(CHUNK);
        chunks[used..].iter_mut().for_each(|c| c.films = 0);
        // Bodies are where they are in the middle of the sub-step.
        let view = View { time: self.time + 0.5 * dt, ..self.view() };
        let result = work(&view, self.is_shared(), &mut chunks[..used], &mut contact, dt);
        self.chunks = chunks;
        self.contact = contact;
        for chunk in &mut self.chunks[..used] {
            self.stiffest = self.stiffest.max(chunk.stiffest);
            self.overlap_calls += std::mem::take(&mut chunk.overlap_calls);
        }
        result
    }

    /// Contact wrenches are what they were at the patches that are kept.
    #[cold]
    fn feel_as_before(&mut self) {
        let mut contact = std::mem::take(&mut self.contact);
        contact.fill(Wrench::default());
        self.chunks.iter().for_each(|c| self.view().add(c, &mut contact));
        self.contact = contact;
    }
}

/// Fills the chunks, on as many threads as there are; after an error all are as they were.
fn work<L: ContactLaw>(
    view: &View<'_, L>,
    shared: bool,
    chunks: &mut [Chunk<L::Memory>],
    wrenches: &mut [Wrench],
    dt: f64,
) -> Result<(), DemError> {
    #[cfg(feature = "parallel")]
    if shared {
        use rayon::prelude::*;
        chunks.par_iter_mut().enumerate().for_each(|(i, chunk)| view.fill_apart(i * CHUNK, chunk, dt));
        let error = chunks.iter_mut().find_map(|c| c.error.take());
        return error.map_or(Ok(()), |error| {
            chunks.iter_mut().for_each(Chunk::undo);
            Err(error)
        });
    }
    let _ = shared;
    wrenches.fill(Wrench::default());
    for i in 0..chunks.len() {
        view.fill::<false>(i * CHUNK, &mut chunks[i], dt, |b, wrench| wrenches[b as usize] += wrench);
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
        if load != *self.loads.of(b.0) {
            self.wake(self.sleepers.island[b.0]);
        }
        self.loads.set(b.0, load);
    }

    /// # Errors
    /// [`DemError::TimeStep`], before anything has moved; [`DemError::SubSteps`] and those of [`OverlapSolver`](crate::OverlapSolver), with the bodies where
    /// the last sub-step left them; [`DemError::Diverged`], when a velocity is no longer finite: the bodies are then of no further use, save to restore an earlier
    /// state.
    fn advance(&mut self, dt: f64) -> Result<(), DemError> {
        if !(dt.is_finite() && dt > 0.0) {
            return Err(DemError::TimeStep { dt });
        }
        // For a long step all pairs that may meet within it are listed; after one, fewer are again enough.
        let foreseen = self.horizon(dt);
        if (dt >= foreseen && self.may_stray(dt)) || self.listed_for > 2.0 * foreseen {
            self.list(dt)?;
        }
        // Without near pairs there is nothing but loads, constant over the step.
        let alone = self.near.is_empty() && self.tethers.is_empty() && !self.may_stray(dt);
        let mut steps = if alone { 1.0 } else { self.n_steps(dt)? };
        let (mut left, mut first) = (dt, true);
        while left > 0.0 {
            let sub = left / steps;
            let made = self.step(sub, left, first);
            if first && !matches!(made, Ok(true)) {
                self.impulse.fill(Wrench::default());
            }
            if !made? {
                steps = self.n_steps(left)?.max(2.0 * steps);
                continue;
            }
            first = false;
            if steps <= 1.0 {
                break;
            }
            left -= sub;
            // Contacts may be stiffer, or softer again.
            steps = self.n_steps(left)?;
        }
        self.fall_asleep(dt);
        Ok(())
    }

    fn contact_impulse(&self, b: BodyId) -> Wrench {
        self.impulse[b.0]
    }

    /// Sets the time at which surfaces move as functions of it; it goes on by what bodies are advanced.
    fn renew(&mut self, time: f64) -> Result<Option<Renumbering>, DemError> {
        self.time = time;
        Ok(None)
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
