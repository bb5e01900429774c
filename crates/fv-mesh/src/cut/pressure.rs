//! The pressure equation of cells that walls cut.
use super::recent::Recent;
use super::regions::{CutCell, Orphan, Passage, Regions};
use crate::boundary::Boundaries;
use crate::metrics::Metrics;
use crate::parts::least_parts;
use crate::poisson::{PoissonError, Rows};
use crate::pressure::Pressure;
use crate::{CartesianGrid, Field};
use interfaces::{CutWalls, RestartError};
use monomorphic::Mat;
use rayon::prelude::*;
use std::ops::Range;
use std::time::{Duration, Instant};

/// Σ_f open_f g_f (φ_N − φ_P) = V f with g_f = A_f/d_f, by the solver of the box and a system of the cells of the fluid with
/// faces that are not wholly open.
///
/// The share of the fluxes that the walls close is a source on the right,
///
/// ```text
/// σ = C φ,   C φ = Σ_f (1 − open_f) g_f (φ_N − φ_P)/V,   L φ = f + P σ
/// K σ = S C L⁻¹ f,   K = S (1 − C L⁻¹ P)
/// ```
///
/// with the box's operator L, P from those cells to all, and S = Σ g/Σ open g, which makes rows of narrow openings as long as
/// others. Cells of the solid keep the box's equation, and nothing in the fluid depends on them: σ is a layer of sources along the
/// walls whose normal derivative is given, an integral equation of the second kind (Hsiao & Wendland 2008, *Boundary Integral
/// Equations*, § 1.4). So the condition number of K does not depend on the cells' size. (Dipoles on the closed faces, whose matrix is
/// symmetric, have one that grows with the number of cells along the walls.)
///
/// [`Recent`] starts from the last σ and known directions of K, with one solution of the box's solver
/// for each new direction. K⁻¹ takes one for each cell, and a solution with it two (the capacitance
/// matrix method: Buzbee, Dorr, George & Golub 1971, SIAM J. Numer. Anal. 8, 722). If it is worth
/// keeping, it is made when iterations have taken as many solutions as it takes, or do not converge:
/// short runs do not pay for it, and no run takes more than twice the cheaper way.
pub(crate) struct CutPressure {
    cells: Vec<CutCell>,
    /// The cells of every row of the grid, and how long a row is.
    rows: Vec<Range<usize>>,
    row: usize,
    /// No pressure is given at any side: the sum of the sources is zero.
    floating: bool,
    /// K⁻¹, row after row, once it is made.
    inverse: Option<Vec<f64>>,
    /// Whether K⁻¹ is worth keeping, and not singular.
    invertible: bool,
    /// Iterations of all solutions; at least the number of cells once they did not converge.
    pub(super) all_iterations: usize,
    /// Time that they took.
    iteration_time: Duration,
    /// σ.
    pub(super) missing: Vec<f64>,
    residual: Vec<f64>,
    change: Vec<f64>,
    direction: Vec<f64>,
    product: Vec<f64>,
    /// Directions of the last solutions, unless K⁻¹ is made.
    pub(super) recent: Option<Recent>,
    /// Iterations of the last solution.
    pub(crate) iterations: usize,
    /// Cells of which no velocity is computed.
    orphans: Vec<Orphan>,
    /// Dense numbers and storage indices of the cells inside the solid.
    solid: Vec<(usize, usize)>,
    /// Per component: how the pressure acts on its faces.
    passages: Vec<Vec<Passage>>,
}

/// Entries of K⁻¹ for each cell of the grid, at most.
const DENSE: usize = 40;

/// Residuals of K σ, over its terms, below which σ is good …
const EXACT: f64 = 1e-11;
/// … and those at which iterations stop, at the latest after so many …
const TOLERANCE: f64 = 1e-6;
const MOST: usize = 200;
/// … unless what is found then is so many times worse.
const SLACK: f64 = 10.0;

/// Iterations of the pressure equation at immersed walls, which the inverse of its matrix replaces
/// when there have been as many as unknowns.
#[derive(Clone, Copy, Debug)]
pub struct InverseOutlook {
    /// Cells that the walls cut.
    pub unknowns: usize,
    /// Iterations so far, each with one solution of the box's Poisson equation.
    pub iterations: usize,
    /// Wall time of these iterations \[s\].
    pub seconds: f64,
}

