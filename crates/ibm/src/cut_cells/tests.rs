use super::*;
use crate::testing::{Balls, Brick, Staggered};
use interfaces::Pose;
use std::f64::consts::PI;

/// A ball of radius 1 in a periodic box of 4.
fn ball(dim: usize, n: usize) -> (Staggered, CutCells) {
    let h = 4.0 / n as f64;
    let bodies = Balls::new(dim, 1.0, vec![[2.013, 1.971, if dim == 2 { 0.0 } else { 2.04 }]]);
    let field =
        if dim == 2 { Staggered::new([n, n], h, [0.0; 2]) } else { Staggered::new([n; 3], h, [0.0; 3]) };
    let cells = cut_cells(&field, &bodies).unwrap();
    (field, cells)
}

#[test]
fn walls_have_the_area_of_a_ball() {
    let error = |dim: usize, n: usize| {
        let (_, cells) = ball(dim, n);
        let exact = if dim == 2 { 2.0 * PI } else { 4.0 * PI };
        let middle = Point::new(2.013, 1.971, if dim == 2 { 0.0 } else { 2.04 });
        for wall in &cells.walls {
            let out = (wall.foot - middle).normalize();
            assert!((wall.foot - middle).norm() - 1.0 < 0.1 * (4.0 / n as f64).powi(2));
            assert!(out.dot(&wall.normal) > 0.9, "{wall:?}");
            assert!((wall.arm - (wall.foot - middle)).norm() < 1e-12);
        }
        (cells.walls.iter().map(|w| w.area).sum::<f64>() / exact - 1.0).abs()
    };
    for (dim, n) in [(2, 20), (3, 16)] {
        let errors = [error(dim, n), error(dim, 2 * n)];
        assert!(errors[1] < 4e-3 && errors[1] < errors[0] / 3.0, "{errors:?}");
    }
}

#[test]
fn open_parts_are_those_of_the_faces() {
    // Against sums over many points.
    for (dim, n) in [(2, 20), (3, 24)] {
        let (field, cells) = ball(dim, n);
        let h = 4.0 / n as f64;
        let points = if dim == 2 { 20_000 } else { 200 };
        let middle = Vector::new(2.013, 1.971, if dim == 2 { 0.0 } else { 2.04 });
        for a in 0..dim {
            for face in &cells.faces[a] {
                let lattice = field.lattice(a);
                let x = lattice.position(lattice.node(face.index));
                // In space the distance is linear between points at most h apart, so h²/8 off at the most; along the face it changes at the rate r, the radius of the circle in which the face's plane cuts
                // the ball, and the wall is at most √2 h long there.
                let from_centre = x[a] - [2.013, 1.971, 2.04][a];
                let circle = (1.0 - from_centre * from_centre).max(0.0).sqrt().max(h);
                let within = if dim == 2 { 1e-4 } else { 2f64.sqrt() * h / (8.0 * circle) };
                let along = [(a + 1) % dim, (a + 2) % dim];
                // Vertices within a hundredth of a cell are on the wall: that of a ball so much larger at the most.
                let (mut open, mut centre, mut far) = (0.0, Vector::zeros(), 0.0);
                let count = if dim == 2 { points } else { points * points };
                for p in 0..count {
                    let mut at = x;
                    at[along[0]] += h * (((p % points) as f64 + 0.5) / points as f64 - 0.5);
                    if dim == 3 {
                        at[along[1]] += h * (((p / points) as f64 + 0.5) / points as f64 - 0.5);
                    }
                    let arm = Vector::from(at) - middle;
                    if arm.norm() > 1.0 {
                        open += 1.0;
                        centre += Vector::from(at);
                        far += f64::from(arm.norm() > 1.0 + 0.01 * h);
                    }
                }
                let near = |k: usize| {
                    let mut at = Vector::from(x);
                    for (bit, axis) in along.into_iter().enumerate().take(dim - 1) {
                        at[axis] += h * ((k >> bit & 1) as f64 - 0.5);
                    }
                    (0.0..=0.01 * h).contains(&((at - middle).norm() - 1.0))
                };
                let [most, least] =
                    [open, if (0..4).any(near) { far } else { open }].map(|n| n / count as f64);
                assert!(face.open < most + within && face.open > least - within, "{face:?} {least} {most}");
                if face.open == 0.0 {
                    continue;
                }
                let within = within + most - least;
                // An area that is wrongly open, or shut, lies in the face: its moment is at most h times the area.
                let moment = face.open * (face.centre.coords - centre / open).norm();
                assert!(moment < within * h, "{face:?} {moment}");
            }
        }
    }
}

