use super::*;
use crate::Hfdib;
use crate::testing::{Ball, Balls, Brick, Collocated, Plain, lattice};
use interfaces::{Lattice, Nodes, Pose, Solid, Twist};

fn scene(u: impl Fn([f64; 3]) -> [f64; 3]) -> (Balls, Collocated, SmoothForcing) {
    let mut bodies = Balls::new(2, 0.5, vec![[0.1, 1.2, 0.0]]);
    bodies.twists[0] = Twist { linear: Vector::new(0.3, -0.2, 0.0), angular: Vector::new(0.0, 0.0, 0.7) };
    let velocity = Collocated::new(lattice(2, [0.05; 3], 3.0), u);
    let mut forcing = SmoothForcing::new(2.0);
    forcing.place(&velocity, &bodies).unwrap();
    (bodies, velocity, forcing)
}

/// What the fluid gets the body loses, linear and angular momentum, over a periodic side.
#[test]
fn momentum_is_conserved() {
    let (bodies, mut velocity, mut forcing) = scene(|x| [x[1].sin(), x[0].cos(), 0.0]);
    let total = |v: &Collocated| {
        let mass = 2.0 * v.lattice.volume([0; 3]);
        Vector::new(v.values[0].iter().sum::<f64>() * mass, v.values[1].iter().sum::<f64>() * mass, 0.0)
    };
    let before = total(&velocity);
    forcing.force(&mut velocity, &bodies);
    let gained = total(&velocity) - before;
    let reaction = forcing.reaction(BodyId(0)).force;
    assert!(reaction.norm() > 0.1);
    // Round-off of the sums over the whole field.
    assert!((gained + reaction).norm() < 1e-14 * 2.0 * 9.0, "{gained} {reaction}");
}

/// What bodies give the fluid is got, hidden or lost, and nothing else: an identity, with slip and without.
#[test]
fn what_bodies_give_is_got_hidden_or_lost() {
    for step in [None, Some(ViscousStep { diffused: 1e-4, implicit: Vector::zeros() })] {
        let (mut bodies, mut velocity, mut forcing) = scene(|x| [x[1].sin(), x[0].cos(), 0.0]);
        // A surface that runs round the body.
        bodies.motion = Some(Box::new(|arm| 0.8 * Vector::new(-arm.y, 0.5 * arm.x, 0.0)));
        forcing.begin(step);
        forcing.place(&velocity, &bodies).unwrap();
        let energy =
            |v: &Collocated| v.lattice.volume([0; 3]) * v.values.iter().flatten().map(|u| u * u).sum::<f64>();
        let (before, had) = (velocity.values.clone(), energy(&velocity));
        forcing.force(&mut velocity, &bodies);
        let (reaction, twist) = (forcing.reaction(BodyId(0)), bodies.twists[0]);
        let own = forcing.surface_work(&bodies);
        let given = own - reaction.force.dot(&twist.linear) - reaction.torque.dot(&twist.angular);
        let before: Vec<&[f64]> = before.iter().map(|u| &u[..]).collect();
        let lost = forcing.inelastic_loss(&before, &velocity, &bodies, &|_| twist);
        let (got, hidden) = (energy(&velocity) - had, forcing.hidden_dissipation());
        assert!((given - got - hidden - lost).abs() < 1e-12 * had, "{given:e} {got:e} {hidden:e} {lost:e}");
        assert!(own.abs() > 0.01 * given.abs());
        assert!(lost > 0.1 * got.abs() && (hidden > 0.0) == step.is_some(), "{got:e} {hidden:e} {lost:e}");
    }
}

