//! Reduced models with linear and quadratic terms.
use super::{Basis, GalerkinError, Ode};
use crate::{Mat, MatRef};
use monomorphic::Qr;
use rand::{RngExt, SeedableRng};

/// η′ = c + A η + Q(η, η), equation (8) of Isoz et al. (2023) for full models y′ = R(y) whose rate is a polynomial of second degree: convection and diffusion, for
/// one. Evaluating it costs r·(r + 1)(r + 2)/2 multiplications, whatever n was.
#[derive(Clone, Debug)]
pub struct QuadraticModel {
    /// r × (r + 1)(r + 2)/2, a column for each of the monomials 1, η₁ … η_r, η₁η₁, η₁η₂ …
    coefficients: Mat<f64>,
}

/// How far the residual of a reduced solution is from 0, at a cost that does not depend on n.
///
/// ρ(η) = R(ȳ + Φη) − Φ η′ is what the modes cannot follow. If differences of solutions of the full model grow by no more than e^{ωt} (for a dissipative
/// linear one ω < 0 is the largest eigenvalue of its symmetric part), the error e of the reduced solution obeys
/// |e(t)| ≤ e^{ωt}|e(0)| + ∫₀ᵗ e^{ω(t−s)} |ρ(η(s))| ds: [`bound`](Residual::bound).
#[derive(Clone, Debug)]
pub struct Residual {
    /// R of the QR factors of what the modes leave of the rate's monomials.
    factor: Mat<f64>,
}

/// Monomials of r unknowns up to degree 2.
fn n_monomials(r: usize) -> usize {
    (r + 1) * (r + 2) / 2
}

fn monomials(of: &[f64], mut each: impl FnMut(f64)) {
    each(1.0);
    of.iter().for_each(|a| each(*a));
    for (i, a) in of.iter().enumerate() {
        of[i..].iter().for_each(|b| each(a * b));
    }
}

/// Relative deviation from a quadratic rate that is round-off.
const QUADRATIC: f64 = 1e-6;

impl QuadraticModel {
    /// Projects the rate of a `full` model, which is asked at ȳ, ȳ ± sφᵢ and ȳ + sφᵢ + sφⱼ and once more to see that it is quadratic:
    /// (r + 1)(r + 2)/2 + 1 evaluations. `amplitude` s is a typical size of coefficients.
    ///
    /// # Errors
    /// [`GalerkinError::Shape`], [`GalerkinError::NotFinite`], [`GalerkinError::NotQuadratic`].
    pub fn project(basis: &Basis<'_>, full: &dyn Ode, amplitude: f64) -> Result<Self, GalerkinError> {
        let mut columns = Vec::new();
        evaluations(basis, full, amplitude, |rate| columns.push(basis.products(rate)))?;
        let model = Self::of_evaluations(basis.rank(), amplitude, &columns);
        model.check(basis, full, amplitude)?;
        Ok(model)
    }

    /// The same, and the residual; takes the memory of (r + 1)(r + 2)/2 fields.
    ///
    /// # Errors
    /// As [`project`](Self::project).
    pub fn project_with_residual(
        basis: &Basis<'_>,
        full: &dyn Ode,
        amplitude: f64,
    ) -> Result<(Self, Residual), GalerkinError> {
        let (r, n) = (basis.rank(), basis.n());
        let (mut columns, mut left) = (Vec::new(), Vec::new());
        evaluations(basis, full, amplitude, |rate| {
            let products = basis.products(rate);
            let less = |row: usize| {
                let within: f64 = products.iter().enumerate().map(|(j, a)| a * basis.mode(row, j)).sum();
                basis.weight(row).sqrt() * (rate[row] - within)
            };
            left.push((0..n).map(less).collect::<Vec<_>>());
            columns.push(products);
        })?;
        let model = Self::of_evaluations(r, amplitude, &columns);
        model.check(basis, full, amplitude)?;
        let left = of_monomials(r, amplitude, &left);
        let p = left.ncols();
        // At least as many rows as columns.
        let left = Mat::from_fn(n.max(p), p, |i, j| if i < n { left[(i, j)] } else { 0.0 });
        Ok((model, Residual { factor: Qr::new(left).upper() }))
    }

    fn of_evaluations(r: usize, amplitude: f64, columns: &[Vec<f64>]) -> Self {
        Self { coefficients: of_monomials(r, amplitude, columns) }
    }

