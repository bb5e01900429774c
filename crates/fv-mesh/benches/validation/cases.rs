//! The cases.
use crate::centrelines::{centreline, cubic, deviation};
use crate::{Case, Found};
use fv_mesh::{
    Axis, Boussinesq, CartesianGrid, Cluster, FlowError, Fluid, Hooks, Profile, Projection, Sampler, Scalar,
    ScalarSide, Side,
};
use interfaces::Vector;
use std::f64::consts::{PI, TAU};

pub(crate) const ALL: &[Case] = &[
    Case {
        name: "taylor-green",
        what: "kinetic energy at t 1, ν 0.01",
        // π² e^(−4νt)
        reference: 9.482612,
        grids: [32, 64, 128],
        run: taylor_green,
    },
    Case {
        name: "poiseuille",
        what: "flow rate of the plane channel, 1/12",
        reference: 1.0 / 12.0,
        grids: [8, 16, 32],
        run: poiseuille,
    },
    Case {
        name: "womersley",
        what: "rms speed in the middle, Wo 5",
        reference: f64::NAN,
        grids: [16, 32, 64],
        run: womersley,
    },
    Case {
        name: "kovasznay",
        what: "least u, Re 40",
        reference: f64::NAN,
        grids: [32, 64, 128],
        run: kovasznay,
    },
    Case {
        name: "channel",
        what: "pressure drop, inlet to pressure outlet",
        reference: 3.6,
        grids: [8, 16, 32],
        run: channel,
    },
    Case {
        name: "cavity-100-u",
        what: "least u (spectral); error of u against Ghia",
        reference: -0.2140424,
        grids: [33, 65, 129],
        run: |n| cavity(n, 100.0, 0),
    },
    Case {
        name: "cavity-100-v",
        what: "least v (spectral); error of v against Ghia",
        reference: -0.253803,
        grids: [33, 65, 129],
        run: |n| cavity(n, 100.0, 1),
    },
    Case {
        name: "cavity-400-u",
        what: "least u (Ghia); error of u against Ghia",
        reference: -0.32726,
        grids: [33, 65, 129],
        run: |n| cavity(n, 400.0, 0),
    },
    Case {
        name: "cavity-400-v",
        what: "least v (Ghia); error of v against Ghia",
        reference: -0.44993,
        grids: [33, 65, 129],
        run: |n| cavity(n, 400.0, 1),
    },
    Case {
        name: "cavity-1000-u",
        what: "least u (Botella & Peyret)",
        reference: -0.3885698,
        grids: [64, 128, 256],
        run: |n| extremum(n, 0),
    },
    Case {
        name: "cavity-1000-v-max",
        what: "largest v (Botella & Peyret)",
        reference: 0.3769447,
        grids: [64, 128, 256],
        run: |n| extremum(n, 1),
    },
    Case {
        name: "cavity-1000-v-min",
        what: "least v (Botella & Peyret)",
        reference: -0.5270771,
        grids: [64, 128, 256],
        run: |n| extremum(n, 2),
    },
    Case {
        name: "heated-square",
        what: "Nusselt number, Ra 1e4 (de Vahl Davis 2.243)",
        reference: 2.243,
        grids: [20, 40, 80],
        run: heated_square,
    },
    Case {
        name: "taylor-green-1600",
        what: "largest −dE/dt (spectral 512³)",
        reference: 1.28575e-2,
        grids: [32, 64, 128],
        run: taylor_green_1600,
    },
];

fn relative(value: f64, reference: f64) -> f64 {
    value / reference - 1.0
}

fn taylor_green(n: usize) -> Result<Found, FlowError> {
    let grid = CartesianGrid::new([n, n], [TAU, TAU])?;
    let fluid = Fluid { density: 1.0, viscosity: 0.01 };
    let mut flow = Projection::new(grid, Side::Periodic.everywhere(), fluid)?;
    flow.set_velocity(|x| [-x[0].cos() * x[1].sin(), x[0].sin() * x[1].cos()]);
    let steps = n;
    for _ in 0..steps {
        flow.advance(1.0 / steps as f64, [0.0; 2])?;
    }
    let value = flow.statistics().kinetic_energy;
    Ok(Found { value, error: relative(value, PI * PI * (-0.04_f64).exp()), cells: n * n })
}

