//! Face coefficients and the kinds of ends, cell by cell.
use super::Multigrid;
use super::axis::{AxisLevel, End, Transfer};
use super::level::Level;
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
            if let Some((face, &value)) = beta.iter().enumerate().find(|(_, b)| !(**b >= 0.0 && **b <= 1e30)) {
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
        if let Some(level) = self.hierarchy.levels.first_mut()
            && let Some(single) = &mut level.stencil.beta
        {
            for (single, stored) in single.iter_mut().zip(stored) {
                single.iter_mut().zip(stored).for_each(|(s, b)| *s = *b as f32);
            }
        }
        for l in 1..self.hierarchy.levels.len() {
            let (fine, coarse) = self.hierarchy.levels.split_at_mut(l);
            coarsen(&fine[l - 1], &mut coarse[0]);
        }
        self.hierarchy.factorise(self.singular);
    }
}

/// β of the coarse faces: the mean over the fine faces in them, weighted by area.
fn coarsen(fine: &Level, coarse: &mut Level) {
    let Some(transfer) = &fine.transfer else { return };
    let (Some(from), Some(to)) = (&fine.stencil.beta, &mut coarse.stencil.beta) else { return };
    let (cells, coarse_cells) = (fine.stencil.cells, coarse.stencil.cells);
    for axis in 0..3 {
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        let (wa, wb) = (&fine.axes[a].widths, &fine.axes[b].widths);
        let (ca, cb) = (&coarse.axes[a].widths, &coarse.axes[b].widths);
        let groups = transfer.each_ref().map(|t: &Transfer| &t.groups);
        for_faces(coarse_cells, axis, |_, _, at| {
            let mut sum = 0.0;
            let mut face = [0; 3];
            face[axis] = groups[axis][at[axis]];
            for p in groups[a][at[a]]..groups[a][at[a] + 1] {
                for q in groups[b][at[b]]..groups[b][at[b] + 1] {
                    (face[a], face[b]) = (p, q);
                    sum += wa[p] * wb[q] * f64::from(from[axis][place(cells, axis, face)]);
                }
            }
            to[axis][place(coarse_cells, axis, at)] = (sum / (ca[at[a]] * cb[at[b]])) as f32;
        });
    }
}
