//! What can be wrong with a mesh.
use std::collections::HashMap;
use std::path::PathBuf;

/// Why triangles do not make a body. Faces are counted from 0; no more than eight are named.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// There are no faces.
    #[error("the mesh has {vertices} vertices but no faces; give a closed surface")]
    Empty {
        /// How many vertices there are.
        vertices: usize,
    },
    /// A face refers to a vertex that is not there.
    #[error("face {face} has vertex {vertex}, but there are {vertices} only (from 0)")]
    NoVertex {
        /// The face.
        face: usize,
        /// The vertex.
        vertex: u32,
        /// How many there are.
        vertices: usize,
    },
    /// A coordinate is not finite.
    #[error("vertex {vertex} is at {position:?}; give finite coordinates")]
    NotFinite {
        /// The vertex.
        vertex: usize,
        /// Its place.
        position: [f64; 3],
    },
    /// Faces without area.
    #[error("{count} faces have no area, among them {faces:?}; remove them and join their neighbours")]
    Degenerate {
        /// How many.
        count: usize,
        /// The first of them.
        faces: Vec<usize>,
    },
    /// Edges that only one face has.
    #[error(
        "the surface is not closed: {count} edges belong to one face only, among them edges of the faces {faces:?}; fill the holes, or join vertices that should be one"
    )]
    NotClosed {
        /// How many open edges.
        count: usize,
        /// Faces that have some of them.
        faces: Vec<usize>,
    },
    /// Neighbouring faces that disagree on which side is outside.
    #[error(
        "the faces are not consistently oriented: at {count} edges the two faces disagree, among them {faces:?}; turn one of each pair"
    )]
    Inconsistent {
        /// At how many edges.
        count: usize,
        /// The pairs at the first of them.
        faces: Vec<[usize; 2]>,
    },
    /// Edges that more than two faces have.
    #[error(
        "{count} edges belong to more than two faces, among them edges of the faces {faces:?}; separate the parts that touch there"
    )]
    NotManifold {
        /// How many.
        count: usize,
        /// Faces that have some of them.
        faces: Vec<usize>,
    },
    /// Nothing between the faces.
    #[error(
        "the faces enclose {volume:.3e} m³ only, though the mesh is {size:.3e} m large; give a body with volume"
    )]
    Flat {
        /// Enclosed volume \[m³\].
        volume: f64,
        /// Largest extent \[m\].
        size: f64,
    },
    /// The file cannot be read.
    #[error("{}: {what}", path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        what: String,
    },
}

/// Errors name this many faces at most.
const MOST_NAMED: usize = 8;

/// Do the faces make a closed, consistently oriented surface?
pub(crate) fn check(vertices: &[[f64; 3]], faces: &[[u32; 3]]) -> Result<(), MeshError> {
    if faces.is_empty() {
        return Err(MeshError::Empty { vertices: vertices.len() });
    }
    for (face, corners) in faces.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|v| **v as usize >= vertices.len()) {
            return Err(MeshError::NoVertex { face, vertex, vertices: vertices.len() });
        }
    }
    if let Some(vertex) = vertices.iter().position(|v| !v.iter().all(|x| x.is_finite())) {
        return Err(MeshError::NotFinite { vertex, position: vertices[vertex] });
    }
    let flat: Vec<usize> = (0..faces.len()).filter(|&f| has_no_area(vertices, faces[f])).collect();
    if !flat.is_empty() {
        return Err(MeshError::Degenerate { count: flat.len(), faces: named(flat) });
    }
    edges(faces)
}

fn named<T>(mut all: Vec<T>) -> Vec<T> {
    all.truncate(MOST_NAMED);
    all
}

/// Is its height less than round-off of its longest edge?
fn has_no_area(vertices: &[[f64; 3]], face: [u32; 3]) -> bool {
    let [a, b, c] = face.map(|v| interfaces::Vector::from(vertices[v as usize]));
    let longest = (b - a).norm_squared().max((c - a).norm_squared()).max((c - b).norm_squared());
    (b - a).cross(&(c - a)).norm() <= 1e-14 * longest
}

/// Every edge must belong to two faces, once in each direction.
fn edges(faces: &[[u32; 3]]) -> Result<(), MeshError> {
    // Of every edge: the faces that have it, and whether they run from its lower vertex to its higher.
    let mut edges: HashMap<(u32, u32), Vec<(usize, bool)>> = HashMap::with_capacity(2 * faces.len());
    for (f, &[a, b, c]) in faces.iter().enumerate() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            edges.entry((from.min(to), from.max(to))).or_default().push((f, from < to));
        }
    }
    let (mut open, mut pairs, mut many) = (Vec::new(), Vec::new(), Vec::new());
    for sharing in edges.values() {
        match sharing[..] {
            [(f, _)] => open.push(f),
            [(f, up), (g, also)] if up == also => pairs.push([f, g]),
            [_, _] => {}
            _ => many.extend(sharing.first().map(|(f, _)| *f)),
        }
    }
    open.sort_unstable();
    pairs.sort_unstable();
    many.sort_unstable();
    let count = open.len() + pairs.len() + many.len();
    let distinct = |mut faces: Vec<usize>| {
        faces.dedup();
        named(faces)
    };
    if !many.is_empty() {
        Err(MeshError::NotManifold { count: many.len(), faces: distinct(many) })
    } else if !open.is_empty() {
        Err(MeshError::NotClosed { count: open.len(), faces: distinct(open) })
    } else if count > 0 {
        Err(MeshError::Inconsistent { count, faces: named(pairs) })
    } else {
        Ok(())
    }
}
