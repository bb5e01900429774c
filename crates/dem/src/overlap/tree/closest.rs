//! Where two bodies that are apart come closest.
use super::around::tangents;
use super::deepest::{Least, Search};
use super::gjk::{Convex, closest_places};
use super::seen::{Seen, shared};
use crate::{Form, Shape};
use interfaces::{Point, Pose, Vector};
use nalgebra::Matrix2;

/// The closest places of two bodies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Closest {
    /// Half-way between them.
    pub(crate) at: Point,
    /// How far they are apart \[m\].
    pub(crate) gap: f64,
    /// From the first to the second, of unit length.
    pub(crate) normal: Vector,
    /// Curvatures of both surfaces in two directions across the normal, as matrices \[1/m\].
    pub(crate) curvatures: [Matrix2<f64>; 2],
}

/// Share of the gap to which it is found.
const ENOUGH: f64 = 1e-3;
/// Places where the gap is larger by no more than this share are closest, too.
const FLAT: f64 = 1e-6;
/// Of the way to the middle.
const HALVINGS: usize = 5;

/// Half-way between both, and what the gap is there.
struct Place {
    at: Vector,
    gap: f64,
    normal: Vector,
}

impl Search<'_> {
    /// Where the larger one of both distances is least.
    fn place(&self) -> Option<Place> {
        let Least { at, distances, .. } = self.least(Vector::zeros(), 0.25 * self.size(), ENOUGH);
        let gap = 2.0 * distances[0].max(distances[1]);
        let slopes = [0, 1].map(|i| self.slope(i, at, distances[i], 1e-3 * gap));
        Some(Place { at, gap, normal: (slopes[0] - slopes[1]).try_normalize(0.0)? })
    }
    /// Of faces along one another many places are the closest: that on the way to the middle of what the boxes share where they end.
    fn towards_the_middle(&self, at: Vector, gap: f64, normal: Vector) -> (Vector, [f64; 2]) {
        let way = normal * normal.dot(&at) - at;
        let closest = |share: f64| {
            let d = self.distances(at + share * way);
            (d[0].max(d[1]) <= 0.5 * (1.0 + FLAT) * gap).then_some((at + share * way, d))
        };
        if let Some(middle) = closest(1.0) {
            return middle;
        }
        let mut ends = [1.0 / 32.0, 1.0];
        let Some(mut best) = closest(ends[0]) else { return (at, self.distances(at)) };
        for _ in 0..HALVINGS {
            let share = 0.5 * (ends[0] + ends[1]);
            match closest(share) {
                Some(found) => (best, ends[0]) = (found, share),
                None => ends[1] = share,
            }
        }
        best
    }
}

/// `None` unless the bodies answer for their farthest points; `Some(None)` if nothing is within reach.
fn between_convex(bodies: [(&dyn Shape, &Pose); 2], centre: Vector, reach: f64) -> Option<Option<Place>> {
    let [a, b] = bodies;
    let first = Convex::new(a.0, a.1, centre)?;
    let places = match b.0.form() {
        Form::HalfSpace(wall) => {
            let wall = wall.posed(b.1);
            let x = first.support(-wall.normal());
            let gap = wall.signed_distance(Point::from(centre + x));
            Some([x, x - gap * wall.normal()]).filter(|_| gap > 0.0)
        }
        _ => closest_places(&first, &Convex::new(b.0, b.1, centre)?, reach),
    };
    Some(places.and_then(|[x, y]| {
        let across = y - x;
        Some(Place { at: 0.5 * (x + y), gap: across.norm(), normal: across.try_normalize(0.0)? })
    }))
}

