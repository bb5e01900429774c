//! The nodes along one axis.
use std::ops::Range;
use std::sync::Arc;

/// Nodes along one axis of a [`Lattice`](crate::Lattice), each with its control volume, equally
/// spaced or not. They are numbered from 0 and go on on both sides: repeated where the axis is
/// periodic, at the distance of the two last ones where it is bounded. Cheap to clone.
#[derive(Clone, Debug, PartialEq)]
pub struct Nodes {
    len: usize,
    periodic: bool,
    /// Place of node 0 \[m\].
    first: f64,
    /// Distance of neighbours \[m\]; their mean where they are not equally spaced.
    spacing: f64,
    table: Option<Table>,
}

/// Nodes that are not equally spaced.
#[derive(Clone, Debug)]
struct Table {
    /// Nodes −1 to n.
    places: Arc<[f64]>,
    /// Ends of the control volumes of the nodes 0 to n − 1: entries i and i + 1.
    edges: Arc<[f64]>,
}

impl PartialEq for Table {
    /// Copies of one table are not compared number by number.
    fn eq(&self, other: &Self) -> bool {
        let same = |a: &Arc<[f64]>, b: &Arc<[f64]>| Arc::ptr_eq(a, b) || a == b;
        same(&self.places, &other.places) && same(&self.edges, &other.edges)
    }
}

impl Nodes {
    /// `len` nodes from `first` \[m\], `spacing` \[m\] apart.
    pub fn uniform(first: f64, spacing: f64, len: usize, periodic: bool) -> Self {
        Self { len, periodic, first, spacing, table: None }
    }

    /// The centres of the cells between these increasing `faces` \[m\]; mirrored at bounded ends. Less than two
    /// faces have none.
    pub fn centres(faces: &[f64], periodic: bool) -> Self {
        let Some(n) = cells(faces) else { return Self::uniform(0.0, 1.0, 0, false) };
        let centre = |i: usize| 0.5 * (faces[i] + faces[i + 1]);
        let length = faces[n] - faces[0];
        let (below, above) = if periodic {
            (centre(n - 1) - length, centre(0) + length)
        } else {
            (2.0 * faces[0] - centre(0), 2.0 * faces[n] - centre(n - 1))
        };
        let places = std::iter::once(below).chain((0..n).map(centre)).chain([above]).collect();
        Self::stretched(places, faces.into(), periodic)
    }

    /// The `faces` \[m\] themselves, with control volumes from cell centre to cell centre: all but
    /// the first and last where the axis is bounded, all but the last where it is periodic.
    pub fn faces(faces: &[f64], periodic: bool) -> Self {
        let Some(n) = cells(faces) else { return Self::uniform(0.0, 1.0, 0, false) };
        let mut edges: Vec<f64> = faces.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
        let mut places = faces.to_vec();
        if periodic {
            let length = faces[n] - faces[0];
            edges.insert(0, edges[n - 1] - length);
            places.insert(0, faces[n - 1] - length);
        }
        Self::stretched(places, edges.into(), periodic)
    }

    fn stretched(places: Vec<f64>, edges: Arc<[f64]>, periodic: bool) -> Self {
        let len = places.len() - 2;
        let spacing = (edges[len] - edges[0]) / len.max(1) as f64;
        Self { len, periodic, first: places[1], spacing, table: Some(Table { places: places.into(), edges }) }
    }

