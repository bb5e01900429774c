//! Where two convex bodies that are apart come closest, from their farthest points along directions.
//!
//! Gilbert, Johnson and Keerthi, IEEE J. Robot. Autom. 4 (1988) 193: of all differences x − y of a point of either body the one nearest
//! to the origin, v. The difference w that is least along v bounds the gap from below, v·w/|v| ≤ gap ≤ |v|; the point nearest to the origin of the
//! tetrahedron of w and the corners that matter of the last one is the next v.
use crate::shapes::triangle::{Part, Triangle};
use crate::{Form, Shape};
use interfaces::{Point, Pose, Vector};
use nalgebra::Matrix3;

/// Bounds of the gap this close are enough; slopes are right to the root of it.
const ENOUGH: f64 = 1e-7;
/// A gap less than this share of what the corners are apart is none.
const TOUCHING: f64 = 1e-12;
/// More rounds are never needed, but for rounding.
const ROUNDS: usize = 100;

/// A convex body where it is.
pub(super) struct Convex<'a> {
    form: Form<'a>,
    turn: Matrix3<f64>,
    at: Vector,
}

/// A point of each body and their difference.
#[derive(Clone, Copy)]
struct Corner {
    of: [Vector; 2],
    apart: Vector,
}

/// Both places, that on the first body before.
pub(super) type Places = [Vector; 2];

impl<'a> Convex<'a> {
    /// `None` unless it is convex and has a point farthest along every direction.
    pub(super) fn new(shape: &'a dyn Shape, pose: &Pose, origin: Vector) -> Option<Self> {
        let form = shape.form();
        let bounded = matches!(
            form,
            Form::Hull(_)
                | Form::Sphere(_)
                | Form::Ellipsoid(_)
                | Form::Cylinder(_)
                | Form::Capsule(_)
                | Form::Smooth(_)
        );
        let turn = pose.orientation.to_rotation_matrix().into_inner();
        bounded.then(|| Self { form, turn, at: pose.position.coords - origin })
    }
    /// A point farthest along `direction`.
    pub(super) fn support(&self, direction: Vector) -> Vector {
        let along = self.turn.tr_mul(&direction);
        let of_smooth = |s: &dyn crate::SmoothConvex| s.support(along);
        let place = match self.form {
            Form::Hull(hull) => farthest(hull.vertices(), along),
            Form::Sphere(s) => of_smooth(s),
            Form::Ellipsoid(s) => of_smooth(s),
            Form::Cylinder(s) => of_smooth(s),
            Form::Capsule(s) => of_smooth(s),
            Form::Smooth(s) => of_smooth(s),
            _ => Point::origin(),
        };
        self.at + self.turn * place.coords
    }
}

fn farthest(points: &[Point], along: Vector) -> Point {
    let first = (f64::NEG_INFINITY, Point::origin());
    let farther = |best: (f64, Point), p: &Point| {
        let reached = p.coords.dot(&along);
        if reached > best.0 { (reached, *p) } else { best }
    };
    points.iter().fold(first, farther).1
}

/// Up to four corners and the point of theirs that is nearest to the origin, as the sum of corners times weights.
#[derive(Clone, Copy)]
struct Simplex {
    corners: [Corner; 4],
    weights: [f64; 4],
    n: usize,
}

impl Simplex {
    fn new<const N: usize>(corners: [Corner; N], weights: [f64; N]) -> Self {
        let mut simplex = Self { corners: [corners[0]; 4], weights: [0.0; 4], n: N };
        simplex.corners[..N].copy_from_slice(&corners);
        simplex.weights[..N].copy_from_slice(&weights);
        simplex
    }
    fn corners(&self) -> &[Corner] {
        &self.corners[..self.n]
    }
    fn sum(&self, of: impl Fn(&Corner) -> Vector) -> Vector {
        self.corners().iter().zip(self.weights).map(|(c, w)| w * of(c)).sum()
    }
    fn size(&self) -> f64 {
        self.corners().iter().map(|c| c.apart.norm()).fold(0.0, f64::max)
    }
    fn nearest(&self) -> Vector {
        self.sum(|c| c.apart)
    }
    /// With one more corner, less those that do not matter any more; `None` if the origin is inside.
    fn with(&self, new: Corner) -> Option<Self> {
        match *self.corners() {
            [a] => Some(segment([a, new])),
            [a, b] => Some(triangle([a, b, new])),
            [a, b, c] => tetrahedron([a, b, c, new]),
            _ => None,
        }
    }
}

fn segment([a, b]: [Corner; 2]) -> Simplex {
    let along = b.apart - a.apart;
    let share = -a.apart.dot(&along) / along.norm_squared();
    match share {
        ..=0.0 => Simplex::new([a], [1.0]),
        1.0.. => Simplex::new([b], [1.0]),
        _ => Simplex::new([a, b], [1.0 - share, share]),
    }
}

fn triangle(corners: [Corner; 3]) -> Simplex {
    let [a, b, c] = corners.map(|c| c.apart);
    let triangle = Triangle::new(a, b, c);
    match triangle.nearest(Vector::zeros()).1 {
        Part::Corner(i) => Simplex::new([corners[i]], [1.0]),
        Part::Edge(i) => segment([corners[i], corners[(i + 1) % 3]]),
        Part::Inside => {
            // The foot of the perpendicular by the areas opposite the corners.
            let area = triangle.cross();
            let share = |p: Vector, q: Vector| p.cross(&q).dot(&area) / area.norm_squared();
            Simplex::new(corners, [share(b, c), share(c, a), share(a, b)])
        }
    }
}

