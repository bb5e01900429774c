//! One triangle.
use interfaces::Vector;

/// Which part of a triangle a point lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    Inside,
    /// The edge from corner i to corner i + 1.
    Edge(usize),
    Corner(usize),
}

/// A triangle as the distance needs it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    a: Vector,
    ab: Vector,
    ac: Vector,
    /// So narrow that products of squares of its edges would leave few digits of its height.
    narrow: bool,
}

/// Height over longest edge, squared, of narrow triangles.
const NARROW: f64 = 1e-4;

impl Triangle {
    pub(crate) fn new(a: Vector, b: Vector, c: Vector) -> Self {
        let (ab, ac) = (b - a, c - a);
        let longest = ab.norm_squared().max(ac.norm_squared()).max((c - b).norm_squared());
        Self { a, ab, ac, narrow: ab.cross(&ac).norm_squared() < NARROW * longest * longest }
    }
    pub(crate) fn corners(&self) -> [Vector; 3] {
        [self.a, self.a + self.ab, self.a + self.ac]
    }
    /// (b − a) × (c − a).
    pub(crate) fn cross(&self) -> Vector {
        self.ab.cross(&self.ac)
    }
    #[cfg(feature = "mesh")]
    /// Angle at corner `i`.
    pub(crate) fn angle(&self, i: usize) -> f64 {
        let bc = self.ac - self.ab;
        match i {
            0 => self.ab.angle(&self.ac),
            1 => bc.angle(&-self.ab),
            _ => bc.angle(&self.ac),
        }
    }
    #[cfg(feature = "mesh")]
    /// How far ahead of `x`, along a unit vector, it is hit, if at all; at its edges in any case.
    pub(crate) fn ahead(&self, x: Vector, along: Vector) -> Option<f64> {
        let (cross, from) = (self.cross(), x - self.a);
        let slope = cross.dot(&along);
        let distance = -cross.dot(&from) / slope;
        let hit = from + along * distance;
        // Its coordinates along both edges.
        let (s, t) = (hit.cross(&self.ac).dot(&cross), self.ab.cross(&hit).dot(&cross));
        let whole = cross.norm_squared();
        let slack = 1e-9 * whole;
        let within = s >= -slack && t >= -slack && s + t <= whole + slack;
        (within && distance > 0.0 && distance.is_finite()).then_some(distance)
    }
    /// Its point nearest to `x`, as the difference x − point, and where that point lies
    /// (Ericson, Real-Time Collision Detection, 2005, section 5.1.5).
    #[inline]
    pub(crate) fn nearest(&self, x: Vector) -> (Vector, Part) {
        if self.narrow {
            return self.nearest_of_narrow(x);
        }
        let ap = x - self.a;
        let (d1, d2) = (self.ab.dot(&ap), self.ac.dot(&ap));
        if d1 <= 0.0 && d2 <= 0.0 {
            return (ap, Part::Corner(0));
        }
        let bp = ap - self.ab;
        let (d3, d4) = (self.ab.dot(&bp), self.ac.dot(&bp));
        if d3 >= 0.0 && d4 <= d3 {
            return (bp, Part::Corner(1));
        }
        let vc = d1 * d4 - d3 * d2;
        if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
            return (ap - self.ab * (d1 / (d1 - d3)), Part::Edge(0));
        }
        let cp = ap - self.ac;
        let (d5, d6) = (self.ab.dot(&cp), self.ac.dot(&cp));
        if d6 >= 0.0 && d5 <= d6 {
            return (cp, Part::Corner(2));
        }
        let vb = d5 * d2 - d1 * d6;
        if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
            return (ap - self.ac * (d2 / (d2 - d6)), Part::Edge(2));
        }
        let va = d3 * d6 - d5 * d4;
        if va <= 0.0 && d4 >= d3 && d5 >= d6 {
            let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
            return (bp - (self.ac - self.ab) * t, Part::Edge(1));
        }
        let scale = 1.0 / (va + vb + vc);
        (ap - self.ab * (vb * scale) - self.ac * (vc * scale), Part::Inside)
    }

    /// The same by the distances from the edges' planes and lines, which takes longer.
    #[cold]
    fn nearest_of_narrow(&self, x: Vector) -> (Vector, Part) {
        let corners = self.corners();
        let cross = self.cross();
        let from = corners.map(|c| x - c);
        let edges = [self.ab, self.ac - self.ab, -self.ac];
        if (0..3).all(|i| cross.dot(&edges[i].cross(&from[i])) > 0.0) {
            return (cross * (cross.dot(&from[0]) / cross.norm_squared()), Part::Inside);
        }
        let nearest = |i: usize| {
            let t = edges[i].dot(&from[i]) / edges[i].norm_squared();
            if t <= 0.0 {
                (from[i], Part::Corner(i))
            } else if t >= 1.0 {
                (from[(i + 1) % 3], Part::Corner((i + 1) % 3))
            } else {
                (from[i] - edges[i] * t, Part::Edge(i))
            }
        };
        let [first, second, third] = [0, 1, 2].map(nearest);
        let nearer = |p: (Vector, Part), q: (Vector, Part)| {
            if q.0.norm_squared() < p.0.norm_squared() { q } else { p }
        };
        nearer(nearer(first, second), third)
    }
}
