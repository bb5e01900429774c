//! Boxes in cells, by size.
use super::BroadPhase;
use super::grid::{Grid, bulk};
use interfaces::Aabb;

/// Classes of sizes, each of a factor of 2, from the largest size downwards; the last one has all smaller ones too.
const CLASSES: usize = 32;
/// What a query of one more level costs, in boxes looked at. With 10 000 boxes, 25 makes lists up to 1.5 times as dear as 80 where all
/// sizes are alike in number, and 80 makes them up to 1.2 times as dear as 25 where they are alike in volume.
const LEVEL_COST: f64 = 50.0;
/// Fewer boxes than these are not worth a second level.
const FEW: usize = 128;

/// Lattices of cells for classes of sizes, each with cells about as large as its boxes (Ogarko & Luding 2012,
/// doi:10.1016/j.cpc.2011.12.019); a query asks all of them. Classes that are not worth a lattice go into that of the next larger one.
///
/// Rebuild O(n) by counting, update O(log n), query O(levels + found) where boxes fill space about evenly; memory O(n)
/// wherever the boxes are. A box that moves far is put aside and looked at by every query; when there are many, all is built anew.
#[derive(Clone, Debug)]
pub struct HierarchicalGrid {
    most_levels: usize,
    levels: Vec<Grid>,
    used: usize,
    level_of: Vec<u16>,
    slots: Vec<u32>,
    /// Numbers by level, and in it cell by cell.
    order: Vec<u32>,
    /// First place of every level in the order.
    firsts: Vec<usize>,
    /// Whether boxes were updated since all was built, so that they need not be where the order says.
    updated: bool,
    /// Where the boxes are put together to build anew.
    scratch: Vec<Aabb>,
}

impl HierarchicalGrid {
    /// Without boxes.
    pub fn new() -> Self {
        Self::with_levels(CLASSES)
    }
    /// With no more levels than these.
    pub(super) fn with_levels(most_levels: usize) -> Self {
        Self {
            most_levels,
            levels: Vec::new(),
            used: 0,
            level_of: Vec::new(),
            slots: Vec::new(),
            order: Vec::new(),
            firsts: Vec::new(),
            updated: false,
            scratch: Vec::new(),
        }
    }

    #[cfg(test)]
    pub(super) fn levels(&self) -> usize {
        self.used
    }

    /// How many boxes a query for a small box looks at, about, beyond those near it.
    pub(super) fn crowding(&self) -> f64 {
        self.levels[..self.used].iter().map(Grid::crowding).sum()
    }

    /// Puts levels in the place of codes of sizes, of which `most` is the highest.
    fn choose_levels(&mut self, most: u16, boxes: &[Aabb]) {
        // Exponents, counted from the largest.
        let class = |code: u16| usize::from((most >> 4) - (code >> 4)).min(CLASSES - 1);
        let (mut count, mut top, mut level) = ([0.0; CLASSES], [0; CLASSES], [0; CLASSES]);
        for code in &self.level_of {
            let class = class(*code);
            count[class] += 1.0;
            top[class] = top[class].max(*code);
        }
        self.used = 1;
        let last = count.iter().rposition(|c| *c > 0.0).unwrap_or(0);
        if last > 0 {
            let everywhere = ([f64::NEG_INFINITY; 3], [f64::INFINITY; 3]);
            let (low, high) = bulk(&self.order, boxes, everywhere.0, everywhere.1);
            let mut smaller = count[last];
            for c in (0..=last).rev() {
                if c < last && count[c] > 0.0 {
                    // Boxes of this class, and those smaller ones if they are put among them, are asked for in cells as large as this.
                    let size = largest_of(top[c]);
                    let share: f64 = (0..3).map(|a| size / (high[a] - low[a]).max(size)).product();
                    let read = share * (4.0 * count[c] + 2.5 * smaller);
                    if read > LEVEL_COST && self.used < self.most_levels {
                        self.used += 1;
                        smaller = 0.0;
                    }
                    smaller += count[c];
                }
                level[c] = self.used as u16 - 1;
            }
        }
        self.level_of.iter_mut().for_each(|code| *code = level[class(*code)]);
    }
}

