//! The time loop in which flow and bodies move one another. Thin: the physics is in `fv-mesh`,
//! `ibm` and `dem`; here they are put together.
//!
//! A step reads as the equations do ([`Simulation::step`]): u* is predicted, the bodies move,
//! f_ib makes the fluid follow them, the pressure makes it free of divergence. [`Particles`] holds
//! the strategy that gives the bodies their new velocities with one pressure solution per step;
//! `()` in its place is the plain flow loop; any [`FlowSolver`] may be the flow. [`hfdib_dem`] is the paper's algorithm. [`run`] makes the steps and calls [`Observer`]s, also of [`Grains`] without a fluid;
//! [`Ledger`] keeps the books of momentum and energy; [`SnapshotFeed`] and [`BodyPaths`] feed models made of snapshots; [`save`] and [`load`] keep a run's state.
//!
//! ```
//! use coupling::dem::{Disc, Material, RigidBodies};
//! use coupling::fv_mesh::{CartesianGrid, Diffusion, Fluid, Projection, Side};
//! use coupling::ibm::SmoothForcing;
//! use coupling::{BodyId, Freedom, Kinematics, Periods, Pose, Twist, Vector};
//! use coupling::{Particles, Simulation, WeightBalance};
//! let water = Fluid { density: 1000.0, viscosity: 1e-6 };
//! let grid = CartesianGrid::new([40, 60], [4e-3, 6e-3])?;
//! let flow = Projection::new(grid, Side::WALL.everywhere(), water)?.with_diffusion(Diffusion::Explicit);
//! let mut bodies = RigidBodies::new(Periods::default());
//! let stone = Material { density: 2500.0, ..Material::default() };
//! bodies.add(Disc::new(5e-4)?, stone, Pose::at([2e-3, 4e-3, 0.0]), Twist::default(), Freedom::PLANAR)?;
//! let gravity = Vector::new(0.0, -9.81, 0.0);
//! let discs = Particles::new(bodies, SmoothForcing::new(water.density), water.density, gravity);
//! let mut fall = Simulation::new(flow, discs, WeightBalance::None)?;
//! for _ in 0..20 {
//!     fall.step(1e-4)?;
//! }
//! assert!(fall.particles.bodies.twist(BodyId(0)).linear.y < 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![doc(html_root_url = "https://docs.rs/siltflow-coupling/latest")]
#![deny(missing_docs)]

mod accounts;
mod checkpoint;
mod error;
mod flow_rate;
mod flow_solver;
mod grains;
mod ledger;
mod moving_window;
mod output;
mod particles;
mod preset;
mod run;
mod serials;
mod simulation;
mod snapshots;
mod state_copy;
mod strategy;
mod walled;
mod with_scalars;

pub use accounts::{Account, Accounts};
pub use checkpoint::{CheckpointError, SavedState, load, previous, save};
pub use dem;
pub use error::{CouplingError, Escape};
pub use flow_rate::FlowRate;
pub use flow_solver::FlowSolver;
pub use fv_mesh;
pub use grains::Grains;
pub use ibm;
pub use interfaces::{
    Aabb, Bodies, BodyId, Checkpoint, Closure, Dynamics, Equation, Freedom, Inertia, Kinematics, Lattice,
    LawOfTheWall, Load, LogSlope, Nodes, Periods, Point, Polyhedron, Pose, Renumbering, RestartError,
    Rotation, SnapshotSink, Solid, SolveError, SolveInfo, SurfaceElement, Transport, Twist, Vector,
    VelocityField, WallPoint, WallRow, Wrench,
};
pub use ledger::{Ledger, LedgerReport};
pub use moving_window::MovingWindow;
pub use nalgebra;
pub use output::FileOutput;
pub use particles::{BodyReport, Particles, check_places};
pub use preset::{HfdibDem, hfdib_dem};
pub use run::{Evolving, Observer, RunSummary, Schedule, StepInfo, run};
pub use simulation::{Immersed, Module, Simulation, Timings, WeightBalance};
pub use snapshots::{BodyPaths, Quantity, SnapshotFeed};
pub use strategy::{Exchange, Explicit, Iterated, OneSolve, Strategy};
pub use walled::Walled;
pub use with_scalars::{Drive, WithScalars};

/// The program of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
