//! One axis of a grid.
use crate::FlowError;
use interfaces::Nodes;
use std::path::Path;
use std::sync::Arc;

/// Which end of an axis a stretching gathers its cells at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cluster {
    /// At the lower end.
    Lower,
    /// At the upper end.
    Upper,
    /// At both ends alike.
    Both,
}

/// One axis of a grid: n cells between the faces x_0 < x_1 < … < x_n \[m\].
///
/// Cheap to clone: the coordinates are shared.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    faces: Arc<[f64]>,
    /// All cells are equal.
    uniform: bool,
}

impl Axis {
    /// `cells` equal cells from `from` to `to` \[m\].
    ///
    /// # Errors
    /// [`FlowError::Grid`] for no cells or ends that are not finite and in order.
    pub fn uniform(cells: usize, from: f64, to: f64) -> Result<Self, FlowError> {
        Self::mapped(cells, from, to, true, |s| s)
    }

    /// `cells` cells, each `ratio` times as wide as the one below it: x(s) = (r^{ns} − 1)/(r^n − 1).
    ///
    /// # Errors
    /// [`FlowError::Grid`] for no cells, ends or a ratio that make no sense, or cells too thin for
    /// double precision.
    pub fn geometric(cells: usize, from: f64, to: f64, ratio: f64) -> Result<Self, FlowError> {
        if !(ratio.is_finite() && ratio > 0.0) {
            return fail(format!("a cell-to-cell ratio of {ratio}; give a positive, finite one"));
        }
        let ln = cells as f64 * ratio.ln();
        if ln.abs() < 1e-12 {
            return Self::uniform(cells, from, to);
        }
        Self::mapped(cells, from, to, false, |s| (s * ln).exp_m1() / ln.exp_m1())
    }

    /// `cells` cells gathered where `cluster` says by a hyperbolic tangent of strength `beta` > 0:
    /// with s = i/n, at both ends x(s) = ½(1 + tanh(β(2s − 1))/tanh β), at the lower one
    /// x(s) = 1 − tanh(β(1 − s))/tanh β.
    ///
    /// # Errors
    /// Those of [`geometric`](Self::geometric).
    pub fn tanh(cells: usize, from: f64, to: f64, beta: f64, cluster: Cluster) -> Result<Self, FlowError> {
        if !(beta.is_finite() && beta > 0.0) {
            return fail(format!("a stretching strength of {beta}; give a positive, finite one"));
        }
        let scale = 1.0 / beta.tanh();
        Self::mapped(cells, from, to, false, |s| match cluster {
            Cluster::Both => 0.5 * (1.0 + scale * (beta * (2.0 * s - 1.0)).tanh()),
            Cluster::Lower => 1.0 - scale * (beta * (1.0 - s)).tanh(),
            Cluster::Upper => scale * (beta * s).tanh(),
        })
    }

    /// The axis with these faces \[m\].
    ///
    /// # Errors
    /// [`FlowError::Grid`] for fewer than two faces, or faces that are not finite and increasing.
    pub fn from_faces(faces: impl Into<Vec<f64>>) -> Result<Self, FlowError> {
        let faces: Vec<f64> = faces.into();
        if faces.len() < 2 {
            return fail(format!("an axis of {} faces; give at least 2", faces.len()));
        }
        if let Some(i) = faces.iter().position(|x| !x.is_finite()) {
            return fail(format!("face {i} at {} m; give finite coordinates", faces[i]));
        }
        if let Some(i) = (1..faces.len()).find(|&i| faces[i] <= faces[i - 1]) {
            return fail(format!(
                "face {i} at {} m after one at {} m; give coordinates that increase (by more than round-off)",
                faces[i],
                faces[i - 1]
            ));
        }
        let n = faces.len() - 1;
        let (mean, largest) = ((faces[n] - faces[0]) / n as f64, faces[0].abs().max(faces[n].abs()));
        let tolerance = 4.0 * f64::EPSILON * largest.max(mean);
        let uniform = faces.windows(2).all(|w| (w[1] - w[0] - mean).abs() <= tolerance);
        Ok(Self { faces: faces.into(), uniform })
    }

