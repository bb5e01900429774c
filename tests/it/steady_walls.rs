//! Immersed walls in the steady flow: what does not depend on how the walls lie.
use siltflow::flow::{
    Axis, CartesianGrid, Convection, FlowError, Fluid, Modelled, Profile, Side, Simple, SimpleParams,
    TransportParams, WallStress,
};
use siltflow::ibm::{StaticBodies, cut_cells};
use siltflow::interfaces::{
    Aabb, Closure, CutCells, LawOfTheWall, Point, Pose, Solid, Vector, VelocityField,
};
use std::collections::HashMap;
use turb::{Inflow, KOmegaSst, Law, Realizable, Sst, WallFunctions, Wilcox};
use validation::developed_duct::DevelopedDuct;
use validation::forced_duct::{DuctWalls, ForcedDuct};
use validation::plane_duct::{PlaneDuct, turbulent_duct};
use validation::turbulent_flows::{Drive, between_walls, developed_channel, numbers};
use validation::turned_ducts::TurnedDucts;

struct Disc(f64);

impl Solid for Disc {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        x.x.hypot(x.y) - self.0
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::new(self.0, self.0, 0.0))
    }
}

/// Largest difference from `exact`, which is taken where the open part of a face has its centroid.
fn worst(flow: &Simple<2>, cuts: &CutCells, exact: impl Fn(Point) -> [f64; 2]) -> f64 {
    let mut worst = 0.0_f64;
    for c in 0..2 {
        let (lattice, u) = (flow.velocity().lattice(c), flow.velocity().component(c));
        let cut: HashMap<usize, _> = cuts.faces[c].iter().map(|face| (face.index, face)).collect();
        let [nx, ny, _] = lattice.shape();
        for (i, j) in (0..ny).flat_map(|j| (0..nx).map(move |i| (i as isize, j as isize))) {
            let index = lattice.index([i, j, 0]).unwrap();
            let place = match cut.get(&index) {
                Some(face) if face.open == 0.0 => continue,
                Some(face) => face.centre,
                None => Point::from(lattice.position([i, j, 0])),
            };
            worst = worst.max((u[index] - exact(place)[c]).abs());
        }
    }
    worst
}

#[test]
fn uniform_flow_along_plane_walls_is_exact() {
    for (angle, shift) in [(0.3_f64, 0.013), (1.0, 0.0), (0.0, 0.007)] {
        let (s, c) = angle.sin_cos();
        let inlet = Side::Inlet(Profile::Uniform([c, s, 0.0]));
        let grid = CartesianGrid::new([24, 24], [1.0, 1.0]).unwrap();
        let fluid = Fluid { density: 1.0, viscosity: 0.0 };
        let mut flow = Simple::new(grid, [inlet.both(), inlet.both()], fluid).unwrap();
        flow = flow.with_convection(Convection::LinearUpwind);
        let duct = PlaneDuct { half: 0.2, angle, at: [0.5 + shift, 0.5] };
        let cuts = cut_cells(flow.velocity(), &StaticBodies::new().with(duct, Pose::at([0.0; 3]))).unwrap();
        flow.set_walls(Some((&cuts, WallStress::Slip))).unwrap();
        flow.set_velocity(|_| [c, s]);
        for _ in 0..3 {
            flow.iterate().unwrap();
        }
        let error = worst(&flow, &cuts, |_| [c, s]);
        let pressure = flow.pressure().values().fold(0.0_f64, |m, p| m.max(p.abs()));
        assert!(error < 1e-12 && pressure < 1e-12, "{angle}: {error:e} {pressure:e}");
    }
}

