//! Proper orthogonal decomposition of snapshots, equation (7) of Isoz et al. (2023).
//!
//! ```
//! use mor::Mat;
//! use mor::pod::{Pod, PodParams, Rank};
//! // Two modes that beat at 200 times.
//! let field = |i: usize, j: usize| (0.1 * i as f64).sin() * (0.2 * j as f64).cos() + 0.01 * i as f64 * (0.05 * j as f64).sin();
//! let snapshots = Mat::from_fn(50, 200, field);
//! let pod = Pod::new(snapshots.as_ref(), &PodParams { rank: Rank::Tolerance(1e-10), ..PodParams::default() })?;
//! assert_eq!(pod.rank(), 2);
//! let (mut back, coefficients) = (vec![0.0; 50], pod.project(snapshots.col_as_slice(7))?);
//! pod.reconstruct(&coefficients, &mut back)?;
//! assert!((back[3] - snapshots[(3, 7)]).abs() < 1e-12);
//! # Ok::<(), mor::pod::PodError>(())
//! ```
mod blocks;
mod combination;
mod error;
mod factors;
mod modes;
mod params;
mod streaming;
#[cfg(test)]
mod tests;

pub(crate) use combination::combine;
pub use error::PodError;
pub use modes::Pod;
pub use params::{PodParams, Rank, SvdMethod};
pub use streaming::StreamingPod;
