//! Balls, capsules and cylinders by their own ways against the sweep that knows nothing but slices.
use super::super::common::Common;
use super::super::lanes::WIDTH;
use super::super::region::Region;
use super::super::slice::Slice;
use super::super::sweep::per_height;
use super::super::touches::touches;
use super::super::{Frame, STEEP, SlicedTube, Slices, Tube, known};
use super::*;
use crate::draw::Draw;
use interfaces::Vector;
use std::f64::consts::PI;

/// A ball, capsule or cylinder, slender or flat up to 1 : 20, up to twenty times as large as others.
fn body(draw: &mut Draw, kind: usize) -> Box<dyn Shape> {
    let (size, slender) = (draw.between(0.2, 4.0), draw.between(0.05, 20.0));
    match kind {
        0 => Box::new(sphere(size)),
        1 => Box::new(capsule(size / slender.max(1.0), size)),
        _ => Box::new(cylinder(size / slender.max(1.0), size * slender.min(1.0))),
    }
}

/// Two bodies, at most one of them a ball, from a graze to one and a half times the smaller one's size deep.
fn pair(draw: &mut Draw, round: usize) -> (Box<dyn Shape>, Pose, Box<dyn Shape>, Pose) {
    let kinds = [[0, 1], [2, 0], [1, 1], [1, 2], [2, 1], [2, 2]][round % 6];
    let [a, b] = kinds.map(|kind| body(draw, kind));
    let at_a = Pose { orientation: draw.turn(), ..here() };
    let (turn, u) = (draw.turn(), draw.direction());
    let at = |d: f64| Pose { position: (u * d).into(), orientation: turn };
    let mut solver = OverlapSolver::new().with_route(Some(Route::Slices));
    let (mut near, mut far) = (0.0, a.bounding_radius() + b.bounding_radius());
    for _ in 0..50 {
        let middle = 0.5 * (near + far);
        let apart = solver.solve(&*a, &at_a, &*b, &at(middle)).unwrap().is_empty();
        if apart { far = middle } else { near = middle }
    }
    let size = a.inertia(1.0).volume.min(b.inertia(1.0).volume).cbrt();
    let at_b = at((near - size * draw.between(1e-5, 1.5)).max(0.0));
    (a, at_a, b, at_b)
}

/// By a sweep.
fn swept(slices: &mut Slices, a: &dyn Shape, at_a: Pose, b: &dyn Shape, at_b: Pose) -> Option<Overlap> {
    let [a, b] = [(a, at_a), (b, at_b)].map(|(s, at)| Tube::of(&s.form(), &at).unwrap());
    // A ball has no axis.
    if a.half > 0.0 {
        slices.along_both(&a, &b, 1e-11, false)
    } else {
        slices.along_both(&b, &a, 1e-11, false).map(|o| o.swapped())
    }
}

/// Errors of volume, gradient, centroid and moment relative to the volume and its powers, or to the area.
fn errors(o: &Overlap, e: &Overlap) -> [f64; 4] {
    let size = e.volume.cbrt();
    let area = e.area() + size * size;
    let width = area.sqrt();
    [
        (o.volume / e.volume - 1.0).abs(),
        (o.gradient - e.gradient).norm() / area,
        (o.centroid - e.centroid).norm() / width,
        (o.moment - e.moment).norm() / (area * width),
    ]
}

/// The sweep itself may miss a side that enters and leaves between two slices: 1e-7 in one of a thousand.
#[test]
fn a_sweep_of_slices_agrees() {
    let (mut draw, mut slices) = (Draw(5), Slices::default());
    for (tolerance, bounds) in [(1e-5, [1e-5, 5e-5, 1e-5, 5e-5]), (1e-9, [2e-7, 5e-7, 2e-7, 5e-7])] {
        let mut worst = [0.0_f64; 4];
        for round in 0..1500 {
            let (a, at_a, b, at_b) = pair(&mut draw, round);
            let found = super::slices(tolerance, &*a, at_a, &*b, at_b);
            let exact = swept(&mut slices, &*a, at_a, &*b, at_b);
            let (Some(o), Some(e)) = (found, exact) else { panic!("{round}: {found:?} {exact:?}") };
            let now = errors(&o, &e);
            worst = [0, 1, 2, 3].map(|i| worst[i].max(now[i]));
        }
        assert!((0..4).all(|i| worst[i] < bounds[i]), "{tolerance} {worst:?}");
    }
}

