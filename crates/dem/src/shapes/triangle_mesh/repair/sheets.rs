//! Connected parts of a surface whose edges may belong to several faces.
use super::super::topology::Sets;
use interfaces::Vector;

/// The faces along an edge.
pub(super) struct Edge {
    pub(super) ends: [u32; 2],
    /// Faces, and whether each runs from the first end to the second.
    pub(super) faces: Vec<(u32, bool)>,
}

/// The edges of faces, in order of their ends. No face has a vertex twice.
pub(super) fn edges(faces: &[[u32; 3]]) -> Vec<Edge> {
    let mut sides: Vec<([u32; 2], u32, bool)> = Vec::with_capacity(3 * faces.len());
    for (f, [a, b, c]) in faces.iter().enumerate() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            sides.push(([*from.min(to), *from.max(to)], f as u32, from < to));
        }
    }
    sides.sort_unstable();
    let chunks = sides.chunk_by(|s, t| s.0 == t.0);
    chunks
        .map(|sharing| Edge { ends: sharing[0].0, faces: sharing.iter().map(|s| (s.1, s.2)).collect() })
        .collect()
}

/// Parts of a surface that are connected by edges of two faces.
pub(super) struct Sheets {
    /// The part of each face.
    pub(super) sheet: Vec<u32>,
    /// Faces that disagree with most of their part on which side is outside.
    pub(super) turned: Vec<u32>,
    /// Parts with an edge that belongs to an odd number of their faces.
    pub(super) open: Vec<bool>,
}

impl Sheets {
    pub(super) fn new(faces: &[[u32; 3]], edges: &[Edge]) -> Self {
        // Every face twice, as it is and turned; neighbours agree on one side of either.
        let n = faces.len() as u32;
        let mut sides = Sets::new(2 * faces.len());
        for edge in edges {
            if let [(f, up), (g, other)] = edge.faces[..] {
                let turned = if up == other { n } else { 0 };
                sides.join(f, g + turned);
                sides.join(f + n, g + n - turned);
            }
        }
        let mut parts = Sets::new(faces.len());
        for edge in edges.iter().filter(|e| e.faces.len() == 2) {
            parts.join(edge.faces[0].0, edge.faces[1].0);
        }
        let mut sheet = vec![0; faces.len()];
        let mut members: Vec<Vec<u32>> = Vec::new();
        for f in 0..n {
            let first = parts.find(f);
            if first == f {
                sheet[f as usize] = members.len() as u32;
                members.push(Vec::new());
            }
            sheet[f as usize] = sheet[first as usize];
            members[sheet[f as usize] as usize].push(f);
        }
        let mut turned = Vec::new();
        for part in &members {
            let like = sides.find(part[0]);
            let (alike, unlike): (Vec<u32>, Vec<u32>) = part.iter().partition(|f| sides.find(**f) == like);
            turned.extend(if unlike.len() > alike.len() { alike } else { unlike });
        }
        turned.sort_unstable();
        let mut open = vec![false; members.len()];
        for edge in edges {
            let mut around: Vec<u32> = edge.faces.iter().map(|(f, _)| sheet[*f as usize]).collect();
            around.sort_unstable();
            for same in around.chunk_by(|s, t| s == t).filter(|same| same.len() % 2 == 1) {
                open[same[0] as usize] = true;
            }
        }
        Self { sheet, turned, open }
    }

    /// Volume within each part \[m³\], by the divergence theorem about the middle of the box.
    pub(super) fn volumes(&self, faces: &[[u32; 3]], vertices: &[[f64; 3]]) -> Vec<f64> {
        let at = |v: u32| Vector::from(vertices[v as usize]);
        let corners = || faces.as_flattened().iter().map(|v| at(*v));
        let low = corners().fold(Vector::repeat(f64::INFINITY), |low, c| low.inf(&c));
        let high = corners().fold(Vector::repeat(f64::NEG_INFINITY), |high, c| high.sup(&c));
        let middle = 0.5 * (low + high);
        let mut volumes = vec![0.0; self.open.len()];
        for (face, sheet) in faces.iter().zip(&self.sheet) {
            let [a, b, c] = face.map(|v| at(v) - middle);
            volumes[*sheet as usize] += a.dot(&b.cross(&c)) / 6.0;
        }
        volumes
    }
}
