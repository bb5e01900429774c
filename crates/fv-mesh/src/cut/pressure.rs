//! The pressure equation of cells that walls cut.
use super::cell;
use crate::grid::GHOSTS;
use crate::metrics::Metrics;
use crate::poisson::PoissonError;
use crate::pressure::Pressure;
use crate::{CartesianGrid, Field, FlowError};
use faer::linalg::solvers::DenseSolveCore;
use faer::{Mat, Side};
use interfaces::CutWalls;
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap, HashSet};

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
/// gradients from the last y, one of the box's each.
///
/// Regions that the walls separate (the inside of a body, a closed pocket of fluid) hang on one closed face each, through
/// which nothing flows as long as what enters the region leaves it.
pub(crate) struct CutPressure {
    faces: Vec<Face>,
    /// Sources of the faces' dipoles, row after row: cell in the row, face, 1/V with its sign.
    dipoles: Vec<(usize, usize, f64)>,
    /// Where each row's dipoles begin.
    row_starts: Vec<usize>,
    method: Method,
    /// y.
    pub(crate) missing: Vec<f64>,
    /// B L⁻¹ f + B L⁻¹ G y − y/((1 − open) g).
    residual: Vec<f64>,
    /// Correction of y, and the directions and products of conjugate gradients.
    change: Vec<f64>,
    direction: Vec<f64>,
    product: Vec<f64>,
    /// Of conjugate gradients in the last solution.
    pub(crate) iterations: usize,
    /// Cells of which no velocity is computed, in order: their storage index and the neighbours' with weights.
    orphans: Vec<(usize, Vec<(usize, f64)>)>,
}

/// How M y = b is solved.
enum Method {
    /// Not known yet.
    Unprepared,
    /// M⁻¹, row after row.
    Inverse(Vec<f64>),
    /// Conjugate gradients with the diagonal 1/((1 − open) g) as preconditioner.
    Iterative,
}

/// M⁻¹ is kept if it has at most so many entries per cell of the grid: its product then costs less than a few of the box's
/// solutions.
const DENSE: usize = 40;

/// Residuals of M y = b, over |B φ|, below which y is good …
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
    pub(crate) fn new<const D: usize>(
        cuts: &CutWalls,
        grid: &CartesianGrid<D>,
        metrics: &Metrics<D>,
    ) -> Self {
        let n = grid.cells();
        let volume = |index: usize| grid.cell_volume(grid.cell(index));
        let mut cut = Vec::new();
        // Closed faces of every cell.
        let mut closed = vec![0; grid.n_cells()];
        for (c, component) in cuts.components.iter().enumerate().take(D) {
            for face in &component.faces {
                let above = cell(grid, face.index);
                let mut below = above;
                below[c] = if above[c] == 0 { n[c] - 1 } else { above[c] - 1 };
                let area: f64 =
                    (0..D).filter(|&a| a != c).map(|a| metrics.axes[a].width[GHOSTS + above[a]]).product();
                let cells = [grid.index(below), grid.index(above)];
                if face.open == 0.0 {
                    cells.iter().for_each(|&cell| closed[cell] += 1);
                }
                cut.push(Cut {
                    axis: c,
                    cells,
                    open: face.open,
                    conductance: area / metrics.axes[c].faces.volume[GHOSTS + above[c]],
                });
            }
        }
        let inner_faces = |index: usize| -> usize {
            let cell = grid.cell(index);
            let sides = |a: usize| usize::from(cell[a] == 0) + usize::from(cell[a] + 1 == n[a]);
            (0..D).map(|a| 2 - if metrics.periodic[a] { 0 } else { sides(a) }).sum()
        };
        let solid = |index: usize| closed[index] > 0 && closed[index] == inner_faces(index);
        let orphans = orphans(cuts, grid, metrics, &mut cut);
        cut.retain(|face| !face.cells.iter().all(|&cell| solid(cell)));
        hang_regions(&mut cut, grid, metrics);
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
            method: Method::Unprepared,
            residual: vec![0.0; m],
            change: vec![0.0; m],
            direction: vec![0.0; m],
            product: vec![0.0; m],
            missing: vec![0.0; m],
            iterations: 0,
            orphans,
        }
    }

    /// Makes what solutions need, with the box's solver; `phi` is scratch.
    ///
    /// # Errors
    /// Those of the solver; [`FlowError::Walls`] if the matrix is not positive definite.
    pub(crate) fn prepare<const D: usize>(
        &mut self,
        solver: &mut Pressure<D>,
        phi: &mut [f64],
    ) -> Result<(), FlowError> {
        let m = self.faces.len();
        match self.method {
            Method::Unprepared if m * m > DENSE * phi.len() => self.method = Method::Iterative,
            Method::Unprepared => {}
            _ => return Ok(()),
        }
        if matches!(self.method, Method::Iterative) {
            return Ok(());
        }
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
        self.method = Method::Inverse((0..m * m).map(|k| inverse[(k / m, k % m)]).collect());
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
            scale += jump * jump / face.resistance;
        }
        let goal = EXACT * EXACT * scale;
        self.iterations = 0;
        if self.weighted_square() <= goal {
            return Ok(());
        }
        let m = self.faces.len();
        if let Method::Inverse(inverse) = &self.method {
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
        for (cell, neighbours) in &self.orphans {
            p[*cell] = neighbours.iter().map(|&(at, weight)| weight * p[at]).sum();
        }
    }
}

