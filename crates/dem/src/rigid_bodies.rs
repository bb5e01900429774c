//! The set of bodies.
use crate::contact::{Touch, force, series};
use crate::overlap::wall_overlap;
use crate::{DemError, HalfSpace, Material, Overlap, PairProperties, Shape, overlap};
use interfaces::{
    Bodies, BodyId, Checkpoint, Dynamics, Freedom, Inertia, Kinematics, Load, Periods, Point, Pose,
    RestartError, Rotation, Solid, Twist, Vector, Wrench,
};

/// Rigid bodies that touch one another and plane walls, in a box that may be periodic.
///
/// [`advance`](Dynamics::advance) moves them by the drift–kick–drift form of the leapfrog method (symplectic,
/// second order), in one step while no bounding spheres can meet, else in steps of at most
/// [`stable_dt`](Dynamics::stable_dt). A warmed-up `advance` allocates nothing.
#[derive(Clone, Debug)]
pub struct RigidBodies {
    periods: Periods,
    bodies: Vec<Body>,
    walls: Vec<(HalfSpace, Material)>,
    /// L_c = `length_factor` · l_i l_j/(l_i + l_j).
    length_factor: f64,
    /// Elastic tangential forces of touching pairs, sorted by key.
    springs: Vec<Spring>,
    last_springs: Vec<Spring>,
    near: Vec<Pair>,
    time: f64,
    contact_time: f64,
    overlap_calls: u64,
}

#[derive(Clone, Copy, Debug)]
struct Body {
    shape: Shape,
    material: Material,
    inertia: Inertia,
    pose: Pose,
    twist: Twist,
    freedom: Freedom,
    moves: u64,
    load: Load,
    /// Contact wrench now, and its time integral over the last advance.
    contact: Wrench,
    impulse: Wrench,
}

/// Two bodies, or a body and (from `n_bodies` on) a wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Pair(usize, usize);

#[derive(Clone, Copy, Debug)]
struct Spring {
    pair: Pair,
    force: Vector,
}

/// Sub-steps per half period of the stiffest contact foreseen.
const STEPS_PER_CONTACT: f64 = 25.0;
/// Overlap, in radii of the smaller body, up to which that stiffness is foreseen.
const FORESEEN_DEPTH: f64 = 0.05;

impl RigidBodies {
    /// No bodies yet, in space that repeats after `periods`.
    pub fn new(periods: Periods) -> Self {
        Self {
            periods,
            bodies: Vec::new(),
            walls: Vec::new(),
            length_factor: 4.0,
            springs: Vec::new(),
            last_springs: Vec::new(),
            near: Vec::new(),
            time: 0.0,
            contact_time: 0.0,
            overlap_calls: 0,
        }
    }
    /// Another factor c in L_c = c·l_i l_j/(l_i + l_j); 4 unless told.
    #[must_use]
    pub fn with_length_factor(mut self, factor: f64) -> Self {
        self.length_factor = factor;
        self
    }

    /// Adds a body.
    ///
    /// # Errors
    /// [`DemError`] for a material, place, motion or size that makes no sense here.
    pub fn add(
        &mut self,
        shape: impl Into<Shape>,
        material: Material,
        pose: Pose,
        twist: Twist,
        freedom: Freedom,
    ) -> Result<BodyId, DemError> {
        let (shape, body) = (shape.into(), BodyId(self.bodies.len()));
        material.check()?;
        let numbers = [pose.position.coords, twist.linear, twist.angular];
        if !numbers.iter().flat_map(|v| v.iter()).all(|x| x.is_finite()) {
            return Err(DemError::Start { body, position: pose.position.into() });
        }
        let extent = shape.solid().aabb().posed(&pose).extent();
        for axis in 0..3 {
            if let Some(period) = self.periods.along(axis)
                && extent[axis] > 0.5 * period
            {
                return Err(DemError::Period { body, axis, size: extent[axis], period });
            }
        }
        let inertia = shape.inertia(material.density);
        let (load, contact, impulse) = Default::default();
        self.bodies.push(Body {
            shape,
            material,
            inertia,
            pose,
            twist,
            freedom,
            moves: 0,
            load,
            contact,
            impulse,
        });
        Ok(body)
    }

    /// Adds a plane wall of `material` (its density does not matter: walls do not move).
    ///
    /// # Errors
    /// [`DemError::Material`].
    pub fn add_wall(&mut self, wall: HalfSpace, material: Material) -> Result<(), DemError> {
        material.check()?;
        self.walls.push((wall, material));
        Ok(())
    }

