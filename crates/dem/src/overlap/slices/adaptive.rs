//! Integrals over heights between which the integrand is smooth.
use super::piece::Piece;
use super::rules::{RULES, missed};
use crate::overlap::integrals::Integrals;

/// Halvings of all pieces, at most, for tolerances that are [`FINE`] and for finer ones: where more seem to be needed slices are
/// rounding errors.
const HALVINGS: [u32; 2] = [64, 1024];
/// From this tolerance on 15 points are taken at least.
const FINE: f64 = 1e-6;

/// What the rules of 3 and 7 points say of a piece.
#[derive(Clone, Copy, Default)]
struct Look {
    /// Of the volume.
    values: [f64; 7],
    three: Integrals,
    seven: Integrals,
    /// The part of the rule of 15 points.
    fifteen: Integrals,
}

/// How large errors may be.
struct Scale {
    volume: f64,
    area: f64,
    tolerance: f64,
}

/// ∫f over all pieces, no more than `N`, with a share of `tolerance` of the volume and ten times that of areas as the error; `known` is
/// what the rest adds up to. Rules of 7 and 15 points are compared with those of half as many, and pieces are halved where they differ.
pub(super) fn integrate<const N: usize>(
    known: Integrals,
    pieces: &[Piece],
    tolerance: f64,
    mut f: impl FnMut(f64) -> Integrals,
) -> Integrals {
    let mut looks = [Look::default(); N];
    let mut all = known;
    for (look, piece) in looks.iter_mut().zip(pieces) {
        *look = Look::new(piece, &mut f);
        all = all + look.seven;
    }
    let scale = Scale { volume: all.volume, area: all.volume.cbrt().powi(2) + all.area.norm(), tolerance };
    let mut left = HALVINGS[usize::from(tolerance < FINE)];
    looks
        .iter()
        .zip(pieces)
        .fold(known, |sums, (look, piece)| sums + look.refined(piece, &scale, &mut f, &mut left))
}

impl Look {
    fn new(piece: &Piece, f: &mut impl FnMut(f64) -> Integrals) -> Self {
        let mut look = Self::default();
        for (rule, value) in RULES[..7].iter().zip(&mut look.values) {
            let [place, three, seven, fifteen] = *rule;
            let [h, change] = piece.height(place);
            let part = f(h) * change;
            *value = part.volume;
            look.three = look.three + part * three;
            look.seven = look.seven + part * seven;
            look.fifteen = look.fifteen + part * fifteen;
        }
        look
    }
    /// By as many points as it takes.
    fn refined(
        &self,
        piece: &Piece,
        scale: &Scale,
        f: &mut impl FnMut(f64) -> Integrals,
        left: &mut u32,
    ) -> Integrals {
        let changed = (self.seven.volume - self.three.volume).abs();
        if scale.tolerance >= FINE && changed > 0.0 {
            // Geometric decay leads to what the rule of 7 points misses, which is hardly less than the square of the change.
            let share = (changed / self.seven.volume.abs()).min(1.0);
            let left = changed.min(missed(&self.values).max(0.01 * changed * share));
            if scale.small(left, 0.1 * (self.seven.area - self.three.area).norm()) {
                return self.seven;
            }
        }
        let mut fifteen = self.fifteen;
        for rule in &RULES[7..] {
            let [place, .., weight] = *rule;
            let [h, change] = piece.height(place);
            fifteen = fifteen + f(h) * (change * weight);
        }
        let changed = (fifteen.volume - self.seven.volume).abs();
        let share = (10.0 * changed / fifteen.volume.abs()).min(0.5);
        let done = scale.small(changed * share, 0.1 * (fifteen.area - self.seven.area).norm());
        if done || *left == 0 || fifteen.volume == 0.0 || fifteen.volume.is_nan() {
            return fifteen;
        }
        *left -= 1;
        let [low, high] = piece.halves((0.0, 0));
        let mut half = |piece: &Piece| Self::new(piece, f).refined(piece, scale, f, left);
        half(&low) + half(&high)
    }
}

impl Scale {
    fn small(&self, of_volume: f64, of_area: f64) -> bool {
        of_volume <= 0.3 * self.tolerance * self.volume && of_area <= 3.0 * self.tolerance * self.area
    }
}
