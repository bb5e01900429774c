//! Automatic steps that exceed the Courant number are taken back and repeated.
use crate::moving_walls::drifting;
use crate::population::rain;
use crate::state::{assert_same, saved};
use crate::with_threads;
use siltflow::coupling::{
    self, CouplingError, Evolving, Explicit, FlowSolver, Observer, Particles, RunSummary, Schedule,
    Simulation, StepInfo, WeightBalance, WithScalars,
};
use siltflow::dem::{Disc, Material, Polygon, RigidBodies};
use siltflow::flow::{
    CartesianGrid, Fluid, Hooked, Hooks, Piso, Profile, Projection, Scalar, ScalarSide, Side,
};
use siltflow::ibm::{Forcing, Hfdib, SmoothForcing};
use siltflow::interfaces::{Freedom, Periods, Pose, Twist, Vector};
use std::sync::atomic::AtomicBool;
use validation::prescribed_bodies::PrescribedBodies;
use validation::walled_flows::put_walls;

const COURANT: f64 = 0.4;

/// Lengths and Courant numbers of the steps that observers are shown.
#[derive(Default)]
struct Record(Vec<[f64; 2]>);

impl<S: Evolving> Observer<S> for Record {
    fn step(&mut self, simulation: &mut S, info: &StepInfo) -> Result<(), CouplingError> {
        assert_eq!(info.step, self.0.len() as u64 + 1, "a step was shown twice");
        assert_eq!(simulation.courant(info.dt), info.courant);
        self.0.push([info.dt, info.courant]);
        Ok(())
    }
}

/// Runs to `end` in two intervals: no step exceeds the Courant number, at least one was repeated, none of it is felt later: the state is, to the bit, that of the steps that
/// were kept alone, and that of a run that was stopped half way.
fn check<S: Evolving>(end: f64, build: impl Fn() -> S + Sync) -> RunSummary {
    with_threads(1, || {
        let stop = AtomicBool::new(false);
        let ramp = [1.0, 2.0];
        let schedule = Schedule { end, intervals: 2, courant: COURANT, ramp, ..Schedule::default() };
        let (mut whole, mut record) = (build(), Record::default());
        let summary = coupling::run(&mut whole, &schedule, &mut record, &stop).unwrap();
        assert!(summary.repeats > 0, "{summary:?}");
        let most = record.0.iter().map(|step| step[1]).fold(0.0, f64::max);
        assert!(most <= COURANT * (1.0 + 1e-6) && most == summary.courant, "{summary:?}");

        let mut kept = build();
        for [dt, _] in &record.0 {
            kept.begin().unwrap();
            kept.step(*dt).unwrap();
            if (kept.time() - 0.5 * end).abs() < 1e-6 * end {
                kept.set_time(0.5 * end);
            }
        }
        kept.set_time(end);
        assert_same(&saved(&kept), &saved(&whole));

        let mut half = build();
        coupling::run(&mut half, &Schedule { end: 0.5 * end, intervals: 1, ..schedule }, &mut (), &stop)
            .unwrap();
        let state = saved(&half);
        let mut second = build();
        second.restore(&|name| state.get(name).map(Vec::as_slice)).unwrap();
        coupling::run(&mut second, &schedule, &mut (), &stop).unwrap();
        assert_same(&saved(&second), &saved(&whole));
        summary
    })
}

const WATER: Fluid = Fluid { density: 1.0, viscosity: 1e-3 };

/// 32 × 16 cells with an inlet on the left.
fn tunnel() -> (CartesianGrid<2>, [[Side; 2]; 2]) {
    let sides = [[Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0])), Side::ConvectiveOutlet], Side::WALL.both()];
    (CartesianGrid::new([32, 16], [2.0, 1.0]).unwrap(), sides)
}

/// A body that is held in a stream which is there at once.
fn held<A: FlowSolver<2>, F: Forcing>(flow: A, forcing: F) -> Simulation<2, Particles<F, RigidBodies>, A> {
    let mut bodies = RigidBodies::new(Periods::default());
    let pose = Pose::at([0.7, 0.5, 0.0]);
    bodies.add(Disc::new(0.2).unwrap(), Material::default(), pose, Twist::default(), Freedom::NONE).unwrap();
    let particles = Particles::new(bodies, forcing, WATER.density, Vector::zeros());
    Simulation::new(flow, particles, WeightBalance::None).unwrap()
}

