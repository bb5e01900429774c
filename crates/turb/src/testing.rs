//! A flow for tests.
use interfaces::{Equation, LogSlope, SolveError, SolveInfo, Transport};

/// Cells that do not know each other, all with one velocity gradient.
pub(crate) struct Uniform {
    gradient: [[f64; 3]; 3],
    pub(crate) volume: f64,
    pub(crate) distance: Vec<f64>,
    pub(crate) log_slopes: Vec<LogSlope>,
}

impl Uniform {
    pub(crate) fn new(gradient: [[f64; 3]; 3], cells: usize) -> Self {
        Self { gradient, volume: 1.0, distance: vec![f64::INFINITY; cells], log_slopes: Vec::new() }
    }
}

impl Transport for Uniform {
    fn n_cells(&self) -> usize {
        self.distance.len()
    }
    fn cell_volume(&self, _: usize) -> f64 {
        self.volume
    }
    fn wall_distance(&self) -> &[f64] {
        &self.distance
    }
    fn strain_rate(&mut self, out: &mut [f64]) -> Result<(), SolveError> {
        out.fill(crate::Invariants::of(&self.gradient).strain);
        Ok(())
    }
    fn log_slopes(&mut self) -> &[LogSlope] {
        &self.log_slopes
    }
    fn velocity_gradient(&mut self, out: &mut [[[f64; 3]; 3]]) -> Result<(), SolveError> {
        out.fill(self.gradient);
        Ok(())
    }
    fn dot_gradients(&mut self, _: &[f64], _: &[f64], out: &mut [f64]) -> Result<(), SolveError> {
        out.fill(0.0);
        Ok(())
    }
    fn solve(&mut self, e: &Equation<'_>, phi: &mut [f64]) -> Result<SolveInfo, SolveError> {
        let rate = e.dt.map_or(0.0, f64::recip);
        let mut initial_residual = 0.0_f64;
        for (i, phi) in phi.iter_mut().enumerate() {
            let (centre, b) = (e.sink[i] + rate, e.source[i] + rate * *phi);
            initial_residual = initial_residual.max((centre * *phi - b).abs() / b.max(centre * *phi));
            // Relaxed as a_P/α φ = b + (1 − α)/α a_P φ.
            *phi += e.relax * (b / centre - *phi);
        }
        e.pinned.iter().for_each(|&(cell, value)| phi[cell] = value);
        Ok(SolveInfo { iterations: 1, initial_residual, residual: 0.0 })
    }
}
