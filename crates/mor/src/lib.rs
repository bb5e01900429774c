//! Model order reduction of snapshots, whatever they were made with.
//!
//! A matrix of snapshots has one row per unknown and one column per snapshot ([`MatRef`], column by column in memory).
//!
//! ```
//! use mor::Mat;
//! use mor::models::Podiann;
//! use mor::pod::{Pod, PodParams};
//! let field = |x: usize, t: f64| (0.1 * x as f64 - t).sin();
//! let times: Vec<f64> = (0..40).map(|k| 0.1 * f64::from(k)).collect();
//! let snapshots = Mat::from_fn(200, 40, |x, k| field(x, times[k]));
//! let pod = Pod::new(snapshots.as_ref(), &PodParams::of_rank(2))?;
//! let points = Mat::from_fn(1, 40, |_, k| times[k]);
//! let model = Podiann::new(points.as_ref(), &pod, None)?;
//! let mut out = vec![0.0; 200];
//! model.predict(&[1.234], &mut out)?;
//! assert!((out[50] - field(50, 1.234)).abs() < 1e-4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![doc(html_root_url = "https://docs.rs/siltflow-mor/latest")]
#![forbid(unsafe_code)]

pub mod galerkin;
pub mod interpolation;
pub mod models;
pub mod pod;
pub mod shifted;
pub mod snapshots;

pub use interfaces::nalgebra;
pub use interfaces::{Point, Pose, Rotation, SnapshotSink, Vector};
pub use monomorphic::{Mat, MatMut, MatRef, faer};

/// The program of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
