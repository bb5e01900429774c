//! Direct forcing at surface markers, spread by a smooth kernel.
mod clearance;
mod curvature;
mod markers;
mod overlap;
mod slip;
mod stencils;

use crate::crowd::Crowd;
use crate::forcing::LayerSums;
use crate::neighbour::Neighbour;
use crate::solid_fraction::check;
use crate::{Forcing, IbmError, Kernel, Layer, SolidFraction, SolidNode, ViscousStep};
use clearance::Clearance;
use interfaces::{
    Aabb, Bodies, BodyId, Kinematics, Lattice, Point, Pose, Renumbering, Twist, Vector, VelocityField, Wrench,
};
use markers::Markers;

/// Smooth direct forcing (Uhlmann 2005; several passes as in Wang et al. 2008; a smooth [`Kernel`] as Yang et al. 2009) with markers on the surface that make up for what
/// the kernel blurs there:
///
/// ```text
/// (1 + β P_t) Δg_m = (U + Ω×r_m + u_s + s − E u)_m,   s = −β P_t g_m,   β = r h/(c ν dt),   P_t = 1 − nnᵀ
/// u += Σ_m δ_h(x − x_m) (Δg_m/c) A_m h
/// ```
///
/// u_s is the surface's own motion, if it has one; E reads the velocity at the markers with the same kernel that spreads; g is the sum of the Δg of the passes of a step, and c the kernel's
/// [`self_overlap`](Kernel::self_overlap). Where there is shear γ = τ/μ, τ being the force per area that markers put on the fluid, the kernel blurs the kink of the velocity, and they read
/// r γ less than there is without slip (r about the kernel's [`retraction`](Kernel::retraction)): they ask for that. It is right to second order in the size of the cells for drag, torque and strain alike.
/// ν dt is told by [`begin`](Forcing::begin) (`coupling::Particles` do).
///
/// Where it is not known, and near other surfaces, markers stand inside the body instead: at the depth r_d of the kernel's retraction and 1.75 r_d² times the sum of the principal curvatures more, where they read no slip.
/// From three cells to two away from another body or a side of the box they go from the one to the other. ([`SmoothFilm`](crate::SmoothFilm) tells what is missing of films then; markers on the
/// surface reach farther across them, which makes them up to twice as stiff as they are.)
///
/// Momentum is conserved: what the fluid gets, the body loses.
#[derive(Clone, Debug)]
pub struct SmoothForcing {
    density: f64,
    /// The step under way, once one is known.
    step: Option<ViscousStep>,
    /// Other than that suited.
    kernel: Option<Kernel>,
    passes: usize,
    inside: [SolidFraction; 3],
    bodies: Vec<Markers>,
    crowd: Crowd,
    /// Bodies were taken away or added since the crowd was looked at.
    renumbered: bool,
    /// Those that have moved.
    moves: Vec<bool>,
    clearance: Clearance,
    /// Periodic images of the body at hand.
    neighbours: Vec<Neighbour>,
    /// Places of the markers of a body.
    places: Vec<Point>,
    /// A velocity per marker of a body.
    values: [Vec<f64>; 3],
    /// Three numbers per marker.
    outside: [Vec<f64>; 3],
    /// Zeros between uses, as long as a velocity component.
    scratch: Vec<f64>,
}

impl SmoothForcing {
    /// Fewer cells across a body than this cannot hold its markers.
    pub const LEAST_CELLS: f64 = 4.0;

