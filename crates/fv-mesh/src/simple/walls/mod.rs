//! Immersed walls in the steady algorithm: conservative balances over what they leave of the control volumes.
mod beside;
mod edges;
mod gradients;
mod layers;
mod nearest;
mod openings;
mod rows;
mod stress;

pub use stress::WallStress;

use crate::across_stream::Stream;
use crate::field::row_start;
use crate::linear::StencilMatrix;
use crate::metrics::Metrics;
use crate::momentum_matrix::MomentumEquations;
use crate::simple::PressureCorrection;
use crate::spans::Spans;
use crate::transport::Dry;
use crate::{CartesianGrid, Convection, Field, FlowError};
use beside::{Beside, Ghost};
use gradients::Gradients;
use interfaces::{CutCells, Vector, WallRow, Wrench};
use layers::Layers;
use nearest::nearest_pieces;
use openings::{LAYERS, Openings};
use rows::{Flow, Row};
use std::collections::HashSet;
use stress::Stresses;

/// Walls in a steady flow.
pub(crate) struct SimpleWalls<const D: usize> {
    rows: [Vec<Row<D>>; D],
    gradients: [Gradients<D>; D],
    stresses: Stresses<D>,
    /// Dense numbers of the nodes in `spans` that no fluid passes.
    pub(super) shut: [Vec<usize>; D],
    /// Faces with a part that is open: storage index, dense number of the cell above and share.
    partly: [Vec<(usize, usize, f64)>; D],
    /// The same on the sides of the box, and where a periodic axis ends: storage index and share.
    sides: [Vec<(usize, f64)>; D],
    /// Cells without fluid at their centre, and the weights of those around from which their ν_t is taken.
    dry: Vec<(usize, Vec<(usize, f64)>)>,
    /// Those of them that a wall cuts: the cell, its piece of wall, and how little of its ν_t is left in a logarithmic layer.
    calm: Vec<(usize, usize, f64)>,
    /// Their ghosts beyond sides of the box: ghost and cell.
    beyond: Vec<(usize, usize)>,
    /// The cells that wall functions see.
    beside: Beside,
    /// Nodes in the solid beside nodes in the fluid.
    ghosts: [Vec<Ghost<D>>; D],
    sums: Vec<f64>,
    rates: Vec<f64>,
    /// At the nodes of one component that have a gradient.
    streams: Vec<Stream<D>>,
    layers: Layers,
    n_bodies: usize,
    /// Of cells with fluid and their neighbours.
    pub(super) spans: Spans,
}

/// What changes from iteration to iteration.
#[derive(Clone, Copy)]
pub(crate) struct Iteration<'a, const D: usize> {
    pub(crate) grid: &'a CartesianGrid<D>,
    pub(crate) metrics: &'a Metrics<D>,
    pub(crate) velocity: &'a [Field<D>; D],
    pub(crate) pressure: &'a Field<D>,
    pub(crate) eddy: Option<&'a Field<D>>,
    pub(crate) scheme: Convection,
    pub(crate) viscosity: f64,
    pub(crate) density: f64,
    pub(crate) force: f64,
    pub(crate) source: Option<&'a Field<D>>,
    pub(crate) relaxation: f64,
    pub(crate) viscous_share: f64,
}

