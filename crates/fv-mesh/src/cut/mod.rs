//! Immersed walls that cut the cells.
mod links;
mod pressure;
mod regions;

#[cfg(test)]
mod tests;

use crate::flow_state::{FlowState, restore_list};
use crate::metrics::Metrics;
use crate::{CartesianGrid, Field, FlowError};
use interfaces::{CutComponent, CutWalls, RestartError, Wrench};
use links::Links;
pub(crate) use pressure::CutPressure;

/// Walls in a flow, and what they did to it in the last step.
pub(crate) struct Walls<const D: usize> {
    pub(crate) cuts: CutWalls,
    pub(crate) links: [Links<D>; D],
    pub(crate) pressure: CutPressure,
    /// Impulse of the fluid on each body in the last step \[N s, N m s\].
    pub(crate) impulses: Vec<Wrench>,
    /// Velocities of the faces' nodes while the faces carry the flux.
    nodes: [Vec<f64>; D],
}

impl<const D: usize> Walls<D> {
    /// # Errors
    /// [`FlowError::Parameter`] for cuts of another grid.
    pub(crate) fn new(
        cuts: CutWalls,
        grid: &CartesianGrid<D>,
        metrics: &Metrics<D>,
    ) -> Result<Self, FlowError> {
        check(&cuts, grid, metrics)?;
        Ok(Self {
            links: std::array::from_fn(|c| Links::new(&cuts.components[c], grid, metrics, c)),
            pressure: CutPressure::new(&cuts, grid, metrics),
            impulses: vec![Wrench::default(); cuts.n_bodies],
            nodes: std::array::from_fn(|c| vec![0.0; cuts.components[c].faces.len()]),
            cuts,
        })
    }

    /// Takes other walls; if they are where the last ones were, only their velocity is new.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub(crate) fn set(
        &mut self,
        cuts: CutWalls,
        grid: &CartesianGrid<D>,
        metrics: &Metrics<D>,
    ) -> Result<(), FlowError> {
        if self.cuts.same_shape(&cuts) {
            self.impulses.resize(cuts.n_bodies, Wrench::default());
            self.cuts = cuts;
            return Ok(());
        }
        *self = Self::new(cuts, grid, metrics)?;
        Ok(())
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

    fn swap(&mut self, c: usize, u: &mut [f64]) {
        for (value, face) in self.nodes[c].iter_mut().zip(&self.cuts.components[c].faces) {
            std::mem::swap(value, &mut u[face.index]);
        }
    }
}

/// Are these walls of this grid?
fn check<const D: usize>(
    cuts: &CutWalls,
    grid: &CartesianGrid<D>,
    metrics: &Metrics<D>,
) -> Result<(), FlowError> {
    let fail = |name, value, range| Err(FlowError::Parameter { name, value, range });
    for (c, component) in cuts.components.iter().enumerate() {
        let CutComponent { solid, links, faces } = component;
        let terms = faces.iter().flat_map(|face| face.terms.iter().map(|term| term.0));
        let nodes = solid.iter().map(|point| point.index).chain(links.iter().map(|node| node.index));
        // A node of a bounded axis is no face of its sides.
        let inside = |index: usize| {
            c < D
                && (grid.base()..grid.storage()).contains(&index)
                && cell(grid, index)
                    .iter()
                    .zip(grid.cells())
                    .enumerate()
                    .all(|(a, (&i, n))| i < n && (i > 0 || a != c || metrics.periodic[a]))
        };
        let all = nodes.chain(faces.iter().map(|face| face.index)).chain(terms);
        if let Some(index) = all.into_iter().find(|&index| !inside(index)) {
            let range = "one of the flow's own velocity lattices: make the walls from its `velocity()`";
            return fail("a storage index of immersed walls", index as f64, range);
        }
        if let Some(face) = faces.iter().find(|face| !(0.0..1.0).contains(&face.open)) {
            return fail("the open share of a face that a wall cuts", face.open, "from 0 to less than 1");
        }
        let mut fractions = links.iter().flat_map(|node| node.links.iter().flatten().flatten());
        if let Some(link) = fractions.find(|link| !(link.fraction > 0.0 && link.fraction <= 1.0)) {
            return fail("the share of a link before a wall", link.fraction, "above 0 and at most 1");
        }
        let mut bodies = solid.iter().map(|point| point.body).chain(links.iter().map(|node| node.body));
        if let Some(body) = bodies.find(|&body| body >= cuts.n_bodies) {
            return fail("a body's number in immersed walls", body as f64, "less than the number of bodies");
        }
    }
    Ok(())
}

/// The cell whose storage index this is.
fn cell<const D: usize>(grid: &CartesianGrid<D>, index: usize) -> [usize; D] {
    let (mut rest, stride) = (index - grid.base(), grid.stride());
    let mut cell = [0; D];
    for a in (0..D).rev() {
        cell[a] = rest / stride[a];
        rest %= stride[a];
    }
    cell
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
    /// Corrects the new velocity at the nodes that the walls touch: their viscous terms along cut links, and the solid's own
    /// velocity inside; sums the impulses that this took.
    pub(crate) fn hold(&mut self, step: Step, old: &[Field<D>; D], next: &mut [Field<D>; D]) {
        self.impulses.fill(Wrench::default());
        for c in 0..D {
            self.links[c].hold(
                c,
                &self.cuts.components[c],
                step,
                old[c].data(),
                next[c].data_mut(),
                &mut self.impulses,
            );
        }
    }

    /// Hands what a step takes from the last one to `sink`.
    pub(crate) fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        for (c, links) in self.links.iter().enumerate() {
            sink(&format!("walls{c}"), &links.plain);
        }
        sink("walls", &self.pressure.missing);
    }

    /// Takes back what [`save`](Self::save) gave.
    pub(crate) fn restore<'a>(
        &mut self,
        source: &dyn Fn(&str) -> Option<&'a [f64]>,
    ) -> Result<(), RestartError> {
        for (c, links) in self.links.iter_mut().enumerate() {
            restore_list(source, &format!("walls{c}"), &mut links.plain)?;
        }
        restore_list(source, "walls", &mut self.pressure.missing)
    }

    /// Gives the nodes inside the solid its velocity again after a correction by the pressure.
    pub(crate) fn hold_solid(&mut self, density: f64, velocity: &mut [Field<D>; D]) {
        for c in 0..D {
            self.links[c].hold_solid(
                c,
                &self.cuts.components[c],
                density,
                velocity[c].data_mut(),
                &mut self.impulses,
            );
        }
    }
}

impl<const D: usize> FlowState<D> {
    /// Tells the walls' velocity to the nodes inside them.
    pub(crate) fn fill_walls(&mut self, cuts: &CutWalls) {
        for (c, component) in self.velocity.components.iter_mut().enumerate() {
            for point in &cuts.components[c].solid {
                component.data_mut()[point.index] = point.velocity;
            }
        }
        self.fill_velocity();
        self.measure_rates();
    }
}
