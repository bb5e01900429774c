//! Terms of which a few rows are enough.
use super::{Basis, GalerkinError, Ode};
use crate::{Mat, MatRef};
use monomorphic::inverse;

/// The discrete empirical interpolation method (Chaturantabut and Sorensen, SIAM J. Sci. Comput. 32 (2010) 2737): f ≈ U (PᵀU)⁻¹ Pᵀ f from `rows` P, one for each mode U of f, chosen one after
/// the other where what the modes before leave of the next is largest.
#[derive(Clone, Debug)]
pub struct Deim {
    rows: Vec<usize>,
    /// Φᵀ W U (PᵀU)⁻¹, r × k.
    projector: Mat<f64>,
    amplification: f64,
}

/// A term of which single rows can be asked for.
pub trait SampledTerm: Send + Sync {
    /// The rows of y that row `row` of f depends on.
    fn support(&self, row: usize) -> Vec<usize>;
    /// fᵢ(t, y) for i = `row` of the `values` of y in its support.
    fn at(&self, t: f64, row: usize, values: &[f64]) -> f64;
}

/// What is left of a mode in its best row, for it to be a mode of its own.
const INDEPENDENT: f64 = 1e-13;

impl Deim {
    /// Of the modes U (n × k) of snapshots of f.
    ///
    /// # Errors
    /// [`GalerkinError::Shape`], [`GalerkinError::Dependent`].
    pub fn new(basis: &Basis<'_>, modes: MatRef<'_, f64>) -> Result<Self, GalerkinError> {
        GalerkinError::same("rows of the term's modes", basis.n(), modes.nrows())?;
        let (n, k) = modes.shape();
        let mut rows: Vec<usize> = Vec::with_capacity(k);
        // What is left of the modes after elimination by the rows before.
        let mut left: Vec<Vec<f64>> = Vec::with_capacity(k);
        for l in 0..k {
            let mut mode: Vec<f64> = (0..n).map(|i| modes[(i, l)]).collect();
            let size = mode.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
            for (pivot, before) in rows.iter().zip(&left) {
                let share = mode[*pivot] / before[*pivot];
                mode.iter_mut().zip(before).for_each(|(m, b)| *m -= share * b);
            }
            let (row, most) =
                mode.iter().enumerate().fold(
                    (0, 0.0),
                    |best: (usize, f64), (i, v)| if v.abs() > best.1 { (i, v.abs()) } else { best },
                );
            if most.is_nan() || most <= INDEPENDENT * size {
                return Err(GalerkinError::Dependent { mode: l, left: most / size });
            }
            rows.push(row);
            left.push(mode);
        }
        let sampled = Mat::from_fn(k, k, |i, j| modes[(rows[i], j)]);
        let by_samples = inverse(sampled.as_ref());
        let products: Vec<Vec<f64>> =
            (0..k).map(|j| basis.products(&(0..n).map(|i| modes[(i, j)]).collect::<Vec<_>>())).collect();
        let entry = |i: usize, j: usize| (0..k).map(|l| products[l][i] * by_samples[(l, j)]).sum();
        let projector = Mat::from_fn(basis.rank(), k, entry);
        let amplification = (0..k)
            .flat_map(|i| (0..k).map(move |j| (i, j)))
            .map(|p| by_samples[p].powi(2))
            .sum::<f64>()
            .sqrt();
        Ok(Self { rows, projector, amplification })
    }
    /// The rows that are asked for.
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }
    /// The Frobenius norm of (PᵀU)⁻¹: for orthonormal U the error is at most this times that of the best approximation of f by its modes.
    pub fn amplification(&self) -> f64 {
        self.amplification
    }
}

/// η′ = `rest` + Φᵀ W f(t, ȳ + Φη), the second by [`Deim`].
pub struct HyperReduced<R, F> {
    rest: R,
    term: F,
    deim: Deim,
    /// For each row its support, as rows of `modes`.
    supports: Vec<std::ops::Range<usize>>,
    /// ȳ and Φ in the rows of all supports.
    mean: Vec<f64>,
    modes: Mat<f64>,
}

impl<R: Ode, F: SampledTerm> HyperReduced<R, F> {
    /// The model `rest` (a [`QuadraticModel`](super::QuadraticModel), say) with a `term` more.
    ///
    /// # Errors
    /// [`GalerkinError::Shape`], also for a support outside of the full model.
    pub fn new(basis: &Basis<'_>, rest: R, term: F, deim: Deim) -> Result<Self, GalerkinError> {
        GalerkinError::same("unknowns of the rest", basis.rank(), rest.n())?;
        let (mut supports, mut needed) = (Vec::new(), Vec::new());
        for row in &deim.rows {
            let start = needed.len();
            needed.extend(term.support(*row));
            supports.push(start..needed.len());
        }
        if let Some(beyond) = needed.iter().find(|row| **row >= basis.n()) {
            return Err(GalerkinError::Shape {
                what: "rows of a support",
                expected: basis.n(),
                found: *beyond,
            });
        }
        let mean = needed.iter().map(|row| basis.mean(*row)).collect();
        let modes = Mat::from_fn(needed.len(), basis.rank(), |i, j| basis.mode(needed[i], j));
        Ok(Self { rest, term, deim, supports, mean, modes })
    }
}

impl<R: Ode, F: SampledTerm> Ode for HyperReduced<R, F> {
    fn n(&self) -> usize {
        self.rest.n()
    }
    fn rate(&self, t: f64, y: &[f64], out: &mut [f64]) {
        self.rest.rate(t, y, out);
        let mut values = self.mean.clone();
        for (j, a) in y.iter().enumerate() {
            values.iter_mut().zip(self.modes.col_as_slice(j)).for_each(|(v, mode)| *v += a * mode);
        }
        for (k, (row, support)) in self.deim.rows.iter().zip(&self.supports).enumerate() {
            let f = self.term.at(t, *row, &values[support.clone()]);
            out.iter_mut().zip(self.deim.projector.col_as_slice(k)).for_each(|(out, p)| *out += p * f);
        }
    }
}
