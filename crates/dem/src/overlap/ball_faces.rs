//! A ball or ellipsoid and a body of flat faces, convex or not: exact sums over the faces that the ball reaches.
//!
//! An ellipsoid is mapped to the unit ball around the origin, and the body with it. Seen from the centre, the body's part beyond
//! face F within the ball has the volume G = ∫ (1 − ρ³)/3 dΩ over F ∩ ball, ρ the distance from the centre, Ω the solid angle, positive
//! where F looks away from the centre. A ray from the centre leaves the body as often as it enters it, once more if
//! it starts inside, so with the outward normals n
//!
//! - V = \[centre inside\] 4π/3 − Σ G,
//! - ∫ x dV = −Σ n ∫ (1 − ρ²)/2 dA, by the divergence theorem,
//! - S = −Σ n ∫ dA, since ∮ n dA = 0 around the common part.
//!
//! Since 0 ≤ V ≤ 4π/3, the sign of Σ G tells whether the centre is inside; no face out of reach counts. The integrals over a face
//! are those over a sector of the disc in which the ball cuts its plane (a cap), less the parts beyond its edges. For a shallow contact
//! all terms are as small as the volume itself, so that it keeps its digits.
//!
//! Under x = B y, B the map of the unit ball onto the ellipsoid, volumes take the factor det B and areas n dA the
//! matrix det B B⁻ᵀ. The moment of the gradient about the centroid c is −Σ ∫ (x − c) × n dA over the faces; the
//! part about the centre is zero for a ball, whose normals go through it.
pub(super) mod edge;
pub(super) mod face;
#[cfg(test)]
mod tests;

use super::Overlap;
use super::facets::holds;
use super::sheets::Sheets;
use crate::ConvexPolyhedron;
use crate::shapes::Facets;
use face::{Face, Part, polygon_angle, seen_angle};
use interfaces::{Point, Polyhedron, Pose, Rotation, Vector};
use nalgebra::Matrix3;
use std::f64::consts::PI;

/// Volume of the unit ball.
const WHOLE: f64 = 4.0 / 3.0 * PI;
/// The most, in radii cubed, that rounding errors make of a mere touch, where not all faces around an edge or corner agree on it.
const TOUCH: f64 = 1e-28;
/// As a share of the amounts that make it, a sum of which not even the sign is known.
const NOTHING: f64 = 1e-13;

/// A closed body of flat convex faces, in its own frame.
pub(crate) trait Faces {
    /// How many corners it has.
    fn n_corners(&self) -> usize;
    /// One of them \[m\].
    fn corner(&self, i: u32) -> Point;
    /// Calls `visit` with the numbers of the corners of every face, counter-clockwise seen from outside.
    fn each(&self, visit: impl FnMut(&[u32]));
    /// Calls `visit` with all faces that meet a box, of half edges `reach` \[m\] around `centre`, and
    /// perhaps with others.
    fn near(&self, centre: Point, reach: Vector, mut visit: impl FnMut(&[u32])) {
        let (low, high) = (centre.coords - reach, centre.coords + reach);
        self.each(|face| {
            let apart = |a: usize| {
                let first = self.corner(face[0])[a];
                let ends = face[1..].iter().fold((first, first), |(least, most), i| {
                    let x = self.corner(*i)[a];
                    (if x < least { x } else { least }, if x > most { x } else { most })
                });
                ends.0 > high[a] || ends.1 < low[a]
            };
            if !(apart(0) || apart(1) || apart(2)) {
                visit(face);
            }
        });
    }
    /// Whether it is known to be convex, so that a ball shares one region with it.
    fn convex(&self) -> bool {
        false
    }
    /// Whether `x`, which is not near the surface, is inside: from the solid angles of all faces.
    fn holds(&self, x: Point) -> bool {
        let (mut corners, mut angle) = (Vec::new(), 0.0);
        self.each(|face| {
            corners.clear();
            corners.extend(face.iter().map(|i| self.corner(*i) - x));
            angle += polygon_angle(&corners);
        });
        angle > 2.0 * PI
    }
}

impl Faces for Polyhedron<'_> {
    fn n_corners(&self) -> usize {
        self.vertices.len()
    }
    fn corner(&self, i: u32) -> Point {
        self.vertices[i as usize]
    }
    fn each(&self, mut visit: impl FnMut(&[u32])) {
        self.faces.iter().for_each(|f| visit(f));
    }
}

