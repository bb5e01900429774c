//! Gradients beside walls.
use super::openings::Openings;
use crate::Field;
use interfaces::WallPiece;
use std::collections::HashMap;

/// Gradients of one velocity component at nodes beside walls, by least squares with weights 1/distance² over the nodes around
/// that are in the fluid and, where the fluid does not slip, the wall.
#[derive(Default)]
pub(super) struct Gradients<const D: usize> {
    slots: HashMap<usize, u32>,
    nodes: Vec<usize>,
    starts: Vec<usize>,
    terms: Vec<(usize, [f64; D])>,
    /// Weight of the node itself.
    own: Vec<[f64; D]>,
    /// What the wall's velocity gives.
    wall: Vec<[f64; D]>,
    pub(super) values: Vec<[f64; D]>,
}

impl<const D: usize> Gradients<D> {
    pub(super) fn new() -> Self {
        Self {
            slots: HashMap::new(),
            nodes: Vec::new(),
            starts: vec![0],
            terms: Vec::new(),
            own: Vec::new(),
            wall: Vec::new(),
            values: Vec::new(),
        }
    }

    /// The number of the gradient at a node of component `c`; `sticks`: the fluid has the wall's velocity.
    pub(super) fn slot(&mut self, openings: &Openings<D>, c: usize, node: usize, sticks: bool) -> u32 {
        if let Some(&slot) = self.slots.get(&node) {
            return slot;
        }
        let slot = self.nodes.len() as u32;
        self.slots.insert(node, slot);
        self.nodes.push(node);
        let x = openings.node(c, node);
        let mut seen: Vec<(Option<usize>, [f64; D], f64)> = Vec::new();
        for other in around(openings, node).filter(|&o| o != node && openings.alive(c, o)) {
            let y = openings.node(c, other);
            seen.push((Some(other), std::array::from_fn(|a| y[a] - x[a]), 0.0));
        }
        if sticks {
            let s = openings.grid.stride()[c];
            for wall in [node - s, node].into_iter().filter_map(|cell| openings.piece(cell)) {
                let step = to_wall(wall.1, x);
                if norm2(&step) > 0.0 {
                    seen.push((None, step, wall.1.velocity[c]));
                }
            }
        }
        let typical =
            seen.iter().map(|t| norm2(&t.1)).fold(f64::INFINITY, |m, d| if d > 0.0 { m.min(d) } else { m });
        let scale =
            if typical.is_finite() { seen.iter().map(|t| norm2(&t.1)).fold(0.0, f64::max) } else { 1.0 };
        let mut normal = [[0.0; D]; D];
        for (_, step, _) in &seen {
            let weight = 1.0 / norm2(step).max(1e-2 * scale);
            for a in 0..D {
                (0..D).for_each(|b| normal[a][b] += weight * step[a] * step[b]);
            }
        }
        // Where nodes are on one line the gradient across it is none.
        let trace: f64 = (0..D).map(|a| normal[a][a]).sum();
        (0..D).for_each(|a| normal[a][a] += 1e-9 * trace + f64::MIN_POSITIVE);
        let (mut own, mut wall) = ([0.0; D], [0.0; D]);
        for (other, step, value) in seen {
            let weight = 1.0 / norm2(&step).max(1e-2 * scale);
            let part = solve(normal, step.map(|s| weight * s));
            (0..D).for_each(|a| own[a] -= part[a]);
            match other {
                Some(other) => self.terms.push((other, part)),
                None => (0..D).for_each(|a| wall[a] += value * part[a]),
            }
        }
        self.starts.push(self.terms.len());
        self.own.push(own);
        self.wall.push(wall);
        self.values.push([0.0; D]);
        slot
    }

    /// The value at `by` from a node as weights of stored values, and a constant.
    pub(super) fn extrapolation(
        &self,
        slot: u32,
        by: [f64; D],
        out: &mut Vec<(usize, f64)>,
        weight: f64,
    ) -> f64 {
        let k = slot as usize;
        let dot = |g: &[f64; D]| (0..D).map(|a| g[a] * by[a]).sum::<f64>();
        out.push((self.nodes[k], weight * (1.0 + dot(&self.own[k]))));
        out.extend(self.terms[self.starts[k]..self.starts[k + 1]].iter().map(|(o, g)| (*o, weight * dot(g))));
        weight * dot(&self.wall[k])
    }

    pub(super) fn update(&mut self, u: &Field<D>) {
        let u = u.data();
        for (k, value) in self.values.iter_mut().enumerate() {
            let here = u[self.nodes[k]];
            let mut sum: [f64; D] = std::array::from_fn(|a| self.own[k][a] * here + self.wall[k][a]);
            for (other, weights) in &self.terms[self.starts[k]..self.starts[k + 1]] {
                (0..D).for_each(|a| sum[a] += weights[a] * u[*other]);
            }
            *value = sum;
        }
    }
}

/// From `x` to the wall.
pub(super) fn to_wall<const D: usize>(wall: &WallPiece, x: [f64; D]) -> [f64; D] {
    let y: f64 = (0..D).map(|a| (x[a] - wall.foot[a]) * wall.normal[a]).sum();
    std::array::from_fn(|a| -y.max(0.0) * wall.normal[a])
}

fn norm2<const D: usize>(x: &[f64; D]) -> f64 {
    x.iter().map(|x| x * x).sum()
}

/// The block of nodes around one, itself included.
pub(super) fn around<const D: usize>(
    openings: &Openings<D>,
    node: usize,
) -> impl Iterator<Item = usize> + use<D> {
    let s = openings.grid.stride();
    (0..3_usize.pow(D as u32)).map(move |k| {
        let mut offset = 0;
        let mut rest = k;
        for stride in s {
            offset += (rest % 3) as isize * stride as isize - stride as isize;
            rest /= 3;
        }
        (node as isize + offset) as usize
    })
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
