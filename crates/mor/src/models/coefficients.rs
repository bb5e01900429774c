//! Coefficients at any point, and how far they may be off.
use super::ModelError;
use crate::interpolation::{
    Degree, Interpolator, Kernel, Method, RbfParams, Record, RecordError, Samples, SplineParams,
    VaryingParams, load,
};

/// A function, and a second one of lower order, whose distance from it is an estimate of the error.
pub(super) struct Coefficients {
    first: Box<dyn Interpolator>,
    second: Box<dyn Interpolator>,
    /// Root mean square, over samples that were held out, of the first function's error (a norm over all outputs).
    error: f64,
}

/// Every so many-th sample is held out for a choice.
const FOLDS: usize = 5;

/// Pairs of methods that suit the samples: splines on grids, radial functions elsewhere, and splines with phases where there are any.
fn candidates(samples: &Samples, phases: bool) -> Vec<[Box<dyn Method>; 2]> {
    if phases {
        let of = |degree| Box::new(VaryingParams { degree, pieces: None }) as Box<dyn Method>;
        return vec![[of(Degree::Quintic), of(Degree::Cubic)], [of(Degree::Cubic), of(Degree::Linear)]];
    }
    let mut all: Vec<[Box<dyn Method>; 2]> = Vec::new();
    let on_grid = samples.grid().is_ok();
    let least = (0..samples.inputs()).map(|i| samples.distinct(i).len()).min().unwrap_or(0);
    if let Some(highest) = Degree::highest(least).filter(|_| on_grid) {
        let of = |degree| Box::new(SplineParams::new(degree)) as Box<dyn Method>;
        for pair in Degree::ALL.windows(2).filter(|pair| pair[1] <= highest) {
            all.push([of(pair[1]), of(pair[0])]);
        }
        all.reverse();
    }
    if samples.inputs() > 1 || all.is_empty() {
        let of = |kernel| Box::new(RbfParams::new(kernel)) as Box<dyn Method>;
        all.push([of(Kernel::Quintic), of(Kernel::ThinPlate)]);
    }
    all
}

impl Coefficients {
    /// By the methods given, or those that predict samples best which were held out.
    pub(super) fn fit(
        samples: &Samples,
        given: Option<&dyn Method>,
        phases: bool,
    ) -> Result<Self, ModelError> {
        let mut best: Option<(f64, [Box<dyn Method>; 2])> = None;
        let mut refused = None;
        let all = candidates(samples, phases);
        for pair in all {
            match held_out(samples, given.unwrap_or(&*pair[0])) {
                Ok(error) if best.as_ref().is_none_or(|(least, _)| error < *least) => {
                    best = Some((error, pair))
                }
                Ok(_) => {}
                Err(why) => refused = Some(why),
            }
            if given.is_some() {
                break;
            }
        }
        let Some((error, [first, second])) = best else {
            let none = ModelError::Shape { what: "methods that suit the samples", expected: 1, found: 0 };
            return Err(refused.unwrap_or(none));
        };
        Ok(Self { first: given.unwrap_or(&*first).fit(samples)?, second: second.fit(samples)?, error })
    }

    pub(super) fn outputs(&self) -> usize {
        self.first.outputs()
    }
    /// Smallest and largest value of every input among the samples.
    pub(super) fn domain(&self) -> &[[f64; 2]] {
        self.first.domain()
    }
    /// Root mean square error at samples that were held out.
    pub(super) fn error(&self) -> f64 {
        self.error
    }
    pub(super) fn predict(&self, x: &[f64], out: &mut [f64]) -> Result<(), ModelError> {
        Ok(self.first.predict(x, out)?)
    }
    /// How far the two functions are apart at x.
    pub(super) fn doubt(&self, x: &[f64]) -> Result<f64, ModelError> {
        let (mut a, mut b) = (vec![0.0; self.outputs()], vec![0.0; self.outputs()]);
        self.first.predict(x, &mut a)?;
        self.second.predict(x, &mut b)?;
        Ok(a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt())
    }
    pub(super) fn record(&self) -> Record {
        Record::new("coefficients")
            .with_record("first", &self.first.record())
            .with_record("second", &self.second.record())
            .with("error", [self.error])
    }
    pub(super) fn from_record(record: &Record) -> Result<Self, RecordError> {
        record.expect("coefficients")?;
        let (first, second) = (load(&record.record("first")?)?, load(&record.record("second")?)?);
        if (first.inputs(), first.outputs()) != (second.inputs(), second.outputs()) {
            return Err(record.wrong("second", "does not fit the first".into()));
        }
        Ok(Self { first, second, error: record.number("error")? })
    }
}

/// Root mean square error at every fifth sample of a function of the others; on a grid of several inputs, of those at every fifth value of the input with most values.
fn held_out(samples: &Samples, method: &dyn Method) -> Result<f64, ModelError> {
    let along = (0..samples.inputs()).max_by_key(|&i| samples.distinct(i).len()).unwrap_or(0);
    let values = samples.distinct(along);
    let inside = 1..values.len().saturating_sub(1);
    let place = |j: usize| {
        let x = samples.points()[(along, j)];
        values.partition_point(|v| *v < x - 0.5e-12 * (values[values.len() - 1] - values[0]))
    };
    // Ends stay: nothing is to be extrapolated.
    let out = |j: usize| inside.contains(&place(j)) && place(j) % FOLDS == FOLDS / 2;
    let (kept, tested): (Vec<usize>, Vec<usize>) = (0..samples.len()).partition(|&j| !out(j));
    if tested.is_empty() {
        // Too few to tell.
        method.fit(samples)?;
        return Ok(0.0);
    }
    let subset = samples.subset(&kept);
    let Some(subset) = subset else { return Ok(0.0) };
    let function = method.fit(&subset)?;
    let (mut x, mut y) = (vec![0.0; samples.inputs()], vec![0.0; samples.outputs()]);
    let mut sum = 0.0;
    for &j in &tested {
        x.iter_mut().enumerate().for_each(|(i, x)| *x = samples.points()[(i, j)]);
        function.predict(&x, &mut y)?;
        sum += y.iter().enumerate().map(|(row, y)| (y - samples.values()[(row, j)]).powi(2)).sum::<f64>();
    }
    Ok((sum / tested.len() as f64).sqrt())
}
