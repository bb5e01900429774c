//! Modes and their coefficients.
use super::blocks::{Blocks, Data};
use super::combination::combine;
use super::factors::{Factors, factors, needs_gram};
use super::{PodError, PodParams};
use crate::snapshots::SnapshotSource;
use crate::{Mat, MatRef};

/// X ≈ x̄ + Φ Σ A: the r modes Φ (n × r) that are nearest to all m snapshots X (n × m), for any r (Eckart and Young, Psychometrika 1 (1936) 211),
///
/// ‖X − x̄ − Φ Σ A‖² = Σ_{k > r} σ_k², ‖X‖² = Σ_j ⟨x_j, x_j⟩, ⟨a, b⟩ = Σᵢ wᵢ aᵢ bᵢ.
#[derive(Clone, Debug)]
pub struct Pod {
    /// x̄, if it was taken away.
    pub mean: Option<Vec<f64>>,
    /// Φ, orthonormal in the inner product.
    pub modes: Mat<f64>,
    /// σ in descending order: those of the modes, and more if they are known; by the method of snapshots those of at least
    /// 1e-5 σ₁.
    pub singular_values: Vec<f64>,
    /// A, r × m, orthonormal rows.
    pub coefficients: Mat<f64>,
    /// w, if they are not all 1.
    pub weights: Option<Vec<f64>>,
    /// Σσ² over all there are.
    pub energy: f64,
}

/// What is less than so many units in the last place of the snapshots' norm is round-off.
pub(super) const ROUND_OFF: f64 = 8.0 * f64::EPSILON;

impl Pod {
    /// Of snapshots (n × m).
    ///
    /// # Errors
    /// [`PodError`].
    pub fn new(snapshots: MatRef<'_, f64>, params: &PodParams) -> Result<Self, PodError> {
        Self::of_data(Data::Memory(snapshots), params)
    }

    /// Of snapshots that need not be in memory, in two passes over blocks of rows by the method of snapshots: it holds a block of 64 MB, m × m numbers and twice the
    /// modes. With [`SvdMethod::Auto`](super::SvdMethod::Auto), too, modes with σ_k < 1e-5 σ₁ are left out then. [`SvdMethod::Qr`](super::SvdMethod::Qr) keeps
    /// them, also in two passes; more snapshots than rows are taken into memory whole.
    ///
    /// # Errors
    /// [`PodError`]; [`PodError::Source`] if snapshots cannot be read.
    pub fn of(source: &dyn SnapshotSource, params: &PodParams) -> Result<Self, PodError> {
        Self::of_data(Data::Source(source), params)
    }

    fn of_data(data: Data<'_>, params: &PodParams) -> Result<Self, PodError> {
        let (n, m) = (data.rows(), data.snapshots());
        if n == 0 || m == 0 {
            return Err(PodError::Empty { rows: n, snapshots: m });
        }
        params.check(n)?;
        let gram = needs_gram(&data, params);
        let y = Blocks::new(data, params.subtract_mean, params.weights.as_deref(), gram)?;
        y.check_size()?;
        let floor = ROUND_OFF * (n.min(m) as f64).sqrt() * f64::sqrt(y.squares);
        let Factors { modes, values, coefficients, energy } = factors(&y, params, floor)?;
        // Nothing but round-off is nothing.
        let energy = if values.first().is_some_and(|s| *s > floor) { energy } else { 0.0 };
        let weights = params.weights.clone();
        Ok(Self { mean: y.mean, modes, singular_values: values, coefficients, weights, energy })
    }

