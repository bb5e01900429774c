//! Quickhull with exact predicates.
use interfaces::Vector;
use robust::{Coord3D, orient3d};
use std::collections::HashMap;

/// A triangle of the hull of the points so far.
struct Facet {
    /// Counter-clockwise seen from outside.
    corners: [u32; 3],
    /// The facets across the edges from corner i to corner i + 1.
    across: [u32; 3],
    /// Points that are strictly beyond its plane and wait for their turn.
    beyond: Vec<u32>,
    alive: bool,
}

/// Is a point strictly on the outer side of the plane of a triangle?
fn sees(points: &[[f64; 3]], [a, b, c]: [u32; 3], p: u32) -> bool {
    let [a, b, c, p] = [a, b, c, p].map(|v| {
        let [x, y, z] = points[v as usize];
        Coord3D { x, y, z }
    });
    orient3d(a, b, c, p) < 0.0
}

/// The hull's triangles, counter-clockwise seen from outside, from four points that are not on a plane. Corners may be on the
/// edges of others' planes, but no point is beyond any of them, not even by round-off.
///
/// A point that sees a facet sees it strictly, so it is on the line of none of its edges: no triangle is degenerate. The
/// facets seen by a point are connected, and of the points beyond a facet that goes, those that are outside of the
/// hull see one of the facets that come (their planes are between those of the two facets at an edge of the horizon).
pub(crate) fn quickhull(points: &[[f64; 3]], start: [u32; 4]) -> Vec<[u32; 3]> {
    let [a, b, c, d] = start;
    let [a, b] = if sees(points, [a, b, c], d) { [b, a] } else { [a, b] };
    let mut hull = Hull { points, facets: Vec::new() };
    for corners in [[a, b, c], [a, d, b], [b, d, c], [c, d, a]] {
        hull.facets.push(Facet { corners, across: [0; 3], beyond: Vec::new(), alive: true });
    }
    hull.link(0, 0);
    hull.share((0..points.len() as u32).collect(), 0);
    let mut f = 0;
    while f < hull.facets.len() {
        // Those that come are at the end.
        if let Some(apex) = hull.farthest(f) {
            hull.add(f as u32, apex);
        }
        f += 1;
    }
    hull.facets.iter().filter(|f| f.alive).map(|f| f.corners).collect()
}

struct Hull<'a> {
    points: &'a [[f64; 3]],
    facets: Vec<Facet>,
}

impl Hull<'_> {
    fn at(&self, v: u32) -> Vector {
        self.points[v as usize].into()
    }

    /// Of the points beyond a facet that is there: about the farthest.
    fn farthest(&self, f: usize) -> Option<u32> {
        let facet = &self.facets[f];
        let [a, b, c] = facet.corners.map(|v| self.at(v));
        let normal = (b - a).cross(&(c - a));
        let height = |v: &u32| normal.dot(&(self.at(*v) - a));
        facet.beyond.iter().copied().filter(|_| facet.alive).max_by(|v, w| height(v).total_cmp(&height(w)))
    }

    /// Gives each of the points to a facet, from `first` on, that it sees; the others are within the hull.
    fn share(&mut self, points: Vec<u32>, first: usize) {
        for p in points {
            let seen = (first..self.facets.len()).find(|&f| sees(self.points, self.facets[f].corners, p));
            if let Some(f) = seen {
                self.facets[f].beyond.push(p);
            }
        }
    }

    /// Links the facets from `first` on with one another, across their edges from number `edge` on.
    fn link(&mut self, first: usize, edge: usize) {
        let mut sides: HashMap<(u32, u32), (usize, usize)> = HashMap::new();
        for f in first..self.facets.len() {
            let corners = self.facets[f].corners;
            for i in edge..3 {
                let (from, to) = (corners[i], corners[(i + 1) % 3]);
                if let Some((g, j)) = sides.remove(&(to, from)) {
                    self.facets[f].across[i] = g as u32;
                    self.facets[g].across[j] = f as u32;
                } else {
                    sides.insert((from, to), (f, i));
                }
            }
        }
    }

    /// Makes `apex`, which sees facet `from`, a corner.
    fn add(&mut self, from: u32, apex: u32) {
        let mut waiting = Vec::new();
        // Edges of facets that stay: their corners, seen from the facet that goes, and the facet.
        let mut horizon: Vec<(u32, u32, u32)> = Vec::new();
        self.facets[from as usize].alive = false;
        let mut seen = vec![from];
        while let Some(f) = seen.pop() {
            waiting.append(&mut self.facets[f as usize].beyond);
            for i in 0..3 {
                let Facet { corners, across, .. } = self.facets[f as usize];
                let g = across[i] as usize;
                if !self.facets[g].alive {
                    continue;
                }
                if sees(self.points, self.facets[g].corners, apex) {
                    self.facets[g].alive = false;
                    seen.push(g as u32);
                } else {
                    horizon.push((corners[i], corners[(i + 1) % 3], g as u32));
                }
            }
        }
        let first = self.facets.len();
        for (p, q, g) in horizon {
            let f = self.facets.len() as u32;
            self.facets.push(Facet {
                corners: [p, q, apex],
                across: [g, 0, 0],
                beyond: Vec::new(),
                alive: true,
            });
            let g = &mut self.facets[g as usize];
            for j in 0..3 {
                if (g.corners[j], g.corners[(j + 1) % 3]) == (q, p) {
                    g.across[j] = f;
                }
            }
        }
        // The first edges are the horizon.
        self.link(first, 1);
        waiting.retain(|p| *p != apex);
        self.share(waiting, first);
    }
}