/// The closest places of two bodies that are no farther apart than `reach`; `None` if they are, or overlap. Of bodies that are not convex one place where
/// the gap is smaller than all around.
///
/// Of convex bodies the place half-way is found by their farthest points ([`gjk`]), of others as where the larger one of both distances is least. Curvatures are differences of the distances over the length √(δ·size)/2
/// along which a film as thick as the gap gets wider.
pub(crate) fn closest(
    a: &dyn Shape,
    pose_a: &Pose,
    b: &dyn Shape,
    pose_b: &Pose,
    reach: f64,
) -> Option<Closest> {
    let near = |shape: &dyn Shape, pose: &Pose| shape.aabb().posed(pose).grown(0.5 * reach);
    let both = shared(&near(a, pose_a), &near(b, pose_b))?;
    let (centre, half) = (nalgebra::center(&both.min, &both.max).coords, 0.5 * both.extent());
    let bodies = [Seen::new(a, pose_a, centre), Seen::new(b, pose_b, centre)];
    let search = Search { bodies, half };
    let Place { at, gap, normal } = match between_convex([(a, pose_a), (b, pose_b)], centre, reach) {
        Some(found) => found?,
        None => search.place()?,
    };
    if !(gap > 0.0 && gap <= reach) {
        return None;
    }
    let (at, distances) = search.towards_the_middle(at, gap, normal);
    let size = a.bounding_radius().min(b.bounding_radius());
    let [u, v] = tangents(normal);
    let step = 0.5 * (gap * size).sqrt();
    let curvatures = [0, 1].map(|i| {
        let places = [u, -u, v, -v, u + v, -u - v].map(|e| at + step * e);
        let d = search.bodies[i].distances(&places, 4.0 * search.size());
        let second = |p: usize| (d[p] + d[p + 1] - 2.0 * distances[i]) / (step * step);
        let (uu, vv) = (second(0), second(2));
        let uv = 0.5 * (second(4) - uu - vv);
        Matrix2::new(uu, uv, uv, vv)
    });
    Some(Closest { at: Point::from(centre + at), gap, normal, curvatures })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cuboid, Ellipsoid, HalfSpace, Sphere};
    use interfaces::Rotation;

    fn off(a: f64, b: f64) -> f64 {
        (a / b - 1.0).abs()
    }

    #[test]
    fn balls_and_a_wall() {
        let (a, b) = (Sphere::new(1.0).unwrap(), Sphere::new(0.5).unwrap());
        for gap in [0.3, 0.03, 0.003] {
            let n = Vector::new(2.0, -1.0, 2.0) / 3.0;
            let at = Pose { position: Point::from((1.5 + gap) * n), ..Pose::at([0.0; 3]) };
            let found = closest(&a, &Pose::at([0.0; 3]), &b, &at, 0.5).unwrap();
            assert!(off(found.gap, gap) < 2e-3 && (found.normal - n).norm() < 1e-2, "{found:?}");
            assert!((found.at - Point::from((1.0 + 0.5 * gap) * n)).norm() < 0.02 * gap.sqrt(), "{found:?}");
            let [ka, kb] = found.curvatures.map(|c| 0.5 * c.trace());
            assert!(
                off(ka, 1.0 / (1.0 + 0.5 * gap)) < 0.1 && off(kb, 1.0 / (0.5 + 0.5 * gap)) < 0.1,
                "{gap}: {ka} {kb}"
            );
            let wall = HalfSpace::new(Point::new(0.0, 0.0, -1.0 - gap), Vector::z()).unwrap();
            let found = closest(&a, &Pose::at([0.0; 3]), &wall, &Pose::at([0.0; 3]), 0.5).unwrap();
            assert!(off(found.gap, gap) < 2e-3 && (found.normal + Vector::z()).norm() < 1e-2, "{found:?}");
            assert!(found.curvatures[1].norm() < 1e-6, "{found:?}");
        }
        let far = Pose::at([2.1, 0.0, 0.0]);
        assert!(closest(&a, &Pose::at([0.0; 3]), &b, &far, 0.5).is_none());
        assert!(closest(&a, &Pose::at([0.0; 3]), &b, &Pose::at([1.4, 0.0, 0.0]), 0.5).is_none());
    }

    #[test]
    fn a_corner_over_a_face_and_two_faces() {
        let cube = Cuboid::new([1.0; 3]).unwrap();
        let tilt = Rotation::from_axis_angle(&Vector::y_axis(), 0.4)
            * Rotation::from_axis_angle(&Vector::x_axis(), 0.3);
        let least = [-0.5, 0.5]
            .into_iter()
            .flat_map(|x| [-0.5, 0.5].map(|y| [x, y]))
            .flat_map(|[x, y]| [-0.5, 0.5].map(|z| (tilt * Vector::new(x, y, z)).z))
            .fold(f64::INFINITY, f64::min);
        let gap = 0.02;
        let over = Pose { position: Point::new(0.05, 0.1, 0.5 + gap - least), orientation: tilt };
        let found = closest(&cube, &Pose::at([0.0; 3]), &cube, &over, 0.1).unwrap();
        assert!(off(found.gap, gap) < 2e-3 && (found.normal - Vector::z()).norm() < 0.02, "{found:?}");
        let found =
            closest(&cube, &Pose::at([0.0; 3]), &cube, &Pose::at([0.0, 0.0, 1.0 + gap]), 0.1).unwrap();
        assert!(off(found.gap, gap) < 2e-3 && found.curvatures[0].norm() < 1e-6, "{found:?}");
    }

    #[test]
    fn an_ellipsoid_has_two_curvatures() {
        let egg = Ellipsoid::new([2.0, 1.0, 0.5]).unwrap();
        let wall = HalfSpace::new(Point::new(0.0, 0.0, -0.51), Vector::z()).unwrap();
        let found = closest(&egg, &Pose::at([0.0; 3]), &wall, &Pose::at([0.0; 3]), 0.1).unwrap();
        let eigen = found.curvatures[0].symmetric_eigenvalues();
        let [low, high] = [eigen.min(), eigen.max()];
        assert!(off(low, 0.125) < 0.1 && off(high, 0.5) < 0.1, "{low} {high}");
    }
}
