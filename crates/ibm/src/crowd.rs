//! Which bodies are near others.
use interfaces::{Aabb, Vector};
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

/// Of every box, whether it meets no other, in a space with these periods (zero where it does not repeat), by an R*-tree of the
/// boxes. A box longer than half a period is taken to meet all.
pub(crate) fn are_alone(boxes: &[Aabb], periods: Vector) -> Vec<bool> {
    // Where the middle is between zero and a period.
    let moved = |b: &Aabb| {
        let middle = nalgebra::center(&b.min, &b.max);
        let shift = Vector::from_fn(|a, _| {
            if periods[a] > 0.0 { -periods[a] * (middle[a] / periods[a]).floor() } else { 0.0 }
        });
        Aabb { min: b.min + shift, max: b.max + shift }
    };
    let corners = |b: &Aabb| (<[f64; 3]>::from(b.min), <[f64; 3]>::from(b.max));
    let inside: Vec<Aabb> = boxes.iter().map(moved).collect();
    let rectangles = inside.iter().enumerate().map(|(k, b)| {
        let (min, max) = corners(b);
        GeomWithData::new(Rectangle::from_corners(min, max), k)
    });
    let tree = RTree::bulk_load(rectangles.collect());
    let mut alone = vec![true; boxes.len()];
    for (k, b) in inside.iter().enumerate() {
        let long = (0..3).any(|a| periods[a] > 0.0 && b.extent()[a] > 0.5 * periods[a]);
        if long {
            alone.fill(false);
            break;
        }
        // Images of this box where it leaves through a side; those of the others find it.
        let turns = |a: usize| {
            let (low, high) = (b.min[a] < 0.0, b.max[a] >= periods[a]);
            [Some(0.0), (periods[a] > 0.0 && low).then_some(1.0), (periods[a] > 0.0 && high).then_some(-1.0)]
        };
        let all = |a: usize| turns(a).into_iter().flatten().map(move |turn| turn * periods[a]);
        for shift in all(0).flat_map(|x| all(1).flat_map(move |y| all(2).map(move |z| Vector::new(x, y, z))))
        {
            let (min, max) = corners(&Aabb { min: b.min + shift, max: b.max + shift });
            let met = tree.locate_in_envelope_intersecting(AABB::from_corners(min, max));
            for other in met.filter(|other| other.data != k) {
                (alone[k], alone[other.data]) = (false, false);
            }
        }
    }
    alone
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::Point;
    use proptest::prelude::*;

    proptest! {
        /// As each pair tells, over its nearest images.
        #[test]
        fn those_alone_meet_no_other(
            places in proptest::collection::vec((-3.0..6.0_f64, -3.0..6.0_f64, 0.1..0.9_f64), 1..12), flat: bool,
        ) {
            let periods = Vector::new(3.0, if flat { 0.0 } else { 4.0 }, 0.0);
            let half = |size: f64| Vector::new(0.5 * size, 0.3 * size, 0.0);
            let boxes: Vec<_> = places.iter().map(|&(x, y, size)| Aabb::around(Point::new(x, y, 0.0), half(size))).collect();
            let alone = are_alone(&boxes, periods);
            for (k, a) in boxes.iter().enumerate() {
                let meets = |b: &Aabb| (0..2).all(|axis| {
                    let mut apart = 0.5 * (a.min + a.max.coords - b.min.coords - b.max.coords)[axis];
                    if periods[axis] > 0.0 {
                        apart -= periods[axis] * (apart / periods[axis]).round();
                    }
                    apart.abs() <= 0.5 * (a.extent() + b.extent())[axis]
                });
                let met = boxes.iter().enumerate().any(|(other, b)| other != k && meets(b));
                prop_assert_eq!(alone[k], !met, "{}", k);
            }
        }
    }

    #[test]
    fn a_box_as_long_as_the_period_is_not_alone() {
        let boxes =
            [0.2, 5.0].map(|half| Aabb::around(Point::new(1.0, 20.0 * half, 0.0), Vector::repeat(half)));
        assert_eq!(are_alone(&boxes, Vector::new(10.5, 0.0, 0.0)), [false, false]);
        assert_eq!(are_alone(&boxes, Vector::zeros()), [true, true]);
    }
}
