use super::recent::Recent;
use super::*;
use crate::FlowError;
use crate::boundary::Boundaries;
use crate::flow_state::each_cell;
use crate::pressure::{Pressure, PressureSolver};
use crate::{Diffusion, Fluid, Projection, Side, Sides};
use interfaces::{Checkpoint, CutComponent, CutFace, CutNode, Link, SolidPoint, Vector, VelocityField};
use proptest::prelude::*;
use std::collections::HashMap;

/// A face with this share open.
fn face(index: usize, open: f64) -> CutFace {
    CutFace { index, open, constant: 0.0, terms: [(index, 0.0); 4] }
}

/// All between the lower side and `height` solid, the wall moving along x; cells are 1/`n` wide.
fn bed(flow: &Projection<2>, height: f64, n: usize, speed: f64) -> CutWalls {
    let h = 1.0 / n as f64;
    let mut walls = CutWalls { n_bodies: 1, ..CutWalls::default() };
    for c in 0..2 {
        let lattice = flow.velocity().lattice(c);
        let [nx, ny, _] = lattice.shape();
        let CutComponent { solid, links, faces } = &mut walls.components[c];
        for at in (0..nx * ny).map(|i| [(i % nx) as isize, (i / nx) as isize, 0]) {
            let (y, index) = (lattice.position(at)[1], lattice.index(at).unwrap());
            let (body, arm, velocity) = (0, Vector::zeros(), if c == 0 { speed } else { 0.0 });
            if y <= height {
                solid.push(SolidPoint { index, velocity, body, arm });
            } else if y - height < h {
                let mut node = CutNode { index, body, arm, links: [[None; 2]; 3] };
                node.links[1][0] = Some(Link { fraction: (y - height) / h, velocity });
                links.push(node);
            }
            let open = if c == 0 {
                ((y - height) / h + 0.5).clamp(0.0, 1.0)
            } else {
                f64::from(u8::from(y > height))
            };
            if open < 1.0 {
                // Along x the flow is the same everywhere: only what differs from face to face counts.
                faces.push(face(index, open));
            }
        }
    }
    walls
}

fn channel(n: usize, height: f64, speed: f64) -> Projection<2> {
    let grid = CartesianGrid::new([4, n], [4.0 / n as f64, 1.0]).unwrap();
    // The side below moves with the bed.
    let sides = [Side::Periodic.both(), [Side::Wall([speed, 0.0, 0.0]), Side::WALL]];
    let mut flow = Projection::new(grid, sides, Fluid { density: 2.0, viscosity: 0.5 }).unwrap();
    let walls = bed(&flow, height, n, speed);
    flow.set_walls(Some(walls)).unwrap();
    flow
}

/// The parabola between a wall inside the cells and the side is exact wherever the wall is, and the wall bears its share.
#[test]
fn flow_over_a_bed_is_exact() {
    for (height, speed) in [(0.23, 0.0), (0.3, 0.0), (0.317, 0.4), (0.2001, -0.3)] {
        let mut flow = channel(10, height, speed);
        let force = 1.5;
        for _ in 0..1500 {
            flow.advance(0.9 * flow.viscous_limit(), [force, 0.0]).unwrap();
        }
        let gap = 1.0 - height;
        let lattice = flow.velocity().lattice(0);
        for at in (0..10).map(|j| [1, j, 0]) {
            let s = (lattice.position(at)[1] - height) / gap;
            let wanted = if s <= 0.0 { speed } else { speed * (1.0 - s) + force * gap * gap * s * (1.0 - s) };
            let found = flow.velocity().component(0)[lattice.index(at).unwrap()];
            assert!((found - wanted).abs() < 1e-9, "{height} {at:?} {found} {wanted}");
        }
        // The momentum balance, and the shear on the side above.
        let impulse = flow.wall_impulses()[0].force / flow.last_dt();
        let side = flow.wall_impulse() / flow.last_dt();
        let total = 2.0 * force * flow.grid().volume();
        assert!((impulse.x - side.x - total).abs() < 1e-9 * total, "{impulse} {side} {total}");
        let shear = 0.5 * 2.0 * (force * gap + speed / gap) * 0.4;
        assert!((-side.x - shear).abs() < 1e-8, "{side} {shear}");
    }
}