/// Were a height missing at which the outline changes, seven points on either side of it would see a kink.
#[test]
fn all_is_smooth_between_known_heights() {
    let (mut draw, mut slices) = (Draw(6), Slices::default());
    for kinds in [2, 3, 5] {
        let mut errors = Vec::new();
        while errors.len() < 400 {
            let (a, at_a, b, at_b) = pair(&mut draw, kinds);
            let [first, second] = [(&a, at_a), (&b, at_b)].map(|(s, at)| Tube::of(&s.form(), &at).unwrap());
            let across = first.axis.cross(&second.axis);
            if across.norm() < STEEP {
                continue;
            }
            let frame = Frame::new(at_a.position, first.axis, across);
            let tubes = [SlicedTube::new(&first, &frame), SlicedTube::new(&second, &frame)];
            let exact = swept(&mut slices, &*a, at_a, &*b, at_b).unwrap().volume;
            errors.extend(known::integrate(tubes, 1.0).map(|found| (found.sums.volume / exact - 1.0).abs()));
        }
        errors.sort_by(f64::total_cmp);
        assert!(errors[200] < 2e-5 && errors[396] < 2e-4, "{} {}", errors[200], errors[396]);
    }
}

/// Slices by the outline that is the same from one known height to the next, against outlines that are cut for each of them.
#[test]
fn outlines_are_the_same_between_known_heights() {
    let (mut draw, mut region, mut several) = (Draw(7), Region::default(), 0);
    let [mut one, mut two] = [Slice::default(), Slice { body: 1, ..Slice::default() }];
    for round in 0..900 {
        let (a, at_a, b, at_b) = pair(&mut draw, [2, 3, 5][round % 3]);
        let [first, second] = [(&a, at_a), (&b, at_b)].map(|(s, at)| Tube::of(&s.form(), &at).unwrap());
        let across = first.axis.cross(&second.axis);
        // Where axes are all but parallel places along them are rounded by more.
        if across.norm() < 0.05 {
            continue;
        }
        let frame = Frame::new(at_a.position, first.axis, across);
        let tubes = [SlicedTube::new(&first, &frame), SlicedTube::new(&second, &frame)];
        let size = a.bounding_radius().min(b.bounding_radius());
        let reach = a.bounding_radius() + b.bounding_radius();
        let touches = touches(&tubes[0], &tubes[1]);
        let mut common = Common::new(&tubes[0], &tubes[1]);
        for w in touches.heights().windows(2) {
            let (low, width) = (w[0].0, w[1].0 - w[0].0);
            let outline = common.between([low, low + width]);
            if width < 1e-6 * size || outline.is_empty() {
                continue;
            }
            assert!(outline.is_closed(), "{round}");
            several += 1;
            let heights =
                std::array::from_fn(|i| low + width * [0.03, 0.1, 0.3, 0.45, 0.6, 0.8, 0.9, 0.97][i]);
            for i in 0..WIDTH {
                let weights = std::array::from_fn(|j| f64::from(u8::from(i == j)));
                let found = common.sums(&outline, &heights, &[weights]).sums[0];
                tubes[0].slice(heights[i], &mut one);
                tubes[1].slice(heights[i], &mut two);
                let section = region.section(&one, &two, 1e-15 * reach);
                let exact = per_height(heights[i], &section);
                let near = |x: f64, y: f64, unit: f64| {
                    let most = 1e-9 * unit * (1.0 + reach / size);
                    assert!((x - y).abs() <= most, "{round} {i}: {found:?} {exact:?}");
                };
                near(found.volume, exact.volume, size * size);
                let slope = 1.0 + one.slope.abs().max(one.sides.first().map_or(0.0, |side| side.slope.abs()));
                for k in 0..3 {
                    near(found.first[k], exact.first[k], size * size * reach);
                    near(found.area[k], exact.area[k], size * slope);
                    near(found.moment[k], exact.moment[k], size * reach * slope);
                }
            }
        }
    }
    assert!(several > 1500, "{several}");
}

