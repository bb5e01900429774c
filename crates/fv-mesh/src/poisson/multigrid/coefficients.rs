//! Face coefficients and the kinds of ends, cell by cell.
use super::Multigrid;
use super::axis::{AxisLevel, End};
use super::hierarchy::Hierarchy;
use super::level::Level;
use super::precision::Precision;
use super::stencil::Real;
use crate::poisson::PoissonError;

/// What may be set between solves.
pub(super) struct Coefficients {
    /// 1 where the value is zero at an end and 0 where the gradient is, x fastest, for the low and the high end of an
    /// axis; empty in periodic axes.
    kinds: [[Vec<f64>; 2]; 3],
    /// β at the ends, whatever kind they are.
    ends: [[Vec<f64>; 2]; 3],
}

impl Coefficients {
    pub(super) fn new(axes: &[AxisLevel; 3]) -> Self {
        let cells: [usize; 3] = std::array::from_fn(|a| axes[a].cells());
        let kinds: [[Vec<f64>; 2]; 3] = std::array::from_fn(|a| {
            axes[a].ends.map(|end| match end {
                End::Periodic => Vec::new(),
                End::ZeroGradient => vec![0.0; cells.iter().product::<usize>() / cells[a]],
                End::ZeroValue => vec![1.0; cells.iter().product::<usize>() / cells[a]],
            })
        });
        let ends = kinds.each_ref().map(|ends| ends.each_ref().map(|end| vec![1.0; end.len()]));
        Self { kinds, ends }
    }
}

/// Number of faces normal to an axis, along each axis.
fn faces(cells: [usize; 3], axis: usize) -> [usize; 3] {
    let mut faces = cells;
    faces[axis] += 1;
    faces
}

/// Place of the face at (i, j, k) among those normal to `axis`, in rows of n + 2 values.
#[inline(always)]
fn place(cells: [usize; 3], axis: usize, [i, j, k]: [usize; 3]) -> usize {
    let rows = cells[1] + usize::from(axis == 1);
    (k * rows + j) * (cells[0] + 2) + i
}

/// Calls `f(place in dense numbering, place in a layer of the end, indices)` for the faces normal to `axis`.
fn for_faces(cells: [usize; 3], axis: usize, mut f: impl FnMut(usize, usize, [usize; 3])) {
    let [x, m, l] = faces(cells, axis);
    let mut dense = 0;
    for k in 0..l {
        for j in 0..m {
            for i in 0..x {
                let end = match axis {
                    0 => k * m + j,
                    1 => k * x + i,
                    _ => j * x + i,
                };
                f(dense, end, [i, j, k]);
                dense += 1;
            }
        }
    }
}

impl<const D: usize> Multigrid<D> {
    /// Sets β ≥ 0 at the faces of each axis; `None` stands for 1. The faces normal to axis a are n_a + 1 along it (of a
    /// periodic axis the last is not used) and as many as cells along the others, x fastest. Where the gradient is zero
    /// at an end, β is not used there.
    ///
    /// Parts of the box that β = 0 cuts off from the others each need an end of zero value, or f of zero mean.
    ///
    /// # Errors
    /// [`PoissonError::Parameter`] unless [`variable`](super::MultigridParams::variable);
    /// [`PoissonError::Faces`] and [`PoissonError::Coefficient`]. The coefficients are then as they were.
    pub fn set_coefficients(&mut self, beta: [Option<&[f64]>; D]) -> Result<(), PoissonError> {
        self.require_variable()?;
        let cells = self.operator.cells;
        for (axis, beta) in beta.iter().enumerate() {
            let Some(beta) = beta else { continue };
            let count: usize = faces(cells, self.inner_axis(axis)).iter().product();
            if beta.len() != count {
                return Err(PoissonError::Faces { axis, length: beta.len(), faces: count });
            }
            if let Some((face, &value)) = beta.iter().enumerate().find(|(_, b)| !(**b >= 0.0 && **b <= 1e30))
            {
                return Err(PoissonError::Coefficient { axis, face, value });
            }
        }
        for (axis, beta) in beta.iter().enumerate() {
            self.write(self.inner_axis(axis), *beta);
        }
        self.renew();
        Ok(())
    }

