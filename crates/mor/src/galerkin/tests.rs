use super::*;
use crate::Mat;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use std::f64::consts::PI;

fn random(n: usize, m: usize, seed: u64) -> Mat<f64> {
    let mut random = rand_pcg::Pcg64::seed_from_u64(seed);
    Mat::from_fn(n, m, |_, _| random.random_range(-1.0..1.0))
}

/// Orthonormal columns in the inner product of `weights`, by Gram and Schmidt, twice.
fn orthonormal(mut a: Mat<f64>, weights: &[f64]) -> Mat<f64> {
    for _ in 0..2 {
        for j in 0..a.ncols() {
            let product = |a: &Mat<f64>, i: usize| -> f64 {
                (0..a.nrows()).map(|k| weights[k] * a[(k, i)] * a[(k, j)]).sum()
            };
            for i in 0..j {
                let share = product(&a, i);
                (0..a.nrows()).for_each(|k| a[(k, j)] -= share * a[(k, i)]);
            }
            let norm = product(&a, j).sqrt();
            (0..a.nrows()).for_each(|k| a[(k, j)] /= norm);
        }
    }
    a
}

/// y′ = c + A y + Q(y, y) with random numbers.
struct Random {
    c: Mat<f64>,
    a: Mat<f64>,
    q: Mat<f64>,
}

impl Random {
    fn new(n: usize, seed: u64) -> Self {
        Self { c: random(n, 1, seed), a: random(n, n, seed + 1), q: random(n, n * n, seed + 2) }
    }
}

