//! Forces of the pairs that touch.
use super::Partner;
use super::body::{Body, Constants, Loads};
use super::film::Film;
use super::meeting::Other;
use super::push::larger;
use super::surfaces::Surfaces;
use crate::broad_phase::NearPair;
use crate::contact::{ContactLaw, Push};
use crate::overlap::closed;
use crate::{DemError, HalfSpace, Overlap, OverlapSolver, PairProperties};
use interfaces::{BodyId, Periods, Point, Vector, Wrench};

/// Pairs that are worked on as one: their number does not depend on that of threads, and so does no sum.
pub(super) const CHUNK: usize = 256;

/// A patch of an overlap, and what it does to the first of the pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch<M> {
    /// Number of the pair in the list of near ones.
    pub(super) near: u32,
    pub(super) volume: f64,
    pub(super) area: f64,
    pub(super) point: Point,
    pub(super) normal: Vector,
    pub(super) force: Vector,
    pub(super) couple: Vector,
    pub(super) memory: M,
}

/// The patches of one pair: those of the last sub-step and after, and where those of this one go.
pub(super) struct Record<'a, M> {
    pub(super) near: u32,
    pub(super) before: &'a [Patch<M>],
    pub(super) patches: &'a mut Vec<Patch<M>>,
}

impl<M> Record<'_, M> {
    #[inline(always)]
    pub(super) fn add(&mut self, overlap: &Overlap, area: f64, push: &Push, memory: M) {
        let Overlap { volume, centroid, normal, .. } = *overlap;
        let near = self.near;
        let Push { force, couple, .. } = *push;
        self.patches.push(Patch { near, volume, area, point: centroid, normal, force, couple, memory });
    }
}

/// Some of the pairs: what they do, and the memory this takes.
#[derive(Clone, Debug)]
pub(super) struct Chunk<M> {
    pub(super) patches: Vec<Patch<M>>,
    last: Vec<Patch<M>>,
    /// What bodies feel, where it is added up later: of each pair the second, and after the last pair in a row of a body that body.
    pub(super) felt: Vec<Wrench>,
    solver: OverlapSolver,
    pub(super) overlap_calls: u64,
    /// Pairs that a film keeps apart.
    pub(super) films: usize,
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
            felt: Vec::new(),
            solver: OverlapSolver::new(),
            overlap_calls: 0,
            films: 0,
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
    pub(super) loads: &'a Loads,
    pub(super) bodies: &'a [Body],
    pub(super) constants: &'a [Constants],
    pub(super) walls: &'a [Wall],
    pub(super) near: &'a [NearPair],
    pub(super) properties: &'a [PairProperties],
    pub(super) periods: Periods,
    /// Length of the last sub-step \[s\].
    pub(super) last_step: f64,
    /// Time \[s\] at which surfaces are looked at.
    pub(super) time: f64,
    /// Surfaces that slide, if any do.
    pub(super) surfaces: Option<&'a Surfaces>,
}

