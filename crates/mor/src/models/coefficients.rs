//! Coefficients at any point, and how far they may be off.
use super::leave_out::{LeaveOut, square_distance};
use super::{Extrapolation, ModelError};
use crate::interpolation::{
    Degree, FitObserver, FitProgress, FitStage, Folds, HarmonicsParams, Interpolator, Method, Record,
    RecordError, Samples, SplineParams, VaryingParams, best_of_observed, candidates, load,
};
use crate::{Mat, MatRef};

/// A function of slow inputs, and of phases if it has them, and estimates of its error.
pub(super) struct Coefficients {
    function: Box<dyn Interpolator>,
    /// Name of its method.
    method: String,
    /// Number of slow inputs: time and parameters.
    slow: usize,
    extrapolation: Extrapolation,
    /// Errors along single inputs, or all parameters together.
    estimates: Vec<LeaveOut>,
    /// Root mean square error at the samples, and along inputs of which there is no estimate.
    error: f64,
}

/// A method for samples and the number of their slow inputs, and its function of all samples.
pub(super) struct Choice<'a> {
    samples: &'a Samples,
    slow: usize,
    method: Box<dyn Method + 'a>,
    function: Box<dyn Interpolator>,
    /// Relative error of samples left out; 0 if they are too few to leave any out.
    pub(super) left_out: f64,
}

