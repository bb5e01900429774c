//! The squared error of given amplitudes with the best modes.
use super::spectrum::{Group, Spectrum};
use crate::Mat;
use monomorphic::add_product;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;

/// Weight of ‖Φ‖² against the squared error at amplitudes of length one: where the frames cannot be told apart, the smallest modes
/// are taken.
const DAMPING: f64 = 1e-13;
/// Iterations for the directions that a frame gets in addition.
const POWERS: usize = 4;

/// Amplitudes a_i^k(t_j): a row per snapshot, a column per mode, those of one frame after those of another.
#[derive(Clone)]
pub(super) struct Amplitudes {
    pub(super) ranks: Vec<usize>,
    pub(super) values: Mat<f64>,
}

impl Amplitudes {
    /// The frame of each column.
    fn frames(&self) -> Vec<usize> {
        self.ranks.iter().enumerate().flat_map(|(k, &r)| vec![k; r]).collect()
    }
}

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
    pub(super) gram: Mat<f64>,
}

/// What is needed for one group after the other.
struct Work {
    phases: Vec<f64>,
    design: Mat<f64>,
    frames: Vec<usize>,
}

impl Work {
    fn new(spectrum: &Spectrum, a: &Amplitudes) -> Self {
        let (n, rank) = a.values.shape();
        let phases = vec![0.0; 2 * n * spectrum.phases.n_frames()];
        Self { phases, design: Mat::zeros(2 * n, 2 * rank), frames: a.frames() }
    }

    /// B: the amplitudes with their phases, real above imaginary parts; then the same times i.
    fn design(&mut self, spectrum: &Spectrum, group: &Group, a: &Amplitudes) {
        spectrum.phases.of(group.wave, &mut self.phases);
        let (n, rank) = a.values.shape();
        for (r, &k) in self.frames.iter().enumerate() {
            let (pr, pi) = self.phases[2 * n * k..][..2 * n].split_at(n);
            let a = a.values.col_as_slice(r);
            let (re, im) = self.design.col_as_slice_mut(r).split_at_mut(n);
            for j in 0..n {
                (re[j], im[j]) = (a[j] * pr[j], a[j] * pi[j]);
            }
            let (re, im) = self.design.col_as_slice_mut(rank + r).split_at_mut(n);
            for j in 0..n {
                (re[j], im[j]) = (-a[j] * pi[j], a[j] * pr[j]);
            }
        }
    }

    /// Φ, real above imaginary parts, and the residual.
    fn solve(&self, group: &Group) -> (Mat<f64>, Mat<f64>) {
        let rank = self.frames.len();
        let b = &self.design;
        let mut normal = Mat::zeros(2 * rank, 2 * rank);
        add_product(normal.as_mut(), b.transpose(), b.as_ref());
        let factor = Factor::new(normal, DAMPING);
        let mut phi: Mat<f64> = Mat::zeros(2 * rank, group.data.ncols());
        add_product(phi.as_mut(), b.transpose(), group.data.as_ref());
        (0..phi.ncols()).for_each(|c| factor.solve(phi.col_as_slice_mut(c)));
        let negative = Mat::from_fn(phi.nrows(), phi.ncols(), |r, c| -phi[(r, c)]);
        let mut residual = group.data.clone();
        add_product(residual.as_mut(), b.as_ref(), negative.as_ref());
        (phi, residual)
    }
}

/// L of L Lᵀ = M + ε.
pub(super) struct Factor(Mat<f64>);

impl Factor {
    /// Pivots below ε are taken for ε.
    pub(super) fn new(mut m: Mat<f64>, damping: f64) -> Self {
        let n = m.nrows();
        for k in 0..n {
            let pivot = (m[(k, k)].max(0.0) + damping).max(f64::MIN_POSITIVE).sqrt();
            let column = m.col_as_slice_mut(k);
            column[k] = pivot;
            column[k + 1..].iter_mut().for_each(|x| *x /= pivot);
            for j in k + 1..n {
                let factor = m[(j, k)];
                for i in j..n {
                    let l = m[(i, k)];
                    m[(i, j)] -= l * factor;
                }
            }
        }
        Self(m)
    }

