//! The ends of lines, as implicit equations need them.
use super::{Boundaries, FaceKind};

/// The ends of the lines along an axis as one component sees them.
pub(crate) struct Ends<'a> {
    kinds: [EndKinds<'a>; 2],
    changes: [&'a [f64]; 2],
    /// What a change counts for in the ghost.
    weights: [f64; 2],
    /// Some value given here changes in time.
    pub(crate) moving: bool,
}

enum EndKinds<'a> {
    Normal(&'a [FaceKind]),
    Along(&'a [bool]),
}

impl Ends<'_> {
    /// Bit 0 is set if the value at the lower end of line `l` is free, bit 1 if that at the upper end is.
    pub(crate) fn kind(&self, l: usize) -> usize {
        let free = |k: &EndKinds| match k {
            EndKinds::Normal(kinds) => !kinds[l].is_fixed(),
            EndKinds::Along(free) => free[l],
        };
        usize::from(free(&self.kinds[0])) + 2 * usize::from(free(&self.kinds[1]))
    }
    /// The kind that all lines share.
    pub(crate) fn common_kind(&self) -> Option<usize> {
        let first = self.kind(0);
        (1..self.changes[0].len()).all(|l| self.kind(l) == first).then_some(first)
    }
    /// By how much the values beyond the ends changed in this step through what is given.
    pub(crate) fn changes(&self, l: usize) -> [f64; 2] {
        [self.weights[0] * self.changes[0][l], self.weights[1] * self.changes[1][l]]
    }
}

impl<const D: usize> Boundaries<D> {
    /// The ends of the lines along axis `a` for component `c`; `None` if periodic.
    pub(crate) fn ends(&self, a: usize, c: usize) -> Option<Ends<'_>> {
        let pair = self.states[a].as_deref()?;
        let kinds = pair
            .each_ref()
            .map(|s| if a == c { EndKinds::Normal(&s.kind) } else { EndKinds::Along(&s.laws[c].free) });
        let changes = pair
            .each_ref()
            .map(|s| if a == c { s.normal_change.as_slice() } else { s.laws[c].change.as_slice() });
        let weights = pair.each_ref().map(|s| if a == c { 1.0 } else { s.beyond.wall });
        Some(Ends { kinds, changes, weights, moving: pair.iter().any(|s| !s.steady) })
    }
}
