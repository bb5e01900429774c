//! The markers of one body.
use super::curvature::curvature;
use super::slip::Slip;
use super::stencils::Stencils;
use crate::{Kernel, surface_elements};
use interfaces::{
    BodyId, Kinematics, Lattice, Point, Pose, Solid, SurfaceElement, Twist, Vector, VelocityField, Wrench,
};

/// The markers of one body.
#[derive(Clone, Debug, Default)]
pub(super) struct Markers {
    pub(super) pose: Option<Pose>,
    /// Volume of a cell around the body \[m³\].
    pub(super) cell: f64,
    /// Where they stand when others are near, in the body's frame.
    pub(super) elements: Vec<SurfaceElement>,
    /// How far that is inside the surface \[m\], and the curvature of this \[1/m\].
    depths: Vec<[f64; 2]>,
    /// Their places on the surface, from the centre of mass, in the world.
    pub(super) surface: Vec<Vector>,
    /// The part s of the depth by which they stand nearer to the surface.
    pub(super) share: f64,
    /// The viscosity was known when they were placed.
    pub(super) known: bool,
    /// No other body's markers reach where these do.
    pub(super) alone: bool,
    /// Places from the centre of mass, in the world.
    pub(super) arms: Vec<Vector>,
    /// ρ ΔV_m / c: the fluid mass that a marker moves \[kg\].
    pub(super) masses: Vec<f64>,
    pub(super) stencils: Stencils,
    /// Divisor of each marker's change where markers of the body overlap ([`super::overlap`]);
    /// empty if none do.
    pub(super) overlaps: Vec<f64>,
    /// Whether the overlaps include periodic images.
    pub(super) long: bool,
    /// Further divisor where sheets of other bodies overlap with these, with which they are forced
    /// at once; empty if none do.
    pub(super) joint: Vec<f64>,
    /// Changes of the velocity by a joint pass, by component and marker \[m/s\].
    pub(super) changes: [Vec<f64>; 3],
    pub(super) reaction: Wrench,
    /// What they read past the surface.
    pub(super) slip: Slip,
}

impl Markers {
    /// Makes those of `solid`, `spacing` apart on cells of size `h`, for a kernel with this `retraction`.
    pub(super) fn make(&mut self, solid: &dyn Solid, dim: usize, [h, spacing, retraction]: [f64; 3]) {
        self.elements = surface_elements(solid, spacing, -retraction);
        self.depths.clear();
        self.depths.extend(self.elements.iter_mut().map(|element| {
            let curvature = curvature(element.point + retraction * element.normal, solid, dim, h);
            let most = LARGEST_SHARE * retraction;
            let deeper = (SHARE * retraction * retraction * curvature).clamp(-most, most);
            element.point -= deeper * element.normal;
            element.area *= 1.0 - curvature * deeper;
            [retraction + deeper, curvature]
        }));
    }

    /// Follows the body's orientation.
    pub(super) fn turn(&mut self, pose: &Pose) {
        self.surface.clear();
        let surface = |(e, [depth, _]): (&SurfaceElement, &[f64; 2])| e.point.coords + *depth * e.normal;
        self.surface
            .extend(self.elements.iter().zip(&self.depths).map(|parts| pose.orientation * surface(parts)));
        self.slip.turn(self.elements.iter().map(|e| pose.orientation * e.normal));
    }

    /// Stands at (1 − s) of the depth, with the areas of the level surface there: A (1 − K(1−s)d/n)ⁿ/(1 − Kd/n)ⁿ, n = `dim` − 1.
    pub(super) fn stand(&mut self, share: f64, mass_per_area: f64, dim: usize) {
        self.share = share;
        self.arms.clear();
        self.masses.clear();
        let directions = dim as i32 - 1;
        for (m, [depth, curvature]) in self.depths.iter().enumerate() {
            let inwards = (1.0 - share) * depth;
            self.arms.push(self.surface[m] - inwards * self.slip.normal(m));
            let narrower = |inwards: f64| 1.0 - (curvature * inwards / f64::from(directions)).min(NARROWEST);
            let wider = (narrower(inwards) / narrower(*depth)).powi(directions);
            self.masses.push(self.elements[m].area * wider * mass_per_area);
        }
    }