/// Walls that cut the cells of a convective outlet: what leaves there is what comes along them.
#[test]
fn uniform_flow_leaves_through_the_open_part_of_an_outlet() {
    for shift in [0.001, 0.007, 0.02, 0.04] {
        let inlet = Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0]));
        let grid = CartesianGrid::new([24, 24], [1.0, 1.0]).unwrap();
        let fluid = Fluid { density: 1.0, viscosity: 0.0 };
        let sides = [[inlet, Side::ConvectiveOutlet], Side::FreeSlip.both()];
        let mut flow = Simple::new(grid, sides, fluid).unwrap().with_convection(Convection::LinearUpwind);
        let duct = PlaneDuct { half: 0.2, angle: 0.0, at: [0.0, 0.5 + shift] };
        let cuts = cut_cells(flow.velocity(), &StaticBodies::new().with(duct, Pose::at([0.0; 3]))).unwrap();
        flow.set_walls(Some((&cuts, WallStress::Slip))).unwrap();
        flow.set_velocity(|_| [1.0, 0.0]);
        for _ in 0..30 {
            flow.iterate().unwrap();
        }
        let error = worst(&flow, &cuts, |_| [1.0, 0.0]);
        assert!(error < 1e-12, "{shift}: {error:e}");
    }
}

/// Errors of the velocity and of the pressure gradient between plane walls `n` cells apart, turned by `angle`.
fn poiseuille(n: usize, angle: f64, shift: f64) -> [f64; 2] {
    let (half, nu, at) = (0.2, 0.05, [0.5 + shift, 0.5]);
    let cells = (n as f64 / (2.0 * half)).round() as usize;
    let (s, c) = angle.sin_cos();
    let exact = move |x: Point| {
        let y = PlaneDuct { half, angle, at }.height([x.x, x.y]) / half;
        let u = (1.0 - y * y).max(0.0);
        [u * c, u * s]
    };
    let inlet = Side::Inlet(Profile::function(move |x, _| {
        let [u, v] = exact(Point::from(x));
        [u, v, 0.0]
    }));
    let grid = CartesianGrid::new([cells; 2], [1.0; 2]).unwrap();
    let fluid = Fluid { density: 1.0, viscosity: nu };
    let mut flow = Simple::new(grid, [inlet.both(), inlet.both()], fluid).unwrap();
    let duct = StaticBodies::new().with(PlaneDuct { half, angle, at }, Pose::at([0.0; 3]));
    let cuts = cut_cells(flow.velocity(), &duct).unwrap();
    flow.set_walls(Some((&cuts, WallStress::NoSlip))).unwrap();
    flow.set_velocity(|[x, y]| exact(Point::new(x, y, 0.0)));
    flow.solve(400, 1e-7).unwrap();
    // Bilinear between the centres.
    let pressure = |t: f64| {
        let [a, b] = [at[0] + t * c, at[1] + t * s].map(|x| x * cells as f64 - 0.5);
        let of = |i: usize, j: usize| {
            let weight = (1.0 - (a - i as f64).abs()) * (1.0 - (b - j as f64).abs());
            weight * flow.pressure().row(j)[i]
        };
        let (i, j) = (a.floor() as usize, b.floor() as usize);
        of(i, j) + of(i + 1, j) + of(i, j + 1) + of(i + 1, j + 1)
    };
    let slope = (pressure(-0.2) - pressure(0.15)) / 0.35;
    [worst(&flow, &cuts, exact), (slope * half * half / (2.0 * nu) - 1.0).abs()]
}

#[test]
fn poiseuille_flow_is_of_second_order_on_walls_along_the_grid() {
    let [coarse, fine] = [20, 40].map(|n| poiseuille(n, 0.0, 0.007));
    assert!(coarse[1] < 0.004 && fine[1] < 0.001 && fine[0] < 0.001, "{coarse:?} {fine:?}");
    for (coarse, fine) in coarse.into_iter().zip(fine) {
        assert!((coarse / fine).log2() > 1.6, "{coarse:e} {fine:e}");
    }
}

/// The pressure gradient within 0.2 %; the velocity is of first order on faces nearly closed.
#[test]
fn poiseuille_flow_between_turned_walls() {
    let [coarse, fine] = [20, 40].map(|n| poiseuille(n, 15.0_f64.to_radians(), 0.003));
    assert!(coarse[1] < 0.002 && fine[1] < 0.002, "{coarse:?} {fine:?}");
    assert!(coarse[0] < 0.016 && fine[0] < 0.006, "{coarse:?} {fine:?}");
}

