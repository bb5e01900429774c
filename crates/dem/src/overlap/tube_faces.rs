//! A capsule or cylinder and a body of flat faces, convex or not: exact sums over the faces within
//! it.
//!
//! Lengths are divided by the radius; z is the axis, h half the length of the straight part. With
//! the outward normals n of the faces and A₊, A₋ the areas of the body's sections at z = ±h within
//! the unit circle, the divergence theorem for the field (0, 0, z), which does not pass the mantle,
//! gives for the straight part
//!
//! - V = Σ n_z ∫ z dA + h (A₊ + A₋),
//! - ∫ z dV = Σ n_z ∫ z²/2 dA + h² (A₊ − A₋)/2,
//! - ∫ x dV = −Σ n_x ∫ (1 − x² − y²)/2 dA, and the same of y.
//!
//! Sections are summed along rays from their centres: A = \[centre inside\] π − Σ of what lies
//! beyond the segments in which faces cross the plane. What a half ball at an end shares with the
//! body is summed along rays from its centre, too ([`ball_faces`](super::ball_faces)), over the
//! parts of faces beyond the plane of its flat side: no ray runs in that plane. Everywhere S = −Σ n
//! ∫ dA, and the moment about the centroid follows from Σ ∫ x dA × n.
mod level;
mod mantle;
mod section;
mod segment;
#[cfg(test)]
mod tests;

use super::Overlap;
use super::ball_faces::face::{self, Face};
use super::ball_faces::{Faces, contained, within};
use super::sheets::Sheets;
use crate::{Capsule, Cylinder, HalfSpace, Shape, SmoothConvex};
use interfaces::{Point, Pose, Vector};
use mantle::Mantle;
use nalgebra::Matrix3;
use section::Beyond;
use std::f64::consts::PI;

/// Areas of sections and volumes of half balls of which not even the sign is known, in units of the
/// radius.
const NOTHING: f64 = 1e-12;

/// Squared distance from the centre of an end, in radii, at which the direction of an edge from
/// there is rounding: the tube is moved off such an edge.
const ON_EDGE2: f64 = 1e-22;
/// Moves off an edge, in radii, the second one if the edge goes along the first.
const STEPS: [[f64; 3]; 2] = [[0.48e-10, 0.64e-10, 0.6e-10], [0.64e-10, -0.48e-10, 0.6e-10]];

/// Half a unit ball.
const HALF_BALL: f64 = 2.0 / 3.0 * PI;

/// A capsule or cylinder at a pose.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tube {
    /// \[m\].
    radius: f64,
    /// Half the length of the straight part, in radii.
    half: f64,
    round: bool,
    /// \[m³\].
    volume: f64,
    at: Pose,
}

impl Tube {
    pub(crate) fn capsule(shape: &Capsule, at: &Pose) -> Self {
        let radius = shape.radius();
        Self {
            radius,
            half: 0.5 * shape.length() / radius,
            round: true,
            volume: shape.inertia(1.0).volume,
            at: *at,
        }
    }
    pub(crate) fn cylinder(shape: &Cylinder, at: &Pose) -> Self {
        let radius = shape.radius();
        Self {
            radius,
            half: 0.5 * shape.length() / radius,
            round: false,
            volume: shape.inertia(1.0).volume,
            at: *at,
        }
    }
    fn top(&self) -> f64 {
        self.half + if self.round { 1.0 } else { 0.0 }
    }
    fn holds(&self, x: &Vector) -> bool {
        let beyond = (x.z.abs() - self.half).max(0.0);
        let flat2 = x.x * x.x + x.y * x.y;
        if self.round { flat2 + beyond * beyond <= 1.0 } else { flat2 <= 1.0 && beyond == 0.0 }
    }
    /// Length of the segment from `p` to `q` within the tube.
    fn length_within(&self, p: Vector, q: Vector) -> f64 {
        let way = q - p;
        let (o, u) = (Point::from(p), way);
        let chord = if self.round {
            Capsule::new(1.0, 2.0 * self.half).ok().and_then(|c| c.chord(o, u))
        } else {
            Cylinder::new(1.0, 2.0 * self.half).ok().and_then(|c| c.chord(o, u))
        };
        chord.map_or(0.0, |[from, to]| (to.min(1.0) - from.max(0.0)).max(0.0) * way.norm())
    }
}

