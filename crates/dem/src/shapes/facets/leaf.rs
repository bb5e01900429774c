//! Eight triangles side by side.
use super::WIDTH;
use super::patches::bits;
use interfaces::Vector;
use nalgebra::Matrix3;

/// The corners, planes and boxes of up to eight triangles, lane by lane; where one is missing, the first one stands.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Leaf {
    /// Coordinates, by corner and axis.
    pub(crate) corners: [[[f64; WIDTH]; 3]; 3],
    /// (b − a) × (c − a), by axis.
    pub(crate) normals: [[f64; WIDTH]; 3],
    /// normal·a.
    pub(crate) heights: [f64; WIDTH],
    /// Square of the largest component of b − a or c − a.
    pub(crate) sizes: [f64; WIDTH],
    /// The boxes, of numbers rounded outwards.
    low: [[f32; WIDTH]; 3],
    high: [[f32; WIDTH]; 3],
    /// The box around all.
    low_all: [f32; 3],
    high_all: [f32; 3],
    /// Which lanes have triangles of their own, a bit each.
    filled: u32,
}

impl Leaf {
    /// Of at least one triangle.
    pub(crate) fn new(triangles: impl Iterator<Item = [Vector; 3]>) -> Self {
        let mut leaf = Self::default();
        for (lane, corners) in triangles.enumerate().take(WIDTH) {
            leaf.filled |= 1 << lane;
            for (own, corner) in leaf.corners.iter_mut().zip(corners) {
                for a in 0..3 {
                    own[a][if lane == 0 { 0..WIDTH } else { lane..lane + 1 }].fill(corner[a]);
                }
            }
        }
        leaf.set_planes();
        leaf.set_boxes();
        leaf
    }

    /// Becomes `own`, turned and shifted.
    #[inline(always)]
    pub(crate) fn move_from(&mut self, own: &Self, turn: &Matrix3<f64>, shift: &Vector) {
        for k in 0..3 {
            let (to, from) = (&mut self.corners[k], &own.corners[k]);
            for a in 0..3 {
                let (row, s) = ([turn[(a, 0)], turn[(a, 1)], turn[(a, 2)]], shift[a]);
                for lane in 0..WIDTH {
                    to[a][lane] = moved(&row, s, [from[0][lane], from[1][lane], from[2][lane]]);
                }
            }
        }
        self.filled = own.filled;
        self.set_planes();
        self.set_boxes();
    }

    #[inline(always)]
    fn set_boxes(&mut self) {
        let [p, q, r] = &self.corners;
        for a in 0..3 {
            let [mut low, mut high] = [[0.0_f32; WIDTH]; 2];
            for i in 0..WIDTH {
                let [x, y, z] = [p[a][i] as f32, q[a][i] as f32, r[a][i] as f32];
                let [least, most] = [less_single(less_single(x, y), z), more_single(more_single(x, y), z)];
                // Two roundings, outwards.
                low[i] = least - least.abs() * 2e-7 - f32::MIN_POSITIVE;
                high[i] = most + most.abs() * 2e-7 + f32::MIN_POSITIVE;
            }
            (self.low[a], self.high[a]) = (low, high);
            let mut half = WIDTH / 2;
            while half > 0 {
                for i in 0..half {
                    low[i] = less_single(low[i], low[i + half]);
                    high[i] = more_single(high[i], high[i + half]);
                }
                half /= 2;
            }
            (self.low_all[a], self.high_all[a]) = (low[0], high[0]);
        }
    }

    /// Which triangles' boxes meet another one, a bit each.
    #[inline(always)]
    fn meeting_box(&self, low: [f32; 3], high: [f32; 3]) -> u32 {
        let mut gaps = [f32::NEG_INFINITY; WIDTH];
        for a in 0..3 {
            for i in 0..WIDTH {
                let gap = more_single(self.low[a][i] - high[a], low[a] - self.high[a][i]);
                gaps[i] = more_single(gap, gaps[i]);
            }
        }
        bits(gaps) & self.filled
    }
    /// Which triangles' boxes meet the box around all of the `other`'s, a bit each.
    #[inline(always)]
    pub(crate) fn meeting_any(&self, other: &Self) -> u32 {
        self.meeting_box(other.low_all, other.high_all)
    }
    /// Which triangles' boxes meet that of number `j` of the `other`'s, a bit each.
    #[inline(always)]
    pub(crate) fn meeting(&self, other: &Self, j: usize) -> u32 {
        let corner = |side: &[[f32; WIDTH]; 3]| [side[0][j], side[1][j], side[2][j]];
        self.meeting_box(corner(&other.low), corner(&other.high))
    }

    #[inline(always)]
    fn set_planes(&mut self) {
        let [a, b, c] = &self.corners;
        for i in 0..WIDTH {
            let u = [b[0][i] - a[0][i], b[1][i] - a[1][i], b[2][i] - a[2][i]];
            let v = [c[0][i] - a[0][i], c[1][i] - a[1][i], c[2][i] - a[2][i]];
            let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            for axis in 0..3 {
                self.normals[axis][i] = n[axis];
            }
            self.heights[i] = n[0] * a[0][i] + n[1] * a[1][i] + n[2] * a[2][i];
            let longest = |w: [f64; 3]| more(more(w[0].abs(), w[1].abs()), w[2].abs());
            let longest = more(longest(u), longest(v));
            self.sizes[i] = longest * longest;
        }
    }

    /// The corners of one triangle.
    #[inline(always)]
    pub(crate) fn triangle(&self, lane: usize) -> [Vector; 3] {
        [0, 1, 2].map(|k| {
            Vector::new(self.corners[k][0][lane], self.corners[k][1][lane], self.corners[k][2][lane])
        })
    }
    /// The first of its corners.
    #[inline(always)]
    pub(crate) fn corner(&self, lane: usize) -> Vector {
        Vector::new(self.corners[0][0][lane], self.corners[0][1][lane], self.corners[0][2][lane])
    }
    #[inline(always)]
    pub(crate) fn normal(&self, lane: usize) -> Vector {
        Vector::new(self.normals[0][lane], self.normals[1][lane], self.normals[2][lane])
    }
}

/// The greater of two numbers that are not NaN: one instruction.
#[inline(always)]
fn more(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[inline(always)]
fn more_single(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
fn less_single(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// One coordinate of a point that was turned and shifted: always with the same rounding.
#[inline(always)]
pub(crate) fn moved(row: &[f64; 3], shift: f64, x: [f64; 3]) -> f64 {
    row[0] * x[0] + row[1] * x[1] + row[2] * x[2] + shift
}
