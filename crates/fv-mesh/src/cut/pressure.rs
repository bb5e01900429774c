//! The pressure equation of cells that walls cut.
use super::recent::Recent;
use super::regions::{Orphan, Regions};
use crate::metrics::Metrics;
use crate::poisson::PoissonError;
use crate::pressure::Pressure;
use crate::{CartesianGrid, Field, FlowError};
use faer::linalg::solvers::DenseSolveCore;
use faer::{Mat, Side};
use interfaces::CutWalls;
use rayon::prelude::*;

/// Σ_f open_f A_f (φ_N − φ_P)/d_f = V f, by the solver of the box and a system of the cut faces.
///
/// The part of the flux that a wall takes away, y_f = (1 − open_f) g_f (φ_N − φ_P) with g_f = A_f/d_f, stands on the right
/// as dipoles. With L the box's operator, B the difference across the cut faces and G its adjoint per volume,
///
/// ```text
/// L φ = f + G y,   M y = B L⁻¹ f,   M = diag(1/((1 − open) g)) − B L⁻¹ G
/// ```
///
/// (the capacitance matrix method: Buzbee, Dorr, George & Golub 1971). M is symmetric and positive definite and stays what
/// it is while the walls stay where they are. Few faces: M⁻¹ is kept, and a solution takes two of the box's. Many: conjugate
/// gradients from the last y and from what the last changes of y tell ([`Recent`]), one of the box's each, with the diagonal
/// 1/((1 − open) g) as preconditioner.
///
/// Regions that the walls separate (the inside of a body, a closed pocket of fluid) hang on one closed face each, through
/// which nothing flows as long as what enters the region leaves it.
pub(crate) struct CutPressure {
    faces: Vec<Face>,
    /// Sources of the faces' dipoles, row after row: cell in the row, face, 1/V with its sign.
    dipoles: Vec<(usize, usize, f64)>,
    /// Where each row's dipoles begin.
    row_starts: Vec<usize>,
    /// M⁻¹, row after row, where it is kept.
    inverse: Option<Vec<f64>>,
    /// y.
    pub(super) missing: Vec<f64>,
    /// B L⁻¹ f + B L⁻¹ G y − y/((1 − open) g).
    residual: Vec<f64>,
    /// What the last solutions by conjugate gradients tell of the next one.
    pub(super) recent: Option<Recent>,
    /// The residual before the last correction.
    start: Vec<f64>,
    /// Correction of y, and the directions and products of conjugate gradients.
    change: Vec<f64>,
    direction: Vec<f64>,
    product: Vec<f64>,
    /// Of conjugate gradients in the last solution.
    pub(crate) iterations: usize,
    /// Cells of which no velocity is computed.
    orphans: Vec<Orphan>,
}

/// M⁻¹ is kept if it has at most so many entries per cell of the grid: its product then costs less than a few of the box's
/// solutions.
const DENSE: usize = 40;

/// Residuals of M y = b, over its terms, below which y is good …
const EXACT: f64 = 1e-11;
/// … and those at which conjugate gradients stop, at the latest after so many iterations.
const TOLERANCE: f64 = 1e-7;
const MOST: usize = 200;

/// A face that is partly closed.
#[derive(Clone, Copy, Debug)]
struct Face {
    /// Dense numbers of the cells below and above.
    cells: [usize; 2],
    /// 1/((1 − open) g).
    resistance: f64,
}

