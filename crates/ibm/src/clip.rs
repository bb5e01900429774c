//! Solid shares of cells from a surface of triangles.
use crate::SolidNode;
use interfaces::{Aabb, Lattice, Point, Polyhedron, Pose, Vector};

/// Cuts closed surfaces of triangles up at the sides of cells; holds the memory that this takes.
///
/// By the divergence theorem the solid volume of a cell between x₀ and x₁ is, but for round-off,
///
/// ```text
/// V = ∫ (x − x₀) n_x dA + (x₁ − x₀) ∫ n_x dA
/// ```
///
/// the first over the surface within the cell, the second over that beyond it along x, between the same sides. So every triangle is
/// worked on by itself, and nothing has to be known of how they hang together.
#[derive(Clone, Debug, Default)]
pub(crate) struct Clipper {
    axes: [Cells; 3],
    corners: Vec<Corner>,
    /// Of every cell, x fastest, and of what is beyond the last one of each row: ∫ (x − x₀) n_x dA and ∫ n_x dA within. The
    /// first becomes λ.
    sums: Vec<[f64; 2]>,
}

/// The control volumes along one axis that a body may reach.
#[derive(Clone, Debug, Default)]
struct Cells {
    /// Their sides, from the centre of mass \[m\].
    edges: Vec<f64>,
    /// Their nodes, from there \[m\], and what these add to the storage index.
    nodes: Vec<(f64, usize)>,
    /// 1/width, where all are equal.
    per_width: Option<f64>,
}

/// A vertex and the cell it lies in.
#[derive(Clone, Copy, Debug)]
struct Corner {
    place: Vector,
    cell: [isize; 3],
}

/// A share that differs from 0 or 1 by less is round-off.
const ROUND_OFF: f64 = 1e-10;

impl Cells {
    fn set(&mut self, lattice: &Lattice, a: usize, span: [f64; 2], centre: f64) {
        self.edges.clear();
        self.nodes.clear();
        let nodes = &lattice.axes[a];
        let (mut first, mut last) = (nodes.locate(span[0]).0, nodes.locate(span[1]).0 + 1);
        if !nodes.is_periodic() {
            (first, last) = (first.max(0), last.min(nodes.len() as isize - 1));
        }
        for i in first..=last {
            let Some(wrapped) = nodes.wrap(i) else { continue };
            self.edges.push(nodes.edge(i) - centre);
            self.nodes.push((nodes.place(i) - centre, wrapped * lattice.stride[a]));
        }
        self.edges.push(nodes.edge(last + 1) - centre);
        self.per_width = nodes.is_uniform().then(|| 1.0 / nodes.mean_spacing());
    }

    /// How many.
    fn len(&self) -> usize {
        self.nodes.len()
    }

    /// In which of them `x` lies: −1 before the first, their number beyond the last.
    #[inline(always)]
    fn locate(&self, x: f64) -> isize {
        match self.per_width {
            Some(per_width) => (((x - self.edges[0]) * per_width).floor() as isize).clamp(-1, self.len() as isize),
            None => self.edges.partition_point(|edge| *edge <= x) as isize - 1,
        }
    }
}

/// A triangle, and what cuts leave of it: two more corners per axis at most.
#[derive(Clone, Copy)]
struct Polygon {
    corners: [Vector; 9],
    len: usize,
}

impl Polygon {
    const NONE: Self = Self { corners: [Vector::new(0.0, 0.0, 0.0); 9], len: 0 };

    fn new(corners: [Vector; 3]) -> Self {
        let mut polygon = Self::NONE;
        corners.into_iter().for_each(|corner| polygon.push(corner));
        polygon
    }

    fn push(&mut self, corner: Vector) {
        // Round-off can make a cut cross a side that it only touches: such a corner has no area.
        if let Some(slot) = self.corners.get_mut(self.len) {
            *slot = corner;
            self.len += 1;
        }
    }

    fn corners(&self) -> &[Vector] {
        &self.corners[..self.len]
    }

