//! A rod between walls at temperature 0 that is heated: u′ = ν u″ + f.
use example_support::Outcome;
use mor::galerkin::{Basis, Deim, DormandPrince, HyperReduced, Ode, QuadraticModel, SampledTerm};
use mor::pod::{Pod, PodParams};
use mor::{Mat, MatRef};
use std::f64::consts::PI;

const CELLS: usize = 200;
const CONDUCTIVITY: f64 = 0.05;
const TIMES: usize = 201;
const END: f64 = 10.0;

/// What models of so many modes are off.
pub(crate) struct Found {
    pub(crate) rank: usize,
    /// Largest error, heated evenly, and its bound.
    pub(crate) error: f64,
    pub(crate) bound: f64,
    /// Largest error with a source that depends on the temperature, evaluated in as many cells as there are modes.
    pub(crate) sampled: f64,
}

/// Conduction, and `even` heating.
struct Rod {
    even: f64,
}

impl Ode for Rod {
    fn n(&self) -> usize {
        CELLS
    }
    fn rate(&self, _: f64, y: &[f64], out: &mut [f64]) {
        let h = 1.0 / CELLS as f64;
        let at = |i: usize| y[i];
        for i in 0..CELLS {
            let below = if i == 0 { 2.0 * at(0) } else { at(i) - at(i - 1) };
            let above = if i == CELLS - 1 { 2.0 * at(i) } else { at(i) - at(i + 1) };
            out[i] = self.even - CONDUCTIVITY * (below + above) / (h * h);
        }
    }
}

/// A flame that wanders and goes out where it is hot.
struct Flame;

impl SampledTerm for Flame {
    fn support(&self, row: usize) -> Vec<usize> {
        vec![row]
    }
    fn at(&self, t: f64, row: usize, values: &[f64]) -> f64 {
        let x = (row as f64 + 0.5) / CELLS as f64;
        3.0 * (-30.0 * (x - 0.3 - 0.04 * t).powi(2)).exp() / (1.0 + values[0].powi(2))
    }
}

/// Rod and flame, every cell.
struct Burning;

impl Ode for Burning {
    fn n(&self) -> usize {
        CELLS
    }
    fn rate(&self, t: f64, y: &[f64], out: &mut [f64]) {
        Rod { even: 0.0 }.rate(t, y, out);
        out.iter_mut().enumerate().for_each(|(i, out)| *out += Flame.at(t, i, &[y[i]]));
    }
}

/// Models of 2 to 12 modes.
pub(crate) fn run() -> Outcome<Vec<Found>> {
    // Dense at the start, where the residual is largest.
    let times: Vec<f64> = (0..TIMES).map(|j| END * (j as f64 / (TIMES - 1) as f64).powi(3)).collect();
    // Explicit steps are as short as diffusion wants.
    let solver = DormandPrince { relative: 1e-8, absolute: 1e-10, ..DormandPrince::default() };
    let rest = vec![0.0; CELLS];
    let (rod, burning) =
        (solver.solve(&Rod { even: 1.0 }, &rest, &times)?, solver.solve(&Burning, &rest, &times)?);
    let flames = Mat::from_fn(CELLS, TIMES, |i, j| Flame.at(times[j], i, &[burning[(i, j)]]));
    let weights = vec![1.0 / CELLS as f64; CELLS];
    let modes = |of: &Mat<f64>, rank: usize| {
        Pod::new(of.as_ref(), &PodParams { weights: Some(weights.clone()), ..PodParams::of_rank(rank) })
    };
    // The slowest decay of differences.
    let slowest = -(4.0 * CONDUCTIVITY * (CELLS * CELLS) as f64) * (PI / (2 * CELLS) as f64).sin().powi(2);
    let mut all = Vec::new();
    for rank in [2, 4, 6, 8, 12] {
        let pod = modes(&rod, rank)?;
        let basis = Basis::new(pod.modes.as_ref(), None, Some(&weights))?;
        let (model, residual) = QuadraticModel::project_with_residual(&basis, &Rod { even: 1.0 }, 1.0)?;
        let start = vec![0.0; pod.rank()];
        let states = solver.solve(&model, &start, &times)?;
        let bounds = residual.bound(&times, states.as_ref(), 0.0, slowest)?;
        let (error, size) = largest(&basis, states.as_ref(), rod.as_ref())?;
        let pod = modes(&burning, rank)?;
        let basis = Basis::new(pod.modes.as_ref(), None, Some(&weights))?;
        let conduction = QuadraticModel::project(&basis, &Rod { even: 0.0 }, 1.0)?;
        let deim = Deim::new(&basis, modes(&flames, rank)?.modes.as_ref())?;
        let model = HyperReduced::new(&basis, conduction, Flame, deim)?;
        let states = solver.solve(&model, &vec![0.0; pod.rank()], &times)?;
        let (off, whole) = largest(&basis, states.as_ref(), burning.as_ref())?;
        let bound = bounds.iter().fold(0.0, |a: f64, b| a.max(*b)) / size;
        all.push(Found { rank, error: error / size, bound, sampled: off / whole });
    }
    Ok(all)
}

/// The largest error of states, and the largest norm of the truth.
fn largest(basis: &Basis<'_>, states: MatRef<'_, f64>, truth: MatRef<'_, f64>) -> Outcome<(f64, f64)> {
    let (mut off, mut size, mut field) = (0.0_f64, 0.0_f64, vec![0.0; CELLS]);
    for j in 0..truth.ncols() {
        let state: Vec<f64> = states.col(j).iter().copied().collect();
        basis.field(&state, &mut field)?;
        let norm =
            |f: &dyn Fn(usize) -> f64| ((0..CELLS).map(|i| f(i).powi(2)).sum::<f64>() / CELLS as f64).sqrt();
        off = off.max(norm(&|i| field[i] - truth[(i, j)]));
        size = size.max(norm(&|i| truth[(i, j)]));
    }
    Ok((off, size))
}