    /// Markers 1 (plane) or 1¼ (space) cells apart, the kernel [suited](Kernel::suited) and three passes, in a fluid of `density`
    /// \[kg/m³\].
    pub fn new(density: f64) -> Self {
        Self {
            density,
            step: None,
            kernel: None,
            passes: 3,
            inside: Default::default(),
            bodies: Vec::new(),
            crowd: Crowd::default(),
            renumbered: false,
            moves: Vec::new(),
            clearance: Clearance::default(),
            neighbours: Vec::new(),
            places: Vec::new(),
            values: Default::default(),
            outside: Default::default(),
            scratch: Vec::new(),
        }
    }
    /// Another kernel.
    #[must_use]
    pub fn with_kernel(mut self, kernel: Kernel) -> Self {
        self.kernel = Some(kernel);
        self
    }
    /// Another number of passes; at least one is made.
    #[must_use]
    pub fn with_passes(mut self, passes: usize) -> Self {
        self.passes = passes.max(1);
        self
    }
    /// How often λ of a body was computed, over all velocity components.
    pub fn updates(&self) -> u64 {
        self.inside.iter().map(SolidFraction::updates).sum()
    }

    fn kernel(&self, dim: usize) -> Kernel {
        self.kernel.unwrap_or_else(|| Kernel::suited(dim))
    }

