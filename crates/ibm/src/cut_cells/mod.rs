//! Walls at rest that leave a part of the cells to the fluid.
mod face;

use crate::IbmError;
use crate::cut_link::distances::{Distances, Near, ON};
use crate::cut_link::resolution;
use face::Open;
use interfaces::{Bodies, BodyId, CutCells, OpenFace, Point, Vector, VelocityField, WallPiece};

/// Vertices nearer to a surface than this share of the narrowest spacing are on it, as other places are within [`ON`]: walls along the lines of the grid leave no slivers.
const SLIVER: f64 = 0.01;
/// Faces and walls below this share of a face are none.
const LEAST: f64 = 1e-6;

/// Which part of every face of a staggered grid bodies at rest leave open, and which wall every cell has: see [`CutCells`].
///
/// In the plane the open part of an edge is found to round-off from the distances, in space that of the surface that is linear
/// on each of the four triangles between the corners and the centre of a face: exact for plane walls, of second order for others.
/// A cell that only one face leads to lets nothing pass: that face is closed. Vertices nearer to a surface than a hundredth of the narrowest
/// spacing are on it, so walls along the grid leave no slivers, whose balances would not settle; the walls stay where they are
/// ([`WallPiece::foot`]), and a duct of n cells across lacks at most 0.02/n of its area.
///
/// # Errors
/// [`IbmError::Lost`] and [`IbmError::TooLarge`]; [`IbmError::Outside`] and [`IbmError::Unseen`] for a body without a corner of a
/// cell inside; [`IbmError::Thin`] for a body that leaks. Thin parts of other bodies are in [`CutCells::thin`].
pub fn cut_cells<B: Bodies + ?Sized>(velocity: &dyn VelocityField, bodies: &B) -> Result<CutCells, IbmError> {
    let dim = velocity.dim();
    for b in 0..bodies.n_bodies() {
        crate::solid_fraction::check(velocity.lattice(0), bodies, BodyId(b))?;
    }
    let corners = resolution::vertices(velocity);
    let mut shape = [1; 3];
    for a in 0..dim {
        let nodes = &velocity.lattice(a).axes[a];
        shape[a] = nodes.len() + usize::from(!nodes.is_periodic());
    }
    let vertices = Distances::new(corners.clone(), dim, bodies);
    resolution::require_seen(bodies, &vertices.unseen, &corners[..dim])?;
    let thin = resolution::thin_parts(velocity, bodies, &corners, &vertices)?;
    let mut cutter = Cutter { velocity, bodies, dim, shape, vertices, open: [const { Vec::new() }; 3] };
    cutter.open();
    cutter.close_dead_ends();
    Ok(CutCells { walls: cutter.walls(), faces: cutter.into_faces(), thin })
}

struct Cutter<'a, B: ?Sized> {
    velocity: &'a dyn VelocityField,
    bodies: &'a B,
    dim: usize,
    /// Cells along each axis.
    shape: [usize; 3],
    vertices: Distances,
    /// Per axis, x fastest: the open part of every face.
    open: [Vec<Open>; 3],
}

/// Who is near: a body, and a place from its centre of mass.
type Seen = (BodyId, Vector);

