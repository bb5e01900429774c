//! Number of terms of a varying-coefficient function.
use super::terms::Terms;
use crate::Mat;
use crate::interpolation::spline::Axis;
use crate::interpolation::{Degree, FitObserver, FitProgress, FitStage, Folds, InterpolationError, Samples};
use monomorphic::{Qr, solve_positive};
use std::collections::HashMap;
use std::f64::consts::TAU;

/// How complex a function is; ordered from the simplest one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Complexity {
    /// Steps of the number of pieces of the spline.
    pieces: usize,
    /// r₀ and r₁.
    parameters: usize,
    variation: usize,
    /// q.
    harmonics: usize,
    /// −log₁₀ of ρ, relative to the largest column.
    ridge: usize,
}

/// Ridges that are tried: from 10⁻¹ to the round-off of the normal equations' Cholesky factors.
const RIDGES: std::ops::RangeInclusive<usize> = 1..=7;

impl Complexity {
    /// Pieces after so many steps of 3/2.
    fn pieces(self) -> usize {
        (0..self.pieces).fold(1, |n: usize, _| (n + 1).max(3 * n / 2))
    }
    /// With one of the numbers larger by `step`, or the ridge changed by it.
    fn neighbours(self, step: usize) -> impl Iterator<Item = Self> {
        let with = move |part: usize| {
            let mut next = self;
            match part {
                0 => next.pieces += step,
                1 => next.parameters += step,
                2 => next.variation += step,
                3 => next.harmonics += step,
                4 => next.ridge += step,
                _ => next.ridge = next.ridge.saturating_sub(step),
            }
            next
        };
        (0..6).map(with)
    }
}

/// Samples to fit.
pub(super) struct Fit<'a> {
    pub(super) samples: &'a Samples,
    pub(super) degree: Degree,
    pub(super) slow: usize,
    /// Ascending distinct values of the first input.
    pub(super) times: Vec<f64>,
}

impl Fit<'_> {
    pub(super) fn terms(&self, of: Complexity) -> Terms {
        let (p, pieces, last) = (self.degree.get(), of.pieces(), self.times.len() - 1);
        let mut knots = vec![self.times[0]; p + 1];
        knots.extend((1..pieces).map(|i| {
            let at = (i * last) as f64 / pieces as f64;
            let before = at as usize;
            self.times[before] + at.fract() * (self.times[(before + 1).min(last)] - self.times[before])
        }));
        knots.extend(vec![self.times[last]; p + 1]);
        let domain = &self.samples.domain()[..self.slow];
        let phases = (self.samples.inputs() - self.slow) / 2;
        let degrees = [of.parameters, of.variation, of.harmonics];
        Terms::new(Axis { degree: p, knots }, domain, phases, degrees)
    }
    /// Terms (columns) at the samples (rows), `below` rows of zeros below.
    fn matrix(&self, terms: &Terms, below: usize) -> Mat<f64> {
        let m = self.samples.len();
        let rows: Vec<Vec<f64>> = (0..m).map(|j| terms.at(self.samples.point(j), None)).collect();
        Mat::from_fn(m + below, terms.len(), |j, c| if j < m { rows[j][c] } else { 0.0 })
    }
    fn ridge(matrix: &Mat<f64>, of: Complexity) -> f64 {
        let largest = (0..matrix.ncols()).map(|c| matrix.col(c).norm_l2()).fold(0.0, f64::max);
        largest * 10.0_f64.powi(-(of.ridge as i32))
    }

    /// The coefficients, k × terms.
    pub(super) fn coefficients(&self, terms: &Terms, of: Complexity) -> Mat<f64> {
        let (m, n, k) = (self.samples.len(), terms.len(), self.samples.outputs());
        let mut rows = self.matrix(terms, n);
        let ridge = Self::ridge(&rows, of);
        (0..n).for_each(|c| rows[(m + c, c)] = ridge);
        let values = self.samples.values();
        let mut right = Mat::from_fn(m + n, k, |j, row| if j < m { values[(row, j)] } else { 0.0 });
        Qr::new(rows).solve(right.as_mut());
        Mat::from_fn(k, n, |row, c| right[(c, row)])
    }

    /// Errors (k × size of the set) at the samples of every set by the coefficients of all others; None if those do not determine them.
    pub(super) fn left_out(&self, of: Complexity, folds: &Folds) -> Option<Vec<Mat<f64>>> {
        let terms = self.terms(of);
        let normal = Normal::new(self, &terms, of);
        folds.sets().iter().map(|set| normal.left_out(self.samples, set)).collect()
    }

    /// Expected square of the error at the samples' slow inputs and phases of any value: e² (1 + ⟨aᵀ(AᵀA + ρ²)⁻¹a⟩) with the root mean square error e of samples left out, the
    /// terms A at the samples and a at phases that are spread evenly. Where a body moves by nearly whole cells between samples, these see few phases, and e does not tell of
    /// the others.
    fn risk(&self, of: Complexity, folds: &Folds) -> f64 {
        let terms = self.terms(of);
        let normal = Normal::new(self, &terms, of);
        let left_out = |set: &Vec<usize>| Some(normal.left_out(self.samples, set)?.squared_norm_l2());
        let Some(sum) = folds.sets().iter().map(left_out).sum::<Option<f64>>() else { return f64::INFINITY };
        let count: usize = folds.sets().iter().map(Vec::len).sum();
        let m = self.samples.len();
        let rows: Vec<Vec<f64>> = (0..m).map(|j| terms.at(&self.elsewhere(j), None)).collect();
        let spread = Mat::from_fn(m, terms.len(), |j, c| rows[j][c]);
        match normal.variance(&spread) {
            Some(variance) if sum.is_finite() => sum / count as f64 * (1.0 + variance),
            _ => f64::INFINITY,
        }
    }
    /// Slow inputs of sample j with phases of a sequence that fills the torus evenly (multiples of square roots of primes).
    fn elsewhere(&self, j: usize) -> Vec<f64> {
        let slow = self.samples.point(j)[..self.slow].iter().copied();
        let phases = (self.samples.inputs() - self.slow) / 2;
        let turns =
            [2.0_f64, 3.0, 5.0].into_iter().cycle().take(phases).map(|p| (j as f64 * p.sqrt()).fract());
        slow.chain(turns.flat_map(|turn| [(TAU * turn).cos(), (TAU * turn).sin()])).collect()
    }

    /// The complexity with the smallest risk that steps from the simplest one lead to.
    pub(super) fn best(
        &self,
        folds: &Folds,
        observer: FitObserver<'_>,
    ) -> Result<Complexity, InterpolationError> {
        let (m, p) = (self.samples.len(), self.degree.get());
        let phases = self.samples.inputs() > self.slow;
        let mut known = HashMap::new();
        let mut error = |of: Complexity| -> Result<f64, InterpolationError> {
            let sensible = RIDGES.contains(&of.ridge)
                && (self.slow > 1 || of.parameters == 0)
                && (phases || of.harmonics == 0)
                && (of.harmonics > 0 || of.variation == 0)
                && of.pieces() + p <= self.times.len();
            if !sensible || self.terms(of).len() >= m {
                return Ok(f64::INFINITY);
            }
            if let Some(&risk) = known.get(&of) {
                return Ok(risk);
            }
            let risk = self.risk(of, folds);
            known.insert(of, risk);
            FitProgress::new(FitStage::Terms, known.len(), None).with_loss(risk).report(&mut *observer)?;
            Ok(risk)
        };
        let first = Complexity {
            pieces: 0,
            parameters: usize::from(self.slow > 1),
            variation: 0,
            harmonics: usize::from(phases),
            ridge: 4,
        };
        let mut best = (first, error(first)?);
        // Two at once where one alone is no gain: even and odd terms may do nothing by turns.
        let mut step = 1;
        while step <= 2 {
            let all = best.0.neighbours(step).map(|of| Ok((of, error(of)?)));
            let all = all.collect::<Result<Vec<_>, InterpolationError>>()?;
            match all.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)) {
                Some(next) if next.1 < GAIN * best.1 => (best, step) = (next, 1),
                _ => step += 1,
            }
        }
        if best.1.is_finite() {
            return Ok(best.0);
        }
        let needed = self.terms(first).len() + 1;
        let what = format!("a spline of degree {p} with {} phases", (self.samples.inputs() - self.slow) / 2);
        Err(InterpolationError::TooFew { what, of: "samples", needed, found: m })
    }
}

