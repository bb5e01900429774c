//! A face of a body against the unit ball around the origin.
use super::edge::{Edge, Integrals, edge_angle, solid_angle};
use interfaces::Vector;
use std::cmp::Ordering;
use std::f64::consts::TAU;

/// Where the centre is as near as this to an edge, the solid angles of the faces there are no longer known to rounding errors, one
/// by one; in radii, squared.
pub(in crate::overlap) const NEAR2: f64 = 1e-4;
/// A triangle whose plane is as far from the centre as this, and whose corners, squared, are nearer than that, may be summed by
/// differences of numbers of order one: its volume then is known to 1e-13 of itself.
const FAR: f64 = 0.1;
const WELL2: f64 = 0.995;

/// What a face contributes, in units of the ball's radius.
#[derive(Clone, Copy, Debug)]
pub(in crate::overlap) struct Part {
    /// The volume between the face and the sphere along rays from the centre; negative where the face looks at the centre.
    pub(in crate::overlap) beyond: f64,
    /// Sum of the amounts of which it is made.
    pub(in crate::overlap) amount: f64,
    /// Outward unit normal of the face.
    pub(in crate::overlap) normal: Vector,
    /// Area of the face within the ball.
    pub(in crate::overlap) area: f64,
    /// ∫ (1 − ρ²)/2 dA over it.
    pub(in crate::overlap) second: f64,
    /// ∫ x dA over it.
    pub(in crate::overlap) moment: Vector,
    /// Squared distance of its nearest edge within the ball from the centre.
    pub(in crate::overlap) nearest2: f64,
}

/// A convex face that the ball may reach.
#[derive(Clone, Copy, Debug)]
pub(in crate::overlap) struct Face<'a> {
    corners: &'a [Vector],
    normal: Vector,
    /// Distance of its plane from the centre, along the normal.
    height: f64,
    /// Area of a triangle.
    area: f64,
}

/// A face in the coordinates of its plane.
struct Plane<'a> {
    along: Vector,
    across: Vector,
    /// The corners, from the foot of the centre.
    places: &'a [[f64; 2]],
}

/// An edge within reach: its ends, their places on its line, its distance from the foot of the centre, its length
/// and its direction in the plane.
pub(in crate::overlap) struct Side {
    pub(in crate::overlap) ends: [Vector; 2],
    pub(in crate::overlap) from: f64,
    pub(in crate::overlap) to: f64,
    pub(in crate::overlap) distance: f64,
    pub(in crate::overlap) length: f64,
    pub(in crate::overlap) direction: [f64; 2],
}

impl Side {
    /// What the ball cuts out of it, on a plane at `height`. `disc2` is the squared radius of the disc there, if the face has its centre
    /// and so takes sectors from the whole disc; else it is what the edge makes of it.
    ///
    /// A shallow contact hangs on the small differences between the radius and the distances of corners and edges. These are
    /// the same for all faces around: |x|² of a corner, and the chord's distance taken from one end, however the edge is run along.
    pub(in crate::overlap) fn within(&self, height: f64, disc2: Option<f64>) -> Option<Edge> {
        let [p, q] = self.ends;
        let along = (q - p) * self.length.recip();
        let (s, t) = (p.dot(&along), q.dot(&along));
        let half2 = |end: &Vector| 1.0 - end.cross(&along).norm_squared();
        let half2 = match s.abs().total_cmp(&t.abs()) {
            Ordering::Less => half2(&p),
            Ordering::Greater => half2(&q),
            Ordering::Equal => half2(&p).max(half2(&q)),
        };
        if half2 <= 0.0 {
            return None;
        }
        let (half, rest_p, rest_q) = (half2.sqrt(), 1.0 - p.norm_squared(), 1.0 - q.norm_squared());
        // The way from an end to where the line leaves the ball beyond it, and to where it leaves it behind.
        let ways = |s: f64, rest: f64| {
            let far = half + s.abs();
            if s > 0.0 { (rest / far, far) } else { (far, rest / far) }
        };
        let (from, to, length, before, after) = match (rest_p > 0.0, rest_q > 0.0) {
            // Both ends may be on the same side of the chord.
            (false, false) if s < 0.0 && t > 0.0 => (-half, half, 2.0 * half, 0.0, 0.0),
            (false, false) => return None,
            (true, true) => (self.from, self.to, self.length, ways(s, rest_p).1, ways(t, rest_q).0),
            (true, false) => {
                let (after, before) = ways(s, rest_p);
                (self.from, half, after, before, 0.0)
            }
            (false, true) => {
                let (after, before) = ways(t, rest_q);
                (-half, self.to, before, 0.0, after)
            }
        };
        let disc2 = disc2.unwrap_or(self.distance * self.distance + from * from + before * (length + after));
        let edge = Edge { height, disc2, distance: self.distance, from, to, length, before, after };
        (length > 0.0 && from < to).then_some(edge)
    }
}

