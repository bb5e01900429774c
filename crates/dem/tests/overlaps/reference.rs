//! Overlap volumes by routes of their own: clipped convex parts, adaptive quadrature over sections.
use crate::kinds::{Body, ConvexPart, Geometry};
use crate::quadrature::{integrate, integrate_between};
use interfaces::{Pose, Vector};
use nalgebra::Matrix3;
use std::f64::consts::PI;

/// x ↦ linear·x + shift.
#[derive(Clone, Copy)]
struct Affine {
    linear: Matrix3<f64>,
    shift: Vector,
}

impl Affine {
    /// From the frame of the body at `from` to that of the body at `to`.
    fn between(from: &Pose, to: &Pose) -> Self {
        let linear = (to.orientation.inverse() * from.orientation).to_rotation_matrix().into_inner();
        Self { linear, shift: to.to_body(from.position).coords }
    }
    /// Divides coordinates by `scale` afterwards.
    fn scaled(self, scale: Vector) -> Self {
        let divide = Matrix3::from_diagonal(&scale.map(f64::recip));
        Self { linear: divide * self.linear, shift: divide * self.shift }
    }
    fn part(&self, part: &ConvexPart) -> ConvexPart {
        let normals = self.linear.try_inverse().expect("a regular map").transpose();
        let planes = part.planes.iter().map(|(n, d)| {
            let n = normals * n;
            let size = n.norm();
            (n / size, (d + n.dot(&self.shift)) / size)
        });
        let vertices = part.vertices.iter().map(|v| self.linear * v + self.shift);
        ConvexPart { planes: planes.collect(), vertices: vertices.collect() }
    }
}

/// Volume that two bodies share \[m³\]: to rounding for two of flat faces and for two spheres, to about 1e-12 of the
/// smaller body where one has flat faces, else to 1e-7.
pub(crate) fn volume(a: &Body, at_a: &Pose, b: &Body, at_b: &Pose) -> f64 {
    let small = a.volume().min(b.volume());
    match (&a.geometry, &b.geometry) {
        (Geometry::Parts(p), Geometry::Parts(q)) => {
            let map = Affine::between(at_b, at_a);
            let q: Vec<ConvexPart> = q.iter().map(|part| map.part(part)).collect();
            p.iter().flat_map(|p| q.iter().map(|q| convex_parts(p, q))).sum()
        }
        (Geometry::Parts(p), round) => {
            let (map, axis) = Axisymmetric::of(round, Affine::between(at_a, at_b));
            p.iter().map(|p| round_and_part(&axis, &map.part(p), small / axis.scale)).sum::<f64>()
                * axis.scale
        }
        (round, Geometry::Parts(q)) => {
            let (map, axis) = Axisymmetric::of(round, Affine::between(at_b, at_a));
            q.iter().map(|q| round_and_part(&axis, &map.part(q), small / axis.scale)).sum::<f64>()
                * axis.scale
        }
        (Geometry::Ellipsoid(p), Geometry::Ellipsoid(q)) if p.max() == p.min() && q.max() == q.min() => {
            spheres(p.x, q.x, (at_b.position - at_a.position).norm())
        }
        (Geometry::Ellipsoid(_), Geometry::Capsule(..) | Geometry::Cylinder(..)) => volume(b, at_b, a, at_a),
        (p, q) => {
            let (map, axis) = Axisymmetric::of(p, Affine::between(at_b, at_a));
            round_and_round(&axis, q, &map, small / axis.scale) * axis.scale
        }
    }
}

/// A body of revolution about z, after division of coordinates by semi-axes if it was an ellipsoid.
struct Axisymmetric {
    radius: f64,
    half: f64,
    round_ends: bool,
    /// Volume per mapped volume.
    scale: f64,
}

