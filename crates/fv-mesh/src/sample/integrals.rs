//! Integrals, norms and extremes over the cells.
use crate::algebra::{Expression, GridMismatch, LANES, Operand, RowExpression, RowPlace};
use crate::kernels::layers_per_task;
use crate::{CartesianGrid, Field};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// Norms of a field f in a box of volume V, each cell weighted with its volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Norms {
    /// (1/V) ∫ |f| dV.
    pub l1: f64,
    /// √((1/V) ∫ f² dV).
    pub l2: f64,
    /// max |f| over the cells.
    pub linf: f64,
}

/// The least or greatest value of a field and where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extreme<const D: usize> {
    /// The value.
    pub value: f64,
    /// Its cell, the first of several equals, x fastest.
    pub cell: [usize; D],
    /// Centre of that cell \[m\].
    pub x: [f64; D],
}

/// Sums fields and [expressions](crate::algebra) over the cells of a grid by the midpoint rule, of second order:
///
/// ```
/// use fv_mesh::{CartesianGrid, Field, Integrals};
///
/// let grid = CartesianGrid::new([64, 64], [1.0, 2.0])?;
/// let a = Field::from_fn(&grid, |x| x[0] * x[1]);
/// let over = Integrals::new(&grid);
/// assert!((over.integral(&a)? - 1.0).abs() < 1e-12);
/// let error = over.norms(&a - grid.function(|x| x[0] * x[1]))?;
/// assert_eq!(error.linf, 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Sums run in an order that does not depend on the number of threads. A value that is not a number makes every
/// result that it enters one.
#[derive(Clone, Debug)]
pub struct Integrals<const D: usize> {
    grid: CartesianGrid<D>,
    widths: [Vec<f64>; D],
}

impl<const D: usize> Integrals<D> {
    /// Over the cells of `grid`.
    pub fn new(grid: &CartesianGrid<D>) -> Self {
        let widths = std::array::from_fn(|a| {
            let axis = grid.axis(a);
            (0..axis.cells()).map(|i| axis.width(i)).collect()
        });
        Self { grid: grid.clone(), widths }
    }

    /// ∫ f dV.
    ///
    /// # Errors
    /// [`GridMismatch`] if an operand lives on another grid.
    pub fn integral<A: Operand<Node: Expression<D>>>(&self, f: A) -> Result<f64, GridMismatch> {
        Ok(self.totals(f)?.sum)
    }

    /// (1/V) ∫ f dV.
    ///
    /// # Errors
    /// Those of [`integral`](Self::integral).
    pub fn mean<A: Operand<Node: Expression<D>>>(&self, f: A) -> Result<f64, GridMismatch> {
        Ok(self.integral(f)? / self.grid.volume())
    }

    /// The norms of f; those of a − b measure the difference of two fields, and with
    /// [`CartesianGrid::function`] that to an exact solution.
    ///
    /// # Errors
    /// Those of [`integral`](Self::integral).
    pub fn norms<A: Operand<Node: Expression<D>>>(&self, f: A) -> Result<Norms, GridMismatch> {
        let (totals, volume) = (self.totals(f)?, self.grid.volume());
        Ok(Norms {
            l1: totals.absolute / volume,
            l2: (totals.square / volume).sqrt(),
            linf: totals.largest + totals.check,
        })
    }

    /// max |f| over the cells.
    ///
    /// # Errors
    /// Those of [`integral`](Self::integral).
    pub fn largest<A: Operand<Node: Expression<D>>>(&self, f: A) -> Result<f64, GridMismatch> {
        Ok(self.norms(f)?.linf)
    }

    /// The least value.
    ///
    /// # Errors
    /// Those of [`integral`](Self::integral).
    pub fn minimum<A: Operand<Node: Expression<D>>>(&self, f: A) -> Result<Extreme<D>, GridMismatch> {
        self.extreme(f, |a, b| a < b)
    }

    /// The greatest value.
    ///
    /// # Errors
    /// Those of [`integral`](Self::integral).
    pub fn maximum<A: Operand<Node: Expression<D>>>(&self, f: A) -> Result<Extreme<D>, GridMismatch> {
        self.extreme(f, |a, b| a > b)
    }

