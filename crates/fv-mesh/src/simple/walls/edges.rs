//! The edges of control volumes beside walls.
use super::gradients::Gradients;
use super::openings::Openings;
use super::rows::{Flow, coordinate};
use crate::across_stream::{Stream, across_stream};
use crate::between::Between;
use crate::{Convection, Field};

/// Faces with a smaller open share carry by first order: what is extrapolated from them would not settle (of walls along the grid that leave 0.1 to 0.11 of a cell
/// it did not, by realizable k–ε at y+ 17).
const SLIVER: f64 = 0.15;

/// What is left of faces with a smaller open share would not settle with more than values of second order, nor damped less across the stream than along it.
pub(super) const WIDE: f64 = 0.25;

/// A face of a control volume, or a part of one.
pub(super) struct Edge<const D: usize> {
    /// Its normal's axis, and whether it is the upper one.
    pub(super) axis: usize,
    pub(super) upper: bool,
    /// Storage index of the node across, and whether that is the next one along the axis.
    pub(super) other: usize,
    pub(super) next: bool,
    /// Storage index of the node above it, which numbers it.
    pub(super) number: usize,
    /// Open area over the volume \[1/m\].
    pub(super) area: f64,
    /// Nodes that carry and their part of the area, per volume.
    pub(super) carriers: [(usize, f64); 2],
    /// Open part of the area over the volume and the distance of the nodes \[1/m²\].
    pub(super) conduct: f64,
    pub(super) kind: Kind<D>,
}

pub(super) enum Kind<const D: usize> {
    /// No wall near: as everywhere else.
    Plain,
    /// On a side of the box, whose value is half way to the ghost.
    Side,
    /// No node in the fluid behind it.
    Blind { to_edge: [f64; D] },
    /// Between two nodes.
    Cut(Link<D>),
}

pub(super) struct Link<const D: usize> {
    pub(super) other: u32,
    pub(super) between: Between<D>,
    /// One of the nodes has next to no volume: what is carried is the upwind node's.
    pub(super) sliver: bool,
    /// How the carriers' velocity changes along the component's axis: their gradients and the step between them.
    pub(super) across: [Option<u32>; 2],
    carriers_step: [f64; D],
    /// Along the axes in its plane the variance of the places on its open part \[m²\]: 1/12 of its extent squared; 0 if less than [`WIDE`] of it, or of a node, is open.
    spread: [f64; D],
}

/// One side of a node's control volume: that of component `c` at `index`, its upper or lower side along `b`.
#[derive(Clone, Copy)]
pub(super) struct VolumeSide<'a, const D: usize> {
    pub(super) openings: &'a Openings<'a, D>,
    pub(super) c: usize,
    pub(super) b: usize,
    pub(super) upper: bool,
    pub(super) index: usize,
    pub(super) inv_volume: f64,
    pub(super) nearest: Option<f64>,
}

