//! The stress of walls on the fluid.
use super::gradients::{AtWall, corners, height, to_wall};
use super::openings::Openings;
use super::rows::Row;
use crate::linear::StencilMatrix;
use crate::{Field, FlowError};
use interfaces::{LawOfTheWall, Vector, WallPiece};

/// How the fluid meets immersed walls.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum WallStress {
    /// It sticks to them: τ = ρν ∂u/∂n.
    #[default]
    NoSlip,
    /// It slips along them.
    Slip,
    /// τ = ρ u_* u/u+(u_* y/ν), u what the law has at some distance y if it has Σ w u of the nodes around, w the weights of that place.
    ///
    /// u_* is [shared](LawOfTheWall::shared_friction_velocity) by k and u with `velocity_weight` w where the turbulence kinetic energy k is known, else that of u.
    Law {
        /// u+.
        law: LawOfTheWall,
        /// y along the normal over the cell's extent along it, above 0.
        distance: f64,
        /// w, 0 to 1.
        velocity_weight: f64,
    },
}

/// Velocity nodes nearer to a wall than this share of a cell are taken to be there.
const NEAREST: f64 = 0.05;
/// Nodes nearer than this share of a cell tell nothing of a logarithmic layer: what is left of a cell that is nearly shut moves with the fluid
/// beside it.
pub(super) const SLIVER: f64 = 0.25;

impl WallStress {
    /// The usual law of the wall and weight, seen from half a cell.
    pub const LAW_OF_THE_WALL: Self =
        Self::Law { law: LawOfTheWall::USUAL, distance: 0.5, velocity_weight: LawOfTheWall::VELOCITY_WEIGHT };

    /// Are its numbers possible?
    pub(super) fn check(self) -> Result<(), FlowError> {
        let Self::Law { distance, velocity_weight, .. } = self else { return Ok(()) };
        let parameter = |name, value, range| Err(FlowError::Parameter { name, value, range });
        if !(distance.is_finite() && distance > 0.0) {
            return parameter("the distance from which a wall sees the flow", distance, "finite and above 0");
        }
        if !(0.0..=1.0).contains(&velocity_weight) {
            return parameter(
                "the weight of the velocity in the friction velocity",
                velocity_weight,
                "0 to 1",
            );
        }
        Ok(())
    }

    /// The least distance at which gradients see walls, in extents of the cell along the normal; none if they do not.
    pub(super) fn nearest(self) -> Option<f64> {
        match self {
            Self::NoSlip => Some(0.0),
            Self::Slip => None,
            Self::Law { .. } => Some(SLIVER),
        }
    }
}

/// u_τ² over the velocity `u` at distance `y` from a wall \[m/s\], with u_τ if that is known.
fn friction(law: LawOfTheWall, [y, u]: [f64; 2], u_tau: Option<f64>, nu: f64) -> f64 {
    let plus = u_tau.map_or_else(|| law.y_plus(u * y / nu), |u_tau| u_tau * y / nu);
    // y+/u+ is 1 on the wall.
    let ratio = if plus > 0.0 { plus / law.u_plus(plus) } else { 1.0 };
    nu / y * ratio
}

/// Where the flow is seen by a wall, and what acts on it there.
pub(super) struct Probe {
    y: f64,
    /// Half of the cell's extent along the normal \[m\].
    pub(super) half: f64,
    /// Per component, range in `terms`.
    ranges: [(usize, usize); 3],
    /// Range in `cells`.
    cells: (usize, usize),
    /// Storage index of its cell.
    pub(super) cell: usize,
    pub(super) normal: Vector,
    pub(super) velocity: Vector,
    pub(super) area: f64,
    pub(super) body: usize,
    pub(super) arm: Vector,
}

/// A node around a probe.
struct Term {
    node: usize,
    weight: f64,
    /// Distance from the wall \[m\].
    y: f64,
    /// It does not count in a logarithmic layer.
    sliver: bool,
}