/// Laminar ducts without ends, driven by a force per mass: what the walls take is what drives the fluid, wherever they lie, and what flows is
/// f H²/(12ν).
#[test]
fn walls_take_what_drives_the_fluid_through_periodic_ends() {
    let (height, force, nu) = (0.4, 0.3, 0.05);
    for angle in [0.0, 15.0, 30.0, 45.0] {
        let (ducts, grid) = TurnedDucts::new(height, f64::to_radians(angle), height / 20.0, 0.3).unwrap();
        let [along, up] = ducts.along();
        let sides = [Side::Periodic.both(), Side::Periodic.both()];
        let mut flow = Simple::new(grid, sides, Fluid { density: 1.0, viscosity: nu }).unwrap();
        let cuts = cut_cells(flow.velocity(), &StaticBodies::new().with(ducts, ducts.pose())).unwrap();
        flow.set_walls(Some((&cuts, WallStress::NoSlip))).unwrap();
        flow.set_force([along * force, up * force]);
        flow.solve(3000, 1e-8).unwrap();
        let taken = ducts.drag(&flow) / (force * ducts.open_area(&flow, &cuts));
        let mean = ducts.mean_velocity(&flow, &cuts) / (force * height * height / (12.0 * nu));
        assert!((taken - 1.0).abs() < 1e-6, "{angle}: {taken}");
        assert!((mean - 1.0).abs() < 0.02, "{angle}: {mean}");
    }
}

/// What lies deep in the solid is not computed: rows across a duct in a wide box have ends that nothing happens in, rows along it have none. The cells across
/// are of different widths, so that parts of rows have to know where they are.
#[test]
fn a_duct_in_a_box_that_is_mostly_solid_is_the_same_along_either_axis() {
    let (across, along, half) = (72, 40, 0.52);
    let faces: Vec<f64> = (0..=across).map(|j| 2.0 * (1.02_f64.powi(j) - 1.0)).collect();
    let middle = faces[36];
    let made = [0, 1].map(|axis| {
        let inlet = Side::Inlet(Profile::Uniform(if axis == 0 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] }));
        let (mut axes, mut sides) = (
            [Axis::uniform(along, 0.0, 4.0).unwrap(), Axis::from_faces(faces.clone()).unwrap()],
            [[inlet, Side::PressureOutlet(0.0)], Side::FreeSlip.both()],
        );
        if axis == 1 {
            axes.reverse();
            sides.reverse();
        }
        let grid = CartesianGrid::from_axes(axes).unwrap();
        let mut flow = Simple::new(grid.clone(), sides, Fluid { density: 1.0, viscosity: 1e-5 })
            .unwrap()
            .with_convection(Convection::Quick)
            .with_params(SimpleParams::turbulent())
            .unwrap();
        let angle = if axis == 0 { 0.0 } else { std::f64::consts::FRAC_PI_2 };
        let duct = PlaneDuct { half, angle, at: [middle; 2] };
        let cuts = cut_cells(flow.velocity(), &StaticBodies::new().with(duct, Pose::at([0.0; 3]))).unwrap();
        flow.set_walls(Some((&cuts, WallStress::LAW_OF_THE_WALL))).unwrap();
        flow.set_velocity(|_| if axis == 0 { [1.0, 0.0] } else { [0.0, 1.0] });
        let inflow = Inflow::from_length(1.0, 0.05, 0.07).unwrap();
        let model = KOmegaSst::new(Sst::default(), grid.n_cells(), inflow).unwrap();
        let mut model = Modelled::new(model, &grid, flow.sides(), TransportParams::steady()).unwrap();
        for (cell, distance) in model.transport_mut().wall_distance_mut().iter_mut().enumerate() {
            *distance = (half - duct.height(grid.centre(grid.cell(cell))).abs()).max(0.0);
        }
        flow.solve_with(&mut model, 1000, 1e-9).unwrap();
        let of = |i: usize, j: usize| {
            let [i, j] = if axis == 0 { [i, j] } else { [j, i] };
            [flow.velocity().field(axis).row(j)[i], model.closure.nu_t()[grid.index([i, j])]]
        };
        let all = (0..along).flat_map(|i| (0..across as usize).map(move |j| (i, j)));
        all.map(|(i, j)| of(i, j)).collect::<Vec<_>>()
    });
    let (mut largest, mut seen) = (0.0_f64, 0);
    for (k, ([u, nu_t], [v, other])) in made[0].iter().zip(&made[1]).enumerate() {
        let j = k % across as usize;
        let depth = half - (0.5 * (faces[j] + faces[j + 1]) - middle).abs();
        if depth > 0.0 {
            largest = largest.max((u - v).abs()).max((nu_t / other - 1.0).abs());
            seen += 1;
        } else if depth < -0.2 {
            assert_eq!([*u, *v], [0.0; 2]);
        }
    }
    assert!(largest < 1e-6 && seen > 100, "{largest:e} {seen}");
}

