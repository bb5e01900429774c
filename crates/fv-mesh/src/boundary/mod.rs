//! What happens at the sides of the box.
mod boundaries;
mod ends;
mod extrapolation;
mod face_excess;
mod ghosts;
mod lines;
mod outlet_momentum;
mod outlets;
mod pressure_faces;
mod side;
mod side_state;

pub(crate) use boundaries::Boundaries;
pub(crate) use extrapolation::Extrapolation;
pub(crate) use lines::Lines;
pub(crate) use outlet_momentum::OutletStep;
pub(crate) use pressure_faces::PressureFace;
pub use side::{Patch, Profile, Side, Sides, VelocityFunction};
pub(crate) use side_state::FaceKind;
use side_state::{Law, SideState};
