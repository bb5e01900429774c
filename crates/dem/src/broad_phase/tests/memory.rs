//! What memory is needed.
use super::super::{Automatic, BroadPhase, HierarchicalGrid, LinkedCells, PairList, Sweep};
use interfaces::{Aabb, Periods, Vector};

fn lattice(n: usize) -> Vec<Aabb> {
    let at = |i: usize| [(i % 12) as f64, (i / 12 % 12) as f64, (i / 144) as f64];
    (0..n)
        .map(|i| Aabb::around(at(i * 7 % n).into(), Vector::repeat(0.55 + 0.4 * (i % 9 / 8) as f64)))
        .collect()
}

/// Not the tree, whose nodes are allocated one by one.
#[test]
fn a_warmed_up_list_allocates_nothing() {
    let phases: [fn() -> Box<dyn BroadPhase>; 4] = [
        || Box::new(Sweep::new()),
        || Box::new(LinkedCells::new()),
        || Box::new(HierarchicalGrid::new()),
        || Box::new(Automatic::new()),
    ];
    for make in phases {
        for periods in [Periods::default(), Periods::new([Some(12.0); 3])] {
            for n in [20, 1728] {
                let mut list = PairList::with_broad_phase(periods, make()).serial();
                let (start, movable) = (lattice(n), vec![true; n]);
                let mut moved = start.clone();
                let changed: Vec<u32> = (0..n as u32 / 10).map(|i| i * 3).collect();
                for i in &changed {
                    // Some stay in their cells, some do not.
                    let by = if i % 2 == 0 { 0.1 } else { 1.7 };
                    moved[*i as usize].min += Vector::repeat(by);
                    moved[*i as usize].max += Vector::repeat(by);
                }
                let mut run = || {
                    list.list(&start, &movable).unwrap();
                    list.refresh(&moved, &movable, &changed).unwrap();
                    list.refresh(&start, &movable, &changed).unwrap();
                    list.refresh(&moved, &movable, &changed[..1]).unwrap();
                    list.list(&moved, &movable).unwrap();
                };
                (0..3).for_each(|_| run());
                let counted = allocation_counter::measure(run);
                assert_eq!(counted.count_total, 0, "{n} bodies, {periods:?}, {:?}", list);
            }
        }
    }
}

/// Memory is by the number of bodies, not by the space between them.
#[test]
fn bodies_far_apart_need_no_more_memory() {
    for far in [1, 500] {
        let mut boxes = lattice(1000);
        for b in &mut boxes[..far] {
            *b = Aabb::around([1e9, -1e9, 1e9].into(), Vector::repeat(1e-3));
        }
        let mut list =
            PairList::with_broad_phase(Periods::default(), Box::new(HierarchicalGrid::new())).serial();
        let counted = allocation_counter::measure(|| list.list(&boxes, &[true; 1000]).unwrap());
        assert!(counted.bytes_max < 10_000_000, "{counted:?}");
    }
}
