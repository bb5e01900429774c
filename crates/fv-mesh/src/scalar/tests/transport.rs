//! Transported scalars.
use super::*;
use crate::{Convection, Diffusion, FlowError, Scalar, ScalarTransport, Velocity};
use interfaces::Checkpoint;
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

/// φ, ∂φ/∂t, ∇φ and ∇²φ of 2 + sin(0.7x + 0.3 − 0.5t) cos(0.5y + 0.3 + 0.3t), without extrema in the box.
fn wave([x, y]: [f64; 2], t: f64) -> (f64, f64, [f64; 2], f64) {
    let (a, b) = (0.7 * x + 0.3 - 0.5 * t, 0.5 * y + 0.3 + 0.3 * t);
    let ((sa, ca), (sb, cb)) = (a.sin_cos(), b.sin_cos());
    (
        2.0 + sa * cb,
        -0.5 * ca * cb - 0.3 * sa * sb,
        [0.7 * ca * cb, -0.5 * sa * sb],
        -(0.7 * 0.7 + 0.5 * 0.5) * sa * cb,
    )
}
/// Steady in direction, not in time; free of divergence.
fn stream([x, y]: [f64; 2], t: f64) -> [f64; 2] {
    let f = 1.0 + 0.3 * (2.0 * t).sin();
    [f * (1.0 + 0.4 * y.sin()), -f * (0.8 + 0.3 * x.cos())]
}
fn source(x: [f64; 2], t: f64, gamma: f64) -> f64 {
    let (_, rate, slope, laplacian) = wave(x, t);
    let u = stream(x, t);
    rate + u[0] * slope[0] + u[1] * slope[1] - gamma * laplacian
}

/// φ at t = 0.2 and its error, after `steps` steps.
fn run(
    family: Family,
    [n, steps]: [usize; 2],
    scheme: Convection,
    diffusion: Diffusion,
    gamma: f64,
) -> (Field<2>, [f64; 2]) {
    let grid: CartesianGrid<2> = family.grid(n);
    let metrics = Metrics::new(&grid, [false; 2]);
    let value = || ScalarSide::Value(Given::function(|x, t| wave([x[0], x[1]], t).0));
    let slope = |sign: f64| Given::function(move |x, t| sign * wave([x[0], x[1]], t).2[1]);
    let above = ScalarSide::Mixed {
        a: 1.0,
        b: 0.2,
        c: Given::function(|x, t| {
            let (phi, _, slope, _) = wave([x[0], x[1]], t);
            phi + 0.2 * slope[1]
        }),
    };
    let sides = [value().both(), [ScalarSide::Gradient(slope(-1.0)), above]];
    let mut scalar =
        Scalar::new(&grid, sides, gamma).unwrap().with_convection(scheme).with_diffusion(diffusion);
    scalar.set(|x| wave(x, 0.0).0);
    let dt = 0.2 / steps as f64;
    for k in 0..steps {
        let t = k as f64 * dt;
        scalar.source_mut().set(|x| source(x, t, gamma));
        scalar.advance(&exact_velocity(&grid, &metrics, |x| stream(x, t)), t, dt).unwrap();
    }
    let exact = Field::from_fn(&grid, |x| wave(x, 0.2).0);
    let error = norms(scalar.field(), &exact, |_| 1.0);
    (scalar.field().clone(), error)
}

#[test]
fn second_order_in_time_and_space() {
    for &family in families(2) {
        for scheme in Convection::ALL {
            // The diffusion that upwinding adds has to be small beside Γ for its error to be of first order.
            // One cell must be small beside the box: upwinding adds diffusion, linear upwinding errs by another
            // multiple of h² in the first cell.
            let (order, n) = match scheme {
                Convection::Upwind => (1.0, 64),
                Convection::LinearUpwind => (2.0, 64),
                _ => (2.0, 32),
            };
            let [coarse, fine] =
                [n, 2 * n].map(|n| run(family, [n, 3 * n / 2], scheme, Diffusion::Auto, 0.2).1);
            assert_order(&format!("{family:?} {scheme:?}"), coarse, fine, order);
        }
    }
}

#[test]
fn second_order_in_time() {
    for diffusion in [Diffusion::Explicit, Diffusion::Implicit] {
        let run = |steps| run(Family::Tanh, [10, steps], Convection::Central, diffusion, 0.05).0;
        let finest = run(1600);
        let errors = [100, 200].map(|steps| norms(&run(steps), &finest, |_| 1.0));
        assert_order(&format!("{diffusion:?}"), errors[0], errors[1], 2.0);
    }
}

