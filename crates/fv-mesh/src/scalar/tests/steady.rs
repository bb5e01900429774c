//! Steady scalars in steady flows against exact solutions.
use crate::{
    CartesianGrid, Convection, FlowError, Fluid, Profile, Projection, Scalar, ScalarSide, Settling, Side,
};

const WATER: Fluid = Fluid { density: 1.0, viscosity: 1e-2 };

/// A uniform stream along x, of one cell across.
fn stream(cells: usize, speed: f64) -> Projection<2> {
    let grid = CartesianGrid::new([cells, 1], [1.0, 0.1]).unwrap();
    let sides = [Side::Inlet(Profile::Uniform([speed, 0.0, 0.0])).both(), Side::Periodic.both()];
    let mut flow = Projection::new(grid, sides, WATER).unwrap();
    flow.set_velocity(|_| [speed, 0.0]);
    flow
}

/// The largest error of the steady φ between 0 and 1 at the ends of a stream.
fn error(cells: usize, speed: f64, gamma: f64, scheme: Convection) -> f64 {
    let flow = stream(cells, speed);
    let sides = [[ScalarSide::value(0.0), ScalarSide::value(1.0)], ScalarSide::Periodic.both()];
    let mut scalar = Scalar::new(flow.grid(), sides, gamma).unwrap().with_convection(scheme);
    let settling = Settling { tolerance: 1e-10, ..Settling::default() };
    scalar.settle(flow.velocity(), 0.0, settling, &[], |_| ()).unwrap();
    let peclet = speed / gamma;
    let exact = |x: f64| if peclet == 0.0 { x } else { (peclet * x).exp_m1() / peclet.exp_m1() };
    let x = |i: usize| (i as f64 + 0.5) / cells as f64;
    scalar.field().values().enumerate().map(|(i, phi)| (phi - exact(x(i))).abs()).fold(0.0, f64::max)
}

/// Convection against conduction, to and fro: (e^{Pe x} − 1)/(e^{Pe} − 1).
#[test]
fn a_stream_between_two_values_has_the_exact_profile() {
    for speed in [5.0, -5.0] {
        for (scheme, least) in
            [(Convection::Central, 3.6), (Convection::Limited, 3.0), (Convection::Upwind, 1.8)]
        {
            let [coarse, fine] = [40, 80].map(|cells| error(cells, speed, 1.0, scheme));
            assert!(coarse / fine > least && fine < 2e-2, "{speed} {scheme:?}: {coarse} {fine}");
        }
    }
    // Conduction alone is exact.
    assert!(error(10, 0.0, 1.0, Convection::Central) < 1e-9);
}

/// Cells that are held are as walls between which φ is linear.
#[test]
fn held_cells_hold() {
    let flow = stream(21, 0.0);
    let sides = [[ScalarSide::value(0.0), ScalarSide::NO_GRADIENT], ScalarSide::Periodic.both()];
    let mut scalar = Scalar::new(flow.grid(), sides, 1.0).unwrap();
    let held = flow.grid().place([10, 0]);
    scalar.settle(flow.velocity(), 0.0, Settling::default(), &[held], |phi| phi[held] = 2.0).unwrap();
    for (i, phi) in scalar.field().values().enumerate() {
        let exact = if i < 10 { 2.0 * (i as f64 + 0.5) / 10.5 } else { 2.0 };
        assert!((phi - exact).abs() < 1e-6, "{i}: {phi} {exact}");
    }
}

/// Nusselt number of developed flow between plates at one temperature: Nu = h D_h/k = 7.5407 (Shah & London 1978).
#[test]
fn heat_from_two_plates_is_that_of_graetz() {
    let nusselt = |across: usize| {
        let (length, along, gamma) = (40.0, 80, 0.01);
        let grid = CartesianGrid::new([along, across], [length, 1.0]).unwrap();
        let profile = |y: f64| 6.0 * y * (1.0 - y);
        let inlet = Side::Inlet(Profile::function(move |x, _| [profile(x[1]), 0.0, 0.0]));
        let mut flow = Projection::new(grid, [inlet.both(), Side::WALL.both()], WATER).unwrap();
        flow.set_velocity(|x| [profile(x[1]), 0.0]);
        let sides = [[ScalarSide::value(1.0), ScalarSide::NO_GRADIENT], ScalarSide::value(0.0).both()];
        let mut warmth = Scalar::new(flow.grid(), sides, gamma).unwrap().with_convection(Convection::Limited);
        warmth.settle(flow.velocity(), 0.0, Settling::default(), &[], |_| ()).unwrap();
        // What the stream carries at a column, and from where to where its logarithm is taken.
        let carried = |i: usize| -> f64 {
            let y = |j: usize| (j as f64 + 0.5) / across as f64;
            (0..across).map(|j| profile(y(j)) * warmth.field().row(j)[i]).sum()
        };
        let [from, to] = [along / 2, along * 3 / 4];
        let distance = (to - from) as f64 * length / along as f64;
        // ū h dθ/dx = −2 (Γ Nu/D_h) θ with ū = h = 1, D_h = 2.
        (carried(from) / carried(to)).ln() / (gamma * distance)
    };
    let [coarse, fine] = [16, 32].map(|across| nusselt(across) / 7.5407 - 1.0);
    assert!(fine.abs() < 3e-3 && coarse.abs() > 2.0 * fine.abs(), "{coarse} {fine}");
}

/// What has no answer is told.
#[test]
fn a_scalar_without_a_value_anywhere_is_told() {
    let flow = stream(8, 1.0);
    let sides = [ScalarSide::NO_GRADIENT.both(), ScalarSide::Periodic.both()];
    let mut scalar = Scalar::new(flow.grid(), sides, 1.0).unwrap();
    let error = scalar.settle(flow.velocity(), 0.0, Settling::default(), &[], |_| ()).unwrap_err();
    assert!(
        matches!(error, FlowError::Boundary { .. }) && error.to_string().contains("give its value"),
        "{error}"
    );
    let sides = [ScalarSide::value(1.0).both(), ScalarSide::Periodic.both()];
    let mut scalar = Scalar::new(flow.grid(), sides, 1.0).unwrap();
    let hasty = Settling { tolerance: 1e-8, max_iterations: 1 };
    let error = scalar.settle(flow.velocity(), 0.0, hasty, &[], |_| ()).unwrap_err();
    assert!(matches!(error, FlowError::ScalarNotSteady { iterations: 1, .. }), "{error}");
}
