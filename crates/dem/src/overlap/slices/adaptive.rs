//! Integrals over heights between which the integrand is smooth.
use super::lanes::WIDTH;
use super::piece::Piece;
use super::rules::{RULES, column, missed};
use super::sums::Sampled;
use crate::overlap::integrals::Integrals;

/// Halvings of all pieces, at most, for tolerances that are [`FINE`] and for finer ones: where more seem to be needed slices are
/// rounding errors.
const HALVINGS: [u32; 2] = [64, 1024];
/// From this tolerance on 15 points are taken at least.
const FINE: f64 = 1e-6;

/// Weights of the rule of 7 points, what they are more than those of the rule of 3, and of the rule of 15 points those at the same places
/// and at the others.
const SEVEN: [f64; WIDTH] = column(0, 2);
const CHANGE: [f64; WIDTH] = {
    let (mut change, three, mut i) = (SEVEN, column(0, 1), 0);
    while i < WIDTH {
        change[i] -= three[i];
        i += 1;
    }
    change
};
const FIFTEEN: [[f64; WIDTH]; 2] = [column(0, 3), column(7, 3)];

/// What is integrated.
pub(super) trait Slices {
    /// Slices of a piece, given by its number, at these heights, each times its weight by several rules.
    fn sums<const N: usize>(
        &mut self,
        piece: usize,
        heights: &[f64; WIDTH],
        weights: &[[f64; WIDTH]; N],
    ) -> Sampled<N>;
}

/// What the rules of 3 and 7 points say of a piece.
#[derive(Clone, Copy, Default)]
struct Look {
    seven: Integrals,
    /// The part of the rule of 15 points.
    fifteen: Integrals,
    /// How much less the rule of 3 points finds.
    changed: f64,
    area_changed: f64,
    /// What the rule of 7 points is guessed to miss.
    missed: f64,
}

/// How large errors may be.
struct Scale {
    volume: f64,
    area: f64,
    tolerance: f64,
}

/// The integral over all pieces, no more than `N`, with a share of `tolerance` of the volume and ten times that of areas as the error; `known` is
/// what the rest adds up to. Rules of 7 and 15 points are compared with those of half as many, and pieces are halved where they differ.
///
/// Each piece is first looked at in seven heights and an eighth that counts nothing: its lower end if it is the first one, else its upper
/// end.
pub(super) fn integrate<const N: usize>(
    known: Integrals,
    pieces: &[Piece],
    tolerance: f64,
    slices: &mut impl Slices,
) -> Integrals {
    let mut looks = [Look::default(); N];
    let mut all = known;
    for (i, (look, piece)) in looks.iter_mut().zip(pieces).enumerate() {
        *look = Look::new(piece, i, slices);
        all = all + look.seven;
    }
    let scale = Scale { volume: all.volume, area: all.volume.cbrt().powi(2) + all.area.norm(), tolerance };
    let mut left = HALVINGS[usize::from(tolerance < FINE)];
    let mut sums = known;
    for (i, (look, piece)) in looks.iter().zip(pieces).enumerate() {
        sums = sums + look.refined(piece, i, &scale, slices, &mut left);
    }
    sums
}

impl Look {
    fn new(piece: &Piece, number: usize, slices: &mut impl Slices) -> Self {
        let (mut heights, mut changes) = ([piece.ends[usize::from(number > 0)]; WIDTH], [0.0; WIDTH]);
        for (i, rule) in RULES[..7].iter().enumerate() {
            [heights[i], changes[i]] = piece.height(rule[0]);
        }
        let weights = [SEVEN, FIFTEEN[0], CHANGE].map(|weights| product(&changes, &weights));
        let Sampled { areas, sums: [seven, fifteen, change] } = slices.sums(number, &heights, &weights);
        let (changed, area_changed) = (change.volume.abs(), change.area.norm());
        Self { seven, fifteen, changed, area_changed, missed: missed(&product(&changes, &areas)) }
    }
    /// By as many points as it takes.
    fn refined(
        &self,
        piece: &Piece,
        number: usize,
        scale: &Scale,
        slices: &mut impl Slices,
        left: &mut u32,
    ) -> Integrals {
        if scale.tolerance >= FINE && self.changed > 0.0 {
            // Geometric decay leads to what the rule of 7 points misses, which is hardly less than the square of the change.
            let share = (self.changed / self.seven.volume.abs()).min(1.0);
            let left = self.changed.min(self.missed.max(0.01 * self.changed * share));
            if scale.small(left, 0.1 * self.area_changed) {
                return self.seven;
            }
        }
        let (mut heights, mut changes) = ([0.0; WIDTH], [0.0; WIDTH]);
        for (i, rule) in RULES[7..].iter().enumerate() {
            [heights[i], changes[i]] = piece.height(rule[0]);
        }
        let Sampled { sums: [rest], .. } = slices.sums(number, &heights, &[product(&changes, &FIFTEEN[1])]);
        let fifteen = self.fifteen + rest;
        let changed = (fifteen.volume - self.seven.volume).abs();
        let share = (10.0 * changed / fifteen.volume.abs()).min(0.5);
        let done = scale.small(changed * share, 0.1 * (fifteen.area - self.seven.area).norm());
        if done || *left == 0 || fifteen.volume == 0.0 || fifteen.volume.is_nan() {
            return fifteen;
        }
        *left -= 1;
        let mut sums = Integrals::default();
        for half in piece.halves((0.0, 0)) {
            sums = sums + Self::new(&half, number, slices).refined(&half, number, scale, slices, left);
        }
        sums
    }
}

impl Scale {
    fn small(&self, of_volume: f64, of_area: f64) -> bool {
        of_volume <= 0.3 * self.tolerance * self.volume && of_area <= 3.0 * self.tolerance * self.area
    }
}

fn product(x: &[f64; WIDTH], y: &[f64; WIDTH]) -> [f64; WIDTH] {
    std::array::from_fn(|i| x[i] * y[i])
}
