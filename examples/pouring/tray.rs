//! The tray and the spout above it.
use crate::Cli;
use example_support::Outcome;
use example_support::granular::{GRAVITY, Grain, Granulate, Law, Scene, Stave, cone_slope, ring_of_staves};
use render::solids::View;
use siltflow::dem::placing::{CrystalLattice, LatticeKind, Orientations};
use siltflow::dem::{ConvexPolyhedron, HalfSpace, Material, RigidBodies, Rolling, Shape};
use siltflow::interfaces::{
    Aabb, BodyId, Freedom, Kinematics, Periods, Point, Pose, Rotation, Twist, Vector,
};
use std::f64::consts::PI;
use std::sync::Arc;

/// Pieces of the rim, and of the wall that keeps what is over it.
const STAVES: usize = 32;
/// Radius of that wall by the tray's.
const YARD: f64 = 1.5;
/// Share of the run in which grains come in.
const POURING: f64 = 0.75;
/// Least time between two batches \[s\].
const LEAST_INTERVAL: f64 = 0.012;
/// Gaps between grains at the spout, by their diameter.
const APART: f64 = 1.12;

/// Where grains are poured: the tray is at z = 0 around the origin.
pub(crate) struct Tray {
    grains: Vec<Grain>,
    turns: Vec<Rotation>,
    material: Material,
    staves: Vec<Stave>,
    radius: f64,
    spout: f64,
    /// Grains come in so often \[s\], there, and so fast \[m/s\].
    interval: f64,
    last_turn: Option<u64>,
    places: Vec<Point>,
    speed: f64,
    next: usize,
    /// Largest diameter of a sphere around a grain.
    widest: f64,
}

impl Tray {
    pub(crate) fn build(cli: &Cli, end: f64) -> Outcome<(Self, Granulate)> {
        let grains = cli.grains.grains(cli.number)?;
        let (material, wall) = (cli.grains.material()?, cli.grains.wall()?);
        let widest = grains.iter().map(|g| 2.0 * g.shape.bounding_radius()).fold(0.0, f64::max);
        let volume: f64 = grains.iter().map(|g| g.shape.inertia(1.0).volume).sum();
        let slope = 22_f64.to_radians().tan();
        let radius = cli.radius.unwrap_or((0.5 * volume / 0.58 * 3.0 / (PI * slope)).cbrt());
        let spout = cli.spout.unwrap_or(1.3 * slope * radius + 5.0 * widest);
        for (flag, value) in [("--radius", radius), ("--spout", spout)] {
            if !(value > 2.0 * widest && value.is_finite()) {
                let least = 2.0 * widest;
                return Err(
                    format!("{flag} {value}: give more than two diameters of a grain, {least} m").into()
                );
            }
        }
        let row = end / cli.run.rows as f64;
        let every = (LEAST_INTERVAL / row).ceil().max(1.0);
        let interval = every * row;
        let batch = (cli.number as f64 / (POURING * end / interval).max(1.0)).ceil() as usize;
        let lattice = CrystalLattice::new(LatticeKind::PlaneHexagonal, APART * widest)?;
        let across = 2.0 * APART * widest * ((batch as f64).sqrt() + 2.0);
        let bounds = Aabb { min: [-across, -across, 0.0].into(), max: [across, across, 0.0].into() };
        let mut places = lattice.in_box(&bounds, 0.0)?;
        // About the middle.
        let middle = places.iter().map(|p| p.coords).sum::<Vector>() / places.len() as f64;
        places.iter_mut().for_each(|p| *p -= middle);
        places.sort_by(|p, q| p.coords.norm_squared().total_cmp(&q.coords.norm_squared()));
        places.truncate(batch);
        let spread = places.last().map_or(0.0, |p| p.coords.norm());
        if spread > 0.5 * radius {
            return Err(format!(
                "{batch} grains at once would be poured over {spread:.3} m: more than half the tray; give more --rows or a longer --end"
            )
            .into());
        }
        // Those before are out of the way.
        let speed = (APART * widest / interval - 0.5 * GRAVITY * interval).max(0.3);

        let law = Rolling(Law::from(cli.grains.law()));
        let mut bodies = RigidBodies::with_law(Periods::default(), law);
        bodies.set_gravity(Vector::new(0.0, 0.0, -GRAVITY));
        bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z())?, wall)?;
        let ring = |inner: f64, height: f64| {
            let outer = inner + widest;
            ring_of_staves(STAVES, [[inner, 0.0], [outer, 0.0], [inner, height], [outer, height]])
        };
        let mut staves = ring(radius, 0.8 * widest)?;
        staves.extend(ring(YARD * radius, 2.5 * widest)?);
        for stave in &staves {
            bodies.add(stave.shape.clone(), wall, stave.pose, Twist::default(), Freedom::NONE)?;
        }
        let turns = Orientations::Random.of(cli.grains.seed).take(grains.len()).collect();
        let tray = Self {
            grains,
            turns,
            material,
            staves,
            radius,
            spout,
            interval,
            last_turn: None,
            places,
            speed,
            next: 0,
            widest,
        };
        Ok((tray, bodies))
    }

    /// The number of the batch at `time`, from 0.
    fn turn(&self, time: f64) -> u64 {
        (time / self.interval + 1e-6) as u64
    }

    /// The next grain, if there is one.
    fn add(&mut self, bodies: &mut Granulate, position: Point) -> Outcome<()> {
        let Some(grain) = self.grains.get(self.next) else { return Ok(()) };
        let pose = Pose { position, orientation: self.turns[self.next] };
        let twist = Twist { linear: Vector::new(0.0, 0.0, -self.speed), ..Twist::default() };
        bodies.add(grain.shape.clone(), self.material, pose, twist, Freedom::FREE)?;
        self.next += 1;
        Ok(())
    }
}

