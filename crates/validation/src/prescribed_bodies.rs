//! Bodies that are where they are told to be and move as they are told.
use crate::Outcome;
use coupling::FlowSolver;
use ibm::Forcing;
use interfaces::{
    Aabb, Bodies, BodyId, Freedom, Inertia, Kinematics, Point, Pose, Rotation, Solid, SurfaceElement, Twist,
    Vector,
};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Some solids, with their place and motion.
#[derive(Clone, Default)]
pub struct PrescribedBodies {
    solids: Vec<Arc<dyn Solid>>,
    poses: Vec<Pose>,
    twists: Vec<Twist>,
}

impl PrescribedBodies {
    /// The same with one more, `turning` \[rad/s\] about the axis z.
    #[must_use]
    pub fn with(mut self, solid: impl Solid + 'static, at: [f64; 3], turning: f64) -> Self {
        self.solids.push(Arc::new(solid));
        self.poses.push(Pose::at(at));
        self.twists.push(Twist { linear: Vector::zeros(), angular: Vector::new(0.0, 0.0, turning) });
        self
    }
    /// The same with the last one turned by `angle` \[rad\] about the axis z.
    #[must_use]
    pub fn turned(mut self, angle: f64) -> Self {
        if let Some(pose) = self.poses.last_mut() {
            pose.orientation = Rotation::from_axis_angle(&Vector::z_axis(), angle);
        }
        self
    }
    /// Puts body `b` somewhere else, with another motion.
    pub fn put(&mut self, b: BodyId, pose: Pose, twist: Twist) {
        (self.poses[b.0], self.twists[b.0]) = (pose, twist);
    }
}

/// One step of `dt` \[s\] of a flow with bodies where they are at its end.
///
/// # Errors
/// Those of flow and forcing.
pub fn forced_step<const D: usize, A: FlowSolver<D>>(
    flow: &mut A,
    forcing: &mut dyn Forcing,
    bodies: &PrescribedBodies,
    dt: f64,
) -> Outcome<()> {
    flow.predict(dt, [0.0; D])?;
    forcing.begin(flow.viscous_step(dt));
    forcing.place(flow.velocity(), bodies)?;
    for _ in 0..forcing.rounds() {
        forcing.force(flow.velocity_mut(), bodies);
        flow.project(dt)?;
    }
    flow.follow_walls(bodies)?;
    Ok(flow.finish(dt)?)
}

impl Kinematics for PrescribedBodies {
    fn n_bodies(&self) -> usize {
        self.solids.len()
    }
    fn pose(&self, b: BodyId) -> Pose {
        self.poses[b.0]
    }
    fn twist(&self, b: BodyId) -> Twist {
        self.twists[b.0]
    }
}

impl Bodies for PrescribedBodies {
    fn solid(&self, b: BodyId) -> &dyn Solid {
        &*self.solids[b.0]
    }
    fn inertia(&self, _: BodyId) -> Inertia {
        Inertia { mass: 1.0, volume: 1.0, tensor: nalgebra::Matrix3::identity() }
    }
    fn freedom(&self, _: BodyId) -> Freedom {
        Freedom::NONE
    }
}

/// All that is not within `radius` of the axis z.
#[derive(Clone, Copy, Debug)]
pub struct Bore {
    /// Radius of the bore \[m\].
    pub radius: f64,
    /// Half-widths of the box it fills \[m\].
    pub half: [f64; 2],
}

impl Solid for Bore {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        self.radius - x.x.hypot(x.y)
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::new(self.half[0], self.half[1], 0.0))
    }
}

/// A cylinder along the axis z that reaches through the whole of a box.
#[derive(Clone, Copy, Debug)]
pub struct Post {
    /// Its radius \[m\].
    pub radius: f64,
    /// Half of the box's height \[m\].
    pub half: f64,
}

impl Solid for Post {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        x.x.hypot(x.y) - self.radius
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::new(self.radius, self.radius, self.half))
    }
    /// Of what is inside the box.
    fn surface(&self, spacing: f64, offset: f64) -> Option<Vec<SurfaceElement>> {
        let (radius, height) = (self.radius + offset, 2.0 * self.half);
        let (around, along) = (4.0 * (0.25 * TAU * radius / spacing).round(), (height / spacing).round());
        let area = TAU * radius * height / (around * along);
        let element = |i: usize| {
            let (sin, cos) = (TAU * (i % around as usize) as f64 / around).sin_cos();
            let z = ((i / around as usize) as f64 + 0.5) / along * height - self.half;
            SurfaceElement {
                point: Point::new(radius * cos, radius * sin, z),
                normal: Vector::new(cos, sin, 0.0),
                area,
            }
        };
        Some((0..(around * along) as usize).map(element).collect())
    }
}

/// All of a doubly periodic box but a channel along its diagonal and the channel's images.
#[derive(Clone, Copy, Debug)]
pub struct Banks {
    /// Edge lengths of the box \[m\].
    pub lengths: [f64; 2],
    /// Width of the channel \[m\].
    pub width: f64,
}

impl Banks {
    /// Unit vectors along the channel and across.
    pub fn axes(&self) -> [[f64; 2]; 2] {
        let [x, y] = self.lengths;
        let l = x.hypot(y);
        [[x / l, y / l], [-y / l, x / l]]
    }
    /// Signed distance from the channel's middle line \[m\].
    pub fn across(&self, x: [f64; 2]) -> f64 {
        let [_, n] = self.axes();
        let period = self.lengths[0] * n[0].abs();
        let d = n[0] * x[0] + n[1] * x[1];
        d - period * (d / period).round()
    }
}

impl Solid for Banks {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        0.5 * self.width - self.across([x.x, x.y]).abs()
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::new(0.5 * self.lengths[0], 0.5 * self.lengths[1], 0.0))
    }
    /// Both lines along the channel from one corner of the box to where they close; some of it lies in the box's images.
    fn surface(&self, spacing: f64, offset: f64) -> Option<Vec<SurfaceElement>> {
        let ([along, across], length) = (self.axes(), self.lengths[0].hypot(self.lengths[1]));
        let n = (length / spacing).round();
        let element = |i: usize, side: f64| {
            let (s, d) = ((i as f64 + 0.5) / n * length - 0.5 * length, side * (0.5 * self.width - offset));
            let at = [0, 1].map(|a| s * along[a] + d * across[a]);
            let normal = Vector::new(-side * across[0], -side * across[1], 0.0);
            SurfaceElement { point: Point::new(at[0], at[1], 0.0), normal, area: length / n }
        };
        Some(
            [-1.0, 1.0].into_iter().flat_map(|side| (0..n as usize).map(move |i| element(i, side))).collect(),
        )
    }
}