impl Faces for Facets {
    fn n_corners(&self) -> usize {
        self.vertices.len()
    }
    fn corner(&self, i: u32) -> Point {
        Point::from(self.vertices[i as usize])
    }
    fn each(&self, mut visit: impl FnMut(&[u32])) {
        self.faces.iter().for_each(|f| visit(&f.corners));
    }
    fn near(&self, centre: Point, reach: Vector, mut visit: impl FnMut(&[u32])) {
        self.visit_near(centre.coords, reach, |f| visit(&self.faces[f as usize].corners));
    }
    fn holds(&self, x: Point) -> bool {
        holds(self, x.coords)
    }
}

/// Faces as loops, all of them looked at.
impl Faces for ConvexPolyhedron {
    fn n_corners(&self) -> usize {
        self.vertices().len()
    }
    fn corner(&self, i: u32) -> Point {
        self.vertices()[i as usize]
    }
    fn each(&self, visit: impl FnMut(&[u32])) {
        self.loops().for_each(visit);
    }
    fn convex(&self) -> bool {
        true
    }
    fn holds(&self, x: Point) -> bool {
        self.planes.iter().all(|p| p.normal.dot(&x.coords) <= p.offset)
    }
}

/// A ball or ellipsoid where it stands, as the image of the unit ball.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Round {
    centre: Point,
    /// Semi-axes \[m\]; all the same for a ball.
    axes: Vector,
    orientation: Rotation,
}

impl Round {
    pub(crate) fn ball(radius: f64, centre: Point) -> Self {
        Self { centre, axes: Vector::repeat(radius), orientation: Rotation::identity() }
    }
    /// An ellipsoid with semi-axes `axes` \[m\] along those of its frame.
    pub(crate) fn ellipsoid(axes: Vector, at: &Pose) -> Self {
        Self { centre: at.position, axes, orientation: at.orientation }
    }
    fn is_ball(&self) -> bool {
        self.axes.x == self.axes.y && self.axes.y == self.axes.z
    }
}

/// Sums over faces.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    beyond: f64,
    amount: f64,
    first: Vector,
    gradient: Vector,
    /// Σ ∫ x dA nᵀ.
    torque: Matrix3<f64>,
}

impl Sums {
    fn add(&mut self, part: &Part) {
        self.beyond += part.beyond;
        self.amount += part.amount;
        self.first -= part.normal * part.second;
        self.gradient -= part.normal * part.area;
        self.torque += part.moment * part.normal.transpose();
    }
}

/// The route, with its memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct BallFaces {
    corners: Vec<Vector>,
    plane: Vec<[f64; 2]>,
    parts: Vec<Part>,
    sheets: Sheets,
}

impl BallFaces {
    /// What `a` shares with `b`.
    pub(crate) fn overlap(&mut self, a: &Round, b: &impl Faces, at_b: &Pose, out: &mut Vec<Overlap>) {
        let centre = at_b.to_body(a.centre);
        // A ball has no orientation: it takes that of the body.
        let a = if a.is_ball() { Round { orientation: at_b.orientation, ..*a } } else { *a };
        let to_unit = a.axes.map(f64::recip);
        if a.is_ball() {
            let scale = to_unit.x;
            self.unit(&a, |x| (x - centre) * scale, centre, b, at_b, out);
        } else {
            let turn = (a.orientation.inverse() * at_b.orientation).to_rotation_matrix();
            let map = Matrix3::from_diagonal(&to_unit) * turn.matrix();
            self.unit(&a, |x| map * (x - centre), centre, b, at_b, out);
        }
    }

