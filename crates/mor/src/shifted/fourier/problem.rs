//! Which wave vectors are fitted.
use super::phases::Phases;
use super::spectrum::{Group, Spectrum};
use monomorphic::{Mat, MatMut, MatRef, add_product};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::borrow::Cow;

/// A sample holds so many values of every snapshot for each mode: n r amplitudes of n snapshots by 2 · 50 r (n − r)
/// equations leave about 1 % too little of the squared error, which the last steps on all data make up for,
const SAMPLES: usize = 50;
/// so many in all at least,
const LEAST: usize = 1000;
/// and at most this part of all.
const MOST: f64 = 0.5;

/// What belongs to one wave vector.
pub(super) struct Piece<'a> {
    pub(super) wave: [usize; 3],
    /// Complex columns, real parts of all snapshots before imaginary parts.
    pub(super) data: Cow<'a, [f64]>,
    /// How many it stands for.
    pub(super) weight: f64,
}

impl<'a> Piece<'a> {
    fn of(group: &'a Group, weight: f64) -> Self {
        Self { wave: group.wave, data: Cow::Borrowed(&group.data), weight }
    }
}

/// All wave vectors, or a sample of them that stands for all.
pub(super) struct Problem<'a> {
    /// Weight of ‖Φ‖² against the squared error, for amplitudes of length one (Tikhonov).
    pub(super) ridge: f64,
    pub(super) phases: &'a Phases,
    pub(super) pieces: Vec<Piece<'a>>,
}

impl<'a> Problem<'a> {
    /// All.
    pub(super) fn all(spectrum: &'a Spectrum, ridge: f64) -> Self {
        let pieces = spectrum.groups.iter().map(|g| Piece::of(g, 1.0)).collect();
        Self { ridge, phases: &spectrum.phases, pieces }
    }

    /// A sample for so many modes, if that is much less than all. Sums over it are those over all on average.
    pub(super) fn sample(spectrum: &'a Spectrum, rank: usize, ridge: f64) -> Option<Self> {
        let n = spectrum.n_snapshots();
        let columns: usize = spectrum.groups.iter().map(|g| g.data.len() / (2 * n)).sum();
        let size = (SAMPLES * rank).max(LEAST);
        if size as f64 > MOST * columns as f64 {
            return None;
        }
        let n_groups = spectrum.groups.len();
        let pieces = if n_groups > size {
            some(&spectrum.groups, size as f64)
        } else {
            let mut rng = Pcg64::seed_from_u64(2);
            let mixed = spectrum.groups.iter().map(|g| mixed(g, n, size.div_ceil(n_groups), &mut rng));
            mixed.collect()
        };
        Some(Self { ridge, phases: &spectrum.phases, pieces })
    }
}

/// Some of many wave vectors, one after the other with probabilities that are half equal and half as their energies are
/// (systematic sampling).
fn some(groups: &[Group], size: f64) -> Vec<Piece<'_>> {
    let energy: f64 = groups.iter().map(|g| g.energy).sum();
    let mut sum = 0.5_f64;
    let mut pieces = Vec::new();
    for group in groups {
        let part = 0.5 / groups.len() as f64 + 0.5 * group.energy / energy;
        let probability = (size * part).min(1.0);
        let next = sum + probability;
        if next.floor() > sum.floor() {
            pieces.push(Piece::of(group, probability.recip()));
        }
        sum = next;
    }
    pieces
}

/// At most `size` sums of the columns with random signs.
fn mixed<'a>(group: &'a Group, n: usize, size: usize, rng: &mut Pcg64) -> Piece<'a> {
    let columns = group.data.len() / (2 * n);
    if columns <= size {
        return Piece::of(group, 1.0);
    }
    let factor = (size as f64).sqrt().recip();
    let signs = Mat::from_fn(columns, size, |_, _| if rng.random_bool(0.5) { factor } else { -factor });
    let mut data = vec![0.0; 2 * n * size];
    let from = MatRef::from_column_major_slice(&group.data, 2 * n, columns);
    add_product(MatMut::from_column_major_slice_mut(&mut data, 2 * n, size), from, signs.as_ref());
    Piece { wave: group.wave, data: Cow::Owned(data), weight: 1.0 }
}
