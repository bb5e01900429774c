//! Matrices of a cell and its face neighbours on a box.
mod chain;
mod dilu;
mod matrix;
mod product;
mod scale;
mod sweep;

pub use dilu::{Dilu, DiluPreconditioner};
pub use matrix::StencilMatrix;
pub use sweep::RedBlack;