    /// Are all bodies clear of one another and of the walls?
    ///
    /// # Errors
    /// [`DemError::OverlappingStart`] or [`DemError::InWall`] for the first that are not.
    pub fn check_overlaps(&self) -> Result<(), DemError> {
        for (j, b) in self.bodies.iter().enumerate() {
            for (i, a) in self.bodies[..j].iter().enumerate() {
                if let Some(o) = self.pair_overlap(a, b)? {
                    return Err(DemError::OverlappingStart { a: BodyId(i), b: BodyId(j), depth: o.depth });
                }
            }
            for (wall, (plane, _)) in self.walls.iter().enumerate() {
                if let Some(o) = wall_overlap(&b.shape, b.pose.position, plane) {
                    return Err(DemError::InWall { body: BodyId(j), wall, depth: o.depth });
                }
            }
        }
        Ok(())
    }

    /// Overlap of two bodies, the second at its image nearest to the first.
    fn pair_overlap(&self, a: &Body, b: &Body) -> Result<Option<Overlap>, DemError> {
        let apart = self.periods.nearest(b.pose.position - a.pose.position);
        overlap(&a.shape, a.pose.position, &b.shape, a.pose.position + apart)
    }

    /// The smallest distance between any two surfaces \[m\], negative when they overlap; walls count. `None`
    /// with one body and no walls.
    pub fn smallest_gap(&self) -> Option<f64> {
        let gaps = (0..self.bodies.len()).flat_map(|j| {
            let b = &self.bodies[j];
            let radius = b.shape.bounding_radius();
            let pairs = self.bodies[..j].iter().map(move |a| {
                let apart = self.periods.nearest(b.pose.position - a.pose.position);
                apart.norm() - radius - a.shape.bounding_radius()
            });
            pairs.chain(self.walls.iter().map(move |(w, _)| w.signed_distance(b.pose.position) - radius))
        });
        gaps.reduce(f64::min)
    }
    /// Seconds so far in which anything touched anything.
    pub fn contact_time(&self) -> f64 {
        self.contact_time
    }
    /// How many pairs touch now.
    pub fn n_contacts(&self) -> usize {
        self.springs.len()
    }
    /// How many overlaps were computed in all steps so far; pairs whose boxes are apart cost none.
    pub fn overlap_calls(&self) -> u64 {
        self.overlap_calls
    }
    /// Σ ½mU² + ½ΩIΩ \[J\].
    pub fn kinetic_energy(&self) -> f64 {
        let energy = |b: &Body| {
            let turned = b.pose.orientation.inverse_transform_vector(&b.twist.angular);
            0.5 * (b.inertia.mass * b.twist.linear.norm_squared() + turned.dot(&(b.inertia.tensor * turned)))
        };
        self.bodies.iter().map(energy).sum()
    }
    /// The periods of space.
    pub fn periods(&self) -> Periods {
        self.periods
    }
    /// The shape of body `b`.
    pub fn shape(&self, b: BodyId) -> &Shape {
        &self.bodies[b.0].shape
    }

    /// Lists the pairs whose boxes may meet within `dt`.
    fn find_near(&mut self, dt: f64) {
        let n = self.bodies.len();
        self.near.clear();
        for j in 0..n {
            let b = &self.bodies[j];
            let reach_b = reach(b, dt);
            for i in 0..j {
                let a = &self.bodies[i];
                let apart = self.periods.nearest(b.pose.position - a.pose.position);
                let within = reach_b + reach(a, dt);
                if apart.iter().all(|x| x.abs() <= within) {
                    self.near.push(Pair(i, j));
                }
            }
            for (w, (wall, _)) in self.walls.iter().enumerate() {
                if wall.signed_distance(b.pose.position) <= reach_b {
                    self.near.push(Pair(j, n + w));
                }
            }
        }
        self.near.sort_unstable();
    }

