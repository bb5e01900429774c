//! Sheets of a surface within a convex body, and the regions that they bound.
use interfaces::Vector;

/// Length of an edge, in sizes of the convex body, below which rounding may hide it from one of
/// its two faces.
const SHORT: f64 = 1e-5;

/// Area, in squared sizes of the convex body, that rounding makes of a mere touch: where a corner
/// is on the surface of a ball but for ε, a face has an area of ε^1.5 within the ball.
const TOUCH: f64 = 1e-20;

/// Faces of a closed surface that a convex body reaches.
///
/// Faces that share an edge within the convex body form a sheet, which separates it into two sides.
/// Two sheets bound the same region if each is on the inner side of the other and no third sheet
/// separates them. Sides follow from the parity of crossings on straight ways, which stay within
/// the convex body.
#[derive(Clone, Debug, Default)]
pub(super) struct Sheets {
    faces: Vec<Face>,
    corners: Vec<Vector>,
    /// Vertex numbers of an edge in one, the face, and whether the edge is long.
    edges: Vec<(u64, u32, bool)>,
    /// A face of the same sheet; the first face of a sheet has itself.
    root: Vec<u32>,
    /// Areas of the sheets, by their first faces.
    areas: Vec<f64>,
    /// First faces of the sheets.
    sheets: Vec<u32>,
    /// One row per sheet and origin: true where the inner side of the sheet, or the origin, is on
    /// the inner side of another sheet.
    sides: Vec<bool>,
}

/// A convex face.
#[derive(Clone, Copy, Debug)]
struct Face {
    /// Outward unit normal.
    normal: Vector,
    /// Area within the convex body.
    area: f64,
    /// Centroid of that area.
    centre: Vector,
    /// End of its corners in the list of all.
    end: usize,
}

impl Sheets {
    pub(super) fn clear(&mut self) {
        self.faces.clear();
        self.corners.clear();
        self.edges.clear();
    }
    /// Registers that a `length` of the edge of the next face from vertex `p` to `q` is within the
    /// convex body.
    pub(super) fn cut(&mut self, p: u32, q: u32, length: f64) {
        let edge = u64::from(p.min(q)) << 32 | u64::from(p.max(q));
        self.edges.push((edge, self.faces.len() as u32, length > SHORT));
    }
    /// Adds a face by its outward unit normal, ∫ dA and ∫ x dA within the convex body, and its
    /// corners.
    pub(super) fn push(&mut self, normal: Vector, area: f64, moment: Vector, corners: &[Vector]) {
        self.corners.extend_from_slice(corners);
        let end = self.corners.len();
        // Zero also where it is not a number.
        let (area, centre) = if area > 0.0 { (area, moment / area) } else { (0.0, corners[0]) };
        self.faces.push(Face { normal, area, centre, end });
    }

    /// Joins the faces along their edges and returns whether there is more than one sheet, mere
    /// touches apart. False as well where an edge has a single face (meshes that store corners once
    /// per face).
    pub(super) fn several(&mut self) -> bool {
        let n = self.faces.len();
        self.root.clear();
        self.root.extend(0..n as u32);
        self.edges.sort_unstable();
        let mut i = 0;
        while i < self.edges.len() {
            let (edge, first, long) = self.edges[i];
            let mut faces = 1;
            while let Some(&(_, face, _)) = self.edges.get(i + faces).filter(|e| e.0 == edge) {
                let (a, b) = (self.first_of(first), self.first_of(face));
                self.root[a.max(b) as usize] = a.min(b);
                faces += 1;
            }
            if faces == 1 && long {
                return false;
            }
            i += faces;
        }
        self.areas.clear();
        self.areas.resize(n, 0.0);
        for i in 0..n {
            self.root[i] = self.first_of(i as u32);
            self.areas[self.root[i] as usize] += self.faces[i].area;
        }
        self.sheets.clear();
        self.sheets.extend((0..n as u32).filter(|i| self.areas[*i as usize] > TOUCH));
        self.sheets.len() > 1
    }
    /// First face of the sheet of a face.
    fn first_of(&mut self, mut face: u32) -> u32 {
        while self.root[face as usize] != face {
            let next = self.root[face as usize];
            self.root[face as usize] = self.root[next as usize];
            face = next;
        }
        face
    }

