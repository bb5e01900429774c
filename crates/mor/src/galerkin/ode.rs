//! Ordinary differential equations: Dormand and Prince's method of order 5 with steps by its own error.
use crate::Mat;

/// y′ = f(t, y).
pub trait Ode {
    /// Unknowns.
    fn n(&self) -> usize;
    /// f(t, y) into `out`.
    fn rate(&self, t: f64, y: &[f64], out: &mut [f64]);
}

/// Why an equation could not be integrated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OdeError {
    /// Two sizes that must agree do not.
    #[error("{what}: {found} were given, {expected} are needed")]
    Shape {
        /// Of what.
        what: &'static str,
        /// How many there must be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// Times must be finite and not fall.
    #[error("time {index} is {time} after {before}; give finite times in ascending order")]
    Times {
        /// Which, from 0.
        index: usize,
        /// The time.
        time: f64,
        /// The one before.
        before: f64,
    },
    /// A tolerance that is none.
    #[error(
        "the tolerances are {relative} (relative) and {absolute}; both must be finite, not negative and not both 0"
    )]
    Tolerance {
        /// Relative.
        relative: f64,
        /// Absolute.
        absolute: f64,
    },
    /// The solution grows beyond all numbers.
    #[error(
        "the solution is not finite soon after t = {time}, at steps of {step:e}; the model is unstable there: take more modes, or a model with dissipation"
    )]
    NotFinite {
        /// Last time at which all was well.
        time: f64,
        /// The step.
        step: f64,
    },
    /// Steps get too short or too many.
    #[error(
        "{steps} steps were made up to t = {time}, the last of {step:e}; the equation is stiff or has a jump there, or the tolerances are too small"
    )]
    Steps {
        /// Where.
        time: f64,
        /// The last step.
        step: f64,
        /// How many.
        steps: u64,
    },
}

/// Dormand and Prince's pair of orders 5 and 4 (J. Comput. Appl. Math. 6 (1980) 19) with its continuous extension of order 4 (Hairer, Nørsett and Wanner, *Solving
/// Ordinary Differential Equations I*, section II.6): the root mean square of error/(absolute + relative·|y|) of a step is kept below 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DormandPrince {
    /// Relative tolerance.
    pub relative: f64,
    /// Absolute tolerance, in the unit of y.
    pub absolute: f64,
    /// Most steps.
    pub most_steps: u64,
}

/// To nine digits.
impl Default for DormandPrince {
    fn default() -> Self {
        Self { relative: 1e-9, absolute: 1e-12, most_steps: 10_000_000 }
    }
}

/// Nodes, weights of the stages (the last row is the step itself), of the error and of the continuous extension.
const C: [f64; 7] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];
const A: [&[f64]; 7] = [
    &[],
    &[0.2],
    &[3.0 / 40.0, 9.0 / 40.0],
    &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
    &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
    &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
    &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
const ERROR: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339_200.0, 22.0 / 525.0, -1.0 / 40.0];
const DENSE: [f64; 7] = [
    -12_715_105_075.0 / 11_282_082_432.0,
    0.0,
    87_487_479_700.0 / 32_700_410_799.0,
    -10_690_763_975.0 / 1_880_347_072.0,
    701_980_252_875.0 / 199_316_789_632.0,
    -1_453_857_185.0 / 822_651_844.0,
    69_997_945.0 / 29_380_423.0,
];

