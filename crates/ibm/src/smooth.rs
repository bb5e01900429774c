//! Direct forcing at surface markers, spread by a smooth kernel.
use crate::kernel::WIDEST;
use crate::{Forcing, IbmError, Kernel, Layer, SolidFraction, surface_elements};
use interfaces::{Bodies, BodyId, Kinematics, Lattice, Pose, SurfaceElement, Vector, VelocityField, Wrench};

/// Smooth direct forcing (Uhlmann 2005; several passes as in Wang et al. 2008; smoothed kernel of
/// Yang et al. 2009), with markers moved into the solid by the kernel's own
/// [`Kernel::retraction`], which puts the no-slip surface where the body's is.
///
/// ```text
/// ΔF_m = (1/c) (U + Ω×r_m − E u)_m / dt,   u += dt Σ_m δ_h(x − x_m) ΔF_m ΔV_m,   ΔV_m = A_m h
/// ```
///
/// E reads the velocity at the markers with the same kernel that spreads. Momentum is conserved:
/// what the fluid gets, the body loses.
#[derive(Clone, Debug)]
pub struct SmoothForcing {
    density: f64,
    kernel: Kernel,
    passes: usize,
    inside: [SolidFraction; 3],
    bodies: Vec<Markers>,
    /// Zeros between uses, as long as a velocity component.
    scratch: Vec<f64>,
}

/// The markers of one body.
#[derive(Clone, Debug, Default)]
struct Markers {
    pose: Option<Pose>,
    /// Volume of a cell around the body \[m³\].
    cell: f64,
    /// In the body's frame.
    elements: Vec<SurfaceElement>,
    /// From the centre of mass, in the world.
    arms: Vec<Vector>,
    /// ρ ΔV_m / c: the fluid mass that a marker moves \[kg\].
    masses: Vec<f64>,
    /// What each marker gives to the fluid in the pass at hand \[N s\].
    impulses: Vec<f64>,
    /// One per component and marker.
    stencils: [Vec<Stencil>; 3],
    /// 1 − χ_m per component and marker, χ = E λ: the share of a marker's fluid outside the body.
    outside: [Vec<f64>; 3],
    reaction: Wrench,
}

/// Where a marker reads and spreads: a product of weights along the axes.
#[derive(Clone, Copy, Debug)]
struct Stencil {
    offset: [[usize; WIDEST]; 3],
    weight: [[f64; WIDEST]; 3],
    width: [usize; 3],
    /// (Share of the weights inside bounded sides)²: by this a pass is relaxed further there, since
    /// the weights that are left, scaled up to sum to one, overlap more with themselves.
    relax: f64,
}

impl Stencil {
    fn new(kernel: Kernel, lattice: &Lattice, x: [f64; 3]) -> Self {
        let mut s = Self { offset: [[0; WIDEST]; 3], weight: [[0.0; WIDEST]; 3], width: [1; 3], relax: 1.0 };
        s.weight[2][0] = 1.0;
        s.offset[0][0] = lattice.base;
        for a in 0..lattice.dim {
            let (node, part) = lattice.axes[a].locate(x[a]);
            let reach = kernel.reach() as isize;
            let weights = kernel.weights(part);
            let first = node - reach + 1;
            let base = if a == 0 { lattice.base } else { 0 };
            let (mut width, mut sum) = (0, 0.0);
            for (i, w) in (first..first + 2 * reach).zip(weights) {
                // Beyond a bounded side there is nothing; the rest is scaled up to sum to one.
                if let Some(at) = lattice.axes[a].wrap(i) {
                    s.offset[a][width] = base + at * lattice.stride[a];
                    s.weight[a][width] = w;
                    sum += w;
                    width += 1;
                }
            }
            if sum < LEAST_SHARE {
                // As good as outside: it reads and spreads nothing.
                return Self { width: [0; 3], relax: 0.0, ..s };
            }
            s.width[a] = width;
            for w in &mut s.weight[a][..width] {
                *w /= sum;
            }
            s.relax *= sum * sum;
        }
        s
    }

