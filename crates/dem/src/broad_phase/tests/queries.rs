//! Every broad phase against a look at all boxes.
use super::super::{BroadPhase, meet};
use super::{all, boxes};
use interfaces::Aabb;
use proptest::prelude::*;

fn meeting(phase: &dyn BroadPhase, target: &Aabb) -> Vec<u32> {
    // What was found before stays.
    let mut found = vec![u32::MAX];
    phase.meeting(target, &mut found);
    assert_eq!(found.remove(0), u32::MAX);
    found.sort_unstable();
    found
}

fn expect_all(phase: &dyn BroadPhase, boxes: &[Aabb], targets: &[Aabb]) {
    for target in boxes.iter().chain(targets) {
        let expected: Vec<u32> =
            (0..boxes.len()).filter(|i| meet(&boxes[*i], target)).map(|i| i as u32).collect();
        assert_eq!(meeting(phase, target), expected, "{target:?} by {phase:?}");
    }
    // Every two that meet, once.
    let (mut pairs, mut expected) = (Vec::new(), Vec::new());
    for place in 0..boxes.len() {
        let i = phase.order().get(place).map_or(place as u32, |i| *i);
        let mut found = Vec::new();
        phase.partners(place, &boxes[i as usize], &mut found);
        pairs.extend(found.iter().map(|j| (i.min(*j), i.max(*j))));
        let higher = (i + 1..boxes.len() as u32).filter(|j| meet(&boxes[i as usize], &boxes[*j as usize]));
        expected.extend(higher.map(|j| (i, j)));
    }
    pairs.sort_unstable();
    expected.sort_unstable();
    assert_eq!(pairs, expected, "{phase:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    /// Mixed sizes, touching boxes, boxes far away; then after updates, near and far, small and large.
    #[test]
    fn queries_find_what_is_there(
        (boxes, targets, to) in (0.0..3.0_f64, 2.0..30.0_f64, any::<bool>()).prop_flat_map(|(decades, width, exact)| {
            (boxes(200, width, decades, exact), boxes(20, width, decades, exact), boxes(120, width, decades, exact))
        }),
        near in any::<bool>(),
        steps in prop::collection::vec(0.0..1.0_f64, 120),
    ) {
        for mut phase in all() {
            // Something else before, and more of it.
            phase.rebuild(&[&to[..], &boxes[..], &targets[..]].concat());
            phase.rebuild(&boxes);
            expect_all(&*phase, &boxes, &targets);
            let (mut boxes, n) = (boxes.clone(), boxes.len());
            for (k, to) in to.iter().enumerate().filter(|_| n > 0) {
                let i = k * 7 % n;
                if near {
                    let by = 0.5 * (steps[k] - 0.5) * boxes[i].extent();
                    boxes[i] = Aabb { min: boxes[i].min + by, max: boxes[i].max + by };
                } else {
                    boxes[i] = *to;
                }
                phase.update(i, &boxes[i]);
            }
            expect_all(&*phase, &boxes, &targets);
        }
    }
}
