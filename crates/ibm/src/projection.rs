//! One body on one lattice.
use crate::clip::Clipper;
use crate::subcells::Cell;
use crate::{FractionRule, SolidNode, cell_fraction};
use interfaces::{Bodies, BodyId, Lattice, Nodes, Point, Rotation, Solid, Vector};
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// Nodes along an edge of a block, which one query may tell to be all solid or all fluid.
const BLOCK: usize = 4;

/// Projects bodies on lattices; holds the memory that this takes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Projector {
    columns: [Vec<Column>; 3],
    /// Signed distances in the body's box, x fastest.
    distances: Vec<f64>,
    points: Vec<Point>,
    /// Which of the distances were asked for.
    rows: Vec<Range<usize>>,
    answers: Vec<f64>,
    clipper: Clipper,
}

/// What all nodes with the same number along one axis share.
#[derive(Clone, Copy, Debug)]
struct Column {
    /// Place from the body's centre of mass \[m\].
    arm: f64,
    /// Width of the control volumes \[m\].
    width: f64,
    /// Share of the storage index; `None` outside the lattice.
    offset: Option<usize>,
    /// First and second difference of the values below, here and above.
    first: [f64; 3],
    second: [f64; 3],
}

/// Is the surface smooth here, as far as the square of the `gradient` of the distance tells, its differences taken
/// over neighbours h away? Across an edge it is the squared cosine of half the edge's angle; beside one, where a
/// neighbour along the surface is past it, above 1. On a sphere it is between 1 − ⅔(h/R)² and 1, so that
/// much is allowed for the curvature `bend`, if it is not that of an edge itself (R at least 2.9 h).
#[inline]
fn is_smooth(square: f64, bend: f64, h: f64) -> bool {
    let least = 1.0 - EDGE - 2.0 / 3.0 * (bend * h).powi(2).min(0.12);
    (least..1.0025).contains(&square)
}

/// 1 − cos² of half the angle of an edge that is not worth smaller cells: 11°.
const EDGE: f64 = 0.01;

impl Projector {
    /// Lists the nodes that body `b` covers at least in part; of all, or those of one layer: the axis along it and the number on it.
    pub(crate) fn project<B: Bodies + ?Sized>(
        &mut self,
        lattice: &Lattice,
        bodies: &B,
        b: BodyId,
        (rule, layer): (FractionRule, Option<(usize, usize)>),
        nodes: &mut Vec<SolidNode>,
    ) {
        nodes.clear();
        let (solid, pose, dim) = (bodies.solid(b), bodies.pose(b), lattice.dim);
        let bounds = bodies.aabb(b);
        if let (FractionRule::CutVolume, 3, Some(surface)) = (rule, dim, solid.polyhedron()) {
            let meets = |(a, number): (usize, usize)| {
                let nodes = &lattice.axes[a];
                reached(nodes, [bounds.min[a], bounds.max[a]]).any(|i| nodes.wrap(i) == Some(number))
            };
            if layer.is_none_or(meets) {
                self.clipper.clip(lattice, surface, pose, bounds, nodes);
                nodes.retain(|n| layer.is_none_or(|(a, number)| lattice.node(n.index)[a] == number as isize));
            }
            return;
        }
        for a in 0..3 {
            let span = [bounds.min[a], bounds.max[a]];
            let only = layer.filter(|layer| layer.0 == a).map(|layer| layer.1);
            columns(&mut self.columns[a], lattice, a, span, pose.position[a], only);
        }
        let shape = [0, 1, 2].map(|a| self.columns[a].len());
        if shape.contains(&0) {
            return;
        }
        let widest = [0, 1, 2].map(|a| self.columns[a].iter().fold(0.0, |m: f64, c| m.max(c.width)));
        let widest = Vector::from(widest).component_mul(&plane(dim));
        let to_body = pose.orientation.inverse();
        self.distances(solid, to_body, widest, dim);

        let room: usize = shape.iter().product();
        if nodes.capacity() < room {
            nodes.reserve(room + room / 4);
        }
        let Self { columns, distances, .. } = &*self;
        let reach = 0.5 * widest.norm();
        let base = lattice.base;
        Arch::new().dispatch(CutCells { base, solid, to_body, dim, reach, rule, columns, distances, nodes });
    }

