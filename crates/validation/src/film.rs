//! A sphere near a wall or another sphere in creeping flow, at a gap that stays.
use crate::Outcome;
use crate::axes::gathered;
use crate::prescribed_bodies::{PrescribedBodies, forced_step};
use coupling::{Particles, Simulation, WeightBalance};
use dem::{ContactLaw, HalfSpace, Material, RigidBodies, Sphere};
use fv_mesh::{CartesianGrid, Diffusion, Fluid, Projection, Side};
use ibm::{Forcing, SmoothForcing};
use interfaces::{BodyId, Freedom, Kinematics, Periods, Point, Pose, Twist, Vector, Wrench};
use std::f64::consts::PI;

/// What a sphere of diameter 1 stands before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Before {
    /// A wall below it.
    Wall,
    /// Another sphere below it, which moves the opposite way.
    Sphere,
}

/// Reynolds number of unit speed.
const SLOW: f64 = 1e-3;

/// What holds a sphere back that moves near another surface, by the grid: over 6πμR times its velocity and 8πμR³ times its angular velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Resistance {
    /// Force against its approach.
    pub approach: f64,
    /// Force against sliding along the surface without turning.
    pub sliding: f64,
    /// Torque against turning about an axis along the surface.
    pub turning: f64,
}

/// The resistance of a sphere (the upper one) while its distance from the other surface stays `gap` diameters, with so many cells per diameter and the centre
/// `shift` cells off. Re → 0, in a box of 32 radii.
///
/// # Errors
/// Those of grid, flow and forcing.
pub fn resistance(
    before: Before,
    per_diameter: usize,
    gap: f64,
    shift: f64,
    mut forcing: Box<dyn Forcing>,
) -> Outcome<Resistance> {
    let (edge, height, h) = (16.0, 18.0, 1.0 / per_diameter as f64);
    let patch = |low: f64, high: f64| [low - 10.0 * h, high + 10.0 * h];
    let middle = 0.5 * edge;
    let across = |shift| gathered(edge, h, patch(middle - 0.5, middle + 0.5), 1.2, shift);
    let base = if before == Before::Wall { 0.0 } else { 0.5 * (height - gap) };
    let centre = base + gap + 0.5;
    let low = if before == Before::Wall { 10.0 * h } else { base - 1.0 };
    let upright = if before == Before::Wall { 0.0 } else { shift };
    let z = gathered(height, h, patch(low, centre + 0.5), 1.2, upright)?;
    let grid = CartesianGrid::from_axes([across(0.37 + shift)?, across(0.11 + shift)?, z])?;
    let fluid = Fluid { density: 1.0, viscosity: 1.0 };
    let mut flow = Projection::new(grid, Side::WALL.everywhere(), fluid)?.with_diffusion(Diffusion::Explicit);
    let at = [middle, middle, centre];
    let mut bodies = PrescribedBodies::default().with(Sphere::new(0.5)?, at, 0.0);
    // All at once: the flow is linear, and no two of these push the same way.
    let twist = |sign: f64| Twist {
        linear: Vector::new(SLOW, 0.0, -sign * SLOW),
        angular: Vector::new(2.0 * SLOW, 0.0, 0.0),
    };
    let mut own = twist(1.0);
    if before == Before::Sphere {
        let at = [middle, middle, base - 0.5];
        bodies = bodies.with(Sphere::new(0.5)?, at, 0.0);
        own.linear.x = 0.5 * SLOW;
        own.linear.z = -0.5 * SLOW;
        bodies.put(BodyId(1), Pose::at(at), Twist { linear: -own.linear, angular: own.angular });
    }
    bodies.put(BodyId(0), Pose::at(at), own);
    let mut last = Resistance::default();
    loop {
        let end = flow.time() + 0.1;
        let mut load = Wrench::default();
        while flow.time() < end {
            let dt = flow.stable_dt(0.4);
            forced_step(&mut flow, &mut *forcing, &bodies, dt)?;
            load = forcing.reaction(BodyId(0)) * (1.0 / dt);
        }
        let now = Resistance {
            approach: load.force.z / (-3.0 * PI * own.linear.z),
            sliding: load.force.x / (-3.0 * PI * own.linear.x),
            turning: load.torque.x / (-PI * own.angular.x),
        };
        let off = |now: f64, last: f64| (now - last).abs() / now;
        let all = [(now.approach, last.approach), (now.sliding, last.sliding), (now.turning, last.turning)];
        if all.iter().all(|(now, last)| off(*now, *last) < 2e-4) {
            return Ok(now);
        }
        last = now;
    }
}

