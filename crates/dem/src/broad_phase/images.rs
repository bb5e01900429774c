//! Boxes in space that repeats.
use super::{PairListError, meet};
use interfaces::{Aabb, Periods, Vector};

/// Longest box, in periods.
const LONGEST: f64 = 250.0;
/// Farthest box, in periods.
const FARTHEST: f64 = (1 << 29) as f64;

/// Boxes moved by whole periods so that their centres are in the base cell, and how far each was moved.
#[derive(Clone, Debug)]
pub(super) struct Images {
    lengths: Vector,
    repeats: [bool; 3],
    pub(super) wrapped: Vec<Aabb>,
    /// Whole periods that were taken off.
    pub(super) shifts: Vec<[i32; 3]>,
    /// Around all that were wrapped since the last [`Self::start`].
    hull: Aabb,
}

impl Images {
    pub(super) fn new(periods: &Periods) -> Self {
        let lengths = Vector::from_fn(|a, _| periods.along(a).unwrap_or(0.0));
        let repeats = [0, 1, 2].map(|a| periods.along(a).is_some());
        Self { lengths, repeats, wrapped: Vec::new(), shifts: Vec::new(), hull: Self::nowhere() }
    }

    fn nowhere() -> Aabb {
        Aabb { min: [f64::INFINITY; 3].into(), max: [f64::NEG_INFINITY; 3].into() }
    }

    /// Whether space repeats at all.
    pub(super) fn any(&self) -> bool {
        self.repeats.contains(&true)
    }

    /// Whether all periods are lengths.
    pub(super) fn check(&self) -> Result<(), PairListError> {
        match (0..3).find(|a| self.repeats[*a] && !(self.lengths[*a] > 0.0 && self.lengths[*a].is_finite())) {
            Some(axis) => Err(PairListError::Period { axis, period: self.lengths[axis] }),
            None => Ok(()),
        }
    }

    /// Whether the images of this box can be counted.
    pub(super) fn check_box(&self, body: usize, b: &Aabb) -> Result<(), PairListError> {
        for axis in (0..3).filter(|a| self.repeats[*a]) {
            let (size, period) = (b.max[axis] - b.min[axis], self.lengths[axis]);
            if size > LONGEST * period {
                return Err(PairListError::Size { body, axis, size, period });
            }
            let periods = self.period_of(b, axis);
            if periods.abs() > FARTHEST {
                return Err(PairListError::Far { body, axis, periods });
            }
        }
        Ok(())
    }

    /// Which period the box's centre is in.
    fn period_of(&self, b: &Aabb, axis: usize) -> f64 {
        ((0.5 * b.min[axis] + 0.5 * b.max[axis]) / self.lengths[axis]).floor()
    }

    /// Forgets all boxes.
    pub(super) fn start(&mut self) {
        self.wrapped.clear();
        self.shifts.clear();
        self.hull = Self::nowhere();
    }

    /// Adds a box.
    pub(super) fn push(&mut self, b: &Aabb) {
        let (wrapped, shift) = self.wrap(b);
        self.wrapped.push(wrapped);
        self.shifts.push(shift);
    }

    /// Box `i` is another one now.
    pub(super) fn set(&mut self, i: usize, b: &Aabb) {
        (self.wrapped[i], self.shifts[i]) = self.wrap(b);
    }

    fn wrap(&mut self, b: &Aabb) -> (Aabb, [i32; 3]) {
        let (mut wrapped, mut shift) = (*b, [0; 3]);
        for a in (0..3).filter(|a| self.repeats[*a]) {
            let periods = self.period_of(b, a);
            shift[a] = periods as i32;
            wrapped.min[a] -= periods * self.lengths[a];
            wrapped.max[a] -= periods * self.lengths[a];
        }
        self.hull.min = self.hull.min.inf(&wrapped.min);
        self.hull.max = self.hull.max.sup(&wrapped.max);
        (wrapped, shift)
    }

    /// All images `k` for which some box could meet `target` when it is moved by `k` periods: from, to.
    pub(super) fn range(&self, target: &Aabb) -> [[i32; 2]; 3] {
        [0, 1, 2].map(|a| {
            if !self.repeats[a] {
                return [0, 0];
            }
            // The quotients are rounded; no more than 500, though.
            let from = (target.min[a] - self.hull.max[a]) / self.lengths[a] - 1e-9;
            let upto = (target.max[a] - self.hull.min[a]) / self.lengths[a] + 1e-9;
            [from.ceil() as i32, upto.floor() as i32]
        })
    }

    /// What boxes have to meet that may meet `target` once they are moved by `k` periods; a little more.
    pub(super) fn moved_back(&self, target: &Aabb, k: [i32; 3]) -> Aabb {
        let by = self.distance(k);
        let (mut min, mut max) = (target.min - by, target.max - by);
        for a in 0..3 {
            min[a] -= 8.0 * f64::EPSILON * (target.min[a].abs() + by[a].abs());
            max[a] += 8.0 * f64::EPSILON * (target.max[a].abs() + by[a].abs());
        }
        Aabb { min, max }
    }

    /// Whether wrapped box `b`, moved by `k` periods, meets wrapped box `a`. The one place that decides it, so that it does not matter
    /// which of the two was asked for the other.
    pub(super) fn meet(&self, a: usize, b: usize, k: [i32; 3]) -> bool {
        let by = self.distance(k);
        let b = &self.wrapped[b];
        meet(&self.wrapped[a], &Aabb { min: b.min + by, max: b.max + by })
    }

    fn distance(&self, k: [i32; 3]) -> Vector {
        Vector::from_fn(|a, _| f64::from(k[a]) * self.lengths[a])
    }
}
