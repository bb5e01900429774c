//! Immersed walls that cut the cells.
mod check;
mod links;
mod pressure;
mod recent;
mod regions;
#[cfg(test)]
mod tests;

pub(crate) use check::check;
pub use pressure::InverseOutlook;

use crate::boundary::Boundaries;
use crate::metrics::Metrics;
use crate::{CartesianGrid, Field};
use interfaces::{CutWalls, RestartError, Wrench};
use links::Links;
use pressure::CutPressure;

/// Walls in a flow, and what they did to it in the last step.
pub(crate) struct Walls<const D: usize> {
    pub(crate) cuts: CutWalls,
    links: [Links<D>; D],
    pub(crate) pressure: CutPressure,
    /// Impulse of the fluid on each body in the last step \[N s, N m s\].
    pub(crate) impulses: Vec<Wrench>,
    /// Velocities of the faces' nodes while the faces carry the flux, that flux otherwise.
    nodes: [Vec<f64>; D],
    /// Whether the fluxes in `nodes` are those that the last projection made free of divergence.
    pub(crate) projected: bool,
}

/// One step's numbers.
#[derive(Clone, Copy)]
pub(crate) struct Step {
    pub(crate) dt: f64,
    /// Weights of the new and the last tendency.
    pub(crate) weights: [f64; 2],
    pub(crate) viscosity: f64,
    pub(crate) density: f64,
}

impl<const D: usize> Walls<D> {
    /// Walls that [`check`] has found to be of this grid.
    pub(crate) fn new(
        cuts: CutWalls,
        grid: &CartesianGrid<D>,
        metrics: &Metrics<D>,
        boundaries: &Boundaries<D>,
    ) -> Self {
        let mut pressure = CutPressure::new(&cuts, grid, metrics, boundaries);
        pressure.prepare(grid.n_cells());
        Self {
            links: std::array::from_fn(|c| Links::new(&cuts.components[c], grid, metrics, c)),
            pressure,
            impulses: vec![Wrench::default(); cuts.n_bodies],
            nodes: std::array::from_fn(|c| vec![0.0; cuts.components[c].faces.len()]),
            projected: false,
            cuts,
        }
    }

    /// Tells the nodes inside the solid its velocity; there is no pressure in it.
    pub(crate) fn start(&self, velocity: &mut [Field<D>; D], pressure: &mut Field<D>) {
        self.pressure.start(pressure);
        for (component, u) in self.cuts.components.iter().zip(velocity) {
            component.solid.iter().for_each(|point| u.data_mut()[point.index] = point.velocity);
        }
    }

    /// Corrects the new velocity at the nodes that the walls touch: their viscous terms along cut links, and the solid's own
    /// velocity inside; sums the impulses that this took.
    pub(crate) fn hold(&mut self, step: Step, old: &[Field<D>; D], next: &mut [Field<D>; D]) {
        self.impulses.fill(Wrench::default());
        for (c, component) in self.cuts.components.iter().enumerate().take(D) {
            self.links[c].hold(component, step, old[c].data(), next[c].data_mut(), &mut self.impulses);
        }
        self.hold_solid(step.density, next);
    }

    /// Gives the nodes inside the solid its velocity again, and counts the impulse.
    pub(crate) fn hold_solid(&mut self, density: f64, velocity: &mut [Field<D>; D]) {
        for (c, component) in self.cuts.components.iter().enumerate().take(D) {
            self.links[c].hold_solid(component, density, velocity[c].data_mut(), &mut self.impulses);
        }
    }

    /// Gives the faces the flux that passes through them.
    pub(crate) fn show_fluxes(&mut self, velocity: &mut [Field<D>; D]) {
        for (c, component) in velocity.iter_mut().enumerate() {
            let faces = &self.cuts.components[c].faces;
            let u = component.data_mut();
            for (flux, face) in self.nodes[c].iter_mut().zip(faces) {
                *flux = face.mean_velocity(u);
            }
            self.swap(c, u);
        }
    }

    /// Gives the nodes of the faces their velocity back.
    pub(crate) fn show_nodes(&mut self, velocity: &mut [Field<D>; D]) {
        for (c, component) in velocity.iter_mut().enumerate() {
            self.swap(c, component.data_mut());
        }
    }

    /// Corrects the fluxes through the faces by `answer` = dt/ρ times the gradient of `phi` on the open part.
    pub(crate) fn project(&mut self, answer: f64, phi: &[f64]) {
        for (c, fluxes) in self.nodes.iter_mut().enumerate() {
            for (flux, slope) in fluxes.iter_mut().zip(self.pressure.gradients(c, phi)) {
                *flux -= answer * slope;
            }
        }
        self.projected = true;
    }

    /// Gives the faces the flux whose divergence the last projection removed; without one the flux of
    /// the velocity.
    pub(crate) fn show_conserved(&self, velocity: &mut [Field<D>; D]) {
        for (c, component) in velocity.iter_mut().enumerate() {
            let u = component.data_mut();
            let faces = &self.cuts.components[c].faces;
            let fluxes = match self.projected {
                true => self.nodes[c].clone(),
                false => faces.iter().map(|face| face.mean_velocity(u)).collect(),
            };
            faces.iter().zip(fluxes).for_each(|(face, flux)| u[face.index] = flux);
        }
    }

    fn swap(&mut self, c: usize, u: &mut [f64]) {
        for (value, face) in self.nodes[c].iter_mut().zip(&self.cuts.components[c].faces) {
            std::mem::swap(value, &mut u[face.index]);
        }
    }

    /// Hands what a step takes from the last one to `sink`.
    pub(crate) fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        for (c, links) in self.links.iter().enumerate() {
            sink(&format!("walls{c}"), &links.plain);
            sink(&format!("walls fluxes{c}"), &self.nodes[c]);
        }
        sink("walls projected", &[f64::from(u8::from(self.projected))]);
        sink("walls", &self.pressure.missing);
        sink("walls iterations", &[self.pressure.all_iterations as f64]);
        if let Some(recent) = &self.pressure.recent {
            recent.save(sink);
        }
    }

    /// Takes back what [`save`](Self::save) gave.
    pub(crate) fn restore<'a>(
        &mut self,
        source: &dyn Fn(&str) -> Option<&'a [f64]>,
    ) -> Result<(), RestartError> {
        self.projected = false;
        for (c, links) in self.links.iter_mut().enumerate() {
            RestartError::fill(source, &format!("walls{c}"), &mut links.plain)?;
            RestartError::fill(source, &format!("walls fluxes{c}"), &mut self.nodes[c])?;
        }
        self.projected = RestartError::take(source, "walls projected", 1)?[0] != 0.0;
        RestartError::fill(source, "walls", &mut self.pressure.missing)?;
        self.pressure.restore_iterations(source)
    }
}
