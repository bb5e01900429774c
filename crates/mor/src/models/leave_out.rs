//! Error of an interpolated function from functions that leave out values of its inputs.
use super::ModelError;
use crate::interpolation::{
    FitObserver, FitProgress, FitStage, InterpolationError, Interpolator, Method, Record, RecordError, Runs,
    Samples, load, thinned,
};

/// An estimate of the error of an interpolated function f along one input, or along the parameters of runs.
///
/// The values of the input are left out one by one, or, of 25 and more, in two classes that alternate. A function without
/// value k differs from f by its own error to leading order: |f₋ₖ(x) − f(x)|. Of these differences, for the n + 1 values
/// next to x of n inputs, all but the largest vanish at all values, as the error does. From one value less to none the
/// error changes as it does from two to one: by E₁/E₂, root mean squares at values that are left out alone, and together
/// with a neighbour (of classes: of every second and of every fourth value). The estimate is the largest difference but
/// one, times E₁/E₂: of polynomials of any degree at evenly spaced values from one to twice the error, if divided
/// differences of successive orders have one ratio. Outside all values the estimate is the largest difference.
pub(super) struct LeaveOut {
    /// Inputs that tell the values apart.
    inputs: Vec<usize>,
    /// All values, each input scaled to 0…1.
    values: Vec<Vec<f64>>,
    /// Functions, the one of number k % n without value k.
    without: Vec<Box<dyn Interpolator>>,
    /// E₁/E₂, at most 1.
    ratio: f64,
}

/// Intervals of every fourth value that tell how the error changes.
const LEAST: usize = 6;
/// So many values are left out in two classes.
const MANY: usize = 4 * LEAST + 1;
/// Pairs of values that are left out together, at most.
const PAIRS: usize = 4;
/// Values nearer than this to one another, relative to their extent, are the same.
const ROUND_OFF: f64 = 1e-12;

/// Samples with one value.
struct Group {
    value: Vec<f64>,
    samples: Vec<usize>,
}

impl LeaveOut {
    const KIND: &str = "leave-out estimate";

    /// Estimates along the first so many inputs: along each of a grid; else along the first one, and along the others
    /// together if they are parameters of runs at the same values of the first.
    ///
    /// # Errors
    /// [`InterpolationError::Stopped`] by the observer.
    pub(super) fn all(
        samples: &Samples,
        inputs: usize,
        method: &dyn Method,
        observer: FitObserver<'_>,
    ) -> Result<Vec<Self>, InterpolationError> {
        let points = samples.first_inputs(inputs);
        let mut directions: Vec<Vec<usize>> = if inputs == 1 || points.grid().is_ok() {
            (0..inputs).map(|i| vec![i]).collect()
        } else if Runs::of(&points).is_ok() {
            vec![vec![0], (1..inputs).collect()]
        } else {
            vec![vec![0]]
        };
        directions.retain(|inputs| samples.domain()[inputs[0]][0] < samples.domain()[inputs[0]][1]);
        let count = directions.len();
        let mut all = Vec::new();
        for (i, inputs) in directions.into_iter().enumerate() {
            let estimate =
                FitProgress::new(FitStage::Estimate, i + 1, count).run(&mut *observer, |observer| {
                    let mut is_stopped = false;
                    let estimate = Self::new(samples, inputs, |progress, kept| {
                        let samples = samples.subset(kept).filter(|_| !is_stopped)?;
                        let function =
                            progress.run(&mut *observer, |observer| method.fit_observed(&samples, observer));
                        is_stopped = matches!(function, Err(InterpolationError::Stopped));
                        function.ok()
                    });
                    if is_stopped { Err(InterpolationError::Stopped) } else { Ok(estimate) }
                })?;
            all.extend(estimate);
        }
        Ok(all)
    }

