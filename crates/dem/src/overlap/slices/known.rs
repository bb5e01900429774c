//! Tubes whose axes are not parallel: heights at which slices change are known.
use super::common::Common;
use super::eight::Eight;
use super::lanes::WIDTH;
use super::piece::Piece;
use super::touches::{TOUCHES, touches};
use super::tube::SlicedTube;
use super::{Swept, adaptive};
use crate::overlap::integrals::Integrals;

/// Pieces of a range of heights that are few.
const FEW: usize = 10;
/// How near to its ends roots are that a piece feels, as a share of its width.
const NEAR: f64 = 0.2;
/// Share of the mean area that slices at the ends have at most, by rounding.
const LEFT: f64 = 1e-3;

/// Tubes whose axes are not parallel, if what they share is found: from one height to the next at which pieces of the common outline
/// come or go.
pub(super) fn integrate([mut a, mut b]: [SlicedTube; 2], tolerance: f64) -> Option<Swept> {
    // Heights from the middle of those that both have.
    let base = 0.5 * (a.low.max(b.low) + a.high.min(b.high));
    a.lift(-base);
    b.lift(-base);
    if a.low.max(b.low) >= a.high.min(b.high) || a.same_end(&b) {
        return None;
    }
    let touches = touches(&a, &b);
    let (mut pieces, mut n) = ([Piece::default(); TOUCHES], 0);
    let mut common = Common::new(&a, &b);
    // Slices have nothing in common but before some height and beyond some other.
    let mut heights = touches.heights();
    while heights.len() > 2
        && !common.find_between([heights[heights.len() - 2].0, heights[heights.len() - 1].0])
    {
        heights = &heights[..heights.len() - 1];
    }
    while heights.len() > 1 && !common.find_between([heights[0].0, heights[1].0]) {
        heights = &heights[1..];
    }
    for i in 1..heights.len() {
        let ends = [heights[i - 1].0, heights[i].0];
        // A root that ends just beyond is felt, too.
        let near =
            |h: f64| (touches.heights().iter()).any(|t| t.1 && (t.0 - h).abs() <= NEAR * (ends[1] - ends[0]));
        let [low, high] = ends.map(|h| (h, near(h)));
        pieces[n] = Piece::between(low, high);
        n += 1;
    }
    let mut outlines = Outlines { common, now: 0, closed: true, of: [false; 2], areas: [f64::NAN; 2] };
    outlines.note();
    let slices =
        |i: usize, at: &[f64; WIDTH]| outlines.slices(i, [heights[i].0, heights[i + 1].0], i + 1 == n, at);
    let sums = if n <= FEW {
        adaptive::integrate::<FEW>(Integrals::default(), &pieces[..n], tolerance, slices)
    } else {
        adaptive::integrate::<TOUCHES>(Integrals::default(), &pieces[..n], tolerance, slices)
    };
    let [low, high] = [heights[0].0, heights[heights.len() - 1].0];
    if n == 1 {
        outlines.areas[1] = outlines.common.slices(&[high; WIDTH]).areas()[0];
    }
    let Outlines { closed, of, areas, .. } = outlines;
    // What is left out has nothing: else a height was missing.
    let most = LEFT * sums.volume / (high - low);
    let ended = areas.iter().all(|area| *area <= most);
    (sums.volume > 0.0 && closed && ended).then_some(Swept { sums, base, of })
}

/// The outline of one piece at a time.
struct Outlines {
    common: Common,
    /// Whose it is.
    now: usize,
    /// Of all: whether they were closed, whether there were pieces of either body.
    closed: bool,
    of: [bool; 2],
    /// Areas at the lower and upper end of all heights.
    areas: [f64; 2],
}

impl Outlines {
    /// The slices of a piece between two heights.
    fn slices(&mut self, piece: usize, [low, high]: [f64; 2], last: bool, at: &[f64; WIDTH]) -> Eight {
        if piece != self.now {
            self.common.find_between([low, high]);
            self.now = piece;
            self.note();
        }
        let slices = self.common.slices(at);
        let area = slices.areas()[WIDTH - 1];
        if piece == 0 && at[WIDTH - 1] == low {
            self.areas[0] = area;
        } else if last && at[WIDTH - 1] == high {
            self.areas[1] = area;
        }
        slices
    }
    /// Takes note of an outline.
    fn note(&mut self) {
        self.closed &= self.common.is_closed();
        let bodies = self.common.bodies();
        self.of = [0, 1].map(|i| self.of[i] | bodies[i]);
    }
}