/// `n` × `n` periodic cells, the faces of the first `cut` × `cut` partly open.
fn sieve(n: usize, cut: i32) -> Projection<2> {
    sieve_with(n, cut, |share| 0.3 + 0.65 * share)
}

/// The same with open parts of a share from 0 to 1.
fn sieve_with(n: usize, cut: i32, open: impl Fn(f64) -> f64) -> Projection<2> {
    let grid = CartesianGrid::new([n, n], [1.0; 2]).unwrap();
    let fluid = Fluid { density: 1.0, viscosity: 0.01 };
    let mut flow = Projection::new(grid, Side::Periodic.everywhere(), fluid).unwrap();
    let mut walls = CutWalls { n_bodies: 1, ..CutWalls::default() };
    for c in 0..2 {
        let lattice = flow.velocity().lattice(c);
        for (i, j) in (0..cut).flat_map(|i| (0..cut).map(move |j| (i, j))) {
            let open = open(f64::from((i * 5 + j * 3 + c as i32 * 7) % 11) / 10.0);
            let index = lattice.index([i as isize, j as isize, 0]).unwrap();
            let terms = [(index, open), (index, 0.0), (index, 0.0), (index, 0.0)];
            walls.components[c].faces.push(CutFace { index, open, constant: 0.0, terms });
        }
    }
    flow.set_walls(Some(walls)).unwrap();
    flow.set_velocity(|x| [(6.0 * x[1]).sin(), (5.0 * x[0]).cos()]);
    flow
}

#[test]
fn walls_are_restarted_bit_for_bit() {
    // More cells are cut in the second than K⁻¹ is kept for.
    for new in [|| channel(10, 0.27, 0.2), || sieve(8, 8)] {
        let step = |flow: &mut Projection<2>, n: usize| {
            for _ in 0..n {
                flow.advance(1e-3, [0.3, 0.1]).unwrap();
            }
        };
        let mut whole = new();
        step(&mut whole, 9);
        let mut first = new();
        step(&mut first, 4);
        let mut saved = HashMap::new();
        first.save(&mut |name, values| drop(saved.insert(name.to_string(), values.to_vec())));
        let mut second = new();
        second.restore(&|name| saved.get(name).map(Vec::as_slice)).unwrap();
        step(&mut second, 5);
        for c in 0..2 {
            assert_eq!(whole.velocity().component(c), second.velocity().component(c));
        }
        assert_eq!(whole.pressure().data(), second.pressure().data());
        // Known directions make later steps cheap.
        assert!(whole.pressure_info().iterations < 8, "{:?}", whole.pressure_info());
    }
}

/// A run that is saved before K⁻¹ is made and one that is saved after it go on as the whole run.
#[test]
fn the_inverse_is_made_once_iterations_have_cost_as_much() {
    let step =
        |flow: &mut Projection<2>, n: usize| (0..n).for_each(|_| flow.advance(1e-2, [0.1; 2]).unwrap());
    let mut whole = sieve(24, 4);
    assert!(whole.inverse_outlook().is_none());
    let mut saved = Vec::new();
    for _ in 0..30 {
        step(&mut whole, 1);
        let mut state = HashMap::new();
        whole.save(&mut |name, values| drop(state.insert(name.to_string(), values.to_vec())));
        saved.push((state, whole.inverse_outlook()));
    }
    let made = saved.iter().take_while(|(_, outlook)| outlook.is_some()).count();
    println!("made after {made} steps, {:?}", saved[made - 1].1);
    assert!(saved[made..].iter().all(|(_, outlook)| outlook.is_none()), "made once");
    let last = saved[made - 1].1.unwrap();
    assert!(last.iterations >= last.unknowns && last.seconds > 0.0, "{last:?}");
    assert!(made > 2 && made < 28 && saved[made - 2].1.unwrap().iterations < last.unknowns, "{made}");
    assert_eq!(whole.pressure_info().iterations, 0);
    for k in made - 2..made + 2 {
        let mut other = sieve(24, 4);
        other.restore(&|name| saved[k].0.get(name).map(Vec::as_slice)).unwrap();
        step(&mut other, 29 - k);
        for c in 0..2 {
            assert_eq!(whole.velocity().component(c), other.velocity().component(c), "saved at {k}");
        }
    }
}

