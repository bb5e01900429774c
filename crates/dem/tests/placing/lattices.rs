//! Lattices: how dense they are, how far neighbours are apart, what fits into a box.
use dem::placing::{CrystalLattice, LatticeKind, Orientations, PlacingError};
use interfaces::{Aabb, Periods, Point, Vector};
use std::f64::consts::PI;

use LatticeKind::{
    BodyCentredCubic, FaceCentredCubic, HexagonalClosePacked, PlaneHexagonal, PlaneSquare, SimpleCubic,
};

const KINDS: [LatticeKind; 6] =
    [SimpleCubic, BodyCentredCubic, FaceCentredCubic, HexagonalClosePacked, PlaneSquare, PlaneHexagonal];

fn plane(kind: LatticeKind) -> bool {
    matches!(kind, PlaneSquare | PlaneHexagonal)
}
/// Smallest distance of any two points, and how many neighbours a point has at it, in a periodic box.
fn neighbours(points: &[Point], periods: Periods) -> (f64, Vec<usize>) {
    let distances: Vec<Vec<f64>> = points
        .iter()
        .enumerate()
        .map(|(i, p)| {
            let others = points.iter().enumerate().filter(|(j, _)| *j != i);
            others.map(|(_, q)| periods.nearest(p - q).norm()).collect()
        })
        .collect();
    let least = distances.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    let count = |d: &Vec<f64>| d.iter().filter(|d| **d < least * 1.0001).count();
    (least, distances.iter().map(count).collect())
}

#[test]
fn densities_and_neighbours_of_touching_bodies() {
    let r2 = 2_f64.sqrt();
    let r3 = 3_f64.sqrt();
    for (kind, density, number) in [
        (SimpleCubic, PI / 6.0, 6),
        (BodyCentredCubic, r3 * PI / 8.0, 8),
        (FaceCentredCubic, r2 * PI / 6.0, 12),
        (HexagonalClosePacked, r2 * PI / 6.0, 12),
        (PlaneSquare, PI / 4.0, 4),
        (PlaneHexagonal, PI / 12_f64.sqrt(), 6),
    ] {
        let d = 0.037;
        let lattice = CrystalLattice::new(kind, d).unwrap();
        let points = lattice.cells([4, 3, 3]).unwrap();
        let cell = lattice.cell();
        let extent = cell.component_mul(&Vector::new(4.0, 3.0, if plane(kind) { 0.0 } else { 3.0 }));
        let (space, body) = if plane(kind) {
            (extent.x * extent.y, PI / 4.0 * d * d)
        } else {
            (extent.product(), PI / 6.0 * d * d * d)
        };
        assert!((points.len() as f64 * body / space / density - 1.0).abs() < 1e-13, "{kind:?}");
        let period = |a: usize| (extent[a] > 0.0).then_some(extent[a]);
        let (least, counts) = neighbours(&points, Periods::new([period(0), period(1), period(2)]));
        assert!((least / d - 1.0).abs() < 1e-12, "{kind:?} {least}");
        assert!(counts.iter().all(|c| *c == number), "{kind:?} {counts:?}");
    }
}

/// Hexagonal layers repeat every second one, cubic ones every third one: the second neighbours tell them apart.
#[test]
fn hexagonal_is_not_face_centred() {
    let shell = |kind| {
        let lattice = CrystalLattice::new(kind, 1.0).unwrap();
        let points = lattice.cells([5, 5, 5]).unwrap();
        let e = lattice.cell() * 5.0;
        let periods = Periods::new([Some(e.x), Some(e.y), Some(e.z)]);
        let away = (8.0_f64 / 3.0).sqrt();
        points[1..].iter().filter(|p| (periods.nearest(*p - points[0]).norm() - away).abs() < 1e-9).count()
    };
    assert_eq!((shell(HexagonalClosePacked), shell(FaceCentredCubic)), (2, 0));
}

#[test]
fn a_box_holds_all_that_fits_and_nothing_else() {
    for kind in KINDS {
        let lattice = CrystalLattice::new(kind, 0.1).unwrap();
        for (min, extent) in [([0.0; 3], [1.0, 0.7, 0.9]), ([-3.1, 2.2, 1e3], [0.33, 0.41, 0.29])] {
            let bounds = Aabb { min: min.into(), max: Point::from(min) + Vector::from(extent) };
            let points = lattice.in_box(&bounds, 0.05).unwrap();
            let axes = if plane(kind) { 2 } else { 3 };
            for p in &points {
                assert!(
                    (0..axes)
                        .all(|a| p[a] - bounds.min[a] > 0.05 - 1e-12 && bounds.max[a] - p[a] > 0.05 - 1e-12)
                );
                assert!(axes == 3 || p.z == 0.0);
            }
            // By counting over a far larger block.
            let big = lattice.cells([20, 20, 20]).unwrap();
            let fits = |p: &&Point| (0..axes).all(|a| p[a] <= extent[a] - 0.1 + 1e-9);
            assert_eq!(points.len(), big.iter().filter(fits).count(), "{kind:?}");
            let (least, _) = neighbours(&points, Periods::default());
            assert!(least > 0.1 * (1.0 - 1e-11), "{kind:?} {least}");
        }
    }
    // Ten bodies of 0.1 exactly fill a length of 1, though 0.1 is not exact.
    let lattice = CrystalLattice::new(SimpleCubic, 0.1).unwrap();
    let unit = Aabb { min: [0.0; 3].into(), max: [1.0; 3].into() };
    assert_eq!(lattice.in_box(&unit, 0.05).unwrap().len(), 1000);
    assert!(lattice.in_box(&unit, 0.51).unwrap().is_empty());
}