    pub(super) fn solve(&self, x: &mut [f64]) {
        let n = x.len();
        for k in 0..n {
            let column = self.0.col_as_slice(k);
            x[k] /= column[k];
            let y = x[k];
            x[k + 1..].iter_mut().zip(&column[k + 1..]).for_each(|(x, l)| *x -= l * y);
        }
        for k in (0..n).rev() {
            let column = self.0.col_as_slice(k);
            let sum: f64 = column[k + 1..].iter().zip(&x[k + 1..]).map(|(l, x)| l * x).sum();
            x[k] = (x[k] - sum) / column[k];
        }
    }
}

fn squares(m: &Mat<f64>) -> f64 {
    (0..m.ncols()).map(|c| m.col_as_slice(c).iter().map(|x| x * x).sum::<f64>()).sum()
}

fn add(to: &mut Mat<f64>, m: &Mat<f64>) {
    for c in 0..m.ncols() {
        to.col_as_slice_mut(c).iter_mut().zip(m.col_as_slice(c)).for_each(|(x, y)| *x += y);
    }
}

impl Evaluation {
    fn zero(n: usize, rank: usize) -> Self {
        Self {
            value: 0.0,
            residual: 0.0,
            gradient: Mat::zeros(n, rank),
            gram: Mat::zeros(n, rank * (rank + 1) / 2),
        }
    }

    /// Of these amplitudes, the columns of each frame orthonormal.
    pub(super) fn new(spectrum: &Spectrum, a: &Amplitudes) -> Self {
        let (n, rank) = a.values.shape();
        // As many parts on every machine, added in their order.
        let size = spectrum.groups.len().div_ceil(16).max(1);
        let parts: Vec<_> = spectrum
            .groups
            .par_chunks(size)
            .map(|groups| {
                let (mut sum, mut work) = (Self::zero(n, rank), Work::new(spectrum, a));
                groups.iter().for_each(|group| sum.add_group(spectrum, group, a, &mut work));
                sum
            })
            .collect();
        let mut sum = Self::zero(n, rank);
        for part in parts {
            sum.value += part.value;
            sum.residual += part.residual;
            add(&mut sum.gradient, &part.gradient);
            add(&mut sum.gram, &part.gram);
        }
        sum
    }

    fn add_group(&mut self, spectrum: &Spectrum, group: &Group, a: &Amplitudes, work: &mut Work) {
        let (n, rank) = a.values.shape();
        work.design(spectrum, group, a);
        let (phi, residual) = work.solve(group);
        let squared = squares(&residual);
        self.residual += squared;
        self.value += squared + DAMPING * squares(&phi);
        let (re, im) = phi.split_at_row(rank);
        self.add_gradient(work, &phi, &residual);
        let [mut same, mut across] = [(); 2].map(|()| Mat::zeros(rank, rank));
        add_product(same.as_mut(), re, re.transpose());
        add_product(same.as_mut(), im, im.transpose());
        add_product(across.as_mut(), im, re.transpose());
        let mut number = 0;
        let mut product = vec![0.0; 2 * n];
        let mut of = None;
        for r in 0..rank {
            for s in 0..=r {
                let (k, l) = (work.frames[r], work.frames[s]);
                if of != Some((k, l)) {
                    let (pr, pi) = work.phases[2 * n * k..][..2 * n].split_at(n);
                    let (qr, qi) = work.phases[2 * n * l..][..2 * n].split_at(n);
                    let (re, im) = product.split_at_mut(n);
                    for j in 0..n {
                        (re[j], im[j]) = (pr[j] * qr[j] + pi[j] * qi[j], pr[j] * qi[j] - pi[j] * qr[j]);
                    }
                    of = Some((k, l));
                }
                // Re p̄_r p_s φ̄_r φ_s
                let (x, y) = (same[(r, s)], across[(r, s)] - across[(s, r)]);
                let (re, im) = product.split_at(n);
                let to = self.gram.col_as_slice_mut(number);
                for j in 0..n {
                    to[j] += re[j] * x + im[j] * y;
                }
                number += 1;
            }
        }
    }

