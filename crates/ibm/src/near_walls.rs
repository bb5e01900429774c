//! The cells in and beside bodies that move, as turbulence models take them.
use crate::reconstruction::{cell_edge, corners};
use crate::solid_fraction::check;
use crate::{IbmError, WallDistance};
use interfaces::{Aabb, Bodies, BodyId, Lattice, Point, Pose, Vector, VelocityField, WallPoint, WallRow};

/// What a turbulence model has to know of bodies that move through the cells of a flow whose velocity a forcing with a smooth kernel makes
/// follow them ([`SmoothForcing`](crate::SmoothForcing)): made anew from their signed distances whenever one moved.
///
/// Such a velocity falls to that of the body over one or two cells, along a line and not by the logarithmic law. So the wall's friction is that of
/// the velocity seen 1½ cells from the surface, in a layer so thick the momentum has the ν_t with which a line has this friction, and the
/// slope of the velocity says nothing up to where a difference over two cells no longer meets that layer. The cells whose centre is up to
/// 2½ cells from a surface have a row ([`WallRow`]), with
///
/// * their own distance y; of cells that the surface cuts, that of the middle of what is fluid of them, ½(y + ½h), h the cell's edge;
/// * [`seen`](WallRow::seen), the tangential velocity 1½ cells from the surface;
/// * [`free`](WallRow::free), the share of the model's own equations, 0 up to 1½ cells and 1 from 2½ on;
/// * the share V/h max(1 − |y/h − 1|, 0) of the surface, in cells about one cell away: all together as much as
///   the parallel surface there, which is 1 + h/R times that of a cylinder.
///
/// All of these change steadily as a body moves through the cells. [`film`](Self::film) lists the cells in which the momentum has the ν_t of the
/// wall: those in the body up to 2½ cells deep, for what the kernel blurs, and those of rows, less and less beyond 1½ cells. A cell beside several
/// bodies has the row of the nearest.
#[derive(Clone, Debug, Default)]
pub struct NearWalls {
    lattice: Option<Lattice>,
    bodies: Vec<(Pose, Aabb)>,
    distance: WallDistance,
    solid: Vec<usize>,
    rows: Vec<WallRow>,
    walls: Vec<NearWall>,
    film: Vec<(usize, usize, f64)>,
    /// Of every cell near a body, the signed distance of the nearest one; infinite elsewhere.
    depth: Vec<f64>,
    /// Of every cell the number of its row plus one; 0 without.
    slots: Vec<u32>,
    found: Vec<Found>,
    batch: Batch,
}

/// What a row knows of its wall.
#[derive(Clone, Copy, Debug)]
struct NearWall {
    body: BodyId,
    /// The surface point, from the body's centre of mass, and the outward normal there.
    foot: Vector,
    normal: Vector,
    /// Where the flow is seen, and its distance from the surface.
    at: Point,
    seen: f64,
    /// Velocity of the surface \[m/s\].
    velocity: Vector,
}

/// A cell near a body.
#[derive(Clone, Copy, Debug)]
struct Found {
    cell: usize,
    body: usize,
    /// From the body's centre of mass.
    arm: Vector,
    distance: f64,
}

/// Points that are asked for at once.
#[derive(Clone, Debug, Default)]
struct Batch {
    cells: Vec<(usize, Vector)>,
    points: Vec<Point>,
    distances: Vec<f64>,
}

/// Cells along the edge of the blocks that are looked at as a whole.
const BLOCK: isize = 4;
/// How far the film reaches into the solid, and rows into the fluid; in cells.
const INSIDE: f64 = 2.5;
const OUTSIDE: f64 = SEEN + 1.0;
/// Where the flow is seen, in cells from the surface: the kernels' forces are all but spent there.
const SEEN: f64 = 1.5;
/// Where the film of a cell in the solid is looked up, in cells from the surface.
const LOOK_UP: f64 = 0.75;

impl NearWalls {
    /// No bodies yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Follows the bodies on `lattice`, that of the cells' centres. Answers whether anything is other than before but the velocities of the
    /// surfaces, which are taken anew each time.
    ///
    /// # Errors
    /// [`IbmError::Lost`] and [`IbmError::TooLarge`] for bodies that stand nowhere or are longer than a period.
    pub fn place(&mut self, lattice: &Lattice, bodies: &dyn Bodies) -> Result<bool, IbmError> {
        let lattice = &lattice.dense();
        let place = |b: usize| (bodies.pose(BodyId(b)), bodies.solid(BodyId(b)).aabb());
        let n = bodies.n_bodies();
        let same = self.lattice.as_ref() == Some(lattice)
            && self.bodies.len() == n
            && (0..n).all(|b| self.bodies[b] == place(b));
        if !same {
            self.distance.update(lattice, bodies)?;
            if self.lattice.as_ref() != Some(lattice) {
                let cells = lattice.shape().iter().product();
                self.found.clear();
                self.solid.clear();
                self.rows.clear();
                self.depth = vec![f64::INFINITY; cells];
                self.slots = vec![0; cells];
                self.lattice = Some(lattice.clone());
            }
            self.bodies.clear();
            self.found.drain(..).for_each(|near| self.depth[near.cell] = f64::INFINITY);
            for b in 0..n {
                check(lattice, bodies, BodyId(b))?;
                self.find(lattice, bodies, b);
            }
            self.sort(lattice, bodies);
            self.bodies.extend((0..n).map(place));
        }
        for wall in &mut self.walls {
            wall.velocity = bodies.surface_velocity(wall.body, wall.foot);
        }
        Ok(!same)
    }

