//! Terms of a varying-coefficient function.
use crate::interpolation::spline::Axis;
use crate::interpolation::waves::{Waves, multi_indices};
use crate::interpolation::{Record, RecordError};

/// B_b(t) P_j(μ), and T_f(θ) P_i(t, μ) with f ≥ 1: each a product of one function of every slow input and of every phase.
#[derive(Clone, Debug)]
pub(super) struct Terms {
    axis: Axis,
    /// Of the slow inputs.
    domain: Vec<[f64; 2]>,
    /// r₀ and r₁.
    degrees: [usize; 2],
    /// Degrees in μ of the terms with B-splines.
    parameters: Vec<Vec<usize>>,
    /// Degrees in (t, μ) of the others.
    slow: Vec<Vec<usize>>,
    waves: Waves,
}

impl Terms {
    /// Degrees: r₀, r₁ and q; `domain` of the slow inputs.
    pub(super) fn new(axis: Axis, domain: &[[f64; 2]], phases: usize, degrees: [usize; 3]) -> Self {
        let [parameters, slow, harmonics] = degrees;
        Self {
            axis,
            domain: domain.to_vec(),
            degrees: [parameters, slow],
            parameters: multi_indices(domain.len() - 1, parameters),
            slow: multi_indices(domain.len(), slow),
            waves: Waves::new(phases, harmonics),
        }
    }
    pub(super) fn len(&self) -> usize {
        self.axis.len() * self.parameters.len() + self.waves.len() * self.slow.len()
    }

    /// Functions T_f, f ≥ 1.
    pub(super) fn waves(&self) -> &Waves {
        &self.waves
    }
    /// g_f(u), f ≥ 1, of an output with these coefficients.
    pub(super) fn amplitudes(&self, u: &[f64], coefficients: impl Fn(usize) -> f64) -> Vec<f64> {
        let (n, first) = (self.slow.len(), self.axis.len() * self.parameters.len());
        let polynomials: Vec<Vec<f64>> =
            (0..u.len()).map(|i| legendre(u[i], self.domain[i], self.degrees[1], false)).collect();
        let value = |degrees: &Vec<usize>| -> f64 {
            degrees.iter().enumerate().map(|(i, &n)| polynomials[i][n]).product()
        };
        let of = |f: usize| {
            self.slow
                .iter()
                .enumerate()
                .map(|(i, degrees)| value(degrees) * coefficients(first + f * n + i))
                .sum()
        };
        (0..self.waves.len()).map(of).collect()
    }

    /// Every term at x, or its derivative by the input `along`.
    pub(super) fn at(&self, x: &[f64], along: Option<usize>) -> Vec<f64> {
        let (slow, [parameters, variation]) = (self.domain.len(), self.degrees);
        let span = self.axis.span(x[0]);
        let basis =
            if along == Some(0) { self.axis.slopes(span, x[0]) } else { self.axis.values(span, x[0]) };
        let mut splines = vec![0.0; self.axis.len()];
        splines[span - self.axis.degree..=span].copy_from_slice(&basis[..=self.axis.degree]);
        let polynomials: Vec<Vec<f64>> = (0..slow)
            .map(|i| legendre(x[i], self.domain[i], parameters.max(variation), along == Some(i)))
            .collect();
        let mut terms = Vec::with_capacity(self.len());
        // Along a phase g₀ is constant.
        let constant = if along.is_some_and(|i| i >= slow) { 0.0 } else { 1.0 };
        for degrees in &self.parameters {
            let factor: f64 = degrees.iter().enumerate().map(|(i, &n)| polynomials[i + 1][n]).product();
            terms.extend(splines.iter().map(|b| constant * factor * b));
        }
        let waves = self.waves.at(&x[slow..], along.and_then(|i| i.checked_sub(slow)));
        let of = |degrees: &Vec<usize>| -> f64 {
            degrees.iter().enumerate().map(|(i, &n)| polynomials[i][n]).product()
        };
        let slow: Vec<f64> = self.slow.iter().map(of).collect();
        for wave in waves {
            terms.extend(slow.iter().map(|polynomial| wave * polynomial));
        }
        terms
    }

    pub(super) fn record(&self, record: Record) -> Record {
        record
            .with("degree", [self.axis.degree as f64])
            .with("knots", self.axis.knots.iter().copied())
            .with("slow", [self.domain.len() as f64])
            .with("degrees", self.degrees.into_iter().chain([self.waves.harmonics()]).map(|n| n as f64))
    }
    pub(super) fn from_record(record: &Record, domain: &[[f64; 2]]) -> Result<Self, RecordError> {
        let axis = Axis::from_record(record, "knots", record.count("degree")?)?;
        let slow = record.count("slow")?;
        if slow == 0 || slow > domain.len() || (domain.len() - slow) % 2 == 1 {
            return Err(record.wrong("slow", format!("is {slow} of {} inputs", domain.len())));
        }
        match record.counts("degrees")?[..] {
            [a, b, c] if a.max(b).max(c) <= Waves::MOST => {
                Ok(Self::new(axis, &domain[..slow], (domain.len() - slow) / 2, [a, b, c]))
            }
            _ => Err(record.wrong("degrees", format!("are not three up to {}", Waves::MOST))),
        }
    }
}

/// Legendre's polynomials of the input scaled to [−1, 1], or their derivatives by the input.
fn legendre(x: f64, [low, high]: [f64; 2], degree: usize, slopes: bool) -> Vec<f64> {
    let factor = if high > low { 2.0 / (high - low) } else { 0.0 };
    let z = factor * (x - low) - f64::from(u8::from(factor > 0.0));
    let (mut p, mut d) = (vec![1.0, z], vec![0.0, factor]);
    for n in 1..degree {
        let k = n as f64;
        p.push(((2.0 * k + 1.0) * z * p[n] - k * p[n - 1]) / (k + 1.0));
        d.push(d[n - 1] + (2.0 * k + 1.0) * factor * p[n]);
    }
    if slopes { d } else { p }
}