    fn each(&self, mut f: impl FnMut(usize, f64)) {
        for k in 0..self.width[2] {
            for j in 0..self.width[1] {
                let at = self.offset[2][k] + self.offset[1][j];
                let w = self.weight[2][k] * self.weight[1][j];
                for i in 0..self.width[0] {
                    f(at + self.offset[0][i], w * self.weight[0][i]);
                }
            }
        }
    }

    fn read(&self, u: &[f64]) -> f64 {
        let mut sum = 0.0;
        self.each(|i, w| sum += w * u[i]);
        sum
    }
}

impl SmoothForcing {
    /// Markers one cell apart, the [`Kernel::Yang`] kernel and three passes, in a fluid of
    /// `density` \[kg/m³\].
    pub fn new(density: f64) -> Self {
        Self {
            density,
            kernel: Kernel::default(),
            passes: 3,
            inside: Default::default(),
            bodies: Vec::new(),
            scratch: Vec::new(),
        }
    }
    /// Another kernel.
    #[must_use]
    pub fn with_kernel(mut self, kernel: Kernel) -> Self {
        self.kernel = kernel;
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

    fn place_body(
        &mut self,
        velocity: &dyn VelocityField,
        bodies: &dyn Bodies,
        b: BodyId,
    ) -> Result<(), IbmError> {
        let dim = velocity.dim();
        let cell = uniform_cell(velocity, self.kernel, bodies, b)?;
        let h = cell.powf(1.0 / dim as f64);
        let markers = &mut self.bodies[b.0];
        // Made once, unless the body has come to where the cells are of another size.
        if markers.elements.is_empty() || (cell / markers.cell - 1.0).abs() > 3.0 * UNEQUAL {
            markers.cell = cell;
            let extent = bodies.solid(b).aabb().extent();
            let size = extent.x.min(extent.y).min(if dim == 3 { extent.z } else { f64::INFINITY });
            if size < LEAST_CELLS * h {
                return Err(IbmError::TooCoarse { body: b, size, spacing: h, least: LEAST_CELLS });
            }
            let offset = -self.kernel.retraction() * h;
            markers.elements = surface_elements(bodies.solid(b), h, offset);
            if markers.elements.is_empty() {
                return Err(IbmError::NoSurface { body: b, offset });
            }
            let scale = self.density * h / self.kernel.self_overlap();
            markers.masses = markers.elements.iter().map(|e| e.area * scale).collect();
        }
        let pose = bodies.pose(b);
        markers.arms.clear();
        markers.arms.extend(markers.elements.iter().map(|e| pose.orientation * e.point.coords));
        for c in 0..dim {
            let lattice = velocity.lattice(c);
            let stencils = &mut markers.stencils[c];
            stencils.clear();
            stencils.extend(
                markers
                    .arms
                    .iter()
                    .map(|arm| Stencil::new(self.kernel, lattice, (pose.position + arm).into())),
            );
        }
        // χ = E λ, with λ laid out on the lattice for a moment.
        for c in 0..dim {
            let nodes = self.inside[c].nodes(b);
            self.scratch.resize(velocity.component(c).len(), 0.0);
            nodes.iter().for_each(|n| self.scratch[n.index] += n.fraction);
            markers.outside[c].clear();
            markers.outside[c].extend(markers.stencils[c].iter().map(|s| 1.0 - s.read(&self.scratch)));
            nodes.iter().for_each(|n| self.scratch[n.index] = 0.0);
        }
        Ok(())
    }
}

/// A marker of whose weights less than this share lies inside the box is outside.
const LEAST_SHARE: f64 = 1e-3;

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
        for c in 0..velocity.dim() {
            let nodes = &velocity.lattice(c).axes[axis];
            let [_, here] = nodes.spacings(bounds.min[axis], bounds.max[axis]);
            let reach = kernel.reach() as f64 * here;
            let [low, high] = nodes.spacings(bounds.min[axis] - reach, bounds.max[axis] + reach);
            (least, most) = (least.min(low), most.max(high));
        }
        if most - least > UNEQUAL * most {
            return Err(IbmError::Stretched { body, axis, least, most });
        }
        cell *= least;
    }
    Ok(cell)
}