fn poiseuille(n: usize) -> Result<Found, FlowError> {
    let grid = CartesianGrid::new([1, n], [0.1, 1.0])?;
    let sides = [Side::Periodic.both(), Side::WALL.both()];
    let mut flow = Projection::new(grid, sides, Fluid { density: 1.0, viscosity: 1.0 })?;
    let dt = 0.9 * flow.viscous_limit();
    while flow.time() < 4.0 {
        flow.advance(dt, [1.0, 0.0])?;
    }
    let y = |j: usize| (j as f64 + 0.5) / n as f64;
    let rows: Vec<f64> = (0..n).map(|j| flow.velocity().field(0).row(j)[0]).collect();
    let worst = (0..n).map(|j| (rows[j] - 0.5 * y(j) * (1.0 - y(j))).abs()).fold(0.0, f64::max);
    // The largest error over the nodes, of the largest speed.
    Ok(Found { value: rows.iter().sum::<f64>() / n as f64, error: 8.0 * worst, cells: n })
}

/// A channel of unit width under the force cos ωt, ν 1, Wo = ½√(ω/ν) = 5.
fn womersley(n: usize) -> Result<Found, FlowError> {
    let omega: f64 = 100.0;
    let grid = CartesianGrid::new([1, n], [0.1, 1.0])?;
    let sides = [Side::Periodic.both(), Side::WALL.both()];
    let mut flow = Projection::new(grid, sides, Fluid { density: 1.0, viscosity: 1.0 })?;
    let period = TAU / omega;
    let steps = (8 * n * n / 16).max(256);
    let dt = period / steps as f64;
    // u = Re{ (1/iω) [1 − cosh(k(y − ½))/cosh(k/2)] e^{iωt} }, k = √(iω/ν) = (1 + i)√(ω/2ν).
    let k = (0.5 * omega).sqrt();
    let cosh = |s: f64| (s.cosh() * s.cos(), s.sinh() * s.sin());
    let exact = |y: f64, t: f64| {
        let ((a, b), (c, d)) = (cosh(k * (y - 0.5)), cosh(0.5 * k));
        let norm = c * c + d * d;
        let (re, im) = (1.0 - (a * c + b * d) / norm, -(b * c - a * d) / norm);
        // Times e^{iωt}/(iω).
        let (sin, cos) = (omega * t).sin_cos();
        (im * cos + re * sin) / omega
    };
    // From the exact state, over one period.
    flow.set_velocity(|x| [exact(x[1], 0.0), 0.0]);
    let (mut square, mut error, mut scale) = (0.0, 0.0, 0.0);
    for step in 0..steps {
        let middle = (step as f64 + 0.5) * dt;
        // The mean of the force over the step.
        let force = (0.5 * omega * dt).sin() / (0.5 * omega * dt) * (omega * middle).cos();
        flow.advance(dt, [force, 0.0])?;
        for j in 0..n {
            let found = flow.velocity().field(0).row(j)[0];
            let wanted = exact((j as f64 + 0.5) / n as f64, flow.time());
            error += (found - wanted).powi(2);
            scale += wanted * wanted;
        }
        square += 0.25
            * (flow.velocity().field(0).row(n / 2)[0] + flow.velocity().field(0).row(n / 2 - 1)[0]).powi(2);
    }
    Ok(Found { value: (square / steps as f64).sqrt(), error: (error / scale).sqrt(), cells: n })
}

