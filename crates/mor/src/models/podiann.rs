//! POD with interpolated coefficients.
use super::assessment::Sums;
use super::coefficients::Coefficients;
use super::modes::write_modes;
use super::{Assessment, Extrapolation, ModelError};
use crate::interpolation::{FitObserver, Method, Record, RecordError, Samples, unobserved};
use crate::pod::{Pod, combine};
use crate::shifted::{Grid, ShiftedError};
use crate::{Mat, MatRef};
use std::io;
use std::path::Path;

/// Q(x, t, μ) ≈ Q̄(x) + Σ_i c_i(t, μ) φ_i(x): the modes of a [`Pod`] with interpolated coefficients (PODIANN; Isoz et al. 2023, equation (7) and figure 8).
///
/// Inputs are time and then parameters.
pub struct Podiann {
    pod: Pod,
    /// Φ once more, mode by mode, if predictions are made in single precision.
    single: Option<Vec<Vec<f32>>>,
    /// None without modes.
    coefficients: Option<Coefficients>,
    inputs: usize,
    /// ‖Q − ΠQ‖/‖Q‖ of the snapshots it was made of.
    projection_error: f64,
    /// Root mean square norm of a snapshot.
    typical: f64,
}

impl Podiann {
    const KIND: &str = "PODIANN";

    /// Of the modes of snapshots at points (inputs × snapshots), interpolated by the method given or that which predicts samples best that are held out.
    ///
    /// # Errors
    /// [`ModelError`]: sizes that do not fit, and those of the interpolation.
    pub fn new(points: MatRef<'_, f64>, pod: &Pod, method: Option<&dyn Method>) -> Result<Self, ModelError> {
        Self::new_observed(points, pod, method, &mut unobserved)
    }
    /// The same with an observer: methods compared, error estimates, and the fit of all samples.
    ///
    /// # Errors
    /// As [`new`](Self::new);
    /// [`InterpolationError::Stopped`](crate::interpolation::InterpolationError::Stopped) by the
    /// observer.
    pub fn new_observed(
        points: MatRef<'_, f64>,
        pod: &Pod,
        method: Option<&dyn Method>,
        observer: FitObserver<'_>,
    ) -> Result<Self, ModelError> {
        let m = points.ncols();
        ModelError::same("columns of coefficients, one for each point", m, pod.coefficients.ncols())?;
        let values = pod.scaled_coefficients();
        let coefficients = match pod.rank() {
            0 => None,
            _ => Some(Coefficients::fit(&Samples::new(points, values.as_ref())?, method, observer)?),
        };
        let weight = |i: usize| pod.weights.as_ref().map_or(1.0, |w| w[i]);
        let mean = pod.mean.iter().flatten().enumerate().map(|(i, x)| weight(i) * x * x).sum::<f64>();
        let typical = (mean + pod.energy / m as f64).sqrt();
        let left = pod.relative_error(pod.rank()) * (pod.energy / m as f64).sqrt();
        let projection_error = if left == 0.0 { 0.0 } else { left / typical };
        // The coefficients are in the function.
        let pod = Pod { coefficients: Mat::zeros(pod.rank(), 0), ..pod.clone() };
        Ok(Self { pod, single: None, coefficients, inputs: points.nrows(), projection_error, typical })
    }