impl DormandPrince {
    /// y at `times`, one column each, from `start` at the first of them.
    ///
    /// # Errors
    /// [`OdeError`]; nothing is returned but the time up to which all went well.
    pub fn solve(&self, ode: &dyn Ode, start: &[f64], times: &[f64]) -> Result<Mat<f64>, OdeError> {
        let n = ode.n();
        if start.len() != n {
            return Err(OdeError::Shape { what: "unknowns at the start", expected: n, found: start.len() });
        }
        let ok = |tolerance: f64| tolerance.is_finite() && tolerance >= 0.0;
        if !(ok(self.relative) && ok(self.absolute) && self.relative + self.absolute > 0.0) {
            return Err(OdeError::Tolerance { relative: self.relative, absolute: self.absolute });
        }
        for (index, pair) in (1..).zip(times.windows(2)) {
            if !(pair[1] >= pair[0] && pair[1].is_finite()) {
                return Err(OdeError::Times { index, time: pair[1], before: pair[0] });
            }
        }
        let mut out = Mat::zeros(n, times.len());
        let (Some(&first), Some(&end)) = (times.first(), times.last()) else { return Ok(out) };
        if !first.is_finite() {
            return Err(OdeError::Times { index: 0, time: first, before: first });
        }
        let mut k = vec![vec![0.0; n]; 7];
        let (mut t, mut y) = (first, start.to_vec());
        ode.rate(t, &y, &mut k[0]);
        let mut h = self.first_step(ode, t, &y, &k[0], end - t);
        let (mut next, mut steps, mut column) = (vec![0.0; n], 0, 0);
        while column < times.len() && times[column] <= t {
            out.col_as_slice_mut(column).copy_from_slice(&y);
            column += 1;
        }
        // Of the error of the last step, for the controller.
        let mut before = 1e-4_f64;
        while column < times.len() {
            steps += 1;
            let stuck = h <= 16.0 * f64::EPSILON * t.abs().max(end - first);
            if steps > self.most_steps || stuck {
                return Err(OdeError::Steps { time: t, step: h, steps });
            }
            h = h.min(end - t);
            for s in 1..7 {
                for i in 0..n {
                    let sum: f64 = A[s].iter().zip(&k).map(|(a, k)| a * k[i]).sum();
                    next[i] = y[i] + h * sum;
                }
                let (done, rest) = k.split_at_mut(s);
                debug_assert_eq!(done.len(), s);
                ode.rate(t + C[s] * h, &next, &mut rest[0]);
            }
            let error = self.error(h, &k, &y, &next);
            if !error.is_finite() {
                // Perhaps a shorter step stays with the numbers.
                if h <= 1e-10 * (end - first) {
                    return Err(OdeError::NotFinite { time: t, step: h });
                }
                h *= 0.1;
                continue;
            }
            let factor = 0.9 * error.max(1e-10).powf(-0.17) * before.powf(0.04);
            if error > 1.0 {
                h *= factor.clamp(0.2, 0.9);
                continue;
            }
            while column < times.len() && times[column] <= t + h * (1.0 + 4.0 * f64::EPSILON) {
                let share = ((times[column] - t) / h).min(1.0);
                let to = out.col_as_slice_mut(column);
                for i in 0..n {
                    to[i] = within(share, h, [y[i], next[i]], |s| k[s][i]);
                }
                column += 1;
            }
            t += h;
            std::mem::swap(&mut y, &mut next);
            k.swap(0, 6);
            before = error.max(1e-4);
            h *= factor.clamp(0.2, 10.0);
        }
        Ok(out)
    }

    fn scale(&self, y: f64) -> f64 {
        self.absolute + self.relative * y.abs()
    }

    fn error(&self, h: f64, k: &[Vec<f64>], y: &[f64], next: &[f64]) -> f64 {
        let square = |i: usize| {
            let off: f64 = ERROR.iter().zip(k).map(|(e, k)| e * k[i]).sum();
            (h * off / self.scale(y[i].abs().max(next[i].abs())).max(f64::MIN_POSITIVE)).powi(2)
        };
        ((0..y.len()).map(square).sum::<f64>() / y.len().max(1) as f64).sqrt()
    }

    /// Hairer, Nørsett and Wanner, section II.4: the second derivative is that of an explicit Euler step.
    fn first_step(&self, ode: &dyn Ode, t: f64, y: &[f64], rate: &[f64], span: f64) -> f64 {
        let norm = |v: &dyn Fn(usize) -> f64| {
            let sum = (0..y.len()).map(|i| (v(i) / self.scale(y[i]).max(f64::MIN_POSITIVE)).powi(2));
            (sum.sum::<f64>() / y.len().max(1) as f64).sqrt()
        };
        let (size, slope) = (norm(&|i| y[i]), norm(&|i| rate[i]));
        let small = size < 1e-5 || slope < 1e-5;
        let h = (if small { 1e-6 } else { 0.01 * size / slope }).min(span);
        let moved: Vec<f64> = y.iter().zip(rate).map(|(y, k)| y + h * k).collect();
        let mut there = vec![0.0; y.len()];
        ode.rate(t + h, &moved, &mut there);
        let bend = norm(&|i| (there[i] - rate[i]) / h.max(f64::MIN_POSITIVE));
        let most = slope.max(bend);
        let by_error = if most <= 1e-15 { (1e-3 * h).max(1e-6) } else { (0.01 / most).powf(0.2) };
        let step = (100.0 * h).min(by_error).min(span);
        if step.is_finite() { step } else { 1e-6 * span }
    }
}