    /// `None` if there are fewer than three values, or not enough for functions of some samples
    /// (`fit`) without some of them.
    fn new(
        samples: &Samples,
        inputs: Vec<usize>,
        mut fit: impl FnMut(FitProgress<'_>, &[usize]) -> Option<Box<dyn Interpolator>>,
    ) -> Option<Self> {
        let groups = groups(samples, &inputs);
        let n = groups.len();
        if n < 3 {
            return None;
        }
        let classes = if n < MANY { n } else { 2 };
        // Functions at the ends extrapolate.
        let ends = usize::from(inputs.len() == 1);
        let inside = ends..n - ends;
        let tested: Vec<usize> = if n < MANY { thinned(inside, PAIRS).collect() } else { inside.collect() };
        let fits = classes + if n < MANY { tested.len() } else { 1 };
        let mut step = 0;
        let mut fit = |is_kept: &dyn Fn(usize) -> bool| {
            let kept = (0..n).filter(|k| is_kept(*k)).flat_map(|k| groups[k].samples.iter().copied());
            step += 1;
            fit(FitProgress::new(FitStage::Fold, step, fits), &kept.collect::<Vec<_>>())
        };
        // Sum of squares of the errors at the samples of a group.
        let error = |f: &dyn Interpolator, k: usize| -> Option<f64> {
            let mut y = vec![0.0; f.outputs()];
            let mut square = 0.0;
            for &j in &groups[k].samples {
                f.predict(samples.point(j), &mut y).ok()?;
                square += square_distance(&y, samples.value(j));
            }
            Some(square / groups[k].samples.len() as f64)
        };
        let mean = |squares: Vec<f64>| squares.iter().sum::<f64>() / squares.len() as f64;
        let without: Vec<_> = (0..classes).map(|c| fit(&|k| k % classes != c)).collect::<Option<Vec<_>>>()?;
        let alone = tested.iter().map(|k| error(&*without[k % classes], *k)).collect::<Option<Vec<_>>>()?;
        let together = if n < MANY {
            let mut pair = |k: usize| {
                let values = groups.iter().map(|g| &g.value[..]);
                let neighbour = nearest(&groups[k].value, values, 2)[1];
                match fit(&|l| l != k && l != neighbour) {
                    Some(f) => error(&*f, k),
                    // Less than any method: the neighbour's values.
                    None => {
                        let [own, other] = [k, neighbour].map(|k| &groups[k].samples);
                        let squares = own.iter().zip(other);
                        let squares =
                            squares.map(|(i, j)| square_distance(samples.value(*i), samples.value(*j)));
                        Some(mean(squares.collect()))
                    }
                }
            };
            tested.iter().map(|k| pair(*k)).collect::<Option<Vec<_>>>()?
        } else {
            let quarter = fit(&|k| k % 4 == 0)?;
            let last = (n - 1) / 4 * 4;
            (2..last).step_by(4).map(|k| error(&*quarter, k)).collect::<Option<Vec<_>>>()?
        };
        let [alone, together] = [alone, together].map(mean);
        let ratio = if together > 0.0 { (alone / together).sqrt().min(1.0) } else { 1.0 };
        let values = groups.into_iter().map(|g| g.value).collect();
        Some(Self { inputs, values, without, ratio })
    }

    pub(super) fn inputs(&self) -> &[usize] {
        &self.inputs
    }

    /// The estimate at x, where the function with this `domain` is `y`; `predict` evaluates others there.
    pub(super) fn at(
        &self,
        x: &[f64],
        y: &[f64],
        domain: &[[f64; 2]],
        predict: impl Fn(&dyn Interpolator) -> Result<Vec<f64>, InterpolationError>,
    ) -> Result<f64, ModelError> {
        let value: Vec<f64> = self.inputs.iter().map(|i| scaled(x[*i], domain[*i])).collect();
        let around = nearest(&value, self.values.iter().map(Vec::as_slice), self.inputs.len() + 1);
        let (mut most, mut second) = (0.0_f64, 0.0_f64);
        for k in around {
            let other = predict(&*self.without[k % self.without.len()])?;
            let distance = square_distance(&other, y).sqrt();
            (most, second) = (most.max(distance), second.max(distance.min(most)));
        }
        let is_between = value.iter().all(|v| (0.0..=1.0).contains(v));
        Ok(if is_between { self.ratio * second } else { most })
    }

    pub(super) fn record(&self) -> Record {
        let record = Record::new(Self::KIND)
            .with("inputs", self.inputs.iter().map(|i| *i as f64))
            .with("values", self.values.iter().flatten().copied())
            .with("functions", [self.without.len() as f64])
            .with("ratio", [self.ratio]);
        let without = self.without.iter().enumerate();
        without.fold(record, |record, (k, f)| record.with_record(&format!("without {k}"), &f.record()))
    }
    pub(super) fn from_record(record: &Record) -> Result<Self, RecordError> {
        record.expect(Self::KIND)?;
        let (inputs, numbers) = (record.counts("inputs")?, record.numbers("values")?);
        if inputs.is_empty() || numbers.is_empty() || !numbers.len().is_multiple_of(inputs.len()) {
            return Err(record.wrong("values", "are not those of the inputs".into()));
        }
        let values: Vec<Vec<f64>> = numbers.chunks_exact(inputs.len()).map(<[f64]>::to_vec).collect();
        let functions = record.count("functions")?;
        if functions != values.len() && functions != 2 {
            return Err(record.wrong("functions", "are not those of the values".into()));
        }
        let without = |k| load(&record.record(&format!("without {k}"))?);
        Ok(Self {
            inputs,
            values,
            without: (0..functions).map(without).collect::<Result<_, _>>()?,
            ratio: record.number("ratio")?,
        })
    }
    /// Whether it is one of functions with these numbers of inputs and outputs, along the first `slow` inputs.
    pub(super) fn fits(&self, slow: usize, sizes: [usize; 2]) -> bool {
        self.inputs.iter().all(|i| *i < slow)
            && self.without.iter().all(|f| [f.inputs(), f.outputs()] == sizes)
    }
}

/// Samples by their scaled values of some of the inputs, upwards.
fn groups(samples: &Samples, inputs: &[usize]) -> Vec<Group> {
    let value = |j: usize| -> Vec<f64> {
        inputs.iter().map(|i| scaled(samples.point(j)[*i], samples.domain()[*i])).collect()
    };
    let mut order: Vec<(Vec<f64>, usize)> = (0..samples.len()).map(|j| (value(j), j)).collect();
    order.sort_by(|a, b| a.0.partial_cmp(&b.0).unwrap_or(std::cmp::Ordering::Equal));
    let mut groups: Vec<Group> = Vec::new();
    for (value, j) in order {
        let same = |g: &&mut Group| g.value.iter().zip(&value).all(|(a, b)| (a - b).abs() <= ROUND_OFF);
        match groups.last_mut().filter(|g| same(g)) {
            Some(group) => group.samples.push(j),
            None => groups.push(Group { value, samples: vec![j] }),
        }
    }
    groups
}

/// From 0 to 1 over the samples.
fn scaled(x: f64, [low, high]: [f64; 2]) -> f64 {
    if high > low { (x - low) / (high - low) } else { x - low }
}

/// Numbers of the values nearest to a point, upwards by distance.
fn nearest<'a>(point: &[f64], values: impl Iterator<Item = &'a [f64]>, count: usize) -> Vec<usize> {
    let mut all: Vec<(f64, usize)> =
        values.enumerate().map(|(k, value)| (square_distance(value, point), k)).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.into_iter().take(count).map(|(_, k)| k).collect()
}

pub(super) fn square_distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}
