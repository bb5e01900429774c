//! Differential operators on fields of cell-centred values: explicit, second order on uniform and smoothly stretched
//! grids.
//!
//! [`Operators`] belong to a grid whose periodic axes are known. They read the first ghost layer, which
//! [`ScalarBoundaries`](crate::ScalarBoundaries) fills; convection reads the second on periodic axes, too. Results are
//! written to the cells (or faces) of the field given; its ghosts are left alone. Values on faces are stored as those of
//! a [`Velocity`]: component c of cell (i, j, k) is on its lower c-face, and the last face of an axis is in the ghost
//! behind the last cell.
//!
//! | | formula of cell P with width h, faces l and u |
//! |---|---|
//! | [`gradient`](Operators::gradient) | ∂φ/∂x_c = (φ_u − φ_l)/h_c, φ_f interpolated linearly |
//! | [`face_gradient`](Operators::face_gradient) | (φ_P − φ_N)/(x_P − x_N) |
//! | [`divergence`](Operators::divergence) | Σ_c (F_u − F_l)/h_c |
//! | [`laplacian`](Operators::laplacian) | Γ times the divergence of the face gradient |
//! | [`variable_laplacian`](Operators::variable_laplacian) | divergence of Γ_f times the face gradient |
//! | [`convection`](Operators::convection) | −Σ_c (u_u φ_u − u_l φ_l)/h_c by a [`Convection`] scheme |
//! | [`velocity_gradient`](Operators::velocity_gradient) | ∂u_a/∂x_b of the velocity interpolated to the centres |
//! | [`strain_rate`](Operators::strain_rate) | √(2 S:S), S = ½(∇u + ∇uᵀ) |
//!
//! **Beside bounded sides.** A ghost mirrors the cell inside. Where the gradient is given this costs no order. Where the
//! value is given it is a linear extrapolation, so that in the cell beside the side the gradient is of first order and
//! the Laplacian's truncation error does not vanish; solutions of diffusion problems are of second order all the same
//! (the flux through the side is of first order, in a layer as thin as the cell).
//!
//! ```
//! use fv_mesh::{CartesianGrid, Field, ScalarBoundaries, ScalarSide, operators::Operators};
//! use std::f64::consts::TAU;
//! let grid = CartesianGrid::new([64, 4], [TAU, 1.0])?;
//! let sides = ScalarBoundaries::new(&grid, ScalarSide::Periodic.everywhere())?;
//! let ops = Operators::new(&grid, sides.periodic());
//! let mut phi = Field::from_fn(&grid, |x| x[0].sin());
//! sides.fill(&mut phi)?;
//! let mut curvature = Field::zeros(&grid);
//! ops.laplacian(1.0, &phi, &mut curvature)?;
//! for (second, value) in curvature.values().zip(phi.values()) {
//!     assert!((second + value).abs() < 1e-3);
//! }
//! # Ok::<(), fv_mesh::FlowError>(())
//! ```
mod convection;
mod rows;
mod strain;
#[cfg(test)]
pub(crate) mod tests;
mod weighted;

pub(crate) use convection::{CENTRAL, Carried, Carrier, with_kind};
pub(crate) use rows::{RowKernel, fill_dense};
pub(crate) use strain::StrainRate;

use crate::grid::GHOSTS;
use crate::metrics::Metrics;
use crate::spans::Spans;
use crate::{CartesianGrid, Convection, Field, FlowError, Velocity};
use convection::{Convect, Steepness};
use rows::fill_rows;
use weighted::{Divergence, Laplacian, VariableLaplacian, Weighted};

/// The operators of a grid. See the [module](self).
#[derive(Clone, Debug)]
pub struct Operators<const D: usize> {
    grid: CartesianGrid<D>,
    metrics: Metrics<D>,
    /// Weights along each axis: of the centred difference (below, here, above), …
    centred: [[Vec<f64>; 3]; D],
    /// … of half of it, …
    half_centred: [[Vec<f64>; 3]; D],
    /// … and of the differences over a face and over a cell.
    face_difference: [[Vec<f64>; 2]; D],
    cell_difference: [[Vec<f64>; 2]; D],
    half: Vec<f64>,
    /// Per scheme of [`Convection::ALL`].
    carriers: [Carrier<D>; 5],
    /// Of the cells for which something is computed.
    spans: Spans,
}

