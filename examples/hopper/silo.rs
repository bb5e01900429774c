//! The silo, its funnel and its gate.
use crate::Cli;
use example_support::Outcome;
use example_support::granular::{
    GRAVITY, Grain, Granulate, Law, Scene, Stave, ring_of_staves, solid_fraction, starts,
};
use render::solids::View;
use siltflow::dem::{Cuboid, HalfSpace, RigidBodies, Rolling, Shape};
use siltflow::interfaces::{
    Aabb, Bodies, BodyId, Dynamics, Freedom, Kinematics, Periods, Point, Pose, Twist, Vector,
};
use std::f64::consts::PI;
use std::sync::Arc;

/// Pieces of the funnel.
const STAVES: usize = 24;
/// How fast the gate is drawn away \[m/s\]: no grain keeps up with it.
const GATE_SPEED: f64 = 4.0;
/// Layers of one colour.
const LAYERS: f64 = 9.0;

/// What is filled and runs out: the opening is at z = 0, its middle at the origin.
pub(crate) struct Silo {
    grains: Vec<Grain>,
    staves: Vec<Stave>,
    width: f64,
    orifice: f64,
    /// Heights of the bin's floor, of the funnel's upper end at the walls' middles, and of what was filled in at first.
    floor: f64,
    shoulder: f64,
    filled: f64,
    open: f64,
    density: f64,
    /// Of all grains \[kg\].
    pub(crate) mass: f64,
    layers: Vec<f64>,
    fraction: Option<f64>,
}

impl Silo {
    pub(crate) fn build(cli: &Cli) -> Outcome<(Self, Granulate)> {
        let (width, d) = (cli.width, cli.grains.diameter);
        let grains = cli.grains.grains(cli.number)?;
        let largest = grains.iter().map(|g| 2.0 * g.shape.bounding_radius()).fold(0.0, f64::max);
        if !(cli.orifice > 0.0 && cli.orifice < width && width.is_finite()) {
            return Err(
                format!("--orifice {} --width {width}: the opening must be narrower", cli.orifice).into()
            );
        }
        if !(0.0..=75.0).contains(&cli.slope) {
            return Err(format!("--slope {}: give 0 to 75 degrees", cli.slope).into());
        }
        if !(cli.open >= 0.0 && cli.open.is_finite()) {
            return Err(format!("--open {}: give zero or a positive time", cli.open).into());
        }
        let (material, wall) = (cli.grains.material()?, cli.grains.wall()?);
        let law = Rolling(Law::from(cli.grains.law()));
        let mut bodies = RigidBodies::with_law(Periods::default(), law);
        bodies.set_gravity(Vector::new(0.0, 0.0, -GRAVITY));

        // A polygon of the same area as the round opening; the funnel's upper end is beyond the corners.
        let sides = STAVES as f64;
        let inner = 0.5 * cli.orifice * (PI / (sides * (PI / sides).tan())).sqrt();
        let outer = 0.75 * width;
        let rise = cli.slope.to_radians().tan();
        let (top, thick) = ((outer - inner) * rise, 1.5 * largest);
        // Sharp at the opening: what is through is free.
        let section = [[inner, 0.0], [outer, top], [inner + 0.8 * thick, -thick], [outer, top - thick]];
        let staves = ring_of_staves(STAVES, section)?;
        for stave in &staves {
            bodies.add(stave.shape.clone(), wall, stave.pose, Twist::default(), Freedom::NONE)?;
        }
        let gate = Cuboid::new([1.5 * cli.orifice, 1.5 * cli.orifice, thick])?;
        bodies.add(gate, wall, Pose::at([0.0, 0.0, -0.5 * thick]), Twist::default(), Freedom::NONE)?;

        let volume: f64 = grains.iter().map(|g| g.shape.inertia(1.0).volume).sum();
        // A loose heap, some way below the funnel.
        let floor = -(volume / (0.5 * width * width) + 0.4 * width + 2.0 * thick);
        let half = 0.5 * width;
        for (at, normal) in [
            ([0.0, 0.0, floor], Vector::z()),
            ([-half, 0.0, 0.0], Vector::x()),
            ([half, 0.0, 0.0], -Vector::x()),
            ([0.0, -half, 0.0], Vector::y()),
            ([0.0, half, 0.0], -Vector::y()),
        ] {
            bodies.add_wall(HalfSpace::new(at.into(), normal)?, wall)?;
        }
        // Nothing of the funnel reaches above this inside of the walls.
        let bottom = (half * 2.0_f64.sqrt() - inner).max(0.0) * rise;
        let room = Aabb { min: [-half, -half, bottom].into(), max: [half, half, bottom].into() };
        let poses = starts(&grains, room, [false; 2], cli.start, cli.grains.seed)?;
        for (grain, pose) in grains.iter().zip(&poses) {
            bodies.add(grain.shape.clone(), material, *pose, Twist::default(), Freedom::FREE)?;
        }
        let starts: Vec<f64> = poses.iter().map(|p| p.position.z).collect();
        let lowest = starts.iter().copied().fold(f64::MAX, f64::min);
        let filled = starts.iter().copied().fold(bottom, f64::max) + d;
        let layer =
            |z: &f64| (LAYERS * (z - lowest) / (filled - d - lowest).max(d)).floor().min(LAYERS - 1.0) + 1.0;
        let silo = Self {
            width,
            orifice: cli.orifice,
            floor,
            shoulder: (half - inner) * rise,
            filled,
            open: cli.open,
            density: cli.grains.density,
            mass: cli.grains.density * volume,
            grains,
            staves,
            layers: starts.iter().map(layer).collect(),
            fraction: None,
        };
        Ok((silo, bodies))
    }