fn kovasznay(n: usize) -> Result<Found, FlowError> {
    let exact = |x: [f64; 3]| {
        let l = 20.0 - (400.0 + 4.0 * PI * PI).sqrt();
        let e = (l * x[0]).exp();
        let (s, c) = (TAU * x[1]).sin_cos();
        [1.0 - e * c, l / TAU * e * s, 0.0]
    };
    let grid = CartesianGrid::from_axes([Axis::uniform(n, -0.5, 1.0)?, Axis::uniform(n, -0.5, 1.5)?])?;
    let side = Side::Inlet(Profile::function(move |x, _| exact(x)));
    let mut flow = Projection::new(grid, side.everywhere(), Fluid { density: 1.0, viscosity: 1.0 / 40.0 })?;
    flow.set_velocity(|x| {
        let u = exact([x[0], x[1], 0.0]);
        [u[0], u[1]]
    });
    let dt = 0.25 / n as f64;
    while flow.time() < 6.0 {
        flow.advance(dt, [0.0; 2])?;
    }
    let (mut error, mut scale, mut least) = (0.0, 0.0, f64::INFINITY);
    for j in 0..n {
        for i in 1..n {
            let x = [flow.grid().axis(0).faces()[i], flow.grid().axis(1).centre(j), 0.0];
            let found = flow.velocity().field(0).row(j)[i];
            error += (found - exact(x)[0]).powi(2);
            scale += exact(x)[0].powi(2);
            least = least.min(found);
        }
    }
    Ok(Found { value: least, error: (error / scale).sqrt(), cells: n * n })
}

/// Developed flow of mean speed 1 through a channel 3 long, 1 wide, ρν 0.1: Δp = 12 ρνŪL/H².
fn channel(n: usize) -> Result<Found, FlowError> {
    let grid = CartesianGrid::new([3 * n, n], [3.0, 1.0])?;
    let inlet = Side::Inlet(Profile::Parabolic { peak: 1.5 });
    let sides = [[inlet, Side::PressureOutlet(0.0)], Side::WALL.both()];
    let mut flow = Projection::new(grid, sides, Fluid { density: 2.0, viscosity: 0.05 })?;
    while flow.time() < 20.0 {
        flow.advance(flow.stable_dt(0.4), [0.0; 2])?;
    }
    let p = |i: usize| flow.pressure().row(n / 2)[i];
    // Linear, so that the ends follow from the first two cells.
    let value = 1.5 * p(0) - 0.5 * p(1);
    Ok(Found { value, error: relative(value, 3.6), cells: 3 * n * n })
}

/// The cavity at rest at last: starts from `coarse` if there is one; cells gathered at the walls by a hyperbolic tangent of
/// strength `beta` (0: uniform).
fn driven(
    n: usize,
    re: f64,
    end: f64,
    coarse: Option<&Projection<2>>,
    beta: f64,
) -> Result<Projection<2>, FlowError> {
    let axis = || match beta {
        0.0 => Axis::uniform(n, 0.0, 1.0),
        _ => Axis::tanh(n, 0.0, 1.0, beta, Cluster::Both),
    };
    let grid = CartesianGrid::from_axes([axis()?, axis()?])?;
    let sides = [Side::WALL.both(), [Side::WALL, Side::Wall([1.0, 0.0, 0.0])]];
    let mut flow = Projection::new(grid, sides, Fluid { density: 1.0, viscosity: 1.0 / re })?;
    if let Some(coarse) = coarse {
        let sampler = Sampler::new(coarse.grid(), coarse.sides());
        flow.set_velocity(|x| sampler.velocity(coarse.velocity(), x).unwrap_or([0.0; 2]));
    }
    let mut last = f64::INFINITY;
    while flow.time() < end {
        let until = flow.time() + 1.0;
        while flow.time() < until {
            flow.advance(flow.stable_dt(0.6), [0.0; 2])?;
        }
        let energy = flow.statistics().kinetic_energy;
        if (energy / last - 1.0).abs() < 1e-8 {
            break;
        }
        last = energy;
    }
    Ok(flow)
}

/// Largest (`sign` 1) or least (−1) value on the line, by the cubics between its points.
fn extreme(line: &[(f64, f64)], sign: f64) -> f64 {
    let top = (0..20_000)
        .map(|k| sign * cubic(line, (k as f64 + 0.5) / 20_000.0))
        .fold(f64::NEG_INFINITY, f64::max);
    sign * top
}

/// Error: the largest deviation of one component from Ghia's table, in lid speeds.
fn cavity(n: usize, re: f64, component: usize) -> Result<Found, FlowError> {
    let flow = driven(n, re, 100.0, None, 0.0)?;
    let line = centreline(flow.grid(), flow.sides(), flow.velocity(), component);
    let error = deviation(&line, component, re);
    Ok(Found { value: extreme(&line, -1.0), error, cells: n * n })
}