impl Axisymmetric {
    fn of(geometry: &Geometry, map: Affine) -> (Affine, Self) {
        match *geometry {
            Geometry::Ellipsoid(axes) => {
                let unit = Self { radius: 1.0, half: 0.0, round_ends: true, scale: axes.product() };
                (map.scaled(axes), unit)
            }
            Geometry::Capsule(radius, half) => (map, Self { radius, half, round_ends: true, scale: 1.0 }),
            Geometry::Cylinder(radius, half) => (map, Self { radius, half, round_ends: false, scale: 1.0 }),
            Geometry::Parts(_) => unreachable!("has flat faces"),
        }
    }
    fn top(&self) -> f64 {
        self.half + if self.round_ends { self.radius } else { 0.0 }
    }
    /// Heights at which sections of planes touch the rim of a section, and at which edges cross the surface.
    fn heights_of_touch(&self, part: &ConvexPart, heights: &mut Vec<f64>) {
        let balls: &[f64] = if self.round_ends { &[-self.half, self.half] } else { &[] };
        for (n, d) in &part.planes {
            let slope = n.xy().norm();
            for centre in balls {
                let distance = d - n.z * centre;
                let radius = ((self.radius - distance) * (self.radius + distance)).max(0.0).sqrt();
                heights.extend([-1.0, 1.0].map(|sign| centre + distance * n.z + sign * radius * slope));
            }
            heights.extend([-1.0, 1.0].map(|sign| (d + sign * self.radius * slope) / n.z));
        }
        for [p, q] in part.edges() {
            let u = q - p;
            let mut cross = |a: f64, b: f64, c: f64| {
                // a t² + 2 b t + c = 0.
                let root = (b * b - a * c).sqrt();
                heights.extend([(-b - root) / a, (-b + root) / a].map(|t| p.z + t * u.z));
            };
            let square = |v: Vector| v.norm_squared() - self.radius * self.radius;
            for centre in balls {
                let from = p - Vector::z() * *centre;
                cross(u.norm_squared(), u.dot(&from), square(from));
            }
            let [across, from] = [u, p].map(|v| Vector::new(v.x, v.y, 0.0));
            cross(across.norm_squared(), across.dot(&from), square(from));
        }
    }
    fn radius_at(&self, z: f64) -> f64 {
        let beyond = (z.abs() - self.half).max(0.0);
        ((self.radius - beyond) * (self.radius + beyond)).max(0.0).sqrt()
    }
}

/// Sections of two spheres across the line of centres are discs around it, of which the smaller is shared.
fn spheres(p: f64, q: f64, distance: f64) -> f64 {
    let (low, high) = ((distance - q).max(-p), (distance + q).min(p));
    if low >= high {
        return 0.0;
    }
    let area = |z: f64| PI * ((p - z) * (p + z)).min((q - z + distance) * (q + z - distance)).max(0.0);
    let same = (distance + (p - q) * (p + q) / distance) * 0.5;
    let middle = same.clamp(low, high);
    let error = 1e-15 * p.min(q).powi(3);
    integrate([low, middle], error, &area) + integrate([middle, high], error, &area)
}

fn round_and_part(axis: &Axisymmetric, part: &ConvexPart, small: f64) -> f64 {
    let heights = || part.vertices.iter().map(|v| v.z);
    let low = heights().fold(f64::INFINITY, f64::min).max(-axis.top());
    let high = heights().fold(f64::NEG_INFINITY, f64::max).min(axis.top());
    if low >= high {
        return 0.0;
    }
    let mut breaks: Vec<f64> = heights().chain([low, high, axis.half, -axis.half]).collect();
    axis.heights_of_touch(part, &mut breaks);
    breaks.retain(|h| (low..=high).contains(h));
    breaks.sort_by(f64::total_cmp);
    let area = |z: f64| {
        let r = axis.radius_at(z);
        let polygon = part.section(z, r);
        disc_and_polygon(r, &polygon)
    };
    integrate_between(&breaks, 1e-12 * small, &area)
}

fn round_and_round(axis: &Axisymmetric, other: &Geometry, map: &Affine, small: f64) -> f64 {
    let back = map.linear.try_inverse().expect("a regular map");
    // Along x in the frame of the first body.
    let along = back * Vector::x();
    let length = |y: f64, z: f64, half: f64| {
        let origin = back * (Vector::new(0.0, y, z) - map.shift);
        chord(other, origin, along).map_or(0.0, |[s, t]| (t.min(half) - s.max(-half)).max(0.0))
    };
    let [low_y, high_y] = extent(other, map, 1);
    let area = |z: f64| {
        let r = axis.radius_at(z);
        let strip = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            length(r * sin, z, r * cos) * r * cos
        };
        let error = 1e-8 * small / axis.top();
        let [from, to] = [low_y, high_y].map(|y| (y / r).clamp(-1.0, 1.0).asin());
        let middle = 0.5 * (from + to);
        if from < to {
            integrate([from, middle], error, &strip) + integrate([middle, to], error, &strip)
        } else {
            0.0
        }
    };
    let [low, high] = extent(other, map, 2);
    let (low, high) = (low.max(-axis.top()), high.min(axis.top()));
    if low >= high {
        return 0.0;
    }
    let mut breaks = vec![low, -axis.half, axis.half, 0.5 * (low + high), high];
    breaks.retain(|z| (low..=high).contains(z));
    breaks.sort_by(f64::total_cmp);
    breaks.windows(2).map(|w| integrate([w[0], w[1]], 3e-8 * small, &area)).sum()
}

