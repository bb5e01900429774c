//! Values at points, on lines and planes, and integrals over the grid.
mod integrals;

pub use integrals::{Extreme, Integrals, Norms};
