//! Repair of triangles that are no body yet.
mod duplicates;
mod sheets;
mod stitches;
mod union;

use super::admission::{number_faults, survey};
use super::crossings::FaceTree;
use super::flat_faces::{FLAT, FlatFaces, is_flat};
use super::topology::Sets;
use super::welding::{Welded, is_collapsed, largest};
use super::{MeshError, RepairReport, TriangleSoup};
use interfaces::Vector;
use sheets::{Edge, Sheets, edges};
use std::collections::HashSet;

/// [`TriangleSoup::repaired`].
pub(super) fn repaired(
    soup: TriangleSoup,
    weld: Option<f64>,
) -> Result<(TriangleSoup, RepairReport), MeshError> {
    if let Some(tolerance) = weld.filter(|t| !(t.is_finite() && *t >= 0.0)) {
        return Err(MeshError::Tolerance { tolerance });
    }
    if let Some(fault) = number_faults(&soup.vertices, &soup.faces).into_iter().next() {
        return Err(fault);
    }
    let mut repair = Repair { soup, report: RepairReport::default() };
    repair.drop_unused();
    repair.weld(weld.unwrap_or(0.0));
    repair.drop_duplicates();
    if repair.edges().iter().any(|e| e.faces.len() == 1) {
        if weld.is_none() {
            repair.weld(f64::from(f32::EPSILON) * largest(&repair.soup.vertices));
            repair.drop_duplicates();
        }
        repair.stitch();
    }
    let mut crossing = usize::MAX;
    loop {
        repair.orient();
        repair.flatten();
        // Rounding may make the union's faces cross again, a few of them.
        match repair.unite() {
            Some(pairs) if pairs < crossing => crossing = pairs,
            _ => break,
        }
    }
    repair.nest();
    repair.finished()
}

/// Triangles under repair.
struct Repair {
    soup: TriangleSoup,
    report: RepairReport,
}

impl Repair {
    fn edges(&self) -> Vec<Edge> {
        edges(&self.soup.faces)
    }
    fn corners(&self, face: usize) -> [Vector; 3] {
        self.soup.faces[face].map(|v| self.soup.vertices[v as usize].into())
    }
    /// Centroid of a face.
    fn middle(&self, face: usize) -> [f64; 3] {
        (self.corners(face).iter().sum::<Vector>() / 3.0).into()
    }
    fn middles(&self, faces: impl IntoIterator<Item = usize>) -> Vec<[f64; 3]> {
        faces.into_iter().map(|f| self.middle(f)).collect()
    }

    /// Leaves out vertices of no face.
    fn drop_unused(&mut self) {
        let mut used = self.soup.faces.as_flattened().to_vec();
        used.sort_unstable();
        used.dedup();
        let number = |v: u32| used.binary_search(&v).unwrap_or(0) as u32;
        self.soup.faces.iter_mut().flatten().for_each(|v| *v = number(*v));
        self.soup.vertices = used.iter().map(|v| self.soup.vertices[*v as usize]).collect();
    }

    /// Joins vertices up to a tolerance \[m\], and leaves out faces that lose a corner.
    fn weld(&mut self, tolerance: f64) {
        let welded = Welded::new(&self.soup.vertices, tolerance);
        self.report.tolerance = tolerance;
        let mut next = 0;
        let joined = welded.number.iter().zip(&self.soup.vertices).filter(|(number, _)| {
            let joined = **number != next;
            next += u32::from(!joined);
            joined
        });
        self.report.welded.add(joined.map(|(_, place)| *place));
        let faces: Vec<[u32; 3]> = welded.faces(&self.soup.faces).collect();
        let collapsed = faces.iter().filter(|f| is_collapsed(**f)).map(|f| welded.kept[f[0] as usize]);
        self.report.collapsed.add(collapsed);
        self.soup.faces = faces.into_iter().filter(|f| !is_collapsed(*f)).collect();
        self.soup.vertices = welded.kept;
    }

    fn drop_duplicates(&mut self) {
        let (kept, left_out) = duplicates::split(&self.soup.faces);
        self.report.duplicates.add(self.middles(left_out));
        self.soup.faces = kept.into_iter().map(|f| self.soup.faces[f]).collect();
    }

    /// Divides faces at vertices in the middle of open edges.
    fn stitch(&mut self) {
        let (vertices, tolerance) = (&self.soup.vertices, self.report.tolerance);
        if let Some((faces, at)) = stitches::stitch(vertices, &self.soup.faces, &self.edges(), tolerance) {
            self.report.stitched.add(at.into_iter().map(|v| vertices[v as usize]));
            self.soup.faces = faces;
        }
    }

