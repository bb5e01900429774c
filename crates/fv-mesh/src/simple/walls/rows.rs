//! The momentum equation of control volumes beside walls.
use super::gradients::{Gradients, dot};
use super::openings::Openings;
use crate::linear::StencilMatrix;
use crate::metrics::Metrics;
use crate::momentum_matrix::MomentumEquations;
use crate::{CartesianGrid, Convection, Field};

/// Faces with a smaller open share carry by first order: what is extrapolated from them would not settle.
const SLIVER: f64 = 0.1;

/// One control volume: the halves of two cells.
pub(super) struct Row<const D: usize> {
    /// Dense number and storage index of its face.
    pub(super) cell: usize,
    pub(super) index: usize,
    /// 1/(open area · distance of the cells' centres) \[1/m³\]: the volume that the pressure gradient acts on.
    pub(super) inv_volume: f64,
    edges: Vec<Edge<D>>,
    slot: u32,
}

/// A face of a control volume, or a part of one.
struct Edge<const D: usize> {
    /// Its normal's axis, and whether it is the upper one.
    axis: usize,
    upper: bool,
    /// Storage index of the node across, and whether that is the next one along the axis.
    other: usize,
    next: bool,
    /// Storage index of the node above it, which numbers it.
    number: usize,
    /// Open area over the volume \[1/m\].
    area: f64,
    /// Nodes that carry and their part of the area, per volume.
    carriers: [(usize, f64); 2],
    /// Open part of the area over the volume and the distance of the nodes \[1/m²\].
    conduct: f64,
    kind: Kind<D>,
}

enum Kind<const D: usize> {
    /// No wall near: as everywhere else.
    Plain,
    /// On a side of the box, whose value is half way to the ghost.
    Side,
    /// No node in the fluid behind it.
    Blind { to_edge: [f64; D] },
    /// Between two nodes.
    Cut(Link<D>),
}

struct Link<const D: usize> {
    other: u32,
    /// From this node, and from the other one, to the middle of the edge; to the other one.
    to_edge: [f64; D],
    from_other: [f64; D],
    step: [f64; D],
    /// Where between the nodes, as a share of the step along the axis.
    share: f64,
    /// One of the nodes has next to no volume: what is carried is the upwind node's.
    sliver: bool,
    /// How the carriers' velocity changes along the component's axis: their gradients and the step between them.
    across: [Option<u32>; 2],
    between: [f64; D],
}

/// What the rows of a component are computed with.
#[derive(Clone, Copy)]
pub(super) struct Flow<'a, const D: usize> {
    pub(super) grid: &'a CartesianGrid<D>,
    pub(super) metrics: &'a Metrics<D>,
    pub(super) velocity: &'a [Field<D>; D],
    pub(super) eddy: Option<&'a Field<D>>,
    pub(super) scheme: Convection,
    pub(super) viscosity: f64,
    pub(super) equations: &'a MomentumEquations<D>,
    pub(super) gradients: &'a [Gradients<D>; D],
}

/// Does an edge of component `c`, below node `number` along `b`, touch nothing but open faces and cells in the fluid?
fn is_plain<const D: usize>(openings: &Openings<D>, [c, b]: [usize; 2], number: usize) -> bool {
    let s = openings.grid.stride();
    let full = |c: usize, index: usize| openings.full(c, index);
    let nodes = [number - 2 * s[b], number - s[b], number, number + s[b]];
    let cells = if b == c {
        [number - s[b]; 4]
    } else {
        [number, number - s[b], number - s[c], number - s[b] - s[c]]
    };
    // Nodes of component `c` beside the control volumes on either side.
    let beside = [number, number - s[b]].into_iter().flat_map(|o| [o - s[c], o + s[c]]);
    nodes.iter().all(|&o| full(c, o))
        && beside.into_iter().all(|o| openings.alive(c, o))
        && (b == c || is_whole(openings, [c, b], number))
        && cells.iter().all(|&o| openings.wet[o] && !openings.near[o])
}

