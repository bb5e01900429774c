//! How far a staggered velocity is from a function.
use super::{Integrals, Norms};
use crate::algebra::{GridMismatch, check_grid};
use crate::{CartesianGrid, Velocity};
use interfaces::VelocityField;

impl<const D: usize> Integrals<D> {
    /// Norms of the difference of `velocity` to the function `exact` \[m/s\], on the faces where its components are unknown (all
    /// but those on bounded sides), each weighted with its control volume: from the middle of the cell below to that of the
    /// cell above. With the mean ⟨·⟩_c over those of component c, `l1` is Σ_c ⟨|u_c − exact_c|⟩_c, `l2` the root mean square of
    /// the vector √(Σ_c ⟨(u_c − exact_c)²⟩_c), and `linf` the largest |u_c − exact_c|. A component without unknowns counts
    /// as zero.
    ///
    /// ```
    /// use fv_mesh::{CartesianGrid, Fluid, Integrals, Projection, Side};
    /// use std::f64::consts::TAU;
    ///
    /// let grid = CartesianGrid::new([16, 16], [TAU, TAU])?;
    /// let water = Fluid { density: 1000.0, viscosity: 1e-6 };
    /// let mut flow = Projection::new(grid, Side::Periodic.everywhere(), water)?;
    /// let vortices = |x: [f64; 2]| [-x[0].cos() * x[1].sin(), x[0].sin() * x[1].cos()];
    /// flow.set_velocity(vortices);
    /// let over = Integrals::new(flow.grid());
    /// assert_eq!(over.velocity_norms(flow.velocity(), vortices)?.linf, 0.0);
    /// // Of the velocity itself: ⟨u²⟩ + ⟨v²⟩ = ½.
    /// assert!((over.velocity_norms(flow.velocity(), |_| [0.0; 2])?.l2 - 0.5_f64.sqrt()).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`GridMismatch`] if the velocity lives on another grid.
    pub fn velocity_norms(
        &self,
        velocity: &Velocity<D>,
        exact: impl Fn([f64; D]) -> [f64; D],
    ) -> Result<Norms, GridMismatch> {
        let grid = self.grid();
        check_grid(grid, velocity.field(0).grid())?;
        let (mut l1, mut square, mut linf) = (0.0, 0.0, 0.0_f64);
        for c in 0..D {
            let (mut sums, mut volume) = ([0.0; 2], 0.0);
            let periodic = velocity.lattice(c).axes[c].is_periodic();
            for (index, u) in velocity.field(c).values().enumerate() {
                let cell = grid.cell(index);
                let Some(weight) = control_volume(grid, c, cell, periodic) else { continue };
                let mut x = grid.centre(cell);
                x[c] = grid.axis(c).faces()[cell[c]];
                let error = (u - exact(x)[c]).abs();
                sums = [sums[0] + weight * error, sums[1] + weight * error * error];
                volume += weight;
                // Passes on what is not a number.
                linf = if error > linf || error.is_nan() { error } else { linf };
            }
            if volume > 0.0 {
                l1 += sums[0] / volume;
                square += sums[1] / volume;
            }
        }
        Ok(Norms { l1, l2: square.sqrt(), linf })
    }
}

/// That of the lower face of `cell` along axis `c`; `None` on a bounded side.
fn control_volume<const D: usize>(
    grid: &CartesianGrid<D>,
    c: usize,
    cell: [usize; D],
    periodic: bool,
) -> Option<f64> {
    let axis = grid.axis(c);
    let below = match cell[c] {
        0 if periodic => axis.cells() - 1,
        i => i.checked_sub(1)?,
    };
    let along = 0.5 * (axis.width(below) + axis.width(cell[c]));
    Some(grid.cell_volume(cell) / axis.width(cell[c]) * along)
}
