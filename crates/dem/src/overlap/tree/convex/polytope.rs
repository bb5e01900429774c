//! A convex polyhedron that planes are cut off from.
use interfaces::Vector;

/// Corners that a side may have at most.
pub(super) const MOST: usize = 48;
/// Sides that a polyhedron may have at most.
const MOST_SIDES: usize = 250;

/// A corner, as seen from the centre.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) x: Vector,
    /// d_A and d_B there \[m\].
    pub(super) distances: [f64; 2],
    /// The share of the way to it from the centre that is outside, about; NaN until it is known.
    pub(super) gap: f64,
    /// Is it still one?
    pub(super) kept: bool,
}

/// A side: n·x ≤ h.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    pub(super) normal: Vector,
    pub(super) height: f64,
    /// Where it touches the body.
    pub(super) foot: Vector,
    /// How fast the body's distance grows across it.
    pub(super) slope: f64,
    /// The body whose surface it touches; none for those of the box at the beginning.
    pub(super) body: Option<usize>,
    /// Has its outline changed since its deficit was measured?
    pub(super) changed: bool,
    pub(super) deficit: f64,
    pub(super) first: Vector,
    n: usize,
    /// Counterclockwise from outside: a corner, and the side across the edge from it to the next.
    ring: [[u16; 2]; MOST],
}

impl Side {
    pub(super) fn new(normal: Vector, foot: Vector, slope: f64, body: Option<usize>) -> Self {
        Self {
            normal,
            height: normal.dot(&foot),
            foot,
            slope,
            body,
            changed: true,
            deficit: 0.0,
            first: Vector::new(0.0, 0.0, 0.0),
            n: 0,
            ring: [[0; 2]; MOST],
        }
    }
    pub(super) fn ring(&self) -> &[[u16; 2]] {
        &self.ring[..self.n]
    }
    /// Pairs of corners that follow one another, with the side across.
    pub(super) fn edges(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        let n = self.n;
        (0..n).map(move |k| {
            let [from, across] = self.ring[k];
            [from.into(), self.ring[if k + 1 == n { 0 } else { k + 1 }][0].into(), across.into()]
        })
    }
    fn push(&mut self, corner: u16, across: u16) -> Option<()> {
        *self.ring.get_mut(self.n)? = [corner, across];
        self.n += 1;
        Some(())
    }
}

/// The polyhedron; the memory stays.
#[derive(Clone, Debug, Default)]
pub(super) struct Polytope {
    pub(super) corners: Vec<Corner>,
    pub(super) sides: Vec<Side>,
    /// Of a cut: heights of the corners over the plane.
    heights: Vec<f64>,
    /// Edges that it divides, and the new corners on them.
    divided: Vec<[u16; 3]>,
    /// The new side's edges: from, to, side across.
    fresh: Vec<[u16; 3]>,
}

impl Polytope {
    /// A box between two of its corners, along the axes.
    pub(super) fn begin(&mut self, low: Vector, high: Vector) {
        self.corners.clear();
        self.sides.clear();
        for i in 0..8 {
            let x = Vector::from_fn(|a, _| if i >> a & 1 == 1 { high[a] } else { low[a] });
            self.corners.push(Corner { x, distances: [0.0; 2], gap: f64::NAN, kept: true });
        }
        for a in 0..3 {
            let (p, q) = ((a + 1) % 3, (a + 2) % 3);
            for (end, at) in [low[a], high[a]].into_iter().enumerate() {
                let sign = if end == 1 { 1.0 } else { -1.0 };
                let normal = sign * Vector::ith(a, 1.0);
                let mut side = Side::new(normal, sign * at * normal, 0.0, None);
                // Around the axis, the other way round below.
                let around = [[0, 0], [1, 0], [1, 1], [0, 1]];
                let across = [2 * q, 2 * p + 1, 2 * q + 1, 2 * p];
                for k in 0..4 {
                    let k = if end == 1 { k } else { 3 - k };
                    let corner = end << a | around[k][0] << p | around[k][1] << q;
                    // Below, the edge to the corner before.
                    let over = if end == 1 { across[k] } else { across[(k + 3) % 4] };
                    side.ring[side.n] = [corner as u16, over as u16];
                    side.n += 1;
                }
                self.sides.push(side);
            }
        }
    }

    /// Heights of all corners over a plane.
    pub(super) fn look(&mut self, side: &Side) -> &[f64] {
        self.heights.clear();
        self.heights.extend(self.corners.iter().map(|c| side.normal.dot(&c.x) - side.height));
        &self.heights
    }

