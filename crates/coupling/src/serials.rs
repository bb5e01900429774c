//! Numbers that bodies keep.
use interfaces::{BodyId, Renumbering, RestartError};

/// Numbers that bodies keep however many come and go: they are counted as they come, from 0.
#[derive(Clone, Debug, Default)]
pub(crate) struct Serials {
    /// Of those that are there, ascending.
    numbers: Vec<u64>,
    next: u64,
}

impl Serials {
    /// How many are counted.
    pub(crate) fn len(&self) -> usize {
        self.numbers.len()
    }
    /// Counts those behind the last one, so that there are `n`.
    pub(crate) fn count(&mut self, n: usize) {
        let last = self.next;
        self.next += (n - self.numbers.len()) as u64;
        self.numbers.extend(last..self.next);
    }
    /// Bodies were taken away.
    pub(crate) fn renumber(&mut self, numbers: &Renumbering) {
        numbers.apply(&mut self.numbers);
    }
    pub(crate) fn of(&self, b: BodyId) -> Option<u64> {
        self.numbers.get(b.0).copied()
    }
    pub(crate) fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        let all = self.numbers.iter().chain([&self.next]);
        sink("serials", &all.map(|s| *s as f64).collect::<Vec<_>>());
    }
    /// Of the `n` bodies that are there.
    pub(crate) fn restore<'a>(
        &mut self,
        source: &dyn Fn(&str) -> Option<&'a [f64]>,
        n: usize,
    ) -> Result<(), RestartError> {
        let all = RestartError::take(source, "serials", n + 1)?;
        let (next, numbers) = all.split_last().unwrap_or((&0.0, &[]));
        self.next = *next as u64;
        self.numbers = numbers.iter().map(|s| *s as u64).collect();
        Ok(())
    }
}