    fn unit(
        &mut self,
        a: &Round,
        map: impl Fn(Point) -> Vector,
        centre: Point,
        b: &impl Faces,
        at_b: &Pose,
        out: &mut Vec<Overlap>,
    ) {
        let apart = a.centre - at_b.position;
        if (0..b.n_corners() as u32).all(|i| map(b.corner(i)).norm_squared() <= 1.0) {
            out.extend(within(b).map(|(volume, centroid)| contained(volume, at_b.to_world(centroid), apart)));
            return;
        }
        let Self { corners, plane, parts, sheets } = self;
        let convex = b.convex();
        let (mut near_edge, mut sums) = (false, Sums::default());
        parts.clear();
        sheets.clear();
        b.near(centre, Vector::repeat(a.axes.max()), |face| {
            let corner = |i: &u32| map(b.corner(*i));
            // Most faces are triangles; they need no memory.
            let (mut three, mut flat);
            let (corners, plane) = if let [p, q, r] = face {
                (three, flat) = ([corner(p), corner(q), corner(r)], [[0.0; 2]; 3]);
                (&mut three[..], &mut flat[..])
            } else {
                corners.clear();
                corners.extend(face.iter().map(corner));
                plane.resize(face.len(), [0.0; 2]);
                (&mut corners[..], &mut plane[..])
            };
            let Some(f) = Face::new(corners) else { return };
            let part = f.part(plane, |i, length| {
                if !convex {
                    sheets.cut(face[i], face[if i + 1 < face.len() { i + 1 } else { 0 }], length);
                }
            });
            if let Some(part) = part {
                near_edge |= part.nearest2 < face::NEAR2;
                sums.add(&part);
                if !convex {
                    sheets.push(part.normal, part.area, part.moment, corners);
                    parts.push(part);
                }
            }
        });
        if sums.amount < TOUCH {
            if b.holds(centre) {
                out.push(contained(WHOLE * a.axes.product(), a.centre, apart));
            }
        } else if near_edge || sums.beyond.abs() <= NOTHING * sums.amount {
            let volume = self.angle(b, &map) / 3.0 - sums.beyond;
            out.extend(patch(a, volume, &sums, apart));
        } else if !convex && sheets.several() {
            sheets.regions([Vector::zeros()], |[centre], faces| {
                let mut sums = Sums::default();
                faces.for_each(|f| sums.add(&parts[f]));
                let whole = if centre { WHOLE } else { 0.0 };
                out.extend(patch(a, whole - sums.beyond, &sums, apart));
            });
        } else {
            let whole = if sums.beyond > 0.0 { WHOLE } else { 0.0 };
            out.extend(patch(a, whole - sums.beyond, &sums, apart));
        }
    }

    /// Solid angle of all faces seen from the centre: 4π inside, and whatever goes with the parts of faces that touch it.
    fn angle(&mut self, b: &impl Faces, map: impl Fn(Point) -> Vector) -> f64 {
        let Self { corners, plane, .. } = self;
        let mut angle = 0.0;
        b.each(|face| {
            corners.clear();
            corners.extend(face.iter().map(|i| map(b.corner(*i))));
            angle += seen_angle(corners, plane);
        });
        angle
    }
}

/// Volume and centroid of the whole of `b`, summed over tetrahedra from its first corner.
pub(super) fn within(b: &impl Faces) -> Option<(f64, Point)> {
    if b.n_corners() == 0 {
        return None;
    }
    let apex = b.corner(0);
    let (mut volume, mut first) = (0.0, Vector::zeros());
    b.each(|face| {
        let corner = |i: u32| b.corner(i) - apex;
        let p = corner(face[0]);
        for pair in face[1..].windows(2) {
            let (q, r) = (corner(pair[0]), corner(pair[1]));
            let part = p.dot(&q.cross(&r)) / 6.0;
            volume += part;
            first += (p + q + r) * (0.25 * part);
        }
    });
    (volume > 0.0).then(|| (volume, apex + first / volume))
}

/// One within the other: the volume no longer changes.
pub(super) fn contained(volume: f64, centroid: Point, apart: Vector) -> Overlap {
    let normal = apart.try_normalize(0.0).unwrap_or(Vector::x());
    Overlap::whole(volume, centroid, normal)
}

/// The region of `volume` whose faces have the `sums`, back in the world; `None` when it is empty.
fn patch(a: &Round, volume: f64, sums: &Sums, apart: Vector) -> Option<Overlap> {
    if volume <= 0.0 {
        return None;
    }
    let (axes, det) = (a.axes, a.axes.product());
    let areas = axes.map(|s| det / s);
    let arm = (sums.first / volume).component_mul(&axes);
    let gradient = sums.gradient.component_mul(&areas);
    let mut moment = gradient.cross(&arm);
    if !a.is_ball() {
        let z = |j: usize, k: usize| axes[j] * sums.torque[(j, k)] * areas[k];
        moment -= Vector::new(z(1, 2) - z(2, 1), z(2, 0) - z(0, 2), z(0, 1) - z(1, 0));
    }
    let gradient = a.orientation * gradient;
    Some(Overlap {
        volume: volume.min(WHOLE) * det,
        centroid: a.centre + a.orientation * arm,
        normal: (-gradient).try_normalize(0.0).or_else(|| apart.try_normalize(0.0)).unwrap_or(Vector::x()),
        gradient,
        moment: a.orientation * moment,
        pivot: nalgebra::Matrix3::zeros(),
    })
}
