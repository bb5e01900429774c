//! The hierarchy in single or double precision.
use super::fields::{Advance, Sweeps};
use super::hierarchy::Hierarchy;
use super::stencil::Stencil;

/// Ratio of the longest axis to the narrowest cell from which on single precision cannot tell the values of
/// neighbouring cells apart well enough.
const SINGLE: f64 = 3e4;

/// The hierarchy. Its finest right-hand side and φ are met through the methods below.
pub(super) enum Precision {
    Single(Hierarchy<f32>),
    Double(Hierarchy<f64>),
}

/// `$body` with `$h` the hierarchy.
macro_rules! with {
    ($precision:expr, $h:ident => $body:expr) => {
        match $precision {
            Precision::Single($h) => $body,
            Precision::Double($h) => $body,
        }
    };
}

impl Precision {
    /// Does a box of this length over its narrowest cell allow for single precision?
    pub(super) fn single(length: f64) -> bool {
        length <= SINGLE
    }

    pub(super) fn cycle(&mut self) {
        with!(self, h => h.cycle());
    }

    /// Cells of the levels.
    pub(super) fn cells(&self) -> Vec<[usize; 3]> {
        with!(self, h => h.levels.iter().map(|l| l.stencil.cells).collect())
    }

    /// [`Sweeps::centre`] into the right-hand side.
    pub(super) fn centre(&mut self, sweeps: &mut Sweeps, mean: f64, scale: f64, r: &mut [f64]) -> f64 {
        with!(self, h => sweeps.centre(mean, scale, r, &mut h.levels[0].f))
    }

    /// [`Sweeps::products`] with φ.
    pub(super) fn products(&self, sweeps: &mut Sweeps, r: &mut [f64], q: &[f64]) -> [f64; 2] {
        with!(self, h => sweeps.products(&h.levels[0].phi, r, q))
    }

    /// [`Sweeps::direct`] with φ.
    pub(super) fn direct(&self, sweeps: &mut Sweeps, s: &Stencil<f64>, scale: f64, beta: f64, p: &mut [f64]) {
        with!(self, h => sweeps.direct(s, scale, &h.levels[0].phi, beta, p));
    }

    /// [`Sweeps::advance`] with the right-hand side.
    pub(super) fn advance(
        &mut self,
        sweeps: &mut Sweeps,
        step: Advance<'_>,
        r: &mut [f64],
        phi: &mut [f64],
    ) -> f64 {
        with!(self, h => sweeps.advance(step, r, &mut h.levels[0].f, phi))
    }
}
