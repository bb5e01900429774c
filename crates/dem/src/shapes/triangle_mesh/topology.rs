//! How the faces of a mesh hang together.
use super::error::{MeshError, named};

/// Sets that grow together.
#[derive(Clone, Debug)]
pub(crate) struct Sets(Vec<u32>);

impl Sets {
    /// So many, each by itself.
    pub(crate) fn new(n: usize) -> Self {
        Self((0..n as u32).collect())
    }
    /// One of the set, the same for all that are in it.
    pub(crate) fn find(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            self.0[i as usize] = self.0[self.0[i as usize] as usize];
            i = self.0[i as usize];
        }
        i
    }
    pub(crate) fn join(&mut self, i: u32, j: u32) {
        let (i, j) = (self.find(i), self.find(j));
        // The first of a set stands for it.
        self.0[i.max(j) as usize] = i.min(j);
    }
}

/// An edge of a face, its vertices in order of their numbers.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    low: u32,
    high: u32,
    /// Position in the list of faces.
    face: u32,
    /// At which of the face's corners it starts.
    corner: u8,
    /// Whether it runs from `low` to `high`.
    up: bool,
}

/// What is wrong with the edges and vertices of faces, and which parts are connected.
pub(crate) struct Topology {
    /// A face for every edge that only one has.
    open: Vec<usize>,
    /// Pairs that run along their edge in the same direction.
    opposed: Vec<[usize; 2]>,
    /// A face for every edge that more than two have.
    many: Vec<usize>,
    /// Vertices around which the faces make more than one fan.
    pinched: Vec<u32>,
    /// Pairs with the same three vertices.
    duplicates: Vec<[usize; 2]>,
    /// Connected parts: positions in the list of faces.
    pub(crate) shells: Vec<Vec<u32>>,
}

impl Topology {
    /// Of these faces and their numbers; no face has a vertex twice.
    pub(crate) fn new(faces: &[[u32; 3]], number: &[usize]) -> Self {
        let mut sides: Vec<Side> = Vec::with_capacity(3 * faces.len());
        for (f, vertices) in faces.iter().enumerate() {
            for corner in 0..3 {
                let (from, to) = (vertices[corner], vertices[(corner + 1) % 3]);
                let (low, high) = (from.min(to), from.max(to));
                sides.push(Side { low, high, face: f as u32, corner: corner as u8, up: from < to });
            }
        }
        sides.sort_unstable();
        let (mut open, mut opposed, mut many) = (Vec::new(), Vec::new(), Vec::new());
        let (mut parts, mut fans) = (Sets::new(faces.len()), Sets::new(3 * faces.len()));
        for sharing in sides.chunk_by(|s, t| (s.low, s.high) == (t.low, t.high)) {
            let number = |s: &Side| number[s.face as usize];
            match sharing {
                [s] => open.push(number(s)),
                [s, t] if s.up == t.up => opposed.push([number(s), number(t)]),
                [_, _] => {}
                _ => many.push(number(&sharing[0])),
            }
            for pair in sharing.windows(2) {
                parts.join(pair[0].face, pair[1].face);
                // Where the edge has its lower vertex, and its higher.
                let ends = [pair[0], pair[1]].map(|s| {
                    let (start, end) =
                        (3 * s.face + u32::from(s.corner), 3 * s.face + u32::from((s.corner + 1) % 3));
                    if s.up { [start, end] } else { [end, start] }
                });
                fans.join(ends[0][0], ends[1][0]);
                fans.join(ends[0][1], ends[1][1]);
            }
        }
        open.sort_unstable();
        many.sort_unstable();
        opposed.sort_unstable();
        let mut shells: Vec<Vec<u32>> = Vec::new();
        let mut place = vec![0; faces.len()];
        for f in 0..faces.len() as u32 {
            let first = parts.find(f);
            if first == f {
                place[f as usize] = shells.len();
                shells.push(Vec::new());
            }
            shells[place[first as usize]].push(f);
        }
        let (pinched, duplicates) = (pinched(faces, &mut fans), duplicates(faces, number));
        Self { open, opposed, many, pinched, duplicates, shells }
    }

    /// What keeps the faces from being a closed, oriented surface.
    pub(crate) fn edge_faults(&self) -> Vec<MeshError> {
        let distinct = |faces: &[usize]| {
            let mut faces = faces.to_vec();
            faces.dedup();
            named(faces)
        };
        let mut faults = Vec::new();
        if !self.many.is_empty() {
            faults.push(MeshError::NotManifold { count: self.many.len(), faces: distinct(&self.many) });
        }
        if !self.open.is_empty() {
            faults.push(MeshError::NotClosed { count: self.open.len(), faces: distinct(&self.open) });
        }
        if !self.opposed.is_empty() {
            let faces = named(self.opposed.clone());
            faults.push(MeshError::Inconsistent { count: self.opposed.len(), faces });
        }
        faults
    }

    /// What makes the surface touch itself in faces or vertices that are shared.
    pub(crate) fn vertex_faults(&self) -> Vec<MeshError> {
        let mut faults = Vec::new();
        if !self.duplicates.is_empty() {
            let faces = named(self.duplicates.clone());
            faults.push(MeshError::Duplicate { count: self.duplicates.len(), faces });
        }
        if !self.pinched.is_empty() {
            let vertices = named(self.pinched.clone());
            faults.push(MeshError::Pinched { count: self.pinched.len(), vertices });
        }
        faults
    }
}

/// The vertices at which the corners are in more than one set.
fn pinched(faces: &[[u32; 3]], fans: &mut Sets) -> Vec<u32> {
    let mut corners: Vec<(u32, u32)> = Vec::with_capacity(3 * faces.len());
    for (c, v) in faces.as_flattened().iter().enumerate() {
        corners.push((*v, fans.find(c as u32)));
    }
    corners.sort_unstable();
    corners.dedup();
    let mut pinched: Vec<u32> = corners.windows(2).filter(|c| c[0].0 == c[1].0).map(|c| c[0].0).collect();
    pinched.dedup();
    pinched
}

fn duplicates(faces: &[[u32; 3]], number: &[usize]) -> Vec<[usize; 2]> {
    let mut sorted: Vec<([u32; 3], usize)> = faces.iter().copied().zip(number.iter().copied()).collect();
    sorted.iter_mut().for_each(|(f, _)| f.sort_unstable());
    sorted.sort_unstable();
    let mut pairs: Vec<[usize; 2]> =
        sorted.windows(2).filter(|f| f[0].0 == f[1].0).map(|f| [f[0].1, f[1].1]).collect();
    pairs.sort_unstable();
    pairs
}