    /// Contact wrenches on all bodies, as things stand; `dt` updates the springs.
    fn contacts(&mut self, dt: f64) -> Result<(), DemError> {
        for b in &mut self.bodies {
            b.contact = Wrench::default();
        }
        std::mem::swap(&mut self.springs, &mut self.last_springs);
        self.springs.clear();
        let n = self.bodies.len();
        for at in 0..self.near.len() {
            let pair = self.near[at];
            self.overlap_calls += 1;
            let a = &self.bodies[pair.0];
            let (found, second) = match self.bodies.get(pair.1) {
                Some(b) => (self.pair_overlap(a, b)?, Some(b)),
                None => (wall_overlap(&a.shape, a.pose.position, &self.walls[pair.1 - n].0), None),
            };
            let Some(overlap) = found else { continue };
            let arm_a = overlap.centroid - a.pose.position;
            let (arm_b, twist_b, mass_b, material_b) = match second {
                // The centroid belongs to the image near `a`.
                Some(b) => {
                    (self.periods.nearest(overlap.centroid - b.pose.position), b.twist, mass(b), b.material)
                }
                None => (Vector::zeros(), Twist::default(), f64::INFINITY, self.walls[pair.1 - n].1),
            };
            let (la, lb) = (arm_a.norm(), arm_b.norm());
            let touch = Touch {
                velocity: a.twist.at(arm_a) - twist_b.at(arm_b),
                mass: if mass_b.is_infinite() {
                    mass(a)
                } else if mass(a).is_infinite() {
                    mass_b
                } else {
                    series(mass(a), mass_b)
                },
                length: self.length_factor * if second.is_some() { series(la, lb) } else { la },
                overlap,
            };
            // Centres that coincide with the contact, or two immovable bodies, give no direction to push.
            if !(touch.length > 0.0 && touch.mass.is_finite()) {
                continue;
            }
            let mut spring = match self.last_springs.binary_search_by_key(&pair, |s| s.pair) {
                Ok(k) => self.last_springs[k].force,
                Err(_) => Vector::zeros(),
            };
            let f = force(&PairProperties::new(&a.material, &material_b), &touch, &mut spring, dt);
            self.springs.push(Spring { pair, force: spring });
            self.bodies[pair.0].contact += Wrench::at(f, arm_a);
            if pair.1 < n {
                self.bodies[pair.1].contact += Wrench::at(-f, arm_b);
            }
        }
        Ok(())
    }
}

/// How far a body's surface may come from its centre's present place within `dt`, along any axis.
fn reach(b: &Body, dt: f64) -> f64 {
    let a = b.load.wrench.force.norm() / (b.inertia.mass + b.load.added_mass);
    b.shape.bounding_radius() + dt * (b.twist.linear.norm() + 0.5 * dt * a)
}

/// The mass that a contact feels: infinite for a body that may not be moved.
fn mass(b: &Body) -> f64 {
    if b.freedom.linear.iter().any(|&f| f) { b.inertia.mass } else { f64::INFINITY }
}

/// Moves a body along with its twist.
fn drift(b: &mut Body, dt: f64) {
    let (step, turn) = (b.twist.linear * dt, b.twist.angular * dt);
    if step != Vector::zeros() || turn != Vector::zeros() {
        b.pose.position += step;
        b.pose.orientation = Rotation::from_scaled_axis(turn) * b.pose.orientation;
        b.pose.orientation.renormalize_fast();
        b.moves += 1;
    }
}

/// Changes a body's twist by load and contact over `dt`.
fn kick(b: &mut Body, dt: f64) {
    let Load { wrench, added_mass, added_moment } = b.load;
    let total = wrench + b.contact;
    let accelerate = total.force / (b.inertia.mass + added_mass);
    // Euler's equations in the body's frame: (I + I_a) dω/dt = t − ω × Iω.
    let q = b.pose.orientation;
    let omega = q.inverse_transform_vector(&b.twist.angular);
    let torque = q.inverse_transform_vector(&total.torque) - omega.cross(&(b.inertia.tensor * omega));
    let tensor = b.inertia.tensor + nalgebra::Matrix3::from_diagonal_element(added_moment);
    let spin = tensor.try_inverse().map_or(Vector::zeros(), |inverse| q * (inverse * torque));
    for i in 0..3 {
        if b.freedom.linear[i] {
            b.twist.linear[i] += dt * accelerate[i];
        }
        if b.freedom.angular[i] {
            b.twist.angular[i] += dt * spin[i];
        }
    }
    b.impulse += b.contact * dt;
}

impl Kinematics for RigidBodies {
    fn n_bodies(&self) -> usize {
        self.bodies.len()
    }
    fn pose(&self, b: BodyId) -> Pose {
        self.bodies[b.0].pose
    }
    fn twist(&self, b: BodyId) -> Twist {
        self.bodies[b.0].twist
    }
}

impl Bodies for RigidBodies {
    fn solid(&self, b: BodyId) -> &dyn Solid {
        self.bodies[b.0].shape.solid()
    }
    fn inertia(&self, b: BodyId) -> Inertia {
        self.bodies[b.0].inertia
    }
    fn freedom(&self, b: BodyId) -> Freedom {
        self.bodies[b.0].freedom
    }
    fn moves(&self, b: BodyId) -> u64 {
        self.bodies[b.0].moves
    }
}

impl Dynamics for RigidBodies {
    type Error = DemError;

    fn apply(&mut self, b: BodyId, load: Load) {
        self.bodies[b.0].load = load;
    }

