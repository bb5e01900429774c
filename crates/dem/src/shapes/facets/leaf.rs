//! Up to eight triangles side by side.
use super::eight::{Singles, Words, dot, parts};
use super::{Face, WIDTH};
use interfaces::Vector;
use nalgebra::Matrix3;
use pulp::Simd;

/// A leaf of the tree: its triangles, and where they are in the body's own frame.
#[derive(Clone, Debug)]
pub(crate) struct Leaf {
    /// The numbers of the corners, each once; the others are not used.
    vertices: [u32; CORNERS],
    n_vertices: usize,
    /// Where each triangle's corners stand among these.
    slots: [[u8; 3]; WIDTH],
    /// The same, a bit for each; none of missing triangles.
    pub(crate) corners: [u32; WIDTH],
    pub(crate) places: Places,
}

/// Corners of eight triangles, if they share none.
const CORNERS: usize = 3 * WIDTH;

/// Places, planes and boxes of a leaf's triangles, lane by lane, in single precision: to tell what is far from crossing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Places {
    corners: [[f32; CORNERS]; 3],
    /// Of unit length.
    normals: [Lanes; 3],
    /// normal·a.
    heights: Lanes,
    /// Infinite where the normal is not known well enough.
    doubts: Lanes,
    /// Each triangle's own corners, by corner and axis.
    triangles: [[Lanes; 3]; 3],
    /// Boxes around the triangles, none around missing ones, and around all of them.
    low: [Lanes; 3],
    high: [Lanes; 3],
    low_all: [f32; 3],
    high_all: [f32; 3],
}

type Lanes = [f32; WIDTH];

/// Of lengths in single precision, relative to the largest coordinate: a plane's distance from a corner is off by less than 48
/// roundings, of the corner's place (14), the normal (10), the height (17) and the sum itself (7).
const SLACK: f32 = 67.0 * 0.5 * f32::EPSILON;

/// A normal is known well enough if the triangle is at least so high, as a share of the body's radius: double precision then adds
/// less than the other 19.
const FLAT: f64 = 1e-7;

impl Default for Places {
    fn default() -> Self {
        let zero = [[0.0; WIDTH]; 3];
        Self {
            corners: [[0.0; CORNERS]; 3],
            normals: zero,
            heights: [0.0; WIDTH],
            doubts: [0.0; WIDTH],
            triangles: [zero; 3],
            low: [[f32::INFINITY; WIDTH]; 3],
            high: [[f32::NEG_INFINITY; WIDTH]; 3],
            low_all: [f32::INFINITY; 3],
            high_all: [f32::NEG_INFINITY; 3],
        }
    }
}

/// What is off by less than this is in doubt, where no coordinate exceeds `extent`.
#[inline(always)]
pub(crate) fn slack(extent: f64) -> f32 {
    SLACK * extent as f32 + f32::MIN_POSITIVE
}

impl Leaf {
    /// Of up to eight triangles of a body of this `radius`.
    pub(super) fn new(faces: &[Face], vertices: &[Vector], radius: f64) -> Self {
        let (mut numbers, mut n) = ([0; CORNERS], 0);
        let (mut slots, mut corners) = ([[0; 3]; WIDTH], [0; WIDTH]);
        let mut places = Places::default();
        for (lane, face) in faces.iter().enumerate().take(WIDTH) {
            for (k, v) in face.corners.into_iter().enumerate() {
                let slot = numbers[..n].iter().position(|w| *w == v).unwrap_or(n);
                if slot == n {
                    numbers[n] = v;
                    n += 1;
                }
                slots[lane][k] = slot as u8;
                corners[lane] |= 1 << slot;
            }
            places.set_triangle(lane, face.corners.map(|v| vertices[v as usize]), radius);
        }
        for (slot, v) in numbers[..n].iter().enumerate() {
            for a in 0..3 {
                places.corners[a][slot] = vertices[*v as usize][a] as f32;
            }
        }
        // Missing triangles stand where the first one does.
        for lane in faces.len()..WIDTH {
            for own in places.triangles.as_flattened_mut() {
                own[lane] = own[0];
            }
        }
        places.set_boxes(slack(radius));
        Self { vertices: numbers, n_vertices: n, slots, corners, places }
    }

    /// The numbers of the corners, each once.
    #[inline(always)]
    pub(crate) fn vertices(&self) -> &[u32] {
        &self.vertices[..self.n_vertices]
    }
    /// Of bits for all corners, those of one triangle.
    #[inline(always)]
    pub(crate) fn pick(&self, bits: u32, lane: usize) -> u32 {
        let [a, b, c] = self.slots[lane];
        (bits >> a & 1) | (bits >> b & 1) << 1 | (bits >> c & 1) << 2
    }
}

impl Places {
    fn set_triangle(&mut self, lane: usize, [a, b, c]: [Vector; 3], radius: f64) {
        let sides = [b - a, c - b, a - c];
        let normal = sides[0].cross(&-sides[2]);
        let longest = sides.iter().map(Vector::norm).fold(0.0, f64::max);
        let well = normal.norm() >= FLAT * radius * longest;
        let unit = normal.try_normalize(0.0).unwrap_or_default();
        for axis in 0..3 {
            self.normals[axis][lane] = unit[axis] as f32;
            for (own, x) in self.triangles.iter_mut().zip([a, b, c]) {
                own[axis][lane] = x[axis] as f32;
            }
        }
        self.heights[lane] = unit.dot(&a) as f32;
        self.doubts[lane] = if well { 0.0 } else { f32::INFINITY };
    }

