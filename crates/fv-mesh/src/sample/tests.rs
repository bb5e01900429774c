//! Samples and integrals against what they approximate.
use super::{Probes, SampleError, Sampler};
use crate::{
    Axis, CartesianGrid, Cluster, Field, Fluid, GridMismatch, Integrals, Projection, Side, Sides, Velocity,
};
use std::f64::consts::TAU;

const FLUID: Fluid = Fluid { density: 1.0, viscosity: 0.01 };

fn walls<const D: usize>() -> Sides<D> {
    Sides::new(Side::WALL.everywhere()).unwrap()
}

fn stretched(n: usize) -> CartesianGrid<3> {
    box_of([n, n + 3, n + 1])
}

fn box_of([nx, ny, nz]: [usize; 3]) -> CartesianGrid<3> {
    let axes = [
        Axis::tanh(nx, -1.0, 1.0, 1.4, Cluster::Both),
        Axis::tanh(ny, 0.0, 2.0, 1.2, Cluster::Lower),
        Axis::tanh(nz, 1.0, 1.5, 1.0, Cluster::Upper),
    ];
    CartesianGrid::from_axes(axes.map(Result::unwrap)).unwrap()
}

/// Points that fill a box, corners, edges and sides included.
fn points<const D: usize>(grid: &CartesianGrid<D>, per_axis: usize) -> Vec<[f64; D]> {
    (0..per_axis.pow(D as u32))
        .map(|index| {
            std::array::from_fn(|a| {
                let i = index / per_axis.pow(a as u32) % per_axis;
                let axis = grid.axis(a);
                if i == per_axis - 1 {
                    axis.upper()
                } else {
                    axis.lower() + axis.length() * i as f64 / (per_axis - 1) as f64
                }
            })
        })
        .collect()
}

#[test]
fn linear_fields_are_exact_up_to_the_walls() {
    let grid = stretched(7);
    let linear = |x: [f64; 3]| 3.0 + x[0] - 2.0 * x[1] + 0.5 * x[2] + x[0] * x[1] * x[2];
    let field = Field::from_fn(&grid, linear);
    let sampler = Sampler::new(&grid, &walls());
    for x in points(&grid, 14) {
        let error = sampler.at(&field, x).unwrap() - linear(x);
        assert!(error.abs() < 1e-13, "{error} at {x:?}");
    }
}

#[test]
fn second_order_up_to_the_walls() {
    let f = |x: [f64; 3]| (2.0 * x[0]).sin() * (1.5 * x[1]).cos() * (3.0 * x[2]).exp().ln_1p();
    let errors = [4, 8, 16].map(|n| {
        let grid = box_of([4 * n, 5 * n, 3 * n]);
        let (field, sampler) = (Field::from_fn(&grid, f), Sampler::new(&grid, &walls()));
        let error = |x: [f64; 3]| (sampler.at(&field, x).unwrap() - f(x)).abs();
        let inside = points(&grid, 17).into_iter().map(error).fold(0.0, f64::max);
        let wall = points(&grid, 17)
            .into_iter()
            .map(|mut x| {
                x[1] = 0.0;
                error(x)
            })
            .fold(0.0, f64::max);
        [inside, wall]
    });
    for which in 0..2 {
        let order = (errors[0][which] / errors[2][which]).log2() / 2.0;
        assert!(order > 1.85, "{errors:?}: order {order}");
    }
}

#[test]
fn ghosts_carry_boundary_values() {
    // One cell of 2 between sides at 1: the ghosts hold 0.
    let grid = CartesianGrid::new([1, 4], [1.0, 1.0]).unwrap();
    let mut field = Field::zeros(&grid);
    field.fill(2.0);
    let sampler = Sampler::new(&grid, &walls()).with_ghosts();
    for (x, exact) in [(0.0, 1.0), (0.25, 1.5), (0.5, 2.0), (1.0, 1.0)] {
        assert_eq!(sampler.at(&field, [x, 0.5]).unwrap(), exact);
    }
    // Without them the only cell is all there is.
    let sampler = Sampler::new(&grid, &walls());
    assert_eq!(sampler.at(&field, [0.0, 0.0]).unwrap(), 2.0);
}