/// Where iterations do not converge, as openings differ by orders of magnitude, the inverse is made
/// at once.
#[test]
fn hard_equations_are_inverted_in_their_first_solution() {
    let mut flow = sieve_with(40, 14, |share| 0.9 * 10.0f64.powf(-6.0 * share));
    flow.advance(1e-4, [0.1; 2]).unwrap();
    assert!(flow.inverse_outlook().is_none() && flow.pressure_info().iterations == 0);
    let statistics = flow.statistics();
    assert!(statistics.divergence < 1e-9, "{}", statistics.divergence);
}

/// The divergence that is measured is that of the fluxes through open parts, which a projection removes: to round-off by K⁻¹, to its
/// tolerance by iterations.
#[test]
fn divergence_is_that_of_the_open_parts() {
    let across = || {
        // Partly open faces along both axes around a closed block, in a flow that changes fast.
        let grid = CartesianGrid::new([12, 12], [1.0; 2]).unwrap();
        let sides = [Side::Periodic.both(), Side::WALL.both()];
        let mut flow = Projection::new(grid, sides, Fluid { density: 2.0, viscosity: 0.01 }).unwrap();
        let mut walls = CutWalls { n_bodies: 1, ..CutWalls::default() };
        for (c, i, j) in (0..2).flat_map(|c| (0..3).flat_map(move |i| (5..8).map(move |j| (c, i, j)))) {
            let open = 0.15 + 0.25 * f64::from((i * 2 + j + c as i32) % 4);
            let index = flow.velocity().lattice(c).index([i as isize, j as isize, 0]).unwrap();
            let terms = [(index, 0.9 * open), (index, 0.0), (index, 0.0), (index, 0.0)];
            walls.components[c].faces.push(CutFace { index, open, constant: 0.0, terms });
        }
        flow.set_walls(Some(walls)).unwrap();
        flow.set_velocity(|x| [(6.0 * x[1]).sin(), (5.0 * x[0]).cos()]);
        flow
    };
    for (name, mut flow, goal) in [("block", across(), 1e-10), ("sieve", sieve(8, 8), 1e-4)] {
        for step in 0..5 {
            flow.advance(2e-3, [0.3, 0.1]).unwrap();
            let nodes: Vec<f64> = flow.velocity().component(0).to_vec();
            let found = flow.statistics();
            assert!(found.divergence < goal, "{name} {step}: {}", found.divergence);
            // Measuring changes nothing.
            assert_eq!(nodes, flow.velocity().component(0));
            assert_eq!(found, flow.statistics());
        }
    }
}