    pub(super) fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// Cuts off what is before a plane that was looked at; corners no higher than `slack` stay. Answers how many corners there
    /// were before.
    pub(super) fn cut(&mut self, mut side: Side, slack: f64) -> Option<usize> {
        let number = self.sides.len();
        let old = self.corners.len();
        if number >= MOST_SIDES || old > 4000 {
            return None;
        }
        self.divided.clear();
        self.fresh.clear();
        let Self { corners, sides, heights, divided, fresh } = self;
        let within = |c: u16| heights[usize::from(c)] <= slack;
        for (i, other) in sides.iter_mut().enumerate().filter(|(_, side)| side.n > 0) {
            let out = other.ring().iter().filter(|[c, _]| !within(*c)).count();
            if out == 0 {
                continue;
            }
            if out == other.n {
                other.n = 0;
                continue;
            }
            let ring = other.ring;
            let n = other.n;
            other.n = 0;
            other.changed = true;
            let mut made = [[u16::MAX; 2]; 1];
            let mut passes = [0, 0];
            for k in 0..n {
                let [from, across] = ring[k];
                let to = ring[if k + 1 == n { 0 } else { k + 1 }][0];
                let ends = [within(from), within(to)];
                if ends[0] {
                    other.push(from, across)?;
                }
                if ends[0] != ends[1] {
                    let key = [from.min(to), from.max(to)];
                    let known = divided.iter().find(|d| d[..2] == key).map(|d| d[2]);
                    let place = known.unwrap_or_else(|| {
                        let [p, q] = [from, to].map(|c| heights[usize::from(c)]);
                        let [x, y] = [from, to].map(|c| corners[usize::from(c)].x);
                        let share = (p / (p - q)).clamp(0.0, 1.0);
                        let x = x + (y - x) * share;
                        corners.push(Corner { x, distances: [0.0; 2], gap: f64::NAN, kept: true });
                        let place = corners.len() as u16 - 1;
                        divided.push([key[0], key[1], place]);
                        place
                    });
                    if ends[0] {
                        other.push(place, number as u16)?;
                        made[0][0] = place;
                        passes[0] += 1;
                    } else {
                        other.push(place, across)?;
                        made[0][1] = place;
                        passes[1] += 1;
                    }
                }
            }
            // A convex outline is left and entered once.
            if passes != [1, 1] {
                return None;
            }
            fresh.push([made[0][1], made[0][0], i as u16]);
        }
        if fresh.len() < 3 {
            return None;
        }
        let mut at = fresh[0][0];
        for _ in 0..fresh.len() {
            let edge = fresh.iter().find(|e| e[0] == at)?;
            side.push(at, edge[2])?;
            at = edge[1];
        }
        if at != fresh[0][0] {
            return None;
        }
        for (corner, height) in corners.iter_mut().zip(heights.iter()) {
            corner.kept &= *height <= slack;
        }
        sides.push(side);
        Some(old)
    }

    pub(super) fn alive(&self) -> impl Iterator<Item = &Side> {
        self.sides.iter().filter(|s| s.n > 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Volume and area vector from the rings.
    fn volume(p: &Polytope) -> (f64, Vector) {
        let (mut volume, mut area) = (0.0, Vector::zeros());
        for side in p.alive() {
            let x = |c: usize| p.corners[c].x;
            let own: Vector = side.edges().map(|[i, j, _]| 0.5 * x(i).cross(&x(j))).sum();
            volume += own.dot(&side.normal) * side.height / 3.0;
            area += own;
        }
        (volume, area)
    }

    #[test]
    fn cuts_leave_it_closed() {
        let mut p = Polytope::default();
        p.begin(Vector::new(-1.0, -2.0, -1.5), Vector::new(1.0, 1.0, 0.5));
        assert!((volume(&p).0 - 12.0).abs() < 1e-14);
        // A corner tetrahedron of edges 1.5.
        let n = Vector::repeat(1.0).normalize();
        let side = Side::new(n, Vector::new(1.0, 1.0, -1.0), 1.0, Some(0));
        p.look(&side);
        p.cut(side, 0.0).unwrap();
        assert!((volume(&p).0 - 12.0 + 1.5_f64.powi(3) / 6.0).abs() < 1e-13);
        // All planes touch a ball of radius 0.4.
        let ball = 4.0 / 3.0 * std::f64::consts::PI * 0.064;
        let mut state = 5_u64;
        let mut draw = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        for _ in 0..40 {
            let n = Vector::new(draw(), draw(), draw()).normalize();
            let side = Side::new(n, 0.4 * n, 1.0, Some(1));
            p.look(&side);
            if p.heights.iter().zip(&p.corners).any(|(h, c)| c.kept && *h > 0.0) {
                p.cut(side, 0.0).unwrap();
            }
            let (v, area) = volume(&p);
            assert!(v > ball && area.norm() < 1e-12);
            for (i, side) in p.sides.iter().enumerate().filter(|(_, s)| s.n > 0) {
                for [from, to, across] in side.edges() {
                    let back = p.sides[across].edges().any(|[f, t, a]| [f, t, a] == [to, from, i]);
                    assert!(back, "{i} {across}");
                }
            }
        }
        assert!(volume(&p).0 < 1.5 * ball);
    }
}
