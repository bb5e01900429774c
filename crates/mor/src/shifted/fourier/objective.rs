//! The squared error of given amplitudes with the best modes.
use super::amplitudes::{Amplitudes, add};
use super::batch::{Batch, batches};
use super::cholesky::{factorise, substitute};
use super::normal::{Normal, modes};
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
    /// For every snapshot the products of the fields of two modes in the order of [`modes`]: half the
    /// second derivatives at given modes.
    gram: Mat<f64>,
    /// Φ of one wave vector after the other: for each column of the data real parts, then imaginary parts.
    pub(super) modes: Vec<f64>,
    /// The modes of each column of `gram`.
    pairs: Vec<[usize; 2]>,
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
    fn zero(a: &Amplitudes) -> Self {
        let (n, rank) = a.values.shape();
        Self {
            value: 0.0,
            residual: 0.0,
            gradient: Mat::zeros(n, rank),
            gram: Mat::zeros(n, modes(a).len()),
            modes: Vec::new(),
            pairs: modes(a),
        }
    }

    /// Of these amplitudes, the columns of each frame orthonormal.
    pub(super) fn new(problem: &Problem<'_>, a: &Amplitudes) -> Self {
        let (n, rank) = a.values.shape();
        let of = |pieces: &[Piece<'_>]| {
            let (mut sum, mut normal, mut batch) = (Self::zero(a), Normal::new(a), Batch::new(n));
            for pieces in batches(n, pieces) {
                batch.load(problem, pieces);
                normal.solve(&mut batch);
                let residuals = normal.residual.chunks_exact(2 * n);
                for (c, (residual, &p)) in residuals.zip(&batch.pieces).enumerate() {
                    let squared = batch.weights[p] * squares(residual);
                    let damped = batch.weights[p] * problem.ridge;
                    sum.residual += squared;
                    sum.value += squared + damped * squares(&normal.phi[2 * rank * c..][..2 * rank]);
                }
                batch.add_gradient(a, &normal.phi, &normal.residual, &mut sum.gradient);
                sum.modes.extend_from_slice(&normal.phi);
                normal.add_gram(&batch, &mut sum.gram);
            }
            sum
        };
        let mut all = Self::zero(a);
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
            let (mut sum, mut normal, mut batch) = (Mat::zeros(n, rank), Normal::new(a), Batch::new(n));
            for pieces in batches(n, pieces) {
                batch.load(problem, pieces);
                normal.solve(&mut batch);
                normal.differentiate(&mut batch, &direction);
                batch.add_gradient(a, &normal.phi, &normal.residual, &mut sum);
            }
            sum
        };
        let mut all = Mat::zeros(n, rank);
        sum(problem, of, |part| add(&mut all, 1.0, &part));
        all
    }

    /// −½ (G + ε tr G)⁻¹ g for every snapshot: with ε = 0 and the gradient the step to the best amplitudes at given modes.
    pub(super) fn precondition(&self, gradient: &Mat<f64>, damping: f64) -> Mat<f64> {
        let (n, rank) = gradient.shape();
        let mut out = Mat::zeros(n, rank);
        let (mut matrix, mut x) = (vec![0.0; rank * rank], vec![0.0; rank]);
        for j in 0..n {
            for (c, [r, s]) in self.pairs.iter().enumerate() {
                matrix[r + s * rank] = self.gram[(j, c)];
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
            let (mut old, mut batch) = (Normal::new(a), Batch::new(n));
            let (mut sum, mut phi) = (Mat::zeros(n, total), Vec::new());
            for pieces in batches(n, pieces) {
                batch.load(problem, pieces);
                old.solve(&mut batch);
                batch.project(&trial, &old.residual, &mut phi);
                batch.add_gradient(&trial, &phi, &old.residual, &mut sum);
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