    /// Becomes `own`, turned and shifted; `extent` is a length that no coordinate exceeds.
    #[inline(always)]
    pub(crate) fn move_from(&mut self, own: &Self, turn: &Matrix3<f64>, shift: &Vector, extent: f64) {
        let slack = slack(extent);
        let s = [shift.x as f32, shift.y as f32, shift.z as f32];
        for a in 0..3 {
            let row = [turn[(a, 0)] as f32, turn[(a, 1)] as f32, turn[(a, 2)] as f32];
            for i in 0..CORNERS {
                let x = &own.corners;
                self.corners[a][i] = row[0] * x[0][i] + row[1] * x[1][i] + row[2] * x[2][i] + s[a];
            }
            for i in 0..WIDTH {
                let along = |x: &[Lanes; 3]| row[0] * x[0][i] + row[1] * x[1][i] + row[2] * x[2][i];
                self.normals[a][i] = along(&own.normals);
                for k in 0..3 {
                    self.triangles[k][a][i] = along(&own.triangles[k]) + s[a];
                }
            }
        }
        for i in 0..WIDTH {
            let n = &self.normals;
            self.heights[i] = own.heights[i] + (n[0][i] * s[0] + n[1][i] * s[1] + n[2][i] * s[2]);
        }
        self.doubts = own.doubts;
        self.set_boxes(slack);
    }

    #[inline(always)]
    fn set_boxes(&mut self, slack: f32) {
        let [p, q, r] = &self.triangles;
        for a in 0..3 {
            let [mut low, mut high] = [[0.0; WIDTH]; 2];
            for i in 0..WIDTH {
                low[i] = less(less(p[a][i], q[a][i]), r[a][i]) - slack;
                high[i] = more(more(p[a][i], q[a][i]), r[a][i]) + slack;
            }
            (self.low[a], self.high[a]) = (low, high);
            let mut half = WIDTH / 2;
            while half > 0 {
                for i in 0..half {
                    low[i] = less(low[i], low[i + half]);
                    high[i] = more(high[i], high[i + half]);
                }
                half /= 2;
            }
            (self.low_all[a], self.high_all[a]) = (low[0], high[0]);
        }
    }

    /// Which of `n` corners of `other` surely lie behind the planes of a part of the triangles, and which ahead of them, a bit each.
    #[inline(always)]
    pub(crate) fn sides<S: Simd>(
        &self,
        simd: S,
        part: usize,
        (other, n): (&Self, usize),
        slack: f32,
    ) -> [Words<S>; 2] {
        let normal = Singles::load_all(simd, &self.normals, part);
        let doubt = Singles::load(simd, &self.doubts, part) + Singles::splat(simd, slack);
        let level = Singles::load(simd, &self.heights, part);
        let (above, below) = (level + doubt, level - doubt);
        let [mut behind, mut ahead] = [Words::splat(simd, 0); 2];
        let [x, y, z] = &other.corners;
        for slot in 0..n.min(CORNERS) {
            let corner = Singles::splat_all(simd, [x[slot], y[slot], z[slot]]);
            let (height, bit) = (dot(normal, corner), Words::splat(simd, 1 << slot));
            behind = behind | (below.above(height) & bit);
            ahead = ahead | (height.above(above) & bit);
        }
        [behind, ahead]
    }

    /// All bits for triangles of a part whose boxes are apart from another one.
    #[inline(always)]
    fn apart_from<S: Simd>(&self, simd: S, part: usize, low: [f32; 3], high: [f32; 3]) -> Words<S> {
        let own = [Singles::load_all(simd, &self.low, part), Singles::load_all(simd, &self.high, part)];
        let others = [Singles::splat_all(simd, low), Singles::splat_all(simd, high)];
        let mut apart = own[0][0].above(others[1][0]) | others[0][0].above(own[1][0]);
        for a in 1..3 {
            apart = apart | own[0][a].above(others[1][a]) | others[0][a].above(own[1][a]);
        }
        apart
    }
    /// All bits for triangles of a part whose boxes are apart from that of triangle `j` of `other`.
    #[inline(always)]
    pub(crate) fn apart<S: Simd>(&self, simd: S, part: usize, other: &Self, j: usize) -> Words<S> {
        let ([low_x, low_y, low_z], [high_x, high_y, high_z]) = (&other.low, &other.high);
        self.apart_from(simd, part, [low_x[j], low_y[j], low_z[j]], [high_x[j], high_y[j], high_z[j]])
    }
    /// Which triangles' boxes meet the box around all of the `other`'s, a bit each.
    #[inline(always)]
    pub(crate) fn meeting<S: Simd>(&self, simd: S, other: &Self) -> u32 {
        let mut bits = 0;
        for part in parts::<S>() {
            bits |= self.apart_from(simd, part, other.low_all, other.high_all).lacking(part);
        }
        bits
    }
}

/// The lesser of two numbers that are not NaN: one instruction.
#[inline(always)]
fn less(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn more(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// One coordinate of a point that was turned and shifted: always with the same rounding.
#[inline(always)]
pub(crate) fn moved(row: &[f64; 3], shift: f64, x: [f64; 3]) -> f64 {
    row[0] * x[0] + row[1] * x[1] + row[2] * x[2] + shift
}

#[cfg(test)]
mod tests;
