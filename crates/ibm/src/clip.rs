//! Solid shares of cells from a surface of triangles.
use crate::SolidNode;
use crate::projection::reached;
use interfaces::{Aabb, Lattice, Point, Polyhedron, Pose, Vector};
use nalgebra::Matrix3;
use pulp::{Arch, Simd, WithSimd};

/// Cuts closed surfaces of triangles up at the sides of cells; holds the memory that this takes.
///
/// By the divergence theorem the solid volume of a cell between x₀ and x₁ is, but for round-off,
///
/// ```text
/// V = ∫ (x − x₀) n_x dA + (x₁ − x₀) ∫ n_x dA
/// ```
///
/// the first over the surface within the cell, the second over that beyond it along x, between the same sides. So every triangle is
/// worked on by itself, and nothing has to be known of how they hang together. What two shells enclose counts twice, up to λ = 1.
#[derive(Clone, Debug, Default)]
pub(crate) struct Clipper {
    axes: [Cells; 3],
    corners: Vec<Corner>,
    /// Of every cell, and of what is beyond on all sides, x fastest: ∫ x n_x dA and ∫ n_x dA within.
    sums: Vec<[f64; 2]>,
}

/// The control volumes along one axis that a body may reach, from number 1; 0 is what lies below them, the last number what
/// lies above.
#[derive(Clone, Debug, Default)]
struct Cells {
    /// Their lower ends, from the centre of mass \[m\]; of number 0, any.
    lower: Vec<f64>,
    /// Their nodes, from there \[m\], and what these add to the storage index.
    nodes: Vec<(f64, usize)>,
    /// 1/width, where all are equal.
    per_width: Option<f64>,
}

/// A vertex and where it lies.
#[derive(Clone, Copy, Debug)]
struct Corner {
    place: Vector,
    /// Numbers of its cell along the axes, [`BITS`] bits each, x lowest.
    cell: u64,
}

const BITS: usize = 21;

/// A share that differs from 0 or 1 by less is round-off.
const ROUND_OFF: f64 = 1e-10;

impl Cells {
    fn set(&mut self, lattice: &Lattice, a: usize, span: [f64; 2], centre: f64) {
        let nodes = &lattice.axes[a];
        let range = reached(nodes, span);
        self.lower.clear();
        self.lower.push(nodes.edge(range.start) - centre);
        self.nodes.clear();
        for i in range.clone() {
            let Some(wrapped) = nodes.wrap(i) else { continue };
            self.lower.push(nodes.edge(i) - centre);
            self.nodes.push((nodes.place(i) - centre, wrapped * lattice.stride[a]));
        }
        self.lower.push(nodes.edge(range.end) - centre);
        self.per_width = nodes.is_uniform().then(|| 1.0 / nodes.mean_spacing());
    }

    /// How many.
    fn len(&self) -> usize {
        self.nodes.len()
    }

    fn width(&self, cell: usize) -> f64 {
        self.lower[cell + 1] - self.lower[cell]
    }

    /// In which of them `x` lies.
    #[inline(always)]
    fn locate(&self, x: f64) -> usize {
        let Some(per_width) = self.per_width else {
            return self.lower[1..].partition_point(|edge| *edge <= x);
        };
        let (number, last) = ((x - self.lower[0]) * per_width + 1.0, (self.lower.len() - 1) as f64);
        let number = if number > 0.0 { number } else { 0.0 };
        (if number < last { number } else { last }) as i32 as usize
    }
}

/// A triangle, and what cuts leave of it: two more corners per axis at most.
#[derive(Clone, Copy, Debug, Default)]
struct Polygon {
    corners: [Vector; 9],
    len: usize,
}

impl Polygon {
    #[inline(always)]
    fn push(&mut self, corner: Vector) {
        // Round-off can make a cut cross a side that it only touches: such a corner has no area.
        if let Some(slot) = self.corners.get_mut(self.len) {
            *slot = corner;
            self.len += 1;
        }
    }

    #[inline(always)]
    fn corners(&self) -> &[Vector] {
        &self.corners[..self.len]
    }
}

/// The parts of a polygon `below` and `above` a `plane` across `axis`.
#[inline(always)]
fn cut(corners: &[Vector], axis: usize, plane: f64, below: &mut Polygon, above: &mut Polygon) {
    (below.len, above.len) = (0, 0);
    let Some(mut last) = corners.last() else { return };
    let mut before = last[axis] - plane;
    for corner in corners {
        let here = corner[axis] - plane;
        if (here >= 0.0) != (before >= 0.0) {
            let mut crossing = last + (corner - last) * (before / (before - here));
            crossing[axis] = plane;
            below.push(crossing);
            above.push(crossing);
        }
        if here >= 0.0 {
            above.push(*corner)
        } else {
            below.push(*corner)
        }
        (last, before) = (corner, here);
    }
}

/// The parts at hand along one axis.
type Parts = [Polygon; 3];

/// Cells and what the surface in them sums to.
struct Sums<'a> {
    axes: &'a [Cells; 3],
    stride: [usize; 3],
    sums: &'a mut [[f64; 2]],
}

