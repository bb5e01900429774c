//! Contacts and motion.
use super::{Body, Listed, Pair, RigidBodies, Spring};
use crate::contact::{Touch, force, series};
use crate::{DemError, Material, PairProperties, Round};
use interfaces::{BodyId, Dynamics, Load, Rotation, Twist, Vector, Wrench};
use std::f64::consts::PI;

/// Sub-steps per half period of the stiffest contact foreseen.
const STEPS_PER_CONTACT: f64 = 33.0;
/// Overlap, in radii of the smaller body, up to which that stiffness is foreseen.
const FORESEEN_DEPTH: f64 = 0.05;
/// Radii by which margins are widened when pairs have to be listed anew within an advance.
const SKIN: f64 = 0.1;

impl RigidBodies {
    /// The longest stable step, over all bodies.
    pub(super) fn least_stable_dt(&self) -> f64 {
        self.bodies.iter().map(|b| self.stable_dt_of(b)).fold(f64::INFINITY, f64::min)
    }

    /// The longest stable step for `b` against its own kind and against the walls.
    pub(super) fn stable_dt_of(&self, b: &Body) -> f64 {
        let own = b.half_period(&b.material, false, self.length_factor);
        let walls = self.walls.iter().map(|(_, m)| b.half_period(m, true, self.length_factor));
        walls.fold(own, f64::min) / STEPS_PER_CONTACT
    }

    /// Lists the pairs whose boxes may meet within `dt`, if nothing but the loads moves the bodies, or which are
    /// not more than their `skin` (in radii) apart.
    pub(super) fn find_near(&mut self, dt: f64, skin: f64) {
        for b in &mut self.bodies {
            let margin = b.path(dt) + skin * b.shape.radius();
            b.listed = Listed { centre: b.pose.position, margin };
        }
        self.broad_phase.sweep(&self.periods, &self.bodies, &mut self.near);
        let n = self.bodies.len();
        let mut with_walls = false;
        for (w, (wall, _)) in self.walls.iter().enumerate() {
            for (i, b) in self.bodies.iter().enumerate() {
                if b.movable() && wall.signed_distance(b.pose.position) <= b.reach() {
                    self.near.push(Pair(i, n + w));
                    with_walls = true;
                }
            }
        }
        if with_walls {
            self.near.sort_unstable();
        }
    }

    /// Contact wrenches on all bodies, as things stand; `dt` updates the springs.
    fn contacts(&mut self, dt: f64) -> Result<(), DemError> {
        for b in &mut self.bodies {
            b.contact = Wrench::default();
        }
        std::mem::swap(&mut self.springs, &mut self.last_springs);
        self.springs.clear();
        for at in 0..self.near.len() {
            let pair = self.near[at];
            let Some((touch, properties, arms)) = self.touch(pair)? else { continue };
            let mut spring = match self.last_springs.binary_search_by_key(&pair, |s| s.pair) {
                Ok(k) => self.last_springs[k].force,
                Err(_) => Vector::zeros(),
            };
            let f = force(&properties, &touch, &mut spring, dt);
            self.springs.push(Spring { pair, force: spring });
            self.bodies[pair.0].contact += Wrench::at(f, arms[0]);
            if let Some(b) = self.bodies.get_mut(pair.1) {
                b.contact += Wrench::at(-f, arms[1]);
            }
        }
        Ok(())
    }

    /// How a pair touches, what the two are to one another, and the arms from their centres to the contact.
    fn touch(&mut self, pair: Pair) -> Result<Option<(Touch, PairProperties, [Vector; 2])>, DemError> {
        let a = &self.bodies[pair.0];
        let (overlap, arm_b, twist_b, material_b, mass, length) = match self.bodies.get(pair.1) {
            Some(b) => {
                let apart = self.periods.nearest(b.pose.position - a.pose.position);
                let within = a.shape.radius() + b.shape.radius();
                if apart.iter().any(|x| x.abs() > within) {
                    return Ok(None);
                }
                self.overlap_calls += 1;
                let at_b = a.pose.position + apart;
                let Some(overlap) = a.shape.overlap(a.pose.position, &b.shape, at_b)? else {
                    return Ok(None);
                };
                let (arm_a, arm_b) = (overlap.centroid - a.pose.position, overlap.centroid - at_b);
                let mass = match (a.pinned(), b.pinned()) {
                    (true, false) => b.inertia.mass,
                    (false, true) => a.inertia.mass,
                    _ => series(a.inertia.mass, b.inertia.mass),
                };
                (overlap, arm_b, b.twist, b.material, mass, series(arm_a.norm(), arm_b.norm()))
            }
            None => {
                let (wall, material) = &self.walls[pair.1 - self.bodies.len()];
                if wall.signed_distance(a.pose.position) > a.shape.radius() {
                    return Ok(None);
                }
                self.overlap_calls += 1;
                let Some(overlap) = a.shape.wall_overlap(a.pose.position, wall) else { return Ok(None) };
                let length = (overlap.centroid - a.pose.position).norm();
                (overlap, Vector::zeros(), Twist::default(), *material, a.inertia.mass, length)
            }
        };
        let length = self.length_factor * length;
        // A contact at a body's very centre has no length to divide by, and no way to push.
        if length <= 0.0 {
            return Ok(None);
        }
        let arm_a = overlap.centroid - a.pose.position;
        let touch = Touch {
            overlap,
            velocity: a.twist.at(arm_a) - twist_b.at(arm_b),
            spin: a.twist.angular - twist_b.angular,
            mass: if a.shape.is_plane() { mass * length } else { mass },
            length,
        };
        Ok(Some((touch, PairProperties::new(&a.material, &material_b), [arm_a, arm_b])))
    }
}