    /// Finds the regions that [several](Self::several) sheets bound: calls `region` with the
    /// numbers of the faces of each, and with whether each of the `origins`, points within the
    /// convex body, is in it.
    pub(super) fn regions<const N: usize>(
        &mut self,
        origins: [Vector; N],
        mut region: impl FnMut([bool; N], &mut dyn Iterator<Item = usize>),
    ) {
        let n = self.sheets.len();
        self.sides.clear();
        for i in 0..n {
            let largest = self.faces_of(i).max_by(|x, y| self.faces[*x].area.total_cmp(&self.faces[*y].area));
            let Some(from) = largest.map(|f| self.faces[f].centre) else { return };
            for j in 0..n {
                let inner = i == j || self.is_inner(from, j);
                self.sides.push(inner);
            }
        }
        for (x, j) in origins.iter().flat_map(|x| (0..n).map(move |j| (x, j))) {
            let inner = self.is_inner(*x, j);
            self.sides.push(inner);
        }
        let row = |i: usize| &self.sides[i * n..(i + 1) * n];
        for i in (0..n).filter(|i| (0..*i).all(|j| row(j) != row(*i))) {
            let origins = std::array::from_fn(|k| row(n + k) == row(i));
            let sheets = (i..n).filter(|j| row(*j) == row(i));
            region(origins, &mut sheets.flat_map(|j| self.faces_of(j)));
        }
    }
    /// Numbers of the faces of a sheet.
    fn faces_of(&self, sheet: usize) -> impl Iterator<Item = usize> {
        let root = self.sheets[sheet];
        (0..self.faces.len()).filter(move |f| self.root[*f] == root)
    }
    /// Whether a point off a sheet is on its inner side: parity of the crossings on the way to its
    /// face that looks largest from there.
    fn is_inner(&self, x: Vector, sheet: usize) -> bool {
        let seen = |f: &usize| {
            let face = &self.faces[*f];
            let way = face.centre - x;
            face.area * face.normal.dot(&way).abs() / way.norm_squared().max(f64::MIN_POSITIVE)
        };
        let Some(last) = self.faces_of(sheet).max_by(|p, q| seen(p).total_cmp(&seen(q))) else {
            return false;
        };
        let way = self.faces[last].centre - x;
        let crossed = self.faces_of(sheet).filter(|f| *f != last && self.crosses(x, way, *f)).count();
        (self.faces[last].normal.dot(&way) > 0.0) == (crossed % 2 == 0)
    }
    /// Whether the way from `x` to x + `way` crosses a face.
    fn crosses(&self, x: Vector, way: Vector, face: usize) -> bool {
        let from = if face == 0 { 0 } else { self.faces[face - 1].end };
        let Face { normal, end, .. } = self.faces[face];
        let corners = &self.corners[from..end];
        let (to_plane, to_end) = (normal.dot(&(corners[0] - x)), normal.dot(&way));
        if to_plane.abs() >= to_end.abs() || (to_plane < 0.0) != (to_end < 0.0) {
            return false;
        }
        // Side of the way on which an edge passes. The neighbour, whose edge is opposite, gets the
        // opposite.
        let left = |p: &Vector, q: &Vector| {
            let side = way.dot(&(p - x).cross(&(q - x)));
            if side == 0.0 { p.as_slice() < q.as_slice() } else { side > 0.0 }
        };
        let inside = |p, q, r| {
            let first = left(p, q);
            first == left(q, r) && first == left(r, p)
        };
        corners[1..].windows(2).filter(|pair| inside(&corners[0], &pair[0], &pair[1])).count() % 2 == 1
    }
}
