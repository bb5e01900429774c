//! Singular value decompositions of weighted, centred snapshots.
use super::blocks::{Blocks, Data};
use super::{PodError, PodParams, Rank, SvdMethod};
use crate::{Mat, MatRef};
use monomorphic::{add_gram, add_product, self_adjoint_eigen, thin_svd};
use rand::{RngExt, SeedableRng};

/// Modes (in rows of weight 0, too), singular values that are known, coefficients (r × m), Σσ².
pub(super) struct Factors {
    pub(super) modes: Mat<f64>,
    pub(super) values: Vec<f64>,
    pub(super) coefficients: Mat<f64>,
    pub(super) energy: f64,
}

/// Singular values below this share of σ₁ are rounding errors of the method of snapshots: those of σ², ε σ₁², are 2e-6
/// of σ² there.
const GRAM: f64 = 1e-5;

/// `floor` is what round-off leaves in singular values.
pub(super) fn factors(y: &Blocks<'_>, params: &PodParams, floor: f64) -> Result<Factors, PodError> {
    let all_in_memory = matches!(y.data, Data::Memory(_));
    match (params.method, &y.gram) {
        (SvdMethod::Randomised { oversampling, power_iterations, seed }, _) => {
            randomised(y, params, floor, oversampling, power_iterations, seed)
        }
        (_, None) => by_qr(y, params, floor),
        (SvdMethod::Auto, Some(gram)) if all_in_memory => match by_gram(y, gram, params, floor)? {
            (factors, true) => Ok(factors),
            _ => by_qr(y, params, floor),
        },
        (_, Some(gram)) => Ok(by_gram(y, gram, params, floor)?.0),
    }
}

/// Are the products of all pairs of snapshots needed?
pub(super) fn needs_gram(data: &Data<'_>, params: &PodParams) -> bool {
    let (n, m) = (data.rows(), data.snapshots());
    // They would be the larger matrix.
    if n < m {
        return false;
    }
    match params.method {
        SvdMethod::Snapshots => true,
        // All there are: small ones, too, if there is the memory.
        SvdMethod::Auto => {
            !(matches!(data, Data::Memory(_)) && params.limit(m) == m && params.rank == Rank::All)
        }
        SvdMethod::Qr | SvdMethod::Randomised { .. } => false,
    }
}

/// Right singular vectors of R of Y = Q R, then modes as by the method of snapshots; more snapshots than rows are
/// decomposed whole.
fn by_qr(y: &Blocks<'_>, params: &PodParams, floor: f64) -> Result<Factors, PodError> {
    if y.data.rows() < y.data.snapshots() {
        return whole(y, params, floor);
    }
    let triangular = y.triangular()?;
    let (_, values, v) = thin_svd(triangular.factor()).ok_or_else(|| y.not_converged())?;
    let energy = values.iter().map(|s| s * s).sum();
    let r = params.kept(&values, energy, floor);
    let vectors = v.subcols(0, r).to_owned();
    match orthonormal_modes(y, values, &vectors)? {
        Some((modes, values, coefficients)) => Ok(Factors { modes, values, coefficients, energy }),
        None => whole(y, params, floor),
    }
}

fn whole(y: &Blocks<'_>, params: &PodParams, floor: f64) -> Result<Factors, PodError> {
    let svd = match (&y.data, &y.mean, y.weights) {
        (Data::Memory(snapshots), None, None) => thin_svd(*snapshots),
        _ => thin_svd(y.whole()?.as_ref()),
    };
    let (u, values, v) = svd.ok_or_else(|| y.not_converged())?;
    let energy = values.iter().map(|s| s * s).sum();
    let r = params.kept(&values, energy, floor);
    let coefficients = v.subcols(0, r).transpose().to_owned();
    let modes = match y.weights {
        None if r == u.ncols() => u,
        None => u.subcols(0, r).to_owned(),
        Some(weights) => unweighted(y, weights, u.subcols(0, r), v.as_ref(), &values)?,
    };
    Ok(Factors { modes, values, coefficients, energy })
}

/// Modes, singular values (the first of those given, corrected) and coefficients.
type Orthonormal = (Mat<f64>, Vec<f64>, Mat<f64>);

/// Y V Σ⁻¹ with right singular vectors V, made orthonormal by one pass of Cholesky QR, which corrects singular values,
/// too. None if the products of the modes are not positive definite.
fn orthonormal_modes(
    y: &Blocks<'_>,
    mut values: Vec<f64>,
    vectors: &Mat<f64>,
) -> Result<Option<Orthonormal>, PodError> {
    let (m, r) = vectors.shape();
    let scaled = Mat::from_fn(m, r, |j, k| vectors[(j, k)] / values[k]);
    let modes = y.times(false, scaled.as_ref())?;
    // S = Lᵀ Σ Vᵀ with L of the modes' products: modes L⁻ᵀ are orthonormal, and so are the factors of S.
    let Some((inverse, lower)) = cholesky(products(modes.as_ref(), y.weights).as_ref()) else {
        return Ok(None);
    };
    let right = Mat::from_fn(r, m, |k, j| values[k] * vectors[(j, k)]);
    let mut s = Mat::zeros(r, m);
    add_product(s.as_mut(), lower.as_ref().transpose(), right.as_ref());
    let (u, exact, v) = thin_svd(s.as_ref()).ok_or_else(|| y.not_converged())?;
    let turn = inverse.transpose() * u;
    let mut turned = Mat::zeros(modes.nrows(), r);
    add_product(turned.as_mut(), modes.as_ref(), turn.as_ref());
    values[..r].copy_from_slice(&exact[..r]);
    let coefficients = v.subcols(0, r).transpose().to_owned();
    Ok(Some((turned, values, coefficients)))
}