/// The part of a wall in a row.
struct Share {
    row: usize,
    probe: usize,
    /// Its area over the row's volume \[1/m\], and the area \[m²\].
    area: f64,
    whole: f64,
    /// 1/distance of the row's node from it.
    inv_y: f64,
}

/// The stress on all rows of all components.
pub(super) struct Stresses<const D: usize> {
    law: WallStress,
    pub(super) probes: Vec<Probe>,
    terms: Vec<Term>,
    cells: Vec<(usize, f64)>,
    shares: [Vec<Share>; D],
    /// Per probe: what the wall takes from the fluid per area and density \[m²/s²\], and that over the velocity.
    pub(super) traction: Vec<Vector>,
    friction: Vec<f64>,
    /// C_μ^¼ √k there, where k is known \[m/s\].
    of_k: Vec<Option<f64>>,
    /// By how much the velocity scale of the layer is above that ([`LawOfTheWall::layer_velocity`]) \[m/s\].
    raised: Vec<f64>,
    /// That which k and the velocity share.
    shared: Vec<Option<f64>>,
    /// Per probe: the force per density \[m⁴/s²\] on it in the last iteration.
    pub(super) force: Vec<Vector>,
}

impl<const D: usize> Stresses<D> {
    pub(super) fn new(openings: &Openings<D>, law: WallStress, rows: &[Vec<Row<D>>; D]) -> Self {
        let n = openings.walls.len();
        let mut this = Self {
            law,
            probes: Vec::new(),
            terms: Vec::new(),
            cells: Vec::new(),
            shares: std::array::from_fn(|_| Vec::new()),
            traction: vec![Vector::zeros(); n],
            friction: vec![0.0; n],
            of_k: vec![None; n],
            raised: vec![0.0; n],
            shared: vec![None; n],
            force: vec![Vector::zeros(); n],
        };
        for wall in openings.walls {
            let probe = this.probe(openings, wall);
            this.probes.push(probe);
        }
        for c in 0..D {
            let s = openings.grid.stride()[c];
            for (r, row) in rows[c].iter().enumerate() {
                let x = openings.node(c, row.index);
                for cell in [row.index - s, row.index] {
                    let Some((probe, wall)) = openings.piece(cell) else { continue };
                    let part = |o: usize| openings.open[c].data()[o] * openings.area(c, o);
                    let whole = wall.area * part(row.index) / (part(cell) + part(cell + s));
                    let y = Vector::from_fn(|a, _| if a < D { to_wall(&wall, x)[a] } else { 0.0 }).norm();
                    let least = 1e-3 * openings.metrics.axes[c].width[openings.at(cell)[c]];
                    let (area, inv_y) = (whole * row.inv_volume, 1.0 / y.max(least));
                    this.shares[c].push(Share { row: r, probe, area, whole, inv_y });
                }
            }
        }
        this
    }

    fn probe(&mut self, openings: &Openings<D>, wall: &WallPiece) -> Probe {
        let index = openings.grid.place(openings.grid.cell(wall.cell));
        let mut probe = Probe {
            y: 0.0,
            half: 0.5 * openings.extent(index, wall),
            ranges: [(0, 0); 3],
            cells: (0, 0),
            cell: index,
            normal: wall.normal,
            velocity: wall.velocity,
            area: wall.area,
            body: wall.body,
            arm: wall.arm,
        };
        let WallStress::Law { distance, .. } = self.law else { return probe };
        probe.y = 2.0 * distance * probe.half;
        let x: [f64; D] = std::array::from_fn(|a| wall.foot[a] + probe.y * wall.normal[a]);
        for c in 0..D {
            let first = self.terms.len();
            let corners = corners(openings, Some(c), x, index, |o| openings.alive(c, o));
            let part = |node: usize| height(wall, openings.node(c, node)) / (2.0 * probe.half);
            let any = corners.iter().any(|&(node, _)| part(node) >= SLIVER);
            self.terms.extend(corners.into_iter().map(|(node, weight)| Term {
                node,
                weight,
                y: 2.0 * probe.half * part(node).max(NEAREST),
                sliver: any && part(node) < SLIVER,
            }));
            probe.ranges[c] = (first, self.terms.len());
        }
        let first = self.cells.len();
        self.cells.extend(corners(openings, None, x, index, |o| openings.wet[o]));
        probe.cells = (first, self.cells.len());
        probe
    }

