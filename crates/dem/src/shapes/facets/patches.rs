//! Boxes along the faces that they hold.
use super::WIDTH;
use interfaces::Vector;
use nalgebra::{Matrix3, SymmetricEigen};

/// Eight boxes, each around a part of a surface and turned with it: where faces are nearly flat, a box is thin, and stays so however
/// the body turns (Gottschalk, Lin & Manocha 1996, "OBBTree").
#[derive(Clone, Copy, Debug)]
pub(crate) struct Patches {
    centres: [Lanes; 3],
    /// Half edges within the surface, by axis.
    long: [Lanes; 3],
    wide: [Lanes; 3],
    /// The mean of the faces' normals.
    normals: [Lanes; 3],
    /// Half edges along the normals.
    thick: Lanes,
    /// Half edges of the upright boxes around all that.
    halves: [Lanes; 3],
    /// The nodes of the tree in the boxes.
    pub(crate) children: [u32; WIDTH],
    /// Which of the boxes there are, a bit each.
    filled: u32,
}

type Lanes = [f32; WIDTH];

/// Of lengths in single precision, relative to the largest coordinate: some ten roundings.
const SLACK: f32 = 4e-6;

impl Default for Patches {
    fn default() -> Self {
        let zero = [[0.0; WIDTH]; 3];
        Self {
            centres: zero,
            long: zero,
            wide: zero,
            normals: zero,
            thick: [0.0; WIDTH],
            halves: zero,
            children: [u32::MAX; WIDTH],
            filled: 0,
        }
    }
}

/// One of eight.
#[derive(Clone, Copy)]
pub(crate) struct Patch {
    centre: [f32; 3],
    long: [f32; 3],
    wide: [f32; 3],
    normal: [f32; 3],
    thick: f32,
    half: [f32; 3],
}

impl Patches {
    /// Puts a box around these triangles, in the node `child`.
    pub(super) fn set(
        &mut self,
        slot: usize,
        child: u32,
        triangles: impl Iterator<Item = [Vector; 3]> + Clone,
    ) {
        let corners = || triangles.clone().flatten();
        let axes = axes(triangles.clone());
        let ends = |n: &Vector| {
            corners()
                .map(|x| x.dot(n))
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
        };
        let ends = axes.each_ref().map(ends);
        let half = ends.map(|[low, high]| 0.5 * (high - low));
        let centre: Vector = axes.iter().zip(ends).map(|(n, [low, high])| n * (0.5 * (low + high))).sum();
        for a in 0..3 {
            self.centres[a][slot] = centre[a] as f32;
            self.long[a][slot] = (axes[0][a] * half[0]) as f32;
            self.wide[a][slot] = (axes[1][a] * half[1]) as f32;
            self.normals[a][slot] = axes[2][a] as f32;
        }
        let largest = corners().map(|x| x.amax()).fold(0.0, f64::max) as f32;
        self.thick[slot] = half[2] as f32 + SLACK * largest + f32::MIN_POSITIVE;
        self.children[slot] = child;
        self.filled |= 1 << slot;
        self.set_halves(SLACK * largest);
    }

    #[inline(always)]
    fn set_halves(&mut self, slack: f32) {
        for a in 0..3 {
            for i in 0..WIDTH {
                self.halves[a][i] = self.long[a][i].abs()
                    + self.wide[a][i].abs()
                    + self.normals[a][i].abs() * self.thick[i]
                    + slack;
            }
        }
    }