    /// The cells whose centre is inside a body or on its surface.
    pub fn solid(&self) -> &[usize] {
        &self.solid
    }
    /// The rows, as they were last filled.
    pub fn rows(&self) -> &[WallRow] {
        &self.rows
    }
    /// Cells, the rows whose ν_t on the wall the momentum has there, and with which share in 0 … 1.
    pub fn film(&self) -> &[(usize, usize, f64)] {
        &self.film
    }
    /// The distance of every cell from the bodies \[m\], 0 inside.
    pub fn distance(&self) -> &[f64] {
        self.distance.values()
    }

    /// Fills k \[m²/s²\] of the rows: at the cells themselves, and where the flow is seen, of the cells there with fluid.
    pub fn fill_k(&mut self, k: &[f64]) {
        let Some(lattice) = &self.lattice else { return };
        for (row, wall) in self.rows.iter_mut().zip(&self.walls) {
            row.k = k[row.cell];
            if let Some(seen) = &mut row.seen {
                seen.k = mean(lattice, wall.at, |i| (self.depth[i] > 0.0).then(|| k[i])).unwrap_or(row.k);
            }
        }
    }

    /// Fills what the rows see of `velocity` \[m/s\]; `nu` is the fluid's kinematic viscosity \[m²/s\].
    pub fn fill(&mut self, velocity: &dyn VelocityField, nu: f64) {
        for (row, wall) in self.rows.iter_mut().zip(&self.walls) {
            let mut u = -wall.velocity;
            for c in 0..velocity.dim() {
                let values = velocity.component(c);
                u[c] += mean(velocity.lattice(c), wall.at, |i| Some(values[i])).unwrap_or(wall.velocity[c]);
            }
            let along = u - wall.normal * wall.normal.dot(&u);
            let speed = along.norm();
            row.tangent = along.try_normalize(0.0).unwrap_or_default();
            // On a line from the wall to where it is seen.
            row.u_t = speed * row.y / wall.seen;
            row.shear = Some(speed / wall.seen);
            row.nu = nu;
            if let Some(seen) = &mut row.seen {
                seen.u_t = speed;
            }
        }
    }

    /// Lists the cells near body `b`.
    fn find(&mut self, lattice: &Lattice, bodies: &dyn Bodies, b: usize) {
        let body = BodyId(b);
        let (bounds, pose, solid) = (bodies.aabb(body), bodies.pose(body), bodies.solid(body));
        let dim = lattice.dim;
        let widest = (0..dim).map(|a| lattice.axes[a].spacings(bounds.min[a], bounds.max[a])[1]);
        let (diagonal, widest) =
            widest.fold((0.0, 0.0), |(sum, most): (f64, f64), h| (sum + h * h, most.max(h)));
        let reach = (INSIDE + 0.5) * widest;
        // Cells may grow away from the body: half a block's diagonal, twice as wide.
        let half = BLOCK as f64 * diagonal.sqrt();
        let range = |a: usize| {
            if a >= dim { 0..1 } else { lattice.axes[a].range(bounds.min[a] - reach, bounds.max[a] + reach) }
        };
        let [ranges_x, ranges_y, ranges_z] = [range(0), range(1), range(2)];
        let Self { found, depth, batch, .. } = self;
        let starts = |r: &std::ops::Range<isize>| r.clone().step_by(BLOCK as usize);
        for k0 in starts(&ranges_z) {
            for j0 in starts(&ranges_y) {
                for i0 in starts(&ranges_x) {
                    let end = |from: isize, r: &std::ops::Range<isize>| (from + BLOCK).min(r.end);
                    batch.cells.clear();
                    for k in k0..end(k0, &ranges_z) {
                        for j in j0..end(j0, &ranges_y) {
                            for i in i0..end(i0, &ranges_x) {
                                if let Some(cell) = lattice.index([i, j, k]) {
                                    let mut x = Vector::from(lattice.position([i, j, k]));
                                    if dim == 2 {
                                        x.z = pose.position.z;
                                    }
                                    batch.cells.push((cell, x - pose.position.coords));
                                }
                            }
                        }
                    }
                    let Some(&(_, first)) = batch.cells.first() else { continue };
                    let Some(&(_, last)) = batch.cells.last() else { continue };
                    let middle = pose.position + 0.5 * (first + last);
                    let whole = solid.signed_distance(pose.to_body(middle), reach + half);
                    if whole > reach + half {
                        continue;
                    }
                    batch.distances.clear();
                    if whole < -reach - half {
                        batch.distances.resize(batch.cells.len(), whole);
                    } else {
                        batch.points.clear();
                        let points = batch.cells.iter().map(|(_, arm)| pose.to_body(pose.position + arm));
                        batch.points.extend(points);
                        batch.distances.resize(batch.cells.len(), 0.0);
                        solid.signed_distances(&batch.points, reach, &mut batch.distances);
                    }
                    for (&(cell, arm), &distance) in batch.cells.iter().zip(&batch.distances) {
                        if distance < reach && distance < depth[cell] {
                            depth[cell] = distance;
                            found.push(Found { cell, body: b, arm, distance });
                        }
                    }
                }
            }
        }
    }

