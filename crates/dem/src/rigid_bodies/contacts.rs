//! Forces of the pairs that touch.
use super::body::{Body, Constants, Kind};
use crate::broad_phase::NearPair;
use crate::contact::{ContactLaw, Push, Touch};
use crate::overlap::{Overlap, closed};
use crate::{DemError, HalfSpace, OverlapSolver, PairProperties};
use interfaces::{Periods, Point, Pose, Twist, Vector, Wrench};

/// Pairs that are worked on as one: their number does not depend on that of threads, and so does no sum.
pub(super) const CHUNK: usize = 1024;

/// A patch of an overlap, and what it does to the first of the pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch<M> {
    /// Number of the pair in the list of near ones.
    pub(super) near: u32,
    pub(super) volume: f64,
    pub(super) point: Point,
    pub(super) force: Vector,
    pub(super) couple: Vector,
    pub(super) memory: M,
}

/// Some of the pairs: what they do, and the memory this takes.
#[derive(Clone, Debug)]
pub(super) struct Chunk<M> {
    pub(super) patches: Vec<Patch<M>>,
    last: Vec<Patch<M>>,
    solver: OverlapSolver,
    pub(super) overlap_calls: u64,
    /// Largest stiffness over mass \[1/s²\].
    pub(super) stiffest: f64,
    pub(super) error: Option<DemError>,
}

impl<M> Chunk<M> {
    /// Takes the last forces back.
    pub(super) fn undo(&mut self) {
        std::mem::swap(&mut self.patches, &mut self.last);
    }
}

impl<M> Default for Chunk<M> {
    fn default() -> Self {
        Self {
            patches: Vec::new(),
            last: Vec::new(),
            solver: OverlapSolver::new(),
            overlap_calls: 0,
            stiffest: 0.0,
            error: None,
        }
    }
}

/// A plane wall of a material.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wall {
    pub(super) plane: HalfSpace,
    pub(super) material: u32,
}

/// The number of a wall as the second of a pair: from the top down, so that it stays what it is when bodies come in.
pub(super) fn wall_number(wall: usize) -> u32 {
    u32::MAX - wall as u32
}

/// The wall that has this number.
pub(super) fn wall_of(number: u32) -> usize {
    (u32::MAX - number) as usize
}

/// All that pairs are computed from.
#[derive(Clone, Copy)]
pub(super) struct View<'a, L> {
    pub(super) law: &'a L,
    pub(super) bodies: &'a [Body],
    pub(super) constants: &'a [Constants],
    pub(super) walls: &'a [Wall],
    pub(super) near: &'a [NearPair],
    pub(super) properties: &'a [PairProperties],
    pub(super) n_materials: usize,
    pub(super) periods: Periods,
}

/// The second of a pair.
enum Other<'a> {
    Body(&'a Body, &'a Constants, Point),
    Wall(&'a Wall),
}

/// How far away the image of a body is whose number of periods is `image`.
#[inline]
pub(super) fn shift(periods: &Periods, image: [i32; 3]) -> Vector {
    if image == [0; 3] {
        return Vector::zeros();
    }
    Vector::from_fn(|a, _| periods.along(a).map_or(0.0, |l| l * f64::from(image[a])))
}

