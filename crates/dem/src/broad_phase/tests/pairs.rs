//! The list against all pairs and images; its history, threads and broad phase do not matter.
use super::super::{NearPair, PairList, PairListError, meet};
use super::{all, boxes};
use interfaces::{Aabb, Periods, Vector};
use proptest::prelude::*;

/// All pairs, all images.
fn by_force(boxes: &[Aabb], movable: &[bool], periods: &Periods) -> Vec<NearPair> {
    let mut pairs = Vec::new();
    for (i, a) in boxes.iter().enumerate() {
        for (j, b) in boxes.iter().enumerate().skip(i).filter(|(j, _)| movable[i] || movable[*j]) {
            let [x, y, z] = [0, 1, 2].map(|axis| match periods.along(axis) {
                Some(l) => {
                    let from = ((a.min[axis] - b.max[axis]) / l).floor() as i32;
                    from..=((a.max[axis] - b.min[axis]) / l).ceil() as i32
                }
                None => 0..=0,
            });
            for (x, y) in x.flat_map(|x| y.clone().map(move |y| (x, y))) {
                for z in z.clone() {
                    let image = [x, y, z];
                    let by =
                        Vector::from_fn(|a, _| periods.along(a).map_or(0.0, |l| l * f64::from(image[a])));
                    let moved = Aabb { min: b.min + by, max: b.max + by };
                    if (i != j || image > [0; 3]) && meet(a, &moved) {
                        pairs.push(NearPair { a: i as u32, b: j as u32, image });
                    }
                }
            }
        }
    }
    pairs
}

fn periods(exact: bool) -> impl Strategy<Value = Periods> {
    let one = prop::option::of(4.0..16.0_f64);
    prop::array::uniform3(one).prop_map(move |lengths| {
        Periods::new(lengths.map(|l| l.map(|l| if exact { (8.0 * l).round() / 8.0 } else { l })))
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 80, failure_persistence: None, ..ProptestConfig::default() })]

    /// Bodies up to thousands of periods away, up to several periods long, at rest or not; touching counts.
    #[test]
    fn all_pairs_and_images_are_listed(
        boxes in (0.0..2.0_f64, 5.0..40.0_f64).prop_flat_map(|(decades, width)| boxes(30, width, decades, true)),
        periods in periods(true),
        rest in prop::collection::vec(0..4_u32, 30),
    ) {
        let movable: Vec<bool> = rest[..boxes.len()].iter().map(|r| *r > 0).collect();
        let expected = by_force(&boxes, &movable, &periods);
        for phase in all() {
            let mut list = PairList::with_broad_phase(periods, phase);
            list.list(&boxes, &movable).unwrap();
            prop_assert_eq!(list.pairs(), &expected[..], "{:?}", list);
        }
    }

    /// Small and large moves, over the sides of the base cell too, growth, bodies that come to rest: always the list made anew, to the bit,
    /// by whichever broad phase.
    #[test]
    fn history_does_not_matter(
        (boxes, to) in (0.0..2.0_f64, 5.0..40.0_f64).prop_flat_map(|(decades, width)| {
            (boxes(90, width, decades, false), boxes(60, width, decades, false))
        }),
        periods in periods(false),
        steps in prop::collection::vec((any::<prop::sample::Index>(), 0.0..1.0_f64, 0..8_u32), 60),
    ) {
        let mut lists = all().map(|phase| PairList::with_broad_phase(periods, phase));
        let (mut boxes, mut movable, n) = (boxes.clone(), vec![true; boxes.len()], boxes.len());
        for (k, some) in steps.chunks(5).enumerate() {
            let mut changed = Vec::new();
            for (which, step, kind) in some.iter().filter(|_| n > 0) {
                let i = which.index(n);
                let by = (step - 0.5) * boxes[i].extent();
                match kind {
                    0 if !to.is_empty() => boxes[i] = to[i % to.len()],
                    1 => boxes[i] = boxes[i].grown(0.3 * by.x.abs()),
                    2 if k % 4 == 0 => movable[i] = !movable[i],
                    _ => boxes[i] = Aabb { min: boxes[i].min + by, max: boxes[i].max + by },
                }
                changed.push(i as u32);
            }
            let mut anew = PairList::new(periods).serial();
            anew.list(&boxes, &movable).unwrap();
            for list in &mut lists {
                list.refresh(&boxes, &movable, &changed).unwrap();
                prop_assert_eq!(list.pairs(), anew.pairs(), "{:?}", list);
            }
        }
    }
}

