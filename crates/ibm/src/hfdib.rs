//! The paper's forcing: velocity values set in the cells that a body covers.
use crate::forcing::LayerSums;
use crate::smooth::{internal_momentum, rigid_momentum};
use crate::{Forcing, FractionRule, IbmError, Layer, Reconstruction, SolidFraction, SolidNode};
use interfaces::{Bodies, BodyId, Kinematics, Renumbering, Twist, Vector, VelocityField, Wrench};

/// Hybrid fictitious domain–immersed boundary forcing (Isoz et al. 2023, equations 1–2 and
/// figure 3): f_ib = ceil(λ) [M(u_ib) + ∇p] after discretisation, which is
/// f_ib = ceil(λ) (u_ib − u*)/dt, solved together with the pressure in [`rounds`](Forcing::rounds)
/// passes. λ is the paper's ([`FractionRule::Centroid`]).
///
/// In cells that are solid (λ = 1) u_ib is the body's velocity. In surface cells (0 < λ < 1) it is
/// the parabola through the body's velocity at the surface point S and the fluid's at P₁ and P₂
/// on the outward normal ([`Reconstruction`]).
///
/// Its slip does not vanish with more rounds, since u_ib is not free of divergence, and bodies that
/// move through the grid feel cells switch on and off: prefer [`SmoothForcing`](crate::SmoothForcing)
/// for them.
#[derive(Clone, Debug)]
pub struct Hfdib {
    density: f64,
    rounds: usize,
    inside: [SolidFraction; 3],
    surface: [Reconstruction; 3],
    reactions: Vec<Wrench>,
}

impl Hfdib {
    /// Two rounds of forcing and pressure per step in a fluid of `density` \[kg/m³\].
    pub fn new(density: f64) -> Self {
        let inside = || SolidFraction::new().with_rule(FractionRule::Centroid);
        Self {
            density,
            rounds: 2,
            inside: [inside(), inside(), inside()],
            surface: Default::default(),
            reactions: Vec::new(),
        }
    }
    /// Another number of rounds; at least one is made.
    #[must_use]
    pub fn with_rounds(mut self, rounds: usize) -> Self {
        self.rounds = rounds.max(1);
        self
    }
    /// How often λ of a body was computed, over all velocity components.
    pub fn updates(&self) -> u64 {
        self.inside.iter().map(SolidFraction::updates).sum()
    }
    /// How many surface cells had to do with less than two fluid points so far.
    pub fn lowered(&self) -> u64 {
        self.surface.iter().map(Reconstruction::lowered).sum()
    }
}

impl Forcing for Hfdib {
    fn place(&mut self, velocity: &dyn VelocityField, bodies: &dyn Bodies) -> Result<(), IbmError> {
        self.reactions.clear();
        self.reactions.resize(bodies.n_bodies(), Wrench::default());
        for c in 0..velocity.dim() {
            let (lattice, storage) = (velocity.lattice(c), velocity.component(c).len());
            self.inside[c].update(lattice, bodies)?;
            self.surface[c].place(lattice, storage, bodies, &self.inside[c]);
        }
        Ok(())
    }

    /// λ and reconstruction find for themselves that other bodies are there now.
    fn renumber(&mut self, _: &Renumbering) {}

    fn density(&self) -> f64 {
        self.density
    }

    fn rounds(&self) -> usize {
        self.rounds
    }

    fn layer(&mut self, velocity: &dyn VelocityField, bodies: &dyn Bodies, b: BodyId) -> Layer {
        let mut layer = Layer::default();
        for c in 0..velocity.dim() {
            let u = velocity.component(c);
            let mut sums = LayerSums::default();
            for cell in self.surface[c].cells(b) {
                // The part of u* that the body's own motion replaces: a·(û/a), a the weight of U_S.
                let moved = bodies.surface_motion(b, cell.foot).unwrap_or_default()[c];
                let free = cell.value(moved, u);
                let solid = cell.surface.unwrap_or(0.0);
                let weight = self.density * cell.node.volume * (1.0 - cell.node.fraction) * solid;
                if weight > 0.0 {
                    sums.add(cell.foot, weight, (u[cell.node.index] - free) / solid);
                }
            }
            layer.add(c, &sums);
        }
        layer
    }

    fn internal_momentum(&mut self, velocity: &dyn VelocityField, _: &dyn Bodies, b: BodyId) -> Wrench {
        internal_momentum(&self.inside, self.density, velocity, b)
    }