    /// How many carry an unknown.
    pub fn len(&self) -> usize {
        self.len
    }
    /// Are there none?
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }
    /// Does the axis repeat?
    pub fn is_periodic(&self) -> bool {
        self.periodic
    }
    /// Are all equally spaced?
    pub fn is_uniform(&self) -> bool {
        self.table.is_none()
    }
    /// After which distance the nodes repeat \[m\], if they do.
    pub fn period(&self) -> Option<f64> {
        self.periodic.then_some(self.spacing * self.len as f64)
    }
    /// Mean distance of neighbours \[m\].
    pub fn mean_spacing(&self) -> f64 {
        self.spacing
    }
    /// Number of node `i` after wrapping; `None` outside a bounded axis.
    #[inline]
    pub fn wrap(&self, i: isize) -> Option<usize> {
        let n = self.len as isize;
        if (0..n).contains(&i) {
            Some(i as usize)
        } else {
            (self.periodic && n > 0).then(|| i.rem_euclid(n) as usize)
        }
    }
    /// Place of node `i` \[m\].
    #[inline]
    pub fn place(&self, i: isize) -> f64 {
        let Some(t) = &self.table else { return self.first + i as f64 * self.spacing };
        let (n, last) = (self.len as isize, t.places.len() - 1);
        if (-1..=n).contains(&i) {
            t.places[(i + 1) as usize]
        } else if self.periodic {
            t.places[i.rem_euclid(n) as usize + 1] + i.div_euclid(n) as f64 * self.spacing * self.len as f64
        } else if i < 0 {
            t.places[0] + (i + 1) as f64 * (t.places[1] - t.places[0])
        } else {
            t.places[last] + (i - n) as f64 * (t.places[last] - t.places[last - 1])
        }
    }
    /// Width of the control volume of node `i` \[m\]; outside a bounded axis, of the last one inside.
    #[inline]
    pub fn width(&self, i: isize) -> f64 {
        let Some(t) = &self.table else { return self.spacing };
        let n = self.len as isize;
        if n == 0 {
            return t.places[1] - t.places[0];
        }
        let i = if self.periodic { i.rem_euclid(n) } else { i.clamp(0, n - 1) } as usize;
        t.edges[i + 1] - t.edges[i]
    }
    /// Lower end of the control volume of node `i` \[m\], which is the upper end of that of node i − 1; beyond a bounded side
    /// volumes go on as wide as the last.
    pub fn edge(&self, i: isize) -> f64 {
        let Some(t) = &self.table else { return self.first + (i as f64 - 0.5) * self.spacing };
        let n = self.len as isize;
        if (0..=n).contains(&i) {
            t.edges[i as usize]
        } else if let Some(period) = self.period() {
            t.edges[i.rem_euclid(n) as usize] + i.div_euclid(n) as f64 * period
        } else {
            let last = i.clamp(0, n);
            t.edges[last as usize] + (i - last) as f64 * self.width(i)
        }
    }
    /// The last node at or below `x` and how far x is from it towards the next, 0 ≤ t < 1.
    #[inline(always)]
    pub fn locate(&self, x: f64) -> (isize, f64) {
        match &self.table {
            None => {
                let r = (x - self.first) / self.spacing;
                (r.floor() as isize, r - r.floor())
            }
            Some(table) => self.locate_between(table, x),
        }
    }

    fn locate_between(&self, t: &Table, mut x: f64) -> (isize, f64) {
        let mut turns = 0;
        if let Some(period) = self.period() {
            let full = ((x - self.first) / period).floor();
            (x, turns) = (x - full * period, full as isize * self.len as isize);
        }
        let after = t.places.partition_point(|&p| p <= x) as isize;
        // Below and above the table the nodes go on evenly.
        let n = self.len as isize;
        let node = if after == 0 {
            -1 + ((x - t.places[0]) / (t.places[1] - t.places[0])).floor() as isize
        } else if after == n + 2 && !self.periodic {
            let gap = self.place(n) - self.place(n - 1);
            n + ((x - self.place(n)) / gap).floor() as isize
        } else {
            after - 2
        };
        let (here, next) = (self.place(node), self.place(node + 1));
        (node + turns, ((x - here) / (next - here)).clamp(0.0, 1.0 - f64::EPSILON))
    }
    /// The nodes that lie in [lo, hi], as first..end, not wrapped; only those that carry an unknown
    /// where the axis is bounded.
    pub fn range(&self, lo: f64, hi: f64) -> Range<isize> {
        let up = |x| {
            let (i, _) = self.locate(x);
            // The node itself, where it is hit within round-off of the arithmetic above.
            if self.place(i) >= x { i } else { i + 1 }
        };
        let (first, end) = (up(lo), self.locate(hi).0 + 1);
        if self.periodic {
            first..end.max(first)
        } else {
            let n = self.len as isize;
            let first = first.clamp(0, n);
            first..end.clamp(first, n)
        }
    }
    /// Smallest and largest distance of neighbours \[m\] from the last node at or below `lo` to the
    /// first at or above `hi`; of all that carry an unknown at most where the axis is bounded.
    pub fn spacings(&self, lo: f64, hi: f64) -> [f64; 2] {
        if self.table.is_none() {
            return [self.spacing; 2];
        }
        let (mut first, mut last) = (self.locate(lo).0, self.locate(hi).0 + 1);
        if !self.periodic {
            let n = self.len as isize;
            (first, last) = (first.clamp(-1, n - 1), last.clamp(0, n));
        }
        (first..last.max(first + 1)).fold([f64::INFINITY, 0.0], |[least, most], i| {
            let gap = self.place(i + 1) - self.place(i);
            [gap.min(least), gap.max(most)]
        })
    }
}

