//! The least-squares problem of one wave vector.
use super::amplitudes::Amplitudes;
use super::problem::{Piece, Problem};
use monomorphic::{Mat, MatMut, MatRef, add_product};

/// Weight of ‖Φ‖² against the squared error at amplitudes of length one: where the frames cannot be told apart, the smallest modes
/// are taken.
pub(super) const DAMPING: f64 = 1e-13;

/// D ≈ B Φ for one wave vector after the other. Complex columns are two columns, of real and of imaginary parts.
pub(super) struct Normal {
    n: usize,
    frames: Vec<usize>,
    /// Of each frame its first column and how many it has.
    ranges: Vec<[usize; 2]>,
    /// Aᵀ A.
    own: Mat<f64>,
    /// p_k(t_j) of each frame.
    pub(super) phases: Vec<f64>,
    /// B: amplitudes with their phases.
    design: Vec<f64>,
    /// BᵀB and BᵀD of these columns.
    products: Vec<f64>,
    matrix: Vec<f64>,
    /// Φ: real and imaginary parts by turns, column by column.
    pub(super) phi: Vec<f64>,
    /// −Φ as the matrix of the columns of B: D + B C is what is left.
    negative: Vec<f64>,
    /// D − B Φ.
    pub(super) residual: Vec<f64>,
    /// (D − B Φ) Φᴴ, negative.
    correlation: Vec<f64>,
}

/// A as a matrix of so many rows.
fn view(a: &[f64], rows: usize) -> MatRef<'_, f64> {
    MatRef::from_column_major_slice(a, rows, a.len() / rows)
}

fn view_mut(a: &mut [f64], rows: usize) -> MatMut<'_, f64> {
    let columns = a.len() / rows;
    MatMut::from_column_major_slice_mut(a, rows, columns)
}

/// `to` becomes a zero matrix of this size.
fn zero(to: &mut Vec<f64>, size: usize) {
    to.clear();
    to.resize(size, 0.0);
}

impl Normal {
    pub(super) fn new(problem: &Problem<'_>, a: &Amplitudes) -> Self {
        let (n, rank) = a.values.shape();
        let mut own = Mat::zeros(rank, rank);
        add_product(own.as_mut(), a.values.transpose(), a.values.as_ref());
        let first = a.ranks.iter().scan(0, |sum, r| Some(std::mem::replace(sum, *sum + r)));
        Self {
            n,
            frames: a.frames(),
            ranges: first.zip(&a.ranks).map(|(first, &rank)| [first, rank]).collect(),
            own,
            phases: vec![0.0; 2 * n * problem.phases.n_frames()],
            design: vec![0.0; 2 * n * rank],
            products: Vec::new(),
            matrix: Vec::new(),
            phi: Vec::new(),
            negative: Vec::new(),
            residual: Vec::new(),
            correlation: Vec::new(),
        }
    }

    /// The real and imaginary parts of frame k's phases.
    pub(super) fn phase(&self, k: usize) -> (&[f64], &[f64]) {
        self.phases[2 * self.n * k..][..2 * self.n].split_at(self.n)
    }

    /// B of these amplitudes at this piece.
    pub(super) fn begin(&mut self, problem: &Problem<'_>, piece: &Piece<'_>, a: &Amplitudes) {
        let n = self.n;
        problem.phases.of(piece.wave, &mut self.phases);
        for (r, (&k, column)) in self.frames.iter().zip(self.design.chunks_exact_mut(2 * n)).enumerate() {
            let (pr, pi) = self.phases[2 * n * k..][..2 * n].split_at(n);
            let a = a.values.col_as_slice(r);
            let (re, im) = column.split_at_mut(n);
            for j in 0..n {
                re[j] = a[j] * pr[j];
                im[j] = a[j] * pi[j];
            }
        }
    }

    /// Bᴴ D becomes Φ.
    pub(super) fn project(&mut self, data: &[f64]) {
        let (width, columns) = (2 * self.frames.len(), data.len() / self.n);
        self.phi.clear();
        if width == 0 {
            return;
        }
        zero(&mut self.products, width * columns);
        let design = view(&self.design, self.n);
        add_product(view_mut(&mut self.products, width), design.transpose(), view(data, self.n));
        for pair in self.products.chunks_exact(2 * width) {
            let (re, im) = pair.split_at(width);
            for (re, im) in re.chunks_exact(2).zip(im.chunks_exact(2)) {
                self.phi.extend([re[0] + im[1], im[0] - re[1]]);
            }
        }
    }

