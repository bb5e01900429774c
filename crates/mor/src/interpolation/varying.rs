//! Linear in some inputs, with coefficients that vary with the first one.
use super::interpolator::check_input;
use super::scaling::ranges;
use super::spline::Axis;
use super::{Degree, InterpolationError, Interpolator, Method, Record, RecordError, Samples};
use crate::Mat;
use monomorphic::Qr;

/// How to make a [`Varying`] function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VaryingParams {
    /// Of the splines g.
    pub degree: Degree,
    /// Pieces of the splines; by generalised cross-validation if it is `None`.
    pub pieces: Option<usize>,
}

/// Quintic splines with as many pieces as generalised cross-validation finds.
impl Default for VaryingParams {
    fn default() -> Self {
        Self { degree: Degree::Quintic, pieces: None }
    }
}

/// y(t, z) = g₀(t) + Σ_f z_f g_f(t), the splines g nearest to the samples in the mean square: a varying-coefficient model (Hastie and Tibshirani, J. R. Stat. Soc. B
/// 55 (1993) 757). t is the first input.
///
/// With z = (cos 2πs/h, sin 2πs/h) of a displacement s(t) it follows what a grid of spacing h does to a body that moves across it, however fast: time alone cannot tell
/// that from anything else when s grows by more than h/2 between snapshots. Where the samples do not tell the g apart, the smallest are taken (ridge, 1e-7 of the
/// largest). Knots are at the quantiles of t, their number from the least m |r|²/(m − p)², p unknowns in all (Golub, Heath and Wahba, Technometrics 21 (1979) 215).
#[derive(Clone, Debug)]
pub struct Varying {
    axis: Axis,
    /// k × (B-splines · d), all of g₀ first.
    coefficients: Mat<f64>,
    domain: Vec<[f64; 2]>,
}

/// Relative weight of the ridge.
const RIDGE: f64 = 1e-7;
/// Numbers of pieces grow by this factor from trial to trial.
const GROWTH: f64 = 1.5;

impl VaryingParams {
    /// The function near the samples.
    ///
    /// # Errors
    /// [`InterpolationError::TooFew`].
    pub fn varying(&self, samples: &Samples) -> Result<Varying, InterpolationError> {
        let (m, d, p) = (samples.len(), samples.inputs(), self.degree.get());
        let times = samples.distinct(0);
        let too_few = |pieces: usize| InterpolationError::TooFew {
            what: format!("{d} splines of degree {p} with {pieces} pieces"),
            of: "samples at different first inputs",
            needed: d * (pieces + p) + 1,
            found: times.len(),
        };
        let fits = |pieces: usize| d * (pieces + p) < times.len();
        if let Some(pieces) = self.pieces {
            return if fits(pieces) && pieces > 0 {
                Ok(self.with_pieces(samples, &times, pieces).0)
            } else {
                Err(too_few(pieces.max(1)))
            };
        }
        let mut best: Option<(f64, Varying)> = None;
        let mut pieces = 1;
        while fits(pieces) {
            let (found, rest) = self.with_pieces(samples, &times, pieces);
            let free = (m - d * (pieces + p)) as f64;
            let score = m as f64 * rest / (free * free);
            if best.as_ref().is_none_or(|(least, _)| score < *least) {
                best = Some((score, found));
            }
            pieces = (pieces + 1).max((pieces as f64 * GROWTH).round() as usize);
        }
        best.map(|(_, found)| found).ok_or_else(|| too_few(1))
    }