/// Axes at a right angle, where lines of both outlines are parallel: against columns.
#[test]
fn capsules_at_right_angles() {
    let (a, b) = (capsule(0.439, 0.438), capsule(0.419, 0.42));
    let at_a = pose([0.3, 0.1, -0.2], [0.4, -0.8, 0.3]);
    for (place, turn) in [
        ([0.0023, 0.0055, 0.0029], 0.5 * PI),
        ([0.1, 0.2, 0.0], 0.5 * PI),
        ([0.0, 0.3, 0.3], 0.5 * PI + 1e-9),
        ([0.6, 0.1, 0.3], 0.5 * PI),
        ([0.0; 3], 0.5 * PI),
    ] {
        let at_b = Pose {
            position: at_a.position + at_a.orientation * Vector::from(place),
            orientation: at_a.orientation * Rotation::from_scaled_axis(Vector::new(turn, 0.0, 0.0)),
        };
        let o = slices(1e-9, &a, at_a, &b, at_b).unwrap();
        let mut columns = OverlapSolver::new().with_route(Some(Route::Columns)).with_tolerance(1e-7);
        let exact = columns.solve(&a, &at_a, &b, &at_b).unwrap()[0].volume;
        assert!((o.volume / exact - 1.0).abs() < 1e-5, "{} {exact}", o.volume);
    }
}

/// Side by side, end to end, crossing, and an end before a side.
#[test]
fn capsules_that_all_but_touch() {
    let (a, b) = (capsule(0.3, 1.0), capsule(0.2, 2.0));
    let quarter = 0.5 * PI;
    for (way, turn, distance) in [
        (Vector::x(), [0.0; 3], 0.5),
        (Vector::new(0.6, 0.8, 0.0), [0.0, 0.0, 1.0], 0.5),
        (Vector::z(), [0.0; 3], 2.0),
        (Vector::x(), [quarter, 0.0, 0.0], 0.5),
        (Vector::x(), [0.7, 0.0, 0.0], 0.5),
        (Vector::x(), [0.0, quarter, 0.0], 1.5),
        (Vector::z(), [quarter, 0.0, 0.0], 1.0),
    ] {
        for (by, meet) in [(-1e-9, true), (1e-9, false)] {
            let at_b = Pose { position: (way * (distance + by)).into(), ..pose([0.0; 3], turn) };
            for at in [here(), pose([0.3, -0.2, 0.5], [0.4, 1.0, -0.3])] {
                let moved = Pose {
                    position: at.position + at.orientation * at_b.position.coords,
                    orientation: at.orientation * at_b.orientation,
                };
                let found = slices(1e-5, &a, at, &b, moved);
                assert_eq!(found.is_some(), meet, "{way:?} {turn:?} {by}");
                if let Some(o) = found {
                    assert!((o.normal - at.orientation * -way).norm() < 1e-3, "{o:?} {way:?} {turn:?}");
                }
            }
        }
    }
}

/// A ball and a tube one of which holds the other, or the ball one or both flat ends of it.
#[test]
fn balls_around_tubes() {
    let at = pose([0.1, -0.2, 0.1], [0.3, 0.5, 0.2]);
    let tubes: [&dyn Shape; 3] = [&capsule(0.2, 0.7), &cylinder(0.2, 0.7), &cylinder(0.7, 0.1)];
    for body in tubes {
        for o in [slices(1e-5, body, at, &sphere(1.5), here()), slices(1e-5, &sphere(1.5), here(), body, at)]
        {
            let o = o.unwrap();
            assert!((o.volume / body.inertia(1.0).volume - 1.0).abs() < 1e-15);
            assert_eq!((o.centroid, o.gradient, o.moment), (at.position, Vector::zeros(), Vector::zeros()));
        }
    }
    // A ball in a coin's middle: less two caps.
    let (ball, coin) = (sphere(0.5), cylinder(2.0, 0.6));
    let cap = PI * 0.04 * (1.5 - 0.2) / 3.0;
    for place in [0.0, 0.3, 1.2] {
        let o = slices(1e-5, &ball, Pose::at([place, 0.0, 0.0]), &coin, here()).unwrap();
        assert!((o.volume - (PI / 6.0 - 2.0 * cap)).abs() < 1e-14);
        assert!(o.gradient.norm() < 1e-14 && (o.centroid.x - place).abs() < 1e-14);
    }
    // And through one face only.
    let o = slices(1e-5, &ball, Pose::at([0.4, 0.0, 0.5]), &coin, here()).unwrap();
    let rest = PI * 0.09 * (1.5 - 0.3) / 3.0;
    assert!((o.volume - rest).abs() < 1e-14 && (o.gradient.z + PI * 0.21).abs() < 1e-14, "{o:?}");
}
