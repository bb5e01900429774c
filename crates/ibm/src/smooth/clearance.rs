//! How clear of other surfaces a body is.
use crate::film::FADES;
use crate::neighbour::{Neighbour, ends};
use interfaces::{Bodies, BodyId, Point, VelocityField};

/// Finds the shares s of bodies: 1 where no other surface is within three cells, 0 where one is within two, linear between; holds the memory that this takes.
#[derive(Clone, Debug, Default)]
pub(super) struct Clearance {
    neighbours: Vec<Neighbour>,
}

impl Clearance {
    /// The share of body `b` with these `places` on its surface, in cells of size `h`; only bodies `among` may be near.
    pub(super) fn share(
        &mut self,
        velocity: &dyn VelocityField,
        bodies: &dyn Bodies,
        b: BodyId,
        among: impl Iterator<Item = BodyId>,
        (places, h): (impl Iterator<Item = Point> + Clone, f64),
    ) -> f64 {
        let dim = velocity.dim();
        let [none, all] = FADES.map(|cells| cells * h);
        let mut least = all;
        let bounds = bodies.aabb(b);
        for a in 0..dim {
            // Of a component that lives at the middles of the cells along a.
            let lattice = velocity.lattice((a + 1) % dim);
            if !lattice.axes[a].is_periodic() {
                let [low, high] = ends(lattice, a);
                least = least.min(bounds.min[a] - low).min(high - bounds.max[a]);
            }
        }
        let among = among.chain(std::iter::once(b));
        Neighbour::list(velocity.lattice(0), bodies, b, FADES[1], among, &mut self.neighbours);
        for neighbour in &self.neighbours {
            for x in places.clone() {
                if least > none && neighbour.may_hold(x, least) {
                    least = least.min(neighbour.distance(bodies, x, all));
                }
            }
        }
        ((least - none) / (all - none)).clamp(0.0, 1.0)
    }
}
