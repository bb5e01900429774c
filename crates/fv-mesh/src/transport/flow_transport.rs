//! What a closure sees.
use super::kernels::DotGradients;
use super::{CellTransport, check_length};
use crate::Velocity;
use crate::kernels::copy_dense;
use crate::operators::fill_dense;
use interfaces::{Equation, LogSlope, SolveError, SolveInfo, Transport};
use std::ops::Range;

/// A [`CellTransport`] on a velocity: what a closure sees.
#[derive(Debug)]
pub struct FlowTransport<'a, const D: usize> {
    pub(super) cells: &'a mut CellTransport<D>,
    pub(super) velocity: &'a Velocity<D>,
}

impl<const D: usize> Transport for FlowTransport<'_, D> {
    fn n_cells(&self) -> usize {
        self.cells.volume.len()
    }
    fn cell_volume(&self, c: usize) -> f64 {
        self.cells.volume[c]
    }
    fn runs(&self) -> Option<&[Range<usize>]> {
        self.cells.runs.as_deref()
    }
    fn wall_distance(&self) -> &[f64] {
        &self.cells.wall_distance
    }
    fn strain_rate(&mut self, out: &mut [f64]) -> Result<(), SolveError> {
        check_length("the strain rate", self.n_cells(), out.len())?;
        let ops = &self.cells.ops;
        fill_dense(ops.grid(), ops.spans(), &ops.strain_kernel(&self.velocity.components), out);
        Ok(())
    }
    fn log_slopes(&mut self) -> &[LogSlope] {
        let CellTransport { near, ops, wall_distance, forced, .. } = &mut *self.cells;
        near.as_mut()
            .filter(|_| !*forced)
            .map_or(&[], |near| near.log_slopes(ops.grid(), self.velocity, wall_distance))
    }
    fn velocity_gradient(&mut self, out: &mut [[[f64; 3]; 3]]) -> Result<(), SolveError> {
        check_length("the velocity gradient", self.n_cells(), out.len())?;
        out.fill([[0.0; 3]; 3]);
        let CellTransport { ops, fields: [field, ..], .. } = &mut *self.cells;
        for (a, b) in (0..D).flat_map(|a| (0..D).map(move |b| (a, b))) {
            let made = ops.velocity_gradient(self.velocity, [a, b], field);
            made.map_err(|e| SolveError::Solver(e.to_string()))?;
            out.iter_mut().zip(field.values()).for_each(|(out, slope)| out[a][b] = slope);
        }
        Ok(())
    }
    fn dot_gradients(&mut self, a: &[f64], b: &[f64], out: &mut [f64]) -> Result<(), SolveError> {
        for (what, list) in [("a", a), ("b", b), ("∇a·∇b", &*out)] {
            check_length(what, self.n_cells(), list.len())?;
        }
        let CellTransport { ops, sides, fields: [first, second, ..], .. } = &mut *self.cells;
        let grid = ops.grid();
        for (dense, field) in [(a, &mut *first), (b, &mut *second)] {
            copy_dense(grid, dense, field);
            sides.extrapolate(field);
        }
        let kernel = DotGradients { grid, centred: ops.centred(), a: first.data(), b: second.data() };
        fill_dense(grid, ops.spans(), &kernel, out);
        Ok(())
    }
    fn solve(&mut self, equation: &Equation<'_>, phi: &mut [f64]) -> Result<SolveInfo, SolveError> {
        self.cells.solve(self.velocity, equation, phi)
    }
}
