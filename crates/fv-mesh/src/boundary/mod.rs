//! What happens at the sides of the box.
mod lines;
mod side;
mod state;
#[cfg(test)]
mod tests;

pub(crate) use lines::Lines;
pub use side::{Patch, Profile, Side, Sides};
pub(crate) use state::{Boundaries, FaceKind, PressureFace};
