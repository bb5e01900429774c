//! One body that moves as it is told, in a flow.
use crate::Outcome;
use crate::axes::gathered;
use crate::prescribed_bodies::{PrescribedBodies, forced_step};
use coupling::FlowSolver;
use dem::{Disc, Sphere};
use fv_mesh::{CartesianGrid, Diffusion, Fluid, Projection, Side};
use ibm::Forcing;
use interfaces::{BodyId, Kinematics, Point, Pose, Rotation, Solid, Twist, Vector, Wrench};
use std::f64::consts::TAU;

const BODY: BodyId = BodyId(0);

/// A flow with a body that moves in it as it is told.
pub struct MovedScene<const D: usize, A = Projection<D>> {
    /// The flow.
    pub flow: A,
    body: PrescribedBodies,
    forcing: Box<dyn Forcing>,
    /// Mass of the fluid that the body displaces \[kg\].
    displaced: f64,
}

impl<const D: usize, A: FlowSolver<D>> MovedScene<D, A> {
    /// With a `solid` of this `volume` that starts at `at` with this `twist`.
    pub fn new(
        flow: A,
        forcing: Box<dyn Forcing>,
        (solid, volume): (impl Solid + 'static, f64),
        at: Point,
        twist: Twist,
    ) -> Self {
        let displaced = flow.fluid().density * volume;
        let mut body = PrescribedBodies::default().with(solid, at.into(), 0.0);
        body.put(BODY, Pose::at(at.into()), twist);
        Self { flow, body, forcing, displaced }
    }

    /// Advances by `dt` to the position and twist given. Answers the force of the fluid on the body, −ρ∫f_ib dV + ρV dU/dt, as if the
    /// fluid inside moved with it (what is computed inside, ρΣλuV, is right on average, but its change from step to step has the noise
    /// of λ), and the torque of a body that turns steadily.
    ///
    /// # Errors
    /// Those of flow and forcing.
    pub fn step(&mut self, dt: f64, position: Point, twist: Twist) -> Outcome<Wrench> {
        let Self { flow, body, forcing, displaced } = self;
        let turn = Rotation::from_scaled_axis(twist.angular * dt);
        let orientation = turn * body.pose(BODY).orientation;
        let last = body.twist(BODY);
        body.put(BODY, Pose { position, orientation }, twist);
        forced_step(flow, &mut **forcing, body, dt)?;
        let mut impulse = forcing.reaction(BODY);
        impulse.force += *displaced * (twist.linear - last.linear);
        Ok(impulse * (1.0 / dt))
    }
}

/// A series of values at equal times as mean, slope and harmonics of its length, and what is left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Root mean square of what the fit leaves.
    pub rms: f64,
    /// Largest value of the series.
    pub peak: f64,
}

impl Noise {
    /// Of what a straight line and `harmonics` sines and cosines leave of the series, by least squares.
    pub fn of(series: &[f64], harmonics: usize) -> Self {
        let n = series.len();
        let columns = 2 + 2 * harmonics;
        let matrix = nalgebra::DMatrix::from_fn(n, columns, |i, j| {
            let t = i as f64 / n as f64;
            match j {
                0 => 1.0,
                1 => t,
                _ if j % 2 == 0 => (TAU * (j / 2) as f64 * t).sin(),
                _ => (TAU * (j / 2) as f64 * t).cos(),
            }
        });
        let values = nalgebra::DVector::from_column_slice(series);
        let normal = matrix.transpose() * &matrix;
        let rest = match normal.cholesky() {
            Some(factor) => &values - &matrix * factor.solve(&(matrix.transpose() * &values)),
            None => values.clone(),
        };
        Self { rms: rest.norm() / (n as f64).sqrt(), peak: values.amax() }
    }
}

/// A cylinder of diameter 1 that swings along x as −A sin(2πt/T) in fluid at rest, largest speed 1, with a Keulegan–Carpenter number of 5, in a
/// box of 40 × 30: without more, at Re 100 (Dütsch, Durst, Becker & Lienhart 1998, J. Fluid Mech. 360, 249).
pub struct Swinging<A = Projection<2>> {
    scene: MovedScene<2, A>,
    middle: [f64; 2],
    steps: usize,
    made: usize,
}

