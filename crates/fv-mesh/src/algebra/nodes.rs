//! The nodes of an expression tree.
use super::{Expression, GridMismatch, LANES, RowExpression, check_grid};
use crate::{CartesianGrid, Field};
use std::marker::PhantomData;

/// A row of cells along x.
#[derive(Clone, Copy, Debug)]
pub struct RowPlace<const D: usize> {
    /// Storage index of its first cell.
    pub(crate) start: usize,
    /// Number of cells.
    pub(crate) cells: usize,
    /// Its first cell.
    pub(crate) at: [usize; D],
}

impl<const D: usize> RowPlace<D> {
    /// Row `row` of layer `layer` of the last axis.
    #[inline(always)]
    pub(crate) fn new(grid: &CartesianGrid<D>, layer: usize, row: usize) -> Self {
        let mut at = [0; D];
        at[D - 1] = layer;
        if D == 3 {
            at[1] = row;
        }
        let stride = grid.stride();
        let start = grid.base() + (1..D).map(|a| at[a] * stride[a]).sum::<usize>();
        Self { start, cells: grid.axis(0).cells(), at }
    }
}

/// The cells of a field.
#[derive(Clone, Copy, Debug)]
pub struct Cells<'a, const D: usize>(pub(super) &'a Field<D>);

impl<const D: usize> Expression<D> for Cells<'_, D> {
    type Row<'r>
        = &'r [f64]
    where
        Self: 'r;
    fn check(&self, grid: &CartesianGrid<D>) -> Result<(), GridMismatch> {
        check_grid(grid, self.0.grid())
    }
    #[inline(always)]
    fn row(&self, place: &RowPlace<D>) -> &[f64] {
        &self.0.data()[place.start..][..place.cells]
    }
}

impl RowExpression for &[f64] {
    #[inline(always)]
    fn at(&self, i: usize) -> f64 {
        self[i]
    }
    #[inline(always)]
    fn block(&self, i: usize) -> [f64; LANES] {
        let mut block = [0.0; LANES];
        block.copy_from_slice(&self[i..][..LANES]);
        block
    }
}

/// A number.
#[derive(Clone, Copy, Debug)]
pub struct Constant(pub(super) f64);

impl<const D: usize> Expression<D> for Constant {
    type Row<'r> = Constant;
    fn check(&self, _: &CartesianGrid<D>) -> Result<(), GridMismatch> {
        Ok(())
    }
    #[inline(always)]
    fn row(&self, _: &RowPlace<D>) -> Self {
        *self
    }
}

impl RowExpression for Constant {
    #[inline(always)]
    fn at(&self, _: usize) -> f64 {
        self.0
    }
    #[inline(always)]
    fn block(&self, _: usize) -> [f64; LANES] {
        [self.0; LANES]
    }
}

/// A function of place at the centres of the cells.
#[derive(Clone, Copy, Debug)]
pub struct Function<'a, F, const D: usize> {
    pub(super) grid: &'a CartesianGrid<D>,
    pub(super) f: F,
}

/// A function of place along a row.
#[derive(Clone, Copy, Debug)]
pub struct FunctionRow<'a, F, const D: usize> {
    faces: &'a [f64],
    f: &'a F,
    /// A place on the row.
    x: [f64; D],
}

impl<F: Fn([f64; D]) -> f64 + Sync, const D: usize> Expression<D> for Function<'_, F, D> {
    type Row<'r>
        = FunctionRow<'r, F, D>
    where
        Self: 'r;
    fn check(&self, grid: &CartesianGrid<D>) -> Result<(), GridMismatch> {
        check_grid(grid, self.grid)
    }
    #[inline(always)]
    fn row(&self, place: &RowPlace<D>) -> FunctionRow<'_, F, D> {
        FunctionRow { faces: self.grid.axis(0).faces(), f: &self.f, x: self.grid.centre(place.at) }
    }
}

impl<F: Fn([f64; D]) -> f64, const D: usize> RowExpression for FunctionRow<'_, F, D> {
    #[inline(always)]
    fn at(&self, i: usize) -> f64 {
        let mut x = self.x;
        x[0] = 0.5 * (self.faces[i] + self.faces[i + 1]);
        (self.f)(x)
    }
    #[inline(always)]
    fn block(&self, i: usize) -> [f64; LANES] {
        std::array::from_fn(|l| self.at(i + l))
    }
}

/// An operation on two numbers.
pub trait Operation: Sync {
    /// Its result.
    fn apply(a: f64, b: f64) -> f64;
}

macro_rules! operations {
    ($($name:ident: $doc:literal, |$a:ident, $b:ident| $result:expr;)*) => {$(
        #[doc = $doc]
        #[derive(Clone, Copy, Debug)]
        pub struct $name;
        impl Operation for $name {
            #[inline(always)]
            fn apply($a: f64, $b: f64) -> f64 {
                $result
            }
        }
    )*};
}