    /// Turns faces to agree with their neighbours.
    fn orient(&mut self) {
        let sheets = Sheets::new(&self.soup.faces, &self.edges());
        self.report.turned.add(self.middles(sheets.turned.iter().map(|f| *f as usize)));
        for f in sheets.turned {
            self.soup.faces[f as usize].swap(1, 2);
        }
    }

    /// Flips faces without area with their neighbours; of those without one, joins ends of edges
    /// without length and leaves out what hangs on a single edge.
    fn flatten(&mut self) {
        let thickness = self.report.tolerance;
        loop {
            let flat = FlatFaces::flip(&self.soup.vertices, &self.soup.faces, thickness);
            let (faces, flipped) = (flat.faces, flat.flipped);
            self.report.flat.add(self.middles(flipped));
            self.soup.faces = faces;
            // Two that cover each other may be left.
            self.drop_duplicates();
            let flat = (0..self.soup.faces.len()).filter(|f| is_flat(self.corners(*f), thickness));
            let flat: Vec<[u32; 3]> = flat.map(|f| self.soup.faces[f]).collect();
            if !self.collapse(&flat) && !self.leave_out(&flat) {
                return;
            }
        }
    }

    /// Joins the ends of the edges of some flat faces that are flat themselves; false if none is.
    fn collapse(&mut self, flat: &[[u32; 3]]) -> bool {
        let mut joined = Sets::new(self.soup.vertices.len());
        let at = |v: u32| Vector::from(self.soup.vertices[v as usize]);
        let mut places = Vec::new();
        for face in flat {
            let edges = [0, 1, 2].map(|i| [face[i], face[(i + 1) % 3]]);
            let length = |[a, b]: [u32; 2]| (at(b) - at(a)).norm();
            let longest = edges.map(length).into_iter().fold(0.0, f64::max);
            for [a, b] in edges {
                if length([a, b]) <= (FLAT * longest).max(self.report.tolerance)
                    && joined.find(a) != joined.find(b)
                {
                    joined.join(a, b);
                    places.push(self.soup.vertices[b as usize]);
                }
            }
        }
        let any = !places.is_empty();
        self.report.welded.add(places);
        let faces = self.soup.faces.iter().map(|f| f.map(|v| joined.find(v)));
        let (gone, left): (Vec<[u32; 3]>, Vec<[u32; 3]>) = faces.partition(|f| is_collapsed(*f));
        self.report.collapsed.add(gone.into_iter().map(|f| self.soup.vertices[f[0] as usize]));
        self.soup.faces = left;
        any
    }

    /// Leaves out those of some flat faces of which two or three edges belong to an odd number of
    /// faces: without them no more do. False if there are none.
    fn leave_out(&mut self, flat: &[[u32; 3]]) -> bool {
        let mut odd: HashSet<[u32; 2]> =
            self.edges().iter().filter(|e| e.faces.len() % 2 == 1).map(|e| e.ends).collect();
        let sides = |[a, b, c]: [u32; 3]| [(a, b), (b, c), (c, a)].map(|(a, b)| [a.min(b), a.max(b)]);
        let mut left_out = HashSet::new();
        for face in flat {
            if sides(*face).iter().filter(|side| odd.contains(*side)).count() >= 2 && left_out.insert(*face) {
                for side in sides(*face) {
                    if !odd.remove(&side) {
                        odd.insert(side);
                    }
                }
            }
        }
        let gone = (0..self.soup.faces.len()).filter(|f| left_out.contains(&self.soup.faces[*f]));
        self.report.flat.add(self.middles(gone.collect::<Vec<_>>()));
        self.soup.faces.retain(|f| !left_out.contains(f));
        !left_out.is_empty()
    }

