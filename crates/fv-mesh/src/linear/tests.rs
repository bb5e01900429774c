//! Known answers, refusals and agreement of the solvers.
use super::*;
use proptest::prelude::*;

mod manipulations;
mod refusals;
mod stencils;

/// Numbers in −1..1 that look random.
fn noise(n: usize, seed: u64) -> Vec<f64> {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    (0..n)
        .map(|_| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        })
        .collect()
}

/// −∇² with φ = 0 on the sides that do not wrap, in units of 1/h².
fn laplacian<const D: usize>(cells: [usize; D], periodic: [bool; D]) -> StencilMatrix<D> {
    let mut a = StencilMatrix::new(cells, periodic).unwrap();
    let n: usize = cells.iter().product();
    let (centre, lower, upper) = a.parts_mut();
    let mut stride = 1;
    for axis in 0..D {
        lower[axis].fill(-1.0);
        upper[axis].fill(-1.0);
        for c in 0..n {
            let i = c / stride % cells[axis];
            let walls = usize::from(i == 0) + usize::from(i + 1 == cells[axis]);
            centre[c] += if periodic[axis] { 2.0 } else { 2.0 + walls as f64 };
        }
        stride *= cells[axis];
    }
    a
}

/// Upwind convection by a flow of the given mesh Péclet number that turns with the place, plus diffusion and a
/// little reaction.
fn convection<const D: usize>(cells: [usize; D], periodic: [bool; D], peclet: f64) -> StencilMatrix<D> {
    let mut a = laplacian(cells, periodic);
    let flow = noise(a.n() * D, 7);
    let (centre, lower, upper) = a.parts_mut();
    for axis in 0..D {
        for c in 0..centre.len() {
            let u = peclet * (0.5 + flow[c * D + axis]);
            lower[axis][c] -= u.max(0.0);
            upper[axis][c] += u.min(0.0);
            centre[c] += u.abs() + 0.01;
        }
    }
    a
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |m, (a, b)| m.max((a - b).abs()))
}

fn product(a: &impl LinearOperator, x: &[f64]) -> Vec<f64> {
    let mut b = vec![0.0; x.len()];
    a.apply(x, &mut b);
    b
}

fn solve_bicgstab(
    a: &impl LinearOperator,
    m: &mut impl Preconditioner,
    b: &[f64],
) -> Result<(Vec<f64>, BiCgStabInfo), LinearError> {
    let mut x = vec![0.0; b.len()];
    let params = BiCgStabParams { relative: 1e-12, ..BiCgStabParams::default() };
    let info = bicgstab(a, m, b, &mut x, &mut BiCgStabScratch::new(b.len()), &params)?;
    Ok((x, info))
}

fn solve_cg(
    a: &impl LinearOperator,
    m: &mut impl Preconditioner,
    b: &[f64],
) -> Result<(Vec<f64>, CgInfo), LinearError> {
    let mut x = vec![0.0; b.len()];
    let params = CgParams { relative: 1e-12, ..CgParams::default() };
    let info = conjugate_gradient(a, m, b, &mut x, &mut CgScratch::new(b.len()), &params)?;
    Ok((x, info))
}

fn solve_lu(a: &Matrix, b: &[f64]) -> Result<Vec<f64>, LinearError> {
    let mut x = vec![0.0; b.len()];
    SparseLu::new(a)?.solve(a, b, &mut x, &DirectParams::default())?;
    Ok(x)
}

fn solve_gauss_seidel(
    a: &impl GaussSeidelSweep,
    b: &[f64],
    order: SweepOrder,
) -> Result<Vec<f64>, LinearError> {
    let mut x = vec![0.0; b.len()];
    let params = GaussSeidelParams { relative: 1e-12, order, ..GaussSeidelParams::default() };
    gauss_seidel(a, b, &mut x, &mut GaussSeidelScratch::new(b.len()), &params)?;
    Ok(x)
}

#[test]
fn direct_solvers_reach_round_off() {
    let a = laplacian([23, 17], [false, true]).to_matrix().unwrap();
    let exact = noise(a.n(), 1);
    let b = product(&a, &exact);
    assert!(largest_difference(&solve_lu(&a, &b).unwrap(), &exact) < 1e-12);
    let mut x = vec![0.0; a.n()];
    let mut cholesky = SparseCholesky::new(&a).unwrap();
    let info = cholesky.solve(&a, &b, &mut x, &DirectParams::default()).unwrap();
    assert!(largest_difference(&x, &exact) < 1e-12);
    assert_eq!(info.iterations, 1);
    // Other values in the same pattern.
    let b: Vec<f64> = b.iter().map(|b| 3.0 * b).collect();
    let mut scaled = a.clone();
    scaled.values_mut().iter_mut().for_each(|v| *v *= 3.0);
    cholesky.refactor(&scaled).unwrap();
    cholesky.solve(&scaled, &b, &mut x, &DirectParams::default()).unwrap();
    assert!(largest_difference(&x, &exact) < 1e-12);
    let a = convection([19, 20], [false, false], 40.0).to_matrix().unwrap();
    let mut lu = SparseLu::new(&scaled_pattern(&a)).unwrap();
    lu.refactor(&a).unwrap();
    let exact = noise(a.n(), 2);
    let mut x = vec![0.0; a.n()];
    let info = lu.solve(&a, &product(&a, &exact), &mut x, &DirectParams::default()).unwrap();
    assert!(largest_difference(&x, &exact) < 1e-12);
    assert!(info.residual < 1e-14 && info.iterations == 1);
}

