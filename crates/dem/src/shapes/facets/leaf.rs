//! Eight triangles side by side.
use super::WIDTH;
use super::tree::more;
use interfaces::Vector;
use nalgebra::Matrix3;

/// The corners and planes of up to eight triangles, lane by lane; what is missing is zero.
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
}

impl Leaf {
    pub(crate) fn new(triangles: impl Iterator<Item = [Vector; 3]>) -> Self {
        let mut leaf = Self::default();
        for (lane, corners) in triangles.enumerate().take(WIDTH) {
            for (own, corner) in leaf.corners.iter_mut().zip(corners) {
                for a in 0..3 {
                    own[a][lane] = corner[a];
                }
            }
        }
        leaf.set_planes();
        leaf
    }

    /// The same triangles, turned and shifted.
    #[inline(always)]
    pub(crate) fn moved(&self, turn: &Matrix3<f64>, shift: &Vector) -> Self {
        let mut leaf = Self::default();
        for (to, from) in leaf.corners.iter_mut().zip(&self.corners) {
            for a in 0..3 {
                let (row, s) = ([turn[(a, 0)], turn[(a, 1)], turn[(a, 2)]], shift[a]);
                for lane in 0..WIDTH {
                    to[a][lane] = moved(&row, s, [from[0][lane], from[1][lane], from[2][lane]]);
                }
            }
        }
        leaf.set_planes();
        leaf
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

/// One coordinate of a point that was turned and shifted: always with the same rounding.
#[inline(always)]
pub(crate) fn moved(row: &[f64; 3], shift: f64, x: [f64; 3]) -> f64 {
    row[0] * x[0] + row[1] * x[1] + row[2] * x[2] + shift
}
