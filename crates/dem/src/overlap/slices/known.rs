//! Tubes whose axes are not parallel: heights at which slices change are known.
use super::piece::Piece;
use super::touches::{TOUCHES, touches};
use super::tube::SlicedTube;
use super::{Swept, adaptive, common};
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
    // Slices have nothing in common but before some height and beyond some other.
    let mut heights = touches.heights();
    let empty = |h: &[(f64, bool)]| common::slice(&a, &b, 0.5 * (h[0].0 + h[1].0)).0.volume <= 0.0;
    while heights.len() > 1 && empty(heights) {
        heights = &heights[1..];
    }
    while heights.len() > 2 && empty(&heights[heights.len() - 2..]) {
        heights = &heights[..heights.len() - 1];
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
    let mut of = [false; 2];
    let slice = |h: f64| {
        let (sums, pieces) = common::slice(&a, &b, h);
        of = [of[0] | pieces[0], of[1] | pieces[1]];
        sums
    };
    let sums = if n <= FEW {
        adaptive::integrate::<FEW>(Integrals::default(), &pieces[..n], tolerance, slice)
    } else {
        adaptive::integrate::<TOUCHES>(Integrals::default(), &pieces[..n], tolerance, slice)
    };
    // What is left out has nothing: else a height was missing.
    let most = LEFT * sums.volume / (heights[heights.len() - 1].0 - heights[0].0);
    let closed = [heights[0].0, heights[heights.len() - 1].0]
        .iter()
        .all(|h| common::slice(&a, &b, *h).0.volume <= most);
    (sums.volume > 0.0 && closed).then_some(Swept { sums, base, of })
}