impl<const D: usize> Operators<D> {
    /// The operators of `grid`, whose axes are `periodic` or bounded.
    pub fn new(grid: &CartesianGrid<D>, periodic: [bool; D]) -> Self {
        let metrics = Metrics::new(grid, periodic);
        let centred: [[Vec<f64>; 3]; D] = std::array::from_fn(|a| centred_weights(&metrics, a));
        let scaled = |lists: &[Vec<f64>; 3], f: f64| {
            lists.each_ref().map(|l| l.iter().map(|w| f * w).collect::<Vec<_>>())
        };
        let opposite = |list: &[f64]| [list.iter().map(|w| -w).collect(), list.to_vec()];
        let longest = grid.cells().into_iter().max().unwrap_or(0) + 2 * GHOSTS;
        Self {
            half_centred: centred.each_ref().map(|lists| scaled(lists, 0.5)),
            face_difference: std::array::from_fn(|a| opposite(&metrics.axes[a].centres.inv_gap)),
            cell_difference: std::array::from_fn(|a| opposite(&metrics.axes[a].centres.inv_volume)),
            half: vec![0.5; longest],
            carriers: Convection::ALL.map(|scheme| Carrier::new(&metrics, scheme)),
            spans: Spans::default(),
            centred,
            metrics,
            grid: grid.clone(),
        }
    }

    /// The grid.
    pub fn grid(&self) -> &CartesianGrid<D> {
        &self.grid
    }

    /// ∂φ/∂x_c at the centres.
    ///
    /// # Errors
    /// [`FlowError::OtherGrid`] for fields of another grid, [`FlowError::Grid`] for an axis that is not there.
    pub fn gradient(&self, phi: &Field<D>, c: usize, out: &mut Field<D>) -> Result<(), FlowError> {
        self.check(&[phi, out])?;
        self.check_axis(c)?;
        let s = self.grid.stride()[c] as isize;
        self.weighted(phi, c, [-s, 0, s], self.centred[c].each_ref(), self.grid.cells(), out);
        Ok(())
    }

    /// ∂φ/∂x_c on the faces normal to axis c, for all c.
    ///
    /// # Errors
    /// As [`gradient`](Self::gradient).
    pub fn face_gradient(&self, phi: &Field<D>, out: &mut [Field<D>; D]) -> Result<(), FlowError> {
        self.check(&[phi])?;
        self.check(&out.each_ref())?;
        for (c, out) in out.iter_mut().enumerate() {
            let s = self.grid.stride()[c] as isize;
            self.weighted(phi, c, [-s, 0], self.face_difference[c].each_ref(), self.faces(c), out);
        }
        Ok(())
    }

    /// φ on the faces normal to axis `c`, interpolated linearly.
    ///
    /// # Errors
    /// As [`gradient`](Self::gradient).
    pub fn to_faces(&self, phi: &Field<D>, c: usize, out: &mut Field<D>) -> Result<(), FlowError> {
        self.check(&[phi, out])?;
        self.check_axis(c)?;
        let s = self.grid.stride()[c] as isize;
        // Each centre by the other cell's share of the distance.
        let [below, above] = &self.metrics.axes[c].share;
        self.weighted(phi, c, [-s, 0], [above, below], self.faces(c), out);
        Ok(())
    }

    /// The mean of the values on the lower and upper c-face of each cell.
    ///
    /// # Errors
    /// As [`gradient`](Self::gradient).
    pub fn to_centres(&self, faces: &Field<D>, c: usize, out: &mut Field<D>) -> Result<(), FlowError> {
        self.check(&[faces, out])?;
        self.check_axis(c)?;
        let s = self.grid.stride()[c] as isize;
        self.weighted(faces, c, [0, s], [&self.half, &self.half], self.grid.cells(), out);
        Ok(())
    }

    /// ∇·F of the face values F, `faces[c]` those on the faces normal to axis c.
    ///
    /// # Errors
    /// As [`gradient`](Self::gradient).
    pub fn divergence(&self, faces: &[Field<D>; D], out: &mut Field<D>) -> Result<(), FlowError> {
        self.check(&faces.each_ref())?;
        self.check(&[out])?;
        let faces = faces.each_ref().map(Field::data);
        let kernel = Divergence { grid: &self.grid, metrics: &self.metrics, faces };
        fill_rows(&self.grid, self.grid.cells(), &self.spans, &kernel, out);
        Ok(())
    }

