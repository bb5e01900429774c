//! Methods side by side, and the best of them.
use super::product::Runs;
use super::{
    CrossValidation, Degree, FitObserver, FitProgress, FitStage, Folds, InterpolationError, Interpolator,
    Kernel, Method, NetworkParams, ProductParams, RbfParams, Samples, SplineParams, cross_validate_observed,
    unobserved,
};
use cpu_time::ThreadTime;
use std::fmt;

/// A later method is better only if its error is smaller than this share of an earlier one's.
const CLEARLY: f64 = 0.9;
/// A method with an error so many times another one's is not worth its time.
const HOPELESS: f64 = 100.0;
/// Errors below this are round-off.
const ROUND_OFF: f64 = 1e-14;

/// What became of one method.
#[derive(Debug)]
pub struct Row {
    /// Of the method.
    pub method: String,
    /// Whether all sets were predicted.
    pub in_full: bool,
    /// Its errors, or why it does not work with these samples.
    pub outcome: Result<CrossValidation, InterpolationError>,
}

/// Methods side by side.
#[derive(Debug)]
pub struct Table {
    /// In the order in which the methods were given.
    pub rows: Vec<Row>,
}

impl Table {
    /// Which has the smallest error; one that comes later must be better by a tenth, and by more than round-off: give cheaper methods
    /// first. None if none worked.
    #[must_use]
    pub fn best(&self) -> Option<usize> {
        let mut best: Option<(usize, f64)> = None;
        for (i, row) in self.rows.iter().enumerate() {
            if let Ok(CrossValidation { error, .. }) = row.outcome
                && row.in_full
                && error.is_finite()
                && best.is_none_or(|(_, least)| error < CLEARLY * least && least > ROUND_OFF)
            {
                best = Some((i, error));
            }
        }
        best.map(|(i, _)| i)
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = self.rows.iter().map(|row| row.method.chars().count()).max().unwrap_or(0).max(6);
        writeln!(f, "{:width$} {:>9} {:>9} {:>9}", "method", "error", "worst", "CPU s")?;
        let best = self.best();
        for (i, Row { method, in_full, outcome }) in self.rows.iter().enumerate() {
            match outcome {
                Ok(of) => {
                    let mark = match (best == Some(i), in_full) {
                        (true, _) => " *",
                        (_, true) => "",
                        (_, false) => " (a part)",
                    };
                    let (worst, _) = of.worst;
                    writeln!(
                        f,
                        "{method:width$} {:9.2e} {worst:9.2e} {:9.3}{mark}",
                        of.error, of.cpu_seconds
                    )?;
                }
                Err(why) => writeln!(f, "{method:width$} {why}")?,
            }
        }
        Ok(())
    }
}

/// Cross-validates every method with the same sets.
#[must_use]
pub fn compare(methods: &[Box<dyn Method>], samples: &Samples, folds: &Folds) -> Table {
    compare_observed(methods, samples, folds, &mut unobserved)
}

/// The same with an observer ([`FitStage::Method`]): once it stops, the outcome of the method under
/// way and of all later ones is [`InterpolationError::Stopped`].
#[must_use]
pub fn compare_observed(
    methods: &[Box<dyn Method>],
    samples: &Samples,
    folds: &Folds,
    observer: FitObserver<'_>,
) -> Table {
    let mut is_stopped = false;
    let row = |(i, method): (usize, &dyn Method)| {
        let name = method.name();
        let outcome = if is_stopped {
            Err(InterpolationError::Stopped)
        } else {
            FitProgress::new(FitStage::Method(&name), i + 1, methods.len())
                .run(&mut *observer, |o| cross_validate_observed(method, samples, folds, o))
        };
        is_stopped = matches!(outcome, Err(InterpolationError::Stopped));
        Row { method: name, in_full: true, outcome }
    };
    Table { rows: methods.iter().map(Box::as_ref).enumerate().map(row).collect() }
}

/// The best of some methods.
pub struct Best {
    /// Made of all samples.
    pub interpolator: Box<dyn Interpolator>,
    /// Which of the methods.
    pub chosen: usize,
    /// How it compares with the others.
    pub table: Table,
    /// CPU seconds of the last fit.
    pub cpu_seconds: f64,
}