/// More passes leave less slip; fluid that moves with the body is left alone.
#[test]
fn passes_remove_the_slip() {
    let (bodies, velocity, _) = scene(|_| [0.0; 3]);
    let mut last = f64::INFINITY;
    for passes in [1, 3, 10] {
        let mut u = Collocated { lattice: velocity.lattice.clone(), values: velocity.values.clone() };
        let mut forcing = SmoothForcing::new(2.0).with_passes(passes);
        forcing.place(&u, &bodies).unwrap();
        forcing.force(&mut u, &bodies);
        let slip = forcing.slip(&u, &bodies);
        assert!(slip < 0.7 * last, "{passes}: {slip} after {last}");
        last = slip;
    }
    assert!(last < 0.02, "{last}");
    let (bodies, mut velocity, mut forcing) = scene(|x| {
        // Rigid motion about the body's centre, which stands across the periodic side.
        let rx = x[0] - 0.1 - 3.0 * ((x[0] - 0.1) / 3.0).round();
        [0.3 - 0.7 * (x[1] - 1.2), -0.2 + 0.7 * rx, 0.0]
    });
    forcing.force(&mut velocity, &bodies);
    assert!(forcing.reaction(BodyId(0)).force.norm() < 1e-13);
    assert!(forcing.slip(&velocity, &bodies) < 1e-13);
}

/// Markers found from signed distances alone do what a shape's own, evenly spaced ones do; in space too, and on a brick.
#[test]
fn any_shape_has_markers() {
    let forced = |dim: usize, solid: Box<dyn Solid>, passes: usize| {
        let mut bodies =
            Balls::boxed(solid, 1.0, vec![Pose::at([1.512, 1.483, if dim == 2 { 0.0 } else { 1.5 }])]);
        bodies.twists[0].linear.x = 1.0;
        bodies.twists[0].angular.z = 0.5;
        let mut velocity = Collocated::new(lattice(dim, [0.1; 3], 3.0), |_| [0.0; 3]);
        let mut forcing = SmoothForcing::new(1.0).with_passes(passes);
        forcing.begin(Some(ViscousStep { diffused: 2e-3, implicit: Vector::zeros() }));
        forcing.place(&velocity, &bodies).unwrap();
        forcing.force(&mut velocity, &bodies);
        (forcing.reaction(BodyId(0)), forcing.slip(&velocity, &bodies))
    };
    let ball = |dim| Ball { dim, radius: 0.5 };
    let (even, smooth) = forced(2, Box::new(ball(2)), 3);
    let (found, slip) = forced(2, Box::new(Plain(ball(2))), 3);
    assert!((found.force - even.force).norm() < 0.01 * even.force.norm(), "{even:?} {found:?}");
    assert!((found.torque.z / even.torque.z - 1.0).abs() < 0.02, "{even:?} {found:?}");
    assert!(slip < 7e-3 && smooth < 4e-3, "{slip} {smooth}");
    let solids: [fn() -> Box<dyn Solid>; 2] =
        [|| Box::new(Plain(Ball { dim: 3, radius: 0.5 })), || Box::new(Brick([0.5, 0.3, 0.4]))];
    for solid in solids {
        let slips = [1, 3, 10, 50].map(|passes| forced(3, solid(), passes).1);
        assert!(slips.windows(2).all(|s| s[1] < 0.9 * s[0]), "{slips:?}");
    }
}

/// A body cut by a bounded side: the stencils that are cut off too do not make passes diverge.
#[test]
fn passes_converge_at_a_wall() {
    let mut bodies = Balls::new(2, 0.5, vec![[1.5, 0.44, 0.0]]);
    bodies.twists[0].linear.x = 1.0;
    let axes = [true, false].map(|periodic| Nodes::uniform(0.025, 0.05, 60, periodic));
    let lattice = Lattice::new(axes, 0, [1, 60]);
    let slip = |passes| {
        let mut u = Collocated::new(lattice.clone(), |_| [0.0; 3]);
        let mut forcing = SmoothForcing::new(2.0).with_passes(passes);
        forcing.place(&u, &bodies).unwrap();
        forcing.force(&mut u, &bodies);
        forcing.slip(&u, &bodies)
    };
    let slips = [1, 3, 10, 100].map(slip);
    assert!(slips.windows(2).all(|s| s[1] < 0.9 * s[0]) && slips[3] < 0.1, "{slips:?}");
}