    /// Chooses the kind of end cell by cell at the low (`high` false) or the high end of `axis`: zero value at the
    /// face where `zero_value`, else zero gradient. Cells of the end with x fastest.
    ///
    /// # Errors
    /// [`PoissonError::Parameter`] unless [`variable`](super::MultigridParams::variable);
    /// [`PoissonError::Faces`] for a wrong number of cells, and none at all in a periodic axis.
    pub fn set_ends(&mut self, axis: usize, high: bool, zero_value: &[bool]) -> Result<(), PoissonError> {
        self.require_variable()?;
        let inner = if axis < D { self.inner_axis(axis) } else { 1 };
        let count = self.coefficients.as_ref().map_or(0, |c| c.kinds[inner][usize::from(high)].len());
        if axis >= D || count == 0 || zero_value.len() != count {
            return Err(PoissonError::Faces { axis, length: zero_value.len(), faces: count });
        }
        if let Some(c) = &mut self.coefficients {
            for (kind, &zero) in c.kinds[inner][usize::from(high)].iter_mut().zip(zero_value) {
                *kind = f64::from(u8::from(zero));
            }
        }
        self.renew();
        Ok(())
    }

    fn require_variable(&self) -> Result<(), PoissonError> {
        if self.coefficients.is_some() {
            Ok(())
        } else {
            Err(PoissonError::Parameter { name: "variable", value: 0.0, least: 1.0 })
        }
    }

    /// Axis of the layout with three axes.
    fn inner_axis(&self, axis: usize) -> usize {
        if D == 2 && axis == 1 { 2 } else { axis }
    }

    /// Sets β = 1.
    pub(super) fn set_ones(&mut self) {
        for axis in 0..3 {
            self.write(axis, None);
        }
        self.renew();
    }

    /// Stores β of an axis.
    fn write(&mut self, axis: usize, beta: Option<&[f64]>) {
        let (Some(c), Some(stored)) = (&mut self.coefficients, &mut self.operator.beta) else { return };
        let (cells, n) = (self.operator.cells, self.operator.cells[axis]);
        for_faces(cells, axis, |dense, end, at| {
            let value = beta.map_or(1.0, |beta| beta[dense]);
            stored[axis][place(cells, axis, at)] = value;
            for (high, layer) in [0, n].into_iter().enumerate() {
                if at[axis] == layer && !c.ends[axis][high].is_empty() {
                    c.ends[axis][high][end] = value;
                }
            }
        });
    }

    /// Puts the coefficients of all levels in line with what was set.
    pub(super) fn renew(&mut self) {
        let (Some(c), Some(stored)) = (&self.coefficients, &mut self.operator.beta) else { return };
        let cells = self.operator.cells;
        let mut open = self.shift > 0.0;
        for axis in 0..3 {
            let n = cells[axis];
            for_faces(cells, axis, |_, end, at| {
                if at[axis] != 0 && at[axis] != n {
                    return;
                }
                let high = usize::from(at[axis] == n);
                stored[axis][place(cells, axis, at)] = if c.kinds[axis][high].is_empty() {
                    let mut first = at;
                    first[axis] = 0;
                    stored[axis][place(cells, axis, first)]
                } else {
                    let value = c.kinds[axis][high][end] * c.ends[axis][high][end];
                    open |= value > 0.0;
                    value
                };
            });
        }
        self.singular = !open;
        match &mut self.hierarchy {
            Precision::Single(h) => renew_levels(h, stored, self.singular),
            Precision::Double(h) => renew_levels(h, stored, self.singular),
        }
    }
}

/// Copies β to the finest level and coarsens it from there.
fn renew_levels<T: Real>(hierarchy: &mut Hierarchy<T>, beta: &[Vec<f64>; 3], singular: bool) {
    if let Some(own) = hierarchy.levels.first_mut().and_then(|level| level.stencil.beta.as_mut()) {
        for (own, beta) in own.iter_mut().zip(beta) {
            own.iter_mut().zip(beta).for_each(|(own, &b)| *own = T::of(b));
        }
    }
    for l in 1..hierarchy.levels.len() {
        let (fine, coarse) = hierarchy.levels.split_at_mut(l);
        coarsen(&mut fine[l - 1], &mut coarse[0]);
    }
    hierarchy.factorise(singular);
}

