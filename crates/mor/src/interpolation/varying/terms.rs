//! Terms of a varying-coefficient function.
use crate::interpolation::spline::Axis;
use crate::interpolation::{Record, RecordError};

/// Highest degree and harmonic that a record may have.
const MOST: usize = 64;

/// B_b(t) P_j(μ), and T_f(θ) P_i(t, μ) with f ≥ 1: each a product of one function of every slow input and of every phase.
#[derive(Clone, Debug)]
pub(super) struct Terms {
    axis: Axis,
    /// Of the slow inputs.
    domain: Vec<[f64; 2]>,
    phases: usize,
    /// r₀, r₁ and q.
    degrees: [usize; 3],
    /// Degrees in μ of the terms with B-splines.
    parameters: Vec<Vec<usize>>,
    /// Degrees in (t, μ) of the others.
    slow: Vec<Vec<usize>>,
    /// For every phase the harmonic k, and whether it is sin kθ; not all zero.
    waves: Vec<Vec<(usize, bool)>>,
}

impl Terms {
    /// Degrees: r₀, r₁ and q; `domain` of the slow inputs.
    pub(super) fn new(axis: Axis, domain: &[[f64; 2]], phases: usize, degrees: [usize; 3]) -> Self {
        let [parameters, slow, harmonics] = degrees;
        let waves = multi_indices(phases, harmonics).into_iter().skip(1).flat_map(|k| {
            let each = |done: Vec<Vec<(usize, bool)>>, k: usize| -> Vec<Vec<(usize, bool)>> {
                let kinds: &[bool] = if k == 0 { &[false] } else { &[false, true] };
                let with = |wave: &Vec<(usize, bool)>, sine: bool| [wave.as_slice(), &[(k, sine)]].concat();
                done.iter().flat_map(|wave| kinds.iter().map(move |&sine| with(wave, sine))).collect()
            };
            k.into_iter().fold(vec![vec![]], each)
        });
        Self {
            axis,
            domain: domain.to_vec(),
            phases,
            degrees,
            parameters: multi_indices(domain.len() - 1, parameters),
            slow: multi_indices(domain.len(), slow),
            waves: waves.collect(),
        }
    }
    pub(super) fn len(&self) -> usize {
        self.axis.len() * self.parameters.len() + self.waves.len() * self.slow.len()
    }

    /// Every term at x, or its derivative by the input `along`.
    pub(super) fn at(&self, x: &[f64], along: Option<usize>) -> Vec<f64> {
        let (slow, [parameters, variation, harmonics]) = (self.domain.len(), self.degrees);
        let span = self.axis.span(x[0]);
        let basis = if along == Some(0) { self.axis.slopes(span, x[0]) } else { self.axis.values(span, x[0]) };
        let mut splines = vec![0.0; self.axis.len()];
        splines[span - self.axis.degree..=span].copy_from_slice(&basis[..=self.axis.degree]);
        let polynomials: Vec<Vec<f64>> = (0..slow)
            .map(|i| legendre(x[i], self.domain[i], parameters.max(variation), along == Some(i)))
            .collect();
        let waves: Vec<Vec<[f64; 2]>> = (0..self.phases)
            .map(|a| {
                let first = slow + 2 * a;
                powers([x[first], x[first + 1]], harmonics, along.and_then(|i| i.checked_sub(first)))
            })
            .collect();
        let mut terms = Vec::with_capacity(self.len());
        // Along a phase g₀ is constant.
        let constant = if along.is_some_and(|i| i >= slow) { 0.0 } else { 1.0 };
        for degrees in &self.parameters {
            let factor: f64 = degrees.iter().enumerate().map(|(i, &n)| polynomials[i + 1][n]).product();
            terms.extend(splines.iter().map(|b| constant * factor * b));
        }
        for wave in &self.waves {
            let factor: f64 = wave.iter().enumerate().map(|(a, &(k, sine))| waves[a][k][usize::from(sine)]).product();
            let of = |degrees: &Vec<usize>| -> f64 {
                degrees.iter().enumerate().map(|(i, &n)| polynomials[i][n]).product()
            };
            terms.extend(self.slow.iter().map(|degrees| factor * of(degrees)));
        }
        terms
    }

    pub(super) fn record(&self, record: Record) -> Record {
        record
            .with("degree", [self.axis.degree as f64])
            .with("knots", self.axis.knots.iter().copied())
            .with("slow", [self.domain.len() as f64])
            .with("degrees", self.degrees.map(|n| n as f64))
    }
    pub(super) fn from_record(record: &Record, domain: &[[f64; 2]]) -> Result<Self, RecordError> {
        let axis = Axis::from_record(record, "knots", record.count("degree")?)?;
        let slow = record.count("slow")?;
        if slow == 0 || slow > domain.len() || (domain.len() - slow) % 2 == 1 {
            return Err(record.wrong("slow", format!("is {slow} of {} inputs", domain.len())));
        }
        match record.counts("degrees")?[..] {
            [a, b, c] if a.max(b).max(c) <= MOST => {
                Ok(Self::new(axis, &domain[..slow], (domain.len() - slow) / 2, [a, b, c]))
            }
            _ => Err(record.wrong("degrees", format!("are not three up to {MOST}"))),
        }
    }
}

/// All vectors of whole numbers with a sum up to `degree`, that of zeros first.
fn multi_indices(variables: usize, degree: usize) -> Vec<Vec<usize>> {
    (0..variables).fold(vec![vec![]], |done: Vec<Vec<usize>>, _| {
        let rest = |index: &Vec<usize>| degree - index.iter().sum::<usize>();
        done.iter().flat_map(|index| (0..=rest(index)).map(move |n| [index.as_slice(), &[n]].concat())).collect()
    })
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

/// cos kθ and sin kθ for k = 0 … `most` as polynomials of c = cos θ and s = sin θ, or their derivatives by c (`along` 0) or s (1).
fn powers([c, s]: [f64; 2], most: usize, along: Option<usize>) -> Vec<[f64; 2]> {
    let mut z = vec![[1.0, 0.0]];
    for k in 0..most {
        let [re, im] = z[k];
        z.push([re * c - im * s, re * s + im * c]);
    }
    // d zᵏ/dc = k zᵏ⁻¹, d zᵏ/ds = i k zᵏ⁻¹.
    let slope = |k: usize, turned: bool| match k.checked_sub(1) {
        None => [0.0; 2],
        Some(lower) => {
            let [re, im] = z[lower].map(|v| k as f64 * v);
            if turned { [-im, re] } else { [re, im] }
        }
    };
    match along {
        Some(0) => (0..=most).map(|k| slope(k, false)).collect(),
        Some(1) => (0..=most).map(|k| slope(k, true)).collect(),
        _ => z,
    }
}
