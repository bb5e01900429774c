//! Shifted proper orthogonal decomposition: fields that several frames of reference carry along.
//!
//! Q(x, t_j) ≈ Σ_k T^{Δ_k(t_j)} [ Σ_i σ_i^k a_i^k(t_j) φ_i^k(x) ] (Reiss, Schulze, Sesterhenn & Mehrmann 2018; equation (9) of Isoz et al. 2023)
//!
//! T^s q (x) = q(x − s): what frame k carries is at rest in it, and moved by Δ_k(t_j) in snapshot j.
mod anderson;
mod axis;
mod correlation;
mod dense;
mod descent;
mod error;
mod estimate;
mod field_shift;
pub mod fourier;
mod frames;
mod gather;
mod grid;
mod huber_descent;

mod lines;
mod motion;
mod multi_frame;
mod operators;
mod proximal;
mod rank_search;
mod residual;
mod residual_parts;
mod robust;
mod shifted_pod;
mod spline;
mod stencil;
mod superposition;
mod tangent;
#[cfg(test)]
mod tests;
mod thinning;
mod translated;
mod translated_fit;
mod turn;
mod waves;

pub use descent::JointDescent;
pub use error::ShiftedError;
pub use estimate::ShiftEstimate;
pub use field_shift::FieldShift;
pub use frames::{Decomposition, Frame, FrameOperators, Progress, StopReason};
pub use grid::Grid;
pub use motion::{Motion, Motions, Shifts};
pub use multi_frame::MultiFrame;
pub use operators::GridFrames;
pub use proximal::Proximal;
pub use residual::Observer;
pub use shifted_pod::{Noise, Ranks, ShiftedPod};
pub use stencil::Interpolation;
pub(crate) use superposition::{Superposition, Workspace};
