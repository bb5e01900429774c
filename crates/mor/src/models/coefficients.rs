//! Coefficients at any point, and how far they may be off.
use super::{Extrapolation, ModelError};
use crate::interpolation::{
    Degree, Folds, HarmonicsParams, Interpolator, Method, Record, RecordError, Samples, SplineParams,
    VaryingParams, best_of, candidates, cross_validate, load,
};
use crate::{Mat, MatRef};

/// A function of slow inputs, and of phases if it has them, and a second one, whose distance from it shows where the samples are too few.
pub(super) struct Coefficients {
    first: Box<dyn Interpolator>,
    second: Box<dyn Interpolator>,
    /// Name of the first one's method.
    method: String,
    /// Number of slow inputs: time and parameters.
    slow: usize,
    extrapolation: Extrapolation,
    /// Root mean square error between samples (a norm over all outputs), by cross-validation.
    error: f64,
    /// Root mean square distance of the two functions between samples.
    distance: f64,
}

/// Methods for samples and the number of their slow inputs, and the error of the best of them.
pub(super) struct Choice<'a> {
    samples: &'a Samples,
    slow: usize,
    /// The best, then the others.
    methods: Vec<Box<dyn Method + 'a>>,
    /// Relative error of samples left out; 0 if they are too few to leave any out.
    pub(super) left_out: f64,
}

/// Splines in time alone; all [`candidates`] with parameters; least squares with harmonics of the phases if there are any, and those of time alone through the samples, too.
fn methods(samples: &Samples, slow: usize) -> Vec<Box<dyn Method>> {
    let highest = |n: usize| Degree::highest(n).map_or(0, |d| d.get());
    let degrees = |most: usize| Degree::ALL.into_iter().rev().filter(move |degree| degree.get() <= most);
    if samples.inputs() > slow {
        let most = highest(samples.distinct(0).len());
        let least_squares =
            degrees(most).map(|degree| Box::new(VaryingParams { degree, slow }) as Box<dyn Method>);
        let spline = |degree| Box::new(SplineParams::new(degree));
        let through = degrees(most).map(|degree| HarmonicsParams { amplitudes: spline(degree), slow });
        let through = through.filter(|_| slow == 1).map(|params| Box::new(params) as Box<dyn Method>);
        return least_squares.chain(through).collect();
    }
    match highest(samples.distinct(0).len()) {
        most if samples.inputs() == 1 && most > 0 => {
            degrees(most).map(|degree| Box::new(SplineParams::new(degree)) as Box<dyn Method>).collect()
        }
        _ => candidates(samples),
    }
}

impl<'a> Choice<'a> {
    /// The method given, or that which [`best_of`] finds; sets left out are those that suit the first `slow` inputs, and the others are phases.
    pub(super) fn new(
        samples: &'a Samples,
        slow: usize,
        given: Option<&'a dyn Method>,
    ) -> Result<Self, ModelError> {
        let folds = Folds::suited(&samples.first_inputs(slow), 1);
        let mut own = methods(samples, slow);
        let (best, left_out): (Box<dyn Method + 'a>, f64) = match given {
            Some(given) => {
                let method: Box<dyn Method + 'a> = match samples.inputs() > slow {
                    true => Box::new(HarmonicsParams { amplitudes: Box::new(given), slow }),
                    false => Box::new(given),
                };
                let left_out = match &folds {
                    Ok(folds) => cross_validate(method.as_ref(), samples, folds)?.error,
                    Err(_) => 0.0,
                };
                (method, left_out)
            }
            None => {
                let (chosen, left_out) = match &folds {
                    Ok(folds) => {
                        let best = best_of(&own, samples, folds)?;
                        let error =
                            best.table.rows[best.chosen].outcome.as_ref().map_or(0.0, |row| row.error);
                        (best.chosen, error)
                    }
                    Err(_) => (own.len().saturating_sub(1), 0.0),
                };
                if own.is_empty() {
                    return Err(ModelError::Shape {
                        what: "methods that suit the samples",
                        expected: 1,
                        found: 0,
                    });
                }
                (own.remove(chosen), left_out)
            }
        };
        let others = own.into_iter().map(|method| method as Box<dyn Method + 'a>);
        Ok(Self { samples, slow, methods: std::iter::once(best).chain(others).collect(), left_out })
    }

