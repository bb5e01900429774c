//! What flow leaves of thin films.
use std::fmt::Debug;

/// What a flow solver leaves of the film between two close surfaces for a model to add, so that what is resolved and what is modelled make the whole once.
///
/// The whole is that of lubrication theory: a force 6πμR²U/δ against an approach at speed U, R the reduced radius of curvature, and
/// forces and torques with ln(1/δ) against sliding and rolling.
pub trait UnresolvedFilm: Debug + Send + Sync {
    /// The largest gap of which something is left \[m\].
    fn reach(&self) -> f64;
    /// What is left of 1/δ at a `gap` δ between surfaces of reduced `radius` \[1/m\]; negative where the flow alone resists too much. `wall`: one of
    /// them is a side of the flow's box.
    fn squeeze(&self, gap: f64, radius: f64, wall: bool) -> f64;
    /// What is left of ln(1/δ).
    fn shear(&self, gap: f64) -> f64;
}