/// A velocity without discrete divergence from the stream function ψ, on a uniform grid.
fn from_stream<const D: usize>(
    grid: &CartesianGrid<D>,
    periodic: [bool; D],
    psi: impl Fn(f64, f64) -> f64,
) -> Velocity<D> {
    let h = grid.spacing();
    exact_velocity(grid, &Metrics::new(grid, periodic), |x| {
        let (y, z) = (0.5 * h[1], 0.5 * h[0]);
        std::array::from_fn(|c| match c {
            0 => (psi(x[0], x[1] + y) - psi(x[0], x[1] - y)) / h[1],
            1 => (psi(x[0] - z, x[1]) - psi(x[0] + z, x[1])) / h[0],
            _ => 0.0,
        })
    })
}

/// A hat of height one, turned by a vortex between walls; lowest and highest value met.
fn bounds(scheme: Convection, courant: f64, gamma: f64) -> [f64; 2] {
    let n = 48;
    let grid = CartesianGrid::new([n, n], [1.0; 2]).unwrap();
    let velocity = from_stream(&grid, [false; 2], |x, y| (PI * x).sin() * (PI * y).sin() / PI);
    let sides = ScalarSide::NO_GRADIENT.everywhere();
    let mut scalar = Scalar::new(&grid, sides, gamma).unwrap().with_convection(scheme);
    scalar.set(|[x, y]| f64::from(u8::from((x - 0.3).abs() < 0.15 && (y - 0.5).abs() < 0.2)));
    let dt = courant / n as f64;
    let mut bounds = [0.0_f64, 1.0_f64];
    for k in 0..300 {
        scalar.advance(&velocity, k as f64 * dt, dt).unwrap();
        for v in scalar.field().values() {
            bounds = [bounds[0].min(v), bounds[1].max(v)];
        }
    }
    bounds
}

#[test]
fn bounded_schemes_stay_within_bounds() {
    // Here Σ|u_a| is at most 1, at the middle of each wall.
    for (scheme, courant) in [(Convection::Upwind, 0.44), (Convection::Limited, 0.22)] {
        for gamma in [0.0, 1e-5] {
            let [low, high] = bounds(scheme, courant, gamma);
            assert!(low > -1e-13 && high < 1.0 + 1e-13, "{scheme:?}: {low:e} … 1 + {:e}", high - 1.0);
        }
    }
    let [low, high] = bounds(Convection::Central, 0.22, 0.0);
    assert!(low < -0.05 && high > 1.05, "the hat is no test: {low} {high}");
}

fn conserved<const D: usize>(grid: CartesianGrid<D>, periodic: [bool; D]) {
    let velocity = from_stream(&grid, periodic, |x, y| (TAU * x).sin() * (TAU * y).sin());
    for (scheme, diffusion) in
        Convection::ALL.into_iter().flat_map(|s| [Diffusion::Explicit, Diffusion::Implicit].map(|d| (s, d)))
    {
        let sides =
            periodic.map(|p| if p { ScalarSide::Periodic.both() } else { ScalarSide::NO_GRADIENT.both() });
        let mut scalar =
            Scalar::new(&grid, sides, 1e-3).unwrap().with_convection(scheme).with_diffusion(diffusion);
        scalar.set(|x| 1.0 + (3.0 * x[0]).sin() * x[1]);
        let start = scalar.integral();
        for k in 0..40 {
            let dt = [0.004, 0.003][k % 2];
            scalar.advance(&velocity, 0.0, dt).unwrap();
        }
        let gained = (scalar.integral() - start).abs() / start;
        assert!(gained < 2e-14, "{scheme:?} {diffusion:?} {gained:e}");
    }
}

#[test]
fn the_integral_is_conserved_to_round_off() {
    conserved(CartesianGrid::new([17, 12], [1.0; 2]).unwrap(), [true, true]);
    conserved(CartesianGrid::new([17, 12], [1.0; 2]).unwrap(), [false, true]);
    conserved(CartesianGrid::new([9, 8, 5], [1.0; 3]).unwrap(), [false, false, true]);
    conserved(CartesianGrid::new([9, 8, 1], [1.0; 3]).unwrap(), [true, false, true]);
}