/// Resistances of the path along `axis` from the centre of group `g` − 1 to that of group `g`, in the column at (p, q) of
/// the other two axes: half of the distance within the group below, the distance across the face between the groups, half
/// of the distance within the group above; and the length of the path. Nothing lies behind an end.
fn path<T: Real>(
    fine: &Level<T>,
    groups: &[usize],
    axis: usize,
    column: [usize; 2],
    g: usize,
) -> ([f64; 3], f64) {
    let Some(beta) = &fine.stencil.beta else { return ([0.0; 3], 0.0) };
    let (w, n, count) = (&fine.axes[axis].widths, fine.stencil.cells[axis], groups.len() - 1);
    let periodic = fine.stencil.periodic[axis];
    let at = |m: usize| {
        let [p, q] = column;
        let face = [[m, p, q], [p, m, q], [p, q, m]][axis];
        beta[axis][place(fine.stencil.cells, axis, face)].double()
    };
    let inside = |g: usize| {
        let (from, to) = (groups[g], groups[g + 1]);
        if to - from == 1 {
            return (0.0, 0.0);
        }
        let half = 0.25 * (w[from] + w[from + 1]);
        (half / at(from + 1), half)
    };
    let m = groups[g];
    let below = match (g, periodic) {
        (0, false) => None,
        (0, true) => Some((count - 1, n - 1)),
        _ => Some((g - 1, m - 1)),
    };
    let above = match (g == count, periodic) {
        (true, false) => None,
        (true, true) => Some((0, 0)),
        _ => Some((g, m)),
    };
    let (low, high) =
        (below.map_or((0.0, 0.0), |(g, _)| inside(g)), above.map_or((0.0, 0.0), |(g, _)| inside(g)));
    let across = 0.5 * (below.map_or(0.0, |(_, i)| w[i]) + above.map_or(0.0, |(_, i)| w[i]));
    ([low.0, across / at(m), high.0], low.1 + across + high.1)
}

/// β of the coarse faces and the weights of the interpolation. The resistances of the fine faces along an axis add up,
/// the conductances of columns side by side do. Along an axis the interpolated value divides the way between two
/// coarse centres as the resistances do.
fn coarsen<T: Real>(fine: &mut Level<T>, coarse: &mut Level<T>) {
    let Some(transfer) = &fine.transfer else { return };
    let Some(to) = &mut coarse.stencil.beta else { return };
    let mut weights = std::mem::take(&mut fine.pulls);
    let (cells, coarse_cells) = (fine.stencil.cells, coarse.stencil.cells);
    for axis in 0..3 {
        let (a, b) = ([1, 0, 0][axis], [2, 2, 1][axis]);
        let (groups, columns) = (&transfer[axis].groups, [&transfer[a].groups, &transfer[b].groups]);
        let count = groups.len() - 1;
        weights[axis].fill(T::default());
        for_faces(coarse_cells, axis, |_, _, at| {
            let mut conductance = 0.0;
            let mut length = 0.0;
            for q in columns[1][at[b]]..columns[1][at[b] + 1] {
                for p in columns[0][at[a]]..columns[0][at[a] + 1] {
                    let (parts, whole) = path(fine, groups, axis, [p, q], at[axis]);
                    length = whole;
                    let total: f64 = parts.iter().sum();
                    conductance += fine.axes[a].widths[p] * fine.axes[b].widths[q] / total;
                    // Cells on both sides of the face in groups of two.
                    let mut pull = |i: usize, part: f64| {
                        let mut cell = [0; 3];
                        (cell[a], cell[b], cell[axis]) = (p, q, i);
                        // A cell that β = 0 cuts off from its group follows the neighbour, if it can.
                        let share = match (part == f64::INFINITY, parts[1] == f64::INFINITY) {
                            (true, true) => 0.0,
                            (true, false) => 1.0,
                            _ => part / total,
                        };
                        weights[axis][(cell[2] * cells[1] + cell[1]) * (cells[0] + 2) + cell[0]] =
                            T::of(share);
                    };
                    let g = at[axis];
                    if g > 0 && groups[g] - groups[g - 1] == 2 {
                        pull(groups[g] - 1, parts[0]);
                    }
                    if g < count && groups[g + 1] - groups[g] == 2 {
                        pull(groups[g], parts[2]);
                    }
                }
            }
            let area = coarse.axes[a].widths[at[a]] * coarse.axes[b].widths[at[b]];
            to[axis][place(coarse_cells, axis, at)] = T::of(conductance * length / area);
        });
    }
    // No more than the whole value comes from the neighbours.
    for i in 0..weights[0].len() {
        let sum = weights[0][i] + weights[1][i] + weights[2][i];
        if sum > T::of(1.0) {
            weights.iter_mut().for_each(|w| w[i] = w[i] / sum);
        }
    }
    fine.pulls = weights;
}
