use super::*;
use crate::testing::{Ball, Balls, Brick, Plain, lattice};
use interfaces::{Bodies, Kinematics, Nodes, Pose, Rotation, Solid, Twist};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

/// Cells along an axis from 0 to 3, the widest 1.6 times the narrowest, 0.1 in the middle.
fn stretched(periodic: bool) -> Nodes {
    let mut faces = vec![0.0_f64];
    while faces[faces.len() - 1] < 3.0 {
        let last = faces[faces.len() - 1];
        faces.push(last + 0.08 * (1.0 + 0.3 * (2.1 * last).sin()));
    }
    let scale = 3.0 / faces[faces.len() - 1];
    Nodes::centres(&faces.iter().map(|x| x * scale).collect::<Vec<_>>(), periodic)
}

fn cube_of(axis: &Nodes, dim: usize) -> Lattice {
    let (n, axis) = (axis.len(), || axis.clone());
    if dim == 2 {
        Lattice::new([axis(), axis()], 0, [1, n])
    } else {
        Lattice::new([axis(), axis(), axis()], 0, [1, n, n * n])
    }
}

fn placed(lattice: &Lattice, bodies: &Balls) -> WallRows {
    let mut rows = WallRows::new();
    rows.place(lattice, bodies).unwrap();
    rows
}

fn field(lattice: &Lattice, f: impl Fn([f64; 3]) -> f64) -> Vec<f64> {
    let dense = lattice.dense();
    (0..lattice.shape().iter().product()).map(|c| f(dense.position(dense.node(c)))).collect()
}

fn area(rows: &WallRows) -> f64 {
    rows.rows().iter().map(|row| row.area).sum()
}

/// A body of any kind, turned.
fn one(solid: impl Solid + 'static, at: [f64; 3], turn: [f64; 3]) -> Balls {
    let orientation = Rotation::from_euler_angles(turn[0], turn[1], turn[2]);
    Balls::of(solid, 1.0, vec![Pose { position: at.into(), orientation }])
}

/// In a flow whose velocity and k are linear in space, past a ball that moves and turns, all is exact, on uniform and
/// stretched lattices, for fields that cells in and beside the body have no part in.
#[test]
fn linear_shear_is_seen_exactly() {
    for (dim, axis) in
        [2, 3].into_iter().flat_map(|d| [(d, Nodes::uniform(0.05, 0.1, 30, false)), (d, stretched(false))])
    {
        let lattice = cube_of(&axis, dim);
        let mut bodies = Balls::new(dim, 0.5, vec![[1.47, 1.53, if dim == 2 { 0.0 } else { 1.38 }]]);
        bodies.twists[0] = Twist { linear: Vector::new(0.3, -0.2, 0.0), angular: Vector::new(0.0, 0.0, 0.7) };
        let u = |x: [f64; 3]| {
            Vector::new(
                0.4 + 1.3 * x[1] - 0.2 * x[0],
                0.1 + 0.5 * x[0],
                if dim == 2 { 0.0 } else { 0.3 * x[1] - x[2] },
            )
        };
        let k = |x: [f64; 3]| 2.0 + x[0] - 0.5 * x[1] + 0.25 * x[2];
        let mut rows = placed(&lattice, &bodies);
        assert_eq!(rows.lowered(), 0);
        let mut velocity: Vec<Vec<f64>> = (0..dim).map(|c| field(&lattice, |x| u(x)[c])).collect();
        let mut energy = field(&lattice, k);
        let here: Vec<f64> = rows.rows().iter().map(|row| velocity[0][row.cell]).collect();
        // P₁ and P₂ see nothing of these.
        for node in rows.fraction.nodes(BodyId(0)) {
            (velocity[0][node.index], energy[node.index]) = (f64::NAN, f64::NAN);
        }
        for (row, here) in rows.rows.iter().zip(here) {
            velocity[0][row.cell] = here;
        }
        let fields: Vec<&[f64]> = velocity.iter().map(Vec::as_slice).collect();
        rows.fill(&fields, Some(&energy), 1e-3, |w| bodies.surface_velocity(w.body, w.foot)).unwrap();
        let dense = lattice.dense();
        assert!(rows.rows().len() > if dim == 2 { 30 } else { 300 });
        for (row, cell) in rows.rows().iter().zip(rows.cells(BodyId(0))) {
            let (centre, n) = (bodies.poses[0].position, cell.normal);
            let x = Point::from(dense.position(dense.node(row.cell)));
            let away = x - centre;
            assert!((row.y - (away.norm() - 0.5)).abs() < 1e-12 && row.y > 0.0);
            // The normal of a ball is a difference over a thousandth of a cell.
            assert!((n - away.normalize()).norm() < 1e-5 && (cell.foot.norm() - 0.5).abs() < 1e-5);
            let relative = |x: Point| {
                let v = u(x.into()) - bodies.twists[0].at(cell.foot);
                v - n * n.dot(&v)
            };
            assert!((row.u_t - relative(x).norm()).abs() < 1e-12 && row.nu == 1e-3);
            let surface = centre + cell.foot;
            let mut last = row.y.max(0.05);
            for point in row.points {
                let point = point.unwrap();
                let x = surface + n * point.y;
                assert!(
                    (point.u_t - relative(x).norm()).abs() < 1e-12,
                    "{} {}",
                    point.u_t,
                    relative(x).norm()
                );
                assert!((point.k - k(x.into())).abs() < 1e-12);
                assert!(point.y > last && point.y < 0.55, "{row:?}");
                last = point.y;
            }
            let along = relative(surface + n * row.points[0].unwrap().y);
            assert!((row.tangent - along.normalize()).norm() < 1e-12);
        }
    }
}