    /// r.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.modes.ncols()
    }
    /// n.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.modes.nrows()
    }
    /// The same with fewer modes.
    #[must_use]
    pub fn truncated(&self, rank: usize) -> Self {
        let r = rank.min(self.rank());
        let modes = self.modes.subcols(0, r).to_owned();
        Self { modes, coefficients: self.coefficients.subrows(0, r).to_owned(), ..self.clone() }
    }
    /// ‖X − x̄ − Φ Σ A‖/‖X − x̄‖ with the first `rank` modes, from the singular values.
    #[must_use]
    pub fn relative_error(&self, rank: usize) -> f64 {
        if self.energy == 0.0 {
            return 0.0;
        }
        let known = &self.singular_values;
        let kept: f64 = known[..rank.min(known.len())].iter().map(|s| s * s).sum();
        // What is known to be left has no cancellation.
        let left: f64 = known[rank.min(known.len())..].iter().map(|s| s * s).sum();
        let unknown = (self.energy - kept - left).max(0.0);
        let unknown = if unknown < 1e-12 * self.energy { 0.0 } else { unknown };
        ((left + unknown) / self.energy).sqrt()
    }
    /// σ_i a_i(t_j), r × m: what interpolation is asked for.
    #[must_use]
    pub fn scaled_coefficients(&self) -> Mat<f64> {
        let a = &self.coefficients;
        Mat::from_fn(a.nrows(), a.ncols(), |i, j| self.singular_values[i] * a[(i, j)])
    }
    /// ΦᵀW(x − x̄): coefficients of the nearest field.
    ///
    /// # Errors
    /// [`PodError::Shape`].
    pub fn project(&self, field: &[f64]) -> Result<Vec<f64>, PodError> {
        PodError::same("rows of the field", self.rows(), field.len())?;
        let weighted: Vec<f64> = field
            .iter()
            .enumerate()
            .map(|(i, x)| {
                let w = self.weights.as_ref().map_or(1.0, |w| w[i]);
                w * (x - self.mean.as_ref().map_or(0.0, |mean| mean[i]))
            })
            .collect();
        let product = |k: usize| self.modes.col_as_slice(k).iter().zip(&weighted).map(|(m, y)| m * y).sum();
        Ok((0..self.rank()).map(product).collect())
    }
    /// x̄ + Φ c into `out`, for as many coefficients as there are modes.
    ///
    /// # Errors
    /// [`PodError::Shape`].
    pub fn reconstruct(&self, coefficients: &[f64], out: &mut [f64]) -> Result<(), PodError> {
        PodError::same("coefficients", self.rank(), coefficients.len())?;
        PodError::same("rows of the field", self.rows(), out.len())?;
        let c = MatRef::from_column_major_slice(coefficients, coefficients.len(), 1);
        self.reconstruct_all(c, out)
    }
    /// x̄ + Φ c_j for coefficients as columns, into fields one after the other: the modes are read once for all of them, and a field is the same bit for bit as by
    /// [`reconstruct`](Self::reconstruct).
    ///
    /// # Errors
    /// [`PodError::Shape`].
    pub fn reconstruct_all(&self, coefficients: MatRef<'_, f64>, fields: &mut [f64]) -> Result<(), PodError> {
        PodError::same("coefficients", self.rank(), coefficients.nrows())?;
        PodError::same("rows of all fields", self.rows() * coefficients.ncols(), fields.len())?;
        let modes: Vec<&[f64]> = (0..self.rank()).map(|k| self.modes.col_as_slice(k)).collect();
        combine(&modes, self.mean.as_deref(), coefficients, fields);
        Ok(())
    }
    /// ‖X − P X‖/‖X‖ of snapshots, seen or not, P the projection on the modes (and the mean).
    ///
    /// # Errors
    /// [`PodError::Shape`].
    pub fn relative_projection_error(&self, snapshots: MatRef<'_, f64>) -> Result<f64, PodError> {
        PodError::same("rows of the snapshots", self.rows(), snapshots.nrows())?;
        let (mut off, mut whole) = (0.0, 0.0);
        let mut nearest = vec![0.0; self.rows()];
        for j in 0..snapshots.ncols() {
            let field: Vec<f64> = snapshots.col(j).iter().copied().collect();
            self.reconstruct(&self.project(&field)?, &mut nearest)?;
            for (i, (x, p)) in field.iter().zip(&nearest).enumerate() {
                let w = self.weights.as_ref().map_or(1.0, |w| w[i]);
                off += w * (x - p) * (x - p);
                whole += w * x * x;
            }
        }
        Ok(if off == 0.0 { 0.0 } else { (off / whole).sqrt() })
    }
}