impl<'a> Face<'a> {
    /// The face with these `corners`, counter-clockwise seen from outside; `None` when it has no area, or when the ball is seen not to
    /// reach it: its plane, or the inner side of one of its edges.
    pub(in crate::overlap) fn new(corners: &'a [Vector]) -> Option<Self> {
        let n = corners.len();
        let first = corners[0];
        let mut normal = Vector::zeros();
        for pair in corners[1..].windows(2) {
            normal += (pair[0] - first).cross(&(pair[1] - first));
        }
        let (size2, height) = (normal.norm_squared(), normal.dot(&first));
        let disc2 = size2 - height * height;
        if disc2 <= 0.0 {
            return None;
        }
        let outside = |i: usize| {
            let (p, q) = (&corners[i], &corners[if i + 1 < n { i + 1 } else { 0 }]);
            let edge = q - p;
            let side = normal.dot(&p.cross(&edge));
            side < 0.0 && side * side >= disc2 * edge.norm_squared()
        };
        if corners.iter().all(|c| c.norm_squared() >= 1.0) && (0..n).any(outside) {
            return None;
        }
        let size = size2.sqrt();
        let scale = size.recip();
        let height = (height * scale).clamp(-1.0, 1.0);
        Some(Self { corners, normal: normal * scale, height, area: 0.5 * size })
    }

    /// The face in its plane. `places` is memory for as many corners.
    fn plane<'b>(&self, places: &'b mut [[f64; 2]]) -> Plane<'b> {
        let n = &self.normal;
        let along =
            if n.x.abs() < n.y.abs() { Vector::new(0.0, -n.z, n.y) } else { Vector::new(n.z, 0.0, -n.x) };
        let along = along * along.norm_squared().sqrt().recip();
        let across = n.cross(&along);
        for (place, c) in places.iter_mut().zip(self.corners) {
            *place = [along.dot(c), across.dot(c)];
        }
        Plane { along, across, places }
    }

    /// A triangle well inside the ball and far from the centre, by formulas that take differences of large numbers.
    fn inside(&self, cut: &mut impl FnMut(usize, f64)) -> Option<Part> {
        let &[p, q, r] = self.corners else { return None };
        let (p2, q2, r2) = (p.norm_squared(), q.norm_squared(), r.norm_squared());
        if self.height.abs() < FAR || p2.max(q2).max(r2) > WELL2 {
            return None;
        }
        (0..3).for_each(|i| cut(i, 1.0));
        let (sum, area) = (p + q + r, self.area);
        let second = 0.5 * area * (1.0 - (p2 + q2 + r2 + sum.norm_squared()) / 12.0);
        let beyond = (solid_angle([p, q, r]) - self.height * area) / 3.0;
        let moment = sum * (area / 3.0);
        Some(Part {
            beyond,
            amount: beyond.abs(),
            normal: self.normal,
            area,
            second,
            moment,
            nearest2: f64::INFINITY,
        })
    }
}

impl Plane<'_> {
    /// The ends of edge `i`, with their numbers.
    fn ends(&self, i: usize) -> ([usize; 2], [[f64; 2]; 2]) {
        let j = if i + 1 < self.places.len() { i + 1 } else { 0 };
        ([i, j], [self.places[i], self.places[j]])
    }

    /// The angle under which the foot of the centre sees the face from within: a whole turn, less at a corner, zero outside.
    fn turn(&self) -> f64 {
        let n = self.places.len();
        if let Some(i) = self.places.iter().position(|c| *c == [0.0; 2]) {
            let (q, r) = (self.places[(i + 1) % n], self.places[(i + n - 1) % n]);
            return cross(q, r).atan2(q[0] * r[0] + q[1] * r[1]).max(0.0);
        }
        let within = (0..n).all(|i| {
            let (_, [p, q]) = self.ends(i);
            cross(p, q) >= 0.0
        });
        if within { TAU } else { 0.0 }
    }
}

