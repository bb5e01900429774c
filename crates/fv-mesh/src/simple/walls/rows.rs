//! The momentum equation of control volumes beside walls.
use super::edges::{Edge, Kind, VolumeSide, WIDE};
use super::gradients::{Gradients, dot};
use super::nearest::{Pieces, away};
use super::openings::Openings;
use crate::across_stream::Stream;
use crate::linear::StencilMatrix;
use crate::metrics::Metrics;
use crate::momentum_matrix::MomentumEquations;
use crate::{CartesianGrid, Convection, Field};

/// One control volume: the halves of two cells, or all of one whose other face is shut.
pub(super) struct Row<const D: usize> {
    /// Dense number and storage index of its face.
    pub(super) cell: usize,
    pub(super) index: usize,
    /// 1/(open area · distance of the cells' centres) \[1/m³\]: the volume that the pressure gradient acts on.
    pub(super) inv_volume: f64,
    edges: Vec<Edge<D>>,
    slot: u32,
    /// The nearest piece of wall, of nodes whose face is open enough.
    piece: Option<usize>,
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
    /// Of the component's nodes that have a gradient, if they are looked at.
    pub(super) streams: Option<&'a [Stream<D>]>,
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

/// The piece of wall nearest to a node, if there is one near it.
fn nearest_piece<const D: usize>(
    openings: &Openings<D>,
    c: usize,
    index: usize,
    nearest: &Pieces,
) -> Option<usize> {
    let (grid, x) = (openings.grid, openings.node(c, index));
    let cells = [index, index - grid.stride()[c]];
    let pieces = cells.into_iter().filter_map(|o| {
        let cell = grid.cell_at(openings.wrap(o))?;
        nearest.get(&grid.index(cell)).copied()
    });
    pieces.min_by(|&p, &q| away(openings, x, p).total_cmp(&away(openings, x, q)))
}

impl<const D: usize> Row<D> {
    /// The row of a node if walls are near.
    pub(super) fn new(
        openings: &Openings<D>,
        c: usize,
        index: usize,
        pieces: &Pieces,
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
            let side = VolumeSide { openings, c, b, upper, index, inv_volume, nearest };
            side.add(kind(b, usize::from(upper)), gradients, &mut edges);
        }
        let cell = openings.grid.cell_at(index).map_or(0, |cell| openings.grid.index(cell));
        let wide = openings.open[c].data()[index] >= WIDE;
        let piece = if wide { nearest_piece(openings, c, index, pieces) } else { None };
        Some(Self { cell, index, inv_volume, edges, slot, piece })
    }

    /// Looks at the stream at the node; `resolved`: how well cells resolve the layer on every piece of wall.
    pub(super) fn see_stream(
        &self,
        c: usize,
        velocity: &[Field<D>; D],
        gradients: &Gradients<D>,
        resolved: &[f64],
        streams: &mut [Stream<D>],
    ) {
        let Some(spared) = self.piece.map(|piece| resolved[piece]).filter(|spared| *spared > 0.0) else {
            return;
        };
        let u = velocity[c].data();
        let here = u[self.index];
        let gradient = &gradients.values[self.slot as usize];
        let (mut through, mut area) = ([0.0; D], [0.0; D]);
        for edge in self.edges.iter().filter(|edge| edge.axis != c) {
            for &(o, a) in &edge.carriers {
                through[edge.axis] += a * velocity[edge.axis].data()[o];
                area[edge.axis] += a;
            }
        }
        let mean = |b: usize| if area[b] > 0.0 { through[b] / area[b] } else { 0.0 };
        let mut stream = Stream::new(std::array::from_fn(|b| if b == c { here } else { mean(b) }), spared);
        for edge in &self.edges {
            if let Kind::Cut(link) = &edge.kind {
                let b = edge.axis;
                let far = &gradients.values[link.other as usize];
                let jump = link.between.jump(b, [here, u[edge.other]], [gradient, far]);
                stream.add(b, jump, link.between.step[b].abs(), edge.area);
            }
        }
        streams[self.slot as usize] = stream;
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
                    let (u, g) = ([here, there], [gradient, far]);
                    let streams = flow.streams.map(|s| [self.slot, link.other].map(|slot| &s[slot as usize]));
                    let value = link.value(flow.scheme, b, out, u, g, streams);
                    let slope = link.slope(b, u, g);
                    let mut stress = total * slope;
                    if b != c && nu > 0.0 {
                        stress += nu * link.cross(edge, [c, b], flow);
                    }
                    sum += edge.conduct * link.between.step[b].abs() * sign * stress - out * value;
                    if flow.scheme.is_linear_upwind() {
                        sum -= sign * link.covariance(edge, [c, b], out * value, g, flow);
                    }
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

pub(super) fn coordinate<const D: usize>(grid: &CartesianGrid<D>, index: usize, a: usize) -> usize {
    super::openings::coordinates(grid, index)[a]
}