/// b − M·v = Σ √w (1 − y P_t) √w (û − U − Ω×r), w = (1−χ) ρ A h/c, and its moment, for every v; y = β/(1 + β).
#[test]
fn the_layer_foresees_what_the_markers_outside_take() {
    // The last one sharpens more than the kernel blurs: β < 0.
    let implicit = Vector::new(0.5, 0.0, 0.0);
    for step in [None, Some(2e-4), Some(5e-2)].map(|s| s.map(|diffused| ViscousStep { diffused, implicit })) {
        let (bodies, velocity, mut forcing) = scene(|x| [x[1].sin(), x[0].cos(), 0.0]);
        if step.is_some() {
            forcing.begin(step);
            forcing.place(&velocity, &bodies).unwrap();
        }
        let (layer, twist) = (forcing.layer(&velocity, &bodies, BodyId(0)), bodies.twists[0]);
        let v = nalgebra::Vector6::new(twist.linear.x, twist.linear.y, 0.0, 0.0, 0.0, twist.angular.z);
        let foreseen = layer.momentum - layer.mass * v;
        let mut weights = [const { Vec::new() }; 2];
        let mut found = [const { Vec::new() }; 2];
        for c in 0..2 {
            forcing.find_outside(&velocity, c, BodyId(0), &mut weights[c]);
            // About half of what markers on the surface reach is outside, less of those a third of a cell inside.
            let known = if step.is_some() { 0.3..0.7 } else { 0.1..0.5 };
            assert!(weights[c].iter().all(|share| known.contains(share)), "{:?}", weights[c]);
            forcing.bodies[0].stencils.read(c, &velocity.lattice, &velocity.values[c], &mut found[c]);
        }
        let (mut sum, markers) = (Wrench::default(), &forcing.bodies[0]);
        for (m, &arm) in markers.arms.iter().enumerate() {
            let root = Vector::new(weights[0][m], weights[1][m], 0.0).map(|w| (w * markers.masses[m]).sqrt());
            let off = Vector::new(found[0][m], found[1][m], 0.0) - twist.at(arm);
            let off = root.component_mul(&off);
            let taken = markers.slip.answer(m, off);
            sum += Wrench::at(root.component_mul(&taken), arm);
        }
        let known = [sum.force.x, sum.force.y, 0.0, 0.0, 0.0, sum.torque.z];
        for (i, known) in known.into_iter().enumerate() {
            assert!((foreseen[i] - known).abs() < 1e-13, "{i}: {} {known}", foreseen[i]);
        }
    }
}

#[test]
fn too_coarse_a_grid_is_refused() {
    let bodies = Balls::new(2, 0.5, vec![[1.0, 1.0, 0.0]]);
    let velocity = Collocated::new(lattice(2, [0.3; 3], 3.0), |_| [0.0; 3]);
    let error = SmoothForcing::new(1.0).place(&velocity, &bodies).unwrap_err();
    assert!(matches!(error, IbmError::TooCoarse { .. }), "{error}");
}

/// Cells of 0.05 up to 1.5, of 0.1 beyond: a body is refused as soon as its markers, which read 2½ cells to each side, reach
/// the node at 1.475, from which the next is 0.075 away.
#[test]
fn unequal_cells_around_a_body_are_refused() {
    let faces: Vec<f64> =
        (0..30).map(|i| 0.05 * f64::from(i)).chain((15..=30).map(|i| 0.1 * f64::from(i))).collect();
    for axis in [0, 1] {
        let nodes = |a: usize| {
            if a == axis { Nodes::centres(&faces, true) } else { Nodes::uniform(0.025, 0.05, 60, true) }
        };
        let axes = [nodes(0), nodes(1)];
        let stride = axes[0].len();
        let velocity = Collocated::new(Lattice::new(axes, 0, [1, stride]), |_| [0.0; 3]);
        let place = |at: f64| {
            let mut centre = [1.5, 1.5, 0.0];
            centre[axis] = at;
            SmoothForcing::new(1.0).place(&velocity, &Balls::new(2, 0.3, vec![centre]))
        };
        assert_eq!(place(1.04), Ok(()));
        for (at, widest) in [(1.06, 0.075), (1.5, 0.1)] {
            let Err(IbmError::Stretched { body: BodyId(0), axis: found, least, most }) = place(at) else {
                panic!("a body at {at} was placed");
            };
            assert!(
                found == axis && (least - 0.05).abs() < 1e-12 && (most - widest).abs() < 1e-12,
                "{least} {most}"
            );
        }
    }
}

