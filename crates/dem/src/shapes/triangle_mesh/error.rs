//! What can be wrong with a mesh.
use super::RepairReport;
use std::path::PathBuf;

/// Why triangles do not make a body. Faces and vertices are counted from 0; no more than eight are named.
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
    /// A coordinate is not finite, or absurd.
    #[error("vertex {vertex} is at {position:?} m; give finite coordinates of no more than 1e50 m")]
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
    /// Faces that are there twice, or whose other side is a face, too.
    #[error(
        "{count} faces have the three vertices of another one, among them {faces:?}; remove one of each pair, or both"
    )]
    Duplicate {
        /// How many.
        count: usize,
        /// The first pairs.
        faces: Vec<[usize; 2]>,
    },
    /// Vertices at which parts of the surface touch.
    #[error(
        "at {count} vertices the surface touches itself, among them {vertices:?}; give each part a vertex of its own, a little apart"
    )]
    Pinched {
        /// How many.
        count: usize,
        /// The first of them.
        vertices: Vec<u32>,
    },
    /// Vertices at the same place.
    #[error(
        "{count} vertices are where another one is, among them {vertices:?}; join them if they are one, or move the parts that touch there apart"
    )]
    Coincident {
        /// How many.
        count: usize,
        /// The first pairs.
        vertices: Vec<[u32; 2]>,
    },
    /// Faces that cross.
    #[error(
        "{} {count} pairs of faces cross, overlap or touch though they are no neighbours there, among them {faces:?}; unite the parts, or move them apart", if *all { "exactly" } else { "at least" }
    )]
    SelfIntersecting {
        /// How many pairs were found.
        count: usize,
        /// The search came to its end.
        all: bool,
        /// The first pairs.
        faces: Vec<[usize; 2]>,
    },
    /// Closed parts of the surface whose outside is in.
    #[error(
        "{count} closed parts of the surface look the wrong way, among them those of the faces {faces:?}: a part is to look outward, a cavity in it inward, and so on; turn all faces of these parts"
    )]
    InsideOut {
        /// How many.
        count: usize,
        /// A face of each of the first.
        faces: Vec<usize>,
    },
    /// The unit of length is not one.
    #[error("the unit of length is {unit} m; give a positive, finite length (1e-3 for millimetres)")]
    Unit {
        /// Its value.
        unit: f64,
    },
    /// A repaired mesh is no body.
    #[error(
        "the mesh cannot be repaired: near ({:.6e}, {:.6e}, {:.6e}) m {fault} (faces and vertices of the mesh after repair: {report})", at[0], at[1], at[2]
    )]
    NotRepaired {
        /// The first fault that is left; its faces and vertices are those of the repaired mesh.
        fault: Box<MeshError>,
        /// Place of the first of them \[m\].
        at: [f64; 3],
        /// Changes so far.
        report: Box<RepairReport>,
    },
    /// The welding tolerance is not a length.
    #[error("the welding tolerance is {tolerance} m; give a finite length, 0 or more")]
    Tolerance {
        /// Its value.
        tolerance: f64,
    },
    /// The text of a file is not what it should be.
    #[error("line {line} of the {format} file: {what}")]
    Text {
        /// Which format.
        format: &'static str,
        /// Which line, from 1.
        line: usize,
        /// What is wrong.
        what: String,
    },
    /// A binary file ends too early.
    #[error(
        "the binary STL file should have {triangles} triangles, that is {} bytes, but has {bytes} bytes; write it again", 84 + 50 * u64::from(*triangles)
    )]
    Truncated {
        /// Triangles that it promises.
        triangles: u32,
        /// Bytes that it has.
        bytes: usize,
    },
    /// There is more than 32 bits can number.
    #[error("the mesh has {count} {what}; no more than {most} can be numbered: give fewer triangles")]
    TooMany {
        /// Vertices, or corners of triangles.
        what: &'static str,
        /// Their number.
        count: usize,
        /// The largest number.
        most: u32,
    },
    /// The path leads to a directory, device, pipe or socket.
    #[error("{}: {kind} is no mesh file; give the path of a regular file", path.display())]
    NoFile {
        /// The path.
        path: PathBuf,
        /// Directory, device, pipe or socket.
        kind: &'static str,
    },
    /// The file is larger than is read.
    #[error(
        "{}: {bytes} bytes are more than the limit of {limit} bytes; write the mesh as a binary file, or with fewer triangles", path.display()
    )]
    TooLarge {
        /// The path.
        path: PathBuf,
        /// Its size \[bytes\].
        bytes: u64,
        /// The largest size \[bytes\].
        limit: u64,
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

impl MeshError {
    /// Whether [`TriangleSoup::repaired`](crate::TriangleSoup::repaired) may mend it.
    pub fn is_repairable(&self) -> bool {
        match self {
            Self::Degenerate { .. }
            | Self::NotClosed { .. }
            | Self::Inconsistent { .. }
            | Self::NotManifold { .. }
            | Self::Flat { .. }
            | Self::Duplicate { .. }
            | Self::Pinched { .. }
            | Self::Coincident { .. }
            | Self::SelfIntersecting { .. }
            | Self::InsideOut { .. } => true,
            Self::Empty { .. }
            | Self::NoVertex { .. }
            | Self::NotFinite { .. }
            | Self::Unit { .. }
            | Self::NotRepaired { .. }
            | Self::Tolerance { .. }
            | Self::Text { .. }
            | Self::Truncated { .. }
            | Self::TooMany { .. }
            | Self::NoFile { .. }
            | Self::TooLarge { .. }
            | Self::File { .. } => false,
        }
    }
    /// An error unless `count` fits in 32 bits.
    pub(crate) fn check_count(what: &'static str, count: usize) -> Result<(), Self> {
        if u32::try_from(count).is_err() {
            return Err(Self::TooMany { what, count, most: u32::MAX });
        }
        Ok(())
    }
}

/// Errors name this many faces at most.
const MOST_NAMED: usize = 8;

/// The first of them.
pub(crate) fn named<T>(mut all: Vec<T>) -> Vec<T> {
    all.truncate(MOST_NAMED);
    all
}
