//! Boxes in cells, by size.
use super::BroadPhase;
use super::grid::Grid;
use interfaces::Aabb;

/// Boxes are of one class of sizes if their largest extents agree to a factor of 2.
const CLASSES: usize = 2048;

/// One lattice of cells for every class of sizes, each with cells about as large as its boxes (Ogarko & Luding 2012,
/// doi:10.1016/j.cpc.2011.12.019); a query asks all of them. Classes with few boxes go into the next larger one.
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

    /// How many boxes a query for a small box looks at, about, beyond those near it.
    pub(super) fn crowding(&self) -> f64 {
        self.levels[..self.used].iter().map(Grid::crowding).sum()
    }

    /// Gives every class a level; `count` tells how many boxes a class has.
    fn choose_levels(&mut self, count: &[u32; CLASSES]) -> [u16; CLASSES] {
        let mut level = [0; CLASSES];
        let (mut now, mut held, mut first) = (0, 0, usize::MAX);
        for class in (0..CLASSES).filter(|c| count[*c] > 0) {
            let near = first == usize::MAX || class - first < SPAN;
            if held > 0 && !near && held > MERGE * count[class] && now + 1 < self.most_levels {
                (now, held, first) = (now + 1, 0, usize::MAX);
            }
            first = first.min(class);
            held += count[class];
            level[class] = now as u16;
        }
        self.used = now + 1;
        level
    }
}
/// A level spans so many classes at least.
const SPAN: usize = 1;
/// Smaller boxes get a level of their own if they are more than so many times those of the next class.
const MERGE: u32 = 1;

/// Largest extent.
fn size(b: &Aabb) -> f64 {
    (b.max.x - b.min.x).max(b.max.y - b.min.y).max(b.max.z - b.min.z)
}

/// The exponent of a size.
fn class(size: f64) -> usize {
    (size.to_bits() >> 52) as usize % CLASSES
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
        self.order.resize(n, 0);
        self.level_of.clear();
        if self.most_levels == 1 {
            self.used = 1;
            self.level_of.resize(n, 0);
        } else {
            let mut count = [0; CLASSES];
            self.level_of.extend(boxes.iter().map(|b| {
                let class = class(size(b));
                count[class] += 1;
                class as u16
            }));
            let level = self.choose_levels(&count);
            self.level_of.iter_mut().for_each(|c| *c = level[usize::from(*c)]);
        }
        if self.levels.len() < self.used {
            self.levels.resize_with(self.used, Grid::default);
        }
        self.firsts.clear();
        self.updated = false;
        let mut done = 0;
        if self.used == 1 {
            self.order.iter_mut().enumerate().for_each(|(i, o)| *o = i as u32);
        } else {
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
