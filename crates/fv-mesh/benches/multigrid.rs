//! Times multigrid on one thread, in processor time:
//! `cargo bench -p siltflow-fv-mesh --bench multigrid`.
use cpu_time::ThreadTime;
use fv_mesh::poisson::AxisBounds::{self, Dirichlet, Neumann};
use fv_mesh::poisson::PoissonAxis;
use fv_mesh::poisson::multigrid::{MultigridCg, MultigridParams};
use fv_mesh::{Axis, Cluster};

fn axis(name: &str, n: usize, ends: AxisBounds) -> PoissonAxis {
    let axis = match name {
        "uniform" => Axis::uniform(n, 0.0, 1.0),
        "tanh 2" => Axis::tanh(n, 0.0, 1.0, 2.0, Cluster::Both),
        _ => Axis::geometric(n, 0.0, 1.0, 1.05),
    };
    let widths = axis.map(|a| (0..n).map(|i| a.width(i)).collect()).unwrap_or_default();
    PoissonAxis { widths, ends }
}

fn time<const D: usize>(name: &str, n: usize, ends: AxisBounds, variable: bool) {
    let cells = n.pow(D as u32);
    let mut state = 1_u64;
    let rhs: Vec<f64> = (0..cells)
        .map(|_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        })
        .collect();
    let axes: [PoissonAxis; D] = std::array::from_fn(|_| axis(name, n, ends));
    let mut solver = match MultigridCg::new(axes, 0.0, MultigridParams { variable, ..Default::default() }) {
        Ok(solver) => solver,
        Err(error) => return println!("{error}"),
    };
    if variable {
        let start = ThreadTime::now();
        if let Err(error) = solver.multigrid().set_coefficients([None; D]) {
            return println!("{error}");
        }
        println!(
            "{n}^{D} set_coefficients: {:.1} ns per cell",
            start.elapsed().as_secs_f64() * 1e9 / cells as f64
        );
    }
    let (mut phi, mut best, mut info) = (vec![0.0; cells], f64::INFINITY, None);
    for _ in 0..(3_000_000 / cells).clamp(2, 20) {
        let start = ThreadTime::now();
        let fill = |r: usize, row: &mut [f64]| row.copy_from_slice(&rhs[r * n..(r + 1) * n]);
        match solver.solve_rows(fill, &mut phi, false) {
            Ok(told) => info = Some(told),
            Err(error) => return println!("{n}^{D} {name}: {error}"),
        }
        best = best.min(start.elapsed().as_secs_f64());
    }
    let (iterations, text) = (info.map_or(0, |i| i.iterations), solver.describe());
    let levels = text.split(" levels").next().and_then(|t| t.rsplit(' ').next()).unwrap_or("");
    println!(
        "{:>6} {name:<8} {:<10} {levels:>3} levels {iterations:>3} iterations {:7.1} ns per cell",
        format!("{n}^{D}"),
        format!("{ends:?}"),
        best * 1e9 / cells as f64
    );
}

fn main() {
    let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(1).build() else { return };
    pool.install(|| {
        println!("With fields of coefficients:");
        time::<2>("tanh 2", 256, Neumann, true);
        time::<3>("tanh 2", 64, Neumann, true);
        println!("Without:");
        for ends in [Neumann, Dirichlet] {
            for name in ["uniform", "tanh 2", "geometric"] {
                // A ratio of 1.05 leaves no precision in 512 cells.
                for n in [64, 128, 256, 512].into_iter().filter(|&n| name != "geometric" || n < 256) {
                    time::<2>(name, n, ends, false);
                }
                for n in [32, 64, 128] {
                    time::<3>(name, n, ends, false);
                }
            }
        }
    });
}
