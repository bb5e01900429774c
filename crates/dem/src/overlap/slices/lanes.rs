//! Numbers and places of several slices at once.
use super::slice::Place;
use pulp::Simd;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// As many slices as are computed at once.
pub(super) const WIDTH: usize = 8;

/// atan √z/√z for z from 0 to tan²(π/8), by the polynomial through its values at the zeros of the Chebyshev polynomial of
/// degree 12: off by less than 2e-18.
const ARC_TANGENT: [f64; 12] = [
    1.0,
    -0.3333333333333312,
    0.19999999999940893,
    -0.14285714279250245,
    0.11111110744919658,
    -0.09090896809064027,
    0.07692045330902225,
    -0.06662951813629191,
    0.05846878297330872,
    -0.05035102456601552,
    0.03796525745386593,
    -0.017805397205419446,
];
/// tan(π/8).
const EIGHTH: f64 = 0.414_213_562_373_095_03;
/// Half angles of segments up to which their areas go by a series.
const SMALL: f64 = 0.25;

/// One number per slice, as many as the processor takes at once.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lanes<S: Simd> {
    simd: S,
    x: S::f64s,
}

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, x: S::f64s) -> Self {
        Self { simd, x }
    }
    #[inline(always)]
    pub(super) fn splat(simd: S, x: f64) -> Self {
        Self { simd, x: simd.splat_f64s(x) }
    }
    /// The numbers for the processor.
    #[inline(always)]
    pub(super) fn raw(self) -> S::f64s {
        self.x
    }
    /// The same number everywhere.
    #[inline(always)]
    pub(super) fn all(self, x: f64) -> Self {
        Self::splat(self.simd, x)
    }
    #[inline(always)]
    pub(super) fn sqrt(self) -> Self {
        Self { x: self.simd.sqrt_f64s(self.x), ..self }
    }
    #[inline(always)]
    pub(super) fn abs(self) -> Self {
        Self { x: self.simd.abs_f64s(self.x), ..self }
    }
    #[inline(always)]
    pub(super) fn max(self, o: Self) -> Self {
        Self { x: self.simd.max_f64s(self.x, o.x), ..self }
    }
    #[inline(always)]
    pub(super) fn min(self, o: Self) -> Self {
        Self { x: self.simd.min_f64s(self.x, o.x), ..self }
    }
    /// `less` where this is less than `limit`, else `not`.
    #[inline(always)]
    pub(super) fn if_less(self, limit: Self, less: Self, not: Self) -> Self {
        let mask = self.simd.less_than_f64s(self.x, limit.x);
        Self { x: self.simd.select_f64s(mask, less.x, not.x), ..self }
    }
    /// self · b + c.
    #[inline(always)]
    fn times_plus(self, b: Self, c: f64) -> Self {
        Self { x: self.simd.mul_add_e_f64s(self.x, b.x, self.simd.splat_f64s(c)), ..self }
    }
    /// The angle of (`cos`, self), self ≥ 0, and the product of sine and cosine; zero at the origin.
    #[inline(always)]
    pub(super) fn angle(self, cos: Self) -> (Self, Self) {
        let across = cos.abs();
        let (low, high) = (self.min(across), self.max(across).max(self.all(f64::MIN_POSITIVE)));
        // By an eighth less where the tangent is larger than that of half of it.
        let limit = high * EIGHTH;
        let turned = limit.if_less(low, low - high, low) / limit.if_less(low, low + high, high);
        let z = turned * turned;
        let mut sum = self.all(ARC_TANGENT[ARC_TANGENT.len() - 1]);
        for c in ARC_TANGENT[..ARC_TANGENT.len() - 1].iter().rev() {
            sum = sum.times_plus(z, *c);
        }
        let first = sum * turned + limit.if_less(low, self.all(FRAC_PI_4), self.all(0.0));
        let quarter = across.if_less(self, first.from(FRAC_PI_2), first);
        let product = low * high / (low * low + high * high).max(self.all(f64::MIN_POSITIVE));
        let zero = self.all(0.0);
        (cos.if_less(zero, quarter.from(PI), quarter), cos.if_less(zero, -product, product))
    }
    /// α − sin α cos α with α = self and that `product`: the area of the segment that spans 2α of the unit circle.
    #[inline(always)]
    pub(super) fn segment(self, product: Self) -> Self {
        let square = self * self;
        let x = square * 4.0;
        let mut series = self.all(1.0);
        for per in [156.0, 110.0, 72.0, 42.0, 20.0] {
            series = (series * x).times_plus(self.all(-1.0 / per), 1.0);
        }
        self.if_less(self.all(SMALL), square * self * series * (2.0 / 3.0), self - product)
    }
    #[inline(always)]
    fn from(self, x: f64) -> Self {
        self.all(x) - self
    }
}

impl<S: Simd> Add for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self { x: self.simd.add_f64s(self.x, o.x), ..self }
    }
}
impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self { x: self.simd.sub_f64s(self.x, o.x), ..self }
    }
}
impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        Self { x: self.simd.mul_f64s(self.x, o.x), ..self }
    }
}
impl<S: Simd> Div for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        Self { x: self.simd.div_f64s(self.x, o.x), ..self }
    }
}
impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { x: self.simd.neg_f64s(self.x), ..self }
    }
}
impl<S: Simd> Add<f64> for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: f64) -> Self {
        self + self.all(o)
    }
}
impl<S: Simd> Sub<f64> for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: f64) -> Self {
        self - self.all(o)
    }
}
impl<S: Simd> Mul<f64> for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: f64) -> Self {
        self * self.all(o)
    }
}

/// A place or vector in each slice.
#[derive(Clone, Copy, Debug)]
pub(super) struct Places<S: Simd> {
    pub(super) x: Lanes<S>,
    pub(super) y: Lanes<S>,
}

impl<S: Simd> Places<S> {
    /// The same in all.
    #[inline(always)]
    pub(super) fn splat(simd: S, place: Place) -> Self {
        Self { x: Lanes::splat(simd, place.x), y: Lanes::splat(simd, place.y) }
    }
    #[inline(always)]
    pub(super) fn dot(self, o: Self) -> Lanes<S> {
        self.x * o.x + self.y * o.y
    }
    #[inline(always)]
    pub(super) fn cross(self, o: Self) -> Lanes<S> {
        self.x * o.y - self.y * o.x
    }
}
impl<S: Simd> Add for Places<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self { x: self.x + o.x, y: self.y + o.y }
    }
}
impl<S: Simd> Sub for Places<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self { x: self.x - o.x, y: self.y - o.y }
    }
}
impl<S: Simd> Mul<Lanes<S>> for Places<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Lanes<S>) -> Self {
        Self { x: self.x * o, y: self.y * o }
    }
}
