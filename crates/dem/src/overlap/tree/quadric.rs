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

/// Where along the axes: the best place for straight lines through a cubic.
const FACE: f64 = 0.774_596_669_241_483_4;
/// Where along each axis, on four diagonals.
const CORNER: f64 = 0.6;
/// Signs of the four corners of a tetrahedron.
const SIGNS: [[f64; 3]; 4] = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];

/// The places besides the centre where the distance must be known.
pub(crate) fn stencil() -> [Vector; 10] {
    std::array::from_fn(|i| match i {
        0..6 => Vector::ith(i / 2, if i % 2 == 0 { FACE } else { -FACE }),
        _ => CORNER * Vector::from(SIGNS[i - 6]),
    })
}

impl Quadric {
    const NULL: Vector = Vector::new(0.0, 0.0, 0.0);
    pub(crate) const ZERO: Self = Self { c: 0.0, g: Self::NULL, h: Self::NULL, m: Self::NULL };
    /// Through `c` at the centre and `f` on the [`stencil`]; with what the eleventh value misses.
    #[inline]
    pub(crate) fn fit(c: f64, f: &[f64; 10]) -> (Self, f64) {
        let g = Vector::from_fn(|a, _| (f[2 * a] - f[2 * a + 1]) / (2.0 * FACE));
        let h = Vector::from_fn(|a, _| (f[2 * a] + f[2 * a + 1] - 2.0 * c) / (FACE * FACE));
        let t = &f[6..];
        let m = Vector::from_fn(|a, _| {
            let sum: f64 = (0..4).map(|i| SIGNS[i][a] * t[i]).sum();
            (sum - 4.0 * CORNER * g[a]) / (4.0 * CORNER * CORNER)
        });
        let mean = t.iter().sum::<f64>() / 4.0;
        let miss = mean - c - 0.5 * CORNER * CORNER * h.sum();
        (Self { c, g, h, m }, miss)
    }
    #[inline]
    pub(crate) fn value(&self, x: Vector) -> f64 {
        let squares = 0.5 * (self.h.x * x.x * x.x + self.h.y * x.y * x.y + self.h.z * x.z * x.z);
        self.c + self.g.dot(&x) + squares + self.m.x * x.y * x.z + self.m.y * x.x * x.z + self.m.z * x.x * x.y
    }
    #[inline]
    pub(crate) fn slope(&self, x: Vector) -> Vector {
        let m = &self.m;
        self.g
            + self.h.component_mul(&x)
            + Vector::new(m.z * x.y + m.y * x.z, m.z * x.x + m.x * x.z, m.y * x.x + m.x * x.y)
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
