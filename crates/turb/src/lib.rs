//! Turbulence models for any flow that is an [`Transport`]: two-equation models ([`KOmega`], [`KEpsilon`],
//! [`RealizableKEpsilon`], [`KOmegaSst`]), sub-grid models ([`Smagorinsky`], [`Wale`]), [`WallFunctions`], and what enters
//! ([`Inflow`]).
//!
//! All are [`Closure`]s. They see the flow through that trait and walls through [`WallRow`]s alone, so they
//! serve walls of the box and immersed ones alike.
//!
//! ```
//! use turb::{Inflow, KOmegaSst, Sst};
//! // Air at 1 m/s with 5 % turbulence of length scale 7 cm.
//! let inflow = Inflow::from_length(1.0, 0.05, 0.07)?;
//! assert!((inflow.omega - 1.59719).abs() < 1e-5);
//! let model = KOmegaSst::new(Sst::default(), 1000, inflow)?;
//! assert_eq!(model.k().len(), 1000);
//! # Ok::<(), turb::TurbulenceError>(())
//! ```
#![doc(html_root_url = "https://docs.rs/siltflow-turb/latest")]
#![deny(missing_docs)]

mod error;
mod inflow;
mod les;
#[cfg(test)]
mod testing;
mod two_equation;
mod wall;

pub use error::TurbulenceError;
pub use inflow::Inflow;
pub use interfaces::nalgebra;
pub use interfaces::{
    Checkpoint, Closure, Equation, LawOfTheWall, LogSlope, RestartError, SolveError, SolveInfo, Transport,
    Vector, WallPoint, WallRow,
};
pub use les::{Smagorinsky, SmagorinskyConstants, Wale, WaleConstants};
pub use two_equation::{
    Controls, Invariants, KEpsilon, KOmega, KOmegaSst, Law, Local, Realizable, RealizableKEpsilon, Scale,
    Sst, StandardKEpsilon, Terms, TwoEquation, Wilcox,
};
pub use wall::{Sublayer, WallFunctions, WallShear, YPlus};

/// The program of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
