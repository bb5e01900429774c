use crate::testing::{Balls, Faceted, lattice};
use crate::{SolidFraction, SolidNode, plane_fraction};
use interfaces::{BodyId, Lattice, Nodes, Point, Pose, Rotation, Vector};
use proptest::prelude::*;

/// A brick between two corners.
fn brick(low: [f64; 3], high: [f64; 3]) -> Faceted {
    let corner = |i: usize| Point::from([0, 1, 2].map(|a| if i >> a & 1 == 0 { low[a] } else { high[a] }));
    let faces = vec![
        [0, 2, 3],
        [0, 3, 1],
        [4, 5, 7],
        [4, 7, 6],
        [0, 1, 5],
        [0, 5, 4],
        [2, 6, 7],
        [2, 7, 3],
        [0, 4, 6],
        [0, 6, 2],
        [1, 3, 7],
        [1, 7, 5],
    ];
    Faceted::new((0..8).map(corner).collect(), faces)
}

fn nodes(lattice: &Lattice, mesh: Faceted, pose: Pose) -> Vec<SolidNode> {
    let (mut fraction, volume) = (SolidFraction::new(), mesh.volume());
    fraction.update(lattice, &Balls::of(mesh, volume, vec![pose])).unwrap();
    fraction.nodes(BodyId(0)).to_vec()
}

fn total(nodes: &[SolidNode]) -> f64 {
    nodes.iter().map(|n| n.fraction * n.volume).sum()
}