/// Are both faces that carry through the edge wholly open?
fn is_whole<const D: usize>(openings: &Openings<D>, [c, b]: [usize; 2], number: usize) -> bool {
    openings.full(b, number) && openings.full(b, number - openings.grid.stride()[c])
}

/// Is the edge on a side of the box?
fn is_side<const D: usize>(openings: &Openings<D>, [c, b]: [usize; 2], number: usize) -> bool {
    let i = openings.at(number)[b];
    let n = openings.grid.cells()[b];
    let first = crate::grid::GHOSTS;
    b != c && !openings.metrics.periodic[b] && (i == first || i == first + n)
}

impl<const D: usize> Row<D> {
    /// The row of a node if walls are near.
    pub(super) fn new(
        openings: &Openings<D>,
        c: usize,
        index: usize,
        nearest: Option<f64>,
        gradients: &mut [Gradients<D>; D],
    ) -> Option<Self> {
        let s = openings.grid.stride();
        let number = |b: usize, upper: usize| index + upper * s[b];
        let kind = |b: usize, upper: usize| {
            let edge = [c, b];
            match number(b, upper) {
                number if is_side(openings, edge, number) => Some(Kind::Side),
                number => is_plain(openings, edge, number).then_some(Kind::Plain),
            }
        };
        let whole = |b: usize, upper: usize| match kind(b, upper) {
            Some(Kind::Side) => is_whole(openings, [c, b], number(b, upper)),
            kind => kind.is_some(),
        };
        let walled = [index, index - s[c]].into_iter().any(|cell| openings.piece(cell).is_some());
        if openings.full(c, index) && !walled && (0..D).all(|b| whole(b, 0) && whole(b, 1)) {
            return None;
        }
        let at = openings.at(index);
        let gap = openings.metrics.axes[c].faces.volume[at[c]];
        let inv_volume = 1.0 / (openings.open[c].data()[index] * openings.area(c, index) * gap);
        let slot = gradients[c].slot(openings, c, index, nearest);
        let mut edges = Vec::with_capacity(2 * D);
        for (b, upper) in (0..D).flat_map(|b| [(b, false), (b, true)]) {
            let kind = kind(b, usize::from(upper));
            Edge::add(openings, [c, b], upper, index, inv_volume, kind, nearest, gradients, &mut edges);
        }
        let cell = openings.grid.cell_at(index).map_or(0, |cell| openings.grid.index(cell));
        Some(Self { cell, index, inv_volume, edges, slot })
    }

    /// Writes the row but for the wall's stress; gives −∇·(u u_c) + viscous terms and the rate at which the flow passes by.
    pub(super) fn write(
        &self,
        c: usize,
        flow: &Flow<D>,
        viscous_share: f64,
        matrix: &mut StencilMatrix<D>,
    ) -> [f64; 2] {
        let u = flow.velocity[c].data();
        let here = u[self.index];
        let gradient = &flow.gradients[c].values[self.slot as usize];
        let (centre, mut lower, mut upper) = matrix.parts_mut();
        centre[self.cell] = 0.0;
        let (mut sum, mut rate) = (0.0, 0.0);
        for b in 0..D {
            lower[b][self.cell] = 0.0;
            upper[b][self.cell] = 0.0;
        }
        for edge in &self.edges {
            let (b, there) = (edge.axis, u[edge.other]);
            let sign = if edge.upper { 1.0 } else { -1.0 };
            // What leaves through the edge.
            let out = sign * edge.carriers.iter().map(|&(o, a)| a * flow.velocity[b].data()[o]).sum::<f64>();
            let nu = edge.viscosity(flow, [c, b]);
            let total = flow.viscosity + if b == c { 2.0 * nu } else { nu };
            rate += 0.5 * out.abs();
            match &edge.kind {
                Kind::Plain | Kind::Side => {
                    let (j, i) =
                        (coordinate(flow.grid, edge.number, b), coordinate(flow.grid, edge.number, c));
                    let [carried, slope] =
                        flow.equations.edge_flux(flow.velocity, [c, b], edge.number, [i, j]);
                    let mut stress = total * slope;
                    if b != c && nu > 0.0 {
                        let v = flow.velocity[b].data();
                        stress += nu
                            * flow.metrics.axes[c].faces.inv_volume[i]
                            * (v[edge.number] - v[edge.number - flow.grid.stride()[c]]);
                    }
                    sum += sign * edge.area * stress;
                    sum -= match edge.kind {
                        Kind::Side => 0.5 * out * (here + there),
                        _ => sign * edge.area * carried,
                    };
                }
                Kind::Blind { to_edge } => {
                    sum -= out * (here + dot(gradient, to_edge));
                    continue;
                }
                Kind::Cut(link) => {
                    let far = &flow.gradients[c].values[link.other as usize];
                    let value = link.value(flow.scheme, out, [here, there], [gradient, far]);
                    let slope = link.slope(b, [here, there], [gradient, far]);
                    let mut stress = total * slope;
                    if b != c && nu > 0.0 {
                        stress += nu * link.cross(edge, [c, b], flow);
                    }
                    sum += edge.conduct * link.step[b].abs() * sign * stress - out * value;
                }
            }
            let coefficient = total * edge.conduct + (-out).max(0.0);
            centre[self.cell] += coefficient;
            rate += viscous_share * total * edge.conduct;
            if edge.next {
                let list = if edge.upper { &mut upper[b] } else { &mut lower[b] };
                list[self.cell] = -coefficient;
            }
        }
        [sum, rate]
    }
}

