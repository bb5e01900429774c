//! Two that may touch.
use super::body::{Body, Constants, Kind};
use super::contacts::{Patch, View, Wall, wall_of};
use crate::broad_phase::NearPair;
use crate::contact::ContactLaw;
use crate::overlap::{Overlap, closed};
use crate::{DemError, OverlapSolver};
use interfaces::{Periods, Point, Pose, Vector, Wrench};

/// Overlaps of more than this times the cube of the smaller body's size are looked at: is the body still pushed back?
const DEEP: f64 = 1e-3;
/// A patch that is turned round goes on from one no farther away than this, in sizes of the smaller body.
const BESIDE: f64 = 0.25;

/// A body and what it may touch.
#[derive(Clone, Copy)]
pub(super) struct Meeting<'a> {
    pub(super) pair: &'a NearPair,
    pub(super) a: &'a Body,
    pub(super) other: Other<'a>,
    /// Of all bodies.
    constants: &'a [Constants],
}

/// The second of a pair.
#[derive(Clone, Copy)]
pub(super) enum Other<'a> {
    /// A body, and where its image is that is near.
    Body(&'a Body, Point),
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
        let other = match self.bodies.get(pair.b as usize) {
            Some(body) => Other::Body(body, body.pose.position + shift(&self.periods, pair.image)),
            None => Other::Wall(&self.walls[wall_of(pair.b)]),
        };
        Meeting { pair, a: &self.bodies[pair.a as usize], other, constants: self.constants }
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
        if meeting.is_round() {
            meeting.lens().iter().for_each(|lens| found(std::slice::from_ref(lens)));
        } else if let patches @ [_, ..] = meeting.solve(solver)? {
            found(patches);
        }
        Ok(())
    }
}

impl<'a> Meeting<'a> {
    #[inline]
    pub(super) fn constants(&self) -> &'a Constants {
        &self.constants[self.pair.a as usize]
    }

    /// Those of the other one, which is a body.
    #[inline]
    pub(super) fn others(&self) -> &'a Constants {
        &self.constants[self.pair.b as usize]
    }

    /// 1/m of both \[1/kg\], the second one's given. Two that may turn but not move are to one another what they would be if they could.
    #[inline(always)]
    pub(super) fn inverse_masses(&self, of_other: f64) -> [f64; 2] {
        if self.a.inverse_mass + of_other > 0.0 {
            [self.a.inverse_mass, of_other]
        } else {
            self.inverse_masses_of_pinned()
        }
    }

    #[cold]
    fn inverse_masses_of_pinned(&self) -> [f64; 2] {
        let of = |c: &Constants| 1.0 / c.inertia.mass;
        match self.other {
            Other::Body(..) => [of(self.constants()), of(self.others())],
            Other::Wall(_) => [of(self.constants()), 0.0],
        }
    }

    /// Are the spheres around both apart?
    #[inline(always)]
    pub(super) fn is_apart(&self) -> bool {
        let place = self.a.pose.position;
        match &self.other {
            Other::Body(b, at_b) => {
                let within = self.a.radius + b.radius;
                (place - at_b).norm_squared() >= within * within
            }
            Other::Wall(wall) => wall.plane.signed_distance(place) >= self.a.radius,
        }
    }

    /// What a force at `point` and a couple on the first are to both, about their centres.
    #[inline(always)]
    pub(super) fn wrenches(&self, point: Point, force: Vector, couple: Vector) -> [Wrench; 2] {
        let torque = |at: Point| (point - at).cross(&force) + couple;
        let on_a = Wrench { force, torque: torque(self.a.pose.position) };
        let on_b = match &self.other {
            Other::Body(_, at_b) => Wrench { force: -force, torque: -torque(*at_b) },
            Other::Wall(_) => Wrench::default(),
        };
        [on_a, on_b]
    }

    /// Is it two balls, or one and a wall, neither within the other?
    #[inline(always)]
    pub(super) fn is_of_balls(&self) -> bool {
        let (r, place) = (self.a.radius, self.a.pose.position);
        self.a.kind == Kind::Ball
            && match &self.other {
                Other::Body(b, at_b) => {
                    let inside = r - b.radius;
                    b.kind == Kind::Ball && (place - at_b).norm_squared() > inside * inside
                }
                Other::Wall(wall) => wall.plane.signed_distance(place) > -r,
            }
    }

    /// Are both balls or discs, or one and a wall?
    #[inline]
    pub(super) fn is_round(&self) -> bool {
        self.a.kind != Kind::Other
            && match &self.other {
                Other::Body(b, _) => b.kind == self.a.kind,
                Other::Wall(_) => true,
            }
    }

    /// The overlap of two that are round.
    #[inline(always)]
    pub(super) fn lens(&self) -> Option<Overlap> {
        let (place, r) = (self.a.pose.position, self.a.radius);
        match (&self.other, self.a.kind) {
            (Other::Body(b, at_b), Kind::Disc) => closed::discs(r, place, b.radius, *at_b),
            (Other::Body(b, at_b), _) => closed::spheres(r, place, b.radius, *at_b),
            (Other::Wall(w), Kind::Disc) => {
                closed::disc_wall(r, place, w.plane.signed_distance(place), w.plane.normal())
            }
            (Other::Wall(w), _) => {
                closed::sphere_wall(r, place, w.plane.signed_distance(place), w.plane.normal())
            }
        }
    }

    /// Is one of both on its way through the other: no longer pushed back, or the other way than `before`?
    #[inline(always)]
    pub(super) fn is_through<M>(&self, overlap: &Overlap, before: Option<&Patch<M>>) -> bool {
        // Of balls and discs the size is the radius.
        let size =
            |b: &Body, i: u32| if b.kind == Kind::Other { self.constants[i as usize].size } else { b.radius };
        let mut smaller = size(self.a, self.pair.a);
        if let Other::Body(b, _) = &self.other {
            smaller = smaller.min(size(b, self.pair.b));
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
        let (shape, pose) = (&*self.constants().shape, &self.a.pose);
        match &self.other {
            Other::Body(b, at_b) => {
                let other = &*self.constants[self.pair.b as usize].shape;
                solver.solve(shape, pose, other, &Pose { position: *at_b, ..b.pose })
            }
            Other::Wall(wall) => solver.solve(shape, pose, &wall.plane, &Pose::at([0.0; 3])),
        }
    }
}
