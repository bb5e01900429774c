//! Wall functions.
mod functions;
mod layer;
mod statistics;

pub use functions::{Sublayer, WallFunctions, WallShear};
pub(crate) use layer::WallLayer;
pub use statistics::YPlus;
