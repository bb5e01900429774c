//! Scalars at the cell centres: boundary conditions and transport.
mod boundaries;
mod diffusion;
mod kernel;
mod side;
mod steady;
#[cfg(test)]
mod tests;
mod transported;

pub use boundaries::ScalarBoundaries;
pub use side::{Given, ScalarPatch, ScalarSide};
pub use steady::Settling;
pub use transported::{Scalar, ScalarTransport};
