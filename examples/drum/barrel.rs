//! The drum and what is in it.
use crate::{Cli, Colour};
use example_support::Outcome;
use example_support::granular::{GRAVITY, Grain, Granulate, Law, Scene, line, ring_of_staves};
use render::solids::View;
use siltflow::dem::placing::{CrystalLattice, LatticeKind, Orientations};
use siltflow::dem::{Part, RigidBodies, Rolling, Union};
use siltflow::interfaces::{
    Aabb, Bodies, BodyId, Freedom, Kinematics, Periods, Point, Pose, Rotation, Twist, Vector,
};
use std::f64::consts::PI;

/// Pieces of the drum: half of them stand out.
const STAVES: usize = 36;
/// By how much, in diameters of a grain.
const RIDGE: f64 = 0.5;
/// What is left between the drum and its image.
const GAP: f64 = 1e-9;

/// The drum: its axis is the y axis.
pub(crate) struct Barrel {
    grains: Vec<Grain>,
    radius: f64,
    length: f64,
    speed: f64,
    colour: Colour,
    sides: Vec<f64>,
}

impl Barrel {
    pub(crate) fn build(cli: &Cli) -> Outcome<(Self, Granulate)> {
        let (radius, length) = (cli.radius, cli.length);
        let grains = cli.grains.grains(cli.number)?;
        let (material, wall) = (cli.grains.material()?, cli.grains.wall()?);
        let widest = grains.iter().map(|g| 2.0 * g.shape.bounding_radius()).fold(0.0, f64::max);
        for (flag, value, least) in [("--radius", radius, 3.0 * widest), ("--length", length, 2.0 * widest)] {
            if !(value >= least && value.is_finite()) {
                return Err(
                    format!("{flag} {value}: give at least {least} m for grains {widest} m wide").into()
                );
            }
        }
        if !cli.speed.is_finite() {
            return Err(format!("--speed {}: give a finite number", cli.speed).into());
        }
        let period = Periods::new([None, Some(length), None]);
        let law = Rolling(Law::from(cli.grains.law()));
        let mut bodies = RigidBodies::with_law(period, law);
        bodies.set_gravity(Vector::new(0.0, 0.0, -GRAVITY));

        let half = 0.5 * length * (1.0 - GAP);
        let (outer, ridge) = (radius + 1.5 * widest, radius - RIDGE * cli.grains.diameter);
        let ring = |inner: f64| {
            ring_of_staves(STAVES, [[inner, -half], [outer, -half], [inner, half], [outer, half]])
        };
        let (low, high) = (ring(radius)?, ring(ridge)?);
        let pieces = low.into_iter().zip(high).enumerate();
        let parts = pieces.map(|(i, (l, h))| if i % 2 == 0 { l } else { h });
        let drum = Union::new(parts.map(|s| Part { shape: s.shape, pose: s.pose }).collect())?;
        let pose = Pose {
            // Where grains are drawn: from 0 to the length.
            position: Point::new(0.0, 0.5 * length, 0.0),
            // The axis of the staves, z, becomes y.
            orientation: Rotation::from_euler_angles(-0.5 * PI, 0.0, 0.0),
        };
        // Clockwise as one looks along y.
        let turning = Twist { angular: Vector::new(0.0, cli.speed, 0.0), ..Twist::default() };
        bodies.add(drum, wall, pose, turning, Freedom::NONE)?;

        let places = places(&grains, ridge, length, widest, cli.grains.seed)?;
        for (grain, pose) in grains.iter().zip(&places) {
            bodies.add(grain.shape.clone(), material, *pose, Twist::default(), Freedom::FREE)?;
        }
        let sides = places.iter().map(|p| if p.position.x < 0.0 { 0.0 } else { 1.0 }).collect();
        let barrel = Self { grains, radius, length, speed: cli.speed, colour: cli.colour, sides };
        Ok((barrel, bodies))
    }