    /// Makes rows and film of the cells found.
    fn sort(&mut self, lattice: &Lattice, bodies: &dyn Bodies) {
        let Self { solid, rows, walls, film, depth, slots, found, .. } = self;
        // Of bodies that were somewhere else.
        solid.iter().chain(rows.iter().map(|row| &row.cell)).for_each(|&cell| slots[cell] = 0);
        solid.clear();
        rows.clear();
        walls.clear();
        film.clear();
        // The last that was found of a cell is the nearest.
        for near in found.iter().filter(|near| depth[near.cell] == near.distance) {
            if near.distance <= 0.0 {
                solid.push(near.cell);
                continue;
            }
            let Some((normal, h)) = frame(lattice, bodies, near) else { continue };
            let from = near.distance / h;
            if from >= OUTSIDE {
                continue;
            }
            let (foot, seen) = (near.arm - normal * near.distance, SEEN * h);
            let body = BodyId(near.body);
            let surface = bodies.pose(body).position + foot;
            let y = if from < 0.5 { 0.5 * (near.distance + 0.5 * h) } else { near.distance };
            slots[near.cell] = u32::try_from(rows.len() + 1).unwrap_or(0);
            film.push((near.cell, rows.len(), (OUTSIDE - from).min(1.0)));
            rows.push(WallRow {
                cell: near.cell,
                y,
                area: lattice.volume(lattice.node(near.cell)) / h * (1.0 - (from - 1.0).abs()).max(0.0),
                free: (from - SEEN).clamp(0.0, 1.0),
                seen: Some(WallPoint { y: seen, ..WallPoint::default() }),
                ..WallRow::default()
            });
            let at = surface + normal * seen;
            walls.push(NearWall { body, foot, normal, at, seen, velocity: Vector::zeros() });
        }
        // What the forcing blurs has the viscosity that is before it.
        for near in found.iter().filter(|near| near.distance <= 0.0 && depth[near.cell] == near.distance) {
            let Some((normal, h)) = frame(lattice, bodies, near) else { continue };
            if -near.distance >= INSIDE * h {
                continue;
            }
            let surface = bodies.pose(BodyId(near.body)).position + near.arm - normal * near.distance;
            let (before, part) = lattice.locate(surface + normal * (LOOK_UP * h));
            let nearest = std::array::from_fn(|a| before[a] + isize::from(part[a] > 0.5));
            let row = lattice.index(nearest).map_or(0, |cell| slots[cell]);
            if let Some(row) = row.checked_sub(1) {
                film.push((near.cell, row as usize, 1.0));
            }
        }
        solid.sort_unstable();
    }
}

/// The outward normal of the surface at a cell, and how wide the cell is along it; `None` where the shape has no normal.
fn frame(lattice: &Lattice, bodies: &dyn Bodies, near: &Found) -> Option<(Vector, f64)> {
    let (body, node) = (BodyId(near.body), lattice.node(near.cell));
    let pose = bodies.pose(body);
    let widest = lattice.widths(node)[..lattice.dim].iter().copied().fold(0.0, f64::max);
    let normal = pose.orientation * bodies.solid(body).normal(pose.to_body(pose.position + near.arm), widest);
    let h = cell_edge(lattice, node, normal);
    (h > 0.0).then_some((normal, h))
}

/// What multilinear interpolation at `x` makes of the nodes around that have a value; `None` if none has.
fn mean(lattice: &Lattice, x: Point, value: impl Fn(usize) -> Option<f64>) -> Option<f64> {
    let (mut sum, mut weights) = (0.0, 0.0);
    for (index, weight) in corners(lattice, x) {
        if let Some(value) = index.filter(|_| weight > 0.0).and_then(&value) {
            sum += weight * value;
            weights += weight;
        }
    }
    (weights > 0.0).then(|| sum / weights)
}

#[cfg(test)]
mod tests;