    /// Unites closed parts that cross or share edges, and each that crosses itself. Returns how many
    /// pairs of faces crossed; `None` if nothing was united.
    fn unite(&mut self) -> Option<usize> {
        let (edges, faces) = (self.edges(), &self.soup.faces);
        let sheets = Sheets::new(faces, &edges);
        let number: Vec<usize> = (0..faces.len()).filter(|f| !is_flat(self.corners(*f), 0.0)).collect();
        let solid: Vec<[u32; 3]> = number.iter().map(|f| faces[*f]).collect();
        let pairs = FaceTree::new(&solid, &self.soup.vertices).crossing_pairs(&number);
        // Parts that are united, in groups.
        let mut groups = Sets::new(sheets.open.len());
        let mut affected = vec![false; sheets.open.len()];
        let mut join = |f: usize, g: usize| {
            let [f, g] = [f, g].map(|f| sheets.sheet[f]);
            groups.join(f, g);
            (affected[f as usize], affected[g as usize]) = (true, true);
        };
        pairs.iter().for_each(|[f, g]| join(*f, *g));
        for edge in edges.iter().filter(|e| e.faces.len() > 2) {
            edge.faces.windows(2).for_each(|p| join(p[0].0 as usize, p[1].0 as usize));
        }
        if !affected.contains(&true) {
            return None;
        }
        let volumes = sheets.volumes(faces, &self.soup.vertices);
        let inward = |part: u32| {
            let part = part as usize;
            affected[part] && !sheets.open[part] && volumes[part] < 0.0
        };
        let mut members: Vec<Vec<[u32; 3]>> = vec![Vec::new(); sheets.open.len()];
        for (face, part) in faces.iter().zip(&sheets.sheet) {
            let [a, b, c] = *face;
            members[groups.find(*part) as usize].push(if inward(*part) { [a, c, b] } else { *face });
        }
        let mut united = TriangleSoup { vertices: self.soup.vertices.clone(), faces: Vec::new() };
        for (part, faces) in members.into_iter().enumerate() {
            if !affected[part] || faces.is_empty() {
                united.faces.extend(faces);
                continue;
            }
            let part = union::united(&self.soup.vertices, &faces)?;
            let first = united.vertices.len() as u32;
            united.vertices.extend(part.vertices);
            united.faces.extend(part.faces.into_iter().map(|f| f.map(|v| v + first)));
        }
        let turned = (0..sheets.open.len() as u32).filter(|part| inward(*part));
        let first = turned.filter_map(|part| sheets.sheet.iter().position(|p| *p == part));
        self.report.turned_shells.add(self.middles(first));
        self.report.united.add(self.middles(pairs.iter().map(|pair| pair[0])));
        self.soup = united;
        self.drop_unused();
        Some(pairs.len())
    }

    /// Turns closed parts outward, and those within an odd number of others inward.
    fn nest(&mut self) {
        let survey = survey(&self.soup.vertices, &self.soup.faces);
        // Shells of opposite signs may have no volume together.
        let of_signs = |f: &MeshError| matches!(f, MeshError::InsideOut { .. } | MeshError::Flat { .. });
        if !survey.faults.iter().all(of_signs) {
            return;
        }
        let sheets = Sheets::new(&self.soup.faces, &self.edges());
        for shell in survey.shells.iter().filter(|s| (s.volume < 0.0) != (s.depth % 2 == 1)) {
            let part = sheets.sheet[shell.first];
            self.report.turned_shells.add([self.middle(shell.first)]);
            for (face, _) in self.soup.faces.iter_mut().zip(&sheets.sheet).filter(|(_, p)| **p == part) {
                face.swap(1, 2);
            }
        }
    }

    /// The result, if it is a body.
    fn finished(mut self) -> Result<(TriangleSoup, RepairReport), MeshError> {
        self.drop_unused();
        let survey = survey(&self.soup.vertices, &self.soup.faces);
        let Some(fault) = survey.faults.into_iter().next() else { return Ok((self.soup, self.report)) };
        let at = self.place(&fault);
        Err(MeshError::NotRepaired { fault: Box::new(fault), at, report: Box::new(self.report) })
    }

    /// Place of the first face or vertex that a fault names, or of the first vertex.
    fn place(&self, fault: &MeshError) -> [f64; 3] {
        let face = match fault {
            MeshError::Degenerate { faces, .. }
            | MeshError::NotClosed { faces, .. }
            | MeshError::NotManifold { faces, .. }
            | MeshError::InsideOut { faces, .. } => faces.first().copied(),
            MeshError::Inconsistent { faces, .. }
            | MeshError::Duplicate { faces, .. }
            | MeshError::SelfIntersecting { faces, .. } => faces.first().map(|pair| pair[0]),
            _ => None,
        };
        let vertex = match fault {
            MeshError::Pinched { vertices, .. } => vertices.first().copied(),
            MeshError::Coincident { vertices, .. } => vertices.first().map(|pair| pair[0]),
            _ => None,
        };
        let vertex = vertex.map(|v| self.soup.vertices[v as usize]);
        face.map(|f| self.middle(f)).or(vertex).or(self.soup.vertices.first().copied()).unwrap_or_default()
    }
}