impl InverseOutlook {
    /// Whether the inverse is worth keeping: its product then costs less than a few solutions of the
    /// box's equation.
    pub fn pays(unknowns: usize, cells: usize) -> bool {
        unknowns > 0 && unknowns.saturating_mul(unknowns) <= DENSE.saturating_mul(cells)
    }
}

impl CutPressure {
    pub(super) fn new<const D: usize>(
        cuts: &CutWalls,
        grid: &CartesianGrid<D>,
        metrics: &Metrics<D>,
        boundaries: &Boundaries<D>,
    ) -> Self {
        let Regions { cells, orphans, solid, floating, passages } =
            Regions::new(cuts, grid, metrics, boundaries);
        let row = grid.cells()[0];
        let start = |r: usize| cells.partition_point(|cut| cut.cell < r * row);
        let m = cells.len();
        Self {
            rows: (0..grid.n_cells() / row).map(|r| start(r)..start(r + 1)).collect(),
            cells,
            row,
            floating,
            inverse: None,
            invertible: false,
            all_iterations: 0,
            iteration_time: Duration::ZERO,
            missing: vec![0.0; m],
            residual: vec![0.0; m],
            change: vec![0.0; m],
            direction: vec![0.0; m],
            product: vec![0.0; m],
            recent: None,
            iterations: 0,
            orphans,
            solid: solid.into_iter().map(|cell| (cell, grid.place(grid.cell(cell)))).collect(),
            passages,
        }
    }

    /// Decides whether K⁻¹ is worth keeping on a grid of so many cells.
    pub(super) fn prepare(&mut self, cells: usize) {
        let m = self.cells.len();
        self.invertible = InverseOutlook::pays(m, cells);
        self.recent = Some(Recent::new(m));
    }

    /// Whether K⁻¹ replaces iterations from now on.
    pub(super) fn inverse_is_due(&self) -> bool {
        self.invertible && self.all_iterations >= self.cells.len()
    }

    /// Progress of the iterations to K⁻¹; none if it is made or not worth keeping.
    pub(crate) fn inverse_outlook(&self) -> Option<InverseOutlook> {
        let awaited = self.invertible && self.inverse.is_none() && self.all_iterations > 0;
        awaited.then_some(InverseOutlook {
            unknowns: self.cells.len(),
            iterations: self.all_iterations,
            seconds: self.iteration_time.as_secs_f64(),
        })
    }