impl CutPressure {
    pub(super) fn new<const D: usize>(
        cuts: &CutWalls,
        grid: &CartesianGrid<D>,
        metrics: &Metrics<D>,
    ) -> Self {
        let Regions { cut, orphans } = Regions::new(cuts, grid, metrics);
        let n = grid.cells();
        let volume = |index: usize| grid.cell_volume(grid.cell(index));
        let faces: Vec<Face> = cut
            .iter()
            .map(|face| Face { cells: face.cells, resistance: 1.0 / ((1.0 - face.open) * face.conductance) })
            .collect();
        let mut dipoles: Vec<(usize, usize, f64)> = faces
            .iter()
            .enumerate()
            .flat_map(|(f, face)| [(face.cells[0], f, 1.0), (face.cells[1], f, -1.0)])
            .map(|(cell, f, sign)| (cell, f, sign / volume(cell)))
            .collect();
        dipoles.sort_by_key(|d| (d.0, d.1));
        let rows = grid.n_cells() / n[0];
        let row_starts = (0..=rows).map(|r| dipoles.partition_point(|d| d.0 < r * n[0])).collect();
        dipoles.iter_mut().for_each(|d| d.0 %= n[0]);
        let m = faces.len();
        Self {
            faces,
            dipoles,
            row_starts,
            inverse: None,
            recent: None,
            start: vec![0.0; m],
            residual: vec![0.0; m],
            change: vec![0.0; m],
            direction: vec![0.0; m],
            product: vec![0.0; m],
            missing: vec![0.0; m],
            iterations: 0,
            orphans,
        }
    }

    /// Makes M⁻¹ with the box's solver if it is worth keeping; `phi` is scratch.
    ///
    /// # Errors
    /// Those of the solver; [`FlowError::Walls`] if M is not positive definite.
    pub(super) fn prepare<const D: usize>(
        &mut self,
        solver: &mut Pressure<D>,
        phi: &mut [f64],
    ) -> Result<(), FlowError> {
        let m = self.faces.len();
        if m * m <= DENSE * phi.len() {
            return self.invert(solver, phi);
        }
        self.recent = Some(Recent::new(m));
        Ok(())
    }

    /// Makes M⁻¹.
    pub(super) fn invert<const D: usize>(
        &mut self,
        solver: &mut Pressure<D>,
        phi: &mut [f64],
    ) -> Result<(), FlowError> {
        let m = self.faces.len();
        let mut matrix = Mat::<f64>::zeros(m, m);
        for j in 0..m {
            self.direction.fill(0.0);
            self.direction[j] = 1.0;
            self.multiply(solver, phi)?;
            for (i, value) in self.product.iter().enumerate() {
                matrix[(i, j)] += 0.5 * value;
                matrix[(j, i)] += 0.5 * value;
            }
        }
        phi.fill(0.0);
        let inverse = matrix.llt(Side::Lower).map_err(|_| FlowError::Walls { faces: m })?.inverse();
        self.inverse = Some((0..m * m).map(|k| inverse[(k / m, k % m)]).collect());
        Ok(())
    }

    /// `product` becomes M `direction`.
    fn multiply<const D: usize>(
        &mut self,
        solver: &mut Pressure<D>,
        phi: &mut [f64],
    ) -> Result<(), PoissonError> {
        let direction = &self.direction;
        solver.solve_rows(
            |r, row: &mut [f64]| {
                row.fill(0.0);
                self.add_dipoles(r, direction, row);
            },
            phi,
        )?;
        for ((product, face), y) in self.product.iter_mut().zip(&self.faces).zip(direction) {
            *product = face.resistance * y - face.jump(phi);
        }
        Ok(())
    }

    /// Solves with the right-hand side that `fill` makes row by row.
    ///
    /// # Errors
    /// Those of the solver; [`PoissonError::NotConverged`].
    pub(crate) fn solve<const D: usize, F>(
        &mut self,
        solver: &mut Pressure<D>,
        fill: F,
        phi: &mut [f64],
    ) -> Result<(), PoissonError>
    where
        F: Fn(usize, &mut [f64]) + Sync,
    {
        let whole = |this: &Self, solver: &mut Pressure<D>, phi: &mut [f64]| {
            let rows = |r: usize, row: &mut [f64]| {
                fill(r, row);
                this.add_dipoles(r, &this.missing, row);
            };
            solver.solve_rows(rows, phi)
        };
        whole(self, solver, phi)?;
        let mut scale = 0.0;
        for ((residual, face), y) in self.residual.iter_mut().zip(&self.faces).zip(&self.missing) {
            let jump = face.jump(phi);
            *residual = jump - face.resistance * y;
            scale += jump * jump / face.resistance + face.resistance * y * y;
        }
        let goal = EXACT * EXACT * scale;
        self.iterations = 0;
        if self.weighted_square() <= goal {
            return Ok(());
        }
        let m = self.faces.len();
        if let Some(inverse) = &self.inverse {
            let residual = &self.residual;
            self.change.par_iter_mut().zip(inverse.par_chunks_exact(m)).with_min_len(64).for_each(
                |(y, row)| {
                    *y = row.iter().zip(residual).map(|(a, b)| a * b).sum();
                },
            );
        } else if !self.iterate(solver, scale, phi)? {
            return Ok(());
        }
        self.missing.iter_mut().zip(&self.change).for_each(|(y, change)| *y += change);
        whole(self, solver, phi)
    }

