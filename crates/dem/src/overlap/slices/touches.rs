//! Heights at which what slices of two tubes share gets or loses a piece of its outline.
use super::circle::Circle;
use super::slice::{Place, cross};
use super::sliced_tube::SlicedTube;
use crate::overlap::tube::Ends;

/// Heights at most.
pub(super) const TOUCHES: usize = 64;
/// What is this share of the size beyond the end of a piece is taken for a place on it.
const SLACK: f64 = 1e-9;

/// Heights, and whether the integrals over the slices may change like a root beyond them.
pub(super) struct Touches {
    heights: [(f64, bool); TOUCHES],
    n: usize,
    range: [f64; 2],
}

/// All heights within the range that both tubes have, and its ends, upwards.
///
/// A corner or the end of an arc of one body runs on the circle in which its straight part begins; it meets a side of the other's
/// outline where that circle meets the other's surface, and there all is smooth from above and from below. A round end touches a
/// side or a round end where in the plane through the centre and the nearest of the other's axis two circles cross.
pub(super) fn touches(a: &SlicedTube, b: &SlicedTube) -> Touches {
    let range = [a.low.max(b.low), a.high.min(b.high)];
    let mut touches = Touches { heights: [(0.0, false); TOUCHES], n: 0, range };
    for (one, other) in [(a, b), (b, a)] {
        for sign in [1.0, -1.0] {
            let end = End::new(one, other, sign);
            end.circle_on_side(&mut touches);
            end.circle_on_ends(&mut touches);
            if one.ends == Ends::Round {
                end.arc_on_side(&mut touches);
                end.arc_on_ends(&mut touches);
            }
        }
    }
    touches.finish();
    touches
}

impl Touches {
    pub(super) fn heights(&self) -> &[(f64, bool)] {
        &self.heights[..self.n]
    }
    fn push(&mut self, h: f64, round: bool) {
        if h > self.range[0] && h < self.range[1] && self.n < TOUCHES - 2 {
            self.heights[self.n] = (h, round);
            self.n += 1;
        }
    }
    /// Adds the ends, sorts, and takes those for one that rounding tells apart.
    fn finish(&mut self) {
        let [low, high] = self.range;
        self.heights[self.n] = (low, true);
        self.heights[self.n + 1] = (high, true);
        let found = &mut self.heights[..self.n + 2];
        found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let close = 1e-13 * (high - low);
        let mut n = 0;
        for i in 0..found.len() {
            let now = found[i];
            if n > 0 && now.0 - found[n - 1].0 <= close {
                found[n - 1].1 |= now.1;
            } else {
                found[n] = now;
                n += 1;
            }
        }
        self.n = n;
    }
}

/// One end of a tube as the other sees it: lengths along and across the other's axis.
struct End {
    /// Half the length of the other and the radii of both.
    half: f64,
    own: f64,
    radius: f64,
    ends: Ends,
    /// The place of the centre, the way out along the own axis, and the way across that.
    centre: Place,
    out: Place,
    left: Place,
    /// Heights of both middles.
    height: f64,
    above: f64,
    slack: f64,
}