    /// The model whose rates at `states` (r × m) are nearest to `rates` (r × m): operator inference (Peherstorfer and Willcox, Comput. Methods Appl. Mech.
    /// Eng. 306 (2016) 196), for data without a full model to ask. Σⱼ|C m(ηⱼ) − η′ⱼ|² + γ²|C|² is least, the monomials m scaled to a root mean square of 1 and γ² being
    /// `regularisation`·m.
    ///
    /// # Errors
    /// [`GalerkinError::Shape`], [`GalerkinError::Undetermined`].
    pub fn infer(
        states: MatRef<'_, f64>,
        rates: MatRef<'_, f64>,
        regularisation: f64,
    ) -> Result<Self, GalerkinError> {
        let (r, m) = (states.nrows(), states.ncols());
        GalerkinError::same("equations of the rates", r, rates.nrows())?;
        GalerkinError::same("samples of the rates", m, rates.ncols())?;
        let p = n_monomials(r);
        let undetermined = GalerkinError::Undetermined { samples: m, unknowns: p };
        if regularisation <= 0.0 && m < p || m == 0 {
            return Err(undetermined);
        }
        let mut rows = Mat::zeros(m + p, p);
        for j in 0..m {
            let state: Vec<f64> = (0..r).map(|i| states[(i, j)]).collect();
            let mut column = 0;
            monomials(&state, |value| {
                rows[(j, column)] = value;
                column += 1;
            });
        }
        let scale: Vec<f64> = (0..p)
            .map(|c| ((0..m).map(|j| rows[(j, c)].powi(2)).sum::<f64>() / m as f64).sqrt())
            .map(|s| if s > 0.0 { s } else { 1.0 })
            .collect();
        for c in 0..p {
            (0..m).for_each(|j| rows[(j, c)] /= scale[c]);
            rows[(m + c, c)] = (regularisation.max(0.0) * m as f64).sqrt();
        }
        let qr = Qr::new(rows);
        let diagonal: Vec<f64> = qr.diagonal().map(f64::abs).collect();
        let largest = diagonal.iter().fold(0.0, |a: f64, b| a.max(*b));
        // NaN included.
        if !diagonal.iter().all(|d| *d > 1e-13 * largest) {
            return Err(undetermined);
        }
        let mut found = Mat::from_fn(m + p, r, |j, i| if j < m { rates[(i, j)] } else { 0.0 });
        qr.solve(found.as_mut());
        Ok(Self { coefficients: Mat::from_fn(r, p, |i, c| found[(c, i)] / scale[c]) })
    }

    /// Coefficients r × (r + 1)(r + 2)/2 of the monomials 1, η₁ … η_r, η₁η₁, η₁η₂ … η_rη_r.
    pub fn coefficients(&self) -> MatRef<'_, f64> {
        self.coefficients.as_ref()
    }

    /// Compares with the full model at a state of random coefficients.
    fn check(&self, basis: &Basis<'_>, full: &dyn Ode, amplitude: f64) -> Result<(), GalerkinError> {
        let mut random = rand_pcg::Pcg64::seed_from_u64(1);
        let state: Vec<f64> = (0..basis.rank()).map(|_| amplitude * random.random_range(-1.0..1.0)).collect();
        let (mut field, mut rate) = (vec![0.0; basis.n()], vec![0.0; basis.n()]);
        basis.field(&state, &mut field)?;
        full.rate(0.0, &field, &mut rate);
        finite(&rate, || "a random state".to_owned())?;
        let (asked, mut ours) = (basis.products(&rate), vec![0.0; basis.rank()]);
        self.rate(0.0, &state, &mut ours);
        let off = asked.iter().zip(&ours).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        let by = off / basis.norm(|row| rate[row]).max(f64::MIN_POSITIVE);
        if by > QUADRATIC { Err(GalerkinError::NotQuadratic { by }) } else { Ok(()) }
    }
}

impl Ode for QuadraticModel {
    fn n(&self) -> usize {
        self.coefficients.nrows()
    }
    fn rate(&self, _: f64, y: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        let mut column = 0;
        monomials(y, |value| {
            let of = self.coefficients.col_as_slice(column);
            out.iter_mut().zip(of).for_each(|(out, c)| *out += c * value);
            column += 1;
        });
    }
}

