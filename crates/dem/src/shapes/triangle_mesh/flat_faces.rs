//! Faces without area in a closed surface.
use interfaces::Vector;
use std::collections::HashMap;

/// A face is flat if its least height is a smaller share of its longest edge: round-off of its
/// coordinates.
pub(crate) const FLAT: f64 = 1e-14;

/// Least height of a triangle over its longest edge; NaN if its corners are at one place.
pub(crate) fn relative_height([a, b, c]: [Vector; 3]) -> f64 {
    let longest = (b - a).norm_squared().max((c - a).norm_squared()).max((c - b).norm_squared());
    (b - a).cross(&(c - a)).norm() / longest
}

/// Whether a triangle has no area: its least height is round-off of its longest edge, or less than
/// `thickness` \[m\].
pub(crate) fn is_flat(corners: [Vector; 3], thickness: f64) -> bool {
    let [a, b, c] = corners;
    let height = relative_height(corners);
    // Nothing is larger if they are all one point.
    !(height > FLAT && height * (b - a).norm().max((c - a).norm()).max((c - b).norm()) > thickness)
}

/// No face, or more than one.
const NONE: u32 = u32::MAX;

/// Faces of a surface, in which those without area are flipped away.
///
/// A face abm whose corner m lies on its edge ab makes an edge with a vertex in its middle closed to
/// a neighbour bac that has none: together they cover mac and mcb, which have areas. The surface
/// stays as it is, and closed.
pub(crate) struct FlatFaces<'a> {
    vertices: &'a [[f64; 3]],
    thickness: f64,
    pub(crate) faces: Vec<[u32; 3]>,
    /// The only face along each directed edge.
    along: HashMap<[u32; 2], u32>,
    /// Faces without area that were flipped.
    pub(crate) flipped: Vec<usize>,
}

impl<'a> FlatFaces<'a> {
    /// Flips those of the `faces` that are flat, within `thickness` \[m\], and have a neighbour to
    /// flip with. Some may be left.
    pub(crate) fn flip(vertices: &'a [[f64; 3]], faces: &[[u32; 3]], thickness: f64) -> Self {
        let mut own =
            Self { vertices, thickness, faces: faces.to_vec(), along: HashMap::new(), flipped: Vec::new() };
        let mut flat: Vec<u32> = (0..faces.len() as u32).filter(|f| own.is_flat(*f)).collect();
        if flat.is_empty() {
            return own;
        }
        for (f, face) in own.faces.iter().enumerate() {
            for side in sides(*face) {
                own.along.entry(side).and_modify(|g| *g = NONE).or_insert(f as u32);
            }
        }
        flat.reverse();
        while let Some(f) = flat.pop() {
            if let Some(changed) = own.flip_one(f) {
                own.flipped.push(f as usize);
                // Their neighbours may have become ones to flip with.
                let around = changed.into_iter().flat_map(|f| {
                    let across = |[a, b]: [u32; 2]| own.along.get(&[b, a]).copied();
                    sides(own.faces[f as usize]).into_iter().filter_map(across).chain([f])
                });
                flat.extend(around.filter(|g| *g != NONE && own.is_flat(*g)));
            }
        }
        own.flipped.sort_unstable();
        own.flipped.dedup();
        own
    }

    /// Corners of a face, if they exist and are numbers.
    fn corners(&self, face: [u32; 3]) -> Option<[Vector; 3]> {
        let place = |v: u32| self.vertices.get(v as usize).map(|v| Vector::from(*v));
        let [Some(a), Some(b), Some(c)] = face.map(place) else { return None };
        [a, b, c].iter().flatten().all(|x| x.abs() <= super::admission::LARGEST).then_some([a, b, c])
    }
    fn flat(&self, face: [u32; 3]) -> bool {
        self.corners(face).is_some_and(|corners| is_flat(corners, self.thickness))
    }
    fn is_flat(&self, face: u32) -> bool {
        self.flat(self.faces[face as usize])
    }

    /// Flips the longest edge of a flat face, if that leaves fewer flat ones, or as many with a
    /// shorter edge between them (so that it ends), and no edge of more than two faces.
    fn flip_one(&mut self, f: u32) -> Option<[u32; 2]> {
        let face = self.faces[f as usize];
        let corners = self.corners(face).filter(|_| self.is_flat(f))?;
        let length = |i: usize| (corners[(i + 1) % 3] - corners[i]).norm_squared();
        let i = (0..3).max_by(|i, j| length(*i).total_cmp(&length(*j)))?;
        let [a, b, m] = [0, 1, 2].map(|k| face[(i + k) % 3]);
        let g = *self.along.get(&[b, a]).filter(|g| **g != NONE && **g != f)?;
        let c = self.faces[g as usize].into_iter().find(|v| *v != a && *v != b)?;
        let clear = |side: [u32; 2]| !self.along.contains_key(&side);
        let known = |side: [u32; 2]| self.along.get(&side).is_some_and(|f| *f != NONE);
        if c == m || a == b || !known([a, b]) || !clear([m, c]) || !clear([c, m]) {
            return None;
        }
        let (new_f, new_g) = ([m, a, c], [m, c, b]);
        let count = |faces: [[u32; 3]; 2]| faces.into_iter().filter(|face| self.flat(*face)).count();
        let (before, after) = (count([face, self.faces[g as usize]]), count([new_f, new_g]));
        let across = Vector::from(self.vertices[m as usize]) - Vector::from(*self.vertices.get(c as usize)?);
        if after > before || (after == before && across.norm_squared() >= length(i)) {
            return None;
        }
        self.along.remove(&[a, b]);
        self.along.remove(&[b, a]);
        for (number, face) in [(f, new_f), (g, new_g)] {
            self.faces[number as usize] = face;
            for side in sides(face) {
                // Edges of several faces stay so.
                self.along
                    .entry(side)
                    .and_modify(|g| *g = if *g == NONE { NONE } else { number })
                    .or_insert(number);
            }
        }
        Some([f, g])
    }
}

/// The directed edges of a face.
fn sides([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}
