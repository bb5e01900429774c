//! What segregated algorithms need of the sides.
use super::{Boundaries, FaceKind};

impl<const D: usize> Boundaries<D> {
    /// The velocity through faces of given pressure follows the correction, u −= β ∂φ/∂n with φ = 0 on the side; `phi` is
    /// dense, `beta(axis, dense cell, upper)` is that of the face beside a cell.
    pub(crate) fn correct_each(&mut self, phi: &[f64], beta: impl Fn(usize, usize, bool) -> f64) {
        for (a, (lines, pair)) in self.lines.iter().zip(&mut self.states).enumerate() {
            let Some(pair) = pair else { continue };
            for (upper, state) in pair.iter_mut().enumerate().filter(|(_, s)| s.has_pressure()) {
                let sign = [-1.0, 1.0][upper];
                let width = self.grid.axis(a).width(if upper == 1 { lines.cells - 1 } else { 0 });
                for l in (0..lines.len()).filter(|&l| lines.inside(l)) {
                    if state.kind[l] == FaceKind::Pressure {
                        let cell = lines.end_cell(&self.grid, l, upper == 1);
                        state.normal[l] += sign * beta(a, cell, upper == 1) * 2.0 * phi[cell] / width;
                    }
                }
            }
        }
    }
}