/// Two bodies whose markers share fluid and that move apart bear like forces, whoever is forced first: they take turns.
#[test]
fn near_bodies_take_turns() {
    let pair = |gap: f64| {
        let mut bodies = Balls::new(2, 0.5, vec![[0.9, 1.5, 0.0], [1.9 + gap, 1.5, 0.0]]);
        (bodies.twists[0].linear.x, bodies.twists[1].linear.x) = (-1.0, 1.0);
        let mut velocity = Collocated::new(lattice(2, [0.05; 3], 3.0), |_| [0.0; 3]);
        let mut forcing = SmoothForcing::new(1.0);
        forcing.place(&velocity, &bodies).unwrap();
        forcing.force(&mut velocity, &bodies);
        let [a, b] = [0, 1].map(|b| forcing.reaction(BodyId(b)).force.x);
        ([forcing.bodies[0].alone, forcing.bodies[1].alone], (a / b).abs())
    };
    let (alone, ratio) = pair(0.5);
    assert!(alone == [true, true] && (ratio - 1.0).abs() < 1e-12, "{alone:?} {ratio}");
    let (alone, ratio) = pair(0.05);
    assert!(alone == [false, false] && (ratio - 1.0).abs() < 1e-3, "{alone:?} {ratio}");
}

/// One forcing serves another grid as a new one does.
#[test]
fn another_grid_is_noticed() {
    let bodies = Balls::new(2, 0.5, vec![[1.3, 1.2, 0.0]]);
    let mut old = SmoothForcing::new(1.0);
    for spacing in [0.1, 0.05, 0.06] {
        let fluid = |forcing: &mut SmoothForcing| {
            let mut velocity =
                Collocated::new(lattice(2, [spacing; 3], 3.0), |x| [x[1].sin(), x[0].cos(), 0.0]);
            forcing.place(&velocity, &bodies).unwrap();
            forcing.force(&mut velocity, &bodies);
            (velocity.values, forcing.reaction(BodyId(0)))
        };
        assert_eq!(fluid(&mut old), fluid(&mut SmoothForcing::new(1.0)), "{spacing}");
    }
}

/// Between walls one cell apart the component across has no nodes: nothing is read or written there.
#[test]
fn a_component_without_nodes_is_left_alone() {
    let axes = [
        Nodes::uniform(0.05, 0.1, 30, true),
        Nodes::uniform(0.05, 0.1, 30, true),
        Nodes::faces(&[0.0, 0.1], false),
    ];
    assert_eq!(axes[2].len(), 0);
    let mut velocity = Collocated::new(lattice(3, [0.1; 3], 3.0), |_| [1.0; 3]);
    velocity.lattice = Lattice::new(axes, 0, [1, 30, 900]);
    let bodies = Balls::of(Plain(Ball { dim: 3, radius: 0.5 }), 1.0, vec![Pose::at([1.5, 1.5, 0.05])]);
    let mut forcing = SmoothForcing::new(1.0);
    forcing.place(&velocity, &bodies).unwrap();
    forcing.force(&mut velocity, &bodies);
    assert!(velocity.values[0].iter().all(|u| *u == 1.0));
    assert_eq!(forcing.reaction(BodyId(0)), Wrench::default());
}

