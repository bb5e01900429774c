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
mod part;
mod section;
mod segment;
#[cfg(test)]
mod tests;
mod unit_tube;
mod wall_box;

pub(crate) use unit_tube::UnitTube;
pub(crate) use wall_box::WallBox;

use super::Overlap;
use super::ball_faces::face;
use super::ball_faces::{Faces, contained, within};
use super::sheets::Sheets;
use interfaces::{Pose, Vector};
use mantle::Mantle;
use nalgebra::Matrix3;
use part::{Part, Sums};
use std::f64::consts::PI;
use unit_tube::Map;

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
    pub(crate) fn overlap(&mut self, a: &UnitTube<'_>, b: &impl Faces, at_b: &Pose, out: &mut Vec<Overlap>) {
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
    fn sum(&mut self, a: &UnitTube<'_>, map: &Map, b: &impl Faces) -> Option<Sums> {
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
    fn split(&mut self, a: &UnitTube<'_>, corners: &[Vector]) -> [Option<[Vector; 2]>; 2] {
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
    fn face(&mut self, a: &UnitTube<'_>, corners: &[Vector]) -> Option<Part> {
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
    fn shares(&mut self, a: &UnitTube<'_>, map: &Map, b: &impl Faces) -> Shares {
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
                    solid[end] += face::seen_angle(polygon, places) / (2.0 * PI);
                }
            }
        });
        self.corners = corners;
        Shares { plane, solid }
    }
}

/// Unit normal of a face, `None` if it has no area or its box is off that of the tube.
fn normal(a: &UnitTube<'_>, corners: &[Vector]) -> Option<Vector> {
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
fn region(a: &UnitTube<'_>, sums: &Sums, shares: Shares, apart: Vector) -> Option<Overlap> {
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
    if volume.is_nan() || volume <= NOTHING * f64::EPSILON {
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
