//! Smooth forcing over all gaps from half a cell of overlap to three cells, beside a body's own
//! image, another body and a side of the box.
use crate::with_threads;
use siltflow::coupling::{Particles, Simulation, WeightBalance};
use siltflow::dem::{Chen, ContactLaw, Cuboid, Disc, Material, Polygon, RigidBodies, Sphere};
use siltflow::flow::{CartesianGrid, Diffusion, Fluid, Projection, Side};
use siltflow::ibm::SmoothForcing;
use siltflow::interfaces::{Freedom, Periods, Pose, Twist, Vector};

/// Gaps in cells.
const GAPS: [f64; 10] = [-0.5, -0.25, -0.1, 0.0, 0.1, 0.25, 0.5, 1.0, 2.0, 3.0];

const FLUID: Fluid = Fluid { density: 1.0, viscosity: 0.01 };

#[derive(Clone, Copy, Debug, PartialEq)]
enum Beside {
    OwnImage,
    Fixed,
    Free,
    Side,
}

/// Adds a block of these edges, of which 3D takes the third.
fn add_block<const D: usize, L: ContactLaw>(
    bodies: &mut RigidBodies<L>,
    edges: [f64; 3],
    at: [f64; 3],
    density: f64,
    (free, twist): (bool, Twist),
) {
    let material = Material { density, youngs_modulus: 10.0, ..Material::default() };
    let freedom = match (free, D) {
        (false, _) => Freedom::NONE,
        (true, 2) => Freedom::PLANAR,
        (true, _) => Freedom::FREE,
    };
    if D == 2 {
        let block = Polygon::rectangle([edges[0], edges[1]]).unwrap();
        bodies.add(block, material, Pose::at([at[0], at[1], 0.0]), twist, freedom).unwrap();
    } else {
        bodies.add(Cuboid::new(edges).unwrap(), material, Pose::at(at), twist, freedom).unwrap();
    }
}

/// Largest velocity, mean velocity along y and velocity of the free fall after 200 steps, each in so
/// many `parts` \[m/s\]: a wall of blocks across a box of 1 m, periodic along y and z, closed but for gaps along x. With
/// `through` a force of 0.1 N/kg acts along y, without it the fluid starts with up to 0.2 m/s along
/// x.
fn wall<const D: usize>(n: usize, gap: f64, beside: Beside, through: bool, parts: u32) -> [f64; 3] {
    let grid = CartesianGrid::new([n; D], [1.0; D]).unwrap();
    let gap = gap / n as f64;
    let bounded = beside == Beside::Side;
    let sides =
        std::array::from_fn(|a| if a == 0 && bounded { Side::WALL.both() } else { Side::Periodic.both() });
    let mut flow = Projection::new(grid, sides, FLUID).unwrap().with_diffusion(Diffusion::Explicit);
    if !through {
        let u = |y: f64| 0.2 * (std::f64::consts::TAU * y).sin();
        flow.set_velocity(|x| std::array::from_fn(|c| if c == 0 { u(x[1]) } else { 0.0 }));
    }
    let mut bodies = RigidBodies::with_law(
        Periods::new(std::array::from_fn(|a| (a < D && !(a == 0 && bounded)).then_some(1.0))),
        (),
    );
    let steady = (false, Twist::default());
    match beside {
        Beside::OwnImage => {
            add_block::<D, ()>(&mut bodies, [1.0 - gap, 0.4, 1.0], [0.513, 0.35, 0.507], 1.5, steady);
        }
        // Overlapping blocks beyond both sides, or a slot at the upper one.
        Beside::Side => {
            let long = 0.5 + 0.1;
            add_block::<D, ()>(&mut bodies, [long, 0.4, 1.0], [0.5 * long - 0.05, 0.35, 0.507], 1.5, steady);
            add_block::<D, ()>(
                &mut bodies,
                [long, 0.4, 1.0],
                [1.0 - gap - 0.5 * long, 0.35, 0.507],
                1.5,
                steady,
            );
        }
        Beside::Fixed | Beside::Free => {
            let free = (beside == Beside::Free, Twist::default());
            let edges = [0.5 - gap, 0.4, if beside == Beside::Free { 0.5 } else { 1.0 }];
            for x in [0.263, 0.763] {
                add_block::<D, ()>(&mut bodies, edges, [x, 0.35, 0.507], 1.5, free);
            }
        }
    }
    let particles = Particles::new(bodies, SmoothForcing::new(1.0), 1.0, Vector::zeros());
    let mut run = Simulation::new(flow, particles, WeightBalance::None).unwrap();
    if through {
        run = run.with_force(|_| 0.1 * Vector::y());
    }
    let steps = 200 * parts;
    let dt = 0.8 * run.flow.viscous_limit().min(0.4 / n as f64) / f64::from(parts);
    let mut fastest = 0.0_f64;
    for _ in 0..steps {
        if run.step(dt).is_err() {
            return [f64::INFINITY; 3];
        }
        fastest =
            (0..D).flat_map(|c| run.flow.centred_velocity(c)).fold(fastest, |most, u| most.max(u.abs()));
    }
    let fall = if through { 0.1 * f64::from(steps) * dt } else { 0.2 };
    [fastest, run.flow.statistics().volume_flow.y, fall]
}

