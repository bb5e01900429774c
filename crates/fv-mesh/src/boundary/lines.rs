//! The lines of nodes along one axis, which start and end at its two sides.
use crate::CartesianGrid;
use crate::grid::GHOSTS;
use crate::metrics::Metrics;

/// The lines along axis `a`, ghost lines of the other axes included: so corners are filled, one axis after another.
#[derive(Clone, Debug)]
pub(crate) struct Lines {
    /// The axis along which they run.
    pub(crate) axis: usize,
    /// The two other axes (the second is meaningless in a plane grid).
    pub(crate) across: [usize; 2],
    /// Lines along these, ghosts included.
    pub(crate) count: [usize; 2],
    stride: [usize; 2],
    /// Storage index of the first cell of the first line.
    start: usize,
    /// Cells of a line, and their storage distance.
    pub(crate) cells: usize,
    pub(crate) step: usize,
    /// Ghost lines beside the first one along each other axis.
    ghosts: [usize; 2],
}

impl Lines {
    pub(crate) fn new<const D: usize>(grid: &CartesianGrid<D>, axis: usize) -> Self {
        let (n, s) = (grid.cells(), grid.stride());
        let across = match (D, axis) {
            (2, a) => [1 - a, 1 - a],
            (_, 0) => [1, 2],
            (_, 1) => [0, 2],
            _ => [0, 1],
        };
        let ghosts = [GHOSTS, if D == 2 { 0 } else { GHOSTS }];
        let count = [n[across[0]] + 2 * GHOSTS, if D == 2 { 1 } else { n[across[1]] + 2 * GHOSTS }];
        let stride = [s[across[0]], if D == 2 { 0 } else { s[across[1]] }];
        let start = grid.base() - (0..2).map(|b| ghosts[b] * stride[b]).sum::<usize>();
        Self { axis, across, count, stride, start, cells: n[axis], step: s[axis], ghosts }
    }

    /// Number of lines.
    pub(crate) fn len(&self) -> usize {
        self.count[0] * self.count[1]
    }
    /// Storage index of the first cell of each line, line after line.
    pub(crate) fn starts(&self) -> impl Iterator<Item = usize> + use<> {
        let (start, stride, count) = (self.start, self.stride, self.count);
        (0..count[1]).flat_map(move |k| (0..count[0]).map(move |j| start + j * stride[0] + k * stride[1]))
    }
    /// Where line `l` is among the other axes, counted from the outermost ghost.
    pub(crate) fn place(&self, l: usize) -> [usize; 2] {
        [l % self.count[0], l / self.count[0]]
    }
    /// Does line `l` run through cells rather than ghosts?
    pub(crate) fn inside(&self, l: usize) -> bool {
        let at = self.place(l);
        (0..2).all(|b| (self.ghosts[b]..self.count[b] - self.ghosts[b]).contains(&at[b]))
    }
    /// Number of the dense (x fastest) cell at the lower or upper end of line `l`, which runs through cells.
    pub(crate) fn end_cell<const D: usize>(&self, grid: &CartesianGrid<D>, l: usize, upper: bool) -> usize {
        let at = self.place(l);
        let mut cell = [0; D];
        for b in 0..D - 1 {
            cell[self.across[b]] = at[b] - self.ghosts[b];
        }
        cell[self.axis] = if upper { self.cells - 1 } else { 0 };
        grid.index(cell)
    }

    /// Centre of the face at which line `l` ends, on a side at `at`; ghost lines are moved to the edge of the side.
    pub(crate) fn face_centre<const D: usize>(&self, grid: &CartesianGrid<D>, at: f64, l: usize) -> [f64; 3] {
        let index = self.place(l);
        let mut x = [0.0; 3];
        x[self.axis] = at;
        for b in 0..D - 1 {
            let axis = grid.axis(self.across[b]);
            let i = index[b].saturating_sub(GHOSTS).min(axis.cells() - 1);
            x[self.across[b]] = axis.centre(i);
        }
        x
    }
    /// Area of the face at which line `l` ends \[m²\]; length in a plane grid.
    pub(crate) fn face_area<const D: usize>(&self, metrics: &Metrics<D>, l: usize) -> f64 {
        let index = self.place(l);
        (0..D - 1).map(|b| metrics.axes[self.across[b]].width[index[b]]).product()
    }
    /// Storage index of the cell before a side and of the ghost behind it, on the line that starts at `o`.
    pub(crate) fn ends(&self, o: usize, upper: usize) -> (usize, usize) {
        let last = o + (self.cells - 1) * self.step;
        if upper == 1 { (last, last + self.step) } else { (o, o - self.step) }
    }
    /// Fills the ghosts of a periodic axis.
    pub(crate) fn wrap(&self, u: &mut [f64]) {
        let (n, s) = (self.cells, self.step);
        let (before, after) = ((2 * n - 2) % n, 1 % n);
        for o in self.starts() {
            u[o - s] = u[o + (n - 1) * s];
            u[o - 2 * s] = u[o + before * s];
            u[o + n * s] = u[o];
            u[o + (n + 1) * s] = u[o + after * s];
        }
    }
}
