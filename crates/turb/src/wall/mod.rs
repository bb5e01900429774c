//! Wall functions.
mod functions;
mod layer;
mod statistics;

pub use functions::{WallFunctions, WallShear};
pub(crate) use layer::WallLayer;
pub use statistics::YPlus;
