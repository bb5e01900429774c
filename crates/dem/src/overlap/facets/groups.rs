//! What hangs together.
use super::super::outline::Outline;
use super::Sums;
use super::body::NONE;
use super::crossings::Crossings;
use interfaces::Vector;
use nalgebra::Matrix3;

/// Disjoint sets of crossings, and of vertices by their group's number (Tarjan 1975, J. ACM 22, 215).
#[derive(Clone, Debug, Default)]
pub(crate) struct Groups {
    parents: Vec<u32>,
    /// One for every group; those of numbers that are not their own parent stay empty.
    sums: Vec<Sums>,
    /// Whether [`Overlap::pivot`](crate::Overlap::pivot) is requested.
    pub(crate) pivots: bool,
    /// One for every group, if so.
    outlines: Vec<Outline>,
    patches: Vec<Region>,
}

/// Sums over one connected region.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Region {
    pub(crate) sums: Sums,
    pub(crate) outline: Outline,
}

impl Groups {
    /// One for every crossing, joined where a segment runs between them.
    pub(super) fn clear(&mut self, crossings: &Crossings) {
        self.parents.clear();
        self.parents.extend(0..crossings.all.len() as u32);
        for s in &crossings.segments {
            self.join(s.ends[0], s.ends[1]);
        }
    }
    /// None yet.
    pub(crate) fn restart(&mut self) {
        self.parents.clear();
    }
    /// Another group.
    pub(crate) fn add(&mut self) -> u32 {
        let new = self.parents.len() as u32;
        self.parents.push(new);
        new
    }
    #[inline]
    pub(crate) fn root(&mut self, mut i: u32) -> u32 {
        while self.parents[i as usize] != i {
            let up = self.parents[self.parents[i as usize] as usize];
            self.parents[i as usize] = up;
            i = up;
        }
        i
    }
    #[inline]
    pub(crate) fn join(&mut self, i: u32, j: u32) {
        let (i, j) = (self.root(i), self.root(j));
        self.parents[i.max(j) as usize] = i.min(j);
    }

    /// Makes sums for all groups, all zero.
    pub(crate) fn start_sums(&mut self) {
        self.sums.clear();
        self.sums.resize(self.parents.len(), Sums::default());
        self.outlines.clear();
        if self.pivots {
            self.outlines.resize(self.parents.len(), Outline::default());
        }
    }
    /// Adds a part p → q of the curve in which the surfaces cross, as [`Sums::add_curve`].
    #[inline]
    pub(crate) fn add_curve(&mut self, i: u32, p: Vector, q: Vector) {
        let root = self.root(i) as usize;
        self.sums[root].add_curve(p, q);
        if let Some(outline) = self.outlines.get_mut(root) {
            outline.add(p, q);
        }
    }
    #[inline]
    pub(crate) fn sums(&mut self, i: u32) -> &mut Sums {
        let root = self.root(i);
        &mut self.sums[root as usize]
    }
    /// Adds sums that were taken in a frame turned by `turn`.
    pub(crate) fn add_turned(&mut self, i: u32, own: &Sums, turn: &Matrix3<f64>) {
        if i != NONE {
            let sums = self.sums(i);
            sums.volume += own.volume;
            sums.first += turn * own.first;
        }
    }
    /// One sum for every connected region. Groups with negative volume, beyond `round_off`, are borders of hollows, which belong
    /// to the region around them: that with the nearest centroid among those large enough. (Without any, they stay as they are.)
    pub(crate) fn patches(&mut self, round_off: f64) -> &[Region] {
        self.patches.clear();
        let roots = || (0..self.parents.len()).filter(|&i| self.parents[i] == i as u32);
        let region = |i: usize| {
            let outline = self.outlines.get(i).copied().unwrap_or_default();
            Region { sums: self.sums[i], outline }
        };
        self.patches.extend(roots().map(region).filter(|r| r.sums.volume > 0.0));
        for hollow in roots().map(region).filter(|r| r.sums.volume < -round_off) {
            let centre = |r: &Region| r.sums.first / r.sums.volume;
            let distance = |r: &Region| (centre(r) - centre(&hollow)).norm();
            let large = |r: &&mut Region| r.sums.volume >= -hollow.sums.volume;
            let around =
                self.patches.iter_mut().filter(large).min_by(|s, t| distance(s).total_cmp(&distance(t)));
            match around {
                Some(around) => {
                    around.sums.add(&hollow.sums);
                    around.outline.join(&hollow.outline);
                }
                None => self.patches.push(hollow),
            }
        }
        &self.patches
    }
}
