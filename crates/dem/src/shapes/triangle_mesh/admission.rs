//! May triangles be a body?
use super::crossings::{FaceTree, coincident};
use super::error::{MeshError, named};
use super::flat_faces::{FlatFaces, is_flat, relative_height};
use super::nesting;
use super::thickness::{Thickness, Thinnest};
use super::topology::Topology;
use interfaces::{Aabb, Point, Vector};
use std::fmt;

/// No coordinate may be larger \[m\]: its fifth power is finite.
pub(crate) const LARGEST: f64 = 1e50;
/// A triangle is a sliver if its least height is a smaller share of its longest edge.
const SLIVER: f64 = 0.01;

/// A connected part of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shell {
    /// How many faces it has.
    pub faces: usize,
    /// The first of them.
    pub first: usize,
    /// Volume within, negative if its faces look inward \[m³\].
    pub volume: f64,
    /// How many other shells it is in: an odd number makes it a cavity.
    pub depth: usize,
}

/// What is known of triangles before they become a body. Nothing is left out because of what was found before.
///
/// ```
/// use dem::AdmissionReport;
///
/// let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let report = AdmissionReport::of(&vertices, &[[0, 2, 1], [0, 1, 3], [0, 3, 2]], Some(0.1));
/// assert!(!report.is_admissible());
/// assert!(report.to_string().contains("the surface is not closed"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct AdmissionReport {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of faces.
    pub faces: usize,
    /// Box around the faces, in the coordinates that the vertices were given in \[m\].
    pub bounds: Aabb,
    /// Volume by the divergence theorem \[m³\]; negative if the faces look inward.
    pub volume: f64,
    /// Everything that keeps the faces from being a body.
    pub faults: Vec<MeshError>,
    /// Connected parts.
    pub shells: Vec<Shell>,
    /// How many faces are slivers: of a height less than a hundredth of their longest edge. They are allowed.
    pub slivers: usize,
    /// The first eight of them.
    pub sliver_faces: Vec<usize>,
    /// Number of faces without area whose longest edge has a neighbour to be flipped with, which
    /// leaves the surface as it is. They are allowed.
    pub flat: usize,
    /// The first eight of them.
    pub flat_faces: Vec<usize>,
    /// The thinnest wall: an estimate from rays, from every vertex and every face's centroid along their normals to the next face
    /// that looks back (within 60°) and is no neighbour. `None` if there is none.
    pub thinnest_wall: Option<Thinnest>,
    /// The thinnest gap, found in the same way.
    pub thinnest_gap: Option<Thinnest>,
    /// What walls and gaps are compared with \[m\].
    pub resolution: Option<f64>,
}

impl AdmissionReport {
    /// Of `vertices` \[m\], three of which make each of the `faces`. `resolution` \[m\], say the width of a cell, is what
    /// [`fmt::Display`] compares walls and gaps with.
    pub fn of(vertices: &[[f64; 3]], faces: &[[u32; 3]], resolution: Option<f64>) -> Self {
        let checked = Checked::new(vertices, faces, true);
        let at = |v: u32| Point::from(vertices[v as usize]);
        let mut report = Self { resolution, ..checked.report };
        if let Some(tree) = &checked.tree {
            let outward = if report.volume < 0.0 { -1.0 } else { 1.0 };
            let thickness = Thickness::new(&checked.faces, &checked.number, tree, at, outward);
            [report.thinnest_wall, report.thinnest_gap] = thickness.thinnest(vertices.len());
        }
        report
    }

    /// Is it a body? [`TriangleMesh::new`](crate::TriangleMesh::new) takes it then.
    pub fn is_admissible(&self) -> bool {
        self.faults.is_empty()
    }
    /// Walls or gaps that are thinner than the resolution.
    pub fn unresolved(&self) -> impl Iterator<Item = Thinnest> {
        let resolution = self.resolution.unwrap_or(0.0);
        [self.thinnest_wall, self.thinnest_gap]
            .into_iter()
            .flatten()
            .filter(move |t| t.thickness < resolution)
    }
}

/// The faces of a body, those without area flipped away, or the first fault of them.
pub(crate) fn check(vertices: &[[f64; 3]], faces: &[[u32; 3]]) -> Result<Vec<[u32; 3]>, MeshError> {
    let Checked { report, faces, .. } = Checked::new(vertices, faces, false);
    report.faults.into_iter().next().map_or(Ok(faces), Err)
}

