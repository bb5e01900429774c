//! Record of the repair of a mesh.
use super::error::named;
use std::fmt;

/// Changes of one kind: their number, and the places of the first eight.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Changes {
    /// Number of changes.
    pub count: usize,
    /// Places of the first eight \[m\].
    pub at: Vec<[f64; 3]>,
}

impl Changes {
    /// Adds changes at these places.
    pub(crate) fn add(&mut self, places: impl IntoIterator<Item = [f64; 3]>) {
        let mut all = std::mem::take(&mut self.at);
        for place in places {
            self.count += 1;
            all.push(place);
        }
        self.at = named(all);
    }
}

/// Everything that [`TriangleSoup::repaired`](crate::TriangleSoup::repaired) did, in its order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RepairReport {
    /// Distance up to which vertices were joined \[m\].
    pub tolerance: f64,
    /// Vertices that were joined with another one.
    pub welded: Changes,
    /// Faces with one corner twice, which were left out.
    pub collapsed: Changes,
    /// Copies of faces that were left out.
    pub duplicates: Changes,
    /// Vertices in the middle of an open edge, at which its face was divided.
    pub stitched: Changes,
    /// Faces that were turned to agree with their neighbours.
    pub turned: Changes,
    /// Faces without area that were flipped with a neighbour or left out.
    pub flat: Changes,
    /// Closed parts that were turned: a part looks outward, a cavity in it inward, and so on.
    pub turned_shells: Changes,
    /// Pairs of faces that crossed, overlapped or touched, whose parts were united.
    pub united: Changes,
}

impl RepairReport {
    fn changes(&self) -> [(&'static str, &Changes); 8] {
        [
            ("vertices joined", &self.welded),
            ("faces with a corner twice left out", &self.collapsed),
            ("copies of faces left out", &self.duplicates),
            ("faces divided at a vertex in the middle of an edge", &self.stitched),
            ("faces turned to agree with their neighbours", &self.turned),
            ("faces without area flipped or left out", &self.flat),
            ("closed parts turned", &self.turned_shells),
            ("pairs of crossing faces removed by uniting closed parts", &self.united),
        ]
    }
    /// Whether nothing was changed.
    pub fn is_empty(&self) -> bool {
        self.changes().into_iter().all(|(_, changes)| changes.count == 0)
    }
}

impl fmt::Display for RepairReport {
    /// One sentence: counts, and the first place of each kind.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_empty() {
            return write!(f, "nothing was changed");
        }
        let done = self.changes().into_iter().filter(|(_, changes)| changes.count > 0);
        for (i, (what, changes)) in done.enumerate() {
            write!(f, "{}{} {what}", if i > 0 { "; " } else { "" }, changes.count)?;
            if let Some([x, y, z]) = changes.at.first() {
                write!(f, " (the first at ({x:.4e}, {y:.4e}, {z:.4e}) m)")?;
            }
        }
        if self.welded.count > 0 {
            write!(f, "; vertices up to {:.3e} m apart were joined", self.tolerance)?;
        }
        Ok(())
    }
}
