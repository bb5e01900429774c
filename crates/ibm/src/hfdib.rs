//! The paper's forcing: velocity values set in the cells that a body covers.
use crate::smooth::internal_momentum;
use crate::{Forcing, IbmError, Layer, SolidFraction, SolidNode};
use interfaces::{Bodies, BodyId, Kinematics, Lattice, Point, Vector, VelocityField, Wrench};

/// Hybrid fictitious domain–immersed boundary forcing (Isoz et al. 2023, equations 1–2 and
/// figure 3): f_ib = ceil(λ) [M(u_ib) + ∇p] after discretisation, which is
/// f_ib = ceil(λ) (u_ib − u*)/dt, solved together with the pressure in [`rounds`](Forcing::rounds)
/// passes.
///
/// In cells that are solid (λ = 1) u_ib is the body's velocity. In surface cells (0 < λ < 1) it is
/// the parabola through the body's velocity at the surface point S and the fluid's at P₁ and P₂
/// on the outward normal, taken at the cell's centre P. P₁ is the first point whose interpolation
/// uses no forced cell; where there is none within three cells the order is lowered to one point,
/// or none, and counted. Where P itself lies inside the body, u_ib is the body's velocity at S: the
/// parabola would have to extrapolate there, which makes free bodies unstable as the step shrinks
/// (two discs, 15 cells per diameter: diverged at dt ≤ 1.25e-4 s; without: stable down to 5e-5 s).
///
/// Its slip does not vanish with more rounds, since u_ib is not free of divergence, and bodies that
/// move through the grid feel cells switch on and off: prefer [`SmoothForcing`](crate::SmoothForcing)
/// for them.
#[derive(Clone, Debug)]
pub struct Hfdib {
    density: f64,
    rounds: usize,
    inside: [SolidFraction; 3],
    bodies: Vec<Cells>,
    forced: Vec<bool>,
    lowered: u64,
}

#[derive(Clone, Debug, Default)]
struct Cells {
    surface: [Vec<SurfaceCell>; 3],
    reaction: Wrench,
}

/// A surface cell: u_ib = `solid`·U_S + Σ weight·u.
#[derive(Clone, Debug)]
struct SurfaceCell {
    node: SolidNode,
    /// Arm of the surface point S.
    foot: Vector,
    solid: f64,
    fluid: [(usize, f64); 16],
}

