//! Are walls those of a grid?
use crate::metrics::Metrics;
use crate::{CartesianGrid, FlowError};
use interfaces::{CutComponent, CutWalls};

/// # Errors
/// [`FlowError::Parameter`] for nodes of another grid, and for shares, fractions and bodies that make no sense.
pub(crate) fn check<const D: usize>(
    cuts: &CutWalls,
    grid: &CartesianGrid<D>,
    metrics: &Metrics<D>,
) -> Result<(), FlowError> {
    let fail = |name, value, range| Err(FlowError::Parameter { name, value, range });
    for (c, CutComponent { solid, links, faces }) in cuts.components.iter().enumerate() {
        // A node of a bounded axis is no face of its sides.
        let is_node = |index: usize| {
            let cell = grid.cell_at(index).filter(|_| c < D);
            cell.is_some_and(|cell| metrics.periodic[c] || cell[c] > 0)
        };
        let nodes = solid.iter().map(|point| point.index).chain(links.iter().map(|node| node.index));
        let of_faces = faces.iter().flat_map(|face| face.terms.iter().map(|term| term.0).chain([face.index]));
        if let Some(index) = nodes.chain(of_faces).find(|&index| !is_node(index)) {
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
