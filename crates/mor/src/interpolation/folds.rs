//! Which samples are left out together.
use super::product::Runs;
use super::{InterpolationError, Samples};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Sets of samples: each in turn is left out and predicted from all the others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Folds {
    sets: Vec<Vec<usize>>,
}

impl Folds {
    /// Sets given, of `samples` samples: whole runs, say.
    ///
    /// # Errors
    /// [`InterpolationError::TooFew`] if a set is empty or has all samples,
    /// [`InterpolationError::Parameter`] if it has one that is not there.
    pub fn new(samples: usize, sets: Vec<Vec<usize>>) -> Result<Self, InterpolationError> {
        let folds = Self { sets };
        folds.check(samples)?;
        Ok(folds)
    }
    /// All samples, shared out at random among k sets that differ by one at most, also those at the
    /// ends: k-fold cross-validation; leave-one-out if k is the number of samples.
    ///
    /// # Errors
    /// As [`random`](Self::random).
    pub fn k_fold(samples: &Samples, k: usize, seed: u64) -> Result<Self, InterpolationError> {
        Self::dealt(&shuffled((0..samples.len()).collect(), seed), k)
    }
    /// Every sample alone, also those at the ends: predictions there are extrapolations.
    #[must_use]
    pub fn leave_one_out(samples: &Samples) -> Self {
        Self { sets: (0..samples.len()).map(|i| vec![i]).collect() }
    }
    /// Every sample alone that is not at an end of any input.
    #[must_use]
    pub fn leave_one_out_inside(samples: &Samples) -> Self {
        Self { sets: inside(samples).into_iter().map(|i| vec![i]).collect() }
    }
    /// The samples that are at no end of an input, shared out at random among so many sets that differ by one at most.
    ///
    /// # Errors
    /// [`InterpolationError::Parameter`] if there are fewer than two sets, [`InterpolationError::TooFew`] if there are fewer such
    /// samples.
    pub fn random(samples: &Samples, sets: usize, seed: u64) -> Result<Self, InterpolationError> {
        Self::dealt(&shuffled(inside(samples), seed), sets)
    }
    /// The samples between the ends, shared out in the order of the first input: with one input each is predicted from neighbours on
    /// both sides.
    ///
    /// # Errors
    /// As [`random`](Self::random).
    pub fn interleaved(samples: &Samples, sets: usize) -> Result<Self, InterpolationError> {
        let mut order = inside(samples);
        order.sort_by(|&a, &b| samples.point(a)[0].total_cmp(&samples.point(b)[0]));
        Self::dealt(&order, sets)
    }
    /// Of a full grid, planes of nodes across every axis, save the outermost ones: what is left is a full grid again. At most so many
    /// across one axis, evenly chosen.
    ///
    /// # Errors
    /// [`InterpolationError::NotAGrid`], [`InterpolationError::TooFew`] if no axis has three values.
    pub fn planes(samples: &Samples, most: usize) -> Result<Self, InterpolationError> {
        let grid = samples.grid()?;
        let mut sets = Vec::new();
        let mut stride = 1;
        for axis in &grid.axes {
            let of = |node: usize| (node / stride) % axis.len();
            for plane in thinned(1..axis.len().saturating_sub(1), most) {
                let nodes = (0..grid.samples.len()).filter(|&node| of(node) == plane);
                sets.push(nodes.map(|node| grid.samples[node]).collect());
            }
            stride *= axis.len();
        }
        if sets.is_empty() {
            let found = grid.axes.iter().map(Vec::len).max().unwrap_or(0);
            return Err(too_few("leaving out planes of a grid", "values of an input", 3, found));
        }
        Ok(Self { sets })
    }
    /// Of samples at all pairs of values of the first input, say time, and points of the others, say the parameters of runs: at most so
    /// many runs, evenly chosen, and five interleaved sets of the values between the first and the last.
    ///
    /// # Errors
    /// [`InterpolationError::NotAGrid`], [`InterpolationError::TooFew`] values of the first input or runs.
    pub fn runs(samples: &Samples, most: usize) -> Result<Self, InterpolationError> {
        let Runs { first, samples: runs } = Runs::of(samples)?;
        let what = "leaving out runs and values of the first input";
        if runs.len() < 3 {
            return Err(too_few(what, "runs", 3, runs.len()));
        }
        if first.len() < 7 {
            return Err(too_few(what, "values of the first input", 7, first.len()));
        }
        let between = |from: usize| (from..first.len() - 1).step_by(5);
        let times =
            (1..6).map(|from| between(from).flat_map(|j| runs.iter().map(move |run| run[j])).collect());
        let some = thinned(0..runs.len(), most).map(|run| runs[run].clone());
        Ok(Self { sets: some.chain(times).collect() })
    }
    /// Those that suit the samples: five [`interleaved`](Self::interleaved) sets for one input; five [`planes`](Self::planes) across
    /// every axis of a grid; ten [`runs`](Self::runs); each sample alone of up to 40 scattered ones, five [`random`](Self::random)
    /// sets of more.
    ///
    /// # Errors
    /// [`InterpolationError::TooFew`] if there are too few samples to leave any out.
    pub fn suited(samples: &Samples, seed: u64) -> Result<Self, InterpolationError> {
        let inside = inside(samples).len();
        if samples.inputs() == 1 {
            return Self::interleaved(samples, inside.clamp(2, 5));
        }
        if let Ok(folds) = Self::planes(samples, 5).or_else(|_| Self::runs(samples, 10)) {
            return Ok(folds);
        }
        match inside {
            0..5 if samples.len() < 3 => Err(too_few("cross-validation", "samples", 3, samples.len())),
            0..5 => Ok(Self::leave_one_out(samples)),
            5..=40 => Ok(Self::leave_one_out_inside(samples)),
            _ => Self::random(samples, 5, seed),
        }
    }