impl Hfdib {
    /// Two rounds of forcing and pressure per step in a fluid of `density` \[kg/m³\].
    pub fn new(density: f64) -> Self {
        Self {
            density,
            rounds: 2,
            inside: Default::default(),
            bodies: Vec::new(),
            forced: Vec::new(),
            lowered: 0,
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
        self.lowered
    }
}

/// Multilinear interpolation at `x`: up to eight (index, weight) pairs, or `None` outside a
/// bounded side.
fn interpolation(lattice: &Lattice, x: Point) -> Option<[(usize, f64); 8]> {
    let mut out = [(lattice.base, 0.0); 8];
    let (first, part) = lattice.locate(x);
    for corner in 0..1 << lattice.dim {
        let up = [corner & 1, (corner >> 1) & 1, (corner >> 2) & 1];
        let index = lattice.index(std::array::from_fn(|a| first[a] + up[a] as isize))?;
        let weight = (0..lattice.dim).map(|a| if up[a] == 1 { part[a] } else { 1.0 - part[a] }).product();
        out[corner] = (index, weight);
    }
    Some(out)
}

/// Weights of the parabola (line, constant) through values at distances 0, `s1`, `s2`, taken at `s`.
fn profile(s: f64, s1: Option<f64>, s2: Option<f64>) -> [f64; 3] {
    match (s1, s2) {
        (Some(s1), Some(s2)) => [
            (s - s1) * (s - s2) / (s1 * s2),
            s * (s - s2) / (s1 * (s1 - s2)),
            s * (s - s1) / (s2 * (s2 - s1)),
        ],
        (Some(s1), None) => [1.0 - s / s1, s / s1, 0.0],
        _ => [1.0, 0.0, 0.0],
    }
}

impl Forcing for Hfdib {
    fn place(&mut self, velocity: &dyn VelocityField, bodies: &dyn Bodies) -> Result<(), IbmError> {
        self.bodies.resize_with(bodies.n_bodies(), Cells::default);
        for cells in &mut self.bodies {
            cells.reaction = Wrench::default();
        }
        for c in 0..velocity.dim() {
            let lattice = velocity.lattice(c);
            let before = self.inside[c].updates();
            self.inside[c].update(lattice, bodies)?;
            if self.inside[c].updates() == before {
                continue;
            }
            // Which cells of any body are forced, for a moment.
            self.forced.resize(velocity.component(c).len(), false);
            let mark = |forced: &mut [bool], to| {
                (0..bodies.n_bodies())
                    .flat_map(|b| self.inside[c].nodes(BodyId(b)))
                    .for_each(|n| forced[n.index] = to);
            };
            mark(&mut self.forced, true);
            let root = 1.0 / lattice.dim as f64;
            for (b, cells) in self.bodies.iter_mut().enumerate() {
                let (solid, pose) = (bodies.solid(BodyId(b)), bodies.pose(BodyId(b)));
                cells.surface[c].clear();
                // Twice what is there now, so that a moving body allocates nothing.
                let room = self.inside[c].nodes(BodyId(b)).len();
                if cells.surface[c].capacity() < room {
                    cells.surface[c].reserve(2 * room);
                }
                for node in self.inside[c].nodes(BodyId(b)).iter().filter(|n| n.fraction < 1.0) {
                    let h = node.volume.powf(root);
                    let local = pose.to_body(pose.position + node.arm);
                    let normal = pose.orientation * solid.normal(local, h);
                    let foot = node.arm - normal * node.distance;
                    // The first point on the normal that sees free fluid only.
                    let free = |s: f64| {
                        let stencil = interpolation(lattice, pose.position + foot + normal * s)?;
                        stencil.iter().all(|&(i, w)| w == 0.0 || !self.forced[i]).then_some((s, stencil))
                    };
                    let p1 = (2..=12).find_map(|i| free(0.25 * h * f64::from(i)));
                    let p2 = p1.and_then(|(s, _)| free(s + h));
                    self.lowered += u64::from(p2.is_none());
                    let weights = profile(node.distance.max(0.0), p1.map(|p| p.0), p2.map(|p| p.0));
                    let mut fluid = [(lattice.base, 0.0); 16];
                    for (p, (stencil, weight)) in [(p1, weights[1]), (p2, weights[2])]
                        .into_iter()
                        .filter_map(|(p, w)| Some((p?.1, w)))
                        .enumerate()
                    {
                        for (at, (i, w)) in stencil.into_iter().enumerate() {
                            fluid[8 * p + at] = (i, w * weight);
                        }
                    }
                    cells.surface[c].push(SurfaceCell { node: *node, foot, solid: weights[0], fluid });
                }
            }
            mark(&mut self.forced, false);
        }
        Ok(())
    }

    fn density(&self) -> f64 {
        self.density
    }

    fn rounds(&self) -> usize {
        self.rounds
    }

    fn layer(&self, velocity: &dyn VelocityField, b: BodyId) -> Layer {
        let mut layer = Layer::default();
        for c in 0..velocity.dim() {
            let u = velocity.component(c);
            for cell in &self.bodies[b.0].surface[c] {
                // The part of u* that the body's own motion replaces: a·(û/a), a the weight of U_S.
                let free: f64 = cell.fluid.iter().map(|&(i, w)| w * u[i]).sum();
                let weight = self.density * cell.node.volume * (1.0 - cell.node.fraction) * cell.solid;
                if weight > 0.0 {
                    layer.add(c, cell.foot, weight, (u[cell.node.index] - free) / cell.solid);
                }
            }
        }
        layer
    }

    fn internal_momentum(&self, velocity: &dyn VelocityField, b: BodyId) -> Wrench {
        internal_momentum(&self.inside, self.density, velocity, b)
    }

    fn force(&mut self, velocity: &mut dyn VelocityField, bodies: &dyn Kinematics) {
        for (b, cells) in self.bodies.iter_mut().enumerate() {
            let twist = bodies.twist(BodyId(b));
            for c in 0..velocity.dim() {
                let u = velocity.component_mut(c);
                let (reaction, density) = (&mut cells.reaction, self.density);
                let mut set = |u: &mut [f64], node: &SolidNode, target: f64| {
                    let mut force = Vector::zeros();
                    force[c] = density * node.volume * (u[node.index] - target);
                    *reaction += Wrench::at(force, node.arm);
                    u[node.index] = target;
                };
                for node in self.inside[c].nodes(BodyId(b)).iter().filter(|n| n.fraction >= 1.0) {
                    set(u, node, twist.at(node.arm)[c]);
                }
                for cell in &cells.surface[c] {
                    let target = cell.target(twist.at(cell.foot)[c], u);
                    set(u, &cell.node, target);
                }
            }
        }
    }

