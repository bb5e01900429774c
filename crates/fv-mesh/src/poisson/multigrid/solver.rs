//! Multigrid on its own.
use super::MultigridParams;
use super::axis::{self, AxisLevel};
use super::fields::{Advance, Sweeps};
use super::hierarchy::Hierarchy;
use super::precision::Precision;
use super::stencil::Stencil;
use crate::poisson::{PoissonAxis, PoissonError, PoissonInfo, PoissonSolver, Rows, rows_of};

/// Geometric multigrid: V-cycles, one after the other. [`MultigridCg`](super::MultigridCg) needs fewer of them.
pub struct Multigrid<const D: usize> {
    pub(super) params: MultigridParams,
    pub(super) operator: Stencil<f64>,
    pub(super) hierarchy: Precision,
    pub(super) sweeps: Sweeps,
    /// The hierarchy inverts `unit` A.
    pub(super) unit: f64,
    /// A maps constants to zero.
    pub(super) singular: bool,
    pub(super) shift: f64,
    /// Residual f − Lφ, with changed sign, and two more fields with ghosts.
    pub(super) r: Vec<f64>,
    pub(super) p: Vec<f64>,
    pub(super) q: Vec<f64>,
    pub(super) coefficients: Option<super::coefficients::Coefficients>,
}

/// A solve that has begun.
pub(super) struct Begun {
    pub(super) removed_mean: f64,
    /// Root mean square of f.
    pub(super) norm: f64,
    /// Factor of the residual in single precision.
    pub(super) scale: f64,
    /// Residual over f.
    pub(super) residual: f64,
}

impl<const D: usize> Multigrid<D> {
    /// A solver of Σ_a ∂_a β ∂_a φ − `shift` φ = f on the box of the given axes; `shift` ≥ 0 \[1/m²\].
    ///
    /// # Errors
    /// [`PoissonError::NoCells`], [`PoissonError::Spacing`], [`PoissonError::Shift`] and
    /// [`PoissonError::Parameter`].
    pub fn new(axes: [PoissonAxis; D], shift: f64, params: MultigridParams) -> Result<Self, PoissonError> {
        const { assert!(D == 2 || D == 3, "multigrid works in two and three dimensions") };
        for (axis, a) in axes.iter().enumerate() {
            if a.widths.is_empty() {
                return Err(PoissonError::NoCells { axis });
            }
            let total: f64 = a.widths.iter().sum();
            let bad =
                |w: f64| !(w > 0.0 && w.is_finite() && (w * w).is_normal() && (1.0 / (w * w)).is_normal());
            if let Some(&spacing) = a.widths.iter().chain([&total]).find(|&&w| bad(w)) {
                return Err(PoissonError::Spacing { axis, spacing });
            }
        }
        if !(shift >= 0.0 && shift.is_finite()) {
            return Err(PoissonError::Shift { shift });
        }
        for (name, value, least) in [
            ("tolerance", params.tolerance, 1e-14),
            ("max_iterations", params.max_iterations as f64, 1.0),
            ("sweeps", params.sweeps as f64, 1.0),
            ("widest_merged", params.widest_merged, 1.0),
        ] {
            if !(value >= least && value.is_finite()) {
                return Err(PoissonError::Parameter { name, value, least });
            }
        }
        let narrowest = axes
            .iter()
            .filter(|a| a.widths.len() > 1)
            .flat_map(|a| &a.widths)
            .fold(f64::INFINITY, |m, &w| m.min(w));
        let narrowest = if narrowest.is_finite() { narrowest } else { axes[0].widths[0] };
        let level = |a: usize| AxisLevel { widths: axes[a].widths.clone(), ends: axis::ends(axes[a].ends) };
        // The last axis of the box stays the last one.
        let none = AxisLevel { widths: vec![1.0], ends: [axis::End::ZeroGradient; 2] };
        let levels = if D == 3 { [level(0), level(1), level(2)] } else { [level(0), none, level(1)] };
        let singular = shift == 0.0 && levels.iter().all(|a| !a.ends.contains(&axis::End::ZeroValue));
        let unit = narrowest * narrowest;
        let operator = Stencil::new(&levels, 1.0, shift, params.variable);
        let longest = levels.iter().map(|a| a.widths.iter().sum()).fold(0.0, f64::max);
        let MultigridParams { variable, sweeps, widest_merged, .. } = params;
        let (axes, merge) = (levels.clone(), widest_merged * narrowest);
        let hierarchy = if Precision::single(longest / narrowest) {
            Precision::Single(Hierarchy::new(axes, unit, shift, variable, sweeps, merge, singular))
        } else {
            Precision::Double(Hierarchy::new(axes, unit, shift, variable, sweeps, merge, singular))
        };
        let zeros = vec![0.0; operator.len()];
        let mut multigrid = Self {
            sweeps: Sweeps::new(&levels),
            r: zeros.clone(),
            p: zeros.clone(),
            q: zeros,
            coefficients: params.variable.then(|| super::coefficients::Coefficients::new(&levels)),
            params,
            operator,
            hierarchy,
            unit,
            singular,
            shift,
        };
        multigrid.set_ones();
        Ok(multigrid)
    }

    /// Cells of the box.
    pub(super) fn cells(&self) -> usize {
        self.operator.cells.iter().product()
    }

    pub(super) fn check(&self, length: usize) -> Result<(), PoissonError> {
        let cells = self.cells();
        if length == cells { Ok(()) } else { Err(PoissonError::Length { length, cells }) }
    }

