//! The curve, followed along the lines of a cone.
use super::common_point::CommonPoint;
use super::rulings::Cone;
use super::sums::Sums;
use super::{Overlap, Posed};
use crate::overlap::doubling::Doubling;
use interfaces::Vector;
use nalgebra::{SymmetricEigen, U3};
use std::f64::consts::TAU;

/// Places on each piece to begin with, and at most.
const FIRST: usize = 8;
const MOST: usize = 2048;
/// Pieces that are smooth enough, as `Pieces::smooth` says.
const SMOOTH: f64 = 0.2;
/// Below this they nearly touch one another or themselves.
const PINCHED: f64 = 0.05;
/// The first place, in steps of the first ring: in finer ones none is nearer to an end of the lines than a third of their steps.
const OFFSET: f64 = 1.0 / 3.0;

/// All pieces of the curve, each followed for itself: two crossing quadrics are cut by the lines of any cone through
/// their curve in two places, so that these are smooth periodic functions of the line or of an angle that takes it there and back
/// again.
pub(super) struct Loops {
    values: Vector,
    lean: Vector,
    sums: Sums,
}

impl Loops {
    pub(super) fn new(a: Posed, b: Posed, common: &CommonPoint, eigen: &SymmetricEigen<f64, U3>) -> Self {
        let mut turn = eigen.eigenvectors;
        if turn.determinant() < 0.0 {
            turn.neg_mut();
        }
        let lean = turn.row(2).transpose() * common.lean;
        Self { values: eigen.eigenvalues, lean, sums: Sums::new(a, b, common, &turn) }
    }
    /// The integrals by the trapezoidal rule, its places doubled until the volume has settled; `None` where they do not.
    pub(super) fn integrate(mut self, tolerance: f64) -> Option<Option<Overlap>> {
        let cone = |first| {
            let cone = Cone::new(self.values, self.lean, first)?;
            Some((cone, cone.pieces()?))
        };
        // The smoother one, unless the first will do.
        let (cone, pieces) = match cone(0) {
            Some(first) if first.1.smooth > SMOOTH => first,
            Some(first) => cone(1).filter(|second| second.1.smooth > first.1.smooth).unwrap_or(first),
            None => cone(1)?,
        };
        // Pieces that nearly touch one another need more, which few places may not show.
        let enough = if pieces.smooth > PINCHED { 4 * FIRST } else { 8 * FIRST };
        let mut doubling = Doubling::new(tolerance);
        let mut around = FIRST;
        loop {
            let stride = MOST / around;
            let (start, step) = if around == FIRST { (0, stride) } else { (stride, 2 * stride) };
            let (mut first, mut kept) = ([[Vector::zeros(); 2]; 2 * FIRST], 0);
            for piece in pieces.iter() {
                for k in (start..MOST).step_by(step) {
                    let [w, dw] = cone.place(piece, TAU * (k as f64 / MOST as f64 + OFFSET / FIRST as f64));
                    // D > 0 on the left.
                    let across = self.lean + self.values.component_mul(&w);
                    let dw = if w.cross(&dw).dot(&across) < 0.0 { -dw } else { dw };
                    if around > FIRST {
                        self.sums.add(w, dw);
                    } else {
                        first[kept] = [w, dw];
                        kept += 1;
                    }
                }
            }
            if around == FIRST {
                self.sums.aim(&first[..kept]);
                first[..kept].iter().for_each(|[w, dw]| self.sums.add(*w, *dw));
            }
            let weight = TAU / around as f64;
            if self.sums.settled(&mut doubling, weight) && around >= enough {
                return Some(self.sums.overlap(weight));
            }
            if around == MOST {
                return None;
            }
            around *= 2;
        }
    }
}