impl<B: Bodies + ?Sized> Cutter<'_, B> {
    /// Faces along each axis of those normal to `a`.
    fn faces(&self, a: usize) -> [usize; 3] {
        let mut shape = self.shape;
        shape[a] += usize::from(!self.velocity.lattice(a).axes[a].is_periodic());
        shape
    }

    /// Where the face below (`upper`: above) `cell` along `a` is among those of the axis.
    fn face(&self, a: usize, cell: [usize; 3], upper: bool) -> usize {
        let shape = self.faces(a);
        let mut at = cell;
        at[a] = (cell[a] + usize::from(upper)) % shape[a];
        at[0] + shape[0] * (at[1] + shape[1] * at[2])
    }

    /// Lower corner and edge lengths of a cell \[m\].
    fn bounds(&self, cell: [usize; 3]) -> (Point, Vector) {
        let (mut low, mut size) = (Point::origin(), Vector::new(0.0, 0.0, 0.0));
        for a in 0..self.dim {
            let nodes = &self.velocity.lattice(a).axes[a];
            let first = cell[a] as isize - isize::from(!nodes.is_periodic());
            low[a] = nodes.place(first);
            size[a] = nodes.place(first + 1) - low[a];
        }
        (low, size)
    }

    fn area(&self, size: Vector, a: usize) -> f64 {
        (0..self.dim).filter(|&b| b != a).map(|b| size[b]).product()
    }

    fn distance(&self, (b, arm): Seen) -> f64 {
        let at = self.bodies.pose(b).orientation.inverse_transform_vector(&arm);
        self.bodies.solid(b).signed_distance(Point::from(at), self.vertices.band)
    }

    /// The nearest of these bodies, seen from `by` beside where they are given.
    fn nearest(&self, seen: &[Seen], by: Vector) -> (f64, Seen) {
        let mut best = (f64::INFINITY, (BodyId(0), Vector::zeros()));
        for &(b, arm) in seen {
            let distance = self.distance((b, arm + by));
            if distance < best.0 {
                best = (distance, (b, arm + by));
            }
        }
        best
    }

    /// The vertices of the face of axis `a` with lower corner `at`: what is known of them, and where they are from that corner.
    fn corners(&self, a: usize, at: [usize; 3], size: Vector) -> [(Option<&Near>, Vector); 4] {
        let along = self.along(a);
        std::array::from_fn(|k| {
            let (mut node, mut place) = (at.map(|i| i as isize), Vector::zeros());
            for (bit, axis) in along.into_iter().enumerate().filter(|&(_, axis)| axis < self.dim) {
                let up = k >> bit & 1;
                node[axis] += up as isize;
                place[axis] = up as f64 * size[axis];
            }
            (self.vertices.at(node), place)
        })
    }

    /// The axes along the faces of axis `a`; beyond the space dimensions where there is only one.
    fn along(&self, a: usize) -> [usize; 2] {
        if self.dim == 2 { [1 - a, 2] } else { [(a + 1) % 3, (a + 2) % 3] }
    }

    fn open(&mut self) {
        for a in 0..self.dim {
            let shape = self.faces(a);
            let mut list = Vec::with_capacity(shape.iter().product());
            for k in 0..shape[2] {
                for j in 0..shape[1] {
                    list.extend((0..shape[0]).map(|i| self.measure(a, [i, j, k])));
                }
            }
            self.open[a] = list;
        }
    }

    fn measure(&self, a: usize, at: [usize; 3]) -> Open {
        let mut cell = at;
        cell[a] = cell[a].min(self.shape[a] - 1);
        let (_, size) = self.bounds(cell);
        let corners = self.corners(a, at, size);
        let along = self.along(a);
        let middle = 0.5 * corners[if self.dim == 2 { 1 } else { 3 }].1;
        let whole = Open { share: 1.0, centre: middle, distance: f64::INFINITY };
        let mut seen: Vec<Seen> = Vec::new();
        for (near, place) in corners {
            let Some(near) = near else { continue };
            if !seen.iter().any(|s| s.0 == near.body()) {
                seen.push((near.body(), near.arm - place));
            }
        }
        if seen.is_empty() {
            return whole;
        }
        let narrowest = (0..self.dim).map(|b| size[b]).fold(f64::INFINITY, f64::min);
        let value = |d: f64| if d <= ON * narrowest { d.min(0.0) } else { d };
        let known = |near: Option<&Near>, place: Vector| match near {
            Some(near) if near.distance.abs() < self.vertices.band => near.distance,
            _ => self.nearest(&seen, place).0,
        };
        let at_vertex = |d: f64| if d <= SLIVER * narrowest { d.min(0.0) } else { value(d) };
        let values = corners.map(|(near, place)| at_vertex(known(near, place)));
        let half = middle.norm();
        if values.iter().all(|d| *d > 2.0 * half) {
            return whole;
        }
        let distance = |place: Vector| value(self.nearest(&seen, place).0);
        let mut open = if values.iter().all(|d| *d < -2.0 * half) {
            Open { share: 0.0, centre: middle, distance: 0.0 }
        } else if self.dim == 2 {
            face::edge(corners[1].1, [values[0], distance(middle), values[1]], distance)
        } else {
            let sides = along.map(|axis| size[axis]);
            face::rectangle(sides, values, distance(middle)).placed(along)
        };
        if open.share < LEAST {
            open = Open { share: 0.0, centre: middle, distance: 0.0 };
        } else {
            open.distance = self.nearest(&seen, open.centre).0.max(0.0);
        }
        open
    }

    /// The cells with their places, x fastest.
    fn cells(shape: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
        let [nx, ny, _] = shape;
        (0..shape.iter().product()).map(move |n| [n % nx, n / nx % ny, n / (nx * ny)])
    }

    fn close_dead_ends(&mut self) {
        let mut work: Vec<[usize; 3]> = Self::cells(self.shape).collect();
        while let Some(cell) = work.pop() {
            let mut way = None;
            let mut ways = 0;
            for a in 0..self.dim {
                for upper in [false, true] {
                    let face = self.face(a, cell, upper);
                    if self.open[a][face].share > 0.0 {
                        ways += 1;
                        way = Some((a, face, upper));
                    }
                }
            }
            let (1, Some((a, face, upper))) = (ways, way) else { continue };
            self.open[a][face].share = 0.0;
            let (n, periodic) = (self.shape[a], self.velocity.lattice(a).axes[a].is_periodic());
            let mut beside = cell;
            if upper && (cell[a] + 1 < n || periodic) {
                beside[a] = (cell[a] + 1) % n;
                work.push(beside);
            } else if !upper && (cell[a] > 0 || periodic) {
                beside[a] = (cell[a] + n - 1) % n;
                work.push(beside);
            }
        }
    }

    fn walls(&self) -> Vec<WallPiece> {
        let mut walls = Vec::new();
        for (number, cell) in Self::cells(self.shape).enumerate() {
            let (low, size) = self.bounds(cell);
            let (mut vector, mut middle, mut sum) = (Vector::zeros(), Vector::zeros(), 0.0);
            let mut largest = 0.0_f64;
            for a in 0..self.dim {
                let area = self.area(size, a);
                largest = largest.max(area);
                for upper in [false, true] {
                    let open = &self.open[a][self.face(a, cell, upper)];
                    let mut place = open.centre;
                    place[a] = if upper { size[a] } else { 0.0 };
                    vector[a] += if upper { open.share * area } else { -open.share * area };
                    middle += open.share * area * place;
                    sum += open.share * area;
                }
            }
            let area = vector.norm();
            if sum == 0.0 || area <= LEAST * largest {
                continue;
            }
            let middle = middle / sum;
            let Some(piece) = self.piece(number, cell, middle, vector / area, area, low) else { continue };
            walls.push(piece);
        }
        walls
    }

    fn piece(
        &self,
        number: usize,
        cell: [usize; 3],
        middle: Vector,
        normal: Vector,
        area: f64,
        low: Point,
    ) -> Option<WallPiece> {
        let mut seen: Vec<Seen> = Vec::new();
        let (_, size) = self.bounds(cell);
        for k in 0..1_usize << self.dim {
            let (mut node, mut place) = (cell.map(|i| i as isize), Vector::zeros());
            for a in 0..self.dim {
                node[a] += (k >> a & 1) as isize;
                place[a] = (k >> a & 1) as f64 * size[a];
            }
            let Some(near) = self.vertices.at(node) else { continue };
            if !seen.iter().any(|s| s.0 == near.body()) {
                seen.push((near.body(), near.arm - place));
            }
        }
        if seen.is_empty() {
            return None;
        }
        let (distance, (body, arm)) = self.nearest(&seen, middle);
        let by = -distance * normal;
        let (foot, arm) = (low + middle + by, arm + by);
        let velocity = self.bodies.surface_velocity(body, arm);
        Some(WallPiece { cell: number, body: body.0, area, normal, foot, arm, velocity })
    }

    fn into_faces(self) -> [Vec<OpenFace>; 3] {
        let mut faces = [const { Vec::new() }; 3];
        for a in 0..self.dim {
            let lattice = self.velocity.lattice(a);
            let shift = isize::from(!lattice.axes[a].is_periodic());
            for (at, open) in Self::cells(self.faces(a)).zip(&self.open[a]) {
                if open.share >= 1.0 {
                    continue;
                }
                let place = |b: usize| at[b] as isize - if b == a { shift } else { 0 };
                let index: isize = (0..self.dim).map(|b| place(b) * lattice.stride[b] as isize).sum();
                let mut cell = at;
                cell[a] = cell[a].min(self.shape[a] - 1);
                let (mut low, size) = self.bounds(cell);
                low[a] += size[a] * (at[a] - cell[a]) as f64;
                faces[a].push(OpenFace {
                    index: (lattice.base as isize + index) as usize,
                    open: open.share,
                    centre: low + open.centre,
                    distance: if open.distance.is_finite() { open.distance } else { 0.0 },
                });
            }
        }
        faces
    }
}

#[cfg(test)]
mod tests;