/// Lengths of the box of [`Swinging`].
const SWINGING_BOX: [f64; 2] = [40.0, 30.0];

impl Swinging {
    /// Time of a swing.
    pub const PERIOD: f64 = 5.0;

    /// The fluid at rest, of this viscosity, with so many cells per diameter, moved by `shift` cells against the cylinder's middle place.
    ///
    /// # Errors
    /// Those of the grid.
    pub fn still(per_diameter: usize, shift: [f64; 2], viscosity: f64) -> Outcome<Projection<2>> {
        let h = 1.0 / per_diameter as f64;
        let [length, height] = SWINGING_BOX;
        let x = gathered(length, h, [length / 2.0 - 2.0, length / 2.0 + 2.0], 1.05, shift[0])?;
        let y = gathered(height, h, [height / 2.0 - 1.2, height / 2.0 + 1.2], 1.05, shift[1])?;
        let fluid = Fluid { density: 1.0, viscosity };
        Ok(Projection::new(CartesianGrid::from_axes([x, y])?, Side::WALL.everywhere(), fluid)?
            .with_diffusion(Diffusion::Explicit))
    }

    /// With so many cells per diameter, moved by `shift` cells against the cylinder's middle place, and steps per swing.
    ///
    /// # Errors
    /// Those of grid and forcing.
    pub fn new(
        per_diameter: usize,
        steps: usize,
        shift: [f64; 2],
        forcing: Box<dyn Forcing>,
    ) -> Outcome<Self> {
        Self::within(Self::still(per_diameter, shift, 0.01)?, steps, forcing)
    }
}

impl<A: FlowSolver<2>> Swinging<A> {
    /// In this flow, in the box of [`Swinging::still`].
    ///
    /// # Errors
    /// Those of forcing and body.
    pub fn within(flow: A, steps: usize, forcing: Box<dyn Forcing>) -> Outcome<Self> {
        let middle = SWINGING_BOX.map(|length| 0.5 * length);
        let start = Twist { linear: -Vector::x(), ..Twist::default() };
        let disc = (Disc::new(0.5)?, 0.125 * TAU);
        let scene = MovedScene::new(flow, forcing, disc, Point::new(middle[0], middle[1], 0.0), start);
        Ok(Self { scene, middle, steps, made: 0 })
    }
    /// The flow.
    pub fn flow(&self) -> &A {
        &self.scene.flow
    }

    /// One step: the force along x over ρU²D.
    ///
    /// # Errors
    /// Those of flow and forcing.
    pub fn step(&mut self) -> Outcome<f64> {
        let amplitude = Swinging::PERIOD / TAU;
        let dt = Swinging::PERIOD / self.steps as f64;
        self.made += 1;
        let phase = TAU * self.made as f64 / self.steps as f64;
        let x = self.middle[0] - amplitude * phase.sin();
        let twist = Twist { linear: Vector::new(-phase.cos(), 0.0, 0.0), ..Twist::default() };
        Ok(self.scene.step(dt, Point::new(x, self.middle[1], 0.0), twist)?.force.x)
    }

    /// The forces along x of the next swing, step by step, over ρU²D.
    ///
    /// # Errors
    /// Those of flow and forcing.
    pub fn swing(&mut self) -> Outcome<Vec<f64>> {
        (0..self.steps).map(|_| self.step()).collect()
    }
}

