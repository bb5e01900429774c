//! Errors of a flow against an exact solution.
use fv_mesh::{CartesianGrid, Projection};
use interfaces::VelocityField;

/// Errors in the volume-weighted 2-norm (root of the mean square) and in the maximum norm.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Norms {
    pub(crate) two: f64,
    pub(crate) max: f64,
}

impl Norms {
    /// Order of accuracy from this error to that on a grid `ratio` times finer: in the 2-norm and the maximum norm.
    pub(crate) fn order_to(self, finer: Self, ratio: f64) -> [f64; 2] {
        [(self.two / finer.two).ln() / ratio.ln(), (self.max / finer.max).ln() / ratio.ln()]
    }
}

/// Coordinates of the node of component `c` (`None`: the centre) in this cell.
fn node<const D: usize>(grid: &CartesianGrid<D>, c: Option<usize>, cell: [usize; D]) -> [f64; D] {
    std::array::from_fn(|a| {
        if c == Some(a) { grid.axis(a).faces()[cell[a]] } else { grid.axis(a).centre(cell[a]) }
    })
}

/// Velocity error over the faces inside the box.
pub(crate) fn velocity<const D: usize>(flow: &Projection<D>, exact: impl Fn([f64; D]) -> [f64; D]) -> Norms {
    let grid = flow.grid();
    let (mut sum, mut volume, mut max) = (0.0, 0.0, 0.0_f64);
    for c in 0..D {
        let lattice = flow.velocity().lattice(c);
        let first = usize::from(!flow.sides().periodic(c));
        for cell in (0..grid.n_cells()).map(|i| grid.cell(i)).filter(|cell| cell[c] >= first) {
            let at = std::array::from_fn(|a| {
                if a < D { cell[a] as isize - isize::from(a == c) * first as isize } else { 0 }
            });
            let Some(index) = lattice.index(at) else { continue };
            let error = flow.velocity().component(c)[index] - exact(node(grid, Some(c), cell))[c];
            let weight = grid.cell_volume(cell);
            sum += weight * error * error;
            volume += weight;
            max = max.max(error.abs());
        }
    }
    Norms { two: (sum / volume * D as f64).sqrt(), max }
}

/// Pressure error, up to a constant if `floating`.
pub(crate) fn pressure<const D: usize>(
    flow: &Projection<D>,
    floating: bool,
    exact: impl Fn([f64; D]) -> f64,
) -> Norms {
    let grid = flow.grid();
    let errors: Vec<(f64, f64)> = flow
        .pressure()
        .values()
        .enumerate()
        .map(|(i, p)| (p - exact(node(grid, None, grid.cell(i))), grid.cell_volume(grid.cell(i))))
        .collect();
    let volume: f64 = errors.iter().map(|e| e.1).sum();
    let mean = if floating { errors.iter().map(|e| e.0 * e.1).sum::<f64>() / volume } else { 0.0 };
    let square: f64 = errors.iter().map(|e| e.1 * (e.0 - mean).powi(2)).sum();
    let max = errors.iter().map(|e| (e.0 - mean).abs()).fold(0.0, f64::max);
    Norms { two: (square / volume).sqrt(), max }
}
