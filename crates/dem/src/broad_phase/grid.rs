//! One lattice of cells.
use super::meet;
use interfaces::{Aabb, Point};
use std::ops::Range;

/// Edges of a cell in units of the largest extent. Cells along x follow one another in memory, so a row of them is read
/// in one go however many they are.
const EDGES: [f64; 3] = [0.5, 1.0, 1.0];
/// At most so many cells per box, and a few.
const CELLS_PER_BOX: usize = 16;
/// How far a box may leave its cell before it is taken out of it, in units of the cell's edge.
const SLACK: f64 = 0.25;
/// The slot of a box that was taken out: it says where in `moved`.
const MOVED: u32 = 1 << 31;

/// Boxes binned by their lower corners; those of a cell, and those of a row of cells along x, are one run of memory.
///
/// Every lower corner has a cell by a function that is monotone in each coordinate, also as rounded, and that takes what is outside of the
/// lattice to its border: so a query reads all cells from that of the lowest corner that could belong to a box it meets to that of the highest.
#[derive(Clone, Debug, Default)]
pub(super) struct Grid {
    origin: [f64; 3],
    per_length: [f64; 3],
    cells: [usize; 3],
    /// Largest extents, rounded up.
    reach: [f64; 3],
    /// How far lower corners may be outside of their cells; 0 until one is.
    slack: [f64; 3],
    /// Hull of the lower corners.
    lowest: [f64; 3],
    highest: [f64; 3],
    /// First slot of every cell, and one more.
    starts: Vec<u32>,
    boxes: Vec<Aabb>,
    ids: Vec<u32>,
    /// Boxes that are far from their old cells, in no order.
    moved: Vec<(Aabb, u32)>,
    cell_of: Vec<u32>,
}

impl Grid {
    /// Takes the boxes `members` (some), and tells `slots` where each of them is.
    pub(super) fn rebuild(&mut self, members: &[u32], boxes: &[Aabb], slots: &mut [u32]) {
        let (mut lowest, mut highest) =
            (Point::from([f64::INFINITY; 3]), Point::from([f64::NEG_INFINITY; 3]));
        let mut reach = [0.0; 3];
        for &i in members {
            let b = &boxes[i as usize];
            (lowest, highest) = (lowest.inf(&b.min), highest.sup(&b.min));
            for a in 0..3 {
                reach[a] = f64::max(reach[a], b.max[a] - b.min[a]);
            }
        }
        self.reach = reach.map(|r| r * (1.0 + 4.0 * f64::EPSILON));
        (self.slack, self.lowest, self.highest) = ([0.0; 3], lowest.into(), highest.into());
        self.moved.clear();
        self.lay(members, boxes);
        self.sort(members, boxes, slots);
    }

    /// Chooses the cells.
    fn lay(&mut self, members: &[u32], boxes: &[Aabb]) {
        let most = (CELLS_PER_BOX * members.len() + 64).min(1 << 30);
        (self.origin, self.cells) = (self.lowest, [1; 3]);
        let mut high = self.highest;
        if members.len() > 4 {
            let wanted: f64 = (0..3).map(|a| self.wanted_cells(a, high[a])).product();
            if wanted > most as f64 {
                // A few stray boxes do not make the cells of all others large: they belong to the border.
                (self.origin, high) = bulk(members, boxes, self.lowest, self.highest);
            }
            let mut wanted = [0, 1, 2].map(|a| self.wanted_cells(a, high[a]).min(most as f64));
            while wanted.iter().product::<f64>() > most as f64 {
                let axes = wanted.iter().filter(|w| **w > 1.0).count() as f64;
                let shrink = (most as f64 / wanted.iter().product::<f64>()).powf(1.0 / axes).min(0.95);
                wanted = wanted.map(|w| (w * shrink).floor().max(1.0));
            }
            self.cells = wanted.map(|w| w as usize);
        }
        for a in 0..3 {
            let span = high[a] - self.origin[a];
            self.per_length[a] = if span > 0.0 { self.cells[a] as f64 / span } else { 0.0 };
        }
    }

    fn wanted_cells(&self, axis: usize, high: f64) -> f64 {
        let span = high - self.origin[axis];
        if span > 0.0 { (span / (EDGES[axis] * self.reach[axis])).floor().max(1.0) } else { 1.0 }
    }