/// From the frame of the body to that of the tube, in radii.
struct Map {
    /// Middle of the tube in the frame of the body \[m\].
    centre: Point,
    /// Axis of the tube there.
    axis: Vector,
    linear: Matrix3<f64>,
}

impl Map {
    fn new(a: &Tube, at_b: &Pose) -> Self {
        let turn = (a.at.orientation.inverse() * at_b.orientation).to_rotation_matrix();
        Self {
            centre: at_b.to_body(a.at.position),
            axis: turn.inverse_transform_vector(&Vector::z()),
            linear: turn.matrix() / a.radius,
        }
    }
    fn apply(&self, x: Point) -> Vector {
        self.linear * (x - self.centre)
    }
}

/// Sums over faces, about the middle of the tube.
#[derive(Clone, Copy, Debug)]
struct Sums {
    /// Volume and ∫ x dV but for what the centres of the ends add if they are inside.
    volume: f64,
    first: Vector,
    gradient: Vector,
    /// Σ ∫ x dA × n.
    torque: Vector,
    /// A₋ − A₊.
    flux: f64,
    /// Integrals beyond the segments of the sections, of the lower end first.
    sections: [Beyond; 2],
    /// Squared distance of the nearest edge within a half ball from its centre.
    nearest2: f64,
}

impl Default for Sums {
    fn default() -> Self {
        let (zero, none) = (Vector::zeros(), Beyond::default());
        Self {
            volume: 0.0,
            first: zero,
            gradient: zero,
            torque: zero,
            flux: 0.0,
            sections: [none; 2],
            nearest2: f64::INFINITY,
        }
    }
}

impl Sums {
    /// Squared distance of the nearest edge or segment from the centre of an end.
    fn nearest2(&self) -> f64 {
        self.sections.iter().fold(self.nearest2, |least, s| least.min(s.nearest2))
    }
    fn add(&mut self, o: &Self) {
        self.volume += o.volume;
        self.first += o.first;
        self.gradient += o.gradient;
        self.torque += o.torque;
        self.flux += o.flux;
        self.sections[0].add(&o.sections[0]);
        self.sections[1].add(&o.sections[1]);
        self.nearest2 = self.nearest2.min(o.nearest2);
    }
    /// Adds a part of a face by its normal, ∫ dA and ∫ x dA.
    fn add_area(&mut self, normal: Vector, area: f64, moment: Vector) {
        self.gradient -= normal * area;
        self.torque += moment.cross(&normal);
    }
}

/// Shares of the whole that the centres of the ends see of the body: 1 inside, 0 outside, between
/// if they are on its surface.
#[derive(Clone, Copy, Debug)]
struct Shares {
    /// Of the section's plane.
    plane: [f64; 2],
    /// Of the half space beyond.
    solid: [f64; 2],
}

impl From<[bool; 2]> for Shares {
    fn from(inside: [bool; 2]) -> Self {
        let share = inside.map(|i| if i { 1.0 } else { 0.0 });
        Self { plane: share, solid: share }
    }
}

/// The route, with its memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct TubeFaces {
    corners: Vec<Vector>,
    places: Vec<[f64; 2]>,
    scratch: mantle::Scratch,
    below: Vec<Vector>,
    middle: Vec<Vector>,
    beyond: [Vec<Vector>; 2],
    parts: Vec<Sums>,
    sheets: Sheets,
}

