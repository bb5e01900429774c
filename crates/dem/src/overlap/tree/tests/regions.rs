//! Regions of bodies that are not convex: none is missed, and what is said of them is held to.
use super::super::AdaptiveTree;
use super::super::roots::Region;
use super::*;

/// Four balls, one another's neighbours.
const HEAP: Given = Given {
    distance: |x| {
        let centres = [[0.0, 0.0, 0.0], [0.5, 0.1, 0.0], [-0.2, 0.45, 0.2], [-0.1, -0.3, 0.5]];
        centres.iter().map(|c| (x - Vector::from(*c)).norm() - 0.45).fold(f64::INFINITY, f64::min)
    },
    half: [0.95, 0.9, 0.95],
};
/// |x|⁴ + |y|⁴ + |z|⁴ = 1 stretched; a bound of its distance.
const PILLOW: Given = Given {
    distance: |x| {
        let p = Vector::new(x.x / 0.9, x.y / 0.5, x.z / 0.7);
        0.5 * (p.map(|c| c.powi(4)).sum().powf(0.25) - 1.0)
    },
    half: [0.9, 0.5, 0.7],
};

/// By a point in each cell of a grid, anywhere in it: the volume, and five times what this may be off by chance.
fn by_grid(a: &Given, b: &Given, at_b: &Pose) -> [f64; 2] {
    const N: usize = 96;
    let half = Vector::from(a.half);
    let cell = half * (2.0 / N as f64);
    let (mut inside, mut near, mut state) = (0.0, 0.0, 7_u64);
    let mut chance = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    for i in 0..N * N * N {
        let number = [i % N, i / N % N, i / (N * N)];
        let x = Vector::from_fn(|e, _| (number[e] as f64 + chance()) * cell[e] - half[e]);
        let depth = (a.distance)(x);
        if depth < cell.norm() {
            let depth = depth.max((b.distance)(at_b.to_body(Point::from(x)).coords));
            inside += f64::from(depth < 0.0);
            near += f64::from(depth.abs() < cell.norm());
        }
    }
    // Of each cell near a surface, no more than half its volume in the mean.
    [inside * cell.product(), 2.5 * near.sqrt() * cell.product()]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]
    /// Against points on a grid, which know nothing of regions.
    #[test]
    fn nothing_is_missed(
        which in 0_usize..6,
        direction in prop::array::uniform3(-1.0..1.0_f64),
        distance in 0.2..1.7_f64,
        turn in prop::array::uniform3(-3.0..3.0_f64),
    ) {
        let pairs = [
            (&TORUS, &TORUS), (&TORUS, &HEAP), (&HEAP, &HEAP), (&TORUS, &PILLOW), (&HEAP, &PILLOW), (&PILLOW, &PILLOW),
        ];
        let (a, b) = pairs[which];
        let way = Vector::from(direction).try_normalize(1e-3).unwrap_or(Vector::x()) * distance;
        let pose = turned(Pose::at(way.into()), turn);
        let [grid, chance] = by_grid(a, b, &pose);
        let patches = tolerance(1e-3).solve(a, &at(0.0, 0.0, 0.0), b, &pose).unwrap().to_vec();
        let volume: f64 = patches.iter().map(|p| p.volume).sum();
        prop_assert!((volume - grid).abs() <= 2e-3 * grid + chance, "{} {} {:?}", volume, grid, patches);
    }

    /// The normals of shallow contacts: to a degree at 1e-3, and the better the less is tolerated.
    #[test]
    fn normals_keep_to_the_tolerance(
        which in 0_usize..3,
        direction in prop::array::uniform3(-1.0..1.0_f64),
        turn in prop::array::uniform3(-3.0..3.0_f64),
        depth in 0.002..0.1_f64,
    ) {
        let (a, b) = [(&TORUS, &TORUS), (&TORUS, &PILLOW), (&PILLOW, &PILLOW)][which];
        let way = Vector::from(direction).try_normalize(1e-3).unwrap_or(Vector::x());
        let here = at(0.0, 0.0, 0.0);
        let mut rough = tolerance(1e-2);
        let mut distance = 2.2;
        while distance > 0.5 && rough.solve(a, &here, b, &turned(Pose::at((way * distance).into()), turn)).unwrap().is_empty() {
            distance -= 0.02;
        }
        let pose = turned(Pose::at((way * (distance - depth)).into()), turn);
        let mut solve = |t: f64| tolerance(t).solve(a, &here, b, &pose).unwrap().to_vec();
        let [coarse, fine, finest] = [1e-3, 1e-4, 1e-5].map(&mut solve);
        prop_assert_eq!(coarse.len(), finest.len());
        if let ([p], [q], [r]) = (&coarse[..], &fine[..], &finest[..]) {
            let degrees = [p, q].map(|o| o.normal.angle(&r.normal).to_degrees());
            prop_assert!(degrees[0] < 1.0 && degrees[1] < 0.2, "{:?} {:?}", degrees, coarse);
        }
    }
}