    /// Least and largest distance \[m\] of nodes along an axis that the markers of a body within
    /// `bounds` reach, on the lattices of the velocity's components; whether they are equal, as
    /// they have to be.
    pub fn spacings<'a>(
        &self,
        lattices: impl Iterator<Item = &'a Lattice> + Clone,
        axis: usize,
        bounds: &Aabb,
    ) -> ([f64; 2], bool) {
        let kernel = self.kernel(lattices.clone().count());
        let (from, to) = (bounds.min[axis], bounds.max[axis]);
        let [least, most] = lattices.fold([f64::INFINITY, 0.0], |[least, most]: [f64; 2], lattice| {
            let nodes = &lattice.axes[axis];
            let [_, here] = nodes.spacings(from, to);
            let reach = kernel.reach() * here;
            let [low, high] = nodes.spacings(from - reach, to + reach);
            [least.min(low), most.max(high)]
        });
        ([least, most], most - least <= UNEQUAL * most)
    }

    /// Volume of the cells that the markers of a body reach, which must all be equal.
    fn uniform_cell(
        &self,
        velocity: &dyn VelocityField,
        bodies: &dyn Bodies,
        body: BodyId,
    ) -> Result<f64, IbmError> {
        let bounds = bodies.aabb(body);
        let lattices = (0..velocity.dim()).map(|c| velocity.lattice(c));
        let mut cell = 1.0;
        for axis in 0..velocity.dim() {
            let ([least, most], equal) = self.spacings(lattices.clone(), axis, &bounds);
            if !equal {
                return Err(IbmError::Stretched { body, axis, least, most });
            }
            let narrowest = lattices.clone().map(|lattice| {
                let nodes = &lattice.axes[axis];
                nodes.spacings(nodes.place(0), nodes.place(nodes.len() as isize - 1))[0]
            });
            let narrowest = narrowest.fold(f64::INFINITY, f64::min);
            // The narrowest cells give the same number wherever the body is, to the last bit: a run
            // that goes on makes the same markers.
            cell *= if least - narrowest <= UNEQUAL * narrowest { narrowest } else { least };
        }
        Ok(cell)
    }

    fn place_body(
        &mut self,
        velocity: &dyn VelocityField,
        bodies: &dyn Bodies,
        b: BodyId,
    ) -> Result<(), IbmError> {
        let dim = velocity.dim();
        let kernel = self.kernel(dim);
        let cell = self.uniform_cell(velocity, bodies, b)?;
        let h = cell.powf(1.0 / dim as f64);
        let markers = &mut self.bodies[b.0];
        let pose = bodies.pose(b);
        let mut turned = markers.pose.is_none_or(|old| old.orientation != pose.orientation);
        // Made once, unless the body has come to where the cells are of another size.
        let made = markers.elements.is_empty() || (cell / markers.cell - 1.0).abs() > 3.0 * UNEQUAL;
        if made {
            let extent = bodies.solid(b).aabb().extent();
            let size = extent.x.min(extent.y).min(if dim == 3 { extent.z } else { f64::INFINITY });
            if size < Self::LEAST_CELLS * h {
                return Err(IbmError::TooCoarse { body: b, size, spacing: h, least: Self::LEAST_CELLS });
            }
            markers.cell = cell;
            let spacing = if dim == 2 { 1.0 } else { SPACING };
            markers.make(bodies.solid(b), dim, [h, spacing * h, kernel.retraction() * h]);
            if markers.elements.is_empty() {
                return Err(IbmError::NoSurface { body: b, offset: -kernel.retraction() * h });
            }
            turned = true;
        }
        let moved = markers.pose != Some(pose);
        let long = self.meets_itself(velocity, bodies, b);
        // Overlaps depend on the pose alone, so that a restart finds the same: long bodies are
        // evaluated at their place, others at a fixed one.
        let markers = &mut self.bodies[b.0];
        if !long && (made || markers.long) {
            markers.turn(&middle(velocity));
            self.find_overlaps(velocity, bodies, (b, middle(velocity)), false);
            turned = true;
        }
        let markers = &mut self.bodies[b.0];
        markers.long = long;
        if turned {
            markers.turn(&pose);
        }
        if long && (made || moved) {
            self.find_overlaps(velocity, bodies, (b, pose), true);
            turned = true;
        }
        let Self { places, clearance, crowd, .. } = self;
        let markers = &mut self.bodies[b.0];
        // Where the viscosity is not known, nothing can be made up for.
        let share = if self.step.is_some() {
            let surface = markers.surface.iter().map(|arm| pose.position + arm);
            clearance.share(velocity, bodies, b, crowd.others(b.0), (surface, h))
        } else {
            0.0
        };
        if !turned && markers.share == share && markers.pose == Some(pose) {
            return Ok(());
        }
        if turned || markers.share != share {
            markers.stand(share, self.density * h / kernel.self_overlap(), dim);
        }
        markers.set_stencils(kernel, velocity, &pose, places);
        if !markers.overlaps.is_empty() {
            let Markers { stencils, overlaps, .. } = markers;
            stencils.relax_by(overlaps);
        }
        Ok(())
    }

    /// Finds the bodies whose markers reach where others do.
    fn find_crowd(&mut self, velocity: &dyn VelocityField, bodies: &dyn Bodies) {
        let axes = &velocity.lattice(0).axes;
        let reach = self.kernel(velocity.dim()).reach() + 1.0;
        self.crowd.boxes.clear();
        self.crowd.boxes.extend((0..bodies.n_bodies()).map(|b| {
            let mut bounds = bodies.aabb(BodyId(b));
            for a in 0..velocity.dim() {
                let [_, widest] = axes[a].spacings(bounds.min[a], bounds.max[a]);
                bounds.min[a] -= reach * widest;
                bounds.max[a] += reach * widest;
            }
            bounds
        }));
        self.crowd.find(Vector::from_fn(|a, _| axes[a].period().unwrap_or(0.0)));
    }

    /// 1 − χ of the markers of body `b`, χ = E λ: the shares of their fluid outside the body.
    fn find_outside(&mut self, velocity: &dyn VelocityField, c: usize, b: BodyId, out: &mut Vec<f64>) {
        let nodes = self.inside[c].nodes(b);
        self.scratch.resize(velocity.component(c).len(), 0.0);
        nodes.iter().for_each(|n| self.scratch[n.index] += n.fraction);
        self.bodies[b.0].stencils.read(c, velocity.lattice(c), &self.scratch, out);
        out.iter_mut().for_each(|share| *share = 1.0 - *share);
        nodes.iter().for_each(|n| self.scratch[n.index] = 0.0);
    }
}

/// A place on the lattice, far from bounded sides, without a turn.
fn middle(velocity: &dyn VelocityField) -> Pose {
    let axes = &velocity.lattice(0).axes[..velocity.dim()];
    let at = |a: usize| axes.get(a).map_or(0.0, |nodes| nodes.place(nodes.len() as isize / 2));
    Pose::at([at(0), at(1), at(2)])
}

/// Distances of nodes that differ by no more than this are equal.
const UNEQUAL: f64 = 1e-6;

