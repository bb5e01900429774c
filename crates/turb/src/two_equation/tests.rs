use super::*;
use crate::WallShear;
use crate::testing::Uniform;
use interfaces::{LogSlope, WallPoint};
use proptest::prelude::*;

const INFLOW: Inflow = Inflow { k: 2.0, omega: 3.0 };

/// −d ln k/d ln t once the start is forgotten, of turbulence that nothing feeds.
fn decay<L: Law>(law: L) -> f64 {
    let mut flow = Uniform::new([[0.0; 3]; 3], 1);
    let mut model = TwoEquation::new(law, 1, INFLOW).unwrap();
    // k(t) = k₀ (1 + t/(n t₀))^−n with t₀ = k/ε at the start: from this origin it is a power of time.
    let turnover = 1.0 / (0.09 * INFLOW.omega);
    let (mut time, mut at) = (0.0, Vec::new());
    while time < 200.0 * turnover {
        let dt = 5e-4 * (turnover + time);
        model.correct(&mut flow, &[], 1e-9, Some(dt)).unwrap();
        time += dt;
        at.push((time, model.k()[0]));
    }
    // With the origin as unknown: t + t₁ is linear in k^(−1/n); n from the slopes of 1/(d ln k/dt), which is −(t + t₁)/n.
    let slope = |i: usize| {
        let ((t0, k0), (t1, k1)) = (at[i], at[i + 1]);
        (0.5 * (t0 + t1), (t1 - t0) / (k1 / k0).ln())
    };
    let ((ta, a), (tb, b)) = (slope(at.len() / 2), slope(at.len() - 2));
    -(tb - ta) / (b - a)
}

#[test]
fn decay_has_the_exponent_of_the_model() {
    let near = |found: f64, exact: f64| assert!((found / exact - 1.0).abs() < 2e-3, "{found} {exact}");
    near(decay(StandardKEpsilon::default()), 1.0 / 0.92);
    near(decay(Wilcox::default()), 1.2);
    near(decay(Wilcox::openfoam()), 0.09 / 0.072);
    near(decay(Realizable::default()), 1.0 / 0.9);
    // Far from walls SST is k–ε in disguise.
    near(decay(Sst::default()), 0.09 / 0.0828);
}

/// Where k and ε are far from each other: in steady iterations no mixing length is beyond the farthest wall, in time the model is as it is.
#[test]
fn eddies_are_no_larger_than_the_flow() {
    let mut flow = Uniform::new([[0.0; 3]; 3], 1);
    flow.distance = vec![0.5];
    let model = || TwoEquation::new(StandardKEpsilon::default(), 1, Inflow { k: 2.0, omega: 1e-6 }).unwrap();
    let (mut steady, mut unsteady) = (model(), model());
    steady.correct(&mut flow, &[], 1e-5, None).unwrap();
    unsteady.correct(&mut flow, &[], 1e-5, Some(1e-3)).unwrap();
    let most = |model: &KEpsilon| 0.09_f64.powf(0.25) * 0.5 * model.k()[0].sqrt();
    assert!((steady.nu_t()[0] / most(&steady) - 1.0).abs() < 1e-12 && steady.limited() == 1);
    assert!(unsteady.nu_t()[0] > 1e3 * most(&unsteady) && unsteady.limited() == 0);
}

/// A layer that differences find too steep is to every model what it is; where it is not logarithmic nothing is taken off.
#[test]
fn logarithmic_layers_have_their_own_slope() {
    fn same<L: Law>(law: L) {
        let part = 0.6;
        let k_after = |shear: f64, distance: f64, slopes: bool| {
            let mut flow = Uniform::new([[0.0, shear, 0.0], [0.0; 3], [0.0; 3]], 1);
            flow.distance = vec![distance];
            flow.log_slopes = slopes.then_some(LogSlope { cell: 0, distance, part }).into_iter().collect();
            let mut model = TwoEquation::new(law.clone(), 1, INFLOW).unwrap();
            for _ in 0..3 {
                model.correct(&mut flow, &[], 1e-6, Some(0.1)).unwrap();
            }
            [model.k()[0], model.scale()[0], model.nu_t()[0]]
        };
        let close = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a / b - 1.0).abs() < 1e-9);
        // y* of 7.7e5, and of 0.008.
        let [far, near] = [1.0, 1e-8];
        assert!(close(k_after(7.0, far, true), k_after(part * 7.0, far, false)));
        assert!(!close(k_after(7.0, far, true), k_after(7.0, far, false)));
        assert!(close(k_after(7.0, near, true), k_after(7.0, near, false)));
    }
    same(Wilcox::default());
    same(Sst::default());
    same(StandardKEpsilon::default());
    same(Realizable::default());
}

