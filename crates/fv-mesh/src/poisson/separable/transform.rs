//! What diagonalises one axis.
use super::super::{PoissonAxis, PoissonError};
use super::eigen::Eigen;
use super::fast::{FastScratch, FastTransform};
use super::gemm::{MR, Matrix, NR, Side, pack_columns, pack_rows, packed_len};
use pulp::Simd;

/// Rows that are multiplied together.
const ROWS: usize = 8 * MR;

/// A transform of real data along one axis, and back.
pub(super) enum Transform {
    /// Fourier, cosine or sine transform.
    Fast(FastTransform),
    /// Product with the matrix of eigenvectors.
    Dense(DenseTransform),
}

/// The products f̂ = Qᵀ W^½ f and φ = W^{−½} Q φ̂ with the eigenvectors Q of an axis and its cell
/// widths W (fast diagonalisation, Lynch, Rice & Thomas 1964).
pub(super) struct DenseTransform {
    n: usize,
    forward: Matrix,
    backward: Matrix,
}

/// Work space of transforms.
pub(super) struct TransformScratch {
    fast: FastScratch,
    packed: Vec<f64>,
}

impl TransformScratch {
    /// Room for the transforms of an x axis of rows and of other axes, of up to `columns` columns at a time.
    pub(super) fn new(x: Option<&Transform>, others: [(Option<&Transform>, usize); 2]) -> Self {
        let fast = x.into_iter().chain(others.iter().filter_map(|o| o.0)).filter_map(|t| match t {
            Transform::Fast(fast) => Some(fast),
            Transform::Dense(_) => None,
        });
        let rows = match x {
            Some(Transform::Dense(dense)) => packed_len(ROWS, dense.n, MR),
            _ => 0,
        };
        let columns = others.iter().map(|o| match o {
            (Some(Transform::Dense(dense)), columns) => packed_len(*columns, dense.n, NR),
            _ => 0,
        });
        Self { packed: vec![0.0; columns.fold(rows, usize::max)], fast: FastScratch::new(fast) }
    }
}

impl Transform {
    /// The transform of `axis`, minus the eigenvalues \[1/m²\] in the order of its modes, and what the
    /// mean of f is to be multiplied with to get the constant mode.
    pub(super) fn new(
        axis: &PoissonAxis,
        place: usize,
        side: Side,
    ) -> Result<(Self, Vec<f64>, f64), PoissonError> {
        let n = axis.cells();
        if axis.is_fast() {
            let fast = FastTransform::new(axis);
            let eigenvalues = fast.eigenvalues();
            return Ok((Self::Fast(fast), eigenvalues, n as f64));
        }
        let eigen = Eigen::new(axis).ok_or(PoissonError::Eigen { axis: place, cells: n })?;
        let root: Vec<f64> = axis.widths.iter().map(|w| w.sqrt()).collect();
        let forward = Matrix::new(n, side, |k, i| eigen.vectors[(i, k)] * root[i]);
        let backward = Matrix::new(n, side, |i, k| eigen.vectors[(i, k)] / root[i]);
        Ok((Self::Dense(DenseTransform { n, forward, backward }), eigen.values, axis.length().sqrt()))
    }

    /// Factor that forward and back multiply with.
    pub(super) fn gain(&self, cells: usize) -> f64 {
        if matches!(self, Self::Fast(_)) { cells as f64 } else { 1.0 }
    }

    /// Transforms `rows` rows, `ld` apart, in place.
    #[inline(always)]
    pub(super) fn rows<S: Simd>(
        &self,
        simd: S,
        data: &mut [f64],
        ld: usize,
        rows: usize,
        forward: bool,
        scratch: &mut TransformScratch,
    ) {
        match self {
            Self::Fast(fast) => fast.rows(data, ld, rows, forward, &mut scratch.fast),
            Self::Dense(dense) => {
                for first in (0..rows).step_by(ROWS) {
                    let (count, data) = (ROWS.min(rows - first), &mut data[first * ld..]);
                    let packed = &mut scratch.packed[..packed_len(count, dense.n, MR)];
                    pack_rows(data, ld, count, dense.n, packed);
                    dense.matrix(forward).multiply(simd, packed, count, data, ld);
                }
            }
        }
    }

    /// Transforms `columns` columns of `data`, whose rows are `ld` apart, in place.
    #[inline(always)]
    pub(super) fn columns<S: Simd>(
        &self,
        simd: S,
        data: &mut [f64],
        ld: usize,
        columns: usize,
        forward: bool,
        scratch: &mut TransformScratch,
    ) {
        match self {
            Self::Fast(fast) => fast.columns(data, ld, columns, forward, &mut scratch.fast),
            Self::Dense(dense) => {
                let packed = &mut scratch.packed[..packed_len(columns, dense.n, NR)];
                pack_columns(data, ld, columns, dense.n, packed);
                dense.matrix(forward).multiply(simd, packed, columns, data, ld);
            }
        }
    }

    /// Transforms `columns` columns from one place to another.
    #[inline(always)]
    pub(super) fn columns_to<S: Simd>(
        &self,
        simd: S,
        (from, from_ld): (&[f64], usize),
        (to, to_ld): (&mut [f64], usize),
        columns: usize,
        forward: bool,
        scratch: &mut TransformScratch,
    ) {
        match self {
            Self::Fast(fast) => {
                fast.columns_to((from, from_ld), (to, to_ld), columns, forward, &mut scratch.fast);
            }
            Self::Dense(dense) => {
                let packed = &mut scratch.packed[..packed_len(columns, dense.n, NR)];
                pack_columns(from, from_ld, columns, dense.n, packed);
                dense.matrix(forward).multiply(simd, packed, columns, to, to_ld);
            }
        }
    }
}

impl DenseTransform {
    #[inline(always)]
    fn matrix(&self, forward: bool) -> &Matrix {
        if forward { &self.forward } else { &self.backward }
    }
}
