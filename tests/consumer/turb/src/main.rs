//! `turb` alone: turbulence that decays in a flow of the user's own, which is one cell here, and
//! what the law of the wall says.
use turb::{Closure, Equation, Inflow, KEpsilon, StandardKEpsilon, WallFunctions};
use turb::{SolveError, SolveInfo, Transport};

/// A box of fluid in which nothing differs from place to place.
struct Still;

impl Transport for Still {
    fn n_cells(&self) -> usize {
        1
    }
    fn cell_volume(&self, _: usize) -> f64 {
        1.0
    }
    fn wall_distance(&self) -> &[f64] {
        &[f64::INFINITY]
    }
    fn strain_rate(&mut self, out: &mut [f64]) -> Result<(), SolveError> {
        out.fill(0.0);
        Ok(())
    }
    fn velocity_gradient(&mut self, out: &mut [[[f64; 3]; 3]]) -> Result<(), SolveError> {
        out.fill([[0.0; 3]; 3]);
        Ok(())
    }
    fn dot_gradients(&mut self, _: &[f64], _: &[f64], out: &mut [f64]) -> Result<(), SolveError> {
        out.fill(0.0);
        Ok(())
    }
    fn solve(&mut self, e: &Equation<'_>, phi: &mut [f64]) -> Result<SolveInfo, SolveError> {
        let rate = 1.0 / e.dt.ok_or_else(|| SolveError::Solver("only in time".into()))?;
        phi[0] = (rate * phi[0] + e.source[0]) / (rate + e.sink[0]);
        Ok(SolveInfo::default())
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let start = Inflow::from_length(10.0, 0.05, 0.02)?;
    let mut model = KEpsilon::new(StandardKEpsilon::default(), 1, start)?;
    // k = k₀ (1 + (C₂ − 1) ε₀ t/k₀)^(−1/(C₂ − 1)).
    let (dt, steps) = (1e-5, 20_000);
    for _ in 0..steps {
        model.correct(&mut Still, &[], 1.5e-5, Some(dt))?;
    }
    let time = dt * f64::from(steps);
    let exact = start.k * (1.0 + 0.92 * start.epsilon() / start.k * time).powf(-1.0 / 0.92);
    println!("k {:.6} m²/s², exactly {exact:.6}", model.k()[0]);
    if (model.k()[0] / exact - 1.0).abs() > 1e-3 {
        return Err("k decays at another rate".into());
    }
    let wall = WallFunctions::default();
    println!("u+ {:.2} and ν_t/ν {:.2} at y+ 100", wall.u_plus(100.0), wall.viscosity_ratio(100.0));
    Ok(())
}