    /// Takes back the iterations that a saved state holds.
    pub(super) fn restore_iterations<'a>(
        &mut self,
        source: &dyn Fn(&str) -> Option<&'a [f64]>,
    ) -> Result<(), RestartError> {
        self.all_iterations = RestartError::take(source, "walls iterations", 1)?[0] as usize;
        self.iteration_time = Duration::ZERO;
        // States behind the moment at which K⁻¹ is made hold no directions.
        if self.inverse_is_due() && source("walls recent").is_none() {
            return Ok(());
        }
        self.inverse = None;
        self.recent.get_or_insert_with(|| Recent::new(self.cells.len())).restore(source)
    }

    /// Makes K⁻¹ with the box's solver; `phi` is scratch.
    ///
    /// # Errors
    /// Those of the solver.
    pub(super) fn invert<const D: usize>(
        &mut self,
        solver: &mut Pressure<D>,
        phi: &mut [f64],
    ) -> Result<(), PoissonError> {
        let m = self.cells.len();
        let mut matrix = Mat::<f64>::zeros(m, m);
        for j in 0..m {
            self.direction.fill(0.0);
            self.direction[j] = 1.0;
            self.multiply(solver, phi)?;
            self.product.iter().enumerate().for_each(|(i, value)| matrix[(i, j)] = *value);
        }
        phi.fill(0.0);
        let inverse = monomorphic::inverse(matrix.as_ref());
        let inverse: Vec<f64> = (0..m * m).map(|k| inverse[(k / m, k % m)]).collect();
        // A matrix that is singular to round-off is left to iterations.
        self.invertible = inverse.iter().all(|value| value.is_finite());
        if self.invertible {
            self.inverse = Some(inverse);
            self.recent = None;
        }
        Ok(())
    }

    /// `product` becomes K `direction`. Where no pressure is given, K is taken of the direction less its mean, and that mean is added:
    /// K is not singular then.
    fn multiply<const D: usize>(
        &mut self,
        solver: &mut Pressure<D>,
        phi: &mut [f64],
    ) -> Result<(), PoissonError> {
        let mean = take_mean(self.floating, &self.cells, &mut self.direction);
        let rows = |r: usize, row: &mut [f64]| {
            row.fill(0.0);
            self.add_sources(r, &self.direction, row);
        };
        solver.solve_rows(&rows, phi)?;
        for ((product, source), cut) in self.product.iter_mut().zip(&mut self.direction).zip(&self.cells) {
            *product = cut.scale * (*source - cut.taken(phi)) + mean;
            *source += mean;
        }
        Ok(())
    }

    /// Solves with the right-hand side that `fill` makes row by row.
    ///
    /// # Errors
    /// Those of the solver; [`PoissonError::Walls`].
    pub(crate) fn solve<const D: usize>(
        &mut self,
        solver: &mut Pressure<D>,
        fill: Rows<'_>,
        phi: &mut [f64],
    ) -> Result<(), PoissonError> {
        let whole = |this: &Self, solver: &mut Pressure<D>, phi: &mut [f64]| {
            let rows = |r: usize, row: &mut [f64]| {
                fill(r, row);
                this.add_sources(r, &this.missing, row);
            };
            solver.solve_rows(&rows, phi)
        };
        if self.inverse.is_none() && self.inverse_is_due() {
            self.invert(solver, phi)?;
        }
        self.iterations = 0;
        let mut corrections = 0;
        loop {
            // Accuracy does not change when K⁻¹ takes over, unless the box's solver iterates itself.
            let tolerance = if self.invertible && !solver.remembers() { EXACT } else { TOLERANCE };
            whole(self, solver, phi)?;
            let scale = self.measure(phi);
            // Limits of round-off: of the inverse, and of known directions.
            let (goal, enough) = match &self.recent {
                None => (EXACT, corrections == 1),
                Some(_) => (if corrections == 0 { tolerance } else { SLACK * tolerance }, false),
            };
            let goal = goal * goal * scale;
            if enough || square(&self.residual) <= goal {
                // Values of the box's equation inside the solid would act on sides of the box that it touches.
                self.solid.iter().for_each(|&(cell, _)| phi[cell] = 0.0);
                return Ok(());
            }
            if corrections > 0 {
                self.recent.as_mut().map(Recent::forget);
            }
            match self.find_change(solver, tolerance, scale, phi) {
                Err(PoissonError::Walls { .. }) if self.invertible => {
                    self.invert(solver, phi)?;
                    self.all_iterations = self.all_iterations.max(self.cells.len());
                    (self.iterations, corrections) = (0, 0);
                    continue;
                }
                found => found?,
            }
            take_mean(self.floating, &self.cells, &mut self.change);
            self.missing.iter_mut().zip(&self.change).for_each(|(source, change)| *source += change);
            corrections += 1;
        }
    }

    /// Takes the residual S (C φ − σ), and answers the sum of its terms' squares.
    fn measure(&mut self, phi: &[f64]) -> f64 {
        let mut scale = 0.0;
        for ((residual, source), cut) in self.residual.iter_mut().zip(&self.missing).zip(&self.cells) {
            let taken = cut.taken(phi);
            *residual = cut.scale * (taken - source);
            scale += cut.scale.powi(2) * (taken * taken + source * source);
        }
        self.balance();
        scale
    }

    /// Where no pressure is given, nothing flows in or out of the largest region in sum: takes from the residual what says otherwise
    /// (the walls' own fluxes do not cancel to round-off).
    fn balance(&mut self) {
        let (mut sum, mut weights) = (0.0, 0.0);
        for (residual, cut) in self.residual.iter().zip(&self.cells).filter(|(_, cut)| cut.floats) {
            let weight = cut.volume / cut.scale;
            sum += weight * residual;
            weights += weight;
        }
        if weights > 0.0 {
            let mean = sum / weights;
            let floating = self.residual.iter_mut().zip(&self.cells).filter(|(_, cut)| cut.floats);
            floating.for_each(|(residual, _)| *residual -= mean);
        }
    }

    /// Finds the `change` with K `change` = `residual`.
    fn find_change<const D: usize>(
        &mut self,
        solver: &mut Pressure<D>,
        tolerance: f64,
        scale: f64,
        phi: &mut [f64],
    ) -> Result<(), PoissonError> {
        if let Some(inverse) = &self.inverse {
            let (m, residual) = (self.cells.len(), &self.residual);
            // Four products take as long as what is done in a cell.
            let least = least_parts(m * m / 4).max(64);
            let rows = inverse.par_chunks_exact(m);
            self.change.par_iter_mut().zip(rows).with_min_len(least).for_each(|(change, row)| {
                *change = row.iter().zip(residual).map(|(a, b)| a * b).sum();
            });
            return Ok(());
        }
        self.change.fill(0.0);
        let mut recent = self.recent.take().unwrap_or_else(|| Recent::new(self.cells.len()));
        recent.reduce(&mut self.residual, &mut self.change);
        let goal = tolerance * tolerance * scale;
        let start = Instant::now();
        let mut solved = Ok(());
        while square(&self.residual) > goal && solved.is_ok() {
            if self.iterations == MOST {
                let residual = (square(&self.residual) / scale).sqrt();
                solved = Err(PoissonError::Walls { cells: self.cells.len(), residual, tolerance });
                break;
            }
            self.direction.copy_from_slice(&self.residual);
            solved = self.multiply(solver, phi);
            recent.learn(&mut self.direction, &mut self.product);
            recent.reduce_last(&mut self.residual, &mut self.change);
            self.iterations += 1;
            self.all_iterations += 1;
        }
        self.iteration_time += start.elapsed();
        self.recent = Some(recent);
        solved
    }

    /// Adds the sources of row `r`.
    fn add_sources(&self, r: usize, sources: &[f64], row: &mut [f64]) {
        let cells = self.rows[r].clone();
        for (cut, source) in self.cells[cells.clone()].iter().zip(&sources[cells]) {
            row[cut.cell - r * self.row] += source;
        }
    }

    /// Open share times ∂φ/∂n at every face of component `c`.
    pub(super) fn gradients(&self, c: usize, phi: &[f64]) -> impl Iterator<Item = f64> {
        self.passages[c].iter().map(|p| p.weight * (phi[p.cells[1]] - phi[p.cells[0]]))
    }

    /// Takes the pressure out of the solid.
    pub(super) fn start<const D: usize>(&self, pressure: &mut Field<D>) {
        self.solid.iter().for_each(|&(_, at)| pressure.data_mut()[at] = 0.0);
    }

    /// Gives the cells of which no velocity is computed the mean pressure of their neighbours.
    pub(crate) fn smooth_orphans<const D: usize>(&self, pressure: &mut Field<D>) {
        let p = pressure.data_mut();
        for Orphan { cell, neighbours } in &self.orphans {
            p[*cell] = neighbours.iter().map(|&(at, weight)| weight * p[at]).sum();
        }
    }
}

impl CutCell {
    /// Flux of the closed shares of the cell's faces: C φ.
    fn taken(&self, phi: &[f64]) -> f64 {
        self.closed.iter().map(|&(neighbour, weight)| weight * (phi[neighbour] - phi[self.cell])).sum()
    }
}

/// Takes out and answers the mean of the sources if they `must` have none.
fn take_mean(must: bool, cells: &[CutCell], sources: &mut [f64]) -> f64 {
    if !must {
        return 0.0;
    }
    let volume: f64 = cells.iter().map(|cut| cut.volume).sum();
    let mean = sources.iter().zip(cells).map(|(source, cut)| cut.volume * source).sum::<f64>() / volume;
    sources.iter_mut().for_each(|source| *source -= mean);
    mean
}

fn square(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum()
}
