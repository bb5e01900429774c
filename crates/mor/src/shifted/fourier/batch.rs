//! Several wave vectors at a time.
use super::amplitudes::Amplitudes;
use super::problem::{Piece, Problem};
use monomorphic::{Mat, MatMut, MatRef, add_product};

/// Columns of a batch, at most, if it has more than one piece: they fit a second-level cache.
const COLUMNS: usize = 32;

/// The pieces in their order, so many columns at a time as fit one batch.
pub(super) fn batches<'p, 'a>(n: usize, pieces: &'p [Piece<'a>]) -> impl Iterator<Item = &'p [Piece<'a>]> {
    let mut rest = pieces;
    std::iter::from_fn(move || {
        let mut columns = 0;
        let fits = rest.iter().take_while(|p| {
            columns += p.data.len() / (2 * n);
            columns <= COLUMNS
        });
        let (batch, others) = rest.split_at(fits.count().max(1).min(rest.len()));
        rest = others;
        (!batch.is_empty()).then_some(batch)
    })
}

/// A as a matrix of so many rows.
pub(super) fn view(a: &[f64], rows: usize) -> MatRef<'_, f64> {
    MatRef::from_column_major_slice(a, rows, a.len() / rows)
}

pub(super) fn view_mut(a: &mut [f64], rows: usize) -> MatMut<'_, f64> {
    let columns = a.len() / rows;
    MatMut::from_column_major_slice_mut(a, rows, columns)
}

/// `to` becomes a zero matrix of this size.
pub(super) fn zero(to: &mut Vec<f64>, size: usize) {
    to.clear();
    to.resize(size, 0.0);
}

/// Calls `of` for all items with the machine's widest vectors.
///
/// The closure that is dispatched consumes the items: it is called as it is and therefore inlined.
#[inline(always)]
pub(super) fn vectorised<T>(items: impl Iterator<Item = T>, mut of: impl FnMut(T)) {
    pulp::Arch::new().dispatch(
        #[inline(always)]
        move || {
            for item in items {
                of(item);
            }
        },
    );
}

/// p̄ q.
#[inline(always)]
fn multiply_conjugate((pr, pi): (&[f64], &[f64]), (qr, qi): (&[f64], &[f64]), to: (&mut [f64], &mut [f64])) {
    let of = pr.iter().zip(pi).zip(qr.iter().zip(qi));
    for ((re, im), ((pr, pi), (qr, qi))) in to.0.iter_mut().zip(to.1).zip(of) {
        *re = pr * qr + pi * qi;
        *im = pr * qi - pi * qr;
    }
}

/// x − p y becomes x.
#[inline(always)]
fn subtract_product((pr, pi): (&[f64], &[f64]), (yr, yi): (&[f64], &[f64]), x: (&mut [f64], &mut [f64])) {
    let of = pr.iter().zip(pi).zip(yr.iter().zip(yi));
    for ((xr, xi), ((pr, pi), (yr, yi))) in x.0.iter_mut().zip(x.1).zip(of) {
        *xr -= pr * yr - pi * yi;
        *xi -= pr * yi + pi * yr;
    }
}

/// Data and phases of some wave vectors; B = (p_k ∘ A_k)_k is never formed.
///
/// A complex column of length n is two columns, of real and of imaginary parts: C columns are an
/// n × 2C matrix. Φ is rank × 2C in the same way.
pub(super) struct Batch {
    n: usize,
    /// p_k(t_j): piece by piece, frame by frame, real parts and then imaginary parts.
    phases: Vec<f64>,
    /// D of all pieces.
    pub(super) data: Vec<f64>,
    /// The piece of each complex column.
    pub(super) pieces: Vec<usize>,
    /// The weight of each piece.
    pub(super) weights: Vec<f64>,
    /// Whether all phases have length one.
    pub(super) unit: bool,
    /// Weight of ‖Φ‖² against the squared error.
    pub(super) ridge: f64,
    work: Vec<f64>,
    scaled: Vec<f64>,
}

impl Batch {
    pub(super) fn new(n: usize) -> Self {
        Self {
            n,
            phases: Vec::new(),
            data: Vec::new(),
            pieces: Vec::new(),
            weights: Vec::new(),
            unit: true,
            ridge: 0.0,
            work: Vec::new(),
            scaled: Vec::new(),
        }
    }

