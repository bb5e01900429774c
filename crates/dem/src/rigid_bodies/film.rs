//! Bodies that are close without touching.
use super::RigidBodies;
use super::body::{Constants, Kind};
use super::contacts::View;
use super::meeting::{Meeting, Other};
use crate::Shape;
use crate::contact::{ContactLaw, FilmForce, Gap, stiffness_of_decay};
use crate::overlap::plane;
use crate::overlap::tree::{self, Closest};
use interfaces::{Point, Pose, Vector, Wrench};
use nalgebra::Matrix2;

/// Surfaces count as no flatter than a sphere of so many radii of the smaller body.
const FLATTEST: f64 = 1.0;

/// What a film does to both bodies, and the stiffness over mass that asks for as short a step \[1/s²\].
pub(super) struct Film {
    pub(super) on_both: [Wrench; 2],
    pub(super) stiffness: f64,
}

/// The closest places of two bodies.
struct Place {
    at: Point,
    gap: f64,
    normal: Vector,
    radius: f64,
    curvatures: [f64; 2],
}

impl<L: ContactLaw> RigidBodies<L> {
    /// How many pairs a [film](crate::Lubricated) kept apart in the last sub-step, those with walls included.
    pub fn n_films(&self) -> usize {
        self.chunks.iter().map(|c| c.films).sum()
    }
}

impl<L: ContactLaw> View<'_, L> {
    /// What the film between two that do not touch does, if there is one.
    pub(super) fn film(&self, meeting: &Meeting<'_>) -> Option<Film> {
        let Place { at, gap, normal, radius, curvatures } = self.place(meeting)?;
        let a = meeting.a;
        let (mut velocity, mut spin) = (a.twist.at(at - a.pose.position), a.twist.angular);
        if let Other::Body(b, at_b) = meeting.other {
            velocity -= b.twist.at(at - at_b);
            spin -= b.twist.angular;
        }
        if let Some(surfaces) = self.surfaces {
            let [first, second] = surfaces.both(meeting, at, normal, self.time);
            velocity += first - second;
            // Velocities along curved surfaces turn with their normals, as by a spin.
            let [k, l] = curvatures;
            spin += normal.cross(&(k * first + l * second));
        }
        let wall = matches!(meeting.other, Other::Wall(_));
        let film = Gap { distance: gap, normal, velocity, spin, radius, curvatures, wall };
        let FilmForce { force, couple, resistance } = self.law.across(&film);
        let inverse_mass = |b: u32, c: &Constants| {
            if c.pinned() { 0.0 } else { 1.0 / (c.mass + self.loads.of(b as usize).added_mass) }
        };
        let mut inverse = inverse_mass(meeting.pair.a, meeting.constants());
        if !wall {
            inverse += inverse_mass(meeting.pair.b, meeting.others());
        }
        let stiffness = stiffness_of_decay(resistance * inverse);
        Some(Film { on_both: meeting.wrenches(at, force, couple), stiffness })
    }

    /// Where the two are closest, if that is within reach.
    fn place(&self, meeting: &Meeting<'_>) -> Option<Place> {
        let (a, reach) = (meeting.a, self.law.reach());
        let at_a = a.pose.position;
        let round = |b: &super::Body| b.kind != Kind::Other;
        let placed = |normal: Vector, gap: f64, k: f64| {
            let at = at_a + normal * (a.radius + 0.5 * gap);
            let own = 1.0 / a.radius;
            (gap > 0.0 && gap <= reach).then(|| Place {
                at,
                gap,
                normal,
                radius: 1.0 / (own + k),
                curvatures: [own, k],
            })
        };
        match meeting.other {
            Other::Body(b, at_b) if round(a) && round(b) => {
                let apart = at_b - at_a;
                let distance = apart.norm();
                placed(apart / distance, distance - a.radius - b.radius, 1.0 / b.radius)
            }
            Other::Wall(wall) if round(a) => {
                placed(-wall.plane.normal(), wall.plane.signed_distance(at_a) - a.radius, 0.0)
            }
            Other::Body(b, at_b) => {
                let within = a.radius + b.radius + reach;
                if (at_b - at_a).norm_squared() > within * within {
                    return None;
                }
                let (first, second) = (meeting.constants(), meeting.others());
                let pose = Pose { position: at_b, ..b.pose };
                let found = closest(&*first.shape, &a.pose, &*second.shape, &pose, reach)?;
                Some(curved(&found, first.size.min(second.size)))
            }
            Other::Wall(wall) => {
                if wall.plane.signed_distance(at_a) > a.radius + reach {
                    return None;
                }
                let first = meeting.constants();
                let found = closest(&*first.shape, &a.pose, &wall.plane, &Pose::at([0.0; 3]), reach)?;
                Some(curved(&found, first.size))
            }
        }
    }
}

/// The closest places of two bodies, if they are within `reach`.
fn closest(a: &dyn Shape, at_a: &Pose, b: &dyn Shape, at_b: &Pose, reach: f64) -> Option<Closest> {
    let form = a.form();
    if form.is_plane() {
        plane::closest(&form, at_a, &b.form(), at_b, reach)
    } else {
        tree::closest(a, at_a, b, at_b, reach)
    }
}

/// Closest places of bodies the smaller of which has this size.
fn curved(found: &Closest, size: f64) -> Place {
    let Closest { at, gap, normal, curvatures: [a, b] } = *found;
    // The level surfaces half-way between are rounder than the bodies' own by half the gap.
    let flattest = 1.0 / (FLATTEST * size);
    let sum: Matrix2<f64> = a + b;
    let [k, l] = {
        let eigen = sum.symmetric_eigenvalues();
        [eigen.x, eigen.y].map(|k| k.max(flattest))
    };
    let mean = [a, b].map(|c| (0.5 * c.trace()).max(0.0));
    // As flat as both may be together.
    let missing = (flattest - mean[0] - mean[1]).max(0.0);
    let radius = (2.0 / ((k + l) * (k * l).sqrt())).sqrt();
    Place { at, gap, normal, radius, curvatures: [mean[0] + missing, mean[1]] }
}
