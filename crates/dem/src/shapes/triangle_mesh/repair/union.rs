//! Union of closed parts that cross.
use super::super::TriangleSoup;
use manifold_rust::impl_mesh::ManifoldImpl;
use manifold_rust::linalg::{IVec3, Vec3};
use manifold_rust::manifold::Manifold;
use manifold_rust::robust::{rebuild_with_rule, soup::soupify};
use manifold_rust::types::{Error, WindingRule};

/// The surface of all places around which these faces go once or more, cut by exact arithmetic (Zhou
/// et al. 2016, ACM Trans. Graph. 35, 39) and rounded to the nearest numbers; `None` if the faces
/// are not closed, or there is no such place.
pub(super) fn united(vertices: &[[f64; 3]], faces: &[[u32; 3]]) -> Option<TriangleSoup> {
    let mut used = faces.as_flattened().to_vec();
    used.sort_unstable();
    used.dedup();
    let number = |v: u32| used.binary_search(&v).unwrap_or(0) as i32;
    let corners = |f: &[u32; 3]| IVec3::new(number(f[0]), number(f[1]), number(f[2]));
    let faces: Vec<IVec3> = faces.iter().map(corners).collect();
    let mut given = ManifoldImpl::new();
    let place =
        |v: &u32| Vec3::new(vertices[*v as usize][0], vertices[*v as usize][1], vertices[*v as usize][2]);
    given.vert_pos = used.iter().map(place).collect();
    // The crate's other ways in swap edges first, which moves surfaces that are folded.
    soupify(&mut given, &faces, &[]).ok()?;
    let solid = Manifold::from_impl(rebuild_with_rule(&given, WindingRule::Positive, None, None));
    if solid.status() != Error::NoError || solid.is_empty() {
        return None;
    }
    let mesh = solid.get_mesh_gl64(-1);
    let vertices =
        mesh.vert_properties.chunks_exact(mesh.num_prop as usize).map(|v| [v[0], v[1], v[2]]).collect();
    let faces = mesh.tri_verts.as_chunks::<3>().0.iter().map(|f| f.map(|v| v as u32)).collect();
    Some(TriangleSoup { vertices, faces })
}