/// Cells from marker to marker in space. On a moving sphere the drag is the same to 1e-4 as with markers a cell apart, its noise
/// stays below 0.2 %, and there are two thirds as many of them.
const SPACING: f64 = 1.25;

impl Forcing for SmoothForcing {
    fn place(&mut self, velocity: &dyn VelocityField, bodies: &dyn Bodies) -> Result<(), IbmError> {
        self.renumbered |= self.bodies.len() != bodies.n_bodies();
        self.bodies.resize_with(bodies.n_bodies(), Markers::default);
        for (c, inside) in self.inside.iter_mut().enumerate().take(velocity.dim()) {
            if inside.resize(velocity.lattice(c), bodies.n_bodies()) {
                // Another grid.
                self.bodies.fill_with(Markers::default);
            }
        }
        self.moves.clear();
        let moves = |(b, markers): (usize, &Markers)| markers.pose != Some(bodies.pose(BodyId(b)));
        self.moves.extend(self.bodies.iter().enumerate().map(moves));
        let any = self.renumbered || self.moves.contains(&true);
        if any {
            self.find_crowd(velocity, bodies);
        }
        let dim = velocity.dim();
        let mut near_ones_placed = false;
        for b in 0..bodies.n_bodies() {
            // Where a body's markers stand depends on what is near, too.
            let stirred = any && (self.renumbered || self.crowd.stirs(b, &self.moves));
            if self.moves[b] || stirred || self.bodies[b].known != self.step.is_some() {
                for c in 0..dim {
                    check(velocity.lattice(c), bodies, BodyId(b))?;
                }
                self.place_body(velocity, bodies, BodyId(b))?;
                near_ones_placed |= !self.bodies[b].joint.is_empty() || self.crowds(b);
            }
            let (kernel, step, markers) = (self.kernel(dim), self.step, &mut self.bodies[b]);
            markers.pose = Some(bodies.pose(BodyId(b)));
            (markers.alone, markers.known) = (self.crowd.alone[b], step.is_some());
            markers.reaction = Wrench::default();
            markers.slip.begin(step, kernel, markers.cell.powf(1.0 / dim as f64), markers.share);
        }
        if near_ones_placed {
            self.find_joint_overlaps(velocity);
        }
        self.renumbered = false;
        Ok(())
    }

    fn renumber(&mut self, numbers: &Renumbering) {
        numbers.apply(&mut self.bodies);
        self.inside.iter_mut().for_each(|inside| inside.renumber(numbers));
        self.crowd.renumber();
        self.renumbered = true;
    }

    fn density(&self) -> f64 {
        self.density
    }

    fn rounds(&self) -> usize {
        1
    }

    fn begin(&mut self, step: Option<ViscousStep>) {
        self.step = step;
    }