    /// The axis whose faces are listed in a text file, separated by blanks, commas or line ends; what follows a `#`
    /// is a comment.
    ///
    /// # Errors
    /// [`FlowError::Grid`] if the file cannot be read or does not hold increasing numbers.
    pub fn from_file(path: impl AsRef<Path>) -> Result<Self, FlowError> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path).map_err(|e| FlowError::Grid {
            what: format!("the faces in {}, which cannot be read: {e}", path.display()),
        })?;
        let mut faces = Vec::new();
        for (number, line) in text.lines().enumerate() {
            let line = line.split('#').next().unwrap_or_default();
            for word in line.split(|c: char| c.is_whitespace() || c == ',').filter(|w| !w.is_empty()) {
                match word.parse() {
                    Ok(x) => faces.push(x),
                    Err(_) => {
                        return fail(format!(
                            "the face \"{word}\" in line {} of {}; give one number per face",
                            number + 1,
                            path.display()
                        ));
                    }
                }
            }
        }
        Self::from_faces(faces)
    }

    fn mapped(
        cells: usize,
        from: f64,
        to: f64,
        uniform: bool,
        x: impl Fn(f64) -> f64,
    ) -> Result<Self, FlowError> {
        if cells == 0 {
            return fail("an axis without cells; give at least 1".into());
        }
        if !(from.is_finite() && to.is_finite() && from < to && (to - from).is_finite()) {
            return fail(format!("an axis from {from} m to {to} m; give finite ends, the lower one first"));
        }
        let mut faces: Vec<f64> =
            (0..=cells).map(|i| from + (to - from) * x(i as f64 / cells as f64)).collect();
        (faces[0], faces[cells]) = (from, to);
        let axis = Self::from_faces(faces)?;
        Ok(Self { uniform, ..axis })
    }

    /// The same axis moved by `by` \[m\].
    ///
    /// # Errors
    /// [`FlowError::Grid`] if the faces are not distinct finite numbers any more.
    pub fn moved(&self, by: f64) -> Result<Self, FlowError> {
        let moved = Self::from_faces(self.faces.iter().map(|x| x + by).collect::<Vec<_>>())?;
        Ok(Self { uniform: self.uniform, ..moved })
    }

    /// The same equal cells `by` cells further up, so that faces which both axes have are the same to the bit, wherever this one
    /// has been before.
    pub(crate) fn slid(&self, by: i64) -> Result<Self, FlowError> {
        let (n, from, to) = (self.cells(), self.lower(), self.upper());
        let place = |i: usize| match i as i64 + by {
            k if k == n as i64 => to,
            k => from + (to - from) * (k as f64 / n as f64),
        };
        let slid = Self::from_faces((0..=n).map(place).collect::<Vec<_>>())?;
        Ok(Self { uniform: self.uniform, ..slid })
    }

    /// Number of cells n.
    pub fn cells(&self) -> usize {
        self.faces.len() - 1
    }
    /// The n + 1 faces \[m\].
    pub fn faces(&self) -> &[f64] {
        &self.faces
    }
    /// The lower end \[m\].
    pub fn lower(&self) -> f64 {
        self.faces[0]
    }
    /// The upper end \[m\].
    pub fn upper(&self) -> f64 {
        self.faces[self.cells()]
    }
    /// Distance of the ends \[m\].
    pub fn length(&self) -> f64 {
        self.upper() - self.lower()
    }
    /// Are all cells equal?
    pub fn is_uniform(&self) -> bool {
        self.uniform
    }
    /// Mean width of a cell \[m\].
    pub fn mean_width(&self) -> f64 {
        self.length() / self.cells() as f64
    }
    /// The centres of the cells as nodes of a lattice.
    pub fn centres(&self, periodic: bool) -> Nodes {
        if self.is_uniform() {
            let h = self.mean_width();
            Nodes::uniform(self.lower() + 0.5 * h, h, self.cells(), periodic)
        } else {
            Nodes::centres(self.faces(), periodic)
        }
    }
    /// Width of cell `i` \[m\].
    pub fn width(&self, i: usize) -> f64 {
        if self.uniform { self.mean_width() } else { self.faces[i + 1] - self.faces[i] }
    }
    /// Centre of cell `i` \[m\].
    pub fn centre(&self, i: usize) -> f64 {
        0.5 * (self.faces[i] + self.faces[i + 1])
    }
    /// Width of the narrowest cell \[m\].
    pub fn narrowest(&self) -> f64 {
        (0..self.cells()).map(|i| self.width(i)).fold(f64::INFINITY, f64::min)
    }
    /// Largest ratio of the widths of two neighbouring cells; 1 on a uniform axis.
    pub fn largest_ratio(&self) -> f64 {
        (1..self.cells())
            .map(|i| self.width(i) / self.width(i - 1))
            .fold(1.0, |top: f64, r| top.max(r).max(1.0 / r))
    }
    /// The cell that holds `x`, its lower face included; the last cell holds the upper end too. `None` outside.
    pub fn locate(&self, x: f64) -> Option<usize> {
        let n = self.cells();
        if !(self.lower() <= x && x <= self.upper()) {
            return None;
        }
        Some(self.faces.partition_point(|&f| f <= x).saturating_sub(1).min(n - 1))
    }
}

