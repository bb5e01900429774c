//! Who is left out with whom.
use super::*;
use crate::Mat;

fn samples(points: &Mat<f64>) -> Samples {
    Samples::new(points.as_ref(), points.as_ref()).unwrap()
}
fn line(m: usize) -> Samples {
    samples(&Mat::from_fn(1, m, |_, j| ((7 * j) % m) as f64))
}
fn grid(n: [usize; 2]) -> Samples {
    samples(&Mat::from_fn(2, n[0] * n[1], |i, j| [j % n[0], j / n[0]][i] as f64))
}
fn sorted(folds: &Folds) -> Vec<usize> {
    let mut all = folds.sets().concat();
    all.sort_unstable();
    all
}

#[test]
fn every_sample_between_the_ends_is_left_out_once() {
    let samples = line(23);
    let between: Vec<usize> = (0..23).filter(|&i| ![0.0, 22.0].contains(&samples.point(i)[0])).collect();
    let [random, interleaved] =
        [Folds::random(&samples, 4, 3).unwrap(), Folds::interleaved(&samples, 4).unwrap()];
    for folds in [&random, &interleaved, &Folds::leave_one_out_inside(&samples)] {
        assert_eq!(sorted(folds), between);
    }
    assert_eq!(random, Folds::random(&samples, 4, 3).unwrap());
    assert_ne!(random, Folds::random(&samples, 4, 4).unwrap());
    assert_eq!(sorted(&Folds::leave_one_out(&samples)), (0..23).collect::<Vec<_>>());
    for set in interleaved.sets() {
        let places: Vec<f64> = set.iter().map(|&i| samples.point(i)[0]).collect();
        assert!(places.windows(2).all(|w| w[1] - w[0] == 4.0) && set.len() >= 5, "{places:?}");
    }
}

#[test]
fn planes_leave_grids() {
    let samples = grid([4, 3]);
    let folds = Folds::planes(&samples).unwrap();
    assert_eq!(folds.sets().iter().map(Vec::len).collect::<Vec<_>>(), [3, 3, 4]);
    for set in folds.sets() {
        let rest = samples.without(set).unwrap();
        assert!(rest.grid().is_ok());
        assert_eq!(rest.domain(), samples.domain());
    }
    assert!(matches!(
        Folds::planes(&grid([2, 2])),
        Err(InterpolationError::TooFew { needed: 3, found: 2, .. })
    ));
    let scattered = samples.subset(&[0, 1, 2, 5, 7]).unwrap();
    assert!(matches!(Folds::planes(&scattered), Err(InterpolationError::NotAGrid { .. })));
}

#[test]
fn sets_suit_the_samples() {
    let sets = |samples: &Samples| Folds::suited(samples, 1).unwrap().sets().len();
    assert_eq!(sets(&line(601)), 5);
    assert_eq!(sets(&line(6)), 4);
    assert_eq!(sets(&grid([5, 5])), 6);
    assert_eq!(sets(&grid([30, 5])), 10);
    let off = |m| samples(&Mat::from_fn(2, m, |i, j| [j as f64, ((j * j) % 17) as f64 + 0.01 * j as f64][i]));
    assert!(sets(&off(20)) > 10);
    assert_eq!(sets(&off(200)), 5);
    for m in 1..4 {
        assert!(matches!(Folds::suited(&line(m), 1), Err(InterpolationError::TooFew { .. })), "{m}");
    }
    assert!(matches!(Folds::random(&line(9), 1, 1), Err(InterpolationError::Parameter { .. })));
    assert!(matches!(
        Folds::random(&line(9), 8, 1),
        Err(InterpolationError::TooFew { needed: 8, found: 7, .. })
    ));
}