impl End {
    fn new(one: &SlicedTube, other: &SlicedTube, sign: f64) -> Self {
        let of = |v: Place| Place::new(other.axis.dot(&v), cross(other.axis, v));
        let height = 0.5 * (one.low + one.high);
        Self {
            half: other.half,
            own: one.radius,
            radius: other.radius,
            ends: other.ends,
            centre: of(one.centre + one.axis * (sign * one.half) - other.centre),
            out: of(one.axis * sign),
            left: of(Place::new(-one.axis.y, one.axis.x)),
            height,
            above: height - 0.5 * (other.low + other.high),
            slack: SLACK * (one.half + one.radius + other.half + other.radius),
        }
    }
    /// The circle's place at an angle given by cosine and sine, across and above the centre.
    fn place(&self, cos: f64) -> Place {
        self.centre + self.left * (self.own * cos)
    }
    /// Where the circle in which the straight part begins meets the other's side: roots of a trigonometric polynomial of second degree.
    fn circle_on_side(&self, touches: &mut Touches) {
        let (y, k, r, up) = (self.centre.y, self.left.y, self.own, self.above);
        let beside = self.centre.x.abs() - r * self.left.x.abs() > self.half + self.slack;
        if beside || y.abs() - r * k.abs() >= self.radius || up.abs() >= r + self.radius {
            return;
        }
        let circle = Circle { across: y, along: k, own: r, above: up, radius: self.radius };
        // Beyond the other's end or beyond all heights in all of a sector, in which cosine and sine have no extremes.
        let reach = self.half + self.slack;
        let range = touches.range.map(|h| h - self.height);
        let beyond = |from: [f64; 2], to: [f64; 2]| {
            let (x, y) = (self.place(from[0]).x, self.place(to[0]).x);
            let (low, high) = (r * from[1].min(to[1]), r * from[1].max(to[1]));
            x.min(y) > reach || x.max(y) < -reach || high < range[0] || low > range[1]
        };
        circle.roots(beyond, |[cos, sin]| {
            if self.place(cos).x.abs() <= reach {
                touches.push(self.height + r * sin, false);
            }
        });
    }
    /// Where it meets the other's ends.
    fn circle_on_ends(&self, touches: &mut Touches) {
        for sign in [1.0, -1.0] {
            let end = sign * self.half;
            if self.ends == Ends::Flat {
                let cos = (end - self.centre.x) / (self.own * self.left.x);
                if cos.abs() < 1.0 {
                    let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
                    let (y, reach) = (self.place(cos).y, self.radius + self.slack);
                    for sin in [sin, -sin] {
                        let up = self.above + self.own * sin;
                        if y * y + up * up <= reach * reach {
                            touches.push(self.height + self.own * sin, false);
                        }
                    }
                }
                continue;
            }
            // p cos φ + q sin φ = s: the circle on a ball.
            let from = self.centre - Place::new(end, 0.0);
            let (p, q) = (2.0 * self.own * self.left.dot(&from), 2.0 * self.own * self.above);
            let s = (self.radius - self.own) * (self.radius + self.own)
                - from.norm_squared()
                - self.above * self.above;
            let most = (p * p + q * q).sqrt();
            if s.abs() < most {
                let (u, v, c) = (p / most, q / most, s / most);
                let root = ((1.0 - c) * (1.0 + c)).sqrt();
                for root in [root, -root] {
                    let (cos, sin) = (u * c - v * root, v * c + u * root);
                    if self.place(cos).x * sign >= self.half - self.slack {
                        touches.push(self.height + self.own * sin, false);
                    }
                }
            }
        }
    }
    /// Places across and above the centre where its circle crosses one around a place this far across.
    fn circles(&self, across: f64) -> [Option<[f64; 2]>; 2] {
        let (r, w) = (self.own, self.radius);
        let d = (across * across + self.above * self.above).sqrt();
        let product = (r + w - d) * (d - r + w) * (d + r - w) * (d + r + w);
        if product <= 0.0 || d == 0.0 {
            return [None; 2];
        }
        let (along, half) = (0.5 * (d + (r - w) * ((r + w) / d)), product.sqrt() / (2.0 * d));
        let (x, y) = (across / d, -self.above / d);
        [half, -half].map(|half| Some([x * along - y * half, y * along + x * half]))
    }
    /// Where the round end touches the other's side, at its foot there.
    fn arc_on_side(&self, touches: &mut Touches) {
        if self.centre.x.abs() > self.half + self.slack {
            return;
        }
        let towards = Place::new(0.0, -1f64.copysign(self.centre.y));
        for [across, up] in self.circles(self.centre.y.abs()).into_iter().flatten() {
            if across * towards.dot(&self.out) >= -self.slack {
                touches.push(self.height + up, true);
            }
        }
    }
    /// Where it touches the other's ends.
    fn arc_on_ends(&self, touches: &mut Touches) {
        for sign in [1.0, -1.0] {
            let end = Place::new(sign * self.half, 0.0);
            if self.ends == Ends::Flat {
                let (off, y, reach) = (end.x - self.centre.x, self.centre.y, self.radius + self.slack);
                if off.abs() < self.own && off * self.out.x >= -self.slack {
                    let up = ((self.own - off) * (self.own + off)).sqrt();
                    for up in [up, -up] {
                        if y * y + (self.above + up) * (self.above + up) <= reach * reach {
                            touches.push(self.height + up, true);
                        }
                    }
                }
                continue;
            }
            let way = end - self.centre;
            let d = way.norm();
            if d == 0.0 {
                continue;
            }
            let towards = way / d;
            for [across, up] in self.circles(d).into_iter().flatten() {
                let x = self.centre.x + towards.x * across;
                if across * towards.dot(&self.out) >= -self.slack && x * sign >= self.half - self.slack {
                    touches.push(self.height + up, true);
                }
            }
        }
    }
}
