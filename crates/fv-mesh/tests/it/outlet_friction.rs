//! Friction of walls up to an outlet.
use fv_mesh::{Axis, CartesianGrid, Convection, Fluid, Patch, Piso, Profile, Projection, Side, Simple};

const VISCOSITY: f64 = 1e-5;
const PLATE: Fluid = Fluid { density: 1.0, viscosity: VISCOSITY };

/// `cells` + 1 faces from `from` to `to` whose widths grow by one ratio from `first`.
fn growing(cells: usize, from: f64, to: f64, first: f64) -> Vec<f64> {
    let sum = |r: f64| (0..cells as i32).map(|i| first * r.powi(i)).sum::<f64>();
    let (mut low, mut high) = (0.1, 10.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if sum(middle) < to - from { low = middle } else { high = middle }
    }
    let mut faces = vec![from];
    (0..cells).for_each(|i| faces.push(faces[i] + first * low.powi(i as i32)));
    faces[cells] = to;
    faces
}

/// A plate of unit length along axis `s`, the stream towards its upper side or, `turned`, towards its lower one; at the outlet and far from the
/// plate the pressure is given. A third axis is periodic.
fn plate<const D: usize>(refine: usize, s: usize, turned: bool) -> (CartesianGrid<D>, [[Side; 2]; D]) {
    let sign = if turned { -1.0 } else { 1.0 };
    let first = 0.01 / refine as f64;
    let mut x: Vec<f64> = growing(8 * refine, 0.0, 0.2, first).iter().rev().map(|x| -x).collect();
    x.extend(&growing(24 * refine, 0.0, 1.0, first)[1..]);
    if turned {
        x = x.iter().rev().map(|x| -x).collect();
    }
    let y = growing(20 * refine, 0.0, 0.4, 4e-4 / refine as f64);
    let n = 1 - s;
    let axes = std::array::from_fn(|a| {
        let faces = if a == s {
            x.clone()
        } else if a == n {
            y.clone()
        } else {
            vec![0.0, 0.1, 0.3, 0.4]
        };
        Axis::from_faces(faces).unwrap()
    });
    let far = f64::INFINITY;
    let (mut lower, mut upper) = ([-far; 3], [far; 3]);
    if turned {
        lower[s] = 0.0
    } else {
        upper[s] = 0.0
    }
    let before = Patch { lower, upper, side: Side::FreeSlip };
    let behind = Patch { lower: [-far; 3], upper: [far; 3], side: Side::WALL };
    let mut stream = [0.0; 3];
    stream[s] = sign;
    let open = Side::PressureOutlet(0.0);
    let mut sides: [[Side; 2]; D] = std::array::from_fn(|_| Side::Periodic.both());
    sides[s] = [Side::Inlet(Profile::Uniform(stream)), open.clone()];
    if turned {
        sides[s].reverse();
    }
    sides[n] = [Side::Patches(vec![before, behind]), open];
    (CartesianGrid::from_axes(axes).unwrap(), sides)
}

/// Friction over that of Blasius (1908), τ = 0.332 ρU² √(ν/xU), in the cells beyond x = 0.3 along the plate.
fn over_blasius<const D: usize>(
    grid: &CartesianGrid<D>,
    s: usize,
    centred: impl Iterator<Item = f64>,
) -> Vec<f64> {
    let y = grid.axis(1 - s).centre(0);
    let cells = centred.enumerate().map(|(i, u)| (grid.cell(i), u.abs()));
    let beside = cells.filter(|(cell, _)| (0..D).all(|a| a == s || cell[a] == 0));
    let mut list: Vec<(f64, f64)> = beside
        .map(|(cell, u)| {
            let x = grid.axis(s).centre(cell[s]).abs();
            (x, VISCOSITY * u / y / (0.332 * (VISCOSITY / x).sqrt()))
        })
        .collect();
    list.retain(|(x, _)| *x > 0.3);
    list.sort_by(|p, q| p.0.total_cmp(&q.0));
    list.into_iter().map(|(_, ratio)| ratio).collect()
}