    /// The function of that many pieces, and Σ|r|².
    fn with_pieces(&self, samples: &Samples, times: &[f64], pieces: usize) -> (Varying, f64) {
        let (m, d, k, p) = (samples.len(), samples.inputs(), samples.outputs(), self.degree.get());
        let [first, last] = [times[0], times[times.len() - 1]];
        let mut knots = vec![first; p + 1];
        knots.extend((1..pieces).map(|i| {
            let at = (i * (times.len() - 1)) as f64 / pieces as f64;
            let before = at as usize;
            times[before] + at.fract() * (times[(before + 1).min(times.len() - 1)] - times[before])
        }));
        knots.extend(vec![last; p + 1]);
        let axis = Axis { degree: p, knots };
        let unknowns = d * axis.len();
        let mut rows = Mat::zeros(m + unknowns, unknowns);
        let mut x = vec![0.0; d];
        for j in 0..m {
            x.iter_mut().enumerate().for_each(|(i, x)| *x = samples.points()[(i, j)]);
            each_factor(&axis, &x, None, |column, factor| rows[(j, column)] = factor);
        }
        let largest = (0..unknowns).map(|c| rows.col(c).norm_l2()).fold(0.0, f64::max);
        (0..unknowns).for_each(|c| rows[(m + c, c)] = RIDGE * largest);
        let mut right =
            Mat::from_fn(m + unknowns, k, |j, row| if j < m { samples.values()[(row, j)] } else { 0.0 });
        Qr::new(rows).solve(right.as_mut());
        let rest = right.as_ref().subrows(unknowns, m).norm_l2().powi(2);
        let coefficients = Mat::from_fn(k, unknowns, |row, c| right[(c, row)]);
        (Varying { axis, coefficients, domain: ranges(samples.points()) }, rest)
    }
}

/// Calls `each` with a column of the coefficients and the factor it has at x, or what `along` makes of it if that is an input to differentiate by.
fn each_factor(axis: &Axis, x: &[f64], along: Option<usize>, mut each: impl FnMut(usize, f64)) {
    let span = axis.span(x[0]);
    let basis = if along == Some(0) { axis.slopes(span, x[0]) } else { axis.values(span, x[0]) };
    for f in 0..x.len() {
        let z = match (along, f) {
            (Some(0) | None, 0) => 1.0,
            (Some(0) | None, _) => x[f],
            (Some(input), _) => f64::from(u8::from(input == f)),
        };
        for (b, value) in basis[..=axis.degree].iter().enumerate() {
            each(f * axis.len() + span - axis.degree + b, z * value);
        }
    }
}

impl Method for VaryingParams {
    fn name(&self) -> String {
        format!("{} spline coefficients", format!("{:?}", self.degree).to_lowercase())
    }
    fn fit(&self, samples: &Samples) -> Result<Box<dyn Interpolator>, InterpolationError> {
        Ok(Box::new(self.varying(samples)?))
    }
}

impl Varying {
    pub(super) const KIND: &str = "varying coefficients";

    /// Pieces of the splines.
    #[must_use]
    pub fn pieces(&self) -> usize {
        self.axis.len() - self.axis.degree
    }

    pub(super) fn from_record(record: &Record) -> Result<Self, RecordError> {
        record.expect(Self::KIND)?;
        let axis = Axis::from_record(record, "knots", record.count("degree")?)?;
        let bounds = record.numbers("domain")?;
        let domain: Vec<[f64; 2]> = bounds.as_chunks::<2>().0.to_vec();
        if domain.is_empty() || bounds.len() != 2 * domain.len() {
            return Err(record.wrong("domain", format!("has {} entries", bounds.len())));
        }
        let (rows, columns) = (record.count("outputs")?, domain.len() * axis.len());
        let values = record.numbers_of("coefficients", rows * columns)?;
        let coefficients = Mat::from_fn(rows, columns, |i, j| values[i + j * rows]);
        Ok(Self { axis, coefficients, domain })
    }

    fn sum(&self, x: &[f64], along: Option<usize>, out: &mut [f64]) {
        out.fill(0.0);
        each_factor(&self.axis, x, along, |column, factor| {
            let of = self.coefficients.col_as_slice(column);
            out.iter_mut().zip(of).for_each(|(out, c)| *out += factor * c);
        });
    }
}

impl Interpolator for Varying {
    fn inputs(&self) -> usize {
        self.domain.len()
    }
    fn outputs(&self) -> usize {
        self.coefficients.nrows()
    }
    fn domain(&self) -> &[[f64; 2]] {
        &self.domain
    }
    fn predict(&self, x: &[f64], out: &mut [f64]) -> Result<(), InterpolationError> {
        InterpolationError::check_prediction([self.inputs(), self.outputs()], x, out)?;
        self.sum(x, None, out);
        Ok(())
    }
    fn derivative(&self, x: &[f64], input: usize, out: &mut [f64]) -> Result<(), InterpolationError> {
        InterpolationError::check_prediction([self.inputs(), self.outputs()], x, out)?;
        check_input(input, self.inputs())?;
        self.sum(x, Some(input), out);
        Ok(())
    }
    fn record(&self) -> Record {
        let columns = 0..self.coefficients.ncols();
        Record::new(Self::KIND)
            .with("degree", [self.axis.degree as f64])
            .with("knots", self.axis.knots.iter().copied())
            .with("domain", self.domain.iter().flatten().copied())
            .with("outputs", [self.outputs() as f64])
            .with("coefficients", columns.flat_map(|j| self.coefficients.col_as_slice(j).iter().copied()))
    }
}