    /// −2 Re p̄ E φ̄
    fn add_gradient(&mut self, work: &Work, phi: &Mat<f64>, residual: &Mat<f64>) {
        let (n, rank) = self.gradient.shape();
        let (re, im) = phi.split_at_row(rank);
        let [mut real, mut imaginary] = [(); 2].map(|()| Mat::zeros(2 * n, rank));
        add_product(real.as_mut(), residual.as_ref(), re.transpose());
        add_product(imaginary.as_mut(), residual.as_ref(), im.transpose());
        for (r, &k) in work.frames.iter().enumerate() {
            let (pr, pi) = work.phases[2 * n * k..][..2 * n].split_at(n);
            let (rr, ri) = real.col_as_slice(r).split_at(n);
            let (ir, ii) = imaginary.col_as_slice(r).split_at(n);
            let to = self.gradient.col_as_slice_mut(r);
            for j in 0..n {
                to[j] -= 2.0 * (pr[j] * (rr[j] + ii[j]) + pi[j] * (ri[j] - ir[j]));
            }
        }
    }

    /// −½ (G + ε)⁻¹ g for every snapshot: with ε = 0 and the gradient the step to the best amplitudes at given modes.
    pub(super) fn precondition(&self, gradient: &Mat<f64>, damping: f64) -> Mat<f64> {
        let (n, rank) = gradient.shape();
        let mut out = Mat::zeros(n, rank);
        let mut x = vec![0.0; rank];
        for j in 0..n {
            let at = |r: usize, s: usize| self.gram[(j, r * (r + 1) / 2 + s)];
            let m = Mat::from_fn(rank, rank, |r, s| if r >= s { at(r, s) } else { at(s, r) });
            let trace: f64 = (0..rank).map(|r| m[(r, r)]).sum();
            let factor = Factor::new(m, damping * trace);
            (0..rank).for_each(|r| x[r] = -0.5 * gradient[(j, r)]);
            factor.solve(&mut x);
            (0..rank).for_each(|r| out[(j, r)] = x[r]);
        }
        out
    }
}

/// The best modes of these amplitudes, group by group: real above imaginary parts.
pub(super) fn modes(spectrum: &Spectrum, a: &Amplitudes) -> Vec<Mat<f64>> {
    let solve = |group: &Group| {
        let mut work = Work::new(spectrum, a);
        work.design(spectrum, group, a);
        work.solve(group).0
    };
    spectrum.groups.par_iter().map(solve).collect()
}

/// What is left of the data by given amplitudes, in each frame: approximately its largest left singular vectors, so many for each
/// frame, by a few power iterations.
pub(super) fn dominant(spectrum: &Spectrum, a: &Amplitudes, more: &[usize]) -> Mat<f64> {
    let n = a.values.nrows();
    let total = more.iter().sum();
    let mut rng = Pcg64::seed_from_u64(1);
    let values = Mat::from_fn(n, total, |_, _| 1.0 + rng.random_range(-0.5..0.5));
    let mut trial = Amplitudes { ranks: more.to_vec(), values };
    trial.orthonormalise();
    for _ in 0..POWERS {
        let size = spectrum.groups.len().div_ceil(16).max(1);
        let parts: Vec<_> = spectrum
            .groups
            .par_chunks(size)
            .map(|groups| {
                let (mut work, mut new) = (Work::new(spectrum, a), Work::new(spectrum, &trial));
                let mut sum = Evaluation::zero(n, total);
                for group in groups {
                    work.design(spectrum, group, a);
                    new.design(spectrum, group, &trial);
                    let residual = work.solve(group).1;
                    let mut phi: Mat<f64> = Mat::zeros(2 * total, group.data.ncols());
                    add_product(phi.as_mut(), new.design.transpose(), residual.as_ref());
                    sum.add_gradient(&new, &phi, &residual);
                }
                sum.gradient
            })
            .collect();
        trial.values = Mat::zeros(n, total);
        parts.iter().for_each(|part| add(&mut trial.values, part));
        trial.orthonormalise();
    }
    trial.values
}
