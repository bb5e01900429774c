//! Free rotation.
use super::*;
use dem::Cuboid;
use interfaces::{Dynamics, Rotation};

/// A box with the moments (1, 2, 3) in the axes (x, y, z): a² = 6(I_y + I_z − I_x)/m.
fn top(turned: Rotation) -> RigidBodies {
    let edges = [24.0_f64, 12.0, 0.0].map(|x| x.max(1e-12).sqrt());
    // The third is no longer than it must be to have a volume.
    let shape = Cuboid::new(edges).unwrap();
    let density = 1.0 / (edges[0] * edges[1] * edges[2]);
    let mut bodies = RigidBodies::new(Periods::default());
    let spin = turned * Vector::new(0.1, 1.0, 0.1);
    let pose = Pose { orientation: turned, ..Pose::at([0.0; 3]) };
    let twist = Twist { angular: spin, ..Twist::default() };
    bodies.add(shape, Material { density, ..Material::default() }, pose, twist, Freedom::FREE).unwrap();
    bodies
}

/// The reference page's top: period of the tumbling 22.99626294, energy and angular momentum kept over ten flips.
#[test]
fn a_torque_free_top_tumbles() {
    const PERIOD: f64 = 22.996_262_94;
    let turned = Rotation::from_euler_angles(0.3, -1.1, 2.0);
    let in_body =
        |b: &RigidBodies| b.pose(BodyId(0)).orientation.inverse_transform_vector(&b.twist(BodyId(0)).angular);
    let off_after_a_period = |steps: u32| {
        let mut bodies = top(turned);
        let start = in_body(&bodies);
        for _ in 0..steps {
            bodies.advance(PERIOD / f64::from(steps)).unwrap();
        }
        (in_body(&bodies) - start).norm()
    };
    let errors = [1000, 2000, 4000].map(off_after_a_period);
    println!("after a period, off by {errors:?}");
    assert!(errors[0] / errors[2] > 14.0 && errors[0] / errors[2] < 18.0, "second order");
    // Richardson: what is left without the leading error.
    assert!(((4.0 * errors[2] - errors[1]) / 3.0).abs() < 1e-6);

    let mut bodies = top(turned);
    let (energy, (_, momentum)) = (bodies.kinetic_energy(), momenta(&bodies));
    let steps = 20_000;
    let mut drift = 0.0_f64;
    for _ in 0..10 * steps {
        bodies.advance(PERIOD / f64::from(steps)).unwrap();
        drift = drift.max((bodies.kinetic_energy() / energy - 1.0).abs());
    }
    let (_, after) = momenta(&bodies);
    println!("ten flips: |dE|/E {drift:.2e}, |dL|/L {:.2e}", (after - momentum).norm() / momentum.norm());
    assert!(drift < 1e-6);
    // Round-off of every step.
    assert!(
        (after - momentum).norm() < 1e-15 * f64::from(10 * steps) * momentum.norm(),
        "direction and size"
    );
}