    /// Σ r²(1 − open) g: the square of the residual in the norm of the preconditioner.
    fn weighted_square(&self) -> f64 {
        self.residual.iter().zip(&self.faces).map(|(r, face)| r * r / face.resistance).sum()
    }

    /// Conjugate gradients for M `change` = `residual`; is there a change?
    fn iterate<const D: usize>(
        &mut self,
        solver: &mut Pressure<D>,
        scale: f64,
        phi: &mut [f64],
    ) -> Result<bool, PoissonError> {
        let goal = TOLERANCE * TOLERANCE * scale;
        let mut square = self.weighted_square();
        if square <= goal {
            return Ok(false);
        }
        self.change.fill(0.0);
        self.start.copy_from_slice(&self.residual);
        if let Some(recent) = &self.recent {
            recent.start(&mut self.residual, &mut self.change);
            square = self.weighted_square();
        }
        for ((p, r), face) in self.direction.iter_mut().zip(&self.residual).zip(&self.faces) {
            *p = r / face.resistance;
        }
        let mut iterations = 0;
        while square > goal {
            if iterations == MOST {
                let residual = (square / scale).sqrt();
                return Err(PoissonError::NotConverged { iterations, residual, tolerance: TOLERANCE });
            }
            self.multiply(solver, phi)?;
            let curvature: f64 = self.direction.iter().zip(&self.product).map(|(p, q)| p * q).sum();
            let alpha = square / curvature;
            for (((y, r), p), q) in
                self.change.iter_mut().zip(&mut self.residual).zip(&self.direction).zip(&self.product)
            {
                *y += alpha * p;
                *r -= alpha * q;
            }
            let last = std::mem::replace(&mut square, self.weighted_square());
            let beta = square / last;
            for ((p, r), face) in self.direction.iter_mut().zip(&self.residual).zip(&self.faces) {
                *p = r / face.resistance + beta * *p;
            }
            iterations += 1;
        }
        self.iterations = iterations;
        if let Some(recent) = &mut self.recent {
            self.direction.copy_from_slice(&self.change);
            for ((product, start), rest) in self.product.iter_mut().zip(&self.start).zip(&self.residual) {
                *product = start - rest;
            }
            recent.learn(&mut self.direction, &mut self.product);
        }
        Ok(true)
    }

    /// Adds the dipoles of row `r`, of these strengths per face.
    fn add_dipoles(&self, r: usize, strengths: &[f64], row: &mut [f64]) {
        for &(i, face, weight) in &self.dipoles[self.row_starts[r]..self.row_starts[r + 1]] {
            row[i] += weight * strengths[face];
        }
    }

    /// Gives the cells of which no velocity is computed the mean pressure of their neighbours.
    pub(crate) fn smooth_orphans<const D: usize>(&self, pressure: &mut Field<D>) {
        let p = pressure.data_mut();
        for Orphan { cell, neighbours } in &self.orphans {
            p[*cell] = neighbours.iter().map(|&(at, weight)| weight * p[at]).sum();
        }
    }
}

impl Face {
    fn jump(&self, phi: &[f64]) -> f64 {
        phi[self.cells[1]] - phi[self.cells[0]]
    }
}
