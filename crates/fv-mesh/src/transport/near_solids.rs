//! Convection near cells without fluid.
use super::log_slopes::LogSlopes;
use crate::across_stream::{Stream, across_stream, spared};
use crate::cell_gradients::{CellGradients, Linear};
use crate::convection::KAPPA;
use crate::least_squares::norm2;
use crate::neighbours::neighbour;
use crate::operators::Operators;
use crate::{CartesianGrid, Velocity};
use interfaces::{LawOfTheWall, LogSlope};

/// Faces of cells that are at most as many steps from one without fluid are near it.
const LAYERS: u8 = 8;
/// Centres nearer to the wall than this share of a cell are taken to be there.
pub(crate) const NEAREST: f64 = 0.3;

/// Convection through the faces near cells without fluid: φ_f = φ + s·(x_f − x) from the side that the flow comes
/// from, s the gradient by least squares over the cells with fluid around, and a third of that what is on the line to the other side (κ = 1/3, van Leer
/// 1985: third order where cells are alike); of one sign, and at most 2φ. Through a face of a cell without fluid comes what the
/// cell on its other side says: so a field that changes across a wall only is not changed by a flow along it, wherever the wall
/// lies on the grid.
///
/// What goes like 1/y at distance y from a wall changes too much from cell to cell for that. There φy is interpolated, and y:
/// u·∇φ = (1/y) u·∇(φy) − (φ/y) u·∇y.
#[derive(Clone, Debug)]
pub(super) struct NearSolids<const D: usize> {
    faces: Vec<Face>,
    cells: CellGradients<D>,
    /// Widths of the cells in that list.
    widths: Vec<[f64; D]>,
    carried: Vec<Linear<D>>,
    distances: Option<Distances<D>>,
    /// Of every cell in the list, how much of what changes across the stream is not to be damped; none if it is nothing anywhere.
    spared: Vec<f64>,
    streams: Vec<Stream<D>>,
}

/// Distances from walls, of which there is none nearer than [`NEAREST`].
#[derive(Clone, Debug)]
struct Distances<const D: usize> {
    dense: Vec<f64>,
    near: Vec<Linear<D>>,
    log_slopes: LogSlopes<D>,
}

/// A face, and the cells below and above it: their places in the list, and how far from their centres it is \[m\].
#[derive(Clone, Debug)]
struct Face {
    axis: usize,
    /// The cell above it, by its dense number, and its own storage index.
    above: usize,
    index: usize,
    area: f64,
    sides: [Option<(usize, f64)>; 2],
}

/// What the cells on both sides of a face say of the value on it differs.
struct Jump {
    /// Their places in the list.
    ends: [usize; 2],
    /// J of [`across_stream`].
    jump: f64,
    /// Between their centres \[m\].
    h: f64,
}

impl Face {
    /// None where there is fluid on one side only.
    fn jump<const D: usize>(&self, values: &[Linear<D>]) -> Option<Jump> {
        let [Some((low, below)), Some((high, above))] = self.sides else { return None };
        let [(u, s), (v, t)] = [low, high].map(|place| (values[place].0, values[place].1[self.axis]));
        // Of what is on the line between both they say the same.
        let jump = (1.0 - KAPPA) * (u - v + s * below + t * above);
        Some(Jump { ends: [low, high], jump, h: below + above })
    }
}

fn width<const D: usize>(grid: &CartesianGrid<D>, cell: usize) -> [f64; D] {
    let at = grid.cell(cell);
    std::array::from_fn(|a| grid.axis(a).width(at[a]))
}

/// How many steps cells are from one without fluid, up to one more than counts.
fn layers<const D: usize>(ops: &Operators<D>, dry: &[bool]) -> Vec<u8> {
    let mut layer: Vec<u8> = dry.iter().map(|&dry| if dry { 0 } else { u8::MAX }).collect();
    let mut front: Vec<usize> = (0..layer.len()).filter(|&c| dry[c]).collect();
    for step in 1..=LAYERS {
        let mut next = Vec::new();
        for &cell in &front {
            for (axis, up) in (0..D).flat_map(|a| [(a, false), (a, true)]) {
                if let Some(other) = neighbour(ops, ops.grid().cell(cell), axis, up)
                    && layer[other] == u8::MAX
                {
                    layer[other] = step;
                    next.push(other);
                }
            }
        }
        front = next;
    }
    layer
}

