//! Walls at rest that cut the grid.
mod distances;
mod faces;
mod links;
mod plane;

use crate::IbmError;
use distances::{Distances, Ticks};
use interfaces::{Bodies, BodyId, CutComponent, CutWalls, Point, SolidPoint, Vector, VelocityField};

/// How bodies at rest (or turning in themselves) cut a staggered grid: where links between velocity nodes meet the
/// surface, and which part of every face is open. See [`CutWalls`] for what a flow does with it.
///
/// The flux through a cut face follows from a velocity that is linear in the distance from the wall: between the wall and
/// the node of the face, and between that node and its neighbour on the open side; in the plane the curvature of the
/// profile is added. That makes the fluxes second order.
///
/// # Errors
/// [`IbmError::Lost`], [`IbmError::TooLarge`] and [`IbmError::Unseen`] for a body in the box that no node of some velocity
/// component is inside of.
pub fn cut_walls<B: Bodies + ?Sized>(velocity: &dyn VelocityField, bodies: &B) -> Result<CutWalls, IbmError> {
    let dim = velocity.dim();
    for c in 0..dim {
        for b in 0..bodies.n_bodies() {
            crate::solid_fraction::check(velocity.lattice(c), bodies, BodyId(b))?;
        }
    }
    let vertices = Distances::new([0, 1, 2].map(|a| vertices(velocity, a)), dim, bodies);
    let mut walls = CutWalls { n_bodies: bodies.n_bodies(), ..CutWalls::default() };
    for c in 0..dim {
        let lattice = velocity.lattice(c);
        let nodes = Distances::new([0, 1, 2].map(|a| Ticks::nodes(&lattice.axes[a])), dim, bodies);
        if let Some(&body) = nodes.unseen.first() {
            let extent = bodies.solid(body).aabb().extent();
            let size = extent.iter().take(dim).fold(f64::INFINITY, |m, &e| m.min(e));
            return Err(IbmError::Unseen { body, size, spacing: lattice.axes[0].mean_spacing() });
        }
        let component = Cutter { velocity, bodies, c, dim, nodes: &nodes, vertices: &vertices };
        let (solid, links, faces) = (component.solid(), component.links(), component.faces());
        walls.components[c] = CutComponent { solid, links, faces };
    }
    Ok(walls)
}

/// All faces of the cells along axis `a`.
fn vertices(velocity: &dyn VelocityField, a: usize) -> Ticks {
    match a < velocity.dim() {
        true => Ticks::faces(&velocity.lattice(a).axes[a]),
        false => Ticks::nodes(&velocity.lattice(0).axes[a]),
    }
}

/// What the cuts of one velocity component are found from.
struct Cutter<'a, B: ?Sized> {
    velocity: &'a dyn VelocityField,
    bodies: &'a B,
    c: usize,
    dim: usize,
    /// Distances of the component's nodes …
    nodes: &'a Distances,
    /// … and of the corners of the cells.
    vertices: &'a Distances,
}

impl<B: Bodies + ?Sized> Cutter<'_, B> {
    /// The nodes inside.
    fn solid(&self) -> Vec<SolidPoint> {
        let lattice = self.velocity.lattice(self.c);
        let inside = self.nodes.near.iter().filter(|near| near.distance <= 0.0);
        let point = |near: &distances::Near| {
            let index = lattice.index(near.node.map(|i| i as isize))?;
            let velocity = self.wall_velocity(near.body, near.arm);
            Some(SolidPoint { index, velocity, body: near.body, arm: near.arm })
        };
        inside.filter_map(point).collect()
    }

    /// The component of the velocity of body `b` at `arm` from its centre of mass.
    fn wall_velocity(&self, b: usize, arm: Vector) -> f64 {
        self.bodies.twist(BodyId(b)).at(arm)[self.c]
    }

    /// Signed distance of body `b` at `arm` from its centre of mass.
    fn distance(&self, b: usize, arm: Vector) -> f64 {
        let at = self.bodies.pose(BodyId(b)).orientation.inverse_transform_vector(&arm);
        self.bodies.solid(BodyId(b)).signed_distance(Point::from(at), self.nodes.band)
    }

    /// Where the surface of body `b` cuts the way from `arm` (in the fluid) along `step`, as a share of it: the root of
    /// the distance, by false position (Illinois).
    fn crossing(&self, b: usize, arm: Vector, step: Vector, ends: [f64; 2]) -> f64 {
        let ([mut low, mut high], [mut at_low, mut at_high]) = ([0.0, 1.0], ends);
        let mut t = 0.0;
        for _ in 0..MOST {
            t = (low * at_high - high * at_low) / (at_high - at_low);
            let d = self.distance(b, arm + t * step);
            if d.abs() <= CLOSE * (ends[0] - ends[1]).abs() {
                break;
            }
            if d > 0.0 {
                (low, at_low, at_high) = (t, d, 0.5 * at_high);
            } else {
                (high, at_high, at_low) = (t, d, 0.5 * at_low);
            }
        }
        t.clamp(0.0, 1.0)
    }
}

/// Steps of a search for a root, and when it is found, as a share of the difference between the ends.
const MOST: usize = 30;
const CLOSE: f64 = 1e-10;

#[cfg(test)]
mod tests;
