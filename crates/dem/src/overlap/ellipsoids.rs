//! Two ellipsoids: integrals along the curve where their surfaces cross.
mod around;
mod cap;
mod common_point;
mod loops;
mod meridian;
mod rulings;
mod sums;
#[cfg(test)]
mod tests;

use super::Overlap;
use around::Around;
use common_point::{Meeting, Nearer, nearer};
use interfaces::{Point, Pose, Vector};
use loops::Loops;
use nalgebra::Matrix3;
use std::f64::consts::TAU;

/// A posed ellipsoid: f(x) = |E⁻¹ Rᵀ(x − c)|² − 1 < 0 inside.
#[derive(Clone, Copy)]
pub(super) struct Posed {
    semi_axes: Vector,
    /// From the body's frame to the world.
    turn: Matrix3<f64>,
    position: Point,
    /// Centre, as seen from the first body's.
    centre: Vector,
}

impl Posed {
    pub(super) fn new(semi_axes: Vector, at: &Pose, origin: Point) -> Self {
        let turn = at.orientation.to_rotation_matrix().into_inner();
        Self { semi_axes, turn, position: at.position, centre: at.position - origin }
    }
    /// To the frame in which the body is the unit ball.
    fn to_ball(self) -> Matrix3<f64> {
        Matrix3::from_diagonal(&self.semi_axes.map(|e| 1.0 / e)) * self.turn.transpose()
    }
    fn ball_to_world(self) -> Matrix3<f64> {
        self.turn * Matrix3::from_diagonal(&self.semi_axes)
    }
    fn whole(&self, direction: Vector) -> Overlap {
        Overlap::whole(2.0 / 3.0 * TAU * self.semi_axes.product(), self.position, direction)
    }
}

/// What the curve says.
pub(super) enum Found {
    /// The overlap, if there is one.
    Overlap(Option<Overlap>),
    /// More than one curve, or one that turns back: this is for another route.
    Tangled,
}

/// The overlap of two ellipsoids to a share of `tolerance` of its volume.
///
/// The point p where max(f_A, f_B) is least (Perram & Wertheim 1985, J. Comput. Phys. 58, 409) minimises some
/// G = λf_A + (1 − λ)f_B as well. So the curve, where both are zero, lies on the ellipsoid G = 0 about p, which is made the
/// unit sphere; on it A is the nearer body where D = f_A − f_B > 0. Volume and first moment are sums over both bodies of
/// what lies between p and the nearer one's surface, each an integral along the curve (`Cap`) that loses no digits in shallow
/// overlaps; S = ½∮x × dx, and the moment is −½∮|x|²dx. Where each meridian about some axis crosses the curve equally often it is
/// followed by azimuths ([`Around`]), else by the lines of a cone on which it lies ([`Loops`]).
pub(super) fn overlap(a: Posed, b: Posed, tolerance: f64) -> Found {
    let common = match common_point::find(&a, &b) {
        Meeting::Apart => return Found::Overlap(None),
        Meeting::Unclear => return Found::Tangled,
        Meeting::At(common) => common,
    };
    // Where D rises on all meridians there is one curve, about the pole.
    if common.quadric.norm() < common.lean
        && let Some(found) = Around::new(a, b, &common, Vector::z()).integrate(tolerance)
    {
        return Found::Overlap(found);
    }
    let upwards = common.axes.column(2).normalize();
    let eigen = common.quadric.symmetric_eigen();
    if let Some(found) = Loops::new(a, b, &common, &eigen).integrate(tolerance) {
        return Found::Overlap(found);
    }
    match nearer(common.lean, &eigen) {
        Nearer::Always(0) => Found::Overlap(Some(a.whole(-upwards))),
        Nearer::Always(_) => Found::Overlap(Some(b.whole(-upwards))),
        Nearer::Either(axes) => {
            for axis in axes {
                if let Some(found) = Around::new(a, b, &common, axis).integrate(tolerance) {
                    return Found::Overlap(found);
                }
            }
            Found::Tangled
        }
    }
}
