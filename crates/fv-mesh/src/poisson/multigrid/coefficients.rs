//! Face coefficients and the kinds of ends, cell by cell.
use super::Multigrid;
use super::axis::{AxisLevel, End};
use super::precision::Precision;
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
pub(super) fn place(cells: [usize; 3], axis: usize, [i, j, k]: [usize; 3]) -> usize {
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
        self.renew(Self::AXES);
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
        self.renew(Self::AXES);
        Ok(())
    }

    fn require_variable(&self) -> Result<(), PoissonError> {
        if self.coefficients.is_some() {
            Ok(())
        } else {
            Err(PoissonError::Parameter { name: "variable", value: 0.0, least: 1.0 })
        }
    }

    /// Axes of the layout along which there may be more than one cell.
    const AXES: &[usize] = if D == 2 { &[0, 2] } else { &[0, 1, 2] };

    /// Axis of the layout with three axes.
    fn inner_axis(&self, axis: usize) -> usize {
        if D == 2 && axis == 1 { 2 } else { axis }
    }

    /// Sets β = 1.
    pub(super) fn set_ones(&mut self) {
        for axis in 0..3 {
            self.write(axis, None);
        }
        self.renew(&[0, 1, 2]);
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

    /// Puts the coefficients of all levels normal to `axes` in line with what was set.
    fn renew(&mut self, axes: &[usize]) {
        let (Some(c), Some(stored)) = (&self.coefficients, &mut self.operator.beta) else { return };
        let cells = self.operator.cells;
        let mut open = self.shift > 0.0;
        for &axis in axes {
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
            Precision::Single(h) => h.renew(stored, axes, self.singular),
            Precision::Double(h) => h.renew(stored, axes, self.singular),
        }
        self.operator.find_spans();
    }
}
