//! The time loop in which flow and bodies move one another. Thin: the physics is in `fv-mesh`,
//! `ibm` and `dem`; here they are put together.
//!
//! A step reads as the equations do ([`Simulation::step`]): u* is predicted, the bodies move,
//! f_ib makes the fluid follow them, the pressure makes it free of divergence. [`Particles`] holds
//! the strategy that gives the bodies their new velocities with one pressure solution per step;
//! `()` in its place is the plain flow loop; any [`FlowSolver`] may be the flow. [`hfdib_dem`] is the paper's algorithm. [`run`] makes the steps and calls [`Observer`]s;
//! [`Ledger`] keeps the books of momentum and energy; [`SnapshotFeed`] and [`BodyPaths`] feed models made of snapshots; [`save`] and [`load`] keep a run's state.
#![deny(missing_docs)]

mod checkpoint;
mod error;
mod flow_solver;
mod ledger;
mod moving_window;
mod output;
mod particles;
mod preset;
mod run;
mod simulation;
mod snapshots;
mod strategy;

pub use checkpoint::{CheckpointError, load, previous, save};
pub use error::CouplingError;
pub use flow_solver::FlowSolver;
pub use ledger::{Accounted, Ledger, LedgerReport};
pub use moving_window::MovingWindow;
pub use output::FileOutput;
pub use particles::{BodyReport, Particles};
pub use preset::{HfdibDem, hfdib_dem};
pub use run::{Observer, RunSummary, Schedule, StepInfo, run};
pub use simulation::{Immersed, Module, Simulation, Timings, WeightBalance};
pub use snapshots::{BodyPaths, Quantity, SnapshotFeed};
pub use strategy::{Exchange, Explicit, Iterated, OneSolve, Strategy};
