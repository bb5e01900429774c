use super::*;
use crate::testing::{Balls, Staggered};
use interfaces::Pose;
use std::f64::consts::PI;

const VISCOSITY: f64 = 0.7;

fn values(lattice: &Lattice, f: impl Fn([f64; 3]) -> f64) -> Vec<f64> {
    let n: usize = lattice.shape().iter().product();
    (0..n).map(|i| f(lattice.position(lattice.node(i)))).collect()
}

/// The loads on the first body at elements a cell apart, in a box around the origin of edge 2 and so many cells, a little moved.
fn loads<const D: usize>(
    cells: usize,
    bodies: &Balls,
    u: impl Fn([f64; 3]) -> [f64; 3],
    p: impl Fn([f64; 3]) -> f64,
) -> SurfaceLoads {
    let h = 2.0 / cells as f64;
    let shift = [0.13, 0.41, 0.27];
    let mut velocity = Staggered::new([cells; D], h, std::array::from_fn(|a| shift[a] * h - 1.0));
    velocity.set(u);
    let lattice = velocity.cells();
    let pressure = values(&lattice, p);
    SurfaceStress::new(&velocity, &lattice, &pressure, VISCOSITY).on(bodies, BodyId(0), h).unwrap()
}

/// The flow around a disc that turns: the torque is −4πμB, u_θ = A r + B/r. A pressure of constant gradient pushes with it
/// times the volume.
#[test]
fn the_torque_of_a_disc() {
    let b = 1.0 / 3.0;
    let mut bodies = Balls::new(2, 0.5, vec![[0.0; 3]]);
    // A part of it by the surface alone.
    bodies.twists[0].angular.z = 0.6;
    bodies.motion = Some(Box::new(|arm| Vector::new(-0.4 * arm.y, 0.4 * arm.x, 0.0)));
    let errors = [20, 40, 80].map(|cells| {
        let turn = |x: [f64; 3]| b / (x[0] * x[0] + x[1] * x[1]) - 1.0 / 3.0;
        let u = |x: [f64; 3]| [-turn(x) * x[1], turn(x) * x[0], 0.0];
        let loads = loads::<2>(cells, &bodies, u, |x| 3.0 + x[0]);
        let push = loads.pressure().force;
        assert!((push.x + 0.25 * PI).abs() < 1e-3 && push.y.abs() < 1e-3, "{push}");
        assert!(loads.lowered() * 10 < loads.points.len(), "{}", loads.lowered());
        let stress = 8.0 * VISCOSITY * b;
        for point in &loads.points {
            assert!((point.friction.norm() / stress - 1.0).abs() < if cells == 20 { 0.1 } else { 0.015 });
        }
        (loads.total().torque.z / (-4.0 * PI * VISCOSITY * b) - 1.0).abs()
    });
    // Third order.
    assert!(errors[1] < 0.011 && errors[1] < 0.18 * errors[0] && errors[2] < 0.18 * errors[1], "{errors:?}");
}

/// Creeping flow past a sphere (Stokes 1851): 6πμRU, a third of it by pressure.
#[test]
fn the_drag_of_a_sphere() {
    let r0 = 0.5_f64;
    let bodies = Balls::new(3, r0, vec![[0.0; 3]]);
    let errors = [16, 32].map(|cells| {
        let u = |x: [f64; 3]| {
            let x = Vector::from(x);
            let r = x.norm();
            let [near, far] = [0.75 * r0 / r, 0.25 * (r0 / r).powi(3)];
            (Vector::x() * (1.0 - near - far) - x * (x.x / (r * r) * (near - 3.0 * far))).into()
        };
        let loads =
            loads::<3>(cells, &bodies, u, |x| -1.5 * VISCOSITY * r0 * x[0] / Vector::from(x).norm().powi(3));
        assert!(loads.lowered() * 20 < loads.points.len(), "{}", loads.lowered());
        let drag = 6.0 * PI * VISCOSITY * r0;
        [3.0 * loads.pressure().force.x / drag - 1.0, 1.5 * loads.friction().force.x / drag - 1.0]
    });
    // Third order.
    assert!(errors[1][0].abs() < 0.035 && errors[1][1].abs() < 0.002, "{errors:?}");
    assert!((0..2).all(|i| errors[1][i].abs() < 0.18 * errors[0][i].abs()), "{errors:?}");
}

