//! Cells that go to and fro from one steady iteration to the next.
use std::ops::Range;

/// The least part of a change that is made, what is left of the part when a change turns round, and what it grows by when not.
const LEAST: f64 = 0.2;
const TURNS: f64 = 0.7;
const GOES_ON: f64 = 1.1;

/// Makes a part of the change of every cell only, the less the more often changes have turned round of late: where two states follow from each
/// other, as beside walls in the buffer layer, the iteration comes to rest between them. What is at rest does not depend on it.
#[derive(Clone, Debug, Default)]
pub(super) struct Damping {
    old: Vec<f64>,
    change: Vec<f64>,
    part: Vec<f64>,
}

impl Damping {
    /// Last changes, then the parts of changes that are made; empty before the first iteration.
    pub(super) fn numbers(&self) -> Vec<f64> {
        [self.change.as_slice(), &self.part].concat()
    }
    /// Takes back [`numbers`](Self::numbers).
    pub(super) fn set_numbers(&mut self, numbers: &[f64]) {
        let (change, part) = numbers.split_at(numbers.len() / 2);
        (self.change, self.part) = (change.to_vec(), part.to_vec());
    }

    /// Before an iteration changes `list`.
    pub(super) fn remember(&mut self, list: &[f64]) {
        self.old.clear();
        self.old.extend_from_slice(list);
        if self.part.len() != list.len() {
            self.part = vec![1.0; list.len()];
            self.change = vec![0.0; list.len()];
        }
    }

    /// After it did, in the cells of `runs`.
    pub(super) fn damp(&mut self, list: &mut [f64], runs: &[Range<usize>]) {
        for i in runs.iter().cloned().flatten() {
            let change = list[i] - self.old[i];
            let turned = change * self.change[i] < 0.0;
            self.part[i] = (self.part[i] * if turned { TURNS } else { GOES_ON }).clamp(LEAST, 1.0);
            self.change[i] = change;
            if self.part[i] < 1.0 {
                list[i] = self.old[i] + self.part[i] * change;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x ← 1 − g (x − 1) goes to and fro for ever with g = 1, and runs away with 5.
    #[test]
    fn what_goes_to_and_fro_comes_to_rest() {
        for gain in [1.0, 5.0] {
            let (mut damping, mut list) = (Damping::default(), [1.1, 3.0]);
            let mut moves = 0.0;
            for _ in 0..300 {
                damping.remember(&list);
                list = [1.0 - gain * (list[0] - 1.0), 0.5 * list[1]];
                let before = list[1];
                damping.damp(&mut list, std::slice::from_ref(&(0..2)));
                moves = (list[0] - 1.0_f64).abs();
                // What goes one way is left alone.
                assert_eq!(list[1], before);
            }
            assert!(moves < 1e-3, "{gain}: {moves}");
        }
    }

    #[test]
    fn cells_outside_of_the_runs_are_left_alone() {
        let (mut damping, mut list) = (Damping::default(), [1.0, 1.0]);
        for sign in [1.0, -1.0, 1.0, -1.0] {
            damping.remember(&list);
            list = list.map(|x| x + sign);
            damping.damp(&mut list, std::slice::from_ref(&(1..2)));
        }
        assert!(list[0] == 1.0 && list[1] != 1.0, "{list:?}");
    }
}
