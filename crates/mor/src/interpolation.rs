//! From samples (xᵢ ∈ ℝᵈ, yᵢ ∈ ℝᵏ), i = 1…m, to a function y(x): the temporal coefficients of modes at any time and parameter.
//!
//! [`Samples`] are checked once; a [`Method`] makes an [`Interpolator`] of them, which predicts, differentiates and is saved
//! ([`Record`]) and [`load`]ed bit for bit.
//!
//! ```
//! use mor::Mat;
//! use mor::interpolation::{Degree, Interpolator, Method, Samples, SplineParams};
//! let times: Vec<f64> = (0..60).map(|i| f64::from(i) / 59.0).collect();
//! let values = Mat::from_fn(2, 60, |row, i| if row == 0 { times[i].sin() } else { times[i].cos() });
//! let spline = SplineParams::new(Degree::Quintic).fit(&Samples::of_one_input(&times, values.as_ref())?)?;
//! let mut y = [0.0; 2];
//! spline.predict(&[0.3], &mut y)?;
//! assert!((y[0] - 0.3_f64.sin()).abs() < 1e-12);
//! # Ok::<(), mor::interpolation::InterpolationError>(())
//! ```
//!
//! Which method? [`best`] cross-validates those that suit the samples ([`candidates`]) and takes the one with the smallest error.
//!
//! ```
//! use mor::Mat;
//! use mor::interpolation::{Samples, best};
//! // Runs at four points of a parameter, ten times each: inputs are the time and the parameter.
//! let points = Mat::from_fn(2, 40, |i, j| if i == 0 { 0.1 * (j % 10) as f64 } else { (j / 10) as f64 });
//! let values = Mat::from_fn(1, 40, |_, j| points[(0, j)].sin() * (1.0 + 0.1 * points[(1, j)]));
//! let best = best(&Samples::new(points.as_ref(), values.as_ref())?)?;
//! println!("{}", best.table);
//! let mut y = [0.0];
//! best.interpolator.predict(&[0.42, 1.5], &mut y)?;
//! assert!((y[0] - 0.42_f64.sin() * 1.15).abs() < 1e-6);
//! # Ok::<(), mor::interpolation::InterpolationError>(())
//! ```
//!
//! Every fit here and of [`models`](crate::models) has a variant with a [`FitObserver`], which gets
//! the stages under way and the loss ([`FitProgress`]) and may stop it.
//!
//! ```
//! use mor::Mat;
//! use mor::interpolation::{NetworkParams, Samples};
//! use std::ops::ControlFlow;
//! let times: Vec<f64> = (0..30).map(f64::from).collect();
//! let values = Mat::from_fn(1, 30, |_, i| (0.3 * times[i]).sin());
//! let samples = Samples::of_one_input(&times, values.as_ref())?;
//! let network = NetworkParams::new(&[8]).network_observed(&samples, &mut |progress| {
//!     let loss = progress.innermost().loss.unwrap_or(f64::INFINITY);
//!     if loss < 1e-4 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
//! })?;
//! assert!(network.report().is_some_and(|report| report.stopped && report.score() < 1e-4));
//! # Ok::<(), mor::interpolation::InterpolationError>(())
//! ```
mod choice;
mod cross_validation;
mod error;
mod folds;
mod harmonics;
mod interpolator;
mod network;
mod product;
mod progress;
mod rbf;
mod record;
mod samples;
mod scaling;
mod spline;
mod varying;
mod waves;

pub use choice::{
    Best, Row, Table, best, best_observed, best_of, best_of_observed, candidates, compare, compare_observed,
};
pub use cross_validation::{CrossValidation, cross_validate, cross_validate_observed};
pub use error::InterpolationError;
pub use folds::Folds;
pub(crate) use folds::thinned;
pub use harmonics::{Harmonics, HarmonicsParams};
pub use interpolator::{Interpolator, Method, load};
pub use network::{Activation, Adam, Epoch, Fourier, Network, NetworkParams, Report, Stop};
pub(crate) use product::Runs;
pub use product::{Product, ProductParams};
pub(crate) use progress::unobserved;
pub use progress::{FitObserver, FitProgress, FitStage};
pub use rbf::{Kernel, Rbf, RbfParams, Shape};
pub use record::{Record, RecordError};
pub use samples::{SampleGrid, Samples};
pub use scaling::Scaling;
pub use spline::{Degree, Spline, SplineParams};
pub use varying::{Varying, VaryingParams};