fn stream() -> Projection<2> {
    let (grid, sides) = tunnel();
    let mut flow = Projection::new(grid, sides, WATER).unwrap();
    flow.set_velocity(|_| [1.0, 0.0]);
    flow
}

fn dye() -> Scalar<2> {
    let (grid, _) = tunnel();
    let sides = [[ScalarSide::value(1.0), ScalarSide::NO_GRADIENT], ScalarSide::NO_GRADIENT.both()];
    Scalar::new(&grid, sides, 1e-3).unwrap()
}

/// A plate, turned by 45° in a stream, as cut links.
#[test]
fn a_stream_that_starts_at_a_wall() {
    let summary = check(0.2, || {
        let mut flow = stream();
        let plate = Polygon::rectangle([0.4, 0.08]).unwrap();
        let bodies = PrescribedBodies::default().with(plate, [0.7, 0.5, 0.0], -45.0_f64.to_radians());
        put_walls(&mut flow, &bodies).unwrap();
        Simulation::new(flow, (), WeightBalance::None).unwrap()
    });
    // Potential flow is there after the first step, whatever its length; later ones foresee their velocity.
    assert!(summary.repeats <= 3, "{summary:?}");
}

#[test]
fn a_stream_with_dye_that_starts_at_a_smoothly_forced_body() {
    check(0.2, || held(Hooked::new(stream(), Hooks::none().with_scalars(dye())), SmoothForcing::new(1.0)));
}

#[test]
fn a_stream_with_dye_that_starts_by_piso() {
    check(0.2, || {
        let (grid, sides) = tunnel();
        let mut flow = Piso::new(grid, sides, WATER).unwrap();
        flow.set_velocity(|_| [1.0, 0.0]);
        let Simulation { flow, particles, .. } =
            held(WithScalars { flow, scalars: dye(), drive: () }, Hfdib::new(1.0));
        Simulation::new(flow, particles.with_strategy(Explicit), WeightBalance::None).unwrap()
    });
}

/// A free disc in a turbulent flow that is pushed while it runs, with cells that come out of the body.
#[test]
fn a_push_in_a_turbulent_flow() {
    check(0.6, || drifting().with_force(|t| Vector::x() * if (0.2..0.25).contains(&t) { 60.0 } else { 0.0 }));
}

/// The same where discs come, lie on the floor and go.
#[test]
fn a_push_where_bodies_come_and_go() {
    check(0.12, || rain().with_force(|t| Vector::x() * if (0.05..0.055).contains(&t) { 60.0 } else { 0.0 }));
}

/// A given step is kept, whatever its Courant number.
#[test]
fn a_given_step_is_kept() {
    with_threads(1, || {
        let stop = AtomicBool::new(false);
        let mut simulation = held(stream(), SmoothForcing::new(1.0));
        let schedule = Schedule { end: 0.1, intervals: 1, dt: Some(0.02), courant: 0.1, ramp: [1.0, 2.0] };
        let summary = coupling::run(&mut simulation, &schedule, &mut (), &stop).unwrap();
        assert!(summary.courant > 0.4 && summary.steps == 5 && summary.repeats == 0, "{summary:?}");
        let mut simulation = held(stream(), SmoothForcing::new(1.0));
        let long = Schedule { dt: Some(0.1), ..schedule };
        let error = coupling::run(&mut simulation, &long, &mut (), &stop).unwrap_err();
        assert!(matches!(error, CouplingError::Courant { .. }), "{error}");
    });
}

/// A force for which no reasonable step is short enough ends the run.
#[test]
fn a_velocity_that_no_step_bounds_ends_the_run() {
    with_threads(1, || {
        let mut simulation = drifting().with_force(|_| Vector::x() * 1e16);
        let schedule = Schedule { end: 0.1, intervals: 1, courant: COURANT, ramp: [1.0, 2.0], dt: None };
        let error = coupling::run(&mut simulation, &schedule, &mut (), &AtomicBool::new(false)).unwrap_err();
        assert!(matches!(error, CouplingError::Collapsed { .. }), "{error}");
    });
}
