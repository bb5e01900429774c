//! Spheres, capsules and cylinders in slices along their axes.
use super::frame::Frame;
use super::slice::{Corner, Place, Slice};
use crate::overlap::tube::{Ends, Tube};

/// A tube in the coordinates of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct SlicedTube {
    pub(super) centre: Place,
    pub(super) axis: Place,
    pub(super) half: f64,
    pub(super) radius: f64,
    pub(super) ends: Ends,
    pub(super) low: f64,
    pub(super) high: f64,
}

impl SlicedTube {
    pub(super) fn new(tube: &Tube, frame: &Frame) -> Self {
        let (centre, axis) = (frame.place(tube.at.position), frame.direction(tube.axis));
        Self {
            centre: centre.xy(),
            axis: axis.xy(),
            half: tube.half,
            radius: tube.radius,
            ends: tube.ends,
            low: centre.z - tube.radius,
            high: centre.z + tube.radius,
        }
    }
    /// Whether its slices have arcs.
    pub(super) fn is_round(&self) -> bool {
        self.ends == Ends::Round
    }
    /// Whether both have a round end that is the same but for rounding.
    pub(super) fn same_end(&self, other: &Self) -> bool {
        let close = 1e-9 * (self.radius + other.radius);
        let near = |x: f64, y: f64| (x - y).abs() <= close;
        let ends = |tube: &Self| [1.0, -1.0].map(|sign| tube.centre + tube.axis * (sign * tube.half));
        self.is_round()
            && other.is_round()
            && near(self.radius, other.radius)
            && near(self.low, other.low)
            && ends(self).iter().any(|x| ends(other).iter().any(|y| (x - y).norm() <= close))
    }
    pub(super) fn lift(&mut self, by: f64) {
        (self.low, self.high) = (self.high + by - 2.0 * self.radius, self.high + by);
    }
    pub(super) fn slice(&self, h: f64, slice: &mut Slice) {
        let r = ((h - self.low) * (self.high - h)).max(0.0).sqrt();
        // Finite where the slice is a line.
        let slope = (h - 0.5 * (self.low + self.high)) / r.max(1e-100 * self.radius);
        slice.corners.clear();
        slice.sides.clear();
        let (c, a) = (self.centre, self.axis * self.half);
        if self.ends == Ends::Round {
            (slice.radius, slice.slope) = (r, slope);
            let still = |x| Corner { x, dx: Place::zeros() };
            if self.half > 0.0 {
                slice.corners.extend([still(c - a), still(c + a)]);
            } else {
                slice.corners.push(still(c));
            }
            return;
        }
        slice.rectangle(c, self.axis, [self.half, r], slope);
    }
}
