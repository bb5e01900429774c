//! Wall distances and wall rows of bodies in a flow, as a turbulence model on `fv-mesh` gets them.
use siltflow::dem::Disc;
use siltflow::flow::{Axis, CartesianGrid, CellTransport, Fluid, Projection, Side, Sides, TransportParams};
use siltflow::ibm::{WallCell, WallDistance, WallRows};
use siltflow::interfaces::{BodyId, Kinematics, Transport, Vector};
use validation::prescribed_bodies::PrescribedBodies;

const CENTRE: [f64; 2] = [0.13, 0.47];
const RADIUS: f64 = 0.2;
const SHEAR: f64 = 3.0;

/// A disc that turns, across a periodic side of a channel in linear shear, on axes that are stretched: distances and rows are in the
/// order of the flow's cells, and exact. Filling rows allocates nothing, nor does anything else while bodies are at rest.
#[test]
fn a_turbulence_model_gets_distances_and_rows() {
    let axes = [Axis::uniform(60, 0.0, 1.0), Axis::geometric(57, 0.0, 1.0, 1.008)].map(Result::unwrap);
    let grid = CartesianGrid::from_axes(axes).unwrap();
    let sides = [Side::Periodic.both(), Side::WALL.both()];
    let mut flow =
        Projection::new(grid.clone(), sides.clone(), Fluid { density: 1.0, viscosity: 1e-3 }).unwrap();
    flow.set_velocity(|x| [SHEAR * x[1], 0.0]);
    let sides = Sides::new(sides).unwrap();
    let bodies =
        PrescribedBodies::default().with(Disc::new(RADIUS).unwrap(), [CENTRE[0], CENTRE[1], 0.0], 2.0);
    let lattice = grid.lattice(None, &sides);

    let mut cells = CellTransport::new(&grid, &sides, TransportParams::default()).unwrap();
    let mut distance = WallDistance::new();
    distance.update(&lattice, &bodies).unwrap();
    for (nearest, body) in cells.wall_distance_mut().iter_mut().zip(distance.values()) {
        *nearest = nearest.min(*body);
    }
    let away = |c: usize| {
        let [x, y] = grid.centre(grid.cell(c));
        let x = x - CENTRE[0];
        Vector::new(x - x.round(), y - CENTRE[1], 0.0)
    };
    let transport = cells.on(flow.velocity()).unwrap();
    for (c, d) in transport.wall_distance().iter().enumerate() {
        let y = grid.centre(grid.cell(c))[1];
        let exact = (away(c).norm() - RADIUS).max(0.0).min(y).min(1.0 - y);
        assert!((d - exact).abs() < 1e-14, "{c}: {d} {exact}");
    }

    let mut rows = WallRows::new();
    rows.place(&lattice, &bodies).unwrap();
    let velocity = [0, 1].map(|c| flow.centred_velocity(c).collect::<Vec<_>>());
    let turning = |w: &WallCell| bodies.twist(w.body).at(w.foot);
    let mut again = || {
        distance.update(&lattice, &bodies).unwrap();
        rows.place(&lattice, &bodies).unwrap();
        rows.fill(&[&velocity[0], &velocity[1]], Some(&velocity[0]), 1e-3, turning).unwrap().len()
    };
    let n = again();
    assert!(n > 60, "{n}");
    let counted = allocation_counter::measure(|| assert_eq!(again(), n));
    assert_eq!(counted.count_total, 0);
    for (row, cell) in rows.rows().iter().zip(rows.cells(BodyId(0))) {
        let out = away(row.cell).normalize();
        let along = Vector::new(-out.y, out.x, 0.0);
        let relative = |x: Vector| (SHEAR * (CENTRE[1] + x.y) * along.x - 2.0 * RADIUS).abs();
        assert!((row.y - (away(row.cell).norm() - RADIUS)).abs() < 1e-14);
        assert!((row.u_t - relative(away(row.cell))).abs() < 1e-13 && (cell.normal - out).norm() < 1e-14);
        for point in row.points {
            let point = point.unwrap();
            assert!((point.u_t - relative(out * (RADIUS + point.y))).abs() < 1e-13);
        }
    }
    let area: f64 = rows.rows().iter().map(|row| row.area).sum();
    assert!((area / (2.0 * std::f64::consts::PI * RADIUS) - 1.0).abs() < 1e-6, "{area}");
}
