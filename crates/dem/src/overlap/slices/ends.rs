//! Round ends: closed forms where they meet nothing but round or flat ends, balls where they meet other parts of one body only.
use crate::Overlap;
use crate::overlap::closed;
use crate::overlap::tube::{Ends, Tube};
use interfaces::{Point, Vector};

/// The ball at an end of a tube.
struct Ball {
    centre: Point,
    radius: f64,
    /// Out of the tube, beyond whose middle the ball's other half is no more the tube's surface; `None` of spheres.
    out: Option<Vector>,
}

/// What both share where that is a lens between balls at their ends, or the cap of one beyond the flat end of the other;
/// `None` where it is not, or not for sure.
///
/// Both bodies are convex, so what they share hangs together: a lens between two of their balls that stays clear of the planes
/// where the tubes' straight parts begin is all of it.
pub(super) fn overlap(a: &Tube, b: &Tube) -> Option<Overlap> {
    match [a.ends, b.ends] {
        [Ends::Round, Ends::Round] => {
            let near = |a: &Tube, b: &Tube| a.end_towards(a.axis.dot(&(b.at.position - a.at.position)));
            // The nearer end of the one to the nearer end of the other, from both sides.
            let first = near(a, b);
            let other = b.end_towards(b.axis.dot(&(first.centre - b.at.position)));
            lens(&first, &other).or_else(|| {
                let second = near(b, a);
                let first = a.end_towards(a.axis.dot(&(second.centre - a.at.position)));
                lens(&first, &second)
            })
        }
        [Ends::Round, Ends::Flat] => face(a, b),
        [Ends::Flat, Ends::Round] => face(b, a).map(|o| o.swapped()),
        [Ends::Flat, Ends::Flat] => None,
    }
}

/// Whether the axes of two capsules are no nearer than both radii (Ericson, Real-Time Collision Detection, 5.1.9).
pub(super) fn apart(a: &Tube, b: &Tube) -> bool {
    let between = b.at.position - a.at.position;
    let (cos, sin) = (a.axis.dot(&b.axis), a.axis.cross(&b.axis).norm_squared());
    let (along_a, along_b) = (a.axis.dot(&between), b.axis.dot(&between));
    // Any place will do of lines that are parallel.
    let s = if sin > 1e-12 { (along_a - cos * along_b) / sin } else { 0.0 };
    let t = (s.clamp(-a.half, a.half) * cos - along_b).clamp(-b.half, b.half);
    let s = (along_a + t * cos).clamp(-a.half, a.half);
    let reach = a.radius + b.radius;
    (between + b.axis * t - a.axis * s).norm_squared() >= reach * reach
}

/// What both share where that is between a round end of the one and any part of the other, which is a ball and a tube; `None` where it is
/// not, or not for sure.
///
/// What is behind the plane that touches the other body in the place nearest to the ball is a cap of the ball, and if this stays clear of
/// the plane where the straight part begins, the common region cannot leave the ball: it is convex.
pub(super) fn end(a: &Tube, b: &Tube, normal: Vector, tolerance: f64) -> Option<Overlap> {
    let of = |tube: &Tube, other: &Tube| {
        if tube.ends == Ends::Flat || tube.half == 0.0 {
            return None;
        }
        let ball = tube.end_towards(tube.axis.dot(&(other.at.position - tube.at.position)));
        let out = ball.out?;
        let (towards, distance) = other.plane_before(ball.centre);
        let along = towards.dot(&out);
        let rim = ((ball.radius - distance) * (ball.radius + distance)).max(0.0).sqrt();
        let clear = distance.abs() < ball.radius
            && -along * ball.radius < distance
            && distance * along - rim * towards.cross(&out).norm() > 0.0;
        if clear { Some(ball) } else { None }
    };
    if let Some(ball) = of(a, b) {
        return super::ball::overlap(ball.centre, ball.radius, b, normal, tolerance);
    }
    let ball = of(b, a)?;
    super::ball::overlap(ball.centre, ball.radius, a, -normal, tolerance).map(|o| o.swapped())
}