/// Other values in the pattern of `a`.
fn scaled_pattern(a: &Matrix) -> Matrix {
    let mut other = a.clone();
    other.values_mut().iter_mut().enumerate().for_each(|(k, v)| *v *= 1.0 + 0.1 * (k % 3) as f64);
    other
}

#[test]
fn lu_pivots_where_the_diagonal_vanishes() {
    let a = Matrix::from_triplets(2, &[(0, 1, 2.0), (1, 0, 4.0)]).unwrap();
    assert_eq!(solve_lu(&a, &[2.0, 8.0]).unwrap(), [2.0, 1.0]);
}

#[test]
fn conjugate_gradients_end_within_n_iterations() {
    for n in [1, 2, 7, 30] {
        let a = laplacian([n], [false]);
        let exact = noise(n, 3);
        let (x, info) = solve_cg(&a, &mut Identity::new(n), &product(&a, &exact)).unwrap();
        assert!(largest_difference(&x, &exact) < 1e-10);
        assert!(info.iterations <= n && info.iterations > 0, "{} iterations for {n}", info.iterations);
        assert!(info.residual <= 1e-12);
    }
}

#[test]
fn better_preconditioners_save_iterations() {
    let a = laplacian([48, 40], [false, false]);
    let csr = a.to_matrix().unwrap();
    let exact = noise(a.n(), 4);
    let b = product(&a, &exact);
    let mut diagonal = vec![0.0; a.n()];
    a.write_diagonal(&mut diagonal).unwrap();
    let (_, plain) = solve_cg(&a, &mut Jacobi::new(&diagonal).unwrap(), &b).unwrap();
    let (x, sweeps) = solve_cg(&a, &mut SymmetricGaussSeidel::new(&a).unwrap(), &b).unwrap();
    let dilu = Dilu::new(&a).unwrap();
    let (y, factors) = solve_cg(&a, &mut dilu.with(&a).unwrap(), &b).unwrap();
    let (z, csr_factors) = solve_cg(&csr, &mut Ilu0::new(&csr).unwrap(), &b).unwrap();
    for x in [x, y, z] {
        assert!(largest_difference(&x, &exact) < 1e-10);
    }
    assert!(2 * sweeps.iterations < plain.iterations + 5, "{sweeps:?} {plain:?}");
    assert!(factors.iterations <= sweeps.iterations);
    assert_eq!(csr_factors.iterations, factors.iterations);
}

#[test]
fn convection_dominated_systems_are_solved() {
    for peclet in [1.0, 100.0, 1e4] {
        let a = convection([40, 30], [false, true], peclet);
        let csr = a.to_matrix().unwrap();
        let exact = noise(a.n(), 5);
        let b = product(&csr, &exact);
        let n = a.n();
        let (x, info) = solve_bicgstab(&csr, &mut Ilu0::new(&csr).unwrap(), &b).unwrap();
        assert!(largest_difference(&x, &exact) < 1e-8);
        assert!(info.iterations < 60 && info.residual <= 1e-12);
        let dilu = Dilu::new(&a).unwrap();
        let (x, info) = solve_bicgstab(&a, &mut dilu.with(&a).unwrap(), &b).unwrap();
        assert!(largest_difference(&x, &exact) < 1e-8);
        assert!(info.iterations < 60);
        let (x, plain) = solve_bicgstab(&a, &mut Identity::new(n), &b).unwrap();
        assert!(largest_difference(&x, &exact) < 1e-8);
        assert!(plain.iterations > info.iterations);
        for order in [SweepOrder::Forward, SweepOrder::Symmetric] {
            assert!(largest_difference(&solve_gauss_seidel(&a, &b, order).unwrap(), &exact) < 1e-8);
        }
    }
}

