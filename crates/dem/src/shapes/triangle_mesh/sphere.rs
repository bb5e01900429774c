//! The tessellated sphere as a mesh.
use super::{MeshError, TriangleMesh};
use crate::shapes::icosphere;

impl TriangleMesh {
    /// An icosahedron whose faces are quartered `times` times, its vertices on a sphere of `radius`
    /// \[m\]: 20·4ⁿ triangles.
    ///
    /// # Errors
    /// [`MeshError`] for a radius that is not positive and finite.
    pub fn sphere(radius: f64, times: u32) -> Result<Self, MeshError> {
        let (vertices, faces) = icosphere(radius, times);
        Self::new(&vertices, &faces)
    }
}
