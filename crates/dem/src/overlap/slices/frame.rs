//! Which way a pair is sliced.
use crate::Overlap;
use crate::overlap::integrals::Integrals;
use interfaces::{Point, Vector};
use nalgebra::Matrix3;

/// A point near the smaller body, two directions in the slices and their normal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) origin: Point,
    /// Columns x, y, and n.
    turn: Matrix3<f64>,
}

impl Frame {
    /// Slices along `axis` and across the part of `normal` that is.
    pub(super) fn new(origin: Point, axis: Vector, normal: Vector) -> Self {
        let x = axis.normalize();
        // Twice, so that hardly any part along the axis is left.
        let across = |v: Vector| (v - x * x.dot(&v)).try_normalize(0.0);
        let n = across(normal).and_then(across).unwrap_or_else(|| {
            let mut other = Vector::zeros();
            other[x.iamin()] = 1.0;
            x.cross(&other).normalize()
        });
        Self { origin, turn: Matrix3::from_columns(&[x, n.cross(&x), n]) }
    }
    /// Coordinates x, y and height of a direction.
    pub(super) fn direction(&self, v: Vector) -> Vector {
        self.turn.tr_mul(&v)
    }
    /// Coordinates of a place.
    pub(super) fn place(&self, x: Point) -> Vector {
        self.direction(x - self.origin)
    }
    /// Back to the world.
    pub(super) fn world(&self, v: Vector) -> Vector {
        self.turn * v
    }
    /// The overlap whose integrals in this frame are `sums`, heights being counted from `base`; `normal` where the gradient gives
    /// none.
    pub(super) fn overlap(&self, sums: &Integrals, base: f64, normal: Vector) -> Option<Overlap> {
        if sums.volume.is_nan() || sums.volume <= 0.0 {
            return None;
        }
        let centroid = sums.first / sums.volume;
        let moment = sums.moment - centroid.cross(&sums.area);
        let gradient = self.world(sums.area);
        Some(Overlap {
            volume: sums.volume,
            centroid: self.origin + self.world(centroid + Vector::new(0.0, 0.0, base)),
            normal: (-gradient).try_normalize(0.0).unwrap_or(normal),
            gradient,
            moment: self.world(moment),
            pivot: nalgebra::Matrix3::zeros(),
        })
    }
}