#[test]
fn walls_along_the_lines_leave_no_slivers() {
    // Round-off must not decide.
    let n = 20;
    let bodies = Balls::of(Brick([1.0, 0.6, 0.0]), 2.4, vec![Pose::at([2.0, 2.2 - 1e-15, 0.0])]);
    let cells = cut_cells(&Staggered::new([n, n], 0.2, [0.0; 2]), &bodies).unwrap();
    assert!(cells.faces.iter().flatten().all(|f| f.open == 0.0));
    let area: f64 = cells.walls.iter().map(|w| w.area).sum();
    assert!((area - 6.4).abs() < 1e-12 && cells.walls.len() == 32, "{area} {}", cells.walls.len());
}

/// Numbers of ten digits put a wall that far from the lines of the grid: no slivers, whose pressure nobody could find.
#[test]
fn a_wall_all_but_on_a_line_of_the_grid_leaves_no_slivers() {
    for off in [-1e-8, -1e-10, 1e-10, 1e-8] {
        let bodies = Balls::of(Brick([1.0, 0.6, 0.0]), 2.4, vec![Pose::at([2.0, 2.2 + off, 0.0])]);
        let cells = cut_cells(&Staggered::new([20, 20], 0.2, [0.0; 2]), &bodies).unwrap();
        let part = |f: &&OpenFace| f.open > 0.0 && f.open < 1.0 - 1e-6;
        assert_eq!(cells.faces.iter().flatten().filter(part).count(), 0, "{off}");
    }
}

#[test]
fn a_gap_with_one_way_in_is_closed() {
    // Two bricks and one behind them leave a blind alley of one cell's width.
    let bodies = Balls::of(
        Brick([1.0, 0.5, 0.0]),
        2.0,
        vec![Pose::at([2.0, 1.5, 0.0]), Pose::at([2.0, 2.6, 0.0]), Pose::at([3.95, 2.0, 0.0])],
    );
    let field = Staggered::new([60, 60], 0.1, [0.0; 2]);
    let cells = cut_cells(&field, &bodies).unwrap();
    let lattice = field.lattice(0);
    let shut = cells.faces[0].iter().filter(|f| f.open == 0.0);
    let alley = shut.filter(|f| {
        let x = lattice.position(lattice.node(f.index));
        (x[1] - 2.05).abs() < 1e-9 && x[0] > 1.0 && x[0] < 2.9
    });
    assert_eq!(alley.count(), 18);
}

/// A wall a little behind a line of the grid leaves the cells between to nobody, but where it is is not forgotten.
#[test]
fn a_wall_a_little_behind_a_line_of_the_grid_leaves_no_slivers() {
    for (dim, off) in [(2, 2e-4), (2, 1.8e-3), (3, 2e-4), (3, 1.8e-3)] {
        let z = if dim == 2 { 0.0 } else { 2.0 };
        let half = [1.0, 0.6, 0.5 * z];
        let bodies = Balls::of(Brick(half), 2.4, vec![Pose::at([2.0, 2.2 - off, z])]);
        let field = if dim == 2 {
            Staggered::new([20; 2], 0.2, [0.0; 2])
        } else {
            Staggered::new([20; 3], 0.2, [0.0; 3])
        };
        let cells = cut_cells(&field, &bodies).unwrap();
        let sliver = |f: &&OpenFace| f.open > 0.0 && f.open < 0.5;
        assert_eq!(cells.faces.iter().flatten().filter(sliver).count(), 0, "{dim} {off}");
        let tops: Vec<_> = cells.walls.iter().filter(|wall| wall.normal.y > 0.9).collect();
        assert_eq!(tops.len(), if dim == 2 { 10 } else { 100 });
        for wall in tops {
            assert!((wall.foot.y - 2.8 + off).abs() < 1e-12, "{wall:?}");
        }
    }
}
