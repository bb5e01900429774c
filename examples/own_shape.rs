//! A shape of one's own: a torus, known by its signed distance alone, drops onto a plane and rolls.
//!
//! ```text
//! d(x) = |(√(x² + y²) − R, z)| − r
//! V = 2π²Rr²,   I_z = m (R² + ¾ r²),   I_x = m (½R² + ⅝ r²)
//! ```
//!
//! [`Implicit`] finds volume and moments of inertia by an adaptive tree of boxes, and the overlap
//! with the plane by the virtual mesh; nothing else has to be written. The picture shows the torus
//! at equal intervals, coloured by time.
//!
//! `cargo run --release --example own_shape [FOLDER]`, 2 s; `out/own_shape/rolling.png`.
use render::solids::{Form, Model, Portrait, Shape, Tint, View};
use siltflow::dem::{HalfSpace, Implicit, Material, RigidBodies, Shape as _};
use siltflow::interfaces::{Aabb, BodyId, Dynamics, Freedom, Kinematics, Periods, Point, Pose};
use siltflow::interfaces::{Rotation, Solid, Twist, Vector};
use std::error::Error;
use std::f64::consts::PI;
use std::sync::Arc;

const MAJOR: f64 = 0.03; // R, m
const MINOR: f64 = 0.01; // r, m
const DENSITY: f64 = 1000.0; // kg/m³
const FRAMES: usize = 9;
const INTERVAL: f64 = 0.12; // s

/// All points within r of a circle of radius R about the axis z.
struct Torus;

impl Solid for Torus {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        (x.x.hypot(x.y) - MAJOR).hypot(x.z) - MINOR
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::new(MAJOR + MINOR, MAJOR + MINOR, MINOR))
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args().nth(1).unwrap_or("out/own_shape".into());
    let torus = Arc::new(Implicit::new("torus", Torus, 1e-4)?);
    let inertia = torus.inertia(DENSITY);
    let mass = DENSITY * 2.0 * PI * PI * MAJOR * MINOR * MINOR;
    let exact = [
        ("mass, kg", inertia.mass, mass),
        ("I_z, kg m²", inertia.tensor[(2, 2)], mass * (MAJOR.powi(2) + 0.75 * MINOR.powi(2))),
        ("I_x, kg m²", inertia.tensor[(0, 0)], mass * (0.5 * MAJOR.powi(2) + 0.625 * MINOR.powi(2))),
    ];
    for (name, found, exact) in exact {
        println!("{name}: {found:.6e}, exact {exact:.6e}, {:+.0e}", found / exact - 1.0);
    }

    let mut bodies = RigidBodies::new(Periods::default());
    bodies.set_gravity(Vector::new(0.0, 0.0, -9.81));
    let rubber = Material { density: DENSITY, damping: 4.0, friction: 0.8, ..Material::default() };
    bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z())?, rubber)?;
    // Upright, its axis along y and a little inclined.
    let orientation = Rotation::from_euler_angles(0.5 * PI - 0.04, 0.0, 0.0);
    let pose = Pose { position: Point::new(0.0, 0.0, 1.3 * (MAJOR + MINOR)), orientation };
    let linear = Vector::new(0.5, 0.0, 0.0);
    let roll = Twist { linear, angular: Vector::new(0.0, linear.x / (MAJOR + MINOR), 0.0) };
    let body = bodies.add(torus.clone(), rubber, pose, roll, Freedom::FREE)?;

    let mut poses = vec![pose];
    while poses.len() < FRAMES {
        bodies.advance(INTERVAL)?;
        poses.push(bodies.pose(body));
    }
    let end = bodies.pose(BodyId(0)).position;
    println!("after {:.2} s at x = {:.3} m, height {:.4} m", INTERVAL * 8.0, end.x, end.z);

    let floor = siltflow::dem::Cuboid::new([1.0, 0.4, 0.01])?;
    let model = |solid, radius, pose, tint| {
        let shape = Shape { form: Form::Solid(solid), bounding_radius: radius };
        Model { shape, pose, tint }
    };
    let moments = poses.iter().enumerate();
    let mut models: Vec<Model> = moments
        .map(|(k, pose)| model(&*torus as &dyn Solid, MAJOR + MINOR, *pose, Tint::Value(INTERVAL * k as f64)))
        .collect();
    models.push(model(&floor, 1.0, Pose::at([0.25, 0.0, -0.005]), Tint::Grey(0.85)));
    let view = View {
        middle: Point::new(0.25, 0.0, 0.03),
        along: Vector::new(0.2, 1.0, -0.5),
        up: Vector::z(),
        width: 0.75,
        height: 0.3,
    };
    let range = (0.0, INTERVAL * (FRAMES - 1) as f64);
    let portrait = Portrait { view, models: &models, range, label: Some("time, s"), title: "A torus rolls" };
    std::fs::create_dir_all(&out)?;
    Ok(portrait.draw(format!("{out}/rolling.png").as_ref())?)
}
