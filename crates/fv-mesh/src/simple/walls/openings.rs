//! The open parts of all faces, on the grid.
use crate::grid::GHOSTS;
use crate::metrics::Metrics;
use crate::{CartesianGrid, Field, FlowError};
use interfaces::{CutCells, WallPiece};
use std::collections::{HashMap, HashSet};

/// What walls leave of the cells, by storage index.
pub(super) struct Openings<'a, const D: usize> {
    pub(super) grid: &'a CartesianGrid<D>,
    pub(super) metrics: &'a Metrics<D>,
    /// Open share of every face, ghosts included.
    pub(super) open: [Field<D>; D],
    /// Where the nodes of the cut faces are.
    centres: [HashMap<usize, [f64; D]>; D],
    /// Is there fluid at the centre of the cell?
    pub(super) wet: Vec<bool>,
    /// The piece of wall in a cell, by storage index of the cell.
    pieces: HashMap<usize, usize>,
    pub(super) walls: &'a [WallPiece],
}

impl<'a, const D: usize> Openings<'a, D> {
    /// # Errors
    /// [`FlowError::Parameter`] for cells that are not the grid's, and numbers that make no sense.
    pub(super) fn new(
        cuts: &'a CutCells,
        grid: &'a CartesianGrid<D>,
        metrics: &'a Metrics<D>,
        outlets: &HashSet<(usize, usize)>,
    ) -> Result<Self, FlowError> {
        let fail = |name, value, range| Err(FlowError::Parameter { name, value, range });
        let mut open = std::array::from_fn(|_| Field::zeros(grid));
        open.iter_mut().for_each(|field: &mut Field<D>| field.data_mut().fill(1.0));
        let mut centres = std::array::from_fn(|_| HashMap::new());
        for c in 0..D {
            for face in &cuts.faces[c] {
                if face.index >= grid.storage() || !on_grid(grid, metrics, c, face.index) {
                    let range =
                        "one of the flow's own velocity lattices: make the walls from its `velocity()`";
                    return fail("a storage index of immersed walls", face.index as f64, range);
                }
                if !(0.0..1.0).contains(&face.open) {
                    return fail(
                        "the open share of a face that a wall cuts",
                        face.open,
                        "from 0 to less than 1",
                    );
                }
                if face.open > 0.0 && outlets.contains(&(c, face.index)) {
                    continue;
                }
                open[c].data_mut()[face.index] = face.open;
                centres[c].insert(face.index, std::array::from_fn(|a| face.centre[a]));
            }
            fill_ghosts(grid, metrics, c, open[c].data_mut());
        }
        let mut pieces = HashMap::new();
        for (p, wall) in cuts.walls.iter().enumerate() {
            let good = wall.area > 0.0 && wall.area.is_finite() && (wall.normal.norm() - 1.0).abs() < 1e-6;
            if wall.cell >= grid.n_cells() || !good {
                return fail("the area of a wall in a cell", wall.area, "positive, in a cell of the grid");
            }
            pieces.insert(grid.place(grid.cell(wall.cell)), p);
        }
        let mut this = Self { grid, metrics, open, centres, wet: Vec::new(), pieces, walls: &cuts.walls };
        this.wet = (0..grid.storage()).map(|o| this.is_wet(o)).collect();
        Ok(this)
    }

    /// Storage coordinates.
    pub(super) fn at(&self, index: usize) -> [usize; D] {
        coordinates(self.grid, index)
    }

    /// Place of the node of component `c` \[m\]: the centroid of what is open.
    pub(super) fn node(&self, c: usize, index: usize) -> [f64; D] {
        if let Some(&x) = self.centres[c].get(&index).filter(|_| self.open[c].data()[index] > 0.0) {
            return x;
        }
        let at = self.at(index);
        std::array::from_fn(|a| self.metrics.of(Some(c), a).x[at[a]])
    }

    /// Area of a whole face \[m²\].
    pub(super) fn area(&self, c: usize, index: usize) -> f64 {
        let at = self.at(index);
        (0..D).filter(|&a| a != c).map(|a| self.metrics.axes[a].width[at[a]]).product()
    }

    pub(super) fn alive(&self, c: usize, index: usize) -> bool {
        self.open[c].data()[index] > 0.0
    }

    pub(super) fn full(&self, c: usize, index: usize) -> bool {
        self.open[c].data()[index] >= 1.0
    }

    /// The wall in the cell with this storage index.
    pub(super) fn piece(&self, cell: usize) -> Option<(usize, &'a WallPiece)> {
        self.pieces.get(&cell).map(|&p| (p, &self.walls[p]))
    }

    /// How far a cell extends along a wall's normal \[m\].
    pub(super) fn extent(&self, cell: usize, wall: &WallPiece) -> f64 {
        let at = self.at(cell);
        (0..D).map(|a| wall.normal[a].abs() * self.metrics.axes[a].width[at[a]]).sum()
    }

    /// The centre of a cell is in the fluid if it has an open face and no wall, or is before the wall it has.
    fn is_wet(&self, cell: usize) -> bool {
        let at = self.at(cell);
        let s = self.grid.stride();
        if (0..D).any(|a| at[a] + 1 >= self.grid.cells()[a] + 2 * GHOSTS) {
            return true;
        }
        let faces = || (0..D).flat_map(move |a| [(a, cell), (a, cell + s[a])]);
        if !faces().any(|(a, f)| self.alive(a, f)) {
            return false;
        }
        let Some((_, wall)) = self.piece(cell) else { return true };
        let x: [f64; D] = std::array::from_fn(|a| self.metrics.axes[a].centres.x[at[a]]);
        (0..D).map(|a| (x[a] - wall.foot[a]) * wall.normal[a]).sum::<f64>() > 0.0
    }
}

/// Storage coordinates, ghosts included.
pub(super) fn coordinates<const D: usize>(grid: &CartesianGrid<D>, mut index: usize) -> [usize; D] {
    let s = grid.stride();
    let mut at = [0; D];
    for a in (0..D).rev() {
        at[a] = index / s[a];
        index %= s[a];
    }
    at
}

/// Is this a face of component `c`, those on the sides included?
fn on_grid<const D: usize>(grid: &CartesianGrid<D>, metrics: &Metrics<D>, c: usize, index: usize) -> bool {
    let (at, n) = (coordinates(grid, index), grid.cells());
    (0..D).all(|a| {
        let last = n[a] + usize::from(a == c && !metrics.periodic[a]);
        at[a] >= GHOSTS && at[a] < GHOSTS + last
    })
}

/// Ghosts of shares: periodic, or those of the nearest face inside.
fn fill_ghosts<const D: usize>(grid: &CartesianGrid<D>, metrics: &Metrics<D>, c: usize, values: &mut [f64]) {
    let (n, s) = (grid.cells(), grid.stride());
    for index in 0..values.len() {
        let at = coordinates(grid, index);
        let from: [usize; D] = std::array::from_fn(|a| {
            let i = at[a] as isize - GHOSTS as isize;
            let m = n[a] as isize;
            let inside =
                if metrics.periodic[a] { i.rem_euclid(m) } else { i.clamp(0, m - isize::from(a != c)) };
            GHOSTS + inside as usize
        });
        if from != at {
            values[index] = values[(0..D).map(|a| from[a] * s[a]).sum::<usize>()];
        }
    }
}
