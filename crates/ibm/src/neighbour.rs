//! The bodies beside a body.
use interfaces::{Aabb, Bodies, BodyId, Lattice, Point, Vector};

/// A body beside the one at hand.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Neighbour {
    pub(crate) body: BodyId,
    /// From where it is to where it repeats.
    shift: Vector,
    /// The box around it there.
    bounds: Aabb,
}

impl Neighbour {
    /// Signed distance of `x` from it.
    pub(crate) fn distance<B: Bodies + ?Sized>(&self, bodies: &B, x: Point, band: f64) -> f64 {
        bodies.solid(self.body).signed_distance(bodies.pose(self.body).to_body(x - self.shift), band)
    }

    /// Is `x` inside it, or outside by no more than `within` \[m\]?
    pub(crate) fn holds<B: Bodies + ?Sized>(&self, bodies: &B, x: Point, within: f64) -> bool {
        self.may_hold(x, within) && self.distance(bodies, x, 2.0 * within + f64::MIN_POSITIVE) <= within
    }

    /// Is `x` inside the box around it, or outside by no more than `within` \[m\]?
    pub(crate) fn may_hold(&self, x: Point, within: f64) -> bool {
        let Aabb { min, max } = self.bounds.grown(within);
        // A plane body's box is flat.
        (0..2).all(|a| (min[a]..=max[a]).contains(&x[a]))
    }

    /// Lists those of `among` whose boxes may be within `cells` cells of body `b`, itself as it repeats among them.
    pub(crate) fn list<B: Bodies + ?Sized>(
        lattice: &Lattice,
        bodies: &B,
        b: BodyId,
        cells: f64,
        among: impl Iterator<Item = BodyId>,
        found: &mut Vec<Self>,
    ) {
        found.clear();
        let dim = lattice.dim;
        let here = bodies.aabb(b);
        let reach = Vector::from_fn(|a, _| {
            if a < dim {
                let [_, widest] = lattice.axes[a].spacings(here.min[a], here.max[a]);
                // Twice, since cells may grow away from the body.
                2.0 * cells * widest
            } else {
                0.0
            }
        });
        let periods =
            Vector::from_fn(|a, _| if a < dim { lattice.axes[a].period().unwrap_or(0.0) } else { 0.0 });
        for body in among {
            let there = bodies.aabb(body);
            let apart = nalgebra::center(&there.min, &there.max) - nalgebra::center(&here.min, &here.max);
            let nearest = Vector::from_fn(|a, _| {
                if periods[a] > 0.0 { -periods[a] * (apart[a] / periods[a]).round() } else { 0.0 }
            });
            let room = 0.5 * (there.extent() + here.extent()) + reach;
            if (0..dim).any(|a| (apart + nearest)[a].abs() > room[a]) {
                continue;
            }
            // The next ones are half a period away or more.
            let turns =
                |a: usize| if periods[a] > 0.0 && room[a] >= 0.5 * periods[a] { -1..=1 } else { 0..=0 };
            for k in turns(2) {
                for j in turns(1) {
                    for i in turns(0) {
                        let turn = Vector::new(f64::from(i), f64::from(j), f64::from(k));
                        let shift = nearest + periods.component_mul(&turn);
                        let itself = body == b && turn == Vector::zeros();
                        if !itself && (0..dim).all(|a| (apart + shift)[a].abs() <= room[a]) {
                            let bounds = Aabb { min: there.min + shift, max: there.max + shift };
                            found.push(Self { body, shift, bounds });
                        }
                    }
                }
            }
        }
    }
}

/// Is a place inside the bounded sides?
pub(crate) fn inside(lattice: &Lattice, x: Point) -> bool {
    (0..lattice.dim).all(|a| {
        let [low, high] = ends(lattice, a);
        lattice.axes[a].is_periodic() || (low..=high).contains(&x[a])
    })
}

/// Where the cells along axis `a` begin and end \[m\].
pub(crate) fn ends(lattice: &Lattice, a: usize) -> [f64; 2] {
    let nodes = &lattice.axes[a];
    let edge = |i: isize, sign: f64| nodes.place(i) + 0.5 * sign * nodes.width(i);
    [edge(0, -1.0), edge(nodes.len() as isize - 1, 1.0)]
}
