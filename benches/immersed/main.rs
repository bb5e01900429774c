//! Immersed walls against exact and published values: plane Poiseuille flow turned against the grid, Taylor–Couette flow,
//! simple-cubic arrays of spheres, the cylinder of Schäfer & Turek; and what walls cost. `cargo bench --bench immersed`, or with the names of cases
//! after `--`.
mod channel;
mod cost;
mod couette;
mod cylinder;
mod spheres;

use siltflow::flow::Projection;
use siltflow::interfaces::VelocityField;

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

fn main() -> Outcome<()> {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    type Case = (&'static str, fn() -> Outcome<()>);
    let cases: [Case; 5] = [
        ("channel", channel::table),
        ("couette", couette::table),
        ("spheres", spheres::table),
        ("cylinder", cylinder::table),
        ("cost", cost::table),
    ];
    for (name, table) in cases {
        if wanted.is_empty() || wanted.iter().any(|w| w == name) {
            table()?;
        }
    }
    Ok(())
}

/// Advances until nothing changes any more: the largest change of `value` over an interval, relative to its largest value.
fn settle<const D: usize>(
    flow: &mut Projection<D>,
    force: [f64; D],
    interval: f64,
    mut value: impl FnMut(&mut Projection<D>, f64) -> f64,
) -> Outcome<f64> {
    let mut last = f64::INFINITY;
    loop {
        let end = flow.time() + interval;
        let mut dt = 0.0;
        while flow.time() < end {
            dt = flow.stable_dt(0.4);
            flow.advance(dt, force)?;
        }
        let now = value(flow, dt);
        if (now - last).abs() < 1e-6 * now.abs() {
            return Ok(now);
        }
        last = now;
    }
}

/// Largest difference of a velocity component from the exact one at the nodes where that is not zero.
fn largest_error<const D: usize>(flow: &Projection<D>, exact: impl Fn([f64; D]) -> [f64; D]) -> f64 {
    let mut worst = 0.0_f64;
    for c in 0..D {
        let lattice = flow.velocity().lattice(c);
        let [nx, ny, nz] = lattice.shape();
        for at in (0..nx * ny * nz).map(|i| [i % nx, i / nx % ny, i / (nx * ny)].map(|i| i as isize)) {
            let x = lattice.position(at);
            let wanted = exact(std::array::from_fn(|a| x[a]))[c];
            if wanted != 0.0
                && let Some(index) = lattice.index(at)
            {
                worst = worst.max((flow.velocity().component(c)[index] - wanted).abs());
            }
        }
    }
    worst
}