impl<const D: usize> SimpleWalls<D> {
    /// # Errors
    /// Those of the openings and of the law.
    pub(super) fn new(
        cuts: &CutCells,
        law: WallStress,
        grid: &CartesianGrid<D>,
        metrics: &Metrics<D>,
        outlets: &HashSet<(usize, usize)>,
    ) -> Result<Self, FlowError> {
        law.check()?;
        let openings = Openings::new(cuts, grid, metrics, outlets, matches!(law, WallStress::Law { .. }))?;
        let spans = openings.spans();
        // Cells of rows and those beside them.
        let nearest = nearest_pieces(&openings, LAYERS + 1);
        let mut gradients = std::array::from_fn(|_| Gradients::default());
        let (mut shut, mut partly) =
            (std::array::from_fn(|_| Vec::new()), std::array::from_fn(|_| Vec::new()));
        let mut rows = std::array::from_fn(|_| Vec::new());
        let mut sides = std::array::from_fn(|_| Vec::new());
        for c in 0..D {
            for face in cuts.faces[c].iter().filter(|face| {
                face.open > 0.0
                    && grid.cell_at(face.index).is_none_or(|cell| !metrics.periodic[c] && cell[c] == 0)
            }) {
                // On the sides of the box.
                let open = openings.open[c].data()[face.index];
                sides[c].push((face.index, open));
            }
            for cell in spans.rows(grid.cells()[0], grid.n_cells() / grid.cells()[0]).flatten() {
                let index = grid.place(grid.cell(cell));
                if !metrics.periodic[c] && grid.cell(cell)[c] == 0 {
                    continue;
                }
                let open = openings.open[c].data()[index];
                if open == 0.0 {
                    shut[c].push(cell);
                    continue;
                }
                if open < 1.0 {
                    partly[c].push((index, cell, open));
                    if grid.cell(cell)[c] == 0 {
                        // The same face at the other end.
                        sides[c].push((index + grid.cells()[c] * grid.stride()[c], open));
                    }
                }
                rows[c].extend(Row::new(&openings, c, index, &nearest, law.nearest(), &mut gradients));
            }
        }
        let stresses = Stresses::new(&openings, law, &rows);
        let layers = Layers::new(&openings, &stresses);
        let beside = Beside::new(&openings);
        let ghosts = std::array::from_fn(|c| beside::ghosts(&openings, c, law.nearest(), &mut gradients[c]));
        let n_bodies = cuts.walls.iter().map(|w| w.body + 1).max().unwrap_or(0);
        let longest = rows.iter().map(Vec::len).max().unwrap_or(0);
        Ok(Self {
            dry: dry(&openings),
            calm: calm(&openings),
            beyond: beyond(&openings),
            beside,
            ghosts,
            sums: vec![0.0; longest],
            rates: vec![0.0; longest],
            streams: Vec::new(),
            layers,
            rows,
            gradients,
            stresses,
            shut,
            partly,
            sides,
            n_bodies,
            spans,
        })
    }

    /// Looks at the flow before an iteration.
    pub(super) fn update(&mut self, velocity: &[Field<D>; D], k: Option<&Field<D>>, viscosity: f64) {
        self.stresses.update(velocity, k, viscosity);
        for (c, (gradients, u)) in self.gradients.iter_mut().zip(velocity).enumerate() {
            gradients.update(u, |piece| self.stresses.at_wall(piece, c, viscosity));
        }
        self.layers.update(velocity, &self.stresses, viscosity);
    }

    /// Puts the rows beside walls into the equation of component `c`. `terms` gets the sizes of the terms of rows that are
    /// not what was measured before.
    pub(super) fn assemble(
        &mut self,
        c: usize,
        it: Iteration<D>,
        equations: &mut MomentumEquations<D>,
        matrix: &mut StencilMatrix<D>,
        terms: &mut f64,
    ) {
        let rows = &self.rows[c];
        let u = it.velocity[c].data();
        let streams = (it.scheme.is_linear_upwind() && self.layers.any()).then(|| {
            self.streams.clear();
            self.streams.resize(self.gradients[c].values.len(), Stream::new([0.0; D], 0.0));
            for row in rows {
                row.see_stream(c, it.velocity, &self.gradients[c], &self.layers.resolved, &mut self.streams);
            }
            self.streams.as_slice()
        });
        let flow = Flow {
            grid: it.grid,
            metrics: it.metrics,
            velocity: it.velocity,
            eddy: it.eddy,
            scheme: it.scheme,
            viscosity: it.viscosity,
            equations,
            gradients: &self.gradients,
            streams,
        };
        for ((sum, rate), row) in self.sums.iter_mut().zip(&mut self.rates).zip(rows) {
            [*sum, *rate] = row.write(c, &flow, it.viscous_share, matrix);
        }
        self.stresses.add(c, rows, u, it.viscosity, &mut self.sums, matrix);
        let (s, p) = (it.grid.stride()[c], it.pressure.data());
        let faces = &it.metrics.axes[c].faces;
        let slope = |index: usize| {
            let at = openings::coordinates(it.grid, index)[c];
            faces.inv_volume[at] * (p[index] - p[index - s]) / it.density
        };
        let volume = |index: usize| -> f64 {
            let at = openings::coordinates(it.grid, index);
            (0..D).map(|a| it.metrics.of(Some(c), a).volume[at[a]]).product()
        };
        for &cell in &self.shut[c] {
            let index = it.grid.place(it.grid.cell(cell));
            *terms -= volume(index) * (equations.tendency(index).abs() + slope(index).abs() + it.force.abs());
        }
        let centre = matrix.parts_mut().0;
        // Whatever the rows of the solid are, they can be solved.
        self.shut[c].iter().for_each(|&cell| centre[cell] = 1.0);
        for ((sum, rate), row) in self.sums.iter().zip(&self.rates).zip(rows) {
            *terms += volume(row.index) * (sum.abs() - equations.tendency(row.index).abs());
            let source = it.source.map_or(0.0, |source| source.data()[row.index]);
            equations.rhs[row.cell] = sum - slope(row.index) + it.force + source;
            centre[row.cell] += (1.0 / it.relaxation - 1.0) * rate;
        }
    }