impl Sums<'_> {
    /// Gives the parts of a polygon to the cells along `AXIS`, and those below it, that it `crosses`; along the others it lies
    /// in `cell`.
    #[inline(always)]
    fn share_out<const AXIS: usize>(
        &mut self,
        corners: &[Vector],
        cell: usize,
        crosses: [bool; 3],
        parts: &mut [Parts],
    ) {
        let (along, stride) = (&self.axes[AXIS], self.stride[AXIS]);
        let Some(([below, rest, next], parts)) = parts.split_first_mut() else { return };
        let (mut low, mut high) = (0, 0);
        if crosses[AXIS] {
            low = usize::MAX;
            for corner in corners {
                let at = along.locate(corner[AXIS]);
                (low, high) = (low.min(at), high.max(at));
            }
        }
        let (mut left, [mut rest, mut next]) = (corners, [rest, next]);
        for i in low..=high {
            let part = if i < high {
                cut(left, AXIS, along.lower[i + 1], below, next);
                std::mem::swap(&mut rest, &mut next);
                left = rest.corners();
                below.corners()
            } else {
                left
            };
            if part.len() > 2 {
                let cell = cell + i * stride;
                match AXIS {
                    0 => self.add(part, cell),
                    1 => self.share_out::<0>(part, cell, crosses, parts),
                    _ => self.share_out::<1>(part, cell, crosses, parts),
                }
            }
        }
    }

    /// Adds a convex polygon that lies in one `cell`.
    #[inline(always)]
    fn add(&mut self, corners: &[Vector], cell: usize) {
        let first = corners[0];
        let [mut moment, mut flux] = self.sums[cell];
        for pair in corners[1..].windows(2) {
            let (u, v) = (pair[0] - first, pair[1] - first);
            let part = 0.5 * (u.y * v.z - u.z * v.y);
            moment += part * ((first.x + pair[0].x + pair[1].x) * (1.0 / 3.0));
            flux += part;
        }
        self.sums[cell] = [moment, flux];
    }
}

/// Turns all vertices and shares all faces out.
struct Clip<'a> {
    surface: Polyhedron<'a>,
    turn: Matrix3<f64>,
    corners: &'a mut Vec<Corner>,
    into: Sums<'a>,
}

impl WithSimd for Clip<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { surface, turn, corners, mut into } = self;
        let (axes, stride) = (into.axes, into.stride);
        corners.clear();
        corners.extend(surface.vertices.iter().map(|x: &Point| {
            let place = turn * x.coords;
            let at = |a: usize| (axes[a].locate(place[a]) as u64) << (a * BITS);
            Corner { place, cell: at(0) | at(1) | at(2) }
        }));
        let mut parts = [Parts::default(); 3];
        for face in surface.faces {
            let [a, b, c] = face.each_ref().map(|&v| &corners[v as usize]);
            let places = [a.place, b.place, c.place];
            let differ = (a.cell ^ b.cell) | (a.cell ^ c.cell);
            let number = |cell: u64, axis: usize| (cell >> (axis * BITS)) as usize & ((1 << BITS) - 1);
            let crosses = [0, 1, 2].map(|axis| number(differ, axis) != 0);
            let cell =
                (0..3).map(|axis| if crosses[axis] { 0 } else { stride[axis] * number(a.cell, axis) }).sum();
            if differ == 0 {
                into.add(&places, cell);
            } else {
                into.share_out::<2>(&places, cell, crosses, &mut parts);
            }
        }
    }
}

impl Clipper {
    /// Lists the nodes of a `lattice` in space that a body at `pose` within `bounds` covers at least in part.
    pub(crate) fn clip(
        &mut self,
        lattice: &Lattice,
        surface: Polyhedron<'_>,
        pose: Pose,
        bounds: Aabb,
        nodes: &mut Vec<SolidNode>,
    ) {
        for a in 0..3 {
            self.axes[a].set(lattice, a, [bounds.min[a], bounds.max[a]], pose.position[a]);
        }
        let lengths = [0, 1, 2].map(|a| self.axes[a].len());
        if lengths.contains(&0) {
            return;
        }
        debug_assert!(lengths.iter().all(|n| *n < (1 << BITS) - 2), "{lengths:?}");
        let room = lengths.iter().product();
        if nodes.capacity() < room {
            nodes.reserve(room + room / 4);
        }
        let stride = [1, lengths[0] + 2, (lengths[0] + 2) * (lengths[1] + 2)];
        self.sums.clear();
        self.sums.resize(stride[2] * (lengths[2] + 2), [0.0; 2]);
        let into = Sums { axes: &self.axes, stride, sums: &mut self.sums };
        let turn = *pose.orientation.to_rotation_matrix().matrix();
        Arch::new().dispatch(Clip { surface, turn, corners: &mut self.corners, into });
        self.collect(lattice.base, stride, nodes);
    }

    /// Makes shares of the sums, and nodes of them.
    fn collect(&mut self, base: usize, stride: [usize; 3], nodes: &mut Vec<SolidNode>) {
        let [along_x, along_y, along_z] = &self.axes;
        for (k, (z, offset_z)) in (1..).zip(&along_z.nodes) {
            for (j, (y, offset_y)) in (1..).zip(&along_y.nodes) {
                let row = &mut self.sums[stride[2] * k + stride[1] * j..][..stride[1]];
                let side = along_y.width(j) * along_z.width(k);
                let mut beyond = row[along_x.len() + 1][1];
                for i in (1..=along_x.len()).rev() {
                    let [moment, flux] = row[i];
                    let within = moment - along_x.lower[i] * flux;
                    row[i][0] = (within / along_x.width(i) + beyond) / side;
                    beyond += flux;
                }
                for (i, (x, offset_x)) in (1..).zip(&along_x.nodes) {
                    let share = row[i][0];
                    if share > ROUND_OFF {
                        nodes.push(SolidNode {
                            index: base + offset_x + offset_y + offset_z,
                            fraction: if share < 1.0 - ROUND_OFF { share } else { 1.0 },
                            arm: Vector::new(*x, *y, *z),
                            volume: along_x.width(i) * side,
                        });
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
