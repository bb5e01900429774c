//! Tubes whose axes are not parallel: heights at which slices change are known.
use super::common::{Common, Outline};
use super::lanes::WIDTH;
use super::piece::Piece;
use super::sliced_tube::SlicedTube;
use super::sums::Sampled;
use super::touches::{TOUCHES, Touches, touches};
use super::{Swept, adaptive};
use crate::overlap::integrals::Integrals;

/// Pieces of a range of heights that are few.
const FEW: usize = 16;
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
    let mut common = Common::new(&a, &b);
    let (sums, of) = if touches.heights().len() <= FEW {
        between::<FEW>(&mut common, &touches, tolerance)?
    } else {
        between::<TOUCHES>(&mut common, &touches, tolerance)?
    };
    Some(Swept { sums, base, of })
}

/// The integrals from one of no more than `N` heights to the next, and whether pieces of the first and the second body's surface were met.
fn between<const N: usize>(
    common: &mut Common,
    touches: &Touches,
    tolerance: f64,
) -> Option<(Integrals, [bool; 2])> {
    let heights = touches.heights();
    let (mut pieces, mut outlines, mut n) = ([Piece::default(); N], [Outline::default(); N], 0);
    for w in heights.windows(2) {
        let (low, high) = (w[0].0, w[1].0);
        let outline = common.between([low, high]);
        if outline.is_empty() {
            // Slices have nothing in common but before some height and beyond some other.
            if n > 0 { break } else { continue }
        }
        // A root that ends just beyond is felt, too.
        let near = |h: f64| heights.iter().any(|t| t.1 && (t.0 - h).abs() <= NEAR * (high - low));
        pieces[n] = Piece::between((low, near(low)), (high, near(high)));
        outlines[n] = outline;
        n += 1;
    }
    let (pieces, outlines) = (&pieces[..n], &outlines[..n]);
    let [low, high] = [pieces.first()?.ends[0], pieces.last()?.ends[1]];
    if !outlines.iter().all(Outline::is_closed) {
        return None;
    }
    let mut slices = Slices { common, outlines, ends: [low, high], areas: [f64::NAN; 2] };
    let sums = adaptive::integrate::<N>(Integrals::default(), pieces, tolerance, &mut slices);
    if n == 1 {
        slices.areas[1] = slices.common.sums(&outlines[0], &[high; WIDTH], &[]).areas[0];
    }
    // What is left out has nothing: else a height was missing.
    let most = LEFT * sums.volume / (high - low);
    let ended = slices.areas.iter().all(|area| *area <= most);
    let of =
        outlines.iter().map(Outline::bodies).fold([false; 2], |of, now| [of[0] | now[0], of[1] | now[1]]);
    (sums.volume > 0.0 && ended).then_some((sums, of))
}

/// Slices between two heights each.
struct Slices<'a> {
    common: &'a Common,
    outlines: &'a [Outline],
    /// Of all, and areas there.
    ends: [f64; 2],
    areas: [f64; 2],
}

impl adaptive::Slices for Slices<'_> {
    fn sums<const N: usize>(
        &mut self,
        piece: usize,
        heights: &[f64; WIDTH],
        weights: &[[f64; WIDTH]; N],
    ) -> Sampled<N> {
        let slices = self.common.sums(&self.outlines[piece], heights, weights);
        for (end, area) in self.ends.iter().zip(&mut self.areas) {
            if heights[WIDTH - 1] == *end {
                *area = slices.areas[WIDTH - 1];
            }
        }
        slices
    }
}
