//! Modes of one frame of reference and their coefficients.
use super::coefficients::{Choice, Coefficients};
use super::{Extrapolation, ModelError};
use crate::interpolation::{FitObserver, FitProgress, FitStage, Method, Record, RecordError, Samples};
use crate::shifted::{Frame, Grid, Motion};
use crate::{Mat, MatRef};
use std::f64::consts::TAU;

/// Method by which the coefficients of one frame were fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct CoefficientFit {
    /// Its name.
    pub method: String,
    /// Axes a whose phase θ_a = 2πs_a/h_a is an input as cos θ_a, sin θ_a; empty if phases are off.
    pub phases: Vec<usize>,
    /// Relative error (‖·‖ over all coefficients) of samples left out in fits of the others; 0 if they are too few.
    pub left_out: f64,
    /// That of the alternative: without phases if they are inputs, with them if they are off. None if the frame crosses no cells, or there is no such function.
    pub left_out_other: Option<f64>,
}

/// Modes that move along with one frame.
pub(super) struct MovingModes {
    pub(super) modes: Mat<f64>,
    /// None without modes.
    pub(super) coefficients: Option<Coefficients>,
    /// Axes whose phase is an input of the coefficients.
    phases: Vec<usize>,
    left_out: f64,
    left_out_other: Option<f64>,
}

impl MovingModes {
    /// The modes.
    pub(super) fn columns(&self) -> Vec<&[f64]> {
        (0..self.modes.ncols()).map(|i| self.modes.col_as_slice(i)).collect()
    }

    /// Coefficients at points (inputs × snapshots) by the method given or the one with the least error of samples left out; phases are inputs if that lowers it.
    pub(super) fn fit(
        points: MatRef<'_, f64>,
        frame: &Frame,
        grid: &Grid,
        motion: &dyn Fn(usize) -> Motion,
        given: Option<&dyn Method>,
        observer: FitObserver<'_>,
    ) -> Result<Self, ModelError> {
        let (modes, none) = (frame.modes.clone(), Vec::new());
        let mut fitted =
            Self { modes, coefficients: None, phases: none, left_out: 0.0, left_out_other: None };
        if frame.rank() == 0 {
            return Ok(fitted);
        }
        let (slow, m) = points.shape();
        let values = frame.scaled_coefficients();
        let samples = Samples::new(points, values.as_ref())?;
        let phases = crossed(grid, (0..m).map(motion));
        let x = |j: usize| points.col(j).iter().copied().collect::<Vec<_>>();
        let all: Vec<Vec<f64>> = (0..m).map(|j| with_phases(&phases, &x(j), &motion(j), grid)).collect();
        let inputs = Mat::from_fn(slow + 2 * phases.len(), m, |i, j| all[j][i]);
        let with_phases = Samples::new(inputs.as_ref(), values.as_ref())?;
        let count = if phases.is_empty() { 1 } else { 2 };
        let mut choice = |samples, step| {
            ModelError::unless_stopped(
                FitProgress::new(FitStage::Inputs, step, count)
                    .run(&mut *observer, |observer| Choice::new(samples, slow, given, observer)),
            )
        };
        let plain = choice(&samples, 1)?;
        let phased = if phases.is_empty() { None } else { Some(choice(&with_phases, 2)?) };
        let chosen = match (plain, phased) {
            (Ok(plain), Some(Ok(phased))) => {
                let [one, other] =
                    if phased.left_out < plain.left_out { [phased, plain] } else { [plain, phased] };
                fitted.left_out_other = Some(other.left_out);
                one
            }
            (Err(_), Some(Ok(phased))) => phased,
            (plain, _) => plain?,
        };
        fitted.left_out = chosen.left_out;
        let function = chosen.fit(observer)?;
        if function.inputs() > slow {
            fitted.phases = phases;
        }
        fitted.coefficients = Some(function);
        Ok(fitted)
    }

    /// x and the phases.
    pub(super) fn inputs(&self, x: &[f64], motion: &Motion, grid: &Grid) -> Vec<f64> {
        with_phases(&self.phases, x, motion, grid)
    }

    /// None without modes.
    pub(super) fn coefficient_fit(&self) -> Option<CoefficientFit> {
        self.coefficients.as_ref().map(|function| CoefficientFit {
            method: function.method().to_owned(),
            phases: self.phases.clone(),
            left_out: self.left_out,
            left_out_other: self.left_out_other,
        })
    }
    pub(super) fn extrapolate(&mut self, how: Extrapolation) {
        self.coefficients.iter_mut().for_each(|function| function.extrapolate(how));
    }

    pub(super) fn record(&self) -> Record {
        let r = self.modes.ncols();
        let record = Record::new("frame")
            .with("rank", [r as f64])
            .with("modes", (0..r).flat_map(|i| self.modes.col_as_slice(i).iter().copied()))
            .with("phases", self.phases.iter().map(|&a| a as f64))
            .with("left out", [self.left_out].into_iter().chain(self.left_out_other));
        match &self.coefficients {
            Some(function) => record.with_record("coefficients", &function.record()),
            None => record,
        }
    }
    /// For fields of so many rows and that many times and parameters.
    pub(super) fn from_record(record: &Record, rows: usize, slow: usize) -> Result<Self, RecordError> {
        record.expect("frame")?;
        let rank = record.count("rank")?;
        let values = record.numbers_of("modes", rows * rank)?;
        let phases = record.counts("phases")?;
        if phases.iter().any(|&a| a > 2) {
            return Err(record.wrong("phases", format!("are those of axes {phases:?}")));
        }
        let (left_out, left_out_other) = match record.numbers("left out")?[..] {
            [one] => (one, None),
            [one, other] => (one, Some(other)),
            _ => return Err(record.wrong("left out", "is not one number or two".into())),
        };
        let coefficients = match rank {
            0 => None,
            _ => Some(Coefficients::from_record(&record.record("coefficients")?)?),
        };
        let sizes = [rank, slow + 2 * phases.len()];
        if coefficients.as_ref().is_some_and(|c| [c.outputs(), c.inputs()] != sizes) {
            return Err(record.wrong("rank", "does not fit the coefficients".into()));
        }
        let modes = Mat::from_fn(rows, rank, |row, i| values[row + i * rows]);
        Ok(Self { modes, coefficients, phases, left_out, left_out_other })
    }
}

/// Axes along which motions reach farther than half a cell from the first one.
fn crossed(grid: &Grid, motions: impl Iterator<Item = Motion>) -> Vec<usize> {
    let displacements: Vec<_> = motions.map(|motion| motion.displacement).collect();
    let far =
        |a: usize| displacements.iter().any(|s| (s[a] - displacements[0][a]).abs() > 0.5 * grid.spacing()[a]);
    (0..3).filter(|&a| grid.cells()[a] > 1 && far(a)).collect()
}

/// x, then cos θ_a and sin θ_a of these axes.
fn with_phases(axes: &[usize], x: &[f64], motion: &Motion, grid: &Grid) -> Vec<f64> {
    let phase = |&a: &usize| {
        let cells: f64 = motion.displacement[a] / grid.spacing()[a];
        let (sin, cos) = (TAU * cells.fract()).sin_cos();
        [cos, sin]
    };
    x.iter().copied().chain(axes.iter().flat_map(phase)).collect()
}
