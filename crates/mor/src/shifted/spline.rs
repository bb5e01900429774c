//! Coefficients of splines.

/// L D Lᵀ of the matrix of a spline's basis function at the nodes (symmetric, of one value per diagonal, two beside the main one).
pub(super) struct Collocation {
    below: Vec<[f64; 2]>,
    pivot: Vec<f64>,
}

/// So many cells beyond its end a field no longer matters: 0.4306⁴⁸ < 1e-17 for the quintic spline, the cubic one forgets faster.
pub(super) const MARGIN: usize = 48;

impl Collocation {
    /// Of `n` nodes.
    pub(super) fn new(basis: [f64; 3], n: usize) -> Self {
        let [diagonal, first, second] = basis;
        let (mut below, mut pivot) = (Vec::with_capacity(n), Vec::<f64>::with_capacity(n));
        for i in 0..n {
            let l2 = if i > 1 { second / pivot[i - 2] } else { 0.0 };
            // What row i − 1 holds of row i − 2.
            let l1 = match i {
                0 => 0.0,
                1 => first / pivot[0],
                _ => {
                    let [before, _]: [f64; 2] = below[i - 1];
                    (first - l2 * pivot[i - 2] * before) / pivot[i - 1]
                }
            };
            let mut d = diagonal;
            if i > 0 {
                d -= l1 * l1 * pivot[i - 1];
            }
            if i > 1 {
                d -= l2 * l2 * pivot[i - 2];
            }
            below.push([l1, l2]);
            pivot.push(d);
        }
        Self { below, pivot }
    }

    /// Replaces blocks of `inner` values, as many as nodes, by their coefficients.
    pub(super) fn solve(&self, inner: usize, x: &mut [f64]) {
        let n = self.pivot.len();
        for i in 1..n {
            let [l1, l2] = self.below[i];
            let (done, row) = x.split_at_mut(i * inner);
            let before = &done[(i - 1) * inner..];
            if i == 1 {
                row[..inner].iter_mut().zip(before).for_each(|(x, a)| *x -= l1 * a);
            } else {
                let second = &done[(i - 2) * inner..];
                let rows = row[..inner].iter_mut().zip(before).zip(second);
                rows.for_each(|((x, a), b)| *x -= l1 * a + l2 * b);
            }
        }
        for i in (0..n).rev() {
            let (row, rest) = x[i * inner..].split_at_mut(inner);
            let inverse = 1.0 / self.pivot[i];
            row.iter_mut().for_each(|x| *x *= inverse);
            for (far, after) in (1..=2).zip(rest.chunks_exact(inner)) {
                if let Some(l) = self.below.get(i + far) {
                    let l = l[far - 1];
                    row.iter_mut().zip(after).for_each(|(x, a)| *x -= l * a);
                }
            }
        }
    }
}