    /// Γ ∇²φ with the same Γ = `gamma` everywhere.
    ///
    /// # Errors
    /// As [`gradient`](Self::gradient).
    pub fn laplacian(&self, gamma: f64, phi: &Field<D>, out: &mut Field<D>) -> Result<(), FlowError> {
        self.check(&[phi, out])?;
        let kernel = Laplacian { grid: &self.grid, metrics: &self.metrics, gamma, phi: phi.data() };
        fill_rows(&self.grid, self.grid.cells(), &self.spans, &kernel, out);
        Ok(())
    }

    /// ∇·(Γ∇φ) with Γ = `gamma` at the centres, interpolated linearly to the faces. Its ghosts count: on a side it is the
    /// mean of ghost and cell.
    ///
    /// # Errors
    /// As [`gradient`](Self::gradient).
    pub fn variable_laplacian(
        &self,
        gamma: &Field<D>,
        phi: &Field<D>,
        out: &mut Field<D>,
    ) -> Result<(), FlowError> {
        self.check(&[gamma, phi, out])?;
        let kernel = VariableLaplacian { grid: &self.grid, metrics: &self.metrics, gamma, phi: phi.data() };
        fill_rows(&self.grid, self.grid.cells(), &self.spans, &kernel, out);
        Ok(())
    }

    /// −∇·(uφ) by `scheme`. On a bounded side the face value is the mean of ghost and cell, whatever the scheme.
    ///
    /// # Errors
    /// As [`gradient`](Self::gradient).
    pub fn convection(
        &self,
        velocity: &Velocity<D>,
        phi: &Field<D>,
        scheme: Convection,
        out: &mut Field<D>,
    ) -> Result<(), FlowError> {
        self.check(&velocity.components.each_ref())?;
        self.check(&[phi, out])?;
        let carried = self.carried(velocity, phi, scheme);
        with_kind!(carried.carrier, KIND => {
            fill_rows(&self.grid, self.grid.cells(), &self.spans, &Convect::<KIND, D>(carried), out);
        });
        Ok(())
    }

    /// How fast what [`Convection::Limited`] takes out of every cell beyond what [`Convection::Upwind`] does grows with φ there, where it
    /// does \[1/s\].
    pub(crate) fn steepness(&self, velocity: &Velocity<D>, phi: &Field<D>, out: &mut [f64]) {
        let carried = self.carried(velocity, phi, Convection::Limited);
        fill_dense(&self.grid, &self.spans, &Steepness(carried), out);
    }

