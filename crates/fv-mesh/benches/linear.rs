//! Times the linear solvers on one thread: `cargo bench -p siltflow-fv-mesh --bench linear`.
use fv_mesh::linear::{
    BiCgStabParams, BiCgStabScratch, CgParams, CgScratch, Dilu, DirectParams, GaussSeidelSweep, Ilu0,
    LinearError, LinearOperator, Preconditioner, RedBlack, SparseCholesky, SparseLu, StencilMatrix, Sweep,
    bicgstab, conjugate_gradient,
};
use std::time::Instant;

/// Best time of a call \[s\].
fn best(repeats: usize, mut f: impl FnMut() -> Result<(), LinearError>) -> Result<f64, LinearError> {
    let mut best = f64::INFINITY;
    for _ in 0..repeats {
        let start = Instant::now();
        f()?;
        best = best.min(start.elapsed().as_secs_f64());
    }
    Ok(best)
}

/// A call that cannot fail.
fn done(mut f: impl FnMut()) -> impl FnMut() -> Result<(), LinearError> {
    move || {
        f();
        Ok(())
    }
}

/// Running out of iterations is what is timed.
fn exhausted<T>(result: Result<T, LinearError>) -> Result<(), LinearError> {
    match result {
        Ok(_) | Err(LinearError::NotConverged { .. }) => Ok(()),
        Err(e) => Err(e),
    }
}

/// Upwind convection across the axes, diffusion and φ = 0 on the sides that do not wrap.
fn system<const D: usize>(
    cells: [usize; D],
    periodic: [bool; D],
    flow: f64,
) -> Result<StencilMatrix<D>, LinearError> {
    let mut a = StencilMatrix::new(cells, periodic)?;
    let (centre, lower, upper) = a.parts_mut();
    for axis in 0..D {
        lower[axis].fill(-1.0 - flow);
        upper[axis].fill(-1.0);
    }
    centre.fill((2.0 + flow) * D as f64 + 1e-3);
    Ok(a)
}

fn time<const D: usize>(cells: [usize; D], periodic: [bool; D]) -> Result<(), LinearError> {
    let a = system(cells, periodic, 2.0)?;
    let csr = a.to_matrix()?;
    let n = a.n();
    let b: Vec<f64> = (0..n).map(|c| (c as f64).sin()).collect();
    let (mut x, mut y) = (vec![0.0; n], vec![0.0; n]);
    let repeats = (4_000_000 / n).clamp(3, 60);
    let tell = |what: &str, seconds: f64, count: f64| {
        println!(
            "{:>14} {what:<34} {:8.2} ns per cell",
            format!("{cells:?}"),
            seconds * 1e9 / n as f64 / count
        );
    };

    tell("product, stencil", best(repeats, done(|| a.apply(&b, &mut y)))?, 1.0);
    tell("product, rows", best(repeats, done(|| csr.apply(&b, &mut y)))?, 1.0);
    let forward = best(repeats, done(|| a.sweep(Sweep::Forward, &b, &mut x, &mut y)))?;
    tell("Gauss-Seidel sweep, stencil", forward, 1.0);
    let backward = best(repeats, done(|| a.sweep(Sweep::Backward, &b, &mut x, &mut y)))?;
    tell("the same backward", backward, 1.0);
    let red_black = RedBlack::new(&a);
    let sweep = best(repeats, done(|| red_black.sweep(Sweep::Forward, &b, &mut x, &mut y)))?;
    tell("red-black sweep", sweep, 1.0);
    let rows = best(repeats, done(|| csr.sweep(Sweep::Forward, &b, &mut x, &mut y)))?;
    tell("Gauss-Seidel sweep, rows", rows, 1.0);

    let mut dilu = Dilu::new(&a)?;
    tell("DILU factors", best(repeats, || dilu.refactor(&a))?, 1.0);
    let mut m = dilu.with(&a)?;
    tell("DILU solve", best(repeats, done(|| m.apply(&b, &mut y)))?, 1.0);
    let mut ilu = Ilu0::new(&csr)?;
    tell("ILU(0) factors", best(repeats, || ilu.refactor(&csr))?, 1.0);
    tell("ILU(0) solve", best(repeats, || ilu.solve(&b, &mut y))?, 1.0);

    let mut scratch = BiCgStabScratch::new(n);
    let params = BiCgStabParams { relative: 0.0, max_iterations: 10, ..BiCgStabParams::default() };
    let repeats = repeats.div_ceil(10);
    let seconds = best(repeats, || {
        x.fill(0.0);
        exhausted(bicgstab(&a, &mut m, &b, &mut x, &mut scratch, &params))
    })?;
    tell("BiCGSTAB iteration, DILU", seconds, 10.0);
    let seconds = best(repeats, || {
        x.fill(0.0);
        exhausted(bicgstab(&csr, &mut ilu, &b, &mut x, &mut scratch, &params))
    })?;
    tell("BiCGSTAB iteration, ILU(0)", seconds, 10.0);
    let params = BiCgStabParams::default();
    let start = Instant::now();
    x.fill(0.0);
    let info = bicgstab(&a, &mut m, &b, &mut x, &mut scratch, &params)?;
    let whole = start.elapsed().as_secs_f64();
    tell(&format!("BiCGSTAB, DILU to 1e-8: {} iterations", info.iterations), whole, 1.0);

    let a = system(cells, periodic, 0.0)?;
    let csr = a.to_matrix()?;
    let dilu = Dilu::new(&a)?;
    let mut m = dilu.with(&a)?;
    let mut scratch = CgScratch::new(n);
    let params = CgParams { relative: 0.0, max_iterations: 10, ..CgParams::default() };
    let seconds = best(repeats, || {
        x.fill(0.0);
        exhausted(conjugate_gradient(&a, &mut m, &b, &mut x, &mut scratch, &params))
    })?;
    tell("CG iteration, DILU", seconds, 10.0);
    if D == 2 {
        let params = DirectParams::default();
        let mut cholesky = SparseCholesky::new(&csr)?;
        tell("Cholesky factors", best(2, || cholesky.refactor(&csr))?, 1.0);
        tell("Cholesky solve", best(2, || cholesky.solve(&csr, &b, &mut x, &params).map(drop))?, 1.0);
        let mut lu = SparseLu::new(&csr)?;
        tell("LU factors", best(2, || lu.refactor(&csr))?, 1.0);
        tell("LU solve", best(2, || lu.solve(&csr, &b, &mut x, &params).map(drop))?, 1.0);
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    pool.install(|| {
        time([256, 256], [false, false])?;
        time([256, 256], [true, true])?;
        time([64, 64, 64], [true, true, false])
    })?;
    Ok(())
}