#[test]
fn periodic_axes_repeat() {
    let axes = [Axis::tanh(40, 1.0, 2.0, 1.0, Cluster::Both), Axis::uniform(1, 0.0, 1.0)].map(Result::unwrap);
    let grid = CartesianGrid::from_axes(axes).unwrap();
    let sampler = Sampler::new(&grid, &Sides::new(Side::Periodic.everywhere()).unwrap());
    let field = Field::from_fn(&grid, |x| (TAU * x[0]).cos());
    // h²/8 max|f''|.
    let widest = (0..40).map(|i| grid.axis(0).width(i)).fold(0.0, f64::max);
    let bound = (TAU * widest).powi(2) / 8.0;
    for i in 0..200 {
        let x = -1.0 + 0.021 * f64::from(i);
        let value = sampler.at(&field, [x, 7.3]).unwrap();
        assert!((value - (TAU * x).cos()).abs() < bound, "{value} at {x}");
        let again = sampler.at(&field, [x + 3.0, 0.3]).unwrap();
        assert!((value - again).abs() < 1e-12);
    }
    let seam = [1.0, 2.0, 3.0].map(|x| sampler.at(&field, [x, 0.0]).unwrap());
    assert!((seam[0] - seam[1]).abs() < 1e-14 && (seam[1] - seam[2]).abs() < 1e-14);
}

/// A flow between a wall at rest and one that moves at 2 m/s.
fn channel(n: usize, u: impl Fn([f64; 2]) -> [f64; 2]) -> Projection<2> {
    let axes = [Axis::uniform(n, 0.0, 1.0).unwrap(), Axis::tanh(n, -0.5, 0.5, 1.3, Cluster::Both).unwrap()];
    let sides = [Side::Periodic.both(), [Side::WALL, Side::Wall([2.0, 0.0, 0.0])]];
    let mut flow = Projection::new(CartesianGrid::from_axes(axes).unwrap(), sides, FLUID).unwrap();
    flow.set_velocity(u);
    flow
}

#[test]
fn couette_flow_is_exact() {
    let flow = channel(9, |x| [1.0 + 2.0 * x[1], 0.0]);
    let sampler = Sampler::new(flow.grid(), flow.sides());
    for x in points(flow.grid(), 23) {
        let u = sampler.velocity(flow.velocity(), x).unwrap();
        assert!((u[0] - 1.0 - 2.0 * x[1]).abs() < 1e-13 && u[1].abs() < 1e-13, "{u:?} at {x:?}");
    }
    // A sixth of a period on, the same.
    let u = sampler.velocity(flow.velocity(), [17.0 / 6.0, 0.5]).unwrap();
    assert!((u[0] - 2.0).abs() < 1e-13);
}

#[test]
fn velocity_is_second_order_up_to_the_walls() {
    let exact = |x: [f64; 2]| {
        let wave = (TAU * x[0]).sin() * (0.25 - x[1] * x[1]);
        [
            1.0 + 2.0 * x[1] + wave * (1.0 + x[1]),
            (TAU * x[0]).cos() * (TAU * x[1]).cos().mul_add(0.5, 0.5) * x[1].cos(),
        ]
    };
    let errors = [16, 32, 64].map(|n| {
        let flow = channel(n, exact);
        let sampler = Sampler::new(flow.grid(), flow.sides());
        let error = |x: [f64; 2]| {
            let u = sampler.velocity(flow.velocity(), x).unwrap();
            (0..2).map(|c| (u[c] - exact(x)[c]).abs()).fold(0.0, f64::max)
        };
        points(flow.grid(), 53).into_iter().map(error).fold(0.0, f64::max)
    });
    let order = (errors[0] / errors[2]).log2() / 2.0;
    assert!(order > 1.85, "{errors:?}: order {order}");
}

