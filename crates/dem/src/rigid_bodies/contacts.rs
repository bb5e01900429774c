//! Forces of the pairs that touch.
use super::Partner;
use super::body::{Body, Constants};
use super::meeting::{Meeting, Other, shift};
use crate::broad_phase::NearPair;
use crate::contact::{ContactLaw, Push, Touch};
use crate::{DemError, HalfSpace, Overlap, OverlapSolver, PairProperties};
use interfaces::{BodyId, Periods, Point, Twist, Vector, Wrench};

/// Pairs that are worked on as one: their number does not depend on that of threads, and so does no sum.
pub(super) const CHUNK: usize = 1024;
/// Contacts count as no nearer to a body's centre than this part of its inner radius, or L_c would vanish there.
const SHORTEST_ARM: f64 = 0.05;

/// A patch of an overlap, and what it does to the first of the pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch<M> {
    /// Number of the pair in the list of near ones.
    pub(super) near: u32,
    pub(super) volume: f64,
    pub(super) point: Point,
    pub(super) normal: Vector,
    pub(super) force: Vector,
    pub(super) couple: Vector,
    pub(super) memory: M,
}

impl<M> Patch<M> {
    #[inline]
    fn new(near: u32, overlap: &Overlap, push: &Push, memory: M) -> Self {
        let Overlap { volume, centroid, normal, .. } = *overlap;
        Self { near, volume, point: centroid, normal, force: push.force, couple: push.couple, memory }
    }
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

impl<L: ContactLaw> View<'_, L> {
    /// Forces of the pairs from `first` on that are this chunk's.
    pub(super) fn fill(&self, first: usize, chunk: &mut Chunk<L::Memory>, dt: f64) {
        let Chunk { patches, last, solver, overlap_calls, stiffest, error } = chunk;
        std::mem::swap(patches, last);
        patches.clear();
        (*stiffest, *error) = (0.0, None);
        let mut old = 0;
        let end = self.near.len().min(first + CHUNK);
        for (k, pair) in (first..).zip(&self.near[first..end]) {
            let meeting = self.meeting(pair);
            if meeting.is_apart() {
                continue;
            }
            *overlap_calls += 1;
            while last.get(old).is_some_and(|p| (p.near as usize) < k) {
                old += 1;
            }
            let mut failed = None;
            if meeting.is_round() {
                let Some(overlap) = meeting.lens() else { continue };
                let before = last.get(old).filter(|p| p.near as usize == k);
                if meeting.is_through(&overlap, before) {
                    failed = Some(self.passed_through(*pair, overlap.volume));
                } else {
                    let (push, memory) = self.push::<true>(&meeting, &overlap, overlap.volume, before, dt);
                    *stiffest = stiffest.max(push.stiffness);
                    patches.push(Patch::new(k as u32, &overlap, &push, memory));
                }
            } else {
                let same = last[old..].iter().take_while(|p| p.near as usize == k).count();
                let before = &last[old..old + same];
                match meeting.solve(solver) {
                    Err(error) => failed = Some(error),
                    Ok(shared) => {
                        let volume = shared.iter().map(|o| o.volume).sum();
                        for overlap in shared {
                            let before = remembered(before, shared, overlap);
                            if meeting.is_through(overlap, before) {
                                failed = Some(self.passed_through(*pair, overlap.volume));
                                break;
                            }
                            let (push, memory) = self.push::<false>(&meeting, overlap, volume, before, dt);
                            *stiffest = stiffest.max(push.stiffness);
                            patches.push(Patch::new(k as u32, overlap, &push, memory));
                        }
                    }
                }
            }
            if failed.is_some() {
                *error = failed;
                return;
            }
        }
    }

