//! Two that may touch.
use super::body::{Body, Constants, Kind};
use super::contacts::{View, Wall, wall_of};
use crate::broad_phase::NearPair;
use crate::contact::ContactLaw;
use crate::overlap::{Overlap, closed};
use crate::{DemError, OverlapSolver};
use interfaces::{Periods, Point, Pose, Vector};

/// A body and what it may touch.
#[derive(Clone, Copy)]
pub(super) struct Meeting<'a> {
    pub(super) pair: &'a NearPair,
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
    pub(super) fn meeting(&self, pair: &'a NearPair) -> Meeting<'a> {
        let (a, b) = (pair.a as usize, pair.b as usize);
        let other = match self.bodies.get(b) {
            Some(body) => {
                Other::Body(body, &self.constants[b], body.pose.position + shift(&self.periods, pair.image))
            }
            None => Other::Wall(&self.walls[wall_of(pair.b)]),
        };
        Meeting { pair, a: &self.bodies[a], constants: &self.constants[a], other }
    }

    /// What the two of a pair share.
    pub(super) fn overlaps(
        &self,
        pair: &'a NearPair,
        solver: &mut OverlapSolver,
        found: &mut impl FnMut(&[Overlap]),
    ) -> Result<(), DemError> {
        let meeting = self.meeting(pair);
        if meeting.is_apart() {
            return Ok(());
        }
        match meeting.round() {
            Some(Some(overlap)) => found(&[overlap]),
            Some(None) => {}
            None => match meeting.solve(solver)? {
                [] => {}
                patches => found(patches),
            },
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

    /// The overlap of two balls or discs, or of one and a wall; `None` for other pairs.
    #[inline(always)]
    pub(super) fn round(&self) -> Option<Option<Overlap>> {
        let (place, r) = (self.a.pose.position, self.a.radius);
        match (&self.other, self.a.kind) {
            (Other::Body(b, _, at_b), Kind::Ball) if b.kind == Kind::Ball => {
                Some(closed::spheres(r, place, b.radius, *at_b))
            }
            (Other::Body(b, _, at_b), Kind::Disc) if b.kind == Kind::Disc => {
                Some(closed::discs(r, place, b.radius, *at_b))
            }
            (Other::Wall(w), Kind::Ball) => {
                Some(closed::sphere_wall(r, place, w.plane.signed_distance(place), w.plane.normal()))
            }
            (Other::Wall(w), Kind::Disc) => {
                Some(closed::disc_wall(r, place, w.plane.signed_distance(place), w.plane.normal()))
            }
            _ => None,
        }
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
