//! The diagonal as a preconditioner.
use super::error::check_length;
use super::{LinearError, Preconditioner, vector};

/// z_P = r_P / a_P.
#[derive(Clone, Debug, PartialEq)]
pub struct Jacobi {
    inverse: Vec<f64>,
}

impl Jacobi {
    /// From the diagonal of a matrix.
    ///
    /// # Errors
    /// [`LinearError::ZeroPivot`] for an entry that cannot be divided by.
    pub fn new(diagonal: &[f64]) -> Result<Self, LinearError> {
        let mut jacobi = Self { inverse: vec![0.0; diagonal.len()] };
        jacobi.update(diagonal)?;
        Ok(jacobi)
    }

    /// Takes new values of the diagonal.
    ///
    /// # Errors
    /// As [`new`](Self::new), and [`LinearError::Shape`]. Nothing is changed then.
    pub fn update(&mut self, diagonal: &[f64]) -> Result<(), LinearError> {
        check_length("the diagonal", self.inverse.len(), diagonal.len())?;
        let bad = |value: &f64| !(value.is_finite() && value.recip().is_finite());
        if let Some(row) = diagonal.iter().position(bad) {
            return Err(LinearError::ZeroPivot { row, value: diagonal[row] });
        }
        for (inverse, value) in self.inverse.iter_mut().zip(diagonal) {
            *inverse = value.recip();
        }
        Ok(())
    }
}

impl Preconditioner for Jacobi {
    fn n(&self) -> usize {
        self.inverse.len()
    }
    fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        vector::multiply(&self.inverse, r, z);
    }
}
