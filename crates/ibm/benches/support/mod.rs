//! What all benches need: equal bodies, balls.
use interfaces::{
    Aabb, Bodies, BodyId, Freedom, Inertia, Kinematics, Point, Pose, Solid, SurfaceElement, Twist, Vector,
};
use std::f64::consts::PI;

/// Equal bodies.
pub(crate) struct Equal {
    pub(crate) solid: Box<dyn Solid>,
    pub(crate) poses: Vec<Pose>,
}

impl Kinematics for Equal {
    fn n_bodies(&self) -> usize {
        self.poses.len()
    }
    fn pose(&self, b: BodyId) -> Pose {
        self.poses[b.0]
    }
    fn twist(&self, _: BodyId) -> Twist {
        Twist::default()
    }
}

impl Bodies for Equal {
    fn solid(&self, _: BodyId) -> &dyn Solid {
        &*self.solid
    }
    fn inertia(&self, _: BodyId) -> Inertia {
        Inertia { mass: 1.0, volume: 1.0, tensor: nalgebra::Matrix3::identity() }
    }
    fn freedom(&self, _: BodyId) -> Freedom {
        Freedom::NONE
    }
}

/// A disc or sphere.
pub(crate) struct Ball {
    pub(crate) radius: f64,
    pub(crate) dim: usize,
}

impl Solid for Ball {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        x.coords.norm() - self.radius
    }
    fn normal(&self, x: Point, _: f64) -> Vector {
        x.coords.try_normalize(0.0).unwrap_or_default()
    }
    fn aabb(&self) -> Aabb {
        let flat = if self.dim == 2 { 0.0 } else { 1.0 };
        Aabb::around(Point::origin(), Vector::new(1.0, 1.0, flat) * self.radius)
    }
    /// Equal areas on a Fibonacci spiral.
    fn surface(&self, spacing: f64, offset: f64) -> Option<Vec<SurfaceElement>> {
        if self.dim == 2 {
            return None;
        }
        let r = self.radius + offset;
        let all = 4.0 * PI * r * r;
        let n = (all / (spacing * spacing)).ceil();
        let element = |i: u32| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / n;
            let (sin, cos) = (2.399_963_229_728_653 * f64::from(i)).sin_cos();
            let around = (1.0 - z * z).sqrt();
            let normal = Vector::new(around * cos, around * sin, z);
            SurfaceElement { point: Point::from(r * normal), normal, area: all / n }
        };
        Some((0..n as u32).map(element).collect())
    }
}