/// A duct whose walls are a little behind lines of the grid settles as that on the lines does, to the same flow.
#[test]
fn turbulent_flow_between_walls_beside_lines_of_the_grid_settles() {
    let mut on_the_lines: Option<f64> = None;
    for behind in [0.0, 1e-4, 2e-3, 9e-3, 0.02] {
        let (mut flow, mut model) =
            turbulent_duct(Sst::default(), 16, 1e5, behind, Side::ConvectiveOutlet).unwrap();
        flow.solve_with(&mut model, 200, 1e-5).unwrap();
        let u = flow.velocity().field(0).row(11)[40];
        let on_the_lines = *on_the_lines.get_or_insert(u);
        assert!((u / on_the_lines - 1.0).abs() < 1e-3 + 0.2 * behind, "{behind}: {u} {on_the_lines}");
    }
}

/// What a duct and its model have found is where they go on from on another grid: at rest at once on the same, and without a value from solids
/// on a finer one.
#[test]
fn a_turbulent_duct_starts_from_another() {
    let duct =
        |cells: usize| turbulent_duct(Sst::default(), cells, 1e5, 0.3, Side::ConvectiveOutlet).unwrap();
    let (mut found, mut known) = duct(16);
    found.solve_with(&mut known, 300, 1e-6).unwrap();
    let (mut flow, mut model) = duct(16);
    flow.start_with(&mut model, &found, &known).unwrap();
    let info = flow.solve_with(&mut model, 10, 1e-5).unwrap();
    assert!(info.iterations <= 6, "{info:?}");
    let (mut flow, mut model) = duct(32);
    flow.start_with(&mut model, &found, &known).unwrap();
    let grid = flow.grid().clone();
    let k = model.closure.k();
    let [least, most] = known
        .closure
        .k()
        .iter()
        .filter(|k| **k > 1e-20)
        .fold([f64::MAX, 0.0], |[a, b], &k| [f64::min(a, k), f64::max(b, k)]);
    for cell in (0..grid.n_cells()).filter(|&cell| model.transport().wall_distance()[cell] > 0.0) {
        assert!((least..=most).contains(&k[cell]), "{:?}: {} {least} {most}", grid.cell(cell), k[cell]);
    }
    let speeds: Vec<f64> = flow.velocity().field(0).row(4).to_vec();
    assert!(speeds.iter().all(|u| *u > 0.3), "{speeds:?}");
}

/// Friction of developed flow is that of simpleFoam's mesh c within 5 %, wherever walls with a law lie on the grid: in cells whose centre is in the
/// fluid or is not, along the grid or across it.
#[test]
fn friction_of_developed_ducts_does_not_depend_on_where_their_walls_are() {
    fn run<L: Law>(law: L, text: &str) {
        let (viscosity, reference) = (1e-6, numbers::<6>(text)[0]);
        let u_tau = reference[1] * viscosity / reference[0];
        let given = 2.0 * u_tau * u_tau;
        let places = [0.0, 0.15, 0.3, 0.49].map(|shift| (0.0, shift));
        for (angle, shift) in places.into_iter().chain([(15.0, 0.3), (45.0, 0.3)]) {
            let duct = DevelopedDuct::new(law.clone(), angle, 20, shift, viscosity, given).unwrap();
            let off = duct.force / given - 1.0;
            assert!(off.abs() < 0.05 && duct.residual < 1e-5, "{angle} {shift}: {off} {}", duct.residual);
            // The closure produces k by it.
            for row in duct.model.wall_rows() {
                let told = row.friction.map_or(f64::NAN, |friction| friction / (0.5 * duct.force) - 1.0);
                assert!(told.abs() < 0.08, "{angle} {shift}: {told}");
            }
        }
    }
    run(Sst::default(), include_str!("../data/turbulence/channel_kOmegaSST_c.csv"));
    run(Wilcox::openfoam(), include_str!("../data/turbulence/channel_kOmega_c.csv"));
}