    /// Becomes the boxes `own`, turned and shifted; `extent` is a length that none of their places exceeds.
    #[inline(always)]
    pub(crate) fn move_from(&mut self, own: &Self, turn: &Matrix3<f64>, shift: &Vector, extent: f64) {
        let slack = SLACK * (extent as f32 + shift.amax() as f32);
        (self.children, self.filled) = (own.children, own.filled);
        for i in 0..WIDTH {
            self.thick[i] = own.thick[i] + slack;
        }
        for a in 0..3 {
            let row = [turn[(a, 0)] as f32, turn[(a, 1)] as f32, turn[(a, 2)] as f32];
            let s = shift[a] as f32;
            for i in 0..WIDTH {
                let along = |x: &[Lanes; 3]| row[0] * x[0][i] + row[1] * x[1][i] + row[2] * x[2][i];
                self.centres[a][i] = along(&own.centres) + s;
                self.long[a][i] = along(&own.long);
                self.wide[a][i] = along(&own.wide);
                self.normals[a][i] = along(&own.normals);
            }
        }
        self.set_halves(slack);
    }

    /// One of the boxes.
    #[inline(always)]
    pub(crate) fn patch(&self, slot: usize) -> Patch {
        let of = |lanes: &[Lanes; 3]| [lanes[0][slot], lanes[1][slot], lanes[2][slot]];
        Patch {
            centre: of(&self.centres),
            long: of(&self.long),
            wide: of(&self.wide),
            normal: of(&self.normals),
            thick: self.thick[slot],
            half: of(&self.halves),
        }
    }

    /// Which of the boxes may meet another one, a bit each: those that no axis and no face along the surface parts.
    #[inline(always)]
    pub(crate) fn meeting(&self, other: &Patch) -> u32 {
        let mut apart = [f32::NEG_INFINITY; WIDTH];
        for i in 0..WIDTH {
            let of = |lanes: &[Lanes; 3]| [lanes[0][i], lanes[1][i], lanes[2][i]];
            let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            let (c, n) = (of(&self.centres), of(&self.normals));
            let t = [c[0] - other.centre[0], c[1] - other.centre[1], c[2] - other.centre[2]];
            let (thick, tilt) = (self.thick[i], dot(n, other.normal).abs());
            let mut gap = more(
                dot(n, t).abs()
                    - dot(n, other.long).abs()
                    - dot(n, other.wide).abs()
                    - (tilt * other.thick + thick),
                dot(other.normal, t).abs()
                    - dot(other.normal, of(&self.long)).abs()
                    - dot(other.normal, of(&self.wide)).abs()
                    - (tilt * thick + other.thick),
            );
            for a in 0..3 {
                gap = more(gap, t[a].abs() - (self.halves[a][i] + other.half[a]));
            }
            apart[i] = gap;
        }
        bits(apart) & self.filled
    }
}

impl Patch {
    /// A measure of its size.
    #[inline(always)]
    pub(crate) fn size(&self) -> f32 {
        self.half[0] + self.half[1] + self.half[2]
    }
}

/// Which of these gaps are not positive, a bit each; what is no number counts as none.
#[inline(always)]
pub(crate) fn bits(gaps: Lanes) -> u32 {
    // In memory: told what becomes of them, the compiler would work lanes out one by one.
    let gaps = std::hint::black_box(gaps);
    let mut bits = [0_u8; WIDTH];
    for i in 0..WIDTH {
        bits[i] = u8::from(gaps[i] > 0.0);
    }
    // Byte i, 0 or 1, comes to bit 56 + i.
    let gathered = u64::from_le_bytes(bits).wrapping_mul(0x0102_0408_1020_4080) >> 56;
    !gathered as u32 & 0xff
}

/// The greater one; `a` if either is no number.
#[inline(always)]
fn more(a: f32, b: f32) -> f32 {
    if b > a { b } else { a }
}