    /// State of every piece of wall: traction, force, friction over velocity, increase of the
    /// layer's velocity scale, and the speeds of k and of both, NaN without k.
    pub(super) fn numbers(&self) -> Vec<f64> {
        let piece = |p: usize| {
            let speeds = [self.of_k[p], self.shared[p]].map(|speed| speed.unwrap_or(f64::NAN));
            let vectors = [self.traction[p], self.force[p]];
            let vectors = vectors.into_iter().flat_map(|v| [v.x, v.y, v.z]);
            vectors.chain([self.friction[p], self.raised[p], speeds[0], speeds[1]])
        };
        (0..self.probes.len()).flat_map(piece).collect()
    }

    /// Takes back [`numbers`](Self::numbers).
    pub(super) fn set_numbers(&mut self, numbers: &[f64]) {
        for (p, &[tx, ty, tz, fx, fy, fz, friction, raised, k, shared]) in
            numbers.as_chunks().0.iter().enumerate()
        {
            self.traction[p] = Vector::new(tx, ty, tz);
            self.force[p] = Vector::new(fx, fy, fz);
            (self.friction[p], self.raised[p]) = (friction, raised);
            [self.of_k[p], self.shared[p]] = [k, shared].map(|speed| (!speed.is_nan()).then_some(speed));
        }
    }

    /// Samples k.
    pub(super) fn see(&mut self, k: Option<&Field<D>>) {
        if !matches!(self.law, WallStress::Law { .. }) {
            return;
        }
        for (of_k, probe) in self.of_k.iter_mut().zip(&self.probes) {
            let k = k.map(|k| {
                self.cells[probe.cells.0..probe.cells.1].iter().map(|&(o, w)| w * k.data()[o]).sum()
            });
            *of_k = k.map(LawOfTheWall::friction_velocity);
        }
    }

    /// Looks at the flow.
    pub(super) fn update(&mut self, velocity: &[Field<D>; D], k: Option<&Field<D>>, nu: f64) {
        let WallStress::Law { law, velocity_weight, .. } = self.law else { return };
        self.see(k);
        for p in 0..self.probes.len() {
            let before = self.raised[p];
            self.sample(p, velocity, nu, (law, velocity_weight));
            // The velocity is sampled by the scale of the layer, which it may raise.
            if self.raised[p] != before {
                self.sample(p, velocity, nu, (law, velocity_weight));
            }
        }
    }

    /// Samples the velocity by piece `p`, and sets its friction.
    fn sample(
        &mut self,
        p: usize,
        velocity: &[Field<D>; D],
        nu: f64,
        (law, velocity_weight): (LawOfTheWall, f64),
    ) {
        let probe = &self.probes[p];
        let scale = self.speed(p) / nu;
        // In fluid at rest the law is that of the viscous sublayer.
        let law_at = |y: f64| if scale > 0.0 { law.u_plus(scale * y) } else { y };
        let logarithmic = self.logarithmic(p, nu);
        let mut u = Vector::zeros();
        for c in 0..D {
            let (first, last) = probe.ranges[c];
            let [mut sum, mut plus] = [0.0; 2];
            for term in &self.terms[first..last] {
                let weight = term.weight * if term.sliver { 1.0 - logarithmic } else { 1.0 };
                sum += weight * (velocity[c].data()[term.node] - probe.velocity[c]);
                plus += weight * law_at(term.y);
            }
            u[c] = sum / plus * law_at(probe.y);
        }
        u -= probe.normal * probe.normal.dot(&u);
        let place = [probe.y, u.norm()];
        self.raised[p] = self.of_k[p].map_or(0.0, |k| law.layer_velocity(k, place, nu, velocity_weight) - k);
        let speed = self.of_k[p].map(|k| law.shared_friction_velocity(k, place, nu, velocity_weight));
        self.friction[p] = friction(law, place, speed, nu);
        self.traction[p] = u * self.friction[p];
        self.shared[p] = speed;
    }