/// A report without the thinnest wall and gap.
pub(crate) fn survey(vertices: &[[f64; 3]], faces: &[[u32; 3]]) -> AdmissionReport {
    Checked::new(vertices, faces, true).report
}

/// Faults of numbers: no faces, vertices that do not exist or are nowhere.
pub(crate) fn number_faults(vertices: &[[f64; 3]], faces: &[[u32; 3]]) -> Vec<MeshError> {
    let mut faults = Vec::new();
    if faces.is_empty() {
        faults.push(MeshError::Empty { vertices: vertices.len() });
    }
    let missing = |face: &[u32; 3]| face.iter().copied().find(|v| *v as usize >= vertices.len());
    let absent = faces.iter().enumerate().find_map(|(face, corners)| Some((face, missing(corners)?)));
    if let Some((face, vertex)) = absent {
        faults.push(MeshError::NoVertex { face, vertex, vertices: vertices.len() });
    }
    if let Some(vertex) = vertices.iter().position(|v| !is_place(v)) {
        faults.push(MeshError::NotFinite { vertex, position: vertices[vertex] });
    }
    faults
}

/// Whether coordinates are finite, and not absurd.
fn is_place(vertex: &[f64; 3]) -> bool {
    vertex.iter().all(|x| x.abs() <= LARGEST)
}

/// A report so far, and what it is made from.
struct Checked {
    report: AdmissionReport,
    /// Faces that are triangles, and their numbers.
    faces: Vec<[u32; 3]>,
    number: Vec<usize>,
    tree: Option<FaceTree>,
}

impl Checked {
    /// Looks for `everything`, or no further than to the first faults.
    fn new(vertices: &[[f64; 3]], faces: &[[u32; 3]], everything: bool) -> Self {
        let report = AdmissionReport {
            vertices: vertices.len(),
            faces: faces.len(),
            bounds: Aabb { min: Point::origin(), max: Point::origin() },
            volume: 0.0,
            faults: Vec::new(),
            shells: Vec::new(),
            slivers: 0,
            sliver_faces: Vec::new(),
            flat: 0,
            flat_faces: Vec::new(),
            thinnest_wall: None,
            thinnest_gap: None,
            resolution: None,
        };
        let mut checked = Self { report, faces: Vec::new(), number: Vec::new(), tree: None };
        let counts = [("vertices", vertices.len()), ("corners", 3 * faces.len())];
        let excess = counts.into_iter().find_map(|(what, count)| MeshError::check_count(what, count).err());
        if let Some(fault) = excess {
            checked.report.faults.push(fault);
            return checked;
        }
        let flat = FlatFaces::flip(vertices, faces, 0.0);
        (checked.report.flat, checked.report.flat_faces) = (flat.flipped.len(), named(flat.flipped));
        checked.sort_out(vertices, &flat.faces);
        if !everything && !checked.report.is_admissible() || checked.faces.is_empty() {
            return checked;
        }
        let at = |v: u32| Point::from(vertices[v as usize]);
        let topology = Topology::new(&checked.faces, &checked.number);
        checked.report.faults.extend(topology.edge_faults());
        checked.measure(at, &topology);
        checked.report.faults.extend(topology.vertex_faults());
        if !everything && !checked.report.is_admissible() {
            return checked;
        }
        let mut same = coincident(&checked.faces, vertices);
        if !same.is_empty() {
            same.sort_unstable();
            checked.report.faults.push(MeshError::Coincident { count: same.len(), vertices: named(same) });
        }
        let tree = FaceTree::new(&checked.faces, vertices);
        checked.report.faults.extend(tree.crossings(&checked.number));
        if everything || checked.report.is_admissible() {
            checked.nest(nesting::depths(&topology.shells, &tree, vertices));
        }
        checked.tree = Some(tree);
        checked
    }

    /// Keeps the faces that are triangles.
    fn sort_out(&mut self, vertices: &[[f64; 3]], faces: &[[u32; 3]]) {
        self.report.faults.extend(number_faults(vertices, faces));
        let faults = &mut self.report.faults;
        let mut flat = Vec::new();
        for (f, face) in faces.iter().enumerate() {
            if !face.iter().all(|v| vertices.get(*v as usize).is_some_and(is_place)) {
                continue;
            }
            let corners = face.map(|v| Vector::from(vertices[v as usize]));
            if is_flat(corners, 0.0) {
                flat.push(f);
                continue;
            }
            self.faces.push(*face);
            self.number.push(f);
            if relative_height(corners) < SLIVER {
                self.report.slivers += 1;
                self.report.sliver_faces.push(f);
            }
        }
        self.report.sliver_faces.truncate(8);
        if !flat.is_empty() {
            faults.push(MeshError::Degenerate { count: flat.len(), faces: named(flat) });
        }
    }

