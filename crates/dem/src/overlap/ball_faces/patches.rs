//! Which faces within the ball hang together, and which of these sheets bound the same region.
use super::{TOUCH, face::Part};
use interfaces::Vector;

/// Rounding errors may hide a shorter edge, in radii, from one of its faces.
const SHORT: f64 = 1e-5;

/// The faces that a ball reaches: what they contribute, their corners, and the edges that the ball cuts.
///
/// Faces that share an edge within the ball form a sheet, which parts the ball in two: the side of the centre and the one beyond.
/// What lies beyond is the body's next to a sheet that looks at the centre (an entry), and is not next to one that looks away (an
/// exit). Every entry begins a region of its own; an exit ends the region of the innermost entry beyond which it lies, or the one
/// around the centre.
#[derive(Clone, Debug, Default)]
pub(super) struct Patches {
    parts: Vec<Part>,
    corners: Vec<Vector>,
    /// Where the corners of each part end.
    ends: Vec<usize>,
    /// The numbers of an edge's vertices in one, the part, and whether the edge is long enough for the face beyond to know of it.
    edges: Vec<(u64, u32, bool)>,
    /// A part of the same sheet; the first of a sheet has itself.
    root: Vec<u32>,
    sheets: Vec<Sheet>,
}

#[derive(Clone, Copy, Debug)]
struct Sheet {
    root: u32,
    /// The largest part, its area, Σ of what lies beyond and of the amounts that it is made of.
    largest: u32,
    area: f64,
    beyond: f64,
    amount: f64,
    /// Behind how many others it lies, and the first part of the entry whose region it bounds; `None`: the one around the centre.
    depth: usize,
    region: Option<u32>,
}

impl Patches {
    pub(super) fn clear(&mut self) {
        self.parts.clear();
        self.corners.clear();
        self.ends.clear();
        self.edges.clear();
    }
    /// `length` of the next part's edge from vertex `p` to `q` is within the ball.
    pub(super) fn cut(&mut self, p: u32, q: u32, length: f64) {
        let edge = u64::from(p.min(q)) << 32 | u64::from(p.max(q));
        self.edges.push((edge, self.parts.len() as u32, length > SHORT));
    }
    /// The next part.
    pub(super) fn push(&mut self, part: Part, corners: &[Vector]) {
        self.parts.push(part);
        self.corners.extend_from_slice(corners);
        self.ends.push(self.corners.len());
    }

    /// Joins the parts along their edges; whether they form more than one sheet. They are taken for one where the mesh does
    /// not tell what hangs together, since an edge has a face on one side only (corners that are stored once per face).
    pub(super) fn several(&mut self) -> bool {
        let n = self.parts.len();
        self.root.clear();
        self.root.extend(0..n as u32);
        self.edges.sort_unstable();
        let (mut sheets, mut i) = (n, 0);
        while i < self.edges.len() {
            let (edge, first, long) = self.edges[i];
            let mut faces = 1;
            while let Some(&(_, part, _)) = self.edges.get(i + faces).filter(|e| e.0 == edge) {
                let (a, b) = (self.set(first), self.set(part));
                if a != b {
                    self.root[a.max(b) as usize] = a.min(b);
                    sheets -= 1;
                }
                faces += 1;
            }
            if faces == 1 && long {
                return false;
            }
            i += faces;
        }
        sheets > 1
    }
    /// The first part of the sheet of `part`.
    fn set(&mut self, mut part: u32) -> u32 {
        while self.root[part as usize] != part {
            let next = self.root[part as usize];
            self.root[part as usize] = self.root[next as usize];
            part = next;
        }
        part
    }

