//! Several of NumPy's arrays in one file.
use super::{NpyArray, SnapshotAxis, SnapshotError};
use flate2::{Crc, read::DeflateDecoder};
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// A `.npz` file: a ZIP archive of `.npy` files, as `numpy.savez` and `numpy.savez_compressed` write it. Arrays that are not compressed are read in parts from the
/// file, others are held in memory.
pub struct NpzFile {
    path: PathBuf,
    entries: Vec<Entry>,
}

/// A file in the archive.
#[derive(Clone, Debug)]
struct Entry {
    name: String,
    method: u16,
    crc: u32,
    packed: u64,
    size: u64,
    /// Of its local header.
    at: u64,
}

/// Marks of the records of an archive (PKWARE's APPNOTE).
const LOCAL: &[u8] = b"PK\x03\x04";
const CENTRAL: &[u8] = b"PK\x01\x02";
const END: &[u8] = b"PK\x05\x06";
const END_64: &[u8] = b"PK\x06\x06";
/// Length of the record at the end, without its comment, which is no longer than the other number.
const END_LENGTH: usize = 22;
const COMMENT: usize = 1 << 16;

fn number(bytes: &[u8], at: usize, size: usize) -> Option<u64> {
    let field = bytes.get(at..at + size)?;
    Some(field.iter().rev().fold(0, |sum, &b| sum << 8 | u64::from(b)))
}

impl NpzFile {
    /// Reads the list of arrays.
    ///
    /// # Errors
    /// [`SnapshotError::Io`], [`SnapshotError::Format`].
    pub fn open(path: impl AsRef<Path>) -> Result<Self, SnapshotError> {
        let path = path.as_ref();
        let io = |e| SnapshotError::io(path, &e);
        let mut file = File::open(path).map_err(io)?;
        let length = file.metadata().map_err(io)?.len();
        let tail = length.min((END_LENGTH + COMMENT) as u64);
        let end = part(&mut file, length - tail, tail).map_err(io)?;
        let broken =
            || SnapshotError::format(path, "this is no ZIP archive, or its list of files is cut off");
        let at = end.windows(4).rposition(|w| w == END).ok_or_else(broken)?;
        let field = |at, size| number(&end, at, size).ok_or_else(broken);
        let (mut size, mut start) = (field(at + 12, 4)?, field(at + 16, 4)?);
        if start == u64::from(u32::MAX) || size == u64::from(u32::MAX) {
            let big = end[..at].windows(4).rposition(|w| w == END_64).ok_or_else(broken)?;
            (size, start) = (field(big + 40, 8)?, field(big + 48, 8)?);
        }
        if start.checked_add(size).is_none_or(|end| end > length) {
            return Err(broken());
        }
        let list = part(&mut file, start, size).map_err(io)?;
        let mut entries = Vec::new();
        let mut rest = &list[..];
        while rest.starts_with(CENTRAL) {
            let (entry, length) = Entry::of(rest).ok_or_else(broken)?;
            entries.push(entry);
            rest = rest.get(length..).ok_or_else(broken)?;
        }
        Ok(Self { path: path.into(), entries })
    }

    /// Of the arrays, without `.npy`.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.entries.iter().map(|e| e.name.strip_suffix(".npy").unwrap_or(&e.name))
    }

    /// The array of this name.
    ///
    /// # Errors
    /// [`SnapshotError::NoArray`], and those of [`NpyArray::open`].
    pub fn array(&self, name: &str, axis: SnapshotAxis) -> Result<NpyArray, SnapshotError> {
        let (path, there) = (&self.path, || self.names().map(String::from).collect());
        let place = self.names().position(|n| n == name);
        let entry = place.map(|i| &self.entries[i]).ok_or_else(|| SnapshotError::NoArray {
            path: path.clone(),
            name: name.into(),
            there: there(),
        })?;
        let io = |e| SnapshotError::io(path, &e);
        let broken = |why: String| SnapshotError::format(path, format!("the array `{name}` {why}"));
        let mut file = File::open(path).map_err(io)?;
        let local = part(&mut file, entry.at, 30).map_err(io)?;
        let (true, Some(a), Some(b)) =
            (local.starts_with(LOCAL), number(&local, 26, 2), number(&local, 28, 2))
        else {
            return Err(broken("is not where the list says".into()));
        };
        let start = entry.at + 30 + a + b;
        match entry.method {
            0 => NpyArray::within(path, axis, file, start, entry.size),
            8 => {
                file.seek(SeekFrom::Start(start)).map_err(io)?;
                let mut bytes = Vec::new();
                DeflateDecoder::new(file.take(entry.packed))
                    .read_to_end(&mut bytes)
                    .map_err(|e| broken(format!("cannot be unpacked: {e}")))?;
                let mut crc = Crc::new();
                crc.update(&bytes);
                if crc.sum() != entry.crc || bytes.len() as u64 != entry.size {
                    let (found, size) = (bytes.len(), entry.size);
                    return Err(broken(format!("is damaged: {found} bytes of {size}, or a wrong checksum")));
                }
                NpyArray::of_bytes(path, axis, bytes)
            }
            method => Err(broken(format!(
                "is packed by method {method}; stored (0) and deflated (8) ones are read"
            ))),
        }
    }
}

impl Entry {
    /// From a record of the list, and the record's length.
    fn of(record: &[u8]) -> Option<(Self, usize)> {
        let field = |at, size| number(record, at, size);
        let [name, extra, comment] = [28, 30, 32].map(|at| field(at, 2).map(|n| n as usize));
        let (name, extra, comment) = (name?, extra?, comment?);
        let mut entry = Self {
            name: String::from_utf8_lossy(record.get(46..46 + name)?).into_owned(),
            method: field(10, 2)? as u16,
            crc: field(16, 4)? as u32,
            packed: field(20, 4)?,
            size: field(24, 4)?,
            at: field(42, 4)?,
        };
        // Numbers that do not fit are in an extra field, in this order.
        let mut rest = record.get(46 + name..46 + name + extra)?;
        while rest.len() >= 4 {
            let (kind, length) = (number(rest, 0, 2)?, number(rest, 2, 2)? as usize);
            if kind == 1 {
                let mut at = 4;
                for to in [&mut entry.size, &mut entry.packed, &mut entry.at] {
                    if *to == u64::from(u32::MAX) {
                        *to = number(rest, at, 8)?;
                        at += 8;
                    }
                }
            }
            rest = rest.get(4 + length..).unwrap_or(&[]);
        }
        Some((entry, 46 + name + extra + comment))
    }
}

/// So many bytes from there on.
fn part(file: &mut File, start: u64, length: u64) -> std::io::Result<Vec<u8>> {
    let mut bytes = vec![0; length as usize];
    file.seek(SeekFrom::Start(start))?;
    file.read_exact(&mut bytes)?;
    Ok(bytes)
}
