//! Finite volumes on Cartesian grids, in two and three dimensions: [`CartesianGrid`] and fields
//! with ghost layers, staggered [`Velocity`], direct [`poisson`] solvers and the incompressible
//! flow algorithm [`Projection`]. It needs no particles and knows of none.
//!
//! ```
//! use fv_mesh::{CartesianGrid, Fluid, Projection, Side};
//! use std::f64::consts::TAU;
//!
//! // Taylor–Green vortices decay by e^(−2νt).
//! let grid = CartesianGrid::new([32, 32], [TAU, TAU])?;
//! let fluid = Fluid { density: 1.0, viscosity: 0.1 };
//! let mut flow = Projection::new(grid, Side::Periodic.everywhere(), fluid)?;
//! flow.set_velocity(|x| [-x[0].cos() * x[1].sin(), x[0].sin() * x[1].cos()]);
//! while flow.time() < 0.5 {
//!     flow.advance(0.02, [0.0, 0.0])?;
//! }
//! let decay = flow.statistics().kinetic_energy / (TAU * TAU / 4.0);
//! assert!((decay - (-4.0 * 0.1 * flow.time()).exp()).abs() < 2e-3);
//! # Ok::<(), fv_mesh::FlowError>(())
//! ```
#![doc(html_root_url = "https://docs.rs/siltflow-fv-mesh/latest")]
#![deny(missing_docs)]

mod across_stream;
pub mod algebra;
mod axis;
mod between;
mod boundary;
mod cell_gradients;
mod convection;
mod cut;
mod diffusion;
mod eddy_stress;
mod error;
mod field;
mod flow_state;
mod fluid;
mod grid;
mod hooked;
mod hooks;
mod implicit;
mod kernels;
mod least_squares;
pub mod linear;
mod mesh_geometry;
mod metrics;
mod modelled;
mod momentum_matrix;
mod neighbours;
pub mod operators;
mod output;
mod parts;
mod per_dimension;
mod piso;
pub mod poisson;
mod pressure;
mod projection;
mod sample;
mod scalar;
mod side_power;
mod simple;
mod spans;
mod statistics;
#[cfg(test)]
mod tests;
mod transport;
mod velocity;
mod walls;
mod window;

pub use algebra::GridMismatch;
pub use axis::{Axis, Cluster};
pub use boundary::{Patch, Profile, Side, Sides, VelocityFunction};
pub use convection::Convection;
pub use cut::InverseOutlook;
pub use diffusion::Diffusion;
pub use eddy_stress::EddyStress;
pub use error::FlowError;
pub use field::Field;
pub use fluid::Fluid;
pub use grid::CartesianGrid;
pub use hooked::Hooked;
pub use hooks::{BodyForce, Boussinesq, ForceField, Hooks, ImmersedForcing};
pub use interfaces::{
    Aabb, Bodies, BodyId, Cell, Checkpoint, Closure, CutCells, CutComponent, CutFace, CutNode, CutWalls,
    Equation, Freedom, Inertia, Kinematics, Lattice, LawOfTheWall, Link, LogSlope, MeshGeometry, Nodes,
    OpenFace, Point, Polyhedron, Pose, Renumbering, RestartError, Rotation, Solid, SolidPoint, SolveError,
    SolveInfo, SurfaceElement, ThinPart, Transport, Twist, Vector, VelocityField, WallPiece, WallPoint,
    WallRow, Wrench,
};
pub use modelled::{ClosureSlot, Modelled};
pub use nalgebra;
pub use output::{CellWriter, OutputError, Precision, TimeSeries};
pub use piso::{Piso, PisoParams, TimeScheme};
pub use pressure::PressureSolver;
pub use projection::{Prediction, Projection, SourceWork};
pub use sample::{Extreme, Integrals, Line, Norms, Plane, Probes, Quantity, SampleError, Sampler};
pub use scalar::{Given, Scalar, ScalarBoundaries, ScalarPatch, ScalarSide, ScalarTransport, Settling};
pub use side_power::SidePower;
pub use simple::{Simple, SimpleInfo, SimpleParams, WallStress};
pub use sprs;
pub use statistics::FlowStatistics;
pub use transport::{CellTransport, FlowTransport, TransportMethod, TransportParams};
pub use velocity::Velocity;

/// The program of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