/// A step must lower the squares of errors by a hundredth at least.
const GAIN: f64 = 0.99;

/// AᵀA + ρ², and the right-hand sides AᵀY.
struct Normal {
    matrix: Mat<f64>,
    normal: Mat<f64>,
    right: Mat<f64>,
}

impl Normal {
    fn new(fit: &Fit<'_>, terms: &Terms, of: Complexity) -> Self {
        let matrix = fit.matrix(terms, 0);
        let mut normal = matrix.transpose() * &matrix;
        let ridge = Fit::ridge(&matrix, of).powi(2);
        (0..terms.len()).for_each(|c| normal[(c, c)] += ridge);
        let right = matrix.transpose() * fit.samples.values().transpose();
        Self { matrix, normal, right }
    }
    /// Errors at a set's samples by the coefficients of all others.
    fn left_out(&self, samples: &Samples, set: &[usize]) -> Option<Mat<f64>> {
        let part = Mat::from_fn(set.len(), self.normal.ncols(), |j, c| self.matrix[(set[j], c)]);
        let known = Mat::from_fn(set.len(), samples.outputs(), |j, row| samples.values()[(row, set[j])]);
        let normal = &self.normal - part.transpose() * &part;
        let mut solution = &self.right - part.transpose() * &known;
        let errors = |solution: Mat<f64>| (&part * &solution - known).transpose().to_owned();
        solve_positive(normal.as_ref(), solution.as_mut()).then(|| errors(solution))
    }
    /// Mean of aᵀ(AᵀA + ρ²)⁻¹a over rows a.
    fn variance(&self, rows: &Mat<f64>) -> Option<f64> {
        let moments = rows.transpose() * rows;
        let mut solution = moments;
        let solved = solve_positive(self.normal.as_ref(), solution.as_mut());
        solved.then(|| (0..solution.ncols()).map(|c| solution[(c, c)]).sum::<f64>() / rows.nrows() as f64)
    }
}