/// Where a flow slows down beside a wall something leaves the first cell. By what upwind schemes make of the wall's own velocity it took 1.4 times the first
/// node's velocity with it beside sides of the box, which had up to 23 % less friction than bodies in the same place.
#[test]
fn sides_of_the_box_rub_as_bodies_do_where_the_flow_slows_down() {
    let duct = |walls| ForcedDuct::new(Sst::default(), walls, 40, 1.6).unwrap();
    let bodies = duct(DuctWalls::Immersed(0.0, WallStress::LAW_OF_THE_WALL));
    let [before, low, high] = duct(DuctWalls::Sides(None)).off(&bodies);
    assert!(before.abs() < 0.015 && low > -0.005 && high < 0.005, "{before} {low} {high}");
}

/// So does what a scalar carries there: with its scheme going on from the walls' own value sides took 4.3 % less than bodies where the flow slows down.
#[test]
fn sides_of_the_box_cool_as_bodies_do_where_the_flow_slows_down() {
    let taken = |walls| {
        let mut duct = ForcedDuct::new(Sst::default(), walls, 40, 1.6).unwrap();
        let flux = duct.warmth([-1.0, -0.5, 0.0, 0.5, 1.0, 1.5]).unwrap();
        flux.windows(2).map(|flux| flux[0] - flux[1]).collect::<Vec<_>>()
    };
    let bodies = taken(DuctWalls::Immersed(0.0, WallStress::LAW_OF_THE_WALL));
    for (sides, bodies) in taken(DuctWalls::Sides(None)).iter().zip(bodies) {
        assert!((sides / bodies - 1.0).abs() < 0.015, "{sides} {bodies}");
    }
}

/// Turned ducts at Re 10⁴, by angle and cells, need the force that drives the resolved flow to this deviation. Answers how much more the receding wall rubs than the rising one.
fn friction_against_resolved(cases: &[(f64, usize, f64)]) -> Vec<f64> {
    let viscosity = 1e-4;
    let fine = developed_channel(
        Sst::default(),
        WallFunctions::default(),
        between_walls(200, 1.0, 3.0 * viscosity).unwrap(),
        viscosity,
        Drive::Bulk(1.0),
        Inflow::from_length(1.0, 0.05, 0.07).unwrap(),
    )
    .unwrap();
    let given = 2.0 * fine.u_tau * fine.u_tau;
    let more = cases.iter().map(|&(angle, cells, most)| {
        let duct = DevelopedDuct::new(Sst::default(), angle, cells, 0.3, viscosity, given).unwrap();
        let off = duct.force / given - 1.0;
        assert!(off.abs() < most && duct.residual < 1e-5, "{angle} {cells}: {off} {}", duct.residual);
        let [rising, receding] = duct.frictions;
        receding / rising - 1.0
    });
    more.collect()
}

/// Walls across the grid have friction in the buffer layer, too, where the upwind part of what carries momentum and k acts along the stream only. (With upwind parts
/// along the axes it was 11 and 26 % too low, with that of k alone along them 17 % at 45°.) Walls that rise along the stream and that recede have it alike: momentum
/// is not carried from the one to the other. (With values of second order and products of mid values one had 18 % too little, the other 21 % too much.)
#[test]
fn friction_of_walls_across_the_grid_in_the_buffer_layer() {
    let more = friction_against_resolved(&[(15.0, 20, 0.05), (45.0, 20, 0.1)]);
    assert!(more.iter().all(|more| more.abs() < 0.15), "{more:?}");
}

