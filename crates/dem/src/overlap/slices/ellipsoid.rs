//! An ellipsoid and a tube, in slices across the tube's axis.
use super::ellipse::Pair;
use super::frame::Frame;
use super::slice::Place;
use super::{heights, sweep};
use crate::overlap::Overlap;
use crate::overlap::tube::{Ends, Tube};
use crate::{Ellipsoid, Shape};
use interfaces::{Pose, Vector};
use nalgebra::{Matrix2, Matrix3, SymmetricEigen};

/// A tube along z and an ellipsoid, whose sections across z are ellipses of one shape and
/// orientation, with their axes along x and y.
struct TubeAndEllipsoid {
    radius: f64,
    half: f64,
    ends: Ends,
    centre: Vector,
    /// Shift of the sections' centres per height.
    shift: Place,
    /// Semi-axes of the section through the centre.
    semi_axes: Place,
    /// Half the extent along z.
    reach: f64,
}

/// Overlap of the tube, the first body, and an ellipsoid; `normal` is used if the gradient is zero.
pub(super) fn overlap(
    tube: &Tube,
    b: &Ellipsoid,
    at_b: &Pose,
    normal: Vector,
    tolerance: f64,
) -> Option<Overlap> {
    let (pair, frame) = TubeAndEllipsoid::new(tube, b, at_b);
    let top = tube.top();
    let own = [pair.centre.z - pair.reach, pair.centre.z + pair.reach];
    let range = [own[0].max(-top), own[1].min(top)];
    if range[0] >= range[1] {
        return None;
    }
    let ends = heights::heights(range, 1e-4 * tolerance.sqrt(), |h| pair.at(h).gap())?;
    // The tube's curvature jumps where its straight part ends.
    let inner = [-pair.half, pair.half].map(|h| (h, false));
    let (mut places, mut n) = ([(ends[0], true); 4], 1);
    for place in inner.into_iter().filter(|p| p.0 > ends[0] && p.0 < ends[1]) {
        places[n] = place;
        n += 1;
    }
    places[n] = (ends[1], true);
    let (mut sums, of) = sweep::sweep(&places[..=n], true, tolerance, |h| pair.at(h).section());
    // Flat ends within the ellipsoid.
    if pair.ends == Ends::Flat {
        for (end, sign) in [(ends[0], -1.0), (ends[1], 1.0)] {
            if end == sign * pair.half {
                let section = pair.at(end).section();
                sums.area.z += sign * section.area;
                sums.moment += Vector::new(section.first.y, -section.first.x, 0.0) * sign;
            }
        }
    }
    match of {
        [false, true] if ends == own => Some(Overlap::whole(b.inertia(1.0).volume, at_b.position, normal)),
        [true, false] if ends == [-top, top] => Some(Overlap::whole(tube.volume(), tube.at.position, normal)),
        _ => frame.overlap(&sums, 0.0, normal),
    }
}

impl TubeAndEllipsoid {
    fn new(tube: &Tube, b: &Ellipsoid, at_b: &Pose) -> (Self, Frame) {
        let frame = Frame::new(tube.at.position, tube.at.orientation * Vector::x(), tube.axis);
        let turn = |frame: &Frame| {
            let columns = [0, 1, 2].map(|a| frame.direction(at_b.orientation * Vector::ith(a, 1.0)));
            Matrix3::from_columns(&columns)
        };
        let inverse = Matrix3::from_diagonal(&b.semi_axes().map(|s| 1.0 / (s * s)));
        let form = turn(&frame) * inverse * turn(&frame).transpose();
        let eigen = SymmetricEigen::new(Matrix2::from(form.fixed_view::<2, 2>(0, 0)));
        let along = frame.world(Vector::new(eigen.eigenvectors[(0, 0)], eigen.eigenvectors[(1, 0)], 0.0));
        let frame = Frame::new(tube.at.position, along, tube.axis);
        let turned = turn(&frame);
        let form = turned * inverse * turned.transpose();
        let square = turned * Matrix3::from_diagonal(&b.semi_axes().map(|s| s * s)) * turned.transpose();
        let flat = Place::new(form[(0, 0)], form[(1, 1)]);
        let pair = Self {
            radius: tube.radius,
            half: tube.half,
            ends: tube.ends,
            centre: frame.place(at_b.position),
            shift: Place::new(square[(0, 2)], square[(1, 2)]) / square[(2, 2)],
            semi_axes: flat.map(|x| x.sqrt().recip()),
            reach: square[(2, 2)].sqrt(),
        };
        (pair, frame)
    }
    /// Both sections at a height.
    fn at(&self, h: f64) -> Pair {
        let beyond = if self.ends == Ends::Round { (h.abs() - self.half).max(0.0) } else { 0.0 };
        let tiny = 1e-100 * self.radius;
        let radius = ((self.radius - beyond) * (self.radius + beyond)).max(0.0).sqrt().max(tiny);
        let z = h - self.centre.z;
        let share =
            ((self.reach - z) * (self.reach + z)).max(0.0).sqrt().max(1e-100 * self.reach) / self.reach;
        Pair {
            radius,
            slope: beyond.copysign(h) / radius,
            centre: self.centre.xy() + self.shift * z,
            shift: self.shift,
            semi_axes: self.semi_axes * share,
            growth: -z / (self.reach * self.reach * share * share),
        }
    }
}
