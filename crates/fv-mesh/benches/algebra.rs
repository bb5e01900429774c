//! Time of expressions against loops written by hand, on one thread: `cargo bench -p siltflow-fv-mesh --bench algebra`.
use fv_mesh::{CartesianGrid, Field, Integrals};
use pulp::{Arch, Simd, WithSimd};
use std::hint::black_box;
use std::time::Instant;

/// a = 2 b + c over the rows of three equal fields, compiled for the processor at hand.
struct Loop<'a> {
    cells: [usize; 3],
    a: &'a mut [f64],
    b: &'a [f64],
    c: &'a [f64],
}

impl WithSimd for Loop<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { cells: [nx, ny, nz], a, b, c } = self;
        // Two ghost layers.
        let (row, layer) = (nx + 4, (nx + 4) * (ny + 4));
        for (k, j) in (0..nz).flat_map(|k| (0..ny).map(move |j| (k, j))) {
            let start = (k + 2) * layer + (j + 2) * row + 2;
            let (a, b, c) = (&mut a[start..][..nx], &b[start..][..nx], &c[start..][..nx]);
            for i in 0..nx {
                a[i] = 2.0 * b[i] + c[i];
            }
        }
    }
}

/// Least time of a run \[s\].
fn time(runs: usize, mut f: impl FnMut()) -> f64 {
    let mut least = f64::INFINITY;
    for _ in 0..runs {
        let start = Instant::now();
        f();
        least = least.min(start.elapsed().as_secs_f64());
    }
    least
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    for (n, runs) in [(16, 20_000), (32, 5_000), (64, 600), (160, 40)] {
        let cells = [n, n, n];
        let grid = CartesianGrid::new(cells, [1.0; 3])?;
        let (b, c) = (Field::from_fn(&grid, |x| x[0]), Field::from_fn(&grid, |x| x[1] * x[2]));
        let mut a = Field::zeros(&grid);
        let by_hand = time(runs, || {
            let (a, b, c) = (black_box(&mut a), black_box(&b), black_box(&c));
            Arch::new().dispatch(Loop { cells, a: a.data_mut(), b: b.data(), c: c.data() });
        });
        let over = Integrals::new(&grid);
        let (assigned, norms) = pool.install(|| {
            let assigned = time(runs, || {
                let (a, b, c) = (black_box(&mut a), black_box(&b), black_box(&c));
                a.assign(2.0 * b + c).expect("one grid");
            });
            let norms = time(runs, || {
                black_box(over.norms(black_box(&b) - black_box(&c)).expect("one grid"));
            });
            (assigned, norms)
        });
        let per_cell = 1e9 / grid.n_cells() as f64;
        println!(
            "{n:4}³ cells: by hand {:6.3} ns/cell, a.assign(2.0 * &b + &c) {:6.3} ns/cell ({:.2}×), norms(&b - &c) {:6.3} ns/cell",
            by_hand * per_cell,
            assigned * per_cell,
            assigned / by_hand,
            norms * per_cell
        );
    }
    Ok(())
}