    /// Fills in the distances: exact where a cut cell needs them, of the right sign and not less than half a diagonal (of the
    /// `widest` cell) elsewhere.
    fn distances(&mut self, solid: &dyn Solid, to_body: Rotation, widest: Vector, dim: usize) {
        // A cut cell's centre is within half a diagonal of the surface, its neighbours a cell further.
        let band = 1.01 * (0.5 * widest.norm() + widest.max());
        let turned = [Vector::x(), Vector::y(), Vector::z()].map(|e| to_body * e);
        let shape = [0, 1, 2].map(|a| self.columns[a].len());
        self.points.clear();
        self.distances.clear();
        self.distances.resize(shape.iter().product(), 0.0);
        // Cells of blocks farther away are not cut, nor are their neighbours' neighbours asked for.
        let far = 0.5 * (BLOCK - 1) as f64 * widest.norm() + band;
        let extent = solid.aabb().extent();
        let narrowest = if dim == 2 { extent.x.min(extent.y) } else { extent.min() };
        if far < 0.25 * narrowest {
            self.blocks(solid, turned, band, far);
            return;
        }
        // In a body not much wider all blocks are near the surface.
        let [columns_x, columns_y, columns_z] = &self.columns;
        for z in columns_z {
            for y in columns_y {
                let side = turned[1] * y.arm + turned[2] * z.arm;
                self.points.extend(columns_x.iter().map(|x| Point::from(side + turned[0] * x.arm)));
            }
        }
        solid.signed_distances(&self.points, band, &mut self.distances);
    }

    /// The same, block by block.
    fn blocks(&mut self, solid: &dyn Solid, turned: [Vector; 3], band: f64, far: f64) {
        let shape = [0, 1, 2].map(|a| self.columns[a].len());
        let blocks = shape.map(|n| n.div_ceil(BLOCK));
        let span = |a: usize, block: usize| block * BLOCK..((block + 1) * BLOCK).min(shape[a]);
        let columns = &self.columns;
        // Between a block's outermost nodes.
        let middle = |a: usize, block: usize| {
            let r = span(a, block);
            turned[a] * (0.5 * (columns[a][r.start].arm + columns[a][r.end - 1].arm))
        };
        let all = blocks.iter().product();
        for n in 0..all {
            let block = winding(n, blocks);
            self.points.push(Point::from(middle(0, block[0]) + middle(1, block[1]) + middle(2, block[2])));
        }
        self.answers.resize(all, 0.0);
        solid.signed_distances(&self.points, far, &mut self.answers);
        self.points.clear();
        self.rows.clear();
        let stride = [1, shape[0], shape[0] * shape[1]];
        for n in 0..all {
            let block = winding(n, blocks);
            let decided = self.answers[n].abs() >= far;
            let value = band.copysign(self.answers[n]);
            let along = span(0, block[0]);
            for k in span(2, block[2]) {
                for j in span(1, block[1]) {
                    let row = stride[1] * j + stride[2] * k;
                    if decided {
                        self.distances[row..][along.clone()].fill(value);
                        continue;
                    }
                    let side = turned[1] * columns[1][j].arm + turned[2] * columns[2][k].arm;
                    let points = columns[0][along.clone()].iter().map(|x| side + turned[0] * x.arm);
                    self.points.extend(points.map(Point::from));
                    self.rows.push(row + along.start..row + along.end);
                }
            }
        }
        self.answers.resize(self.points.len(), 0.0);
        solid.signed_distances(&self.points, band, &mut self.answers);
        let mut answers = self.answers.iter();
        for row in &self.rows {
            for (distance, answer) in self.distances[row.clone()].iter_mut().zip(&mut answers) {
                *distance = *answer;
            }
        }
    }
}

/// λ of the nodes in the body's box.
struct CutCells<'a> {
    base: usize,
    solid: &'a dyn Solid,
    to_body: Rotation,
    dim: usize,
    /// Half the diagonal of the widest cell.
    reach: f64,
    rule: FractionRule,
    columns: &'a [Vec<Column>; 3],
    distances: &'a [f64],
    nodes: &'a mut Vec<SolidNode>,
}