    /// Stencils of all markers for the body at this `pose`.
    pub(super) fn set_stencils(
        &mut self,
        kernel: Kernel,
        velocity: &dyn VelocityField,
        pose: &Pose,
        places: &mut Vec<Point>,
    ) {
        places.clear();
        places.extend(self.arms.iter().map(|arm| pose.position + arm));
        self.stencils.set(kernel, velocity, places);
    }

    /// What the markers of body `b` read of component `c`, without what their surface does besides moving with it.
    pub(super) fn read(
        &self,
        c: usize,
        lattice: &Lattice,
        u: &[f64],
        (bodies, b): (&(impl Kinematics + ?Sized), BodyId),
        out: &mut Vec<f64>,
    ) {
        self.stencils.read(c, lattice, u, out);
        if self.arms.first().is_some_and(|arm| bodies.surface_motion(b, *arm).is_some()) {
            for (value, arm) in out.iter_mut().zip(&self.arms) {
                *value -= bodies.surface_motion(b, *arm).unwrap_or_default()[c];
            }
        }
    }

    /// U + Ω×r + s − E u of marker `m`, of which the markers read `found`.
    #[inline]
    pub(super) fn missing(&self, m: usize, twist: &Twist, found: &[Vec<f64>], dim: usize) -> Vector {
        let mut missing = twist.at(self.arms[m]);
        missing += self.slip.of(m);
        (0..dim).for_each(|c| missing[c] -= found[c][m]);
        (dim..3).for_each(|c| missing[c] = 0.0);
        missing
    }

    /// Finds the changes of component `c` that bring it nearer to the body's motion: without slip
    /// components are independent of one another.
    pub(super) fn request(
        &mut self,
        c: usize,
        (lattice, u): (&Lattice, &[f64]),
        (bodies, b): (&dyn Kinematics, BodyId),
        density: f64,
        values: &mut Vec<f64>,
    ) {
        self.read(c, lattice, u, (bodies, b), values);
        let (twist, per_mass) = (bodies.twist(b), 1.0 / (density * self.cell));
        let (mut impulse, mut moment) = (0.0, Vector::zeros());
        let weights = self.masses.iter().zip(&self.stencils.relax[c]).zip(&mut self.slip.given);
        for ((value, arm), ((mass, relax), sum)) in values.iter_mut().zip(&self.arms).zip(weights) {
            let change = relax * (twist.at(*arm)[c] - *value);
            sum[c] += change;
            let given = mass * change;
            impulse += given;
            moment += given * arm;
            *value = given * per_mass;
        }
        let mut unit = Vector::zeros();
        unit[c] = 1.0;
        self.reaction.force[c] -= impulse;
        self.reaction.torque -= moment.cross(&unit);
    }

    /// Finds the changes that bring the velocity nearer to the body's motion and the slip along its
    /// surface.
    pub(super) fn request_with_slip(
        &mut self,
        (velocity, lattices): (&dyn VelocityField, &[Lattice; 3]),
        (bodies, b): (&dyn Kinematics, BodyId),
        density: f64,
        values: &mut [Vec<f64>; 3],
    ) {
        let dim = velocity.dim();
        for (c, values) in values.iter_mut().enumerate().take(dim) {
            self.read(c, &lattices[c], velocity.component(c), (bodies, b), values);
        }
        let (twist, per_mass) = (bodies.twist(b), 1.0 / (density * self.cell));
        for m in 0..self.arms.len() {
            let mut change = self.missing(m, &twist, values, dim);
            change = self.slip.answer(m, change);
            (0..dim).for_each(|c| change[c] *= self.stencils.relax[c][m]);
            self.slip.given[m] += change;
            let impulse = self.masses[m] * change;
            self.reaction.force -= impulse;
            self.reaction.torque -= self.arms[m].cross(&impulse);
            (0..dim).for_each(|c| values[c][m] = per_mass * impulse[c]);
        }
    }