/// The nearest of the faces that the origin is in front of.
fn tetrahedron(corners: [Corner; 4]) -> Option<Simplex> {
    let faces = [[0, 1, 2, 3], [0, 1, 3, 2], [0, 2, 3, 1], [1, 2, 3, 0]];
    let in_front = faces.into_iter().filter_map(|face| {
        let [a, b, c, d] = face.map(|i: usize| corners[i].apart);
        let normal = (b - a).cross(&(c - a));
        let same_side = normal.dot(&-a) * normal.dot(&(d - a)) > 0.0;
        (!same_side).then(|| triangle([0, 1, 2].map(|i| corners[face[i]])))
    });
    let square = |s: &Simplex| s.nearest().norm_squared();
    in_front.min_by(|s, t| square(s).total_cmp(&square(t)))
}

/// The places where both are closest; `None` if they overlap or are farther apart than `reach`.
pub(super) fn closest_places(a: &Convex<'_>, b: &Convex<'_>, reach: f64) -> Option<Places> {
    let corner = |v: Vector| {
        let of = [a.support(-v), b.support(v)];
        Corner { of, apart: of[0] - of[1] }
    };
    let mut simplex = Simplex::new([corner(a.at - b.at)], [1.0]);
    for _ in 0..ROUNDS {
        let v = simplex.nearest();
        let square = v.norm_squared();
        if square <= (TOUCHING * simplex.size()).powi(2) {
            return None;
        }
        let next = corner(v);
        let bound = v.dot(&next.apart);
        if bound > reach * square.sqrt() {
            return None;
        }
        if square - bound <= ENOUGH * square {
            break;
        }
        let closer = simplex.with(next)?;
        if closer.nearest().norm_squared() >= square {
            break;
        }
        simplex = closer;
    }
    Some([0, 1].map(|i| simplex.sum(|c| c.of[i])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Capsule, ConvexPolyhedron, Cylinder, Ellipsoid};
    use interfaces::Rotation;
    use proptest::prelude::*;

    fn points(n: usize) -> impl Strategy<Value = Vec<[f64; 3]>> {
        prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), n)
    }
    fn shape() -> impl Strategy<Value = Option<Box<dyn Shape>>> {
        let hull = points(12).prop_map(|p| {
            let hull = ConvexPolyhedron::from_points(&p).ok();
            hull.map(|h| Box::new(h) as Box<dyn Shape>)
        });
        let egg = prop::array::uniform3(0.2..1.0f64)
            .prop_map(|a| Ellipsoid::new(a).ok().map(|e| Box::new(e) as Box<dyn Shape>));
        let rod = (0.1..0.5f64, 0.2..1.0f64)
            .prop_map(|(r, l)| Capsule::new(r, l).ok().map(|c| Box::new(c) as Box<dyn Shape>));
        let drum = (0.2..0.8f64, 0.2..1.0f64)
            .prop_map(|(r, l)| Cylinder::new(r, l).ok().map(|c| Box::new(c) as Box<dyn Shape>));
        prop_oneof![hull, egg, rod, drum]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        /// No two places are closer than those found if a plane across their line parts the bodies at either.
        #[test]
        fn a_plane_at_either_place_parts_them(
            a in shape(), b in shape(), at in prop::array::uniform3(-2.0..2.0f64), by in prop::array::uniform3(-3.0..3.0f64),
        ) {
            let (Some(a), Some(b)) = (a, b) else { return Ok(()) };
            let pose = Pose { position: Point::from(at), orientation: Rotation::from_scaled_axis(Vector::from(by)) };
            let origin = Vector::from(at) * 0.5;
            let first = Convex::new(&*a, &Pose::at([0.0; 3]), origin).unwrap();
            let second = Convex::new(&*b, &pose, origin).unwrap();
            let found = closest_places(&first, &second, f64::INFINITY);
            let near = closest_places(&first, &second, 0.1);
            let Some([x, y]) = found else { prop_assert!(near.is_none()); return Ok(()) };
            let gap = (y - x).norm();
            prop_assert_eq!(near.is_some(), gap <= 0.1);
            let n = (y - x) / gap;
            let between = n.dot(&(second.support(-n) - first.support(n)));
            prop_assert!(gap < 1e-6 || (between / gap - 1.0).abs() < 1e-6, "{} {}", gap, between);
            for (place, shape, pose) in [(x, &a, Pose::at([0.0; 3])), (y, &b, pose)] {
                let off = shape.signed_distance(pose.to_body(Point::from(place + origin)), 1.0);
                prop_assert!(off.abs() <= ENOUGH * gap + 1e-12, "{}", off);
            }
        }
        /// What they share is found by the signed distances.
        #[test]
        fn those_that_overlap_have_no_gap(a in shape(), b in shape(), at in prop::array::uniform3(-0.5..0.5f64)) {
            let (Some(a), Some(b)) = (a, b) else { return Ok(()) };
            let first = Convex::new(&*a, &Pose::at([0.0; 3]), Vector::zeros()).unwrap();
            let second = Convex::new(&*b, &Pose::at(at), Vector::zeros()).unwrap();
            let inside = |s: &dyn Shape, x: Vector| s.signed_distance(Point::from(x), 1.0) < -1e-6;
            let share = (0..=20).map(|i| Vector::from(at) * f64::from(i) / 20.0).any(|x| inside(&*a, x) && inside(&*b, x - Vector::from(at)));
            prop_assert!(!share || closest_places(&first, &second, 1.0).is_none());
        }
    }
}
