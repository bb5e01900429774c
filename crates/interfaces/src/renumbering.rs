//! Numbers after some bodies were taken away.
use crate::BodyId;

/// Which number every body has after some were taken away: those that are left close up, in their order.
///
/// Whoever keeps something of each body applies it.
///
/// ```
/// use interfaces::{BodyId, Renumbering};
/// let numbers = Renumbering::without(4, [BodyId(1)]);
/// assert_eq!(numbers.of(BodyId(1)), None);
/// assert_eq!(numbers.of(BodyId(3)), Some(BodyId(2)));
/// let mut names = vec!["a", "b", "c", "d"];
/// numbers.apply(&mut names);
/// assert_eq!(names, ["a", "c", "d"]);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[must_use = "whoever keeps something of each body has to be told"]
pub struct Renumbering {
    after: Vec<Option<BodyId>>,
    left: usize,
}

impl Renumbering {
    /// Of `n` bodies without those that are `gone`; told twice is as once, and who was not there is no one.
    pub fn without(n: usize, gone: impl IntoIterator<Item = BodyId>) -> Self {
        let mut after = vec![Some(BodyId(0)); n];
        for b in gone {
            if let Some(b) = after.get_mut(b.0) {
                *b = None;
            }
        }
        let mut left = 0;
        for b in after.iter_mut().flatten() {
            *b = BodyId(left);
            left += 1;
        }
        Self { after, left }
    }
    /// The number that body `b` has now, if it is still there.
    pub fn of(&self, b: BodyId) -> Option<BodyId> {
        self.after.get(b.0).copied().flatten()
    }
    /// How many there were.
    pub fn before(&self) -> usize {
        self.after.len()
    }
    /// How many are left.
    pub fn left(&self) -> usize {
        self.left
    }
    /// The old numbers of those that are gone.
    pub fn gone(&self) -> impl Iterator<Item = BodyId> {
        (0..self.after.len()).map(BodyId).filter(|b| self.of(*b).is_none())
    }
    /// Takes out of `list`, which has one entry per body (or fewer), the entries of those that are gone.
    pub fn apply<T>(&self, list: &mut Vec<T>) {
        let mut stays = self.after.iter().map(Option::is_some);
        list.retain(|_| stays.next().unwrap_or(true));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn those_left_close_up() {
        let numbers = Renumbering::without(5, [4, 0, 4, 9].map(BodyId));
        assert_eq!((numbers.before(), numbers.left()), (5, 3));
        let after: Vec<_> = (0..6).map(|b| numbers.of(BodyId(b)).map(|b| b.0)).collect();
        assert_eq!(after, [None, Some(0), Some(1), Some(2), None, None]);
        assert_eq!(numbers.gone().collect::<Vec<_>>(), [BodyId(0), BodyId(4)]);
        let mut short = vec![0, 1];
        numbers.apply(&mut short);
        assert_eq!(short, [1]);
    }
}