    /// Leaves of the conductances of the faces what is open.
    pub(super) fn narrow(&self, c: usize, correction: &mut PressureCorrection<D>) {
        for &(_, cell, open) in &self.partly[c] {
            correction.narrow(c, cell, open);
        }
        for &cell in &self.shut[c] {
            correction.narrow(c, cell, 0.0);
        }
    }

    /// Gives the faces the mean velocity over the whole of them.
    pub(super) fn show_fluxes(&self, velocity: &mut [Field<D>; D]) {
        for ((list, sides), u) in self.partly.iter().zip(&self.sides).zip(velocity) {
            list.iter().for_each(|&(index, _, open)| u.data_mut()[index] *= open);
            sides.iter().for_each(|&(index, open)| u.data_mut()[index] *= open);
        }
    }

    /// Gives the faces the velocity in their open part again.
    pub(super) fn show_nodes(&self, velocity: &mut [Field<D>; D]) {
        for ((list, sides), u) in self.partly.iter().zip(&self.sides).zip(velocity) {
            list.iter().for_each(|&(index, _, open)| u.data_mut()[index] /= open);
            sides.iter().for_each(|&(index, open)| u.data_mut()[index] /= open);
        }
    }

    /// The cells without fluid at their centre, by dense numbers.
    pub(super) fn dry_cells(&self, grid: &CartesianGrid<D>) -> Vec<Dry> {
        let dense = |o: usize| grid.cell_at(o).map(|cell| grid.index(cell));
        let list = |from: &[(usize, f64)]| from.iter().filter_map(|&(o, w)| Some((dense(o)?, w))).collect();
        self.dry.iter().filter_map(|(cell, from)| Some((dense(*cell)?, list(from)))).collect()
    }

    /// The nodes of component `c` that fluid passes, by dense numbers.
    pub(super) fn open_nodes(&self, grid: &CartesianGrid<D>, c: usize) -> Vec<bool> {
        let n = grid.cells()[0];
        let mut open: Vec<bool> = (0..grid.n_cells()).map(|cell| self.spans.contains(n, cell)).collect();
        self.shut[c].iter().for_each(|&cell| open[cell] = false);
        open
    }

    /// Fills the rows of wall functions.
    pub(super) fn fill_rows(&mut self, viscosity: f64) {
        self.beside.fill(&self.stresses, viscosity);
    }

    pub(super) fn wall_rows(&self) -> &[WallRow] {
        &self.beside.rows
    }

    /// Lets the velocity go on smoothly into the solid, for gradients beside it.
    pub(super) fn reach_in(&self, velocity: &mut [Field<D>; D]) {
        for (c, u) in velocity.iter_mut().enumerate() {
            let data = u.data_mut();
            for ghost in &self.ghosts[c] {
                let there = |&(o, slot, step): &(usize, u32, [f64; D])| {
                    let gradient = &self.gradients[c].values[slot as usize];
                    data[o] + gradients::dot(gradient, &step)
                };
                data[ghost.node] = ghost.from.iter().map(there).sum::<f64>() / ghost.from.len() as f64;
            }
        }
    }

    /// Takes back what [`reach_in`](Self::reach_in) did.
    pub(super) fn draw_back(&self, velocity: &mut [Field<D>; D]) {
        for (ghosts, u) in self.ghosts.iter().zip(velocity) {
            ghosts.iter().for_each(|ghost| u.data_mut()[ghost.node] = 0.0);
        }
    }

    /// Stops what is in the solid.
    pub(super) fn stop(&self, grid: &CartesianGrid<D>, velocity: &mut [Field<D>; D]) {
        let n = grid.cells()[0];
        for (list, u) in self.shut.iter().zip(velocity) {
            let u = u.data_mut();
            list.iter().for_each(|&cell| u[grid.place(grid.cell(cell))] = 0.0);
            for r in 0..grid.n_cells() / n {
                let (o, span) = (row_start(grid, r), self.spans.of(r, n));
                u[o..o + span.start].fill(0.0);
                u[o + span.end..o + n].fill(0.0);
            }
        }
    }