impl<const D: usize> VolumeSide<'_, D> {
    /// The node above it, which numbers it.
    fn number(&self) -> usize {
        if self.upper { self.index + self.openings.grid.stride()[self.b] } else { self.index }
    }

    /// The next node along `b`.
    fn next(&self, index: usize) -> usize {
        let s = self.openings.grid.stride()[self.b];
        if self.upper { index + s } else { index - s }
    }

    /// Adds the edges of the side. A cell is shared by the nodes of its two faces along `c`, and is all of the one's through whose face something
    /// passes if nothing passes the other: so whatever leaves one control volume comes into another.
    pub(super) fn add(
        self,
        kind: Option<Kind<D>>,
        gradients: &mut [Gradients<D>; D],
        edges: &mut Vec<Edge<D>>,
    ) {
        let Self { openings, c, b, index, .. } = self;
        let (s, number, next) = (openings.grid.stride(), self.number(), self.next(index));
        let area = |o: usize| 0.5 * openings.open[b].data()[o] * openings.area(b, o);
        let pair = if b == c { [number - s[b], number] } else { [number - s[c], number] };
        // The other face of either cell.
        let behind = |k: usize, o: usize| if k == 0 { o - s[c] } else { o + s[c] };
        let alone = |k: usize| b != c && !openings.alive(c, behind(k, index));
        let whole = [0, 1].map(|k| (pair[k], if alone(k) { 2.0 } else { 1.0 } * area(pair[k])));
        if kind.is_some() {
            edges.push(self.edge(next, whole, kind, gradients));
            return;
        }
        if b == c {
            if openings.alive(c, next) {
                edges.push(self.edge(next, whole, None, gradients));
            }
            return;
        }
        let mut main = pair.map(|face| (face, 0.0));
        for (k, face) in pair.into_iter().enumerate() {
            // Across the half beside the node, and across the other one.
            let halves = [next, behind(k, next)];
            for half in 0..if alone(k) { 2 } else { 1 } {
                let owner = [halves[half], halves[1 - half]].into_iter().find(|&o| openings.alive(c, o));
                match owner.unwrap_or(next) {
                    owner if owner == next => main[k].1 += area(face),
                    owner => {
                        let carriers = [(face, area(face)), (face, 0.0)];
                        edges.push(self.edge(owner, carriers, None, gradients));
                    }
                }
            }
        }
        if main[0].1 + main[1].1 > 0.0 {
            edges.push(self.edge(next, main, None, gradients));
        }
    }

    /// The edge to the node `other`, through these areas of faces.
    fn edge(
        &self,
        other: usize,
        carriers: [(usize, f64); 2],
        kind: Option<Kind<D>>,
        gradients: &mut [Gradients<D>; D],
    ) -> Edge<D> {
        let Self { openings, c, b, upper, index, inv_volume, nearest } = *self;
        let metrics = openings.metrics;
        let number = self.number();
        let at = openings.at(number);
        let open = carriers[0].1 + carriers[1].1;
        let gap = 1.0 / metrics.of(Some(c), b).inv_gap[at[b]];
        let mut edge = Edge {
            axis: b,
            upper,
            other,
            next: other == self.next(index),
            number,
            area: open * inv_volume,
            carriers: carriers.map(|(o, area)| (o, area * inv_volume)),
            conduct: open * inv_volume / gap,
            kind: Kind::Plain,
        };
        if let Some(kind) = kind {
            edge.kind = kind;
            return edge;
        }
        let pair = carriers.map(|(o, _)| o);
        let (x, middle) = (openings.node(c, index), middle(openings, [c, b], number, carriers));
        if !openings.alive(c, other) {
            edge.kind = Kind::Blind { to_edge: std::array::from_fn(|a| middle[a] - x[a]) };
            return edge;
        }
        let between = Between::new(x, openings.node(c, other), middle, b);
        edge.conduct = open * inv_volume / between.step[b].abs();
        let mut slot =
            |c: usize, o: usize| openings.alive(c, o).then(|| gradients[c].slot(openings, c, o, nearest));
        let [v, w] = [openings.node(b, pair[0]), openings.node(b, pair[1])];
        let whole = 0.5 * (openings.area(b, pair[0]) + openings.area(b, pair[1]));
        let extent = |t: usize| (open / whole).min(1.0) * metrics.of(Some(c), t).volume[at[t]];
        let least = [index, other].iter().map(|&o| openings.open[c].data()[o]).fold(open / whole, f64::min);
        let spread = |t: usize| if t == b || least < WIDE { 0.0 } else { extent(t).powi(2) / 12.0 };
        edge.kind = Kind::Cut(Link {
            other: slot(c, other).unwrap_or_default(),
            between,
            sliver: [index, other].iter().any(|&o| openings.open[c].data()[o] < SLIVER),
            across: if b == c {
                [None; 2]
            } else if pair[0] == pair[1] {
                [slot(b, pair[0]), None]
            } else {
                [slot(b, pair[0]), slot(b, pair[1])]
            },
            carriers_step: std::array::from_fn(|a| w[a] - v[a]),
            spread: std::array::from_fn(spread),
        });
        edge
    }
}

impl<const D: usize> Edge<D> {
    /// ν_t on the edge, linear between the cells around.
    pub(super) fn viscosity(&self, flow: &Flow<D>, [c, b]: [usize; 2]) -> f64 {
        let Some(eddy) = flow.eddy.map(Field::data) else { return 0.0 };
        let (k, s) = (self.number, flow.grid.stride());
        if b == c {
            return eddy[k - s[b]];
        }
        if let [(face, _), (other, _)] = self.carriers
            && face == other
        {
            return 0.5 * (eddy[face - s[b]] + eddy[face]);
        }
        let (j, m) = (coordinate(flow.grid, k, b), coordinate(flow.grid, k, c));
        let (along_b, along_c) = (&flow.metrics.axes[b].share, &flow.metrics.axes[c].share);
        let beside = |k: usize| along_c[1][m] * eddy[k - s[c]] + along_c[0][m] * eddy[k];
        along_b[1][j] * beside(k - s[b]) + along_b[0][j] * beside(k)
    }
}

