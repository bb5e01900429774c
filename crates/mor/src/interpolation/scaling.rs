//! Numbers of order one.
use super::{Record, RecordError};
use crate::MatRef;

/// z_i = (v_i − offset_i) · factor_i for every row i.
#[derive(Clone, Debug, PartialEq)]
pub struct Scaling {
    offsets: Vec<f64>,
    factors: Vec<f64>,
}

impl Scaling {
    /// Every row from its smallest and largest value to −1 and 1; a row with one value to 0.
    #[must_use]
    pub fn by_range(v: MatRef<'_, f64>) -> Self {
        let (offsets, factors) = ranges(v)
            .into_iter()
            .map(|[low, high]| (low + 0.5 * (high - low), if high > low { 2.0 / (high - low) } else { 1.0 }))
            .unzip();
        Self { offsets, factors }
    }
    /// Every row to mean zero, and all rows together, with one factor, to a root mean square of one: errors keep their weights.
    #[must_use]
    pub fn by_common_deviation(v: MatRef<'_, f64>) -> Self {
        let count = v.ncols().max(1) as f64;
        let row = |i: usize| (0..v.ncols()).map(move |j| v[(i, j)]);
        let offsets: Vec<f64> = (0..v.nrows()).map(|i| row(i).sum::<f64>() / count).collect();
        let squares: f64 =
            (0..v.nrows()).map(|i| row(i).map(|v| (v - offsets[i]).powi(2)).sum::<f64>()).sum();
        let deviation = (squares / (count * v.nrows().max(1) as f64)).sqrt();
        let factor = if deviation > 0.0 { 1.0 / deviation } else { 1.0 };
        Self { factors: vec![factor; offsets.len()], offsets }
    }
    /// How many rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.offsets.len()
    }
    /// z of a column v.
    pub fn apply(&self, v: &[f64], z: &mut [f64]) {
        for i in 0..z.len() {
            z[i] = (v[i] - self.offsets[i]) * self.factors[i];
        }
    }
    /// v of a column z, in place.
    pub fn undo(&self, z: &mut [f64]) {
        for i in 0..z.len() {
            z[i] = z[i] / self.factors[i] + self.offsets[i];
        }
    }
    /// dz_i/dv_i.
    #[must_use]
    pub fn factor(&self, i: usize) -> f64 {
        self.factors[i]
    }

    pub(super) fn record(&self) -> Record {
        Record::new("scaling")
            .with("offsets", self.offsets.iter().copied())
            .with("factors", self.factors.iter().copied())
    }
    pub(super) fn from_record(record: &Record, rows: usize) -> Result<Self, RecordError> {
        record.expect("scaling")?;
        let take = |name| record.numbers_of(name, rows).map(<[f64]>::to_vec);
        Ok(Self { offsets: take("offsets")?, factors: take("factors")? })
    }
}

/// Smallest and largest value of every row.
pub(super) fn ranges(v: MatRef<'_, f64>) -> Vec<[f64; 2]> {
    let widen = |[low, high]: [f64; 2], v: f64| [low.min(v), high.max(v)];
    (0..v.nrows())
        .map(|i| (0..v.ncols()).map(|j| v[(i, j)]).fold([f64::INFINITY, f64::NEG_INFINITY], widen))
        .collect()
}
