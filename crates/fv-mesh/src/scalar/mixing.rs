//! What eddies do to a scalar.
use super::Scalar;
use super::thermal_law::ThermalLaw;
use crate::field::row_start;
use crate::grid::GHOSTS;
use crate::kernels::{for_rows, row_place};
use crate::metrics::Metrics;
use crate::{CartesianGrid, EddyStress, Field, FlowError};

/// Turbulent Prandtl (or Schmidt) number Pr_t unless told otherwise (Kays 1994, *J. Heat Transfer* 116, 284–295).
pub(super) const USUAL: f64 = 0.85;

/// The eddy diffusivity D_t = ν_t/Pr_t of a scalar.
#[derive(Clone, Debug)]
pub(super) struct Mixing<const D: usize> {
    /// D_t at the centres with its ghosts; half the sum of a ghost and the cell inside is D_t on the side.
    pub(super) diffusivity: Field<D>,
    /// The largest Σ D_t/h² \[1/s\].
    pub(super) rate: f64,
    /// S + ∇·(D_t∇φ).
    pub(super) total: Field<D>,
    law: ThermalLaw,
}

impl<const D: usize> Mixing<D> {
    /// D_t on the faces below and above a cell along axis `b`, linear between the cells beside: storage index and entry in the metrics.
    #[inline(always)]
    pub(super) fn on_faces(
        &self,
        metrics: &Metrics<D>,
        b: usize,
        step: usize,
        o: usize,
        j: usize,
    ) -> [f64; 2] {
        on_faces(&metrics.axes[b].share, self.diffusivity.data(), step, o, j)
    }
}

#[inline(always)]
fn on_faces(share: &[Vec<f64>; 2], eddy: &[f64], step: usize, o: usize, j: usize) -> [f64; 2] {
    let face = |o: usize, j: usize| share[1][j] * eddy[o - step] + share[0][j] * eddy[o];
    [face(o, j), face(o + step, j + 1)]
}

impl<const D: usize> Scalar<D> {
    /// The same with this turbulent Prandtl (or Schmidt) number instead of 0.85.
    ///
    /// # Errors
    /// [`FlowError::Parameter`] for a number that is not positive.
    pub fn with_turbulent_prandtl(mut self, number: f64) -> Result<Self, FlowError> {
        if !(number.is_finite() && number > 0.0) {
            let range = "above 0, 0.85 in most flows";
            return Err(FlowError::Parameter { name: "turbulent Prandtl number", value: number, range });
        }
        self.turbulent_prandtl = number;
        self.mixing = None;
        Ok(self)
    }
    /// Pr_t.
    pub fn turbulent_prandtl(&self) -> f64 {
        self.turbulent_prandtl
    }

    /// From here on the eddies of this model mix the scalar: D_t = ν_t/Pr_t is added to Γ. On walls where the model gives ν_t and the scalar's value is
    /// given, what passes is that of the law of the wall: y+/T+ with
    ///
    /// ```text
    /// T+ = ∫ dy+/(1/Pr + ν_t+/Pr_t),   ν_t+ = 1/(du+/dy+) − 1
    /// ```
    ///
    /// which is Reynolds' analogy where Pr = Pr_t; on other sides of such walls eddies bring nothing. `viscosity` is that of the fluid \[m²/s\].
    pub fn mix(&mut self, eddy: &EddyStress<D>, viscosity: f64) {
        let (gamma, number) = (self.diffusivity, self.turbulent_prandtl);
        let mixing = self.mixing.get_or_insert_with(|| {
            Box::new(Mixing {
                diffusivity: Field::zeros(&self.grid),
                rate: 0.0,
                total: Field::zeros(&self.grid),
                law: ThermalLaw::new(viscosity / gamma, number),
            })
        });
        mixing.rate = eddy.rate / number;
        let (diffusivity, mut law) = (mixing.diffusivity.data_mut(), [[false; 2]; D]);
        diffusivity.iter_mut().zip(eddy.eddy.data()).for_each(|(d, nu)| *d = nu / number);
        for wall in &eddy.walls {
            // What lies behind the wall is as much above the value as what lies before it is below.
            let factor = self.boundaries.ends(wall.axis).map_or(0.0, |e| e.factor[wall.end][wall.line]);
            let given = factor < -1.0 + 1e-12;
            law[wall.axis][wall.end] |= given;
            let on_wall = match given {
                true if viscosity > 0.0 => viscosity * mixing.law.ratio(1.0 + wall.eddy / viscosity) - gamma,
                true => wall.eddy / number,
                false => 0.0,
            };
            diffusivity[wall.ghost] = 2.0 * on_wall - diffusivity[wall.inside];
        }
        self.carrier.set_law(&self.metrics, law);
    }

    /// Brings S + ∇·(D_t∇φ) up to date.
    pub(super) fn stir(&mut self) {
        let Some(mixing) = self.mixing.as_deref_mut() else { return };
        let eddy = mixing.diffusivity.data();
        stirred(&self.grid, &self.metrics, self.phi.data(), eddy, self.source.as_ref(), &mut mixing.total);
    }
}

/// What is added to convection and diffusion, if anything is.
pub(super) fn sources<'a, const D: usize>(
    mixing: &'a Option<Box<Mixing<D>>>,
    source: &'a Option<Field<D>>,
) -> Option<&'a [f64]> {
    mixing.as_ref().map(|m| &m.total).or(source.as_ref()).map(Field::data)
}

/// out = S + ∇·(D_t∇φ).
fn stirred<const D: usize>(
    grid: &CartesianGrid<D>,
    metrics: &Metrics<D>,
    phi: &[f64],
    eddy: &[f64],
    source: Option<&Field<D>>,
    out: &mut Field<D>,
) {
    let (n, s) = (grid.cells()[0], grid.stride());
    for_rows(grid, out, |rows, start, out| {
        for r in rows {
            let (first, at) = (row_start(grid, r), row_place(grid, r));
            let out = &mut out[first - start..][..n];
            match source {
                Some(source) => out.copy_from_slice(&source.data()[first..][..n]),
                None => out.fill(0.0),
            }
            for b in 0..D {
                let (nodes, share) = (&metrics.axes[b].centres, &metrics.axes[b].share);
                for (i, out) in out.iter_mut().enumerate() {
                    let (o, j) = (first + i, GHOSTS + if b == 0 { i } else { at[b] });
                    let [below, above] = on_faces(share, eddy, s[b], o, j);
                    *out += nodes.up[j] * above * (phi[o + s[b]] - phi[o])
                        - nodes.down[j] * below * (phi[o] - phi[o - s[b]]);
                }
            }
        }
    });
}
