//! Faces of which the surface closes a part.
use super::Cutter;
use super::distances::{Near, ON};
use super::face_distances::FaceDistances;
use super::profile::{self, Side, Support};
use interfaces::{Bodies, CutFace, Vector};

/// Openings up to this share are closed: the flux that is lost goes with the square of it. Round-off does not decide for walls just that far
/// from a line of the grid.
const LEAST: f64 = 1e-3 * (1.0 + ON);

/// Faces of which no more than this share is closed are open.
const ROUND: f64 = 1e-12;

impl<B: Bodies + ?Sized> Cutter<'_, B> {
    /// The faces that are not wholly open.
    pub(super) fn faces(&self) -> Vec<CutFace> {
        let mut out = Vec::with_capacity(self.nodes.near.len());
        for near in &self.nodes.near {
            let face = if self.dim == 2 { self.edge(near) } else { self.polygon(near) };
            out.extend(face.map(|face| self.moved(face, near)));
        }
        out
    }

    /// The velocity of a face of which the velocity relative to the wall is known. The wall's velocity goes on on either side of it;
    /// deep inside it is that of the body.
    fn moved(&self, face: CutFace, near: &Near) -> CutFace {
        if near.distance < -self.nodes.widest {
            return CutFace { constant: self.bodies.twist(near.body()).at(near.arm)[self.c], ..face };
        }
        let lattice = self.velocity.lattice(self.c);
        let own = self.wall_velocity(near.body(), near.arm);
        let wall = |index: usize| {
            if index == face.index {
                return own;
            }
            let mut arm = near.arm;
            let there = lattice.node(index);
            for a in 0..self.dim {
                let nodes = &lattice.axes[a];
                let away = nodes.place(there[a]) - nodes.place(near.node[a] as isize);
                let turns = nodes.period().map_or(0.0, |period| period * (away / period).round());
                arm[a] += away - turns;
            }
            self.wall_velocity(near.body(), arm)
        };
        let terms = face.terms.iter().filter(|term| term.1 != 0.0);
        let taken: f64 = terms.map(|&(index, weight)| weight * wall(index)).sum();
        CutFace { constant: own - taken, ..face }
    }

    /// The corner of the face of `node` that is above it along the axes where `up` is 1.
    fn corner(&self, node: [isize; 3], up: [isize; 3]) -> Option<&Near> {
        // Vertices are counted from the side of a bounded axis, nodes from the first face inside.
        let shift = isize::from(!self.velocity.lattice(self.c).axes[self.c].is_periodic());
        self.vertices.at([0, 1, 2].map(|a| node[a] + if a == self.c { shift } else { up[a] }))
    }

    /// Storage index of a node, if it is in the fluid.
    fn fluid(&self, node: [isize; 3]) -> Option<usize> {
        self.velocity.lattice(self.c).index(node).filter(|_| self.nodes.solid(node).is_none())
    }

    /// A face of a grid in 2D: an edge, cut by the surface on either side of its node, or on both.
    fn edge(&self, near: &Near) -> Option<CutFace> {
        let lattice = self.velocity.lattice(self.c);
        let (node, along) = (near.node.map(|i| i as isize), 1 - self.c);
        let index = lattice.index(node)?;
        let width = lattice.axes[along].width(node[along]);
        if near.distance.abs() > 0.5 * width {
            return (near.distance < 0.0).then(|| closed(index));
        }
        let sides = [0, 1].map(|side| self.side(near, side, along, width));
        let open = sides[0].open + sides[1].open;
        if open >= 1.0 - ROUND {
            return None;
        }
        let mut face = CutFace { open, ..closed(index) };
        if open < LEAST {
            return Some(closed(index));
        }
        if near.distance > 0.0 {
            profile::around_node(sides, &mut face)
        } else {
            profile::from_walls(sides, &mut face)
        }
        Some(face)
    }

    /// One side of the node of an edge.
    fn side(&self, near: &Near, side: usize, along: usize, width: f64) -> Side {
        let node = near.node.map(|i| i as isize);
        let sign = 2 * side as isize - 1;
        let mut up = [0; 3];
        up[along] = side as isize;
        let end = self.corner(node, up).filter(|corner| corner.distance <= 0.0);
        let at = |steps: isize| {
            let mut at = node;
            at[along] += steps * sign;
            at
        };
        let mut step = Vector::zeros();
        step[along] = 0.5 * sign as f64 * width;
        let open = 0.5
            * match (near.distance > 0.0, end) {
                (true, None) => 1.0,
                (true, Some(end)) => self.share_before(near, end, step),
                (false, Some(_)) => 0.0,
                (false, None) => {
                    let arm = near.arm + step;
                    let d = self.distance(near.body(), arm);
                    if d > 0.0 { self.crossing(near.body(), arm, -step, [d, near.distance]) } else { 0.0 }
                }
            };
        let next = match self.nodes.solid(at(1)) {
            _ if end.is_some() => Support::Wall(open),
            Some(wall) if near.distance > 0.0 => {
                let nodes = &self.velocity.lattice(self.c).axes[along];
                step[along] = nodes.place(at(1)[along]) - nodes.place(node[along]);
                let share = self.share_before(near, wall, step);
                Support::Wall((share * step[along].abs() / width).max(0.5))
            }
            Some(_) => Support::Wall(1.0),
            None => self.fluid(at(1)).map_or(Support::None, Support::Node),
        };
        let second = match self.nodes.solid(at(2)) {
            Some(_) => Support::Wall(2.0),
            None => self.fluid(at(2)).map_or(Support::None, Support::Node),
        };
        Side { open, cut: end.is_some(), next, second }
    }

    /// Share of the way along `step` from a node in the fluid to a place inside that is before the surface.
    fn share_before(&self, near: &Near, end: &Near, step: Vector) -> f64 {
        let arm = end.arm - step;
        let start = self.distance_at(near, end.body(), arm).max(0.0);
        self.crossing(end.body(), arm, step, [start, end.distance])
    }

    /// A face of a grid in 3D, by the distances at its node and corners.
    fn polygon(&self, near: &Near) -> Option<CutFace> {
        let lattice = self.velocity.lattice(self.c);
        let node = near.node.map(|i| i as isize);
        let index = lattice.index(node)?;
        let axes = [(self.c + 1) % 3, (self.c + 2) % 3];
        let [w, v] = axes.map(|a| lattice.axes[a].width(node[a]));
        if near.distance * near.distance > 0.25 * (w * w + v * v) {
            return (near.distance < 0.0).then(|| closed(index));
        }
        let mut corners = [0.0; 4];
        for (k, distance) in corners.iter_mut().enumerate() {
            let mut up = [0; 3];
            (up[axes[0]], up[axes[1]]) = ((k & 1) as isize, (k >> 1) as isize);
            *distance = self.corner(node, up)?.distance;
        }
        let cut = FaceDistances::new(corners, near.distance);
        let open = cut.open();
        if open >= 1.0 - ROUND {
            return None;
        }
        if open < LEAST {
            return Some(closed(index));
        }
        let neighbours = [0, 1].map(|k| {
            let mut beyond = node;
            beyond[axes[k]] += if cut.rise[k] > 0.0 { 1 } else { -1 };
            let nodes = &lattice.axes[axes[k]];
            let gap = (nodes.place(beyond[axes[k]]) - nodes.place(node[axes[k]])).abs();
            let further = cut.rise[k].abs() * gap / nodes.width(node[axes[k]]);
            let next = match self.nodes.solid(beyond) {
                Some(_) => Support::Wall(0.0),
                None => self.fluid(beyond).map_or(Support::None, Support::Node),
            };
            (next, further)
        });
        let mut face = CutFace { open, ..closed(index) };
        cut.weights(neighbours, &mut face);
        Some(face)
    }
}

/// A face whose flux is the wall's.
fn closed(index: usize) -> CutFace {
    CutFace { index, open: 0.0, constant: 0.0, terms: [(index, 0.0); 4] }
}
