//! Triangles as a file has them.
use super::welding::{Welded, is_collapsed};
use super::{AdmissionReport, MeshError, RepairReport, TriangleMesh, obj, repair, stl};
use std::collections::HashMap;
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

/// Triangles that need not be a body yet: what a file holds. Look at them with
/// [`admission`](Self::admission), join vertices with [`welded`](Self::welded), then make a
/// [`TriangleMesh`] of them.
///
/// ```
/// use dem::{MeshError, TriangleMesh, TriangleSoup};
///
/// let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
/// let soup = TriangleSoup::from_obj_bytes(obj, 1e-3)?;
/// assert!(soup.admission(None).is_admissible());
/// let mesh = TriangleMesh::try_from(soup)?;
/// assert!((mesh.volume() - 1e-9 / 6.0).abs() < 1e-20);
/// # Ok::<(), MeshError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleSoup {
    /// Places \[m\].
    pub vertices: Vec<[f64; 3]>,
    /// Numbers of three vertices each.
    pub faces: Vec<[u32; 3]>,
}

impl TriangleSoup {
    /// Largest size of a mesh file \[bytes\], 1 GiB: 2·10⁷ triangles of a binary STL file.
    pub const LARGEST_FILE: u64 = 1 << 30;

    /// Triangles of an STL file's bytes, text or binary, several solids as one; `unit` is its unit
    /// of length \[m\] (1e-3 for millimetres). Corners that are equal, digit by digit, are one
    /// vertex. Normals are not used and may be missing; bytes behind the triangles of a binary file
    /// are skipped. Lines end with LF, CR or both; a byte-order mark (UTF-8, UTF-16) may come
    /// first.
    ///
    /// # Errors
    /// [`MeshError::Text`], [`MeshError::Truncated`], [`MeshError::TooMany`] or
    /// [`MeshError::Unit`]; never a panic, whatever the bytes are.
    pub fn from_stl_bytes(bytes: &[u8], unit: f64) -> Result<Self, MeshError> {
        let corners = stl::read(bytes)?;
        Self::of_corners(&corners)?.scaled(unit)
    }
    /// Triangles of a Wavefront OBJ file's bytes: its lines `v` and `f`, with comments and
    /// continuations. Polygons, convex or not, make fans around their first corners or are cut up
    /// by clipping ears; corners that repeat the one before are left out. `unit` is its unit of
    /// length \[m\]. Text as in [`from_stl_bytes`](Self::from_stl_bytes).
    ///
    /// # Errors
    /// [`MeshError::Text`], [`MeshError::TooMany`] or [`MeshError::Unit`]; never a panic, whatever
    /// the bytes are.
    pub fn from_obj_bytes(bytes: &[u8], unit: f64) -> Result<Self, MeshError> {
        let (vertices, faces) = obj::read(bytes)?;
        Self { vertices, faces }.scaled(unit)
    }
    /// Triangles of an STL file: [`from_stl_bytes`](Self::from_stl_bytes).
    ///
    /// # Errors
    /// [`MeshError::File`], [`MeshError::NoFile`] unless it is a regular file,
    /// [`MeshError::TooLarge`] beyond [`LARGEST_FILE`](Self::LARGEST_FILE), and
    /// [`MeshError::Unit`].
    pub fn from_stl(path: impl AsRef<Path>, unit: f64) -> Result<Self, MeshError> {
        Self::from_file(path.as_ref(), unit, Self::from_stl_bytes)
    }
    /// Triangles of an OBJ file: [`from_obj_bytes`](Self::from_obj_bytes).
    ///
    /// # Errors
    /// Those of [`from_stl`](Self::from_stl).
    pub fn from_obj(path: impl AsRef<Path>, unit: f64) -> Result<Self, MeshError> {
        Self::from_file(path.as_ref(), unit, Self::from_obj_bytes)
    }

