//! Discs and spheres, with one another and with plane walls: lenses, segments and caps.
use super::Overlap;
use interfaces::{Point, Vector};
use nalgebra::Matrix3;
use std::f64::consts::PI;

/// A part of a disc or sphere of radius `r` beyond a plane, `s` deep: its volume, the distance of
/// its centroid from the centre, and the area of the cut.
pub(super) struct Part {
    pub(super) volume: f64,
    pub(super) centroid: f64,
    pub(super) cut: f64,
}

/// Circular segment: area ½r²(2α − sin 2α) with cos α = 1 − s/r.
pub(super) fn segment(r: f64, s: f64) -> Part {
    let s = s.clamp(0.0, 2.0 * r); // Round-off may lead beyond.
    let half = (s * (2.0 * r - s)).sqrt();
    let twice = 4.0 * (s / (2.0 * r)).sqrt().min(1.0).asin();
    // 2α − sin 2α without cancellation.
    let bulge = if twice < 0.3 {
        let x2 = twice * twice;
        twice * x2 / 6.0 * (1.0 - x2 / 20.0 * (1.0 - x2 / 42.0 * (1.0 - x2 / 72.0 * (1.0 - x2 / 110.0))))
    } else {
        twice - twice.sin()
    };
    let volume = 0.5 * r * r * bulge;
    // ∫ x dA = ⅔ half³.
    let centroid = if volume > 0.0 { 2.0 / 3.0 * half.powi(3) / volume } else { r };
    Part { volume, centroid, cut: 2.0 * half }
}

/// Spherical cap: V = πs²(3r − s)/3, centroid at ¾(2r − s)²/(3r − s).
#[inline]
fn cap(r: f64, s: f64) -> Part {
    let s = s.clamp(0.0, 2.0 * r); // Round-off may lead beyond.
    Part {
        volume: PI * s * s * (3.0 * r - s) / 3.0,
        centroid: 0.75 * (2.0 * r - s).powi(2) / (3.0 * r - s),
        cut: PI * s * (2.0 * r - s),
    }
}

/// Round bodies have no moment about the centroid: it lies on the line of centres, and so does the gradient.
#[inline]
fn overlap(volume: f64, centroid: Point, normal: Vector, area: f64) -> Overlap {
    Overlap {
        volume,
        centroid,
        normal,
        gradient: -area * normal,
        moment: Vector::zeros(),
        pivot: Matrix3::zeros(),
    }
}

pub(crate) fn discs(ra: f64, a: Point, rb: f64, b: Point) -> Option<Overlap> {
    pair(ra, a, rb, b, segment, |r| PI * r * r)
}

#[inline(always)]
pub(crate) fn spheres(ra: f64, a: Point, rb: f64, b: Point) -> Option<Overlap> {
    let apart = a - b;
    spheres_apart(ra, a, rb, b, apart, apart.norm())
}

/// What two spheres share whose centres are `apart`, that far.
#[inline(always)]
pub(super) fn spheres_apart(ra: f64, a: Point, rb: f64, b: Point, apart: Vector, d: f64) -> Option<Overlap> {
    if ra + rb - d <= 0.0 {
        None
    } else if d > (ra - rb).abs() {
        Some(lens_apart(ra, a, rb, apart, d).overlap)
    } else {
        Some(nested(ra, a, rb, b, apart, d))
    }
}

/// What two spheres share of which one is within the other.
#[cold]
fn nested(ra: f64, a: Point, rb: f64, b: Point, apart: Vector, d: f64) -> Overlap {
    let (r, centroid) = if ra < rb { (ra, a) } else { (rb, b) };
    let normal = if d > 0.0 { apart / d } else { Vector::x() };
    Overlap::whole(4.0 / 3.0 * PI * r.powi(3), centroid, normal)
}

/// What a sphere shares with another one or with a wall, and what is known about it because all lies along the normal.
pub(crate) struct Lens {
    pub(crate) overlap: Overlap,
    /// Of the common circle.
    pub(crate) area: f64,
    /// Distances of the centroid from both centres; infinite for a wall.
    pub(crate) arms: [f64; 2],
}

