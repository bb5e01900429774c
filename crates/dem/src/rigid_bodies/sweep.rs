//! Going through all bodies.
use super::body::Body;
use super::contacts::{CHUNK, Chunk};
use crate::broad_phase::NearPair;
use interfaces::Wrench;

/// Bodies that a thread takes at a time.
#[cfg(feature = "parallel")]
const BLOCK: usize = 1024;
/// Work, in pairs of balls, from which on threads are worth their while; and that of a pair of other bodies, as little as it may be.
const LITTLE: usize = 8192;
const OF_OTHERS: usize = 16;

/// Is the work on so many pairs worth more than one thread?
pub(super) fn is_shared(pairs: usize, all_round: bool) -> bool {
    let work = pairs * if all_round { 1 } else { OF_OTHERS };
    cfg!(feature = "parallel") && work >= LITTLE && threads() > 1
}

fn threads() -> usize {
    #[cfg(feature = "parallel")]
    return rayon::current_num_threads();
    #[cfg(not(feature = "parallel"))]
    return 1;
}

/// Calls `f` for every body, its number, contact wrench and impulse, if `shared` on as many threads as there are; answers whether it did so for any.
pub(super) fn any(
    shared: bool,
    bodies: &mut [Body],
    contact: &mut [Wrench],
    impulse: &mut [Wrench],
    f: impl Fn(usize, &mut Body, &mut Wrench, &mut Wrench) -> bool + Sync,
) -> bool {
    let block = |first: usize, bodies: &mut [Body], contact: &mut [Wrench], impulse: &mut [Wrench]| {
        let mut any = false;
        for (i, ((body, contact), impulse)) in bodies.iter_mut().zip(contact).zip(impulse).enumerate() {
            any |= f(first + i, body, contact, impulse);
        }
        any
    };
    #[cfg(feature = "parallel")]
    if shared {
        use rayon::prelude::*;
        return bodies
            .par_chunks_mut(BLOCK)
            .zip(contact.par_chunks_mut(BLOCK))
            .zip(impulse.par_chunks_mut(BLOCK))
            .enumerate()
            .map(|(i, ((bodies, contact), impulse))| block(i * BLOCK, bodies, contact, impulse))
            .reduce(|| false, |one, other| one | other);
    }
    let _ = shared;
    block(0, bodies, contact, impulse)
}

/// Where in the chunks is what each body feels, in the order in which one thread adds it up.
#[derive(Clone, Debug, Default)]
pub(super) struct Felt {
    /// Where the entries of each body begin.
    start: Vec<u32>,
    /// Numbers of chunks times [`STRIDE`], and places there.
    entries: Vec<u32>,
}

/// More than the places in a chunk: two of a pair.
const STRIDE: usize = 2 * CHUNK;

impl Felt {
    /// Other pairs are near now.
    pub(super) fn clear(&mut self) {
        self.start.clear();
    }

    /// Finds the places, if that was not done before.
    pub(super) fn list(&mut self, near: &[NearPair], n: usize) {
        let Self { start, entries } = self;
        if !start.is_empty() {
            return;
        }
        start.resize(n + 2, 0);
        each_place(near, n, |b, _| start[b as usize + 2] += 1);
        for b in 2..n + 2 {
            start[b] += start[b - 1];
        }
        entries.clear();
        entries.resize(start[n + 1] as usize, 0);
        each_place(near, n, |b, place| {
            let at = &mut start[b as usize + 1];
            entries[*at as usize] = place;
            *at += 1;
        });
    }

    /// What body `b` feels.
    pub(super) fn by<M>(&self, b: usize, chunks: &[Chunk<M>]) -> Wrench {
        let mut sum = Wrench::default();
        for place in &self.entries[self.start[b] as usize..self.start[b + 1] as usize] {
            sum += chunks[*place as usize / STRIDE].felt[*place as usize % STRIDE];
        }
        sum
    }
}

/// Tells of all places whose they are.
fn each_place(near: &[NearPair], n: usize, mut tell: impl FnMut(u32, u32)) {
    for (i, chunk) in near.chunks(CHUNK).enumerate() {
        let mut place = (i * STRIDE) as u32;
        let mut next = |b: u32| {
            tell(b, place);
            place += 1;
        };
        for (k, pair) in chunk.iter().enumerate() {
            if (pair.b as usize) < n {
                next(pair.b);
            }
            if chunk.get(k + 1).is_none_or(|p| p.a != pair.a) {
                next(pair.a);
            }
        }
    }
}
