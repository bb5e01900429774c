//! Integrals over the overlap.
use super::frame::Frame;
use crate::Overlap;
use interfaces::{Point, Vector};
use std::ops::{Add, Mul};

/// Integrals in the coordinates of a [`Frame`], about its origin.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    /// ∫ dV.
    pub(super) volume: f64,
    /// ∫ x dV.
    pub(super) first: Vector,
    /// ∫ n dA over the first body's surface within the second.
    pub(super) area: Vector,
    /// ∫ x × n dA over it \[m³\], along the axes but not stretched.
    pub(super) moment: Vector,
}

impl Sums {
    /// The overlap; `origin` is that of the frame in which the `frame` is given.
    pub(super) fn overlap(&self, frame: &Frame, origin: Point) -> Option<Overlap> {
        if self.volume.is_nan() || self.volume <= 0.0 {
            return None;
        }
        let middle = self.first / self.volume;
        let gradient = frame.area(self.area);
        let units = frame.axes.map(|v| v.normalize());
        let about = units[0] * self.moment[0] + units[1] * self.moment[1] + units[2] * self.moment[2];
        let centroid = frame.point(middle);
        Some(Overlap {
            volume: self.volume * frame.cell(),
            centroid: origin + centroid.coords,
            normal: (-gradient).try_normalize(0.0).unwrap_or(-units[2]),
            gradient,
            moment: about - (centroid.coords - frame.origin).cross(&gradient),
        })
    }
}

impl Add for Sums {
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
impl Mul<f64> for Sums {
    type Output = Self;
    fn mul(self, w: f64) -> Self {
        Self { volume: self.volume * w, first: self.first * w, area: self.area * w, moment: self.moment * w }
    }
}
