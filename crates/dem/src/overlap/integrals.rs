//! What routes that integrate sum up.
use interfaces::Vector;
use std::ops::{Add, Mul};

/// Integrals over a shared region, in the coordinates of a route.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Integrals {
    /// ∫ dV.
    pub(super) volume: f64,
    /// ∫ x dV.
    pub(super) first: Vector,
    /// ∫ n dA over the first body's surface within the second.
    pub(super) area: Vector,
    /// ∫ x × n dA over it.
    pub(super) moment: Vector,
}

impl Integrals {
    /// Of the region's image in the plane across the third axis.
    pub(super) fn mirrored(self) -> Self {
        let image = |v: Vector| Vector::new(v.x, v.y, -v.z);
        Self {
            volume: self.volume,
            first: image(self.first),
            area: image(self.area),
            moment: -image(self.moment),
        }
    }
}

impl Add for Integrals {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self {
            volume: self.volume + o.volume,
            first: self.first + o.first,
            area: self.area + o.area,
            moment: self.moment + o.moment,
        }
    }
}
impl Mul<f64> for Integrals {
    type Output = Self;
    fn mul(self, w: f64) -> Self {
        Self { volume: self.volume * w, first: self.first * w, area: self.area * w, moment: self.moment * w }
    }
}