    /// The best Φ for it, and what it leaves.
    pub(super) fn solve(&mut self, problem: &Problem<'_>, piece: &Piece<'_>) {
        let width = 2 * self.frames.len();
        self.residual.clear();
        self.residual.extend_from_slice(&piece.data);
        self.phi.clear();
        if width == 0 {
            return;
        }
        self.multiply(problem.phases.shortest(piece.wave));
        zero(&mut self.matrix, width * width);
        let s = |i: usize, j: usize| self.products[i + j * width];
        for c in (0..width).step_by(2) {
            for r in (c..width).step_by(2) {
                let (re, im) = (s(r, c) + s(r + 1, c + 1), s(r, c + 1) - s(r + 1, c));
                let matrix = &mut self.matrix;
                (matrix[r + c * width], matrix[r + 1 + c * width]) = (re, im);
                (matrix[r + (c + 1) * width], matrix[r + 1 + (c + 1) * width]) = (-im, re);
            }
        }
        self.project(&piece.data);
        factorise(width, &mut self.matrix, DAMPING);
        self.phi.chunks_exact_mut(width).for_each(|x| substitute(&self.matrix, x));
        self.negate();
        let (design, negative) = (view(&self.design, self.n), view(&self.negative, width));
        add_product(view_mut(&mut self.residual, self.n), design, negative);
    }

    /// What is left changes by this when B does by that of another one.
    pub(super) fn differentiate(&mut self, other: &Self) {
        let width = 2 * self.frames.len();
        self.residual.fill(0.0);
        let change = view(&other.design, self.n);
        add_product(view_mut(&mut self.residual, self.n), change, view(&self.negative, width));
        let phi = std::mem::take(&mut self.phi);
        let residual = std::mem::take(&mut self.residual);
        self.project(&residual);
        self.residual = residual;
        self.phi.chunks_exact_mut(width).for_each(|x| substitute(&self.matrix, x));
        self.negate();
        let (design, negative) = (view(&self.design, self.n), view(&self.negative, width));
        add_product(view_mut(&mut self.residual, self.n), design, negative);
        self.phi = phi;
    }

    /// BᵀB below its diagonal. Phases of length one cancel within a frame.
    fn multiply(&mut self, shortest: bool) {
        let width = 2 * self.frames.len();
        zero(&mut self.products, width * width);
        let design = view(&self.design, self.n);
        for &[first, count] in &self.ranges {
            if !shortest {
                for (r, s) in (first..first + count).flat_map(|s| (s..first + count).map(move |r| (r, s))) {
                    self.products[2 * r + 2 * s * width] = self.own[(r, s)];
                }
            }
            let from = 2 * if shortest { first } else { first + count };
            if from < width && count > 0 {
                let to = view_mut(&mut self.products, width);
                let to = to.submatrix_mut(from, 2 * first, width - from, 2 * count);
                let rows = design.subcols(from, width - from);
                add_product(to, rows.transpose(), design.subcols(2 * first, 2 * count));
            }
        }
    }

    fn negate(&mut self) {
        let width = 2 * self.frames.len();
        self.negative.clear();
        for phi in self.phi.chunks_exact(width) {
            self.negative.extend(phi.chunks_exact(2).flat_map(|z| [-z[0], z[1]]));
            self.negative.extend(phi.chunks_exact(2).flat_map(|z| [-z[1], -z[0]]));
        }
    }

    /// Adds −2 `weight` Re p̄ E Φᴴ to the columns of `to`, with these E and Φ as it stands.
    pub(super) fn add_gradient(&mut self, e: &[f64], weight: f64, to: &mut Mat<f64>) {
        let (n, width) = (self.n, 2 * self.frames.len());
        if width == 0 {
            return;
        }
        self.negate();
        zero(&mut self.correlation, n * width);
        let negative = view(&self.negative, width);
        add_product(view_mut(&mut self.correlation, n), view(e, n), negative.transpose());
        for (r, (&k, column)) in self.frames.iter().zip(self.correlation.chunks_exact(2 * n)).enumerate() {
            let (pr, pi) = self.phases[2 * n * k..][..2 * n].split_at(n);
            let (re, im) = column.split_at(n);
            let to = to.col_as_slice_mut(r);
            for j in 0..n {
                to[j] += 2.0 * weight * (pr[j] * re[j] + pi[j] * im[j]);
            }
        }
    }
}

/// L of L Lᵀ = M + ε for M, column by column; pivots below ε are taken for ε.
pub(super) fn factorise(n: usize, m: &mut [f64], damping: f64) {
    for k in 0..n {
        let (before, after) = m.split_at_mut((k + 1) * n);
        let column = &mut before[k * n..];
        let pivot = (column[k].max(0.0) + damping).max(f64::MIN_POSITIVE).sqrt();
        column[k] = pivot;
        column[k + 1..].iter_mut().for_each(|x| *x /= pivot);
        for (j, other) in (k + 1..n).zip(after.chunks_exact_mut(n)) {
            let factor = column[j];
            other[j..].iter_mut().zip(&column[j..]).for_each(|(x, l)| *x -= l * factor);
        }
    }
}

/// Replaces x by (L Lᵀ)⁻¹ x.
pub(super) fn substitute(l: &[f64], x: &mut [f64]) {
    let n = x.len();
    for k in 0..n {
        let column = &l[k * n..][..n];
        x[k] /= column[k];
        let y = x[k];
        x[k + 1..].iter_mut().zip(&column[k + 1..]).for_each(|(x, l)| *x -= l * y);
    }
    for k in (0..n).rev() {
        let column = &l[k * n..][..n];
        let sum: f64 = column[k + 1..].iter().zip(&x[k + 1..]).map(|(l, x)| l * x).sum();
        x[k] = (x[k] - sum) / column[k];
    }
}