/// And where the logarithmic layer begins, if it is several cells thick: y+ 33 and 25. (With the upwind part along the axes there −13 and −12 %.)
#[test]
fn friction_of_walls_across_the_grid_beyond_the_buffer_layer() {
    friction_against_resolved(&[(15.0, 10, 0.08), (45.0, 10, 0.09)]);
}

/// Walls that cut the outlet and leave a tenth of a cell: with values of third order there it oscillates (a residual of 0.1), and with an equation of their own for the faces
/// of the outlet that they cut (0.07).
#[test]
fn a_tenth_of_a_cell_comes_to_rest() {
    for place in [0.1001, 0.11, 0.16, 0.3] {
        let (mut flow, mut model) =
            turbulent_duct(Realizable::default(), 20, 1e4, place, Side::PressureOutlet(0.0)).unwrap();
        let info = flow.solve_with(&mut model, 300, 1e-5);
        assert!(info.is_ok(), "{place}: {info:?}");
    }
}

/// Where the flow along a wall speeds up and slows down friction of the velocity's own law is within 6 % of that of finer cells; k alone comes late by
/// 16 %.
#[test]
fn friction_follows_a_flow_that_speeds_up() {
    let duct = |walls, cells| ForcedDuct::new(Sst::default(), walls, cells, -1.5).unwrap();
    let fine = duct(DuctWalls::Sides(Some(0.003)), 60);
    let off = |velocity_weight: f64| {
        let stress = WallStress::Law { law: LawOfTheWall::USUAL, distance: 0.5, velocity_weight };
        let [before, low, high] = duct(DuctWalls::Immersed(0.0, stress), 40).off(&fine);
        [low, high].map(|off| (1.0 + before) * (1.0 + off) - 1.0)
    };
    let [of_k, usual, of_u] = [0.0, 0.4, 1.0].map(off);
    assert!(of_u[0] > -0.06 && of_u[1] < 0.06, "{of_u:?}");
    assert!(usual[0] > -0.11 && usual[1] < 0.06, "{usual:?}");
    assert!(of_k[0] < -0.13, "{of_k:?}");
}

#[test]
fn a_law_with_impossible_numbers_is_an_error() {
    let (duct, grid) = TurnedDucts::new(1.0, 0.0, 0.1, 0.3).unwrap();
    let sides = [Side::Periodic.both(), Side::Periodic.both()];
    let mut flow = Simple::new(grid, sides, Fluid { density: 1.0, viscosity: 1e-3 }).unwrap();
    let cuts = cut_cells(flow.velocity(), &StaticBodies::new().with(duct, duct.pose())).unwrap();
    for (distance, velocity_weight) in [(0.0, 0.4), (f64::NAN, 0.4), (0.5, -0.1), (0.5, 1.1), (0.5, f64::NAN)]
    {
        let stress = WallStress::Law { law: LawOfTheWall::USUAL, distance, velocity_weight };
        let error = flow.set_walls(Some((&cuts, stress))).unwrap_err();
        assert!(matches!(error, FlowError::Parameter { .. }), "{error}");
    }
}

/// Schäfer & Turek (1996), 2D-1: Cd = 5.5795.
#[test]
fn the_drag_of_a_cylinder() {
    let (n, diameter) = (20, 0.1);
    let h = diameter / n as f64;
    for shift in [0.0, 0.37] {
        let grid = CartesianGrid::new([220, 82], [220.0 * h, 82.0 * h]).unwrap();
        let inlet = Side::Inlet(Profile::Parabolic { peak: 0.3 });
        let sides = [[inlet, Side::PressureOutlet(0.0)], Side::WALL.both()];
        let mut flow = Simple::new(grid, sides, Fluid { density: 1.0, viscosity: 1e-3 }).unwrap();
        let bodies = StaticBodies::new().with(Disc(0.5 * diameter), Pose::at([0.2 + shift * h, 0.2, 0.0]));
        let cuts = cut_cells(flow.velocity(), &bodies).unwrap();
        flow.set_walls(Some((&cuts, WallStress::NoSlip))).unwrap();
        flow.solve(400, 1e-5).unwrap();
        let force = flow.wall_friction()[0].force.x + flow.wall_pressure_force()[0].force.x;
        let drag = 2.0 * force / (0.2 * 0.2 * diameter);
        assert!((drag / 5.5795 - 1.0).abs() < 0.01, "{shift}: {drag}");
    }
}

