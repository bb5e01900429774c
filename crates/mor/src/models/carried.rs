//! What one frame of a model carries.
use super::ModelError;
use super::coefficients::Coefficients;
use crate::interpolation::{Method, Record, RecordError, Samples};
use crate::shifted::{Frame, Grid, Motion};
use crate::{Mat, MatRef};
use std::f64::consts::TAU;

/// What one frame carries.
pub(super) struct Carried {
    pub(super) modes: Mat<f64>,
    /// None without modes.
    pub(super) coefficients: Option<Coefficients>,
    /// Axes whose phase is an input of the coefficients, too.
    phases: Vec<usize>,
}

impl Carried {
    /// The modes.
    pub(super) fn columns(&self) -> Vec<&[f64]> {
        (0..self.modes.ncols()).map(|i| self.modes.col_as_slice(i)).collect()
    }

    pub(super) fn fit(
        points: MatRef<'_, f64>,
        frame: &Frame,
        grid: &Grid,
        motion: &dyn Fn(usize) -> Motion,
        method: Option<&dyn Method>,
    ) -> Result<Self, ModelError> {
        let mut carried = Self { modes: frame.modes.clone(), coefficients: None, phases: Vec::new() };
        if frame.rank() == 0 {
            return Ok(carried);
        }
        let values = frame.scaled_coefficients();
        let plain = Coefficients::fit(&Samples::new(points, values.as_ref())?, method, false);
        if points.nrows() == 1 {
            let first = motion(0).displacement;
            let crosses = |a: usize| {
                let far = |j: usize| (motion(j).displacement[a] - first[a]).abs() > 0.5 * grid.spacing()[a];
                grid.cells()[a] > 1 && (0..points.ncols()).any(far)
            };
            carried.phases = (0..3).filter(|&a| crosses(a)).collect();
            if !carried.phases.is_empty() {
                let all: Vec<Vec<f64>> = (0..points.ncols())
                    .map(|j| carried.inputs(&[points[(0, j)]], &motion(j), grid))
                    .collect();
                let inputs = Mat::from_fn(all[0].len(), points.ncols(), |i, j| all[j][i]);
                let phased = Coefficients::fit(&Samples::new(inputs.as_ref(), values.as_ref())?, None, true);
                match (phased, &plain) {
                    (Ok(phased), Ok(plain)) if phased.error() < plain.error() => {
                        carried.coefficients = Some(phased);
                        return Ok(carried);
                    }
                    _ => carried.phases.clear(),
                }
            }
        }
        carried.coefficients = Some(plain?);
        Ok(carried)
    }

    /// x and the phases.
    pub(super) fn inputs(&self, x: &[f64], motion: &Motion, grid: &Grid) -> Vec<f64> {
        let phase = |&a: &usize| {
            let cells: f64 = motion.displacement[a] / grid.spacing()[a];
            let (sin, cos) = (TAU * cells.fract()).sin_cos();
            [cos, sin]
        };
        x.iter().copied().chain(self.phases.iter().flat_map(phase)).collect()
    }

    pub(super) fn record(&self) -> Record {
        let r = self.modes.ncols();
        let record = Record::new("frame")
            .with("rank", [r as f64])
            .with("modes", (0..r).flat_map(|i| self.modes.col_as_slice(i).iter().copied()))
            .with("phases", self.phases.iter().map(|&a| a as f64));
        match &self.coefficients {
            Some(function) => record.with_record("coefficients", &function.record()),
            None => record,
        }
    }
    pub(super) fn from_record(record: &Record, rows: usize) -> Result<Self, RecordError> {
        record.expect("frame")?;
        let rank = record.count("rank")?;
        let values = record.numbers_of("modes", rows * rank)?;
        let phases = record.counts("phases")?;
        if phases.iter().any(|&a| a > 2) {
            return Err(record.wrong("phases", format!("are those of axes {phases:?}")));
        }
        let coefficients = match rank {
            0 => None,
            _ => Some(Coefficients::from_record(&record.record("coefficients")?)?),
        };
        if coefficients.as_ref().is_some_and(|c| c.outputs() != rank) {
            return Err(record.wrong("rank", "does not fit the coefficients".into()));
        }
        Ok(Self { modes: Mat::from_fn(rows, rank, |row, i| values[row + i * rows]), coefficients, phases })
    }
}