/// Fluid that turns with a body does not move along it.
#[test]
fn rigid_rotation_is_no_shear() {
    let lattice = lattice(2, [0.1; 3], 3.0);
    let mut bodies = Balls::new(2, 0.6, vec![[1.5, 1.5, 0.0]]);
    bodies.twists[0].angular.z = 2.0;
    let mut rows = placed(&lattice, &bodies);
    let turn = |c: usize| field(&lattice, |x| if c == 0 { -2.0 * (x[1] - 1.5) } else { 2.0 * (x[0] - 1.5) });
    let velocity = [turn(0), turn(1)];
    let rows = rows
        .fill(&[&velocity[0], &velocity[1]], None, 1.0, |w| bodies.surface_velocity(w.body, w.foot))
        .unwrap();
    for row in rows {
        // Ωy remains, as the surface moves with Ωr.
        assert!((row.u_t - 2.0 * row.y).abs() < 1e-5 && row.k == 0.0);
    }
    let mut still = placed(&lattice, &Balls::new(2, 0.6, vec![[1.5, 1.5, 0.0]]));
    let zero = vec![0.0; 900];
    let rows = still.fill(&[&zero, &zero], None, 1.0, |_| Vector::zeros()).unwrap();
    assert!(rows.iter().all(|row| row.u_t == 0.0 && row.tangent == Vector::zeros()));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20))]
    /// Within 1 % at ten cells per diameter, wherever and however they sit, over periodic sides and corners too.
    #[test]
    fn areas_are_those_of_the_surfaces(
        at in prop::array::uniform3(0.0..3.0_f64), turn in prop::array::uniform3(-3.0..3.0_f64), uneven: bool,
    ) {
        let grid = |dim| if uneven { cube_of(&stretched(true), dim) } else { lattice(dim, [0.1; 3], 3.0) };
        let flat = [at[0], at[1], 0.0];
        let disc = area(&placed(&grid(2), &one(Plain(Ball { dim: 2, radius: 0.5 }), flat, [0.0; 3]))) / PI;
        prop_assert!((disc - 1.0).abs() < 0.002, "disc {disc}");
        let square = area(&placed(&grid(2), &one(Brick([0.5, 0.5, 0.0]), flat, [0.0, 0.0, turn[2]]))) / 4.0;
        prop_assert!((square - 1.0).abs() < 0.01, "square {square}");
        let sphere = area(&placed(&grid(3), &one(Plain(Ball { dim: 3, radius: 0.5 }), at, turn))) / PI;
        prop_assert!((sphere - 1.0).abs() < 0.002, "sphere {sphere}");
        let cube = area(&placed(&grid(3), &one(Brick([0.5; 3]), at, turn))) / 6.0;
        prop_assert!((cube - 1.0).abs() < 0.01, "cube {cube}");
    }

    /// There is a row wherever a fluid cell shares a face with an in-solid cell, and wherever the surface cuts a cell with its
    /// centre in the fluid; and none elsewhere, nor in another body.
    #[test]
    fn rows_are_where_walls_are(
        at in prop::array::uniform3(0.0..3.0_f64), turn in prop::array::uniform3(-3.0..3.0_f64), dim in 2..4_usize,
    ) {
        let lattice = lattice(dim, [0.15; 3], 3.0);
        let mut bodies = if dim == 2 {
            one(Brick([0.6, 0.2, 0.0]), [at[0], at[1], 0.0], [0.0, 0.0, turn[2]])
        } else {
            one(Brick([0.6, 0.2, 0.4]), at, turn)
        };
        let second = Pose::at([at[1], at[2], if dim == 2 { 0.0 } else { at[0] }]);
        bodies.poses.push(second);
        bodies.twists.push(Twist::default());
        let rows = placed(&lattice, &bodies);
        let x = |node| Point::from(lattice.position(node));
        let inside = |b: usize, node| {
            let away = interfaces::Periods::new([Some(3.0), Some(3.0), (dim == 3).then_some(3.0)]);
            // Images count: bodies are shorter than half a period.
            let d = away.nearest(x(node) - bodies.poses[b].position);
            let x = bodies.poses[b].to_body(bodies.poses[b].position + d);
            bodies.solid(BodyId(b)).signed_distance(x, 9.0) <= 0.0
        };
        for cell in 0..lattice.shape().iter().product() {
            let node = lattice.node(cell);
            let solid = inside(0, node) || inside(1, node);
            for b in 0..2 {
                let found = rows.cells(BodyId(b)).iter().filter(|c| c.cell == cell).count();
                let beside = (0..dim).flat_map(|a| [(a, -1), (a, 1)]).any(|(a, step)| {
                    let mut node = node;
                    node[a] += step;
                    inside(b, node)
                });
                let cut = rows.fraction.nodes(BodyId(b)).iter().any(|n| n.index == cell);
                prop_assert_eq!(found, usize::from(!solid && (beside || cut)), "body {} cell {}", b, cell);
            }
        }
    }
}

