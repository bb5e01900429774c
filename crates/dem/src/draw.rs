//! Numbers for tests.
use interfaces::{Rotation, Vector};

/// Numbers that look random, the same in each run.
pub(crate) struct Draw(pub(crate) u64);

impl Draw {
    /// From 0 to 1.
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
    /// Between two sizes, as likely in every decade.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.next())
    }
    pub(crate) fn direction(&mut self) -> Vector {
        loop {
            let v = Vector::from_fn(|_, _| 2.0 * self.next() - 1.0);
            if v.norm() < 1.0 && v.norm() > 0.1 {
                return v.normalize();
            }
        }
    }
    pub(crate) fn turn(&mut self) -> Rotation {
        Rotation::from_scaled_axis(self.direction() * 3.0 * self.next())
    }
}