#[test]
fn impossible_walls_are_errors() {
    let mut flow = channel(10, 0.27, 0.0);
    let lattice = flow.velocity().lattice(1);
    // The lowest faces along y are a side of the box.
    let (node, side) = (lattice.base, lattice.base - lattice.stride[1]);
    let mut refused = |change: &dyn Fn(&mut CutWalls), what: &str| {
        let mut walls = CutWalls { n_bodies: 1, ..CutWalls::default() };
        change(&mut walls);
        match flow.set_walls(Some(walls)) {
            Err(FlowError::Parameter { name, .. }) => assert!(name.contains(what), "{name}"),
            other => panic!("{what}: {other:?}"),
        }
    };
    for index in [0, side, 1 << 40] {
        refused(&|walls| walls.components[1].faces.push(face(index, 0.5)), "storage index");
    }
    for open in [-0.1, 1.0, f64::NAN] {
        refused(&|walls| walls.components[1].faces.push(face(node, open)), "open share");
    }
    let point = |body| SolidPoint { index: node, velocity: 0.0, body, arm: Vector::zeros() };
    refused(&|walls| walls.components[1].solid.push(point(1)), "body");
    refused(&|walls| walls.components[2].solid.push(point(0)), "storage index");
    for fraction in [0.0, 1.1, f64::NAN] {
        let mut cut = CutNode { index: node, body: 0, arm: Vector::zeros(), links: [[None; 2]; 3] };
        cut.links[0][1] = Some(Link { fraction, velocity: 0.0 });
        refused(&|walls| walls.components[1].links.push(cut), "link");
    }
    let grid = CartesianGrid::new([4, 10], [0.4, 1.0]).unwrap();
    let sides = [Side::Periodic.both(), Side::WALL.both()];
    let fluid = Fluid { density: 1.0, viscosity: 1.0 };
    let mut implicit = Projection::new(grid, sides, fluid).unwrap().with_diffusion(Diffusion::Implicit);
    let walls = bed(&implicit, 0.3, 10, 0.0);
    assert!(matches!(implicit.set_walls(Some(walls)), Err(FlowError::Parameter { .. })));
    implicit.advance(1e-3, [0.0; 2]).unwrap();
    // The other way round.
    let mut implicit = channel(10, 0.3, 0.0).with_diffusion(Diffusion::Implicit);
    assert!(matches!(implicit.advance(1e-3, [0.0; 2]), Err(FlowError::Parameter { .. })));
}

/// Beside walls diffusion is explicit; without them it is what it was. Walls that are refused change nothing.
#[test]
fn walls_come_and_go() {
    let mut flow = channel(10, 0.3, 0.0);
    let walls = bed(&flow, 0.3, 10, 0.0);
    let dt = 3.0 * flow.viscous_limit();
    assert!(flow.stable_dt(1.0) < flow.viscous_limit());
    assert!(matches!(flow.advance(dt, [1.0, 0.0]), Err(FlowError::Unstable { .. })));
    let mut strange = walls.clone();
    strange.components[0].links[0].body = 1;
    assert!(matches!(flow.set_walls(Some(strange)), Err(FlowError::Parameter { .. })));
    assert!(
        matches!(flow.advance(dt, [1.0, 0.0]), Err(FlowError::Unstable { .. })),
        "the walls are still there"
    );
    flow.set_walls(None).unwrap();
    assert!(flow.stable_dt(1.0) > flow.viscous_limit());
    flow.advance(dt, [1.0, 0.0]).unwrap();
}

/// Same walls: what was prepared is kept.
#[test]
fn walls_that_stay_cost_nothing() {
    let mut flow = channel(10, 0.27, 0.0);
    let moved = bed(&flow, 0.27, 10, 1.0);
    let other = bed(&flow, 0.28, 10, 1.0);
    assert!(moved.same_shape(&bed(&flow, 0.27, 10, 0.0)) && !moved.same_shape(&other));
    flow.set_walls(Some(moved)).unwrap();
    flow.advance(1e-3, [0.0; 2]).unwrap();
    let lattice = flow.velocity().lattice(0);
    assert_eq!(flow.velocity().component(0)[lattice.index([0, 0, 0]).unwrap()], 1.0);
    flow.set_walls(None).unwrap();
    assert!(flow.wall_impulses().is_empty());
}