impl Body {
    /// How far the centre goes within `dt` at most, if nothing but the load changes its velocity.
    fn path(&self, dt: f64) -> f64 {
        let acceleration = match self.pinned() {
            true => 0.0,
            false => self.load.wrench.force.norm() / (self.inertia.mass + self.load.added_mass),
        };
        dt * (self.twist.linear.norm() + 0.5 * dt * acceleration)
    }

    /// Has it gone farther than the list of near pairs foresaw?
    fn strayed(&self) -> bool {
        (self.pose.position - self.listed.centre).norm() > self.listed.margin
    }

    /// Moves along with the twist.
    fn drift(&mut self, dt: f64) {
        let (step, turn) = (self.twist.linear * dt, self.twist.angular * dt);
        if step != Vector::zeros() || turn != Vector::zeros() {
            self.pose.position += step;
            self.pose.orientation = Rotation::from_scaled_axis(turn) * self.pose.orientation;
            self.pose.orientation.renormalize_fast();
        }
    }

    /// Changes the twist by load and contact over `dt`.
    fn kick(&mut self, dt: f64) {
        self.impulse += self.contact * dt;
        if !self.movable() {
            return;
        }
        let Load { wrench, added_mass, added_moment } = self.load;
        let total = wrench + self.contact;
        let accelerate = total.force / (self.inertia.mass + added_mass);
        // Euler's equations in the body's frame: (I + I_a) dω/dt = t − ω × Iω.
        let q = self.pose.orientation;
        let omega = q.inverse_transform_vector(&self.twist.angular);
        let torque = q.inverse_transform_vector(&total.torque) - omega.cross(&(self.inertia.tensor * omega));
        let tensor = self.inertia.tensor + nalgebra::Matrix3::from_diagonal_element(added_moment);
        let spin = tensor.try_inverse().map_or(Vector::zeros(), |inverse| q * (inverse * torque));
        for i in 0..3 {
            if self.freedom.linear[i] {
                self.twist.linear[i] += dt * accelerate[i];
            }
            if self.freedom.angular[i] {
                self.twist.angular[i] += dt * spin[i];
            }
        }
    }

    /// π√(M/k) for a contact with `other` (a wall, or the body's like), k = Y A/L_c at the foreseen depth, cut by
    /// 1 + the ratio of damping to √(kM), so that the dashpot stays stable.
    fn half_period(&self, other: &Material, wall: bool, length_factor: f64) -> f64 {
        let r = self.shape.radius();
        let (share, mass) = if wall { (1.0, self.inertia.mass) } else { (0.5, 0.5 * self.inertia.mass) };
        let depth = share * FORESEEN_DEPTH * r;
        let chord = (depth * (2.0 * r - depth)).sqrt();
        let length = length_factor * share * r;
        let (area, depth_of_scene) = match self.shape {
            Round::Disc(_) => (2.0 * chord, length),
            Round::Sphere(_) => (PI * chord * chord, 1.0),
        };
        let p = PairProperties::new(&self.material, other);
        let damping = p.damping * (area * depth_of_scene).sqrt() / length;
        PI * (mass * length / (p.stiffness * area)).sqrt() / (1.0 + damping)
    }
}

impl Dynamics for RigidBodies {
    type Error = DemError;

    /// The load is kept until another one is given.
    fn apply(&mut self, b: BodyId, load: Load) {
        self.bodies[b.0].load = load;
    }

    /// # Errors
    /// [`DemError::TimeStep`], before anything has moved; [`DemError::Diverged`], when a velocity is no longer
    /// finite: the bodies are then of no further use, save to restore an earlier state.
    fn advance(&mut self, dt: f64) -> Result<(), DemError> {
        if !(dt.is_finite() && dt > 0.0) {
            return Err(DemError::TimeStep { dt });
        }
        for b in &mut self.bodies {
            (b.impulse, b.contact) = Default::default();
        }
        self.find_near(dt, 0.0);
        // Without near pairs there is nothing but loads, constant over the step.
        let alone = self.near.is_empty();
        let steps = if alone { 1.0 } else { (dt / self.stable_dt()).ceil().max(1.0) };
        let sub = dt / steps;
        for step in 0..steps as u64 {
            self.bodies.iter_mut().for_each(|b| b.drift(0.5 * sub));
            if alone {
                self.springs.clear();
            } else {
                // A body that was hit may meet others than it was on its way to.
                if self.bodies.iter().any(Body::strayed) {
                    self.find_near(dt - step as f64 * sub, SKIN);
                }
                self.contacts(sub)?;
                self.contact_time += if self.springs.is_empty() { 0.0 } else { sub };
            }
            for b in &mut self.bodies {
                b.kick(sub);
                b.drift(0.5 * sub);
            }
        }
        let finite = |b: &Body| b.twist.linear.iter().chain(&b.twist.angular).all(|x| x.is_finite());
        match self.bodies.iter().position(|b| !finite(b)) {
            Some(b) => {
                Err(DemError::Diverged { body: BodyId(b), velocity: self.bodies[b].twist.linear.into() })
            }
            None => Ok(()),
        }
    }

    fn contact_impulse(&self, b: BodyId) -> Wrench {
        self.bodies[b.0].impulse
    }

    fn set_twist(&mut self, b: BodyId, twist: Twist) {
        self.bodies[b.0].twist = twist;
    }

    /// A fixed part of the half period π√(M/k) of the stiffest contact foreseen: every body against its own kind
    /// and against the walls, overlapping by a twentieth of its radius, k = Y A/L_c.
    fn stable_dt(&self) -> f64 {
        self.stable_dt
    }
}
