//! The friction that a closure gives walls.
use fv_mesh::{
    Axis, CartesianGrid, Cluster, Fluid, Hooks, Modelled, Projection, Side, Simple, TransportParams,
};
use interfaces::{Closure, SolveError, Transport, WallRow};

const NU: f64 = 0.1;
/// On walls, in units of ν.
const ON_WALLS: [f64; 2] = [3.0, 0.5];
const LID: f64 = 0.7;
const FORCE: f64 = 0.8;

/// ν_t = ν in the fluid; on the lower and upper wall as above.
#[derive(Default)]
struct Given {
    eddy: Vec<f64>,
    on_walls: Vec<f64>,
}

impl Closure for Given {
    fn eddy_viscosity(&self) -> Option<&[f64]> {
        (!self.eddy.is_empty()).then_some(&self.eddy)
    }
    fn wall_viscosity(&self) -> &[f64] {
        &self.on_walls
    }
    fn correct(
        &mut self,
        flow: &mut dyn Transport,
        walls: &[WallRow],
        nu: f64,
        _: Option<f64>,
    ) -> Result<(), SolveError> {
        self.eddy.resize(flow.n_cells(), nu);
        // Rows of the lower wall come first.
        let lower = walls.len() / 2;
        self.on_walls.clear();
        self.on_walls.extend((0..walls.len()).map(|i| nu * ON_WALLS[usize::from(i >= lower)]));
        Ok(())
    }
}

/// Two walls, the upper one moving: ν_eff u'' = −f between the centres of the outermost cells, where (1 + r) ν u/y is the stress.
fn profile(y: [f64; 2]) -> impl Fn(f64) -> f64 {
    let [a, b] = [(1.0 + ON_WALLS[0]) * NU / y[0], (1.0 + ON_WALLS[1]) * NU / y[1]];
    // u = c₀ + c₁ x − f x²/(4ν) between x = 0 and 1; what passes x = 0 is a u(y₀), what passes x = 1 is b (u(1 − y₁) − lid).
    let curve = |x: f64| -FORCE * x * x / (4.0 * NU);
    let slope = |x: f64| -FORCE * x / (2.0 * NU);
    // 2ν (c₁ + slope(0)) = a (c₀ + c₁ y₀ + curve(y₀)); −2ν (c₁ + slope(1)) = b (c₀ + c₁ (1 − y₁) + curve(1 − y₁) − lid).
    let (x0, x1) = (y[0], 1.0 - y[1]);
    let (m, r) = (
        [[a, a * x0 - 2.0 * NU], [b, b * x1 + 2.0 * NU]],
        [2.0 * NU * slope(0.0) - a * curve(x0), -2.0 * NU * slope(1.0) - b * (curve(x1) - LID)],
    );
    let det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    let (c0, c1) = ((r[0] * m[1][1] - m[0][1] * r[1]) / det, (m[0][0] * r[1] - m[1][0] * r[0]) / det);
    move |x| c0 + c1 * x + curve(x)
}

fn setting(n: usize) -> (CartesianGrid<2>, [[Side; 2]; 2], Fluid) {
    let y = Axis::tanh(n, 0.0, 1.0, 1.2, Cluster::Both).unwrap();
    let grid = CartesianGrid::from_axes([Axis::uniform(3, 0.0, 0.4).unwrap(), y]).unwrap();
    let sides = [Side::Periodic.both(), [Side::WALL, Side::Wall([LID, 0.0, 0.0])]];
    (grid, sides, Fluid { density: 1.3, viscosity: NU })
}

fn error(grid: &CartesianGrid<2>, u: impl Fn(usize) -> f64) -> f64 {
    let n = grid.cells()[1];
    let exact = profile([grid.axis(1).centre(0), 1.0 - grid.axis(1).centre(n - 1)]);
    (0..n).map(|j| (u(j) - exact(grid.axis(1).centre(j))).abs()).fold(0.0, f64::max)
}

#[test]
fn steady_flow_feels_the_friction_that_the_model_says() {
    let errors = [12, 24].map(|n| {
        let (grid, sides, fluid) = setting(n);
        let mut flow = Simple::new(grid.clone(), sides, fluid).unwrap();
        let mut model =
            Modelled::new(Given::default(), &grid, flow.sides(), TransportParams::default()).unwrap();
        flow.set_force([FORCE, 0.0]);
        flow.solve_with(&mut model, 4000, 1e-10).unwrap();
        let u = flow.velocity().field(0);
        let row = model.wall_rows()[0];
        assert!((row.u_t - u.row(0)[0]).abs() < 1e-9 && row.y == grid.axis(1).centre(0));
        // The walls carry the whole force.
        let friction: f64 = (model.wall_rows().iter().zip(model.closure.wall_viscosity()))
            .map(|(w, nu_t)| w.area * (NU + nu_t) * w.u_t / w.y * w.tangent.x)
            .sum();
        assert!((friction - 0.4 * FORCE).abs() < 1e-7, "{friction}");
        error(&grid, |j| u.row(j)[1])
    });
    let order = (errors[0] / errors[1]).log2();
    assert!(errors[1] < 2e-3 && order > 1.8, "{errors:?} {order}");
}

#[test]
fn a_flow_in_time_ends_in_the_steady_one() {
    let (grid, sides, fluid) = setting(12);
    let mut steady = Simple::new(grid.clone(), sides.clone(), fluid).unwrap();
    let sides_of = fv_mesh::Sides::new(sides.clone()).unwrap();
    let modelled = || Modelled::new(Given::default(), &grid, &sides_of, TransportParams::default()).unwrap();
    let mut model = modelled();
    steady.set_force([FORCE, 0.0]);
    steady.solve_with(&mut model, 4000, 1e-10).unwrap();
    let mut flow = Projection::new(grid.clone(), sides, fluid).unwrap();
    let mut hooks = Hooks::none().with_body_force([FORCE, 0.0]).with_closure(modelled());
    while flow.time() < 25.0 {
        flow.advance_with(1e-3, &mut hooks).unwrap();
    }
    let [a, b] = [flow.velocity(), steady.velocity()].map(|v| v.field(0).values().collect::<Vec<_>>());
    let apart = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-6, "{apart}");
}