/// A surface that turns about a body at rest drives the fluid as a body that turns does, whatever the forcing; and the layer takes it for
/// fluid that is at rest when it moves with the surface.
#[test]
fn surfaces_may_move_by_themselves() {
    let twist = Twist { linear: Vector::new(0.3, -0.2, 0.0), angular: Vector::new(0.0, 0.0, 0.7) };
    let forcings: [fn() -> Box<dyn Forcing>; 2] =
        [|| Box::new(SmoothForcing::new(2.0)), || Box::new(Hfdib::new(2.0))];
    for forcing in forcings {
        let forced = |by_itself: bool| {
            let mut bodies = Balls::new(2, 0.5, vec![[0.1, 1.2, 0.0]]);
            if by_itself {
                bodies.motion = Some(Box::new(move |arm| twist.at(arm)));
            } else {
                bodies.twists[0] = twist;
            }
            let mut velocity = Collocated::new(lattice(2, [0.05; 3], 3.0), |x| [x[1].sin(), x[0].cos(), 0.0]);
            let mut forcing = forcing();
            forcing.place(&velocity, &bodies).unwrap();
            let layer = forcing.layer(&velocity, &bodies, BodyId(0));
            forcing.force(&mut velocity, &bodies);
            let slip = forcing.slip(&velocity, &bodies);
            (velocity, slip, layer, bodies)
        };
        let [(moved, slip, layer, _), (driven, other, seen, bodies)] = [false, true].map(forced);
        assert!((slip - other).abs() < 1e-12, "{slip} {other}");
        let v = nalgebra::Vector6::new(0.3, -0.2, 0.0, 0.0, 0.0, 0.7);
        assert!((layer.mass - seen.mass).norm() < 1e-12);
        assert!((layer.momentum - layer.mass * v - seen.momentum).norm() < 1e-12, "{layer:?} {seen:?}");
        for c in 0..2 {
            for (index, (a, b)) in moved.values[c].iter().zip(&driven.values[c]).enumerate() {
                let x = Point::from(moved.lattice.position(moved.lattice.node(index)));
                // Deep inside the paper's forcing sets the body's own velocity.
                let arm = interfaces::Periods::new([Some(3.0); 3]).nearest(x - bodies.poses[0].position);
                assert!((a - b).abs() < 1e-12 || arm.norm() < 0.5, "{x}: {a} {b}");
            }
        }
    }
}

/// A disc whose markers are mirror images of one another leaves a flow that is its own mirror image, whether its kernel stands about the
/// nearest node or between two.
#[test]
fn what_is_symmetric_stays_symmetric() {
    for kernel in [Kernel::Yang, Kernel::QuarticSpline, Kernel::QuinticSpline] {
        let mut bodies = Balls::new(2, 0.5, vec![[1.3, 1.5, 0.0]]);
        bodies.twists[0].linear.x = 1.0;
        let mut velocity = Collocated::new(lattice(2, [0.05; 3], 3.0), |_| [0.0; 3]);
        let mut forcing = SmoothForcing::new(1.0).with_kernel(kernel);
        forcing.place(&velocity, &bodies).unwrap();
        forcing.force(&mut velocity, &bodies);
        let (u, n) = (&velocity.values[0], 60);
        let worst = (0..n * n).map(|at| (u[at] - u[at % n + n * (n - 1 - at / n)]).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-13, "{kernel:?}: {worst}");
        assert!(u.iter().fold(0.0, |most: f64, u| most.max(*u)) > 0.9, "{kernel:?}");
    }
}

/// s of a disc whose gap to another one, across a periodic side, or to a side of the box is so many cells: 1 from three on, 0 below two.
#[test]
fn markers_stand_deeper_where_another_surface_is_near() {
    let h = 0.05;
    let step = Some(ViscousStep { diffused: 0.2 * h * h, implicit: Vector::zeros() });
    let axes = [true, false].map(|periodic| Nodes::uniform(0.5 * h, h, 60, periodic));
    let velocity = Collocated::new(Lattice::new(axes, 0, [1, 60]), |_| [0.0; 3]);
    let mut bodies = Balls::new(2, 0.5, vec![[0.3, 1.5, 0.0], [1.7, 1.5, 0.0]]);
    let mut forcing = SmoothForcing::new(1.0);
    let mut shares = |at: [f64; 2]| {
        bodies.poses[1] = Pose::at([at[0], at[1], 0.0]);
        forcing.begin(step);
        forcing.place(&velocity, &bodies).unwrap();
        [0, 1].map(|b| forcing.bodies[b].share)
    };
    // The first disc stays where it is, and follows what comes near and goes.
    let (far, period) = ([1.7, 1.5], 3.0);
    for (gap, known) in [(1.9, 0.0), (2.0, 0.0), (2.25, 0.25), (2.75, 0.75), (3.0, 1.0), (3.5, 1.0)] {
        let close = |found: f64| (found - known).abs() < 0.03;
        let found = shares([1.3 + gap * h, 1.5]);
        assert!(found.into_iter().all(close), "{gap}: {found:?}");
        assert_eq!(shares(far), [1.0, 1.0]);
        let found = shares([0.3 + period - 1.0 - gap * h, 1.5]);
        assert!(found.into_iter().all(close), "across the side, {gap}: {found:?}");
        for side in [0.5 + gap * h, 2.5 - gap * h] {
            let found = shares([1.8, side]);
            assert!(found[0] == 1.0 && close(found[1]), "{gap} from the side: {found:?}");
        }
    }
    // Without a viscosity nothing is made up for.
    shares(far);
    forcing.begin(None);
    forcing.place(&velocity, &bodies).unwrap();
    assert_eq!([0, 1].map(|b| forcing.bodies[b].share), [0.0, 0.0]);
}

