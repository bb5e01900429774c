//! The curve, followed around an axis.
use super::common_point::{CommonPoint, towards};
use super::meridian::{MOST, Quadric};
use super::sums::Sums;
use super::{Overlap, Posed};
use crate::overlap::doubling::Doubling;
use interfaces::Vector;
use std::f64::consts::TAU;

/// Azimuths to begin with.
const FIRST: usize = 4;

/// The curve, followed around an axis.
pub(super) struct Around {
    quadric: Quadric,
    sums: Sums,
}

impl Around {
    pub(super) fn new(a: Posed, b: Posed, common: &CommonPoint, axis: Vector) -> Self {
        let turn = towards(axis);
        let lean = turn.row(2).transpose() * common.lean;
        let quadric = Quadric { lean, form: turn.tr_mul(&(common.quadric * turn)) };
        Self { quadric, sums: Sums::new(a, b, common, &turn) }
    }
    /// The integrals over N azimuths, doubled until the volume has settled; `None` unless the curve crosses each
    /// meridian equally often.
    pub(super) fn integrate(mut self, tolerance: f64) -> Option<Option<Overlap>> {
        let mut taus = [0.0; MOST];
        // Where the curve is far from a great circle, few azimuths may miss what lies between them.
        let enough = if self.quadric.form.norm() < 0.5 * self.quadric.lean.z { 2 * FIRST } else { 8 * FIRST };
        let mut doubling = Doubling::new(tolerance);
        let (mut around, mut crossings) = (FIRST, None);
        loop {
            let stride = MOST / around;
            let (start, step) = if around == FIRST { (0, stride) } else { (stride, 2 * stride) };
            // Where to see the caps from is known after the first ring only.
            let (mut first, mut kept) = ([[Vector::zeros(); 2]; 4 * FIRST], 0);
            for k in (start..MOST).step_by(step) {
                let meridian = self.quadric.meridian(TAU * k as f64 / MOST as f64);
                let guess = if around > FIRST {
                    0.5 * (taus[k - stride] + taus[(k + stride) % MOST])
                } else {
                    meridian.guess()
                };
                let mut count = 0;
                taus[k] = meridian.crossings(guess, &mut |w, dw| {
                    count += 1;
                    if around > FIRST {
                        self.sums.add(w, dw);
                    } else if kept < first.len() {
                        first[kept] = [w, dw];
                        kept += 1;
                    }
                })?;
                if count == 0 || *crossings.get_or_insert(count) != count {
                    return None;
                }
            }
            if around == FIRST {
                self.sums.aim(&first[..kept]);
                first[..kept].iter().for_each(|[w, dw]| self.sums.add(*w, *dw));
            }
            let weight = TAU / around as f64;
            if self.sums.settled(&mut doubling, weight) && (around >= enough || doubling.still()) {
                return Some(self.sums.overlap(weight));
            }
            if around == MOST {
                return None;
            }
            around *= 2;
        }
    }
}
