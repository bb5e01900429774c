//! The box and what falls into it.
use crate::{Cli, Colour};
use example_support::Outcome;
use example_support::granular::{GRAVITY, Grain, Granulate, Law, Scene, solid_fraction, starts};
use render::solids::View;
use siltflow::dem::placing::read_bodies;
use siltflow::dem::{Cuboid, HalfSpace, RigidBodies, Rolling, Shape};
use siltflow::interfaces::{Aabb, BodyId, Freedom, Kinematics, Periods, Point, Pose, Twist, Vector};
use std::sync::Arc;

/// Grains in a box, its floor at z = 0, from 0 to its width along x and y.
pub(crate) struct Heap {
    grains: Vec<Grain>,
    width: f64,
    periodic: bool,
    /// Of each grain at the start.
    heights: Vec<f64>,
    /// Of the picture.
    tall: f64,
    colour: Colour,
    from_table: bool,
    fall_speed: f64,
}

impl Heap {
    pub(crate) fn build(cli: &Cli) -> Outcome<(Self, Granulate)> {
        let (material, wall) = (cli.grains.material()?, cli.grains.wall()?);
        let rows = match &cli.table {
            Some(path) => {
                let told = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
                let file = std::fs::File::open(path).map_err(|e| told(&e))?;
                Some(read_bodies(file).map_err(|e| told(&e))?)
            }
            None => None,
        };
        let grains = match &rows {
            Some(rows) => cli.grains.grains_of(rows)?,
            None => cli.grains.grains(cli.number)?,
        };
        if grains.is_empty() {
            return Err("the table has no bodies".into());
        }
        let volume: f64 = grains.iter().map(|g| g.shape.inertia(1.0).volume).sum();
        let width = cli.width.unwrap_or((volume / (0.58 * 1.25)).cbrt());
        if !(width > 0.0 && width.is_finite()) {
            return Err(format!("--width {width}: give a positive, finite length").into());
        }
        let places: Vec<(Pose, Twist)> = match rows {
            Some(rows) => rows.into_iter().map(|r| (r.pose, r.twist.unwrap_or_default())).collect(),
            None => {
                let room = Aabb { min: [0.0; 3].into(), max: [width, width, 0.0].into() };
                let poses = starts(&grains, room, [cli.periodic; 2], cli.start, cli.grains.seed)?;
                poses.into_iter().map(|p| (p, Twist::default())).collect()
            }
        };
        let period = cli.periodic.then_some(width);
        let law = Rolling(Law::from(cli.grains.law()));
        let mut bodies = RigidBodies::with_law(Periods::new([period, period, None]), law);
        bodies.set_gravity(Vector::new(0.0, 0.0, -GRAVITY));
        bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z())?, wall)?;
        if !cli.periodic {
            let far = Point::new(width, width, 0.0);
            for (at, normal) in [
                (Point::origin(), Vector::x()),
                (Point::origin(), Vector::y()),
                (far, -Vector::x()),
                (far, -Vector::y()),
            ] {
                bodies.add_wall(HalfSpace::new(at, normal)?, wall)?;
            }
        }
        for (grain, (pose, twist)) in grains.iter().zip(&places) {
            bodies.add(grain.shape.clone(), material, *pose, *twist, Freedom::FREE)?;
        }
        let heights: Vec<f64> = places.iter().map(|(p, _)| p.position.z).collect();
        let top = heights.iter().copied().fold(0.0, f64::max) + cli.grains.diameter;
        let heap = Self {
            grains,
            width,
            periodic: cli.periodic,
            heights,
            tall: top,
            colour: cli.colour,
            from_table: cli.table.is_some(),
            fall_speed: (GRAVITY * top).sqrt(),
        };
        Ok((heap, bodies))
    }
}

impl Scene for Heap {
    fn domain(&self) -> Aabb {
        let beyond = if self.periodic { f64::INFINITY } else { 0.0 };
        let (low, high) = (-beyond, self.width + beyond);
        Aabb { min: [low, low, 0.0].into(), max: [high, high, 3.0 * self.tall].into() }
    }
    fn may_touch(&self) -> bool {
        self.from_table
    }
    fn columns(&self) -> Vec<&'static str> {
        vec!["fraction", "height"]
    }
    /// Solid fraction between a quarter and seven tenths of the height, and the height below which 19 of 20 centres are.
    fn measure(&mut self, bodies: &Granulate, _: f64) -> Vec<f64> {
        let mut heights: Vec<f64> = bodies.ids().map(|b| bodies.pose(b).position.z).collect();
        heights.sort_unstable_by(f64::total_cmp);
        let h = heights[heights.len() * 19 / 20];
        vec![solid_fraction(bodies, 0, self.width * self.width, 0.25 * h, 0.7 * h), h]
    }
    fn view(&self) -> View {
        let high = self.tall.min(2.4 * self.width);
        View {
            middle: Point::new(0.5 * self.width, 0.5 * self.width, 0.46 * high),
            along: Vector::new(-0.55, 1.0, -0.42),
            up: Vector::z(),
            width: 1.75 * self.width,
            height: 0.95 * high + 0.85 * self.width,
        }
    }
    fn furniture(&self) -> Vec<(Arc<dyn Shape>, Pose)> {
        let (w, t) = (self.width, 0.03 * self.width);
        let high = self.tall.min(2.4 * w);
        let plate = |edges: [f64; 3], at: [f64; 3]| {
            Cuboid::new(edges).ok().map(|c| (Arc::new(c) as Arc<dyn Shape>, Pose::at(at)))
        };
        let floor = plate([w, w, t], [0.5 * w, 0.5 * w, -0.5 * t]);
        let back = plate([w + t, t, high + t], [0.5 * (w - t), w + 0.5 * t, 0.5 * (high - t)]);
        let side = plate([t, w, high + t], [-0.5 * t, 0.5 * w, 0.5 * (high - t)]);
        [floor].into_iter().chain(if self.periodic { [None, None] } else { [back, side] }).flatten().collect()
    }
    fn value(&self, bodies: &Granulate, b: BodyId) -> f64 {
        match self.colour {
            Colour::Height => 100.0 * self.heights[b.0],
            Colour::Speed => bodies.twist(b).linear.norm(),
            Colour::Size => 1e3 * self.grains[b.0].size,
        }
    }
    fn scale(&self) -> (&'static str, (f64, f64)) {
        let sizes = self.grains.iter().map(|g| 1e3 * g.size);
        match self.colour {
            Colour::Height => ("height at the start, cm", (0.0, 100.0 * self.tall)),
            Colour::Speed => ("speed, m/s", (0.0, self.fall_speed)),
            Colour::Size => {
                ("diameter, mm", (sizes.clone().fold(f64::MAX, f64::min), sizes.fold(0.0, f64::max)))
            }
        }
    }
    fn tells(&self, b: BodyId) -> (Option<f64>, &'static str) {
        (Some(self.grains[b.0].size), self.grains[b.0].kind)
    }
}
