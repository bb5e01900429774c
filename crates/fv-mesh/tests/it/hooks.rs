//! Body forces, buoyancy, closures, scalars.
use crate::norms;
use fv_mesh::{
    Axis, Boussinesq, CartesianGrid, Cluster, Fluid, ForceField, Hooks, Modelled, Projection, Scalar,
    ScalarSide, Side, TransportParams,
};
use interfaces::{Closure, SolveError, Transport, Vector, VelocityField, WallRow};
use std::f64::consts::TAU;

fn vortices(nu: f64) -> Projection<2> {
    let grid = CartesianGrid::new([24, 20], [TAU, TAU]).unwrap();
    let fluid = Fluid { density: 1.5, viscosity: nu };
    let mut flow = Projection::new(grid, Side::Periodic.everywhere(), fluid).unwrap();
    flow.set_velocity(|x| [-x[0].cos() * x[1].sin() + 0.3, x[0].sin() * x[1].cos()]);
    flow
}

fn difference(a: &Projection<2>, b: &Projection<2>) -> f64 {
    let pairs = (0..2).flat_map(|c| a.velocity().component(c).iter().zip(b.velocity().component(c)));
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn empty_hooks_change_no_bit() {
    assert_eq!(size_of::<Hooks>(), 0);
    let (mut plain, mut hooked) = (vortices(0.01), vortices(0.01));
    for _ in 0..20 {
        plain.advance(0.02, [0.0; 2]).unwrap();
        hooked.advance_with(0.02, &mut Hooks::none()).unwrap();
    }
    assert_eq!(difference(&plain, &hooked), 0.0);
}

#[test]
fn a_force_field_that_is_uniform_is_the_uniform_force() {
    let (mut plain, mut hooked) = (vortices(0.01), vortices(0.01));
    let mut hooks = Hooks::none().with_body_force(ForceField(|_, t: f64| [0.2 + t, -0.1]));
    for _ in 0..20 {
        // The field is extrapolated like all that is explicit: the force of the middle of the step.
        let t = plain.time();
        let middle = if plain.steps() == 0 { t } else { t + 0.01 };
        plain.advance(0.02, [0.2 + middle, -0.1]).unwrap();
        hooked.advance_with(0.02, &mut hooks).unwrap();
    }
    assert!(difference(&plain, &hooked) < 1e-13, "{}", difference(&plain, &hooked));
}

/// A closure with one eddy viscosity everywhere.
struct Uniform(Vec<f64>);
impl Closure for Uniform {
    fn eddy_viscosity(&self) -> Option<&[f64]> {
        Some(&self.0)
    }
    fn correct(
        &mut self,
        flow: &mut dyn Transport,
        _: &[WallRow],
        _: f64,
        _: Option<f64>,
    ) -> Result<(), SolveError> {
        let mut strain = vec![0.0; flow.n_cells()];
        flow.strain_rate(&mut strain)?;
        assert!(strain.iter().all(|s| s.is_finite()));
        Ok(())
    }
}

/// A refused step leaves nothing behind.
#[test]
fn a_force_is_not_felt_twice_after_a_refused_step() {
    let (mut tried, mut plain) = (vortices(0.01), vortices(0.01));
    let field = || Hooks::none().with_body_force(ForceField(|x: [f64; 2], _t: f64| [x[1].sin(), 0.0]));
    assert!(tried.advance_with(-1.0, &mut field()).is_err());
    let n = tried.grid().n_cells();
    let modelled =
        Modelled::new(Uniform(vec![1e3; n]), tried.grid(), tried.sides(), TransportParams::default())
            .unwrap();
    assert!(tried.advance_with(0.02, &mut field().with_closure(modelled)).is_err());
    for _ in 0..3 {
        tried.advance_with(0.02, &mut field()).unwrap();
        plain.advance_with(0.02, &mut field()).unwrap();
    }
    assert_eq!(difference(&tried, &plain), 0.0);
    let short =
        Modelled::new(Uniform(vec![1e-3; n - 1]), tried.grid(), tried.sides(), TransportParams::default())
            .unwrap();
    let error = tried.advance_with(0.02, &mut Hooks::none().with_closure(short)).unwrap_err().to_string();
    assert!(error.contains("480 cells"), "{error}");
}

#[test]
fn a_uniform_eddy_viscosity_is_a_viscosity() {
    // ∇·(∇u)ᵀ is a gradient times div u = 0: in a box without walls the discrete operators agree to round-off.
    let (mut thick, mut thin) = (vortices(0.05), vortices(0.02));
    let closure = Uniform(vec![0.03; thin.grid().n_cells()]);
    let modelled = Modelled::new(closure, thin.grid(), thin.sides(), TransportParams::default()).unwrap();
    let mut hooks = Hooks::none().with_closure(modelled);
    thick.project(1.0).unwrap();
    thin.project(1.0).unwrap();
    for _ in 0..20 {
        thick.advance(0.02, [0.0; 2]).unwrap();
        thin.advance_with(0.02, &mut hooks).unwrap();
    }
    assert!(difference(&thick, &thin) < 1e-13, "{}", difference(&thick, &thin));
}

fn heated(ra: f64, n: usize) -> (Projection<2>, Scalar<2>, Boussinesq) {
    // De Vahl Davis' square: Pr 0.71, ν and κ from Ra with β g ΔT H³ = 1.
    let (pr, grid) = (0.71_f64, CartesianGrid::new([n, n], [1.0, 1.0]).unwrap());
    let (nu, kappa) = ((pr / ra).sqrt(), 1.0 / (pr * ra).sqrt());
    let flow = Projection::new(grid.clone(), Side::WALL.everywhere(), Fluid { density: 1.0, viscosity: nu })
        .unwrap();
    let sides = [
        [ScalarSide::value(1.0), ScalarSide::value(0.0)],
        [ScalarSide::NO_GRADIENT, ScalarSide::NO_GRADIENT],
    ];
    let scalar = Scalar::new(&grid, sides, kappa).unwrap();
    let buoyancy = Boussinesq { expansion: 1.0, reference: 0.5, gravity: Vector::new(0.0, -1.0, 0.0) };
    (flow, scalar, buoyancy)
}

#[test]
fn natural_convection_in_a_square_carries_the_heat_of_the_benchmark() {
    // De Vahl Davis 1983, Ra 10⁴: mean Nusselt number 2.243, largest u 16.178 κ/H.
    let n = 40;
    let (mut flow, scalar, body_force) = heated(1e4, n);
    let mut hooks = Hooks::none().with_body_force(body_force).with_scalars(scalar);
    while flow.time() < 60.0 {
        let dt = flow.stable_dt(0.4).min(0.02);
        flow.advance_with(dt, &mut hooks).unwrap();
    }
    let phi = hooks.scalars.field();
    let flux: f64 = (0..n).map(|j| (1.0 - phi.row(j)[0]) * 2.0 * n as f64 / n as f64).sum();
    assert!((flux / 2.243 - 1.0).abs() < 0.015, "{flux}");
    let fastest = norms::velocity(&flow, |_| [0.0; 2]).linf;
    let unit = hooks.scalars.diffusivity();
    // The largest component is v, 19.617 κ/H.
    assert!((fastest / unit / 19.617 - 1.0).abs() < 0.01, "{}", fastest / unit);
}

#[test]
fn stratified_fluid_stays_at_rest() {
    let (mut flow, _, body_force) = heated(1e4, 12);
    let sides = [
        [ScalarSide::NO_GRADIENT, ScalarSide::NO_GRADIENT],
        [ScalarSide::value(0.0), ScalarSide::value(1.0)],
    ];
    let mut scalar = Scalar::new(flow.grid(), sides, 1e-3).unwrap();
    scalar.set(|x| x[1]);
    let mut hooks = Hooks::none().with_body_force(body_force).with_scalars(vec![scalar]);
    for _ in 0..50 {
        flow.advance_with(0.01, &mut hooks).unwrap();
    }
    assert!(norms::velocity(&flow, |_| [0.0; 2]).linf < 1e-14);
}

/// An eddy viscosity that is large where cells are wide: the limit of a step is that of the cells, not that of the largest ν_t in the
/// thinnest of them; at the limit noise dies, however rough the viscosity is.
#[test]
fn eddies_limit_the_step_where_they_are() {
    let y = Axis::tanh(32, 0.0, 1.0, 2.0, Cluster::Both).unwrap();
    let grid = CartesianGrid::from_axes([Axis::uniform(24, 0.0, 1.0).unwrap(), y]).unwrap();
    let sides = [Side::Periodic.both(), Side::WALL.both()];
    let mut flow = Projection::new(grid, sides, Fluid { density: 1.0, viscosity: 1e-9 }).unwrap();
    let mut state = 3_u64;
    let mut noise = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    let eddy: Vec<f64> = (0..flow.grid().n_cells())
        .map(|i| {
            let y = flow.grid().centre(flow.grid().cell(i))[1];
            (y * (1.0 - y)).powi(2) * (1.0 + noise()) + 1e-6
        })
        .collect();
    let most = eddy.iter().copied().fold(0.0, f64::max);
    // So shaky a function of the place that it is noise.
    let rough = |s: f64| 1e-6 * (1e5 * s).sin();
    flow.set_velocity(|[x, y]| [rough(x + 3.1 * y), rough(1.7 * x - y)]);
    let closure =
        Modelled::new(Uniform(eddy), flow.grid(), flow.sides(), TransportParams::default()).unwrap();
    let mut hooks = Hooks::none().with_closure(closure);
    flow.advance_with(1e-6, &mut hooks).unwrap();
    let thinnest = flow.grid().axis(1).faces()[1];
    let of_all = 0.25 / (most * (24.0_f64.powi(2) + thinnest.powi(-2)));
    assert!(flow.viscous_limit() > 4.0 * of_all, "{} {of_all}", flow.viscous_limit());
    let mut energy = flow.statistics().kinetic_energy;
    let first = energy;
    for _ in 0..300 {
        flow.advance_with(flow.viscous_limit(), &mut hooks).unwrap();
        let now = flow.statistics().kinetic_energy;
        assert!(now <= energy, "{now} {energy}");
        energy = now;
    }
    assert!(energy < 0.1 * first, "{energy} {first}");
}