/// W^−½ U; where the weight is 0, the values that the snapshots' combination has.
fn unweighted(
    y: &Blocks<'_>,
    weights: &[f64],
    u: MatRef<'_, f64>,
    v: MatRef<'_, f64>,
    values: &[f64],
) -> Result<Mat<f64>, PodError> {
    let scaled = Mat::from_fn(v.nrows(), u.ncols(), |j, k| v[(j, k)] / values[k]);
    let bare = weights.contains(&0.0).then(|| y.times(false, scaled.as_ref())).transpose()?;
    Ok(Mat::from_fn(u.nrows(), u.ncols(), |i, k| match (weights[i], &bare) {
        (0.0, Some(bare)) => bare[(i, k)],
        (w, _) => u[(i, k)] / w.sqrt(),
    }))
}

/// And whether all modes that were asked for are there.
fn by_gram(
    y: &Blocks<'_>,
    gram: &Mat<f64>,
    params: &PodParams,
    floor: f64,
) -> Result<(Factors, bool), PodError> {
    let (ascending, vectors) = self_adjoint_eigen(gram.as_ref()).ok_or_else(|| y.not_converged())?;
    let m = ascending.len();
    let mut values: Vec<f64> = ascending.iter().rev().map(|v| v.max(0.0).sqrt()).collect();
    let energy = values.iter().map(|s| s * s).sum();
    let sound = values.iter().take_while(|s| **s >= GRAM * values[0] && **s > floor).count();
    let wanted = params.kept(&values, energy, floor);
    let r = wanted.min(sound);
    // Squares have lost smaller ones.
    values.truncate(sound);
    let vectors = Mat::from_fn(m, r, |j, k| vectors[(j, m - 1 - k)]);
    let (modes, values, coefficients) =
        orthonormal_modes(y, values, &vectors)?.ok_or_else(|| y.not_converged())?;
    Ok((Factors { modes, values, coefficients, energy }, r == wanted))
}

/// ΦᵀWΦ, the lower triangle.
fn products(modes: MatRef<'_, f64>, weights: Option<&[f64]>) -> Mat<f64> {
    let mut gram = Mat::zeros(modes.ncols(), modes.ncols());
    match weights {
        None => add_gram(gram.as_mut(), modes),
        Some(w) => {
            let root = Mat::from_fn(modes.nrows(), modes.ncols(), |i, k| w[i].sqrt() * modes[(i, k)]);
            add_gram(gram.as_mut(), root.as_ref());
        }
    }
    gram
}

/// L⁻¹ and L of A = L Lᵀ, of which the lower triangle is read.
fn cholesky(a: MatRef<'_, f64>) -> Option<(Mat<f64>, Mat<f64>)> {
    let n = a.nrows();
    let mut lower = Mat::zeros(n, n);
    for j in 0..n {
        for i in j..n {
            let sum: f64 = a[(i, j)] - (0..j).map(|k| lower[(i, k)] * lower[(j, k)]).sum::<f64>();
            if i == j {
                if sum.is_nan() || sum <= 0.0 {
                    return None;
                }
                lower[(j, j)] = sum.sqrt();
            } else {
                lower[(i, j)] = sum / lower[(j, j)];
            }
        }
    }
    let mut inverse = Mat::zeros(n, n);
    for j in 0..n {
        for i in j..n {
            let below: f64 = (j..i).map(|k| lower[(i, k)] * inverse[(k, j)]).sum();
            inverse[(i, j)] = (f64::from(u8::from(i == j)) - below) / lower[(i, i)];
        }
    }
    Some((inverse, lower))
}

fn randomised(
    y: &Blocks<'_>,
    params: &PodParams,
    floor: f64,
    oversampling: usize,
    power_iterations: usize,
    seed: u64,
) -> Result<Factors, PodError> {
    let (n, m) = (y.data.rows(), y.data.snapshots());
    let l = (params.limit(n.min(m)) + oversampling).min(n.min(m));
    let mut random = rand_pcg::Pcg64::seed_from_u64(seed);
    let orthonormal = |a: Mat<f64>| thin_svd(a.as_ref()).map(|svd| svd.0).ok_or_else(|| y.not_converged());
    // Sums of uniform numbers: near enough to normal ones.
    let test = Mat::from_fn(m, l, |_, _| (0..4).map(|_| random.random_range(-1.0..1.0)).sum::<f64>());
    let mut q = orthonormal(y.times(true, test.as_ref())?)?;
    for _ in 0..power_iterations {
        let right = orthonormal(y.transposed_times(q.as_ref())?.transpose().to_owned())?;
        q = orthonormal(y.times(true, right.as_ref())?)?;
    }
    let (u, values, v) =
        thin_svd(y.transposed_times(q.as_ref())?.as_ref()).ok_or_else(|| y.not_converged())?;
    let energy = y.energy()?;
    let r = params.kept(&values, energy, floor);
    let mut modes = Mat::zeros(n, r);
    add_product(modes.as_mut(), q.as_ref(), u.subcols(0, r));
    if let Some(weights) = y.weights {
        modes = unweighted(y, weights, modes.as_ref(), v.as_ref(), &values)?;
    }
    Ok(Factors { modes, values, coefficients: v.subcols(0, r).transpose().to_owned(), energy })
}