/// A second region a fortieth as wide as what the boxes share, by a plate under two balls, near or far from the first one.
#[test]
fn small_regions_are_found() {
    const PLATE: Given = Given {
        distance: |x| {
            let q = x.abs() - Vector::new(1.5, 1.0, 0.1);
            q.map(|q| q.max(0.0)).norm() + q.max().min(0.0)
        },
        half: [1.5, 1.0, 0.1],
    };
    // Radii 0.3 and 0.2, as deep as it takes: radii of the regions 0.224 and 0.028.
    const TWO: Given = Given {
        distance: |x| {
            let ball = |at: Vector, r: f64| (x - at).norm() - r;
            ball(Vector::new(-0.8, 0.1, 0.3), 0.3).min(ball(Vector::new(0.7, -0.2, 0.298), 0.2))
        },
        half: [1.1, 0.5, 0.65],
    };
    for turn in [[0.0; 3], [0.0, 0.0, 0.4], [0.0, 0.0, 1.3]] {
        let mut solver = tolerance(1e-3);
        let patches = solver
            .solve(&TWO, &turned(at(0.0, 0.0, 0.0), turn), &PLATE, &turned(at(0.0, 0.0, 0.0), turn))
            .unwrap();
        let cap = |r: f64, h: f64| PI * h * h * (3.0 * r - h) / 3.0;
        let mut volumes: Vec<f64> = patches.iter().map(|p| p.volume).collect();
        volumes.sort_by(f64::total_cmp);
        assert_eq!(volumes.len(), 2, "{patches:?}");
        for (found, exact) in volumes.iter().zip([cap(0.2, 0.002), cap(0.3, 0.1)]) {
            assert!((found / exact - 1.0).abs() < 2e-3, "{found} {exact}");
        }
    }
}

/// A tolerance that takes too many boxes is an error that says so, not a number.
#[test]
fn boxes_run_out_loudly() {
    // A cube with a round groove: neither convex nor smooth, nor are there flat faces to part it along.
    const GROOVED: Given = Given {
        distance: |x| {
            let q = x.abs() - Vector::repeat(0.5);
            let cube = q.map(|q| q.max(0.0)).norm() + q.max().min(0.0);
            let groove = x.x.hypot(x.z - 0.5) - 0.3;
            cube.max(-groove)
        },
        half: [0.5; 3],
    };
    let b = turned(at(0.2, 0.1, 0.8), [0.3, 0.2, 0.5]);
    let error = tolerance(1e-8).solve(&GROOVED, &at(0.0, 0.0, 0.0), &CUBE, &b).unwrap_err();
    let DemError::Boxes { boxes, error, .. } = error else { panic!("{error:?}") };
    assert!(boxes > 50_000 && error > 1e-8 && error < 1e-3, "{boxes} {error}");
}

/// Gradient and moment of a lens by its rim against those by columns in boxes.
#[test]
fn lenses_and_boxes_agree() {
    let b = turned(at(1.5, 0.3, 0.25), [0.4, 0.2, 0.3]);
    let lens = one(tolerance(1e-4).solve(&TORUS, &at(0.0, 0.0, 0.0), &TORUS, &b).unwrap());
    let mut boxes = tolerance(1e-5).with_normal(Normal::PlaneFit);
    let other = one(boxes.solve(&TORUS, &at(0.0, 0.0, 0.0), &TORUS, &b).unwrap());
    assert!(boxes.boxes().next().is_some());
    assert!((lens.volume / other.volume - 1.0).abs() < 1.2e-4, "{lens:?} {other:?}");
    let area = lens.area();
    assert!((lens.centroid - other.centroid).norm() < 1e-3 * area.sqrt());
    assert!((lens.gradient - other.gradient).norm() < 2e-2 * area, "{lens:?} {other:?}");
    assert!((lens.moment - other.moment).norm() < 2e-2 * area.powf(1.5), "{lens:?} {other:?}");
}

