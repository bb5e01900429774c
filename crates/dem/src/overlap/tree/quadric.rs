//! A surface in a box, to second order.
use interfaces::Vector;

/// f = c + g·ξ + ½ ξᵀHξ with ξ from −1 to 1 across a box along each axis: the distance's value, slope and curvature.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Quadric {
    pub(crate) c: f64,
    pub(crate) g: Vector,
    /// H_xx, H_yy, H_zz.
    pub(crate) h: Vector,
    /// H_yz, H_xz, H_xy: at the number of the axis that is not there.
    pub(crate) m: Vector,
}

/// The places besides the centre where the distance must be known: the middles of the faces, two by two along the axes, and the
/// corners, x fastest.
pub(crate) const STENCIL: [Vector; 14] = {
    let mut out = [Vector::new(0.0, 0.0, 0.0); 14];
    let faces = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut i = 0;
    while i < 14 {
        let [x, y, z] = if i < 6 {
            let s = if i % 2 == 0 { 1.0 } else { -1.0 };
            let f = faces[i / 2];
            [s * f[0], s * f[1], s * f[2]]
        } else {
            let n = i - 6;
            [sign(n & 1), sign(n >> 1 & 1), sign(n >> 2 & 1)]
        };
        out[i] = Vector::new(x, y, z);
        i += 1;
    }
    out
};

const fn sign(bit: usize) -> f64 {
    if bit == 1 { 1.0 } else { -1.0 }
}

impl Quadric {
    const NULL: Vector = Vector::new(0.0, 0.0, 0.0);
    pub(crate) const ZERO: Self = Self { c: 0.0, g: Self::NULL, h: Self::NULL, m: Self::NULL };
    /// Through `c` at the centre and `f` on the [`STENCIL`]; with what it misses at the corners, root mean square.
    #[inline]
    pub(crate) fn fit(c: f64, f: &[f64; 14]) -> (Self, f64) {
        let corners = &f[6..];
        let mut odd = [0.0; 3];
        let mut m = [0.0; 3];
        for (n, f) in corners.iter().enumerate() {
            let s = [sign(n & 1), sign(n >> 1 & 1), sign(n >> 2 & 1)];
            for a in 0..3 {
                odd[a] += 0.125 * s[a] * f;
                m[a] += 0.125 * s[(a + 1) % 3] * s[(a + 2) % 3] * f;
            }
        }
        // The slope of a cubic that fits best all over the box is between those of faces and corners.
        let g = Vector::from_fn(|a, _| (f[2 * a] - f[2 * a + 1]) / 3.0 + odd[a] / 3.0);
        let h = Vector::from_fn(|a, _| f[2 * a] + f[2 * a + 1] - 2.0 * c);
        let this = Self { c, g, h, m: m.into() };
        let off = |(x, f): (&Vector, &f64)| (f - this.value(*x)).powi(2);
        let miss = (STENCIL[6..].iter().zip(corners).map(off).sum::<f64>() / 8.0).sqrt();
        (this, miss)
    }
    #[inline]
    pub(crate) fn value(&self, x: Vector) -> f64 {
        let squares = 0.5 * (self.h.x * x.x * x.x + self.h.y * x.y * x.y + self.h.z * x.z * x.z);
        self.c + self.g.dot(&x) + squares + self.m.x * x.y * x.z + self.m.y * x.x * x.z + self.m.z * x.x * x.y
    }
    /// The most by which it differs from its value at the centre.
    #[inline]
    pub(crate) fn reach(&self) -> f64 {
        self.g.abs().sum() + self.curved()
    }
    /// The most by which it differs from its tangent plane.
    #[inline]
    pub(crate) fn curved(&self) -> f64 {
        0.5 * self.h.abs().sum() + self.m.abs().sum()
    }
    /// Does the plane c + g·ξ = 0 cut the box?
    #[inline]
    pub(crate) fn cuts(&self) -> bool {
        self.c.abs() < self.g.abs().sum()
    }
}
