//! A face of a body against the unit ball around the origin.
use super::edge::{Edge, Integrals, edge_angle, solid_angle};
use interfaces::Vector;
use std::cmp::Ordering;
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
    corners: &'a [Vector],
    /// The corners in the plane, from the foot of the centre.
    plane: &'a [[f64; 2]],
}

/// An edge: its ends, their places in the plane, its distance there from the foot of the centre, its length and direction, and where
/// on its line the ends are.
struct Side {
    ends: [Vector; 2],
    distance: f64,
    length: f64,
    direction: [f64; 2],
    from: f64,
    to: f64,
}

impl Side {
    /// What the ball cuts out of it, on a plane at `height`.
    ///
    /// A shallow contact hangs on the small differences between the radius and the distances of corners and edges. These are
    /// the same for all faces around: |x|² of a corner, and the chord's distance taken from one end, however the edge is run along.
    fn within(&self, height: f64) -> Option<Edge> {
        let [p, q] = self.ends;
        let along = (q - p) / self.length;
        let (s, t) = (p.dot(&along), q.dot(&along));
        let (rest_p, rest_q) = (1.0 - p.norm_squared(), 1.0 - q.norm_squared());
        let half2 = |end: &Vector| 1.0 - end.cross(&along).norm_squared();
        let half2 = match s.abs().total_cmp(&t.abs()) {
            Ordering::Less => half2(&p),
            Ordering::Greater => half2(&q),
            Ordering::Equal => half2(&p).max(half2(&q)),
        };
        if half2 <= 0.0 {
            return None;
        }
        let half = half2.sqrt();
        // The way from an end to where the line leaves the ball beyond it, and to where it leaves it behind.
        let ways = |s: f64, rest: f64| {
            let far = half + s.abs();
            if s > 0.0 { (rest / far, far) } else { (far, rest / far) }
        };
        let (after_p, before) = ways(s, rest_p);
        let (after, before_q) = ways(t, rest_q);
        let edge = |from, to, length, before, after| Edge {
            height,
            distance: self.distance,
            from,
            to,
            length,
            before,
            after,
        };
        let edge = match (rest_p > 0.0, rest_q > 0.0) {
            (true, true) => edge(self.from, self.to, self.length, before, after),
            (true, false) => edge(self.from, half, after_p, before, 0.0),
            (false, true) => edge(-half, self.to, before_q, 0.0, after),
            // Both ends may be on the same side of the chord.
            (false, false) if s < 0.0 && t > 0.0 => edge(-half, half, 2.0 * half, 0.0, 0.0),
            (false, false) => return None,
        };
        (edge.length > 0.0 && edge.from < edge.to).then_some(edge)
    }
}

impl<'a> Face<'a> {
    /// `None` when the ball does not reach the plane of the `corners` (counter-clockwise seen from outside), or when they have none.
    pub(super) fn new(corners: &'a [Vector], plane: &'a mut Vec<[f64; 2]>) -> Option<Self> {
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
        Some(Self { normal, along, across, height: (height * scale).clamp(-1.0, 1.0), corners, plane })
    }

    /// Edge by edge with its number; edges without length are left out.
    fn sides(&self) -> impl Iterator<Item = (usize, Side)> {
        let n = self.corners.len();
        (0..n).filter_map(move |i| {
            let j = if i + 1 < n { i + 1 } else { 0 };
            let ends = [self.corners[i], self.corners[j]];
            let length = (ends[1] - ends[0]).norm();
            if length == 0.0 {
                return None;
            }
            let (p, q, scale) = (self.plane[i], self.plane[j], length.recip());
            let direction = [(q[0] - p[0]) * scale, (q[1] - p[1]) * scale];
            let along = |c: [f64; 2]| c[0] * direction[0] + c[1] * direction[1];
            // Adding zero makes a positive zero of a negative one.
            let distance = (p[0] * q[1] - p[1] * q[0]) * scale + 0.0;
            Some((i, Side { ends, distance, length, direction, from: along(p), to: along(q) }))
        })
    }

    /// The angle under which the foot of the centre sees the face from within, a whole turn unless it is at a corner. `within` tells
    /// whether it is on the inner side of all edges.
    fn turn(&self, within: bool) -> f64 {
        let n = self.plane.len();
        match self.plane.iter().position(|c| *c == [0.0; 2]) {
            Some(i) => {
                let (q, r) = (self.plane[(i + 1) % n], self.plane[(i + n - 1) % n]);
                (q[0] * r[1] - q[1] * r[0]).atan2(q[0] * r[0] + q[1] * r[1]).max(0.0)
            }
            None if within => TAU,
            None => 0.0,
        }
    }

    /// What lies within the ball, if anything; `cut` is called with the number of every edge that does.
    pub(super) fn part(&self, mut cut: impl FnMut(usize)) -> Option<Part> {
        let height = self.height.abs();
        let mut sum = Integrals::default();
        let (mut within, mut near_edge, mut amount, mut reached) = (true, false, 0.0, false);
        let mut shift = [0.0; 2];
        for (i, side) in self.sides() {
            within &= side.distance >= 0.0;
            let Some(edge) = side.within(height) else { continue };
            reached = true;
            cut(i);
            near_edge |= edge.centre2() < NEAR2;
            let beyond = edge.beyond();
            sum.area += beyond.area;
            sum.second += beyond.second;
            sum.beyond += beyond.beyond;
            amount += beyond.beyond.abs();
            // ∫ x dA in the plane = −Σ outward normals of the edges times ∫ p/2 dt.
            let push = edge.push();
            shift[0] -= push * side.direction[1];
            shift[1] += push * side.direction[0];
        }
        let turn = self.turn(within);
        if !reached && turn == 0.0 {
            return None;
        }
        let disc = Integrals::sector(height, (1.0 - height) * (1.0 + height), turn);
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
        for (_, Side { distance, from, to, .. }) in self.sides() {
            within &= distance >= 0.0;
            sum += edge_angle(height, distance, from, to);
        }
        let angle = self.turn(within) - sum;
        if self.height < 0.0 { -angle } else { angle }
    }
}

/// Solid angle of a convex face seen from the origin.
pub(super) fn polygon_angle(corners: &[Vector]) -> f64 {
    corners[1..].windows(2).map(|pair| solid_angle([corners[0], pair[0], pair[1]])).sum()
}