/// Two lenses whose boxes meet and who share nothing are measured as two lenses: a ball between two others that do not touch.
#[test]
fn lenses_whose_boxes_meet_have_no_boxes() {
    const TWO: Given = Given {
        distance: |x| (x - Vector::x() * 1.01).norm().min((x + Vector::x() * 1.01).norm()) - 1.0,
        half: [2.01, 1.0, 1.0],
    };
    for height in [1.2, 1.3, 1.4, 1.5] {
        let mut solver = tolerance(1e-3);
        let at_b = turned(at(0.0, 0.0, height), [0.3, -0.4, 0.5]);
        let patches = solver.solve(&TWO, &at(0.0, 0.0, 0.0), &BALL, &at_b).unwrap().to_vec();
        let exact = lens(1.01_f64.hypot(height));
        assert_eq!(patches.len(), 2, "{height}");
        for patch in patches {
            assert!((patch.volume / exact - 1.0).abs() < 1e-3, "{height} {patch:?}");
        }
        assert_eq!(solver.boxes().count(), 0, "{height}");
    }
}

/// Two heaps that share two regions, a gap of a twelfth of the way between them: the larger one was taken for known.
#[test]
fn a_region_behind_a_gap_is_not_missed() {
    let way = Vector::new(-0.578525086920355, 0.24442398505071153, -0.1505783283382215).normalize();
    let turn = [-0.7234808745748457, 2.865944496126956, 0.7757666574805523];
    let pose = turned(Pose::at((0.8989745568281442 * way).into()), turn);
    let [grid, chance] = by_grid(&HEAP, &HEAP, &pose);
    let mut solver = tolerance(1e-3);
    let patches = solver.solve(&HEAP, &at(0.0, 0.0, 0.0), &HEAP, &pose).unwrap();
    let volume: f64 = patches.iter().map(|p| p.volume).sum();
    assert!((volume - grid).abs() <= chance, "{volume} {grid}");
    assert!((volume / 0.0172222 - 1.0).abs() < 1e-3, "{volume}");
}

/// Volume, gradient and moment of regions with creases by rays against those by boxes.
#[test]
fn rays_and_boxes_agree() {
    let here = at(0.0, 0.0, 0.0);
    let mut by_rays = 0;
    for i in 0..40 {
        let angle = 2.4 * f64::from(i);
        let height = 1.0 - 2.0 * (f64::from(i) + 0.5) / 40.0;
        let flat = (1.0 - height * height).sqrt();
        let way = Vector::new(flat * angle.cos(), flat * angle.sin(), height);
        let pose = turned(Pose::at((0.9 * way).into()), [0.3 * angle, 1.0 - 0.1 * angle, 0.7]);
        let mut tree = AdaptiveTree::default();
        let mut found = Vec::new();
        tree.overlap(&HEAP, &here, &HEAP, &pose, &mut found).unwrap();
        let [root] = &tree.roots[..] else { continue };
        if !matches!(root.region, Some(Region::Bundle(_))) {
            continue;
        }
        by_rays += 1;
        let rays = found[0];
        found.clear();
        let again =
            allocation_counter::measure(|| tree.overlap(&HEAP, &here, &HEAP, &pose, &mut found).unwrap());
        assert_eq!(again.count_total, 0, "{i}");
        let mut boxes = tolerance(1e-4).with_normal(Normal::PlaneFit);
        let patches = boxes.solve(&HEAP, &here, &HEAP, &pose).unwrap();
        let [other] = patches else { panic!("{i} {patches:?}") };
        assert!((rays.volume / other.volume - 1.0).abs() < 1.1e-3, "{i} {rays:?} {other:?}");
        let area = other.area();
        assert!((rays.centroid - other.centroid).norm() < 3e-4 * area.sqrt(), "{i} {rays:?} {other:?}");
        assert!((rays.gradient - other.gradient).norm() < 1.5e-2 * area, "{i} {rays:?} {other:?}");
        assert!((rays.moment - other.moment).norm() < 4e-3 * area.powf(1.5), "{i} {rays:?} {other:?}");
    }
    // Seven without the sides along the rays, whose surfaces then do not close.
    assert!(by_rays >= 9, "{by_rays}");
}