fn sweep<const D: usize>(n: usize) {
    let mut wrong = Vec::new();
    for beside in [Beside::OwnImage, Beside::Fixed, Beside::Free, Beside::Side] {
        for gap in GAPS {
            for through in [true, false] {
                let [fastest, rate, fall] = wall::<D>(n, gap, beside, through, 1);
                // Free walls move along.
                let leaks = beside != Beside::Free && gap <= 0.0 && rate.abs() > LEAK * fall / 200.0;
                if fastest > 1.05 * fall || leaks {
                    wrong.push(format!(
                        "{beside:?}, {gap} cells, through {through}: {fastest:.4} {rate:.2e} of {fall}"
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{D}D:\n{}", wrong.join("\n"));
}

/// Largest velocity through closed walls over what the force adds in a step, which the passes remove
/// before the pressure acts: an error of the splitting, of order 0.5 to 0.9 in the step. Measured: 0.03 to 0.07 (2D), 0.09 to 0.16 (3D), largest next to the own
/// image with an overlap of a quarter of a cell and more; 0.07 and 0.12 without an overlap.
const LEAK: f64 = 0.2;

/// Walls that overlap with their image leak by the splitting of the step alone: a seam would leak at
/// any step. Measured: 1.5, 1.5 and 1.4 times less with half the step, 3.8, 3.7 and 3.2 times less
/// with an eighth.
#[test]
fn leaks_fall_with_the_step() {
    for gap in [-0.5, -0.25, 0.0] {
        let [one, two] = [1, 2].map(|parts| {
            let [_, rate, fall] = wall::<2>(20, gap, Beside::OwnImage, true, parts);
            rate / fall
        });
        assert!(one > 1.35 * two && two > 0.0, "{gap}: {one:e} {two:e}");
    }
}

#[test]
fn gaps_are_bounded_and_walls_are_closed_in_the_plane() {
    with_threads(1, || sweep::<2>(20));
}

#[test]
fn gaps_are_bounded_and_walls_are_closed_in_space() {
    with_threads(1, || sweep::<3>(12));
}

/// Largest velocity \[m/s\] of 150 steps of free bodies in a row under a lid of 1 m/s, that start
/// apart along y by 0.2 m/s each.
fn row<const D: usize, L: ContactLaw + 'static>(
    law: L,
    gap: f64,
    (free, round): (&[bool], bool),
    density: f64,
    share: f64,
) -> f64 {
    let h = 1.0 / 20.0;
    let grid = CartesianGrid::new([20; D], [1.0; D]).unwrap();
    let sides = std::array::from_fn(|a| {
        if a == 1 { [Side::WALL, Side::Wall([1.0, 0.0, 0.0])] } else { Side::WALL.both() }
    });
    let flow = Projection::new(grid, sides, FLUID).unwrap().with_diffusion(Diffusion::Explicit);
    let mut bodies = RigidBodies::with_law(Periods::default(), law);
    let wide = 5.5 * h;
    for (b, &free) in free.iter().enumerate() {
        let linear = if free { 0.2 * (b as f64 - 0.5) * Vector::y() } else { Vector::zeros() };
        let (twist, at) =
            (Twist { linear, ..Twist::default() }, [0.21 + b as f64 * (wide + gap * h), 0.51, 0.49]);
        if round {
            let material = Material { density, youngs_modulus: 10.0, ..Material::default() };
            let freedom = if !free {
                Freedom::NONE
            } else if D == 2 {
                Freedom::PLANAR
            } else {
                Freedom::FREE
            };
            let pose = Pose::at([at[0], at[1], if D == 2 { 0.0 } else { at[2] }]);
            match D {
                2 => bodies.add(Disc::new(0.5 * wide).unwrap(), material, pose, twist, freedom),
                _ => bodies.add(Sphere::new(0.5 * wide).unwrap(), material, pose, twist, freedom),
            }
            .unwrap();
        } else {
            add_block::<D, L>(&mut bodies, [wide; 3], at, density, (free, twist));
        }
    }
    let particles = Particles::new(bodies, SmoothForcing::new(1.0), 1.0, -Vector::y());
    let mut run = Simulation::new(flow, particles, WeightBalance::None).unwrap();
    let dt = share * 0.8 * run.flow.viscous_limit().min(0.4 / 20.0);
    let mut fastest = 0.0_f64;
    for _ in 0..if D == 2 { 150 } else { 50 } {
        if run.step(dt).is_err() {
            return f64::INFINITY;
        }
        fastest =
            (0..D).flat_map(|c| run.flow.centred_velocity(c)).fold(fastest, |most, u| most.max(u.abs()));
    }
    fastest
}

/// Free bodies that overlap with others, whatever their density, step and contact, are no faster
/// than the lid: forced one after the other light ones diverge within ten steps.
fn overlapping_bodies_stay_slow<const D: usize>() {
    for density in [1.5, 0.3, 0.05] {
        for free in [&[true, true][..], &[true, true, true], &[false, true]] {
            for gap in [-0.5, -0.25, 0.0] {
                for round in [true, false] {
                    for share in if D == 2 { &[1.0, 0.2][..] } else { &[1.0] } {
                        let fastest = [
                            row::<D, ()>((), gap, (free, round), density, *share),
                            row::<D, Chen>(Chen::default(), gap, (free, round), density, *share),
                        ];
                        assert!(
                            fastest.iter().all(|fastest| *fastest < 1.0),
                            "{D}D, {density}, {free:?}, {gap} cells, round {round}, dt {share}: {fastest:?}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn overlapping_free_bodies_stay_slow_in_the_plane() {
    with_threads(1, overlapping_bodies_stay_slow::<2>);
}

#[test]
fn overlapping_free_bodies_stay_slow_in_space() {
    with_threads(1, overlapping_bodies_stay_slow::<3>);
}