impl TubeFaces {
    /// Adds the regions that `a` shares with `b`.
    pub(crate) fn overlap(&mut self, a: &Tube, b: &impl Faces, at_b: &Pose, out: &mut Vec<Overlap>) {
        let (mut a, mut map) = (*a, Map::new(a, at_b));
        let apart = a.at.position - at_b.position;
        if (0..b.n_corners() as u32).all(|i| a.holds(&map.apply(b.corner(i)))) {
            let whole = within(b).map(|(volume, x)| contained(volume, at_b.to_world(x), apart));
            out.extend(whole);
            return;
        }
        let mut found = self.sum(&a, &map, b);
        for off in STEPS {
            if found.as_ref().is_some_and(|sums| sums.nearest2() < ON_EDGE2) {
                a.at.position += a.at.orientation * Vector::from(off) * a.radius;
                map = Map::new(&a, at_b);
                found = self.sum(&a, &map, b);
            }
        }
        let a = &a;
        let Some(sums) = found else {
            if b.holds(map.centre) {
                out.push(contained(a.volume, a.at.position, apart));
            }
            return;
        };
        let near = sums.nearest2() < face::NEAR2;
        if !near && !b.convex() && self.sheets.several() {
            let ends = [-a.half, a.half].map(|z| Vector::z() * z);
            let Self { sheets, parts, .. } = self;
            sheets.regions(ends, |inside, faces| {
                let mut sums = Sums::default();
                faces.for_each(|f| sums.add(&parts[f]));
                out.extend(region(a, &sums, inside.into(), apart));
            });
            return;
        }
        let known = if near { None } else { ends_inside(&sums) };
        let shares = known.map_or_else(|| self.shares(a, &map, b), Shares::from);
        out.extend(region(a, &sums, shares, apart));
    }

    /// Sums over all faces that the tube reaches, listed by sheets unless the body is convex;
    /// `None` if there are none.
    fn sum(&mut self, a: &Tube, map: &Map, b: &impl Faces) -> Option<Sums> {
        let reach = map.axis.map(|n| {
            let across = if a.round { 1.0 } else { (1.0 - n * n).max(0.0).sqrt() };
            (a.half * n.abs() + across) * a.radius
        });
        let convex = b.convex();
        self.parts.clear();
        self.sheets.clear();
        let mut sums: Option<Sums> = None;
        b.near(map.centre, reach, |face| {
            let mut corners = std::mem::take(&mut self.corners);
            corners.clear();
            corners.extend(face.iter().map(|i| map.apply(b.corner(*i))));
            if let Some(part) = self.face(a, &corners) {
                sums.get_or_insert_default().add(&part.sums);
                if !convex && part.area > 0.0 {
                    for (i, p) in corners.iter().enumerate() {
                        let j = if i + 1 < corners.len() { i + 1 } else { 0 };
                        let length = a.length_within(*p, corners[j]);
                        if length > 0.0 {
                            self.sheets.cut(face[i], face[j], length);
                        }
                    }
                    self.sheets.push(part.normal, part.area, part.moment, &corners);
                    self.parts.push(part.sums);
                }
            }
            self.corners = corners;
        });
        sums
    }

    /// Parts of a convex face between the ends and, moved to their centres, beyond them; the
    /// segments in which it crosses the planes of the ends, the lower first.
    fn split(&mut self, a: &Tube, corners: &[Vector]) -> [Option<[Vector; 2]>; 2] {
        let Self { below, middle, beyond: [lower, upper], .. } = self;
        let above = level::cut(corners, a.half, below, upper);
        // The mirror image is cut, whose segments run the other way around.
        let mirror = |polygon: &mut Vec<Vector>| polygon.iter_mut().for_each(|x| x.z = -x.z);
        mirror(below);
        let under = level::cut(below, a.half, middle, lower).map(|[p, q]| [q, p]);
        mirror(middle);
        mirror(lower);
        upper.iter_mut().for_each(|x| x.z -= a.half);
        lower.iter_mut().for_each(|x| x.z += a.half);
        [under, above]
    }

    /// Integrals over a convex face, given by its corners counter-clockwise; `None` where it is off
    /// the tube.
    fn face(&mut self, a: &Tube, corners: &[Vector]) -> Option<Part> {
        let normal = normal(a, corners)?;
        let mut part = Part { normal, area: 0.0, moment: Vector::zeros(), sums: Sums::default() };
        let segments = self.split(a, corners);
        for (end, segment) in segments.iter().enumerate() {
            if let Some([p, q]) = segment {
                part.add_section(a, end, *p, *q);
            }
        }
        let Self { middle, beyond, scratch, places, .. } = self;
        if middle.len() > 2 {
            part.add_mantle(&Mantle::new(middle, normal, scratch));
        }
        for (end, polygon) in beyond.iter().enumerate().filter(|(_, p)| a.round && p.len() > 2) {
            part.add_ball(a, end, polygon, places);
        }
        let touched = part.area > 0.0 || part.sums.sections.iter().any(|s| s.area != 0.0);
        touched.then_some(part)
    }

