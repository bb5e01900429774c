//! The waves that samples are made of.
use crate::Mat;
use crate::interpolation::{Samples, Scaling};
use monomorphic::Qr;
use std::f64::consts::FRAC_PI_2;

/// Candidates at most: the work is this times m k for each wave that is found.
const CANDIDATES: usize = 2048;
/// Waves are looked for until this share of the squares is left.
const LEFT: f64 = 1e-3;

/// The ω (as columns, for inputs scaled to [−1, 1]) of the waves cos ωᵀz, sin ωᵀz that explain most of the values, one after another
/// (orthogonal matching pursuit: Pati, Rezaiifar & Krishnaprasad 1993), beside a constant and a slope along every input.
///
/// Candidates have periods that are whole fractions of twice the extent, down to four distances of points that are evenly
/// distributed; around the best one its frequency is refined continuously.
pub(super) fn strongest(samples: &Samples, scaling: &Scaling, most: usize) -> Mat<f64> {
    let (d, m, k) = (samples.inputs(), samples.len(), samples.outputs());
    let mut z = Mat::zeros(d, m);
    (0..m).for_each(|j| scaling.apply(samples.point(j), z.col_as_slice_mut(j)));
    let values = samples.values();
    let mut found: Vec<Vec<f64>> = Vec::new();
    let mut start = None;
    let candidates = candidates(samples);
    // Two numbers are needed for each wave, and one for the constant and for each slope.
    while found.len() < most && m > 2 * (1 + d + 2 * (found.len() + 1)) {
        let columns = |i: usize, c: usize| match c {
            0 => 1.0,
            c if c <= d => z[(c - 1, i)],
            c => {
                let (sin, cos) = angle(&z, i, &found[(c - 1 - d) / 2]).sin_cos();
                if (c - 1 - d) % 2 == 0 { cos } else { sin }
            }
        };
        let basis = without_constants(Mat::from_fn(m, 1 + d + 2 * found.len(), columns));
        let mut right = Mat::from_fn(m, k, |j, row| values[(row, j)]);
        Qr::new(basis.clone()).solve(right.as_mut());
        let coefficients = right.get(..basis.ncols(), ..);
        let left = Mat::from_fn(m, k, |j, row| values[(row, j)]) - &basis * coefficients;
        let sum = left.squared_norm_l2();
        let start = *start.get_or_insert(sum);
        if sum <= LEFT * start {
            break;
        }
        let explained = |omega: &[f64]| explained(&z, &left, omega);
        let Some(best) = candidates
            .iter()
            .map(|omega| (explained(omega), omega))
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, omega)| omega.clone())
        else {
            break;
        };
        let best = refined(best, &explained);
        found.push(best);
    }
    Mat::from_fn(d, found.len(), |i, j| found[j][i])
}

/// Columns that are zero or repeat the constant make way: inputs may have one value only.
fn without_constants(basis: Mat<f64>) -> Mat<f64> {
    let varies = |c: usize| c == 0 || (1..basis.nrows()).any(|i| basis[(i, c)] != basis[(0, c)]);
    let kept: Vec<usize> = (0..basis.ncols()).filter(|&c| varies(c)).collect();
    Mat::from_fn(basis.nrows(), kept.len(), |i, c| basis[(i, kept[c])])
}

fn angle(z: &Mat<f64>, i: usize, omega: &[f64]) -> f64 {
    z.col_as_slice(i).iter().zip(omega).map(|(z, omega)| z * omega).sum()
}

/// Multiples of π/2 along every input, of ±ω only one.
fn candidates(samples: &Samples) -> Vec<Vec<f64>> {
    let d = samples.inputs();
    let even = (samples.len() as f64).powf(1.0 / d as f64);
    let most = |i: usize| ((samples.distinct(i).len() as f64).min(even) - 1.0) / 2.0;
    let mut bounds: Vec<i32> = (0..d).map(|i| most(i) as i32).collect();
    let count = |bounds: &[i32]| bounds.iter().map(|&b| f64::from(2 * b + 1)).product::<f64>();
    while count(&bounds) > 2.0 * CANDIDATES as f64 {
        let largest = bounds.iter().copied().max().unwrap_or(0);
        bounds.iter_mut().for_each(|b| *b = (*b).min(largest - 1));
    }
    let mut all = vec![vec![]];
    for &bound in &bounds {
        all = all
            .into_iter()
            .flat_map(|of: Vec<i32>| (-bound..=bound).map(move |n| [of.as_slice(), &[n]].concat()))
            .collect();
    }
    all.retain(|of| of.iter().find(|n| **n != 0).is_some_and(|n| *n > 0));
    all.into_iter().map(|of| of.into_iter().map(|n| FRAC_PI_2 * f64::from(n)).collect()).collect()
}

/// By how much cos ωᵀz and sin ωᵀz together lower the sum of squares.
fn explained(z: &Mat<f64>, left: &Mat<f64>, omega: &[f64]) -> f64 {
    let waves: Vec<(f64, f64)> = (0..z.ncols()).map(|i| angle(z, i, omega).sin_cos()).collect();
    let [mut ss, mut sc, mut cc] = [0.0; 3];
    for (s, c) in &waves {
        ss += s * s;
        sc += s * c;
        cc += c * c;
    }
    let determinant = ss * cc - sc * sc;
    if determinant <= 1e-10 * (ss + cc).powi(2) {
        return 0.0;
    }
    let one = |row: usize| {
        let pairs = left.col_as_slice(row).iter().zip(&waves);
        let [s, c] = pairs.fold([0.0; 2], |[a, b], (y, (s, c))| [a + y * s, b + y * c]);
        (cc * s * s - 2.0 * sc * s * c + ss * c * c) / determinant
    };
    (0..left.ncols()).map(one).sum()
}

/// One input after another by golden sections within half a step to both sides.
fn refined(mut omega: Vec<f64>, explained: &dyn Fn(&[f64]) -> f64) -> Vec<f64> {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let start = explained(&omega);
    let before = omega.clone();
    for i in 0..omega.len() {
        let [mut a, mut b] = [omega[i] - 0.5 * FRAC_PI_2, omega[i] + 0.5 * FRAC_PI_2];
        let mut at = |place: f64| {
            omega[i] = place;
            explained(&omega)
        };
        let [mut c, mut d] = [b - golden * (b - a), a + golden * (b - a)];
        let [mut at_c, mut at_d] = [at(c), at(d)];
        for _ in 0..30 {
            if at_c > at_d {
                (b, d, at_d) = (d, c, at_c);
                c = b - golden * (b - a);
                at_c = at(c);
            } else {
                (a, c, at_c) = (c, d, at_d);
                d = a + golden * (b - a);
                at_d = at(d);
            }
        }
        omega[i] = 0.5 * (a + b);
    }
    if explained(&omega) >= start { omega } else { before }
}