    /// Triangles of a file whose name ends in `.stl` or `.obj`.
    ///
    /// # Errors
    /// Those of [`from_stl`](Self::from_stl); [`MeshError::File`] for other endings.
    pub fn from_path(path: impl AsRef<Path>, unit: f64) -> Result<Self, MeshError> {
        let path = path.as_ref();
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        match ending.as_deref() {
            Some("stl") => Self::from_stl(path, unit),
            Some("obj") => Self::from_obj(path, unit),
            _ => {
                let what = "unknown format; give a file whose name ends in .stl or .obj".into();
                Err(MeshError::File { path: path.into(), what })
            }
        }
    }

    /// Repairs the triangles if `repair`, otherwise joins vertices up to `weld` \[m\] if that is given;
    /// returns them with a description of the changes, none if nothing was changed.
    ///
    /// # Errors
    /// Those of [`repaired`](Self::repaired) and [`welded`](Self::welded).
    pub fn mended(self, weld: Option<f64>, repair: bool) -> Result<(Self, Option<String>), MeshError> {
        if repair {
            let (soup, report) = self.repaired(weld)?;
            return Ok((soup, (!report.is_empty()).then(|| format!("repaired: {report}"))));
        }
        let Some(tolerance) = weld else { return Ok((self, None)) };
        let before = [self.vertices.len(), self.faces.len()];
        let soup = self.welded(tolerance)?;
        let [joined, lost] = [before[0] - soup.vertices.len(), before[1] - soup.faces.len()];
        let changes = format!(
            "{joined} vertices up to {tolerance:.3e} m from others were joined, and {lost} faces lost by it"
        );
        Ok((soup, (joined > 0).then_some(changes)))
    }