/// p × q, with no negative zero.
fn cross(p: [f64; 2], q: [f64; 2]) -> f64 {
    p[0] * q[1] - p[1] * q[0] + 0.0
}

impl Face<'_> {
    /// What lies within the ball, if anything; `cut` is called with the number of every edge that does and how much of it. `places` is memory for as many
    /// corners.
    #[inline]
    pub(in crate::overlap) fn part(
        &self,
        places: &mut [[f64; 2]],
        mut cut: impl FnMut(usize, f64),
    ) -> Option<Part> {
        if let Some(part) = self.inside(&mut cut) {
            return Some(part);
        }
        let plane = self.plane(places);
        let height = self.height.abs();
        let radius2 = (1.0 - height) * (1.0 + height);
        let mut sum = Integrals::default();
        let (mut nearest2, mut amount, mut reached) = (f64::INFINITY, 0.0, false);
        let turn = plane.turn();
        let disc2 = (turn > 0.0).then_some(radius2);
        let mut shift = [0.0; 2];
        for i in 0..self.corners.len() {
            let ([from, to], [p, q]) = plane.ends(i);
            let step = [q[0] - p[0], q[1] - p[1]];
            let length2 = step[0] * step[0] + step[1] * step[1];
            // Distance times length.
            let area = cross(p, q);
            if area * area >= radius2 * length2 {
                continue;
            }
            let ends = [self.corners[from], self.corners[to]];
            // In the plane it is the same but for what far corners lose there.
            let length = (ends[1] - ends[0]).norm();
            let scale = length.recip();
            let direction = [step[0] * scale, step[1] * scale];
            let along = |c: [f64; 2]| c[0] * direction[0] + c[1] * direction[1];
            let side = Side { ends, from: along(p), to: along(q), distance: area * scale, length, direction };
            let Some(edge) = side.within(height, disc2) else { continue };
            reached = true;
            cut(i, edge.length);
            nearest2 = edge.centre2().min(nearest2);
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
        if !reached && turn == 0.0 {
            return None;
        }
        let disc = Integrals::sector(height, radius2, turn);
        let Integrals { area, second, beyond } = disc.minus(sum);
        let moment = self.normal * (self.height * area) + plane.along * shift[0] + plane.across * shift[1];
        let sign = if self.height < 0.0 { -1.0 } else { 1.0 };
        Some(Part {
            beyond: sign * beyond,
            amount: amount + disc.beyond,
            normal: self.normal,
            area,
            second,
            moment,
            nearest2,
        })
    }

    /// Solid angle of the face seen from the centre, from the very numbers that [`part`](Self::part) uses.
    fn solid_angle(&self, places: &mut [[f64; 2]]) -> f64 {
        let plane = self.plane(places);
        let height = self.height.abs();
        let mut sum = 0.0;
        for i in 0..self.corners.len() {
            let (_, [p, q]) = plane.ends(i);
            let step = [q[0] - p[0], q[1] - p[1]];
            let length = (step[0] * step[0] + step[1] * step[1]).sqrt();
            if length > 0.0 {
                let along = |c: [f64; 2]| (c[0] * step[0] + c[1] * step[1]) / length;
                sum += edge_angle(height, cross(p, q) / length, along(p), along(q));
            }
        }
        let angle = plane.turn() - sum;
        if self.height < 0.0 { -angle } else { angle }
    }
}

/// Solid angle of any convex face seen from the centre, where the ball reaches it from the very numbers that
/// [`part`](Face::part) uses; `places` is memory.
pub(in crate::overlap) fn seen_angle(corners: &[Vector], places: &mut Vec<[f64; 2]>) -> f64 {
    places.resize(corners.len(), [0.0; 2]);
    match Face::new(corners) {
        Some(face) => face.solid_angle(places),
        None => polygon_angle(corners),
    }
}

/// Solid angle of a convex face seen from the origin.
pub(in crate::overlap) fn polygon_angle(corners: &[Vector]) -> f64 {
    corners[1..].windows(2).map(|pair| solid_angle([corners[0], pair[0], pair[1]])).sum()
}
