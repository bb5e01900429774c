//! What the other crates use of `faer` and `rustfft`, for `f64`. Both libraries are generic: the crate that calls them compiles
//! them, which takes minutes, and so do its tests. Here they are compiled once.
//!
//! All of it runs on the calling thread alone, so that results do not depend on the number of threads.
#![doc(html_root_url = "https://docs.rs/siltflow-monomorphic/latest")]
#![forbid(unsafe_code)]

mod decompositions;
mod dense;
mod least_squares;
mod solve;
mod sparse;

pub use decompositions::{TriangularFactor, add_gram, self_adjoint_eigen, thin_svd};
pub use dense::{add_product, inverse, self_adjoint_eigenvectors};
pub use faer;
pub use faer::{ColRef, Mat, MatMut, MatRef};
pub use least_squares::LeastSquares;
pub use rustfft;
pub use solve::{DenseLu, Qr, solve_positive};
pub use sparse::{Cholesky, FactorError, Lu, Pattern};

/// The program of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

use rustfft::{Fft, FftPlanner};
use std::sync::Arc;

/// The Fourier transforms of length `n`, forward and inverse, not normalised.
#[must_use]
pub fn fourier_transforms(n: usize) -> [Arc<dyn Fft<f64>>; 2] {
    let mut planner = FftPlanner::new();
    [planner.plan_fft_forward(n), planner.plan_fft_inverse(n)]
}
