//! Links that the surface cuts.
use super::Cutter;
use super::distances::Near;
use interfaces::{Bodies, CutNode, Link, Vector};

/// A wall is never nearer than this share of a link.
const LEAST: f64 = 1e-8;

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
                    let fraction = match start > 0.0 {
                        true => self.crossing(inside.body(), arm, step, [start, inside.distance]),
                        false => 0.0,
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