#[test]
fn ilu_is_exact_for_tridiagonal_matrices() {
    let a = convection([50], [false], 5.0);
    let csr = a.to_matrix().unwrap();
    let exact = noise(50, 6);
    let b = product(&a, &exact);
    let mut ilu = Ilu0::new(&scaled_pattern(&csr)).unwrap();
    ilu.refactor(&csr).unwrap();
    let mut x = vec![0.0; 50];
    ilu.solve(&b, &mut x).unwrap();
    assert!(largest_difference(&x, &exact) < 1e-13);
    let dilu = Dilu::new(&a).unwrap();
    dilu.with(&a).unwrap().apply(&b, &mut x);
    assert!(largest_difference(&x, &exact) < 1e-13);
    assert_eq!(solve_bicgstab(&csr, &mut ilu, &b).unwrap().1.iterations, 1);
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let a = convection([150, 170], [true, false], 3.0);
    let csr = a.to_matrix().unwrap();
    let b = noise(a.n(), 8);
    let solve = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut diagonal = vec![0.0; a.n()];
            a.write_diagonal(&mut diagonal).unwrap();
            let (x, _) = solve_bicgstab(&a, &mut Jacobi::new(&diagonal).unwrap(), &b).unwrap();
            let (y, _) = solve_bicgstab(&csr, &mut Ilu0::new(&csr).unwrap(), &b).unwrap();
            let mut z = vec![0.0; a.n()];
            let mut work = z.clone();
            RedBlack::new(&a).sweep(Sweep::Forward, &b, &mut z, &mut work);
            (x, y, z)
        })
    };
    assert!(solve(1) == solve(3));
}

#[test]
fn zero_right_hand_sides_give_zero() {
    let a = laplacian([5, 4], [false, false]);
    let mut x = noise(20, 9);
    let info = bicgstab(
        &a,
        &mut Identity::new(20),
        &[0.0; 20],
        &mut x,
        &mut BiCgStabScratch::new(20),
        &BiCgStabParams::default(),
    );
    assert_eq!(info, Ok(BiCgStabInfo::default()));
    assert_eq!(x, [0.0; 20]);
}

#[test]
fn a_neumann_problem_with_a_consistent_right_hand_side_is_solved() {
    let mut a = laplacian([16, 12], [true, true]);
    let b: Vec<f64> = (0..a.n()).map(|c| (c % 16) as f64 - 7.5).collect();
    let dilu = Dilu::new(&a).unwrap();
    let (x, _) = solve_cg(&a, &mut dilu.with(&a).unwrap(), &b).unwrap();
    assert!(largest_difference(&product(&a, &x), &b) < 1e-9);
    // With one value fixed it is regular.
    let mut pinned = b.clone();
    a.pin_symmetric(5, 2.0, &mut pinned).unwrap();
    let y = solve_lu(&a.to_matrix().unwrap(), &pinned).unwrap();
    let shift = y[0] - x[0];
    assert!(y.iter().zip(&x).all(|(y, x)| (y - x - shift).abs() < 1e-8));
    assert_eq!(y[5], 2.0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn all_solvers_agree_on_diagonally_dominant_systems(
        n in 1_usize..40,
        places in prop::collection::vec((0_usize..40, 0_usize..40, -1.0..1.0_f64), 0..160),
        seed in 1_u64..1000,
        symmetric in any::<bool>(),
    ) {
        let mut triplets = Vec::new();
        for (row, col, value) in places {
            if row < n && col < n && row != col {
                triplets.push((row, col, value));
                triplets.push((row, row, value.abs()));
                triplets.push((col, col, value.abs()));
                triplets.push((col, row, if symmetric { value } else { 0.0 }));
            }
        }
        triplets.extend((0..n).map(|row| (row, row, 0.3)));
        // Rows dominate: each entry's size is in its row's diagonal.
        let a = Matrix::from_triplets(n, &triplets).unwrap();
        prop_assert!(a.dominance() > 0.0);
        let exact = noise(n, seed);
        let b = product(&a, &exact);
        let mut diagonal = vec![0.0; n];
        a.write_diagonal(&mut diagonal).unwrap();
        let mut found = vec![
            solve_lu(&a, &b).unwrap(),
            solve_bicgstab(&a, &mut Identity::new(n), &b).unwrap().0,
            solve_bicgstab(&a, &mut Jacobi::new(&diagonal).unwrap(), &b).unwrap().0,
            solve_bicgstab(&a, &mut Ilu0::new(&a).unwrap(), &b).unwrap().0,
            solve_bicgstab(&a, &mut SymmetricGaussSeidel::new(&a).unwrap(), &b).unwrap().0,
            solve_gauss_seidel(&a, &b, SweepOrder::Forward).unwrap(),
            solve_gauss_seidel(&a, &b, SweepOrder::Symmetric).unwrap(),
        ];
        if symmetric {
            found.push(solve_cg(&a, &mut Ilu0::new(&a).unwrap(), &b).unwrap().0);
            let mut x = vec![0.0; n];
            let mut cholesky = SparseCholesky::new(&a).unwrap();
            cholesky.solve(&a, &b, &mut x, &DirectParams::default()).unwrap();
            found.push(x);
        }
        for x in found {
            prop_assert!(largest_difference(&x, &exact) < 1e-9);
        }
    }
}