    /// The function, by all samples.
    pub(super) fn fit(self) -> Result<Coefficients, ModelError> {
        let Self { samples, slow, methods, left_out } = self;
        let first = methods[0].as_ref();
        // The first other one that works.
        let other = methods[1..].iter().find_map(|method| Some((method.fit(samples).ok()?, method.as_ref())));
        let (second, second_method) = match other {
            Some(other) => other,
            None => (first.fit(samples)?, first),
        };
        let squares: f64 = samples.values().squared_norm_l2();
        let left_out = left_out * (squares / samples.len() as f64).sqrt();
        let (error, distance) = match between(samples, [first, second_method]) {
            Some([error, distance]) if slow == 1 => (error, distance),
            // Across the parameters a value left out doubles the distance: at order 2 or more the error is a quarter of that or less.
            Some([error, distance]) => (error.max(0.25 * left_out), distance),
            None => (0.25 * left_out, 0.0),
        };
        Ok(Coefficients {
            first: first.fit(samples)?,
            second,
            method: first.name(),
            slow,
            extrapolation: Extrapolation::default(),
            error,
            distance,
        })
    }
}

impl Coefficients {
    /// Without phases, by the method given, or that which [`best_of`] finds.
    pub(super) fn fit(samples: &Samples, given: Option<&dyn Method>) -> Result<Self, ModelError> {
        Choice::new(samples, samples.inputs(), given)?.fit()
    }

    pub(super) fn outputs(&self) -> usize {
        self.first.outputs()
    }
    /// Name of the method.
    pub(super) fn method(&self) -> &str {
        &self.method
    }
    /// Smallest and largest value of every slow input among the samples.
    pub(super) fn domain(&self) -> &[[f64; 2]] {
        &self.first.domain()[..self.slow]
    }
    pub(super) fn inputs(&self) -> usize {
        self.first.inputs()
    }
    pub(super) fn extrapolate(&mut self, how: Extrapolation) {
        self.extrapolation = how;
    }
    pub(super) fn predict(&self, x: &[f64], out: &mut [f64]) -> Result<(), ModelError> {
        Ok(self.extrapolation.predict(self.first.as_ref(), self.slow, x, out)?)
    }
    /// At points that are columns, as columns.
    pub(super) fn predict_all(&self, points: MatRef<'_, f64>) -> Result<Mat<f64>, ModelError> {
        let mut values = Mat::zeros(self.outputs(), points.ncols());
        for j in 0..points.ncols() {
            let x: Vec<f64> = points.col(j).iter().copied().collect();
            self.predict(&x, values.col_as_slice_mut(j))?;
        }
        Ok(values)
    }
    /// Estimate of the error at x: the root mean square one, larger by the ratio of the two functions' distance to their usual one; beyond the samples also the distance of
    /// the extrapolation from the function itself.
    pub(super) fn doubt(&self, x: &[f64]) -> Result<f64, ModelError> {
        let at = |function: &dyn Interpolator, how: Extrapolation| {
            let mut y = vec![0.0; self.outputs()];
            how.predict(function, self.slow, x, &mut y).map(|()| y)
        };
        let distance =
            |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        let first = at(self.first.as_ref(), self.extrapolation)?;
        let apart = distance(&first, &at(self.second.as_ref(), self.extrapolation)?);
        let factor = if self.distance > 0.0 { (apart / self.distance).max(1.0) } else { 1.0 };
        let inside = x.iter().zip(self.domain()).all(|(x, [low, high])| (low..=high).contains(&x));
        let beyond = if inside {
            0.0
        } else {
            let constant = distance(&first, &at(self.first.as_ref(), Extrapolation::Constant)?);
            apart.max(constant).max(distance(&first, &at(self.first.as_ref(), Extrapolation::Function)?))
        };
        Ok((self.error * factor).max(beyond))
    }
    pub(super) fn record(&self) -> Record {
        Record::new("coefficients")
            .with_record("first", &self.first.record())
            .with_record("second", &self.second.record())
            .with_word("method", &self.method)
            .with_word("extrapolation", self.extrapolation.name())
            .with("slow", [self.slow as f64])
            .with("error", [self.error, self.distance])
    }
    pub(super) fn from_record(record: &Record) -> Result<Self, RecordError> {
        record.expect("coefficients")?;
        let (first, second) = (load(&record.record("first")?)?, load(&record.record("second")?)?);
        if (first.inputs(), first.outputs()) != (second.inputs(), second.outputs()) {
            return Err(record.wrong("second", "does not fit the first".into()));
        }
        let [error, distance] = record.numbers("error")?[..] else {
            return Err(record.wrong("error", "is not two numbers".into()));
        };
        let slow = record.count("slow")?;
        if slow == 0 || slow > first.inputs() {
            return Err(record.wrong("slow", format!("is {slow} of {} inputs", first.inputs())));
        }
        let word = record.word("extrapolation")?;
        let extrapolation = Extrapolation::named(word)
            .ok_or_else(|| record.wrong("extrapolation", format!("is `{word}`")))?;
        let method = record.word("method")?.to_owned();
        Ok(Self { first, second, method, slow, extrapolation, error, distance })
    }
}