/// The largest eigenvalue λ of the pass operator EᵀDE for component `c`, by powers: passes leave (1
/// − λ)ⁿ of its mode.
fn spectral_radius(bodies: &Balls, lattice: &Lattice, c: usize) -> f64 {
    let mut velocity = Collocated::new(lattice.clone(), |_| [0.0; 3]);
    // Golden-ratio sequence: all modes are in it.
    let start = |(i, u): (usize, &mut f64)| *u = (0.618_033_988_75 * (i + 1) as f64).fract();
    velocity.values[c].iter_mut().enumerate().for_each(start);
    let mut forcing = SmoothForcing::new(1.0).with_passes(1);
    forcing.place(&velocity, bodies).unwrap();
    let norm = |v: &[f64]| v.iter().map(|u| u * u).sum::<f64>().sqrt();
    let mut radius = 0.0;
    for _ in 0..60 {
        let before = velocity.values[c].clone();
        forcing.force(&mut velocity, bodies);
        velocity.values[c].iter_mut().zip(&before).for_each(|(u, before)| *u = before - *u);
        radius = norm(&velocity.values[c]) / norm(&before);
        if radius == 0.0 {
            // No markers are left.
            return 0.0;
        }
        velocity.values[c].iter_mut().for_each(|u| *u /= radius);
    }
    radius
}

/// Blocks that are shorter than the period by so many cells, along one axis, two or all, and balls:
/// without relaxation λ is up to 1.99 (plane) and 2.2, and an odd number of passes reverses what it
/// should remove. Single convex bodies stay as they are.
#[test]
fn passes_do_not_overshoot_where_sheets_overlap() {
    let period = 3.0;
    for dim in [2, 3] {
        let h = if dim == 2 { 0.1 } else { 3.0 / 16.0 };
        let lattice = lattice(dim, [h; 3], period);
        let flat = |half: f64| if dim == 2 { 0.0 } else { half };
        let pose = || vec![Pose::at([1.512, 1.483, flat(1.47)])];
        for gap in [-0.5, -0.1, 0.0, 0.05, 0.1, 0.3, 0.5] {
            let long = 0.5 * (period - gap * h);
            for half in [[long, 0.7, 0.6], [long, long, 0.6], [long; 3]] {
                let bodies = Balls::of(Brick([half[0], half[1], flat(half[2])]), 1.0, pose());
                let radius = spectral_radius(&bodies, &lattice, dim - 1);
                assert!(radius < 1.0 + 1e-9, "{dim}D, {gap} cells, {half:?}: {radius}");
            }
            let bodies = Balls::of(Ball { dim, radius: long }, 1.0, pose());
            // Round sheets overlap at a point: less than relaxation begins with, or none.
            let radius = spectral_radius(&bodies, &lattice, 0);
            assert!(radius < 1.5, "{dim}D, ball, {gap} cells: {radius}");
        }
        for half in [2.01 * h, 4.0 * h] {
            let mut forcing = SmoothForcing::new(1.0);
            let velocity = Collocated::new(lattice.clone(), |_| [0.0; 3]);
            forcing.place(&velocity, &Balls::of(Brick([half, half, flat(half)]), 1.0, pose())).unwrap();
            assert!(forcing.bodies[0].overlaps.is_empty(), "{dim}D, {half}");
        }
    }
}

