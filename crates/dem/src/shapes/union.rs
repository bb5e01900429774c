//! A body made of parts.
use crate::{DemError, Form, OverlapSolver, Shape};
use interfaces::{Aabb, Inertia, Point, Pose, Solid, SurfaceElement, Vector};
use nalgebra::Matrix3;
use std::fmt;
use std::sync::Arc;

/// Rigidly joined parts that may touch but not overlap; the centre of mass is at the origin.
///
/// Its overlaps are those of its parts, one patch for each. (Parts that overlap one another, such as clumps of balls, make an
/// [`Implicit`](crate::Implicit) shape: wrap a `Solid` of your own whose distance is the least of theirs.)
#[derive(Clone)]
pub struct Union {
    parts: Vec<Part>,
    origin: Point,
    bounds: Aabb,
    radius: f64,
}

/// A part and where it is in the whole.
#[derive(Clone)]
pub struct Part {
    /// Its shape.
    pub shape: Arc<dyn Shape>,
    /// Its place and orientation in the frame of the whole.
    pub pose: Pose,
}

/// Parts may overlap by this share of the smaller one's volume: round-off of touching ones.
const TOUCHING: f64 = 1e-9;

impl Union {
    /// The parts at these poses; the whole is moved so that its centre of mass, at equal densities, is at the origin.
    ///
    /// # Errors
    /// [`DemError::NoParts`]; [`DemError::OverlappingParts`]; what the solver says of pairs of parts that it knows no route for.
    pub fn new(parts: Vec<Part>) -> Result<Self, DemError> {
        if parts.is_empty() {
            return Err(DemError::NoParts);
        }
        let mut solver = OverlapSolver::new();
        for (j, b) in parts.iter().enumerate() {
            for (i, a) in parts[..j].iter().enumerate() {
                let shared = solver.solve(&*a.shape, &a.pose, &*b.shape, &b.pose)?;
                let shared: f64 = shared.iter().map(|o| o.volume).sum();
                let least = a.shape.inertia(1.0).volume.min(b.shape.inertia(1.0).volume);
                if shared > TOUCHING * least {
                    return Err(DemError::OverlappingParts { a: i, b: j, volume: shared });
                }
            }
        }
        let volume: f64 = parts.iter().map(|p| p.shape.inertia(1.0).volume).sum();
        let first: Vector = parts.iter().map(|p| p.pose.position.coords * p.shape.inertia(1.0).volume).sum();
        let origin = Point::from(first / volume);
        let mut parts = parts;
        parts.iter_mut().for_each(|p| p.pose.position -= origin.coords);
        let boxes = parts.iter().map(|p| p.shape.aabb().posed(&p.pose));
        let bounds = boxes.reduce(|a, b| Aabb { min: a.min.inf(&b.min), max: a.max.sup(&b.max) });
        let bounds = bounds.unwrap_or(Aabb { min: origin, max: origin });
        let reach = |p: &Part| p.pose.position.coords.norm() + p.shape.bounding_radius();
        let radius = parts.iter().map(reach).fold(0.0, f64::max);
        Ok(Self { parts, origin, bounds, radius })
    }
    /// The parts, from the centre of mass.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }
    /// Where the centre of mass is in the coordinates that the parts were given in \[m\].
    pub fn origin(&self) -> Point {
        self.origin
    }
    /// The part nearest to `x`, its distance, and `x` in its frame.
    fn nearest(&self, x: Point, band: f64) -> (&Part, f64, Point) {
        let of = |p: &'_ Part| {
            let x = p.pose.to_body(x);
            (p.shape.signed_distance(x, band), x)
        };
        let (mut best, (mut distance, mut there)) = (&self.parts[0], of(&self.parts[0]));
        for p in &self.parts[1..] {
            let (d, x) = of(p);
            if d < distance {
                (best, distance, there) = (p, d, x);
            }
        }
        (best, distance, there)
    }
}

impl fmt::Debug for Union {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts: Vec<_> = self.parts.iter().map(|p| (p.shape.name(), p.pose)).collect();
        f.debug_struct("Union").field("parts", &parts).field("origin", &self.origin).finish()
    }
}