/// The continuous extension.
fn within(share: f64, h: f64, [y, next]: [f64; 2], k: impl Fn(usize) -> f64) -> f64 {
    let rest = 1.0 - share;
    let way = next - y;
    let first = h * k(0) - way;
    let last = way - h * k(6) - first;
    let dense: f64 = DENSE.iter().enumerate().map(|(s, d)| d * k(s)).sum();
    y + share * (way + rest * (first + share * (last + rest * h * dense)))
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Given<F: Fn(f64, &[f64], &mut [f64])>(usize, F);

    impl<F: Fn(f64, &[f64], &mut [f64])> Ode for Given<F> {
        fn n(&self) -> usize {
            self.0
        }
        fn rate(&self, t: f64, y: &[f64], out: &mut [f64]) {
            (self.1)(t, y, out);
        }
    }

    fn times(n: usize, end: f64) -> Vec<f64> {
        (0..=n).map(|i| end * i as f64 / n as f64).collect()
    }

    #[test]
    fn circles_and_growth() {
        let ode = Given(3, |t: f64, y: &[f64], out: &mut [f64]| {
            out.copy_from_slice(&[y[1], -y[0], (t.cos() - t.sin()) * y[2]]);
        });
        let times = times(317, 20.0);
        for relative in [1e-6, 1e-9, 1e-12] {
            let solver = DormandPrince { relative, absolute: 1e-3 * relative, ..Default::default() };
            let y = solver.solve(&ode, &[0.0, 1.0, 1.0], &times).unwrap();
            let mut off = 0.0_f64;
            for (j, t) in times.iter().enumerate() {
                let exact = [t.sin(), t.cos(), (t.sin() + t.cos() - 1.0).exp()];
                off = (0..3).map(|i| (y[(i, j)] - exact[i]).abs()).fold(off, f64::max);
            }
            assert!(off < 100.0 * relative && off > 1e-3 * relative, "{relative}: {off}");
        }
    }

    /// Polynomials of degree 5 are exact at the ends of steps, of degree 4 everywhere.
    #[test]
    fn polynomials_are_exact() {
        for (degree, least) in [(4, 1e-13), (5, 1e-6)] {
            let ode = Given(1, |t: f64, _: &[f64], out: &mut [f64]| {
                out[0] = f64::from(degree) * t.powi(degree - 1)
            });
            let y = DormandPrince::default().solve(&ode, &[0.0], &times(50, 2.0)).unwrap();
            let off =
                (0..=50).map(|j| (y[(0, j)] - (j as f64 / 25.0).powi(degree)).abs()).fold(0.0, f64::max);
            assert!(off < least, "{degree}: {off}");
            assert!((y[(0, 50)] - 2.0_f64.powi(degree)).abs() < 1e-12);
        }
    }

    #[test]
    fn what_cannot_be_integrated_is_told() {
        let solver = DormandPrince::default();
        let burst = Given(1, |_: f64, y: &[f64], out: &mut [f64]| out[0] = y[0] * y[0]);
        match solver.solve(&burst, &[1.0], &times(10, 2.0)) {
            Err(OdeError::NotFinite { time, .. } | OdeError::Steps { time, .. }) => {
                assert!((time - 1.0).abs() < 1e-3, "{time}")
            }
            other => panic!("{other:?}"),
        }
        let few = DormandPrince { most_steps: 3, ..solver };
        let fine = Given(1, |_: f64, y: &[f64], out: &mut [f64]| out[0] = -y[0]);
        assert!(matches!(few.solve(&fine, &[1.0], &times(10, 2.0)), Err(OdeError::Steps { steps: 4, .. })));
        assert!(matches!(
            solver.solve(&fine, &[1.0], &[0.0, 1.0, 0.5]),
            Err(OdeError::Times { index: 2, .. })
        ));
        assert!(matches!(solver.solve(&fine, &[1.0], &[f64::NAN]), Err(OdeError::Times { .. })));
        assert!(matches!(solver.solve(&fine, &[], &[0.0, 1.0]), Err(OdeError::Shape { .. })));
        let senseless = DormandPrince { relative: -1.0, ..solver };
        assert!(matches!(senseless.solve(&fine, &[1.0], &[0.0]), Err(OdeError::Tolerance { .. })));
        assert_eq!(solver.solve(&fine, &[1.0], &[]).unwrap().ncols(), 0);
        assert_eq!(solver.solve(&fine, &[1.0], &[2.0, 2.0]).unwrap()[(0, 1)], 1.0);
    }
}