    /// Of every piece of wall the u_τ by which it has its friction \[m/s\]: that which k and the velocity share, or that of the friction itself where there is no k.
    pub(super) fn friction_velocities(&self) -> impl Iterator<Item = f64> + '_ {
        let own = |p: usize| (self.force[p].norm() / self.probes[p].area).sqrt();
        self.shared.iter().enumerate().map(move |(p, shared)| shared.unwrap_or_else(|| own(p)))
    }

    /// Velocity scale of the layer beside a piece of wall \[m/s\].
    fn speed(&self, piece: usize) -> f64 {
        self.of_k[piece].map_or_else(|| self.traction[piece].norm().sqrt(), |k| k + self.raised[piece])
    }

    /// Is the layer beside a piece of wall logarithmic? From 0 in the viscous sublayer to 1.
    pub(super) fn logarithmic(&self, piece: usize, nu: f64) -> f64 {
        LawOfTheWall::logarithmic(self.y_plus(piece, nu))
    }

    /// y+ of half a cell.
    pub(super) fn y_plus(&self, piece: usize, nu: f64) -> f64 {
        self.speed(piece) * self.probes[piece].half / nu
    }

    /// What a wall tells gradients of component `c`: where cells are much larger than the viscous sublayer the nodes around say more of
    /// the flow.
    pub(super) fn at_wall(&self, piece: usize, c: usize, nu: f64) -> AtWall {
        let probe = &self.probes[piece];
        let share = match self.law {
            WallStress::Law { .. } => {
                // A half where half a cell is as high as a layer that begins to be logarithmic.
                1.0 / (1.0 + (self.y_plus(piece, nu) / LawOfTheWall::LOGARITHMIC).powi(2))
            }
            _ => 1.0,
        };
        AtWall { velocity: probe.velocity[c], share }
    }

    /// What a wall takes from the fluid per area and density \[m²/s²\].
    pub(super) fn of(&self, piece: usize) -> f64 {
        match self.law {
            WallStress::Law { .. } => self.traction[piece].norm(),
            _ => self.force[piece].norm() / self.probes[piece].area,
        }
    }

    /// Tangential velocity at distance `y` from the wall that goes with its friction and k, by the law where there is one.
    pub(super) fn seen(&self, piece: usize, y: f64, nu: f64) -> f64 {
        let WallStress::Law { law, .. } = self.law else {
            return self.of(piece) * y / nu;
        };
        let (stress, speed) = (self.of(piece), self.speed(piece));
        if speed > 0.0 { stress / speed * law.u_plus(speed * y / nu) } else { stress * y / nu }
    }

    /// Adds the stress to the equations of component `c`: right-hand sides and diagonals.
    pub(super) fn add(
        &mut self,
        c: usize,
        rows: &[Row<D>],
        u: &[f64],
        nu: f64,
        sums: &mut [f64],
        matrix: &mut StencilMatrix<D>,
    ) {
        self.force.iter_mut().for_each(|f| f[c] = 0.0);
        if self.law == WallStress::Slip {
            return;
        }
        let centre = matrix.parts_mut().0;
        for share in &self.shares[c] {
            let (row, probe) = (&rows[share.row], &self.probes[share.probe]);
            let (stress, rate) = if self.law == WallStress::NoSlip {
                (nu * share.inv_y * (u[row.index] - probe.velocity[c]), nu * share.inv_y)
            } else {
                let normal = probe.normal[c];
                (self.traction[share.probe][c], self.friction[share.probe] * (1.0 - normal * normal))
            };
            sums[share.row] -= share.area * stress;
            centre[row.cell] += share.area * rate;
            self.force[share.probe][c] += share.whole * stress;
        }
    }
}
