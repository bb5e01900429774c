//! POD–Galerkin: reduced models from projecting the full one, equation (8) of Isoz et al. (2023).
//!
//! A full model is an [`Ode`], y′ = R(y). Where R is a polynomial of second degree, as convection and diffusion are, its projection is a [`QuadraticModel`], found by asking R at
//! combinations of modes: no matrices are needed, so that a flow solver's own discrete operators do. Other terms are sampled in a few rows ([`Deim`], [`HyperReduced`]).
//! [`DormandPrince`] integrates, [`Residual`] bounds the error.
//!
//! ```
//! use mor::galerkin::{Basis, DormandPrince, Ode, QuadraticModel};
//! use mor::Mat;
//! /// u′ = −u², v′ = u − v.
//! struct Full;
//! impl Ode for Full {
//!     fn n(&self) -> usize { 2 }
//!     fn rate(&self, _: f64, y: &[f64], out: &mut [f64]) {
//!         out.copy_from_slice(&[-y[0] * y[0], y[0] - y[1]]);
//!     }
//! }
//! let modes = Mat::from_fn(2, 2, |i, j| f64::from(u8::from(i == j)));
//! let model = QuadraticModel::project(&Basis::new(modes.as_ref(), None, None)?, &Full, 1.0)?;
//! let found = DormandPrince::default().solve(&model, &[1.0, 0.0], &[0.0, 1.0])?;
//! assert!((found[(0, 1)] - 0.5).abs() < 1e-8);
//! # Ok::<(), mor::galerkin::GalerkinError>(())
//! ```
mod basis;
mod deim;
mod error;
mod ode;
mod quadratic;
#[cfg(test)]
mod tests;

pub use basis::Basis;
pub use deim::{Deim, HyperReduced, SampledTerm};
pub use error::GalerkinError;
pub use ode::{DormandPrince, Ode, OdeError};
pub use quadratic::{QuadraticModel, Residual};