    /// One V-cycle from zero: an approximation of the φ that belongs to f, both dense. The map is linear, symmetric in
    /// the volume-weighted product and negative definite as the operator (up to constants if that is singular),
    /// all to the precision that [`describe`](Self::describe) tells.
    ///
    /// # Errors
    /// [`PoissonError::Length`] and [`PoissonError::NonFinite`]; f is then left as it was.
    pub fn v_cycle(&mut self, rhs_in_phi_out: &mut [f64]) -> Result<(), PoissonError> {
        self.check(rhs_in_phi_out.len())?;
        let begun = self.begin(&rows_of(rhs_in_phi_out, self.operator.cells[0]))?;
        rhs_in_phi_out.fill(0.0);
        if begun.norm > 0.0 {
            self.hierarchy.cycle();
            self.direct(&begun, 0.0);
            self.advance(&begun, 1.0, rhs_in_phi_out);
        }
        Ok(())
    }

    /// Takes in f and prepares its residual for a V-cycle.
    pub(super) fn begin(&mut self, fill: Rows<'_>) -> Result<Begun, PoissonError> {
        let [mean, square] = self.sweeps.load(fill, &mut self.r);
        if !square.is_finite() {
            return Err(self.not_finite(&self.r, square));
        }
        let removed = if self.singular { mean } else { 0.0 };
        let scale = if square > 0.0 { 1.0 / square.sqrt() } else { 0.0 };
        let square_left = self.hierarchy.centre(&mut self.sweeps, removed, scale, &mut self.r);
        // What is left of a constant is round-off.
        let norm = if square_left > 1e-28 * square { square_left.sqrt() } else { 0.0 };
        Ok(Begun { removed_mean: 0.0 - removed, norm, scale, residual: 1.0 })
    }

    /// The error that tells which layer of `field` is not finite.
    pub(super) fn not_finite(&self, field: &[f64], sum: f64) -> PoissonError {
        let sums = field.chunks_exact(self.operator.layer()).map(|r| r.iter().map(|r| r * r).sum::<f64>());
        let (low, sum) = sums.enumerate().find(|(_, sum)| !sum.is_finite()).unwrap_or((0, sum));
        PoissonError::NonFinite { low, high: low, sum }
    }

    /// p ← the correction of the V-cycle + `beta` p.
    pub(super) fn direct(&mut self, begun: &Begun, beta: f64) {
        let scale = self.unit / begun.scale;
        self.hierarchy.direct(&mut self.sweeps, &self.operator, scale, beta, &mut self.p);
    }

    /// φ ← φ + `alpha` p and the residual with it; returns the residual over f.
    pub(super) fn advance(&mut self, begun: &Begun, alpha: f64, phi: &mut [f64]) -> f64 {
        let step = Advance { alpha, p: &self.p, q: &self.q, scale: begun.scale };
        let square = self.hierarchy.advance(&mut self.sweeps, step, &mut self.r, phi);
        square.sqrt() / begun.norm
    }

    /// Ends a solve.
    pub(super) fn end(
        &mut self,
        begun: &Begun,
        iterations: usize,
        residual: f64,
        phi: &mut [f64],
    ) -> Result<PoissonInfo, PoissonError> {
        if self.singular {
            self.sweeps.remove_mean(phi);
        }
        let tolerance = self.params.tolerance;
        if residual <= tolerance {
            Ok(PoissonInfo { removed_mean: begun.removed_mean, iterations, residual })
        } else {
            Err(PoissonError::NotConverged { iterations, residual, tolerance })
        }
    }

    /// Levels, coarsening and smoother in one sentence.
    pub fn describe(&self) -> String {
        let levels = self.hierarchy.cells();
        let size =
            |[x, m, z]: &[usize; 3]| if D == 3 { format!("{x}×{m}×{z}") } else { format!("{x}×{z}") };
        let sizes: Vec<String> = levels.iter().map(size).collect();
        let total: usize = levels.iter().map(|l| l.iter().product::<usize>()).sum();
        let precision = if matches!(self.hierarchy, Precision::Single(_)) { "single" } else { "double" };
        format!(
            "Multigrid on {} levels ({}; {:.2} times the cells of the finest) that merge the narrow cells of every axis \
             first, with {} + {} red–black Gauss–Seidel sweeps per level in {precision} precision and dense Cholesky on \
             the coarsest.",
            levels.len(),
            sizes.join(", "),
            total as f64 / self.cells() as f64,
            self.params.sweeps,
            self.params.sweeps,
        )
    }
}

impl<const D: usize> PoissonSolver<D> for Multigrid<D> {
    fn solve(&mut self, rhs_in_phi_out: &mut [f64]) -> Result<PoissonInfo, PoissonError> {
        self.check(rhs_in_phi_out.len())?;
        let mut begun = self.begin(&rows_of(rhs_in_phi_out, self.operator.cells[0]))?;
        rhs_in_phi_out.fill(0.0);
        if begun.norm == 0.0 {
            begun.residual = 0.0;
        }
        let mut iterations = 0;
        while begun.residual > self.params.tolerance && iterations < self.params.max_iterations {
            self.hierarchy.cycle();
            self.direct(&begun, 0.0);
            self.sweeps.apply(&self.operator, &self.p, &mut self.q);
            begun.residual = self.advance(&begun, 1.0, rhs_in_phi_out);
            iterations += 1;
        }
        self.end(&begun, iterations, begun.residual, rhs_in_phi_out)
    }
}
