//! Smagorinsky's model.
use super::check;
use crate::TurbulenceError;
use crate::error::positive;
use interfaces::{Checkpoint, Closure, RestartError, SolveError, Transport, WallRow};

/// Constants of [`Smagorinsky`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmagorinskyConstants {
    /// C_s. Default 0.065, that of channels (Moin & Kim 1982, *J. Fluid Mech.* 118, 341–377); 0.1 to 0.17 without walls (Deardorff 1970,
    /// *J. Fluid Mech.* 41, 453–480; Lilly 1967).
    pub c_s: f64,
    /// A+ of the damping. Default 25 (Moin & Kim 1982).
    pub a_plus: f64,
}

impl Default for SmagorinskyConstants {
    fn default() -> Self {
        Self { c_s: 0.065, a_plus: 25.0 }
    }
}

/// Smagorinsky (1963), damped beside walls as van Driest (1956) has it:
///
/// ```text
/// ν_t = (C_s Δ (1 − e^(−y+/A+)))² |S|,   Δ = V^⅓
/// ```
///
/// y+ is that of the mean friction ν u_t/y of all walls; without walls nothing is damped.
#[derive(Clone, Debug)]
pub struct Smagorinsky {
    constants: SmagorinskyConstants,
    eddy: Vec<f64>,
}

impl Smagorinsky {
    /// The model on `cells` cells.
    ///
    /// # Errors
    /// [`TurbulenceError::Value`].
    pub fn new(constants: SmagorinskyConstants, cells: usize) -> Result<Self, TurbulenceError> {
        positive("C_s", constants.c_s)?;
        positive("A+", constants.a_plus)?;
        Ok(Self { constants, eddy: vec![0.0; cells] })
    }
}

impl Closure for Smagorinsky {
    fn eddy_viscosity(&self) -> Option<&[f64]> {
        Some(&self.eddy)
    }
    fn correct(
        &mut self,
        flow: &mut dyn Transport,
        walls: &[WallRow],
        nu: f64,
        _: Option<f64>,
    ) -> Result<(), SolveError> {
        check(flow, self.eddy.len())?;
        flow.strain_rate(&mut self.eddy)?;
        let [friction, area] =
            walls.iter().fold([0.0; 2], |[f, a], w| [f + w.area * nu * w.u_t / w.y, a + w.area]);
        let unit =
            if area > 0.0 { (friction / area).sqrt() / (nu * self.constants.a_plus) } else { f64::INFINITY };
        let distance = flow.wall_distance();
        for (i, eddy) in self.eddy.iter_mut().enumerate() {
            let damping = -(-distance[i] * unit).exp_m1();
            let length = self.constants.c_s * flow.cell_volume(i).cbrt() * damping;
            *eddy *= length * length;
        }
        Ok(())
    }
}

impl Checkpoint for Smagorinsky {
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
    fn the_eddy_viscosity_is_damped_beside_walls() {
        let mut flow = Uniform::new([[0.0, 3.0, 0.0], [0.0; 3], [0.0; 3]], 2);
        (flow.volume, flow.distance) = (8.0, vec![1e-3, 1e3]);
        let mut model = Smagorinsky::new(SmagorinskyConstants::default(), 2).unwrap();
        model.correct(&mut flow, &[], 0.1, None).unwrap();
        let full = (0.065 * 2.0_f64).powi(2) * 3.0;
        assert!(model.eddy.iter().all(|e| (e - full).abs() < 1e-14));
        // u_τ = 1: y+ = 0.01 and 1e4.
        let wall = WallRow { cell: 0, y: 0.1, area: 2.0, u_t: 1.0, ..WallRow::default() };
        model.correct(&mut flow, &[wall], 0.1, None).unwrap();
        let damped = full * (1.0 - (-0.01_f64 / 25.0).exp()).powi(2);
        assert!((model.eddy[0] / damped - 1.0).abs() < 1e-9 && (model.eddy[1] - full).abs() < 1e-14);
        assert!(model.correct(&mut Uniform::new([[0.0; 3]; 3], 3), &[], 0.1, None).is_err());
        assert!(Smagorinsky::new(SmagorinskyConstants { c_s: -0.1, a_plus: 26.0 }, 2).is_err());
    }
}