    fn carried<'a>(
        &'a self,
        velocity: &'a Velocity<D>,
        phi: &'a Field<D>,
        scheme: Convection,
    ) -> Carried<'a, D> {
        let carrier = &self.carriers[Convection::ALL.iter().position(|&s| s == scheme).unwrap_or(0)];
        let (velocity, phi) = (&velocity.components, phi.data());
        Carried { carrier, grid: &self.grid, metrics: &self.metrics, velocity, phi }
    }

    /// ∂u_a/∂x_b at the centres: over the cell for a = b, else the centred difference of the mean of both faces.
    ///
    /// # Errors
    /// As [`gradient`](Self::gradient).
    pub fn velocity_gradient(
        &self,
        velocity: &Velocity<D>,
        [a, b]: [usize; 2],
        out: &mut Field<D>,
    ) -> Result<(), FlowError> {
        self.check_axis(a)?;
        self.check_axis(b)?;
        let u = &velocity.components[a];
        self.check(&[u, out])?;
        let s = self.grid.stride();
        let (f, t) = (s[a] as isize, s[b] as isize);
        if a == b {
            self.weighted(u, a, [0, f], self.cell_difference[a].each_ref(), self.grid.cells(), out);
        } else {
            let [below, here, above] = &self.half_centred[b];
            let distances = [-t, f - t, 0, f, t, f + t];
            self.weighted(u, b, distances, [below, below, here, here, above, above], self.grid.cells(), out);
        }
        Ok(())
    }

    /// |S| = √(2 S:S) at the centres \[1/s\], S = ½(∇u + ∇uᵀ).
    ///
    /// # Errors
    /// As [`gradient`](Self::gradient).
    pub fn strain_rate(&self, velocity: &Velocity<D>, out: &mut Field<D>) -> Result<(), FlowError> {
        self.check(&velocity.components.each_ref())?;
        self.check(&[out])?;
        let kernel = self.strain_kernel(&velocity.components);
        fill_rows(&self.grid, self.grid.cells(), &self.spans, &kernel, out);
        Ok(())
    }

    /// The kernel of [`strain_rate`](Self::strain_rate).
    pub(crate) fn strain_kernel<'a>(&'a self, velocity: &'a [Field<D>; D]) -> StrainRate<'a, D> {
        StrainRate { grid: &self.grid, metrics: &self.metrics, centred: &self.centred, velocity }
    }

    /// Outside of `spans` the values of cells are left alone from now on.
    pub(crate) fn set_spans(&mut self, spans: Spans) {
        self.spans = spans;
    }
    pub(crate) fn spans(&self) -> &Spans {
        &self.spans
    }
    /// The dense numbers of the cells for which something is computed, row by row.
    pub(crate) fn cells(&self) -> impl Iterator<Item = std::ops::Range<usize>> + '_ {
        let n = self.grid.cells()[0];
        self.spans.rows(n, self.grid.n_cells() / n)
    }

    /// The distances.
    pub(crate) fn metrics(&self) -> &Metrics<D> {
        &self.metrics
    }
    /// Weights of the centred difference along each axis: below, here, above.
    pub(crate) fn centred(&self) -> &[[Vec<f64>; 3]; D] {
        &self.centred
    }

    /// Σ_P V_P φ_P in the order of the cells.
    ///
    /// # Errors
    /// As [`gradient`](Self::gradient).
    pub fn integral(&self, phi: &Field<D>) -> Result<f64, FlowError> {
        self.check(&[phi])?;
        Ok(integral(&self.grid, &self.metrics, phi))
    }

    fn weighted<const N: usize>(
        &self,
        phi: &Field<D>,
        axis: usize,
        distance: [isize; N],
        weight: [&Vec<f64>; N],
        extent: [usize; D],
        out: &mut Field<D>,
    ) {
        let kernel = Weighted { phi: phi.data(), axis, distance, weight: weight.map(Vec::as_slice) };
        let everywhere = Spans::default();
        let spans = if extent == self.grid.cells() { &self.spans } else { &everywhere };
        fill_rows(&self.grid, extent, spans, &kernel, out);
    }

    /// Faces normal to axis `c` along each axis.
    fn faces(&self, c: usize) -> [usize; D] {
        let n = self.grid.cells();
        std::array::from_fn(|a| n[a] + usize::from(a == c))
    }

    fn check(&self, fields: &[&Field<D>]) -> Result<(), FlowError> {
        fields.iter().try_for_each(|f| f.check(&self.grid))
    }

    fn check_axis(&self, c: usize) -> Result<(), FlowError> {
        if c < D {
            return Ok(());
        }
        Err(FlowError::Grid { what: format!("a derivative along axis {c}; give one below {D}") })
    }
}

/// Σ_P V_P φ_P.
pub(crate) fn integral<const D: usize>(grid: &CartesianGrid<D>, metrics: &Metrics<D>, phi: &Field<D>) -> f64 {
    let widths = &metrics.axes[0].centres.volume[GHOSTS..];
    (0..phi.n_rows())
        .map(|r| {
            let at = crate::kernels::row_place(grid, r);
            let across: f64 = (1..D).map(|b| metrics.axes[b].centres.volume[GHOSTS + at[b]]).product();
            across * phi.row(r).iter().zip(widths).map(|(phi, width)| phi * width).sum::<f64>()
        })
        .sum()
}

/// Weights of (φ_u − φ_l)/h, φ on both faces interpolated linearly: below, here, above.
fn centred_weights<const D: usize>(metrics: &Metrics<D>, a: usize) -> [Vec<f64>; 3] {
    let axis = &metrics.axes[a];
    let ([below, above], inv) = (&axis.share, &axis.centres.inv_volume);
    let next = |i: usize| (i + 1).min(inv.len() - 1);
    [
        (0..inv.len()).map(|i| -inv[i] * above[i]).collect(),
        (0..inv.len()).map(|i| inv[i] * (above[next(i)] - below[i])).collect(),
        (0..inv.len()).map(|i| inv[i] * below[next(i)]).collect(),
    ]
}
