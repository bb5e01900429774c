//! Direct forcing at surface markers, spread by a smooth kernel.
mod curvature;
mod markers;
mod shear;
mod stencils;

use crate::crowd::Crowd;
use crate::forcing::LayerSums;
use crate::solid_fraction::check;
use crate::{Forcing, IbmError, Kernel, Layer, SolidFraction, surface_elements};
use curvature::follow_curvature;
use interfaces::{
    Bodies, BodyId, Kinematics, Point, Renumbering, RestartError, Vector, VelocityField, Wrench,
};
use markers::Markers;
use shear::Shear;

/// Smooth direct forcing (Uhlmann 2005; several passes as in Wang et al. 2008; a smooth [`Kernel`] as Yang et al. 2009), with
/// markers moved into the solid by the kernel's own [`Kernel::retraction`] r_d and, where the surface is curved, by 1.75 r_d² times the sum of
/// its principal curvatures more, which puts the no-slip surface where the body's is.
///
/// ```text
/// ΔF_m = (1/c) (U + Ω×r_m + u_s − E u)_m / dt,   u += dt Σ_m δ_h(x − x_m) ΔF_m ΔV_m,   ΔV_m = A_m h
/// ```
///
/// u_s is the surface's own motion, if it has one; E reads the velocity at the markers with the same kernel that spreads.
/// Momentum is conserved: what the fluid gets, the body loses.
///
/// [`with_viscosity`](Self::with_viscosity) puts the markers on the surface itself and makes up for the kernel's blur by the shear there, which is right to second order in the size of the cells
/// for drag, torque and strain alike.
#[derive(Clone, Debug)]
pub struct SmoothForcing {
    density: f64,
    /// Kinematic, if the blur is made up for by the shear.
    viscosity: Option<f64>,
    /// Other than that suited.
    kernel: Option<Kernel>,
    passes: usize,
    inside: [SolidFraction; 3],
    bodies: Vec<Markers>,
    crowd: Crowd,
    /// Bodies moved since the crowd was looked at.
    moved: bool,
    /// Places of the markers of a body.
    places: Vec<Point>,
    /// One number per marker of a body.
    values: Vec<f64>,
    /// Another.
    outside: Vec<f64>,
    /// Zeros between uses, as long as a velocity component.
    scratch: Vec<f64>,
}

