//! A contact law of one's own: the linear spring and dashpot of Cundall & Strack (1979), and balls
//! that bounce by it.
//!
//! ```text
//! F_n = max(0, k δ + c dδ/dt),   c = 2ζ √(k m)
//! e = exp(−2ζ arccos ζ/√(1 − ζ²))
//! ```
//!
//! The depth δ follows from the overlap volume V and its area A = ∂V/∂δ: δ = 2V/A,
//! dδ/dt = (dV/dt)/A, exact for a ball as δ/R → 0. The restitution e is that of a contact without
//! tension (Schwager & Pöschel 2007, Granul. Matter 9, 465); the measured one is the speed after over
//! the speed before the first rebound.
//!
//! `cargo run --release --example own_contact_law [FOLDER]`, 1 s;
//! `out/own_contact_law/height.png`.
use render::sketch::{Drawing, draw};
use siltflow::dem::{ContactLaw, DemError, HalfSpace, Material, PairProperties, Push};
use siltflow::dem::{RigidBodies, Sphere, Touch};
use siltflow::interfaces::{BodyId, Dynamics, Freedom, Kinematics, Periods, Point, Pose, Twist, Vector};
use std::error::Error;

/// Spring and dashpot along the normal; no friction.
#[derive(Clone, Copy, Debug)]
struct SpringDashpot {
    /// k \[N/m\].
    stiffness: f64,
    /// ζ, 0 to 1.
    damping_ratio: f64,
}

impl ContactLaw for SpringDashpot {
    /// Nothing is kept from one sub-step to the next.
    type Memory = ();

    fn push(&self, _: &PairProperties, touch: &Touch<'_>, (): &mut ()) -> Push {
        let (k, zeta) = (self.stiffness, self.damping_ratio);
        let inverse_mass: f64 = touch.inverse_masses.iter().sum();
        let depth = 2.0 * touch.overlap.volume / touch.area;
        let speed = touch.rate / touch.area;
        let force = (k * depth + 2.0 * zeta * (k / inverse_mass).sqrt() * speed).max(0.0);
        // The sub-step follows from the stiffness, dashpot included.
        let stiffness = k * (1.0 + 2.0 * zeta).powi(2);
        Push { force: touch.overlap.normal * force, couple: Vector::zeros(), stiffness }
    }

    fn check(&self) -> Result<(), DemError> {
        let value = self.damping_ratio;
        let valid = self.stiffness > 0.0 && (0.0..1.0).contains(&value);
        let property = "damping ratio, or stiffness";
        let remedy = "give a ratio from 0 to 1 and a positive stiffness";
        if valid { Ok(()) } else { Err(DemError::Material { property, value, remedy }) }
    }
}

const RADIUS: f64 = 0.01; // m
const DROP: f64 = 0.1; // m, from the ball's lowest point
const INTERVAL: f64 = 1e-4; // s

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args().nth(1).unwrap_or("out/own_contact_law".into());
    println!("damping ratio  restitution  by the formula");
    let mut curves = Vec::new();
    for zeta in [0.0, 0.05, 0.2_f64] {
        let law = SpringDashpot { stiffness: 1e5, damping_ratio: zeta };
        let mut bodies = RigidBodies::with_law(Periods::default(), law);
        bodies.set_gravity(Vector::new(0.0, 0.0, -9.81));
        let glass = Material { density: 2500.0, ..Material::default() };
        let pose = Pose::at([0.0, 0.0, RADIUS + DROP]);
        bodies.add(Sphere::new(RADIUS)?, glass, pose, Twist::default(), Freedom::FREE)?;
        bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z())?, glass)?;

        let (mut heights, mut speeds) = (Vec::new(), [0.0_f64; 2]);
        for step in 0..10_000 {
            bodies.advance(INTERVAL)?;
            let height = bodies.pose(BodyId(0)).position.z - RADIUS;
            let speed = bodies.twist(BodyId(0)).linear.z;
            // Fastest fall, and fastest rise from the first rebound.
            speeds = [speeds[0].max(-speed), speeds[1].max(speed)];
            if step % 20 == 0 {
                heights.push([INTERVAL * f64::from(step + 1), 1e3 * height]);
            }
        }
        let measured = speeds[1] / speeds[0];
        let formula = (-2.0 * zeta * zeta.acos() / (1.0 - zeta * zeta).sqrt()).exp();
        println!("{zeta:13}  {measured:11.4}  {formula:14.4}");
        curves.push((format!("ζ = {zeta}, e = {measured:.3}"), heights));
    }
    let curves: Vec<_> = curves.iter().map(|(name, curve)| (name.as_str(), curve.clone())).collect();
    let labels = ["time in s", "height in mm"];
    let picture = Drawing::curves("A ball bounces", labels, &curves);
    std::fs::create_dir_all(&out)?;
    Ok(draw(format!("{out}/height.png").as_ref(), 1, &[picture])?)
}
