//! The pressure equation of segregated algorithms.
use crate::boundary::{Boundaries, PressureFace};
use crate::grid::GHOSTS;
use crate::kernels::{self, Conductance, face_row, layers_per_task};
use crate::linear::StencilMatrix;
use crate::metrics::Metrics;
use crate::parts::each_part;
use crate::poisson::multigrid::{MultigridCg, MultigridParams};
use crate::poisson::{PoissonError, PoissonInfo};
use crate::pressure::PressureEnds;
use crate::{CartesianGrid, Field, FlowError};

/// Solves ∇·(β ∇φ) = ∇·u for the correction u ← u − β ∇φ, with β \[s\] on the faces: what a component answers to a
/// kinematic pressure gradient.
pub(crate) struct PressureCorrection<const D: usize> {
    grid: CartesianGrid<D>,
    metrics: Metrics<D>,
    solver: MultigridCg<D>,
    /// On the n + 1 faces along the component's axis, x fastest.
    beta: [Vec<f64>; D],
    /// φ \[m²/s²\], dense.
    pub(crate) phi: Vec<f64>,
    /// ∇·u, dense.
    divergence: Vec<f64>,
    /// β of faces of a box one cell wide.
    single: f64,
    /// At the faces of given pressure, in the order of the sides.
    given: Vec<Given>,
}

/// A face on which φ is given.
struct Given {
    /// Dense number of the cell before it.
    cell: usize,
    /// 2β/width of the cell.
    conductance: f64,
}

impl<const D: usize> PressureCorrection<D> {
    pub(crate) fn new(
        grid: &CartesianGrid<D>,
        metrics: &Metrics<D>,
        boundaries: &Boundaries<D>,
        tolerance: f64,
        max_iterations: usize,
    ) -> Result<Self, FlowError> {
        let ends = PressureEnds::new(grid, boundaries);
        let params = MultigridParams { tolerance, max_iterations, variable: true, ..Default::default() };
        let solver = ends.multigrid(params)?;
        let cells = grid.cells();
        let beta = std::array::from_fn(|a| vec![0.0; grid.n_cells() / cells[a] * (cells[a] + 1)]);
        let (phi, divergence) = (vec![0.0; grid.n_cells()], vec![0.0; grid.n_cells()]);
        Ok(Self {
            grid: grid.clone(),
            metrics: metrics.clone(),
            solver,
            beta,
            phi,
            divergence,
            single: 0.0,
            given: Vec::new(),
        })
    }

    /// Takes β of component `c` from its matrix: 1/A_PP, or 1/(A_PP + Σ_N A_PN) (Van Doormaal & Raithby 1984) if
    /// `consistent`, at most 1/(`consistent` A_PP). `single` is β in a box one cell wide.
    pub(crate) fn set(&mut self, c: usize, matrix: &StencilMatrix<D>, consistent: Option<f64>, single: f64) {
        let (n, rows) = (self.grid.cells(), self.grid.rows_per_layer());
        let per_task = layers_per_task(n[D - 1]);
        let layer = face_layer(&self.grid, c);
        let grid = &self.grid;
        self.single = single;
        each_part(&mut self.beta[c], layer * per_task, &|task, out| {
            let first = task * per_task;
            for r in first * rows..(first + per_task).min(n[D - 1]) * rows {
                let (span, out) = (matrix.span(r), &mut out[face_row(grid, c, r) - first * layer..][..n[0]]);
                let (o, m) = (r * n[0] + span.start, span.len());
                out[..span.start].fill(0.0);
                out[span.end..].fill(0.0);
                let out = &mut out[span];
                let centre = &matrix.centre()[o..][..m];
                out.copy_from_slice(centre);
                if let Some(part) = consistent {
                    for b in 0..D {
                        let (l, u) = (&matrix.lower(b)[o..][..m], &matrix.upper(b)[o..][..m]);
                        for i in 0..m {
                            out[i] += l[i] + u[i];
                        }
                    }
                    out.iter_mut().zip(centre).for_each(|(x, centre)| *x = x.max(part * centre));
                }
                out.iter_mut().for_each(|x| *x = 1.0 / *x);
            }
        });
    }

    /// Faces on bounded sides take β of the next ones.
    fn close(&mut self, c: usize) {
        let (n, single) = (self.grid.cells(), self.single);
        let inner: usize = n[..c].iter().product();
        for block in self.beta[c].chunks_exact_mut(inner * (n[c] + 1)) {
            for k in 0..inner {
                let (first, last) = (k, n[c] * inner + k);
                if n[c] == 1 {
                    (block[first], block[last]) = (single, single);
                } else {
                    (block[first], block[last]) = (block[first + inner], block[last - inner]);
                }
            }
        }
    }

    /// Lets the velocity on one face be: β = 0; `cell` is the dense one above it along `c`.
    pub(crate) fn freeze(&mut self, c: usize, cell: usize) {
        let n = self.grid.cells()[0];
        let face = face_row(&self.grid, c, cell / n) + cell % n;
        self.beta[c][face] = 0.0;
    }

    /// Leaves a share of β on one face, of which only that is open; `cell` is the dense one above it along `c`.
    pub(crate) fn narrow(&mut self, c: usize, cell: usize, open: f64) {
        let n = self.grid.cells()[0];
        let face = face_row(&self.grid, c, cell / n) + cell % n;
        self.beta[c][face] *= open;
    }