/// Fewer cells across a body than this cannot hold its markers.
const LEAST_CELLS: f64 = 4.0;

impl Forcing for SmoothForcing {
    fn place(&mut self, velocity: &dyn VelocityField, bodies: &dyn Bodies) -> Result<(), IbmError> {
        self.bodies.resize_with(bodies.n_bodies(), Markers::default);
        for c in 0..velocity.dim() {
            self.inside[c].update(velocity.lattice(c), bodies)?;
        }
        for b in 0..bodies.n_bodies() {
            let pose = bodies.pose(BodyId(b));
            if self.bodies[b].pose != Some(pose) {
                self.place_body(velocity, bodies, BodyId(b))?;
                self.bodies[b].pose = Some(pose);
            }
            self.bodies[b].reaction = Wrench::default();
        }
        Ok(())
    }

    fn density(&self) -> f64 {
        self.density
    }

    fn rounds(&self) -> usize {
        1
    }

    fn layer(&self, velocity: &dyn VelocityField, b: BodyId) -> Layer {
        let markers = &self.bodies[b.0];
        let mut layer = Layer::default();
        for c in 0..velocity.dim() {
            let u = velocity.component(c);
            for (m, stencil) in markers.stencils[c].iter().enumerate() {
                let weight = markers.outside[c][m] * markers.masses[m] * stencil.relax;
                layer.add(c, markers.arms[m], weight, stencil.read(u));
            }
        }
        layer
    }

    fn internal_momentum(&self, velocity: &dyn VelocityField, b: BodyId) -> Wrench {
        internal_momentum(&self.inside, self.density, velocity, b)
    }

    fn force(&mut self, velocity: &mut dyn VelocityField, bodies: &dyn Kinematics) {
        for _ in 0..self.passes {
            for (b, markers) in self.bodies.iter_mut().enumerate() {
                let twist = bodies.twist(BodyId(b));
                let cell_mass = self.density * markers.cell;
                for c in 0..velocity.dim() {
                    let u = velocity.component_mut(c);
                    // All markers read before any of them spreads: their order must not matter.
                    markers.impulses.clear();
                    markers.impulses.extend(markers.stencils[c].iter().enumerate().map(|(m, stencil)| {
                        let slip = twist.at(markers.arms[m])[c] - stencil.read(u);
                        markers.masses[m] * stencil.relax * slip
                    }));
                    for (m, stencil) in markers.stencils[c].iter().enumerate() {
                        let (arm, impulse) = (markers.arms[m], markers.impulses[m]);
                        let scale = impulse / cell_mass;
                        stencil.each(|i, w| u[i] += scale * w);
                        let mut force = Vector::zeros();
                        force[c] = -impulse;
                        markers.reaction += Wrench::at(force, arm);
                    }
                }
            }
        }
    }

    fn reaction(&self, b: BodyId) -> Wrench {
        self.bodies.get(b.0).map_or_else(Wrench::default, |body| body.reaction)
    }

    fn slip(&self, velocity: &dyn VelocityField, bodies: &dyn Kinematics) -> f64 {
        let (mut sum, mut n) = (0.0, 0.0);
        for (b, markers) in self.bodies.iter().enumerate() {
            let twist = bodies.twist(BodyId(b));
            for c in 0..velocity.dim() {
                let u = velocity.component(c);
                for (stencil, arm) in markers.stencils[c].iter().zip(&markers.arms) {
                    sum += (stencil.read(u) - twist.at(*arm)[c]).powi(2);
                }
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
        for node in inside[c].nodes(b) {
            let mut momentum = Vector::zeros();
            momentum[c] = density * node.volume * node.fraction * u[node.index];
            sum += Wrench::at(momentum, node.arm);
        }
    }
    sum
}

#[cfg(test)]
mod tests;