/// How many cells there are between these faces, if any.
fn cells(faces: &[f64]) -> Option<usize> {
    faces.len().checked_sub(1).filter(|&n| n > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACES: [f64; 6] = [1.0, 1.5, 1.8, 2.0, 2.7, 3.0];

    fn all() -> [Nodes; 4] {
        [false, true]
            .map(|p| [Nodes::centres(&FACES, p), Nodes::faces(&FACES, p)])
            .concat()
            .try_into()
            .unwrap()
    }

    #[test]
    fn equal_faces_give_what_uniform_gives() {
        let faces: Vec<f64> = (0..=8).map(|i| -1.0 + 0.25 * f64::from(i)).collect();
        for periodic in [false, true] {
            let pairs = [
                (Nodes::centres(&faces, periodic), Nodes::uniform(-0.875, 0.25, 8, periodic)),
                if periodic {
                    (Nodes::faces(&faces, true), Nodes::uniform(-1.0, 0.25, 8, true))
                } else {
                    (Nodes::faces(&faces, false), Nodes::uniform(-0.75, 0.25, 7, false))
                },
            ];
            for (a, b) in pairs {
                assert_eq!((a.len(), a.period()), (b.len(), b.period()));
                for i in -20..30 {
                    assert_eq!(
                        (a.place(i), a.width(i), a.wrap(i)),
                        (b.place(i), b.width(i), b.wrap(i)),
                        "{i}"
                    );
                }
                for step in -200..200 {
                    let x = f64::from(step) / 32.0;
                    assert_eq!(a.locate(x), b.locate(x), "{x}");
                    assert_eq!(a.range(x, x + 0.7), b.range(x, x + 0.7), "{x}");
                }
            }
        }
    }

    #[test]
    fn a_single_face_holds_nothing() {
        for periodic in [false, true] {
            for faces in [&[][..], &[2.0]] {
                for nodes in [Nodes::centres(faces, periodic), Nodes::faces(faces, periodic)] {
                    assert!(nodes.is_empty() && nodes.wrap(0).is_none() && nodes.range(-9.0, 9.0).is_empty());
                }
            }
        }
    }

    #[test]
    fn places_are_those_of_the_faces() {
        let [centres, faces, round_centres, round_faces] = all();
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-14, "{a} {b}");
        close(centres.place(3), 2.35);
        close(centres.place(-1), 0.75);
        close(centres.place(-2), 0.25);
        close(centres.width(3), 0.7);
        close(faces.place(0), 1.5);
        close(faces.place(-1), 1.0);
        close(faces.place(4), 3.0);
        close(faces.width(0), 0.4);
        assert_eq!((faces.len(), round_faces.len()), (4, 5));
        close(round_centres.place(-1), 0.85);
        close(round_centres.place(5 + 3), 4.35);
        close(round_faces.place(0), 1.0);
        close(round_faces.width(0), 0.4);
        close(round_faces.place(-6), 2.7 - 4.0);
        // The control volumes fill the axis.
        for nodes in [centres, round_centres, round_faces] {
            close((0..5).map(|i| nodes.width(i)).sum(), 2.0);
        }
    }

    #[test]
    fn locate_inverts_place() {
        for nodes in all() {
            for i in -12..15 {
                for t in [0.25, 0.75] {
                    let x = (1.0 - t) * nodes.place(i) + t * nodes.place(i + 1);
                    let (node, part) = nodes.locate(x);
                    assert_eq!(node, i, "{nodes:?} at {x}");
                    assert!((part - t).abs() < 1e-12, "{part}");
                    let inside = |i| nodes.wrap(i).is_some();
                    let range = nodes.range(x, x + 1.7317);
                    let expected: Vec<_> = (-20..30)
                        .filter(|&j| inside(j) && nodes.place(j) >= x && nodes.place(j) <= x + 1.7317)
                        .collect();
                    assert_eq!(range.collect::<Vec<_>>(), expected);
                }
            }
        }
    }

    #[test]
    fn volumes_lie_edge_to_edge() {
        for nodes in all() {
            for i in -12..15 {
                let [low, high] = [nodes.edge(i), nodes.edge(i + 1)];
                assert!((high - low - nodes.width(i)).abs() < 1e-12, "{nodes:?} {i}");
                let holds = low < nodes.place(i) && nodes.place(i) < high;
                assert!(holds || nodes.wrap(i).is_none(), "{nodes:?} {i}");
            }
        }
    }

    #[test]
    fn spacings_are_those_between() {
        let nodes = Nodes::faces(&FACES, true);
        let [least, most] = nodes.spacings(1.6, 2.1);
        assert!((least - 0.2).abs() < 1e-14 && (most - 0.7).abs() < 1e-14);
        let [least, most] = nodes.spacings(1.55, 1.7317);
        assert!((least - 0.3).abs() < 1e-14 && (most - 0.3).abs() < 1e-14);
        assert_eq!(Nodes::uniform(0.0, 0.1, 5, false).spacings(-3.0, 9.0), [0.1; 2]);
    }
}