    /// Takes these pieces.
    pub(super) fn load(&mut self, problem: &Problem<'_>, pieces: &[Piece<'_>]) {
        let size = 2 * self.n * problem.phases.n_frames();
        self.phases.resize(size * pieces.len(), 0.0);
        self.data.clear();
        self.pieces.clear();
        self.weights.clear();
        self.unit = true;
        self.ridge = problem.ridge;
        for (p, (piece, phases)) in pieces.iter().zip(self.phases.chunks_exact_mut(size)).enumerate() {
            problem.phases.of(piece.wave, phases);
            self.data.extend_from_slice(&piece.data);
            self.pieces.resize(self.data.len() / (2 * self.n), p);
            self.weights.push(piece.weight);
            self.unit &= !problem.phases.shortest(piece.wave);
        }
    }

    /// Real and imaginary parts of frame k's phases at each piece.
    #[inline(always)]
    fn phase(&self, k: usize) -> impl Iterator<Item = (&[f64], &[f64])> {
        let size = self.phases.len() / self.weights.len().max(1);
        self.phases.chunks_exact(size.max(1)).map(move |p| p[2 * self.n * k..][..2 * self.n].split_at(self.n))
    }

    /// p̄_k p_l of each piece.
    pub(super) fn pair(&self, k: usize, l: usize, to: &mut Vec<f64>) {
        let n = self.n;
        to.resize(2 * n * self.weights.len(), 0.0);
        let pieces = to.chunks_exact_mut(2 * n).zip(self.phase(k)).zip(self.phase(l));
        vectorised(
            pieces,
            #[inline(always)]
            |((to, p), q)| multiply_conjugate(p, q, to.split_at_mut(n)),
        );
    }

    /// p̄_k ∘ x becomes the work.
    fn unshift(&mut self, k: usize, x: &[f64]) {
        let n = self.n;
        let mut work = std::mem::take(&mut self.work);
        work.resize(x.len(), 0.0);
        let phases: Vec<_> = self.phase(k).collect();
        let columns = work.chunks_exact_mut(2 * n).zip(x.chunks_exact(2 * n)).zip(&self.pieces);
        vectorised(
            columns,
            #[inline(always)]
            |((to, x), &p)| {
                multiply_conjugate(phases[p], x.split_at(n), to.split_at_mut(n));
            },
        );
        self.work = work;
    }

    /// Bᴴ x.
    pub(super) fn project(&mut self, a: &Amplitudes, x: &[f64], to: &mut Vec<f64>) {
        let (n, rank) = a.values.shape();
        zero(to, rank * x.len() / n);
        for (k, [first, count]) in a.ranges().filter(|(_, [_, count])| *count > 0) {
            self.unshift(k, x);
            let to = view_mut(to, rank).submatrix_mut(first, 0, count, x.len() / n);
            add_product(to, a.values.subcols(first, count).transpose(), view(&self.work, n));
        }
    }

    /// x − B Φ becomes x.
    pub(super) fn subtract(&mut self, a: &Amplitudes, phi: &[f64], x: &mut [f64]) {
        let (n, rank) = a.values.shape();
        for (k, [first, count]) in a.ranges().filter(|(_, [_, count])| *count > 0) {
            let mut work = std::mem::take(&mut self.work);
            zero(&mut work, x.len());
            let of = view(phi, rank).submatrix(first, 0, count, x.len() / n);
            add_product(view_mut(&mut work, n), a.values.subcols(first, count), of);
            let phases: Vec<_> = self.phase(k).collect();
            let columns = x.chunks_exact_mut(2 * n).zip(work.chunks_exact(2 * n)).zip(&self.pieces);
            vectorised(
                columns,
                #[inline(always)]
                |((x, y), &p)| {
                    subtract_product(phases[p], y.split_at(n), x.split_at_mut(n));
                },
            );
            self.work = work;
        }
    }

    /// Adds −2 w Re p̄ e Φᴴ to the columns of `to`, one per amplitude, with the weights w of the pieces.
    pub(super) fn add_gradient(&mut self, a: &Amplitudes, phi: &[f64], e: &[f64], to: &mut Mat<f64>) {
        let (n, rank) = a.values.shape();
        if rank == 0 {
            return;
        }
        let mut scaled = std::mem::take(&mut self.scaled);
        scaled.clear();
        for (phi, &p) in phi.chunks_exact(2 * rank).zip(&self.pieces) {
            scaled.extend(phi.iter().map(|x| -2.0 * self.weights[p] * x));
        }
        for (k, [first, count]) in a.ranges().filter(|(_, [_, count])| *count > 0) {
            self.unshift(k, e);
            let of = view(&scaled, rank).submatrix(first, 0, count, e.len() / n);
            let to = to.as_mut().submatrix_mut(0, first, n, count);
            add_product(to, view(&self.work, n), of.transpose());
        }
        self.scaled = scaled;
    }
}

#[cfg(test)]
mod tests {
    use super::{COLUMNS, batches};
    use crate::shifted::fourier::problem::Piece;

    #[test]
    fn batches_are_all_pieces_in_their_order() {
        // A piece with more columns than a batch is one of its own.
        let piece = |(i, columns): (usize, &usize)| Piece {
            wave: [i, 0, 0],
            data: vec![0.0; 2 * 3 * columns].into(),
            weight: 1.0,
        };
        let counts = [1, COLUMNS, 2 * COLUMNS, 1, COLUMNS - 1, 1, 0];
        let pieces: Vec<_> = counts.iter().enumerate().map(piece).collect();
        let sizes: Vec<_> = batches(3, &pieces).map(<[_]>::len).collect();
        assert_eq!(sizes, [1, 1, 1, 2, 2]);
        let order: Vec<_> = batches(3, &pieces).flatten().map(|p| p.wave[0]).collect();
        assert_eq!(order, [0, 1, 2, 3, 4, 5, 6]);
    }
}
