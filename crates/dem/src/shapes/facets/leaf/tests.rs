//! What single precision is sure of is true.
use super::*;
use crate::draw::Draw;
use pulp::{Arch, WithSimd};
use robust::{Coord3D, orient3d};

/// A leaf's triangles and where its corners really are, in the common frame.
struct Body {
    places: Places,
    leaf: Leaf,
    corners: Vec<Vector>,
    faces: Vec<Face>,
}

fn face(k: u32) -> Face {
    Face { corners: [3 * k, 3 * k + 1, 3 * k + 2], edges: [0; 3] }
}

impl Body {
    /// Eight triangles that share no corner, within `radius` of the origin; turned and shifted if so.
    fn new(vertices: &[Vector], radius: f64, to: Option<(Matrix3<f64>, Vector)>) -> Self {
        let faces: Vec<Face> = (0..WIDTH as u32).map(face).collect();
        let leaf = Leaf::new(&faces, vertices, radius);
        let (mut places, mut corners) = (leaf.places, vertices.to_vec());
        if let Some((turn, shift)) = to {
            places.move_from(&leaf.places, &turn, &shift, radius + shift.norm());
            for x in &mut corners {
                let along =
                    |a: usize| moved(&[turn[(a, 0)], turn[(a, 1)], turn[(a, 2)]], shift[a], [x.x, x.y, x.z]);
                *x = Vector::new(along(0), along(1), along(2));
            }
        }
        Self { places, leaf, corners, faces }
    }
    fn triangle(&self, lane: usize) -> [Vector; 3] {
        self.faces[lane].corners.map(|v| self.corners[v as usize])
    }
}

struct Sides<'a>(&'a Places, &'a Places, f32);

impl WithSimd for Sides<'_> {
    /// Of each lane, which corners are surely behind, and which ahead.
    type Output = [[u32; WIDTH]; 2];
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let mut out = [[0; WIDTH]; 2];
        for part in parts::<S>() {
            let [behind, ahead] = self.0.sides(simd, part, (self.1, CORNERS), self.2);
            behind.store(&mut out[0], part);
            ahead.store(&mut out[1], part);
        }
        out
    }
}

struct Apart<'a>(&'a Places, &'a Places);

impl WithSimd for Apart<'_> {
    /// Of each lane, from which triangles of the other leaf its box is apart.
    type Output = [[u32; WIDTH]; WIDTH];
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let mut out = [[0; WIDTH]; WIDTH];
        for (j, lanes) in out.iter_mut().enumerate() {
            for part in parts::<S>() {
                self.0.apart(simd, part, self.1, j).store(lanes, part);
            }
        }
        out
    }
}

/// Positive where `p` lies behind the face, exactly.
fn orient([a, b, c]: [Vector; 3], p: Vector) -> f64 {
    let coord = |v: Vector| Coord3D { x: v.x, y: v.y, z: v.z };
    orient3d(coord(a), coord(b), coord(c), coord(p))
}

/// A triangle within a ball of `radius`: of any size, or a needle, or a sliver.
fn triangle(draw: &mut Draw, radius: f64) -> [Vector; 3] {
    // Along a diagonal of space all coordinates and all products are rounded alike.
    let diagonal = Vector::from_fn(|_, _| if draw.next() < 0.5 { 1.0 } else { -1.0 }) / 3.0_f64.sqrt();
    let at = if draw.next() < 0.5 { diagonal } else { draw.direction() } * radius * (0.2 + 0.6 * draw.next());
    let size = draw.between(1e-6, 0.15) * radius;
    let flat = if draw.next() < 0.5 { 1.0 } else { draw.between(1e-7, 1.0) };
    let (u, v) = (draw.direction(), draw.direction());
    [at, at + size * u, at + size * (draw.next() * u + flat * v)]
}

/// Two leaves whose corners are all but in the planes of the other's faces, by shares of what is in doubt: how many answers are wrong
/// that are taken for sure where no more than a `share` of that doubt is left.
fn wrong(draw: &mut Draw, share: f32) -> usize {
    let radius = draw.between(1e-6, 1e3);
    // The common frame is the second body's: a tiny one on a large one, or one of its size.
    let radii = [radius, if draw.next() < 0.5 { radius } else { radius * draw.between(1e-6, 1.0) }];
    let turn = *draw.turn().to_rotation_matrix().matrix();
    let shift = draw.direction() * (radii[0] + radii[1]) * draw.next();
    let extent = radii[0] + radii[1] + shift.norm();
    let doubt = slack(extent);
    let vertices: Vec<Vector> = (0..WIDTH).flat_map(|_| triangle(draw, radii[0])).collect();
    let first = Body::new(&vertices, radii[0], Some((turn, shift)));
    // Corners of the second, in the planes of faces of the first or a little off.
    let near: Vec<Vector> = (0..CORNERS)
        .map(|k| {
            let [a, b, c] = first.triangle(k / 3);
            let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default();
            let foot = a + draw.next() * (b - a) + draw.next() * (c - a);
            foot + normal * (4.0 * draw.next() - 2.0) * f64::from(doubt)
        })
        .collect();
    let second = Body::new(&near, radii[1].max(near.iter().map(Vector::norm).fold(0.0, f64::max)), None);
    let doubt = slack(extent + second.corners.iter().map(Vector::norm).fold(0.0, f64::max));
    let mut wrong = 0;
    for (own, other) in [(&first, &second), (&second, &first)] {
        let sides = Arch::new().dispatch(Sides(&own.places, &other.places, share * doubt));
        for lane in 0..WIDTH {
            let face = own.triangle(lane);
            for (slot, v) in other.leaf.vertices().iter().enumerate() {
                let exact = orient(face, other.corners[*v as usize]);
                for (bits, sign) in [(sides[0][lane], 1.0), (sides[1][lane], -1.0)] {
                    wrong += usize::from(bits >> slot & 1 == 1 && sign * exact <= 0.0);
                }
            }
        }
        let apart = Arch::new().dispatch(Apart(&own.places, &other.places));
        for (j, lanes) in apart.iter().enumerate() {
            let others = other.triangle(j);
            for (i, bits) in lanes.iter().enumerate() {
                let face = own.triangle(i);
                let are_apart = (0..3).any(|a| {
                    let ends = |t: &[Vector; 3]| {
                        let x = t.map(|v| v[a]);
                        [x[0].min(x[1]).min(x[2]), x[0].max(x[1]).max(x[2])]
                    };
                    let ([low, high], [others_low, others_high]) = (ends(&face), ends(&others));
                    high < others_low || others_high < low
                });
                wrong += usize::from(*bits != 0 && !are_apart);
            }
        }
    }
    wrong
}

/// Faces of all sizes, needles, far from the origin, of bodies of very different sizes; corners within twice the doubt of planes.
/// Roundings hardly ever add up: answers are wrong from a hundredth of the doubt on, so that the test sees what it looks for.
#[test]
fn what_is_sure_is_true() {
    let of = |share: f32| {
        let mut draw = Draw(5);
        (0..20_000).map(|_| wrong(&mut draw, share)).sum::<usize>()
    };
    assert_eq!(of(1.0), 0);
    let wrong = [0.01, 0.0].map(of);
    assert!(wrong[0] > 0 && wrong[1] > 100, "{wrong:?}");
}