/// Compares the methods, and fits the [`Table::best`] of them to all samples. A method that is a hundred times worse than another one
/// on a fifth of the sets is not tried on the others.
///
/// # Errors
/// That of the first method if none works, or that of the last fit.
pub fn best_of(
    methods: &[Box<dyn Method + '_>],
    samples: &Samples,
    folds: &Folds,
) -> Result<Best, InterpolationError> {
    best_of_observed(methods, samples, folds, &mut unobserved)
}

/// The same with an observer: [`FitStage::Method`] for each, then [`FitStage::Fit`].
///
/// # Errors
/// As [`best_of`]; [`InterpolationError::Stopped`] by the observer.
pub fn best_of_observed(
    methods: &[Box<dyn Method + '_>],
    samples: &Samples,
    folds: &Folds,
    observer: FitObserver<'_>,
) -> Result<Best, InterpolationError> {
    let some = folds.some(folds.sets().len().div_ceil(5));
    let mut least = f64::INFINITY;
    let mut validate = |method: &dyn Method, observer: FitObserver<'_>| -> Result<Row, InterpolationError> {
        let mut outcome = |folds| {
            InterpolationError::unless_stopped(cross_validate_observed(
                method,
                samples,
                folds,
                &mut *observer,
            ))
        };
        let trial = outcome(&some)?;
        let error = trial.as_ref().map_or(f64::INFINITY, |of| of.error);
        least = least.min(error);
        let in_full = error <= HOPELESS * least.max(ROUND_OFF);
        let outcome = if in_full { outcome(folds)? } else { trial };
        Ok(Row { method: method.name(), in_full, outcome })
    };
    let mut table = Table { rows: Vec::new() };
    for (i, method) in methods.iter().enumerate() {
        let name = method.name();
        let stage = FitProgress::new(FitStage::Method(&name), i + 1, methods.len());
        table.rows.push(stage.run(&mut *observer, |observer| validate(method.as_ref(), observer))?);
    }
    let Some(chosen) = table.best() else {
        let none = InterpolationError::TooFew {
            what: "a choice".into(),
            of: "methods that give finite errors",
            needed: 1,
            found: 0,
        };
        let first = table.rows.drain(..).find_map(|row| row.outcome.err());
        return Err(first.unwrap_or(none));
    };
    let begin = ThreadTime::now();
    let interpolator = FitProgress::new(FitStage::Fit(&table.rows[chosen].method), 1, 1)
        .run(observer, |observer| methods[chosen].fit_observed(samples, observer))?;
    Ok(Best { interpolator, chosen, table, cpu_seconds: begin.elapsed().as_secs_f64() })
}

/// The best of the [`candidates`], with the [`suited`](Folds::suited) sets.
///
/// # Errors
/// As [`best_of`]; [`InterpolationError::TooFew`] samples to leave any out.
pub fn best(samples: &Samples) -> Result<Best, InterpolationError> {
    best_observed(samples, &mut unobserved)
}

/// The same with an observer.
///
/// # Errors
/// As [`best`]; [`InterpolationError::Stopped`] by the observer.
pub fn best_observed(samples: &Samples, observer: FitObserver<'_>) -> Result<Best, InterpolationError> {
    best_of_observed(&candidates(samples), samples, &Folds::suited(samples, 1)?, observer)
}

/// Methods that suit the samples, the cheaper first.
///
/// Runs at points of the other inputs, each at the same seven or more values of the first: the spline of the highest degree in the
/// first by the candidates of the others ([`ProductParams`]). Else, on a line or a full grid: (products of) splines of every degree
/// there are enough values for; of at most 2000 samples off a line: radial functions without a shape; of at most 600: those that
/// look for their shape; of ten to 2000, or on a line: [networks](NetworkParams::suited).
#[must_use]
pub fn candidates(samples: &Samples) -> Vec<Box<dyn Method>> {
    let products = products(samples);
    if !products.is_empty() {
        return products;
    }
    let (m, d) = (samples.len(), samples.inputs());
    let mut radial = Vec::new();
    if m <= 2000 && d > 1 {
        radial.extend([Kernel::ThinPlate, Kernel::Cubic, Kernel::Quintic].map(RbfParams::new));
        radial.push(RbfParams::new(Kernel::Cubic).with_tail(2));
    }
    if m <= 600 {
        radial.extend([Kernel::Multiquadric, Kernel::Gaussian].map(RbfParams::new));
    }
    let small = m >= 10 && (m <= 2000 || d == 1);
    let networks = if small { NetworkParams::suited(samples) } else { vec![] };
    let splines = splines(samples).into_iter().map(boxed);
    splines.chain(radial.into_iter().map(boxed)).chain(networks.into_iter().map(boxed)).collect()
}

fn boxed(method: impl Method + 'static) -> Box<dyn Method> {
    Box::new(method)
}

fn splines(samples: &Samples) -> Vec<SplineParams> {
    let (Ok(highest), Ok(_)) = (SplineParams::highest(samples), samples.grid()) else { return vec![] };
    let mut splines: Vec<SplineParams> = Degree::ALL.iter().map(|degree| highest.at_most(*degree)).collect();
    splines.dedup();
    splines
}

fn products(samples: &Samples) -> Vec<Box<dyn Method>> {
    let Ok(Runs { first, samples: runs }) = Runs::of(samples) else { return vec![] };
    let of_runs: Vec<usize> = runs.iter().map(|run| run[0]).collect();
    let (Some(others), Some(degree)) = (samples.without_first_input(&of_runs), Degree::highest(first.len()))
    else {
        return vec![];
    };
    if first.len() < 7 || runs.len() < 3 {
        return vec![];
    }
    let first = SplineParams::new(degree);
    let product = |others| boxed(ProductParams { first: first.clone(), others });
    candidates(&others).into_iter().map(product).collect()
}

#[cfg(test)]
mod tests;
