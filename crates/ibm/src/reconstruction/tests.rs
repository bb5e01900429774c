use super::*;
use crate::testing::{Balls, lattice};
use interfaces::Nodes;

const CENTRE: [f64; 2] = [1.1, 1.2];

/// Distance from the disc of radius ½.
fn distance(x: [f64; 3]) -> f64 {
    (x[0] - CENTRE[0]).hypot(x[1] - CENTRE[1]) - 0.5
}

/// A lattice of about `cells` per metre, stretched smoothly by up to ±30 % if asked.
fn plane(cells: f64, stretched: bool) -> Lattice {
    if !stretched {
        return lattice(2, [1.0 / cells; 3], 3.0);
    }
    let n = (3.0 * cells) as usize;
    let tau = std::f64::consts::TAU;
    let faces: Vec<f64> =
        (0..=n).map(|i| i as f64 / n as f64).map(|s| 3.0 * (s + 0.3 / tau * (tau * s).sin())).collect();
    let axis = || Nodes::centres(&faces, true);
    Lattice::new([axis(), axis()], 0, [1, n])
}

/// Root mean square error of the values in surface cells whose centres are outside, of a field f(d) given in
/// the fluid.
fn error(
    cells: f64,
    stretched: bool,
    profile: Profile,
    given: Given,
    f: impl Fn(f64) -> f64,
    known: f64,
) -> f64 {
    let lattice = plane(cells, stretched);
    let bodies = Balls::new(2, 0.5, vec![[CENTRE[0], CENTRE[1], 0.0]]);
    let mut fraction = SolidFraction::new();
    fraction.update(&lattice, &bodies).unwrap();
    let [nx, ny, _] = lattice.shape();
    let exact: Vec<f64> = (0..nx * ny).map(|n| f(distance(lattice.position(lattice.node(n))))).collect();
    let mut reconstruction = Reconstruction::new(profile, given);
    reconstruction.place(&lattice, nx * ny, &bodies, &fraction);
    assert_eq!(reconstruction.lowered(), 0);
    let mut field = exact.clone();
    // What bodies cover must not be used.
    fraction.nodes(BodyId(0)).iter().for_each(|n| field[n.index] = f64::NAN);
    reconstruction.apply(BodyId(0), &mut field, |_, _| known);
    let outside = || reconstruction.cells(BodyId(0)).iter().filter(|c| c.distance > 0.0);
    let sum: f64 = outside().map(|c| (field[c.node.index] - exact[c.node.index]).powi(2)).sum();
    (sum / outside().count() as f64).sqrt()
}

/// First order for the constant, second for the rest (that of the interpolation at P₁ and P₂), on
/// uniform and stretched lattices, with values and gradients given.
#[test]
fn orders_are_what_they_should_be() {
    let smooth = |d: f64| 2.0 + d + 0.8 * d * d + 0.5 * d * d * d;
    let log = |d: f64| d.max(-0.1).ln_1p();
    let logarithmic = Profile::Logarithmic { length: 1.0 };
    for stretched in [false, true] {
        let order = |profile, given, log_field: bool| {
            let errors = [20.0, 40.0, 80.0, 160.0].map(|cells| match (log_field, given) {
                (true, _) => error(cells, stretched, profile, given, log, 0.0),
                (_, Given::Value) => error(cells, stretched, profile, given, smooth, 2.0),
                (_, Given::Gradient) => error(cells, stretched, profile, given, smooth, 1.0),
            });
            (errors, (errors[0] / errors[3]).log2() / 3.0)
        };
        for (profile, given, log_field, least) in [
            (Profile::Constant, Given::Value, false, 0.9),
            (Profile::Linear, Given::Value, false, 1.8),
            (Profile::Quadratic, Given::Value, false, 1.8),
            (logarithmic, Given::Value, true, 1.8),
            (Profile::Constant, Given::Gradient, false, 0.9),
            (Profile::Linear, Given::Gradient, false, 1.8),
            (Profile::Quadratic, Given::Gradient, false, 1.8),
        ] {
            let (errors, found) = order(profile, given, log_field);
            println!("{profile:?} {given:?} stretched {stretched}: {errors:?}, order {found:.2}");
            assert!(found > least, "{profile:?} {given:?} stretched {stretched}: {errors:?}, order {found}");
        }
        // A field of its own kind is met better than by the next lower profile.
        let quadratic = order(Profile::Quadratic, Given::Value, false).0[0];
        assert!(quadratic < 0.5 * order(Profile::Linear, Given::Value, false).0[0]);
        assert!(
            order(logarithmic, Given::Value, true).0[0]
                < 0.5 * order(Profile::Linear, Given::Value, true).0[0]
        );
    }
}

