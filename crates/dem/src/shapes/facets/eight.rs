//! Numbers and bits side by side.
use super::WIDTH;
use pulp::Simd;
use std::ops::{Add, BitAnd, BitOr, Mul, Range, Sub};

/// The parts that eight lanes come in: as many as the processor needs for them.
#[inline(always)]
pub(crate) fn parts<S: Simd>() -> Range<usize> {
    0..WIDTH.div_ceil(S::F32_LANES)
}

/// Numbers in single precision, as many as the processor takes at once.
#[derive(Clone, Copy)]
pub(crate) struct Singles<S: Simd> {
    simd: S,
    x: S::f32s,
}

/// As many words of 32 bits.
#[derive(Clone, Copy)]
pub(crate) struct Words<S: Simd> {
    simd: S,
    x: S::u32s,
}

impl<S: Simd> Singles<S> {
    /// A part of eight.
    #[inline(always)]
    pub(crate) fn load(simd: S, lanes: &[f32; WIDTH], part: usize) -> Self {
        let whole = S::as_simd_f32s(lanes).0;
        let x = if S::F32_LANES <= WIDTH { whole[part] } else { simd.partial_load_f32s(lanes) };
        Self { simd, x }
    }
    /// A part of the coordinates of eight points.
    #[inline(always)]
    pub(crate) fn load_all(simd: S, [x, y, z]: &[[f32; WIDTH]; 3], part: usize) -> [Self; 3] {
        [Self::load(simd, x, part), Self::load(simd, y, part), Self::load(simd, z, part)]
    }
    /// The same point everywhere.
    #[inline(always)]
    pub(crate) fn splat_all(simd: S, [x, y, z]: [f32; 3]) -> [Self; 3] {
        [Self::splat(simd, x), Self::splat(simd, y), Self::splat(simd, z)]
    }
    /// The same one everywhere.
    #[inline(always)]
    pub(crate) fn splat(simd: S, x: f32) -> Self {
        Self { simd, x: simd.splat_f32s(x) }
    }
    /// self · b + c, rounded once or twice.
    #[inline(always)]
    pub(crate) fn mul_add(self, b: Self, c: Self) -> Self {
        Self { x: self.simd.mul_add_e_f32s(self.x, b.x, c.x), ..self }
    }
    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        Self { x: self.simd.abs_f32s(self.x), ..self }
    }
    /// All bits where this is greater; none where either is no number.
    #[inline(always)]
    pub(crate) fn above(self, o: Self) -> Words<S> {
        let simd = self.simd;
        let mask = simd.greater_than_f32s(self.x, o.x);
        Words { simd, x: simd.select_u32s(mask, simd.splat_u32s(u32::MAX), simd.splat_u32s(0)) }
    }
}

impl<S: Simd> Add for Singles<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self { x: self.simd.add_f32s(self.x, o.x), ..self }
    }
}

impl<S: Simd> Sub for Singles<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self { x: self.simd.sub_f32s(self.x, o.x), ..self }
    }
}

impl<S: Simd> Mul for Singles<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        Self { x: self.simd.mul_f32s(self.x, o.x), ..self }
    }
}

/// a − b of vectors.
#[inline(always)]
pub(crate) fn minus<S: Simd>(a: [Singles<S>; 3], b: [Singles<S>; 3]) -> [Singles<S>; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// a·b of vectors.
#[inline(always)]
pub(crate) fn dot<S: Simd>(a: [Singles<S>; 3], b: [Singles<S>; 3]) -> Singles<S> {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

/// a × b of vectors.
#[inline(always)]
pub(crate) fn cross<S: Simd>(a: [Singles<S>; 3], b: [Singles<S>; 3]) -> [Singles<S>; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

impl<S: Simd> Words<S> {
    /// A part of eight.
    #[inline(always)]
    pub(crate) fn load(simd: S, lanes: &[u32; WIDTH], part: usize) -> Self {
        let whole = S::as_simd_u32s(lanes).0;
        let x = if S::U32_LANES <= WIDTH { whole[part] } else { simd.partial_load_u32s(lanes) };
        Self { simd, x }
    }
    /// The same one everywhere.
    #[inline(always)]
    pub(crate) fn splat(simd: S, x: u32) -> Self {
        Self { simd, x: simd.splat_u32s(x) }
    }
    /// Puts them into a part of eight.
    #[inline(always)]
    pub(crate) fn store(self, lanes: &mut [u32; WIDTH], part: usize) {
        if S::U32_LANES <= WIDTH {
            S::as_mut_simd_u32s(lanes).0[part] = self.x;
        } else {
            self.simd.partial_store_u32s(lanes, self.x);
        }
    }
    /// The bits that `o` does not have.
    #[inline(always)]
    pub(crate) fn without(self, o: Self) -> Self {
        self & Self { x: self.simd.not_u32s(o.x), ..o }
    }
    /// A bit for each lane of a part that has none set; lanes have all bits set or none.
    #[inline(always)]
    pub(crate) fn lacking(self, part: usize) -> u32 {
        let mut bits = [0; WIDTH];
        Self::load(self.simd, &BITS, part).without(self).store(&mut bits, part);
        bits.into_iter().fold(0, |all, bit| all | bit)
    }
    /// 0 − self: of words below 2³¹, the highest bit is set if any is.
    #[inline(always)]
    pub(crate) fn negative(self) -> Self {
        Self { x: self.simd.sub_u32s(self.simd.splat_u32s(0), self.x), ..self }
    }
    /// The highest bit alone, in this `place`.
    #[inline(always)]
    pub(crate) fn highest(self, place: usize) -> Self {
        let one = self.simd.wrapping_dyn_shr_u32s(self.x, self.simd.splat_u32s(31));
        Self { x: self.simd.wrapping_dyn_shl_u32s(one, self.simd.splat_u32s(place as u32)), ..self }
    }
}

/// A bit for each lane.
const BITS: [u32; WIDTH] = [1, 2, 4, 8, 16, 32, 64, 128];

impl<S: Simd> BitAnd for Words<S> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, o: Self) -> Self {
        Self { x: self.simd.and_u32s(self.x, o.x), ..self }
    }
}

impl<S: Simd> BitOr for Words<S> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, o: Self) -> Self {
        Self { x: self.simd.or_u32s(self.x, o.x), ..self }
    }
}