    fn rigid_momentum(
        &mut self,
        velocity: &dyn VelocityField,
        _: &dyn Bodies,
        b: BodyId,
        twist: Twist,
    ) -> Wrench {
        rigid_momentum(&self.inside, self.density, velocity.dim(), b, twist)
    }

    fn force(&mut self, velocity: &mut dyn VelocityField, bodies: &dyn Kinematics) {
        let density = self.density;
        for (b, reaction) in self.reactions.iter_mut().enumerate() {
            let (body, twist) = (BodyId(b), bodies.twist(BodyId(b)));
            for c in 0..velocity.dim() {
                let u = velocity.component_mut(c);
                let mut set = |u: &mut [f64], node: &SolidNode, target: f64| {
                    let mut force = Vector::zeros();
                    force[c] = density * node.volume * (u[node.index] - target);
                    *reaction += Wrench::at(force, node.arm);
                    u[node.index] = target;
                };
                for node in self.inside[c].nodes(body).iter().filter(|n| n.fraction >= 1.0) {
                    set(u, node, twist.at(node.arm)[c]);
                }
                for cell in self.surface[c].cells(body) {
                    let target = cell.value(bodies.surface_velocity(body, cell.foot)[c], u);
                    set(u, &cell.node, target);
                }
            }
        }
    }

    fn reaction(&self, b: BodyId) -> Wrench {
        self.reactions.get(b.0).copied().unwrap_or_default()
    }

    fn slip(&self, velocity: &dyn VelocityField, bodies: &dyn Kinematics) -> f64 {
        let (mut sum, mut n) = (0.0, 0.0);
        for b in (0..self.reactions.len()).map(BodyId) {
            for c in 0..velocity.dim() {
                let (u, cells) = (velocity.component(c), self.surface[c].cells(b));
                for cell in cells {
                    sum += (u[cell.node.index] - cell.value(bodies.surface_velocity(b, cell.foot)[c], u))
                        .powi(2);
                }
                n += cells.len() as f64 / velocity.dim() as f64;
            }
        }
        if n > 0.0 { (sum / n).sqrt() } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Balls, Collocated, lattice};

    #[test]
    fn momentum_is_conserved_and_the_inside_moves_with_the_body() {
        let mut bodies = Balls::new(2, 0.5, vec![[0.1, 1.2, 0.0]]);
        bodies.twists[0] = Twist { linear: Vector::new(0.3, -0.2, 0.0), angular: Vector::new(0.0, 0.0, 0.7) };
        let mut velocity = Collocated::new(lattice(2, [0.05; 3], 3.0), |x| [x[1].sin(), x[0].cos(), 0.0]);
        let mut forcing = Hfdib::new(2.0);
        forcing.place(&velocity, &bodies).unwrap();
        let mass = 2.0 * velocity.lattice.volume([0; 3]);
        let total = |v: &Collocated, c: usize| v.values[c].iter().sum::<f64>() * mass;
        let before = [0, 1].map(|c| total(&velocity, c));
        forcing.force(&mut velocity, &bodies);
        for c in 0..2 {
            let gained = total(&velocity, c) - before[c];
            let lost = forcing.reaction(BodyId(0)).force[c];
            // Round-off of a sum of 3600 terms.
            assert!((gained + lost).abs() < 1e-12, "{c}: {gained} {lost}");
            for node in forcing.inside[c].nodes(BodyId(0)).iter().filter(|n| n.fraction == 1.0) {
                let target = bodies.twists[0].at(node.arm)[c];
                assert!((velocity.values[c][node.index] - target).abs() < 1e-15);
            }
        }
    }

    /// Two near bodies lower the order of both; the velocity stays finite.
    #[test]
    fn near_bodies_are_counted() {
        let bodies = Balls::new(2, 0.5, vec![[1.0, 1.2, 0.0], [2.05, 1.2, 0.0]]);
        let mut velocity = Collocated::new(lattice(2, [0.05; 3], 3.0), |_| [1.0; 3]);
        let mut forcing = Hfdib::new(1.0);
        forcing.place(&velocity, &bodies).unwrap();
        assert!(forcing.lowered() > 0);
        forcing.force(&mut velocity, &bodies);
        assert!(velocity.values[0].iter().all(|u| u.is_finite()));
    }
}