    fn advance(&mut self, dt: f64) -> Result<(), DemError> {
        if !(dt.is_finite() && dt > 0.0) {
            return Err(DemError::TimeStep { dt });
        }
        for b in &mut self.bodies {
            (b.impulse, b.contact) = Default::default();
        }
        self.find_near(dt);
        let steps = if self.near.is_empty() { 1.0 } else { (dt / self.stable_dt()).ceil().max(1.0) };
        let sub = dt / steps;
        for _ in 0..steps as u64 {
            self.bodies.iter_mut().for_each(|b| drift(b, 0.5 * sub));
            if self.near.is_empty() {
                self.springs.clear();
            } else {
                self.contacts(sub)?;
                self.contact_time += if self.springs.is_empty() { 0.0 } else { sub };
            }
            self.bodies.iter_mut().for_each(|b| kick(b, sub));
            self.bodies.iter_mut().for_each(|b| drift(b, 0.5 * sub));
        }
        self.time += dt;
        match self
            .bodies
            .iter()
            .position(|b| !b.twist.linear.iter().chain(b.twist.angular.iter()).all(|x| x.is_finite()))
        {
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

    /// A 25th of the half period π√(M/k) of the stiffest contact foreseen: every body against its own kind
    /// and against the walls, overlapping by a twentieth of its radius, k = Y A/L_c.
    fn stable_dt(&self) -> f64 {
        let half_period = |b: &Body, other: &Material, wall: bool| {
            let r = b.shape.bounding_radius();
            let depth = FORESEEN_DEPTH * r;
            let half_depth = if wall { depth } else { 0.5 * depth };
            let chord = (half_depth * (2.0 * r - half_depth)).sqrt();
            let area = match b.shape {
                Shape::Disc(_) => 2.0 * chord,
                Shape::Sphere(_) => std::f64::consts::PI * chord * chord,
            };
            let p = PairProperties::new(&b.material, other);
            let (mass, length) = if wall { (b.inertia.mass, r) } else { (0.5 * b.inertia.mass, 0.5 * r) };
            std::f64::consts::PI * (mass * self.length_factor * length / (p.stiffness * area)).sqrt()
        };
        let contacts = self.bodies.iter().flat_map(|b| {
            let own = half_period(b, &b.material, false);
            std::iter::once(own).chain(self.walls.iter().map(move |(_, m)| half_period(b, m, true)))
        });
        contacts.fold(f64::INFINITY, f64::min) / STEPS_PER_CONTACT
    }
}

impl Checkpoint for RigidBodies {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        let mut values = Vec::with_capacity(self.bodies.len() * BODY);
        for b in &self.bodies {
            let q = b.pose.orientation;
            values.extend_from_slice(b.pose.position.coords.as_slice());
            values.extend([q.w, q.i, q.j, q.k]);
            values.extend_from_slice(b.twist.linear.as_slice());
            values.extend_from_slice(b.twist.angular.as_slice());
            values.push(b.moves as f64);
        }
        sink("bodies", &values);
        values.clear();
        for s in &self.springs {
            values.extend([s.pair.0 as f64, s.pair.1 as f64, s.force.x, s.force.y, s.force.z]);
        }
        sink("n_springs", &[self.springs.len() as f64]);
        sink("springs", &values);
        sink("clock", &[self.time, self.contact_time, self.overlap_calls as f64]);
    }

    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        let values = RestartError::take(source, "bodies", self.bodies.len() * BODY)?;
        for (b, v) in self.bodies.iter_mut().zip(values.chunks_exact(BODY)) {
            b.pose.position = Point::new(v[0], v[1], v[2]);
            // As it was saved, to the last bit.
            b.pose.orientation = Rotation::new_unchecked(nalgebra::Quaternion::new(v[3], v[4], v[5], v[6]));
            b.twist.linear = Vector::new(v[7], v[8], v[9]);
            b.twist.angular = Vector::new(v[10], v[11], v[12]);
            b.moves = v[13] as u64;
        }
        let n = RestartError::take(source, "n_springs", 1)?[0] as usize;
        self.springs.clear();
        for v in RestartError::take(source, "springs", 5 * n)?.chunks_exact(5) {
            let pair = Pair(v[0] as usize, v[1] as usize);
            self.springs.push(Spring { pair, force: Vector::new(v[2], v[3], v[4]) });
        }
        let clock = RestartError::take(source, "clock", 3)?;
        (self.time, self.contact_time, self.overlap_calls) = (clock[0], clock[1], clock[2] as u64);
        Ok(())
    }
}

/// Saved numbers per body.
const BODY: usize = 14;
