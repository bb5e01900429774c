//! The books of a flow without bodies.
use siltflow::coupling::{self, Ledger, Schedule, Simulation, WeightBalance};
use siltflow::flow::{CartesianGrid, Fluid, Profile, Projection, Side};
use siltflow::interfaces::Vector;
use std::sync::atomic::AtomicBool;

/// Developed flow between plates with a force that changes in time: the pressure takes it up, so that it only shifts work from the ends to the force.
#[test]
fn books_of_a_flow_alone_close() {
    let fluid = Fluid { density: 900.0, viscosity: 0.02 };
    for outlet in [Side::ConvectiveOutlet, Side::PressureOutlet(7.0)] {
        let grid = CartesianGrid::new([24, 16], [3.0, 1.0]).unwrap();
        let inlet = Side::Inlet(Profile::Parabolic { peak: 1.5 });
        let mut flow = Projection::new(grid, [[inlet, outlet.clone()], Side::WALL.both()], fluid).unwrap();
        flow.set_velocity(|x| [6.0 * x[1] * (1.0 - x[1]), 0.0]);
        let mut simulation = Simulation::new(flow, (), WeightBalance::None)
            .unwrap()
            .with_force(|t| 2.0 * (1.0 - t.cos()) * Vector::x());
        let mut ledger = Ledger::new();
        let schedule =
            Schedule { end: 0.4, dt: Some(0.01), intervals: 1, ramp: [1.0, 1.15], ..Schedule::default() };
        coupling::run(&mut simulation, &schedule, &mut ledger, &AtomicBool::new(false)).unwrap();
        let books = ledger.report();
        assert!(books.work > 0.2 * books.dissipation && books.side_work > books.work, "{books:?}");
        assert!(books.energy_residual.abs() < 1e-10 * books.dissipation, "{outlet:?}: {books:?}");
        assert!(books.momentum_total < 1e-10, "{outlet:?}: {books:?}");
    }
}