impl<const D: usize> Edge<D> {
    /// The edges of a node's control volume on one side along `b`. Where no node is across, what it would have is that of the node on the other side
    /// of its cell.
    fn add(
        openings: &Openings<D>,
        [c, b]: [usize; 2],
        upper: bool,
        index: usize,
        inv_volume: f64,
        kind: Option<Kind<D>>,
        nearest: Option<f64>,
        gradients: &mut [Gradients<D>; D],
        edges: &mut Vec<Self>,
    ) {
        let s = openings.grid.stride();
        let number = if upper { index + s[b] } else { index };
        let across = |o: usize| if upper { o + s[b] } else { o - s[b] };
        let next = across(index);
        let area = |o: usize| 0.5 * openings.open[b].data()[o] * openings.area(b, o);
        let pair = if b == c { [number - s[b], number] } else { [number - s[c], number] };
        // The other face of either cell that the control volume has a part of: where nothing passes it, that is all of the cell.
        let behind = |k: usize, o: usize| if k == 0 { o - s[c] } else { o + s[c] };
        let alone = |k: usize| b != c && !openings.alive(c, behind(k, index));
        let whole = [0, 1].map(|k| (pair[k], if alone(k) { 2.0 } else { 1.0 } * area(pair[k])));
        let mut add = |other: usize, carriers: [(usize, f64); 2], kind: Option<Kind<D>>| {
            let edge = Self::new(
                openings,
                [c, b],
                upper,
                [index, other],
                carriers,
                inv_volume,
                kind,
                nearest,
                gradients,
            );
            edges.push(edge);
        };
        if kind.is_some() {
            add(next, whole, kind);
            return;
        }
        if b == c {
            if openings.alive(c, next) {
                add(next, whole, None);
            }
            return;
        }
        let mut main = [(pair[0], 0.0), (pair[1], 0.0)];
        for (k, face) in pair.into_iter().enumerate() {
            // Across the half beside the node, and across the other one.
            let halves = [next, behind(k, next)];
            for half in 0..if alone(k) { 2 } else { 1 } {
                let owner = [halves[half], halves[1 - half]].into_iter().find(|&o| openings.alive(c, o));
                match owner.unwrap_or(next) {
                    owner if owner == next => main[k].1 += area(face),
                    owner => add(owner, [(face, area(face)), (face, 0.0)], None),
                }
            }
        }
        if main[0].1 + main[1].1 > 0.0 {
            add(next, main, None);
        }
    }

