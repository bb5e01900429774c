//! Shifts from the snapshots themselves.
use super::correlation::first_paths;
use super::dense::{columns, inner};
use super::fourier::Als;
use super::residual::{Observer, check_entries};
use super::waves::Waves;
use super::{Decomposition, FrameOperators, Grid, Motion, Motions, Progress, ShiftedError};
use interfaces::Vector;
use monomorphic::{Mat, MatRef, solve_positive};

/// Finds how frames move that nobody knows the motion of, along the periodic axes of a grid.
///
/// Averages of phase correlations between snapshots tell the speeds of several movers, as long as these differ and change little
/// from one snapshot to the next. The paths are polynomials in time, so they are smooth. They are improved by Gauss and Newton's method on the
/// error of the decomposition, ½ ‖Q − Σ T^k Q_k‖²: ∂/∂s T^s q = −T^s ∂q/∂x. All paths begin at zero, and nothing tells frames
/// from one another: the fastest is the first.
#[derive(Clone, Debug, PartialEq)]
pub struct ShiftEstimate {
    grid: Grid,
    ranks: Vec<usize>,
    degree: usize,
    tolerance: f64,
    max_steps: usize,
}

/// Of so many snapshots the shifts are told, the others lie in between.
const SOME: usize = 120;

impl ShiftEstimate {
    /// Of so many frames with one mode each, along polynomials of degree 5; until the error is 1e-9 or three steps lower it by less than a
    /// hundredth, 100 steps at most.
    #[must_use]
    pub fn new(grid: Grid, n_frames: usize) -> Self {
        Self { grid, ranks: vec![1; n_frames], degree: 5, tolerance: 1e-9, max_steps: 100 }
    }

    /// Modes of each frame, of which there are as many as ranks.
    #[must_use]
    pub fn ranks(mut self, ranks: impl Into<Vec<usize>>) -> Self {
        self.ranks = ranks.into();
        self
    }

    /// Of the paths as polynomials in time.
    #[must_use]
    pub fn degree(mut self, degree: usize) -> Self {
        self.degree = degree.max(1);
        self
    }

    /// Steps, at most.
    #[must_use]
    pub fn max_steps(mut self, steps: usize) -> Self {
        self.max_steps = steps;
        self
    }

    /// Tells the motions and the relative error that is left. The snapshots are taken to be equally far apart in time.
    ///
    /// # Errors
    /// [`ShiftedError::Empty`] of fewer than eight snapshots or no frames; [`ShiftedError::NotPeriodic`] if no axis with more than one
    /// cell is periodic; [`ShiftedError::Rows`], [`ShiftedError::NotFinite`].
    pub fn estimate(
        &self,
        snapshots: MatRef<'_, f64>,
        observer: Observer<'_>,
    ) -> Result<(Motions, f64), ShiftedError> {
        let (m, n) = snapshots.shape();
        let n_frames = self.ranks.len();
        if n < 8 || n_frames == 0 {
            return Err(ShiftedError::Empty { snapshots: n, frames: n_frames });
        }
        if m == 0 || !m.is_multiple_of(self.grid.n_cells()) {
            return Err(ShiftedError::Rows { rows: m, cells: self.grid.n_cells() });
        }
        check_entries(snapshots)?;
        let axes: Vec<_> = (0..3).filter(|&a| self.grid.cells()[a] > 1 && self.grid.periodic()[a]).collect();
        if axes.is_empty() {
            return Err(ShiftedError::NotPeriodic { frame: 0, snapshot: 0, axis: 0, distance: 0.0 });
        }
        let count = n.min(SOME);
        let some: Vec<usize> = (0..count).map(|i| i * (n - 1) / (count - 1)).collect();
        let few = Mat::from_fn(m, count, |i, j| snapshots[(i, some[j])]);
        let basis = Basis { degree: self.degree.min(count - 1) };
        // From −1 to 1.
        let times: Vec<f64> = some.iter().map(|&j| 2.0 * j as f64 / (n - 1) as f64 - 1.0).collect();
        let mut paths = first_paths(&self.grid, &axes, few.as_ref(), n_frames, &times, &basis);
        let refinement = Refinement { estimate: self, axes: &axes, few: &few, times: &times, basis: &basis };
        let error = refinement.refine(&mut paths, observer)?;
        let all = |k: usize, j: usize| paths.motion(k, 2.0 * j as f64 / (n - 1) as f64 - 1.0, &axes, &basis);
        Ok((Motions::by(n_frames, n, all), error))
    }
}

/// Polynomials that vanish at −1: T_p(x) − T_p(−1).
pub(super) struct Basis {
    pub(super) degree: usize,
}

impl Basis {
    /// Those of degree 1 and more.
    pub(super) fn values(&self, x: f64) -> Vec<f64> {
        let (mut before, mut now) = (1.0, x);
        let mut values = Vec::with_capacity(self.degree);
        for p in 1..=self.degree {
            values.push(now - if p % 2 == 0 { 1.0 } else { -1.0 });
            (before, now) = (now, 2.0 * x * now - before);
        }
        values
    }
}

/// Coefficients of the basis for each frame and axis.
#[derive(Clone)]
pub(super) struct Paths {
    pub(super) coefficients: Vec<Vec<Vec<f64>>>,
}

