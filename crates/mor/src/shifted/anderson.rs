//! Acceleration of fixed-point iterations.
use super::dense::{add, columns, inner};
use monomorphic::Mat;
use std::collections::VecDeque;

/// Anderson's mixing for x = G(x): the next x is that combination of the last values of G whose
/// residuals F = G(x) − x cancel best in the sense of least squares (Anderson 1965). For an affine
/// G it is as good as GMRES of as many steps (Walker & Ni 2011).
#[derive(Default)]
pub(super) struct Anderson {
    /// Changes ΔG and ΔF of the last steps, combined so that the ΔF are orthonormal.
    changes: VecDeque<[Mat<f64>; 2]>,
    /// G and F of the last step.
    last: Option<[Mat<f64>; 2]>,
}

/// Steps whose changes are combined.
const DEPTH: usize = 5;

impl Anderson {
    /// No step is combined with the last one.
    pub(super) fn is_empty(&self) -> bool {
        self.changes.is_empty()
    }

    /// The next x after G(x) and F = G(x) − x.
    pub(super) fn next(&mut self, g: Mat<f64>, f: Mat<f64>) -> Mat<f64> {
        if let Some([last_g, last_f]) = self.last.take() {
            let [mut dg, mut df] = [&g - last_g, &f - last_f];
            let before = df.norm_l2();
            // Twice is enough (Giraud, Langou, Rozložník & van den Eshof 2005).
            for _ in 0..2 {
                for [g, f] in &self.changes {
                    let part = inner(f.as_ref(), df.as_ref());
                    add(&mut dg, -part, g);
                    add(&mut df, -part, f);
                }
            }
            let norm = df.norm_l2();
            if norm > f64::EPSILON.sqrt() * before {
                for change in [&mut dg, &mut df] {
                    columns(change).into_iter().flatten().for_each(|x| *x /= norm);
                }
                self.changes.push_back([dg, df]);
            }
            if self.changes.len() > DEPTH {
                self.changes.pop_front();
            }
        }
        let mut next = g.clone();
        for [dg, df] in &self.changes {
            add(&mut next, -inner(df.as_ref(), f.as_ref()), dg);
        }
        self.last = Some([g, f]);
        next
    }
}

#[cfg(test)]
mod tests {
    use super::Anderson;
    use monomorphic::Mat;

    /// G(x)ᵢ = 1 + λᵢ xᵢ with four different λ, up to 0.99: plain iteration needs thousands of
    /// steps.
    #[test]
    fn an_affine_map_is_solved_in_as_many_steps_as_it_has_eigenvalues() {
        let lambda = |i: usize| [0.99, 0.9, 0.3, -0.5][i % 4];
        let mut x = Mat::zeros(20, 3);
        let mut mixing = Anderson::default();
        let mut left = f64::INFINITY;
        for _ in 0..6 {
            let g = Mat::from_fn(20, 3, |i, j| 1.0 + lambda(i) * x[(i, j)]);
            let f = &g - &x;
            left = f.norm_l2();
            x = mixing.next(g, f);
        }
        assert!(left < 1e-9, "{left}");
        assert!((x[(0, 2)] - 100.0).abs() < 1e-6 && (x[(1, 0)] - 10.0).abs() < 1e-6);
    }
}