fn fail<T>(what: String) -> Result<T, FlowError> {
    Err(FlowError::Grid { what })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretchings_are_what_they_say() {
        let g = Axis::geometric(10, -1.0, 2.0, 1.2).unwrap();
        for i in 1..10 {
            assert!((g.width(i) / g.width(i - 1) - 1.2).abs() < 1e-12);
        }
        assert!((g.largest_ratio() - 1.2).abs() < 1e-12 && !g.is_uniform());
        let t = Axis::tanh(16, 0.0, 1.0, 2.0, Cluster::Both).unwrap();
        for i in 0..16 {
            assert!((t.width(i) - t.width(15 - i)).abs() < 1e-14);
        }
        assert!(t.width(0) < 0.3 * t.width(8) && t.narrowest() == t.width(0));
        let (lower, upper) =
            (Axis::tanh(8, 0.0, 1.0, 1.5, Cluster::Lower), Axis::tanh(8, 0.0, 1.0, 1.5, Cluster::Upper));
        let (lower, upper) = (lower.unwrap(), upper.unwrap());
        for i in 0..8 {
            assert!((lower.width(i) - upper.width(7 - i)).abs() < 1e-14);
        }
        assert!(lower.width(0) < lower.width(7));
        assert!(Axis::geometric(5, 0.0, 1.0, 1.0).unwrap().is_uniform());
        assert!(Axis::from_faces([0.0, 0.1, 0.2, 0.1 + 0.2]).unwrap().is_uniform());
    }

    #[test]
    fn locate_inverts_the_faces() {
        let axis = Axis::tanh(37, -2.0, 3.0, 1.3, Cluster::Upper).unwrap();
        for i in 0..37 {
            assert_eq!(axis.locate(axis.centre(i)), Some(i));
            assert_eq!(axis.locate(axis.faces()[i]), Some(i));
        }
        assert_eq!(axis.locate(3.0), Some(36));
        assert_eq!((axis.locate(3.1), axis.locate(-2.1), axis.locate(f64::NAN)), (None, None, None));
    }

    #[test]
    fn impossible_axes_are_errors() {
        let bad = [
            Axis::uniform(0, 0.0, 1.0),
            Axis::uniform(3, 1.0, 1.0),
            Axis::uniform(3, 0.0, f64::NAN),
            Axis::geometric(3, 0.0, 1.0, -2.0),
            Axis::geometric(4000, 0.0, 1.0, 1.5),
            Axis::tanh(3, 0.0, 1.0, 0.0, Cluster::Both),
            Axis::tanh(300, 0.0, 1.0, 80.0, Cluster::Both),
            Axis::from_faces([1.0]),
            Axis::from_faces([1.0, 1.0]),
            Axis::from_faces([1.0, f64::INFINITY]),
            Axis::from_file("no such file"),
        ];
        for axis in bad {
            assert!(matches!(axis, Err(FlowError::Grid { .. })), "{axis:?}");
        }
    }

    #[test]
    fn faces_from_a_file() {
        let path = std::env::temp_dir().join(format!("fv-mesh-axis-{}.txt", std::process::id()));
        std::fs::write(&path, "# faces in m\n0.0, 0.1\n0.3 # wider\n").unwrap();
        assert_eq!(Axis::from_file(&path).unwrap(), Axis::from_faces([0.0, 0.1, 0.3]).unwrap());
        std::fs::write(&path, "0.0\nfoot\n").unwrap();
        let error = Axis::from_file(&path).unwrap_err().to_string();
        assert!(error.contains("\"foot\" in line 2"), "{error}");
        std::fs::remove_file(path).unwrap();
    }
}