#[test]
fn flux_is_that_of_the_faces() {
    let grid = CartesianGrid::new([12, 10, 8], [1.0, 2.0, 0.5]).unwrap();
    let sides = [Side::Periodic.both(), Side::Periodic.both(), Side::WALL.both()];
    let mut flow = Projection::new(grid.clone(), sides, FLUID).unwrap();
    flow.set_velocity(|x| [0.3 + (TAU * x[0]).sin() * x[2], x[1].cos(), x[0] * x[2]]);
    flow.project(0.1).unwrap();
    let sampler = Sampler::new(&grid, flow.sides());
    let volume_flow = Integrals::new(&grid);
    let mut u = Field::zeros(&grid);
    for (row, values) in (0..u.n_rows()).zip(flow.centred_velocity(0).collect::<Vec<_>>().chunks(12)) {
        let start = u.row_start(row);
        u.data_mut()[start..start + 12].copy_from_slice(values);
    }
    let mean = volume_flow.integral(&u).unwrap();
    for x in [0.0, 0.1, 0.37, 0.99, 1.0, 2.2] {
        let flux = sampler.flux(flow.velocity(), 0, x).unwrap();
        assert!((flux - mean).abs() < 1e-13, "{flux} at {x}, {mean} on average");
    }
    for z in [0.0, 0.31, 0.5] {
        assert!(sampler.flux(flow.velocity(), 2, z).unwrap().abs() < 1e-13);
    }
    let ones = Field::from_fn(&grid, |_| 1.0);
    let convected = sampler.convective_flux(&ones, flow.velocity(), 0, 0.4).unwrap();
    assert!((convected - mean).abs() < 1e-13);
}

#[test]
fn surface_integrals_weight_with_area() {
    let grid = stretched(6);
    let field = Field::from_fn(&grid, |x| 1.0 + x[0] * x[2] + x[1]);
    let sampler = Sampler::new(&grid, &walls());
    // ∫∫ (1 + x z + y) dx dz over [−1, 1]×[1, 1.5].
    for y in [0.0, 0.7, 2.0] {
        let exact = (1.0 + y) * 2.0 * 0.5;
        assert!((sampler.surface_integral(&field, 1, y).unwrap() - exact).abs() < 1e-13);
    }
}

#[test]
fn integrals_and_norms() {
    let grid = stretched(9);
    let over = Integrals::new(&grid);
    let field = Field::from_fn(&grid, |x| 1.0 + x[0] + x[1] * x[2]);
    // Midpoints are exact for multilinear functions: ∫ y z = ∫ y ∫ z · 2.
    let exact = 2.0 * 2.0 * 0.5 + 2.0 * 2.0 * (1.5_f64.powi(2) - 1.0) / 2.0;
    assert!((over.integral(&field).unwrap() - exact).abs() < 1e-13);
    assert!((over.mean(&field).unwrap() - exact / grid.volume()).abs() < 1e-13);
    let constant = over.norms(&field - &field - 2.0).unwrap();
    for norm in [constant.l1, constant.l2, constant.linf] {
        assert!((norm - 2.0).abs() < 1e-14);
    }
    let naive = |f: &dyn Fn(f64) -> f64| -> f64 {
        field.values().enumerate().map(|(i, v)| f(v) * grid.cell_volume(grid.cell(i))).sum::<f64>()
            / grid.volume()
    };
    let norms = over.norms(&field - 2.0).unwrap();
    assert!((norms.l1 - naive(&|v| (v - 2.0).abs())).abs() < 1e-13);
    assert!((norms.l2 - naive(&|v| (v - 2.0) * (v - 2.0)).sqrt()).abs() < 1e-13);
    assert_eq!(norms.linf, field.values().map(|v| (v - 2.0).abs()).fold(0.0, f64::max));
    // Second order for what is not multilinear.
    let error = |n| {
        let grid = stretched(n);
        let f = Field::from_fn(&grid, |x| x[0].exp() * x[1].sin());
        let exact = (1_f64.exp() - (-1_f64).exp()) * (1.0 - 2_f64.cos()) * 0.5;
        (Integrals::new(&grid).integral(&f).unwrap() - exact).abs()
    };
    assert!((error(10) / error(40)).log2() / 2.0 > 1.85);
}