#[cfg(test)]
mod tests {
    use super::super::load;
    use super::*;
    use std::f64::consts::TAU;

    fn displacement(t: f64) -> f64 {
        3.0 * t + 40.0 * t * t
    }

    /// y = (t + t² cos 2πs, sin(3t) − eᵗ sin 2πs).
    fn exact(t: f64) -> [f64; 2] {
        let s = TAU * displacement(t);
        [t + t * t * s.cos(), (3.0 * t).sin() - t.exp() * s.sin()]
    }

    fn point(t: f64) -> [f64; 3] {
        [t, (TAU * displacement(t)).cos(), (TAU * displacement(t)).sin()]
    }

    fn samples(m: usize) -> Samples {
        let t = |j: usize| j as f64 / (m - 1) as f64;
        let points = Mat::from_fn(3, m, |i, j| point(t(j))[i]);
        let values = Mat::from_fn(2, m, |i, j| exact(t(j))[i]);
        Samples::new(points.as_ref(), values.as_ref()).unwrap()
    }

    /// s grows by up to 0.69 from sample to sample: no interpolation in t alone could know.
    #[test]
    fn fast_phases_are_followed() {
        let found = VaryingParams::default().varying(&samples(121)).unwrap();
        let mut worst = 0.0_f64;
        let mut y = [0.0; 2];
        for t in (0..2000).map(|j| f64::from(j) / 1999.0) {
            found.predict(&point(t), &mut y).unwrap();
            worst = worst.max((y[0] - exact(t)[0]).abs()).max((y[1] - exact(t)[1]).abs());
        }
        assert!(worst < 1e-6, "{worst:e} with {} pieces", found.pieces());
        // Derivatives.
        let (x, mut slope) = (point(0.37), [0.0; 2]);
        for i in 0..3 {
            let mut at = |by: f64| {
                let mut x = x;
                x[i] += by;
                found.predict(&x, &mut y).unwrap();
                y
            };
            let [up, down] = [at(1e-5), at(-1e-5)];
            found.derivative(&x, i, &mut slope).unwrap();
            assert!((0..2).all(|k| (slope[k] - (up[k] - down[k]) / 2e-5).abs() < 1e-6));
        }
        let again = load(&Record::from_bytes(&found.record().to_bytes()).unwrap()).unwrap();
        let mut same = [0.0; 2];
        again.predict(&x, &mut same).unwrap();
        found.predict(&x, &mut y).unwrap();
        assert_eq!(same, y);
    }

    /// What does not move is no reason for large coefficients, nor is too little to go by.
    #[test]
    fn poor_samples() {
        let times: Vec<f64> = (0..40).map(|j| f64::from(j) / 39.0).collect();
        let points = Mat::from_fn(3, 40, |i, j| [times[j], 1.0, 0.0][i]);
        let values = Mat::from_fn(1, 40, |_, j| times[j].powi(3));
        let still = Samples::new(points.as_ref(), values.as_ref()).unwrap();
        let found = VaryingParams::default().fit(&still).unwrap();
        let mut y = [0.0];
        found.predict(&[0.3, 1.0, 0.0], &mut y).unwrap();
        assert!((y[0] - 0.027).abs() < 1e-7, "{}", y[0]);
        found.predict(&[0.3, 0.0, 1.0], &mut y).unwrap();
        assert!(y[0].abs() < 0.1);
        match VaryingParams::default().fit(&samples(18)) {
            Err(InterpolationError::TooFew { needed: 19, found: 18, .. }) => {}
            other => panic!("{:?}", other.map(|_| ())),
        }
        let wanted = VaryingParams { pieces: Some(8), ..VaryingParams::default() };
        assert!(matches!(wanted.fit(&samples(30)), Err(InterpolationError::TooFew { needed: 40, .. })));
    }
}
