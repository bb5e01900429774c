//! The operators that build expressions.
use super::nodes::{
    Absolute, Binary, Cells, Constant, Function, Higher, Lower, Map, Minus, Negative, Over, Plus, Root,
    Square, Times, Unary,
};
use super::{Expression, GridMismatch, Operand, RowPlace};
use crate::{CartesianGrid, Field};
use std::marker::PhantomData;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// An expression in fields, numbers and functions of place.
#[derive(Clone, Copy, Debug)]
#[must_use = "an expression is evaluated when it is assigned or summed"]
pub struct Expr<E>(pub(super) E);

impl<E: Expression<D>, const D: usize> Expression<D> for Expr<E> {
    type Row<'r>
        = E::Row<'r>
    where
        Self: 'r;
    fn check(&self, grid: &CartesianGrid<D>) -> Result<(), GridMismatch> {
        self.0.check(grid)
    }
    #[inline(always)]
    fn row(&self, place: &RowPlace<D>) -> Self::Row<'_> {
        self.0.row(place)
    }
}

impl<E> Operand for Expr<E> {
    type Node = E;
    fn node(self) -> E {
        self.0
    }
}
impl<'a, const D: usize> Operand for &'a Field<D> {
    type Node = Cells<'a, D>;
    fn node(self) -> Cells<'a, D> {
        Cells(self)
    }
}
impl Operand for f64 {
    type Node = Constant;
    fn node(self) -> Constant {
        Constant(self)
    }
}

fn binary<O, A: Operand, B: Operand>(a: A, b: B) -> Expr<Binary<O, A::Node, B::Node>> {
    Expr(Binary { a: a.node(), b: b.node(), operation: PhantomData })
}
fn unary<T, A: Operand>(a: A) -> Expr<Unary<T, A::Node>> {
    Expr(Unary { a: a.node(), transformation: PhantomData })
}

macro_rules! operators {
    ($($operator:ident, $method:ident, $operation:ident;)*) => {$(
        impl<A, B: Operand> $operator<B> for Expr<A> {
            type Output = Expr<Binary<$operation, A, B::Node>>;
            fn $method(self, b: B) -> Self::Output {
                binary(self, b)
            }
        }
        impl<'a, B: Operand, const D: usize> $operator<B> for &'a Field<D> {
            type Output = Expr<Binary<$operation, Cells<'a, D>, B::Node>>;
            fn $method(self, b: B) -> Self::Output {
                binary(self, b)
            }
        }
        impl<B> $operator<Expr<B>> for f64 {
            type Output = Expr<Binary<$operation, Constant, B>>;
            fn $method(self, b: Expr<B>) -> Self::Output {
                binary(self, b)
            }
        }
        impl<'a, const D: usize> $operator<&'a Field<D>> for f64 {
            type Output = Expr<Binary<$operation, Constant, Cells<'a, D>>>;
            fn $method(self, b: &'a Field<D>) -> Self::Output {
                binary(self, b)
            }
        }
    )*};
}

operators! {
    Add, add, Plus;
    Sub, sub, Minus;
    Mul, mul, Times;
    Div, div, Over;
}

impl<A> Neg for Expr<A> {
    type Output = Expr<Unary<Negative, A>>;
    fn neg(self) -> Self::Output {
        unary(self)
    }
}
impl<'a, const D: usize> Neg for &'a Field<D> {
    type Output = Expr<Unary<Negative, Cells<'a, D>>>;
    fn neg(self) -> Self::Output {
        unary(self)
    }
}

/// The functions of an expression, for `Expr` and `Field` alike.
macro_rules! functions {
    ($this:ty, $node:ty $(, $life:lifetime)?) => {
        /// |a|.
        pub fn abs($(& $life)? self) -> Expr<Unary<Absolute, $node>> {
            unary(self)
        }
        /// √a, not a number where a < 0.
        pub fn sqrt($(& $life)? self) -> Expr<Unary<Root, $node>> {
            unary(self)
        }
        /// a².
        pub fn square($(& $life)? self) -> Expr<Unary<Square, $node>> {
            unary(self)
        }
        /// The lesser of both at every cell.
        pub fn min<B: Operand>($(& $life)? self, b: B) -> Expr<Binary<Lower, $node, B::Node>> {
            binary(self, b)
        }
        /// The greater of both at every cell.
        pub fn max<B: Operand>($(& $life)? self, b: B) -> Expr<Binary<Higher, $node, B::Node>> {
            binary(self, b)
        }
        /// f(a).
        pub fn map<F: Fn(f64) -> f64 + Sync>($(& $life)? self, f: F) -> Expr<Map<F, $node>> {
            Expr(Map { a: self.node(), f })
        }
    };
}

impl<A> Expr<A> {
    functions!(Self, A);
}
impl<'a, const D: usize> Field<D> {
    functions!(&'a Self, Cells<'a, D>, 'a);
}

impl<const D: usize> CartesianGrid<D> {
    /// f(x) at the centres x \[m\] of the cells, to be used in an expression.
    pub fn function<F: Fn([f64; D]) -> f64 + Sync>(&self, f: F) -> Expr<Function<'_, F, D>> {
        Expr(Function { grid: self, f })
    }
}