#[test]
fn extremes_know_their_place() {
    let grid = stretched(5);
    let over = Integrals::new(&grid);
    let field = Field::from_fn(&grid, |x| (x[0] - 0.1).powi(2) + x[1] - x[2]);
    let (low, high) = (over.minimum(&field).unwrap(), over.maximum(&field).unwrap());
    assert_eq!((low.cell[1..].to_vec(), high.cell[1..].to_vec()), (vec![0, 5], vec![7, 0]));
    for extreme in [&low, &high] {
        assert_eq!(extreme.x, grid.centre(extreme.cell));
        assert_eq!(field.values().nth(grid.index(extreme.cell)), Some(extreme.value));
    }
    assert!(field.values().all(|v| low.value <= v && v <= high.value));
    let broken = Field::from_expression(&grid, (-&field).sqrt()).unwrap();
    assert!(over.maximum(&broken).unwrap().value.is_nan() && over.integral(&broken).unwrap().is_nan());
    assert!(over.norms(&broken).unwrap().linf.is_nan());
}

#[test]
fn sums_do_not_depend_on_threads() {
    let grid = stretched(37);
    let field = Field::from_fn(&grid, |x| (17.0 * x[0]).sin() + x[1] * x[2]);
    let sums = [1, 2, 5].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| Integrals::new(&grid).norms(&field).unwrap())
    });
    assert!(sums[0] == sums[1] && sums[0] == sums[2]);
}

#[test]
fn lines_planes_and_their_tables() {
    let flow = channel(8, |x| [1.0 + 2.0 * x[1], 0.0]);
    let sampler = Sampler::new(flow.grid(), flow.sides());
    let p = Field::from_fn(flow.grid(), |x| x[1]);
    let line = sampler.line([0.5, -0.5], [0.5, 0.5], 5).unwrap();
    let line = line.with("p", &p).unwrap().with("u", flow.velocity()).unwrap();
    let mut csv = Vec::new();
    line.write_csv(&mut csv).unwrap();
    let csv = String::from_utf8(csv).unwrap();
    let rows: Vec<&str> = csv.lines().collect();
    assert_eq!((rows[0], rows.len()), ("s,x,y,p,u_x,u_y", 6));
    for (i, row) in rows[1..].iter().enumerate() {
        let row: Vec<f64> = row.split(',').map(|v| v.parse().unwrap()).collect();
        let s = 0.25 * i as f64;
        for (value, exact) in row.iter().zip([s, 0.5, s - 0.5, s - 0.5, 2.0 * s, 0.0]) {
            assert!((value - exact).abs() < 1e-13, "{rows:?}");
        }
        assert_eq!((row[3], row[4]), (line.column("p").unwrap()[i], line.column("u_x").unwrap()[i]));
    }
    assert_eq!(line.column("q"), None);

    let plane = sampler.plane(1, 0.25).unwrap().with("u", flow.velocity()).unwrap();
    assert_eq!((plane.axes().collect::<Vec<_>>(), plane.coordinates(1)), (vec![0], vec![0.25]));
    assert!(plane.values("u", 0).unwrap().iter().all(|u| (u - 1.5).abs() < 1e-13));
    let mut csv = Vec::new();
    plane.write_csv(&mut csv).unwrap();
    let csv = String::from_utf8(csv).unwrap();
    assert_eq!((csv.lines().next(), csv.lines().count()), (Some("x,y,u_x,u_y"), 9));
    assert!(csv.lines().nth(2).unwrap().starts_with("1.875e-1,2.5e-1,1."), "{csv}");

    let grid = stretched(4);
    let field = Field::from_fn(&grid, |x| x[0] + 10.0 * x[1] + 100.0 * x[2]);
    let sampler = Sampler::new(&grid, &walls());
    let plane = sampler.plane(1, 0.9).unwrap().with("f", &field).unwrap();
    let (x, z) = (plane.coordinates(0), plane.coordinates(2));
    for (i, value) in plane.values("f", 0).unwrap().iter().enumerate() {
        assert!((value - (x[i % 4] + 9.0 + 100.0 * z[i / 4])).abs() < 1e-12);
    }
    assert_eq!((plane.values("f", 1), plane.points().count()), (None, x.len() * z.len()));
}