/// A corner is shared, seven images away in each direction; a body meets its own images over faces, edges and corners.
#[test]
fn images_are_counted_from_where_bodies_are() {
    let at = |x: f64, half: f64| Aabb::around([x; 3].into(), Vector::repeat(half));
    let mut list = PairList::new(Periods::new([Some(10.0); 3]));
    list.list(&[at(0.5, 0.5), at(-60.5, 0.5)], &[true; 2]).unwrap();
    assert_eq!(list.pairs(), [NearPair { a: 0, b: 1, image: [6; 3] }]);
    list.list(&[at(123.0, 5.0)], &[true]).unwrap();
    assert_eq!(list.pairs().len(), 13);
    assert!(list.pairs().iter().all(|p| p.a == 0 && p.b == 0 && p.image > [0; 3]));
    // Over 15 periods: all distances up to 15, but its own place, each once for both directions.
    list.list(&[at(0.0, 75.0)], &[true]).unwrap();
    assert_eq!(list.pairs().len(), (31_usize.pow(3) - 1) / 2);
}

/// As many threads as there are, or none, over a number of bodies that is no multiple of anything.
#[cfg(feature = "parallel")]
#[test]
fn threads_do_not_matter() {
    let n = 5003_usize;
    let mut state = 1_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let boxes: Vec<Aabb> = (0..n)
        .map(|_| {
            let half = 0.3 * 4.0_f64.powf(random());
            Aabb::around([20.0 * random(), 20.0 * random(), 20.0 * random()].into(), Vector::repeat(half))
        })
        .collect();
    let movable: Vec<bool> = (0..n).map(|i| i % 5 > 0).collect();
    for periods in [Periods::default(), Periods::new([Some(20.0), None, Some(19.0)])] {
        let mut serial = PairList::new(periods).serial();
        serial.list(&boxes, &movable).unwrap();
        assert!(serial.pairs().len() > 10_000 && serial.pairs().is_sorted());
        for threads in [2, 3, 7] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            for phase in all() {
                let mut list = PairList::with_broad_phase(periods, phase);
                pool.install(|| list.list(&boxes, &movable)).unwrap();
                assert!(list.pairs() == serial.pairs(), "{threads} threads");
            }
        }
    }
}

/// Typed errors, and the list stays what it was.
#[test]
fn what_is_no_box_is_refused() {
    let unit = Aabb::around([0.0; 3].into(), Vector::repeat(0.5));
    let good = [unit, unit];
    let periods = Periods::new([None, Some(4.0), None]);
    let mut list = PairList::new(periods);
    list.list(&good, &[true; 2]).unwrap();
    let mut refused = |bad: Aabb, is: fn(&PairListError) -> bool| {
        for error in [
            list.list(&[unit, bad], &[true; 2]).unwrap_err(),
            list.refresh(&[unit, bad], &[true; 2], &[1]).unwrap_err(),
        ] {
            assert!(is(&error), "{error}");
            assert_eq!(list.pairs(), [NearPair { a: 0, b: 1, image: [0; 3] }]);
        }
    };
    let is_box = |e: &PairListError| matches!(e, PairListError::Box { body: 1, .. });
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for a in 0..3 {
            let (mut low, mut high) = (unit, unit);
            (low.min[a], high.max[a]) = (x, x);
            refused(low, is_box);
            refused(high, is_box);
        }
    }
    refused(Aabb { min: unit.max, max: unit.min }, is_box);
    let around = |y: f64, half: f64| Aabb::around([0.0, y, 0.0].into(), Vector::new(1.0, half, 1.0));
    refused(around(0.0, 501.0), |e| matches!(e, PairListError::Size { body: 1, axis: 1, .. }));
    refused(around(3e9, 1.0), |e| matches!(e, PairListError::Far { body: 1, axis: 1, .. }));
    refused(around(f64::MAX, 0.0), |e| matches!(e, PairListError::Far { body: 1, axis: 1, .. }));
    let changed = list.refresh(&good, &[true; 2], &[2]);
    assert_eq!(changed, Err(PairListError::Changed { body: 2, boxes: 2 }));
    assert_eq!(list.list(&good, &[true]), Err(PairListError::Movable { boxes: 2, movable: 1 }));
    for period in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let mut list = PairList::new(Periods::new([None, None, Some(period)]));
        assert!(matches!(list.list(&good, &[true; 2]), Err(PairListError::Period { axis: 2, .. })));
        assert!(list.pairs().is_empty());
    }
}
