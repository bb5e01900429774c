//! Scalars at the cell centres: boundary conditions and transport.
mod boundaries;
mod diffusion;
mod kernel;
mod mixing;
mod side;
mod steady;
#[cfg(test)]
mod tests;
mod thermal_law;
mod transported;
mod walls;

pub use boundaries::ScalarBoundaries;
pub use side::{Given, ScalarPatch, ScalarSide};
pub use steady::Settling;
pub use transported::{Scalar, ScalarTransport};
