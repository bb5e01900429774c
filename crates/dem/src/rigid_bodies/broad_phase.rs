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

/// A body's box on the axis of the sweep.
#[derive(Clone, Copy, Debug)]
struct Shadow {
    low: f64,
    width: f64,
    body: usize,
}

impl BroadPhase {
    /// Lists the pairs of bodies whose boxes, grown by their margins, meet. Every pair is listed once, in
    /// ascending order, whatever happened before; pairs that nothing can move are left out.
    pub(super) fn sweep(&mut self, periods: &Periods, bodies: &[Body], near: &mut Vec<Pair>) {
        near.clear();
        let n = bodies.len();
        if self.shadows.len() != n {
            self.shadows.clear();
            self.shadows.extend((0..n).map(|body| Shadow { low: 0.0, width: 0.0, body }));
        }
        let axis = longest_axis(periods, bodies);
        let period = periods.along(axis);
        for s in &mut self.shadows {
            let reach = bodies[s.body].reach();
            s.low = bodies[s.body].listed.centre[axis] - reach;
            s.low -= period.map_or(0.0, |l| l * (s.low / l).floor());
            s.width = 2.0 * reach;
        }
        self.shadows.sort_unstable_by(|p, q| p.low.total_cmp(&q.low).then(p.body.cmp(&q.body)));
        for (at, s) in self.shadows.iter().enumerate() {
            // Those ahead, then, one period on, those behind.
            let ahead = self.shadows[at + 1..].iter().map(|t| (t.body, t.low - s.low));
            let behind = self.shadows[..at].iter().map(|t| (t.body, t.low + period.unwrap_or(0.0) - s.low));
            let behind = behind.take(if period.is_some() { at } else { 0 });
            for (other, gap) in ahead.chain(behind) {
                if gap > s.width {
                    break;
                }
                let pair = Pair(s.body.min(other), s.body.max(other));
                if meet(periods, &bodies[pair.0], &bodies[pair.1]) {
                    near.push(pair);
                }
            }
        }
        near.sort_unstable();
        // Across a period each of two may be ahead of the other.
        near.dedup();
    }
}

fn meet(periods: &Periods, a: &Body, b: &Body) -> bool {
    let apart = periods.nearest(b.listed.centre - a.listed.centre);
    let within = a.reach() + b.reach();
    (a.movable() || b.movable()) && apart.iter().all(|x| x.abs() <= within)
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