    /// The parts below and above a `plane` across `axis`.
    fn cut(&self, axis: usize, plane: f64) -> [Self; 2] {
        let mut parts = [Self::NONE; 2];
        let Some(mut last) = self.corners().last() else { return parts };
        for corner in self.corners() {
            let (before, here) = (last[axis] - plane, corner[axis] - plane);
            let above = usize::from(here >= 0.0);
            if above != usize::from(before >= 0.0) {
                let mut crossing = last + (corner - last) * (before / (before - here));
                crossing[axis] = plane;
                parts.iter_mut().for_each(|part| part.push(crossing));
            }
            parts[above].push(*corner);
            last = corner;
        }
        parts
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
        let [nx, ny, nz] = [0, 1, 2].map(|a| self.axes[a].len());
        if nx * ny * nz == 0 {
            return;
        }
        self.sums.clear();
        self.sums.resize((nx + 1) * ny * nz, [0.0; 2]);
        self.corners.clear();
        let (axes, turn) = (&self.axes, pose.orientation.to_rotation_matrix());
        self.corners.extend(surface.vertices.iter().map(|x: &Point| {
            let place = turn * x.coords;
            Corner { place, cell: std::array::from_fn(|a| axes[a].locate(place[a])) }
        }));
        for face in surface.faces {
            let [a, b, c] = face.map(|v| self.corners[v as usize]);
            if a.cell == b.cell && b.cell == c.cell {
                self.add(&[a.place, b.place, c.place], a.cell);
            } else {
                self.share_out(Polygon::new([a.place, b.place, c.place]), 2, [0; 3]);
            }
        }
        self.collect(lattice.base, nodes);
    }

    /// Gives the parts of a polygon to the cells along `axis` and those below it; along the axes above it lies in `cell`.
    fn share_out(&mut self, polygon: Polygon, axis: usize, mut cell: [isize; 3]) {
        let (mut low, mut high) = (isize::MAX, isize::MIN);
        for corner in polygon.corners() {
            let at = self.axes[axis].locate(corner[axis]);
            (low, high) = (low.min(at), high.max(at));
        }
        let mut rest = polygon;
        for i in low..=high {
            let mut part = rest;
            if i < high {
                [part, rest] = rest.cut(axis, self.axes[axis].edges[(i + 1) as usize]);
            }
            cell[axis] = i;
            if part.len < 3 || (axis > 0 && !(0..self.axes[axis].len() as isize).contains(&i)) {
                continue;
            }
            if axis == 0 { self.add(part.corners(), cell) } else { self.share_out(part, axis - 1, cell) }
        }
    }

    /// Adds a convex polygon that lies in one `cell`.
    #[inline]
    fn add(&mut self, corners: &[Vector], cell: [isize; 3]) {
        let [nx, ny, nz] = [0, 1, 2].map(|a| self.axes[a].len());
        let [Ok(i), Ok(j), Ok(k)] = cell.map(usize::try_from) else { return };
        if i > nx || j >= ny || k >= nz {
            return;
        }
        let side = self.axes[0].edges[i];
        let sums = &mut self.sums[i + (nx + 1) * (j + ny * k)];
        let first = corners[0];
        for pair in corners[1..].windows(2) {
            let (u, v) = (pair[0] - first, pair[1] - first);
            let flux = 0.5 * (u.y * v.z - u.z * v.y);
            sums[0] += flux * ((first.x + pair[0].x + pair[1].x) / 3.0 - side);
            sums[1] += flux;
        }
    }

    /// Makes shares of the sums, and nodes of them.
    fn collect(&mut self, base: usize, nodes: &mut Vec<SolidNode>) {
        let [along_x, along_y, along_z] = &self.axes;
        let width = |cells: &Cells, i: usize| cells.edges[i + 1] - cells.edges[i];
        let rows = self.sums.chunks_exact_mut(along_x.len() + 1);
        for (row, sums) in rows.enumerate() {
            let (j, k) = (row % along_y.len(), row / along_y.len());
            let side = width(along_y, j) * width(along_z, k);
            let mut beyond = sums[along_x.len()][1];
            for i in (0..along_x.len()).rev() {
                let width = width(along_x, i);
                let [within, flux] = sums[i];
                sums[i][0] = (within + beyond * width) / (width * side);
                beyond += flux;
            }
            let ((y, offset_y), (z, offset_z)) = (along_y.nodes[j], along_z.nodes[k]);
            for (i, ([share, _], (x, offset_x))) in sums.iter().zip(&along_x.nodes).enumerate() {
                if *share > ROUND_OFF {
                    nodes.push(SolidNode {
                        index: base + offset_x + offset_y + offset_z,
                        fraction: if *share < 1.0 - ROUND_OFF { *share } else { 1.0 },
                        arm: Vector::new(*x, y, z),
                        volume: width(along_x, i) * side,
                    });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
