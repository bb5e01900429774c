//! Where a circle meets an infinite cylinder.
use std::f64::consts::TAU;

/// Parts of a circle that are searched for roots one by one: cosine and sine where they begin.
const SECTORS: [[f64; 2]; 16] = {
    const R: f64 = std::f64::consts::FRAC_1_SQRT_2;
    const C: f64 = 0.923_879_532_511_286_7;
    const S: f64 = 0.382_683_432_365_089_8;
    [
        [1.0, 0.0],
        [C, S],
        [R, R],
        [S, C],
        [0.0, 1.0],
        [-S, C],
        [-R, R],
        [-C, S],
        [-1.0, 0.0],
        [-C, -S],
        [-R, -R],
        [-S, -C],
        [0.0, -1.0],
        [S, -C],
        [R, -R],
        [C, -S],
    ]
};
/// The angle of one.
const SECTOR: f64 = TAU / 16.0;
/// How often a sector is halved: what two roots nearer than this enclose is nothing.
const HALVINGS: u32 = 14;

/// A circle in a plane at a right angle to the slices, beside a cylinder along them: a place at the angle φ is `across` + `along`
/// `own` cos φ from the cylinder's axis in the slices and `above` + `own` sin φ above it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Circle {
    pub(super) across: f64,
    pub(super) along: f64,
    /// Its radius and the cylinder's.
    pub(super) own: f64,
    pub(super) above: f64,
    pub(super) radius: f64,
}

/// An angle, its cosine and sine.
#[derive(Clone, Copy, Debug)]
struct Turned {
    angle: f64,
    place: [f64; 2],
}

impl Circle {
    /// The square of the distance from the axis but for that of the radius: a trigonometric polynomial of second degree.
    fn value(&self, [cos, sin]: [f64; 2]) -> f64 {
        let (across, above) = (self.across + self.along * self.own * cos, self.above + self.own * sin);
        (across - self.radius) * (across + self.radius) + above * above
    }
    fn slope(&self, [cos, sin]: [f64; 2]) -> f64 {
        let (across, above) = (self.across + self.along * self.own * cos, self.above + self.own * sin);
        2.0 * self.own * (above * cos - self.along * across * sin)
    }
    fn bend(&self, [cos, sin]: [f64; 2]) -> f64 {
        let second = self.own * (1.0 - self.along * self.along) * (cos - sin) * (cos + sin);
        2.0 * self.own * (second - self.above * sin - self.along * self.across * cos)
    }
    /// Finds all places on the cylinder but those in sectors that need not be looked at, given by the places of their ends.
    pub(super) fn roots(&self, skip: impl Fn([f64; 2], [f64; 2]) -> bool, mut found: impl FnMut([f64; 2])) {
        let first = self.above.abs() + (self.along * self.across).abs();
        let second = self.own * (1.0 - self.along * self.along).abs();
        // The largest second and third derivative.
        let most = [2.0 * self.own * (first + second), 2.0 * self.own * (first + 2.0 * second)];
        let mut last = self.value(SECTORS[0]);
        for (i, place) in SECTORS.iter().enumerate() {
            let next = SECTORS[(i + 1) % SECTORS.len()];
            let values = [last, self.value(next)];
            last = values[1];
            let ends = [Turned::new(i, *place), Turned::new(i + 1, next)];
            if !skip(*place, next) {
                self.within(ends, values, most, HALVINGS, &mut found);
            }
        }
    }
    /// The roots between two angles: halved until the function is far from zero, or rises or bends one way only.
    fn within(
        &self,
        [from, to]: [Turned; 2],
        values: [f64; 2],
        most: [f64; 2],
        halvings: u32,
        found: &mut impl FnMut([f64; 2]),
    ) {
        let width = to.angle - from.angle;
        let crosses = (values[0] < 0.0) != (values[1] < 0.0);
        let (value, slope, bend) = (|p| self.value(p), |p| self.slope(p), |p| self.bend(p));
        if !crosses && values[0].abs().min(values[1].abs()) > most[0] * width * width / 8.0 {
            return;
        }
        let middle = from.by(0.5 * width);
        let rises = slope(middle.place).abs() > 0.5 * most[0] * width;
        let bends = || bend(middle.place).abs() > 0.5 * most[1] * width;
        if rises || halvings == 0 || bends() {
            if crosses {
                found(root(from, to, value, slope).place);
            } else if !rises && (slope(from.place) < 0.0) != (slope(to.place) < 0.0) {
                // There and back, perhaps.
                let extreme = root(from, to, slope, bend);
                if (value(extreme.place) < 0.0) != (values[0] < 0.0) {
                    found(root(from, extreme, value, slope).place);
                    found(root(extreme, to, value, slope).place);
                }
            }
            return;
        }
        let half = value(middle.place);
        self.within([from, middle], [values[0], half], most, halvings - 1, found);
        self.within([middle, to], [half, values[1]], most, halvings - 1, found);
    }
}