impl WithSimd for CutCells<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { base, solid, to_body, dim, reach, rule, columns, distances, nodes } = self;
        let shape = [0, 1, 2].map(|a| columns[a].len());
        let stride = [1, shape[0], shape[0] * shape[1]];
        let inner = |a: usize| if a < dim { 1..shape[a] - 1 } else { 0..1 };
        for k in inner(2) {
            for j in inner(1) {
                let (z, y) = (columns[2][k], columns[1][j]);
                let (Some(above), Some(beside)) = (z.offset, y.offset) else { continue };
                for i in inner(0) {
                    let x = columns[0][i];
                    let Some(along) = x.offset else { continue };
                    let at = i + stride[1] * j + stride[2] * k;
                    let distance = distances[at];
                    if distance >= reach {
                        continue;
                    }
                    let h = Vector::new(x.width, y.width, z.width).component_mul(&plane(dim));
                    let reach2 = 0.25 * h.norm_squared();
                    if distance > 0.0 && distance * distance >= reach2 {
                        continue;
                    }
                    let arm = Vector::new(x.arm, y.arm, z.arm);
                    let volume = x.width * y.width * z.width;
                    let mut fraction = 1.0;
                    if distance * distance < reach2 {
                        let (mut gradient, mut curvature) = (Vector::zeros(), 0.0);
                        for (a, column) in [x, y, z].into_iter().enumerate().take(dim) {
                            let s = stride[a];
                            let d = [distances[at - s], distance, distances[at + s]];
                            for m in 0..3 {
                                gradient[a] += column.first[m] * d[m];
                                curvature += column.second[m] * d[m];
                            }
                        }
                        let square = gradient.norm_squared();
                        let bend = curvature / (dim - 1) as f64;
                        let cut = if is_smooth(square, bend, h.max()) {
                            cell_fraction(distance, gradient / square.sqrt(), curvature, h)
                        } else {
                            Cell { solid, to_body, dim, centre: arm, edges: h }.solid_share()
                        };
                        fraction = rule.fraction(cut, distance, volume, dim);
                    }
                    if fraction > 0.0 {
                        let index = base + along + beside + above;
                        nodes.push(SolidNode { index, fraction, arm, volume });
                    }
                }
            }
        }
    }
}

/// The n-th block on a way on which each is next to the one before.
#[inline]
fn winding(n: usize, shape: [usize; 3]) -> [usize; 3] {
    let (row, layer) = (n / shape[0], n / (shape[0] * shape[1]));
    let turn = |i: usize, back: bool, n: usize| if back { n - 1 - i } else { i };
    [turn(n % shape[0], row % 2 == 1, shape[0]), turn(row % shape[1], layer % 2 == 1, shape[1]), layer]
}

/// Ones along the axes that a lattice of `dim` dimensions has.
#[inline]
fn plane(dim: usize) -> Vector {
    Vector::new(1.0, 1.0, if dim == 2 { 0.0 } else { 1.0 })
}

/// The nodes whose control volumes a body between the ends of `span` may reach; only those that carry an unknown where the axis is
/// bounded.
pub(crate) fn reached(nodes: &Nodes, span: [f64; 2]) -> Range<isize> {
    let (first, end) = (nodes.locate(span[0]).0, nodes.locate(span[1]).0 + 2);
    if nodes.is_periodic() { first..end } else { first.max(0)..end.min(nodes.len() as isize) }
}

/// The nodes along axis `a` that a body between `span` may cover, one more on both sides that it may
/// cut, and one more again for differences; if `only` one counts, what the differences there take.
fn columns(
    out: &mut Vec<Column>,
    lattice: &Lattice,
    a: usize,
    span: [f64; 2],
    centre: f64,
    only: Option<usize>,
) {
    out.clear();
    let nodes = &lattice.axes[a];
    if a >= lattice.dim {
        let arm = nodes.place(0) - centre;
        out.push(Column { arm, width: 1.0, offset: Some(0), first: [0.0; 3], second: [0.0; 3] });
        return;
    }
    let counts = |i: isize| nodes.wrap(i).filter(|&number| only.is_none_or(|only| only == number));
    let mut range = reached(nodes, span);
    while !range.is_empty() && counts(range.start).is_none() {
        range.start += 1;
    }
    while !range.is_empty() && counts(range.end - 1).is_none() {
        range.end -= 1;
    }
    if range.is_empty() {
        return;
    }
    for i in range.start - 1..range.end + 1 {
        let (x, below, above) = (nodes.place(i), nodes.place(i - 1), nodes.place(i + 1));
        let (m, p) = (x - below, above - x);
        out.push(Column {
            arm: x - centre,
            width: nodes.width(i),
            offset: if range.contains(&i) { counts(i).map(|i| i * lattice.stride[a]) } else { None },
            first: [-p / (m * (m + p)), (p - m) / (m * p), m / (p * (m + p))],
            second: [2.0 / (m * (m + p)), -2.0 / (m * p), 2.0 / (p * (m + p))],
        });
    }
}
