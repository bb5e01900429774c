//! Snapshots into a file of NumPy's.
use super::SnapshotError;
use super::npy::{Header, Number};
use interfaces::SnapshotSink;
use std::error::Error;
use std::fs::{File, OpenOptions};
use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Appends snapshots to a `.npy` file as they come: an array of snapshots × rows in C order of 64-bit numbers, which [`NpyArray`](super::NpyArray) reads with
/// [`SnapshotAxis::First`](super::SnapshotAxis::First). The file is whole after each [`flush`](Self::flush).
///
/// ```
/// use mor::snapshots::{NpyArray, NpyWriter, SnapshotAxis, SnapshotSource};
/// let path = std::env::temp_dir().join(format!("mor-writer-{}.npy", std::process::id()));
/// let mut writer = NpyWriter::create(&path)?;
/// writer.add(&[1.0, 2.0, 3.0])?;
/// writer.add(&[4.0, 5.0, 6.0])?;
/// writer.flush()?;
/// let all = NpyArray::open(&path, SnapshotAxis::First)?.to_mat()?;
/// assert_eq!(all[(2, 1)], 6.0);
/// # std::fs::remove_file(path)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct NpyWriter {
    path: PathBuf,
    file: BufWriter<File>,
    rows: Option<usize>,
    snapshots: usize,
}

/// Bytes of the header, whatever the shape is.
const HEADER: usize = 128;
/// `<f8`.
const NUMBER: Number = Number { double: true, big_endian: false };

fn other(path: &Path) -> SnapshotError {
    SnapshotError::format(
        path,
        "only a file of snapshots × rows that `NpyWriter` wrote can be gone on with; create another one",
    )
}

impl NpyWriter {
    /// A new file, in place of one that may be there.
    ///
    /// # Errors
    /// [`SnapshotError::Io`].
    pub fn create(path: impl AsRef<Path>) -> Result<Self, SnapshotError> {
        let path = path.as_ref();
        let file = File::create(path).map_err(|e| SnapshotError::io(path, &e))?;
        let mut writer = Self { path: path.into(), file: BufWriter::new(file), rows: None, snapshots: 0 };
        writer.flush()?;
        Ok(writer)
    }

    /// Goes on with a file that this type wrote behind its first `snapshots`; what follows them is cut off.
    ///
    /// # Errors
    /// [`SnapshotError::Io`]; [`SnapshotError::Format`] if the file is not of this type's; [`SnapshotError::Truncated`] if there are not so many snapshots.
    pub fn resume(path: impl AsRef<Path>, snapshots: usize) -> Result<Self, SnapshotError> {
        let path = path.as_ref();
        let io = |e| SnapshotError::io(path, &e);
        let mut file = OpenOptions::new().read(true).write(true).open(path).map_err(io)?;
        let (header, bytes) = Header::read(&mut file, path)?;
        let ours = bytes == HEADER as u64 && !header.fortran && header.kind == NUMBER;
        let &[_, rows] = &header.shape[..] else { return Err(other(path)) };
        if !ours {
            return Err(other(path));
        }
        let (expected, found) = ((HEADER + 8 * rows * snapshots) as u64, file.metadata().map_err(io)?.len());
        if found < expected {
            let what = format!("an array of {snapshots} × {rows}");
            return Err(SnapshotError::Truncated { path: path.into(), what, expected, found });
        }
        file.set_len(expected).map_err(io)?;
        let mut file = BufWriter::new(file);
        file.seek(SeekFrom::End(0)).map_err(io)?;
        let rows = (snapshots > 0).then_some(rows);
        Ok(Self { path: path.into(), file, rows, snapshots })
    }

    /// How many snapshots are there.
    #[must_use]
    pub fn snapshots(&self) -> usize {
        self.snapshots
    }