/// Three directions: the longest one within the surface, that across it, and the mean normal.
fn axes(triangles: impl Iterator<Item = [Vector; 3]> + Clone) -> [Vector; 3] {
    let areas = triangles.clone().map(|[a, b, c]| (b - a).cross(&(c - a)));
    let normal = areas.sum::<Vector>().try_normalize(0.0).filter(|n| n.iter().all(|x| x.is_finite()));
    let normal = normal.unwrap_or(Vector::z());
    let corners = || triangles.clone().flatten();
    let (sum, number) = corners().fold((Vector::zeros(), 0.0), |(sum, n), x| (sum + x, n + 1.0));
    let mean = sum / number;
    let within = |x: Vector| {
        let x = x - mean;
        x - normal * normal.dot(&x)
    };
    let largest = corners().map(|x| within(x).amax()).fold(0.0, f64::max);
    let scale = if largest > 0.0 { 1.0 / largest } else { 0.0 };
    let spread =
        corners().map(|x| within(x) * scale).fold(Matrix3::zeros(), |sum, x| sum + x * x.transpose());
    let spread = SymmetricEigen::new(spread);
    let long = spread.eigenvectors.column(spread.eigenvalues.imax()).into_owned();
    // At a right angle to the normal, whatever was rounded.
    let long = (long - normal * normal.dot(&long)).try_normalize(0.5);
    let long = long.unwrap_or_else(|| {
        let axis = Vector::ith(normal.iamin(), 1.0);
        (axis - normal * normal.dot(&axis)).normalize()
    });
    [long, normal.cross(&long), normal]
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::Rotation;
    use proptest::prelude::*;

    fn vector(size: f64) -> impl Strategy<Value = Vector> {
        prop::array::uniform3(-size..size).prop_map(Vector::from)
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

        /// Boxes around triangles that share a point meet, wherever they are, however large, flat or slender.
        #[test]
        fn what_shares_a_point_meets(
            corners in prop::collection::vec(vector(1.0), 24),
            turn in vector(3.0),
            scale in vector(1.0).prop_map(|s| s.map(|s| 10_f64.powf(4.0 * s))),
            place in vector(1e3),
            weights in prop::array::uniform3(0.0..1.0f64),
            slots in (0..8usize, 0..8usize),
            few in 1..4usize,
        ) {
            let triangle = |i: usize| [0, 1, 2].map(|k| corners[(3 * i + k) % 24].component_mul(&scale));
            let (i, j) = slots;
            let (mut own, mut other) = (Patches::default(), Patches::default());
            own.set(i, 0, (0..few).map(triangle));
            other.set(j, 0, (few..2 * few).map(triangle));
            let sum: f64 = weights.iter().sum::<f64>().max(1e-9);
            let within = |[a, b, c]: [Vector; 3]| (a * weights[0] + b * weights[1] + c * weights[2]) / sum;
            // Moves a point of one onto a point of the other, far from the origin.
            let turn = *Rotation::from_scaled_axis(turn).to_rotation_matrix().matrix();
            let to = within(triangle(few));
            let shift = to - turn * within(triangle(0));
            let extent = corners.iter().map(|c| c.component_mul(&scale).norm()).fold(0.0, f64::max);
            let mut moved = Patches::default();
            moved.move_from(&own, &turn, &shift, extent);
            prop_assert_eq!(moved.meeting(&other.patch(j)), 1 << i);
            prop_assert_eq!(other.meeting(&moved.patch(i)), 1 << j);
            // Far away nothing meets, and what is not there never does.
            moved.move_from(&own, &turn, &(shift + place.normalize() * 8.0 * extent), extent);
            prop_assert_eq!(moved.meeting(&other.patch(j)), 0);
        }
    }

    /// A flat part has a thin box, whichever way it is turned, and nothing above it meets it.
    #[test]
    fn flat_parts_have_thin_boxes() {
        let turn = Rotation::from_scaled_axis(Vector::new(0.5, 0.3, 0.7));
        let flat = |z: f64| [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|[x, y]| turn * Vector::new(x, y, z));
        let of = |z: f64| {
            let mut patches = Patches::default();
            patches.set(0, 0, std::iter::once(flat(z)));
            patches
        };
        assert_eq!(of(0.0).meeting(&of(1e-4).patch(0)), 0);
        assert_eq!(of(0.0).meeting(&of(1e-7).patch(0)), 1);
    }
}
