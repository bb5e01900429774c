//! The box.
use super::ConvexPolyhedron;
use crate::{DemError, Form, Shape};
use interfaces::{Aabb, Inertia, Point, Polyhedron, Solid, SurfaceElement, Vector};
use nalgebra::Matrix3;

/// A box with its edges along the axes.
#[derive(Clone, Debug)]
pub struct Cuboid {
    half: Vector,
    hull: ConvexPolyhedron,
}

impl Cuboid {
    /// A box with these edge lengths \[m\].
    ///
    /// # Errors
    /// [`DemError::Length`] unless all are positive and finite.
    pub fn new(edges: [f64; 3]) -> Result<Self, DemError> {
        for value in edges {
            if !(value.is_finite() && value > 0.0) {
                return Err(DemError::Length { what: "edge of a box", value });
            }
        }
        let corner =
            |i: usize| [0, 1, 2].map(|a| if i >> a & 1 == 1 { 0.5 * edges[a] } else { -0.5 * edges[a] });
        let vertices: Vec<_> = (0..8).map(corner).collect();
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]]
            .map(Vec::from);
        // Numbers whose products or quotients leave the range make no body.
        let hull = ConvexPolyhedron::new(&vertices, &faces).map_err(|_| DemError::Length {
            what: "smallest edge of a box, against the largest,",
            value: edges.into_iter().fold(f64::INFINITY, f64::min),
        })?;
        Ok(Self { half: Vector::from(edges) * 0.5, hull })
    }
    /// Edge lengths \[m\].
    pub fn edges(&self) -> [f64; 3] {
        (self.half * 2.0).into()
    }
}

impl Shape for Cuboid {
    fn name(&self) -> &'static str {
        "box"
    }
    /// m/12 (b² + c²) and so on.
    fn inertia(&self, density: f64) -> Inertia {
        let volume = 8.0 * self.half.product();
        let mass = density * volume;
        let s = self.half.component_mul(&self.half) * (mass / 3.0);
        let tensor = Matrix3::from_diagonal(&Vector::new(s.y + s.z, s.z + s.x, s.x + s.y));
        Inertia { mass, volume, tensor }
    }
    fn bounding_radius(&self) -> f64 {
        self.half.norm()
    }
    fn form(&self) -> Form<'_> {
        Form::Hull(&self.hull)
    }
}

impl Solid for Cuboid {
    fn signed_distance(&self, x: Point, _band: f64) -> f64 {
        let out = x.coords.abs() - self.half;
        out.sup(&Vector::zeros()).norm() + out.max().min(0.0)
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), self.half)
    }
    fn polyhedron(&self) -> Option<Polyhedron<'_>> {
        self.hull.polyhedron()
    }
    /// Rectangles. The level surface outside has rounded edges, which are left out: `offset` 0 only.
    fn surface(&self, spacing: f64, offset: f64) -> Option<Vec<SurfaceElement>> {
        if offset != 0.0 || spacing.is_nan() || spacing <= 0.0 {
            return None;
        }
        let mut all = Vec::new();
        for axis in 0..3 {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let count = |a: usize| (2.0 * self.half[a] / spacing).round().max(1.0);
            let (nu, nv) = (count(u), count(v));
            let area = 4.0 * self.half[u] * self.half[v] / (nu * nv);
            for side in [-1.0, 1.0] {
                for i in 0..(nu * nv) as usize {
                    let at = |i: f64, n: f64, a: usize| self.half[a] * ((2.0 * i + 1.0) / n - 1.0);
                    let (mut point, mut normal) = (Vector::zeros(), Vector::zeros());
                    (point[axis], normal[axis]) = (side * self.half[axis], side);
                    point[u] = at((i % nu as usize) as f64, nu, u);
                    point[v] = at((i / nu as usize) as f64, nv, v);
                    all.push(SurfaceElement { point: point.into(), normal, area });
                }
            }
        }
        Some(all)
    }
}
