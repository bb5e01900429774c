//! Random numbers that are the same on all machines.
use interfaces::{Point, Rotation, Vector};
use nalgebra::{Quaternion, Unit};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// PCG64 (O'Neill 2014), and what is drawn from it by exactly rounded operations and functions of `libm` only.
#[derive(Clone, Debug)]
pub(super) struct Source(Pcg64);

impl Source {
    pub(super) fn new(seed: u64) -> Self {
        Self(Pcg64::seed_from_u64(seed))
    }
    /// From 0 to below 1.
    pub(super) fn unit(&mut self) -> f64 {
        self.0.random()
    }
    /// From −1 to below 1.
    fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }
    /// Uniform in the unit disc, its centre left out; and the squared distance from it.
    fn in_disc(&mut self) -> (f64, f64, f64) {
        loop {
            let (x, y) = (self.signed(), self.signed());
            let s = x * x + y * y;
            if s > 0.0 && s < 1.0 {
                return (x, y, s);
            }
        }
    }
    /// Normal with mean 0 and deviation 1 (polar method, Marsaglia & Bray 1964).
    pub(super) fn normal(&mut self) -> f64 {
        let (x, _, s) = self.in_disc();
        x * (-2.0 * libm::log(s) / s).sqrt()
    }
    /// Uniform in the unit ball, or in the unit disc in the plane z = 0.
    pub(super) fn in_ball(&mut self, plane: bool) -> Vector {
        if plane {
            let (x, y, _) = self.in_disc();
            return Vector::new(x, y, 0.0);
        }
        loop {
            let v = Vector::new(self.signed(), self.signed(), self.signed());
            if v.norm_squared() < 1.0 {
                return v;
            }
        }
    }
    /// Uniform in a box.
    pub(super) fn in_box(&mut self, low: Point, extent: Vector) -> Point {
        let u = Vector::new(self.unit(), self.unit(), if extent.z == 0.0 { 0.0 } else { self.unit() });
        low + u.component_mul(&extent)
    }
    /// Uniform over all rotations (Marsaglia 1972, Ann. Math. Stat. 43, 645), or over those about z.
    pub(super) fn rotation(&mut self, plane: bool) -> Rotation {
        let (x, y, s) = self.in_disc();
        if plane {
            // The half angle is uniform over the circle, so the angle is, too.
            let r = s.sqrt();
            return Unit::new_normalize(Quaternion::new(x / r, 0.0, 0.0, y / r));
        }
        let (z, w, t) = self.in_disc();
        let f = ((1.0 - s) / t).sqrt();
        Unit::new_normalize(Quaternion::new(x, y, z * f, w * f))
    }
}
