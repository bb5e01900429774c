//! Faces of which the surface closes a part.
use super::Cutter;
use super::distances::Near;
use super::plane::Plane;
use interfaces::{Bodies, CutFace, Vector};

/// Smaller openings are closed: the flux that is lost goes with the square of this share.
const LEAST: f64 = 1e-3;

/// A half of the mean velocity over an edge, relative to the wall: the share of the edge that is open there, and the weights of
/// the node in the middle of the edge and of its neighbour.
#[derive(Clone, Copy, Debug, Default)]
struct Half {
    open: f64,
    own: f64,
    neighbour: f64,
}

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

    /// A face of a plane grid: two halves, from the node to either end.
    fn edge(&self, near: &Near) -> Option<CutFace> {
        let lattice = self.velocity.lattice(self.c);
        let (node, along) = (near.node.map(|i| i as isize), 1 - self.c);
        let index = lattice.index(node)?;
        let width = lattice.axes[along].width(node[along]);
        if near.distance.abs() > 0.5 * width {
            return (near.distance < 0.0).then(|| closed(index));
        }
        let ends = [0, 1].map(|side| {
            let mut up = [0; 3];
            up[along] = side;
            self.corner(node, up).filter(|corner| corner.distance <= 0.0)
        });
        let beyond = |side: usize, steps: isize| {
            let mut at = node;
            at[along] += steps * (2 * side as isize - 1);
            self.fluid(at)
        };
        let mut face = closed(index);
        for side in 0..2 {
            let mut step = Vector::zeros();
            step[along] = (side as f64 - 0.5) * width;
            let next = beyond(side, 1);
            let half = match (near.distance > 0.0, ends[side]) {
                // Beside a half that the wall cuts the profile goes on to the next node.
                (true, None) if ends[1 - side].is_some() && next.is_some() => {
                    Half { open: 0.5, own: 0.375, neighbour: 0.125 }
                }
                (true, None) => Half { open: 0.5, own: 0.5, neighbour: 0.0 },
                (true, Some(end)) => self.half_to_the_wall(near, end, step),
                (false, None) => self.half_from_the_wall(near, step, next.is_some()),
                (false, Some(_)) => Half::default(),
            };
            face.open += half.open;
            face.terms[0].1 += half.own;
            if let Some(next) = next {
                face.terms[1 + side] = (next, half.neighbour);
            }
        }
        if face.open >= 1.0 {
            return None;
        }
        if face.open < LEAST {
            return Some(closed(index));
        }
        // The open side, where the wall is on one side only.
        let side = usize::from(ends[0].is_some());
        if ends[0].is_some() != ends[1].is_some()
            && let (Some(_), Some(second)) = (beyond(side, 1), beyond(side, 2))
        {
            bend(&mut face, side, second);
        }
        Some(face)
    }

    /// From the node in the fluid along `step` to an end inside: linear up to the wall.
    fn half_to_the_wall(&self, near: &Near, end: &Near, step: Vector) -> Half {
        let arm = end.arm - step;
        let start = self.distance_at(near, end.body(), arm).max(0.0);
        let t = self.crossing(end.body(), arm, step, [start, end.distance]);
        Half { open: 0.5 * t, own: 0.25 * t, neighbour: 0.0 }
    }

    /// From the node inside along `step` to an end in the fluid: linear from the wall to the next node, if there is one, which
    /// is `open` + ½ away and seen at the middle of what is open.
    fn half_from_the_wall(&self, near: &Near, step: Vector, next: bool) -> Half {
        let arm = near.arm + step;
        let end = self.distance(near.body(), arm);
        let t = if end > 0.0 { self.crossing(near.body(), arm, -step, [end, near.distance]) } else { 0.0 };
        let open = 0.5 * t;
        Half { open, own: 0.0, neighbour: if next { 0.5 * open * open / (open + 0.5) } else { 0.0 } }
    }

    /// A face of a grid in space, cut by the plane that fits the distances at its node and corners.
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
        let solid = corners.iter().chain([&near.distance]).filter(|&&d| d <= 0.0).count();
        if solid == 0 {
            return None;
        }
        // Simpson's mean, since the surface bends, and the rise from side to side.
        let mean = (8.0 * near.distance + corners.iter().sum::<f64>()) / 12.0;
        let rise = [
            0.5 * (corners[1] + corners[3] - corners[0] - corners[2]),
            0.5 * (corners[2] + corners[3] - corners[0] - corners[1]),
        ];
        let plane = Plane::new(mean, rise);
        let open = if solid == 5 { 0.0 } else { plane.open() };
        if open >= 1.0 {
            return None;
        }
        let mut face = closed(index);
        if open < LEAST {
            return Some(face);
        }
        face.open = open;
        // The next node on the open side, along the axis where the distance grows most, and how much larger it is there.
        let k = usize::from(rise[1].abs() > rise[0].abs());
        let (axis, mut beyond) = (axes[k], node);
        beyond[axis] += if rise[k] > 0.0 { 1 } else { -1 };
        let nodes = &lattice.axes[axis];
        let gap = (nodes.place(beyond[axis]) - nodes.place(node[axis])).abs();
        let further = rise[k].abs() * gap / nodes.width(node[axis]);
        let next = self.fluid(beyond).filter(|_| further > 0.0);
        let whole = plane.above(0.0);
        if near.distance > 0.0 {
            // Linear from the wall to the node, and on to the next one.
            let own = mean.max(0.0);
            let rest = plane.above(own);
            let inner = if own > 1e-12 * further { (whole - rest) / own } else { open };
            let outer = next.map_or(0.0, |_| rest / further);
            face.terms[0].1 = inner - outer;
            face.terms[1] = (next.unwrap_or(index), outer);
        } else if let Some(next) = next {
            face.terms[1] = (next, whole / (mean + further).max(whole));
        }
        Some(face)
    }
}

/// A face whose flux is the wall's.
fn closed(index: usize) -> CutFace {
    CutFace { index, open: 0.0, constant: 0.0, terms: [(index, 0.0); 4] }
}

/// Adds what the curvature of the profile changes in a flux by straight pieces; `second` is the node after next on the open
/// `side`.
///
/// With t the distance from the wall in cells, a the open share, nodes at t₁ = a + ½ and t₂ = a + 3⁄2 and the second
/// difference u″ of the wall and these two, it is −u″ (t₀³/12 + 1/24) for a > ½ (t₀ = a − ½) and −u″ (t₁a²/4 − a³/6) else.
/// Faces that are wholly open carry the velocity of their middle, which is u″/24 less than their mean; so does the open
/// part here, or neighbouring faces would not agree.
fn bend(face: &mut CutFace, side: usize, second: usize) {
    let a = face.open;
    let (t0, t1, t2) = (a - 0.5, a + 0.5, a + 1.5);
    let pieces = if t0 > 0.0 { t0.powi(3) / 12.0 + 1.0 / 24.0 } else { t1 * a * a / 4.0 - a.powi(3) / 6.0 };
    // u″ = 2 (u₂/t₂ − u₁/t₁), relative to the wall.
    let share = -2.0 * (pieces + a / 24.0);
    face.terms[1 + side].1 -= share / t1;
    face.terms[3] = (second, share / t2);
}