/// A wall along the faces of the grid cuts no cell, but has its rows, each of the area of a face. Anywhere else in a cell it has
/// as many.
#[test]
fn flat_walls_have_even_areas() {
    let lattice = lattice(3, [0.1; 3], 3.0);
    for shift in [0.0, 0.013, 0.05, 0.077] {
        let rows = placed(&lattice, &one(Brick([0.5, 0.4, 0.6]), [1.5, 1.5 + shift, 1.5], [0.0; 3]));
        let top = |c: &&WallCell| c.normal.y > 0.999 && c.foot.x.abs() < 0.4 && c.foot.z.abs() < 0.5;
        let top: Vec<_> = rows.cells(BodyId(0)).iter().filter(top).collect();
        assert_eq!(top.len(), 8 * 10);
        for cell in top {
            let y = if shift < 0.05 { 0.05 - shift } else { 0.15 - shift };
            assert!((cell.y - y).abs() < 1e-9, "{} {y}", cell.y);
            assert!((cell.area / 0.01 - 1.0).abs() < 1e-6, "{}", cell.area);
        }
    }
}

/// Rows of a body are the same wherever it sits on a periodic grid of equal cells.
#[test]
fn periodic_sides_are_crossed() {
    let lattice = lattice(3, [0.1; 3], 3.0);
    let at = |shift: f64| one(Brick([0.5, 0.3, 0.4]), [1.43 + shift, 1.52, 1.58 + shift], [0.3, 0.2, 0.1]);
    let [here, there] = [0.0, 1.5].map(|shift| placed(&lattice, &at(shift)));
    let key = |rows: &WallRows, shift: isize| {
        let mut list: Vec<_> = rows
            .cells(BodyId(0))
            .iter()
            .map(|c| {
                let [i, j, k] = lattice.node(c.cell);
                let distances = c.points.map(|p| p.map_or(0.0, |p| p.distance));
                (
                    lattice.index([i + shift, j, k + shift]).unwrap(),
                    [c.y, c.area, distances[0], distances[1], c.foot.x],
                )
            })
            .collect();
        list.sort_by_key(|row| row.0);
        list
    };
    let (a, b) = (key(&here, 15), key(&there, 0));
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(&b) {
        assert!(a.0 == b.0 && (0..5).all(|i| (a.1[i] - b.1[i]).abs() < 1e-9), "{a:?} {b:?}");
    }
}

/// Between near bodies, and a body and the next image of itself, there is no room for P₁ and P₂: the rows say so.
#[test]
fn near_bodies_lower_the_order() {
    let lattice = lattice(2, [0.05; 3], 3.0);
    let rows = |gap: f64| placed(&lattice, &Balls::new(2, 0.5, vec![[0.8, 1.2, 0.0], [1.8 + gap, 1.2, 0.0]]));
    assert_eq!(rows(0.5).lowered(), 0);
    let lowered: Vec<usize> = [0.2, 0.12, 0.05].iter().map(|gap| rows(*gap).lowered()).collect();
    assert!(0 < lowered[0] && lowered[0] < lowered[1] && lowered[1] < lowered[2], "{lowered:?}");
    let mut near = rows(0.05);
    let between = |row: &&WallRow| row.points[0].is_none();
    assert!(near.rows().iter().filter(between).count() > 0);
    let ones = vec![1.0; 3600];
    for row in near.fill(&[&ones, &ones], Some(&ones), 1.0, |_| Vector::zeros()).unwrap() {
        assert!(row.u_t.is_finite() && row.points.iter().flatten().all(|p| (p.k - 1.0).abs() < 1e-12));
    }
    // A bar nearly as long as the period, and the sides of a box.
    let bar = one(Brick([1.45, 0.2, 0.0]), [1.5, 1.5, 0.0], [0.0; 3]);
    assert!(placed(&lattice, &bar).lowered() > 0);
    let walled = cube_of(&Nodes::uniform(0.025, 0.05, 60, false), 2);
    assert!(placed(&walled, &Balls::new(2, 0.5, vec![[0.6, 1.5, 0.0]])).lowered() > 0);
}