    fn dealt(order: &[usize], count: usize) -> Result<Self, InterpolationError> {
        if count < 2 {
            let (what, value, must) = ("number of sets", count as f64, "at least 2");
            return Err(InterpolationError::Parameter { what, value, must });
        }
        if order.len() < count {
            return Err(too_few("cross-validation", "samples to leave out", count, order.len()));
        }
        let set = |first: usize| order.iter().skip(first).step_by(count).copied().collect();
        Ok(Self { sets: (0..count).map(set).collect() })
    }
    /// At most so many of the sets, evenly chosen.
    #[must_use]
    pub fn some(&self, most: usize) -> Self {
        Self { sets: thinned(0..self.sets.len(), most).map(|i| self.sets[i].clone()).collect() }
    }
    /// Checks that every set has some, but not all, of so many samples.
    pub(crate) fn check(&self, samples: usize) -> Result<(), InterpolationError> {
        let what = "leaving out a set";
        if self.sets.is_empty() {
            return Err(too_few("cross-validation", "sets", 1, 0));
        }
        for set in &self.sets {
            if set.is_empty() {
                return Err(too_few(what, "samples in each set", 1, 0));
            }
            if let Some(&sample) = set.iter().find(|&&sample| sample >= samples) {
                let (what, must) = ("index of a sample left out", "below the number of samples");
                return Err(InterpolationError::Parameter { what, value: sample as f64, must });
            }
            if (0..samples).all(|sample| set.contains(&sample)) {
                return Err(too_few(what, "samples that are not left out", 1, 0));
            }
        }
        Ok(())
    }
    /// Samples of each set.
    #[must_use]
    pub fn sets(&self) -> &[Vec<usize>] {
        &self.sets
    }
}

/// Shuffles them.
fn shuffled(mut order: Vec<usize>, seed: u64) -> Vec<usize> {
    let mut random = Pcg64::seed_from_u64(seed);
    for i in (1..order.len()).rev() {
        order.swap(i, random.random_range(0..=i));
    }
    order
}

fn too_few(what: &str, of: &'static str, needed: usize, found: usize) -> InterpolationError {
    InterpolationError::TooFew { what: what.into(), of, needed, found }
}

/// At most so many, evenly chosen.
pub(crate) fn thinned(all: std::ops::Range<usize>, most: usize) -> impl Iterator<Item = usize> {
    let count = all.len();
    all.enumerate()
        .filter(move |(i, _)| count <= most || (i * most) / count != ((i + 1) * most) / count)
        .map(|(_, of)| of)
}

/// At no end of an input that has more than two values.
fn inside(samples: &Samples) -> Vec<usize> {
    let bounded: Vec<usize> = (0..samples.inputs()).filter(|&i| samples.distinct(i).len() > 2).collect();
    let is_inside = |j: &usize| {
        let x = samples.point(*j);
        bounded.iter().all(|&i| samples.domain()[i][0] < x[i] && x[i] < samples.domain()[i][1])
    };
    (0..samples.len()).filter(|j| !bounded.is_empty() && is_inside(j)).collect()
}

#[cfg(test)]
mod tests;
