//! The wake of a cylinder, pushed to one side by a force until it is no longer symmetric.
use fv_mesh::{CartesianGrid, FlowError, Fluid, ForceField, Hooks, Profile, Projection, Side};
use fv_mesh::{Sampler, Velocity, VelocityField};

/// Centre and radius \[m\].
const CENTRE: [f64; 2] = [2.0, 2.0];
const RADIUS: f64 = 0.5;

/// Holds the fluid in the cylinder.
fn cylinder(velocity: &mut Velocity<2>, _time: f64, _dt: f64) -> Result<(), FlowError> {
    for c in 0..2 {
        let lattice = velocity.lattice(c).clone();
        let [columns, rows] = [0, 1].map(|a| lattice.range(a, CENTRE[a] - RADIUS, CENTRE[a] + RADIUS));
        for node in rows.flat_map(|j| columns.clone().map(move |i| [i, j, 0])) {
            let x = lattice.position(node);
            let inside = (x[0] - CENTRE[0]).hypot(x[1] - CENTRE[1]) < RADIUS;
            if let (true, Some(at)) = (inside, lattice.index(node)) {
                velocity.component_mut(c)[at] = 0.0;
            }
        }
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let inlet = Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0]));
    let sides = [[inlet, Side::ConvectiveOutlet], Side::FreeSlip.both()];
    let fluid = Fluid { density: 1.0, viscosity: 0.01 };
    let mut flow = Projection::new(CartesianGrid::new([80, 40], [8.0, 4.0])?, sides, fluid)?;
    flow.set_velocity(|_| [1.0, 0.0]);

    let source = |x: [f64; 2], time: f64| {
        let near = (x[0] - 3.0).hypot(x[1] - 2.0) < 0.5;
        [0.0, if near && time < 1.0 { 1.0 } else { 0.0 }]
    };
    let mut hooks = Hooks::none().with_body_force(ForceField(source)).with_forcing(cylinder);
    while flow.time() < 2.0 {
        flow.advance_with(flow.stable_dt(0.4), &mut hooks)?;
    }
    let sampler = Sampler::new(flow.grid(), flow.sides());
    let wake = sampler.velocity(flow.velocity(), [3.0, 2.0])?;
    println!("fv-mesh: velocity in the wake {:.3} and {:.3} m/s", wake[0], wake[1]);
    assert!(wake[0] < 0.5 && wake[1].abs() > 1e-3);
    Ok(())
}
