//! A free, neutrally buoyant body between two walls that move in opposite directions, in creeping flow.
//!
//! Far from the walls a sphere turns at half the shear rate (Einstein 1906), and a spheroid of aspect ratio r as Jeffery (1922, Proc. R. Soc.
//! A 102, 161) found: φ̇ = γ̇ (r² cos²φ + sin²φ)/(r² + 1), φ the angle of its axis from the direction of the gradient. What inertia there is
//! slows a body down by a share of the order of Re^{3/2}/10, Re = γ̇R²/ν.
use crate::Outcome;
use crate::axes::gathered;
use crate::motion::Fall;
use coupling::{Particles, Simulation, WeightBalance};
use dem::{Ellipsoid, Material, RigidBodies, Sphere};
use fv_mesh::{CartesianGrid, Diffusion, Fluid, Projection, Side};
use ibm::{Kernel, SmoothForcing};
use interfaces::{BodyId, Freedom, Kinematics, Periods, Pose, Rotation, Twist, Vector};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Jeffery's φ̇/γ̇.
pub fn jeffery_rate(aspect: f64, angle: f64) -> f64 {
    let (sin, cos) = angle.sin_cos();
    (aspect * aspect * cos * cos + sin * sin) / (aspect * aspect + 1.0)
}

/// Jeffery's φ at γ̇t; 0 at 0.
pub fn jeffery_angle(aspect: f64, strain: f64) -> f64 {
    let phase = strain / (aspect + 1.0 / aspect);
    // On the same branch as the phase.
    let turns = ((phase + FRAC_PI_2) / (0.5 * TAU)).floor();
    (aspect * phase.tan()).atan() + 0.5 * TAU * turns
}

/// Time of a whole turn times γ̇: 2π(r + 1/r).
pub fn jeffery_period(aspect: f64) -> f64 {
    TAU * (aspect + 1.0 / aspect)
}

/// A spheroid whose shorter diameter is 1, its axis in the plane of shear.
#[derive(Clone, Copy, Debug)]
pub struct Shear {
    /// Longer over shorter diameter; 1 is a sphere.
    pub aspect: f64,
    /// φ at the start.
    pub angle: f64,
    /// Does it turn as theory says from the start on? Else it is at rest then.
    pub turning: bool,
    /// Edge of the box: walls below and above, periodic else.
    pub edge: f64,
    /// Cells across the shorter diameter.
    pub cells_per_diameter: usize,
    /// γ̇R²/ν with the radius R of the sphere of equal volume.
    pub reynolds: f64,
    /// Other than that suited.
    pub kernel: Option<Kernel>,
    /// How viscous terms are advanced.
    pub diffusion: Diffusion,
}

impl Default for Shear {
    fn default() -> Self {
        Self {
            aspect: 1.0,
            angle: 0.0,
            turning: false,
            edge: 8.0,
            cells_per_diameter: 8,
            reynolds: 0.1,
            kernel: None,
            diffusion: Diffusion::Explicit,
        }
    }
}

/// The flow with the body in it.
pub struct ShearedBody {
    /// Both.
    pub fall: Fall<3>,
    /// γ̇ \[1/s\].
    pub rate: f64,
    angle: f64,
}

/// Cells by which equal ones reach beyond the body: more than any kernel does.
const MARGIN: f64 = 6.5;

