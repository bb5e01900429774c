//! Which pairs may touch soon.
use super::{Body, Pair};
use interfaces::{Periods, Point};

/// Where a body was when pairs were listed, and how far it may go before they have to be listed anew.
#[derive(Clone, Copy, Debug)]
pub(super) struct Listed {
    pub(super) centre: Point,
    pub(super) margin: f64,
}

/// Sort and sweep: the bodies' boxes, cast on the axis along which the bodies are spread most and sorted there,
/// are compared with those that begin before they end. Allocates only when bodies were added.
#[derive(Clone, Debug, Default)]
pub(super) struct BroadPhase {
    /// In the order of the last sweep, which is nearly that of the next one.
    shadows: Vec<Shadow>,
}

/// A body's box and where it begins on the axis of the sweep; a copy, so that the sweep reads memory in a row.
#[derive(Clone, Copy, Debug)]
struct Shadow {
    low: f64,
    reach: f64,
    centre: Point,
    movable: bool,
    body: usize,
}

impl BroadPhase {
    /// Lists the pairs of bodies whose boxes, grown by their margins, meet. Every pair is listed once, in
    /// ascending order, whatever happened before; pairs that nothing can move are left out.
    pub(super) fn sweep(&mut self, periods: &Periods, bodies: &[Body], near: &mut Vec<Pair>) {
        near.clear();
        if self.shadows.len() != bodies.len() {
            self.shadows.clear();
            let shadow = |body| Shadow { low: 0.0, reach: 0.0, centre: Point::origin(), movable: true, body };
            self.shadows.extend((0..bodies.len()).map(shadow));
        }
        let axis = longest_axis(periods, bodies);
        let period = periods.along(axis);
        for s in &mut self.shadows {
            let b = &bodies[s.body];
            (s.reach, s.centre, s.movable) = (b.reach(), b.listed.centre, b.movable());
            s.low = s.centre[axis] - s.reach;
            s.low -= period.map_or(0.0, |l| l * (s.low / l).floor());
        }
        self.shadows.sort_unstable_by(|p, q| p.low.total_cmp(&q.low).then(p.body.cmp(&q.body)));
        for (at, s) in self.shadows.iter().enumerate() {
            let end = s.low + 2.0 * s.reach;
            let ahead = self.shadows[at + 1..].iter().take_while(|t| t.low <= end);
            near.extend(ahead.filter(|t| s.meets(t, periods)).map(|t| s.pair(t)));
            // One period on, those behind.
            if let Some(l) = period.filter(|l| end >= *l) {
                let behind = self.shadows[..at].iter().take_while(|t| t.low + l <= end);
                near.extend(behind.filter(|t| s.meets(t, periods)).map(|t| s.pair(t)));
            }
        }
        near.sort_unstable();
        // Across a period each of two may be ahead of the other.
        near.dedup();
    }
}

impl Shadow {
    fn meets(&self, other: &Self, periods: &Periods) -> bool {
        let apart = periods.nearest(other.centre - self.centre);
        let within = self.reach + other.reach;
        (self.movable || other.movable) && apart.iter().all(|x| x.abs() <= within)
    }
    fn pair(&self, other: &Self) -> Pair {
        Pair(self.body.min(other.body), self.body.max(other.body))
    }
}

fn longest_axis(periods: &Periods, bodies: &[Body]) -> usize {
    let spread = |axis: usize| {
        let places = || bodies.iter().map(|b| b.listed.centre[axis]);
        let spread = places().fold(f64::NEG_INFINITY, f64::max) - places().fold(f64::INFINITY, f64::min);
        spread.min(periods.along(axis).unwrap_or(f64::INFINITY))
    };
    let spreads = [0, 1, 2].map(spread);
    (1..3).fold(0, |best, axis| if spreads[axis] > spreads[best] { axis } else { best })
}
