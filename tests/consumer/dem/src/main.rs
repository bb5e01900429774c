//! A disc falls on a floor and bounces, without any fluid.
use dem::{Bodies, Dynamics, Freedom, Kinematics, Load, Periods, Point, Pose, Twist, Vector, Wrench};
use dem::{DemError, Disc, HalfSpace, Material, RigidBodies};

fn main() -> Result<(), DemError> {
    let mut bodies = RigidBodies::new(Periods::default());
    bodies.add_wall(HalfSpace::new(Point::origin(), Vector::y())?, Material::default())?;
    let (disc, start) = (Disc::new(0.01)?, Pose::at([0.0, 0.03, 0.0]));
    let ball = bodies.add(disc, Material::default(), start, Twist::default(), Freedom::PLANAR)?;
    let weight = Vector::y() * -9.81 * bodies.inertia(ball).mass;
    let wrench = Wrench { force: weight, torque: Vector::zeros() };
    bodies.apply(ball, Load { wrench, ..Load::default() });
    for _ in 0..80 {
        bodies.advance(1e-3)?;
    }
    assert!(bodies.contact_time() > 0.0 && bodies.twist(ball).linear.y > 0.0);
    println!("dem: on its way up at {:.3} m/s", bodies.twist(ball).linear.y);
    Ok(())
}