operations! {
    Plus: "a + b.", |a, b| a + b;
    Minus: "a − b.", |a, b| a - b;
    Times: "a b.", |a, b| a * b;
    Over: "a/b.", |a, b| a / b;
    Lower: "The lesser of a and b; not a number if one of them is not.",
        |a, b| if a < b || a.is_nan() { a } else { b };
    Higher: "The greater of a and b; not a number if one of them is not.",
        |a, b| if a > b || a.is_nan() { a } else { b };
}

/// An operation on two expressions.
#[derive(Clone, Copy, Debug)]
pub struct Binary<O, A, B> {
    pub(super) a: A,
    pub(super) b: B,
    pub(super) operation: PhantomData<O>,
}

/// An operation on two expressions along a row.
#[derive(Clone, Copy, Debug)]
pub struct BinaryRow<O, A, B> {
    a: A,
    b: B,
    operation: PhantomData<O>,
}

impl<O: Operation, A: Expression<D>, B: Expression<D>, const D: usize> Expression<D> for Binary<O, A, B> {
    type Row<'r>
        = BinaryRow<O, A::Row<'r>, B::Row<'r>>
    where
        Self: 'r;
    fn check(&self, grid: &CartesianGrid<D>) -> Result<(), GridMismatch> {
        self.a.check(grid)?;
        self.b.check(grid)
    }
    #[inline(always)]
    fn row(&self, place: &RowPlace<D>) -> Self::Row<'_> {
        BinaryRow { a: self.a.row(place), b: self.b.row(place), operation: PhantomData }
    }
}

impl<O: Operation, A: RowExpression, B: RowExpression> RowExpression for BinaryRow<O, A, B> {
    #[inline(always)]
    fn at(&self, i: usize) -> f64 {
        O::apply(self.a.at(i), self.b.at(i))
    }
    #[inline(always)]
    fn block(&self, i: usize) -> [f64; LANES] {
        let (a, b) = (self.a.block(i), self.b.block(i));
        std::array::from_fn(|l| O::apply(a[l], b[l]))
    }
}

/// A function of one number.
pub trait Transformation: Sync {
    /// Its result.
    fn apply(a: f64) -> f64;
}

macro_rules! transformations {
    ($($name:ident: $doc:literal, |$a:ident| $result:expr;)*) => {$(
        #[doc = $doc]
        #[derive(Clone, Copy, Debug)]
        pub struct $name;
        impl Transformation for $name {
            #[inline(always)]
            fn apply($a: f64) -> f64 {
                $result
            }
        }
    )*};
}

transformations! {
    Negative: "−a.", |a| -a;
    Absolute: "|a|.", |a| a.abs();
    Root: "√a.", |a| a.sqrt();
    Square: "a².", |a| a * a;
}

/// A function of one expression.
#[derive(Clone, Copy, Debug)]
pub struct Unary<T, A> {
    pub(super) a: A,
    pub(super) transformation: PhantomData<T>,
}

/// A function of one expression along a row.
#[derive(Clone, Copy, Debug)]
pub struct UnaryRow<T, A> {
    a: A,
    transformation: PhantomData<T>,
}

impl<T: Transformation, A: Expression<D>, const D: usize> Expression<D> for Unary<T, A> {
    type Row<'r>
        = UnaryRow<T, A::Row<'r>>
    where
        Self: 'r;
    fn check(&self, grid: &CartesianGrid<D>) -> Result<(), GridMismatch> {
        self.a.check(grid)
    }
    #[inline(always)]
    fn row(&self, place: &RowPlace<D>) -> Self::Row<'_> {
        UnaryRow { a: self.a.row(place), transformation: PhantomData }
    }
}

impl<T: Transformation, A: RowExpression> RowExpression for UnaryRow<T, A> {
    #[inline(always)]
    fn at(&self, i: usize) -> f64 {
        T::apply(self.a.at(i))
    }
    #[inline(always)]
    fn block(&self, i: usize) -> [f64; LANES] {
        self.a.block(i).map(T::apply)
    }
}

/// Any function of an expression.
#[derive(Clone, Copy, Debug)]
pub struct Map<F, A> {
    pub(super) a: A,
    pub(super) f: F,
}

/// Any function of an expression along a row.
#[derive(Clone, Copy, Debug)]
pub struct MapRow<'a, F, A> {
    a: A,
    f: &'a F,
}

impl<F: Fn(f64) -> f64 + Sync, A: Expression<D>, const D: usize> Expression<D> for Map<F, A> {
    type Row<'r>
        = MapRow<'r, F, A::Row<'r>>
    where
        Self: 'r;
    fn check(&self, grid: &CartesianGrid<D>) -> Result<(), GridMismatch> {
        self.a.check(grid)
    }
    #[inline(always)]
    fn row(&self, place: &RowPlace<D>) -> Self::Row<'_> {
        MapRow { a: self.a.row(place), f: &self.f }
    }
}

impl<F: Fn(f64) -> f64, A: RowExpression> RowExpression for MapRow<'_, F, A> {
    #[inline(always)]
    fn at(&self, i: usize) -> f64 {
        (self.f)(self.a.at(i))
    }
    #[inline(always)]
    fn block(&self, i: usize) -> [f64; LANES] {
        self.a.block(i).map(self.f)
    }
}
