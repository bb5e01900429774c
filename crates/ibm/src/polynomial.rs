//! Polynomials through scattered values.
use interfaces::Vector;
use nalgebra::{DMatrix, DVector};

/// A value near a point: where (in units of about the reach of all of them), how much it counts, and what it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) at: Vector,
    pub(crate) weight: f64,
    pub(crate) value: f64,
}

/// Value and gradient of a polynomial at the origin, and its degree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fit {
    pub(crate) value: f64,
    pub(crate) gradient: Vector,
    pub(crate) degree: usize,
}

/// The polynomial of the highest degree up to `degree` that the `samples` determine, by weighted least squares. With `fixed` it
/// has that value at the origin. `None` if there are no samples and nothing is fixed.
pub(crate) fn fit(samples: &[Sample], dim: usize, degree: usize, fixed: Option<f64>) -> Option<Fit> {
    (1..=degree).rev().find_map(|degree| fit_degree(samples, dim, degree, fixed)).or_else(|| {
        let weight: f64 = samples.iter().map(|s| s.weight).sum();
        let mean = samples.iter().map(|s| s.weight * s.value).sum::<f64>() / weight;
        let value = fixed.or((weight > 0.0).then_some(mean))?;
        Some(Fit { value, gradient: Vector::zeros(), degree: 0 })
    })
}

/// So many samples per coefficient are asked for.
const SAMPLES: f64 = 1.3;
/// Pivots of the normal equations, over the largest, below which a degree is not determined.
const PIVOT: f64 = 1e-4;

fn fit_degree(samples: &[Sample], dim: usize, degree: usize, fixed: Option<f64>) -> Option<Fit> {
    // The constant comes first, or not at all; then the linear terms.
    let skip = usize::from(fixed.is_some());
    let mut row = [0.0; MOST];
    let n = terms(Vector::zeros(), dim, degree, &mut row) - skip;
    if (samples.len() as f64) < SAMPLES * n as f64 {
        return None;
    }
    let mut matrix = DMatrix::<f64>::zeros(n, n);
    let mut right = DVector::<f64>::zeros(n);
    for sample in samples {
        terms(sample.at, dim, degree, &mut row);
        let row = &row[skip..skip + n];
        let value = sample.value - fixed.unwrap_or(0.0);
        for (i, a) in row.iter().enumerate() {
            let weighted = sample.weight * a;
            right[i] += weighted * value;
            for (j, b) in row[..=i].iter().enumerate() {
                matrix[(i, j)] += weighted * b;
            }
        }
    }
    let scale = DVector::from_fn(n, |i, _| matrix[(i, i)].sqrt().recip());
    if scale.iter().any(|s| !s.is_finite()) {
        return None;
    }
    for i in 0..n {
        for j in 0..=i {
            matrix[(i, j)] *= scale[i] * scale[j];
        }
    }
    let factor = matrix.cholesky()?;
    if factor.l_dirty().diagonal().iter().any(|&pivot| pivot < PIVOT) {
        return None;
    }
    let solution = factor.solve(&right.component_mul(&scale)).component_mul(&scale);
    let value = fixed.unwrap_or_else(|| solution[0]);
    let gradient = Vector::from_fn(|a, _| if a < dim { solution[1 - skip + a] } else { 0.0 });
    Some(Fit { value, gradient, degree })
}

/// Coefficients of a cubic in space.
const MOST: usize = 20;

/// All monomials up to `degree` (at most 3) at `x`, by degree; how many they are.
fn terms(x: Vector, dim: usize, degree: usize, out: &mut [f64; MOST]) -> usize {
    out[0] = 1.0;
    let mut n = 1;
    let mut push = |value: f64| {
        out[n] = value;
        n += 1;
    };
    for a in 0..dim {
        push(x[a]);
    }
    for a in 0..if degree > 1 { dim } else { 0 } {
        for b in a..dim {
            push(x[a] * x[b]);
        }
    }
    for a in 0..if degree > 2 { dim } else { 0 } {
        for b in a..dim {
            for c in b..dim {
                push(x[a] * x[b] * x[c]);
            }
        }
    }
    n
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(dim: usize, half: bool, f: impl Fn(Vector) -> f64) -> Vec<Sample> {
        let side = |a: usize| if a < dim { -3..=3 } else { 0..=0 };
        let mut all = Vec::new();
        for i in side(0) {
            for j in side(1) {
                for k in side(2) {
                    let at = Vector::new(f64::from(i) + 0.3, f64::from(j) - 0.2, f64::from(k)) / 3.0;
                    if !half || at.x + 0.5 * at.y > 0.0 {
                        all.push(Sample { at, weight: 1.0 / (0.1 + at.norm()), value: f(at) });
                    }
                }
            }
        }
        all
    }

    /// Cubics come back from one side of the origin, with and without their value given.
    #[test]
    fn cubics_are_exact() {
        for dim in [2, 3] {
            let z = if dim == 3 { 1.0 } else { 0.0 };
            let f = |x: Vector| {
                2.0 - x.x + 3.0 * x.y + z * 0.5 * x.z + x.x * x.y - x.y.powi(3) + z * x.x * x.z * x.z
            };
            for fixed in [None, Some(2.0)] {
                let found = fit(&samples(dim, true, f), dim, 3, fixed).unwrap();
                assert_eq!(found.degree, 3);
                assert!((found.value - 2.0).abs() < 1e-11, "{found:?}");
                assert!((found.gradient - Vector::new(-1.0, 3.0, 0.5 * z)).norm() < 1e-10, "{found:?}");
            }
        }
    }

    /// Too few samples, or samples on a line, lower the degree; a line says nothing of what is across it.
    #[test]
    fn the_degree_is_what_the_samples_determine() {
        let f = |x: Vector| 1.0 + 2.0 * x.x;
        let all = samples(2, false, f);
        let degree = |n: usize| fit(&all[..n], 2, 3, None).unwrap().degree;
        // Two columns of them, and three.
        assert_eq!([1, 3, 12, 21, 49].map(degree), [0, 0, 1, 2, 3]);
        let line: Vec<Sample> = all.iter().filter(|s| (s.at.y + 0.2 / 3.0).abs() < 1e-9).copied().collect();
        assert_eq!(line.len(), 7);
        assert_eq!(fit(&line, 2, 3, None).unwrap().degree, 0);
        assert_eq!(fit(&[], 2, 3, None), None);
        assert_eq!(fit(&[], 2, 3, Some(4.0)).unwrap().value, 4.0);
    }
}