/// Least and greatest coordinate of a convex body after a map.
fn extent(body: &Geometry, map: &Affine, coordinate: usize) -> [f64; 2] {
    let along = map.linear.row(coordinate).transpose();
    let reach = match *body {
        Geometry::Ellipsoid(axes) => axes.component_mul(&along).norm(),
        Geometry::Capsule(radius, half) => radius * along.norm() + half * along.z.abs(),
        Geometry::Cylinder(radius, half) => radius * along.xy().norm() + half * along.z.abs(),
        Geometry::Parts(_) => unreachable!("has flat faces"),
    };
    [map.shift[coordinate] - reach, map.shift[coordinate] + reach]
}

/// Where the line origin + t·along is within a convex body.
fn chord(body: &Geometry, origin: Vector, along: Vector) -> Option<[f64; 2]> {
    let quadratic = |a: f64, b: f64, c: f64| {
        // a t² + 2 b t + c ≤ 0.
        if a == 0.0 {
            return (c <= 0.0).then_some([f64::NEG_INFINITY, f64::INFINITY]);
        }
        let d = b * b - a * c;
        (d > 0.0).then(|| [(-b - d.sqrt()) / a, (-b + d.sqrt()) / a])
    };
    let ball = |centre: Vector, radius: f64| {
        let from = origin - centre;
        quadratic(along.norm_squared(), along.dot(&from), from.norm_squared() - radius * radius)
    };
    let cylinder = |radius: f64, half: f64| {
        let (o, u) = (origin.xy(), along.xy());
        let [s, t] = quadratic(u.norm_squared(), u.dot(&o), o.norm_squared() - radius * radius)?;
        if along.z == 0.0 {
            return (origin.z.abs() <= half).then_some([s, t]);
        }
        let ends = [-half, half].map(|z| (z - origin.z) / along.z);
        let (s, t) = (s.max(ends[0].min(ends[1])), t.min(ends[0].max(ends[1])));
        (s < t).then_some([s, t])
    };
    match *body {
        Geometry::Ellipsoid(axes) => {
            let (o, u) = (origin.component_div(&axes), along.component_div(&axes));
            quadratic(u.norm_squared(), u.dot(&o), o.norm_squared() - 1.0)
        }
        Geometry::Cylinder(radius, half) => cylinder(radius, half),
        Geometry::Capsule(radius, half) => {
            let ends = [-half, half].map(|z| ball(Vector::z() * z, radius));
            let all = ends.into_iter().chain([cylinder(radius, half)]).flatten();
            all.reduce(|p, q| [p[0].min(q[0]), p[1].max(q[1])])
        }
        Geometry::Parts(_) => unreachable!("has flat faces"),
    }
}

impl ConvexPart {
    /// Pairs of vertices that two planes have in common.
    fn edges(&self) -> Vec<[Vector; 2]> {
        let size = self.vertices.iter().map(|v| v.norm()).fold(0.0, f64::max);
        let on = |v: &Vector| -> Vec<usize> {
            let is_on = |(n, d): &(Vector, f64)| (n.dot(v) - d).abs() < 1e-9 * size;
            self.planes.iter().enumerate().filter(|(_, plane)| is_on(plane)).map(|(i, _)| i).collect()
        };
        let planes: Vec<Vec<usize>> = self.vertices.iter().map(on).collect();
        let mut edges = Vec::new();
        for (i, p) in self.vertices.iter().enumerate() {
            for (j, q) in self.vertices.iter().enumerate().take(i) {
                if planes[i].iter().filter(|k| planes[j].contains(k)).count() > 1 {
                    edges.push([*p, *q]);
                }
            }
        }
        edges
    }
    /// The section at height z as a polygon, cut out of a square around the disc of radius r.
    fn section(&self, z: f64, r: f64) -> Vec<[f64; 2]> {
        let mut polygon = vec![[-r, -r], [r, -r], [r, r], [-r, r]];
        for (n, d) in &self.planes {
            cut(&mut polygon, |p| n.x * p[0] + n.y * p[1] + n.z * z - d);
            if polygon.is_empty() {
                break;
            }
        }
        polygon
    }
}