impl Ode for Random {
    fn n(&self) -> usize {
        self.a.nrows()
    }
    fn rate(&self, _: f64, y: &[f64], out: &mut [f64]) {
        let n = y.len();
        for i in 0..n {
            out[i] = self.c[(i, 0)];
            for j in 0..n {
                out[i] += self.a[(i, j)] * y[j];
                out[i] += (0..n).map(|k| self.q[(i, n * j + k)] * y[j] * y[k]).sum::<f64>();
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    /// Projecting and evaluating commute, and the residual is what is left.
    #[test]
    fn projections_are_exact(n in 3..9usize, r in 1..4usize, seed in 0..1000_u64, amplitude in 0.1..10.0f64) {
        let full = Random::new(n, seed);
        let weights: Vec<f64> = (0..n).map(|i| 0.5 + (i as f64 * 0.7).sin().powi(2)).collect();
        let mean: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
        let modes = orthonormal(random(n, r, seed + 3), &weights);
        let basis = Basis::new(modes.as_ref(), Some(&mean), Some(&weights)).unwrap();
        let (model, residual) = QuadraticModel::project_with_residual(&basis, &full, amplitude).unwrap();
        let plain = QuadraticModel::project(&basis, &full, amplitude).unwrap();
        prop_assert_eq!(plain.coefficients(), model.coefficients());
        let state: Vec<f64> = (0..r).map(|j| (j as f64 + 0.3).sin()).collect();
        let (mut field, mut rate, mut ours) = (vec![0.0; n], vec![0.0; n], vec![0.0; r]);
        basis.field(&state, &mut field).unwrap();
        let back = basis.coefficients(&field).unwrap();
        prop_assert!(back.iter().zip(&state).all(|(a, b)| (a - b).abs() < 1e-12));
        full.rate(0.0, &field, &mut rate);
        model.rate(0.0, &state, &mut ours);
        let asked = basis.products(&rate);
        let size = basis.norm(|i| rate[i]);
        for (a, b) in asked.iter().zip(&ours) {
            prop_assert!((a - b).abs() < 1e-10 * size * (1.0 + 1.0 / amplitude), "{} {}", a, b);
        }
        let left = basis.norm(|i| rate[i] - (0..r).map(|j| modes[(i, j)] * asked[j]).sum::<f64>());
        prop_assert!((residual.norm(&state) - left).abs() < 1e-9 * size * (1.0 + 1.0 / amplitude), "{} {}", residual.norm(&state), left);
    }

    /// Rates of a quadratic model give it back.
    #[test]
    fn inference_finds_the_model(r in 1..4usize, seed in 0..1000_u64) {
        let full = Random::new(r, seed);
        let states = random(r, 60, seed + 7);
        let mut rates = Mat::zeros(r, 60);
        for j in 0..60 {
            full.rate(0.0, states.col_as_slice(j), rates.col_as_slice_mut(j));
        }
        let model = QuadraticModel::infer(states.as_ref(), rates.as_ref(), 0.0).unwrap();
        let state = vec![0.7; r];
        let (mut a, mut b) = (vec![0.0; r], vec![0.0; r]);
        full.rate(0.0, &state, &mut a);
        model.rate(0.0, &state, &mut b);
        prop_assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-9), "{:?} {:?}", a, b);
    }
}

/// u′ = ν u″ + 1 between walls at 0, cells of different width.
struct Heat {
    widths: Vec<f64>,
    conductivity: f64,
}

impl Ode for Heat {
    fn n(&self) -> usize {
        self.widths.len()
    }
    fn rate(&self, _: f64, y: &[f64], out: &mut [f64]) {
        let n = y.len();
        for i in 0..n {
            let h = |i: usize| self.widths[i];
            let flux = |j: usize| match j {
                0 => self.conductivity * y[0] / (0.5 * h(0)),
                j if j == n => -self.conductivity * y[n - 1] / (0.5 * h(n - 1)),
                j => self.conductivity * (y[j] - y[j - 1]) / (0.5 * (h(j) + h(j - 1))),
            };
            out[i] = 1.0 + (flux(i + 1) - flux(i)) / h(i);
        }
    }
}

/// The error of a reduced model of diffusion is below its bound, and not farther below than the modes left out decay faster.
#[test]
fn the_bound_holds_for_diffusion() {
    let n = 40;
    let widths: Vec<f64> = (0..n).map(|i| 1.0 + 0.5 * (i as f64).sin()).collect();
    let length: f64 = widths.iter().sum();
    let widths: Vec<f64> = widths.iter().map(|h| h / length).collect();
    let full = Heat { widths: widths.clone(), conductivity: 0.05 };
    let solver = DormandPrince { most_steps: 10_000_000, ..DormandPrince::default() };
    let times: Vec<f64> = (0..=200).map(|j| 0.05 * f64::from(j)).collect();
    let truth = solver.solve(&full, &vec![0.0; n], &times).unwrap();
    let mut before = f64::INFINITY;
    for r in [1, 2, 3, 5] {
        // The modes of an equal grid.
        let mut at = 0.0;
        let middles: Vec<f64> = widths
            .iter()
            .map(|h| {
                at += h;
                at - 0.5 * h
            })
            .collect();
        let sines = Mat::from_fn(n, r, |i, j| (PI * (2 * j + 1) as f64 * middles[i]).sin());
        let modes = orthonormal(sines, &widths);
        let basis = Basis::new(modes.as_ref(), None, Some(&widths)).unwrap();
        let (model, residual) = QuadraticModel::project_with_residual(&basis, &full, 1.0).unwrap();
        let states = solver.solve(&model, &vec![0.0; r], &times).unwrap();
        // Differences decay at least as the slowest mode does, π²ν; on these cells a little slower.
        let bounds = residual.bound(&times, states.as_ref(), 0.0, -0.99 * 0.05 * PI * PI).unwrap();
        let mut field = vec![0.0; n];
        let mut off = [0.0_f64; 2];
        for j in 1..times.len() {
            basis.field(&(0..r).map(|i| states[(i, j)]).collect::<Vec<_>>(), &mut field).unwrap();
            let error = basis.norm(|i| field[i] - truth[(i, j)]);
            assert!(error <= 1.001 * bounds[j], "{r} modes, {}: {error} {}", times[j], bounds[j]);
            off = [off[0].max(error), off[1].max(bounds[j])];
        }
        // What the modes leave decays (2r + 1)² times as fast as the bound takes it to.
        let pessimism = f64::from(2 * r as u32 + 1).powi(2);
        assert!(off[0] < before && off[1] < 2.0 * pessimism * off[0], "{r}: {off:?}");
        before = off[0];
    }
}

/// u′ = −λ u + f(t, x, u): every row on its own, the source wandering.
struct Bumps {
    rates: Vec<f64>,
}

impl SampledTerm for &Bumps {
    fn support(&self, row: usize) -> Vec<usize> {
        vec![row]
    }
    fn at(&self, t: f64, row: usize, values: &[f64]) -> f64 {
        let x = row as f64 / self.rates.len() as f64;
        (-10.0 * (x - 0.3 - 0.2 * t).powi(2)).exp() / (1.0 + values[0].powi(2))
    }
}

impl Ode for Bumps {
    fn n(&self) -> usize {
        self.rates.len()
    }
    fn rate(&self, t: f64, y: &[f64], out: &mut [f64]) {
        for (i, out) in out.iter_mut().enumerate() {
            *out = -self.rates[i] * y[i] + (&self).at(t, i, &[y[i]]);
        }
    }
}

/// Only the linear part.
struct Decay<'a>(&'a Bumps);

