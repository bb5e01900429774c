//! What a reduced model is projected on.
use super::GalerkinError;
use crate::MatRef;

/// The fields y = ȳ + Φ η, with the inner product ⟨a, b⟩ = Σᵢ wᵢ aᵢ bᵢ, in which the modes Φ (n × r) are orthonormal.
#[derive(Clone, Copy, Debug)]
pub struct Basis<'a> {
    modes: MatRef<'a, f64>,
    mean: Option<&'a [f64]>,
    weights: Option<&'a [f64]>,
}

/// Products of modes may be off 0 and 1 by this much.
const ORTHONORMAL: f64 = 1e-8;

impl<'a> Basis<'a> {
    /// The modes as columns, ȳ (0 if there is none) and the weights, such as the volumes of cells (1 if there are none).
    ///
    /// # Errors
    /// [`GalerkinError::Shape`]; [`GalerkinError::NotOrthonormal`] names the two modes whose product is off by most.
    pub fn new(
        modes: MatRef<'a, f64>,
        mean: Option<&'a [f64]>,
        weights: Option<&'a [f64]>,
    ) -> Result<Self, GalerkinError> {
        for (what, given) in [("entries of the mean", mean), ("weights", weights)] {
            if let Some(found) = given.map(<[f64]>::len).filter(|found| *found != modes.nrows()) {
                return Err(GalerkinError::Shape { what, expected: modes.nrows(), found });
            }
        }
        let basis = Self { modes, mean, weights };
        let r = modes.ncols();
        let off = |i: usize, j: usize| {
            let product: f64 =
                (0..modes.nrows()).map(|row| basis.weight(row) * modes[(row, i)] * modes[(row, j)]).sum();
            (product - f64::from(u8::from(i == j))).abs()
        };
        for (i, j) in (0..r).flat_map(|i| (i..r).map(move |j| (i, j))) {
            let by = off(i, j);
            if by.is_nan() || by > ORTHONORMAL {
                return Err(GalerkinError::NotOrthonormal { modes: [i, j], by });
            }
        }
        Ok(basis)
    }
    /// Unknowns n of the full model.
    pub fn n(&self) -> usize {
        self.modes.nrows()
    }
    /// Modes r.
    pub fn rank(&self) -> usize {
        self.modes.ncols()
    }
    /// Entries of Φ.
    pub(super) fn mode(&self, row: usize, j: usize) -> f64 {
        self.modes[(row, j)]
    }
    /// Entries of ȳ.
    pub(super) fn mean(&self, row: usize) -> f64 {
        self.mean.map_or(0.0, |m| m[row])
    }
    pub(super) fn weight(&self, row: usize) -> f64 {
        self.weights.map_or(1.0, |w| w[row])
    }
    /// y = ȳ + Φ η into `out`.
    ///
    /// # Errors
    /// [`GalerkinError::Shape`].
    pub fn field(&self, coefficients: &[f64], out: &mut [f64]) -> Result<(), GalerkinError> {
        GalerkinError::same("coefficients", self.rank(), coefficients.len())?;
        GalerkinError::same("entries of the field", self.n(), out.len())?;
        for (row, y) in out.iter_mut().enumerate() {
            *y = self.mean(row);
        }
        for (j, a) in coefficients.iter().enumerate() {
            let column = self.modes.col(j);
            out.iter_mut().zip(column.iter()).for_each(|(y, mode)| *y += a * mode);
        }
        Ok(())
    }
    /// η = Φᵀ W (y − ȳ): the fields nearest to y.
    ///
    /// # Errors
    /// [`GalerkinError::Shape`].
    pub fn coefficients(&self, field: &[f64]) -> Result<Vec<f64>, GalerkinError> {
        GalerkinError::same("entries of the field", self.n(), field.len())?;
        let less: Vec<f64> = field.iter().enumerate().map(|(row, y)| y - self.mean(row)).collect();
        Ok(self.products(&less))
    }
    /// Φᵀ W f.
    pub(super) fn products(&self, f: &[f64]) -> Vec<f64> {
        let of = |j: usize| {
            self.modes.col(j).iter().zip(f).enumerate().map(|(row, (m, f))| self.weight(row) * m * f).sum()
        };
        (0..self.rank()).map(of).collect()
    }
    /// √⟨f, f⟩.
    pub(super) fn norm(&self, f: impl Fn(usize) -> f64) -> f64 {
        (0..self.n()).map(|row| self.weight(row) * f(row).powi(2)).sum::<f64>().sqrt()
    }
}