/// Keeps the part of a convex polygon where a linear function is negative.
fn cut(polygon: &mut Vec<[f64; 2]>, above: impl Fn([f64; 2]) -> f64) {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for i in 0..polygon.len() {
        let (p, q) = (polygon[i], polygon[(i + 1) % polygon.len()]);
        let (f, g) = (above(p), above(q));
        if f <= 0.0 {
            kept.push(p);
        }
        if (f <= 0.0) != (g <= 0.0) {
            let t = f / (f - g);
            kept.push([p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]);
        }
    }
    *polygon = kept;
}

/// Area that a polygon shares with the disc of radius r around the origin: triangles and sectors
/// seen from the origin.
fn disc_and_polygon(r: f64, polygon: &[[f64; 2]]) -> f64 {
    let n = polygon.len();
    let side = |i: usize| {
        let (p, q) = (Vector::new(polygon[i][0], polygon[i][1], 0.0), polygon[(i + 1) % n]);
        let q = Vector::new(q[0], q[1], 0.0);
        let u = q - p;
        let (a, b, c) = (u.norm_squared(), u.dot(&p), p.norm_squared() - r * r);
        let sector = |p: Vector, q: Vector| 0.5 * r * r * p.cross(&q).z.atan2(p.dot(&q));
        let d = b * b - a * c;
        if a == 0.0 || d <= 0.0 {
            return sector(p, q);
        }
        let [s, t] = [(-b - d.sqrt()) / a, (-b + d.sqrt()) / a].map(|t| t.clamp(0.0, 1.0));
        if s == t {
            return sector(p, q);
        }
        let [x, y] = [s, t].map(|t| p + u * t);
        sector(p, x) + 0.5 * x.cross(&y).z + sector(y, q)
    };
    (0..n).map(side).sum()
}

/// Volume of the intersection of two convex parts: pyramids from a point over what both leave of
/// each plane.
fn convex_parts(p: &ConvexPart, q: &ConvexPart) -> f64 {
    let corner = |part: &ConvexPart, pick: fn(f64, f64) -> f64| {
        Vector::from_fn(|a, _| part.vertices.iter().map(|v| v[a]).reduce(pick).expect("vertices"))
    };
    let low = corner(p, f64::min).sup(&corner(q, f64::min));
    let high = corner(p, f64::max).inf(&corner(q, f64::max));
    if (0..3).any(|a| low[a] >= high[a]) {
        return 0.0;
    }
    let (middle, size) = (0.5 * (low + high), (high - low).norm());
    let planes: Vec<(Vector, f64)> =
        p.planes.iter().chain(&q.planes).map(|(n, d)| (*n, d - n.dot(&middle))).collect();
    let mut volume = 0.0;
    for (i, (n, d)) in planes.iter().enumerate() {
        if d.abs() > size {
            continue;
        }
        let u = n.cross(&Vector::ith(n.iamin(), 1.0)).normalize();
        let v = n.cross(&u);
        let mut polygon = vec![[-size, -size], [size, -size], [size, size], [-size, size]];
        for (j, (m, e)) in planes.iter().enumerate() {
            if i != j {
                let (mu, mv, rest) = (m.dot(&u), m.dot(&v), m.dot(n) * d - e);
                cut(&mut polygon, |x| mu * x[0] + mv * x[1] + rest);
            }
        }
        let area: f64 = (0..polygon.len())
            .map(|k| {
                let (x, y) = (polygon[k], polygon[(k + 1) % polygon.len()]);
                0.5 * (x[0] * y[1] - x[1] * y[0])
            })
            .sum();
        volume += d * area / 3.0;
    }
    volume
}