    /// Time and parameters.
    #[must_use]
    pub fn inputs(&self) -> usize {
        self.inputs
    }
    /// Unknowns of a field.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.pod.rows()
    }
    /// How many modes it has.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.pod.rank()
    }
    /// Φ, rows × r.
    #[must_use]
    pub fn modes(&self) -> MatRef<'_, f64> {
        self.pod.modes.as_ref()
    }
    /// Name of the method of the coefficients; none without modes.
    #[must_use]
    pub fn method(&self) -> Option<&str> {
        self.coefficients.as_ref().map(Coefficients::method)
    }
    /// The same with another continuation of the coefficients beyond the samples ([`covers`](Self::covers)); it is linear unless given.
    #[must_use]
    pub fn extrapolated(mut self, how: Extrapolation) -> Self {
        self.coefficients.iter_mut().for_each(|function| function.extrapolate(how));
        self
    }
    /// Is x within the samples' times and parameters? Predictions elsewhere are extrapolations ([`Extrapolation`]).
    #[must_use]
    pub fn covers(&self, x: &[f64]) -> bool {
        let domain = self.coefficients.as_ref().map_or(&[][..], |c| c.domain());
        x.len() == self.inputs && x.iter().zip(domain).all(|(x, [low, high])| (low..=high).contains(&x))
    }

    /// The same with predictions in single precision, which read half as much: they are off by no more than (r + 2) 2⁻²⁴ Σ_i |c_i φ_i| at a place, for r modes. All
    /// else, files too, stays in double precision; the modes take half as much memory again.
    #[must_use]
    pub fn in_single_precision(mut self) -> Self {
        let single = |k: usize| self.pod.modes.col_as_slice(k).iter().map(|m| *m as f32).collect();
        self.single = Some((0..self.rank()).map(single).collect());
        self
    }

    /// The field at time and parameters x into `out`.
    ///
    /// # Errors
    /// [`ModelError::Shape`], [`ModelError::Interpolation`].
    pub fn predict(&self, x: &[f64], out: &mut [f64]) -> Result<(), ModelError> {
        self.predict_many(MatRef::from_column_major_slice(x, x.len(), 1), out)
    }

    /// The fields at points that are columns (inputs × n), one after the other: modes are read once for all of them. Each is the same bit for bit as by
    /// [`predict`](Self::predict).
    ///
    /// # Errors
    /// As [`predict`](Self::predict).
    pub fn predict_many(&self, points: MatRef<'_, f64>, fields: &mut [f64]) -> Result<(), ModelError> {
        ModelError::same("inputs", self.inputs, points.nrows())?;
        ModelError::same("rows of all fields", self.rows() * points.ncols(), fields.len())?;
        let c = match &self.coefficients {
            Some(function) => function.predict_all(points)?,
            None => Mat::zeros(0, points.ncols()),
        };
        if let Some(single) = &self.single {
            let modes: Vec<&[f32]> = single.iter().map(|m| &m[..]).collect();
            combine(&modes, self.pod.mean.as_deref(), c.as_ref(), fields);
            return Ok(());
        }
        Ok(self.pod.reconstruct_all(c.as_ref(), fields)?)
    }

    /// Estimate of the relative error at x: ‖Q − ΠQ‖/‖Q‖ of the snapshots, and the error of the coefficients from functions
    /// that leave out values of time and of the parameters, relative to the root mean square of the snapshots.
    ///
    /// # Errors
    /// As [`predict`](Self::predict).
    pub fn error_indicator(&self, x: &[f64]) -> Result<f64, ModelError> {
        ModelError::same("inputs", self.inputs, x.len())?;
        let Some(function) = &self.coefficients else { return Ok(self.projection_error) };
        let off = function.doubt(x)? / self.typical.max(f64::MIN_POSITIVE);
        Ok(self.projection_error.hypot(off))
    }

    /// Errors of the predictions at points of snapshots (rows × m).
    ///
    /// # Errors
    /// As [`predict`](Self::predict).
    pub fn assess(
        &self,
        points: MatRef<'_, f64>,
        snapshots: MatRef<'_, f64>,
    ) -> Result<Assessment, ModelError> {
        self.sums(points, snapshots).map(Sums::assessment)
    }
    pub(super) fn sums(
        &self,
        points: MatRef<'_, f64>,
        snapshots: MatRef<'_, f64>,
    ) -> Result<Sums, ModelError> {
        ModelError::same("snapshots, one for each point", points.ncols(), snapshots.ncols())?;
        let mut sums = Sums::default();
        let (mut nearest, mut predicted) = (vec![0.0; self.rows()], vec![0.0; self.rows()]);
        for j in 0..points.ncols() {
            let x: Vec<f64> = (0..points.nrows()).map(|i| points[(i, j)]).collect();
            self.predict(&x, &mut predicted)?;
            let snapshot: Vec<f64> = snapshots.col(j).iter().copied().collect();
            self.pod.reconstruct(&self.pod.project(&snapshot)?, &mut nearest)?;
            sums.add(&snapshot, &nearest, &predicted);
        }
        Ok(sums)
    }

    /// All of it, for a file.
    #[must_use]
    pub fn record(&self) -> Record {
        let (pod, r) = (&self.pod, self.rank());
        let record = Record::new(Self::KIND)
            .with("sizes", [self.inputs as f64, self.rows() as f64, r as f64])
            .with("modes", (0..r).flat_map(|k| pod.modes.col_as_slice(k).iter().copied()))
            .with("singular values", pod.singular_values.iter().copied())
            .with("mean", pod.mean.iter().flatten().copied())
            .with("weights", pod.weights.iter().flatten().copied())
            .with("errors", [self.projection_error, self.typical, pod.energy]);
        match &self.coefficients {
            Some(function) => record.with_record("coefficients", &function.record()),
            None => record,
        }
    }

    /// What [`record`](Self::record) recorded.
    ///
    /// # Errors
    /// [`RecordError`] if it is no such model, or not whole.
    pub fn from_record(record: &Record) -> Result<Self, RecordError> {
        record.expect(Self::KIND)?;
        let [inputs, rows, rank] = record.counts("sizes")?[..] else {
            return Err(record.wrong("sizes", "are not three".into()));
        };
        let [projection_error, typical, energy] = record.numbers("errors")?[..] else {
            return Err(record.wrong("errors", "are not three".into()));
        };
        let values = record.numbers_of("modes", rows * rank)?;
        let optional = |name: &str| -> Result<Option<Vec<f64>>, RecordError> {
            match record.numbers(name)? {
                [] => Ok(None),
                _ => Ok(Some(record.numbers_of(name, rows)?.to_vec())),
            }
        };
        let coefficients = match rank {
            0 => None,
            _ => Some(Coefficients::from_record(&record.record("coefficients")?)?),
        };
        if coefficients.as_ref().is_some_and(|c| c.outputs() != rank || c.inputs() != inputs) {
            return Err(record.wrong("sizes", "do not fit the coefficients".into()));
        }
        let pod = Pod {
            mean: optional("mean")?,
            modes: Mat::from_fn(rows, rank, |i, k| values[i + k * rows]),
            singular_values: record.numbers("singular values")?.to_vec(),
            coefficients: Mat::zeros(rank, 0),
            weights: optional("weights")?,
            energy,
        };
        if pod.singular_values.len() < rank {
            return Err(record.wrong("singular values", "are fewer than the modes".into()));
        }
        Ok(Self { pod, single: None, coefficients, inputs, projection_error, typical })
    }

    /// Writes all modes, and the mean, as cell data of an image for ParaView (`.vti`): `mode i`, with the component if there are several.
    ///
    /// # Errors
    /// Of the file system; [`ShiftedError::Rows`] as its source if this is another grid's model.
    pub fn write_modes(&self, path: &Path, grid: &Grid) -> io::Result<()> {
        if !self.rows().is_multiple_of(grid.n_cells()) {
            return Err(io::Error::other(ShiftedError::Rows { rows: self.rows(), cells: grid.n_cells() }));
        }
        let mean = self.pod.mean.iter().map(|mean| ("mean".to_owned(), &mean[..]));
        let modes = (0..self.rank()).map(|k| (format!("mode {k}"), self.pod.modes.col_as_slice(k)));
        write_modes(path, grid, mean.chain(modes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pod::{PodParams, Rank};

    /// Rank 3 about a mean, smooth in t and μ.
    fn field(t: f64, mu: f64) -> Vec<f64> {
        let at = |i: usize| {
            let x = i as f64 / 60.0;
            2.0 + (3.0 * x).sin() * (t * mu).cos() + (5.0 * x).cos() * (t + mu) + x * x * (2.0 * t).sin()
        };
        (0..60).map(at).collect()
    }

    /// 21 times at 4 parameters.
    fn model(mean: bool) -> Podiann {
        let point = |j: usize| [(j % 21) as f64 / 20.0, 0.5 + 0.25 * (j / 21) as f64];
        let points = Mat::from_fn(2, 84, |i, j| point(j)[i]);
        let fields: Vec<Vec<f64>> = (0..84).map(|j| field(point(j)[0], point(j)[1])).collect();
        let snapshots = Mat::from_fn(60, 84, |i, j| fields[j][i]);
        let params = PodParams { subtract_mean: mean, rank: Rank::Tolerance(1e-10), ..PodParams::default() };
        Podiann::new(points.as_ref(), &Pod::new(snapshots.as_ref(), &params).unwrap(), None).unwrap()
    }

    #[test]
    fn predictions_at_new_times_and_parameters() {
        for mean in [false, true] {
            let model = model(mean);
            assert_eq!(model.rank(), if mean { 3 } else { 4 });
            let x = [[0.33, 0.6], [0.81, 1.1]];
            let points = Mat::from_fn(2, 2, |i, j| x[j][i]);
            let fields = x.map(|[t, mu]| field(t, mu));
            let found =
                model.assess(points.as_ref(), Mat::from_fn(60, 2, |i, j| fields[j][i]).as_ref()).unwrap();
            assert!(found.projection < 1e-9 && found.total < 1e-4 && found.total > 1e-9, "{found:?}");
            // The indicator is no smaller than the error, and larger where nothing is known.
            let told = model.error_indicator(&x[0]).unwrap();
            assert!(told > 0.3 * found.total && told < 100.0 * found.total, "{told:e} {found:?}");
            assert!(model.error_indicator(&[0.5, 2.5]).unwrap() > 5.0 * told);
            assert!(model.covers(&x[1]) && !model.covers(&[0.5, 2.5]));
        }
    }

    /// Between snapshots in time the indicator is what the error is, within a factor of 8 (measured: 7), by splines and by a network, where every fourth snapshot would show the motion.
    #[test]
    fn the_indicator_is_the_error() {
        let network = crate::interpolation::NetworkParams {
            iterations: 60,
            ..crate::interpolation::NetworkParams::new(&[12])
        };
        let methods: [(usize, Option<&dyn Method>); 4] =
            [(61, None), (121, None), (241, None), (81, Some(&network))];
        let mut missed = vec![];
        for (m, method) in methods {
            let time = |j: f64| 4.0 * j / (m - 1) as f64;
            let at = |t: f64| field(t * (1.0 + 0.3 * (5.0 * t).sin()), 1.3);
            let matrix = |times: &[f64]| {
                let fields: Vec<_> = times.iter().map(|t| at(*t)).collect();
                Mat::from_fn(60, times.len(), |i, j| fields[j][i])
            };
            let row = |times: &[f64]| Mat::from_fn(1, times.len(), |_, j| times[j]);
            let times: Vec<f64> = (0..m).map(|j| time(j as f64)).collect();
            let pod = Pod::new(
                matrix(&times).as_ref(),
                &PodParams { rank: Rank::Tolerance(1e-10), ..PodParams::default() },
            );
            let model = Podiann::new(row(&times).as_ref(), &pod.unwrap(), method).unwrap();
            let held_out: Vec<f64> = (0..m - 1).map(|j| time(j as f64 + 0.5)).collect();
            let found = model.assess(row(&held_out).as_ref(), matrix(&held_out).as_ref()).unwrap().total;
            let told: f64 = held_out.iter().map(|t| model.error_indicator(&[*t]).unwrap().powi(2)).sum();
            let told = (told / held_out.len() as f64).sqrt();
            if told > 8.0 * found || found > 5.0 * told {
                missed.push((m, told, found));
            }
        }
        assert!(missed.is_empty(), "{missed:?}");
    }

    #[test]
    fn files_give_the_model_back() {
        let model = model(true);
        let again = Podiann::from_record(&Record::from_bytes(&model.record().to_bytes()).unwrap()).unwrap();
        let (mut a, mut b) = (vec![0.0; 60], vec![0.0; 60]);
        model.predict(&[0.2, 0.7], &mut a).unwrap();
        again.predict(&[0.2, 0.7], &mut b).unwrap();
        assert_eq!(a, b);
        assert_eq!(again.error_indicator(&[0.2, 0.7]).unwrap(), model.error_indicator(&[0.2, 0.7]).unwrap());
        let path = std::env::temp_dir().join(format!("siltflow-pod-modes-{}.vti", std::process::id()));
        again.write_modes(&path, &Grid::new([10, 3], [1.0, 2.0]).unwrap()).unwrap();
        let text = String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned();
        assert!(text.contains("Name=\"mean component 1\"") && text.contains("Name=\"mode 2 component 0\""));
        std::fs::remove_file(&path).unwrap();
        assert!(again.write_modes(&path, &Grid::new([7], [1.0]).unwrap()).is_err());
        assert!(Podiann::from_record(&model.record().with("sizes", [2.0, 59.0, 3.0])).is_err());
    }

    /// Without a mode the mean is the model.
    #[test]
    fn constant_snapshots() {
        let snapshots = Mat::from_fn(5, 4, |i, _| i as f64);
        let params = PodParams { subtract_mean: true, ..PodParams::default() };
        let pod = Pod::new(snapshots.as_ref(), &params).unwrap();
        let points = Mat::from_fn(1, 4, |_, j| j as f64);
        let model = Podiann::new(points.as_ref(), &pod, None).unwrap();
        let mut out = [0.0; 5];
        model.predict(&[1.5], &mut out).unwrap();
        assert_eq!(out, [0.0, 1.0, 2.0, 3.0, 4.0]);
        assert_eq!(model.error_indicator(&[1.5]).unwrap(), 0.0);
        assert!(matches!(
            Podiann::new(points.subcols(0, 3), &pod, None),
            Err(ModelError::Shape { expected: 3, found: 4, .. })
        ));
    }

    /// f = sin(3x − tμ) + .3 μ² cos 5x cos 2t at 41 times and n values of μ: the root mean square of the indicator
    /// is from 0.5 to 6 times that of the error at times and parameters between those, each alone and both together.
    #[test]
    fn the_indicator_is_the_error_with_parameters() {
        let at = |t: f64, mu: f64| -> Vec<f64> {
            let x = |i: i32| 2.0 * std::f64::consts::PI * f64::from(i) / 64.0;
            (0..64)
                .map(|i| (3.0 * x(i) - t * mu).sin() + 0.3 * mu * mu * (5.0 * x(i)).cos() * (2.0 * t).cos())
                .collect()
        };
        for n in 3..=8_u32 {
            let mu = |k: f64| 0.5 + 1.5 * k / f64::from(n - 1);
            let time = |j: f64| 2.0 * j / 40.0;
            let points = Mat::from_fn(2, 41 * n as usize, |i, j| {
                if i == 0 { time((j % 41) as f64) } else { mu((j / 41) as f64) }
            });
            let fields: Vec<_> = (0..points.ncols()).map(|j| at(points[(0, j)], points[(1, j)])).collect();
            let snapshots = Mat::from_fn(64, fields.len(), |i, j| fields[j][i]);
            let params = PodParams { rank: Rank::Tolerance(1e-10), ..PodParams::default() };
            let model =
                Podiann::new(points.as_ref(), &Pod::new(snapshots.as_ref(), &params).unwrap(), None).unwrap();
            let mut out = vec![0.0; 64];
            let typical = snapshots.squared_norm_l2() / snapshots.ncols() as f64;
            for (dt, dmu) in [(0.5, 0.0), (0.0, 0.5), (0.5, 0.5), (0.25, 0.2), (0.5, 0.01)] {
                let (mut told, mut found) = (0.0, 0.0);
                for j in 0..40 {
                    for k in 0..n - 1 {
                        let x = [time(f64::from(j) + dt), mu(f64::from(k) + dmu)];
                        model.predict(&x, &mut out).unwrap();
                        let square: f64 = out.iter().zip(&at(x[0], x[1])).map(|(a, b)| (a - b).powi(2)).sum();
                        found += square / typical;
                        told += model.error_indicator(&x).unwrap().powi(2);
                    }
                }
                let ratio = (told / found).sqrt();
                assert!(
                    (0.5..6.0).contains(&ratio),
                    "{n} values, {dt} and {dmu} between: {ratio} times the error"
                );
            }
        }
    }

    /// Runs at scattered points of two parameters: within a factor of 5 at random times and parameters.
    #[test]
    fn the_indicator_is_the_error_between_scattered_runs() {
        let at = |t: f64, mu: [f64; 2]| -> Vec<f64> {
            let x = |i: i32| 2.0 * std::f64::consts::PI * f64::from(i) / 64.0;
            let one = |i: i32| {
                (3.0 * x(i) - t * (1.0 + 0.5 * mu[0])).sin()
                    + 0.3 * mu[1] * mu[1] * (5.0 * x(i) + mu[0]).cos()
            };
            (0..64).map(one).collect()
        };
        // Points of Halton's sequence.
        let halton = |mut k: u32, base: u32| {
            let (mut share, mut x) = (1.0, 0.0);
            while k > 0 {
                share /= f64::from(base);
                x += share * f64::from(k % base);
                k /= base;
            }
            x
        };
        let mu = |k: u32| [halton(k, 2), halton(k, 3)];
        for runs in [12, 24] {
            let points = Mat::from_fn(3, 31 * runs as usize, |i, j| match i {
                0 => (j % 31) as f64 / 15.0,
                _ => mu(j as u32 / 31 + 1)[i - 1],
            });
            let fields: Vec<_> =
                (0..points.ncols()).map(|j| at(points[(0, j)], [points[(1, j)], points[(2, j)]])).collect();
            let snapshots = Mat::from_fn(64, fields.len(), |i, j| fields[j][i]);
            let params = PodParams { rank: Rank::Tolerance(1e-10), ..PodParams::default() };
            let model =
                Podiann::new(points.as_ref(), &Pod::new(snapshots.as_ref(), &params).unwrap(), None).unwrap();
            let typical = snapshots.squared_norm_l2() / snapshots.ncols() as f64;
            let (mut told, mut found, mut out) = (0.0, 0.0, vec![0.0; 64]);
            for k in 100..200 {
                let [a, b] = mu(k);
                let x = [2.0 * halton(k, 5), 0.25 + 0.5 * a, 0.25 + 0.5 * b];
                model.predict(&x, &mut out).unwrap();
                let square: f64 = out.iter().zip(&at(x[0], [x[1], x[2]])).map(|(a, b)| (a - b).powi(2)).sum();
                found += square / typical;
                told += model.error_indicator(&x).unwrap().powi(2);
            }
            let ratio = (told / found).sqrt();
            assert!((0.2..5.0).contains(&ratio), "{runs} runs: {ratio} times the error");
        }
    }
}
