//! Boxes that move on over their fluid.
use super::*;
use crate::{Axis, Fluid, Patch, Piso, Profile, Projection, Side};
use interfaces::Checkpoint;
use std::collections::HashMap;

const FLUID: Fluid = Fluid { density: 2.0, viscosity: 2e-3 };

/// A vortex of radius 0.12 at `centre`, with no flow beyond a few radii.
fn vortex([x, y]: [f64; 2], centre: [f64; 2]) -> [f64; 2] {
    let (x, y) = ((x - centre[0]) / 0.12, (y - centre[1]) / 0.12);
    let swirl = (-0.5 * (x * x + y * y)).exp();
    [-y * swirl, x * swirl]
}

fn sides(axis: usize) -> [[Side; 2]; 2] {
    let mut sides = Side::Periodic.everywhere();
    sides[axis] = [Side::WALL, Side::ConvectiveOutlet];
    sides
}

/// Cells along x and y: `along` along `axis`, 32 across.
fn grid(axis: usize, along: usize, from: f64) -> CartesianGrid<2> {
    let mut axes = [Axis::uniform(32, 0.0, 1.0).unwrap(), Axis::uniform(32, 0.0, 1.0).unwrap()];
    axes[axis] = Axis::uniform(along, from, from + along as f64 / 32.0).unwrap();
    CartesianGrid::from_axes(axes).unwrap()
}

/// Velocities of component `c` by the place of their nodes, in bits.
fn by_place(velocity: &crate::Velocity<2>, c: usize) -> HashMap<[u64; 2], u64> {
    let lattice = velocity.lattice(c);
    let [nx, ny, _] = lattice.shape();
    let faces = velocity.field(c).grid();
    let nodes = (0..ny).flat_map(|j| (0..nx).map(move |i| [i, j]));
    let shown = nodes.map(|[i, j]| {
        let node = [i as isize, j as isize, 0];
        let cell = faces.cell_at(lattice.index(node).unwrap()).unwrap();
        let place = std::array::from_fn(|a| {
            let x = if a == c { faces.axis(a).faces()[cell[a]] } else { faces.axis(a).centre(cell[a]) };
            x.to_bits()
        });
        (place, velocity.component(c)[lattice.index(node).unwrap()].to_bits())
    });
    shown.collect()
}

#[test]
fn layers_move_and_the_last_one_is_repeated() {
    for (by, expected) in [
        (0, [0, 1, 2, 3, 4, 5]),
        (1, [0, 2, 3, 4, 4, 5]),
        (3, [0, 4, 4, 4, 4, 5]),
        (4, [0, 4, 4, 4, 4, 5]),
        (i64::MIN, [0, 1, 1, 1, 1, 5]),
        (-1, [0, 1, 1, 2, 3, 5]),
        (-3, [0, 1, 1, 1, 1, 5]),
    ] {
        let mut values: Vec<f64> = (0..24).map(f64::from).collect();
        slide(&mut values, 2, 6, 1..=4, by);
        let found: Vec<f64> = values.iter().step_by(2).copied().collect();
        let both = expected.iter().chain(&expected).enumerate();
        let expected: Vec<f64> = both.map(|(k, layer)| f64::from(12 * (k as i32 / 6) + 2 * layer)).collect();
        assert_eq!(found, expected, "{by}");
    }
}

/// What both boxes hold is the same to the bit in value and place, and going back ends at the first places.
#[test]
fn values_stay_where_they_are() {
    for axis in 0..2 {
        let mut flow = Projection::new(grid(axis, 48, -0.2), sides(axis), FLUID).unwrap();
        flow.set_velocity(|x| vortex(x, if axis == 0 { [0.6, 0.5] } else { [0.5, 0.6] }));
        for _ in 0..4 {
            flow.advance(2e-3, [0.0; 2]).unwrap();
        }
        let (first, home) = (flow.velocity().clone(), flow.grid().clone());
        for cells in [7, -3] {
            flow.move_window(axis, cells).unwrap();
        }
        assert_eq!(flow.window()[axis], 4);
        assert_eq!(flow.grid().axis(axis).faces()[..45], home.axis(axis).faces()[4..]);
        for c in 0..2 {
            let (old, new) = (by_place(&first, c), by_place(flow.velocity(), c));
            let common = new.iter().filter(|(place, _)| old.contains_key(*place)).count();
            // Seven layers were lost, four of them by where the box is now; and the faces that became the lower side.
            assert_eq!(common, 32 * (44 - usize::from(c == axis)));
            let same = new.iter().filter(|(place, u)| old.get(*place) == Some(u)).count();
            assert!(same >= 32 * (41 - usize::from(c == axis)), "{same} of {common}");
        }
        flow.advance(2e-3, [0.0; 2]).unwrap();
        assert!(flow.statistics().divergence < 1e-11, "{:?}", flow.statistics());
        flow.move_window(axis, -4).unwrap();
        assert_eq!(flow.grid(), &home);
    }
}