impl Ode for Decay<'_> {
    fn n(&self) -> usize {
        self.0.rates.len()
    }
    fn rate(&self, _: f64, y: &[f64], out: &mut [f64]) {
        for (i, out) in out.iter_mut().enumerate() {
            *out = -self.0.rates[i] * y[i];
        }
    }
}

/// A term sampled in k rows takes the reduced model to the full one as r and k grow; rows are distinct and the error of f is bounded.
#[test]
fn few_rows_are_enough() {
    let n = 200;
    let full = Bumps { rates: (0..n).map(|i| 0.5 + i as f64 / n as f64).collect() };
    let times: Vec<f64> = (0..=100).map(|j| 0.02 * f64::from(j)).collect();
    let solver = DormandPrince::default();
    let truth = solver.solve(&full, &vec![0.0; n], &times).unwrap();
    let f = Mat::from_fn(n, 101, |i, j| (&&full).at(times[j], i, &[truth[(i, j)]]));
    // Every tenth snapshot, orthonormal: a basis good enough here.
    let every = |of: &Mat<f64>, k: usize| {
        orthonormal(Mat::from_fn(n, k, |i, j| of[(i, 100 * (j + 1) / k)]), &vec![1.0; n])
    };
    let mut before = f64::INFINITY;
    for k in [3, 5, 8, 11] {
        let (modes, terms) = (every(&truth, k), every(&f, k));
        let basis = Basis::new(modes.as_ref(), None, None).unwrap();
        let deim = Deim::new(&basis, terms.as_ref()).unwrap();
        let mut rows = deim.rows().to_vec();
        rows.sort_unstable();
        rows.dedup();
        assert_eq!(rows.len(), k);
        assert!(deim.amplification() >= 1.0 && deim.amplification() < 100.0, "{}", deim.amplification());
        let linear = QuadraticModel::project(&basis, &Decay(&full), 1.0).unwrap();
        let model = HyperReduced::new(&basis, linear, &full, deim).unwrap();
        let states = solver.solve(&model, &vec![0.0; k], &times).unwrap();
        let mut field = vec![0.0; n];
        basis.field(&(0..k).map(|i| states[(i, 100)]).collect::<Vec<_>>(), &mut field).unwrap();
        let error = basis.norm(|i| field[i] - truth[(i, 100)]) / basis.norm(|i| truth[(i, 100)]);
        assert!(error < 0.3 * before, "{k}: {error} after {before}");
        before = error;
    }
    assert!(before < 1e-5, "{before}");
}

#[test]
fn what_does_not_fit_is_told() {
    struct Cubic;
    impl Ode for Cubic {
        fn n(&self) -> usize {
            2
        }
        fn rate(&self, _: f64, y: &[f64], out: &mut [f64]) {
            out.copy_from_slice(&[y[0].powi(3), -y[1]]);
        }
    }
    struct Broken;
    impl Ode for Broken {
        fn n(&self) -> usize {
            2
        }
        fn rate(&self, _: f64, y: &[f64], out: &mut [f64]) {
            out.copy_from_slice(&[y[0], (y[1] - 0.5).ln()]);
        }
    }
    let modes = Mat::from_fn(2, 2, |i, j| f64::from(u8::from(i == j)));
    let basis = Basis::new(modes.as_ref(), None, None).unwrap();
    assert!(
        matches!(QuadraticModel::project(&basis, &Cubic, 1.0), Err(GalerkinError::NotQuadratic { by }) if by > 0.01)
    );
    assert!(matches!(
        QuadraticModel::project(&basis, &Broken, 1.0),
        Err(GalerkinError::NotFinite { row: 1, .. })
    ));
    assert!(matches!(
        QuadraticModel::project(&basis, &Random::new(3, 1), 1.0),
        Err(GalerkinError::Shape { expected: 2, found: 3, .. })
    ));
    let skew = Mat::from_fn(2, 2, |i, j| if i == j { 1.0 } else { 0.1 });
    assert!(matches!(Basis::new(skew.as_ref(), None, None), Err(GalerkinError::NotOrthonormal { .. })));
    assert!(matches!(Basis::new(modes.as_ref(), Some(&[1.0]), None), Err(GalerkinError::Shape { .. })));
    let twice = Mat::from_fn(2, 2, |_, _| 1.0);
    assert!(matches!(Deim::new(&basis, twice.as_ref()), Err(GalerkinError::Dependent { mode: 1, .. })));
    let few = Mat::zeros(2, 3);
    assert!(matches!(
        QuadraticModel::infer(few.as_ref(), few.as_ref(), 0.0),
        Err(GalerkinError::Undetermined { samples: 3, unknowns: 6 })
    ));
    assert!(QuadraticModel::infer(random(2, 3, 1).as_ref(), random(2, 3, 2).as_ref(), 1e-6).is_ok());
}