    /// Slope of the line through the highest grains of columns in the middle half \[rad\].
    fn surface(&self, bodies: &Granulate) -> Option<f64> {
        let width = self.grains[0].size;
        let n = (self.radius / width).floor() as usize;
        let mut tops: Vec<Option<(f64, f64)>> = vec![None; n];
        for b in bodies.ids().skip(1) {
            let p = bodies.pose(b).position;
            let column = (p.x + 0.5 * self.radius) / width;
            if column >= 0.0
                && let Some(top) = tops.get_mut(column as usize)
                && top.is_none_or(|(_, z)| p.z > z)
            {
                *top = Some((p.x, p.z));
            }
        }
        let points: Vec<_> = tops.into_iter().flatten().collect();
        (points.len() >= 3).then(|| line(&points).1.atan())
    }
}

/// Places on a lattice within the drum, from below.
fn places(grains: &[Grain], radius: f64, length: f64, widest: f64, seed: u64) -> Outcome<Vec<Pose>> {
    // A whole number of rows, so that they repeat.
    let rows = (length / (1.05 * widest)).floor();
    let distance = length / rows;
    let lattice = CrystalLattice::new(LatticeKind::SimpleCubic, distance)?;
    let play = lattice.play(widest, 0.02 * widest)?;
    let bounds =
        Aabb { min: [-radius, 0.0, -radius].into(), max: [radius, length - 0.5 * distance, radius].into() };
    let mut points = lattice.in_box(&bounds, 0.0)?;
    let reach = radius - 0.5 * widest - play - 0.02 * widest;
    points.retain(|p| p.x.hypot(p.z) < reach * (PI / STAVES as f64).cos());
    points.sort_by(|p, q| p.z.total_cmp(&q.z));
    if points.len() < grains.len() {
        let (n, room) = (grains.len(), points.len());
        return Err(format!(
            "--number {n}: there is room for {room} in the drum; give fewer, or a larger --radius"
        )
        .into());
    }
    points.truncate(grains.len());
    lattice.jitter(&mut points, play, seed)?;
    let turns = Orientations::Random.of(seed);
    Ok(points.into_iter().zip(turns).map(|(position, orientation)| Pose { position, orientation }).collect())
}

impl Scene for Barrel {
    fn first_grain(&self) -> usize {
        1
    }
    fn domain(&self) -> Aabb {
        let far = self.radius / (PI / STAVES as f64).cos();
        let low = [-far, f64::NEG_INFINITY, -far];
        Aabb { min: low.into(), max: low.map(|x: f64| -x).into() }
    }
    fn columns(&self) -> Vec<&'static str> {
        vec!["angle", "surface_slope"]
    }
    /// Both angles in degrees, upwards in the sense in which the drum turns.
    fn measure(&mut self, bodies: &Granulate, _: f64) -> Vec<f64> {
        let (mut mass, mut first) = (0.0, Vector::zeros());
        for b in bodies.ids().skip(1) {
            let m = bodies.inertia(b).mass;
            mass += m;
            first += m * bodies.pose(b).position.coords;
        }
        let centre = first / mass;
        // Turning from z towards x: below the axis the wall goes towards −x.
        let sense = -self.speed.signum();
        let angle = (sense * centre.x).atan2(-centre.z);
        let slope = sense * self.surface(bodies).unwrap_or(0.0);
        vec![angle.to_degrees(), slope.to_degrees()]
    }
    fn view(&self) -> View {
        let across = 2.4 * (self.radius + 2.0 * self.grains[0].size);
        View {
            middle: Point::new(0.0, 0.5 * self.length, 0.0),
            along: Vector::new(0.16, 1.0, -0.16),
            up: Vector::z(),
            width: 1.1 * across,
            height: across,
        }
    }
    fn value(&self, bodies: &Granulate, b: BodyId) -> f64 {
        match self.colour {
            Colour::Speed => 100.0 * bodies.twist(b).linear.norm(),
            Colour::Side => self.sides[b.0 - 1],
        }
    }
    fn scale(&self) -> (&'static str, (f64, f64)) {
        match self.colour {
            Colour::Speed => ("speed, cm/s", (0.0, 400.0 * (self.speed.abs() * self.radius).max(0.05))),
            Colour::Side => ("side at the start: 0 left, 1 right", (0.0, 1.0)),
        }
    }
    fn tells(&self, b: BodyId) -> (Option<f64>, &'static str) {
        let grain = &self.grains[b.0 - 1];
        (Some(grain.size), grain.kind)
    }
}