/// The part of a surface that is in another body or outside the box is no wall.
#[test]
fn only_the_wet_surface_counts() {
    let walled = cube_of(&Nodes::uniform(0.05, 0.1, 30, false), 2);
    let half = area(&placed(&walled, &Balls::new(2, 0.5, vec![[0.0, 1.52, 0.0]])));
    assert!((half / (0.5 * PI) - 1.0).abs() < 0.03, "{half}");
    // Two discs whose centres are a radius apart: two thirds of each are seen.
    let lattice = lattice(2, [0.1; 3], 3.0);
    let both = placed(&lattice, &Balls::new(2, 0.5, vec![[1.24, 1.52, 0.0], [1.74, 1.52, 0.0]]));
    assert!((area(&both) / (TAU * 2.0 / 3.0) - 1.0).abs() < 0.03, "{}", area(&both));
    for row in both.rows() {
        let x = Point::from(lattice.position(lattice.node(row.cell)));
        assert!([1.24, 1.74].iter().all(|c| (x - Point::new(*c, 1.52, 0.0)).norm() > 0.5));
    }
}

/// After any moves the rows are those of bodies that have always been there; at rest nothing is done, and bodies that are gone
/// have none.
#[test]
fn rows_follow_the_bodies() {
    let lattice = lattice(3, [0.1; 3], 3.0);
    let mut bodies = Balls::new(3, 0.3, vec![[0.5, 0.5, 0.5], [1.2, 0.5, 0.5], [1.7, 1.9, 2.4]]);
    let mut rows = placed(&lattice, &bodies);
    for step in 0..6 {
        bodies.shift(1, Vector::new(0.11, 0.13, 0.17));
        bodies.shift(2, Vector::new(0.0, f64::from(step % 2), 0.0));
        rows.place(&lattice, &bodies).unwrap();
        assert_eq!(rows.rows(), placed(&lattice, &bodies).rows());
    }
    let (updates, before) = (rows.fraction.updates(), rows.rows().as_ptr());
    rows.place(&lattice, &bodies).unwrap();
    assert_eq!((rows.fraction.updates(), rows.rows().as_ptr()), (updates, before));
    rows.place(&lattice, &Balls::new(3, 0.3, vec![[0.5, 0.5, 0.5]])).unwrap();
    assert!(rows.rows().iter().all(|row| rows.cells(BodyId(0)).iter().any(|c| c.cell == row.cell)));
    rows.place(&lattice, &Balls::new(3, 0.3, vec![])).unwrap();
    assert!(rows.rows().is_empty() && rows.covered.iter().all(|c| !c) && rows.slots.iter().all(|s| *s == 0));
}

/// However the fields of a flow are stored, with ghosts around them: rows count the cells one after the other.
#[test]
fn rows_do_not_depend_on_the_storage() {
    let dense = cube_of(&stretched(true), 3);
    let [n, ..] = dense.shape();
    let stride = [1, n + 4, (n + 4) * (n + 4)];
    let ghosts = Lattice { base: 2 * stride.iter().sum::<usize>(), stride, ..dense.clone() };
    let bodies = Balls::new(3, 0.4, vec![[0.2, 1.5, 2.9]]);
    assert_eq!(placed(&dense, &bodies).rows(), placed(&ghosts, &bodies).rows());
}

#[test]
fn fields_that_do_not_fit_are_named() {
    let lattice = lattice(2, [0.1; 3], 3.0);
    let bodies = Balls::new(2, 0.5, vec![[1.0, 1.0, 0.0]]);
    let mut rows = placed(&lattice, &bodies);
    let (good, bad) = (vec![0.0; 900], vec![0.0; 899]);
    let still = |_: &WallCell| Vector::zeros();
    assert!(rows.fill(&[&good, &good], Some(&good), 1.0, still).is_ok());
    let error = IbmError::Storage { needed: 900, found: 899 };
    assert_eq!(rows.fill(&[&good, &bad], None, 1.0, still).unwrap_err(), error);
    assert_eq!(rows.fill(&[&good, &good], Some(&bad), 1.0, still).unwrap_err(), error);
    let error = IbmError::Components { needed: 2, found: 3 };
    assert_eq!(rows.fill(&[&good, &good, &good], None, 1.0, still).unwrap_err(), error);
    // A grid that a body does not fit on leaves no rows of the old one.
    let small = crate::testing::lattice(2, [0.1; 3], 0.5);
    assert!(matches!(rows.place(&small, &bodies), Err(IbmError::TooLarge { .. })));
    assert!(rows.rows().is_empty());
}
