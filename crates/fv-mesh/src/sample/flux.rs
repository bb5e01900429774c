//! Integrals over planes normal to an axis.
use super::{Quantity, SampleError, Sampler};
use crate::{Field, Velocity};

impl<const D: usize> Sampler<D> {
    /// ∫ u·n dA through the plane x_axis = `at` \[m³/s\] (plane grid: m²/s), n along the axis. As the velocity is
    /// interpolated between the faces of cells that conserve mass, it is the flux itself, not an estimate.
    ///
    /// # Errors
    /// [`SampleError::Axis`], [`SampleError::Outside`], [`SampleError::Grid`].
    pub fn flux(&self, velocity: &Velocity<D>, axis: usize, at: f64) -> Result<f64, SampleError> {
        self.over_plane(velocity.into(), axis, at, |q, x| self.component(q, axis, x))
    }

    /// ∫ φ dA over the plane x_axis = `at`, midpoint rule: second order.
    ///
    /// # Errors
    /// Those of [`flux`](Self::flux).
    pub fn surface_integral(&self, field: &Field<D>, axis: usize, at: f64) -> Result<f64, SampleError> {
        self.over_plane(field.into(), axis, at, |q, x| self.component(q, 0, x))
    }

    /// ∫ φ u·n dA through the plane x_axis = `at`: the convective flux of φ, second order.
    ///
    /// # Errors
    /// Those of [`flux`](Self::flux).
    pub fn convective_flux(
        &self,
        field: &Field<D>,
        velocity: &Velocity<D>,
        axis: usize,
        at: f64,
    ) -> Result<f64, SampleError> {
        let scalar = Quantity::from(field);
        self.check(&scalar)?;
        self.over_plane(velocity.into(), axis, at, |q, x| {
            self.component(&scalar, 0, x) * self.component(q, axis, x)
        })
    }

    fn over_plane(
        &self,
        quantity: Quantity<'_, D>,
        axis: usize,
        at: f64,
        f: impl Fn(&Quantity<'_, D>, [f64; D]) -> f64,
    ) -> Result<f64, SampleError> {
        let plane = self.plane(axis, at)?;
        self.check(&quantity)?;
        let mut cells = self.grid().cells();
        cells[axis] = 1;
        let area = |mut index: usize| -> f64 {
            let mut area = 1.0;
            for a in 0..D {
                if a != axis {
                    area *= self.grid().axis(a).width(index % cells[a]);
                }
                index /= cells[a];
            }
            area
        };
        Ok(plane.points().enumerate().map(|(i, x)| area(i) * f(&quantity, x)).sum())
    }
}