/// Between near bodies and at walls there is no room for P₁ and P₂: the order is lowered and counted,
/// and what cannot be known stays.
#[test]
fn neighbours_and_walls_lower_the_order() {
    let bodies = Balls::new(2, 0.5, vec![[1.0, 1.2, 0.0], [2.05, 1.2, 0.0]]);
    let walled = |length: f64| {
        let axis = || Nodes::uniform(0.025, 0.05, (length / 0.05) as usize, false);
        Lattice::new([axis(), axis()], 0, [1, (length / 0.05) as usize])
    };
    let alone = Balls::new(2, 0.5, vec![[1.0, 0.54, 0.0]]);
    for (lattice, bodies) in [(lattice(2, [0.05; 3], 3.0), bodies), (walled(3.0), alone)] {
        let mut fraction = SolidFraction::new();
        fraction.update(&lattice, &bodies).unwrap();
        for given in [Given::Value, Given::Gradient] {
            let mut reconstruction = Reconstruction::new(Profile::Quadratic, given);
            reconstruction.place(&lattice, 3600, &bodies, &fraction);
            assert!(reconstruction.lowered() > 0);
            let mut field = vec![1.0; 3600];
            reconstruction.apply(BodyId(0), &mut field, |_, _| if given == Given::Value { 1.0 } else { 0.0 });
            // A uniform field is kept by every order.
            assert!(field.iter().all(|u| (u - 1.0).abs() < 1e-12));
        }
    }
}

/// Only a body that moved and its neighbours, before and after, are worked on.
#[test]
fn bodies_far_from_movers_keep_their_cells() {
    let lattice = lattice(2, [0.025; 3], 3.0);
    let mut bodies = Balls::new(2, 0.2, vec![[0.5, 0.5, 0.0], [0.95, 0.5, 0.0], [1.7, 1.9, 0.0]]);
    let mut fraction = SolidFraction::new();
    let mut reconstruction = Reconstruction::new(Profile::Quadratic, Given::Value);
    fraction.update(&lattice, &bodies).unwrap();
    reconstruction.place(&lattice, 14_400, &bodies, &fraction);
    let lowered = reconstruction.lowered();
    assert!(lowered > 0);
    let distances = |r: &Reconstruction, b| r.cells(BodyId(b)).iter().map(|c| c.points).collect::<Vec<_>>();
    let before = [0, 2].map(|b| distances(&reconstruction, b));
    // At rest: nothing is counted again.
    fraction.update(&lattice, &bodies).unwrap();
    reconstruction.place(&lattice, 14_400, &bodies, &fraction);
    assert_eq!(reconstruction.lowered(), lowered);
    // The second leaves the first: both are placed anew, the third is not.
    bodies.shift(1, Vector::new(1.2, 0.0, 0.0));
    fraction.update(&lattice, &bodies).unwrap();
    reconstruction.place(&lattice, 14_400, &bodies, &fraction);
    assert_eq!(reconstruction.lowered(), lowered);
    assert!(distances(&reconstruction, 0).iter().flatten().all(Option::is_some));
    assert_ne!(distances(&reconstruction, 0), before[0]);
    assert_eq!(distances(&reconstruction, 2), before[1]);
}

/// A body that is taken away no longer stands in its neighbour's way.
#[test]
fn bodies_that_are_gone_are_forgotten() {
    let lattice = lattice(2, [0.025; 3], 3.0);
    let mut fraction = SolidFraction::new();
    let mut reconstruction = Reconstruction::new(Profile::Quadratic, Given::Value);
    let lowered: Vec<usize> = [vec![[0.5, 0.5, 0.0], [0.95, 0.5, 0.0]], vec![[0.5, 0.5, 0.0]]]
        .into_iter()
        .map(|centres| {
            let bodies = Balls::new(2, 0.2, centres);
            fraction.update(&lattice, &bodies).unwrap();
            reconstruction.place(&lattice, 14_400, &bodies, &fraction);
            reconstruction.cells(BodyId(0)).iter().filter(|c| c.points[1].is_none()).count()
        })
        .collect();
    assert!(lowered[0] > 0 && lowered[1] == 0, "{lowered:?}");
}