/// The first method's error and its distance from the second one's function, root mean squares half-way between values of the first input. Both are told from
/// what functions of every second value have at the others, e₂, and functions of every fourth one half-way between those, e₄: at an order p e₂/e₄ = 2^−p, and what is
/// looked for is e₂ e₂/e₄. None with too few values.
fn between(samples: &Samples, methods: [&dyn Method; 2]) -> Option<[f64; 2]> {
    let values = samples.distinct(0);
    let place = |j: &usize| {
        values.partition_point(|v| {
            *v < samples.point(*j)[0] - 0.5 * ROUND_OFF * (values[values.len() - 1] - values[0])
        })
    };
    let last = values.len() - 1;
    let mut told = [[0.0; 2]; 2];
    for (told, stride) in told.iter_mut().zip([2, 4]) {
        let ends = last / stride * stride;
        let kept: Vec<usize> = (0..samples.len()).filter(|j| place(j).is_multiple_of(stride)).collect();
        let tested: Vec<usize> =
            (0..samples.len()).filter(|j| place(j) % stride == stride / 2 && place(j) < ends).collect();
        if ends < LEAST * stride || tested.is_empty() {
            return None;
        }
        let part = samples.subset(&kept)?;
        let functions = methods.map(|method| method.fit(&part));
        let [Ok(first), Ok(second)] = functions else { return None };
        let (mut a, mut b) = (vec![0.0; samples.outputs()], vec![0.0; samples.outputs()]);
        for &j in &tested {
            first.predict(samples.point(j), &mut a).ok()?;
            second.predict(samples.point(j), &mut b).ok()?;
            for (row, y) in samples.value(j).iter().enumerate() {
                told[0] += (a[row] - y).powi(2) / tested.len() as f64;
                told[1] += (a[row] - b[row]).powi(2) / tested.len() as f64;
            }
        }
        *told = told.map(f64::sqrt);
    }
    let [two, four] = told;
    let at_spacing = |i: usize| two[i] * if four[i] > 0.0 { (two[i] / four[i]).min(1.0) } else { 1.0 };
    Some([at_spacing(0), at_spacing(1)])
}

/// Intervals that are needed of every fourth value.
const LEAST: usize = 6;
/// Of the values of an input, relative to their range.
const ROUND_OFF: f64 = 1e-12;