/// Middle of the open part of an edge.
fn middle<const D: usize>(
    openings: &Openings<D>,
    [c, b]: [usize; 2],
    number: usize,
    carriers: [(usize, f64); 2],
) -> [f64; D] {
    let at = openings.at(number);
    let sum = carriers[0].1 + carriers[1].1;
    let weights = if sum > 0.0 { carriers.map(|(_, area)| area / sum) } else { [0.5; 2] };
    let places = carriers.map(|(o, _)| openings.node(b, o));
    let mut x: [f64; D] = std::array::from_fn(|a| weights[0] * places[0][a] + weights[1] * places[1][a]);
    if b == c {
        x[c] = openings.metrics.axes[c].centres.x[at[c] - 1];
    } else if carriers[0].0 != carriers[1].0 {
        let width = &openings.metrics.axes[c].width;
        let face = openings.metrics.axes[c].faces.x[at[c]];
        x[c] = face + 0.25 * (weights[1] * width[at[c]] - weights[0] * width[at[c] - 1]);
        x[b] = openings.metrics.axes[b].faces.x[at[b]];
    }
    x
}

impl<const D: usize> Link<D> {
    /// The velocity that is carried through the edge of axis `b`. The upwind part of linear schemes is that along the `streams`, if there are any; without it they
    /// are of third order, with [`covariance`](Self::covariance).
    pub(super) fn value(
        &self,
        scheme: Convection,
        b: usize,
        out: f64,
        u: [f64; 2],
        g: [&[f64; D]; 2],
        streams: Option<[&Stream<D>; 2]>,
    ) -> f64 {
        let upwind = usize::from(out < 0.0);
        if self.sliver {
            return u[upwind];
        }
        let across = match streams {
            Some(streams) if scheme.is_linear_upwind() => {
                across_stream(b, self.between.jump(b, u, g), self.between.step[b].abs(), streams)
            }
            _ => 0.0,
        };
        self.between.value(scheme, b, upwind, u, g, across)
    }

    /// What passes the edge upwards beside `product`, that of the mean velocities u_b and u_c, because both change along it \[m/s²\]: its area by
    /// Σ_t w_t²/12 ∂u_b/∂x_t ∂u_c/∂x_t over the axes t in its plane, w_t its extent; no more than a third of the product, which is what both share that grow linearly from 0 at the edge's end. With values of
    /// second order it is an error that carries momentum across a layer, from walls that rise along the stream to those that recede (docs/results.md, "First cells of any height").
    pub(super) fn covariance(
        &self,
        edge: &Edge<D>,
        [c, b]: [usize; 2],
        product: f64,
        g: [&[f64; D]; 2],
        flow: &Flow<D>,
    ) -> f64 {
        let carriers = || self.across.iter().flatten().map(|&slot| &flow.gradients[b].values[slot as usize]);
        let n = carriers().count().max(1) as f64;
        let change = |t: usize| {
            let carried = 0.5 * (g[0][t] + g[1][t]);
            let carries = match t {
                _ if b == c => carried,
                t if t == c => self.cross(edge, [c, b], flow),
                t => carriers().map(|g| g[t]).sum::<f64>() / n,
            };
            carries * carried
        };
        let sum: f64 = (0..D).filter(|&t| t != b).map(|t| self.spread[t] * change(t)).sum();
        let most = product.abs() / 3.0;
        (edge.area * sum).clamp(-most, most)
    }

    /// ∂u/∂x_b on the edge.
    pub(super) fn slope(&self, b: usize, u: [f64; 2], g: [&[f64; D]; 2]) -> f64 {
        directed(b, u, g, &self.between.step)
    }

    /// ∂u_b/∂x_c on the edge.
    pub(super) fn cross(&self, edge: &Edge<D>, [c, b]: [usize; 2], flow: &Flow<D>) -> f64 {
        let gradient = |slot: u32| &flow.gradients[b].values[slot as usize];
        match self.across {
            [Some(low), Some(high)] => {
                let u = edge.carriers.map(|(o, _)| flow.velocity[b].data()[o]);
                directed(c, u, [gradient(low), gradient(high)], &self.carriers_step)
            }
            [Some(one), None] | [None, Some(one)] => gradient(one)[c],
            _ => 0.0,
        }
    }
}

/// The derivative along `b` between two nodes that are not beside each other along it alone.
fn directed<const D: usize>(b: usize, u: [f64; 2], g: [&[f64; D]; 2], step: &[f64; D]) -> f64 {
    let aside: f64 = (0..D).filter(|&a| a != b).map(|a| 0.5 * (g[0][a] + g[1][a]) * step[a]).sum();
    (u[1] - u[0] - aside) / step[b]
}
