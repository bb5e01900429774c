//! The list of pairs that may touch soon.
mod listing;
mod near_pair;

pub use near_pair::NearPair;

use super::images::Images;
use super::{Automatic, BroadPhase, PairListError};
use interfaces::{Aabb, Periods};
use listing::{Listing, Sorting};
use near_pair::Key;

/// From this number of bodies on, threads are worth their while.
#[cfg(feature = "parallel")]
const MANY: usize = 4096;
/// All is listed anew if more than one in so many bodies changed.
const ANEW: usize = 8;

/// Lists the pairs of bodies whose boxes meet, with all their images, and keeps the list up to date. Time per body: see [`Automatic`].
///
/// [`Self::list`] takes what the broad phase takes, and O(n + pairs): the pairs come in the order of space, are counted out to their first
/// bodies, and each body's few are sorted. [`Self::refresh`] asks for the changed bodies only and merges what they meet into the
/// list, O(changed log changed + pairs). Once warm neither allocates, but for the nodes of [`RTree`](crate::RTree) and what rayon needs for its tasks.
///
/// The list is a function of the boxes alone: neither the broad phase nor the number of threads nor what was listed
/// before changes a bit of it. A pair meets if the boxes, moved by whole periods so that their centres are between 0 and one period, share a
/// point, as rounded there.
#[derive(Clone, Debug)]
pub struct PairList {
    images: Images,
    broad_phase: Box<dyn BroadPhase>,
    parallel: bool,
    pairs: Vec<NearPair>,
    movable: Vec<bool>,
    sorting: Sorting,
    /// For [`Self::refresh`]: the next list, what is new in it, which bodies changed, what one of them meets.
    next: Vec<NearPair>,
    fresh: Vec<NearPair>,
    changed: Vec<bool>,
    found: Vec<u32>,
}

impl PairList {
    /// An empty list for space with these periods; the broad phase picks its way.
    pub fn new(periods: Periods) -> Self {
        Self::with_broad_phase(periods, Box::new(Automatic::new()))
    }

    /// An empty list that is made by this broad phase.
    pub fn with_broad_phase(periods: Periods, broad_phase: Box<dyn BroadPhase>) -> Self {
        Self {
            images: Images::new(&periods),
            broad_phase,
            parallel: true,
            pairs: Vec::new(),
            movable: Vec::new(),
            sorting: Sorting::default(),
            next: Vec::new(),
            fresh: Vec::new(),
            changed: Vec::new(),
            found: Vec::new(),
        }
    }

    /// Without threads of its own, however many bodies there are.
    pub fn serial(mut self) -> Self {
        self.parallel = false;
        self
    }

    /// The pairs, ascending by (a, b, image), each image once: a < b, or a body with its own image, of which only those count whose
    /// first number other than 0 is positive.
    pub fn pairs(&self) -> &[NearPair] {
        &self.pairs
    }

    /// Lists anew.
    ///
    /// `boxes`: where bodies are, already grown by how far they may go, unwrapped: bodies in periodic space run on and may be many periods
    /// away from one another. Pairs of two that are not `movable` are left out. If something is wrong with the boxes, the list stays what it was.
    pub fn list(&mut self, boxes: &[Aabb], movable: &[bool]) -> Result<(), PairListError> {
        self.check(boxes.len(), movable)?;
        for (i, b) in boxes.iter().enumerate() {
            self.check_box(i, b)?;
        }
        self.list_checked(boxes, movable);
        Ok(())
    }

    /// Lists boxes of which only those of the bodies `changed` are others than at the last call. Bodies that became movable, or no longer are, need
    /// not be named.
    pub fn refresh(
        &mut self,
        boxes: &[Aabb],
        movable: &[bool],
        changed: &[u32],
    ) -> Result<(), PairListError> {
        if self.movable.len() != boxes.len() || self.movable != movable {
            return self.list(boxes, movable);
        }
        for &i in changed {
            let b = boxes.get(i as usize).ok_or(PairListError::Changed { body: i, boxes: boxes.len() })?;
            self.check_box(i as usize, b)?;
        }
        if changed.len() > boxes.len() / ANEW {
            self.list_checked(boxes, movable);
        } else if !changed.is_empty() {
            self.list_changed(boxes, changed);
        }
        Ok(())
    }

    fn check(&self, boxes: usize, movable: &[bool]) -> Result<(), PairListError> {
        if boxes != movable.len() {
            return Err(PairListError::Movable { boxes, movable: movable.len() });
        }
        if boxes >= 1 << 31 {
            return Err(PairListError::TooMany { boxes });
        }
        self.images.check()
    }

    #[inline]
    fn check_box(&self, body: usize, b: &Aabb) -> Result<(), PairListError> {
        let in_order = (0..3).all(|a| b.min[a] <= b.max[a] && b.min[a].abs() < f64::INFINITY);
        if !(in_order && b.max.iter().all(|x| x.abs() < f64::INFINITY)) {
            return Err(PairListError::Box { body, min: b.min.into(), max: b.max.into() });
        }
        if self.images.any() { self.images.check_box(body, b) } else { Ok(()) }
    }

    fn list_checked(&mut self, boxes: &[Aabb], movable: &[bool]) {
        self.movable.clear();
        self.movable.extend_from_slice(movable);
        let boxes = if self.images.any() {
            self.images.start();
            boxes.iter().for_each(|b| self.images.push(b));
            &self.images.wrapped
        } else {
            boxes
        };
        self.broad_phase.rebuild(boxes);
        let listing = Listing { broad_phase: &*self.broad_phase, images: &self.images, boxes, movable };
        #[cfg(feature = "parallel")]
        let parallel = self.parallel && boxes.len() >= MANY && rayon::current_num_threads() > 1;
        #[cfg(not(feature = "parallel"))]
        let parallel = false;
        listing.list(parallel, &mut self.sorting, &mut self.pairs);
    }

    /// Finds the pairs of the changed bodies and puts them in the place of those that these bodies had.
    fn list_changed(&mut self, boxes: &[Aabb], changed: &[u32]) {
        self.changed.clear();
        self.changed.resize(boxes.len(), false);
        let periodic = self.images.any();
        for &i in changed {
            let i = i as usize;
            self.changed[i] = true;
            if periodic {
                self.images.set(i, &boxes[i]);
            }
            self.broad_phase.update(i, if periodic { &self.images.wrapped[i] } else { &boxes[i] });
        }
        let boxes = if periodic { &self.images.wrapped } else { boxes };
        let movable = &self.movable;
        let listing = Listing { broad_phase: &*self.broad_phase, images: &self.images, boxes, movable };
        self.fresh.clear();
        for &i in changed {
            listing.all_of(i, &mut self.found, &mut self.fresh);
        }
        self.fresh.sort_unstable();
        // Of two that changed each has found the other, and a body may be named twice.
        self.fresh.dedup();
        self.next.clear();
        let mut fresh = self.fresh.iter().peekable();
        for p in &self.pairs {
            if self.changed[p.a as usize] || self.changed[p.b as usize] {
                continue;
            }
            while let Some(f) = fresh.next_if(|f| *f < p) {
                self.next.push(*f);
            }
            self.next.push(*p);
        }
        self.next.extend(fresh);
        std::mem::swap(&mut self.pairs, &mut self.next);
    }
}
