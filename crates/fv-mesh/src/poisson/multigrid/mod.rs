//! Geometric multigrid for boxes with stretched axes.
mod axis;
mod cg;
mod coarsest;
mod coefficients;
mod fields;
mod hierarchy;
mod level;
mod params;
mod solver;
mod stencil;
#[cfg(test)]
mod tests;
mod transfer;

pub use cg::MultigridCg;
pub use params::{MultigridAxis, MultigridParams};
pub use solver::Multigrid;
