//! The squared error of given amplitudes with the best modes.
use super::amplitudes::{Amplitudes, add};
use super::normal::{DAMPING, Normal, factorise, substitute};
use super::problem::{Piece, Problem};
use crate::Mat;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;

/// Iterations for the directions that a frame gets in addition.
const POWERS: usize = 4;

/// min over Φ of f(A) = Σ_κ ‖D − B(A) Φ‖², and its derivatives.
pub(super) struct Evaluation {
    /// f, with the damping.
    pub(super) value: f64,
    /// ‖D − B Φ‖².
    pub(super) residual: f64,
    /// ∂f/∂A.
    pub(super) gradient: Mat<f64>,
    /// For every snapshot the products of the fields of all modes, column r, s ≤ r being number r (r + 1)/2 + s: half the second
    /// derivatives at given modes.
    gram: Mat<f64>,
    /// Φ of one wave vector after the other: real and imaginary parts by turns, a column for each of the data.
    pub(super) modes: Vec<f64>,
}

fn squares(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum()
}

/// Sums over wave vectors: in as many parts on every machine, added in their order.
fn sum<T: Send>(problem: &Problem<'_>, part: impl Fn(&[Piece<'_>]) -> T + Sync, mut fold: impl FnMut(T)) {
    let size = problem.pieces.len().div_ceil(16).max(1);
    let parts: Vec<_> = problem.pieces.par_chunks(size).map(&part).collect();
    parts.into_iter().for_each(&mut fold);
}

impl Evaluation {
    fn zero(n: usize, rank: usize) -> Self {
        Self {
            value: 0.0,
            residual: 0.0,
            gradient: Mat::zeros(n, rank),
            gram: Mat::zeros(n, rank * (rank + 1) / 2),
            modes: Vec::new(),
        }
    }

    /// Of these amplitudes, the columns of each frame orthonormal.
    pub(super) fn new(problem: &Problem<'_>, a: &Amplitudes) -> Self {
        let (n, rank) = a.values.shape();
        let of = |pieces: &[Piece<'_>]| {
            let (mut sum, mut normal) = (Self::zero(n, rank), Normal::new(problem, a));
            let mut product = vec![0.0; 2 * n];
            for piece in pieces {
                normal.begin(problem, piece, a);
                normal.solve(problem, piece);
                let squared = piece.weight * squares(&normal.residual);
                sum.residual += squared;
                sum.value += squared + piece.weight * DAMPING * squares(&normal.phi);
                let residual = std::mem::take(&mut normal.residual);
                normal.add_gradient(&residual, piece.weight, &mut sum.gradient);
                normal.residual = residual;
                sum.modes.extend_from_slice(&normal.phi);
                sum.add_gram(&normal, &a.frames(), piece.weight, &mut product);
            }
            sum
        };
        let mut all = Self::zero(n, rank);
        sum(problem, of, |part: Self| {
            all.value += part.value;
            all.residual += part.residual;
            add(&mut all.gradient, 1.0, &part.gradient);
            add(&mut all.gram, 1.0, &part.gram);
            all.modes.extend(part.modes);
        });
        all
    }

    /// The second derivatives of f along a direction, but for what vanishes with the residual (Kaufman 1975).
    pub(super) fn curvature(problem: &Problem<'_>, a: &Amplitudes, direction: &Mat<f64>) -> Mat<f64> {
        let (n, rank) = a.values.shape();
        let direction = Amplitudes { ranks: a.ranks.clone(), values: direction.clone() };
        let of = |pieces: &[Piece<'_>]| {
            let (mut normal, mut other) = (Normal::new(problem, a), Normal::new(problem, &direction));
            let mut sum = Mat::zeros(n, rank);
            for piece in pieces {
                normal.begin(problem, piece, a);
                normal.solve(problem, piece);
                other.begin(problem, piece, &direction);
                normal.differentiate(&other);
                let residual = std::mem::take(&mut normal.residual);
                normal.add_gradient(&residual, piece.weight, &mut sum);
                normal.residual = residual;
            }
            sum
        };
        let mut all = Mat::zeros(n, rank);
        sum(problem, of, |part| add(&mut all, 1.0, &part));
        all
    }

