//! Particle-resolved direct numerical simulation of flow laden with solids of any shape.
//!
//! A thin facade: each crate can be used alone, and this one re-exports them. The command of this
//! name is behind the feature `cli`, which is on by default: libraries take this crate with
//! `default-features = false` and the features that they need.
//!
//! | module | what it holds | feature |
//! |---|---|---|
//! | [`interfaces`] | the traits and words that the others share | always |
//! | `flow` (crate `fv-mesh`) | grids, operators, pressure solvers, flow | `flow` |
//! | `ibm` | solid fraction, forcing, loads | `bodies` |
//! | `dem` | rigid bodies, overlap, contact | `bodies` |
//! | `coupling` | the time loop, output, ledger, restart | `bodies` |
//! | `mor` | snapshots, POD, POD–Galerkin, shifted POD, interpolation in time and parameters | `mor` |
//! | `turb` | turbulence models and wall functions | `turb` |
#![deny(missing_docs)]

#[cfg(feature = "bodies")]
pub use coupling;
#[cfg(feature = "bodies")]
pub use dem;
#[cfg(feature = "flow")]
pub use fv_mesh as flow;
#[cfg(feature = "bodies")]
pub use ibm;
pub use interfaces;
#[cfg(feature = "mor")]
pub use mor;
#[cfg(feature = "turb")]
pub use turb;

/// The programs of the guide.
#[cfg(doctest)]
#[doc = include_str!("../docs/guide.md")]
struct Guide;
