//! Cells without fluid at their centre.
use super::CellTransport;
use super::near_solids::NearSolids;
use crate::kernels::copy_dense;
use crate::neighbours::{around, neighbour};
use crate::spans::Spans;
use crate::{CartesianGrid, Convection, Field, Sampler, Velocity};

/// A cell without fluid at its centre, and the weights of the cells around from which its value is taken.
pub(crate) type Dry = (usize, Vec<(usize, f64)>);

impl<const D: usize> CellTransport<D> {
    /// Takes these cells out of the equations: nothing passes between them and others. `forced`: a forcing makes the velocity beside them, which
    /// is not that of a layer on a wall.
    pub(crate) fn set_walls(&mut self, dry: Vec<Dry>, forced: bool) {
        self.forced = forced;
        self.span(&dry);
        let dry: Vec<Dry> = dry.into_iter().filter(|&(cell, _)| self.is_in_span(cell)).collect();
        let (grid, periodic) = (self.ops.grid(), self.ops.metrics().periodic);
        let (n, s, closed) = (grid.cells(), grid.stride(), &mut self.closed);
        closed.clear();
        // The lower face of a cell, at both ends of a periodic axis.
        let mut close = |a: usize, mut at: [usize; D]| {
            if periodic[a] {
                at[a] %= n[a];
            }
            closed.push((a, grid.place(at)));
            if periodic[a] && at[a] == 0 {
                closed.push((a, grid.place(at) + n[a] * s[a]));
            }
        };
        for &(cell, _) in &dry {
            for a in 0..D {
                let mut at = grid.cell(cell);
                close(a, at);
                at[a] += 1;
                close(a, at);
            }
        }
        let second_order = self.params.scheme != Convection::Upwind;
        self.near = (second_order && !dry.is_empty()).then(|| {
            let mut solid = vec![false; grid.n_cells()];
            dry.iter().for_each(|&(cell, _)| solid[cell] = true);
            let near = NearSolids::new(&self.ops, &solid);
            near.faces().for_each(|(a, above)| close(a, grid.cell(above)));
            near
        });
        if dry.is_empty() {
            self.carrier = None;
        }
        self.dry = dry;
    }

    /// Leaves alone what is far from fluid from now on.
    fn span(&mut self, dry: &[Dry]) {
        let grid = self.ops.grid();
        let mut solid = vec![false; grid.n_cells()];
        dry.iter().for_each(|&(cell, _)| solid[cell] = true);
        let spans = Spans::around(grid.cells(), self.ops.metrics().periodic, |cell| !solid[cell]);
        if spans == *self.ops.spans() {
            return;
        }
        self.matrix.set_spans(spans.clone());
        for list in [&mut self.b, &mut self.x] {
            list.fill(0.0);
        }
        self.units.fill(1.0);
        let whole = spans == Spans::default();
        self.ops.set_spans(spans);
        self.runs = (!whole).then(|| self.ops.cells().filter(|run| !run.is_empty()).collect());
    }

    fn is_in_span(&self, cell: usize) -> bool {
        self.ops.spans().contains(self.ops.grid().cells()[0], cell)
    }

    /// What `values` are, linear between the centres of cells with fluid, at the centres of the cells of another grid; in cells that
    /// are not beside one the value of the cell there.
    pub(crate) fn at_cells(&self, values: &[f64], to: &CartesianGrid<D>) -> Vec<f64> {
        let (grid, periodic) = (self.ops.grid(), self.ops.metrics().periodic);
        let mut field = Field::zeros(grid);
        copy_dense(grid, values, &mut field);
        let mut fluid: Vec<bool> = (0..grid.n_cells()).map(|cell| self.is_in_span(cell)).collect();
        self.dry.iter().for_each(|&(cell, _)| fluid[cell] = false);
        let known = |o: usize| grid.cell_at(o).is_some_and(|cell| fluid[grid.index(cell)]);
        let sampler = Sampler::on(grid, periodic);
        let value = |x: [f64; D]| {
            let in_fluid = sampler.known_value(&field, None, x, known);
            in_fluid.or_else(|| sampler.known_value(&field, None, x, |_| true)).unwrap_or_default()
        };
        (0..to.n_cells()).map(|cell| value(to.centre(to.cell(cell)))).collect()
    }

    /// Looks at k of all cells, where a model has it, and at how well cells resolve layers.
    pub(crate) fn see_layers(&mut self, k: Option<&[f64]>, viscosity: f64) {
        if let (Some(near), Some(k), false) = (&mut self.near, k, self.forced) {
            near.see_layers(k, viscosity);
        }
    }

    pub(crate) fn has_walls(&self) -> bool {
        !self.dry.is_empty()
    }

    /// The cells around cell `c`, those that share a corner with it.
    pub(crate) fn around(&self, c: usize) -> Vec<usize> {
        let mut found = Vec::with_capacity(26);
        for (cell, _) in around(&self.ops, c) {
            if !found.contains(&cell) {
                found.push(cell);
            }
        }
        found
    }

    /// Takes the velocity as it is where something passes: not through faces of cells without fluid, nor those that [`NearSolids`] has.
    pub(super) fn carry(&mut self, velocity: &Velocity<D>) {
        if self.dry.is_empty() {
            return;
        }
        let carrier = self.carrier.get_or_insert_with(|| Box::new(velocity.clone()));
        for (own, u) in carrier.components.iter_mut().zip(&velocity.components) {
            own.data_mut().copy_from_slice(u.data());
        }
        for &(a, o) in &self.closed {
            carrier.components[a].data_mut()[o] = 0.0;
        }
    }

    /// Closes the faces of cells without fluid.
    pub(super) fn shut(&mut self) {
        let (_, lower, upper) = self.matrix.parts_mut();
        for &(cell, _) in &self.dry {
            let at = self.ops.grid().cell(cell);
            for a in 0..D {
                if let Some(above) = neighbour(&self.ops, at, a, true) {
                    lower[a][above] = 0.0;
                }
                if let Some(below) = neighbour(&self.ops, at, a, false) {
                    upper[a][below] = 0.0;
                }
                (lower[a][cell], upper[a][cell]) = (0.0, 0.0);
            }
        }
    }

    /// Gives cells without fluid the values around them.
    pub(super) fn extend(&self, phi: &mut [f64]) {
        for (cell, from) in &self.dry {
            if !from.is_empty() {
                phi[*cell] = from.iter().map(|&(o, w)| w * phi[o]).sum();
            }
        }
    }
}
