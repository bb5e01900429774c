//! Meshes whose unit of length does not go with the box.
use crate::setup::Setup;
use dem::Shape;
use fv_mesh::Axis;
use interfaces::{Pose, is_longer};
use std::collections::HashSet;
use std::sync::Arc;

/// Usual units of length of files \[m\]: metre, foot, inch, centimetre, millimetre and micrometre.
const UNITS: [(f64, &str); 6] =
    [(1.0, "1"), (0.3048, "0.3048"), (0.0254, "0.0254"), (1e-2, "1e-2"), (1e-3, "1e-3"), (1e-6, "1e-6")];

impl Setup {
    /// Meshes that are longer than the diagonal of the box, so that they do not fit into it however
    /// they are turned, or shorter than a cell.
    pub(super) fn doubt_units(&self, out: &mut Vec<String>) {
        let mut known = HashSet::new();
        for mesh in self.meshes() {
            if !known.contains(mesh.origin)
                && let Some(doubt) = self.doubt_of(&mesh)
            {
                known.insert(mesh.origin);
                out.push(format!("{}.shape.unit: {doubt}", mesh.origin));
            }
        }
    }

    /// Why the unit of the mesh that this key makes looks wrong, and the likely one.
    pub(crate) fn unit_doubt(&self, key: &str) -> Option<String> {
        self.meshes().filter(|mesh| mesh.origin == key).find_map(|mesh| self.doubt_of(&mesh))
    }

    fn doubt_of(&self, mesh: &Mesh<'_>) -> Option<String> {
        let edges: Vec<f64> = self.axes.iter().map(Axis::length).collect();
        let (diagonal, cell) = (edges.iter().map(|l| l * l).sum::<f64>().sqrt(), self.narrowest());
        let extent = mesh.shape.aabb().posed(&mesh.pose).extent();
        let size = extent.max();
        if !is_longer(size, diagonal) && (self.fluid.is_none() || size >= cell) {
            return None;
        }
        let likely = UNITS.into_iter().find(|(unit, _)| {
            let factor = unit / mesh.unit;
            let fits = edges.iter().enumerate().all(|(a, edge)| !is_longer(factor * extent[a], *edge));
            fits && factor * size >= cell
        });
        let likely = match likely {
            Some((_, unit)) => format!("did you mean unit = {unit}?"),
            None => "give the length that one unit of the file stands for".into(),
        };
        let edges: Vec<String> = edges.iter().map(|l| format!("{l:.3e}")).collect();
        Some(format!(
            "with unit = {:e} the mesh is {size:.3e} m long in a box of {} m with cells of {cell:.3e} m; {likely}",
            mesh.unit,
            edges.join(" × ")
        ))
    }

    fn meshes(&self) -> impl Iterator<Item = Mesh<'_>> {
        let list = self.bodies.list.iter().filter_map(|body| {
            Some(Mesh { origin: &body.origin, shape: &body.shape, pose: body.pose, unit: body.unit? })
        });
        let inflows = self.bodies.inflows.iter().flat_map(|inflow| {
            let mesh = |shape| {
                Some(Mesh { origin: &inflow.origin, shape, pose: Pose::at([0.0; 3]), unit: inflow.unit? })
            };
            inflow.shapes.iter().filter_map(mesh)
        });
        list.chain(inflows)
    }
}

/// A body from a file.
struct Mesh<'a> {
    /// The key that made it.
    origin: &'a str,
    shape: &'a Arc<dyn Shape>,
    pose: Pose,
    /// Unit of length of the file \[m\].
    unit: f64,
}
