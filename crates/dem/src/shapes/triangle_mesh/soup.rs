//! Triangles as a file has them.
use super::{AdmissionReport, MeshError, TriangleMesh, obj, stl};
use std::collections::HashMap;
use std::fs::File;
use std::io::Read;
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
        // Boxes wider than the tolerance, and wide enough that they can be numbered: a vertex's like is in its own box or in one
        // beside it.
        let largest = self
            .vertices
            .as_flattened()
            .iter()
            .fold(0.0, |m: f64, x| if x.is_finite() { m.max(x.abs()) } else { m });
        let width = (1.001 * tolerance).max(largest * 1e-15).max(f64::MIN_POSITIVE);
        let mut boxes: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
        let mut kept: Vec<[f64; 3]> = Vec::new();
        let mut number = Vec::with_capacity(self.vertices.len());
        for v in &self.vertices {
            let home = v.map(|x| (x / width).floor() as i64);
            let near = |w: &u32| {
                let w = kept[*w as usize];
                (0..3).map(|a| (w[a] - v[a]).powi(2)).sum::<f64>() <= tolerance * tolerance
            };
            let around = (0..27).map(|i| [i % 3, i / 3 % 3, i / 9]);
            let around = around.map(|i| [0, 1, 2].map(|a| home[a].saturating_add(i[a] - 1)));
            let like = around.filter_map(|b| boxes.get(&b)).flatten().copied().filter(near).min();
            number.push(like.unwrap_or_else(|| {
                kept.push(*v);
                boxes.entry(home).or_default().push(kept.len() as u32 - 1);
                kept.len() as u32 - 1
            }));
        }
        // Out of range is left so, to be named later.
        let last = number.len() as u32;
        self.faces
            .iter_mut()
            .flatten()
            .for_each(|v| *v = number.get(*v as usize).copied().unwrap_or((*v).max(last)));
        self.faces.retain(|[a, b, c]| a != b && b != c && c != a);
        Ok(Self { vertices: kept, faces: self.faces })
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
