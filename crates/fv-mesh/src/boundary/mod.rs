//! What happens at the sides of the box.
mod lines;
mod side;
mod state;

pub(crate) use lines::Lines;
pub use side::{Patch, Profile, Side, Sides};
pub(crate) use state::{Boundaries, FaceKind, PressureFace, extrapolation, face_centre, wrap};
