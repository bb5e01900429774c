//! β of a coarser level and the weights of its interpolation.
//!
//! The resistances of fine faces along an axis add up, the conductances of columns side by side do. Along an axis the
//! interpolated value divides the way between two coarse centres as the resistances do.
use super::axis::AxisLevel;
use super::coefficients::place;
use super::level::Level;
use super::stencil::Real;

/// The way along an axis from the centre of a group of cells to that of the next one: the part within the group below,
/// that across the face between them, the part within the group above. Nothing lies behind an end.
pub(super) struct Path {
    /// The face in each part; a group of one cell has none.
    faces: [Option<usize>; 3],
    /// \[m\]
    lengths: [f64; 3],
    /// The cells of the two groups beside the face between them, where the groups are of two.
    beside: [Option<usize>; 2],
}

impl Path {
    /// To group `g` from the one below it; both are cells of the box.
    pub(super) fn new(axis: &AxisLevel, groups: &[usize], g: usize) -> Self {
        let (w, n, count) = (&axis.widths, axis.cells(), groups.len() - 1);
        let inside = |group: usize| {
            let from = groups[group];
            let pair = groups[group + 1] - from == 2;
            (pair.then_some(from + 1), if pair { 0.25 * (w[from] + w[from + 1]) } else { 0.0 })
        };
        let periodic = axis.periodic();
        let below = if g > 0 { Some((g - 1, groups[g] - 1)) } else { periodic.then(|| (count - 1, n - 1)) };
        let above = if g < count { Some((g, groups[g])) } else { periodic.then_some((0, 0)) };
        let [low, high] = [below, above].map(|side| side.map_or((None, 0.0), |(group, _)| inside(group)));
        let half = |side: Option<(usize, usize)>| side.map_or(0.0, |(_, cell)| 0.5 * w[cell]);
        Self {
            faces: [low.0, Some(groups[g]), high.0],
            lengths: [low.1, half(below) + half(above), high.1],
            beside: [
                low.0.filter(|_| g > 0).map(|_| groups[g] - 1),
                high.0.filter(|_| g < count).map(|_| groups[g]),
            ],
        }
    }
    fn length(&self) -> f64 {
        self.lengths[0] + self.lengths[1] + self.lengths[2]
    }
}

/// What part `r` of the resistance `total` the neighbour group has, `across` that of the face between them: a cell that
/// β = 0 cuts off from its own group follows the neighbour, if it can.
#[inline(always)]
fn share(r: f64, across: f64, total: f64) -> f64 {
    match (r == f64::INFINITY, across == f64::INFINITY) {
        (true, true) => 0.0,
        (true, false) => 1.0,
        _ => r / total,
    }
}

/// Room for a row of the fine level: the three resistances of a path, and the conductance.
#[derive(Default)]
pub(super) struct Scratch {
    resistances: [Vec<f64>; 3],
    conductances: Vec<f64>,
}

/// Sets β of the faces of `coarse` normal to `axes`, and the weights of its interpolation along them.
pub(super) fn coarsen<T: Real>(
    fine: &mut Level<T>,
    coarse: &mut Level<T>,
    axes: &[usize],
    scratch: &mut Scratch,
) {
    let mut weights = std::mem::take(&mut fine.pulls);
    for &axis in axes {
        weights[axis].fill(T::default());
        if axis == 0 {
            along_rows(fine, coarse, &mut weights[axis], scratch);
        } else {
            across_rows(fine, coarse, axis, &mut weights[axis], scratch);
        }
    }
    // No more than the whole value comes from the neighbours.
    let [x, y, z] = &mut weights;
    for ((x, y), z) in x.iter_mut().zip(y).zip(z) {
        let sum = *x + *y + *z;
        if sum > T::of(1.0) {
            (*x, *y, *z) = (*x / sum, *y / sum, *z / sum);
        }
    }
    fine.pulls = weights;
}

