//! Against all pairs and all images; against one another.
mod choice;
mod memory;
mod pairs;
mod queries;

use super::{Automatic, BroadPhase, HierarchicalGrid, LinkedCells, RTree, Sweep};
use interfaces::{Aabb, Vector};
use proptest::prelude::*;

fn all() -> [Box<dyn BroadPhase>; 5] {
    [
        Box::new(Sweep::new()),
        Box::new(LinkedCells::new()),
        Box::new(HierarchicalGrid::new()),
        Box::new(RTree::new()),
        Box::new(Automatic::new()),
    ]
}

/// Boxes of sizes over `decades`, points and plates among them, some far away; on multiples of 1/16 m if `exact`, so that many
/// touch, and sums are exact.
fn boxes(count: usize, width: f64, decades: f64, exact: bool) -> impl Strategy<Value = Vec<Aabb>> {
    let number = 0.0..1.0_f64;
    let one =
        (prop::array::uniform3(number.clone()), prop::array::uniform3(number.clone()), number, 0..40_u32);
    let one = one.prop_map(move |(place, shape, size, kind)| {
        let size = 10.0_f64.powf(decades * (size - 0.5));
        let mut half = Vector::from(shape).map(|s| size * (0.3 + 0.7 * s));
        match kind {
            0 => half.fill(0.0),
            1 => half.z = 0.0,
            _ => {}
        }
        let mut centre = Vector::from(place).map(|x| width * (x - 0.5));
        if kind == 2 {
            centre *= 1000.0;
        }
        if exact {
            (half, centre) =
                (half.map(|x| (16.0 * x).round() / 16.0), centre.map(|x| (16.0 * x).round() / 16.0));
        }
        Aabb::around(centre.into(), half)
    });
    prop::collection::vec(one, 0..count)
}
