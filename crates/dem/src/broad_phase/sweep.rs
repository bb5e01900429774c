//! Boxes sorted along one axis.
use super::{BroadPhase, meet};
use interfaces::{Aabb, Point};

/// Boxes sorted by where they begin on the axis along which they are spread most: those that meet a target are among
/// those that begin between its end and its beginning less the largest extent. For a few bodies, and for long rows.
///
/// Rebuild O(n log n), update O(n) (a move of memory), query O(log n + those it overlaps on this axis).
#[derive(Clone, Debug, Default)]
pub struct Sweep {
    axis: usize,
    /// Largest extent along the axis, rounded up.
    reach: f64,
    /// Where the boxes begin, in ascending order; a list of its own, so that the search reads little.
    lows: Vec<f64>,
    boxes: Vec<Aabb>,
    ids: Vec<u32>,
    /// Where every box begins, by its number.
    low_of: Vec<f64>,
}

impl Sweep {
    /// Without boxes.
    pub fn new() -> Self {
        Self::default()
    }
    /// Place of the first entry that does not come before (`low`, `id`).
    fn place(&self, low: f64, id: u32) -> usize {
        let mut at = self.lows.partition_point(|l| *l < low);
        while at < self.lows.len() && self.lows[at] == low && self.ids[at] < id {
            at += 1;
        }
        at
    }
}

impl BroadPhase for Sweep {
    fn boxed(&self) -> Box<dyn BroadPhase> {
        Box::new(self.clone())
    }
    fn rebuild(&mut self, boxes: &[Aabb]) {
        self.axis = widest_axis(boxes);
        let axis = self.axis;
        self.low_of.clear();
        self.low_of.extend(boxes.iter().map(|b| b.min[axis]));
        let low_of = &self.low_of;
        // The order of last time is nearly that of this time.
        if self.ids.len() != boxes.len() {
            self.ids.clear();
            self.ids.extend(0..boxes.len() as u32);
        }
        let by_low = |i: &u32, j: &u32| low_of[*i as usize].total_cmp(&low_of[*j as usize]).then(i.cmp(j));
        self.ids.sort_unstable_by(by_low);
        self.lows.clear();
        self.lows.extend(self.ids.iter().map(|i| low_of[*i as usize]));
        self.boxes.clear();
        self.boxes.extend(self.ids.iter().map(|i| boxes[*i as usize]));
        self.reach = boxes.iter().fold(0.0, |r, b| f64::max(r, b.max[axis] - b.min[axis]));
    }
    fn update(&mut self, i: usize, to: &Aabb) {
        let (id, low) = (i as u32, to.min[self.axis]);
        let from = self.place(self.low_of[i], id);
        let mut at = self.place(low, id);
        if at > from {
            at -= 1;
            self.lows[from..=at].rotate_left(1);
            self.boxes[from..=at].rotate_left(1);
            self.ids[from..=at].rotate_left(1);
        } else {
            self.lows[at..=from].rotate_right(1);
            self.boxes[at..=from].rotate_right(1);
            self.ids[at..=from].rotate_right(1);
        }
        (self.lows[at], self.boxes[at], self.ids[at], self.low_of[i]) = (low, *to, id, low);
        self.reach = self.reach.max(to.max[self.axis] - low);
    }
    fn meeting(&self, target: &Aabb, found: &mut Vec<u32>) {
        let (low, high) = (target.min[self.axis], target.max[self.axis]);
        // Extent and difference are rounded.
        let from = low - self.reach - 4.0 * f64::EPSILON * (low.abs() + self.reach);
        let from = self.lows.partition_point(|l| *l < from);
        let here = self.lows[from..].iter().zip(&self.boxes[from..]).zip(&self.ids[from..]);
        let here = here.take_while(|((l, _), _)| **l <= high);
        found.extend(here.filter(|((_, b), _)| meet(b, target)).map(|(_, id)| *id));
    }
    fn order(&self) -> &[u32] {
        &self.ids
    }
}

/// The axis along which the boxes' lower corners are spread most.
fn widest_axis(boxes: &[Aabb]) -> usize {
    let lowest = boxes.iter().fold(Point::from([f64::INFINITY; 3]), |p, b| p.inf(&b.min));
    let highest = boxes.iter().fold(Point::from([f64::NEG_INFINITY; 3]), |p, b| p.sup(&b.min));
    (highest - lowest).imax()
}
