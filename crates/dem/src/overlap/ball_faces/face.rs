//! A face of a body against the unit ball around the origin.
use super::edge::{Edge, Integrals, solid_angle};
use interfaces::Vector;
use std::f64::consts::TAU;

/// Where the centre is as near as this to an edge, the solid angles of the faces there are no longer known to rounding errors, one
/// by one; in radii, squared.
const NEAR2: f64 = 1e-4;
/// A corner as near as this to the foot of the centre is there; in radii, squared.
const THERE2: f64 = 1e-60;

/// What a face contributes, in units of the ball's radius.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// The volume between the face and the sphere along rays from the centre; negative where the face looks at the centre.
    pub(super) beyond: f64,
    /// Sum of the amounts of which it is made.
    pub(super) amount: f64,
    /// Outward unit normal of the face.
    pub(super) normal: Vector,
    /// Area of the face within the ball.
    pub(super) area: f64,
    /// ∫ (1 − ρ²)/2 dA over it.
    pub(super) second: f64,
    /// ∫ x dA over it.
    pub(super) moment: Vector,
    /// An edge of it passes the centre very closely.
    pub(super) near_edge: bool,
}

/// A convex face whose plane the ball reaches.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face<'a> {
    normal: Vector,
    along: Vector,
    across: Vector,
    height: f64,
    /// Its corners in the plane, from the foot of the centre.
    corners: &'a [[f64; 2]],
}

/// An edge's line in the plane: distance, unit vector, and where on it its ends are.
struct Line {
    distance: f64,
    direction: [f64; 2],
    from: f64,
    to: f64,
}

impl<'a> Face<'a> {
    /// `None` when the ball does not reach the plane of the `corners` (counter-clockwise seen from outside), or when they have none.
    pub(super) fn new(corners: &[Vector], plane: &'a mut Vec<[f64; 2]>) -> Option<Self> {
        let first = corners[0];
        let mut normal = Vector::zeros();
        for pair in corners[1..].windows(2) {
            normal += (pair[0] - first).cross(&(pair[1] - first));
        }
        let (size2, height) = (normal.norm_squared(), normal.dot(&first));
        if height * height >= size2 {
            return None;
        }
        let scale = size2.sqrt().recip();
        normal *= scale;
        let edge = corners[1..].iter().map(|c| c - first).find(|e| *e != Vector::zeros())?;
        let along = (edge - normal * normal.dot(&edge)).try_normalize(0.0)?;
        let across = normal.cross(&along);
        plane.clear();
        plane.extend(corners.iter().map(|c| {
            let p = [along.dot(c), across.dot(c)];
            if p[0] * p[0] + p[1] * p[1] < THERE2 { [0.0; 2] } else { p }
        }));
        Some(Self { normal, along, across, height: (height * scale).clamp(-1.0, 1.0), corners: plane })
    }

    /// Edge by edge with its number; edges without length are left out.
    fn lines(&self) -> impl Iterator<Item = (usize, Line)> {
        let n = self.corners.len();
        (0..n).filter_map(move |i| {
            let (p, q) = (self.corners[i], self.corners[if i + 1 < n { i + 1 } else { 0 }]);
            let step = [q[0] - p[0], q[1] - p[1]];
            let length = (step[0] * step[0] + step[1] * step[1]).sqrt();
            if length == 0.0 {
                return None;
            }
            let scale = length.recip();
            let direction = [step[0] * scale, step[1] * scale];
            let along = |c: [f64; 2]| c[0] * direction[0] + c[1] * direction[1];
            // Adding zero makes a positive zero of a negative one.
            let distance = (p[0] * q[1] - p[1] * q[0]) * scale + 0.0;
            Some((i, Line { distance, direction, from: along(p), to: along(q) }))
        })
    }

    /// The angle under which the foot of the centre sees the face from within, a whole turn unless it is at a corner. `within` tells
    /// whether it is on the inner side of all edges.
    fn turn(&self, within: bool) -> f64 {
        let n = self.corners.len();
        match self.corners.iter().position(|c| *c == [0.0; 2]) {
            Some(i) => {
                let (q, r) = (self.corners[(i + 1) % n], self.corners[(i + n - 1) % n]);
                (q[0] * r[1] - q[1] * r[0]).atan2(q[0] * r[0] + q[1] * r[1]).max(0.0)
            }
            None if within => TAU,
            None => 0.0,
        }
    }

    /// What lies within the ball, if anything; `cut` is called with the number of every edge that does.
    pub(super) fn part(&self, mut cut: impl FnMut(usize)) -> Option<Part> {
        let height = self.height.abs();
        let radius = ((1.0 - height) * (1.0 + height)).sqrt();
        let mut sum = Integrals::default();
        let (mut within, mut near_edge, mut amount, mut reached) = (true, false, 0.0, false);
        let mut shift = [0.0; 2];
        for (i, line) in self.lines() {
            within &= line.distance >= 0.0;
            let d = line.distance.abs();
            if d >= radius {
                continue;
            }
            let half = ((radius - d) * (radius + d)).sqrt();
            let (from, to) = (line.from.max(-half), line.to.min(half));
            if from >= to {
                continue;
            }
            reached = true;
            cut(i);
            let edge = Edge { height, distance: line.distance, from, to, half };
            near_edge |= edge.centre2() < NEAR2;
            let beyond = edge.beyond();
            sum.area += beyond.area;
            sum.second += beyond.second;
            sum.beyond += beyond.beyond;
            amount += beyond.beyond.abs();
            // ∫ x dA in the plane = −Σ outward normals of the edges times ∫ (half² − t²)/2 dt.
            let (length, middle) = (to - from, 0.5 * (from + to));
            let push = 0.5 * length * ((half - middle) * (half + middle) - length * length / 12.0);
            shift[0] -= push * line.direction[1];
            shift[1] += push * line.direction[0];
        }
        let turn = self.turn(within);
        if !reached && turn == 0.0 {
            return None;
        }
        let disc = Integrals::sector(height, turn);
        let Integrals { area, second, beyond } = disc.minus(sum);
        let moment = self.normal * (self.height * area) + self.along * shift[0] + self.across * shift[1];
        let sign = if self.height < 0.0 { -1.0 } else { 1.0 };
        Some(Part {
            beyond: sign * beyond,
            amount: amount + disc.beyond,
            normal: self.normal,
            area,
            second,
            moment,
            near_edge,
        })
    }

    /// Solid angle of the face seen from the centre, from the very numbers that [`part`](Self::part) uses.
    pub(super) fn solid_angle(&self) -> f64 {
        let height = self.height.abs();
        let (mut within, mut sum) = (true, 0.0);
        for (_, Line { distance, from, to, .. }) in self.lines() {
            within &= distance >= 0.0;
            sum += Edge { height, distance, from, to, half: 1.0 }.solid_angle(from, to);
        }
        let angle = self.turn(within) - sum;
        if self.height < 0.0 { -angle } else { angle }
    }
}

/// Solid angle of a convex face seen from the origin.
pub(super) fn polygon_angle(corners: &[Vector]) -> f64 {
    corners[1..].windows(2).map(|pair| solid_angle([corners[0], pair[0], pair[1]])).sum()
}