/// Homogeneous shear: k and the scale grow without bound, at the rate that P/ε = (C₂ − 1)/(C₁ − 1) says.
#[test]
fn shear_flow_reaches_the_equilibrium_of_the_model() {
    let shear = 7.0;
    let mut flow = Uniform::new([[0.0, shear, 0.0], [0.0; 3], [0.0; 3]], 1);
    let mut model = TwoEquation::new(StandardKEpsilon::default(), 1, INFLOW).unwrap();
    for _ in 0..20_000 {
        model.correct(&mut flow, &[], 1e-9, Some(1e-3)).unwrap();
    }
    let ratio = model.nu_t()[0] * shear * shear / model.scale()[0];
    assert!((ratio / (0.92 / 0.44) - 1.0).abs() < 2e-3, "{ratio}");
}

#[test]
fn sst_blends_from_one_model_to_the_other() {
    let sst = Sst::default();
    let near =
        Local { k: 1.0, scale: 100.0, eddy: 0.01, strain: 1.0, distance: 1e-3, nu: 1e-5, ..Local::default() };
    let far = Local { distance: 1e3, ..near };
    assert_eq!((sst.f_1(&near), sst.f_2(&near)), (1.0, 1.0));
    assert!(sst.f_1(&far) < 1e-12 && sst.f_2(&far) < 1e-6);
    // The limiter: ν_t = a₁k/|S| where |S| is large beside walls, k/ω elsewhere.
    let sheared = |c: Local| Local { strain: 1e3, ..c };
    assert_eq!(sst.eddy_viscosity(&sheared(near)), 0.31 / 1e3);
    assert_eq!(sst.eddy_viscosity(&sheared(far)), 0.01);
    // Cross diffusion of either sign is a term that is not negative.
    let crossed = |cross: f64| sst.scale_terms(&Local { cross, auxiliary: 0.3, ..near });
    let (plus, minus, none) = (crossed(50.0), crossed(-50.0), crossed(0.0));
    let term = 2.0 * 0.7 * 0.856 * 50.0 / 100.0;
    assert!((plus.source - none.source - term).abs() < 1e-13 && plus.sink == none.sink);
    assert!(((minus.sink - none.sink) * 100.0 - term).abs() < 1e-13 && minus.source == none.source);
}

