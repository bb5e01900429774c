//! Scheme and solver.
use crate::Convection;

/// How [`CellTransport`](super::CellTransport) discretises and solves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransportParams {
    /// Convection scheme. Anything but [`Convection::Upwind`] enters by deferred correction (Khosla & Rubin 1974): the
    /// matrix is upwind's, the difference is taken from the φ given, so that repeated solves converge to the scheme. Where
    /// the difference d is negative and φ is not, it enters as the sink −d/φ (Patankar 1980), so that what is positive stays so.
    pub scheme: Convection,
    /// Method of the linear solver.
    pub method: TransportMethod,
    /// Largest relative residual: where nothing is negative, the root mean square of (b_P − Σ a φ)/(a_P φ_P) over the cells; else
    /// ‖b − Aφ‖ over the larger of ‖b‖ and ‖a_P φ‖, taken over the cells that are not pinned.
    pub tolerance: f64,
    /// The solver may stop where the residual is this part of the residual of the φ given, too; 0 for never. A steady iteration
    /// needs no more than 0.1.
    pub reduction: f64,
    /// Iterations allowed.
    pub max_iterations: usize,
}

impl TransportParams {
    /// For steady iterations: convection of second order ([`Convection::Limited`]), residuals brought down to a tenth.
    pub fn steady() -> Self {
        Self { scheme: Convection::Limited, reduction: 0.1, ..Self::default() }
    }
}

impl Default for TransportParams {
    fn default() -> Self {
        Self {
            scheme: Convection::Upwind,
            method: TransportMethod::BiCgStab,
            tolerance: 1e-9,
            reduction: 0.0,
            max_iterations: 1000,
        }
    }
}

/// Linear solver of [`CellTransport`](super::CellTransport).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TransportMethod {
    /// [`bicgstab`](crate::linear::bicgstab) with [`Dilu`](crate::linear::Dilu).
    #[default]
    BiCgStab,
    /// [`gauss_seidel`](crate::linear::gauss_seidel), forward and backward in turn: for short time steps and strong sinks.
    GaussSeidel,
}