    /// Calls `region` with the parts of each region, and whether it is the one around the centre.
    pub(super) fn regions<'a>(
        &'a mut self,
        mut region: impl FnMut(bool, &mut dyn Iterator<Item = &'a Part>),
    ) {
        self.find_sheets();
        self.nest();
        for i in 0..self.root.len() {
            self.root[i] = self.set(i as u32);
        }
        let Self { parts, root, sheets, .. } = &*self;
        let around = |part: usize| sheets.iter().find(|s| s.root == root[part]).and_then(|s| s.region);
        let of =
            |r: Option<u32>| parts.iter().enumerate().filter(move |(i, _)| around(*i) == r).map(|(_, p)| p);
        if sheets.iter().any(|s| s.region.is_none()) {
            region(true, &mut of(None));
        }
        for sheet in sheets.iter().filter(|s| s.region == Some(s.root)) {
            region(false, &mut of(sheet.region));
        }
    }

    fn find_sheets(&mut self) {
        self.sheets.clear();
        for i in 0..self.parts.len() as u32 {
            let root = self.set(i);
            let part = &self.parts[i as usize];
            let at = self.sheets.iter().position(|s| s.root == root).unwrap_or_else(|| {
                self.sheets.push(Sheet {
                    root,
                    largest: i,
                    area: 0.0,
                    beyond: 0.0,
                    amount: 0.0,
                    depth: 0,
                    region: None,
                });
                self.sheets.len() - 1
            });
            let sheet = &mut self.sheets[at];
            sheet.beyond += part.beyond;
            sheet.amount += part.amount;
            if part.area > sheet.area {
                (sheet.area, sheet.largest) = (part.area, i);
            }
        }
    }

    /// Finds behind which others each sheet lies.
    fn nest(&mut self) {
        let n = self.sheets.len();
        let behind =
            |this: &Self, j: usize, k: usize| j != k && this.behind(&this.sheets[j], this.sheets[k].root);
        for j in 0..n {
            self.sheets[j].depth = (0..n).filter(|&k| behind(self, j, k)).count();
        }
        for j in 0..n {
            let sheet = self.sheets[j];
            // What looks like an exit may be a mere touch, which has no region.
            self.sheets[j].region = if sheet.beyond < 0.0 || sheet.amount < TOUCH {
                Some(sheet.root)
            } else {
                let around = (0..n).filter(|&k| self.sheets[k].beyond < 0.0 && behind(self, j, k));
                around.max_by_key(|&k| self.sheets[k].depth).map(|k| self.sheets[k].root)
            };
        }
    }

    /// Whether `sheet` lies behind the one with this `root`: a ray to a point of it crosses that one an odd number of times.
    fn behind(&self, sheet: &Sheet, root: u32) -> bool {
        let part = &self.parts[sheet.largest as usize];
        let x = part.moment / part.area;
        let root_of = |mut p: u32| {
            while self.root[p as usize] != p {
                p = self.root[p as usize];
            }
            p
        };
        let crossed = |i: &usize| {
            let from = if *i == 0 { 0 } else { self.ends[i - 1] };
            crosses(x, self.parts[*i].normal, &self.corners[from..self.ends[*i]])
        };
        (0..self.parts.len()).filter(|i| root_of(*i as u32) == root).filter(crossed).count() % 2 == 1
    }
}

/// Whether the way from the origin to `x` crosses a convex face.
fn crosses(x: Vector, normal: Vector, corners: &[Vector]) -> bool {
    let (to_plane, to_x) = (normal.dot(&corners[0]), normal.dot(&x));
    if to_plane.abs() >= to_x.abs() || (to_plane < 0.0) != (to_x < 0.0) {
        return false;
    }
    // On which side of the ray an edge passes; the neighbour, which runs along it the other way, hears the opposite.
    let left = |p: &Vector, q: &Vector| {
        let side = x.dot(&p.cross(q));
        if side == 0.0 { p.as_slice() < q.as_slice() } else { side > 0.0 }
    };
    let inside = |p, q, r| {
        let first = left(p, q);
        first == left(q, r) && first == left(r, p)
    };
    corners[1..].windows(2).filter(|pair| inside(&corners[0], &pair[0], &pair[1])).count() % 2 == 1
}
