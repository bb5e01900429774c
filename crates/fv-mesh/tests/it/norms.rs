//! Errors of a flow against an exact solution.
use fv_mesh::{Integrals, Norms, Projection};

/// Orders of accuracy from one error to that on a grid `ratio` times finer: in the 2-norm and the maximum norm.
pub(crate) fn order(coarse: Norms, fine: Norms, ratio: f64) -> [f64; 2] {
    [coarse.l2 / fine.l2, coarse.linf / fine.linf].map(|e| e.ln() / ratio.ln())
}

/// Velocity error on the faces inside the box.
pub(crate) fn velocity<const D: usize>(flow: &Projection<D>, exact: impl Fn([f64; D]) -> [f64; D]) -> Norms {
    Integrals::new(flow.grid()).velocity_norms(flow.velocity(), exact).unwrap()
}

/// Pressure error, up to a constant if `floating`.
pub(crate) fn pressure<const D: usize>(
    flow: &Projection<D>,
    floating: bool,
    exact: impl Fn([f64; D]) -> f64 + Sync,
) -> Norms {
    let over = Integrals::new(flow.grid());
    let error = || flow.pressure() - flow.grid().function(&exact);
    let mean = if floating { over.mean(error()).unwrap() } else { 0.0 };
    over.norms(error() - mean).unwrap()
}