#[test]
fn probes_append_rows() {
    let flow = channel(4, |x| [1.0 + 2.0 * x[1], 0.0]);
    let sampler = Sampler::new(flow.grid(), flow.sides());
    let p = Field::from_fn(flow.grid(), |x| x[1]);
    let path = std::env::temp_dir().join(format!("fv-mesh-probes-{}.csv", std::process::id()));
    let _ = std::fs::remove_file(&path);
    let places = [[0.5, 0.25], [3.0, -0.5]];
    for start in [0.0, 2.0] {
        let mut probes = Probes::append(&sampler, &places, &path).unwrap();
        for time in [start, start + 1.0] {
            probes.record(time, &[("u", flow.velocity().into()), ("p,", (&p).into())]).unwrap();
        }
        let wrong = probes.record(9.0, &[("p", (&p).into())]);
        assert!(matches!(wrong, Err(SampleError::Columns { .. })));
    }
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    let rows: Vec<&str> = text.lines().collect();
    assert_eq!(rows[..2], ["# 0: [0.5, 0.25] m", "# 1: [3.0, -0.5] m"]);
    assert_eq!(rows[2], "time,u_x@0,u_x@1,u_y@0,u_y@1,\"p,@0\",\"p,@1\"");
    assert_eq!(rows.len(), 7);
    for (time, row) in rows[3..].iter().enumerate() {
        let row: Vec<f64> = row.split(',').map(|v| v.parse().unwrap()).collect();
        for (value, exact) in row.iter().zip([time as f64, 1.5, 0.0, 0.0, 0.0, 0.25, -0.5]) {
            assert!((value - exact).abs() < 1e-13, "{text}");
        }
    }
}

#[test]
fn what_cannot_be_sampled_is_an_error() {
    let grid = stretched(4);
    let (sampler, field) = (Sampler::new(&grid, &walls()), Field::zeros(&grid));
    for x in [[-1.01, 1.0, 1.2], [0.0, 2.1, 1.2], [0.0, 1.0, f64::NAN]] {
        assert!(matches!(sampler.at(&field, x), Err(SampleError::Outside { .. })));
        assert!(sampler.line([0.0, 1.0, 1.2], x, 3).is_err());
        assert!(Probes::new(&sampler, &[x], Vec::new()).is_err());
    }
    let error = sampler.at(&field, [0.0, 2.5, 1.2]).unwrap_err().to_string();
    assert!(error.contains("2.5 m along axis 1") && error.contains("from 0 m to 2 m"), "{error}");
    let periodic = Sampler::new(&grid, &Sides::new(Side::Periodic.everywhere()).unwrap());
    assert!(periodic.at(&field, [f64::INFINITY, 0.0, 0.0]).is_err());
    let other = stretched(5);
    let lost = Field::zeros(&other);
    assert!(matches!(
        sampler.at(&lost, [0.0, 1.0, 1.2]),
        Err(SampleError::Grid(GridMismatch { axis: 0, .. }))
    ));
    let velocity = Velocity::zeros(&other, &walls());
    assert!(sampler.velocity(&velocity, [0.0, 1.0, 1.2]).is_err());
    assert!(sampler.flux(&velocity, 0, 0.0).is_err());
    assert!(sampler.plane(0, 0.0).unwrap().with("f", &lost).is_err());
    assert!(sampler.line([0.0, 1.0, 1.2], [0.0, 1.5, 1.2], 2).unwrap().with("f", &lost).is_err());
    assert!(matches!(sampler.plane(3, 0.0), Err(SampleError::Axis { axis: 3, axes: 3 })));
    assert!(matches!(sampler.plane(2, 0.0), Err(SampleError::Outside { axis: 2, .. })));
    assert!(matches!(
        sampler.line([0.0, 1.0, 1.2], [0.0, 1.0, 1.2], 1),
        Err(SampleError::Points { found: 1, least: 2 })
    ));
    assert!(matches!(
        Probes::new(&sampler, &[], Vec::new()),
        Err(SampleError::Points { found: 0, least: 1 })
    ));
    assert!(Integrals::new(&grid).integral(&lost).is_err());
}

