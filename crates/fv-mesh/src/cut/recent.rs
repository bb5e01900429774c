//! What the last solutions of a system with a fixed matrix tell of the next one.

use crate::flow_state::restore_list;
use interfaces::RestartError;

/// Changes of the unknowns in the last solutions and their products with the matrix, M-orthonormal: of a new right-hand side
/// they take what lies in their span (Fischer 1998, Comput. Methods Appl. Mech. Eng. 163, 193).
#[derive(Clone, Debug)]
pub(super) struct Recent {
    m: usize,
    /// How many there are, and which is the next to be replaced.
    count: usize,
    next: usize,
    /// Change after change, and product after product; as many as there may be.
    changes: Vec<f64>,
    products: Vec<f64>,
}

/// So many are kept.
const KEPT: usize = 10;
/// What is left of a change after those before it have been taken out, in the square of the norm, below which it is nothing new.
const NEW: f64 = 1e-6;

impl Recent {
    /// For `m` unknowns.
    pub(super) fn new(m: usize) -> Self {
        Self { m, count: 0, next: 0, changes: vec![0.0; KEPT * m], products: vec![0.0; KEPT * m] }
    }

    /// Hands all of it to `sink`.
    pub(super) fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        sink("walls recent", &[self.count as f64, self.next as f64]);
        sink("walls changes", &self.changes);
        sink("walls products", &self.products);
    }

    /// Takes back what [`save`](Self::save) gave.
    pub(super) fn restore<'a>(
        &mut self,
        source: &dyn Fn(&str) -> Option<&'a [f64]>,
    ) -> Result<(), RestartError> {
        let mut counts = [0.0; 2];
        restore_list(source, "walls recent", &mut counts)?;
        [self.count, self.next] = counts.map(|count| (count as usize).min(KEPT));
        self.next %= KEPT;
        restore_list(source, "walls changes", &mut self.changes)?;
        restore_list(source, "walls products", &mut self.products)
    }

    fn pairs(&self) -> impl Iterator<Item = (&[f64], &[f64])> {
        self.changes.chunks_exact(self.m).zip(self.products.chunks_exact(self.m)).take(self.count)
    }

    /// Moves from `residual` to `change` what is known.
    pub(super) fn start(&self, residual: &mut [f64], change: &mut [f64]) {
        for (d, q) in self.pairs() {
            let part = dot(d, residual);
            add(residual, -part, q);
            add(change, part, d);
        }
    }

    /// Learns from a solution: M `change` = `product`. Both are scratch afterwards.
    pub(super) fn learn(&mut self, change: &mut [f64], product: &mut [f64]) {
        let whole = dot(change, product);
        // Twice, for round-off.
        for _ in 0..2 {
            for (d, q) in self.pairs() {
                let part = dot(q, change);
                add(change, -part, d);
                add(product, -part, q);
            }
        }
        let left = dot(change, product);
        if !(left > NEW * whole && whole > 0.0) {
            return;
        }
        let scale = left.sqrt().recip();
        let at = self.next * self.m..(self.next + 1) * self.m;
        self.changes[at.clone()].iter_mut().zip(&*change).for_each(|(to, from)| *to = scale * from);
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

    /// A symmetric, positive definite matrix.
    fn product(x: &[f64]) -> Vec<f64> {
        let n = x.len();
        (0..n).map(|i| (0..n).map(|j| if i == j { 3.0 + i as f64 } else { 0.3 } * x[j]).sum()).collect()
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
        // Nothing new.
        recent.learn(&mut change(3), &mut product(&change(3)));
        assert_eq!(recent.count, 6);
        let wanted: Vec<f64> = (0..n).map(|i| 2.0 * change(2)[i] - 0.7 * change(5)[i]).collect();
        let (mut residual, mut found) = (product(&wanted), vec![0.0; n]);
        recent.start(&mut residual, &mut found);
        assert!(residual.iter().all(|r| r.abs() < 1e-12), "{residual:?}");
        assert!(found.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 1e-12));
        // The oldest gives way, and what was saved is the same.
        for k in 7..=14 {
            recent.learn(&mut change(k), &mut product(&change(k)));
        }
        assert_eq!((recent.count, recent.next), (KEPT, 4));
        let mut saved: Vec<(String, Vec<f64>)> = Vec::new();
        recent.save(&mut |name, values| saved.push((name.into(), values.to_vec())));
        let mut other = Recent::new(n);
        other.restore(&|name| saved.iter().find(|s| s.0 == name).map(|s| s.1.as_slice())).unwrap();
        let first = |recent: &Recent| {
            let (mut residual, mut found) = (product(&wanted), vec![0.0; n]);
            recent.start(&mut residual, &mut found);
            found
        };
        assert_eq!((first(&recent), recent.next), (first(&other), other.next));
    }
}