    /// Re Σ p̄_r p_s φ̄_r φ_s
    fn add_gram(&mut self, normal: &Normal, frames: &[usize], weight: f64, product: &mut [f64]) {
        let rank = frames.len();
        let n = product.len() / 2;
        let mut of = None;
        for r in 0..rank {
            for s in 0..=r {
                let (k, l) = (frames[r], frames[s]);
                if of != Some((k, l)) {
                    let ((pr, pi), (qr, qi)) = (normal.phase(k), normal.phase(l));
                    let (re, im) = product.split_at_mut(n);
                    for j in 0..n {
                        re[j] = pr[j] * qr[j] + pi[j] * qi[j];
                        im[j] = pr[j] * qi[j] - pi[j] * qr[j];
                    }
                    of = Some((k, l));
                }
                let (mut x, mut y) = (0.0, 0.0);
                for phi in normal.phi.chunks_exact(2 * rank) {
                    let (a, b) = (&phi[2 * r..][..2], &phi[2 * s..][..2]);
                    x += weight * (a[0] * b[0] + a[1] * b[1]);
                    y += weight * (a[1] * b[0] - a[0] * b[1]);
                }
                let (re, im) = product.split_at(n);
                let to = self.gram.col_as_slice_mut(r * (r + 1) / 2 + s);
                for j in 0..n {
                    to[j] += re[j] * x + im[j] * y;
                }
            }
        }
    }

    /// −½ (G + ε tr G)⁻¹ g for every snapshot: with ε = 0 and the gradient the step to the best amplitudes at given modes.
    pub(super) fn precondition(&self, gradient: &Mat<f64>, damping: f64) -> Mat<f64> {
        let (n, rank) = gradient.shape();
        let mut out = Mat::zeros(n, rank);
        let (mut matrix, mut x) = (vec![0.0; rank * rank], vec![0.0; rank]);
        for j in 0..n {
            for s in 0..rank {
                (s..rank).for_each(|r| matrix[r + s * rank] = self.gram[(j, r * (r + 1) / 2 + s)]);
            }
            let trace: f64 = (0..rank).map(|r| matrix[r + r * rank]).sum();
            factorise(rank, &mut matrix, damping * trace);
            (0..rank).for_each(|r| x[r] = -0.5 * gradient[(j, r)]);
            substitute(&matrix, &mut x);
            (0..rank).for_each(|r| out[(j, r)] = x[r]);
        }
        out
    }
}

/// What is left of the data by given amplitudes, in each frame: approximately its largest left singular vectors, so many for each
/// frame, by a few power iterations.
pub(super) fn dominant(problem: &Problem<'_>, a: &Amplitudes, more: &[usize]) -> Mat<f64> {
    let (n, total) = (a.values.nrows(), more.iter().sum());
    let mut rng = Pcg64::seed_from_u64(1);
    let values = Mat::from_fn(n, total, |_, _| 1.0 + rng.random_range(-0.5..0.5));
    let mut trial = Amplitudes { ranks: more.to_vec(), values };
    trial.orthonormalise();
    for _ in 0..POWERS {
        let of = |pieces: &[Piece<'_>]| {
            let (mut old, mut new) = (Normal::new(problem, a), Normal::new(problem, &trial));
            let mut sum = Mat::zeros(n, total);
            for piece in pieces {
                old.begin(problem, piece, a);
                old.solve(problem, piece);
                new.begin(problem, piece, &trial);
                new.project(&old.residual);
                new.add_gradient(&old.residual, piece.weight, &mut sum);
            }
            sum
        };
        let mut next = Mat::zeros(n, total);
        sum(problem, of, |part| add(&mut next, 1.0, &part));
        trial.values = next;
        trial.orthonormalise();
    }
    trial.values
}