    fn layer(&mut self, velocity: &dyn VelocityField, bodies: &dyn Bodies, b: BodyId) -> Layer {
        let mut layer = Layer::default();
        let (mut outside, mut found) = (std::mem::take(&mut self.outside), std::mem::take(&mut self.values));
        let dim = velocity.dim();
        for c in 0..dim {
            let lattice = velocity.lattice(c);
            self.inside[c].cover(lattice, bodies, b);
            self.find_outside(velocity, c, b, &mut outside[c]);
            let Markers { stencils, masses, .. } = &self.bodies[b.0];
            for (m, outside) in outside[c].iter_mut().enumerate() {
                *outside = (*outside * masses[m] * stencils.relax[c][m]).max(0.0);
            }
            self.bodies[b.0].read(c, lattice, velocity.component(c), (bodies, b), &mut found[c]);
        }
        let Markers { slip, arms, joint, .. } = &self.bodies[b.0];
        if slip.any() {
            // √w (1 − y P_t) √w of each marker, y = β/(1 + β): its part along the normal, and what is the same all round.
            for (m, arm) in arms.iter().enumerate() {
                let (yields, n) = slip.yields(m);
                let (mut along, mut momentum) = (Vector::zeros(), 0.0);
                for c in 0..dim {
                    along[c] = outside[c][m].sqrt() * n[c];
                    momentum += along[c] * found[c][m];
                    outside[c][m] *= 1.0 - yields;
                }
                layer.add_along(yields, along, *arm, momentum);
            }
        }
        for c in 0..dim {
            let mut sums = LayerSums::default();
            for ((arm, mass), found) in arms.iter().zip(&outside[c]).zip(&found[c]) {
                sums.add(*arm, *mass, *found);
            }
            layer.add(c, &sums);
        }
        if !joint.is_empty() {
            // Passes after the first see the share 1/σ of the body's own velocity at a marker where
            // sheets of σ times its own volume overlap, and give 1 − 1/σ of the mass again.
            let mut shared = Layer::default();
            for c in 0..dim {
                let mut sums = LayerSums::default();
                for ((arm, mass), overlap) in arms.iter().zip(&outside[c]).zip(joint) {
                    sums.add(*arm, (self.passes - 1) as f64 * (1.0 - 1.0 / overlap) * mass, 0.0);
                }
                shared.add(c, &sums);
            }
            layer.shared = shared.mass;
        }
        (self.outside, self.values) = (outside, found);
        layer
    }

    fn internal_momentum(&mut self, velocity: &dyn VelocityField, bodies: &dyn Bodies, b: BodyId) -> Wrench {
        for c in 0..velocity.dim() {
            self.inside[c].cover(velocity.lattice(c), bodies, b);
        }
        internal_momentum(&self.inside, self.density, velocity, b)
    }

    fn rigid_momentum(
        &mut self,
        velocity: &dyn VelocityField,
        bodies: &dyn Bodies,
        b: BodyId,
        twist: Twist,
    ) -> Wrench {
        for c in 0..velocity.dim() {
            self.inside[c].cover(velocity.lattice(c), bodies, b);
        }
        rigid_momentum(&self.inside, self.density, velocity.dim(), b, twist)
    }

    fn force(&mut self, velocity: &mut dyn VelocityField, bodies: &dyn Kinematics) {
        let Self { density, passes, bodies: all, values, .. } = self;
        let dim = velocity.dim();
        let lattices = [0, 1, 2].map(|c| velocity.lattice(c.min(dim - 1)).clone());
        let mut pass = |velocity: &mut dyn VelocityField, b: usize, markers: &mut Markers| {
            markers.pass((velocity, &lattices), (bodies, BodyId(b)), *density, values);
        };
        // Bodies whose markers share no fluid with others, while their numbers are at hand.
        for (b, markers) in all.iter_mut().enumerate().filter(|(_, markers)| markers.alone) {
            (0..*passes).for_each(|_| pass(velocity, b, markers));
        }
        for _ in 0..*passes {
            for (b, markers) in all.iter_mut().enumerate().filter(|(_, markers)| !markers.joint.is_empty()) {
                markers.request_all((velocity, &lattices), (bodies, BodyId(b)), *density);
            }
            for markers in all.iter().filter(|markers| !markers.joint.is_empty()) {
                markers.spread(velocity, &lattices, &markers.changes);
            }
            let in_turn = |markers: &Markers| !markers.alone && markers.joint.is_empty();
            for (b, markers) in all.iter_mut().enumerate().filter(|(_, markers)| in_turn(markers)) {
                pass(velocity, b, markers);
            }
        }
    }

    fn hidden_dissipation(&self) -> f64 {
        self.bodies.iter().map(|m| m.slip.hidden(&m.masses)).sum()
    }

