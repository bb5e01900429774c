//! Conjugate gradients with multigrid as preconditioner.
use super::super::rows_of;
use super::solver::Begun;
use super::{Multigrid, MultigridParams};
use crate::poisson::PoissonAxis;
use crate::poisson::{PoissonError, PoissonInfo, PoissonSolver};

/// Conjugate gradients preconditioned by one V-cycle of [`Multigrid`] each.
///
/// The flexible form (Polak & Ribière 1969; Notay 2000) allows for the V-cycle being made in single precision.
pub struct MultigridCg<const D: usize> {
    multigrid: Multigrid<D>,
}

impl<const D: usize> MultigridCg<D> {
    /// A solver of Σ_a ∂_a β ∂_a φ − `shift` φ = f on the box of the given axes; `shift` ≥ 0 \[1/m²\].
    ///
    /// # Errors
    /// Those of [`Multigrid::new`].
    pub fn new(axes: [PoissonAxis; D], shift: f64, params: MultigridParams) -> Result<Self, PoissonError> {
        Ok(Self { multigrid: Multigrid::new(axes, shift, params)? })
    }

    /// The preconditioner; coefficients and kinds of ends are set there.
    pub fn multigrid(&mut self) -> &mut Multigrid<D> {
        &mut self.multigrid
    }

    /// Levels, coarsening and smoother in one sentence.
    pub fn describe(&self) -> String {
        format!("Conjugate gradients preconditioned by V-cycles. {}", self.multigrid.describe())
    }

    /// Solves for φ, starting from the φ given.
    ///
    /// # Errors
    /// [`PoissonError::Length`] and [`PoissonError::NonFinite`] (of f or of the φ given) leave φ as it was;
    /// [`PoissonError::NotConverged`] writes the last φ, whose error is the least in the energy norm.
    pub fn solve_from(&mut self, rhs: &[f64], phi: &mut [f64]) -> Result<PoissonInfo, PoissonError> {
        self.multigrid.check(rhs.len())?;
        let fill = rows_of(rhs, self.multigrid.operator.cells[0]);
        self.solve_rows(fill, phi, true)
    }

    /// Solves for φ; `fill(r, row)` writes row r (along x, counted through the box) of f. Starts from the φ given if
    /// `warm`, else from zero.
    ///
    /// # Errors
    /// Those of [`solve_from`](Self::solve_from).
    pub fn solve_rows(
        &mut self,
        fill: impl Fn(usize, &mut [f64]) + Sync,
        phi: &mut [f64],
        warm: bool,
    ) -> Result<PoissonInfo, PoissonError> {
        self.multigrid.check(phi.len())?;
        let begun = self.multigrid.begin(&fill)?;
        self.iterate(begun, phi, warm)
    }

    fn iterate(
        &mut self,
        mut begun: Begun,
        phi: &mut [f64],
        warm: bool,
    ) -> Result<PoissonInfo, PoissonError> {
        let m = &mut self.multigrid;
        if begun.norm == 0.0 {
            begun.residual = 0.0;
            phi.fill(0.0);
        } else if warm {
            // The guess as a first step.
            m.sweeps.copy_in(&m.operator, phi, &mut m.p);
            let product = m.sweeps.apply(&m.operator, &m.p, &mut m.q);
            if !product.is_finite() {
                return Err(m.not_finite(&m.p, product));
            }
            phi.fill(0.0);
            begun.residual = m.advance(&begun, 1.0, phi);
        } else {
            phi.fill(0.0);
        }
        let (mut iterations, mut alpha, mut last) = (0, 0.0, 1.0);
        while begun.residual > m.params.tolerance && iterations < m.params.max_iterations {
            m.hierarchy.cycle();
            // ⟨z, r⟩ and, as r − r_last = −α q, ⟨z, r − r_last⟩ = −α ⟨z, q⟩.
            let [zr, zq] = m.hierarchy.products(&mut m.sweeps, &mut m.r, &m.q);
            let scale = m.unit / begun.scale;
            let beta = if iterations == 0 { 0.0 } else { -alpha * zq * scale / last };
            m.direct(&begun, beta);
            let pq = m.sweeps.apply(&m.operator, &m.p, &mut m.q);
            last = zr * scale;
            if !(pq > 0.0 && last.is_finite()) {
                break;
            }
            alpha = last / pq;
            begun.residual = m.advance(&begun, alpha, phi);
            iterations += 1;
        }
        m.end(&begun, iterations, begun.residual, phi)
    }
}

impl<const D: usize> PoissonSolver<D> for MultigridCg<D> {
    fn solve(&mut self, rhs_in_phi_out: &mut [f64]) -> Result<PoissonInfo, PoissonError> {
        self.multigrid.check(rhs_in_phi_out.len())?;
        let begun = self.multigrid.begin(&rows_of(rhs_in_phi_out, self.multigrid.operator.cells[0]))?;
        self.iterate(begun, rhs_in_phi_out, false)
    }
}
