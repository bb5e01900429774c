//! Bodies in a flow with a turbulence model, a scalar and buoyancy.
use crate::state::{assert_same, saved};
use siltflow::coupling::{FlowSolver, Particles, Simulation, WeightBalance};
use siltflow::dem::{Material, RigidBodies, Sphere};
use siltflow::flow::{
    Boussinesq, CartesianGrid, Fluid, Hooked, Hooks, Modelled, Projection, Scalar, ScalarSide, Side,
    TransportParams,
};
use siltflow::ibm::{SmoothForcing, ViscousStep};
use siltflow::interfaces::{BodyId, Checkpoint, Closure, Freedom, Kinematics, Periods, Pose, Twist, Vector};
use std::sync::Arc;
use turb::{Inflow, KOmegaSst, Smagorinsky, SmagorinskyConstants, Sst};

type Warm<C> = Hooked<3, Boussinesq, Modelled<3, C>, Scalar<3>>;
const AIR: Fluid = Fluid { density: 1.2, viscosity: 1.5e-5 };

/// A shaken ball in a warm box.
fn build<C: Closure + Checkpoint>(
    closure: impl Fn(usize) -> C,
) -> Simulation<3, Particles<SmoothForcing, RigidBodies>, Warm<C>> {
    let grid = CartesianGrid::new([16, 16, 16], [0.1; 3]).unwrap();
    let mut flow = Projection::new(grid.clone(), Side::WALL.everywhere(), AIR).unwrap();
    flow.set_velocity(|x| [0.3 * (60.0 * x[1]).sin(), 0.0, 0.2 * (50.0 * x[0]).cos()]);
    let model =
        Modelled::new(closure(grid.n_cells()), &grid, flow.sides(), TransportParams::default()).unwrap();
    let sides = [
        [ScalarSide::value(1.0), ScalarSide::value(0.0)],
        ScalarSide::NO_GRADIENT.both(),
        ScalarSide::NO_GRADIENT.both(),
    ];
    let warmth = Scalar::new(&grid, sides, 2e-5).unwrap();
    let lift = Boussinesq { expansion: 3.4e-3, reference: 0.5, gravity: Vector::new(0.0, -9.81, 0.0) };
    let hooks = Hooks::none().with_body_force(lift).with_closure(model).with_scalars(warmth);
    let mut bodies = RigidBodies::new(Periods::default());
    let ball = Arc::new(Sphere::new(0.02).unwrap());
    let material = Material { density: 2.0, ..Material::default() };
    bodies.add(ball, material, Pose::at([0.05; 3]), Twist::default(), Freedom::FREE).unwrap();
    let particles = Particles::new(bodies, SmoothForcing::new(AIR.density), AIR.density, Vector::zeros());
    Simulation::new(Hooked::new(flow, hooks), particles, WeightBalance::None).unwrap()
}

/// Seven steps, each as long as is stable.
fn seven_are_three_and_four<C: Closure + Checkpoint>(closure: impl Fn(usize) -> C) {
    let mut whole = build(&closure);
    let step = |fall: &mut Simulation<3, _, Warm<C>>| fall.step(fall.flow.stable_dt(0.3)).unwrap();
    (0..3).for_each(|_| step(&mut whole));
    let state = saved(&whole);
    let mut after = Vec::new();
    (0..4).for_each(|_| {
        step(&mut whole);
        after.push(saved(&whole));
    });
    let mut second = build(&closure);
    second.restore(&|name| state.get(name).map(Vec::as_slice)).unwrap();
    assert_same(&saved(&second), &state);
    for after in after {
        step(&mut second);
        assert_same(&saved(&second), &after);
    }
    let eddy = whole.flow.hooks.closure.closure.eddy_viscosity().unwrap();
    assert!(eddy.iter().copied().fold(0.0, f64::max) > 0.05 * AIR.viscosity);
    // The ball is carried along and the warm wall warms.
    assert!(whole.particles.bodies.twist(BodyId(0)).linear.norm() > 1e-4);
    assert!(whole.flow.hooks.scalars.integral() > 0.0);
}

#[test]
fn a_run_with_a_closure_a_scalar_and_a_ball_goes_on_as_if_it_had_not_stopped() {
    seven_are_three_and_four(|n| Smagorinsky::new(SmagorinskyConstants::default(), n).unwrap());
    let inflow = Inflow::from_length(0.3, 0.05, 0.01).unwrap();
    seven_are_three_and_four(|n| KOmegaSst::new(Sst::default(), n, inflow).unwrap());
}

/// The parts of a step are those of `advance_with`.
#[test]
fn parts_make_a_whole_step() {
    let closure = |n| Smagorinsky::new(SmagorinskyConstants::default(), n).unwrap();
    let (mut parts, whole) = (build(closure).flow, build(closure).flow);
    let Hooked { mut flow, mut hooks, .. } = whole;
    for _ in 0..3 {
        let dt = parts.stable_dt(0.3);
        parts.predict(dt, [0.0; 3]).unwrap();
        parts.project(dt).unwrap();
        parts.finish(dt).unwrap();
        flow.advance_with(dt, &mut hooks).unwrap();
    }
    assert_same(&saved(&parts), &saved(&Hooked::new(flow, hooks)));
}

/// Forces on a body's surface are told to follow from ν only where they do: not beside a model, which has a ν_t of its own.
#[test]
fn the_viscosity_is_told_where_there_is_no_model() {
    let flow = || {
        let grid = CartesianGrid::new([8; 3], [0.1; 3]).unwrap();
        Projection::new(grid, Side::WALL.everywhere(), AIR).unwrap()
    };
    let model = || {
        let (of, closure) = (flow(), Smagorinsky::new(SmagorinskyConstants::default(), 512).unwrap());
        Modelled::new(closure, of.grid(), of.sides(), TransportParams::default()).unwrap()
    };
    let told = |step: Option<ViscousStep>| step.is_some_and(|s| (s.diffused - 1.5e-9).abs() < 1e-18);
    assert!(told(flow().viscous_step(1e-4)));
    assert!(told(Hooked::new(flow(), Hooks::none()).viscous_step(1e-4)));
    let with = |model| Hooked::new(flow(), Hooks::none().with_closure(model)).viscous_step(1e-4);
    assert!(told(with(None)));
    assert_eq!(with(Some(model())), None);
}