    /// About how long it takes to run out \[s\].
    pub(crate) fn foreseen(&self) -> f64 {
        let reach = (self.orifice - 1.4 * self.grains[0].size).max(0.3 * self.orifice);
        self.mass / (0.58 * 0.6 * self.density * GRAVITY.sqrt() * reach.powf(2.5))
    }

    /// Mass over volume in the filled silo, when the gate opens \[kg/m³\].
    pub(crate) fn bulk_density(&self) -> Option<f64> {
        self.fraction.map(|f| f * self.density)
    }

    /// From just above the funnel to just below the surface.
    fn fraction_above(&self, bodies: &Granulate) -> Option<f64> {
        let d = self.grains[0].size;
        let mut heights: Vec<f64> =
            bodies.ids().skip(self.first_grain()).map(|b| bodies.pose(b).position.z).collect();
        heights.sort_unstable_by(f64::total_cmp);
        // The surface is not level.
        let top = heights.get(heights.len() * 9 / 10).copied()? - d;
        let corners =
            self.shoulder * (0.71 * self.width - 0.5 * self.orifice) / (0.5 * (self.width - self.orifice));
        let low = corners.max(d);
        (top > low + 2.0 * d)
            .then(|| solid_fraction(bodies, self.first_grain(), self.width * self.width, low, top))
    }
}

impl Scene for Silo {
    fn first_grain(&self) -> usize {
        STAVES + 1
    }
    fn domain(&self) -> Aabb {
        let half = 0.5 * self.width;
        let above = 2.0 * self.filled.abs() + self.width;
        Aabb { min: [-half, -half, self.floor].into(), max: [half, half, above].into() }
    }
    fn steer(&mut self, bodies: &mut Granulate, time: f64) {
        let gate = BodyId(STAVES);
        let away = bodies.pose(gate).position.z < self.floor - self.width;
        let speed = if time < self.open || away { 0.0 } else { -GATE_SPEED };
        let linear = Vector::new(0.0, 0.0, speed);
        bodies.set_twist(gate, Twist { linear, ..Twist::default() });
    }
    fn columns(&self) -> Vec<&'static str> {
        vec!["discharged", "flow", "fraction_above"]
    }
    /// Mass below the opening \[kg\], mass flow through it \[kg/s\] by the momentum of what is just there, solid fraction in the silo.
    fn measure(&mut self, bodies: &Granulate, time: f64) -> Vec<f64> {
        let d = self.grains[0].size;
        let (mut out, mut flow) = (0.0, 0.0);
        for b in bodies.ids().skip(self.first_grain()) {
            let (z, mass) = (bodies.pose(b).position.z, bodies.inertia(b).mass);
            if z < 0.0 {
                out += mass;
            }
            // ∫ρ u dz over a slab, by its height.
            if z.abs() < d {
                flow -= mass * bodies.twist(b).linear.z / (2.0 * d);
            }
        }
        let fraction = self.fraction_above(bodies);
        if time <= self.open {
            self.fraction = fraction;
        }
        vec![out, flow, fraction.unwrap_or(0.0)]
    }
    fn view(&self) -> View {
        let (low, high) = (self.floor, self.filled.min(1.6 * self.width - self.floor));
        let height = 1.10 * (high - low) + 0.15 * self.width;
        View {
            middle: Point::new(0.0, 0.0, 0.5 * (low + high)),
            along: Vector::new(0.0, 1.0, -0.22),
            up: Vector::z(),
            width: (1.35 * self.width).max(0.6 * height),
            height,
        }
    }
    fn furniture(&self) -> Vec<(Arc<dyn Shape>, Pose)> {
        let (w, t) = (self.width, 0.03 * self.width);
        let (low, high) = (self.floor, self.filled);
        let plate = |edges: [f64; 3], at: [f64; 3]| {
            Cuboid::new(edges).ok().map(|c| (Arc::new(c) as Arc<dyn Shape>, Pose::at(at)))
        };
        let (tall, middle) = (high - low, 0.5 * (high + low));
        [
            plate([w + 2.0 * t, w + t, t], [0.0, 0.5 * t, low - 0.5 * t]),
            plate([w + 2.0 * t, t, tall], [0.0, 0.5 * (w + t), middle]),
            plate([t, 0.5 * w, tall], [0.5 * (w + t), 0.25 * w, middle]),
            plate([t, 0.5 * w, tall], [-0.5 * (w + t), 0.25 * w, middle]),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
    /// The front half is cut away, above the opening; the whole heap below is shown.
    fn hidden(&self, bodies: &Granulate, b: BodyId) -> bool {
        match b.0 {
            i if i < STAVES => self.staves[i].angle.sin() < -0.05,
            STAVES => bodies.pose(b).position.z < self.floor,
            _ => bodies.pose(b).position.y < 0.0,
        }
    }
    fn value(&self, _: &Granulate, b: BodyId) -> f64 {
        self.layers[b.0 - self.first_grain()]
    }
    fn scale(&self) -> (&'static str, (f64, f64)) {
        ("layer at the start, from below", (1.0, LAYERS))
    }
    fn tells(&self, b: BodyId) -> (Option<f64>, &'static str) {
        let grain = &self.grains[b.0 - self.first_grain()];
        (Some(grain.size), grain.kind)
    }
}