impl Residual {
    /// |ρ(η)| in the norm of the weights.
    pub fn norm(&self, state: &[f64]) -> f64 {
        let mut of = Vec::with_capacity(self.factor.ncols());
        monomials(state, |value| of.push(value));
        let row = |i: usize| (i..of.len()).map(|j| self.factor[(i, j)] * of[j]).sum::<f64>();
        (0..of.len()).map(|i| row(i).powi(2)).sum::<f64>().sqrt()
    }
    /// The bound of the error at `times` of a solution `states` (r × m) there, from that of the start and the growth rate ω \[1/s\]; the integral by trapezoids of |ρ|.
    ///
    /// # Errors
    /// [`GalerkinError::Shape`].
    pub fn bound(
        &self,
        times: &[f64],
        states: MatRef<'_, f64>,
        at_start: f64,
        growth: f64,
    ) -> Result<Vec<f64>, GalerkinError> {
        GalerkinError::same("states", times.len(), states.ncols())?;
        let norm = |j: usize| self.norm(&(0..states.nrows()).map(|i| states[(i, j)]).collect::<Vec<_>>());
        let mut bounds = Vec::with_capacity(times.len());
        let (mut before, mut bound) = (0.0, at_start);
        for (j, t) in times.iter().enumerate() {
            let now = norm(j);
            if j > 0 {
                let dt = t - times[j - 1];
                let grown = (growth * dt).exp();
                bound = grown * bound + 0.5 * dt * (grown * before + now);
            }
            bounds.push(bound);
            before = now;
        }
        Ok(bounds)
    }
}

fn finite(rate: &[f64], at: impl Fn() -> String) -> Result<(), GalerkinError> {
    match rate.iter().position(|v| !v.is_finite()) {
        Some(row) => Err(GalerkinError::NotFinite { row, value: rate[row], at: at() }),
        None => Ok(()),
    }
}

/// Hands on R(ȳ), R(ȳ + sφᵢ) and R(ȳ − sφᵢ) for every i, R(ȳ + sφᵢ + sφⱼ) for every i < j.
fn evaluations(
    basis: &Basis<'_>,
    full: &dyn Ode,
    amplitude: f64,
    mut each: impl FnMut(&[f64]),
) -> Result<(), GalerkinError> {
    let (n, r) = (basis.n(), basis.rank());
    GalerkinError::same("unknowns of the full model", n, full.n())?;
    let (mut state, mut field, mut rate) = (vec![0.0; r], vec![0.0; n], vec![0.0; n]);
    let mut ask = |of: &[(usize, f64)]| {
        state.fill(0.0);
        of.iter().for_each(|(i, sign)| state[*i] = sign * amplitude);
        basis.field(&state, &mut field)?;
        full.rate(0.0, &field, &mut rate);
        finite(&rate, || format!("modes and signs {of:?} of amplitude {amplitude}"))?;
        each(&rate);
        Ok::<(), GalerkinError>(())
    };
    ask(&[])?;
    for i in 0..r {
        ask(&[(i, 1.0)])?;
        ask(&[(i, -1.0)])?;
    }
    for i in 0..r {
        (i + 1..r).try_for_each(|j| ask(&[(i, 1.0), (j, 1.0)]))?;
    }
    Ok(())
}

/// The coefficients of monomials by those evaluations.
fn of_monomials(r: usize, s: f64, found: &[Vec<f64>]) -> Mat<f64> {
    let n = found[0].len();
    let (up, down) = (|i: usize| &found[1 + 2 * i], |i: usize| &found[2 + 2 * i]);
    let mut both = found[1 + 2 * r..].iter();
    let mut columns: Vec<Vec<f64>> = vec![found[0].clone()];
    let column = |of: &dyn Fn(usize) -> f64| (0..n).map(of).collect::<Vec<f64>>();
    columns.extend((0..r).map(|i| column(&|k| 0.5 * (up(i)[k] - down(i)[k]) / s)));
    for i in 0..r {
        columns.push(column(&|k| (0.5 * (up(i)[k] + down(i)[k]) - found[0][k]) / (s * s)));
        for (j, both) in (i + 1..r).zip(&mut both) {
            columns.push(column(&|k| (both[k] - up(i)[k] - up(j)[k] + found[0][k]) / (s * s)));
        }
    }
    Mat::from_fn(n, columns.len(), |i, j| columns[j][i])
}