/// What another body covers is left out; where there is little room the degree is lower, and what is found still right: in a
/// fluid at rest under its own weight, over periodic sides.
#[test]
fn bodies_beside_and_over_one_another() {
    let rest = |x: f64, y: f64, gap: f64| {
        // The third repeats beyond the sides of the box.
        let poses = [[x, y, 0.0], [x + 0.6 + gap, y, 0.0], [x - 0.5, y - 0.1 - 2.0, 0.0]];
        let bodies =
            Balls::of(crate::testing::Ball { dim: 2, radius: 0.3 }, 1.0, poses.map(Pose::at).to_vec());
        loads::<2>(40, &bodies, |_| [0.0; 3], |x| 5.0 - 2.0 * x[1])
    };
    let whole = 0.6 * PI;
    let area = |loads: &SurfaceLoads| loads.points.iter().map(|p| p.area).sum::<f64>();
    let apart = rest(0.1, 0.1, 0.02);
    assert!(apart.lowered() > 0);
    for point in &apart.points {
        let exact = 5.0 - 2.0 * (0.1 + point.arm.y);
        assert!((point.pressure - exact).abs() < 1e-9 || point.degrees[0] == 0, "{point:?}");
        assert!(point.friction.norm() < 1e-12, "{point:?}");
    }
    // The third one covers an arc of half angle acos(½·√0.26/0.3).
    let covered = 2.0 * 0.3 * (0.5 * 0.26_f64.sqrt() / 0.3).acos();
    assert!((area(&apart) - (whole - covered)).abs() < 0.06, "{} {whole} {covered}", area(&apart));
    assert!(area(&rest(0.1, 0.1, -0.1)) < area(&apart) - 0.2);
}

/// Parts beyond a bounded side are left out.
#[test]
fn a_body_in_a_wall() {
    let axes = [true, false].map(|periodic| interfaces::Nodes::uniform(0.025, 0.05, 40, periodic));
    let lattice = Lattice::new(axes, 0, [1, 40]);
    let velocity = crate::testing::Collocated::new(lattice.clone(), |_| [0.0; 3]);
    let pressure = values(&lattice, |_| 2.0);
    let bodies = Balls::new(2, 0.3, vec![[1.0, 0.0, 0.0]]);
    let loads = SurfaceStress::new(&velocity, &lattice, &pressure, 1.0).on(&bodies, BodyId(0), 0.05).unwrap();
    let area: f64 = loads.points.iter().map(|p| p.area).sum();
    assert!((area / (0.3 * PI) - 1.0).abs() < 0.06, "{area}");
    assert!((loads.total().force - Vector::new(0.0, -2.0 * 0.6, 0.0)).norm() < 0.06, "{:?}", loads.total());
}

/// In a box hardly larger than the body its own repetitions are in the way: nothing is taken from inside them.
#[test]
fn a_body_beside_itself() {
    let bodies = Balls::new(2, 0.85, vec![[0.0; 3]]);
    let inside = |x: [f64; 3]| {
        let near = [0, 1].map(|a| x[a] - 2.0 * (x[a] / 2.0).round());
        near[0].hypot(near[1]) < 0.85
    };
    let loads = loads::<2>(40, &bodies, |_| [0.0; 3], |x| if inside(x) { 1e3 } else { 7.0 });
    for point in &loads.points {
        assert!((point.pressure - 7.0).abs() < 1e-6, "{point:?}");
    }
}

#[test]
fn input_that_does_not_fit_is_named() {
    let velocity = Staggered::new([10, 10], 0.2, [-1.0; 2]);
    let (lattice, bodies) = (velocity.cells(), Balls::new(2, 0.5, vec![[0.0; 3]]));
    let on = |pressure: &[f64], spacing| {
        SurfaceStress::new(&velocity, &lattice, pressure, 1.0).on(&bodies, BodyId(0), spacing).unwrap_err()
    };
    assert_eq!(on(&[0.0; 99], 0.2), IbmError::Storage { needed: 100, found: 99 });
    for spacing in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(on(&[0.0; 100], spacing), IbmError::NoSurface { .. }), "{spacing}");
    }
}
