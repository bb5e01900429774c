//! Which wave vectors are fitted.
use super::phases::Phases;
use super::spectrum::{Group, Spectrum};

/// Samples hold so many values of every snapshot for each mode.
const SAMPLES: usize = 200;
/// And so many in all at least.
const LEAST: usize = 1000;

/// All wave vectors, or a sample of them that stands for all.
pub(super) struct Problem<'a> {
    pub(super) phases: &'a Phases,
    /// With how many each of them stands for.
    pub(super) groups: Vec<(&'a Group, f64)>,
}

impl<'a> Problem<'a> {
    /// All.
    pub(super) fn all(spectrum: &'a Spectrum) -> Self {
        Self { phases: &spectrum.phases, groups: spectrum.groups.iter().map(|g| (g, 1.0)).collect() }
    }

    /// A sample for so many modes, if it is much less than all: one after the other with probabilities that are half equal and
    /// half as their energies are (systematic sampling), so that sums over it are those over all on average.
    pub(super) fn sample(spectrum: &'a Spectrum, rank: usize) -> Option<Self> {
        let (groups, n) = (&spectrum.groups, spectrum.n_snapshots());
        let columns: usize = groups.iter().map(|g| g.data.len() / (2 * n)).sum();
        let part = (SAMPLES * rank).max(LEAST) as f64 / columns.max(1) as f64;
        if part > 0.25 {
            return None;
        }
        let energies: Vec<_> = groups.iter().map(|g| g.energy).collect();
        let energy: f64 = energies.iter().sum();
        let n_groups = groups.len() as f64;
        let mut last = 0.5;
        let mut taken = Vec::new();
        for (group, e) in groups.iter().zip(energies) {
            let probability = (part * n_groups * (0.5 / n_groups + 0.5 * e / energy)).min(1.0);
            let next: f64 = last + probability;
            if next.floor() > last.floor() {
                taken.push((group, probability.recip()));
            }
            last = next;
        }
        Some(Self { phases: &spectrum.phases, groups: taken })
    }
}
