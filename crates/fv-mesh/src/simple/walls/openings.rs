//! The open parts of all faces, on the grid.
use crate::grid::GHOSTS;
use crate::metrics::Metrics;
use crate::spans::Spans;
use crate::{CartesianGrid, Field, FlowError};
use interfaces::{CutCells, WallPiece};
use std::collections::{HashMap, HashSet};

/// Cells at most as many steps from one that a wall cuts are near it.
pub(super) const LAYERS: usize = 3;

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
    /// Is the cell so near a wall that stress and convection follow the wall?
    pub(super) near: Vec<bool>,
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
        law: bool,
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
        let mut this = Self {
            grid,
            metrics,
            open,
            centres,
            wet: Vec::new(),
            near: vec![false; grid.storage()],
            pieces,
            walls: &cuts.walls,
        };
        this.wet = (0..grid.storage()).map(|o| this.is_wet(o)).collect();
        if law {
            this.mark_near();
        }
        Ok(this)
    }

    /// Of the cells that something passes.
    pub(super) fn spans(&self) -> Spans {
        let s = self.grid.stride();
        Spans::around(self.grid.cells(), self.metrics.periodic, |cell| {
            let o = self.grid.place(self.grid.cell(cell));
            (0..D).any(|a| self.alive(a, o) || self.alive(a, o + s[a]))
        })
    }

    /// The storage index inside the box that one among the ghosts stands for, along periodic axes.
    pub(super) fn wrap(&self, index: usize) -> usize {
        storage_index(self.grid, wrapped(self.grid, self.metrics, self.at(index)))
    }

    /// How far a place among the ghosts is from the one it stands for \[m\].
    fn shift(&self, index: usize) -> [f64; D] {
        let (at, n) = (self.at(index), self.grid.cells());
        std::array::from_fn(|a| {
            let turns = (at[a] as isize - GHOSTS as isize).div_euclid(n[a] as isize);
            if self.metrics.periodic[a] { turns as f64 * self.grid.axis(a).length() } else { 0.0 }
        })
    }

    /// Storage coordinates.
    pub(super) fn at(&self, index: usize) -> [usize; D] {
        coordinates(self.grid, index)
    }

    /// Place of the node of component `c` \[m\]: the centroid of what is open.
    pub(super) fn node(&self, c: usize, index: usize) -> [f64; D] {
        if let Some(&x) = self.centres[c].get(&self.wrap(index)).filter(|_| self.alive(c, index)) {
            let shift = self.shift(index);
            return std::array::from_fn(|a| x[a] + shift[a]);
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

    /// The wall in the cell with this storage index, where the cell is.
    pub(super) fn piece(&self, cell: usize) -> Option<(usize, WallPiece)> {
        let &p = self.pieces.get(&self.wrap(cell))?;
        let mut wall = self.walls[p];
        self.shift(cell).iter().enumerate().for_each(|(a, shift)| wall.foot[a] += shift);
        Some((p, wall))
    }

    /// Marks the cells at most [`LAYERS`] steps from one with a wall, and their ghosts.
    fn mark_near(&mut self) {
        let mut front: Vec<usize> = self.pieces.keys().copied().collect();
        for _ in 0..=LAYERS {
            front.iter().for_each(|&cell| self.near[cell] = true);
            let around = front.iter().flat_map(|&cell| super::gradients::around(self, cell));
            let mut next: Vec<usize> = around
                .map(|o| self.wrap(o))
                .filter(|&o| !self.near[o] && self.grid.cell_at(o).is_some())
                .collect();
            next.sort_unstable();
            next.dedup();
            front = next;
        }
        self.near = (0..self.near.len()).map(|o| self.near[self.wrap(o)]).collect();
    }

    /// How far a cell extends along a wall's normal \[m\].
    pub(super) fn extent(&self, cell: usize, wall: &WallPiece) -> f64 {
        let at = self.at(cell);
        (0..D).map(|a| wall.normal[a].abs() * self.metrics.axes[a].width[at[a]]).sum()
    }

    /// The centre of a cell is in the fluid if it has an open face and no wall, or is before the wall it has.
    fn is_wet(&self, cell: usize) -> bool {
        let cell = self.wrap(cell);
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

fn storage_index<const D: usize>(grid: &CartesianGrid<D>, at: [usize; D]) -> usize {
    at.iter().zip(grid.stride()).map(|(i, s)| i * s).sum()
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
    let n = grid.cells();
    for index in 0..values.len() {
        let mut from = wrapped(grid, metrics, coordinates(grid, index));
        for axis in (0..D).filter(|&axis| !metrics.periodic[axis]) {
            from[axis] = from[axis].clamp(GHOSTS, GHOSTS + n[axis] - usize::from(axis != c));
        }
        values[index] = values[storage_index(grid, from)];
    }
}

/// Storage coordinates inside the box along periodic axes.
fn wrapped<const D: usize>(grid: &CartesianGrid<D>, metrics: &Metrics<D>, mut at: [usize; D]) -> [usize; D] {
    for (a, i) in at.iter_mut().enumerate().filter(|&(a, _)| metrics.periodic[a]) {
        let inside = (*i as isize - GHOSTS as isize).rem_euclid(grid.cells()[a] as isize);
        *i = GHOSTS + inside as usize;
    }
    at
}
