//! Loops over parts of lists on the threads of the pool. What is done to a part is no type parameter: a loop is compiled once
//! per type of the entries rather than once per use, which takes minutes.
use rayon::prelude::*;

/// Calls `body` with the number of each part of so many entries, and the part.
pub(crate) fn each_part<A: Send>(a: &mut [A], length: usize, body: &(dyn Fn(usize, &mut [A]) + Sync)) {
    a.par_chunks_mut(length).enumerate().for_each(|(k, a)| body(k, a));
}

type OnPair<'a, A, B> = &'a (dyn Fn(usize, &mut [A], &mut [B]) + Sync);

/// The same for parts of two lists.
pub(crate) fn each_pair<A: Send, B: Send>(
    a: &mut [A],
    b: &mut [B],
    lengths: [usize; 2],
    body: OnPair<'_, A, B>,
) {
    let pairs = a.par_chunks_mut(lengths[0]).zip(b.par_chunks_mut(lengths[1]));
    pairs.enumerate().for_each(|(k, (a, b))| body(k, a, b));
}
