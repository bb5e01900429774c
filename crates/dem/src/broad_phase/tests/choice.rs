//! What the grid and the choice do with boxes that do not fit.
use super::super::{Automatic, BroadPhase, HierarchicalGrid};
use interfaces::{Aabb, Vector};

fn bed(n: usize) -> Vec<Aabb> {
    let at = |i: usize| [(i % 20) as f64, (i / 20 % 20) as f64, (i / 400) as f64];
    (0..n).map(|i| Aabb::around(at(i).into(), Vector::repeat(0.5))).collect()
}

fn crowding(boxes: &[Aabb]) -> f64 {
    let mut grid = HierarchicalGrid::new();
    grid.rebuild(boxes);
    grid.crowding()
}

/// Neither a few that fell out of the scene nor one that is as large as it crowd the cells of the others.
#[test]
fn strays_and_giants_do_not_crowd_the_cells() {
    let mut boxes = bed(4000);
    let alone = crowding(&boxes);
    assert!(alone < 3.0, "{alone}");
    for i in [17, 1234, 3999] {
        boxes[i] = Aabb::around([1e9, -1e8, i as f64].into(), Vector::repeat(0.5));
    }
    boxes[2000] = Aabb::around([10.0; 3].into(), Vector::repeat(30.0));
    let with_strays = crowding(&boxes);
    assert!(with_strays < 2.0 * alone + 2.0, "{with_strays}");
}

/// Two beds far apart have no good cells.
#[test]
fn clusters_are_put_in_a_tree() {
    let (mut boxes, mut automatic) = (bed(4000), Automatic::new());
    automatic.rebuild(&boxes);
    assert!(!automatic.is_tree());
    for b in &mut boxes[..2000] {
        *b = Aabb { min: b.min + Vector::repeat(1e9), max: b.max + Vector::repeat(1e9) };
    }
    automatic.rebuild(&boxes);
    assert!(automatic.is_tree());
}

/// A body that grows is given cells of its own size; else every query would be as wide as it.
#[test]
fn a_body_that_grows_gets_its_own_cells() {
    let (boxes, mut grid) = (bed(4000), HierarchicalGrid::new());
    grid.rebuild(&boxes);
    grid.update(7, &boxes[7].grown(0.1));
    assert_eq!(grid.levels(), 1);
    grid.update(7, &boxes[7].grown(10.0));
    assert_eq!(grid.levels(), 2);
}