    /// Sorts by counting.
    fn sort(&mut self, members: &[u32], boxes: &[Aabb], slots: &mut [u32]) {
        let cells = self.cells.iter().product::<usize>();
        self.starts.clear();
        self.starts.resize(cells + 1, 0);
        self.cell_of.clear();
        for &i in members {
            let [x, y, z] = self.cell(boxes[i as usize].min.into());
            let cell = (z * self.cells[1] + y) * self.cells[0] + x;
            self.starts[cell] += 1;
            self.cell_of.push(cell as u32);
        }
        let mut sum = 0;
        for start in &mut self.starts {
            sum += *start;
            *start = sum;
        }
        let empty = Aabb { min: Point::origin(), max: Point::origin() };
        self.boxes.resize(members.len(), empty);
        self.ids.resize(members.len(), 0);
        // Backwards, so that the starts end up at the starts, and boxes of a cell in ascending order.
        for (&i, &cell) in members.iter().zip(&self.cell_of).rev() {
            let start = &mut self.starts[cell as usize];
            *start -= 1;
            self.boxes[*start as usize] = boxes[i as usize];
            self.ids[*start as usize] = i;
            slots[i as usize] = *start;
        }
    }

    #[inline]
    fn cell(&self, corner: [f64; 3]) -> [usize; 3] {
        [self.cell_along(0, corner[0]), self.cell_along(1, corner[1]), self.cell_along(2, corner[2])]
    }

    #[inline]
    fn cell_along(&self, a: usize, x: f64) -> usize {
        let place = ((x - self.origin[a]) * self.per_length[a]) as i32;
        place.clamp(0, self.cells[a] as i32 - 1) as usize
    }

    /// Box `i` in `slot` is another one now, which is no larger than [`Self::holds`] allows.
    pub(super) fn update(&mut self, i: usize, slot: &mut u32, to: &Aabb) {
        for a in 0..3 {
            self.reach[a] = self.reach[a].max((to.max[a] - to.min[a]) * (1.0 + 4.0 * f64::EPSILON));
            self.lowest[a] = self.lowest[a].min(to.min[a]);
            self.highest[a] = self.highest[a].max(to.min[a]);
        }
        if *slot & MOVED != 0 {
            self.moved[(*slot & !MOVED) as usize].0 = *to;
            return;
        }
        let at = *slot as usize;
        let cell = self.starts.partition_point(|s| *s as usize <= at) - 1;
        let [nx, ny, _] = self.cells;
        let old = [cell % nx, cell / nx % ny, cell / nx / ny];
        let slack = self.per_length.map(|p| if p > 0.0 { SLACK / p } else { 0.0 });
        let from = self.cell([0, 1, 2].map(|a| to.min[a] - slack[a]));
        let upto = self.cell([0, 1, 2].map(|a| to.min[a] + slack[a]));
        if (0..3).all(|a| from[a] <= old[a] && old[a] <= upto[a]) {
            if self.cell(to.min.into()) != old {
                self.slack = slack;
            }
            self.boxes[at] = *to;
        } else {
            // Nothing meets what is left.
            self.boxes[at] = Aabb { min: [f64::INFINITY; 3].into(), max: [f64::NEG_INFINITY; 3].into() };
            *slot = MOVED | self.moved.len() as u32;
            self.moved.push((*to, i as u32));
        }
    }

    /// Whether a box of this largest extent fits in without making every query much larger.
    pub(super) fn holds(&self, size: f64) -> bool {
        size <= 1.25 * self.reach.iter().fold(0.0, |m: f64, r| m.max(*r))
    }

    /// How many boxes are out of order.
    pub(super) fn moved(&self) -> usize {
        self.moved.len()
    }

    /// Numbers of the boxes, cell by cell, as last built.
    pub(super) fn ids(&self) -> &[u32] {
        &self.ids
    }

    /// Puts all boxes where their numbers say.
    pub(super) fn give_back(&self, boxes: &mut [Aabb]) {
        for (b, i) in self.boxes.iter().zip(&self.ids) {
            boxes[*i as usize] = *b;
        }
        for (b, i) in &self.moved {
            boxes[*i as usize] = *b;
        }
    }

