//! Random addition of spheres around bodies, checked by brute force.
use dem::placing::{Jammed, Orientations, PlacingError, RandomAddition, Region, SizeDistribution};
use dem::{Capsule, Cuboid, Disc, Ellipsoid, HalfSpace, Shape, Sphere};
use interfaces::{Aabb, Point, Pose, Rotation, Solid, Vector};
use std::f64::consts::PI;

/// What rounding may take from a distance.
const ROUNDING: f64 = 1e-13;

fn bounds(min: [f64; 3], max: [f64; 3]) -> Aabb {
    Aabb { min: min.into(), max: max.into() }
}
fn spheres(law: &SizeDistribution, number: usize, seed: u64) -> Vec<Sphere> {
    law.sizes(seed).take(number).map(|d| Sphere::new(0.5 * d).unwrap()).collect()
}
fn shapes<S: Shape>(all: &[S]) -> Vec<&dyn Shape> {
    all.iter().map(|s| s as _).collect()
}
/// Smallest distance between the spheres around bodies and all images of them, their own ones, too, and how many pairs come near only
/// over two or more sides of the box.
fn least_gap(bodies: &[&dyn Shape], poses: &[Pose], extent: Vector, periodic: [bool; 3]) -> (f64, usize) {
    let range = |a: usize| if periodic[a] { -1..=1 } else { 0..=0 };
    let (mut least, mut over_edges) = (f64::INFINITY, 0);
    for (i, p) in poses.iter().enumerate() {
        for (j, q) in poses.iter().enumerate().skip(i) {
            let touching = bodies[i].bounding_radius() + bodies[j].bounding_radius();
            for k in range(2) {
                for m in range(1) {
                    for n in range(0) {
                        if i == j && (k, m, n) == (0, 0, 0) {
                            continue;
                        }
                        let shift =
                            Vector::new(f64::from(n), f64::from(m), f64::from(k)).component_mul(&extent);
                        let d = (p.position - q.position + shift).norm() - touching;
                        least = least.min(d);
                        let sides = [k, m, n].iter().filter(|s| **s != 0).count();
                        over_edges += usize::from(sides > 1 && d < 0.2 * touching);
                    }
                }
            }
        }
    }
    (least, over_edges)
}

#[test]
fn mixed_spheres_in_periodic_boxes_keep_their_gap() {
    let law = SizeDistribution::log_normal(0.06, 1.6, [0.02, 0.3]).unwrap();
    let spheres = spheres(&law, 1200, 1);
    let bodies = shapes(&spheres);
    let space = bounds([-0.3, 0.1, 5.0], [0.7, 1.3, 6.1]);
    for periodic in [[true; 3], [true, false, true], [false; 3]] {
        let region = Region::cuboid(space, periodic).unwrap();
        let poses = RandomAddition::new(region).with_gap(4e-3).unwrap().place(&bodies, 2).unwrap();
        let (least, over_edges) = least_gap(&bodies, &poses, space.extent(), periodic);
        // The gap is kept, and it is used.
        assert!(least > 4e-3 - ROUNDING && least < 4.2e-3, "{periodic:?}: {least}");
        assert!(over_edges > if periodic[1] { 10 } else { 0 } || !periodic[0], "{over_edges}");
        for (sphere, pose) in spheres.iter().zip(&poses) {
            for a in 0..3 {
                let margin = if periodic[a] { 0.0 } else { sphere.radius() + 4e-3 - ROUNDING };
                let x = pose.position[a];
                assert!(x >= space.min[a] + margin && x <= space.max[a] - margin);
            }
        }
    }
}

/// Sizes from 2 to 300: the grids of all octaves are asked, in both directions.
#[test]
fn very_different_sizes() {
    let law = SizeDistribution::power_law(-2.5, [8e-3, 0.3]).unwrap();
    let sizes = law.until(0.25, |d| PI / 6.0 * d * d * d, 3).unwrap();
    let spheres: Vec<Sphere> = sizes.iter().map(|d| Sphere::new(0.5 * d).unwrap()).collect();
    assert!(spheres.len() > 1000);
    let bodies = shapes(&spheres);
    let space = bounds([0.0; 3], [1.0; 3]);
    let region = Region::cuboid(space, [true; 3]).unwrap();
    // Small ones that were there before.
    let dust = Sphere::new(1e-3).unwrap();
    let before: Vec<Pose> = (0..30)
        .map(|i| Pose::at([0.37 * f64::from(i) % 1.0, 0.61 * f64::from(i) % 1.0, 0.033 * f64::from(i)]))
        .collect();
    let adding =
        before.iter().fold(RandomAddition::new(region), |adding, at| adding.with_obstacle(&dust, *at));
    let poses = adding.place(&bodies, 4).unwrap();
    let (least, _) = least_gap(&bodies, &poses, space.extent(), [true; 3]);
    assert!((-ROUNDING..1e-4).contains(&least), "{least}");
    for at in &before {
        for (sphere, pose) in spheres.iter().zip(&poses) {
            let pair = [Pose { position: pose.position, ..*pose }, *at];
            let (d, _) = least_gap(&[sphere, &dust], &pair, Vector::repeat(1.0), [true; 3]);
            assert!(d > -ROUNDING, "{d}");
        }
    }
}