    /// Gives cells in the solid the ν_t around them, and less of it where a wall leaves them a part in a logarithmic layer: half way to the
    /// next centre it is then about that of the law. Slivers go along with the fluid beside them.
    pub(super) fn extend(&mut self, eddy: &mut Field<D>, k: Option<&Field<D>>, viscosity: f64) {
        self.stresses.see(k);
        let data = eddy.data_mut();
        for (cell, from) in self.dry.iter().filter(|(_, from)| !from.is_empty()) {
            data[*cell] = from.iter().map(|&(o, w)| w * data[o]).sum();
        }
        for &(cell, piece, left) in &self.calm {
            data[cell] *= 1.0 + self.stresses.logarithmic(piece, viscosity) * (left - 1.0);
        }
        self.beyond.iter().for_each(|&(ghost, cell)| data[ghost] = data[cell]);
    }

    /// Friction of the last iteration as a list of numbers.
    pub(super) fn friction_state(&self) -> Vec<f64> {
        self.stresses.numbers()
    }
    /// Takes back what [`friction_state`](Self::friction_state) gave.
    pub(super) fn set_friction_state(&mut self, numbers: &[f64]) {
        self.stresses.set_numbers(numbers);
    }

    /// Force of friction on each body \[N\], about its centre of mass.
    pub(super) fn friction(&self, density: f64) -> Vec<Wrench> {
        let mut out = vec![Wrench::default(); self.n_bodies];
        for (force, probe) in self.stresses.force.iter().zip(&self.stresses.probes) {
            out[probe.body] += Wrench::at(density * force, probe.arm);
        }
        out
    }

    /// Force of the pressure on each body \[N\], about its centre of mass: that of every cell acts on the wall in it.
    pub(super) fn pressure_force(&self, pressure: &Field<D>) -> Vec<Wrench> {
        let mut out = vec![Wrench::default(); self.n_bodies];
        for probe in &self.stresses.probes {
            let force = probe.normal * (-pressure.data()[probe.cell] * probe.area);
            out[probe.body] += Wrench::at(force, probe.arm);
        }
        out
    }

    /// Per piece of wall: what the wall takes from the fluid per area and density \[m²/s²\] in the last iteration.
    pub(super) fn tractions(&self) -> impl Iterator<Item = Vector> + '_ {
        self.stresses.force.iter().zip(&self.stresses.probes).map(|(force, probe)| force / probe.area)
    }

    /// Per piece of wall u_τ \[m/s\] in the last iteration.
    pub(super) fn friction_velocities(&self) -> impl Iterator<Item = f64> + '_ {
        self.stresses.friction_velocities()
    }
}

/// Cells without fluid at their centre that have neighbours with, and the weights of those.
fn dry<const D: usize>(openings: &Openings<D>) -> Vec<(usize, Vec<(usize, f64)>)> {
    let grid = openings.grid;
    let inner = |o: usize| grid.cell_at(o).is_some();
    let cells = (0..grid.n_cells()).map(|cell| grid.place(grid.cell(cell)));
    cells
        .filter(|&o| !openings.wet[o])
        .map(|cell| {
            let from: Vec<usize> = gradients::around(openings, cell)
                .map(|o| openings.wrap(o))
                .filter(|&o| inner(o) && openings.wet[o])
                .collect();
            let weight = 1.0 / from.len().max(1) as f64;
            (cell, from.into_iter().map(|o| (o, weight)).collect())
        })
        .collect()
}

/// Cells without fluid at their centre that a wall cuts: storage index, piece, and 1 for slivers to 0 where a quarter of a cell is left.
fn calm<const D: usize>(openings: &Openings<D>) -> Vec<(usize, usize, f64)> {
    let grid = openings.grid;
    let dry = (0..grid.n_cells()).map(|cell| grid.place(grid.cell(cell))).filter(|&o| !openings.wet[o]);
    dry.filter_map(|cell| {
        let (piece, wall) = openings.piece(cell)?;
        let centre = grid.centre(grid.cell_at(cell)?);
        let height = gradients::height(&wall, centre);
        let part = 0.5 + height / openings.extent(cell, &wall);
        Some((cell, piece, 1.0 - (part / stress::SLIVER).clamp(0.0, 1.0)))
    })
    .collect()
}

/// Ghosts of cells without fluid at their centre beyond sides of the box that are not periodic.
fn beyond<const D: usize>(openings: &Openings<D>) -> Vec<(usize, usize)> {
    let grid = openings.grid;
    let dry = (0..grid.n_cells()).map(|cell| grid.place(grid.cell(cell))).filter(|&o| !openings.wet[o]);
    let around = dry.flat_map(|o| grid.stride().into_iter().flat_map(move |s| [(o - s, o), (o + s, o)]));
    around.filter(|&(ghost, _)| grid.cell_at(openings.wrap(ghost)).is_none()).collect()
}