/// ν_t/ν and C_μ of the reference run's wall cell (realizable k–ε, mesh c): from its k+, y+ and u+.
#[test]
fn realizable_has_the_eddy_viscosity_of_the_reference_run() {
    let (y, k, strain) = (52.604_748_67, 3.462_002_653, 0.156_107);
    let epsilon = WallFunctions::default().epsilon(y, k, 1.0);
    let law = Realizable::default();
    let mut cell = Local { k, scale: epsilon, strain, nu: 1.0, ..Local::default() };
    cell.auxiliary = law.auxiliary(&cell, Invariants::shear(strain));
    let found = law.eddy_viscosity(&cell);
    assert!((found / 8.925_587_185 - 1.0).abs() < 2e-3, "{found}");
    // A strain that is not plane: of axisymmetric expansion √6 W = 1 and φ = 0.
    let i = Invariants::of(&[[2.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]);
    assert!((6.0_f64.sqrt() * i.third - 1.0).abs() < 1e-12);
    assert!((law.auxiliary(&cell, i) - 6.0).abs() < 1e-6);
}

/// A row whose k is in equilibrium with its friction: ν_t on the wall is that of the law of the wall, the pinned values are the
/// wall functions', and production is dissipation.
#[test]
fn rows_get_wall_functions() {
    let f = WallFunctions::default();
    let (nu, y_plus, u_tau) = (1e-5, 80.0, 0.4);
    let (y, u_t, k) = (y_plus * nu / u_tau, u_tau * f.u_plus(y_plus), u_tau * u_tau / 0.3);
    let row = |cell, area| WallRow { cell, y, area, u_t, shear: Some(u_t / (2.0 * y)), ..WallRow::default() };
    // Cell 1 has two walls.
    let rows = [row(1, 0.5), row(0, 1.0), row(1, 1.5)];
    let mut layer = WallLayer::new(f);
    layer.update(&rows, &[k, k, 5.0], nu, Scale::Omega).unwrap();
    layer.refresh(&rows, &[k, k, 5.0], nu);
    layer.update(&rows, &[k, k, 5.0], nu, Scale::Omega).unwrap();
    for nu_t in &layer.viscosity {
        assert!(((nu + nu_t) * u_t / y / (u_tau * u_tau) - 1.0).abs() < 1e-12);
    }
    assert_eq!(layer.pins.len(), 2);
    for (w, (cell, value)) in layer.cells.iter().zip(&layer.pins) {
        assert_eq!(w.cell, *cell);
        assert!((value / f.omega(y, k, nu) - 1.0).abs() < 1e-14);
        assert!((w.production / (0.3_f64.powi(2) * k * value) - 1.0).abs() < 1e-9);
        assert!((w.shear.unwrap() / f.log_shear(y, k) - 1.0).abs() < 1e-9 && w.share > 1.0 - 1e-12);
    }
    let mut mean = WallLayer::new(WallFunctions { shear: WallShear::Mean, ..f });
    mean.update(&rows, &[k, k, 5.0], nu, Scale::Omega).unwrap();
    assert!(mean.cells.iter().all(|w| (w.shear.unwrap() * 2.0 * y / u_t - 1.0).abs() < 1e-14));
    let statistics = layer.y_plus(&rows, nu, 0.0);
    assert!((statistics.mean / y_plus - 1.0).abs() < 1e-12 && statistics.rows == 3);
    let bad = layer.update(&[WallRow { cell: 9, y, ..WallRow::default() }], &[k; 3], nu, Scale::Omega);
    assert!(matches!(bad, Err(SolveError::Value { .. })));
}

/// k of a flow that has sped up by a fourth is still that of before: the velocity has its share in the friction, unless a row knows it.
#[test]
fn friction_is_shared_by_k_and_the_velocity() {
    let f = WallFunctions::default();
    let (nu, y_plus, u_tau) = (1e-5, 80.0, 0.4);
    let (y, k) = (y_plus * nu / u_tau, u_tau * u_tau / 0.3);
    let u_t = 1.25 * u_tau * f.u_plus(1.25 * y_plus);
    let row = WallRow { cell: 0, y, area: 1.0, u_t, ..WallRow::default() };
    let of = |functions: WallFunctions, row: WallRow| {
        let mut layer = WallLayer::new(functions);
        layer.see(&[row], &[k], nu).unwrap();
        layer.update(&[row], &[k], nu, Scale::Omega).unwrap();
        let plus = layer.y_plus(&[row], nu, 0.0).mean;
        ((nu + layer.viscosity[0]) * u_t / y / (u_tau * u_tau), plus / y_plus, layer.cells[0].production)
    };
    let alone = |speed: f64| speed * 1.25 * f.u_plus(1.25 * y_plus) / f.u_plus(speed * y_plus);
    // A logarithmic layer lacks 0.36 of its k.
    let layer: f64 = 1.0 + (1.0 - 1.25_f64.powi(-2)) * 0.25;
    let shared = layer.powf(0.6) * 1.25_f64.powf(0.4);
    for (velocity_weight, layer, speed) in [(0.0, 1.0, 1.0), (0.4, layer, shared), (1.0, layer, 1.25)] {
        let k = layer * layer * k;
        let (found, plus, produced) = of(WallFunctions { velocity_weight, ..f }, row);
        assert!((found / alone(speed) - 1.0).abs() < 1e-9, "{velocity_weight}: {found}");
        assert!((plus * plus / found - 1.0).abs() < 1e-9);
        // As much as that friction produces with the shear of the same share.
        let wanted = speed / layer * f.production(Scale::Omega, f.omega(y, k, nu), k, found * u_tau * u_tau);
        assert!((produced / wanted - 1.0).abs() < 1e-9);
    }
    let known = 1.1 * u_tau * u_tau;
    let (_, plus, produced) = of(f, WallRow { friction: Some(known), ..row });
    assert!((plus * plus - 1.1).abs() < 1e-9);
    let k = layer * layer * k;
    let wanted = shared / layer * f.production(Scale::Omega, f.omega(y, k, nu), k, known);
    assert!((produced / wanted - 1.0).abs() < 1e-9);
}

/// A first cell at y+ of hundreds that the stream has passed before it produced any k has turbulent friction, and produces the k of its layer.
#[test]
fn a_turbulent_first_cell_without_k_produces_it() {
    let f = WallFunctions::default();
    let (nu, u_tau, k) = (1e-6, 0.05, 1e-9);
    for (y_plus, least) in [(3.0, 0.0), (40.0, 0.9), (300.0, 0.999), (3000.0, 0.999)] {
        let y = y_plus * nu / u_tau;
        let row = WallRow { cell: 0, y, area: 1.0, u_t: u_tau * f.u_plus(y_plus), ..WallRow::default() };
        for scale in [Scale::Omega, Scale::Epsilon] {
            let mut layer = WallLayer::new(f);
            layer.see(&[row], &[k], nu).unwrap();
            layer.update(&[row], &[k], nu, scale).unwrap();
            let cell = layer.cells[0];
            let stress = (nu + layer.viscosity[0]) * row.u_t / y;
            if least == 0.0 {
                // In a resolved sublayer the stress is that of the fluid.
                assert!((stress / (nu * row.u_t / y) - 1.0).abs() < 1e-3 && cell.production < 1e-9);
                continue;
            }
            assert!(stress > least * u_tau * u_tau, "{y_plus}: {stress}");
            assert!(cell.k > least * least * u_tau * u_tau / 0.3, "{y_plus}: {}", cell.k);
            // Production by the shear of the logarithmic layer.
            let produced = cell.production / (u_tau.powi(3) / (f.kappa * y));
            assert!((0.8 * least..1.15).contains(&produced), "{y_plus} {scale:?}: {produced}");
        }
    }
}

/// A row that sees the flow elsewhere has the friction of there; half of the model's own equations go half in.
#[test]
fn rows_may_see_the_flow_elsewhere() {
    let f = WallFunctions::default();
    let (nu, u_tau) = (1e-5, 0.4);
    let (y, far) = (40.0 * nu / u_tau, 120.0 * nu / u_tau);
    let (u_far, k) = (u_tau * f.u_plus(120.0), u_tau * u_tau / 0.3);
    let seen = Some(WallPoint { y: far, u_t: u_far, k });
    let row = WallRow {
        cell: 0,
        y,
        area: 1.0,
        u_t: u_far * y / far,
        shear: Some(u_far / far),
        seen,
        ..WallRow::default()
    };
    let rows = [row, WallRow { cell: 1, free: 0.25, ..row }];
    let mut layer = WallLayer::new(f);
    layer.see(&rows, &[k; 2], nu).unwrap();
    assert!(((nu + layer.viscosity[0]) * u_far / far / (u_tau * u_tau) - 1.0).abs() < 1e-12);
    layer.update(&rows, &[k; 2], nu, Scale::Omega).unwrap();
    // Known before the update, so that the production is right at once.
    let production = 0.3 * u_tau * u_tau * layer.pins[0].1;
    assert!((layer.cells[0].production / production - 1.0).abs() < 1e-9);
    // The slope of the logarithmic law at the cell, not that of the line.
    assert!((layer.cells[0].shear.unwrap() / f.log_shear(y, k) - 1.0).abs() < 1e-6);
    assert_eq!((layer.pins.len(), layer.blends.len()), (1, 1));
    let (cell, weight, value) = layer.blends[0];
    assert!((cell, weight) == (1, 0.75) && value == layer.pins[0].1);
    // Other rows: ν_t on the wall is theirs, not none.
    layer.see(&rows[1..], &[k; 2], nu).unwrap();
    assert!(layer.viscosity.len() == 1 && layer.viscosity[0] > nu);
    assert!((layer.y_plus(&rows[1..], nu, 0.0).mean / 120.0 - 1.0).abs() < 1e-9);
}

/// Cells in solids, and such as have come out of one.
#[test]
fn cells_in_solids_hold_nothing_and_are_filled_when_they_come_out() {
    let mut model = KOmegaSst::new(Sst::default(), 4, INFLOW).unwrap();
    model.set(&[1.0, 2.0, 3.0, 4.0], &[10.0, 20.0, 30.0, 40.0]).unwrap();
    assert!(model.wants_walls() && !().wants_walls());
    model.immerse(&[3, 1], &[]);
    assert!(model.k()[1] < 1e-29 && model.scale()[1] == 30.0 && model.nu_t()[3] == 0.0);
    model.immerse(&[3], &[(1, vec![0, 2])]);
    assert_eq!((model.k()[1], model.scale()[1], model.nu_t()[1]), (2.0, 20.0, 0.1));
    // With nothing around that tells, it stays what it is.
    model.immerse(&[], &[(3, vec![])]);
    assert!(model.k()[3] < 1e-29);
}

#[test]
fn bad_input_is_an_error() {
    let new = |law: Wilcox, inflow| KOmega::new(law, 3, inflow).map(|_| ());
    assert!(new(Wilcox { beta: 0.0, ..Wilcox::default() }, INFLOW).is_err());
    assert!(new(Wilcox::default(), Inflow { k: -1.0, ..INFLOW }).is_err());
    assert!(new(Wilcox::default(), Inflow { omega: f64::NAN, ..INFLOW }).is_err());
    let mut model = KOmega::new(Wilcox::default(), 3, INFLOW).unwrap();
    assert!(model.set(&[1.0; 2], &[1.0; 3]).is_err() && model.set(&[0.0; 3], &[1.0; 3]).is_err());
    model.set(&[3.0; 3], &[2.0; 3]).unwrap();
    assert_eq!(model.nu_t(), [1.5; 3]);
    let other = model.correct(&mut Uniform::new([[0.0; 3]; 3], 2), &[], 1e-5, None);
    assert!(matches!(other, Err(SolveError::Length { expected: 2, found: 3, .. })));
    let controls = Controls { relax_k: 1.5, ..Controls::default() };
    assert!(KOmega::new(Wilcox::default(), 3, INFLOW).unwrap().with_controls(controls).is_err());
}

#[test]
fn a_checkpoint_goes_on_as_if_nothing_had_been() {
    let mut flow = Uniform::new([[0.0, 2.0, 0.0], [0.0; 3], [0.0; 3]], 2);
    let mut model = KOmegaSst::new(Sst::default(), 2, INFLOW).unwrap();
    let mut step = |model: &mut KOmegaSst| model.correct(&mut flow, &[], 1e-5, Some(0.1)).unwrap();
    step(&mut model);
    let mut saved = Vec::new();
    model.save(&mut |name, list| saved.push((name.to_owned(), list.to_vec())));
    let mut other = KOmegaSst::new(Sst::default(), 2, INFLOW).unwrap();
    let find = |name: &str| saved.iter().find(|(n, _)| n == name).map(|(_, l)| l.as_slice());
    other.restore(&find).unwrap();
    step(&mut model);
    step(&mut other);
    assert_eq!((model.k(), model.scale(), model.nu_t()), (other.k(), other.scale(), other.nu_t()));
}

fn all_positive<L: Law>(law: L, g: [[f64; 3]; 3], inflow: Inflow, rows: &[WallRow]) -> bool {
    let mut flow = Uniform::new(g, 2);
    flow.distance = vec![1e-3, 2.0];
    let mut model = TwoEquation::new(law, 2, inflow).unwrap();
    [None, Some(1e-2), None].into_iter().all(|dt| {
        model.correct(&mut flow, rows, 1e-5, dt).unwrap();
        let lists = [model.k(), model.scale(), model.nu_t()];
        lists.into_iter().flatten().all(|v| v.is_finite() && *v >= 0.0)
            && model.wall_viscosity().iter().all(|v| v.is_finite() && *v >= 0.0)
            && model.floored() == 0
    })
}

proptest! {
    /// Whatever the strain, the state and the wall, k, ω, ε and ν_t are positive, and nothing had to be set.
    #[test]
    fn positivity(
        g in prop::array::uniform3(prop::array::uniform3(-1e4..1e4f64)),
        k in -8.0..3.0f64, omega in -3.0..7.0f64, u_t in 0.0..100.0f64, y in -7.0..-1.0f64,
    ) {
        let inflow = Inflow { k: 10f64.powf(k), omega: 10f64.powf(omega) };
        let rows = [WallRow { cell: 0, y: 10f64.powf(y), area: 1.0, u_t, ..WallRow::default() }];
        prop_assert!(all_positive(Wilcox::default(), g, inflow, &rows));
        prop_assert!(all_positive(StandardKEpsilon::default(), g, inflow, &rows));
        prop_assert!(all_positive(Realizable::default(), g, inflow, &rows));
        prop_assert!(all_positive(Sst::default(), g, inflow, &rows));
    }
}

#[test]
fn a_model_starts_from_what_another_has() {
    let inflow = |k: f64| Inflow::from_length(1.0, k, 0.07).unwrap();
    let known = KOmegaSst::new(Sst::default(), 4, inflow(0.1)).unwrap();
    let mut model = KOmegaSst::new(Sst::default(), 4, inflow(0.02)).unwrap();
    let mut state: Vec<Vec<f64>> = known.cell_state().into_iter().map(<[f64]>::to_vec).collect();
    // SST's ν_t may be less than k/ω.
    state[2].iter_mut().for_each(|nu| *nu *= 0.5);
    model.set_cell_state(&state).unwrap();
    assert_eq!(model.k(), known.k());
    assert_eq!(model.nu_t(), state[2]);
    let refused = model.set_cell_state(&state[..2]).unwrap_err();
    assert!(refused.to_string().contains("give three"), "{refused}");
    state[0][1] = -1.0;
    let refused = model.set_cell_state(&state).unwrap_err();
    assert!(refused.to_string().contains("-1"), "{refused}");
    state[0][1] = 1.0;
    state[2].pop();
    assert!(matches!(model.set_cell_state(&state), Err(SolveError::Length { expected: 4, found: 3, .. })));
}