/// What two spheres share that overlap, neither within the other.
#[inline(always)]
pub(crate) fn lens(ra: f64, a: Point, rb: f64, b: Point) -> Lens {
    let apart = a - b;
    lens_apart(ra, a, rb, apart, apart.norm())
}

/// Two caps on the common circle, s_a and s_b deep. The centroid divides the line of centres as the volumes of the caps do: both have
/// the same moment about their own centre, π/4 of the circle's radius to the fourth. Of all, products with powers of the distance d of
/// the centres are taken first, so that neither division waits for the other.
#[inline(always)]
fn lens_apart(ra: f64, a: Point, rb: f64, apart: Vector, d: f64) -> Lens {
    let depth = ra + rb - d;
    let per_distance = 1.0 / d;
    // s d, and d³/π of the caps' volumes π s² (r − s/3).
    let [ta, tb] = [rb, ra].map(|other| 0.5 * depth * (2.0 * other - depth));
    let [va, vb] = [(ra, ta), (rb, tb)].map(|(r, t)| t * t * (r * d - t * (1.0 / 3.0)));
    let both = va + vb;
    let share = if both > 0.0 { vb / both } else { 0.5 };
    let (t, r) = if ta < tb { (ta, ra) } else { (tb, rb) };
    let s = t * per_distance;
    let normal = apart * per_distance;
    let area = PI * s * (2.0 * r - s);
    let volume = PI * both * (per_distance * per_distance * per_distance);
    let overlap = overlap(volume, a - apart * share, normal, area);
    Lens { overlap, area, arms: [share * d, d - share * d] }
}

/// What a sphere and a half-space share whose centre is `distance` above its plane, less than the radius in or out.
#[inline(always)]
pub(crate) fn cap_at_wall(r: f64, at: Point, distance: f64, normal: Vector) -> Lens {
    let Part { volume, centroid, cut } = cap(r, r - distance);
    let overlap = overlap(volume, at - normal * centroid, normal, cut);
    Lens { overlap, area: cut, arms: [centroid, f64::INFINITY] }
}

pub(crate) fn disc_wall(r: f64, at: Point, distance: f64, normal: Vector) -> Option<Overlap> {
    wall(r, at, distance, normal, segment, PI * r * r)
}

pub(crate) fn sphere_wall(r: f64, at: Point, distance: f64, normal: Vector) -> Option<Overlap> {
    wall(r, at, distance, normal, cap, 4.0 / 3.0 * PI * r.powi(3))
}

fn pair(
    ra: f64,
    a: Point,
    rb: f64,
    b: Point,
    part: impl Fn(f64, f64) -> Part,
    whole: impl Fn(f64) -> f64,
) -> Option<Overlap> {
    let apart = a - b;
    let d = apart.norm();
    let depth = ra + rb - d;
    if depth <= 0.0 {
        return None;
    }
    let normal = if d > 0.0 { apart / d } else { Vector::x() };
    if d <= (ra - rb).abs() {
        // One inside the other: no force from the gradient, but the volume is known.
        let (r, centroid) = if ra < rb { (ra, a) } else { (rb, b) };
        return Some(Overlap::whole(whole(r), centroid, normal));
    }
    // Depth of each one's part beyond the plane of the common circle, without cancellation.
    let (sa, sb) = (depth * (2.0 * rb - depth) / (2.0 * d), depth * (2.0 * ra - depth) / (2.0 * d));
    let (pa, pb) = (part(ra, sa), part(rb, sb));
    let volume = pa.volume + pb.volume;
    let from_a = a - normal * pa.centroid;
    let from_b = b + normal * pb.centroid;
    let share = if volume > 0.0 { pb.volume / volume } else { 0.5 };
    let area = if sa < sb { pa.cut } else { pb.cut };
    Some(overlap(volume, from_a + (from_b - from_a) * share, normal, area))
}

fn wall(
    r: f64,
    at: Point,
    distance: f64,
    normal: Vector,
    part: impl Fn(f64, f64) -> Part,
    whole: f64,
) -> Option<Overlap> {
    let depth = r - distance;
    if depth <= 0.0 {
        None
    } else if depth >= 2.0 * r {
        Some(Overlap::whole(whole, at, normal))
    } else {
        let p = part(r, depth);
        Some(overlap(p.volume, at - normal * p.centroid, normal, p.cut))
    }
}
