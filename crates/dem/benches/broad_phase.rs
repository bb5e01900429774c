//! Nanoseconds per body for every broad phase: rebuild, all queries, list (both, and the sorted pairs), refresh after 1 % of the
//! bodies went a tenth of their size. One thread, its CPU time, best of many; thresholds of `Automatic` come from here.
//!
//! `cargo bench -p siltflow-dem --bench broad_phase -- [part of a scene's name] [number of bodies] [part of a way's name]`
use cpu_time::ThreadTime;
use dem::{Automatic, BroadPhase, HierarchicalGrid, LinkedCells, PairList, RTree, Sweep};
use interfaces::{Aabb, Periods, Point, Vector};
use std::hint::black_box;

/// Numbers between 0 and 1 (Knuth's linear congruence).
struct Random(u64);
impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

type Make = fn() -> Box<dyn BroadPhase>;

struct Scene {
    name: String,
    boxes: Vec<Aabb>,
    periods: Periods,
}

fn main() {
    let mut args = std::env::args().skip(1).filter(|a| !a.starts_with('-'));
    let only = args.next().unwrap_or_default();
    let number: Option<usize> = args.next().map(|a| a.parse().expect("a number of bodies"));
    let way = args.next().unwrap_or_default();
    let all = [10, 20, 50, 100, 1000, 10_000, 100_000];
    println!("scene | bodies | pairs per body | broad phase | rebuild | queries | list | refresh of 1 %");
    for &n in number.as_ref().map_or(&all[..], std::slice::from_ref) {
        for scene in scenes(n).iter().filter(|s| s.name.contains(&only)) {
            measure(scene, &way);
        }
    }
}

/// Cubes in random order of numbers.
fn scenes(n: usize) -> Vec<Scene> {
    let mut all = vec![dense(n, "dense", None), dense(n, "dense, periodic", Some(1.0))];
    all.push(dilute(n));
    for ratio in [10.0, 100.0, 1000.0] {
        all.push(mixed(n, ratio, 0.0));
        all.push(mixed(n, ratio, 3.0));
    }
    let mut huge = dense(n, "dense and one over all", None);
    huge.boxes[n / 2] = hull(&huge.boxes);
    all.push(huge);
    let mut huge = dense(n, "dense and one over all, periodic", Some(1.0));
    huge.boxes[n / 2] = hull(&huge.boxes);
    all.push(huge);
    let mut stray = dense(n, "dense and one astray", None);
    stray.boxes[n / 2] = Aabb::around([1e9; 3].into(), Vector::repeat(0.5));
    all.push(stray);
    let mut clusters = dense(n, "two clusters", None);
    for b in &mut clusters.boxes[..n / 2] {
        *b = Aabb { min: b.min + Vector::repeat(1e6), max: b.max + Vector::repeat(1e6) };
    }
    all.push(clusters);
    all
}

/// A lattice that was shaken, with about six pairs per body.
fn dense(n: usize, name: &str, period: Option<f64>) -> Scene {
    let mut random = Random(1);
    let side = (n as f64).cbrt().ceil() as usize;
    let mut places: Vec<usize> = (0..side * side * side).collect();
    for i in (1..places.len()).rev() {
        places.swap(i, (random.next() * (i + 1) as f64) as usize);
    }
    let boxes = places[..n].iter().map(|p| {
        let place = Point::new((p % side) as f64, (p / side % side) as f64, (p / side / side) as f64);
        let shake = Vector::from_fn(|_, _| 0.6 * (random.next() - 0.5));
        Aabb::around(place + shake, Vector::repeat(0.55))
    });
    let boxes = boxes.collect();
    Scene { name: name.into(), boxes, periods: Periods::new([period.map(|p| p * side as f64); 3]) }
}

/// One body per thousand volumes of its box.
fn dilute(n: usize) -> Scene {
    let mut random = Random(3);
    let side = (1000.0 * n as f64).cbrt();
    let mut place = || Point::from(Vector::from_fn(|_, _| side * random.next()));
    let boxes = (0..n).map(|_| Aabb::around(place(), Vector::repeat(0.5))).collect();
    Scene { name: "dilute".into(), boxes, periods: Periods::default() }
}

