//! Eigenvalues and eigenvectors of the operator of one axis.
use super::super::PoissonAxis;
use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{self, ComputeEigenvectors};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};

/// Corrections of the eigenvectors; each squares their error.
const REFINEMENTS: usize = 2;

/// The eigenvalues λ ≥ 0 of A = −W^{½} L W^{−½}, ascending, and its orthonormal eigenvectors as the
/// columns of Q, where L is the operator of the axis and W holds the cell widths.
///
/// A = BᵀB with the gradient B of φ/√w through the faces, weighted with the roots of their
/// conductances. A decomposition of A is good to round-off of its largest eigenvalue only, which on a
/// finely stretched axis drowns the smallest. It is therefore corrected by the products of the columns
/// of BQ, which hold their digits down to the smallest eigenvalue (the iteration of Ogita & Aishima
/// 2018 for the singular values of B).
pub(super) struct Eigen {
    pub(super) values: Vec<f64>,
    pub(super) vectors: Mat<f64>,
}

impl Eigen {
    /// None if the decomposition does not converge.
    pub(super) fn new(axis: &PoissonAxis) -> Option<Self> {
        let n = axis.cells();
        let gradient = Gradient::new(axis);
        let mut vectors = decompose(&gradient.normal(n))?;
        let mut values = vec![0.0; n];
        for _ in 0..REFINEMENTS {
            let flux = gradient.apply(&vectors);
            let (stiffness, mass) = (gram(&flux), gram(&vectors));
            for i in 0..n {
                values[i] = stiffness[(i, i)] / mass[(i, i)];
            }
            let correction = Mat::from_fn(n, n, |i, j| {
                let defect = f64::from(u8::from(i == j)) - mass[(i, j)];
                let (turn, gap) = (stiffness[(i, j)] + values[j] * defect, values[j] - values[i]);
                // Equal eigenvalues: any orthonormal basis will do.
                if i == j || turn.abs() > 1e-3 * gap.abs() { 0.5 * defect } else { turn / gap }
            });
            let old = vectors.clone();
            matmul(vectors.as_mut(), Accum::Add, old.as_ref(), correction.as_ref(), 1.0, Par::Seq);
        }
        let flux = gradient.apply(&vectors);
        for j in 0..n {
            values[j] = flux.col(j).squared_norm_l2() / vectors.col(j).squared_norm_l2();
        }
        if axis.is_free() {
            // The constant, which has no flux.
            values[0] = 0.0;
            let length = axis.length();
            for i in 0..n {
                vectors[(i, 0)] = (axis.widths[i] / length).sqrt();
            }
        }
        (values.iter().all(|v| v.is_finite())).then_some(Self { values, vectors })
    }
}

/// B: of each face that something flows through, the cells on both sides with their factors; at an end
/// the one cell twice, the second time with zero.
struct Gradient(Vec<[(usize, f64); 2]>);

impl Gradient {
    fn new(axis: &PoissonAxis) -> Self {
        let (n, conductances) = (axis.cells(), axis.conductances());
        let cyclic = axis.ends == super::super::AxisBounds::Periodic;
        let part = |cell: usize, g: f64| (g / axis.widths[cell]).sqrt();
        let faces = conductances.iter().enumerate().filter(|&(i, &g)| g > 0.0 && !(cyclic && i == n));
        Self(
            faces
                .map(|(i, &g)| match i {
                    0 if cyclic => [(n - 1, -part(n - 1, g)), (0, part(0, g))],
                    0 => [(0, part(0, g)), (0, 0.0)],
                    _ if i == n => [(n - 1, -part(n - 1, g)), (n - 1, 0.0)],
                    _ => [(i - 1, -part(i - 1, g)), (i, part(i, g))],
                })
                .collect(),
        )
    }

    /// BᵀB.
    fn normal(&self, n: usize) -> Mat<f64> {
        let mut a = Mat::zeros(n, n);
        for face in &self.0 {
            for (i, p) in face {
                for (j, q) in face {
                    a[(*i, *j)] += p * q;
                }
            }
        }
        a
    }

    /// BQ.
    fn apply(&self, q: &Mat<f64>) -> Mat<f64> {
        Mat::from_fn(self.0.len(), q.ncols(), |face, j| {
            let [(low, a), (high, b)] = self.0[face];
            a * q[(low, j)] + b * q[(high, j)]
        })
    }
}

/// MᵀM.
fn gram(m: &Mat<f64>) -> Mat<f64> {
    let mut out = Mat::zeros(m.ncols(), m.ncols());
    matmul(out.as_mut(), Accum::Replace, m.transpose(), m.as_ref(), 1.0, Par::Seq);
    out
}

/// Orthonormal eigenvectors in the order of ascending eigenvalues. On the calling thread alone, so
/// that they do not depend on the number of threads.
fn decompose(a: &Mat<f64>) -> Option<Mat<f64>> {
    let n = a.nrows();
    let (mut values, mut vectors) = (Diag::zeros(n), Mat::zeros(n, n));
    let need =
        evd::self_adjoint_evd_scratch::<f64>(n, ComputeEigenvectors::Yes, Par::Seq, Default::default());
    evd::self_adjoint_evd(
        a.as_ref(),
        values.as_mut(),
        Some(vectors.as_mut()),
        Par::Seq,
        MemStack::new(&mut MemBuffer::new(need)),
        Default::default(),
    )
    .ok()?;
    Some(vectors)
}