/// The pressure equation with so much open of the faces inside a unit box, and the box's solver.
fn cut_pressure<const D: usize>(
    grid: &CartesianGrid<D>,
    sides: [[Side; 2]; D],
    mut open: impl FnMut(usize, [usize; D]) -> f64,
) -> (CutPressure, Pressure<D>, CutWalls) {
    let sides = Sides::new(sides).unwrap();
    let periodic = std::array::from_fn(|a| sides.periodic(a));
    let metrics = Metrics::new(grid, periodic);
    let boundaries = Boundaries::new(grid, sides, &metrics).unwrap();
    let mut walls = CutWalls { n_bodies: 1, ..CutWalls::default() };
    for c in 0..D {
        each_cell(grid, |index, cell| {
            let open = open(c, cell);
            if (periodic[c] || cell[c] > 0) && open < 1.0 {
                walls.components[c].faces.push(face(index, open));
            }
        });
    }
    let solver = Pressure::new(grid, &boundaries, PressureSolver::Auto).unwrap();
    (CutPressure::new(&walls, grid, &metrics, &boundaries), solver, walls)
}

/// Solves with random faces cut, then applies the operator: the largest residual over the largest term.
fn largest_residual<const D: usize>(
    sides: [[Side; 2]; D],
    cells: [usize; D],
    opens: &[f64],
    dense: bool,
) -> f64 {
    let grid = CartesianGrid::new(cells, [1.0; D]).unwrap();
    let periodic: [bool; D] = std::array::from_fn(|a| matches!(sides[a][0], Side::Periodic));
    let mut opens = opens.iter().cycle();
    let (mut pressure, mut solver, walls) = cut_pressure(&grid, sides, |_, _| *opens.next().unwrap());
    let shares: [HashMap<usize, f64>; D] =
        std::array::from_fn(|c| walls.components[c].faces.iter().map(|f| (f.index, f.open)).collect());
    let mut phi = vec![0.0; grid.n_cells()];
    if dense {
        pressure.invert(&mut solver, &mut phi).unwrap();
    }
    // Sources without a sum.
    let mut f: Vec<f64> = (0..phi.len()).map(|i| ((i * 7919) % 101) as f64 / 50.0 - 1.0).collect();
    let mean = f.iter().sum::<f64>() / f.len() as f64;
    f.iter_mut().for_each(|f| *f -= mean);
    let n = cells[0];
    pressure
        .solve(&mut solver, &|r, row: &mut [f64]| row.copy_from_slice(&f[r * n..][..n]), &mut phi)
        .unwrap();
    let (mut worst, mut scale) = (0.0_f64, 0.0_f64);
    each_cell(&grid, |index, cell| {
        let (mut sum, here) = (0.0, grid.index(cell));
        for a in 0..D {
            for up in [false, true] {
                let mut next = cell;
                let last = cells[a] - 1;
                next[a] = match (up, cell[a], periodic[a]) {
                    (true, i, false) if i == last => continue,
                    (false, 0, false) => continue,
                    (true, i, _) => {
                        if i == last {
                            0
                        } else {
                            i + 1
                        }
                    }
                    (false, i, _) => {
                        if i == 0 {
                            last
                        } else {
                            i - 1
                        }
                    }
                };
                let upper = if up { next } else { cell };
                let at = grid.place(upper);
                let share = shares[a].get(&at).copied().unwrap_or(1.0);
                let h = 1.0 / cells[a] as f64;
                let flux = (phi[grid.index(next)] - phi[here]) / (h * h);
                sum += share * flux;
                scale = scale.max(flux.abs());
            }
        }
        assert!(index < grid.storage());
        worst = worst.max((sum - f[here]).abs());
    });
    worst / scale
}

