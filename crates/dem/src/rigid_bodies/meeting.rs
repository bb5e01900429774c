//! Two that may touch.
use super::body::{Body, Constants, Kind};
use super::contacts::{Patch, View, Wall, wall_of};
use crate::broad_phase::NearPair;
use crate::contact::ContactLaw;
use crate::overlap::{Overlap, closed};
use crate::{DemError, OverlapSolver};
use interfaces::{Periods, Point, Pose, Vector};

/// Overlaps of more than this times the cube of the smaller body's size are looked at: is the body still pushed back?
const DEEP: f64 = 1e-3;
/// A patch that is turned round goes on from one no farther away than this, in sizes of the smaller body.
const BESIDE: f64 = 0.25;

/// A body and what it may touch.
#[derive(Clone, Copy)]
pub(super) struct Meeting<'a> {
    pub(super) a: &'a Body,
    pub(super) constants: &'a Constants,
    pub(super) other: Other<'a>,
}

/// The second of a pair.
#[derive(Clone, Copy)]
pub(super) enum Other<'a> {
    /// A body, and where its image is that is near.
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

impl<'a, L: ContactLaw> View<'a, L> {
    #[inline(always)]
    pub(super) fn meeting(&self, pair: &NearPair) -> Meeting<'a> {
        let (a, b) = (pair.a as usize, pair.b as usize);
        let other = match self.bodies.get(b) {
            Some(body) => {
                Other::Body(body, &self.constants[b], body.pose.position + shift(&self.periods, pair.image))
            }
            None => Other::Wall(&self.walls[wall_of(pair.b)]),
        };
        Meeting { a: &self.bodies[a], constants: &self.constants[a], other }
    }

    /// What the two of a pair share.
    pub(super) fn overlaps(
        &self,
        pair: &NearPair,
        solver: &mut OverlapSolver,
        found: &mut impl FnMut(&[Overlap]),
    ) -> Result<(), DemError> {
        let meeting = self.meeting(pair);
        if meeting.is_apart() {
            return Ok(());
        }
        if meeting.is_round() {
            meeting.lens().iter().for_each(|lens| found(std::slice::from_ref(lens)));
        } else if let patches @ [_, ..] = meeting.solve(solver)? {
            found(patches);
        }
        Ok(())
    }
}

impl Meeting<'_> {
    /// Are the spheres around both apart?
    #[inline(always)]
    pub(super) fn is_apart(&self) -> bool {
        let place = self.a.pose.position;
        match &self.other {
            Other::Body(b, _, at_b) => {
                let within = self.a.radius + b.radius;
                (place - at_b).norm_squared() >= within * within
            }
            Other::Wall(wall) => wall.plane.signed_distance(place) >= self.a.radius,
        }
    }

    /// Are both balls or discs, or one and a wall?
    #[inline]
    pub(super) fn is_round(&self) -> bool {
        self.a.kind != Kind::Other
            && match &self.other {
                Other::Body(b, _, _) => b.kind == self.a.kind,
                Other::Wall(_) => true,
            }
    }

    /// The overlap of two that are round.
    #[inline(always)]
    pub(super) fn lens(&self) -> Option<Overlap> {
        let (place, r) = (self.a.pose.position, self.a.radius);
        match (&self.other, self.a.kind) {
            (Other::Body(b, _, at_b), Kind::Disc) => closed::discs(r, place, b.radius, *at_b),
            (Other::Body(b, _, at_b), _) => closed::spheres(r, place, b.radius, *at_b),
            (Other::Wall(w), Kind::Disc) => {
                closed::disc_wall(r, place, w.plane.signed_distance(place), w.plane.normal())
            }
            (Other::Wall(w), _) => {
                closed::sphere_wall(r, place, w.plane.signed_distance(place), w.plane.normal())
            }
        }
    }

    /// Is one of both on its way through the other: no longer pushed back, or the other way than `before`?
    #[inline]
    pub(super) fn is_through<M>(&self, overlap: &Overlap, before: Option<&Patch<M>>) -> bool {
        // Of balls and discs the size is the radius.
        let size = |b: &Body, c: &Constants| if b.kind == Kind::Other { c.size } else { b.radius };
        let mut smaller = size(self.a, self.constants);
        if let Other::Body(b, c, _) = &self.other {
            smaller = smaller.min(size(b, c));
        }
        let deep = DEEP * smaller * smaller * if self.a.is_plane() { 1.0 } else { smaller };
        let turned = |p: &Patch<M>| {
            p.volume > deep
                && p.normal.dot(&overlap.normal) < 0.0
                && (p.point - overlap.centroid).norm() < BESIDE * smaller
        };
        overlap.volume > deep
            && (overlap.area() * smaller <= 1e-9 * overlap.volume || before.is_some_and(turned))
    }

    /// The overlap of any two.
    pub(super) fn solve(self, solver: &mut OverlapSolver) -> Result<&[Overlap], DemError> {
        let (shape, pose) = (&*self.constants.shape, &self.a.pose);
        match &self.other {
            Other::Body(b, constants, at_b) => {
                solver.solve(shape, pose, &*constants.shape, &Pose { position: *at_b, ..b.pose })
            }
            Other::Wall(wall) => solver.solve(shape, pose, &wall.plane, &Pose::at([0.0; 3])),
        }
    }
}