impl<const D: usize> NearSolids<D> {
    pub(super) fn new(ops: &Operators<D>, dry: &[bool]) -> Self {
        let grid = ops.grid();
        let layer = layers(ops, dry);
        let near = |cell: usize| (1..=LAYERS).contains(&layer[cell]);
        let mut new = Self {
            faces: Vec::new(),
            cells: CellGradients::new(dry.len()),
            widths: Vec::new(),
            carried: Vec::new(),
            distances: None,
            spared: Vec::new(),
            streams: Vec::new(),
        };
        for upper in 0..dry.len() {
            let at = grid.cell(upper);
            for axis in 0..D {
                let Some(lower) = neighbour(ops, at, axis, false) else { continue };
                if !near(lower) && !near(upper) {
                    continue;
                }
                let sides = [lower, upper].map(|cell| {
                    let width = grid.axis(axis).width(grid.cell(cell)[axis]);
                    (!dry[cell]).then(|| (new.cells.place(ops, dry, cell), 0.5 * width))
                });
                let across = (0..D).filter(|&b| b != axis).map(|b| grid.axis(b).width(at[b]));
                let (index, area) = (grid.place(at), across.product());
                new.faces.push(Face { axis, above: upper, index, area, sides });
            }
        }
        new.cells.close();
        new.widths = new.cells.cells().map(|cell| width(grid, cell)).collect();
        new
    }

    /// Axes of the faces, and the cells above them.
    pub(super) fn faces(&self) -> impl Iterator<Item = (usize, usize)> {
        self.faces.iter().map(|face| (face.axis, face.above))
    }

    /// Where a logarithmic layer seems too steep in this flow.
    pub(super) fn log_slopes(
        &mut self,
        grid: &CartesianGrid<D>,
        velocity: &Velocity<D>,
        distance: &[f64],
    ) -> &[LogSlope] {
        if self.distances.is_none() {
            self.distances = self.measure(grid, distance);
        }
        self.distances.as_mut().map_or(&[], |distances| distances.log_slopes.update(grid, velocity))
    }

    /// Distances have changed.
    pub(super) fn forget_distances(&mut self) {
        self.distances = None;
    }

    /// None where no walls are known of.
    fn measure(&self, grid: &CartesianGrid<D>, distance: &[f64]) -> Option<Distances<D>> {
        if self.cells.seen().any(|cell| !distance[cell].is_finite()) {
            return None;
        }
        let (mut dense, mut near) = (distance.to_vec(), Vec::new());
        self.cells.look(|c| distance[c], &mut near);
        let cells = || self.cells.cells().zip(&self.widths).zip(&near);
        let log_slopes =
            LogSlopes::new(grid, cells().map(|((cell, &width), &(y, slope))| (cell, width, y, slope)));
        for ((cell, width), (y, slope)) in cells() {
            let norm = norm2(slope).sqrt();
            let extent = match norm > 0.0 {
                true => (0..D).map(|a| slope[a].abs() / norm * width[a]).sum(),
                false => width[0],
            };
            dense[cell] = y.max(NEAREST * extent);
        }
        self.cells.look(|c| dense[c], &mut near);
        Some(Distances { dense, near, log_slopes })
    }

    /// Looks at k \[m²/s²\] of all cells in a fluid of viscosity `nu`: where half a cell is no higher than the buffer layer, what changes across the stream is not
    /// to be damped.
    pub(super) fn see_layers(&mut self, k: &[f64], nu: f64) {
        let y_plus = |(cell, width): (usize, &[f64; D])| {
            let half = 0.5 * width.iter().sum::<f64>() / D as f64;
            LawOfTheWall::friction_velocity(k[cell]) * half / nu
        };
        self.spared.clear();
        self.spared.extend(self.cells.cells().zip(&self.widths).map(y_plus).map(spared));
        if self.spared.iter().all(|share| *share == 0.0) {
            self.spared.clear();
        }
    }