    /// What a patch does to the first of a pair (its stiffness over mass \[1/s²\]), and what the law keeps of it; `ROUND` where both are balls or discs, or one and a wall.
    #[inline(always)]
    fn push<const ROUND: bool>(
        &self,
        meeting: &Meeting<'_>,
        overlap: &Overlap,
        volume: f64,
        before: Option<&Patch<L::Memory>>,
        dt: f64,
    ) -> (Push, L::Memory) {
        let Meeting { a, constants, other, .. } = meeting;
        let normal = overlap.normal;
        let arm_a = overlap.centroid - a.pose.position;
        // Contacts of round bodies are on the line of centres.
        let length = |arm: &Vector, sign: f64| if ROUND { sign * arm.dot(&normal) } else { arm.norm() };
        let area = if ROUND { -overlap.gradient.dot(&normal) } else { overlap.area() };
        let (size_a, inner_a) = if ROUND { (a.radius, a.radius) } else { (constants.size, constants.inner) };
        let (twist_b, arm_b, length_b, size_b, face_b, inverse_b, material_b) = match other {
            Other::Body(b, constants, at_b) => {
                let arm = overlap.centroid - at_b;
                let (size, face) = if ROUND { (b.radius, 0.0) } else { (constants.size, constants.face) };
                let inner = if ROUND { b.radius } else { constants.inner };
                let length = length(&arm, 1.0).max(SHORTEST_ARM * inner);
                (b.twist, arm, length, size, face, b.inverse_mass, b.material)
            }
            Other::Wall(w) => {
                let far = f64::INFINITY;
                (Twist::default(), Vector::zeros(), far, far, far, 0.0, w.material)
            }
        };
        // Two that may turn but not move are to one another what they would be if they could.
        let inverse_masses = match (a.inverse_mass, inverse_b, other) {
            (0.0, 0.0, Other::Body(_, b, _)) => [1.0 / constants.inertia.mass, 1.0 / b.inertia.mass],
            (0.0, 0.0, Other::Wall(_)) => [1.0 / constants.inertia.mass, 0.0],
            (wa, wb, _) => [wa, wb],
        };
        let mobility = if L::MOBILITY {
            let mut sum = area * area * (a.inverse_mass + inverse_b);
            if !ROUND {
                let of = |constants: &Constants, body: &Body, arm: &Vector| {
                    let j = arm.cross(&overlap.gradient) + overlap.moment;
                    constants.turning.mobility(&body.pose.orientation, &j)
                };
                sum += of(constants, a, &arm_a);
                if let Other::Body(b, constants, _) = other {
                    sum += of(constants, b, &arm_b);
                }
            }
            sum
        } else {
            f64::NAN
        };
        let touch = Touch {
            overlap,
            area,
            volume,
            velocity: a.twist.at(arm_a) - twist_b.at(arm_b),
            spin: a.twist.angular - twist_b.angular,
            inverse_masses,
            arms: [length(&arm_a, -1.0).max(SHORTEST_ARM * inner_a), length_b],
            sizes: [size_a, size_b],
            mobility,
            face: if ROUND { 0.0 } else { constants.face.min(face_b) },
            plane: a.is_plane(),
            dt,
        };
        let mut memory = before.map_or_else(L::Memory::default, |p| p.memory);
        let properties = &self.properties[a.material as usize * self.n_materials + material_b as usize];
        let mut push = self.law.push(properties, &touch, &mut memory);
        let inverse = inverse_masses[0] + inverse_masses[1];
        let inverse = if L::MOBILITY && area > 0.0 { mobility / (area * area) } else { inverse };
        push.stiffness *= inverse;
        (push, memory)
    }

    #[cold]
    fn passed_through(&self, pair: NearPair, volume: f64) -> DemError {
        let of = |b: u32| self.constants.get(b as usize).map_or(f64::INFINITY, |c| c.inertia.volume);
        let share = volume / of(pair.a).min(of(pair.b));
        DemError::PassedThrough { body: BodyId(pair.a as usize), partner: self.partner(&pair), share }
    }

    /// What the first of a pair meets.
    pub(super) fn partner(&self, pair: &NearPair) -> Partner {
        let b = pair.b as usize;
        if b < self.bodies.len() {
            Partner::Body(BodyId(b), pair.image)
        } else {
            Partner::Wall(wall_of(pair.b))
        }
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

/// The patch before that a patch goes on from: the pair's nearest one, unless another patch is nearer to it.
#[inline]
fn remembered<'a, M>(before: &'a [Patch<M>], now: &[Overlap], patch: &Overlap) -> Option<&'a Patch<M>> {
    match (before, now) {
        ([], _) => None,
        ([only], [_]) => Some(only),
        _ => {
            let away = |p: &Patch<M>, o: &Overlap| (p.point - o.centroid).norm_squared();
            before
                .iter()
                .min_by(|p, q| away(p, patch).total_cmp(&away(q, patch)))
                .filter(|p| now.iter().all(|o| std::ptr::eq(o, patch) || away(p, o) > away(p, patch)))
        }
    }
}
