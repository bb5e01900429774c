//! Model order reduction of snapshots, whatever they were made with.
//!
//! A matrix of snapshots has one row per unknown and one column per snapshot ([`MatRef`], column by column in memory).
#![forbid(unsafe_code)]

pub mod galerkin;
pub mod interpolation;
pub mod models;
pub mod pod;
pub mod shifted;
pub mod snapshots;

pub use monomorphic::{Mat, MatRef};
