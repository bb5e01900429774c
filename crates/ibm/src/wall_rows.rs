//! The cells beside bodies, as wall functions take them.
mod area;

use crate::neighbour::Neighbour;
use crate::reconstruction::{FluidPoint, cell_edge, fluid_points};
use crate::vicinity::Vicinity;
use crate::{IbmError, SolidFraction};
use area::Areas;
use interfaces::{Bodies, BodyId, Lattice, Point, Vector, WallPoint, WallRow};

/// Rows for wall functions at the surfaces of bodies: geometry, found again only where bodies moved
/// ([`place`](Self::place)), and what the flow is there, as often as asked ([`fill`](Self::fill)).
///
/// The cells are divided as in Isoz et al. 2023 (equations 5–6, figure 4b) and the published code, by the paper's λ, which is ½
/// where the surface goes through a cell's centre:
///
/// * *in-solid* cells have their centre inside a body (λ ≥ ½);
/// * *boundary* cells have it in the fluid and are cut by the surface (0 < λ < ½), or are not but share a face with an
///   in-solid cell (so that a wall along the faces of the grid has boundary cells, too): each has a row;
/// * *fluid* cells are the others.
///
/// P₁ and P₂ are those of [`Reconstruction`](crate::Reconstruction): on the outward normal through the surface point S, where
/// nothing is seen but fluid cells. A cell beside two bodies has a row for each. The areas are the surface's, shared out to
/// the rows beside it: their sum is the area that is neither in another body nor outside the box.
#[derive(Clone, Debug, Default)]
pub struct WallRows {
    lattice: Option<Lattice>,
    fraction: SolidFraction,
    vicinity: Vicinity,
    bodies: Vec<Vec<WallCell>>,
    areas: Areas,
    covered: Vec<bool>,
    /// Of every cell, the number of the row of the body at hand there plus one; 0 where it is not, or `SOLID`.
    slots: Vec<u32>,
    /// Cells whose slots are to be freed.
    touched: Vec<usize>,
    others: Vec<Neighbour>,
    /// Nodes of a body in its frame, and their signed distances.
    points: Vec<Point>,
    distances: Vec<f64>,
    rows: Vec<WallRow>,
}

/// A boundary cell of a body.
#[derive(Clone, Debug)]
pub struct WallCell {
    /// Its number, x fastest.
    pub cell: usize,
    /// The body.
    pub body: BodyId,
    /// The surface point S, from the body's centre of mass \[m\].
    pub foot: Vector,
    /// Outward unit normal there.
    pub normal: Vector,
    /// Distance of the cell's centre from S \[m\].
    pub y: f64,
    /// Area of the surface that is this cell's \[m²\]; in the plane length \[m\].
    pub area: f64,
    /// P₁ and P₂, where there is room for them.
    pub points: [Option<FluidPoint>; 2],
}

/// Centres nearer to a surface than this share of a cell are on it, which is inside: round-off is no distance.
const ON: f64 = 1e-9;
/// The slot of a cell of a body that has no row.
const SOLID: u32 = u32::MAX;

impl WallRows {
    /// No bodies yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Follows the bodies on `lattice`, that of the cells' centres. Only bodies that moved, and those that one that moved is or
    /// was near, are worked on.
    ///
    /// # Errors
    /// Those of [`SolidFraction::update`].
    pub fn place<B: Bodies + ?Sized>(&mut self, lattice: &Lattice, bodies: &B) -> Result<(), IbmError> {
        let lattice = &lattice.dense();
        if self.lattice.as_ref() != Some(lattice) {
            let cells = lattice.shape().iter().product();
            self.covered.resize(cells, false);
            self.slots.resize(cells, 0);
            (self.vicinity, self.lattice) = (Vicinity::default(), Some(lattice.clone()));
            self.bodies.clear();
            self.rows.clear();
        }
        self.fraction.update(lattice, bodies)?;
        let mut vicinity = std::mem::take(&mut self.vicinity);
        if vicinity.follow(lattice, bodies, &self.fraction) {
            self.bodies.resize_with(bodies.n_bodies(), Vec::new);
            for &b in &vicinity.work {
                self.find(lattice, bodies, BodyId(b), &vicinity.seen);
            }
            self.cover(&vicinity.seen, true);
            for &b in &vicinity.work {
                for cell in &mut self.bodies[b] {
                    let surface = bodies.pose(cell.body).position + cell.foot;
                    let h = cell_edge(lattice, lattice.node(cell.cell), cell.normal);
                    cell.points = fluid_points(lattice, surface, cell.normal, h, &self.covered);
                }
            }
            self.cover(&vicinity.seen, false);
            self.areas.keep(bodies.n_bodies());
            for &b in &vicinity.work {
                self.share_area(lattice, bodies, BodyId(b), &vicinity.seen);
            }
            self.rows.clear();
            self.rows.extend(self.bodies.iter().flatten().map(WallCell::row));
        }
        self.vicinity = vicinity;
        Ok(())
    }