    /// The streams in the cells, and what `carried` jumps by through them.
    fn see_streams(&mut self, velocity: &Velocity<D>, carried: &[Linear<D>]) {
        let grid = velocity.components[0].grid();
        let strides = grid.stride();
        self.streams.clear();
        self.streams.extend(self.cells.cells().zip(&self.spared).map(|(cell, &spared)| {
            let o = grid.place(grid.cell(cell));
            let mean = |a: usize| {
                let u = velocity.components[a].data();
                0.5 * (u[o] + u[o + strides[a]])
            };
            Stream::new(std::array::from_fn(mean), spared)
        }));
        for face in &self.faces {
            let Some(Jump { ends, jump, h }) = face.jump(carried) else { continue };
            ends.into_iter().for_each(|place| self.streams[place].add(face.axis, jump, h, 1.0));
        }
    }

    /// Adds to `out` what the faces bring to the cells \[m³/s φ\], less what upwind differences between cells with fluid bring.
    /// With `distance` φ goes like 1/y, y the distance of every cell from the nearest wall.
    pub(super) fn add(
        &mut self,
        velocity: &Velocity<D>,
        phi: &[f64],
        distance: Option<&[f64]>,
        out: &mut [f64],
    ) {
        if let (Some(distance), None) = (distance, &self.distances) {
            self.distances = self.measure(velocity.components[0].grid(), distance);
        }
        let mut carried = std::mem::take(&mut self.carried);
        let spares = distance.is_none() && !self.spared.is_empty();
        match self.distances.as_ref().filter(|_| distance.is_some()) {
            Some(y) => self.cells.look(|c| y.dense[c] * phi[c], &mut carried),
            None => self.cells.look(|c| phi[c], &mut carried),
        }
        if spares {
            self.see_streams(velocity, &carried);
        }
        let distances = self.distances.as_ref().filter(|_| distance.is_some());
        for face in &self.faces {
            let flux = face.area * velocity.components[face.axis].data()[face.index];
            let ends = if flux >= 0.0 { [0, 1] } else { [1, 0] };
            // Where the flow comes from, or else the other side.
            let Some(from) = ends.into_iter().find(|&end| face.sides[end].is_some()) else { continue };
            let on_face = |values: &[Linear<D>]| {
                face.sides[from].map_or([0.0; 2], |(place, gap)| {
                    let (value, slope) = &values[place];
                    let ahead = if from == 0 { gap } else { -gap } * slope[face.axis];
                    let more = match face.sides[1 - from] {
                        Some((other, far)) => {
                            let between = (values[other].0 - value) * gap / (gap + far);
                            ahead + KAPPA * (between - ahead)
                        }
                        None => ahead,
                    };
                    [*value, more]
                })
            };
            let [g, mut more] = on_face(&carried);
            if spares && let Some(Jump { ends, jump, h }) = face.jump(&carried) {
                let across = across_stream(face.axis, jump, h, ends.map(|place| &self.streams[place]));
                more -= if from == 0 { 0.5 * across } else { -0.5 * across };
            }
            // Nothing flows out that is not there.
            let g = g + more.clamp(-g.abs(), g.abs());
            let y = distances.map(|y| (&y.near, on_face(&y.near).iter().sum::<f64>()));
            for (end, side) in face.sides.iter().enumerate() {
                let Some((place, _)) = *side else { continue };
                let cell = self.cells.cell(place);
                let inflow = if end == 1 { flux } else { -flux };
                let brought = match y {
                    Some((near, y)) => {
                        let (own, _) = near[place];
                        ((g - carried[place].0) - phi[cell] * (y - own)) / own
                    }
                    None => g - phi[cell],
                };
                let upwind = match face.sides[1 - end] {
                    Some((other, _)) if inflow > 0.0 => phi[self.cells.cell(other)] - phi[cell],
                    _ => 0.0,
                };
                out[cell] += inflow * (brought - upwind);
            }
        }
        self.carried = carried;
    }
}