    /// Sum over the cells of the boxes in them squared, per box: how many a query of one cell would look at.
    pub(super) fn crowding(&self) -> f64 {
        let squares = self.starts.windows(2).map(|w| f64::from(w[1] - w[0]).powi(2)).sum::<f64>();
        squares / self.ids.len().max(1) as f64
    }

    /// Appends the numbers of the boxes that meet `target`.
    #[inline]
    pub(super) fn meeting(&self, target: &Aabb, found: &mut Vec<u32>) {
        for (b, i) in &self.moved {
            if meet(b, target) {
                found.push(*i);
            }
        }
        let (mut low, mut high) = (self.from(target), [target.max.x, target.max.y, target.max.z]);
        if (0..3).any(|a| low[a] > self.highest[a] || high[a] < self.lowest[a]) {
            return;
        }
        for a in 0..3 {
            low[a] -= self.slack[a];
            high[a] += self.slack[a];
        }
        let ([x0, y0, z0], [x1, y1, z1]) = (self.cell(low), self.cell(high));
        let mut end = found.len();
        for z in z0..=z1 {
            for y in y0..=y1 {
                self.read(self.run(z, y, x0, x1), target, found, &mut end);
            }
        }
        found.truncate(end);
    }

    /// Appends the numbers of the boxes that meet `target`, the one in this `slot`, and come after it: in its row of cells those in later slots,
    /// and all in later rows. Not after an update.
    #[inline]
    pub(super) fn later(&self, slot: usize, target: &Aabb, found: &mut Vec<u32>) {
        let ([x0, y0, _], [x1, y1, z1]) = (self.cell(self.from(target)), self.cell(target.max.into()));
        let [_, y, z] = self.cell(target.min.into());
        let mut end = found.len();
        self.read(slot + 1..self.run(z, y, x0, x1).end, target, found, &mut end);
        for y in y + 1..=y1 {
            self.read(self.run(z, y, x0, x1), target, found, &mut end);
        }
        for z in z + 1..=z1 {
            for y in y0..=y1 {
                self.read(self.run(z, y, x0, x1), target, found, &mut end);
            }
        }
        found.truncate(end);
    }

    /// The lowest a lower corner can be of a box that meets `target`.
    #[inline]
    fn from(&self, target: &Aabb) -> [f64; 3] {
        // The difference is rounded.
        let from = |a: usize| target.min[a] - self.reach[a] - 4.0 * f64::EPSILON * target.min[a].abs();
        [from(0), from(1), from(2)]
    }

    /// The slots of a run of cells.
    #[inline]
    fn run(&self, z: usize, y: usize, x0: usize, x1: usize) -> Range<usize> {
        let row = (z * self.cells[1] + y) * self.cells[0];
        self.starts[row + x0] as usize..self.starts[row + x1 + 1] as usize
    }

    /// Writes those that meet `target` at `end`, which goes on.
    #[inline]
    fn read(&self, run: Range<usize>, target: &Aabb, found: &mut Vec<u32>, end: &mut usize) {
        // Every number is written, and kept if it counts: which do cannot be foretold, and a branch foretold wrongly
        // costs more than all comparisons.
        if found.len() < *end + run.len() {
            found.resize(*end + run.len() + 64, 0);
        }
        for (b, i) in self.boxes[run.clone()].iter().zip(&self.ids[run]) {
            found[*end] = *i;
            *end += usize::from(meet(b, target));
        }
    }
}

/// The hull of most lower corners, from a sample, a quarter wider.
pub(super) fn bulk(
    members: &[u32],
    boxes: &[Aabb],
    lowest: [f64; 3],
    highest: [f64; 3],
) -> ([f64; 3], [f64; 3]) {
    const SAMPLE: usize = 128;
    let (mut low, mut high) = (lowest, highest);
    let count = members.len().min(SAMPLE);
    for a in 0..3 {
        let mut sample = [0.0; SAMPLE];
        for (k, s) in sample[..count].iter_mut().enumerate() {
            *s = boxes[members[k * members.len() / count] as usize].min[a];
        }
        let sample = &mut sample[..count];
        sample.sort_unstable_by(f64::total_cmp);
        let (first, last) = (sample[count / 32], sample[count - 1 - count / 32]);
        low[a] = low[a].max(first - 0.125 * (last - first));
        high[a] = high[a].min(last + 0.125 * (last - first));
    }
    (low, high)
}