    /// Writes an OBJ file, from which [`from_obj`](Self::from_obj) reads the same numbers.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write_obj(&self, out: &mut impl Write) -> io::Result<()> {
        for [x, y, z] in &self.vertices {
            writeln!(out, "v {x:e} {y:e} {z:e}")?;
        }
        for face in &self.faces {
            let [a, b, c] = face.map(|vertex| vertex + 1);
            writeln!(out, "f {a} {b} {c}")?;
        }
        Ok(())
    }

    fn from_file(
        path: &Path,
        unit: f64,
        read: impl Fn(&[u8], f64) -> Result<Self, MeshError>,
    ) -> Result<Self, MeshError> {
        let failed = |what: String| MeshError::File { path: path.into(), what };
        let bytes = bytes_of(path, Self::LARGEST_FILE)?;
        read(&bytes, unit).map_err(|e| match e {
            MeshError::Unit { .. } => e,
            e => failed(e.to_string()),
        })
    }

    /// Triangles that are given by their corners.
    fn of_corners(corners: &[[f64; 3]]) -> Result<Self, MeshError> {
        MeshError::check_count("corners", corners.len())?;
        let mut soup = Self::default();
        let mut numbers: HashMap<[u64; 3], u32> = HashMap::new();
        for triangle in corners.as_chunks::<3>().0 {
            soup.faces.push(triangle.map(|corner| {
                // 0 and −0 are one place.
                let corner = corner.map(|x| x + 0.0);
                *numbers.entry(corner.map(f64::to_bits)).or_insert_with(|| {
                    soup.vertices.push(corner);
                    soup.vertices.len() as u32 - 1
                })
            }));
        }
        Ok(soup)
    }

    fn scaled(mut self, unit: f64) -> Result<Self, MeshError> {
        if !(unit.is_finite() && unit > 0.0) {
            return Err(MeshError::Unit { unit });
        }
        self.vertices.as_flattened_mut().iter_mut().for_each(|x| *x *= unit);
        Ok(self)
    }

    /// Joins vertices: one that is no farther than `tolerance` \[m\] from a vertex before it that
    /// is kept is replaced by that one. Faces that lose a corner are left out.
    ///
    /// Files of single precision, and files of several surfaces that were meshed one by one, have
    /// vertices that should be one but differ by round-off, about 1e-7 of the distance from the
    /// file's origin: then the mesh is [not closed](MeshError::NotClosed). A tolerance of ten times
    /// that, and no more than a tenth of the shortest edge, is safe.
    ///
    /// # Errors
    /// [`MeshError::Tolerance`] unless it is finite and not negative.
    pub fn welded(mut self, tolerance: f64) -> Result<Self, MeshError> {
        if !(tolerance.is_finite() && tolerance >= 0.0) {
            return Err(MeshError::Tolerance { tolerance });
        }
        let welded = Welded::new(&self.vertices, tolerance);
        self.faces = welded.faces(&self.faces).filter(|f| !is_collapsed(*f)).collect();
        Ok(Self { vertices: welded.kept, faces: self.faces })
    }

    /// Repairs what a file has wrong, and reports everything that was done, in this order (vertices
    /// of no face are left out):
    ///
    /// 1. Vertices no farther apart than `weld` \[m\] are joined. By default those that are equal
    ///    digit by digit, and if the surface is open then, those that differ by round-off of single
    ///    precision, 2⁻²³ of the largest coordinate. Faces that lose a corner are left out.
    /// 2. Of faces with the same three corners one is kept. Connected ones that divide the inside
    ///    (every edge of theirs belongs to an even number of other faces) are all left out.
    /// 3. Faces with a vertex of open edges on an open edge of theirs, within the tolerance, are
    ///    divided there.
    /// 4. Faces are turned to agree with their neighbours, fewer than half of each connected part.
    /// 5. Faces without area, or thinner than the tolerance, are flipped with the neighbour across
    ///    their longest edge, which leaves the surface as it is, and closed.
    /// 6. Closed parts that cross, overlap or share edges are united: the surface of all places
    ///    around which they go once or more, cut by exact arithmetic and rounded to the nearest
    ///    numbers.
    /// 7. Closed parts are turned outward, those within an odd number of others inward (cavities).
    ///
    /// # Errors
    /// [`MeshError::Tolerance`] unless `weld` is finite and not negative.
    /// [`MeshError::NotRepaired`] with the fault that is left and its place, if the result is no
    /// body: holes are not filled, parts that touch in a vertex or along an edge not separated.
    pub fn repaired(self, weld: Option<f64>) -> Result<(Self, RepairReport), MeshError> {
        repair::repaired(self, weld)
    }

    /// May they be a body? [`AdmissionReport::of`].
    pub fn admission(&self, resolution: Option<f64>) -> AdmissionReport {
        AdmissionReport::of(&self.vertices, &self.faces, resolution)
    }
}

/// The bytes of a regular file that has no more of them than `limit`. Whether it is one is known
/// before it is opened, so that pipes without a writer do not block.
fn bytes_of(path: &Path, limit: u64) -> Result<Vec<u8>, MeshError> {
    let failed = |e: std::io::Error| MeshError::File { path: path.into(), what: e.to_string() };
    let about = std::fs::metadata(path).map_err(failed)?;
    if !about.is_file() {
        let kind = if about.is_dir() { "a directory" } else { "a device, pipe or socket" };
        return Err(MeshError::NoFile { path: path.into(), kind });
    }
    let mut bytes = Vec::new();
    if about.len() <= limit {
        bytes.reserve_exact(about.len() as usize);
        // Files may grow while they are read.
        File::open(path).and_then(|file| file.take(limit + 1).read_to_end(&mut bytes)).map_err(failed)?;
    }
    let size = about.len().max(bytes.len() as u64);
    if size > limit {
        return Err(MeshError::TooLarge { path: path.into(), bytes: size, limit });
    }
    Ok(bytes)
}

impl TryFrom<TriangleSoup> for TriangleMesh {
    type Error = MeshError;
    fn try_from(soup: TriangleSoup) -> Result<Self, MeshError> {
        Self::new(&soup.vertices, &soup.faces)
    }
}
