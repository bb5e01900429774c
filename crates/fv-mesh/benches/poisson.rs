//! Times the direct Poisson solvers on one thread:
//! `cargo bench -p siltflow-fv-mesh --bench poisson`.
use fv_mesh::poisson::AxisBounds::{self, Dirichlet, Neumann, NeumannDirichlet, Periodic};
use fv_mesh::poisson::{DirectPoisson, PoissonAxis, PoissonError, PoissonInfo, SeparablePoisson};
use std::time::Instant;

/// Prints the best time of many solves.
fn time(what: &str, n: usize, mut solve: impl FnMut(&mut [f64]) -> Result<PoissonInfo, PoissonError>) {
    let mut phi = vec![0.0; n];
    let mut best = f64::INFINITY;
    for _ in 0..(20_000_000 / n).clamp(5, 400) {
        let start = Instant::now();
        if solve(&mut phi).is_err() {
            return;
        }
        best = best.min(start.elapsed().as_secs_f64());
    }
    println!("{what:<60} {:6.2} ns per cell", best * 1e9 / n as f64);
}

/// Rows of a right-hand side.
fn rows(n: usize, nx: usize) -> impl Fn(usize, &mut [f64]) + Sync {
    let rhs: Vec<f64> = (0..n).map(|c| (c as f64).sin()).collect();
    move |r, row| row.copy_from_slice(&rhs[r * nx..(r + 1) * nx])
}

fn direct<const D: usize>(cells: [usize; D], bounds: [AxisBounds; D]) {
    let n = cells.iter().product();
    let Ok(mut solver) = DirectPoisson::new(cells, [1.0; D], bounds) else { return };
    let fill = rows(n, cells[0]);
    time(&format!("{:>15} {bounds:?}", format!("{cells:?}")), n, |phi| solver.solve_rows(&fill, phi));
}

/// Axes that are stretched where `stretched` says.
fn separable<const D: usize>(cells: [usize; D], bounds: [AxisBounds; D], stretched: [bool; D]) {
    let n = cells.iter().product();
    let axes: [_; D] = std::array::from_fn(|a| match stretched[a] {
        true => {
            let width = |i: usize| 1.0 + 0.5 * (6.0 * i as f64 / cells[a] as f64).sin();
            PoissonAxis { widths: (0..cells[a]).map(width).collect(), ends: bounds[a] }
        }
        false => PoissonAxis::uniform(cells[a], 1.0, bounds[a]),
    });
    let start = Instant::now();
    let Ok(mut solver) = SeparablePoisson::new(axes) else { return };
    let made = start.elapsed().as_secs_f64();
    let letters: String = "xyz".chars().zip(stretched).map(|(a, s)| if s { a } else { '-' }).collect();
    let fill = rows(n, cells[0]);
    let what = format!("{:>15} {bounds:?} stretched {letters}, made in {made:.2} s", format!("{cells:?}"));
    time(&what, n, |phi| solver.solve_rows(&fill, phi));
}

fn main() {
    let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(1).build() else { return };
    pool.install(|| {
        for cells in [[64, 64], [150, 300], [256, 256], [512, 512], [1024, 1024], [251, 257]] {
            direct(cells, [Periodic, Periodic]);
        }
        for bounds in [[Periodic, Neumann], [Neumann, Neumann], [Neumann, Periodic], [Dirichlet, Dirichlet]] {
            direct([150, 300], bounds);
            direct([256, 256], bounds);
        }
        for cells in [[64; 3], [128; 3]] {
            direct(cells, [Periodic; 3]);
            direct(cells, [Periodic, Periodic, Neumann]);
            direct(cells, [Neumann; 3]);
        }
        for cells in [[64, 64], [256, 256], [1024, 1024]] {
            for stretched in [[false, true], [true, false], [true, true]] {
                separable(cells, [Neumann, Neumann], stretched);
            }
        }
        separable([256, 256], [Neumann, Periodic], [true, true]);
        separable([256, 256], [NeumannDirichlet, Periodic], [false, false]);
        for stretched in [[false, false, true], [false, true, false], [true, false, false]] {
            separable([128; 3], [Periodic, Periodic, Neumann], stretched);
        }
        separable([128; 3], [Neumann; 3], [true, true, false]);
        separable([128; 3], [Neumann; 3], [true, true, true]);
    });
}