    fn reaction(&self, b: BodyId) -> Wrench {
        self.bodies.get(b.0).map_or_else(Wrench::default, |body| body.reaction)
    }

    fn slip(&self, velocity: &dyn VelocityField, bodies: &dyn Kinematics) -> f64 {
        let (mut sum, mut n) = (0.0, 0.0);
        for (b, cells) in self.bodies.iter().enumerate() {
            let twist = bodies.twist(BodyId(b));
            for c in 0..velocity.dim() {
                let u = velocity.component(c);
                for cell in &cells.surface[c] {
                    sum += (u[cell.node.index] - cell.target(twist.at(cell.foot)[c], u)).powi(2);
                }
                n += cells.surface[c].len() as f64 / velocity.dim() as f64;
            }
        }
        if n > 0.0 { (sum / n).sqrt() } else { 0.0 }
    }
}

impl SurfaceCell {
    /// u_ib of this cell.
    fn target(&self, at_surface: f64, u: &[f64]) -> f64 {
        self.solid * at_surface + self.fluid.iter().map(|&(i, w)| w * u[i]).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Balls, Collocated, lattice};
    use interfaces::Twist;

    /// A field that vanishes on the disc of radius ½ around (1.1, 1.2): d + 0.8 d² beyond it.
    fn outside(x: [f64; 3]) -> [f64; 3] {
        let d = (x[0] - 1.1).hypot(x[1] - 1.2) - 0.5;
        [d + 0.8 * d * d, 0.0, 0.0]
    }

    fn worst(cells: f64) -> f64 {
        let bodies = Balls::new(2, 0.5, vec![[1.1, 1.2, 0.0]]);
        let mut velocity = Collocated::new(lattice(2, [1.0 / cells; 3], 3.0), outside);
        let exact = velocity.values[0].clone();
        let mut forcing = Hfdib::new(1.0);
        forcing.place(&velocity, &bodies).unwrap();
        assert_eq!(forcing.lowered(), 0);
        forcing.force(&mut velocity, &bodies);
        let cells = forcing.bodies[0].surface[0].iter().filter(|c| c.node.distance > 0.0);
        cells.map(|c| (velocity.values[0][c.node.index] - exact[c.node.index]).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn reconstruction_is_second_order() {
        let errors = [20.0, 40.0, 80.0].map(worst);
        let order = (errors[0] / errors[2]).log2() / 2.0;
        assert!(order > 1.8, "{errors:?}: {order}");
    }

    #[test]
    fn the_profile_meets_its_points_and_falls_back() {
        let parabola = |s: f64| 2.0 - 3.0 * s + 5.0 * s * s;
        let w = profile(0.3, Some(1.1), Some(2.3));
        let found = w[0] * parabola(0.0) + w[1] * parabola(1.1) + w[2] * parabola(2.3);
        assert!((found - parabola(0.3)).abs() < 1e-14);
        let line = profile(0.3, Some(1.2), None);
        assert!((line[0] - 0.75).abs() < 1e-15 && (line[1] - 0.25).abs() < 1e-15 && line[2] == 0.0);
        assert_eq!(profile(0.3, None, None), [1.0, 0.0, 0.0]);
    }

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

    /// Between two near bodies there is no room for P₁ and P₂: the order is lowered and counted.
    #[test]
    fn a_near_neighbour_lowers_the_order() {
        let bodies = Balls::new(2, 0.5, vec![[1.0, 1.2, 0.0], [2.05, 1.2, 0.0]]);
        let mut velocity = Collocated::new(lattice(2, [0.05; 3], 3.0), |_| [1.0; 3]);
        let mut forcing = Hfdib::new(1.0);
        forcing.place(&velocity, &bodies).unwrap();
        assert!(forcing.lowered() > 0);
        forcing.force(&mut velocity, &bodies);
        assert!(velocity.values[0].iter().all(|u| u.is_finite()));
    }
}
