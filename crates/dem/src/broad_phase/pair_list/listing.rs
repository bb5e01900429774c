//! One listing of all pairs.
use super::super::BroadPhase;
use super::super::images::Images;
use super::{Key, NearPair};
use interfaces::Aabb;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering::Relaxed};

/// Bodies that a thread lists in one go.
#[cfg(feature = "parallel")]
const CHUNK: usize = 512;

/// What pairs are listed from.
pub(super) struct Listing<'a> {
    pub(super) broad_phase: &'a dyn BroadPhase,
    pub(super) images: &'a Images,
    /// Wrapped if space repeats.
    pub(super) boxes: &'a [Aabb],
    pub(super) movable: &'a [bool],
}

/// Memory for a listing, in three steps: pairs as they are found, going through space; the same by their first body; in order.
#[derive(Debug, Default)]
pub(super) struct Sorting {
    chunks: Vec<Chunk>,
    /// How many pairs every body is the first of; then where the next of them goes, and in the end where they end.
    cursors: Vec<AtomicUsize>,
    /// The pairs by their first bodies. Atomic because threads fill it together; each entry is written once.
    keys: Vec<AtomicU64>,
}

/// A copy starts with memory of its own: nothing is remembered here.
impl Clone for Sorting {
    fn clone(&self) -> Self {
        Self::default()
    }
}

#[derive(Clone, Debug, Default)]
struct Chunk {
    found: Vec<u32>,
    pairs: Vec<(u32, Key)>,
}