    /// The boundary cells of body `b`.
    pub fn cells(&self, b: BodyId) -> &[WallCell] {
        self.bodies.get(b.0).map_or(&[], |cells| cells)
    }
    /// All rows, body after body in the order of [`cells`](Self::cells), as they were last filled.
    pub fn rows(&self) -> &[WallRow] {
        &self.rows
    }
    /// How many rows have no room for P₂, or not even for P₁.
    pub fn lowered(&self) -> usize {
        self.rows.iter().filter(|row| row.points[1].is_none()).count()
    }

    /// Fills the rows with what the flow is at the cells now: `velocity` \[m/s\], one field per dimension, and `k` \[m²/s²\], if
    /// there is one, have one value per cell, x fastest; `nu` is the fluid's kinematic viscosity \[m²/s\] and `wall` the
    /// velocity of the surface at a cell's foot: `|w| bodies.surface_velocity(w.body, w.foot)`.
    ///
    /// # Errors
    /// [`IbmError::Components`] and [`IbmError::Storage`] for fields that are not the lattice's.
    pub fn fill(
        &mut self,
        velocity: &[&[f64]],
        k: Option<&[f64]>,
        nu: f64,
        wall: impl Fn(&WallCell) -> Vector,
    ) -> Result<&[WallRow], IbmError> {
        let dim = self.lattice.as_ref().map_or(velocity.len(), |lattice| lattice.dim);
        if velocity.len() != dim {
            return Err(IbmError::Components { needed: dim, found: velocity.len() });
        }
        let needed = self.covered.len();
        if let Some(field) = velocity.iter().chain(&k).find(|field| field.len() != needed) {
            return Err(IbmError::Storage { needed, found: field.len() });
        }
        for (row, cell) in self.rows.iter_mut().zip(self.bodies.iter().flatten()) {
            let (wall, normal) = (wall(cell), cell.normal);
            let tangential = |read: &dyn Fn(&[f64]) -> f64| {
                let mut u = -wall;
                velocity.iter().enumerate().for_each(|(c, field)| u[c] += read(field));
                u - normal * normal.dot(&u)
            };
            let here = tangential(&|field| field[cell.cell]);
            (row.u_t, row.nu) = (here.norm(), nu);
            row.k = k.map_or(0.0, |k| k[cell.cell]);
            let mut along = here;
            for p in [1, 0] {
                if let (Some(point), Some(seen)) = (&cell.points[p], &mut row.points[p]) {
                    along = tangential(&|field| point.value(field));
                    (seen.u_t, seen.k) = (along.norm(), k.map_or(0.0, |k| point.value(k)));
                }
            }
            row.tangent = along.try_normalize(0.0).unwrap_or_default();
        }
        Ok(&self.rows)
    }