/// Between walls at 0 and 2, cells growing or the same, on faces or centres.
fn bounded(equal: bool, faces: bool) -> Lattice {
    let sides: Vec<f64> =
        (0..=20).map(|i| 0.1 * f64::from(i)).map(|x| if equal { x } else { 0.5 * x * x }).collect();
    let axis = |on_faces| if on_faces { Nodes::faces(&sides, false) } else { Nodes::centres(&sides, false) };
    let axes = [axis(faces), axis(false), axis(false)];
    let n = axes[0].len();
    Lattice::new(axes, 0, [1, n, n * 20])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]
    /// A brick along the axes covers of each cell the product of what its edges cover, on equal cells and others, and where the
    /// sides of the box cut it.
    #[test]
    fn bricks_along_the_axes_are_exact(
        at in prop::array::uniform3(-0.3..2.3_f64), size in prop::array::uniform3(0.02..1.2_f64), equal: bool, faces: bool,
    ) {
        let lattice = bounded(equal, faces);
        let half = size.map(|s| 0.5 * s);
        let found = nodes(&lattice, brick(half.map(|h| -h), half), Pose::at(at));
        let mut covered = 0;
        let [nx, ny, nz] = lattice.shape();
        for n in 0..nx * ny * nz {
            let i = [n % nx, n / nx % ny, n / (nx * ny)];
            let share = |a: usize| {
                let [low, high] = [0, 1].map(|up| lattice.axes[a].edge(i[a] as isize + up));
                ((at[a] + half[a]).min(high) - (at[a] - half[a]).max(low)).max(0.0) / (high - low)
            };
            let exact = share(0) * share(1) * share(2);
            let node = found.iter().find(|node| node.index == i[0] + nx * (i[1] + 20 * i[2]));
            let fraction = node.map_or(0.0, |node| node.fraction);
            covered += usize::from(node.is_some());
            prop_assert!((fraction - exact).abs() < 2e-10, "{i:?}: {fraction} {exact}");
            if let Some(node) = node {
                let widths = lattice.widths(i.map(|i| i as isize));
                prop_assert!((node.volume - widths.iter().product::<f64>()).abs() < 1e-15);
                let place = lattice.position(i.map(|i| i as isize));
                prop_assert!((0..3).all(|a| (at[a] + node.arm[a] - place[a]).abs() < 1e-14));
            }
        }
        prop_assert_eq!(covered, found.len());
    }

    /// The volume, to round-off, in any pose, over periodic sides; cells that only one face cuts as the plane would.
    #[test]
    fn any_mesh_keeps_its_volume(
        at in prop::array::uniform3(0.0..3.0_f64), turn in prop::array::uniform3(-4.0..4.0_f64), fine: bool,
    ) {
        let orientation = Rotation::from_euler_angles(turn[0], turn[1], turn[2]);
        let pose = Pose { position: at.into(), orientation };
        let lattice = lattice(3, [0.1; 3], 3.0);
        let sphere = Faceted::sphere(0.5, if fine { 4 } else { 0 });
        let volume = sphere.volume();
        let sum = total(&nodes(&lattice, sphere, pose));
        prop_assert!((sum / volume - 1.0).abs() < 1e-8, "{sum} {volume}");

        let half = [0.5, 0.6, 0.7];
        let block = brick(half.map(|h| -h), half);
        let found = nodes(&lattice, block.clone(), pose);
        prop_assert!((total(&found) / block.volume() - 1.0).abs() < 1e-8);
        let mut cut = 0;
        for node in found {
            let body = orientation.inverse() * node.arm;
            let gaps = Vector::from_fn(|a, _| body[a].abs() - half[a]);
            let axis = gaps.imax();
            // No edge within the cell.
            if (0..3).any(|a| a != axis && gaps[a] > -0.1) {
                continue;
            }
            let mut normal = Vector::zeros();
            normal[axis] = body[axis].signum();
            let plane = plane_fraction(gaps[axis], orientation * normal, Vector::repeat(0.1));
            prop_assert!((node.fraction - plane).abs() < 1e-9, "{} {plane}", node.fraction);
            cut += usize::from(node.fraction < 1.0);
        }
        prop_assert!(cut > 300, "{cut}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20))]
    /// A turned brick that the sides of the box cut covers there what it covers in a wider box, on equal cells and others; one
    /// that is wholly outside covers nothing.
    #[test]
    fn sides_cut_off_what_is_beyond(at in prop::array::uniform3(-0.4..2.4_f64), turn in prop::array::uniform3(-4.0..4.0_f64), equal: bool) {
        let orientation = Rotation::from_euler_angles(turn[0], turn[1], turn[2]);
        let pose = Pose { position: at.into(), orientation };
        let box_of = |low: i32, high: i32| {
            let sides: Vec<f64> = (low..=high)
                .map(|i| 0.1 * f64::from(i))
                .map(|x| if equal { x } else { x + 0.02 * (5.0 * x).sin() })
                .collect();
            let n = sides.len() - 1;
            Lattice::new([(); 3].map(|()| Nodes::centres(&sides, false)), 0, [1, n, n * n])
        };
        let (inner, wide) = (box_of(0, 20), box_of(-10, 30));
        let block = || brick([-0.2, -0.3, -0.4], [0.2, 0.3, 0.4]);
        let found = nodes(&inner, block(), pose);
        let all = nodes(&wide, block(), pose);
        prop_assert!((total(&all) / block().volume() - 1.0).abs() < 1e-8);
        let mut inside = 0;
        for node in all {
            let [i, j, k] = wide.node(node.index).map(|i| i - 10);
            if let Some(index) = inner.index([i, j, k]) {
                let same = found.iter().find(|n| n.index == index);
                prop_assert!(same.is_some_and(|n| (n.fraction - node.fraction).abs() < 1e-9), "{i} {j} {k}");
                inside += 1;
            }
        }
        prop_assert_eq!(inside, found.len());
        let outside = Pose { position: [-1.0, 0.5, 0.5].into(), orientation };
        prop_assert!(nodes(&inner, block(), outside).is_empty());
    }
}

/// Turned vertices, cells and sums are reused: other bodies and lattices before change nothing.
#[test]
fn nothing_is_left_from_before() {
    let (coarse, fine) = (lattice(3, [0.1; 3], 3.0), lattice(3, [0.05; 3], 3.0));
    let mut fraction = SolidFraction::new();
    for (lattice, times, x) in [(&fine, 3, 0.3), (&coarse, 1, 0.3), (&coarse, 2, 0.7)] {
        let mesh = Faceted::sphere(0.4, times);
        let volume = mesh.volume();
        fraction.update(lattice, &Balls::of(mesh, volume, vec![Pose::at([x, 1.0, 2.9])])).unwrap();
        assert!((total(fraction.nodes(BodyId(0))) / volume - 1.0).abs() < 1e-8);
    }
}
