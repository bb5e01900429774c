//! Gradients by least squares.

/// What values at `steps` from a place, less the one there, add to its gradient; weights are 1/distance².
pub(crate) fn gradient_weights<const D: usize>(steps: &[[f64; D]]) -> Vec<[f64; D]> {
    let scale = steps.iter().map(norm2).fold(0.0, f64::max);
    let weight = |step: &[f64; D]| 1.0 / norm2(step).max(1e-2 * scale);
    let mut normal = [[0.0; D]; D];
    for step in steps {
        for a in 0..D {
            (0..D).for_each(|b| normal[a][b] += weight(step) * step[a] * step[b]);
        }
    }
    // Where places are on one line the gradient across it is none.
    let trace: f64 = (0..D).map(|a| normal[a][a]).sum();
    (0..D).for_each(|a| normal[a][a] += 1e-9 * trace + f64::MIN_POSITIVE);
    steps.iter().map(|step| solve(normal, step.map(|s| weight(step) * s))).collect()
}

pub(crate) fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|k| a[k] * b[k]).sum()
}

pub(crate) fn norm2<const D: usize>(x: &[f64; D]) -> f64 {
    dot(x, x)
}

/// Solves a small symmetric positive system.
fn solve<const D: usize>(mut m: [[f64; D]; D], mut b: [f64; D]) -> [f64; D] {
    for k in 0..D {
        for i in k + 1..D {
            let factor = m[i][k] / m[k][k];
            for j in k..D {
                m[i][j] -= factor * m[k][j];
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..D).rev() {
        for j in k + 1..D {
            b[k] -= m[k][j] * b[j];
        }
        b[k] /= m[k][k];
    }
    b
}