impl SmoothForcing {
    /// Markers 1 (plane) or 1¼ (space) cells apart, the kernel [suited](Kernel::suited) and three passes, in a fluid of `density`
    /// \[kg/m³\].
    pub fn new(density: f64) -> Self {
        Self {
            density,
            viscosity: None,
            kernel: None,
            passes: 3,
            inside: Default::default(),
            bodies: Vec::new(),
            crowd: Crowd::default(),
            moved: false,
            places: Vec::new(),
            values: Vec::new(),
            outside: Vec::new(),
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
    /// Markers on the surface, in a fluid of this kinematic viscosity ν \[m²/s\]: where there is shear γ = τ/μ, the kernel blurs the kink of the velocity, and the markers read r γ less than there is
    /// without slip (r = 0.31 to 0.34 cells for [`Kernel::Yang`]). They expect that, from the force τ that they gave in the last 3 h²/ν (six times as long where bodies share fluid), so [`finish`](Forcing::finish) has to be called after every step
    /// (`coupling::Particles` do); before the first call it is as if there were no shear. Shear that lives shorter than that is not made up for: a body that starts is larger by r. The tables of
    /// [`SmoothFilm`](crate::SmoothFilm) are not made for it.
    #[must_use]
    pub fn with_viscosity(mut self, viscosity: f64) -> Self {
        self.viscosity = Some(viscosity);
        self
    }
    /// How often λ of a body was computed, over all velocity components.
    pub fn updates(&self) -> u64 {
        self.inside.iter().map(SolidFraction::updates).sum()
    }

    fn kernel(&self, dim: usize) -> Kernel {
        self.kernel.unwrap_or_else(|| Kernel::suited(dim))
    }

    fn place_body(
        &mut self,
        velocity: &dyn VelocityField,
        bodies: &dyn Bodies,
        b: BodyId,
    ) -> Result<(), IbmError> {
        let dim = velocity.dim();
        let kernel = self.kernel(dim);
        let cell = uniform_cell(velocity, kernel, bodies, b)?;
        let h = cell.powf(1.0 / dim as f64);
        let markers = &mut self.bodies[b.0];
        // Made once, unless the body has come to where the cells are of another size.
        let made = markers.elements.is_empty() || (cell / markers.cell - 1.0).abs() > 3.0 * UNEQUAL;
        if made {
            markers.cell = cell;
            let extent = bodies.solid(b).aabb().extent();
            let size = extent.x.min(extent.y).min(if dim == 3 { extent.z } else { f64::INFINITY });
            if size < LEAST_CELLS * h {
                return Err(IbmError::TooCoarse { body: b, size, spacing: h, least: LEAST_CELLS });
            }
            let spacing = if dim == 2 { 1.0 } else { SPACING };
            let (retraction, solid) = (kernel.retraction() * h, bodies.solid(b));
            if self.viscosity.is_some() {
                markers.elements = surface_elements(solid, spacing * h, 0.0);
                markers.shear.get_or_insert_default();
            } else {
                markers.elements = surface_elements(solid, spacing * h, -retraction);
                markers.elements.iter_mut().for_each(|e| follow_curvature(e, solid, dim, h, retraction));
            }
            if markers.elements.is_empty() {
                return Err(IbmError::NoSurface { body: b, offset: -retraction });
            }
            let scale = self.density * h / kernel.self_overlap();
            markers.masses = markers.elements.iter().map(|e| e.area * scale).collect();
        }
        let pose = bodies.pose(b);
        if made || markers.pose.is_none_or(|old| old.orientation != pose.orientation) {
            markers.arms.clear();
            markers.arms.extend(markers.elements.iter().map(|e| pose.orientation * e.point.coords));
            if let Some(shear) = &mut markers.shear {
                shear.place(kernel, h, markers.elements.iter().map(|e| pose.orientation * e.normal));
            }
        }
        self.places.clear();
        self.places.extend(markers.arms.iter().map(|arm| pose.position + arm));
        markers.stencils.set(kernel, velocity, &self.places);
        Ok(())
    }

    /// Finds the bodies whose markers reach where no others do.
    fn find_alone(&mut self, velocity: &dyn VelocityField, bodies: &dyn Bodies) {
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
        self.crowd.find_alone(Vector::from_fn(|a, _| axes[a].period().unwrap_or(0.0)));
        self.bodies.iter_mut().zip(&self.crowd.alone).for_each(|(markers, alone)| markers.alone = *alone);
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

/// Distances of nodes that differ by no more than this are equal.
const UNEQUAL: f64 = 1e-6;

/// Volume of the cells that the markers of body `b` reach, which must all be equal.
fn uniform_cell(
    velocity: &dyn VelocityField,
    kernel: Kernel,
    bodies: &dyn Bodies,
    body: BodyId,
) -> Result<f64, IbmError> {
    let bounds = bodies.aabb(body);
    let mut cell = 1.0;
    for axis in 0..velocity.dim() {
        let [mut least, mut most] = [f64::INFINITY, 0.0_f64];
        let mut narrowest = f64::INFINITY;
        for c in 0..velocity.dim() {
            let nodes = &velocity.lattice(c).axes[axis];
            let [_, here] = nodes.spacings(bounds.min[axis], bounds.max[axis]);
            let reach = kernel.reach() * here;
            let [low, high] = nodes.spacings(bounds.min[axis] - reach, bounds.max[axis] + reach);
            (least, most) = (least.min(low), most.max(high));
            narrowest =
                narrowest.min(nodes.spacings(nodes.place(0), nodes.place(nodes.len() as isize - 1))[0]);
        }
        if most - least > UNEQUAL * most {
            return Err(IbmError::Stretched { body, axis, least, most });
        }
        // Where the narrowest cells are it is the same number wherever the body is, to the last bit: a run that goes on makes the same markers.
        cell *= if least - narrowest <= UNEQUAL * narrowest { narrowest } else { least };
    }
    Ok(cell)
}

/// Cells from marker to marker in space. On a moving sphere the drag is the same to 1e-4 as with markers a cell apart, its noise
/// stays below 0.2 %, and there are two thirds as many of them.
const SPACING: f64 = 1.25;

/// Fewer cells across a body than this cannot hold its markers.
const LEAST_CELLS: f64 = 4.0;

impl Forcing for SmoothForcing {
    fn place(&mut self, velocity: &dyn VelocityField, bodies: &dyn Bodies) -> Result<(), IbmError> {
        self.moved |= self.bodies.len() != bodies.n_bodies();
        self.bodies.resize_with(bodies.n_bodies(), Markers::default);
        for (c, inside) in self.inside.iter_mut().enumerate().take(velocity.dim()) {
            if inside.resize(velocity.lattice(c), bodies.n_bodies()) {
                // Another grid.
                let anew = |old: &mut Markers| Markers { shear: old.shear.take(), ..Markers::default() };
                self.bodies.iter_mut().for_each(|markers| *markers = anew(markers));
            }
        }
        for b in 0..bodies.n_bodies() {
            let pose = bodies.pose(BodyId(b));
            if self.bodies[b].pose != Some(pose) {
                self.moved = true;
                for c in 0..velocity.dim() {
                    check(velocity.lattice(c), bodies, BodyId(b))?;
                }
                self.place_body(velocity, bodies, BodyId(b))?;
                self.bodies[b].pose = Some(pose);
            }
            self.bodies[b].reaction = Wrench::default();
            self.bodies[b].shear.iter_mut().for_each(Shear::clear);
        }
        if std::mem::take(&mut self.moved) {
            self.find_alone(velocity, bodies);
        }
        Ok(())
    }

    fn renumber(&mut self, numbers: &Renumbering) {
        numbers.apply(&mut self.bodies);
        self.inside.iter_mut().for_each(|inside| inside.renumber(numbers));
        self.moved = true;
    }

    fn density(&self) -> f64 {
        self.density
    }

    fn rounds(&self) -> usize {
        1
    }

    fn layer(&mut self, velocity: &dyn VelocityField, bodies: &dyn Bodies, b: BodyId) -> Layer {
        let mut layer = Layer::default();
        let (mut outside, mut found) = (std::mem::take(&mut self.outside), std::mem::take(&mut self.values));
        for c in 0..velocity.dim() {
            let lattice = velocity.lattice(c);
            self.inside[c].cover(lattice, bodies, b);
            self.find_outside(velocity, c, b, &mut outside);
            let markers = &self.bodies[b.0];
            markers.read(c, lattice, velocity.component(c), (bodies, b), &mut found);
            let Markers { stencils, masses, arms, .. } = markers;
            let mut sums = LayerSums::default();
            for (m, arm) in arms.iter().enumerate() {
                sums.add(*arm, outside[m] * masses[m] * stencils.relax[c][m], found[m]);
            }
            layer.add(c, &sums);
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

    fn force(&mut self, velocity: &mut dyn VelocityField, bodies: &dyn Kinematics) {
        let Self { density, passes, bodies: all, values, .. } = self;
        // Components do not see one another.
        for c in 0..velocity.dim() {
            let lattice = velocity.lattice(c).clone();
            let u = velocity.component_mut(c);
            let mut pass = |b: usize, markers: &mut Markers| {
                markers.pass(c, &lattice, u, (bodies, BodyId(b)), *density, values);
            };
            // While its numbers are at hand; those that share fluid in turn.
            for (b, markers) in all.iter_mut().enumerate().filter(|(_, markers)| markers.alone) {
                (0..*passes).for_each(|_| pass(b, markers));
            }
            for _ in 0..*passes {
                for (b, markers) in all.iter_mut().enumerate().filter(|(_, markers)| !markers.alone) {
                    pass(b, markers);
                }
            }
        }
    }

    fn finish(&mut self, dt: f64, implicit: Vector) {
        let Some(viscosity) = self.viscosity else { return };
        for Markers { shear, masses, alone, .. } in &mut self.bodies {
            let rivals = if *alone { 1.0 } else { 2.0 * self.passes as f64 };
            shear.iter_mut().for_each(|shear| shear.finish(viscosity * dt, implicit, (masses, rivals)));
        }
    }

    fn hidden_dissipation(&self) -> f64 {
        self.bodies.iter().filter_map(|m| m.shear.as_ref()).map(|shear| shear.hidden).sum()
    }

    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        for (b, shear) in self.bodies.iter().enumerate().filter_map(|(b, m)| Some((b, m.shear.as_ref()?))) {
            sink(&format!("shear.{b}"), &shear.numbers());
        }
    }

    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        if self.viscosity.is_some() {
            self.bodies.clear();
            let saved = (0..).map_while(|b| source(&format!("shear.{b}")));
            let markers = |numbers| Markers { shear: Some(Shear::of(numbers)), ..Markers::default() };
            self.bodies.extend(saved.map(markers));
        }
        Ok(())
    }

    fn reaction(&self, b: BodyId) -> Wrench {
        self.bodies.get(b.0).map_or_else(Wrench::default, |body| body.reaction)
    }

    fn slip(&self, velocity: &dyn VelocityField, bodies: &dyn Kinematics) -> f64 {
        let (mut sum, mut n) = (0.0, 0.0);
        let mut found = Vec::new();
        for (b, markers) in self.bodies.iter().enumerate() {
            let (twist, how) = (bodies.twist(BodyId(b)), (bodies, BodyId(b)));
            for c in 0..velocity.dim() {
                markers.read(c, velocity.lattice(c), velocity.component(c), how, &mut found);
                let slips = found.iter().zip(&markers.arms).map(|(u, arm)| u - twist.at(*arm)[c]);
                sum += slips.map(|slip| slip * slip).sum::<f64>();
            }
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
    let mut sum = Wrench::default();
    for c in 0..velocity.dim() {
        let u = velocity.component(c);
        let (mut momentum, mut moment) = (0.0, Vector::zeros());
        for node in inside[c].nodes(b) {
            let part = node.volume * node.fraction * u[node.index];
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
