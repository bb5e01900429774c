//! Coefficients at any point, and how far they may be off.
use super::ModelError;
use crate::interpolation::{
    Degree, Folds, Interpolator, Method, Record, RecordError, Samples, SplineParams, VaryingParams, best_of,
    candidates, cross_validate, load,
};
use crate::{Mat, MatRef};

/// A function, and a second one, whose distance from it tells where the samples are too few.
pub(super) struct Coefficients {
    first: Box<dyn Interpolator>,
    second: Box<dyn Interpolator>,
    /// Root mean square error between samples (a norm over all outputs), as cross-validation tells.
    error: f64,
    /// Root mean square distance of the two functions between samples.
    distance: f64,
}

/// Methods that suit the samples: splines in time alone, with phases where there are any; all [`candidates`] with parameters.
fn methods(samples: &Samples, phases: bool) -> Vec<Box<dyn Method>> {
    if phases {
        let of = |degree| Box::new(VaryingParams { degree, pieces: None }) as Box<dyn Method>;
        return [Degree::Quintic, Degree::Cubic, Degree::Linear].map(of).into();
    }
    let highest = (samples.inputs() == 1).then(|| Degree::highest(samples.distinct(0).len())).flatten();
    match highest {
        Some(highest) => {
            let degrees = Degree::ALL.into_iter().filter(|degree| *degree <= highest).rev();
            degrees.map(|degree| Box::new(SplineParams::new(degree)) as Box<dyn Method>).collect()
        }
        None => candidates(samples),
    }
}

impl Coefficients {
    /// By the method given, or that which [`best_of`] finds.
    pub(super) fn fit(
        samples: &Samples,
        given: Option<&dyn Method>,
        phases: bool,
    ) -> Result<Self, ModelError> {
        let folds = match phases {
            // Only the first input is free.
            true => Folds::interleaved(samples, 5),
            false => Folds::suited(samples, 1),
        };
        let mut methods = methods(samples, phases);
        let (best, relative) = match (given, &folds) {
            (Some(given), Ok(folds)) => (None, cross_validate(given, samples, folds)?.error),
            (Some(_), Err(_)) => (None, 0.0),
            (None, Ok(folds)) => {
                let best = best_of(&methods, samples, folds)?;
                let error = best.table.rows[best.chosen].outcome.as_ref().map_or(0.0, |row| row.error);
                (Some(methods.remove(best.chosen)), error)
            }
            // Too few samples to leave any out.
            (None, Err(_)) => (methods.pop(), 0.0),
        };
        let Some(first) = given.or(best.as_deref()) else {
            return Err(ModelError::Shape { what: "methods that suit the samples", expected: 1, found: 0 });
        };
        // The first other one that works.
        let other = methods.iter().find_map(|method| Some((method.fit(samples).ok()?, &**method)));
        let (second, second_method) = match other {
            Some(other) => other,
            None => (first.fit(samples)?, first),
        };
        let squares: f64 = samples.values().squared_norm_l2();
        let left_out = relative * (squares / samples.len() as f64).sqrt();
        let (error, distance) = match between(samples, [first, second_method]) {
            Some([error, distance]) if samples.inputs() == 1 || phases => (error, distance),
            // Across the parameters a value left out doubles the distance: at order 2 or more the error is a quarter of that or less.
            Some([error, distance]) => (error.max(0.25 * left_out), distance),
            None => (0.25 * left_out, 0.0),
        };
        Ok(Self { first: first.fit(samples)?, second, error, distance })
    }

    pub(super) fn outputs(&self) -> usize {
        self.first.outputs()
    }
    /// Smallest and largest value of every input among the samples.
    pub(super) fn domain(&self) -> &[[f64; 2]] {
        self.first.domain()
    }
    /// Root mean square error between samples.
    pub(super) fn error(&self) -> f64 {
        self.error
    }
    pub(super) fn predict(&self, x: &[f64], out: &mut [f64]) -> Result<(), ModelError> {
        Ok(self.first.predict(x, out)?)
    }
    /// At points that are columns, as columns.
    pub(super) fn predict_all(&self, points: MatRef<'_, f64>) -> Result<Mat<f64>, ModelError> {
        Ok(self.first.predict_all(points)?)
    }
    /// What the error may be at x: the root mean square one, or larger by as much as the two functions are farther apart than they usually are.
    pub(super) fn doubt(&self, x: &[f64]) -> Result<f64, ModelError> {
        let (mut a, mut b) = (vec![0.0; self.outputs()], vec![0.0; self.outputs()]);
        self.first.predict(x, &mut a)?;
        self.second.predict(x, &mut b)?;
        let distance = a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        let factor = if self.distance > 0.0 { (distance / self.distance).max(1.0) } else { 1.0 };
        // Far outside the functions are no measure of one another.
        let beyond = if self.first.covers(x) { 0.0 } else { distance };
        Ok((self.error * factor).max(beyond))
    }
    pub(super) fn record(&self) -> Record {
        Record::new("coefficients")
            .with_record("first", &self.first.record())
            .with_record("second", &self.second.record())
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
        Ok(Self { first, second, error, distance })
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
