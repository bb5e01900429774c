//! Scalars in steady flow beside immersed walls.
use siltflow::flow::{Convection, Fluid, Scalar, ScalarSide, Settling, Side, Simple, WallStress};
use siltflow::ibm::{StaticBodies, cut_cells};
use turb::Sst;
use validation::developed_duct::DevelopedDuct;
use validation::turned_ducts::TurnedDucts;

/// What gains per time what the force gives the flow, and is conducted and mixed as momentum, is the velocity, wherever walls lie on the grid; and they take all of it: what
/// passes through cells without fluid at their centre is not lost there. (It was, so that nothing came to rest but along the grid.)
#[test]
fn heat_in_ducts_across_the_grid_is_the_velocity() {
    for (angle, most) in [(0.0, 0.015), (15.0, 0.025), (30.0, 0.02), (45.0, 0.02)] {
        let mut duct = DevelopedDuct::new(Sst::default(), angle, 20, 0.3, 1e-6, 2.5e-3).unwrap();
        let [taken, off] = duct.analogy().unwrap();
        assert!((taken - 1.0).abs() < 1e-3 && off.abs() < most, "{angle}: {taken} {off}");
    }
}

/// At y+ 45 the velocity is not steepened by what carries it, where the layer is several cells thick (−16 % when it was): k would then be too high and mix too much.
#[test]
fn heat_across_the_grid_where_the_logarithmic_layer_begins() {
    let mut duct = DevelopedDuct::new(Sst::default(), 45.0, 40, 0.3, 1e-5, 3.9e-3).unwrap();
    let [taken, off] = duct.analogy().unwrap();
    assert!((taken - 1.0).abs() < 1e-3 && off.abs() < 0.1, "{taken} {off}");
}

/// The same of laminar flow: of second order, and the parabola to 1.2 % with 20 cells.
#[test]
fn heat_in_laminar_ducts_across_the_grid_is_a_parabola() {
    let error = |angle: f64, cells: usize| {
        let (ducts, grid) = TurnedDucts::new(1.0, f64::to_radians(angle), 1.0 / cells as f64, 0.3).unwrap();
        let sides = [Side::Periodic.both(), Side::Periodic.both()];
        let mut flow = Simple::new(grid.clone(), sides, Fluid { density: 1.0, viscosity: 0.05 }).unwrap();
        flow = flow.with_convection(Convection::Quick);
        let cuts = cut_cells(flow.velocity(), &StaticBodies::new().with(ducts, ducts.pose())).unwrap();
        flow.set_walls(Some((&cuts, WallStress::NoSlip))).unwrap();
        let along = ducts.along();
        flow.set_force(along.map(|x| 0.4 * x));
        flow.set_velocity(|_| along.map(|x| 0.6667 * x));
        flow.solve(4000, 1e-9).unwrap();
        let periodic = [ScalarSide::Periodic.both(), ScalarSide::Periodic.both()];
        let mut heat = Scalar::new(&grid, periodic, 0.05).unwrap().with_convection(Convection::Quick);
        heat.set_walls(Some((&cuts, 0.0))).unwrap();
        heat.source_mut().data_mut().fill(0.4);
        let settling = Settling { tolerance: 1e-10, max_iterations: 10_000 };
        heat.settle(flow.velocity(), 0.0, settling, &[], |_| ()).unwrap();
        let mut sum = [0.0; 2];
        for i in 0..grid.n_cells() {
            let ([a, b], x) = (grid.cell(i), grid.centre(grid.cell(i)));
            if ducts.distance(x) > 0.0 {
                let y = ducts.height_of(x);
                let exact = 4.0 * y * (1.0 - y);
                sum = [sum[0] + (heat.field().row(b)[a] - exact).powi(2), sum[1] + exact * exact];
            }
        }
        let taken = -heat.given_off().unwrap() / (0.4 * ducts.open_area(&flow, &cuts));
        assert!((taken - 1.0).abs() < 1e-5, "{angle} {cells}: {taken}");
        (sum[0] / sum[1]).sqrt()
    };
    for angle in [0.0, 15.0, 30.0, 45.0] {
        let [coarse, fine] = [10, 20].map(|cells| error(angle, cells));
        println!("{angle}: {coarse} {fine}");
        assert!(fine < 0.012 && fine < 0.35 * coarse, "{angle}: {coarse} {fine}");
    }
}

#[test]
fn walls_of_a_scalar_want_a_friction_velocity_each() {
    let (ducts, grid) = TurnedDucts::new(1.0, 0.0, 0.1, 0.3).unwrap();
    let sides = [Side::Periodic.both(), Side::Periodic.both()];
    let flow = Simple::new(grid.clone(), sides, Fluid { density: 1.0, viscosity: 1e-3 }).unwrap();
    let cuts = cut_cells(flow.velocity(), &StaticBodies::new().with(ducts, ducts.pose())).unwrap();
    let periodic = [ScalarSide::Periodic.both(), ScalarSide::Periodic.both()];
    let mut heat = Scalar::new(&grid, periodic, 1e-3).unwrap();
    heat.set_walls(Some((&cuts, 0.0))).unwrap();
    heat.rub(&vec![0.1; cuts.walls.len()], 1e-3).unwrap();
    let error = heat.rub(&[0.1; 3], 1e-3).unwrap_err().to_string();
    assert!(error.contains("friction velocities") && error.contains('3'), "{error}");
}
