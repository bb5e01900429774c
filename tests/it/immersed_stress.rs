//! Shapes that are hard on a grid, by all ways to immerse them: a flow that stays finite and bounded, or an error with a name.
//! (Surfaces that are not closed: crates/ibm/src/mesh/tests.rs.)
use siltflow::dem::Disc;
use siltflow::flow::{CartesianGrid, Fluid, Profile, Projection, Side};
use siltflow::ibm::{Forcing, Hfdib, SmoothForcing};
use siltflow::interfaces::{Aabb, Bodies, Kinematics, Point, Solid, Vector, VelocityField};
use validation::Outcome;
use validation::prescribed_bodies::{PrescribedBodies, forced_step};
use validation::walled_flows::put_walls;

/// A closed polygon, its corners counter-clockwise.
#[derive(Clone)]
struct Polygon(Vec<[f64; 2]>);

impl Solid for Polygon {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        let x = Vector::new(x.x, x.y, 0.0);
        let corner = |i: usize| {
            let [a, b] = self.0[i % self.0.len()];
            Vector::new(a, b, 0.0)
        };
        let (mut least, mut inside) = (f64::INFINITY, false);
        for i in 0..self.0.len() {
            let (a, b) = (corner(i), corner(i + 1));
            let (edge, from) = (b - a, x - a);
            let along = (from.dot(&edge) / edge.norm_squared()).clamp(0.0, 1.0);
            least = least.min((from - edge * along).norm());
            if (a.y > x.y) != (b.y > x.y) && from.x < edge.x * from.y / edge.y {
                inside = !inside;
            }
        }
        if inside { -least } else { least }
    }
    fn aabb(&self) -> Aabb {
        let range = |a: usize| {
            let values = self.0.iter().map(|p| p[a]);
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)])
        };
        let [x, y] = [range(0), range(1)];
        Aabb { min: Point::new(x[0], y[0], 0.0), max: Point::new(x[1], y[1], 0.0) }
    }
}

const H: f64 = 0.05;

/// A channel of 40 × 30 cells with the bodies in it, sixty steps at Re 20 over its height.
fn run(way: &str, bodies: &PrescribedBodies) -> Outcome<Projection<2>> {
    let grid = CartesianGrid::new([40, 30], [40.0 * H, 30.0 * H]).unwrap();
    let inlet = Side::Inlet(Profile::Parabolic { peak: 1.0 });
    let sides = [[inlet, Side::PressureOutlet(0.0)], Side::WALL.both()];
    let mut flow = Projection::new(grid, sides, Fluid { density: 1.0, viscosity: 0.05 }).unwrap();
    let mut forcing: Option<Box<dyn Forcing>> = match way {
        "cut links" => {
            put_walls(&mut flow, bodies)?;
            None
        }
        "smooth" => Some(Box::new(SmoothForcing::new(1.0))),
        _ => Some(Box::new(Hfdib::new(1.0))),
    };
    for _ in 0..60 {
        let dt = flow.stable_dt(0.25).min(0.01);
        match &mut forcing {
            None => flow.advance(dt, [0.0; 2])?,
            Some(forcing) => forced_step(&mut flow, &mut **forcing, bodies, dt)?,
        }
    }
    Ok(flow)
}

/// What is expected of cut links, `SmoothForcing` and `Hfdib`: does the flow run, or what does the error say?
fn expect(name: &str, bodies: &PrescribedBodies, expected: [Option<&str>; 3]) {
    for (way, expected) in ["cut links", "smooth", "hfdib"].into_iter().zip(expected) {
        match (run(way, bodies), expected) {
            (Ok(flow), None) => {
                let (mut fastest, mut inside) = (0.0_f64, 0.0_f64);
                // Markers stand half a cell inside and see two more; only they hold the fluid inside.
                let depth = if way == "smooth" { 2.5 * H } else { 0.3 * H };
                for c in 0..2 {
                    let (lattice, u) = (flow.velocity().lattice(c), flow.velocity().component(c));
                    let [nx, ny, _] = lattice.shape();
                    for node in (0..nx * ny).map(|i| [(i % nx) as isize, (i / nx) as isize, 0]) {
                        let Some(index) = lattice.index(node) else { continue };
                        assert!(u[index].is_finite(), "{name}, {way}");
                        fastest = fastest.max(u[index].abs());
                        let x = Point::from(lattice.position(node));
                        let solid =
                            |b| bodies.solid(b).signed_distance(bodies.pose(b).to_body(x), H) <= -depth;
                        if bodies.ids().any(solid) {
                            inside = inside.max(u[index].abs());
                        }
                    }
                }
                // The bodies stand, whatever rushes by.
                assert!(inside < 0.2 * fastest, "{name}, {way}: {inside} of {fastest}");
                // What comes in passes: at about the inlet's speed, at most through a gap of a sixth of the channel.
                assert!((0.9..6.0).contains(&fastest), "{name}, {way}: {fastest}");
                assert!(flow.pressure().values().all(f64::is_finite), "{name}, {way}");
            }
            (Err(error), Some(text)) => assert!(error.to_string().contains(text), "{name}, {way}: {error}"),
            (Ok(_), Some(text)) => panic!("{name}, {way}: no error, but {text:?} was expected"),
            (Err(error), None) => panic!("{name}, {way}: {error}"),
        }
    }
}

fn body(solid: impl Solid + 'static) -> PrescribedBodies {
    PrescribedBodies::default().with(solid, [0.83, 0.76, 0.0], 0.0)
}

#[test]
fn a_plate_one_cell_thick() {
    let plate = Polygon(vec![[-0.4, -0.5 * H], [0.4, -0.5 * H], [0.4, 0.5 * H], [-0.4, 0.5 * H]]);
    let thin = Some("at least 4 are needed");
    expect("along", &body(plate.clone()), [None, thin, None]);
    expect("turned", &body(plate).turned(0.6), [None, thin, None]);
}

#[test]
fn a_sharp_trailing_edge() {
    let wedge = Polygon(vec![[-0.3, -0.12], [0.5, 0.0], [-0.3, 0.12]]);
    expect("wedge", &body(wedge.clone()), [None; 3]);
    expect("turned wedge", &body(wedge).turned(-0.4), [None; 3]);
}

/// The block reaches beyond the lower side.
#[test]
fn a_body_over_half_the_box() {
    let block = Polygon(vec![[-0.63, -1.5], [0.97, -1.5], [0.97, 0.12], [-0.63, 0.17]]);
    expect("block", &body(block), [None; 3]);
}

#[test]
fn two_bodies_half_a_cell_apart() {
    for gap in [0.5, 0.1] {
        let disc = || Disc::new(0.2).unwrap();
        let apart: f64 = 0.4 + gap * H;
        let bodies = PrescribedBodies::default().with(disc(), [0.83, 0.5, 0.0], 0.0);
        let bodies = bodies.with(disc(), [0.93, 0.5 + (apart * apart - 0.01).sqrt(), 0.0], 0.0);
        expect("pair", &bodies, [None; 3]);
    }
}

/// Neither forcing nor links can show it: all but the paper's forcing, whose λ is just small, say so.
#[test]
fn a_body_smaller_than_a_cell() {
    let speck = body(Disc::new(0.2 * H).unwrap());
    expect(
        "speck",
        &speck,
        [Some("no node of some velocity component"), Some("at least 4 are needed"), None],
    );
}
