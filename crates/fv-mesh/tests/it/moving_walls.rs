//! Walls whose velocity along themselves depends on place and time.
use crate::norms;
use fv_mesh::{CartesianGrid, Diffusion, Fluid, Patch, Projection, Side};
use interfaces::Checkpoint;
use std::collections::HashMap;

const NU: f64 = 0.02;
const OMEGA: f64 = 2.0;

/// Stokes' second problem: u = U exp(−y√(ω/2ν)) cos(ωt − y√(ω/2ν)), U = 1 m/s.
fn stokes(y: f64, t: f64) -> f64 {
    let depth = y * (OMEGA / (2.0 * NU)).sqrt();
    (-depth).exp() * (OMEGA * t - depth).cos()
}

/// The layer above an oscillating wall, ten penetration depths high, in so many cells.
fn layer(cells: usize, diffusion: Diffusion) -> Projection<2> {
    let height = 10.0 * (2.0 * NU / OMEGA).sqrt();
    let grid = CartesianGrid::new([4, cells], [0.5, height]).unwrap();
    let lid = Side::moving_wall(move |_, t| [stokes(height, t), 0.0, 0.0]);
    // The component normal to the wall has no effect.
    let floor = Side::moving_wall(|_, t| [stokes(0.0, t), 3.0, 0.0]);
    let fluid = Fluid { density: 1.3, viscosity: NU };
    let mut flow = Projection::new(grid, [Side::Periodic.both(), [floor, lid]], fluid)
        .unwrap()
        .with_diffusion(diffusion);
    flow.set_velocity(|x| [stokes(x[1], 0.0), 0.0]);
    flow
}

/// Largest error over two periods, sampled eight times in each.
fn error(cells: usize, diffusion: Diffusion) -> f64 {
    let mut flow = layer(cells, diffusion);
    let (period, mut worst) = (std::f64::consts::TAU / OMEGA, 0.0_f64);
    let steps = cells * cells / 4;
    for step in 1..=2 * steps {
        flow.advance(period / steps as f64, [0.0; 2]).unwrap();
        if step % (steps / 8) == 0 {
            let t = flow.time();
            worst = worst.max(norms::velocity(&flow, |x| [stokes(x[1], t), 0.0]).linf);
        }
    }
    worst
}

#[test]
fn stokes_second_problem_is_met_to_second_order() {
    for diffusion in [Diffusion::Explicit, Diffusion::Implicit] {
        let errors = [64, 128].map(|cells| error(cells, diffusion));
        println!("{diffusion:?}: {errors:?}");
        assert!(errors[1] < 3e-3 && errors[0] / errors[1] > 3.5, "{diffusion:?}: {errors:?}");
    }
}

/// A function that is constant is the wall of that velocity, to the bit; patches take it, too.
#[test]
fn a_constant_function_is_a_constant_wall() {
    let run = |lid: Side| {
        let grid = CartesianGrid::new([12, 10], [1.2, 1.0]).unwrap();
        let fluid = Fluid { density: 2.0, viscosity: 0.05 };
        let mut flow = Projection::new(grid, [Side::WALL.both(), [Side::WALL, lid]], fluid).unwrap();
        (0..20).for_each(|_| flow.advance(5e-3, [0.0; 2]).unwrap());
        flow.velocity().field(0).values().collect::<Vec<_>>()
    };
    let half =
        |low: f64, high: f64, side: Side| Patch { lower: [low, 0.0, 0.0], upper: [high, 0.0, 0.0], side };
    let steady = Side::Wall([0.7, 0.0, 0.0]);
    let moving = Side::moving_wall(|_, _| [0.7, 0.0, 0.0]);
    let left = |side: Side| Side::Patches(vec![half(0.0, 0.6, side), half(0.6, 1.2, Side::WALL)]);
    assert_eq!(run(steady.clone()), run(moving.clone()));
    assert_eq!(run(left(steady.clone())), run(left(moving)));
    let of_place = Side::moving_wall(|x, _| [if x[0] <= 0.6 { 0.7 } else { 0.0 }, 0.0, 0.0]);
    assert_eq!(run(left(steady)), run(of_place));
}

#[test]
fn an_oscillating_wall_goes_on_as_if_it_had_not_stopped() {
    for diffusion in [Diffusion::Explicit, Diffusion::Implicit] {
        let mut whole = layer(16, diffusion);
        (0..30).for_each(|_| whole.advance(0.01, [0.0; 2]).unwrap());
        let mut state = HashMap::new();
        whole.save(&mut |name, values| drop(state.insert(name.to_owned(), values.to_vec())));
        let mut second = layer(16, diffusion);
        second.restore(&|name| state.get(name).map(Vec::as_slice)).unwrap();
        for _ in 0..30 {
            whole.advance(0.01, [0.0; 2]).unwrap();
            second.advance(0.01, [0.0; 2]).unwrap();
        }
        let values = |flow: &Projection<2>| flow.velocity().field(0).values().collect::<Vec<_>>();
        assert_eq!(values(&whole), values(&second), "{diffusion:?}");
    }
}
