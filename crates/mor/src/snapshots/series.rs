//! The files of a run.
use super::source::check_part;
use super::xml::tags;
use super::{SnapshotError, SnapshotSource, VtkFile};
use crate::shifted::Grid;
use monomorphic::MatMut;
use std::path::{Path, PathBuf};

/// One field of the VTK files that a `.pvd` collection lists, a snapshot each. Files are opened when they are read; each must have as many values as the first.
///
/// A read of some rows goes through all files: blocks of columns are read faster.
pub struct VtkSeries {
    name: String,
    times: Vec<f64>,
    files: Vec<PathBuf>,
    n_rows: usize,
    grid: Option<Grid>,
}

impl VtkSeries {
    /// The array `name` of the collection's files; the first one is read.
    ///
    /// # Errors
    /// [`SnapshotError`].
    pub fn open(pvd: impl AsRef<Path>, name: &str) -> Result<Self, SnapshotError> {
        let path = pvd.as_ref();
        let text = std::fs::read_to_string(path).map_err(|e| SnapshotError::io(path, &e))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let (mut times, mut files) = (vec![], vec![]);
        for tag in tags(&text).filter(|t| t.name == "DataSet") {
            let time = tag.get("timestep").and_then(|t| t.parse().ok());
            let (Some(time), Some(file)) = (time, tag.get("file")) else {
                let why = format!("entry {} has no time step or no file", times.len());
                return Err(SnapshotError::format(path, why));
            };
            times.push(time);
            files.push(folder.join(&*file));
        }
        let Some(first) = files.first() else {
            return Err(SnapshotError::format(path, "this collection lists no files"));
        };
        let first = VtkFile::open(first)?;
        let n_rows = first.field(name)?.len();
        Ok(Self { name: name.into(), times, files, n_rows, grid: first.grid() })
    }

    /// Of the snapshots \[s\].
    #[must_use]
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Of the first file's cells, if it is an image; periodic.
    #[must_use]
    pub fn grid(&self) -> Option<Grid> {
        self.grid
    }

    fn snapshot(&self, number: usize) -> Result<Vec<f64>, SnapshotError> {
        let file = VtkFile::open(&self.files[number])?;
        let field = file.field(&self.name)?;
        if field.len() != self.n_rows {
            return Err(SnapshotError::Shape {
                path: file.path().into(),
                what: format!("the array `{}` of snapshot {number}", self.name),
                expected: self.n_rows,
                found: field.len(),
            });
        }
        Ok(field)
    }
}

impl SnapshotSource for VtkSeries {
    fn n_rows(&self) -> usize {
        self.n_rows
    }
    fn n_snapshots(&self) -> usize {
        self.files.len()
    }
    fn read(
        &self,
        first_row: usize,
        first_snapshot: usize,
        mut to: MatMut<'_, f64>,
    ) -> Result<(), SnapshotError> {
        check_part([self.n_rows, self.files.len()], [first_row, first_snapshot], &to)?;
        for j in 0..to.ncols() {
            let field = self.snapshot(first_snapshot + j)?;
            for i in 0..to.nrows() {
                to[(i, j)] = field[first_row + i];
            }
        }
        Ok(())
    }
}
