//! Boxes along the faces that they hold.
use super::WIDTH;
use super::eight::{Singles, cross, dot, minus, parts};
use interfaces::Vector;
use nalgebra::Matrix3;
use pulp::Simd;

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
    /// What places may be off by.
    slack: f32,
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
            slack: 0.0,
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
    slack: f32,
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
        let ends = axes.each_ref().map(|axis| reach(corners(), axis));
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
        self.slack = self.slack.max(SLACK * largest);
        self.set_halves();
    }

    #[inline(always)]
    fn set_halves(&mut self) {
        for a in 0..3 {
            for i in 0..WIDTH {
                self.halves[a][i] = self.long[a][i].abs()
                    + self.wide[a][i].abs()
                    + self.normals[a][i].abs() * self.thick[i]
                    + self.slack;
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
        self.slack = own.slack + slack;
        self.set_halves();
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
            slack: self.slack,
        }
    }

    /// Which of the boxes may meet another one, a bit each: those that no axis, no face along the surface and no stretch of the line
    /// in which two flat ones would cross parts.
    #[inline(always)]
    pub(crate) fn meeting<S: Simd>(&self, simd: S, other: &Patch) -> u32 {
        let mut bits = 0;
        for part in parts::<S>() {
            let (n, m) =
                (Singles::load_all(simd, &self.normals, part), Singles::splat_all(simd, other.normal));
            let t =
                minus(Singles::load_all(simd, &self.centres, part), Singles::splat_all(simd, other.centre));
            let own = [Singles::load_all(simd, &self.long, part), Singles::load_all(simd, &self.wide, part)];
            let others = [Singles::splat_all(simd, other.long), Singles::splat_all(simd, other.wide)];
            let (thick, others_thick) =
                (Singles::load(simd, &self.thick, part), Singles::splat(simd, other.thick));
            let tilt = dot(n, m).abs();
            let mut apart = dot(n, t).abs().above(over(n, others) + tilt.mul_add(others_thick, thick))
                | dot(m, t).abs().above(over(m, own) + tilt.mul_add(thick, others_thick));
            for a in 0..3 {
                let reach = Singles::load(simd, &self.halves[a], part) + Singles::splat(simd, other.half[a]);
                apart = apart | t[a].abs().above(reach);
            }
            let v = cross(n, m);
            let slack = Singles::splat(simd, self.slack + other.slack);
            apart = apart | dot(v, t).abs().above(over(v, own) + over(v, others) + slack);
            bits |= apart.lacking(part);
        }
        bits & self.filled
    }
}

/// How far two half edges reach along an axis.
#[inline(always)]
fn over<S: Simd>(axis: [Singles<S>; 3], half: [[Singles<S>; 3]; 2]) -> Singles<S> {
    dot(axis, half[0]).abs() + dot(axis, half[1]).abs()
}

impl Patch {
    /// A measure of its size.
    #[inline(always)]
    pub(crate) fn size(&self) -> f32 {
        self.half[0] + self.half[1] + self.half[2]
    }
}

/// Directions within the surface that are tried for a box.
const DIRECTIONS: usize = 16;

/// Three directions: those along and across the smallest rectangle within the surface, and the mean normal.
fn axes(triangles: impl Iterator<Item = [Vector; 3]> + Clone) -> [Vector; 3] {
    let [u, v, normal] = within(mean_normal(triangles.clone()));
    let places: Vec<[f64; 2]> = triangles.flatten().map(|x| [x.dot(&u), x.dot(&v)]).collect();
    let mut best = (f64::INFINITY, [u, v]);
    for k in 0..DIRECTIONS {
        let (sin, cos) = (std::f64::consts::FRAC_PI_2 * k as f64 / DIRECTIONS as f64).sin_cos();
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for [x, y] in &places {
            for (i, x) in [cos * x + sin * y, cos * y - sin * x].into_iter().enumerate() {
                low[i] = if x < low[i] { x } else { low[i] };
                high[i] = if x > high[i] { x } else { high[i] };
            }
        }
        let area = (high[0] - low[0]) * (high[1] - low[1]);
        if area < best.0 {
            best = (area, [cos * u + sin * v, cos * v - sin * u]);
        }
    }
    let [long, wide] = best.1;
    [long, wide, normal]
}

/// The mean of the normals of triangles, of unit length.
pub(super) fn mean_normal(triangles: impl Iterator<Item = [Vector; 3]>) -> Vector {
    let areas = triangles.map(|[a, b, c]| (b - a).cross(&(c - a)));
    let normal = areas.sum::<Vector>().try_normalize(0.0).filter(|n| n.iter().all(|x| x.is_finite()));
    normal.unwrap_or(Vector::z())
}

/// Two directions at a right angle to a `normal`, and that.
pub(super) fn within(normal: Vector) -> [Vector; 3] {
    let u = normal.cross(&Vector::ith(normal.iamin(), 1.0)).normalize();
    [u, normal.cross(&u), normal]
}

/// The lowest and the highest of some places along an axis.
pub(super) fn reach(places: impl Iterator<Item = Vector>, axis: &Vector) -> [f64; 2] {
    let around = |[low, high]: [f64; 2], x: f64| [low.min(x), high.max(x)];
    places.map(|x| x.dot(axis)).fold([f64::INFINITY, f64::NEG_INFINITY], around)
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::Rotation;
    use proptest::prelude::*;
    use pulp::Scalar;

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
            prop_assert_eq!(moved.meeting(Scalar::new(), &other.patch(j)), 1 << i);
            prop_assert_eq!(other.meeting(Scalar::new(), &moved.patch(i)), 1 << j);
            // Far away nothing meets, and what is not there never does.
            moved.move_from(&own, &turn, &(shift + place.normalize() * 8.0 * extent), extent);
            prop_assert_eq!(moved.meeting(Scalar::new(), &other.patch(j)), 0);
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
        assert_eq!(of(0.0).meeting(Scalar::new(), &of(1e-4).patch(0)), 0);
        assert_eq!(of(0.0).meeting(Scalar::new(), &of(1e-7).patch(0)), 1);
    }
}