    fn new(
        openings: &Openings<D>,
        [c, b]: [usize; 2],
        upper: bool,
        [index, other]: [usize; 2],
        carriers: [(usize, f64); 2],
        inv_volume: f64,
        kind: Option<Kind<D>>,
        nearest: Option<f64>,
        gradients: &mut [Gradients<D>; D],
    ) -> Self {
        let Openings { grid, metrics, .. } = openings;
        let s = grid.stride();
        let number = if upper { index + s[b] } else { index };
        let next = other == if upper { number } else { index - s[b] };
        let at = openings.at(number);
        let open = carriers[0].1 + carriers[1].1;
        let gap = 1.0 / metrics.of(Some(c), b).inv_gap[at[b]];
        let mut edge = Self {
            axis: b,
            upper,
            other,
            next,
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
        let to_edge = std::array::from_fn(|a| middle[a] - x[a]);
        if !openings.alive(c, other) {
            edge.kind = Kind::Blind { to_edge };
            return edge;
        }
        let y = openings.node(c, other);
        let step: [f64; D] = std::array::from_fn(|a| y[a] - x[a]);
        edge.conduct = open * inv_volume / step[b].abs();
        let mut slot =
            |c: usize, o: usize| openings.alive(c, o).then(|| gradients[c].slot(openings, c, o, nearest));
        let [v, w] = [openings.node(b, pair[0]), openings.node(b, pair[1])];
        edge.kind = Kind::Cut(Link {
            other: slot(c, other).unwrap_or_default(),
            to_edge,
            from_other: std::array::from_fn(|a| middle[a] - y[a]),
            step,
            share: (to_edge[b] / step[b]).clamp(0.0, 1.0),
            sliver: [index, other].iter().any(|&o| openings.open[c].data()[o] < SLIVER),
            across: if b == c {
                [None; 2]
            } else if pair[0] == pair[1] {
                [slot(b, pair[0]), None]
            } else {
                [slot(b, pair[0]), slot(b, pair[1])]
            },
            between: std::array::from_fn(|a| w[a] - v[a]),
        });
        edge
    }

    /// ν_t on the edge, linear between the cells around.
    fn viscosity(&self, flow: &Flow<D>, [c, b]: [usize; 2]) -> f64 {
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
    /// The velocity that is carried through the edge.
    fn value(&self, scheme: Convection, out: f64, u: [f64; 2], g: [&[f64; D]; 2]) -> f64 {
        let linear = |k: usize| u[k] + dot(g[k], if k == 0 { &self.to_edge } else { &self.from_other });
        let upwind = usize::from(out < 0.0);
        let mean = || {
            let side: [f64; D] = std::array::from_fn(|a| self.to_edge[a] - self.share * self.step[a]);
            u[0] + self.share * (u[1] - u[0]) + 0.5 * (dot(g[0], &side) + dot(g[1], &side))
        };
        match scheme {
            _ if self.sliver => u[upwind],
            Convection::Upwind => u[upwind],
            Convection::LinearUpwind => linear(upwind),
            Convection::Central => mean(),
            Convection::Quick | Convection::Limited => 0.5 * (mean() + linear(upwind)),
        }
    }

    /// ∂u/∂x_b on the edge.
    fn slope(&self, b: usize, u: [f64; 2], g: [&[f64; D]; 2]) -> f64 {
        directed(b, u, g, &self.step)
    }

    /// ∂u_b/∂x_c on the edge.
    fn cross(&self, edge: &Edge<D>, [c, b]: [usize; 2], flow: &Flow<D>) -> f64 {
        let gradient = |slot: u32| &flow.gradients[b].values[slot as usize];
        match self.across {
            [Some(low), Some(high)] => {
                let u = edge.carriers.map(|(o, _)| flow.velocity[b].data()[o]);
                directed(c, u, [gradient(low), gradient(high)], &self.between)
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

fn coordinate<const D: usize>(grid: &CartesianGrid<D>, index: usize, a: usize) -> usize {
    super::openings::coordinates(grid, index)[a]
}