/// Bodies whose sheets overlap are forced at once: the impulse on the middle one of three in a row
/// does not depend on their order, and is what its layer foresees, alone and shared with others
/// (measured: 0.9 to 1.28 of it).
/// Bodies two cells apart are forced in turn.
#[test]
fn sheets_of_several_bodies_are_forced_at_once() {
    for dim in [2, 3] {
        let h = if dim == 2 { 0.1 } else { 3.0 / 20.0 };
        let wide = 4.5 * h;
        for gap in [-0.5, -0.25, -0.1, 0.0, 2.0] {
            let at =
                |b: f64| Pose::at([1.51 + b * (wide + gap * h), 1.49, if dim == 2 { 0.0 } else { 1.47 }]);
            let half = [0.5 * wide, 0.5 * wide, if dim == 2 { 0.0 } else { 0.5 * wide }];
            // The middle one moves.
            let react = |order: [f64; 3]| {
                let middle = order.iter().position(|b| *b == 0.0).unwrap();
                let mut bodies = Balls::of(Brick(half), 1.0, order.map(at).into());
                bodies.twists[middle].linear.y = 1.0;
                let mut velocity = Collocated::new(lattice(dim, [h; 3], 3.0), |_| [0.0; 3]);
                let mut forcing = SmoothForcing::new(1.0);
                forcing.place(&velocity, &bodies).unwrap();
                let layer = forcing.layer(&velocity, &bodies, BodyId(middle));
                forcing.force(&mut velocity, &bodies);
                let joint = [0, 1, 2].map(|b: usize| !forcing.bodies[b].joint.is_empty());
                let internal = forcing.internal_momentum(&velocity, &bodies, BodyId(middle));
                ((forcing.reaction(BodyId(middle)) + internal).force.y, layer, joint)
            };
            let (force, layer, joint) = react([0.0, -1.0, 1.0]);
            let (other, ..) = react([-1.0, 1.0, 0.0]);
            assert_eq!(joint, [gap < 1.0; 3], "{dim}D, {gap} cells");
            if gap < 1.0 {
                assert!((force - other).abs() < 1e-12, "{dim}D, {gap} cells: {force} {other}");
                let foreseen = layer.mass[(1, 1)] + layer.shared[(1, 1)];
                assert!(
                    -force < 1.4 * foreseen && layer.shared[(1, 1)] > 0.1 * layer.mass[(1, 1)],
                    "{dim}D, {gap} cells: {force} {layer:?}"
                );
            } else {
                assert_eq!(layer.shared, nalgebra::Matrix6::zeros());
            }
        }
    }
}

/// Spheres are forced in turn at every gap for which the films that their forcing leaves are tabulated
/// ([`SmoothFilm`](crate::SmoothFilm)).
#[test]
fn tabulated_films_are_those_of_bodies_in_turn() {
    let h = 0.1;
    for (radius, gap) in [(4.0, 0.05), (4.0, 0.2), (6.0, 0.05), (6.0, 0.2)] {
        let at = |x: f64| [x * h + 0.013, 1.507, 1.481];
        let bodies = Balls::new(3, radius * h, vec![at(8.0), at(8.0 + 2.0 * radius + gap)]);
        let velocity = Collocated::new(lattice(3, [h; 3], 3.0), |_| [0.0; 3]);
        let mut forcing = SmoothForcing::new(1.0);
        forcing.place(&velocity, &bodies).unwrap();
        assert!(forcing.bodies[0].joint.is_empty(), "{radius} {gap}");
    }
}

/// A block with a plate of 1.8 cells on it.
struct Fin(Brick, Brick);

impl Solid for Fin {
    fn signed_distance(&self, x: Point, band: f64) -> f64 {
        self.0.signed_distance(x, band).min(self.1.signed_distance(x - Vector::new(0.6, 0.0, 0.0), band))
    }
    fn aabb(&self) -> interfaces::Aabb {
        interfaces::Aabb { max: Point::new(1.2, 0.4, 0.0), ..self.0.aabb() }
    }
}

