//! Times the direct Poisson solver on one thread: `cargo bench -p fv-mesh --bench poisson`.
use fv_mesh::poisson::AxisBounds::{self, Dirichlet, Neumann, Periodic};
use fv_mesh::poisson::DirectPoisson;
use std::time::Instant;

fn time<const D: usize>(cells: [usize; D], bounds: [AxisBounds; D]) {
    let n: usize = cells.iter().product();
    let rhs: Vec<f64> = (0..n).map(|c| (c as f64).sin()).collect();
    let mut phi = vec![0.0; n];
    let Ok(mut solver) = DirectPoisson::new(cells, [1.0; D], bounds) else { return };
    let mut best = f64::INFINITY;
    for _ in 0..(40_000_000 / n).clamp(5, 400) {
        let start = Instant::now();
        let fill = |r: usize, row: &mut [f64]| row.copy_from_slice(&rhs[r * cells[0]..(r + 1) * cells[0]]);
        if solver.solve_rows(fill, &mut phi).is_err() {
            return;
        }
        best = best.min(start.elapsed().as_secs_f64());
    }
    println!(
        "{:>14} {:<34} {:6.2} ns per cell",
        format!("{cells:?}"),
        format!("{bounds:?}"),
        best * 1e9 / n as f64
    );
}

fn main() {
    let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(1).build() else { return };
    pool.install(|| {
        for cells in [[64, 64], [150, 300], [256, 256], [512, 512], [1024, 1024], [251, 257]] {
            time(cells, [Periodic, Periodic]);
        }
        for bounds in [[Periodic, Neumann], [Neumann, Neumann], [Neumann, Periodic], [Dirichlet, Dirichlet]] {
            time([150, 300], bounds);
            time([256, 256], bounds);
        }
        for cells in [[64; 3], [128; 3]] {
            time(cells, [Periodic; 3]);
            time(cells, [Periodic, Periodic, Neumann]);
            time(cells, [Neumann; 3]);
        }
    });
}