/// Fluid above a floor.
struct Floor(f64);

impl Solid for Floor {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        x.y - self.0
    }
    fn aabb(&self) -> Aabb {
        Aabb { min: Point::new(-9.0, -9.0, 0.0), max: Point::new(9.0, self.0, 0.0) }
    }
}

/// Cf at x = 0.97 of a plate at Re 5e6 per length in a stream that brings next to no turbulence, first cells `h` high; a side of the box, or a body whose
/// surface is `behind` cells from its lower side.
fn coarse_plate<L: Law>(law: L, h: f64, behind: Option<f64>) -> f64 {
    let viscosity = 1.0 / 5e6;
    let (mut faces, mut width, mut y) = (vec![0.0], h, 0.0);
    while y < 0.5 {
        width *= if faces.len() > 8 { 1.15 } else { 1.0 };
        y += width;
        faces.push(y);
    }
    let grid =
        CartesianGrid::from_axes([Axis::uniform(50, 0.0, 2.0).unwrap(), Axis::from_faces(faces).unwrap()])
            .unwrap();
    let open = Side::PressureOutlet(0.0);
    let wall = if behind.is_some() { Side::FreeSlip } else { Side::WALL };
    let sides = [[Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0])), open.clone()], [wall, open]];
    let mut flow = Simple::new(grid.clone(), sides, Fluid { density: 1.0, viscosity })
        .unwrap()
        .with_convection(Convection::Quick)
        .with_params(SimpleParams::turbulent())
        .unwrap();
    let floor = behind.map(|behind| behind * h);
    if let Some(floor) = floor {
        let cuts =
            cut_cells(flow.velocity(), &StaticBodies::new().with(Floor(floor), Pose::at([0.0; 3]))).unwrap();
        flow.set_walls(Some((&cuts, WallStress::LAW_OF_THE_WALL))).unwrap();
    }
    flow.set_velocity(|_| [1.0, 0.0]);
    let inflow = Inflow::from_viscosity_ratio(1.0, 5e-4, 0.1, viscosity).unwrap();
    let model = turb::TwoEquation::new(law, grid.n_cells(), inflow).unwrap();
    let mut model = Modelled::new(model, &grid, flow.sides(), TransportParams::steady()).unwrap();
    if let Some(floor) = floor {
        for (cell, distance) in model.transport_mut().wall_distance_mut().iter_mut().enumerate() {
            *distance = (grid.centre(grid.cell(cell))[1] - floor).max(0.0);
        }
    }
    flow.solve_with(&mut model, 300, 1e-5).unwrap();
    let rows = model.wall_rows().iter().zip(model.closure.wall_viscosity());
    let of = |r: &siltflow::interfaces::WallRow, eddy: f64| {
        2.0 * r.friction.unwrap_or((viscosity + eddy) * r.u_t / r.y)
    };
    let list = rows.map(|(r, eddy)| ((grid.centre(grid.cell(r.cell))[0] - 0.97).abs(), of(r, *eddy)));
    list.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap().1
}

/// First cells at y+ 1000 to 240 that the stream passes before they have any k: friction is that of a turbulent layer, and finer cells bring it nearer to that of
/// resolved ones (0.0027, NASA's codes). With the friction velocity of k alone it is 0.0001 to 0.0003.
#[test]
fn turbulent_first_cells_without_k_start_the_layer() {
    let resolved = 0.0027;
    for behind in [None, Some(0.3)] {
        let off = [0.01, 0.005].map(|h| coarse_plate(Sst::default(), h, behind) / resolved - 1.0);
        assert!(off[0].abs() < 0.12 && off[1].abs() < 0.06, "{behind:?}: {off:?}");
    }
    let off = coarse_plate(Wilcox::default(), 0.005, None) / resolved - 1.0;
    assert!(off.abs() < 0.1, "k-omega: {off}");
    let off = coarse_plate(turb::StandardKEpsilon::default(), 0.005, None) / resolved - 1.0;
    assert!(off.abs() < 0.1, "k-epsilon: {off}");
}