impl Shear {
    /// The undisturbed flow with the body in it.
    ///
    /// # Errors
    /// Those of grid, flow and bodies.
    pub fn build(&self) -> Outcome<ShearedBody> {
        let (edge, h) = (self.edge, 1.0 / self.cells_per_diameter as f64);
        let long = 0.5 * self.aspect.max(1.0);
        let (middle, viscosity) = (0.5 * edge, 1.0);
        let radius = 0.5 * self.aspect.cbrt();
        let rate = self.reynolds * viscosity / (radius * radius);
        let axis = |radius: f64, shift: f64| {
            let patch = [-1.0, 1.0].map(|side| middle + side * (radius + MARGIN * h));
            gathered(edge, h, patch, 1.15, shift)
        };
        // The body's centre stands neither on faces nor on centres of cells.
        let grid = CartesianGrid::from_axes([axis(long, 0.37)?, axis(long, 0.3)?, axis(0.5, 0.11)?])?;
        let wall = |side: f64| Side::Wall([side * rate * middle, 0.0, 0.0]);
        let sides = [Side::Periodic.both(), [wall(-1.0), wall(1.0)], Side::Periodic.both()];
        let fluid = Fluid { density: 1.0, viscosity };
        let mut flow = Projection::new(grid, sides, fluid)?.with_diffusion(self.diffusion);
        flow.set_velocity(|x| [rate * (x[1] - middle), 0.0, 0.0]);

        let mut bodies = RigidBodies::new(Periods::new([Some(edge), None, Some(edge)]));
        let material = Material { density: fluid.density, ..Material::default() };
        let orientation = Rotation::from_axis_angle(&Vector::z_axis(), FRAC_PI_2 - self.angle);
        let pose = Pose { orientation, ..Pose::at([middle; 3]) };
        let spin = if self.turning { -rate * jeffery_rate(self.aspect, self.angle) } else { 0.0 };
        let twist = Twist { angular: Vector::new(0.0, 0.0, spin), ..Twist::default() };
        if self.aspect == 1.0 {
            bodies.add(Sphere::new(0.5)?, material, pose, twist, Freedom::FREE)?;
        } else {
            let spheroid = Ellipsoid::new([0.5 * self.aspect, 0.5, 0.5])?;
            bodies.add(spheroid, material, pose, twist, Freedom::FREE)?;
        }
        let mut forcing = SmoothForcing::new(fluid.density);
        if let Some(kernel) = self.kernel {
            forcing = forcing.with_kernel(kernel);
        }
        let particles = Particles::new(bodies, forcing, fluid.density, Vector::zeros());
        let fall = Simulation::new(flow, particles, WeightBalance::None)?;
        Ok(ShearedBody { fall, rate, angle: self.angle })
    }
}

impl ShearedBody {
    /// A step of `dt` \[s\].
    ///
    /// # Errors
    /// Those of the coupling.
    pub fn step(&mut self, dt: f64) -> Outcome<()> {
        self.fall.step(dt)?;
        let orientation = self.fall.particles.bodies.pose(BodyId(0)).orientation;
        let axis = orientation * Vector::x();
        // The nearest to the last angle: φ runs on over whole turns.
        let (new, half) = (axis.x.atan2(axis.y), 0.5 * TAU);
        self.angle += (new - self.angle + 0.5 * half).rem_euclid(half) - 0.5 * half;
        Ok(())
    }
    /// φ \[rad\], running on.
    pub fn angle(&self) -> f64 {
        self.angle
    }
    /// Angular velocity over shear rate.
    pub fn spin(&self) -> f64 {
        -self.fall.particles.bodies.twist(BodyId(0)).angular.z / self.rate
    }
    /// Shear so far, γ̇t.
    pub fn strain(&self) -> f64 {
        self.rate * self.fall.flow.time()
    }
}

/// Angular velocity over Jeffery's for the angle of that time, averaged from `from` to `until` (in d²/ν after the start).
///
/// # Errors
/// Those of the coupling.
pub fn settled_spin(shear: &Shear, dt_factor: f64, [from, until]: [f64; 2]) -> Outcome<f64> {
    let mut body = shear.build()?;
    let (mut sum, mut time) = (0.0, 0.0);
    while body.fall.flow.time() < until {
        let dt = dt_factor * body.fall.flow.stable_dt(0.4);
        body.step(dt)?;
        if body.fall.flow.time() > from {
            sum += dt * body.spin() / jeffery_rate(shear.aspect, body.angle());
            time += dt;
        }
    }
    Ok(sum / time)
}

/// φ over γ̇t of a spheroid from -15° on (so that the start is forgotten at 0°) until its axis has come to 90°, step by step.
///
/// # Errors
/// Those of the coupling.
pub fn orbit(shear: &Shear, dt_factor: f64) -> Outcome<Vec<(f64, f64)>> {
    let mut body = Shear { angle: -TAU / 24.0, turning: true, ..*shear }.build()?;
    let mut series = vec![(0.0, body.angle())];
    while body.angle() < 1.005 * FRAC_PI_2 {
        let dt = dt_factor * body.fall.flow.stable_dt(0.4);
        body.step(dt)?;
        series.push((body.strain(), body.angle()));
    }
    Ok(series)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jeffery_turns_as_he_should() {
        let (r, step) = (2.0, 1e-4);
        let mut angle = 0.0;
        for i in 0..200_000 {
            assert!((angle - jeffery_angle(r, step * f64::from(i))).abs() < 1e-8);
            let middle = angle + 0.5 * step * jeffery_rate(r, angle);
            angle += step * jeffery_rate(r, middle);
        }
        assert!((jeffery_period(r) - 15.708).abs() < 1e-3);
        assert!((jeffery_angle(r, jeffery_period(r)) - TAU).abs() < 1e-9);
    }
}