impl Listing<'_> {
    /// Puts all pairs in order.
    pub(super) fn list(&self, parallel: bool, memory: &mut Sorting, pairs: &mut Vec<NearPair>) {
        let n = self.boxes.len();
        memory.cursors.resize_with(n, AtomicUsize::default);
        memory.cursors.iter_mut().for_each(|c| *c.get_mut() = 0);
        #[cfg(feature = "parallel")]
        if parallel {
            return self.list_in_parallel(memory, pairs);
        }
        debug_assert!(!parallel);
        let Sorting { chunks, cursors, keys } = memory;
        chunks.resize_with(1, Chunk::default);
        self.fill(0..n, &mut chunks[0]);
        chunks[0].pairs.iter().for_each(|(a, _)| *cursors[*a as usize].get_mut() += 1);
        let total = start_cursors(cursors);
        keys.resize_with(total, AtomicU64::default);
        for (a, key) in &chunks[0].pairs {
            let cursor = cursors[*a as usize].get_mut();
            *keys[*cursor].get_mut() = key.0;
            *cursor += 1;
        }
        pairs.clear();
        let mut start = 0;
        for (a, cursor) in cursors.iter_mut().enumerate() {
            let end = *cursor.get_mut();
            sorted(&mut keys[start..end], |key| pairs.push(self.pair(a as u32, key)));
            start = end;
        }
    }

    #[cfg(feature = "parallel")]
    fn list_in_parallel(&self, memory: &mut Sorting, pairs: &mut Vec<NearPair>) {
        use rayon::prelude::*;
        let n = self.boxes.len();
        let Sorting { chunks, cursors, keys } = memory;
        chunks.resize_with(n.div_ceil(CHUNK), Chunk::default);
        chunks.par_iter_mut().enumerate().for_each(|(c, chunk)| {
            self.fill(c * CHUNK..n.min((c + 1) * CHUNK), chunk);
            chunk.pairs.iter().for_each(|(a, _)| _ = cursors[*a as usize].fetch_add(1, Relaxed));
        });
        let total = start_cursors(cursors);
        keys.resize_with(total, AtomicU64::default);
        chunks.par_iter().for_each(|chunk| {
            let put = |(a, key): &(u32, Key)| {
                keys[cursors[*a as usize].fetch_add(1, Relaxed)].store(key.0, Relaxed)
            };
            chunk.pairs.iter().for_each(put);
        });
        pairs.resize(total, NearPair { a: 0, b: 0, image: [0; 3] });
        // In parts of some bodies each: what is left to be cut off, and where it starts.
        let (mut pairs, mut keys, mut from) = (&mut pairs[..], &mut keys[..], 0);
        let parts: Vec<_> = (cursors.chunks_mut(CHUNK).enumerate())
            .map(|(c, ends)| {
                let (start, end) = (from, ends.last_mut().map_or(from, |end| *end.get_mut()));
                let (these, rest) = std::mem::take(&mut pairs).split_at_mut(end - start);
                let (its, others) = std::mem::take(&mut keys).split_at_mut(end - start);
                (pairs, keys, from) = (rest, others, end);
                (c * CHUNK, start, ends, these, its)
            })
            .collect();
        parts.into_par_iter().for_each(|(first, from, ends, pairs, keys)| {
            let (mut start, mut places) = (0, pairs.iter_mut());
            for (i, end) in ends.iter_mut().enumerate() {
                let end = *end.get_mut() - from;
                let body = (first + i) as u32;
                sorted(&mut keys[start..end], |key| {
                    if let Some(place) = places.next() {
                        *place = self.pair(body, key);
                    }
                });
                start = end;
            }
        });
    }

    /// Finds the pairs of the bodies at these places of the order.
    fn fill(&self, places: std::ops::Range<usize>, chunk: &mut Chunk) {
        let order = self.broad_phase.order();
        let Chunk { found, pairs } = chunk;
        pairs.clear();
        for place in places {
            let i = order.get(place).map_or(place as u32, |id| *id);
            let target = &self.boxes[i as usize];
            found.clear();
            self.broad_phase.partners(place, target, found);
            let here = |j: &u32| (i.min(*j), Key::new(i.max(*j), [0; 3]));
            if self.movable[i as usize] {
                pairs.extend(found.iter().map(here));
            } else {
                pairs.extend(found.iter().filter(|j| self.movable[**j as usize]).map(here));
            }
            if self.images.any() {
                self.for_images(i, |k| self.partners_in(i, k, found, pairs));
            }
        }
    }

    /// Appends those pairs of which `a` is the first and the second is `k` periods away.
    fn partners_in(&self, a: u32, k: [i32; 3], found: &mut Vec<u32>, pairs: &mut Vec<(u32, Key)>) {
        found.clear();
        self.broad_phase.meeting(&self.images.moved_back(&self.boxes[a as usize], k), found);
        let ordered = |b: u32| b > a || b == a && k > [0; 3];
        let counts =
            |b: &&u32| ordered(**b) && self.movable(a, **b) && self.images.meet(a as usize, **b as usize, k);
        pairs.extend(found.iter().filter(counts).map(|b| (a, Key::new(*b, k))));
    }

    fn movable(&self, a: u32, b: u32) -> bool {
        self.movable[a as usize] || self.movable[b as usize]
    }

    /// Visits all images but that of the base cell in which something could meet body `a`.
    fn for_images(&self, a: u32, mut visit: impl FnMut([i32; 3])) {
        let [x, y, z] = self.images.range(&self.boxes[a as usize]);
        for i in x[0]..=x[1] {
            for j in y[0]..=y[1] {
                for k in z[0]..=z[1] {
                    if [i, j, k] != [0; 3] {
                        visit([i, j, k]);
                    }
                }
            }
        }
    }

    /// Appends all pairs of body `i`.
    pub(super) fn all_of(&self, i: u32, found: &mut Vec<u32>, pairs: &mut Vec<NearPair>) {
        let target = &self.boxes[i as usize];
        found.clear();
        self.broad_phase.meeting(target, found);
        let here = found.iter().filter(|j| **j != i && self.movable(i, **j));
        pairs.extend(here.map(|j| self.pair(i.min(*j), Key::new(i.max(*j), [0; 3]))));
        if !self.images.any() {
            return;
        }
        self.for_images(i, |k| {
            found.clear();
            self.broad_phase.meeting(&self.images.moved_back(target, k), found);
            for &j in found.iter().filter(|j| self.movable(i, **j)) {
                let (a, b, k) = if j < i { (j, i, k.map(|k| -k)) } else { (i, j, k) };
                if (a < b || k > [0; 3]) && self.images.meet(a as usize, b as usize, k) {
                    pairs.push(self.pair(a, Key::new(b, k)));
                }
            }
        });
    }

    #[inline]
    fn pair(&self, a: u32, key: Key) -> NearPair {
        let b = key.partner();
        if !self.images.any() {
            return NearPair { a, b, image: [0; 3] };
        }
        let (of_a, of_b) = (self.images.shifts[a as usize], self.images.shifts[b as usize]);
        let k = key.image();
        NearPair { a, b, image: [0, 1, 2].map(|x| k[x] + of_a[x] - of_b[x]) }
    }
}

/// Makes starts of counts; returns their sum.
fn start_cursors(cursors: &mut [AtomicUsize]) -> usize {
    let mut sum = 0;
    for c in cursors {
        let count = std::mem::replace(c.get_mut(), sum);
        sum += count;
    }
    sum
}

/// Visits different keys in order: a few by counting how many come before each, without branches.
#[inline]
fn sorted(keys: &mut [AtomicU64], mut visit: impl FnMut(Key)) {
    const FEW: usize = 12;
    let count = keys.len();
    if count > FEW {
        keys.sort_unstable_by_key(|k| k.load(Relaxed));
        return keys.iter_mut().for_each(|k| visit(Key(*k.get_mut())));
    }
    let (mut these, mut sorted) = ([0; FEW], [0; FEW]);
    for (to, k) in these.iter_mut().zip(keys) {
        *to = *k.get_mut();
    }
    for k in &these[..count] {
        let before: usize = these[..count].iter().map(|other| usize::from(other < k)).sum();
        sorted[before] = *k;
    }
    sorted[..count].iter().for_each(|k| visit(Key(*k)));
}
