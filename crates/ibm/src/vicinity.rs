//! Which bodies have to be looked at again, since they or others near them moved.
use crate::SolidFraction;
use interfaces::{Aabb, Bodies, BodyId, Lattice};

/// Bodies farther apart than so many cells see nothing of one another: three to P₁, one to P₂, one for
/// the cells around it, one that the surface cuts.
const REACH: f64 = 6.0;

/// Follows bodies from place to place.
#[derive(Clone, Debug, Default)]
pub(crate) struct Vicinity {
    /// Of every body, its stamp when it was last worked on and its box then.
    known: Vec<(u64, Option<Aabb>)>,
    /// Boxes of all bodies where they are now.
    now: Vec<Aabb>,
    /// Boxes that were left or entered.
    changed: Vec<Aabb>,
    /// Bodies to work on: those that moved, and those that one that moved is or was near.
    pub(crate) work: Vec<usize>,
    /// Bodies that those may see.
    pub(crate) seen: Vec<usize>,
}

impl Vicinity {
    /// Lists the bodies to work on since the last call; false if there are none, nor any gone.
    pub(crate) fn follow<B: Bodies + ?Sized>(
        &mut self,
        lattice: &Lattice,
        bodies: &B,
        fraction: &SolidFraction,
    ) -> bool {
        let n = fraction.n_bodies();
        let Self { known, now, changed, work, seen } = self;
        // Those of bodies that are gone first.
        changed.clear();
        changed.extend(known.drain(n.min(known.len())..).filter_map(|(_, bounds)| bounds));
        known.resize(n, (0, None));
        for (b, (stamp, bounds)) in known.iter().enumerate() {
            if *stamp != fraction.stamp(BodyId(b)) {
                changed.extend(*bounds);
                changed.push(bodies.aabb(BodyId(b)));
            }
        }
        if changed.is_empty() {
            return false;
        }
        now.clear();
        now.extend((0..n).map(|b| bodies.aabb(BodyId(b))));
        work.clear();
        work.extend((0..n).filter(|&b| changed.iter().any(|c| near(lattice, c, &now[b]))));
        seen.clear();
        seen.extend((0..n).filter(|&b| work.iter().any(|&w| near(lattice, &now[w], &now[b]))));
        for &b in work.iter() {
            known[b] = (fraction.stamp(BodyId(b)), Some(now[b]));
        }
        true
    }
}

/// Are two boxes so near that what one covers may matter to the other?
fn near(lattice: &Lattice, a: &Aabb, b: &Aabb) -> bool {
    (0..lattice.dim).all(|axis| {
        let nodes = &lattice.axes[axis];
        let mut apart = 0.5 * (a.min[axis] + a.max[axis] - b.min[axis] - b.max[axis]);
        if let Some(period) = nodes.period() {
            apart -= period * (apart / period).round();
        }
        let [_, widest] = nodes.spacings(b.min[axis], b.max[axis]);
        // Twice, since cells may grow away from the body.
        apart.abs() <= 0.5 * (a.extent()[axis] + b.extent()[axis]) + 2.0 * REACH * widest
    })
}
