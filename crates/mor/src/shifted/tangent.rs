//! Directions in which fields of a given rank can change.
use super::Frame;
use super::dense::{columns, inner, orthonormalise, product, thin};
use monomorphic::{Mat, MatRef, add_product};

/// A frame's field Φ Σ A, ready to be moved.
pub(super) struct Base<'a> {
    frame: &'a Frame,
    /// Aᵀ.
    v: Mat<f64>,
}

/// ξ = Φ M A + U A + Φ Vᵀ with Φᵀ U = 0 and A V = 0: a direction tangent to the fields of this rank (Vandereycken 2013, equation (2.4)).
/// The norms of its three parts are its own.
#[derive(Clone)]
pub(super) struct Tangent {
    m: Mat<f64>,
    u: Mat<f64>,
    v: Mat<f64>,
}

impl<'a> Base<'a> {
    pub(super) fn new(frame: &'a Frame) -> Self {
        Self { v: frame.coefficients.transpose().to_owned(), frame }
    }

    /// What of a field is tangent.
    pub(super) fn project(&self, field: MatRef<'_, f64>) -> Tangent {
        let phi = self.frame.modes.as_ref();
        let mut u = product(field, self.v.as_ref());
        let mut v = product(field.transpose(), phi);
        let m = product(phi.transpose(), u.as_ref());
        u -= product(phi, m.as_ref());
        v -= product(self.v.as_ref(), m.transpose());
        Tangent { m, u, v }
    }

    /// `to` += ξ.
    pub(super) fn add_to(&self, direction: &Tangent, to: &mut Mat<f64>) {
        let phi = &self.frame.modes;
        let mut left = product(phi.as_ref(), direction.m.as_ref());
        left += &direction.u;
        add_product(to.as_mut(), left.as_ref(), self.frame.coefficients.as_ref());
        add_product(to.as_mut(), phi.as_ref(), direction.v.transpose());
    }

    /// The field of this rank that is nearest to Φ Σ A + ξ.
    pub(super) fn moved(&self, direction: &Tangent) -> Frame {
        let (phi, r) = (&self.frame.modes, self.frame.rank());
        let (mut u, mut v) = (direction.u.clone(), direction.v.clone());
        let (r_u, r_v) = (orthonormalise(&mut u), orthonormalise(&mut v));
        // Φ Σ A + ξ = (Φ U) core (Aᵀ V)ᵀ.
        let core = Mat::from_fn(2 * r, 2 * r, |i, j| match (i < r, j < r) {
            (true, true) => direction.m[(i, j)] + if i == j { self.frame.singular_values[i] } else { 0.0 },
            (true, false) => r_v[(i, j - r)],
            (false, true) => r_u[(i - r, j)],
            (false, false) => 0.0,
        });
        let (left, singular_values, right) = thin(core, r);
        let modes = joined(phi, &u, &left);
        let coefficients = joined(&self.v, &v, &right).transpose().to_owned();
        Frame { modes, singular_values, coefficients }
    }
}

/// (A B) C.
fn joined(a: &Mat<f64>, b: &Mat<f64>, c: &Mat<f64>) -> Mat<f64> {
    let r = a.ncols();
    let mut all = product(a.as_ref(), c.subrows(0, r));
    add_product(all.as_mut(), b.as_ref(), c.subrows(r, c.nrows() - r));
    all
}

impl Tangent {
    pub(super) fn dot(&self, other: &Self) -> f64 {
        let part = |a: &Mat<f64>, b: &Mat<f64>| inner(a.as_ref(), b.as_ref());
        part(&self.m, &other.m) + part(&self.u, &other.u) + part(&self.v, &other.v)
    }

    /// `self` ← `keep` self + `factor` other.
    pub(super) fn combine(&mut self, keep: f64, factor: f64, other: &Self) {
        for (to, from) in [(&mut self.m, &other.m), (&mut self.u, &other.u), (&mut self.v, &other.v)] {
            for (to, from) in columns(to).into_iter().zip(from.col_iter()) {
                to.iter_mut().zip(from.iter()).for_each(|(to, from)| *to = keep * *to + factor * from);
            }
        }
    }
}
