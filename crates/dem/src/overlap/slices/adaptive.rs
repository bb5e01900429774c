//! Integrals over heights between which the integrand is smooth.
use super::eight::Eight;
use super::lanes::WIDTH;
use super::piece::Piece;
use super::rules::{RULES, column, missed};
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

/// The slices of a piece at the places of the rule of 7 points.
#[derive(Clone, Copy, Default)]
struct Look {
    slices: Eight,
    /// Of the heights with the rules' places.
    changes: [f64; WIDTH],
    seven: Integrals,
}

/// How large errors may be.
struct Scale {
    volume: f64,
    area: f64,
    tolerance: f64,
}

/// ∫f over all pieces, no more than `N`, with a share of `tolerance` of the volume and ten times that of areas as the error; `known` is
/// what the rest adds up to. Rules of 7 and 15 points are compared with those of half as many, and pieces are halved where they differ.
///
/// `f` tells what slices of a piece, given by its number, add. Each piece is first looked at in seven heights and an eighth that counts nothing:
/// its lower end if it is the first one, else its upper end.
pub(super) fn integrate<const N: usize>(
    known: Integrals,
    pieces: &[Piece],
    tolerance: f64,
    mut f: impl FnMut(usize, &[f64; WIDTH]) -> Eight,
) -> Integrals {
    let mut looks = [Look::default(); N];
    let mut all = known;
    for (i, (look, piece)) in looks.iter_mut().zip(pieces).enumerate() {
        *look = Look::new(piece, i, &mut f);
        all = all + look.seven;
    }
    let scale = Scale { volume: all.volume, area: all.volume.cbrt().powi(2) + all.area.norm(), tolerance };
    let mut left = HALVINGS[usize::from(tolerance < FINE)];
    looks
        .iter()
        .zip(pieces)
        .enumerate()
        .fold(known, |sums, (i, (look, piece))| sums + look.refined(piece, i, &scale, &mut f, &mut left))
}

impl Look {
    fn new(piece: &Piece, number: usize, f: &mut impl FnMut(usize, &[f64; WIDTH]) -> Eight) -> Self {
        let (mut heights, mut changes) = ([piece.ends[usize::from(number > 0)]; WIDTH], [0.0; WIDTH]);
        for (i, rule) in RULES[..7].iter().enumerate() {
            [heights[i], changes[i]] = piece.height(rule[0]);
        }
        let mut slices = f(number, &heights);
        slices.forget(7);
        let seven = slices.weighted(&product(&changes, &SEVEN));
        Self { slices, changes, seven }
    }
    /// By as many points as it takes.
    fn refined(
        &self,
        piece: &Piece,
        number: usize,
        scale: &Scale,
        f: &mut impl FnMut(usize, &[f64; WIDTH]) -> Eight,
        left: &mut u32,
    ) -> Integrals {
        let change = self.slices.weighted(&product(&self.changes, &CHANGE));
        let changed = change.volume.abs();
        if scale.tolerance >= FINE && changed > 0.0 {
            // Geometric decay leads to what the rule of 7 points misses, which is hardly less than the square of the change.
            let share = (changed / self.seven.volume.abs()).min(1.0);
            let values = product(&self.changes, self.slices.areas());
            let left = changed.min(missed(&values).max(0.01 * changed * share));
            if scale.small(left, 0.1 * change.area.norm()) {
                return self.seven;
            }
        }
        let (mut heights, mut changes) = ([0.0; WIDTH], [0.0; WIDTH]);
        for (i, rule) in RULES[7..].iter().enumerate() {
            [heights[i], changes[i]] = piece.height(rule[0]);
        }
        let fifteen = self.slices.weighted(&product(&self.changes, &FIFTEEN[0]))
            + f(number, &heights).weighted(&product(&changes, &FIFTEEN[1]));
        let changed = (fifteen.volume - self.seven.volume).abs();
        let share = (10.0 * changed / fifteen.volume.abs()).min(0.5);
        let done = scale.small(changed * share, 0.1 * (fifteen.area - self.seven.area).norm());
        if done || *left == 0 || fifteen.volume == 0.0 || fifteen.volume.is_nan() {
            return fifteen;
        }
        *left -= 1;
        let [low, high] = piece.halves((0.0, 0));
        let mut half = |piece: &Piece| Self::new(piece, number, f).refined(piece, number, scale, f, left);
        half(&low) + half(&high)
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