/// A sphere that sinks slowly onto a wall: its distance from it over R, and its net weight over 6πμR times its speed, at each step from `start` R until the distance is `least` R.
///
/// Net weight 6πμR times `stokes` (in ν/d; what it accelerates is felt at 0.2 still: 1 to 4 % of the weight), twice the fluid's density, a box of 6 diameters, from rest.
///
/// # Errors
/// Those of grid, flow and bodies.
pub fn sinking<L: ContactLaw>(
    per_diameter: usize,
    law: L,
    [start, least]: [f64; 2],
    stokes: f64,
) -> Outcome<Vec<[f64; 2]>> {
    let (edge, h) = (6.0, 1.0 / per_diameter as f64);
    let patch = [-1.0, 1.0].map(|side| 0.5 * edge + side * (0.5 + 10.0 * h));
    let across = |shift| gathered(edge, h, patch, 1.2, shift);
    let z = gathered(edge, h, [0.0, 1.0 + 0.5 * start + 10.0 * h], 1.2, 0.0)?;
    let grid = CartesianGrid::from_axes([across(0.37)?, across(0.11)?, z])?;
    let fluid = Fluid { density: 1.0, viscosity: 1.0 };
    let flow = Projection::new(grid, Side::WALL.everywhere(), fluid)?.with_diffusion(Diffusion::Explicit);
    let stone = Material { density: 2.0, youngs_modulus: 1e4, ..Material::default() };
    let mut bodies = RigidBodies::with_law(Periods::default(), law);
    bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z())?, stone)?;
    let start = Pose::at([0.5 * edge, 0.5 * edge, 0.5 + 0.5 * start]);
    bodies.add(Sphere::new(0.5)?, stone, start, Twist::default(), Freedom::FREE)?;
    let volume = PI / 6.0;
    let gravity = Vector::new(0.0, 0.0, -3.0 * PI * stokes / volume);
    let particles = Particles::new(bodies, SmoothForcing::new(1.0), 1.0, gravity);
    let mut fall = Simulation::new(flow, particles, WeightBalance::None)?;
    let mut found = Vec::new();
    loop {
        // From rest in small steps.
        let ramp = (0.05 * 1.15_f64.powi(fall.flow.steps() as i32)).min(1.0);
        fall.step(fall.flow.stable_dt(0.1) * ramp)?;
        let bodies = &fall.particles.bodies;
        let gap = 2.0 * (bodies.pose(BodyId(0)).position.z - 0.5);
        found.push([gap, stokes / -bodies.twist(BodyId(0)).linear.z]);
        if gap <= least || found.len() > 100_000 {
            return Ok(found);
        }
    }
}

/// The resistance κ of a sphere of radius R that moves towards a plane wall, as a multiple of 6πμR, at `gap` δ/R (Brenner 1961, Chem. Eng. Sci. 16, 242), cosh α = 1 + δ/R.
pub fn brenner(gap: f64) -> f64 {
    series(gap, |m, alpha| {
        let above = 2.0 * (m * alpha).sinh() + m * (2.0 * alpha).sinh();
        let below = 4.0 * (0.5 * m * alpha).sinh().powi(2) - (m * alpha.sinh()).powi(2);
        [above, below]
    })
}

/// The resistance of each of two equal spheres that approach one another at opposite speeds, `gap` δ/R apart: that of a sphere at half the distance from a free surface
/// (same source).
pub fn spheres(gap: f64) -> f64 {
    series(0.5 * gap, |m, alpha| {
        let above = 4.0 * (0.5 * m * alpha).cosh().powi(2) + (m * alpha.sinh()).powi(2);
        let below = 2.0 * (m * alpha).sinh() - m * (2.0 * alpha).sinh();
        [above, below]
    })
}

fn series(gap: f64, fraction: impl Fn(f64, f64) -> [f64; 2]) -> f64 {
    // arcosh without cancellation.
    let alpha = (gap + (gap * (2.0 + gap)).sqrt()).ln_1p();
    let terms = (40.0 / alpha).ceil() as usize + 10;
    let term = |n: usize| {
        let n = n as f64;
        let m = 2.0 * n + 1.0;
        let [above, below] = fraction(m, alpha);
        let share = if above.is_finite() && below.is_finite() { above / below - 1.0 } else { 0.0 };
        n * (n + 1.0) / ((m - 2.0) * (m + 2.0)) * share
    };
    4.0 / 3.0 * alpha.sinh() * (1..=terms).map(term).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_have_known_values() {
        for (gap, kappa) in [(1.0, 2.12554), (0.5, 3.20539), (0.2, 6.34089), (0.1, 11.4592), (0.05, 21.5858)]
        {
            assert!((brenner(gap) / kappa - 1.0).abs() < 1e-5, "{gap}: {} {kappa}", brenner(gap));
        }
        // Jeffrey & Onishi (1984): 1/2ξ + 9/20 ln(1/ξ) + 1.3456.
        let xi: f64 = 0.01;
        assert!((spheres(xi) / (0.5 / xi - 0.45 * xi.ln() + 1.3456) - 1.0).abs() < 1e-3, "{}", spheres(xi));
    }
}
