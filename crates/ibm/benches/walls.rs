//! What wall distances and wall rows cost, in ns of CPU time. Sample run: `cargo bench -p siltflow-ibm --bench walls` (a minute or so);
//! `-- 50` repeats more often, `-- distances` or `-- rows` takes only those.
//!
//! 1. Distances of all cells from 1 to 512 spheres and a cube on 128³ cells: from scratch, after all bodies moved, after one
//!    moved, at rest.
//! 2. Rows around a sphere and 512 of them: placed, filled, at rest.
#[path = "support/brick.rs"]
mod brick;
mod support;

use brick::Brick;
use cpu_time::ProcessTime;
use ibm::{WallDistance, WallRows};
use interfaces::{Lattice, Nodes, Pose, Rotation, Solid, Vector};
use support::{Ball, Equal};

/// Of diameter 1.
const SPHERE: Ball = Ball { radius: 0.5, dim: 3 };

/// A periodic cube of `n` cells per edge, `length` wide.
fn lattice(n: usize, length: f64) -> Lattice {
    let h = length / n as f64;
    let axis = || Nodes::uniform(0.5 * h, h, n, true);
    Lattice::new([axis(), axis(), axis()], 0, [1, n, n * n])
}

/// `edge`³ bodies, 1.25 apart.
fn crowd(solid: Box<dyn Solid>, edge: usize) -> Equal {
    let centres = (0..edge * edge * edge).map(|i| [i % edge, i / edge % edge, i / (edge * edge)]);
    Equal { solid, poses: centres.map(|c| Pose::at(c.map(|i| 1.25 * i as f64 + 0.6))).collect() }
}

/// Moves the first `n` bodies a little.
fn shift(bodies: &mut Equal, n: usize, step: usize) {
    for (b, pose) in bodies.poses.iter_mut().take(n).enumerate() {
        pose.position += Vector::new(0.011, -0.013, 0.007) * (b as f64 + step as f64).sin();
        pose.orientation = Rotation::from_euler_angles(0.3 * step as f64, 0.1, 0.2);
    }
}

/// The least CPU time of several \[ns\].
fn best(repeat: usize, mut work: impl FnMut(usize) -> std::time::Duration) -> f64 {
    (0..repeat).map(|step| work(step).as_secs_f64() * 1e9).fold(f64::INFINITY, f64::min)
}

fn timed(work: impl FnOnce()) -> std::time::Duration {
    let start = ProcessTime::now();
    work();
    start.elapsed()
}

fn distances(name: &str, mut bodies: Equal, n: usize, repeat: usize) {
    let edge = (bodies.poses.len() as f64).cbrt();
    let lattice = lattice(n, (1.25 * edge).max(2.5));
    let cells = (n * n * n) as f64;
    let place = |distance: &mut WallDistance, bodies: &Equal| {
        distance.update(&lattice, bodies).expect("bodies on a grid");
    };
    let fresh = best(repeat, |_| timed(|| place(&mut WallDistance::new(), &bodies)));
    let mut distance = WallDistance::new();
    place(&mut distance, &bodies);
    let count = bodies.poses.len();
    let mut after = |moved: usize| {
        let before = distance.updates();
        let time = best(repeat, |step| {
            shift(&mut bodies, moved, step);
            timed(|| place(&mut distance, &bodies))
        });
        (time / cells, (distance.updates() - before) as f64 / repeat as f64 / cells)
    };
    let ((all, _), (one, share), (rest, _)) = (after(count), after(1), after(0));
    println!(
        "{name:<26} {count:>4} bodies: {:>6.1} ns/cell at first, {all:>6.1} when all moved, {one:>6.2} when one moved \
         ({:>4.1} % of the cells), {:.0} ns at rest",
        fresh / cells,
        100.0 * share,
        rest * cells
    );
}

fn rows(edge: usize, cells_per_diameter: usize, repeat: usize) {
    let mut bodies = crowd(Box::new(SPHERE), edge);
    let length = (1.25 * edge as f64).max(2.5);
    let n = (length * cells_per_diameter as f64).round() as usize;
    let lattice = lattice(n, length);
    let mut rows = WallRows::new();
    rows.place(&lattice, &bodies).expect("bodies on a grid");
    let number = rows.rows().len() as f64;
    let count = bodies.poses.len();
    let moved = best(repeat, |step| {
        shift(&mut bodies, count, step);
        timed(|| rows.place(&lattice, &bodies).expect("bodies on a grid"))
    });
    let rest = best(repeat, |_| timed(|| rows.place(&lattice, &bodies).expect("bodies on a grid")));
    let u: Vec<f64> = (0..n * n * n).map(|i| i as f64).collect();
    let fill = best(repeat, |_| {
        timed(|| {
            let still = |_: &ibm::WallCell| Vector::zeros();
            rows.fill(&[&u, &u, &u], Some(&u), 1e-6, still).expect("fields of the grid");
        })
    });
    println!(
        "{count:>4} spheres of {cells_per_diameter} cells: {:>6} rows, {} lowered; place {:>6.0} ns/row, fill {:>5.0} ns/row, \
         at rest {:.0} ns",
        rows.rows().len(),
        rows.lowered(),
        moved / number,
        fill / number,
        rest
    );
}

fn main() {
    let arguments = || std::env::args().skip(1).filter(|a| !a.starts_with('-'));
    let repeat = arguments().find_map(|a| a.parse().ok()).unwrap_or(5);
    let only = arguments().find(|a| a.parse::<usize>().is_err());
    let wants = |part: &str| only.as_ref().is_none_or(|only| only == part);
    if wants("distances") {
        for edge in [1, 2, 4, 8] {
            distances("spheres", crowd(Box::new(SPHERE), edge), 128, repeat);
        }
        distances("cube", crowd(Box::new(Brick(Vector::repeat(0.5))), 1), 128, repeat);
    }
    if wants("rows") {
        for (edge, cells) in [(1, 10), (1, 20), (1, 40), (8, 10)] {
            rows(edge, cells, repeat);
        }
    }
}