impl Scene for Tray {
    fn first_grain(&self) -> usize {
        2 * STAVES
    }
    fn domain(&self) -> Aabb {
        let far = (YARD * self.radius + self.widest) / (PI / STAVES as f64).cos();
        Aabb { min: [-far, -far, 0.0].into(), max: [far, far, 1.5 * self.spout].into() }
    }
    fn feed(&mut self, bodies: &mut Granulate, time: f64) -> Outcome<()> {
        let turn = self.turn(time);
        if self.last_turn == Some(turn) {
            return Ok(());
        }
        self.last_turn = Some(turn);
        let turned = Rotation::from_euler_angles(0.0, 0.0, 2.4 * turn as f64);
        let places: Vec<Point> = self.places.iter().map(|p| turned * p + Vector::z() * self.spout).collect();
        // What has been thrown up to the spout is in the way.
        let near: Vec<Point> = bodies
            .ids()
            .skip(self.first_grain())
            .map(|b| bodies.pose(b).position)
            .filter(|p| p.z > self.spout - APART * self.widest)
            .collect();
        let widest = self.widest;
        let clear = |p: &&Point| near.iter().all(|q| (*p - q).norm() > widest);
        for place in places.iter().filter(clear) {
            self.add(bodies, *place)?;
        }
        Ok(())
    }
    fn refill(&mut self, bodies: &mut Granulate, number: usize, time: f64) -> Outcome<()> {
        self.last_turn = Some(self.turn(time));
        while bodies.n_bodies() < number && self.next < self.grains.len() {
            self.add(bodies, Point::new(0.0, 0.0, self.spout))?;
        }
        Ok(())
    }
    fn columns(&self) -> Vec<&'static str> {
        vec!["angle", "over_the_rim"]
    }
    /// Angle of the flank \[degrees\], and how many grains are beyond the rim.
    fn measure(&mut self, bodies: &Granulate, _: f64) -> Vec<f64> {
        let grains = || bodies.ids().skip(self.first_grain());
        // What is still falling is no part of the heap.
        let lies = |b: &BodyId| bodies.twist(*b).linear.norm() < 0.15;
        let top = |b: BodyId| {
            let p = bodies.pose(b).position;
            [p.x, p.y, p.z + 0.5 * self.grains[b.0 - self.first_grain()].size]
        };
        let slope =
            cone_slope(grains().filter(lies).map(top), 0.35 * self.radius, 0.95 * self.radius, self.widest);
        let over = grains().filter(|b| bodies.pose(*b).position.coords.xy().norm() > self.radius).count();
        vec![slope.unwrap_or(0.0).to_degrees(), over as f64]
    }
    fn view(&self) -> View {
        let width = 2.3 * YARD * self.radius;
        View {
            middle: Point::new(0.0, 0.0, 0.40 * self.spout),
            along: Vector::new(0.0, 1.0, -0.36),
            up: Vector::z(),
            width,
            height: 0.62 * width,
        }
    }
    fn furniture(&self) -> Vec<(Arc<dyn Shape>, Pose)> {
        let (r, t) = (YARD * self.radius + self.widest, 0.5 * self.widest);
        let rim = |z: f64| {
            (0..STAVES).map(move |i| {
                let (sin, cos) = (2.0 * PI * (f64::from(i as u32) + 0.5) / STAVES as f64).sin_cos();
                let r = r / (PI / STAVES as f64).cos();
                [r * cos, r * sin, z]
            })
        };
        let points: Vec<[f64; 3]> = rim(0.0).chain(rim(-t)).collect();
        let plate = ConvexPolyhedron::from_points(&points).ok();
        plate.map(|p| (Arc::new(p) as Arc<dyn Shape>, Pose::at([0.0, 0.0, -0.5 * t]))).into_iter().collect()
    }
    /// The outer wall's front would be in the way.
    fn hidden(&self, _: &Granulate, b: BodyId) -> bool {
        (STAVES..2 * STAVES).contains(&b.0) && self.staves[b.0].angle.sin() < 0.0
    }
    fn value(&self, _: &Granulate, b: BodyId) -> f64 {
        // In tenths of the whole, in the order in which they came.
        let share = (b.0 - self.first_grain()) as f64 / self.grains.len() as f64;
        (10.0 * share).floor() * 10.0
    }
    fn scale(&self) -> (&'static str, (f64, f64)) {
        ("poured before it, % of all grains", (0.0, 90.0))
    }
    fn tells(&self, b: BodyId) -> (Option<f64>, &'static str) {
        let grain = &self.grains[b.0 - self.first_grain()];
        (Some(grain.size), grain.kind)
    }
}
