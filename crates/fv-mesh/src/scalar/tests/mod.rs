//! Boundary conditions and transport of scalars against exact solutions and conservation laws.
mod diffusion;
mod steady;
mod transport;

use crate::metrics::Metrics;
use crate::operators::Operators;
use crate::operators::tests::{Family, assert_order, exact_velocity, families, norms};
use crate::{CartesianGrid, Field, Given, ScalarBoundaries, ScalarPatch, ScalarSide};
