//! Evaluation of expressions into fields.
use super::{Expression, GridMismatch, Operand, RowExpression, RowPlace};
use crate::grid::GHOSTS;
use crate::kernels::layers_per_task;
use crate::parts::each_part;
use crate::{CartesianGrid, Field, Integrals};
use pulp::{Arch, Simd, WithSimd};

impl<const D: usize> Field<D> {
    /// The field f(x) at the centres x \[m\] of the cells; ghosts are 0.
    pub fn from_fn(grid: &CartesianGrid<D>, f: impl Fn([f64; D]) -> f64 + Sync) -> Self {
        let mut field = Self::zeros(grid);
        field.evaluate(&grid.function(f), |_, new| new);
        field
    }

    /// The field of this value; ghosts are 0.
    ///
    /// # Errors
    /// [`GridMismatch`] if an operand lives on another grid.
    pub fn from_expression<A: Operand<Node: Expression<D>>>(
        grid: &CartesianGrid<D>,
        value: A,
    ) -> Result<Self, GridMismatch> {
        let mut field = Self::zeros(grid);
        field.assign(value)?;
        Ok(field)
    }

    /// Gives every cell this value.
    pub fn fill(&mut self, value: f64) {
        self.evaluate(&value.node(), |_, new| new);
    }

    /// a = `value` at every cell.
    ///
    /// # Errors
    /// [`GridMismatch`] if an operand lives on another grid; the field is as it was.
    pub fn assign<A: Operand<Node: Expression<D>>>(&mut self, value: A) -> Result<(), GridMismatch> {
        self.combine(value, |_, new| new)
    }

    /// a = a + `value` at every cell.
    ///
    /// # Errors
    /// Those of [`assign`](Self::assign).
    pub fn increase<A: Operand<Node: Expression<D>>>(&mut self, value: A) -> Result<(), GridMismatch> {
        self.combine(value, |old, new| old + new)
    }

    /// a = a·`factor` at every cell.
    ///
    /// # Errors
    /// Those of [`assign`](Self::assign).
    pub fn multiply<A: Operand<Node: Expression<D>>>(&mut self, factor: A) -> Result<(), GridMismatch> {
        self.combine(factor, |old, new| old * new)
    }

    /// a = f(a, `value`) at every cell.
    ///
    /// # Errors
    /// Those of [`assign`](Self::assign).
    pub fn combine<A: Operand<Node: Expression<D>>>(
        &mut self,
        value: A,
        f: impl Fn(f64, f64) -> f64 + Sync,
    ) -> Result<(), GridMismatch> {
        let expression = value.node();
        expression.check(self.grid())?;
        self.evaluate(&expression, f);
        Ok(())
    }

    /// max |a − `other`| over the cells; not a number if a difference is none.
    ///
    /// # Errors
    /// [`GridMismatch`] if an operand lives on another grid.
    pub fn max_difference<A: Operand<Node: Expression<D>>>(&self, other: A) -> Result<f64, GridMismatch> {
        Integrals::new(self.grid()).largest(self - super::Expr(other.node()))
    }

    /// `expression` fits the grid.
    fn evaluate<E: Expression<D>>(&mut self, expression: &E, f: impl Fn(f64, f64) -> f64 + Sync) {
        let grid = self.grid().clone();
        let layer = grid.stride()[D - 1];
        let layers = grid.cells()[D - 1];
        let per_task = layers_per_task(layers);
        let run = |task: usize, out: &mut [f64]| {
            let first = task * per_task;
            let end = (first + per_task).min(layers);
            let start = (GHOSTS + first) * layer;
            Arch::new().dispatch(Evaluate { grid: &grid, expression, f: &f, layers: first..end, start, out });
        };
        each_part(self.layers_mut(), layer * per_task, &run);
    }
}

/// Evaluates a run of layers.
struct Evaluate<'a, E, F, const D: usize> {
    grid: &'a CartesianGrid<D>,
    expression: &'a E,
    f: &'a F,
    layers: std::ops::Range<usize>,
    /// Storage index of the first entry of `out`.
    start: usize,
    out: &'a mut [f64],
}

impl<E: Expression<D>, F: Fn(f64, f64) -> f64, const D: usize> WithSimd for Evaluate<'_, E, F, D> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { grid, expression, f, layers, start, out } = self;
        let rows = grid.rows_per_layer();
        for layer in layers {
            for row in 0..rows {
                let place = RowPlace::new(grid, layer, row);
                let row = expression.row(&place);
                let out = &mut out[place.start - start..][..place.cells];
                for i in 0..out.len() {
                    out[i] = f(out[i], row.at(i));
                }
            }
        }
    }
}