/// Splines in time alone; all [`candidates`] with parameters; least squares with harmonics of the phases if there are any, and those of time alone through the samples, too.
fn methods<'a>(samples: &Samples, slow: usize) -> Vec<Box<dyn Method + 'a>> {
    let highest = |n: usize| Degree::highest(n).map_or(0, |d| d.get());
    let degrees = |most: usize| Degree::ALL.into_iter().rev().filter(move |degree| degree.get() <= most);
    if samples.inputs() > slow {
        let most = highest(samples.distinct(0).len());
        let least_squares =
            degrees(most).map(|degree| Box::new(VaryingParams { degree, slow }) as Box<dyn Method + 'a>);
        let spline = |degree| Box::new(SplineParams::new(degree));
        let through = degrees(most).map(|degree| HarmonicsParams { amplitudes: spline(degree), slow });
        let through = through.filter(|_| slow == 1).map(|params| Box::new(params) as Box<dyn Method + 'a>);
        return least_squares.chain(through).collect();
    }
    match highest(samples.distinct(0).len()) {
        most if samples.inputs() == 1 && most > 0 => {
            degrees(most).map(|degree| Box::new(SplineParams::new(degree)) as Box<dyn Method + 'a>).collect()
        }
        _ => candidates(samples).into_iter().map(|method| method as Box<dyn Method + 'a>).collect(),
    }
}

impl<'a> Choice<'a> {
    /// The method given, or that with the least error of samples left out; sets left out are those
    /// that suit the first `slow` inputs, and the others are phases.
    pub(super) fn new(
        samples: &'a Samples,
        slow: usize,
        given: Option<&'a dyn Method>,
        observer: FitObserver<'_>,
    ) -> Result<Self, ModelError> {
        let folds = Folds::suited(&samples.first_inputs(slow), 1);
        let mut tried: Vec<Box<dyn Method + 'a>> = match given {
            None => methods(samples, slow),
            Some(given) if samples.inputs() == slow => vec![Box::new(given)],
            Some(given) => {
                let harmonics = HarmonicsParams { amplitudes: Box::new(given), slow };
                let mut both: Vec<Box<dyn Method + 'a>> = vec![Box::new(harmonics)];
                // Runs left out have phases that the others have not; times of one run may all have the same.
                if slow > 1 {
                    both.push(Box::new(given));
                }
                both
            }
        };
        let (chosen, left_out, function) = match &folds {
            Ok(folds) => {
                let best = best_of_observed(&tried, samples, folds, observer)?;
                let error = best.table.rows[best.chosen].outcome.as_ref().map_or(0.0, |row| row.error);
                (best.chosen, error, best.interpolator)
            }
            // Too few samples to leave any out.
            Err(_) => {
                let chosen = if given.is_some() { 0 } else { tried.len().saturating_sub(1) };
                let what = "methods that suit the samples";
                let method = tried.get(chosen).ok_or(ModelError::Shape { what, expected: 1, found: 0 })?;
                let stage = FitStage::Fit(&method.name());
                let function = FitProgress::new(stage, 1, 1)
                    .run(observer, |observer| method.fit_observed(samples, observer))?;
                (chosen, 0.0, function)
            }
        };
        Ok(Self { samples, slow, method: tried.remove(chosen), function, left_out })
    }

    /// The function with estimates of its error.
    pub(super) fn fit(self, observer: FitObserver<'_>) -> Result<Coefficients, ModelError> {
        let Self { samples, slow, method, function, left_out } = self;
        let estimates = LeaveOut::all(samples, slow, method.as_ref(), observer)?;
        // A value left out doubles the distance: at order 2 or more the error is a quarter of that or less.
        let known = estimates.iter().flat_map(LeaveOut::inputs).count() == slow;
        let typical = (samples.values().squared_norm_l2() / samples.len() as f64).sqrt();
        let unseen = if known { 0.0 } else { 0.25 * left_out * typical };
        let misfit = (function.predict_all(samples.points())? - samples.values()).norm_l2();
        Ok(Coefficients {
            function,
            method: method.name(),
            slow,
            extrapolation: Extrapolation::default(),
            error: unseen.hypot(misfit / (samples.len() as f64).sqrt()),
            estimates,
        })
    }
}

impl Coefficients {
    /// Without phases, by the method given, or that with the least error of samples left out.
    pub(super) fn fit(
        samples: &Samples,
        given: Option<&dyn Method>,
        observer: FitObserver<'_>,
    ) -> Result<Self, ModelError> {
        Choice::new(samples, samples.inputs(), given, &mut *observer)?.fit(observer)
    }

    pub(super) fn outputs(&self) -> usize {
        self.function.outputs()
    }
    /// Name of the method.
    pub(super) fn method(&self) -> &str {
        &self.method
    }
    /// Smallest and largest value of every slow input among the samples.
    pub(super) fn domain(&self) -> &[[f64; 2]] {
        &self.function.domain()[..self.slow]
    }
    pub(super) fn inputs(&self) -> usize {
        self.function.inputs()
    }
    pub(super) fn extrapolate(&mut self, how: Extrapolation) {
        self.extrapolation = how;
    }
    pub(super) fn predict(&self, x: &[f64], out: &mut [f64]) -> Result<(), ModelError> {
        Ok(self.extrapolation.predict(self.function.as_ref(), self.slow, x, out)?)
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
    /// Estimate of the error at x: along all inputs, and beyond the samples also the distance of the extrapolation from a
    /// constant and from the function itself.
    pub(super) fn doubt(&self, x: &[f64]) -> Result<f64, ModelError> {
        let at = |function: &dyn Interpolator, how: Extrapolation| {
            let mut y = vec![0.0; self.outputs()];
            how.predict(function, self.slow, x, &mut y).map(|()| y)
        };
        let y = at(self.function.as_ref(), self.extrapolation)?;
        let mut square = self.error.powi(2);
        for estimate in &self.estimates {
            square += estimate.at(x, &y, self.domain(), |f| at(f, self.extrapolation))?.powi(2);
        }
        if !x.iter().zip(self.domain()).all(|(x, [low, high])| (low..=high).contains(&x)) {
            for how in [Extrapolation::Constant, Extrapolation::Function] {
                square = square.max(square_distance(&y, &at(self.function.as_ref(), how)?));
            }
        }
        Ok(square.sqrt())
    }
    pub(super) fn record(&self) -> Record {
        let record = Record::new("coefficients")
            .with_record("function", &self.function.record())
            .with_word("method", &self.method)
            .with_word("extrapolation", self.extrapolation.name())
            .with("slow", [self.slow as f64])
            .with("error", [self.error])
            .with("estimates", [self.estimates.len() as f64]);
        let estimates = self.estimates.iter().enumerate();
        estimates.fold(record, |record, (k, e)| record.with_record(&format!("estimate {k}"), &e.record()))
    }
    pub(super) fn from_record(record: &Record) -> Result<Self, RecordError> {
        record.expect("coefficients")?;
        let function = load(&record.record("function")?)?;
        let estimate = |k| LeaveOut::from_record(&record.record(&format!("estimate {k}"))?);
        let estimates = (0..record.count("estimates")?).map(estimate).collect::<Result<Vec<_>, _>>()?;
        let slow = record.count("slow")?;
        if slow == 0 || slow > function.inputs() {
            return Err(record.wrong("slow", format!("is {slow} of {} inputs", function.inputs())));
        }
        if !estimates.iter().all(|e| e.fits(slow, [function.inputs(), function.outputs()])) {
            return Err(record.wrong("estimates", "do not fit the function".into()));
        }
        let word = record.word("extrapolation")?;
        let extrapolation = Extrapolation::named(word)
            .ok_or_else(|| record.wrong("extrapolation", format!("is `{word}`")))?;
        let (method, error) = (record.word("method")?.to_owned(), record.number("error")?);
        Ok(Self { function, method, slow, extrapolation, estimates, error })
    }
}