    /// Lists the boundary cells of body `b` among the others of `seen`.
    fn find<B: Bodies + ?Sized>(&mut self, lattice: &Lattice, bodies: &B, b: BodyId, seen: &[usize]) {
        let (solid, pose) = (bodies.solid(b), bodies.pose(b));
        let bounds = bodies.aabb(b);
        let widest = (0..lattice.dim)
            .map(|a| lattice.axes[a].spacings(bounds.min[a], bounds.max[a])[1])
            .fold(0.0, f64::max);
        Neighbour::list(lattice, bodies, b, 2.0, seen.iter().map(|&b| BodyId(b)), &mut self.others);
        let least = ON * widest;
        let Self { fraction, bodies: all, slots, touched, others, points, distances, .. } = self;
        let (nodes, cells) = (fraction.nodes(b), &mut all[b.0]);
        cells.clear();
        // Twice what is there now, so that a moving body allocates nothing.
        if cells.capacity() < nodes.len() / 2 {
            cells.reserve(nodes.len());
        }
        let mut add = |cell: usize, arm: Vector, y: f64| {
            let x = pose.position + arm;
            if !others.iter().any(|o| o.holds(bodies, x, least)) {
                let normal = pose.orientation * solid.normal(pose.to_body(x), widest);
                let (foot, points) = (arm - normal * y, [None, None]);
                cells.push(WallCell { cell, body: b, foot, normal, y, area: 0.0, points });
            }
        };
        points.clear();
        points.extend(nodes.iter().map(|node| pose.to_body(pose.position + node.arm)));
        distances.resize(nodes.len(), 0.0);
        solid.signed_distances(points, 2.0 * widest, distances);
        for (node, &distance) in nodes.iter().zip(&*distances) {
            slots[node.index] = SOLID;
            if distance > least {
                add(node.index, node.arm, distance);
            }
        }
        // Those that are not cut but share a face with a cell that has its centre inside.
        let inside = |d: f64| d <= least && d > -1.001 * widest;
        for (node, _) in nodes.iter().zip(&*distances).filter(|(_, d)| inside(**d)) {
            let at = lattice.node(node.index);
            for (a, step) in (0..lattice.dim).flat_map(|a| [(a, -1), (a, 1)]) {
                let mut beside = at;
                beside[a] += step;
                let Some(index) = lattice.index(beside).filter(|&index| slots[index] == 0) else { continue };
                let mut arm = node.arm;
                arm[a] += lattice.axes[a].place(beside[a]) - lattice.axes[a].place(at[a]);
                let y = solid.signed_distance(pose.to_body(pose.position + arm), 4.0 * widest);
                if y > least {
                    add(index, arm, y);
                }
                slots[index] = SOLID;
                touched.push(index);
            }
        }
        nodes.iter().for_each(|node| slots[node.index] = 0);
        touched.drain(..).for_each(|index| slots[index] = 0);
    }

    /// Marks what P₁ and P₂ must not see.
    fn cover(&mut self, seen: &[usize], to: bool) {
        for &b in seen {
            self.fraction.nodes(BodyId(b)).iter().for_each(|node| self.covered[node.index] = to);
            self.bodies[b].iter().for_each(|cell| self.covered[cell.cell] = to);
        }
    }

    /// Shares the surface of body `b` out to its rows.
    fn share_area<B: Bodies + ?Sized>(&mut self, lattice: &Lattice, bodies: &B, b: BodyId, seen: &[usize]) {
        let Self { bodies: all, areas, slots, others, .. } = self;
        Neighbour::list(lattice, bodies, b, 0.0, seen.iter().map(|&b| BodyId(b)), others);
        let cells = &mut all[b.0];
        for (number, cell) in (1..SOLID).zip(cells.iter_mut()) {
            slots[cell.cell] = number;
        }
        let wet = |x: Point| !others.iter().any(|o| o.holds(bodies, x, 0.0));
        areas.share(lattice, bodies, b, wet, |row, area| cells[row].area += area, slots);
        cells.iter().for_each(|cell| slots[cell.cell] = 0);
    }
}

impl WallCell {
    /// The row, but for the flow.
    fn row(&self) -> WallRow {
        let points = self.points.map(|p| p.map(|p| WallPoint { y: p.distance, ..WallPoint::default() }));
        WallRow { cell: self.cell, y: self.y, area: self.area, points, ..WallRow::default() }
    }
}

#[cfg(test)]
mod tests;