impl Paths {
    fn motion(&self, k: usize, time: f64, axes: &[usize], basis: &Basis) -> Motion {
        let values = basis.values(time);
        let mut s = Vector::zeros();
        for (c, &a) in self.coefficients[k].iter().zip(axes) {
            s[a] = c.iter().zip(&values).map(|(c, v)| c * v).sum();
        }
        Motion::translation(s)
    }
}

struct Refinement<'a> {
    estimate: &'a ShiftEstimate,
    axes: &'a [usize],
    few: &'a Mat<f64>,
    times: &'a [f64],
    basis: &'a Basis,
}

impl Refinement<'_> {
    fn refine(&self, paths: &mut Paths, observer: Observer<'_>) -> Result<f64, ShiftedError> {
        let (mut d, mut error) = self.fit(paths, None)?;
        let mut damping = 1e-6;
        let mut errors = vec![error];
        for step in 1..=self.estimate.max_steps {
            let direction = self.direction(paths, &d, damping);
            let mut trial = paths.clone();
            let all = trial.coefficients.iter_mut().flatten().flatten();
            all.zip(direction).for_each(|(c, x)| *c += x);
            let (better, after) = self.fit(&trial, Some(&d))?;
            if after < error {
                (*paths, d, error) = (trial, better, after);
                damping = (damping / 10.0_f64).max(1e-9);
            } else {
                damping *= 10.0;
            }
            errors.push(error);
            let progress = Progress { step, error, rank: self.estimate.ranks.iter().sum() };
            let stagnant = errors.len() > 3 && error > 0.99 * errors[errors.len() - 4];
            if observer(&progress).is_break() || error <= self.estimate.tolerance || stagnant || damping > 1e6
            {
                break;
            }
        }
        Ok(error)
    }

    fn motions(&self, paths: &Paths) -> Motions {
        let at = |k: usize, j: usize| paths.motion(k, self.times[j], self.axes, self.basis);
        Motions::by(self.estimate.ranks.len(), self.times.len(), at)
    }

    fn fit(
        &self,
        paths: &Paths,
        start: Option<&Decomposition>,
    ) -> Result<(Decomposition, f64), ShiftedError> {
        let als =
            Als { max_steps: 30, tolerance: self.estimate.tolerance, ..Als::new(&self.estimate.ranks[..]) };
        let shifts = self.motions(paths);
        let d = als.solve(&self.estimate.grid, &shifts, self.few.as_ref(), start, None, &mut |_| true)?;
        let error = d.history.last().map_or(0.0, |p| p.error);
        Ok((d, error))
    }

    /// How the coefficients should change, with Levenberg's and Marquardt's damping.
    fn direction(&self, paths: &Paths, d: &Decomposition, damping: f64) -> Vec<f64> {
        let shifts = self.motions(paths);
        let waves = Waves::along(&self.estimate.grid, self.axes.to_vec(), &shifts, self.few.nrows());
        let mut residual = waves.waves(self.few.as_ref());
        let mut slopes = Vec::new();
        for (k, frame) in d.frames.iter().enumerate() {
            let modes = waves.waves(frame.modes.as_ref());
            let mut field = &modes * frame.scaled_coefficients();
            for &a in self.axes {
                let mut slope = field.clone();
                waves.differentiate(a, &mut slope);
                waves.to_lab(k, slope.as_mut());
                slopes.push(slope);
            }
            waves.to_lab(k, field.as_mut());
            residual -= field;
        }
        // One unknown per path and polynomial, and a constant that the modes take over.
        let (q, p) = (slopes.len(), self.basis.degree + 1);
        let mut matrix = Mat::<f64>::zeros(q * p, q * p);
        let mut right = Mat::<f64>::zeros(q * p, 1);
        for (j, &time) in self.times.iter().enumerate() {
            let mut values = self.basis.values(time);
            values.push(1.0);
            let column = |m: &Mat<f64>| m.subcols(j, 1).to_owned();
            let here: Vec<_> = slopes.iter().map(column).collect();
            let left = column(&residual);
            for a in 0..q {
                let push = -inner(here[a].as_ref(), left.as_ref());
                (0..p).for_each(|i| right[(a * p + i, 0)] += push * values[i]);
                for b in 0..=a {
                    let product = inner(here[a].as_ref(), here[b].as_ref());
                    for i in 0..p {
                        for l in 0..p {
                            let x = product * values[i] * values[l];
                            matrix[(a * p + i, b * p + l)] += x;
                            if a != b {
                                matrix[(b * p + l, a * p + i)] += x;
                            }
                        }
                    }
                }
            }
        }
        let largest = (0..q * p).map(|i| matrix[(i, i)]).fold(f64::MIN_POSITIVE, f64::max);
        (0..q * p).for_each(|i| matrix[(i, i)] += damping * matrix[(i, i)] + 1e-12 * largest);
        if !solve_positive(matrix.as_ref(), right.as_mut()) {
            columns(&mut right).into_iter().for_each(|c| c.fill(0.0));
        }
        (0..q * p).filter(|i| i % p < p - 1).map(|i| right[(i, 0)]).collect()
    }
}
