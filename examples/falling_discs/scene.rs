//! The scene as data, and its parts put together; tests and benches use it too.
use dem::{DemError, Disc, HalfSpace, Material, RigidBodies};
use fv_mesh::{CartesianGrid, Fluid, Projection, Side};
use ibm::Forcing;
use interfaces::{Freedom, Periods, Pose, Twist, Vector};
use siltflow::coupling::{CouplingError, Particles, Simulation, WeightBalance};
use siltflow::{dem, flow as fv_mesh, ibm, interfaces};
use std::sync::Arc;

/// Box \[m\]: 10 × 20 of the paper's diameters.
pub(crate) const BOX: [f64; 2] = [10e-3, 20e-3];
/// The fluid: water.
pub(crate) const FLUID: Fluid = Fluid { density: 1000.0, viscosity: 1e-6 };
/// Gravity \[m/s²\].
pub(crate) const GRAVITY: f64 = 9.81;