    /// Box and volumes.
    fn measure(&mut self, at: impl Fn(u32) -> Point, topology: &Topology) {
        let (mut low, mut high) = (Point::from([f64::INFINITY; 3]), Point::from([f64::NEG_INFINITY; 3]));
        for v in self.faces.as_flattened() {
            (low, high) = (low.inf(&at(*v)), high.sup(&at(*v)));
        }
        // About the middle of the box, so that a mesh far from the origin loses no digits.
        let middle = nalgebra::center(&low, &high);
        let volume = |f: u32| {
            let [a, b, c] = self.faces[f as usize].map(|v| at(v) - middle);
            a.dot(&b.cross(&c)) / 6.0
        };
        for shell in &topology.shells {
            let volume = shell.iter().map(|f| volume(*f)).sum();
            let first = self.number[shell[0] as usize];
            self.report.shells.push(Shell { faces: shell.len(), first, volume, depth: 0 });
        }
        self.report.volume = self.report.shells.iter().map(|s| s.volume).sum();
        self.report.bounds = Aabb { min: low, max: high };
        let (volume, size) = (self.report.volume.abs(), (high - low).max());
        if volume <= 1e-12 * size.powi(3) {
            self.report.faults.push(MeshError::Flat { volume, size });
        }
    }

    /// Whether shells at these depths are turned as they should be.
    fn nest(&mut self, depths: Vec<usize>) {
        let whole = self.report.volume;
        let mut wrong = Vec::new();
        for (shell, depth) in self.report.shells.iter_mut().zip(depths) {
            shell.depth = depth;
            if (shell.volume * whole < 0.0) != (depth % 2 == 1) {
                wrong.push(shell.first);
            }
        }
        if !wrong.is_empty() {
            self.report.faults.push(MeshError::InsideOut { count: wrong.len(), faces: named(wrong) });
        }
    }
}

impl fmt::Display for AdmissionReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (e, low) = (self.bounds.extent(), self.bounds.min);
        writeln!(f, "{} faces, {} vertices", self.faces, self.vertices)?;
        writeln!(
            f,
            "box: {:.4e} × {:.4e} × {:.4e} m from ({:.4e}, {:.4e}, {:.4e}) m",
            e.x, e.y, e.z, low.x, low.y, low.z
        )?;
        writeln!(
            f,
            "volume: {:.6e} m³{}",
            self.volume.abs(),
            if self.volume < 0.0 { ", faces inward" } else { "" }
        )?;
        let cavities = self.shells.iter().filter(|s| s.depth % 2 == 1).count();
        writeln!(f, "closed parts: {}, of which {cavities} cavities", self.shells.len())?;
        for shell in self.shells.iter().take(8) {
            let Shell { faces, first, volume, depth } = shell;
            writeln!(f, "  {faces} faces from face {first} on, {volume:.6e} m³, within {depth} others")?;
        }
        for (what, thinnest) in [("wall", self.thinnest_wall), ("gap", self.thinnest_gap)] {
            let Some(Thinnest { thickness, faces: [a, b], at }) = thinnest else {
                writeln!(f, "thinnest {what}: none found")?;
                continue;
            };
            write!(
                f,
                "thinnest {what}: about {thickness:.4e} m, between faces {a} and {b} at ({:.4e}, {:.4e}, {:.4e}) m",
                at.x, at.y, at.z
            )?;
            match self.resolution {
                Some(h) if thickness < h => {
                    writeln!(f, ": thinner than the resolution of {h:.4e} m; refine, or thicken it")?
                }
                Some(h) => writeln!(f, ": {:.1} times the resolution", thickness / h)?,
                None => writeln!(f)?,
            }
        }
        if self.slivers > 0 {
            writeln!(f, "slivers: {} faces, among them {:?}", self.slivers, self.sliver_faces)?;
        }
        if self.flat > 0 {
            writeln!(f, "without area: {} faces, among them {:?}", self.flat, self.flat_faces)?;
        }
        for fault in &self.faults {
            writeln!(f, "fault: {fault}")?;
        }
        writeln!(f, "{}", if self.is_admissible() { "admitted" } else { "not admitted" })
    }
}