    /// Shares of the planes and half spaces at the ends, by all faces and the numbers that their
    /// integrals use.
    fn shares(&mut self, a: &Tube, map: &Map, b: &impl Faces) -> Shares {
        let (mut plane, mut solid) = ([0.0; 2], [0.0; 2]);
        let mut corners = std::mem::take(&mut self.corners);
        b.each(|face| {
            corners.clear();
            corners.extend(face.iter().map(|i| map.apply(b.corner(*i))));
            let segments = self.split(a, &corners);
            let Self { places, beyond, .. } = self;
            for end in 0..2 {
                if let Some([p, q]) = segments[end] {
                    plane[end] += section::angle(p, q) / (2.0 * PI);
                }
                let polygon = &beyond[end];
                if polygon.len() > 2 {
                    places.resize(polygon.len(), [0.0; 2]);
                    let angle = match Face::new(polygon) {
                        Some(f) => f.solid_angle(places),
                        None => face::polygon_angle(polygon),
                    };
                    solid[end] += angle / (2.0 * PI);
                }
            }
        });
        self.corners = corners;
        Shares { plane, solid }
    }
}

/// Unit normal of a face, `None` if it has no area or its box is off that of the tube.
fn normal(a: &Tube, corners: &[Vector]) -> Option<Vector> {
    let limit = Vector::new(1.0, 1.0, a.top());
    let start = (Vector::repeat(f64::INFINITY), Vector::repeat(f64::NEG_INFINITY));
    let (low, high) = corners.iter().fold(start, |(low, high), x| (low.inf(x), high.sup(x)));
    if (0..3).any(|i| low[i] > limit[i] || high[i] < -limit[i]) {
        return None;
    }
    let first = corners[0];
    let double: Vector =
        corners[1..].windows(2).map(|pair| (pair[0] - first).cross(&(pair[1] - first))).sum();
    let normal = double.try_normalize(0.0)?;
    // Distance of the plane against the tube's reach.
    let across = if a.round { 1.0 } else { normal.xy().norm() };
    (normal.dot(&first).abs() <= a.half * normal.z.abs() + across).then_some(normal)
}

/// Integrals over the part of one face.
#[derive(Clone, Copy, Debug)]
struct Part {
    normal: Vector,
    area: f64,
    moment: Vector,
    sums: Sums,
}

impl Part {
    /// Adds a segment of the section at an end.
    fn add_section(&mut self, a: &Tube, end: usize, p: Vector, q: Vector) {
        let (beyond, sign) = (Beyond::new(p, q), [-1.0, 1.0][end]);
        self.sums.volume -= a.half * beyond.area;
        self.sums.first.z -= sign * 0.5 * a.half * a.half * beyond.area;
        if a.round {
            self.sums.first.z -= sign * beyond.second;
        }
        self.sums.sections[end].add(&beyond);
    }
    fn add_mantle(&mut self, m: &Mantle) {
        let n = self.normal;
        self.area += m.area;
        self.moment += m.moment;
        self.sums.add_area(n, m.area, m.moment);
        self.sums.flux += n.z * m.area;
        self.sums.volume += n.z * m.moment.z;
        self.sums.first += Vector::new(-n.x * m.second, -n.y * m.second, 0.5 * n.z * m.z2);
    }
    /// Adds the part within the half ball at an end, of a polygon seen from its centre.
    fn add_ball(&mut self, a: &Tube, end: usize, polygon: &[Vector], places: &mut Vec<[f64; 2]>) {
        let centre = Vector::z() * [-a.half, a.half][end];
        places.resize(polygon.len(), [0.0; 2]);
        let Some(part) = Face::new(polygon).and_then(|f| f.part(places, |_, _| {})) else { return };
        let moment = part.moment + centre * part.area;
        self.area += part.area;
        self.moment += moment;
        self.sums.add_area(part.normal, part.area, moment);
        self.sums.volume -= part.beyond;
        self.sums.first -= centre * part.beyond + part.normal * part.second;
        self.sums.nearest2 = self.sums.nearest2.min(part.nearest2);
    }
}