    fn extreme<A: Operand<Node: Expression<D>>>(
        &self,
        f: A,
        beyond: impl Fn(f64, f64) -> bool,
    ) -> Result<Extreme<D>, GridMismatch> {
        let expression = f.node();
        expression.check(&self.grid)?;
        let rows = self.grid.n_cells() / self.grid.cells()[0];
        let mut found: Option<(f64, [usize; D])> = None;
        for r in 0..rows {
            let place = RowPlace::new(&self.grid, r);
            let row = expression.row(&place);
            for i in 0..place.cells {
                let value = row.at(i);
                if found.is_none_or(|(top, _)| beyond(value, top) || value.is_nan() && !top.is_nan()) {
                    let mut cell = place.at;
                    cell[0] = i;
                    found = Some((value, cell));
                }
            }
        }
        // A grid has at least one cell.
        let (value, cell) = found.unwrap_or((f64::NAN, [0; D]));
        Ok(Extreme { value, cell, x: self.grid.centre(cell) })
    }

    fn totals<A: Operand<Node: Expression<D>>>(&self, f: A) -> Result<Totals, GridMismatch> {
        let expression = f.node();
        expression.check(&self.grid)?;
        let (layers, rows) = (self.grid.cells()[D - 1], self.grid.rows_per_layer());
        let per_task = layers_per_task(layers);
        // At most 16 tasks.
        let mut parts = [Totals::default(); 16];
        parts[..layers.div_ceil(per_task)].par_iter_mut().enumerate().for_each(|(task, part)| {
            let first = task * per_task;
            let end = (first + per_task).min(layers);
            let rows = first * rows..end * rows;
            *part = Arch::new().dispatch(Rows { integrals: self, expression: &expression, rows });
        });
        Ok(parts.into_iter().fold(Totals::default(), Totals::plus))
    }
}

/// Sums over the cells, each weighted with its volume.
#[derive(Clone, Copy, Debug, Default)]
struct Totals {
    sum: f64,
    absolute: f64,
    square: f64,
    /// Largest |f|, passing over what is not a number.
    largest: f64,
    /// 0, or not a number if a value is none.
    check: f64,
}

impl Totals {
    fn plus(self, other: Self) -> Self {
        Self {
            sum: self.sum + other.sum,
            absolute: self.absolute + other.absolute,
            square: self.square + other.square,
            largest: self.largest.max(other.largest),
            check: self.check + other.check,
        }
    }
}

/// Sums over a run of rows.
struct Rows<'a, E, const D: usize> {
    integrals: &'a Integrals<D>,
    expression: &'a E,
    rows: std::ops::Range<usize>,
}

impl<E: Expression<D>, const D: usize> WithSimd for Rows<'_, E, D> {
    type Output = Totals;
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Totals {
        let Self { integrals: Integrals { grid, widths }, expression, rows } = self;
        let mut totals = Totals::default();
        for r in rows {
            let place = RowPlace::new(grid, r);
            let row = expression.row(&place);
            let along = &widths[0][..place.cells];
            let (mut sum, mut absolute, mut square) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
            let (mut largest, mut unordered) = ([0.0_f64; LANES], [0.0_f64; LANES]);
            let mut last = [0.0; LANES];
            let mut take = |w: &[f64], f: &[f64]| {
                for (l, (w, f)) in w.iter().zip(f).enumerate() {
                    let size = f.abs();
                    sum[l] += w * f;
                    absolute[l] += w * size;
                    square[l] += w * f * f;
                    largest[l] = if size > largest[l] { size } else { largest[l] };
                    unordered[l] += if f.is_nan() { *f } else { 0.0 };
                }
            };
            let (whole, rest) = along.as_chunks::<LANES>();
            for (block, along) in whole.iter().enumerate() {
                take(along, &row.block(block * LANES));
            }
            let first = place.cells - rest.len();
            for l in 0..rest.len() {
                last[l] = row.at(first + l);
            }
            take(rest, &last[..rest.len()]);
            let across: f64 = (1..D).map(|a| widths[a][place.at[a]]).product();
            let add = |lanes: [f64; LANES]| lanes.into_iter().sum::<f64>();
            totals = totals.plus(Totals {
                sum: across * add(sum),
                absolute: across * add(absolute),
                square: across * add(square),
                largest: largest.into_iter().fold(0.0, f64::max),
                check: add(unordered),
            });
        }
        totals
    }
}

impl<const D: usize> Field<D> {
    /// The first cell, x fastest, whose value is not a finite number.
    pub fn first_not_finite(&self) -> Option<Extreme<D>> {
        let index = self.values().position(|v| !v.is_finite())?;
        let cell = self.grid().cell(index);
        let value = self.row(index / self.grid().cells()[0])[cell[0]];
        Some(Extreme { value, cell, x: self.grid().centre(cell) })
    }
}
