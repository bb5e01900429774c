//! Sums over slices.
use super::lanes::{Lanes, Places, WIDTH};
use crate::overlap::integrals::Integrals;
use interfaces::Vector;
use pulp::Simd;

/// Slices of a piece: their areas, and the sums of what they add by several rules.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sampled<const N: usize> {
    pub(super) areas: [f64; WIDTH],
    pub(super) sums: [Integrals; N],
}

/// What slices add, summed up with the weights of `N` rules.
pub(super) struct Weighted<'a, S: Simd, const N: usize> {
    simd: S,
    weights: &'a [[f64; WIDTH]; N],
    areas: [f64; WIDTH],
    /// The volume, then three components of the first moment, of the area and of its moment.
    sums: [[S::f64s; 10]; N],
}

impl<'a, S: Simd, const N: usize> Weighted<'a, S, N> {
    #[inline(always)]
    pub(super) fn new(simd: S, weights: &'a [[f64; WIDTH]; N]) -> Self {
        Self { simd, weights, areas: [0.0; WIDTH], sums: [[simd.splat_f64s(0.0); 10]; N] }
    }
    /// Adds slices that are computed at once, after `before` times as many.
    #[inline(always)]
    pub(super) fn add(&mut self, before: usize, slices: [S::f64s; 10]) {
        S::as_mut_simd_f64s(&mut self.areas).0[before] = slices[0];
        for (sums, weights) in self.sums.iter_mut().zip(self.weights) {
            let weight = S::as_simd_f64s(weights).0[before];
            for (sum, now) in sums.iter_mut().zip(slices) {
                *sum = self.simd.mul_add_e_f64s(now, weight, *sum);
            }
        }
    }
    #[inline(always)]
    pub(super) fn finish(self) -> Sampled<N> {
        let mut sums = [Integrals::default(); N];
        for (sums, parts) in sums.iter_mut().zip(&self.sums) {
            let mut all = [0.0; 10];
            for (sum, part) in all.iter_mut().zip(parts) {
                *sum = self.simd.reduce_sum_f64s(*part);
            }
            let [volume, x, y, z, n, m, l, p, q, r] = all;
            *sums = Integrals {
                volume,
                first: Vector::new(x, y, z),
                area: Vector::new(n, m, l),
                moment: Vector::new(p, q, r),
            };
        }
        Sampled { areas: self.areas, sums }
    }
}

/// Sums over the pieces of an outline, and over those of the first body's surface.
#[derive(Clone, Copy)]
pub(super) struct Sums<S: Simd> {
    pub(super) area: Lanes<S>,
    pub(super) first: Places<S>,
    /// ∫ n ds of the part of the surface's normal in the plane.
    pub(super) normal: Places<S>,
    /// ∫ t ds of the part t along the slices' normal.
    pub(super) upward: Lanes<S>,
    /// ∫ x t ds.
    pub(super) arm: Places<S>,
    /// ∫ x × n ds.
    pub(super) turn: Lanes<S>,
}

impl<S: Simd> Sums<S> {
    #[inline(always)]
    pub(super) fn zero(simd: S) -> Self {
        let (none, nowhere) = (Lanes::splat(simd, 0.0), Places::splat(simd, Default::default()));
        Self { area: none, first: nowhere, normal: nowhere, upward: none, arm: nowhere, turn: none }
    }
    /// Adds the triangle between the origin and a chord; both its ends from there, and its normal, as long.
    #[inline(always)]
    fn chord(&mut self, origin: Places<S>, [start, end]: [Places<S>; 2]) -> [Places<S>; 3] {
        let (u, v) = (start - origin, end - origin);
        let double = u.cross(v);
        self.area = self.area + double * 0.5;
        self.first = self.first + (u + v) * (double * (1.0 / 6.0));
        [u, v, Places { x: v.y - u.y, y: u.x - v.x }]
    }
    /// Adds a straight piece with this normal of length one, and if it is the `first` body's what it has of its surface, whose line
    /// moves so fast against its normal.
    #[inline(always)]
    pub(super) fn line(
        &mut self,
        origin: Places<S>,
        ends: [Places<S>; 2],
        unit: Places<S>,
        slope: Lanes<S>,
        first: bool,
    ) {
        let [.., normal] = self.chord(origin, ends);
        if first {
            let middle = (ends[0] + ends[1]) * slope.all(0.5);
            let upward = normal.dot(unit) * slope;
            self.normal = self.normal + normal;
            self.upward = self.upward + upward;
            self.arm = self.arm + middle * upward;
            self.turn = self.turn + middle.cross(normal);
        }
    }
    /// Adds an arc of no more than half a circle of this centre and radius.
    #[inline(always)]
    pub(super) fn arc(
        &mut self,
        origin: Places<S>,
        ends: [Places<S>; 2],
        (centre, r): (Places<S>, Lanes<S>),
        slope: Lanes<S>,
        first: bool,
    ) {
        let [u, v, normal] = self.chord(origin, ends);
        let from = centre - origin;
        let square = normal.dot(normal);
        // Twice the chord's distance from the centre, times the chord.
        let rise = (u + v - from - from).dot(normal);
        let (angle, product) = square.angle(rise.max(square.all(0.0)));
        let bulge = r * r * angle.segment(product);
        self.area = self.area + bulge;
        self.first = self.first + from * bulge + normal * (square * (1.0 / 12.0));
        if first {
            let length = r * angle * 2.0;
            self.normal = self.normal + normal;
            self.upward = self.upward + slope * length;
            self.arm = self.arm + (centre * length + normal * r) * slope;
            self.turn = self.turn + centre.cross(normal);
        }
    }
    /// The first moment about zero where it was about another origin.
    #[inline(always)]
    pub(super) fn about(self, origin: Places<S>) -> Self {
        Self { first: self.first + origin * self.area, ..self }
    }
    /// What slices at these heights add where the surface's normals lead through the origin: [`Self::all`] with no moment.
    #[inline(always)]
    pub(super) fn without_moment(&self, h: Lanes<S>) -> [S::f64s; 10] {
        let mut all = self.all(h);
        all[7..].fill(h.all(0.0).raw());
        all
    }
    /// What slices at these heights add, in the order of [`Weighted`].
    #[inline(always)]
    pub(super) fn all(&self, h: Lanes<S>) -> [S::f64s; 10] {
        let (area, n) = (self.area, self.normal);
        [
            area.raw(),
            self.first.x.raw(),
            self.first.y.raw(),
            (h * area).raw(),
            n.x.raw(),
            n.y.raw(),
            self.upward.raw(),
            (self.arm.y - h * n.y).raw(),
            (h * n.x - self.arm.x).raw(),
            self.turn.raw(),
        ]
    }
}