impl Face {
    fn jump(&self, phi: &[f64]) -> f64 {
        phi[self.cells[1]] - phi[self.cells[0]]
    }
}

/// A face that is not wholly open.
struct Cut {
    axis: usize,
    /// Dense numbers of the cells below and above.
    cells: [usize; 2],
    open: f64,
    /// Its area over the distance of the cells' centres.
    conductance: f64,
}

/// The cells with no velocity node in the fluid, and where their pressure comes from. What passes through them passes on to
/// neighbours in the same step, however narrow their openings are: those are widened until the widest of a cell is a whole face.
fn orphans<const D: usize>(
    cuts: &CutWalls,
    grid: &CartesianGrid<D>,
    metrics: &Metrics<D>,
    cut: &mut Vec<Cut>,
) -> Vec<(usize, Vec<(usize, f64)>)> {
    let solid: [HashSet<usize>; D] =
        std::array::from_fn(|c| cuts.components[c].solid.iter().map(|point| point.index).collect());
    let (n, stride) = (grid.cells(), grid.stride());
    let place = |index: usize| {
        let cell = grid.cell(index);
        grid.base() + (0..D).map(|a| cell[a] * stride[a]).sum::<usize>()
    };
    let orphan = |index: usize| {
        let (cell, at) = (grid.cell(index), place(index));
        (0..D).all(|a| {
            let upper = if metrics.periodic[a] && cell[a] + 1 == n[a] {
                at + stride[a] - n[a] * stride[a]
            } else {
                at + stride[a]
            };
            let bounded = |end: usize| !metrics.periodic[a] && cell[a] == end;
            (bounded(0) || solid[a].contains(&at)) && (bounded(n[a] - 1) || solid[a].contains(&upper))
        })
    };
    let mut sources: BTreeMap<usize, Vec<(usize, f64)>> = BTreeMap::new();
    for face in cut.iter().filter(|face| face.open > 0.0) {
        for [cell, neighbour] in [face.cells, [face.cells[1], face.cells[0]]] {
            if orphan(cell) {
                sources.entry(cell).or_default().push((place(neighbour), face.open * face.conductance));
            }
        }
    }
    let mut widest: HashMap<usize, f64> = HashMap::new();
    for face in cut.iter() {
        for cell in face.cells.iter().filter(|cell| sources.contains_key(cell)) {
            let widest = widest.entry(*cell).or_default();
            *widest = widest.max(face.open);
        }
    }
    for face in cut.iter_mut() {
        let factor = |cell: &usize| widest.get(cell).map_or(1.0, |widest| 1.0 / widest);
        face.open *= face.cells.iter().map(factor).fold(1.0, f64::max);
    }
    cut.retain(|face| face.open < 1.0);
    let mean = |(cell, mut neighbours): (usize, Vec<(usize, f64)>)| {
        let sum: f64 = neighbours.iter().map(|n| n.1).sum();
        neighbours.iter_mut().for_each(|n| n.1 /= sum);
        (place(cell), neighbours)
    };
    sources.into_iter().map(mean).collect()
}

/// Opens one closed face per region that the walls separate from the rest.
fn hang_regions<const D: usize>(cut: &mut Vec<Cut>, grid: &CartesianGrid<D>, metrics: &Metrics<D>) {
    let n = grid.cells();
    let mut regions = Regions((0..grid.n_cells()).collect());
    let closed: HashSet<(usize, usize)> =
        cut.iter().filter(|face| face.open == 0.0).map(|face| (face.axis, face.cells[1])).collect();
    for above in 0..grid.n_cells() {
        let cell = grid.cell(above);
        for a in 0..D {
            let mut below = cell;
            below[a] = match (cell[a], metrics.periodic[a]) {
                (0, false) => continue,
                (0, true) => n[a] - 1,
                (i, _) => i - 1,
            };
            if !closed.contains(&(a, above)) {
                regions.join(grid.index(below), above);
            }
        }
    }
    cut.retain(|face| face.open > 0.0 || !regions.join(face.cells[0], face.cells[1]));
}

/// Disjoint sets of cells.
struct Regions(Vec<usize>);

impl Regions {
    fn find(&mut self, mut i: usize) -> usize {
        while self.0[i] != i {
            self.0[i] = self.0[self.0[i]];
            i = self.0[i];
        }
        i
    }
    /// Makes one set of two; were they two?
    fn join(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b)] = a.min(b);
        a != b
    }
}