/// Faces across the rows: a row of the fine level is a column along the axis.
fn along_rows<T: Real>(fine: &Level<T>, coarse: &mut Level<T>, weights: &mut [T], scratch: &mut Scratch) {
    let (Some(transfer), Some([beta, ..])) = (&fine.transfer, &fine.stencil.beta) else { return };
    let Some([to, ..]) = &mut coarse.stencil.beta else { return };
    let ([n, rows, _], coarse_cells) = (fine.stencil.cells, coarse.stencil.cells);
    let [along, middle, last] = transfer;
    let paths = &along.paths;
    for (k, layers) in last.groups.windows(2).enumerate() {
        for (j, lines) in middle.groups.windows(2).enumerate() {
            let sums = &mut scratch.conductances;
            sums.clear();
            sums.resize(paths.len(), 0.0);
            for q in layers[0]..layers[1] {
                for p in lines[0]..lines[1] {
                    let area = fine.axes[1].widths[p] * fine.axes[2].widths[q];
                    let start = (q * rows + p) * (n + 2);
                    let (beta, weights) = (&beta[start..][..n + 2], &mut weights[start..][..n + 2]);
                    for (sum, path) in sums.iter_mut().zip(paths) {
                        let mut r = [0.0; 3];
                        for ((r, face), length) in r.iter_mut().zip(path.faces).zip(path.lengths) {
                            *r = face.map_or(0.0, |face| length / beta[face].double());
                        }
                        let total = r[0] + r[1] + r[2];
                        *sum += area / total;
                        for (cell, r_in) in path.beside.into_iter().zip([r[0], r[2]]) {
                            if let Some(cell) = cell {
                                weights[cell] = T::of(share(r_in, r[1], total));
                            }
                        }
                    }
                }
            }
            let area = coarse.axes[1].widths[j] * coarse.axes[2].widths[k];
            let out = &mut to[place(coarse_cells, 0, [0, j, k])..][..paths.len()];
            for ((out, &sum), path) in out.iter_mut().zip(sums.iter()).zip(paths) {
                *out = T::of(sum * path.length() / area);
            }
        }
    }
}

/// Faces between rows, a row at a time.
fn across_rows<T: Real>(
    fine: &Level<T>,
    coarse: &mut Level<T>,
    axis: usize,
    weights: &mut [T],
    scratch: &mut Scratch,
) {
    let (Some(transfer), Some(beta)) = (&fine.transfer, &fine.stencil.beta) else { return };
    let Some(to) = &mut coarse.stencil.beta else { return };
    let (cells, coarse_cells) = (fine.stencil.cells, coarse.stencil.cells);
    let (n, other) = (cells[0], 3 - axis);
    // Indices of a face or cell of a row, from those along the axis and along the other one.
    let at = |m: usize, q: usize| if axis == 1 { [0, m, q] } else { [0, q, m] };
    let widths = &fine.axes[0].widths;
    let Scratch { resistances, conductances } = scratch;
    for row in resistances.iter_mut().chain([&mut *conductances]) {
        row.clear();
        row.resize(n, 0.0);
    }
    let [low, across, high] = resistances;
    for (g, path) in transfer[axis].paths.iter().enumerate() {
        for (c, columns) in transfer[other].groups.windows(2).enumerate() {
            let coarse_row = place(coarse_cells, axis, at(g, c));
            let out = &mut to[axis][coarse_row..][..coarse_cells[0]];
            let area = coarse.axes[other].widths[c];
            for q in columns[0]..columns[1] {
                let parts = [&mut *low, &mut *across, &mut *high];
                for ((r, face), length) in parts.into_iter().zip(path.faces).zip(path.lengths) {
                    let Some(face) = face else {
                        r.fill(0.0);
                        continue;
                    };
                    let beta = &beta[axis][place(cells, axis, at(face, q))..][..n];
                    r.iter_mut().zip(beta).for_each(|(r, b)| *r = length / b.double());
                }
                let width = fine.axes[other].widths[q];
                for (i, sum) in conductances.iter_mut().enumerate() {
                    let total = low[i] + across[i] + high[i];
                    let before = if q == columns[0] { 0.0 } else { *sum };
                    *sum = before + widths[i] * width / total;
                }
                for (cell, own) in path.beside.into_iter().zip([&*low, &*high]) {
                    let Some(cell) = cell else { continue };
                    let start = place(cells, 2, at(cell, q));
                    let weights = weights[start..][..n].iter_mut();
                    for (i, weight) in weights.enumerate() {
                        let total = low[i] + across[i] + high[i];
                        *weight = T::of(share(own[i], across[i], total));
                    }
                }
            }
            for ((out, pair), width) in
                out.iter_mut().zip(transfer[0].groups.windows(2)).zip(&coarse.axes[0].widths)
            {
                let sum: f64 = conductances[pair[0]..pair[1]].iter().sum();
                *out = T::of(sum * path.length() / (width * area));
            }
        }
    }
}
