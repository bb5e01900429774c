//! What a prediction costs: CPU microseconds a field, the best of several rounds. `cargo bench -p siltflow-mor --bench prediction`.
//!
//! 150 × 300 cells: λ of two discs in frames that move both ways (1 and 3 modes each), a velocity of 20 modes; alone and nine times together, in double and
//! single precision.
use cpu_time::ProcessTime;
use interfaces::Vector;
use mor::models::{Podiann, Spodiann, SpodiannParams};
use mor::pod::{Pod, PodParams};
use mor::shifted::fourier::Als;
use mor::shifted::{Grid, Interpolation, Motion, Motions};
use mor::{Mat, MatRef};

const CELLS: [usize; 2] = [150, 300];
const SNAPSHOTS: usize = 60;
const TOGETHER: usize = 9;

fn time(j: f64) -> f64 {
    j / (SNAPSHOTS - 1) as f64
}

fn way(k: usize, t: f64) -> Vector {
    Vector::new([6.3, -4.1][k] * t * t, [-101.7, -60.2][k] * t, 0.0)
}

fn discs(ranks: [usize; 2]) -> Spodiann {
    let grid = Grid::new(CELLS, [1.0; 2]).expect("a grid");
    let [nx, ny] = CELLS.map(|n| n as f64);
    let value = |i: usize, j: usize| {
        let disc = |k: usize| {
            let r =
                grid.centre(i).coords - way(k, time(j as f64)) - Vector::new([40.0, 100.0][k], 250.0, 0.0);
            let r = (r.x - nx * (r.x / nx).round()).hypot(r.y - ny * (r.y / ny).round());
            0.5 - 0.5 * (r - 7.5).tanh()
        };
        disc(0) + disc(1)
    };
    let motions = Motions::by(2, SNAPSHOTS, |k, j| Motion::translation(way(k, time(j as f64))));
    let snapshots = Mat::from_fn(grid.n_cells(), SNAPSHOTS, value);
    let als = Als { max_steps: 20, ..Als::new(ranks) };
    let modes = als.solve(&grid, &motions, snapshots.as_ref(), None, None, &mut |_| true).expect("modes");
    let points = Mat::from_fn(1, SNAPSHOTS, |_, j| time(j as f64));
    let how = (grid, Interpolation::Spectral);
    Spodiann::new(points.as_ref(), &modes, how, &motions, SpodiannParams::default()).expect("a model")
}

fn velocity() -> Podiann {
    let value = |i: usize, j: usize| {
        let (x, t) = (i as f64 / 9e4, time(j as f64));
        (1..=20).map(|k| (f64::from(k) * (40.0 * x + t)).sin() / f64::from(k * k)).sum()
    };
    let snapshots = Mat::from_fn(2 * CELLS[0] * CELLS[1], SNAPSHOTS, value);
    let pod = Pod::new(snapshots.as_ref(), &PodParams::of_rank(20)).expect("modes");
    let points = Mat::from_fn(1, SNAPSHOTS, |_, j| time(j as f64));
    Podiann::new(points.as_ref(), &pod, None).expect("a model")
}

/// Prints what one field costs, alone and together with others.
fn measure<E: std::fmt::Debug>(
    name: &str,
    rows: usize,
    predict: impl Fn(MatRef<'_, f64>, &mut [f64]) -> Result<(), E>,
) {
    const ROUNDS: usize = 15;
    const TIMES: usize = 20;
    let mut costs = [f64::INFINITY; 2];
    for (cost, count) in costs.iter_mut().zip([1, TOGETHER]) {
        let mut fields = vec![0.0; rows * count];
        for round in 0..ROUNDS {
            let watch = ProcessTime::now();
            for i in 0..TIMES {
                let at = (round * TIMES + i) as f64 / (ROUNDS * TIMES + TOGETHER) as f64;
                let points = Mat::from_fn(1, count, |_, j| at + 0.002 * j as f64);
                predict(points.as_ref(), &mut fields).expect("predicts");
            }
            *cost = cost.min(1e6 * watch.elapsed().as_secs_f64() / (TIMES * count) as f64);
        }
    }
    println!("{name:44} {:8.1} {:8.1}", costs[0], costs[1]);
}

fn main() {
    println!("{:44} {:>8} {:>8}", "CPU µs a field", "alone", "of nine");
    for ranks in [[1, 1], [3, 3]] {
        let model = discs(ranks);
        measure(&format!("λ, sPODIANN {ranks:?}"), model.rows(), |x, out| model.predict_many(x, out));
    }
    let model = velocity();
    measure("velocity, PODIANN 20", model.rows(), |x, out| model.predict_many(x, out));
    let model = model.in_single_precision();
    measure("velocity, PODIANN 20, single precision", model.rows(), |x, out| model.predict_many(x, out));
}