/// Sizes from 1 to `ratio`, as many per decade, or as much volume per decade (`power` 3); all boxes together have 1.5 times the volume they are in.
fn mixed(n: usize, ratio: f64, power: f64) -> Scene {
    let mut random = Random(2);
    let mut size = || match random.next() {
        u if power == 0.0 => ratio.powf(u),
        u => (1.0 - u * (1.0 - ratio.powf(-power))).powf(-1.0 / power),
    };
    let halves: Vec<f64> = (0..n).map(|_| 0.5 * size()).collect();
    let volume: f64 = halves.iter().map(|h| (2.0 * h).powi(3)).sum();
    let side = (volume / 1.5).cbrt();
    let mut place = || Point::from(Vector::from_fn(|_, _| side * random.next()));
    let boxes = halves.iter().map(|h| Aabb::around(place(), Vector::repeat(*h))).collect();
    let name = format!("sizes 1 to {ratio}, {}", if power == 0.0 { "by number" } else { "by volume" });
    Scene { name, boxes, periods: Periods::default() }
}

fn hull(boxes: &[Aabb]) -> Aabb {
    let join = |a: Aabb, b: &Aabb| Aabb { min: a.min.inf(&b.min), max: a.max.sup(&b.max) };
    boxes.iter().fold(boxes[0], join)
}

fn measure(scene: &Scene, only: &str) {
    let n = scene.boxes.len();
    let ways: [(&str, Make); 5] = [
        ("sweep", || Box::new(Sweep::new())),
        ("cells", || Box::new(LinkedCells::new())),
        ("cells by size", || Box::new(HierarchicalGrid::new())),
        ("tree", || Box::new(RTree::new())),
        ("automatic", || Box::new(Automatic::new())),
    ];
    for (name, make) in ways.into_iter().filter(|w| w.0.contains(only)) {
        let crowded = scene.name.contains("clusters")
            || scene.name.contains("sizes")
            || scene.name.contains("over all");
        if n > 10_000 && (name == "sweep" || name == "cells" && crowded && !scene.name.contains("sizes"))
            || n > 10_000 && name == "cells by size" && scene.name.contains("clusters")
        {
            continue;
        }
        let mut way = make();
        let rebuild = best(n, || way.rebuild(&scene.boxes));
        let mut found = Vec::new();
        let queries = best(n, || {
            for b in &scene.boxes {
                found.clear();
                way.meeting(b, &mut found);
                black_box(&found);
            }
        });
        let movable = vec![true; n];
        let mut pairs = PairList::with_broad_phase(scene.periods, make()).serial();
        let list = best(n, || pairs.list(&scene.boxes, &movable).unwrap());
        let count = pairs.pairs().len() as f64 / n as f64;
        let mut random = Random(4);
        let mut boxes = scene.boxes.clone();
        let some = n.div_ceil(100);
        let mut changed = vec![0; some];
        let refresh = best(n, || {
            for c in &mut changed {
                *c = ((random.next() * n as f64) as u32).min(n as u32 - 1);
                let size = scene.boxes[*c as usize].extent().x;
                let by = Vector::from_fn(|_, _| 0.2 * size * (random.next() - 0.5));
                let b = &scene.boxes[*c as usize];
                boxes[*c as usize] = Aabb { min: b.min + by, max: b.max + by };
            }
            pairs.refresh(&boxes, &movable, &changed).unwrap();
        });
        println!(
            "{} | {n} | {count:.2} | {name} | {rebuild:.1} | {queries:.1} | {list:.1} | {refresh:.1}",
            scene.name
        );
    }
}

/// Least CPU time of a call \[ns per body\].
fn best(n: usize, mut call: impl FnMut()) -> f64 {
    let calls = (20_000 / n).max(1);
    let mut least = f64::INFINITY;
    let start = ThreadTime::now();
    let mut runs = 0;
    while runs < 4 || start.elapsed().as_secs_f64() < 0.15 {
        let one = ThreadTime::now();
        (0..calls).for_each(|_| call());
        least = least.min(one.elapsed().as_secs_f64() * 1e9 / (calls * n) as f64);
        runs += 1;
    }
    least
}