#[test]
fn containers_hold_bodies_wholly() {
    let law = SizeDistribution::uniform(0.05, 0.15).unwrap();
    let spheres = spheres(&law, 150, 5);
    let bodies = shapes(&spheres);
    let turn = Rotation::from_euler_angles(0.4, -0.8, 0.3);
    let tilted = Pose { position: Point::new(3.0, -2.0, 1.0), orientation: turn };
    let egg = Ellipsoid::new([0.9, 0.5, 0.6]).unwrap();
    let round = Sphere::new(0.8).unwrap();
    let drum = dem::Cylinder::new(0.5, 1.6).unwrap();
    let at = Pose::at([3.0, -2.0, 1.0]);
    let cases: [(Region<'_>, &dyn Solid, Pose, f64); 3] = [
        (Region::sphere(0.8, at.position).unwrap(), &round, at, round.inertia(1.0).volume),
        (Region::cylinder(0.5, 1.6, tilted).unwrap(), &drum, tilted, drum.inertia(1.0).volume),
        (Region::solid(&egg, tilted).unwrap(), &egg, tilted, egg.inertia(1.0).volume),
    ];
    for (region, solid, at, volume) in cases {
        assert!((region.volume() / volume - 1.0).abs() < 1e-3, "{} {volume}", region.volume());
        let poses = RandomAddition::new(region).with_gap(0.01).unwrap().place(&bodies, 6).unwrap();
        let (least, _) = least_gap(&bodies, &poses, Vector::zeros(), [false; 3]);
        assert!(least > 0.01 - ROUNDING);
        let mut nearest = f64::INFINITY;
        for (sphere, pose) in spheres.iter().zip(&poses) {
            let d = -solid.signed_distance(at.to_body(pose.position), 10.0) - sphere.radius();
            assert!(d > 0.01 - 1e-9, "{d}");
            nearest = nearest.min(d);
        }
        // They come near the wall, too.
        assert!(nearest < 0.02, "{nearest}");
    }
}

#[test]
fn discs_in_a_plane() {
    let law = SizeDistribution::uniform(0.02, 0.06).unwrap();
    let discs: Vec<Disc> = law.sizes(7).take(300).map(|d| Disc::new(0.5 * d).unwrap()).collect();
    let bodies = shapes(&discs);
    let area: f64 = discs.iter().map(|d| PI * d.radius().powi(2)).sum();
    assert!(area > 0.35);
    let space = bounds([0.0, -1.0, 0.0], [1.0, 0.0, 0.0]);
    let region = Region::cuboid(space, [true, true, false]).unwrap();
    assert!((region.volume() - 1.0).abs() < 1e-15 && region.is_plane());
    let adding = RandomAddition::new(region);
    let mut over_corners = 0;
    // A plane box has one corner only, so it takes several of them.
    for seed in 0..40 {
        let poses = adding.place(&bodies, seed).unwrap();
        let (least, found) = least_gap(&bodies, &poses, space.extent(), [true, true, false]);
        assert!((-ROUNDING..1e-3).contains(&least), "{least}");
        over_corners += found;
    }
    assert!(over_corners > 5, "{over_corners}");
    for pose in &adding.place(&bodies, 8).unwrap() {
        let z = pose.orientation * Vector::z();
        assert!(pose.position.z == 0.0 && (z - Vector::z()).norm() < 1e-15);
    }
    let centre = Point::new(2.0, 3.0, 0.0);
    let region = Region::disc(0.7, centre).unwrap();
    assert!((region.volume() - PI * 0.49).abs() < 1e-12);
    let poses = RandomAddition::new(region).place(&bodies, 9).unwrap();
    let inside = |(d, p): (&Disc, &Pose)| (p.position - centre).norm() + d.radius() <= 0.7 + ROUNDING;
    assert!(discs.iter().zip(&poses).all(inside));
}

/// Of all positions that one body may have, each is as likely as any other: also over a sphere, where many attempts fail.
#[test]
fn places_are_uniform() {
    let ball = Sphere::new(0.1).unwrap();
    let n = 4000;
    let mut heights = Vec::new();
    let mut radii = Vec::new();
    for seed in 0..n {
        let region = Region::cuboid(bounds([0.0; 3], [1.0; 3]), [true, true, false]).unwrap();
        heights.push((RandomAddition::new(region).place(&[&ball], seed).unwrap()[0].position.z - 0.1) / 0.8);
        let region = Region::sphere(1.0, Point::origin()).unwrap();
        let r = RandomAddition::new(region).place(&[&ball], seed).unwrap()[0].position.coords.norm();
        radii.push((r / 0.9).powi(3));
    }
    for mut values in [heights, radii] {
        values.sort_by(f64::total_cmp);
        let far = |(i, x): (usize, &f64)| (x - i as f64 / n as f64).abs();
        let largest = values.iter().enumerate().map(far).fold(0.0, f64::max);
        assert!(largest * (n as f64).sqrt() < 2.5, "{largest}");
    }
}

#[test]
fn obstacles_keep_their_place_and_their_images() {
    let ball = Sphere::new(0.04).unwrap();
    let bodies = vec![&ball as &dyn Shape; 300];
    let space = bounds([0.0; 3], [1.0; 3]);
    let floor = HalfSpace::new(Point::origin(), Vector::z()).unwrap();
    let plate = Cuboid::new([1.4, 0.02, 0.9]).unwrap();
    let rod = Capsule::new(0.05, 0.8).unwrap();
    // The plate is longer than the box, so that two images of it are near one place, and the rod stands in an image of it.
    let plate_at = Pose {
        position: Point::new(0.9, 0.02, 0.5),
        orientation: Rotation::from_euler_angles(0.0, 0.0, 0.3),
    };
    let rod_at = Pose {
        position: Point::new(-3.5, 7.4, 0.5),
        orientation: Rotation::from_euler_angles(1.4, 0.0, 0.0),
    };
    let floor_at = Pose::at([0.0, 0.0, 0.1]);
    let region = Region::cuboid(space, [true, true, false]).unwrap();
    let adding = RandomAddition::new(region)
        .with_obstacle(&floor, floor_at)
        .with_obstacle(&plate, plate_at)
        .with_obstacle(&rod, rod_at)
        .with_gap(0.003)
        .unwrap();
    let poses = adding.place(&bodies, 3).unwrap();
    let mut nearest = [f64::INFINITY; 3];
    for pose in &poses {
        for i in -12..=12 {
            for j in -12..=12 {
                let x = pose.position + Vector::new(f64::from(i), f64::from(j), 0.0);
                let solids: [(&dyn Solid, Pose); 3] =
                    [(&floor, floor_at), (&plate, plate_at), (&rod, rod_at)];
                for (near, (solid, at)) in nearest.iter_mut().zip(solids) {
                    *near = near.min(solid.signed_distance(at.to_body(x), 1e3) - 0.04);
                }
            }
        }
    }
    assert!(nearest.iter().all(|d| *d > 0.003 - ROUNDING && *d < 0.01), "{nearest:?}");
}

#[test]
fn a_full_region_is_told_and_nothing_is_lost() {
    let ball = Sphere::new(0.05).unwrap();
    let bodies = vec![&ball as &dyn Shape; 1000];
    let space = bounds([0.0; 3], [1.0; 3]);
    let region = Region::cuboid(space, [true; 3]).unwrap();
    let wrong = RandomAddition::new(region).with_attempts(30_000).place(&bodies, 1).unwrap_err();
    let message = wrong.to_string();
    let PlacingError::Jammed(Jammed { placed, asked, body, attempts, fraction }) = wrong else {
        panic!("{wrong}")
    };
    assert_eq!((asked, attempts, body), (1000, 30_000, placed.len()));
    let exact = placed.len() as f64 * ball.inertia(1.0).volume;
    assert!((fraction / exact - 1.0).abs() < 1e-12);
    // Spheres jam at 0.3841 (Torquato & Stillinger 2010), in so small a box within a few per cent of that.
    assert!((0.33..0.39).contains(&fraction), "{fraction}");
    assert!(message.contains(&format!("{} of 1000", placed.len())), "{message}");
    let poses: Vec<Pose> = placed.iter().map(|p| p.1).collect();
    assert!(least_gap(&bodies[..poses.len()], &poses, space.extent(), [true; 3]).0 > -ROUNDING);
    // As many can be had, and they are the same ones.
    let region = Region::cuboid(space, [true; 3]).unwrap();
    assert_eq!(RandomAddition::new(region).place(&bodies[..poses.len()], 1).unwrap(), poses);
    // The largest ones come first.
    let large = Sphere::new(0.2).unwrap();
    let mixed: [&dyn Shape; 4] = [&ball, &large, &ball, &large];
    let region = Region::cuboid(space, [true; 3]).unwrap();
    let PlacingError::Jammed(jammed) =
        RandomAddition::new(region).with_attempts(0).place(&mixed, 1).unwrap_err()
    else {
        panic!()
    };
    assert_eq!((jammed.body, jammed.placed.len()), (1, 0));
}

/// Written down once: other machines must place the same bits.
#[test]
fn the_same_seed_has_the_same_places() {
    let law = SizeDistribution::uniform(0.05, 0.15).unwrap();
    let spheres = spheres(&law, 200, 1);
    let place = |seed| {
        let region = Region::cuboid(bounds([0.0; 3], [1.0; 3]), [true; 3]).unwrap();
        RandomAddition::new(region).place(&shapes(&spheres), seed).unwrap()
    };
    let poses = place(1);
    assert_eq!(poses, place(1));
    assert_ne!(poses, place(2));
    let all = poses.iter().flat_map(|p| {
        p.position.iter().copied().chain(p.orientation.coords.iter().copied()).collect::<Vec<_>>()
    });
    let hash = all.fold(0_u64, |h, v| (h.rotate_left(5) ^ v.to_bits()).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    assert_eq!(hash, 0x85b3_d8a8_8d44_cad7, "{hash:#x}");
}

#[test]
fn senseless_requests_are_told() {
    use PlacingError as E;
    let unit = || bounds([0.0; 3], [1.0; 3]);
    let cube = |periodic| Region::cuboid(unit(), periodic).unwrap();
    let (ball, disc) = (Sphere::new(0.1).unwrap(), Disc::new(0.1).unwrap());
    for (min, max) in [
        ([0.0; 3], [-1.0; 3]),
        ([0.0; 3], [f64::NAN; 3]),
        ([f64::NEG_INFINITY; 3], [0.0; 3]),
        ([0.0, 0.0, 1.0], [1.0; 3]),
    ] {
        assert!(matches!(Region::cuboid(bounds(min, max), [false; 3]), Err(E::Region { .. })));
    }
    assert!(matches!(Region::sphere(-1.0, Point::origin()), Err(E::Shape(_))));
    assert!(matches!(Region::sphere(1.0, Point::new(f64::NAN, 0.0, 0.0)), Err(E::Region { .. })));
    assert!(matches!(Region::disc(1.0, Point::new(0.0, 0.0, 1.0)), Err(E::Region { .. })));
    assert!(matches!(RandomAddition::new(cube([true; 3])).with_gap(-1.0), Err(E::Parameter { .. })));
    assert!(matches!(
        RandomAddition::new(cube([true; 3])).place(&[&ball, &disc], 1),
        Err(E::Dimension { body: 1, flat: true })
    ));
    let plane = Region::disc(1.0, Point::origin()).unwrap();
    let tilted = Orientations::Fixed(Rotation::from_euler_angles(0.1, 0.0, 0.0));
    let adding = RandomAddition::new(plane).with_orientations(tilted);
    assert!(matches!(adding.place(&[&ball], 1), Err(E::Dimension { body: 0, flat: false })));
    assert!(matches!(adding.place(&[&disc], 1), Err(E::Orientation { .. })));
    let large = Sphere::new(0.45).unwrap();
    for (periodic, gap, fits) in [
        ([true; 3], 0.09, true),
        ([true; 3], 0.11, false),
        ([false; 3], 0.04, true),
        ([false; 3], 0.06, false),
    ] {
        let place = RandomAddition::new(cube(periodic)).with_gap(gap).unwrap().place(&[&large], 1);
        assert_eq!(place.is_ok(), fits);
        assert!(fits || matches!(place, Err(E::TooLarge { body: 0, axis: 0, .. })));
    }
    let wall = HalfSpace::new(Point::origin(), Vector::z()).unwrap();
    assert!(matches!(RandomAddition::new(cube([true; 3])).place(&[&wall], 1), Err(E::TooLarge { .. })));
    let nowhere = RandomAddition::new(cube([true; 3])).with_obstacle(&ball, Pose::at([f64::NAN; 3]));
    assert!(matches!(nowhere.place(&[&ball], 1), Err(E::Obstacle { obstacle: 0, .. })));
    assert!(RandomAddition::new(cube([true; 3])).place(&[], 1).unwrap().is_empty());
}