fn lens(a: &Ball, b: &Ball) -> Option<Overlap> {
    let apart = b.centre - a.centre;
    let d = apart.norm();
    if d >= a.radius + b.radius || d <= (a.radius - b.radius).abs() {
        return None;
    }
    let e = apart / d;
    // Of the plane of the common circle from the first centre.
    let along = 0.5 * (d + (a.radius - b.radius) * ((a.radius + b.radius) / d));
    let rim = ((a.radius - along) * (a.radius + along)).max(0.0).sqrt();
    let clear = |ball: &Ball| {
        ball.out.is_none_or(|n| {
            // The lens's lowest place along n: of a ball's surface, if it is within the other, or of the common circle.
            let low = |p: &Ball, q: &Ball| {
                let x = p.centre - n * p.radius;
                ((x - q.centre).norm_squared() <= q.radius * q.radius).then_some(x)
            };
            let lowest = match low(a, b).or_else(|| low(b, a)) {
                Some(x) => n.dot(&(x - ball.centre)),
                None => n.dot(&(a.centre - ball.centre)) + along * n.dot(&e) - rim * n.cross(&e).norm(),
            };
            lowest > 0.0
        })
    };
    if clear(a) && clear(b) { closed::spheres(a.radius, a.centre, b.radius, b.centre) } else { None }
}

/// The cap of a ball at an end of `a` beyond a flat end of `b`, if it meets nothing else.
fn face(a: &Tube, b: &Tube) -> Option<Overlap> {
    let apart = a.at.position - b.at.position;
    let n = if b.axis.dot(&apart) < 0.0 { -b.axis } else { b.axis };
    let ball = a.end_towards(-a.axis.dot(&n));
    let from = ball.centre - b.at.position;
    let distance = n.dot(&from) - b.half;
    let beside = (from - n * n.dot(&from)).norm();
    let widest = if distance > 0.0 {
        ((ball.radius - distance) * (ball.radius + distance)).max(0.0).sqrt()
    } else {
        ball.radius
    };
    if beside + widest > b.radius || ball.radius - distance > 2.0 * b.half {
        return None;
    }
    ball.cap(n, distance)
}

impl Tube {
    /// The direction from a place x into the tube and the distance along it at which a plane across it touches the tube, in the
    /// place nearest to x if x is outside.
    fn plane_before(&self, x: Point) -> (Vector, f64) {
        let from = x - self.at.position;
        let along = self.axis.dot(&from);
        let beyond = along - along.clamp(-self.half, self.half);
        let across = from - self.axis * along;
        let distance = across.norm();
        if self.ends == Ends::Round {
            let way = across + self.axis * beyond;
            let to_line = way.norm();
            return (way / -to_line, to_line - self.radius);
        }
        let (side, end) = (distance - self.radius, along.abs() - self.half);
        let (out, up) = (across / distance, self.axis * 1f64.copysign(along));
        if side > 0.0 && end > 0.0 {
            let way = side.hypot(end);
            ((out * side + up * end) / -way, way)
        } else if side > end {
            (-out, side)
        } else {
            (-up, end)
        }
    }
    /// The ball at the end along the axis if `along` is positive, else at the other one.
    fn end_towards(&self, along: f64) -> Ball {
        let out = if along < 0.0 { -self.axis } else { self.axis };
        let (centre, radius) = (self.at.position + out * self.half, self.radius);
        Ball { centre, radius, out: (self.half > 0.0).then_some(out) }
    }
}

impl Ball {
    /// What lies beyond a plane at a signed `distance`, out of which leads `n`, if it is clear of the tube's straight part.
    fn cap(&self, n: Vector, distance: f64) -> Option<Overlap> {
        if distance >= self.radius || distance <= -self.radius {
            return None;
        }
        let rim = ((self.radius - distance) * (self.radius + distance)).max(0.0).sqrt();
        let clear = self.out.is_none_or(|out| {
            let along = n.dot(&out);
            // The ball's lowest place is not beyond the plane, and the lowest of the circle is above the middle.
            distance - self.radius * along > 0.0 && -distance * along - rim * n.cross(&out).norm() > 0.0
        });
        if clear { closed::sphere_wall(self.radius, self.centre, distance, n) } else { None }
    }
}