#[test]
fn a_constant_stays_what_it_is() {
    let grid = CartesianGrid::new([12, 9], [1.0; 2]).unwrap();
    let velocity = from_stream(&grid, [false, true], |x, y| (TAU * x).sin() * (TAU * y).sin());
    for scheme in Convection::ALL {
        let sides = [[ScalarSide::value(3.0), ScalarSide::NO_GRADIENT], ScalarSide::Periodic.both()];
        let mut scalar = Scalar::new(&grid, sides, 0.1).unwrap().with_convection(scheme);
        scalar.set(|_| 3.0);
        for k in 0..20 {
            scalar.advance(&velocity, 0.002 * k as f64, 0.002).unwrap();
        }
        let worst = scalar.field().values().map(|v| (v - 3.0).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-13, "{scheme:?} {worst:e}");
    }
}

#[test]
fn a_restart_goes_on_bit_for_bit() {
    let grid: CartesianGrid<2> = Family::Tanh.grid(14);
    let velocity = exact_velocity(&grid, &Metrics::new(&grid, [false; 2]), |x| stream(x, 0.0));
    let moving = || ScalarSide::Value(Given::function(|x, t| x[1] + (5.0 * t).sin()));
    let new = || {
        let sides = [moving().both(), ScalarSide::NO_GRADIENT.both()];
        Scalar::new(&grid, sides, 0.05).unwrap().with_convection(Convection::Limited)
    };
    let step = |scalar: &mut Scalar<2>, k: usize| {
        scalar.advance(&velocity, 0.01 * k as f64, 0.01).unwrap();
    };
    let mut whole = new();
    whole.source_mut().set(|x| x[0]);
    (0..7).for_each(|k| step(&mut whole, k));
    let mut saved = HashMap::new();
    whole.save(&mut |name, values| assert!(saved.insert(name.to_string(), values.to_vec()).is_none()));
    let mut second = new();
    second.restore(&|name| saved.get(name).map(Vec::as_slice)).unwrap();
    for k in 7..12 {
        step(&mut whole, k);
        step(&mut second, k);
    }
    assert_eq!(whole.field().data(), second.field().data());
    assert!(second.restore(&|_| None).is_err());
}

#[test]
fn none_one_or_many() {
    let grid = CartesianGrid::new([8, 6], [1.0; 2]).unwrap();
    let velocity = from_stream(&grid, [true; 2], |x, y| (TAU * x).sin() * (TAU * y).sin());
    let new = |gamma: f64| {
        let mut scalar = Scalar::new(&grid, ScalarSide::Periodic.everywhere(), gamma).unwrap();
        scalar.set(|x| x[0]);
        scalar
    };
    let (mut one, mut many) = (new(0.2), vec![new(0.1), new(0.2)]);
    ScalarTransport::<2>::advance(&mut (), &velocity, 0.0, 0.01).unwrap();
    one.advance(&velocity, 0.0, 0.01).unwrap();
    many.advance(&velocity, 0.0, 0.01).unwrap();
    assert_eq!(one.field().data(), many[1].field().data());
    assert_eq!(size_of::<()>(), 0);
    assert_eq!(many.longest_step(0.0), one.longest_step(0.0));
    assert_eq!(ScalarTransport::<2>::longest_step(&(), 1.0), f64::INFINITY);
}

#[test]
fn bad_input_is_an_error() {
    let grid = CartesianGrid::new([8, 6], [1.0; 2]).unwrap();
    let other = CartesianGrid::new([6, 8], [1.0; 2]).unwrap();
    let velocity = |grid, periodic| from_stream(grid, periodic, |x, y| x * y);
    let new = || Scalar::new(&grid, ScalarSide::Periodic.everywhere(), 0.2).unwrap();
    let fits = velocity(&grid, [true; 2]);
    assert!(matches!(new().advance(&fits, 0.0, 0.0), Err(FlowError::TimeStep { .. })));
    assert!(matches!(new().advance(&fits, 0.0, f64::NAN), Err(FlowError::TimeStep { .. })));
    assert!(matches!(
        new().advance(&velocity(&other, [true; 2]), 0.0, 0.1),
        Err(FlowError::OtherGrid { .. })
    ));
    let walled = velocity(&grid, [true, false]);
    assert!(matches!(new().advance(&walled, 0.0, 0.1), Err(FlowError::Boundary { .. })));
    let mut explicit = new().with_diffusion(Diffusion::Explicit);
    assert!(matches!(explicit.advance(&fits, 0.0, 1.0), Err(FlowError::Unstable { .. })));
    let mut bad = new();
    bad.set(|_| f64::INFINITY);
    assert!(matches!(bad.advance(&fits, 0.0, 0.01), Err(FlowError::ScalarDiverged { step: 1, .. })));
    assert!(Scalar::new(&grid, ScalarSide::Periodic.everywhere(), -1.0).is_err());
}