/// Whether the centres of the ends are inside, by the signs of sums that are known; `None` where
/// they are not.
fn ends_inside(sums: &Sums) -> Option<[bool; 2]> {
    let beyond = sums.sections.map(|s| s.area);
    let sign = beyond.map(|b| if b.abs() > NOTHING { Some(b > 0.0) } else { None });
    // Area of the section at the other end, from that at an end.
    let other = |inside: bool, end: usize| {
        let area = if inside { PI - beyond[end] } else { -beyond[end] };
        let area = if end == 1 { area + sums.flux } else { area - sums.flux };
        area + beyond[1 - end] > 0.5 * PI
    };
    match sign {
        [Some(lower), Some(upper)] => Some([lower, upper]),
        [Some(lower), None] => Some([lower, other(lower, 0)]),
        [None, Some(upper)] => Some([other(upper, 1), upper]),
        [None, None] if sums.flux.abs() > 0.5 * PI => Some([sums.flux > 0.0, sums.flux < 0.0]),
        [None, None] => None,
    }
}

/// The region whose faces have the `sums`, back in the world; `None` if it is empty.
fn region(a: &Tube, sums: &Sums, shares: Shares, apart: Vector) -> Option<Overlap> {
    let (mut volume, mut first) = (sums.volume, sums.first);
    for (end, sign) in [(0, -1.0), (1, 1.0)] {
        let (plane, solid) = (shares.plane[end], shares.solid[end]);
        volume += PI * a.half * plane;
        first.z += sign * 0.5 * PI * a.half * a.half * plane;
        if a.round {
            volume += HALF_BALL * solid;
            first.z += sign * (HALF_BALL * a.half * solid + 0.25 * PI * plane);
        }
    }
    if !(volume > NOTHING * f64::EPSILON) {
        return None;
    }
    let arm = first / volume;
    let gradient = sums.gradient;
    let moment = gradient.cross(&arm) - sums.torque;
    let world = |v: Vector| a.at.orientation * v;
    let r = a.radius;
    let gradient = world(gradient) * (r * r);
    Some(Overlap {
        volume: (volume * r.powi(3)).min(a.volume),
        centroid: a.at.position + world(arm) * r,
        normal: (-gradient).try_normalize(0.0).or_else(|| apart.try_normalize(0.0)).unwrap_or(Vector::x()),
        gradient,
        moment: world(moment) * r.powi(3),
        pivot: Matrix3::zeros(),
    })
}

/// A wall as a closed box, larger than the tube, whose upper side is the wall.
pub(crate) struct WallBox {
    corners: [Point; 8],
    wall: HalfSpace,
}

impl WallBox {
    pub(crate) fn new(a: &Tube, wall: &HalfSpace) -> Self {
        let n = wall.normal();
        let size = 4.0 * (a.half + 1.0) * a.radius;
        let u = n.cross(&Vector::ith(n.iamin(), 1.0)).normalize();
        let v = n.cross(&u);
        let foot = a.at.position - n * wall.signed_distance(a.at.position);
        let corners = std::array::from_fn(|i| {
            let side = |bit: usize| if i >> bit & 1 == 0 { -size } else { size };
            let depth = if i & 4 == 0 { -2.0 * size } else { 0.0 };
            foot + u * side(0) + v * side(1) + n * depth
        });
        Self { corners, wall: *wall }
    }
}

impl Faces for WallBox {
    fn n_corners(&self) -> usize {
        self.corners.len()
    }
    fn corner(&self, i: u32) -> Point {
        self.corners[i as usize]
    }
    fn each(&self, visit: impl FnMut(&[u32])) {
        const LOOPS: [[u32; 4]; 6] =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        LOOPS.iter().map(|l| l.as_slice()).for_each(visit);
    }
    fn convex(&self) -> bool {
        true
    }
    fn holds(&self, x: Point) -> bool {
        self.wall.signed_distance(x) <= 0.0
    }
}