    /// Passes β to the solver. On faces of given pressure, where φ = 0, it is the response of their momentum to a pressure, also where immersed walls cut them: the
    /// open share of it would not converge beside slivers.
    pub(crate) fn update(&mut self, boundaries: &mut Boundaries<D>) -> Result<(), FlowError> {
        for c in 0..D {
            if !self.metrics.periodic[c] {
                self.close(c);
            }
        }
        let (grid, beta) = (&self.grid, &mut self.beta);
        boundaries.each_pressure_face(|face, _| {
            let PressureFace { axis, upper, cell, rate, .. } = face;
            if rate > 0.0 {
                beta[axis][end_face(grid, axis, cell, upper)] = 1.0 / rate;
            }
        });
        let beta = self.beta.each_ref().map(|b| Some(b.as_slice()));
        Ok(self.solver.multigrid().set_coefficients(beta)?)
    }

    fn write_divergence(&mut self, velocity: &[Field<D>; D]) {
        let (grid, metrics, n) = (&self.grid, &self.metrics, self.grid.cells()[0]);
        let rows = rows_per_task(grid.n_cells() / n);
        each_part(&mut self.divergence, n * rows, &|task, out| {
            for (k, row) in out.chunks_exact_mut(n).enumerate() {
                kernels::divergence_row(grid, metrics, task * rows + k, velocity, 1.0, row);
            }
        });
    }

    /// Drops the divergence of cells none of whose faces answers.
    pub(crate) fn skip_frozen(&mut self) {
        let (n, inner) = (self.grid.cells(), |c: usize| -> usize { self.grid.cells()[..c].iter().product() });
        for (cell, divergence) in self.divergence.iter_mut().enumerate() {
            let frozen = (0..D).all(|c| {
                let low = face_row(&self.grid, c, cell / n[0]) + cell % n[0];
                let i = cell / inner(c) % n[c];
                let high = if self.metrics.periodic[c] && i + 1 == n[c] {
                    low - (n[c] - 1) * inner(c)
                } else {
                    low + inner(c)
                };
                self.beta[c][low] == 0.0 && self.beta[c][high] == 0.0
            });
            if frozen {
                *divergence = 0.0;
            }
        }
    }

    /// Measures the divergence of the velocity; returns Σ |∇·u| V.
    pub(crate) fn measure(&mut self, boundaries: &mut Boundaries<D>, velocity: &[Field<D>; D]) -> f64 {
        self.write_divergence(velocity);
        self.given.clear();
        let (given, n) = (&mut self.given, self.grid.cells());
        let (metrics, beta, grid) = (&self.metrics, &self.beta, &self.grid);
        boundaries.each_pressure_face(|face, _| {
            let PressureFace { axis, upper, cell, .. } = face;
            let width = metrics.axes[axis].width[GHOSTS + if upper { n[axis] - 1 } else { 0 }];
            let beta = beta[axis][end_face(grid, axis, cell, upper)];
            given.push(Given { cell, conductance: 2.0 * beta / width });
        });
        crate::momentum_matrix::absolute_sum(grid, metrics, None, &self.divergence)
    }

    /// Solves for φ with the divergence measured, from zero. Running out of iterations is an error only if `strict`.
    pub(crate) fn solve(&mut self, strict: bool) -> Result<PoissonInfo, PoissonError> {
        let (n, f) = (self.grid.cells()[0], &self.divergence);
        let fill = |r: usize, row: &mut [f64]| row.copy_from_slice(&f[r * n..][..n]);
        match self.solver.solve_rows(fill, &mut self.phi, false) {
            Err(PoissonError::NotConverged { iterations, residual, .. }) if !strict && residual < 1.0 => {
                Ok(PoissonInfo { iterations, residual, ..Default::default() })
            }
            other => other,
        }
    }

    /// φ ← `gain` (φ − (`viscosity` + `eddy`) ∇·u), with the divergence measured last; before faces of given pressure φ
    /// alone.
    pub(crate) fn scale(&mut self, gain: f64, viscosity: f64, eddy: Option<&Field<D>>) {
        let n = self.grid.cells()[0];
        for g in &self.given {
            self.divergence[g.cell] = 0.0;
        }
        let rows = self.phi.chunks_exact_mut(n).zip(self.divergence.chunks_exact(n));
        for (r, (phi, divergence)) in rows.enumerate() {
            for (phi, divergence) in phi.iter_mut().zip(divergence) {
                *phi = gain * (*phi - viscosity * divergence);
            }
            let Some(eddy) = eddy else { continue };
            for ((phi, divergence), eddy) in phi.iter_mut().zip(divergence).zip(eddy.row(r)) {
                *phi -= gain * eddy * divergence;
            }
        }
    }

    /// u ← u − β ∇φ, sides included.
    pub(crate) fn correct(&self, boundaries: &mut Boundaries<D>, velocity: &mut [Field<D>; D]) {
        for (c, component) in velocity.iter_mut().enumerate() {
            let beta = Conductance::Faces(&self.beta[c]);
            kernels::correct_component(&self.grid, &self.metrics, c, beta, &self.phi, component);
        }
        let mut given = self.given.iter();
        boundaries.each_pressure_face(|face, normal| {
            let Some(g) = given.next() else { return };
            let sign = if face.upper { 1.0 } else { -1.0 };
            *normal += sign * g.conductance * self.phi[g.cell];
        });
    }
}

/// Place of the face below or above a dense cell among the faces of component `c`.
fn end_face<const D: usize>(grid: &CartesianGrid<D>, c: usize, cell: usize, upper: bool) -> usize {
    let n = grid.cells();
    let low = face_row(grid, c, cell / n[0]) + cell % n[0];
    if upper { low + n[..c].iter().product::<usize>() } else { low }
}

/// Rows that one task works on.
fn rows_per_task(rows: usize) -> usize {
    rows.div_ceil(16).max(4)
}

/// Faces of component `c` in one layer of the last axis.
fn face_layer<const D: usize>(grid: &CartesianGrid<D>, c: usize) -> usize {
    let n = grid.cells();
    let mut faces = n;
    faces[c] += 1;
    faces[..D - 1].iter().product()
}
