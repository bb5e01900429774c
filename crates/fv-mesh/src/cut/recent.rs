//! What the last solutions of a system with a fixed matrix tell of the next one.

use interfaces::RestartError;

/// Directions and their products with the matrix, the products orthonormal: of a right-hand side they take what lies in the products'
/// span. Going on in the direction of what is left, with each product made orthogonal to those before, is the method of generalised
/// conjugate residuals (Eisenstat, Elman & Schultz 1983, SIAM J. Numer. Anal. 20, 345), and the directions serve the next right-hand
/// side as well (de Sturler 1996, J. Comput. Appl. Math. 67, 15). The oldest give way.
#[derive(Clone, Debug)]
pub(super) struct Recent {
    m: usize,
    /// How many there are, and which is the next to be replaced.
    count: usize,
    next: usize,
    /// Direction after direction, and product after product; as many as there may be.
    directions: Vec<f64>,
    products: Vec<f64>,
}

/// So many are kept.
const KEPT: usize = 20;

impl Recent {
    /// For `m` unknowns.
    pub(super) fn new(m: usize) -> Self {
        Self { m, count: 0, next: 0, directions: vec![0.0; KEPT * m], products: vec![0.0; KEPT * m] }
    }

    /// Hands all of it to `sink`.
    pub(super) fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        sink("walls recent", &[self.count as f64, self.next as f64]);
        sink("walls directions", &self.directions);
        sink("walls products", &self.products);
    }

    /// Takes back what [`save`](Self::save) gave.
    pub(super) fn restore<'a>(
        &mut self,
        source: &dyn Fn(&str) -> Option<&'a [f64]>,
    ) -> Result<(), RestartError> {
        let mut counts = [0.0; 2];
        RestartError::fill(source, "walls recent", &mut counts)?;
        [self.count, self.next] = counts.map(|count| (count as usize).min(KEPT));
        self.next %= KEPT;
        RestartError::fill(source, "walls directions", &mut self.directions)?;
        RestartError::fill(source, "walls products", &mut self.products)
    }

    /// Forgets all.
    pub(super) fn forget(&mut self) {
        (self.count, self.next) = (0, 0);
    }

    fn pair(&self, k: usize) -> (&[f64], &[f64]) {
        let at = k * self.m..(k + 1) * self.m;
        (&self.directions[at.clone()], &self.products[at])
    }

    /// Moves from `residual` to `change` what pair `k` tells.
    fn reduce_by(&self, k: usize, residual: &mut [f64], change: &mut [f64]) {
        let (d, q) = self.pair(k);
        let part = dot(q, residual);
        add(residual, -part, q);
        add(change, part, d);
    }

    /// Moves from `residual` to `change` what is known.
    pub(super) fn reduce(&self, residual: &mut [f64], change: &mut [f64]) {
        (0..self.count).for_each(|k| self.reduce_by(k, residual, change));
    }

    /// Moves from `residual` to `change` what was learnt last.
    pub(super) fn reduce_last(&self, residual: &mut [f64], change: &mut [f64]) {
        self.reduce_by((self.next + KEPT - 1) % KEPT, residual, change);
    }

    /// Learns that the matrix makes this `product` of this `direction`. Both are scratch afterwards.
    pub(super) fn learn(&mut self, direction: &mut [f64], product: &mut [f64]) {
        // Twice, for round-off; not against the one that gives way.
        for _ in 0..2 {
            for k in (0..self.count).filter(|&k| k != self.next) {
                let (d, q) = self.pair(k);
                let part = dot(q, product);
                add(product, -part, q);
                add(direction, -part, d);
            }
        }
        let scale = dot(product, product).sqrt().max(f64::MIN_POSITIVE).recip();
        let at = self.next * self.m..(self.next + 1) * self.m;
        self.directions[at.clone()].iter_mut().zip(&*direction).for_each(|(to, from)| *to = scale * from);
        self.products[at].iter_mut().zip(&*product).for_each(|(to, from)| *to = scale * from);
        self.count = (self.count + 1).min(KEPT);
        self.next = (self.next + 1) % KEPT;
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(to: &mut [f64], part: f64, from: &[f64]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to += part * from);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix without symmetry.
    fn product(x: &[f64]) -> Vec<f64> {
        let entry = |i: usize, j: usize| {
            if i == j { 3.0 + i as f64 } else { 0.3 * (i as f64 + 0.1 * j as f64).sin() }
        };
        (0..x.len()).map(|i| x.iter().enumerate().map(|(j, x)| entry(i, j) * x).sum()).collect()
    }

    #[test]
    fn what_lies_in_the_span_is_solved_at_once() {
        let n = 30;
        let change = |k: usize| -> Vec<f64> { (0..n).map(|i| ((i * k + k) as f64).sin()).collect() };
        let mut recent = Recent::new(n);
        for k in 1..=6 {
            recent.learn(&mut change(k), &mut product(&change(k)));
        }
        assert_eq!(recent.count, 6);
        let wanted: Vec<f64> = (0..n).map(|i| 2.0 * change(2)[i] - 0.7 * change(5)[i]).collect();
        let (mut residual, mut found) = (product(&wanted), vec![0.0; n]);
        recent.reduce(&mut residual, &mut found);
        assert!(residual.iter().all(|r| r.abs() < 1e-12), "{residual:?}");
        assert!(found.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 1e-12));
        // The oldest gives way, and what was saved is the same.
        for k in 7..=24 {
            recent.learn(&mut change(k), &mut product(&change(k)));
        }
        assert_eq!((recent.count, recent.next), (KEPT, 4));
        let mut saved: Vec<(String, Vec<f64>)> = Vec::new();
        recent.save(&mut |name, values| saved.push((name.into(), values.to_vec())));
        let mut other = Recent::new(n);
        other.restore(&|name| saved.iter().find(|s| s.0 == name).map(|s| s.1.as_slice())).unwrap();
        let first = |recent: &Recent| {
            let (mut residual, mut found) = (product(&wanted), vec![0.0; n]);
            recent.reduce(&mut residual, &mut found);
            found
        };
        assert_eq!((first(&recent), recent.next), (first(&other), other.next));
    }
}