    /// Makes the file whole: its header tells how many snapshots there are.
    ///
    /// # Errors
    /// [`SnapshotError::Io`].
    pub fn flush(&mut self) -> Result<(), SnapshotError> {
        let shape = format!("({}, {})", self.snapshots, self.rows.unwrap_or(0));
        let dictionary = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
        let mut header = b"\x93NUMPY\x01\x00".to_vec();
        header.extend(((HEADER - 10) as u16).to_le_bytes());
        header.extend(dictionary.as_bytes());
        header.resize(HEADER - 1, b' ');
        header.push(b'\n');
        let mut write = || {
            self.file.seek(SeekFrom::Start(0))?;
            self.file.write_all(&header)?;
            self.file.seek(SeekFrom::End(0))?;
            self.file.flush()
        };
        write().map_err(|e| SnapshotError::io(&self.path, &e))
    }

    /// Adds a snapshot; all have the same length.
    ///
    /// # Errors
    /// [`SnapshotError::Shape`] for another length, [`SnapshotError::Io`].
    pub fn add(&mut self, field: &[f64]) -> Result<(), SnapshotError> {
        let expected = *self.rows.get_or_insert(field.len());
        if field.len() != expected {
            let what = format!("snapshot {}", self.snapshots);
            return Err(SnapshotError::Shape { path: self.path.clone(), what, expected, found: field.len() });
        }
        for value in field {
            self.file.write_all(&value.to_le_bytes()).map_err(|e| SnapshotError::io(&self.path, &e))?;
        }
        self.snapshots += 1;
        Ok(())
    }
}

impl SnapshotSink for NpyWriter {
    fn push(&mut self, _: f64, field: &[f64]) -> Result<(), Box<dyn Error + Send + Sync>> {
        Ok(self.add(field)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::snapshots::{NpyArray, SnapshotAxis, SnapshotSource};

    #[test]
    fn a_file_that_goes_on_is_that_of_one_go() {
        let path = |name: &str| std::env::temp_dir().join(format!("mor-{name}-{}.npy", std::process::id()));
        let (whole, parts) = (path("whole"), path("parts"));
        let field = |k: usize| [k as f64, 0.5, -1.0 / (k + 1) as f64];
        let mut writer = NpyWriter::create(&whole).unwrap();
        (0..7).for_each(|k| writer.push(0.0, &field(k)).unwrap());
        writer.flush().unwrap();
        let mut writer = NpyWriter::create(&parts).unwrap();
        (0..5).for_each(|k| writer.push(0.0, &field(k)).unwrap());
        writer.flush().unwrap();
        drop(writer);
        // Two of them were written after the state that the run goes on from.
        let mut writer = NpyWriter::resume(&parts, 3).unwrap();
        (3..7).for_each(|k| writer.push(0.0, &field(k)).unwrap());
        writer.flush().unwrap();
        assert_eq!(std::fs::read(&whole).unwrap(), std::fs::read(&parts).unwrap());
        let read = NpyArray::open(&parts, SnapshotAxis::First).unwrap().to_mat().unwrap();
        assert_eq!([read.nrows(), read.ncols()], [3, 7]);
        assert!((0..7).all(|k| (0..3).all(|i| read[(i, k)] == field(k)[i])));
        let fail = NpyWriter::resume(&parts, 8).err().unwrap();
        assert!(matches!(fail, SnapshotError::Truncated { .. }), "{fail}");
        assert!(writer.push(0.0, &[1.0]).unwrap_err().to_string().contains("1 values where 3"));
        // NumPy's own files may have other headers.
        std::fs::write(
            &whole,
            b"\x93NUMPY\x01\x00\x36\x00{'descr': '<f8', 'fortran_order': True, 'shape': (1, 1)}\n",
        )
        .unwrap();
        let fail = NpyWriter::resume(&whole, 0).err().unwrap();
        assert!(matches!(fail, SnapshotError::Format { .. }), "{fail}");
        [whole, parts].iter().for_each(|path| std::fs::remove_file(path).unwrap());
    }
}