impl Turned {
    fn new(sector: usize, place: [f64; 2]) -> Self {
        Self { angle: SECTOR * sector as f64, place }
    }
    /// Farther by an angle of no more than a sector's, by the series of both.
    fn by(&self, step: f64) -> Self {
        let s = step * step;
        let cos = 1.0
            - s / 2.0
                * (1.0
                    - s / 12.0 * (1.0 - s / 30.0 * (1.0 - s / 56.0 * (1.0 - s / 90.0 * (1.0 - s / 132.0)))));
        let sin = step
            * (1.0 - s / 6.0 * (1.0 - s / 20.0 * (1.0 - s / 42.0 * (1.0 - s / 72.0 * (1.0 - s / 110.0)))));
        let [c, d] = self.place;
        Self { angle: self.angle + step, place: [c * cos - d * sin, d * cos + c * sin] }
    }
}

/// Where between two angles of a sector at which its signs differ a function vanishes: Newton's method, else halves.
fn root(
    mut low: Turned,
    mut high: Turned,
    f: impl Fn([f64; 2]) -> f64,
    slope: impl Fn([f64; 2]) -> f64,
) -> Turned {
    let (at_low, at_high) = (f(low.place), f(high.place));
    let width = high.angle - low.angle;
    // By the chord.
    let mut x = low.by(width * (at_low / (at_low - at_high)).clamp(0.0, 1.0));
    for _ in 0..60 {
        let y = f(x.place);
        if (y < 0.0) == (at_low < 0.0) {
            low = x
        } else {
            high = x
        }
        let step = -y / slope(x.place);
        let angle = x.angle + step;
        let newton = angle > low.angle && angle < high.angle;
        x = if newton { x.by(step) } else { low.by(0.5 * (high.angle - low.angle)) };
        // Newton's method squares the error.
        if (newton && step.abs() <= 1e-8) || high.angle - low.angle <= 1e-15 {
            return x;
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::Draw;

    /// As many as a fine table of signs shows, with large circles that only dip into thin cylinders: up to four close together.
    #[test]
    fn all_places_are_found() {
        let mut draw = Draw(3);
        let (mut four, mut several) = (0, 0);
        for _ in 0..3000 {
            let (own, radius) = (1.0, draw.between(1e-3, 2.0));
            let sign = if draw.next() < 0.5 { -1.0 } else { 1.0 };
            let along = (2.0 * draw.next() - 1.0) * draw.between(1e-4, 1.0);
            // The top of the circle near the cylinder.
            let above = sign * (own - radius * (1.0 - draw.between(1e-4, 1.0)));
            let across = radius * (2.0 * draw.next() - 1.0);
            let circle = Circle { across, along, own, above, radius };
            let mut found = Vec::new();
            circle.roots(|_, _| false, |place| found.push(place));
            for place in &found {
                assert!(circle.value(*place).abs() < 1e-12 && (place[0].hypot(place[1]) - 1.0).abs() < 1e-13);
            }
            let n = 20_000;
            let at = |i: usize| {
                let (sin, cos) = (TAU * (i as f64 + 0.123) / n as f64).sin_cos();
                circle.value([cos, sin]) < 0.0
            };
            let changes = (0..n).filter(|i| at(*i) != at(i + 1)).count();
            assert!(found.len() >= changes && found.len() <= 4, "{circle:?}: {changes} {found:?}");
            several += usize::from(found.len() > changes);
            four += usize::from(changes == 4);
        }
        assert!(four > 100 && several < 30, "{four} {several}");
    }
}