fn steady<const D: usize>(refine: usize, s: usize, turned: bool) -> Vec<f64> {
    let (grid, sides) = plate::<D>(refine, s, turned);
    let mut flow = Simple::new(grid.clone(), sides, PLATE).unwrap().with_convection(Convection::LinearUpwind);
    flow.set_velocity(|_| {
        std::array::from_fn(|a| {
            if a != s {
                0.0
            } else if turned {
                -1.0
            } else {
                1.0
            }
        })
    });
    flow.solve(4000, 1e-9).unwrap();
    over_blasius(&grid, s, flow.centred_velocity(s))
}

/// Nothing happens to the friction at the end of the plate, and finer cells bring it nearer to that of Blasius: the momentum of the
/// faces of the outlet has the viscous term across the layer.
#[test]
fn friction_goes_on_to_a_pressure_outlet() {
    let [coarse, fine] = [1, 2].map(|refine| steady::<2>(refine, 0, false));
    for (ratios, off) in [(&coarse, 0.035), (&fine, 0.01)] {
        assert!(ratios.iter().all(|r| (r - 1.0).abs() < off), "{ratios:?}");
        let [.., before, last] = ratios[..] else { panic!("no cells") };
        assert!((last - before).abs() < 0.004, "{ratios:?}");
    }
}

#[test]
fn outlets_are_alike_along_every_axis_and_in_space() {
    let along_x = steady::<2>(1, 0, false);
    for other in [steady::<2>(1, 1, true), steady::<3>(1, 0, true), steady::<3>(1, 1, false)] {
        let off = along_x.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-5 && along_x.len() == other.len(), "{off} {other:?} {along_x:?}");
    }
}

/// In time the flow becomes the steady one up to the outlet.
#[test]
fn unsteady_algorithms_have_the_same_friction_before_an_outlet() {
    let wanted = steady::<2>(1, 0, false);
    let (grid, sides) = plate::<2>(1, 0, false);
    let check = |found: Vec<f64>, what: &str| {
        let off = wanted.iter().zip(&found).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 2e-3, "{what}: {off} {found:?} {wanted:?}");
    };
    let mut flow =
        Piso::new(grid.clone(), sides.clone(), PLATE).unwrap().with_convection(Convection::LinearUpwind);
    flow.set_velocity(|_| [1.0, 0.0]);
    (0..300).for_each(|_| flow.advance(0.02, [0.0; 2], &mut ()).unwrap());
    check(over_blasius(&grid, 0, flow.centred_velocity(0)), "PISO");
    let mut flow =
        Projection::new(grid.clone(), sides, PLATE).unwrap().with_convection(Convection::LinearUpwind);
    flow.set_velocity(|_| [1.0, 0.0]);
    while flow.time() < 6.0 {
        flow.advance(flow.stable_dt(0.5), [0.0; 2]).unwrap();
    }
    check(over_blasius(&grid, 0, flow.centred_velocity(0)), "projection");
}

/// Entry flow of a square duct: both lateral walls act on the faces of the outlet.
#[test]
fn friction_in_the_corners_of_a_duct_goes_on_to_its_outlet() {
    let wall = || Axis::tanh(16, 0.0, 1.0, 2.0, fv_mesh::Cluster::Both).unwrap();
    let grid = CartesianGrid::from_axes([Axis::uniform(10, 0.0, 1.0).unwrap(), wall(), wall()]).unwrap();
    let ends = [Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0])), Side::PressureOutlet(0.0)];
    let fluid = Fluid { density: 1.0, viscosity: 2e-4 };
    let mut flow = Simple::new(grid.clone(), [ends, Side::WALL.both(), Side::WALL.both()], fluid)
        .unwrap()
        .with_convection(Convection::LinearUpwind);
    flow.solve(1000, 1e-6).unwrap();
    let u: Vec<f64> = flow.centred_velocity(0).collect();
    for cell in [[0, 0], [0, 8], [2, 0], [8, 0]] {
        let at = |i: usize| u[grid.index([i, cell[0], cell[1]])];
        // The layer grows: friction falls a little from cell to cell, and no faster at the end.
        let [before, last] = [at(7) - at(8), at(8) - at(9)];
        assert!(
            last > -0.002 * at(8) && last < 1.5 * before + 0.002 * at(8),
            "{cell:?} {before} {last} {}",
            at(9)
        );
    }
}
