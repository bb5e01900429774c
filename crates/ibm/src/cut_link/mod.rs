//! Walls at rest that cut the grid.
pub(crate) mod distances;
mod face_distances;
mod faces;
mod links;
mod profile;
pub(crate) mod resolution;

use crate::IbmError;
use distances::{Distances, Near, Ticks};
use interfaces::{Bodies, BodyId, CutComponent, CutWalls, Point, SolidPoint, Vector, VelocityField};

/// How bodies at rest (or turning in themselves) cut a staggered grid: where links between velocity nodes meet the
/// surface, and which part of every face is open. See [`CutWalls`] for what a flow does with it.
///
/// The flux through a cut face follows from a velocity that depends on the distance from the wall alone: from the wall to
/// the node of the face and on to its neighbours on the open side, with the curvature of the profile. That makes the fluxes
/// second order. Cuts are continuous in the place of the wall: nodes on a surface, within 10⁻⁶ of the narrowest spacing, are
/// inside, so that bodies which are symmetric to the grid have symmetric loads.
///
/// # Errors
/// [`IbmError::Lost`] and [`IbmError::TooLarge`]; [`IbmError::Outside`] and [`IbmError::Unseen`] for a body without a node of some
/// velocity component inside; [`IbmError::Thin`] for a body that leaks. Thin parts of other bodies are in [`CutWalls::thin`].
pub fn cut_walls<B: Bodies + ?Sized>(velocity: &dyn VelocityField, bodies: &B) -> Result<CutWalls, IbmError> {
    let dim = velocity.dim();
    for c in 0..dim {
        for b in 0..bodies.n_bodies() {
            crate::solid_fraction::check(velocity.lattice(c), bodies, BodyId(b))?;
        }
    }
    let corners = resolution::vertices(velocity);
    let vertices = Distances::new(corners.clone(), dim, bodies);
    let mut walls = CutWalls { n_bodies: bodies.n_bodies(), ..CutWalls::default() };
    for c in 0..dim {
        let lattice = velocity.lattice(c);
        let nodes = Distances::new([0, 1, 2].map(|a| Ticks::nodes(&lattice.axes[a])), dim, bodies);
        resolution::require_seen(bodies, &nodes.unseen, &corners[..dim])?;
        let component = Cutter { velocity, bodies, c, dim, nodes: &nodes, vertices: &vertices };
        let (solid, links, faces) = (component.solid(), component.links(), component.faces());
        walls.components[c] = CutComponent { solid, links, faces };
    }
    walls.thin = resolution::thin_parts(velocity, bodies, &corners, &vertices)?;
    Ok(walls)
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
        let mut out = Vec::with_capacity(self.nodes.near.len());
        for near in self.nodes.near.iter().filter(|near| near.distance <= 0.0) {
            if let Some(index) = lattice.index(near.node.map(|i| i as isize)) {
                let velocity = self.bodies.twist(near.body()).at(near.arm)[self.c];
                out.push(SolidPoint { index, velocity, body: near.body().0, arm: near.arm });
            }
        }
        out
    }

    /// The component of the velocity of the surface of body `b` at `arm` from its centre of mass.
    fn wall_velocity(&self, b: BodyId, arm: Vector) -> f64 {
        self.bodies.surface_velocity(b, arm)[self.c]
    }

    /// Signed distance of body `b` at `arm` from its centre of mass.
    fn distance(&self, b: BodyId, arm: Vector) -> f64 {
        let at = self.bodies.pose(b).orientation.inverse_transform_vector(&arm);
        self.bodies.solid(b).signed_distance(Point::from(at), self.nodes.band)
    }

    /// The same, known already if `near` is that body there.
    fn distance_at(&self, near: &Near, b: BodyId, arm: Vector) -> f64 {
        let known = near.body() == b
            && (near.arm - arm).amax() < self.nodes.widest
            && near.distance < self.nodes.band;
        if known { near.distance } else { self.distance(b, arm) }
    }

    /// Share of the way from `arm` (in the fluid) along `step` before the surface of body `b`, with the
    /// distances `ends` at its ends: the root of the distance, by false position (Anderson & Björck
    /// 1973, BIT 13, 253), [`grazed`].
    fn crossing(&self, b: BodyId, arm: Vector, step: Vector, ends: [f64; 2]) -> f64 {
        let (solid, turn) = (self.bodies.solid(b), self.bodies.pose(b).orientation.inverse());
        let (from, way) = (Point::from(turn * arm), turn * step);
        let ([mut low, mut high], [mut at_low, mut at_high]) = ([0.0, 1.0], ends);
        let mut t = 0.0;
        // Factor for the value of an end that stays, from those of the end that moves.
        let less = |new: f64, old: f64| if new < old { 1.0 - new / old } else { 0.5 };
        let mut width = 1.0;
        for step in 0..MOST {
            t = (low * at_high - high * at_low) / (at_high - at_low);
            // Three steps that do not halve the bracket (a kink of the distance) are followed by a bisection.
            if step % 3 == 2 {
                if high - low > 0.5 * width {
                    t = 0.5 * (low + high);
                }
                width = high - low;
            }
            let d = solid.signed_distance(from + t * way, self.nodes.band);
            if d.abs() <= CLOSE * (ends[0] - ends[1]).abs() {
                break;
            }
            if d > 0.0 {
                at_high *= less(d, at_low);
                (low, at_low) = (t, d);
            } else {
                at_low *= less(-d, -at_high);
                (high, at_high) = (t, d);
            }
        }
        grazed(t.clamp(0.0, 1.0), ends)
    }
}

/// Share of a way before the wall that it crosses at the share `t`, with the distances `ends` of its
/// ends.
///
/// A way that enters a body and goes on along its surface ends at the wall at t if its end inside is
/// a little below the surface, and at that end, whose velocity is the wall's, if it is a little
/// above. So that loads and fluxes do not jump in between, the wall goes to the end as the crossing q
/// by the straight line between the distances does, t + (1 − t) Q⁴ with Q = (q − t)/(1 − t): Q is 0
/// for flat walls and of the order of the curvature times the way's length for smooth ones.
fn grazed(t: f64, ends: [f64; 2]) -> f64 {
    let straight = ends[0] / (ends[0] - ends[1]);
    if straight > t && t < 1.0 { t + (1.0 - t) * ((straight - t) / (1.0 - t)).powi(4) } else { t }
}

/// Steps of a search for a root, and when it is found, as a share of the difference between the ends.
const MOST: usize = 100;
const CLOSE: f64 = 1e-10;

#[cfg(test)]
mod tests;