/// Both faces of a thin plate are sheets that overlap; so are markers of a body that has turned
/// towards its image.
#[test]
fn thin_plates_and_turned_bodies_are_relaxed() {
    let h = 0.1;
    let lattice = lattice(2, [h; 3], 3.0);
    let turned = |angle: f64| Pose {
        orientation: interfaces::Rotation::from_axis_angle(&Vector::z_axis(), angle),
        ..Pose::at([1.5, 1.5, 0.0])
    };
    let fin = Fin(Brick([0.4, 0.4, 0.0]), Brick([0.6, 0.9 * h, 0.0]));
    let radius = spectral_radius(&Balls::of(fin, 1.0, vec![turned(0.7)]), &lattice, 0);
    assert!(radius < 1.05, "{radius}");
    // As long as the period less a twentieth of a cell along x: near its image only then.
    let mut bar = Balls::of(Brick([1.5 - 0.025 * h, 0.4, 0.0]), 1.0, vec![turned(1.1)]);
    bar.poses[0].position.y = 1.49;
    let velocity = Collocated::new(lattice, |_| [0.0; 3]);
    let mut forcing = SmoothForcing::new(1.0);
    forcing.place(&velocity, &bar).unwrap();
    assert!(forcing.bodies[0].overlaps.is_empty());
    bar.poses[0] = turned(0.0);
    forcing.place(&velocity, &bar).unwrap();
    let most = |forcing: &SmoothForcing| forcing.bodies[0].overlaps.iter().fold(0.0, |m: f64, o| m.max(*o));
    assert!((1.5..2.5).contains(&most(&forcing)), "{}", most(&forcing));
}

/// Relaxation is that of a forcing made anew, wherever a body was before: runs go on to the bit.
#[test]
fn relaxation_follows_from_the_pose_alone() {
    let h = 0.1;
    let velocity = Collocated::new(lattice(2, [h; 3], 3.0), |_| [0.0; 3]);
    let solids: [fn() -> Box<dyn Solid>; 2] = [
        || Box::new(Fin(Brick([0.4, 0.4, 0.0]), Brick([0.6, 0.9 * 0.1, 0.0]))),
        || Box::new(Brick([1.49, 0.4, 0.0])),
    ];
    for solid in solids {
        let place = |forcing: &mut SmoothForcing, x: f64, angle: f64| {
            let orientation = interfaces::Rotation::from_axis_angle(&Vector::z_axis(), angle);
            let pose = Pose { orientation, ..Pose::at([x, 1.503, 0.0]) };
            forcing.place(&velocity, &Balls::boxed(solid(), 1.0, vec![pose])).unwrap();
            let markers = &forcing.bodies[0];
            (markers.overlaps.clone(), markers.masses.clone(), markers.stencils.relax.clone())
        };
        let mut old = SmoothForcing::new(1.0);
        for (x, angle) in [(1.5, 0.0), (1.53, 0.0), (1.53, 0.7), (1.61, 0.7), (1.61, 1.5), (1.65, 0.0)] {
            let found = place(&mut old, x, angle);
            assert_eq!(found, place(&mut SmoothForcing::new(1.0), x, angle), "{x} {angle}");
        }
        assert!(!old.bodies[0].overlaps.is_empty());
    }
}

/// No marker is on a seam that is closed, all are on the faces beside it.
#[test]
fn closed_seams_have_no_markers() {
    let h = 0.1;
    for gap in [-0.5, 0.0, 1e-9, 0.05] {
        let half = 0.5 * (3.0 - gap * h);
        let bodies = Balls::of(Brick([half, 0.7, 0.0]), 1.0, vec![Pose::at([1.512, 1.483, 0.0])]);
        let velocity = Collocated::new(lattice(2, [h; 3], 3.0), |_| [0.0; 3]);
        let mut forcing = SmoothForcing::new(1.0);
        forcing.place(&velocity, &bodies).unwrap();
        let markers = &forcing.bodies[0];
        for (e, overlap) in markers.elements.iter().zip(&markers.overlaps) {
            // Corners are cut off: their elements are neither.
            if e.point.x.abs() < half - 0.8 * h || e.point.y.abs() < 0.7 - 0.8 * h {
                let closed = e.normal.x.abs() > 0.9 && gap < 0.01;
                assert_eq!(overlap.is_infinite(), closed, "{gap}: {e:?}");
            }
        }
    }
}