impl<L: ContactLaw> View<'_, L> {
    #[inline]
    fn second(&self, pair: &NearPair) -> Other<'_> {
        let b = pair.b as usize;
        match self.bodies.get(b) {
            Some(body) => {
                Other::Body(body, &self.constants[b], body.pose.position + shift(&self.periods, pair.image))
            }
            None => Other::Wall(&self.walls[wall_of(pair.b)]),
        }
    }

    /// What the two of a pair share, handed to `found`; counts the overlaps that were computed.
    #[inline]
    pub(super) fn overlaps(
        &self,
        pair: &NearPair,
        solver: &mut OverlapSolver,
        calls: &mut u64,
        found: &mut impl FnMut(&[Overlap]),
    ) -> Result<(), DemError> {
        let a = &self.bodies[pair.a as usize];
        let place = a.pose.position;
        let other = self.second(pair);
        match &other {
            Other::Body(b, _, at_b) => {
                let within = a.radius + b.radius;
                if (place - at_b).norm_squared() >= within * within {
                    return Ok(());
                }
            }
            Other::Wall(wall) if wall.plane.signed_distance(place) >= a.radius => return Ok(()),
            Other::Wall(_) => {}
        }
        *calls += 1;
        let one = match (&other, a.kind) {
            (Other::Body(b, _, at_b), Kind::Ball) if b.kind == Kind::Ball => {
                closed::spheres(a.radius, place, b.radius, *at_b)
            }
            (Other::Body(b, _, at_b), Kind::Disc) if b.kind == Kind::Disc => {
                closed::discs(a.radius, place, b.radius, *at_b)
            }
            (Other::Wall(w), Kind::Ball) => {
                closed::sphere_wall(a.radius, place, w.plane.signed_distance(place), w.plane.normal())
            }
            (Other::Wall(w), Kind::Disc) => {
                closed::disc_wall(a.radius, place, w.plane.signed_distance(place), w.plane.normal())
            }
            _ => {
                let shape = &*self.constants[pair.a as usize].shape;
                let patches = match &other {
                    Other::Body(b, constants, at_b) => {
                        let pose = Pose { position: *at_b, ..b.pose };
                        solver.solve(shape, &a.pose, &*constants.shape, &pose)?
                    }
                    Other::Wall(wall) => solver.solve(shape, &a.pose, &wall.plane, &Pose::at([0.0; 3]))?,
                };
                if !patches.is_empty() {
                    found(patches);
                }
                return Ok(());
            }
        };
        if let Some(patch) = one {
            found(&[patch]);
        }
        Ok(())
    }

    /// Forces of the pairs from `first` on that are this chunk's.
    pub(super) fn fill(&self, first: usize, chunk: &mut Chunk<L::Memory>, dt: f64) {
        let Chunk { patches, last, solver, overlap_calls, stiffest, error } = chunk;
        std::mem::swap(patches, last);
        patches.clear();
        *stiffest = 0.0;
        let mut old = 0;
        let end = self.near.len().min(first + CHUNK);
        for (k, pair) in (first..).zip(&self.near[first..end]) {
            while last.get(old).is_some_and(|p| (p.near as usize) < k) {
                old += 1;
            }
            let mut found = |shared: &[Overlap]| {
                let same = last[old..].iter().take_while(|p| p.near as usize == k).count();
                let before = &last[old..old + same];
                let volume = shared.iter().map(|o| o.volume).sum();
                for overlap in shared {
                    let memory = remembered(before, shared, overlap);
                    let patch = self.patch(k as u32, pair, overlap, volume, memory, dt, stiffest);
                    patches.push(patch);
                }
            };
            if let Err(e) = self.overlaps(pair, solver, overlap_calls, &mut found) {
                *error = Some(e);
                return;
            }
        }
    }

    #[inline]
    #[expect(clippy::too_many_arguments)]
    fn patch(
        &self,
        near: u32,
        pair: &NearPair,
        overlap: &Overlap,
        volume: f64,
        mut memory: L::Memory,
        dt: f64,
        stiffest: &mut f64,
    ) -> Patch<L::Memory> {
        let (a, constants_a) = (&self.bodies[pair.a as usize], &self.constants[pair.a as usize]);
        let arm_a = overlap.centroid - a.pose.position;
        let round = a.kind != Kind::Other;
        let other = self.second(pair);
        let (twist_b, arm_b, length_b, size_b, flat_b, inverse_b, material_b) = match &other {
            Other::Body(b, constants, at_b) => {
                let arm = overlap.centroid - at_b;
                (b.twist, arm, arm.norm(), constants.size, constants.flat > 0.0, b.inverse_mass, b.material)
            }
            Other::Wall(w) => {
                (Twist::default(), Vector::zeros(), f64::INFINITY, f64::INFINITY, true, 0.0, w.material)
            }
        };
        // Two that may turn but not move are to one another what they would be if they could.
        let inverse_masses = match (a.inverse_mass, inverse_b, &other) {
            (0.0, 0.0, Other::Body(_, b, _)) => [1.0 / constants_a.inertia.mass, 1.0 / b.inertia.mass],
            (0.0, 0.0, Other::Wall(_)) => [1.0 / constants_a.inertia.mass, 0.0],
            (wa, wb, _) => [wa, wb],
        };
        let inverse_sum = a.inverse_mass + inverse_b;
        let mobility = if L::MOBILITY {
            let mut sum = overlap.gradient.norm_squared() * inverse_sum;
            let of = |constants: &Constants, body: &Body, arm: &Vector| {
                let j = arm.cross(&overlap.gradient) + overlap.moment;
                constants.turning.mobility(&body.pose.orientation, &j)
            };
            if !round {
                sum += of(constants_a, a, &arm_a);
            }
            if let Other::Body(b, constants, _) = &other
                && b.kind == Kind::Other
            {
                sum += of(constants, b, &arm_b);
            }
            sum
        } else {
            f64::NAN
        };
        let touch = Touch {
            overlap,
            volume,
            velocity: a.twist.at(arm_a) - twist_b.at(arm_b),
            spin: a.twist.angular - twist_b.angular,
            inverse_masses,
            arms: [arm_a.norm(), length_b],
            sizes: [constants_a.size, size_b],
            mobility,
            flat: flat_b && constants_a.flat > 0.0,
            plane: a.is_plane(),
            dt,
        };
        let properties = &self.properties[a.material as usize * self.n_materials + material_b as usize];
        let Push { force, couple, stiffness } = self.law.push(properties, &touch, &mut memory);
        let inverse = inverse_masses[0] + inverse_masses[1];
        let area = overlap.area();
        let inverse = if L::MOBILITY && area > 0.0 { mobility / (area * area) } else { inverse };
        *stiffest = stiffest.max(stiffness * inverse);
        Patch { near, volume: overlap.volume, point: overlap.centroid, force, couple, memory }
    }

    /// Adds the forces of a chunk to those on the bodies, always in the same order.
    pub(super) fn add(&self, chunk: &Chunk<L::Memory>, wrenches: &mut [Wrench]) {
        for patch in &chunk.patches {
            let pair = &self.near[patch.near as usize];
            let Wrench { force, torque } = &mut wrenches[pair.a as usize];
            let arm = patch.point - self.bodies[pair.a as usize].pose.position;
            *force += patch.force;
            *torque += arm.cross(&patch.force) + patch.couple;
            if let Some(b) = self.bodies.get(pair.b as usize) {
                let arm = patch.point - b.pose.position - shift(&self.periods, pair.image);
                let Wrench { force, torque } = &mut wrenches[pair.b as usize];
                *force -= patch.force;
                *torque -= arm.cross(&patch.force) + patch.couple;
            }
        }
    }
}

/// What is remembered of a patch: that of the pair's nearest one, unless another patch is nearer to it.
#[inline]
fn remembered<M: Copy + Default>(before: &[Patch<M>], now: &[Overlap], patch: &Overlap) -> M {
    match (before, now) {
        ([], _) => M::default(),
        ([only], [_]) => only.memory,
        _ => {
            let away = |p: &Patch<M>, o: &Overlap| (p.point - o.centroid).norm_squared();
            let nearest = before
                .iter()
                .min_by(|p, q| away(p, patch).total_cmp(&away(q, patch)))
                .filter(|p| now.iter().all(|o| std::ptr::eq(o, patch) || away(p, o) > away(p, patch)));
            nearest.map_or_else(M::default, |p| p.memory)
        }
    }
}