impl Shape for Union {
    fn name(&self) -> &'static str {
        "union"
    }
    /// Sums over the parts, each moved from its own centre of mass (Steiner).
    fn inertia(&self, density: f64) -> Inertia {
        let mut sum = Inertia { mass: 0.0, volume: 0.0, tensor: Matrix3::zeros() };
        for p in &self.parts {
            let own = p.shape.inertia(density);
            let (r, x) = (p.pose.orientation.to_rotation_matrix(), p.pose.position.coords);
            let moved = Matrix3::from_diagonal_element(x.norm_squared()) - x * x.transpose();
            sum.mass += own.mass;
            sum.volume += own.volume;
            sum.tensor += r * own.tensor * r.transpose() + own.mass * moved;
        }
        sum
    }
    fn bounding_radius(&self) -> f64 {
        self.radius
    }
    fn form(&self) -> Form<'_> {
        Form::Union(&self.parts)
    }
}

impl Solid for Union {
    /// The least of the parts' distances: exact outside; inside it is short where parts touch.
    fn signed_distance(&self, x: Point, band: f64) -> f64 {
        self.nearest(x, band).1
    }
    fn aabb(&self) -> Aabb {
        self.bounds
    }
    fn normal(&self, x: Point, band: f64) -> Vector {
        let (part, _, there) = self.nearest(x, band);
        part.pose.orientation * part.shape.normal(there, band)
    }
    fn curvature(&self, x: Point, band: f64) -> f64 {
        let (part, _, there) = self.nearest(x, band);
        part.shape.curvature(there, band)
    }
    /// Of the parts, as far as it lies in no other one.
    fn surface(&self, spacing: f64, offset: f64) -> Option<Vec<SurfaceElement>> {
        let mut all = Vec::new();
        for (i, p) in self.parts.iter().enumerate() {
            for e in p.shape.surface(spacing, offset)? {
                let (point, normal) = (p.pose.to_world(e.point), p.pose.orientation * e.normal);
                let covers = |q: &Part| {
                    q.shape.signed_distance(q.pose.to_body(point), spacing + offset.abs()) < offset
                };
                let others = self.parts.iter().enumerate().filter(|(j, _)| *j != i);
                if !others.into_iter().any(|(_, q)| covers(q)) {
                    all.push(SurfaceElement { point, normal, area: e.area });
                }
            }
        }
        Some(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cuboid, Sphere};
    use approx::assert_relative_eq;
    use interfaces::Rotation;

    fn part(shape: impl Shape + 'static, position: [f64; 3]) -> Part {
        Part { shape: Arc::new(shape), pose: Pose::at(position) }
    }

    /// Parts are left out by the spheres and the boxes around them, but none that touches: what is found is what all parts find alone.
    #[test]
    fn no_part_is_left_out_that_touches() {
        let parts: Vec<Part> = (0..6)
            .map(|i| {
                let turn = f64::from(i);
                let orientation = Rotation::from_euler_angles(0.3 * turn, 0.2, turn);
                let position = orientation * Vector::new(1.2, 0.0, 0.0) + Vector::z() * (3.0 * turn);
                let shape: Arc<dyn Shape> = Arc::new(Cuboid::new([0.4, 3.0, 1.0]).unwrap());
                Part { shape, pose: Pose { position: position.into(), orientation } }
            })
            .collect();
        let union = Union::new(parts).unwrap();
        let at = Pose {
            position: Point::new(0.3, -0.2, 0.1),
            orientation: Rotation::from_euler_angles(1.0, 2.0, 0.5),
        };
        let others: [Box<dyn Shape>; 2] =
            [Box::new(Sphere::new(0.7).unwrap()), Box::new(Cuboid::new([0.9, 0.3, 0.5]).unwrap())];
        let (mut solver, mut touched) = (OverlapSolver::new(), 0);
        for k in 0..4000 {
            let spread = |i: i32| f64::from((k * i) % 997) / 997.0 - 0.5;
            let place = union.aabb().extent() + Vector::repeat(1.0);
            let inner = Vector::new(spread(113), spread(271), spread(619)).component_mul(&place);
            let orientation =
                Rotation::from_euler_angles(spread(31) * 6.0, spread(77) * 6.0, spread(5) * 6.0);
            let pose = Pose { position: at.to_world(inner.into()), orientation };
            let other = &*others[k as usize % 2];
            let found: f64 = solver.solve(&union, &at, other, &pose).unwrap().iter().map(|o| o.volume).sum();
            let alone: f64 = union
                .parts()
                .iter()
                .map(|p| {
                    let patches = solver.solve(&*p.shape, &at.of(&p.pose), other, &pose).unwrap();
                    patches.iter().map(|o| o.volume).sum::<f64>()
                })
                .sum();
            assert_eq!(found, alone, "case {k}");
            touched += usize::from(found > 0.0);
        }
        assert!((200..3800).contains(&touched), "{touched}");
    }

    /// Two boxes make a longer one.
    #[test]
    fn a_box_of_two() {
        let whole = Cuboid::new([3.0, 1.0, 1.0]).unwrap();
        let parts = vec![
            part(Cuboid::new([1.0; 3]).unwrap(), [10.0, 0.0, 0.0]),
            part(Cuboid::new([2.0, 1.0, 1.0]).unwrap(), [11.5, 0.0, 0.0]),
        ];
        let union = Union::new(parts).unwrap();
        assert_relative_eq!(union.origin(), Point::new(11.0, 0.0, 0.0), epsilon = 1e-14);
        assert_relative_eq!(union.inertia(2.0).tensor, whole.inertia(2.0).tensor, epsilon = 1e-13);
        assert_eq!(union.aabb(), whole.aabb());
        for x in [Point::new(2.0, 0.3, 0.1), Point::new(-1.4, 0.7, 0.6), Point::new(-1.2, 0.0, 0.1)] {
            assert_relative_eq!(
                union.signed_distance(x, 9.0),
                whole.signed_distance(x, 9.0),
                epsilon = 1e-14
            );
        }
        let ball = Cuboid::new([0.7; 3]).unwrap();
        let at = Pose {
            position: Point::new(-0.6, 0.6, 0.5),
            orientation: interfaces::Rotation::from_scaled_axis(Vector::new(0.3, 0.4, 0.5)),
        };
        let mut solver = OverlapSolver::new();
        let mut volume = |s: &dyn Shape| {
            let o = solver.solve(s, &Pose::at([0.0; 3]), &ball, &at).unwrap();
            (o.len(), o.iter().map(|o| o.volume).sum::<f64>())
        };
        let (one, two) = (volume(&union), volume(&whole));
        assert_eq!((one.0, two.0), (2, 1));
        assert_relative_eq!(one.1, two.1, epsilon = 1e-14);
        // The other way round, too: no tree of boxes.
        let swapped = solver.solve(&ball, &at, &union, &Pose::at([0.0; 3])).unwrap();
        assert_relative_eq!(swapped.iter().map(|o| o.volume).sum::<f64>(), two.1, epsilon = 1e-14);
        let sphere = crate::Sphere::new(0.5).unwrap();
        let unions = solver.solve(&union, &at, &union, &Pose::at([0.0; 3])).unwrap();
        assert!(unions.iter().all(|o| o.volume > 0.0 && o.area().is_finite()));
        let ball_in = solver.solve(&sphere, &Pose::at([0.4, 0.0, 0.0]), &union, &Pose::at([0.0; 3])).unwrap();
        let ball_in: f64 = ball_in.iter().map(|o| o.volume).sum();
        assert_relative_eq!(ball_in, sphere.inertia(1.0).volume, epsilon = 1e-14);
    }

    #[test]
    fn refused() {
        assert!(matches!(Union::new(Vec::new()), Err(DemError::NoParts)));
        let ball = || Sphere::new(1.0).unwrap();
        let error = Union::new(vec![part(ball(), [0.0; 3]), part(ball(), [1.9, 0.0, 0.0])]).unwrap_err();
        assert!(matches!(error, DemError::OverlappingParts { a: 0, b: 1, .. }));
        assert!(Union::new(vec![part(ball(), [0.0; 3]), part(ball(), [2.0, 0.0, 0.0])]).is_ok());
    }
}