#[test]
fn a_given_number_is_about_a_cube() {
    for kind in KINDS {
        let lattice = CrystalLattice::new(kind, 1.0).unwrap();
        for number in [0, 1, 2, 7, 500, 1234] {
            let points = lattice.number(number).unwrap();
            assert_eq!(points.len(), number);
            let mut top = Vector::zeros();
            points.iter().for_each(|p| top = top.sup(&p.coords));
            let axes = if plane(kind) { 2 } else { 3 };
            let ideal = (number as f64).powf(1.0 / f64::from(axes));
            assert!(top.max() <= 1.2 * ideal + 2.0, "{kind:?} {number} {top}");
            let (least, _) = neighbours(&points, Periods::default());
            assert!(number < 2 || (least - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn jitter_keeps_the_gap() {
    for kind in KINDS {
        let lattice = CrystalLattice::new(kind, 1.0).unwrap();
        let amplitude = lattice.play(0.8, 0.05).unwrap();
        assert!((amplitude - 0.075).abs() < 1e-15);
        let points = lattice.number(900).unwrap();
        let mut moved = points.clone();
        lattice.jitter(&mut moved, amplitude, 5).unwrap();
        let (least, _) = neighbours(&moved, Periods::default());
        assert!(least >= 0.85, "{kind:?} {least}");
        // It uses what it has: the mean way in a ball is 3/4 of its radius, in a disc 2/3.
        let ways: Vec<f64> = points.iter().zip(&moved).map(|(p, q)| (p - q).norm()).collect();
        let mean = ways.iter().sum::<f64>() / 900.0 / amplitude;
        let exact = if plane(kind) { 2.0 / 3.0 } else { 0.75 };
        assert!((mean - exact).abs() < 0.04 && ways.iter().all(|w| *w <= amplitude), "{mean}");
        assert!(!plane(kind) || moved.iter().all(|p| p.z == 0.0));
        let mut again = points.clone();
        lattice.jitter(&mut again, amplitude, 5).unwrap();
        assert_eq!(again, moved);
    }
}

/// A matrix of a uniform rotation has entries of mean 0, variance 1/3; the trace has mean 0, and the angle the density (1 − cos φ)/π.
#[test]
fn random_orientations_are_uniform() {
    let n = 100_000;
    let turns: Vec<_> = Orientations::Random.of(3).take(n).collect();
    let mut sums = [[0.0; 2]; 9];
    let mut angles = Vec::new();
    for turn in &turns {
        assert!((turn.quaternion().norm() - 1.0).abs() < 1e-15);
        for (sum, m) in sums.iter_mut().zip(turn.to_rotation_matrix().matrix().iter()) {
            sum[0] += m;
            sum[1] += m * m;
        }
        angles.push(turn.angle());
    }
    let n = n as f64;
    // Entries are uniform from −1 to 1: variances 1/3 and 4/45.
    for [first, second] in sums {
        assert!((first / n).abs() < 5.0 * (1.0 / 3.0 / n).sqrt());
        assert!((second / n - 1.0 / 3.0).abs() < 5.0 * (4.0 / 45.0 / n).sqrt());
    }
    angles.sort_by(f64::total_cmp);
    let far = |(i, a): (usize, &f64)| ((a - a.sin()) / PI - i as f64 / n).abs();
    assert!(angles.iter().enumerate().map(far).fold(0.0, f64::max) * n.sqrt() < 2.5);
    // About z: the angle is uniform over the whole turn.
    let mut angles: Vec<f64> = Orientations::AboutZ
        .of(4)
        .take(20_000)
        .map(|r| {
            let x = r * Vector::x();
            assert!(x.z == 0.0 && (r * Vector::z() - Vector::z()).norm() < 1e-15);
            x.y.atan2(x.x)
        })
        .collect();
    angles.sort_by(f64::total_cmp);
    let far = |(i, a): (usize, &f64)| ((a + PI) / (2.0 * PI) - i as f64 / 2e4).abs();
    assert!(angles.iter().enumerate().map(far).fold(0.0, f64::max) * 2e4_f64.sqrt() < 2.5);
}

#[test]
fn senseless_lattices_are_told() {
    use PlacingError::{Parameter, Region, TooMany};
    for d in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(CrystalLattice::new(SimpleCubic, d), Err(Parameter { .. })));
    }
    let lattice = CrystalLattice::new(SimpleCubic, 1e-9).unwrap();
    let unit = Aabb { min: [0.0; 3].into(), max: [1.0; 3].into() };
    assert!(matches!(lattice.in_box(&unit, 0.0), Err(TooMany { .. })));
    assert!(matches!(lattice.in_box(&unit, -1.0), Err(Parameter { .. })));
    let endless = Aabb { min: [0.0; 3].into(), max: [f64::INFINITY; 3].into() };
    assert!(matches!(lattice.in_box(&endless, 0.0), Err(Region { .. })));
    assert!(matches!(lattice.number(usize::MAX), Err(TooMany { .. })));
    assert!(matches!(lattice.cells([usize::MAX; 3]), Err(TooMany { .. })));
    assert!(matches!(lattice.play(1e-9, 1e-10), Err(Parameter { .. })));
    assert!(matches!(lattice.jitter(&mut [], f64::NAN, 1), Err(Parameter { .. })));
}
