//! The WALE model.
use super::check;
use crate::TurbulenceError;
use crate::error::positive;
use interfaces::{Checkpoint, Closure, RestartError, SolveError, Transport, WallRow};

/// Constants of [`Wale`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaleConstants {
    /// C_w. Default 0.325; the paper has 0.5 for decaying turbulence.
    pub c_w: f64,
}

impl Default for WaleConstants {
    fn default() -> Self {
        Self { c_w: 0.325 }
    }
}

/// The wall-adapting model of Nicoud & Ducros (1999, *Flow Turbul. Combust.* 62, 183–200):
///
/// ```text
/// ν_t = (C_w Δ)² (S^d:S^d)^(3/2)/((S:S)^(5/2) + (S^d:S^d)^(5/4)),   Δ = V^⅓
/// S^d = ½(g² + (gᵀ)²) − ⅓ I tr g²,   g = ∇u
/// ```
///
/// It vanishes in pure shear, and as y³ beside walls.
#[derive(Clone, Debug)]
pub struct Wale {
    constants: WaleConstants,
    gradient: Vec<[[f64; 3]; 3]>,
    eddy: Vec<f64>,
}

impl Wale {
    /// The model on `cells` cells.
    ///
    /// # Errors
    /// [`TurbulenceError::Value`].
    pub fn new(constants: WaleConstants, cells: usize) -> Result<Self, TurbulenceError> {
        positive("C_w", constants.c_w)?;
        Ok(Self { constants, gradient: vec![[[0.0; 3]; 3]; cells], eddy: vec![0.0; cells] })
    }
}

/// (S^d:S^d)^(3/2)/((S:S)^(5/2) + (S^d:S^d)^(5/4)) \[1/s\].
fn rate(g: &[[f64; 3]; 3]) -> f64 {
    let mut square = [[0.0; 3]; 3];
    for (a, row) in square.iter_mut().enumerate() {
        for (b, sum) in row.iter_mut().enumerate() {
            *sum = (0..3).map(|c| g[a][c] * g[c][b]).sum();
        }
    }
    let trace = (square[0][0] + square[1][1] + square[2][2]) / 3.0;
    let (mut ss, mut dd) = (0.0, 0.0);
    for a in 0..3 {
        for b in 0..3 {
            let s = 0.5 * (g[a][b] + g[b][a]);
            let d = 0.5 * (square[a][b] + square[b][a]) - if a == b { trace } else { 0.0 };
            ss += s * s;
            dd += d * d;
        }
    }
    let below = ss * ss * ss.sqrt() + dd * dd.sqrt().sqrt();
    if below > 0.0 { dd * dd.sqrt() / below } else { 0.0 }
}

impl Closure for Wale {
    fn eddy_viscosity(&self) -> Option<&[f64]> {
        Some(&self.eddy)
    }
    fn correct(
        &mut self,
        flow: &mut dyn Transport,
        _: &[WallRow],
        _: f64,
        _: Option<f64>,
    ) -> Result<(), SolveError> {
        check(flow, self.eddy.len())?;
        flow.velocity_gradient(&mut self.gradient)?;
        for (i, (eddy, g)) in self.eddy.iter_mut().zip(&self.gradient).enumerate() {
            let length = self.constants.c_w * flow.cell_volume(i).cbrt();
            *eddy = length * length * rate(g);
        }
        Ok(())
    }
}

impl Checkpoint for Wale {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        sink("eddy", &self.eddy);
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        RestartError::fill(source, "eddy", &mut self.eddy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Uniform;

    #[test]
    fn shear_makes_no_eddies_and_rotation_does() {
        let shear = [[0.0, 2.0, 0.0], [0.0; 3], [0.0; 3]];
        assert_eq!(rate(&shear), 0.0);
        // Solid rotation w: g² = −w² on two diagonal entries, S^d = −w²(1, 1, −2)/3, S^d:S^d = 2w⁴/3.
        let w = 1.5_f64;
        let turn = [[0.0, -w, 0.0], [w, 0.0, 0.0], [0.0; 3]];
        assert!((rate(&turn) - (2.0 / 3.0 * w.powi(4)).powf(0.25)).abs() < 1e-13);
        assert_eq!(rate(&[[0.0; 3]; 3]), 0.0);
        let mut model = Wale::new(WaleConstants::default(), 1).unwrap();
        let mut flow = Uniform::new(turn, 1);
        flow.volume = 0.008;
        model.correct(&mut flow, &[], 0.1, None).unwrap();
        assert!((model.eddy[0] / (0.065_f64.powi(2) * rate(&turn)) - 1.0).abs() < 1e-12);
        assert!(Wale::new(WaleConstants { c_w: f64::NAN }, 1).is_err());
    }
}