    fn inelastic_loss(
        &mut self,
        before: &[&[f64]],
        velocity: &dyn VelocityField,
        bodies: &dyn Kinematics,
        mean: &dyn Fn(BodyId) -> Twist,
    ) -> f64 {
        let Self { bodies: all, values: found, outside: [old, ..], .. } = self;
        let dim = velocity.dim();
        let lost = |(b, markers): (usize, &Markers)| {
            for (c, found) in found.iter_mut().enumerate().take(dim) {
                let (lattice, who) = (velocity.lattice(c), (bodies, BodyId(b)));
                markers.read(c, lattice, velocity.component(c), who, found);
                markers.read(c, lattice, before[c], who, old);
                found.iter_mut().zip(&*old).for_each(|(now, old)| *now = 0.5 * (*now + old));
            }
            let mean = mean(BodyId(b));
            let missing = |m: usize| {
                markers.masses[m] * markers.slip.given[m].dot(&markers.missing(m, &mean, &found[..], dim))
            };
            (0..markers.arms.len()).map(missing).sum::<f64>()
        };
        all.iter().enumerate().map(lost).sum()
    }

    fn surface_work(&self, bodies: &dyn Kinematics) -> f64 {
        let work = |(b, markers): (usize, &Markers)| {
            let given = markers.arms.iter().zip(&markers.masses).zip(&markers.slip.given);
            let power = |((arm, mass), given): ((&Vector, &f64), &Vector)| {
                mass * given.dot(&bodies.surface_motion(BodyId(b), *arm).unwrap_or_default())
            };
            given.map(power).sum::<f64>()
        };
        self.bodies.iter().enumerate().map(work).sum()
    }

    fn reaction(&self, b: BodyId) -> Wrench {
        self.bodies.get(b.0).map_or_else(Wrench::default, |body| body.reaction)
    }

    fn slip(&self, velocity: &dyn VelocityField, bodies: &dyn Kinematics) -> f64 {
        let (mut sum, mut n) = (0.0, 0.0);
        let (dim, mut found) = (velocity.dim(), [const { Vec::new() }; 3]);
        for (b, markers) in self.bodies.iter().enumerate() {
            let twist = bodies.twist(BodyId(b));
            for (c, found) in found.iter_mut().enumerate().take(dim) {
                markers.read(c, velocity.lattice(c), velocity.component(c), (bodies, BodyId(b)), found);
            }
            let slips = (0..markers.arms.len()).map(|m| markers.missing(m, &twist, &found, dim));
            sum += slips.map(|slip| slip.norm_squared()).sum::<f64>();
            n += markers.arms.len() as f64;
        }
        if n > 0.0 { (sum / n).sqrt() } else { 0.0 }
    }
}

/// ρ Σ λ (u, r × u) V over the nodes of body `b`.
pub(crate) fn internal_momentum(
    inside: &[SolidFraction; 3],
    density: f64,
    velocity: &dyn VelocityField,
    b: BodyId,
) -> Wrench {
    momentum_inside(inside, density, velocity.dim(), b, |c| {
        let u = velocity.component(c);
        move |node| u[node.index]
    })
}

/// The same of fluid that moves with `twist`.
pub(crate) fn rigid_momentum(
    inside: &[SolidFraction; 3],
    density: f64,
    dim: usize,
    b: BodyId,
    twist: Twist,
) -> Wrench {
    momentum_inside(inside, density, dim, b, |c| move |node| twist.at(node.arm)[c])
}

/// ρ Σ λ (v, r × v) V over the nodes of body `b`, v by component and node.
fn momentum_inside<V: Fn(&SolidNode) -> f64>(
    inside: &[SolidFraction; 3],
    density: f64,
    dim: usize,
    b: BodyId,
    component: impl Fn(usize) -> V,
) -> Wrench {
    let mut sum = Wrench::default();
    for c in 0..dim {
        let v = component(c);
        let (mut momentum, mut moment) = (0.0, Vector::zeros());
        for node in inside[c].nodes(b) {
            let part = node.volume * node.fraction * v(node);
            momentum += part;
            moment += part * node.arm;
        }
        let mut unit = Vector::zeros();
        unit[c] = density;
        sum += Wrench { force: momentum * unit, torque: moment.cross(&unit) };
    }
    sum
}

#[cfg(test)]
mod tests;