/// Largest extent.
fn size(b: &Aabb) -> f64 {
    (b.max.x - b.min.x).max(b.max.y - b.min.y).max(b.max.z - b.min.z)
}

/// Exponent and first four digits of a size.
fn code(b: &Aabb) -> u16 {
    (size(b).to_bits() >> 48) as u16
}

/// The size that none of this code reaches.
fn largest_of(code: u16) -> f64 {
    f64::from_bits((u64::from(code) + 1) << 48)
}

impl Default for HierarchicalGrid {
    fn default() -> Self {
        Self::new()
    }
}

impl BroadPhase for HierarchicalGrid {
    fn boxed(&self) -> Box<dyn BroadPhase> {
        Box::new(self.clone())
    }
    fn rebuild(&mut self, boxes: &[Aabb]) {
        let n = boxes.len();
        self.slots.resize(n, 0);
        self.order.clear();
        self.order.extend(0..n as u32);
        self.level_of.clear();
        self.used = 1;
        if self.most_levels == 1 || n < FEW {
            self.level_of.resize(n, 0);
        } else {
            let mut most = 0;
            self.level_of.extend(boxes.iter().map(|b| {
                let code = code(b);
                most = most.max(code);
                code
            }));
            self.choose_levels(most, boxes);
        }
        if self.levels.len() < self.used {
            self.levels.resize_with(self.used, Grid::default);
        }
        self.firsts.clear();
        self.updated = false;
        let mut done = 0;
        if self.used > 1 {
            let mut starts = [0; CLASSES + 1];
            self.level_of.iter().for_each(|l| starts[usize::from(*l) + 1] += 1);
            for l in 0..self.used {
                starts[l + 1] += starts[l];
            }
            for (i, l) in self.level_of.iter().enumerate() {
                let at = &mut starts[usize::from(*l)];
                self.order[*at] = i as u32;
                *at += 1;
            }
        }
        for l in 0..self.used {
            let left = &self.order[done..];
            let here = left.iter().take_while(|i| usize::from(self.level_of[**i as usize]) == l).count();
            self.levels[l].rebuild(&left[..here], boxes, &mut self.slots);
            self.order[done..done + here].copy_from_slice(self.levels[l].ids());
            self.firsts.push(done);
            done += here;
        }
    }

    fn update(&mut self, i: usize, to: &Aabb) {
        let level = usize::from(self.level_of[i]);
        self.updated = true;
        let holds = self.levels[level].holds(size(to));
        self.levels[level].update(i, &mut self.slots[i], to);
        let moved: usize = self.levels[..self.used].iter().map(Grid::moved).sum();
        if moved * moved > self.slots.len() + 64 || !holds {
            let mut boxes = std::mem::take(&mut self.scratch);
            boxes.resize(self.slots.len(), *to);
            self.levels[..self.used].iter().for_each(|l| l.give_back(&mut boxes));
            self.rebuild(&boxes);
            self.scratch = boxes;
        }
    }

    fn meeting(&self, target: &Aabb, found: &mut Vec<u32>) {
        self.levels[..self.used].iter().for_each(|l| l.meeting(target, found));
    }

    fn order(&self) -> &[u32] {
        &self.order
    }

    /// The smaller finds the larger, which are in fewer cells; among like sizes the earlier finds the later.
    fn partners(&self, place: usize, target: &Aabb, found: &mut Vec<u32>) {
        if self.updated {
            return super::higher_partners(self, place, target, found);
        }
        let level = self.firsts.partition_point(|f| *f <= place) - 1;
        self.levels[level].later(place - self.firsts[level], target, found);
        self.levels[level + 1..self.used].iter().for_each(|l| l.meeting(target, found));
    }
}
