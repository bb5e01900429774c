//! Links that the surface cuts.
use super::Cutter;
use super::distances::Near;
use interfaces::{Bodies, CutNode, Link, Vector};

/// A wall is never nearer than this share of a link.
const LEAST: f64 = 1e-8;

/// Fraction of a link before the wall that it crosses at the fraction `t`, with the distances `ends` of its nodes.
///
/// A link that enters a body at an edge and goes on along its surface ends at the wall at t if its node inside is a little below the surface, and
/// at that node, whose velocity is the wall's, if it is a little above. So that the load does not jump in between, the wall goes to
/// the node as the crossing q by the straight line between the distances does, t + (1 − t) Q⁴ with Q = (q − t)/(1 − t): Q is 0 for
/// flat walls and of the order of the curvature times the link's length for smooth ones.
fn grazed(t: f64, ends: [f64; 2]) -> f64 {
    let straight = ends[0] / (ends[0] - ends[1]);
    if straight > t && t < 1.0 { t + (1.0 - t) * ((straight - t) / (1.0 - t)).powi(4) } else { t }
}

impl<B: Bodies + ?Sized> Cutter<'_, B> {
    /// The nodes in the fluid with a neighbour inside.
    pub(super) fn links(&self) -> Vec<CutNode> {
        let lattice = self.velocity.lattice(self.c);
        let mut out = Vec::new();
        let beside = |near: &&Near| near.distance > 0.0 && near.distance <= self.nodes.widest;
        for near in self.nodes.near.iter().filter(beside) {
            let node = near.node.map(|i| i as isize);
            let mut links = [[None; 2]; 3];
            for a in 0..self.dim {
                for (side, link) in links[a].iter_mut().enumerate() {
                    let mut beyond = node;
                    beyond[a] += 2 * side as isize - 1;
                    let Some(inside) = self.nodes.solid(beyond) else { continue };
                    let mut step = Vector::zeros();
                    step[a] = lattice.axes[a].place(beyond[a]) - lattice.axes[a].place(node[a]);
                    let arm = inside.arm - step;
                    let start = self.distance_at(near, inside.body(), arm);
                    let ends = [start, inside.distance];
                    let fraction = if start > 0.0 {
                        grazed(self.crossing(inside.body(), arm, step, ends), ends)
                    } else {
                        0.0
                    };
                    let velocity = self.wall_velocity(inside.body(), arm + fraction * step);
                    *link = Some(Link { fraction: fraction.max(LEAST), velocity });
                }
            }
            if links.iter().flatten().any(Option::is_some)
                && let Some(index) = lattice.index(node)
            {
                out.push(CutNode { index, body: near.body().0, arm: near.arm, links });
            }
        }
        out
    }
}
