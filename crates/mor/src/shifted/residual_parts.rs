//! Parts of a residual in a frame of reference.
use super::Frame;
use super::dense::product;
use monomorphic::Mat;

/// Parts of a residual R in a frame with the field Φ Σ A.
pub(super) struct Parts {
    /// Largest mode of the normal part (1 − Φ Φᵀ) R (1 − Aᵀ A).
    pub(super) mode: Frame,
    /// Bound of the norm of a matrix of independent entries like those of the normal part without
    /// the mode: the largest norm of a row, plus that of a column, plus √(ln N) times the largest
    /// entry (Bandeira & van Handel 2016).
    pub(super) noise: f64,
}

impl Parts {
    pub(super) fn new(mut field: Mat<f64>, frame: &Frame) -> Self {
        let (phi, a) = (frame.modes.as_ref(), frame.coefficients.as_ref());
        if frame.rank() > 0 {
            field -= product(phi, product(phi.transpose(), field.as_ref()).as_ref());
            field -= product(product(field.as_ref(), a.transpose()).as_ref(), a);
        }
        let mode = Frame::leading(field.as_ref(), 1);
        let Some(sigma) = mode.singular_values.first() else { return Self { mode, noise: 0.0 } };
        let rest = |square: f64, part: f64| (square - (sigma * part).powi(2)).max(0.0);
        let columns = field.col_iter().zip(mode.coefficients.row(0).iter());
        let column = columns.map(|(c, a)| rest(c.squared_norm_l2(), *a)).fold(0.0, f64::max);
        let mut rows = vec![0.0; field.nrows()];
        for c in field.col_iter() {
            rows.iter_mut().zip(c.iter()).for_each(|(row, x)| *row += x * x);
        }
        let rows = rows.into_iter().zip(mode.modes.col(0).iter());
        let row = rows.map(|(square, phi)| rest(square, *phi)).fold(0.0, f64::max);
        let few = field.nrows().min(field.ncols()) as f64;
        let noise = row.sqrt() + column.sqrt() + few.ln().sqrt() * field.norm_max();
        Self { noise, mode }
    }
}