/// A cylinder or sphere of diameter 1 in a periodic box of edge `edge`, set in motion at speed 1 against the fluid: either it
/// `moves` through fluid at rest, or the fluid passes it. Both are the same flow. Answers the forces against the motion of the first
/// `time`, step by step, over ½ρU² and the frontal area.
///
/// # Errors
/// Those of grid, flow and forcing.
pub fn passing<const D: usize>(
    moves: bool,
    edge: usize,
    per_diameter: usize,
    viscosity: f64,
    [time, dt]: [f64; 2],
    forcing: Box<dyn Forcing>,
) -> Outcome<Vec<f64>> {
    let grid = CartesianGrid::new([edge * per_diameter; D], [edge as f64; D])?;
    let fluid = Fluid { density: 1.0, viscosity };
    let mut flow =
        Projection::new(grid, Side::Periodic.everywhere(), fluid)?.with_diffusion(Diffusion::Explicit);
    // Neither on a face nor on a centre.
    let place = 0.5 * edge as f64 + 0.23 / per_diameter as f64;
    let at = Point::new(place, place, if D == 2 { 0.0 } else { place });
    // Along no axis of the grid.
    let heading = Vector::new(0.96, 0.28, 0.0);
    if !moves {
        flow.set_velocity(|_| std::array::from_fn(|a| -heading[a]));
    }
    let twist = Twist { linear: if moves { heading } else { Vector::zeros() }, ..Twist::default() };
    let area = if D == 2 { 1.0 } else { 0.125 * TAU };
    let mut scene = match D {
        2 => MovedScene::new(flow, forcing, (Disc::new(0.5)?, 0.125 * TAU), at, twist),
        _ => MovedScene::new(flow, forcing, (Sphere::new(0.5)?, TAU / 12.0), at, twist),
    };
    (1..=(time / dt).round() as usize)
        .map(|step| {
            let position = at + twist.linear * (dt * step as f64);
            Ok(-scene.step(dt, position, twist)?.force.dot(&heading) / (0.5 * area))
        })
        .collect()
}

/// The torque on a sphere of diameter 1 that turns at 1 about an oblique axis in creeping flow, over −8πμR³Ω; in a box of edge 8 with
/// walls (which make it larger by about (R/4)³ = 0.2 %).
///
/// # Errors
/// Those of grid, flow and forcing.
pub fn turning(per_diameter: usize, forcing: Box<dyn Forcing>, diffusion: Diffusion) -> Outcome<f64> {
    let (edge, h) = (8.0, 1.0 / per_diameter as f64);
    // Equal cells as far as the widest kernel reaches.
    let patch = [-1.0, 1.0].map(|side| 0.5 * edge + side * (0.5 + 10.0 * h));
    let axis = |shift| gathered(edge, h, patch, 1.15, shift);
    let grid = CartesianGrid::from_axes([axis(0.37)?, axis(0.3)?, axis(0.11)?])?;
    let flow = Projection::new(grid, Side::WALL.everywhere(), Fluid { density: 1.0, viscosity: 1.0 })?
        .with_diffusion(diffusion);
    let at = Point::new(0.5 * edge, 0.5 * edge, 0.5 * edge);
    let twist = Twist { linear: Vector::zeros(), angular: Vector::new(0.48, 0.6, 0.64) };
    let mut scene = MovedScene::new(flow, forcing, (Sphere::new(0.5)?, TAU / 12.0), at, twist);
    let mut last = f64::INFINITY;
    loop {
        // The torque of the start dies with the root of time.
        let end = scene.flow.time() + 0.1;
        let mut torque = 0.0;
        while scene.flow.time() < end {
            let dt = scene.flow.stable_dt(0.4);
            torque = -scene.step(dt, at, twist)?.torque.dot(&twist.angular);
        }
        let torque = torque / (0.5 * TAU);
        if (torque / last - 1.0).abs() < 1e-4 {
            return Ok(torque);
        }
        last = torque;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_what_harmonics_leave() {
        let series: Vec<f64> = (0..200)
            .map(|i| {
                let t = f64::from(i) / 200.0;
                3.0 * (TAU * 5.0 * t).sin() + 0.5 * t + if i % 2 == 0 { 0.01 } else { -0.01 }
            })
            .collect();
        let noise = Noise::of(&series, 12);
        assert!((noise.rms - 0.01).abs() < 1e-4 && (noise.peak - 3.3).abs() < 0.2, "{noise:?}");
    }
}