proptest! {
    /// Both ways of solving solve the equation of the open parts.
    #[test]
    fn the_pressure_acts_on_what_is_open(opens in proptest::collection::vec(0.1..1.6_f64, 60..90), seed in 0..3_usize) {
        let sides = [
            [Side::Periodic.both(), Side::Periodic.both()],
            [Side::Periodic.both(), Side::WALL.both()],
            [Side::WALL.both(), Side::WALL.both()],
        ];
        for dense in [true, false] {
            let worst = largest_residual(sides[seed].clone(), [7, 6], &opens, dense);
            // All faces may be open by a tenth only: a condition number of some thousands.
            prop_assert!(worst < if dense { 1e-11 } else { 1e-5 }, "{worst}");
        }
        let worst = largest_residual([Side::Periodic.both(), Side::WALL.both(), Side::WALL.both()], [4, 5, 3], &opens, true);
        prop_assert!(worst < 1e-11, "{worst}");
    }
}

/// Iterations from nothing around a ball do not grow with the grid.
#[test]
fn finer_cells_take_no_more_iterations() {
    let iterations = [12, 24, 48].map(|n: usize| {
        let grid = CartesianGrid::new([n; 3], [1.0; 3]).unwrap();
        let inside = |cell: [usize; 3]| {
            let x = cell.map(|i| (i as f64 + 0.5) / n as f64 - 0.5);
            x.iter().map(|x| x * x).sum::<f64>() < 0.09
        };
        let (mut pressure, mut solver, _) = cut_pressure(&grid, Side::Periodic.everywhere(), |c, cell| {
            let mut below = cell;
            below[c] = (cell[c] + n - 1) % n;
            f64::from(u8::from(!inside(cell) && !inside(below)))
        });
        pressure.recent = Some(Recent::new(pressure.missing.len()));
        // A jet that the ball parts.
        let mut phi = vec![0.0; n * n * n];
        let source = |x: usize| f64::from(u8::from(x == 0)) - f64::from(u8::from(x == n / 4));
        let fill = |_: usize, row: &mut [f64]| row.iter_mut().enumerate().for_each(|(x, f)| *f = source(x));
        pressure.solve(&mut solver, &fill, &mut phi).unwrap();
        pressure.iterations
    });
    println!("iterations at 12³, 24³, 48³: {iterations:?}");
    assert!(iterations[0] > 5 && iterations[2] <= iterations[0] + 3, "{iterations:?}");
}

/// A region that walls close in has the pressure that its own sources make, and passes nothing on.
#[test]
fn closed_regions_do_not_leak() {
    let n = 6;
    let mut flow = {
        let grid = CartesianGrid::new([n, n], [1.0; 2]).unwrap();
        Projection::new(grid, Side::Periodic.everywhere(), Fluid { density: 1.0, viscosity: 0.1 }).unwrap()
    };
    // A box of 3 × 3 cells with closed faces all round.
    let mut walls = CutWalls { n_bodies: 1, ..CutWalls::default() };
    for c in 0..2 {
        let lattice = flow.velocity().lattice(c);
        for (k, i) in [(1, 1), (1, 2), (1, 3), (4, 1), (4, 2), (4, 3)] {
            let at = if c == 0 { [k, i, 0] } else { [i, k, 0] };
            let index = lattice.index(at).unwrap();
            walls.components[c].solid.push(SolidPoint {
                index,
                velocity: 0.0,
                body: 0,
                arm: Vector::zeros(),
            });
            walls.components[c].faces.push(face(index, 0.0));
        }
    }
    flow.set_walls(Some(walls)).unwrap();
    flow.set_velocity(|x| [(7.0 * x[1]).sin() + x[0], (5.0 * x[0]).cos()]);
    flow.advance(1e-3, [0.0; 2]).unwrap();
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i as isize, j as isize))) {
        let u = |c: usize, at: [isize; 2]| {
            let lattice = flow.velocity().lattice(c);
            flow.velocity().component(c)[lattice.index([at[0], at[1], 0]).unwrap()]
        };
        let divergence = u(0, [i + 1, j]) - u(0, [i, j]) + u(1, [i, j + 1]) - u(1, [i, j]);
        assert!(divergence.abs() < 1e-12, "{i} {j} {divergence}");
    }
}