#[test]
fn velocity_norms_are_those_of_the_unknown_faces() {
    // u = a + x − y, v = 2a on stretched cells, a unknown on all faces that are not on a bounded side.
    fn flow(sides: [[Side; 2]; 2]) -> Projection<2> {
        let axes = [
            Axis::geometric(7, 0.0, 1.0, 1.2).unwrap(),
            Axis::tanh(6, 0.0, 2.0, 1.1, Cluster::Upper).unwrap(),
        ];
        let grid = CartesianGrid::from_axes(axes).unwrap();
        let mut flow = Projection::new(grid, sides, FLUID).unwrap();
        flow.set_velocity(|x| [0.5 + x[0] - x[1], 1.0]);
        flow
    }
    let periodic = flow(Side::Periodic.everywhere());
    let over = Integrals::new(periodic.grid());
    let found = over.velocity_norms(periodic.velocity(), |x| [x[0] - x[1], 3.0]).unwrap();
    assert!((found.l1 - 2.5).abs() < 1e-14 && (found.l2 - 0.5_f64.hypot(2.0)).abs() < 1e-14);
    assert!((found.linf - 2.0).abs() < 1e-14);

    // Between walls at rest, where the error would be 9.
    let walled = flow(Side::WALL.everywhere());
    let moved = |x: [f64; 2]| {
        let on_wall = [x[0] == 0.0, x[1] == 0.0];
        [[x[0] - x[1], 9.0][usize::from(on_wall[0])], [3.0, 9.0][usize::from(on_wall[1])]]
    };
    let found = over.velocity_norms(walled.velocity(), moved).unwrap();
    assert!((found.l2 - 0.5_f64.hypot(2.0)).abs() < 1e-14 && (found.linf - 2.0).abs() < 1e-14);

    // Each face by its control volume: ⟨(u − u(x̄))²⟩ with the nodes' own mean and spread.
    let x = periodic.grid().axis(0);
    let widths: Vec<f64> = (0..7).map(|i| 0.5 * (x.width((i + 6) % 7) + x.width(i))).collect();
    let spread: f64 = widths.iter().zip(x.faces()).map(|(w, x)| w * x * x).sum();
    let found = over.velocity_norms(periodic.velocity(), |x| [0.5 - x[1], 1.0]).unwrap();
    assert!((found.l2 - spread.sqrt()).abs() < 1e-14, "{found:?} {spread}");

    let nowhere = over.velocity_norms(periodic.velocity(), |_| [f64::NAN, 0.0]).unwrap();
    assert!(nowhere.l2.is_nan() && nowhere.linf.is_nan());
    let other = Integrals::new(&CartesianGrid::new([7, 6], [1.0, 2.0]).unwrap());
    let mismatch = other.velocity_norms(periodic.velocity(), |_| [0.0; 2]);
    assert!(matches!(mismatch, Err(GridMismatch { axis: 0, .. })), "{mismatch:?}");
}