impl<L: ContactLaw> View<'_, L> {
    /// Forces of the pairs from `first` on that are this chunk's. What the second of each pair feels is handed to `add`, and after a row of
    /// pairs with the same first body what that one feels; `ALL`: of pairs that do not touch, too.
    #[inline(always)]
    pub(super) fn fill<const ALL: bool>(
        &self,
        first: usize,
        chunk: &mut Chunk<L::Memory>,
        dt: f64,
        mut add: impl FnMut(u32, Wrench),
    ) {
        let Chunk { patches, last, solver, overlap_calls, films, stiffest, error, .. } = chunk;
        std::mem::swap(patches, last);
        patches.clear();
        (*films, *stiffest, *error) = (0, 0.0, None);
        let mut before = &last[..];
        let end = self.near.len().min(first + CHUNK);
        let (mut one, mut own) = (self.near[first].a, Wrench::default());
        for (k, pair) in (first as u32..).zip(&self.near[first..end]) {
            if pair.a != one {
                add(one, own);
                (one, own) = (pair.a, Wrench::default());
            }
            let meeting = self.meeting(pair);
            if meeting.is_apart() {
                let film = if L::FILMS { self.film(&meeting) } else { None };
                if let Some(Film { on_both: [on_a, on_b], stiffness }) = film {
                    own += on_a;
                    *films += 1;
                    *stiffest = larger(stiffness, *stiffest);
                    if matches!(meeting.other, Other::Body(..)) {
                        add(pair.b, on_b);
                    }
                } else if ALL && matches!(meeting.other, Other::Body(..)) {
                    add(pair.b, Wrench::default());
                }
                continue;
            }
            *overlap_calls += 1;
            while let [p, rest @ ..] = before
                && p.near < k
            {
                before = rest;
            }
            let known = patches.len();
            let mut record = Record { near: k, before, patches };
            let (a, place) = (meeting.a, meeting.a.pose.position);
            let result = match meeting.other {
                Other::Body(b, at_b) if meeting.is_of_balls() => {
                    let lens = closed::lens(a.radius, place, b.radius, at_b);
                    self.push_balls(&meeting, &lens, &mut record, dt).map(|(stiffness, [on_a, on_b])| {
                        own += on_a;
                        add(pair.b, on_b);
                        stiffness
                    })
                }
                Other::Wall(wall) if meeting.is_of_balls() => {
                    let distance = wall.plane.signed_distance(place);
                    let lens = closed::cap_at_wall(a.radius, place, distance, wall.plane.normal());
                    self.push_balls(&meeting, &lens, &mut record, dt).map(|(stiffness, [on_a, _])| {
                        own += on_a;
                        stiffness
                    })
                }
                _ => {
                    let result = self.push(&meeting, &mut record, solver, dt);
                    let mut on_other = Wrench::default();
                    for p in &patches[known..] {
                        let [on_a, on_b] = meeting.wrenches(p.point, p.force, p.couple);
                        own += on_a;
                        on_other += on_b;
                    }
                    let mut result = result;
                    if L::FILMS
                        && patches.len() == known
                        && let Some(film) = self.film(&meeting)
                    {
                        let Film { on_both: [on_a, on_b], stiffness } = film;
                        own += on_a;
                        on_other += on_b;
                        *films += 1;
                        result = result.map(|r| larger(stiffness, r));
                    }
                    if matches!(meeting.other, Other::Body(..)) && (ALL || L::FILMS || patches.len() > known)
                    {
                        add(pair.b, on_other);
                    }
                    result
                }
            };
            match result {
                Ok(stiffness) => *stiffest = larger(stiffness, *stiffest),
                Err(failed) => {
                    *error = Some(failed);
                    return;
                }
            }
        }
        add(one, own);
    }

    /// The same where threads share the work: what is felt is kept, to be added up by bodies.
    #[cfg(feature = "parallel")]
    pub(super) fn fill_apart(&self, first: usize, chunk: &mut Chunk<L::Memory>, dt: f64) {
        let mut felt = std::mem::take(&mut chunk.felt);
        felt.clear();
        self.fill::<true>(first, chunk, dt, |_, wrench| felt.push(wrench));
        chunk.felt = felt;
    }

    #[cold]
    pub(super) fn passed_through(&self, pair: &NearPair, volume: f64) -> DemError {
        let of = |b: u32| self.constants.get(b as usize).map_or(f64::INFINITY, |c| c.inertia.volume);
        let share = volume / of(pair.a).min(of(pair.b));
        DemError::PassedThrough { body: BodyId(pair.a as usize), partner: self.partner(pair), share }
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

    /// Adds the forces of a chunk to those on the bodies.
    pub(super) fn add(&self, chunk: &Chunk<L::Memory>, wrenches: &mut [Wrench]) {
        for p in &chunk.patches {
            let pair = &self.near[p.near as usize];
            let [on_a, on_b] = self.meeting(pair).wrenches(p.point, p.force, p.couple);
            wrenches[pair.a as usize] += on_a;
            if let Some(b) = wrenches.get_mut(pair.b as usize) {
                *b += on_b;
            }
        }
    }
}