    /// Brings the velocity nearer to the body's motion. All markers read before any of them spreads:
    /// their order must not matter.
    pub(super) fn pass(
        &mut self,
        (velocity, lattices): (&mut dyn VelocityField, &[Lattice; 3]),
        who: (&dyn Kinematics, BodyId),
        density: f64,
        values: &mut [Vec<f64>; 3],
    ) {
        if self.slip.any() {
            self.request_with_slip((velocity, lattices), who, density, values);
            self.spread(velocity, lattices, values);
            return;
        }
        for (c, values) in values.iter_mut().enumerate().take(velocity.dim()) {
            let u = velocity.component_mut(c);
            self.request(c, (&lattices[c], u), who, density, values);
            self.stencils.spread(c, &lattices[c], values, u);
        }
    }

    /// Finds the changes of a joint pass.
    pub(super) fn request_all(
        &mut self,
        (velocity, lattices): (&dyn VelocityField, &[Lattice; 3]),
        who: (&dyn Kinematics, BodyId),
        density: f64,
    ) {
        let mut changes = std::mem::take(&mut self.changes);
        if self.slip.any() {
            self.request_with_slip((velocity, lattices), who, density, &mut changes);
        } else {
            for (c, changes) in changes.iter_mut().enumerate().take(velocity.dim()) {
                self.request(c, (&lattices[c], velocity.component(c)), who, density, changes);
            }
        }
        self.changes = changes;
    }

    /// Adds `changes` to the velocity.
    pub(super) fn spread(
        &self,
        velocity: &mut dyn VelocityField,
        lattices: &[Lattice; 3],
        changes: &[Vec<f64>; 3],
    ) {
        for (c, changes) in changes.iter().enumerate().take(velocity.dim()) {
            self.stencils.spread(c, &lattices[c], changes, velocity.component_mut(c));
        }
    }
}

/// C in d = r_d + C r_d² K, the depth at which markers read no slip. Measured with spheres of 6 to 16 cells per diameter whose markers all stand at it: the torque of a turning one becomes right to 0.1 %,
/// the drag of one in a periodic cube is off by half of what it was. (The retraction makes up for what the kernel blurs of straight profiles; those at a bulging surface are bent. The blurred profile
/// around a turning sphere, Ω within, Ω(a/r)³ outside, asks for C = 2 to second order, drag for more.)
const SHARE: f64 = 1.75;
/// Largest part of the retraction that curvature adds to it: edges are rounder than the cells see.
const LARGEST_SHARE: f64 = 0.5;
/// Largest Kd/n: so much narrower level surfaces inside an edge may be.
const NARROWEST: f64 = 0.5;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Ball;

    /// On the surface or at their depth, with its area there.
    #[test]
    fn markers_of_a_ball_stand_deeper_by_its_curvature() {
        let (radius, h, r) = (0.5, 0.05, 0.0156);
        for dim in [2, 3] {
            let (mut markers, directions) = (Markers::default(), dim as f64 - 1.0);
            markers.make(&Ball { radius, dim }, dim, [h, h, r]);
            markers.turn(&Pose::at([0.3, 0.2, 0.1]));
            let depth = r + SHARE * r * r * directions / radius;
            for share in [0.0, 0.3, 1.0] {
                markers.stand(share, 2.0, dim);
                let at = radius - (1.0 - share) * depth;
                // Differences over h see the curvature to (h/R)².
                let off = |arm: &Vector| (arm.norm() - at).abs();
                assert!(markers.arms.iter().all(|arm| off(arm) < 0.01 * r * r / radius), "{dim} {share}");
                let area = std::f64::consts::TAU * at * if dim == 3 { 2.0 * at } else { 1.0 };
                let found = 0.5 * markers.masses.iter().sum::<f64>();
                assert!((found / area - 1.0).abs() < 2e-3, "{dim} {share}: {found} {area}");
            }
        }
    }
}