/// A vortex carried along by the stream: a short box that follows it, and a long one.
#[test]
fn a_window_sees_what_a_long_box_sees() {
    let stream = |v: f64| {
        let ends = [Side::Inlet(Profile::Uniform([v, 0.0, 0.0])), Side::ConvectiveOutlet];
        [ends, [Side::Periodic, Side::Periodic]]
    };
    let start = |x: [f64; 2]| {
        let [u, v] = vortex(x, [0.8, 0.5]);
        [u + 1.0, v]
    };
    let new = |cells| Projection::new(grid(0, cells, 0.0), stream(1.0), FLUID).unwrap();
    let (mut long, mut window) = (new(128), new(52));
    for flow in [&mut long, &mut window] {
        flow.set_velocity(start);
    }
    let mut worst = [0.0_f64; 2];
    for step in 1..=320 {
        for flow in [&mut long, &mut window] {
            flow.advance(5e-3, [0.0; 2]).unwrap();
        }
        let passed = (step as f64 * 5e-3 * 32.0) as i64;
        let by = passed - window.window()[0];
        window.move_window(0, by).unwrap();
        let from = usize::try_from(window.window()[0]).unwrap();
        for c in 0..2 {
            for j in 0..32 {
                let (a, b) = (long.velocity().field(c).row(j), window.velocity().field(c).row(j));
                for i in 10..42 {
                    worst[c] = worst[c].max((a[from + i] - b[i]).abs());
                }
            }
        }
    }
    assert_eq!(window.window(), [51, 0]);
    assert!(worst.iter().all(|w| *w < 2e-3), "{worst:?}");
}

#[test]
fn a_uniform_stream_does_not_notice() {
    let ends = [Side::Inlet(Profile::Uniform([1.0, 0.3, 0.0])), Side::PressureOutlet(0.0)];
    let sides = [ends, [Side::Periodic, Side::Periodic]];
    let mut flow = Projection::new(grid(0, 32, 0.0), sides, FLUID).unwrap();
    flow.set_velocity(|_| [1.0, 0.3]);
    for cells in [3, -5, 40, -1] {
        flow.move_window(0, cells).unwrap();
        flow.advance(2e-3, [0.0; 2]).unwrap();
        for (c, expected) in [1.0, 0.3].into_iter().enumerate() {
            assert!(flow.velocity().field(c).values().all(|u| (u - expected).abs() < 1e-12));
        }
    }
}

fn state(of: &impl Checkpoint) -> HashMap<String, Vec<f64>> {
    let mut saved = HashMap::new();
    of.save(&mut |name, values| {
        saved.insert(name.to_owned(), values.to_vec());
    });
    saved
}

#[test]
fn restarts_know_where_the_box_was() {
    let swirl = |x| vortex(x, [0.6, 0.5]);
    let projection = || Projection::new(grid(0, 40, 0.0), sides(0), FLUID).unwrap();
    let piso = || Piso::new(grid(0, 40, 0.0), sides(0), FLUID).unwrap();
    let (mut a, mut b) = (projection(), piso());
    a.set_velocity(swirl);
    b.set_velocity(swirl);
    for _ in 0..3 {
        a.advance(2e-3, [0.0; 2]).unwrap();
        b.advance(2e-3, [0.0; 2], &mut ()).unwrap();
        a.move_window(0, 2).unwrap();
        b.move_window(0, 2).unwrap();
    }
    let (saved_a, saved_b) = (state(&a), state(&b));
    let (mut c, mut d) = (projection(), piso());
    c.restore(&|name| saved_a.get(name).map(Vec::as_slice)).unwrap();
    d.restore(&|name| saved_b.get(name).map(Vec::as_slice)).unwrap();
    assert_eq!((c.window(), d.window()), ([6, 0], [6, 0]));
    a.advance(2e-3, [0.0; 2]).unwrap();
    c.advance(2e-3, [0.0; 2]).unwrap();
    assert_eq!(state(&a), state(&c));
    b.advance(2e-3, [0.0; 2], &mut ()).unwrap();
    d.advance(2e-3, [0.0; 2], &mut ()).unwrap();
    assert_eq!(state(&b), state(&d));
    assert!(b.statistics().divergence < 1e-5);
    // Back to a state from before any move.
    let start = state(&projection());
    c.restore(&|name| start.get(name).map(Vec::as_slice)).unwrap();
    assert_eq!((c.window(), c.grid()), ([0, 0], projection().grid()));
}

#[test]
fn boxes_that_cannot_move() {
    let cannot = |mut flow: Projection<2>, axis| {
        let before = flow.grid().clone();
        let error = flow.move_window(axis, 1).unwrap_err();
        assert!(matches!(error, FlowError::Window { .. }), "{error}");
        assert_eq!((flow.grid(), flow.window()), (&before, [0, 0]));
    };
    let new = |grid, sides| Projection::new(grid, sides, FLUID).unwrap();
    cannot(new(grid(0, 32, 0.0), sides(0)), 1);
    cannot(new(grid(0, 32, 0.0), sides(0)), 2);
    cannot(new(grid(0, 1, 0.0), sides(0)), 0);
    let stretched = [Axis::geometric(8, 0.0, 1.0, 1.1).unwrap(), Axis::uniform(8, 0.0, 1.0).unwrap()];
    cannot(new(CartesianGrid::from_axes(stretched).unwrap(), sides(0)), 0);
    let patch = |lower: f64, upper: f64| Patch {
        lower: [lower, -1.0, 0.0],
        upper: [upper, 2.0, 0.0],
        side: Side::WALL,
    };
    let patches = Side::Patches(vec![patch(-1.0, 0.5), patch(0.5, 2.0)]);
    let beside = [[Side::WALL, Side::WALL], [Side::WALL, patches]];
    cannot(new(grid(0, 32, 0.0), beside.clone()), 0);
    // Patches on the ends move along.
    let mut flow = new(grid(1, 32, 0.0), beside);
    flow.move_window(1, 1).unwrap();
    let far = Projection::new(grid(0, 32, 0.0), sides(0), FLUID).unwrap().move_window(0, i64::MAX);
    assert!(matches!(far, Err(FlowError::Grid { .. })), "{far:?}");
}
