//! Eigenvalues and eigenvectors of the operator of one axis.
use super::super::PoissonAxis;
use monomorphic::{Mat, add_product, self_adjoint_eigenvectors};

/// Corrections of the eigenvectors by products of matrices: the largest angle that each may turn a
/// pair by. What remains is left to rotations; an angle spoils the orthogonality by its square.
const CORRECTIONS: [f64; 2] = [1e-5, 1e-8];
/// Most passes of rotations; two do unless eigenvalues are close to each other.
const PASSES: usize = 8;

/// The eigenvalues λ ≥ 0 of A = −W^{½} L W^{−½}, ascending, and its orthonormal eigenvectors, where L
/// is the operator of the axis and W holds the cell widths.
///
/// A = BᵀB with the gradient B of φ/√w through the faces, weighted with the roots of their
/// conductances. A decomposition of A is good to round-off of its largest eigenvalue only, which on a
/// finely stretched axis drowns the smallest. It is therefore corrected until the columns of BQ, which
/// hold their digits down to the smallest eigenvalue, are orthogonal: first all pairs at once (Ogita &
/// Aishima 2018), then by plane rotations where eigenvalues are close (Hestenes 1958).
pub(super) struct Eigen {
    pub(super) values: Vec<f64>,
    /// Each one contiguous.
    pub(super) vectors: Vec<Vec<f64>>,
}

impl Eigen {
    /// None if the decomposition does not converge.
    pub(super) fn new(axis: &PoissonAxis) -> Option<Self> {
        let n = axis.cells();
        let gradient = Gradient::new(axis);
        let mut vectors = self_adjoint_eigenvectors(gradient.normal(n).as_ref())?;
        if axis.is_free() {
            set_constant(&mut vectors, axis);
        }
        for largest in CORRECTIONS {
            correct(&mut vectors, &gradient, largest);
        }
        let mut vectors: Vec<Vec<f64>> = vectors.col_iter().map(|v| v.iter().copied().collect()).collect();
        let mut fluxes: Vec<Vec<f64>> = vectors.iter().map(|v| gradient.apply(|i| v[i]).collect()).collect();
        // The constant has no flux.
        let first = usize::from(axis.is_free());
        for _ in 0..PASSES {
            if !rotate(&mut vectors[first..], &mut fluxes[first..]) {
                break;
            }
        }
        let square = |v: &Vec<f64>| dot(v, v);
        let mut values: Vec<f64> = vectors
            .iter()
            .map(|v| gradient.apply(|i| v[i]).map(|y| y * y).sum::<f64>() / square(v))
            .collect();
        values[..first].fill(0.0);
        values.iter().all(|v| v.is_finite()).then_some(Self { values, vectors })
    }
}

/// Puts the exact constant in the first place and makes the other vectors orthogonal to it.
fn set_constant(vectors: &mut Mat<f64>, axis: &PoissonAxis) {
    let length = axis.length();
    let constant: Vec<f64> = axis.widths.iter().map(|w| (w / length).sqrt()).collect();
    for (j, column) in vectors.col_iter_mut().enumerate() {
        let along: f64 = column.as_ref().iter().zip(&constant).map(|(v, c)| v * c).sum();
        for (v, c) in column.iter_mut().zip(&constant) {
            *v = if j == 0 { *c } else { *v - along * c };
        }
    }
}

/// Turns all pairs of vectors by the angle that makes their fluxes orthogonal, if it is at most
/// `largest`, and the vectors themselves orthonormal.
fn correct(vectors: &mut Mat<f64>, gradient: &Gradient, largest: f64) {
    let n = vectors.ncols();
    let mut fluxes = Mat::zeros(gradient.0.len(), n);
    for j in 0..n {
        for (i, y) in gradient.apply(|i| vectors[(i, j)]).enumerate() {
            fluxes[(i, j)] = y;
        }
    }
    let (stiffness, mass) = (gram(&fluxes), gram(vectors));
    let values: Vec<f64> = (0..n).map(|i| stiffness[(i, i)] / mass[(i, i)]).collect();
    let correction = Mat::from_fn(n, n, |i, j| {
        let (low, high) = (i.min(j), i.max(j));
        let defect = f64::from(u8::from(i == j)) - mass[(low, high)];
        let (product, gap) = (stiffness[(low, high)], values[j] - values[i]);
        // Alike for (i, j) and (j, i).
        let bound = product.abs() + values[low].max(values[high]) * defect.abs();
        if i == j || bound > largest * gap.abs() {
            0.5 * defect
        } else {
            (product + values[j] * defect) / gap
        }
    });
    let old = vectors.clone();
    add_product(vectors.as_mut(), old.as_ref(), correction.as_ref());
}

/// Rotates each pair of vectors whose fluxes are not orthogonal to round-off; false if there is none.
fn rotate(vectors: &mut [Vec<f64>], fluxes: &mut [Vec<f64>]) -> bool {
    let tolerance = 4.0 * f64::EPSILON * (vectors.len() as f64).sqrt();
    let mut squares: Vec<f64> = fluxes.iter().map(|y| dot(y, y)).collect();
    let mut any = false;
    for j in 1..vectors.len() {
        for i in 0..j {
            let product = dot(&fluxes[i], &fluxes[j]);
            if product.abs() <= tolerance * squares[i].sqrt() * squares[j].sqrt() {
                continue;
            }
            any = true;
            let zeta = (squares[j] - squares[i]) / (2.0 * product);
            let tangent = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
            turn(vectors, i, j, tangent);
            turn(fluxes, i, j, tangent);
            squares[i] = dot(&fluxes[i], &fluxes[i]);
            squares[j] = dot(&fluxes[j], &fluxes[j]);
        }
    }
    any
}

/// Rotates lines i < j by an angle.
fn turn(lines: &mut [Vec<f64>], i: usize, j: usize, tangent: f64) {
    let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
    let sine = cosine * tangent;
    let (low, high) = lines.split_at_mut(j);
    for (a, b) in low[i].iter_mut().zip(&mut high[0]) {
        (*a, *b) = (cosine * *a - sine * *b, sine * *a + cosine * *b);
    }
}

/// Scalar product, in lanes.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let ((a, rest_a), (b, rest_b)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    let mut sums = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    sums.iter().sum::<f64>() + rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum::<f64>()
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

    /// B times the vector with entries `at(i)`.
    fn apply(&self, at: impl Fn(usize) -> f64) -> impl Iterator<Item = f64> {
        self.0.iter().map(move |&[(low, a), (high, b)]| a * at(low) + b * at(high))
    }
}

/// MᵀM.
fn gram(m: &Mat<f64>) -> Mat<f64> {
    let mut out = Mat::zeros(m.ncols(), m.ncols());
    add_product(out.as_mut(), m.transpose(), m.as_ref());
    out
}
