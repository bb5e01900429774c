//! Integrals, norms and extremes over the cells.
use crate::algebra::{Expression, GridMismatch, LANES, Operand, RowExpression, RowPlace};
use crate::kernels::layers_per_task;
use crate::parts::each_result;
use crate::{CartesianGrid, Field};
use pulp::{Arch, Simd, WithSimd};

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
/// [`velocity_norms`](Self::velocity_norms) measures the error of a staggered velocity on its faces.
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

    /// The grid.
    pub(super) fn grid(&self) -> &CartesianGrid<D> {
        &self.grid
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
    /// [`CartesianGrid::function`] that to an exact solution. For a velocity see [`velocity_norms`](Self::velocity_norms).
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
        let per_layer = self.grid.rows_per_layer();
        let mut found: Option<(f64, [usize; D])> = None;
        for r in 0..self.grid.cells()[D - 1] * per_layer {
            let place = RowPlace::new(&self.grid, r / per_layer, r % per_layer);
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
        let layers = self.grid.cells()[D - 1];
        let per_task = layers_per_task(layers);
        // At most 16 tasks.
        let mut parts = [Totals::default(); 16];
        each_result(self.grid.n_cells(), &mut parts[..layers.div_ceil(per_task)], &|task, part| {
            let first = task * per_task;
            let layers = first..(first + per_task).min(layers);
            *part = Arch::new().dispatch(Layers { integrals: self, expression: &expression, layers });
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

/// [`Totals`] in as many partial sums as fill vector registers.
#[derive(Default)]
struct Lanes {
    sum: [f64; LANES],
    absolute: [f64; LANES],
    square: [f64; LANES],
    largest: [f64; LANES],
    check: [f64; LANES],
}

impl Lanes {
    /// Adds the values `f` of cells of volumes `across`·`along`.
    #[inline(always)]
    fn add(&mut self, across: f64, along: &[f64; LANES], f: &[f64; LANES]) {
        for l in 0..LANES {
            let (volume, size) = (across * along[l], f[l].abs());
            self.sum[l] += volume * f[l];
            self.absolute[l] += volume * size;
            self.square[l] += volume * f[l] * f[l];
            self.largest[l] = if size > self.largest[l] { size } else { self.largest[l] };
            self.check[l] += if f[l].is_nan() { f[l] } else { 0.0 };
        }
    }

    fn totals(self) -> Totals {
        let add = |lanes: [f64; LANES]| lanes.into_iter().sum();
        Totals {
            sum: add(self.sum),
            absolute: add(self.absolute),
            square: add(self.square),
            largest: self.largest.into_iter().fold(0.0, f64::max),
            check: add(self.check),
        }
    }
}

/// Sums over a run of layers.
struct Layers<'a, E, const D: usize> {
    integrals: &'a Integrals<D>,
    expression: &'a E,
    layers: std::ops::Range<usize>,
}

impl<E: Expression<D>, const D: usize> WithSimd for Layers<'_, E, D> {
    type Output = Totals;
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Totals {
        let Self { integrals: Integrals { grid, widths }, expression, layers } = self;
        let mut lanes = Lanes::default();
        let (whole, rest) = widths[0].as_chunks::<LANES>();
        let rows = grid.rows_per_layer();
        for layer in layers {
            for row in 0..rows {
                let place = RowPlace::new(grid, layer, row);
                let row = expression.row(&place);
                let mut across = 1.0;
                for a in 1..D {
                    across *= widths[a][place.at[a]];
                }
                for (block, along) in whole.iter().enumerate() {
                    lanes.add(across, along, &row.block(block * LANES));
                }
                // The cells left, filled up with zeros.
                let (mut along, mut f) = ([0.0; LANES], [0.0; LANES]);
                for l in 0..rest.len() {
                    (along[l], f[l]) = (rest[l], row.at(place.cells - rest.len() + l));
                }
                lanes.add(across, &along, &f);
            }
        }
        lanes.totals()
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
