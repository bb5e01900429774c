//! What several slices add.
use super::lanes::{Lanes, Places, WIDTH};
use crate::overlap::integrals::Integrals;
use interfaces::Vector;
use pulp::Simd;

/// What slices add per height: the volume, then three components of the first moment, of the area and of its moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Eight(pub(super) [[f64; WIDTH]; 10]);

impl Default for Eight {
    fn default() -> Self {
        Self([[0.0; WIDTH]; 10])
    }
}

impl Eight {
    /// Areas of the slices.
    pub(super) fn areas(&self) -> &[f64; WIDTH] {
        &self.0[0]
    }
    /// The sums over all slices, each times its weight.
    pub(super) fn weighted(&self, weights: &[f64; WIDTH]) -> Integrals {
        let [volume, x, y, z, n, m, l, p, q, r] = self.0.map(|values| {
            let products: [f64; WIDTH] = std::array::from_fn(|i| values[i] * weights[i]);
            let four: [f64; 4] = std::array::from_fn(|i| products[i] + products[i + 4]);
            (four[0] + four[2]) + (four[1] + four[3])
        });
        let [first, area, moment] = [[x, y, z], [n, m, l], [p, q, r]].map(Vector::from);
        Integrals { volume, first, area, moment }
    }
    /// A slice of this area at a height, whose first moment and whose surface's area lead along the slices' normal.
    pub(super) fn set_upright(&mut self, slice: usize, area: f64, h: f64, upward: f64) {
        (self.0[0][slice], self.0[3][slice], self.0[6][slice]) = (area, h * area, upward);
    }
    /// Slices that are computed at once, after `before` times as many.
    #[inline(always)]
    pub(super) fn set<S: Simd>(&mut self, before: usize, now: [S::f64s; 10]) {
        for (values, now) in self.0.iter_mut().zip(now) {
            S::as_mut_simd_f64s(values).0[before] = now;
        }
    }
    /// Leaves out a slice.
    pub(super) fn forget(&mut self, slice: usize) {
        self.0.iter_mut().for_each(|values| values[slice] = 0.0);
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
    /// What slices at these heights add, in the order of [`Eight`].
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