/// Extremes at Re 1000 on cells gathered at the walls: least u, largest v, least v.
fn extremum(n: usize, which: usize) -> Result<Found, FlowError> {
    // One run serves the three.
    use std::collections::HashMap;
    use std::sync::Mutex;
    static RUNS: Mutex<Option<HashMap<usize, [f64; 3]>>> = Mutex::new(None);
    let mut runs = RUNS.lock().unwrap_or_else(|e| e.into_inner());
    let runs = runs.get_or_insert_default();
    let values = match runs.get(&n) {
        Some(values) => *values,
        None => {
            let mut flow = driven(n.min(64), 1000.0, 80.0, None, 1.2)?;
            let mut size = 128;
            while size <= n {
                flow = driven(size, 1000.0, 40.0, Some(&flow), 1.2)?;
                size *= 2;
            }
            let line = |c| centreline(flow.grid(), flow.sides(), flow.velocity(), c);
            let (u, v) = (line(0), line(1));
            *runs.entry(n).or_insert([extreme(&u, -1.0), extreme(&v, 1.0), extreme(&v, -1.0)])
        }
    };
    let value = values[which];
    let reference = [-0.3885698, 0.3769447, -0.5270771][which];
    Ok(Found { value, error: relative(value, reference), cells: n * n })
}

/// Natural convection of air (Pr 0.71) in a square heated from the side; sides gathered by a hyperbolic tangent.
fn heated_square(n: usize) -> Result<Found, FlowError> {
    let (pr, ra) = (0.71_f64, 1e4);
    let axis = || Axis::tanh(n, 0.0, 1.0, 1.2, Cluster::Both);
    let grid = CartesianGrid::from_axes([axis()?, axis()?])?;
    let fluid = Fluid { density: 1.0, viscosity: (pr / ra).sqrt() };
    let mut flow = Projection::new(grid.clone(), Side::WALL.everywhere(), fluid)?;
    let sides = [[ScalarSide::value(1.0), ScalarSide::value(0.0)], ScalarSide::NO_GRADIENT.both()];
    let scalar = Scalar::new(&grid, sides, 1.0 / (pr * ra).sqrt())?;
    let buoyancy = Boussinesq { expansion: 1.0, reference: 0.5, gravity: Vector::new(0.0, -1.0, 0.0) };
    let mut hooks = Hooks::none().with_body_force(buoyancy).with_scalars(scalar);
    while flow.time() < 60.0 {
        let dt = flow.stable_dt(0.4).min(0.02);
        flow.advance_with(dt, &mut hooks)?;
    }
    let phi = hooks.scalars.field();
    let (x, y) = (grid.axis(0), grid.axis(1));
    let value: f64 = (0..n).map(|j| (1.0 - phi.row(j)[0]) * 2.0 / x.width(0) * y.width(j)).sum();
    Ok(Found { value, error: relative(value, 2.243), cells: n * n })
}

/// Box [0, 2π]³, unit speed, ν 1/1600; the rate per volume by differences of the energy over 0.1.
fn taylor_green_1600(n: usize) -> Result<Found, FlowError> {
    let grid = CartesianGrid::new([n; 3], [TAU; 3])?;
    let fluid = Fluid { density: 1.0, viscosity: 1.0 / 1600.0 };
    let mut flow = Projection::new(grid, Side::Periodic.everywhere(), fluid)?;
    flow.set_velocity(|x| [x[0].sin() * x[1].cos() * x[2].cos(), -x[0].cos() * x[1].sin() * x[2].cos(), 0.0]);
    let volume = flow.grid().volume();
    let (mut last, mut largest) = (flow.statistics().kinetic_energy, 0.0_f64);
    for tenth in 1..=100 {
        let end = 0.1 * f64::from(tenth);
        while flow.time() < end - 1e-12 {
            let left = end - flow.time();
            let steps = (left / flow.stable_dt(0.5)).ceil();
            flow.advance(left / steps, [0.0; 3])?;
        }
        let energy = flow.statistics().kinetic_energy;
        largest = largest.max((last - energy) / volume / 0.1);
        last = energy;
    }
    Ok(Found { value: largest, error: relative(largest, 1.28575e-2), cells: n * n * n })
}
