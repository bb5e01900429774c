//! NumPy's arrays.
use super::source::check_part;
use super::{SnapshotError, SnapshotSource};
use monomorphic::MatMut;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// Which axis of an array counts the snapshots. All others make the rows, in the order in which they are in memory: the last axis fastest in C order, the first one in
/// Fortran order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SnapshotAxis {
    /// The first: an array of times × y × x in C order has cells of x fastest.
    First,
    /// The last: a matrix of rows × snapshots.
    #[default]
    Last,
}

/// An array of a `.npy` file: float32 or float64 of either byte order, C or Fortran order, formats 1 to 3 (NEP 1). Only its header is read when it is opened.
///
/// Rows are those of a [`Grid`](crate::shifted::Grid) of n_x, n_y, n_z cells if x is the fastest
/// axis in memory, then y, z, and the components of a vector the slowest:
/// [`on_cells`](Self::on_cells) checks it. `a` of each shape in NumPy, what to save, and the axis
/// of the snapshots (`np.save` keeps the order in memory of contiguous arrays, Fortran's, too):
///
/// | shape of `a` | command | `SnapshotAxis` |
/// |---|---|---|
/// | (time, z, y, x) | `np.save(f, np.ascontiguousarray(a))` | `First` |
/// | (time, y, x, component) | `np.save(f, np.ascontiguousarray(a.transpose(0, 3, 1, 2)))` | `First` |
/// | (y, x, time) | `np.save(f, np.ascontiguousarray(a))` | `Last` |
/// | (x, y, z, time), Fortran order | `np.save(f, np.asfortranarray(a))` | `Last` |
/// | (time, y, x), Fortran order | `np.save(f, np.ascontiguousarray(a))` | `First` |
/// | (time, cells), x fastest | `np.save(f, a)` | `First` |
///
/// ```
/// use mor::snapshots::{NpyArray, SnapshotAxis, SnapshotSource};
/// let path = std::env::temp_dir().join(format!("mor-order-{}.npy", std::process::id()));
/// // np.save(path, a): a of shape (time, y, x) = (2, 3, 4) with a[t, y, x] = 100 t + 10 y + x.
/// let header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3, 4), }\n";
/// let mut file = b"\x93NUMPY\x01\x00".to_vec();
/// file.extend((header.len() as u16).to_le_bytes());
/// file.extend(header);
/// for i in 0..24 {
///     file.extend(f64::from(100 * (i / 12) + 10 * (i / 4 % 3) + i % 4).to_le_bytes());
/// }
/// std::fs::write(&path, file)?;
/// let all = NpyArray::open(&path, SnapshotAxis::First)?.on_cells([4, 3])?.to_mat()?;
/// let cell = |x: usize, y: usize| x + 4 * y;
/// assert_eq!(all.shape(), (12, 2));
/// assert_eq!(all[(cell(3, 1), 1)], 113.0);
/// // The same array on 3 × 4 cells: the error has the command.
/// let error = NpyArray::open(&path, SnapshotAxis::First)?.on_cells([3, 4]).err().unwrap();
/// assert!(error.to_string().contains("np.ascontiguousarray(a.transpose(0, 2, 1))"));
/// # std::fs::remove_file(path)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Snapshots that lie one after the other (C order with [`SnapshotAxis::First`], Fortran order with [`SnapshotAxis::Last`]) are read fastest in blocks of columns,
/// others in blocks of rows.
pub struct NpyArray {
    pub(super) path: PathBuf,
    data: Data,
    pub(super) shape: Vec<usize>,
    pub(super) fortran: bool,
    pub(super) axis: SnapshotAxis,
    kind: Number,
}

/// Where the numbers are.
enum Data {
    /// From this byte on.
    File(File, u64),
    Memory(Vec<u8>),
}

/// How a number is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Number {
    pub(super) double: bool,
    pub(super) big_endian: bool,
}

impl Number {
    pub(super) fn size(self) -> usize {
        if self.double { 8 } else { 4 }
    }
    /// From the bytes of one.
    pub(super) fn value(self, bytes: &[u8]) -> f64 {
        if self.double {
            let mut word = [0; 8];
            word.copy_from_slice(bytes);
            if self.big_endian { f64::from_be_bytes(word) } else { f64::from_le_bytes(word) }
        } else {
            let mut word = [0; 4];
            word.copy_from_slice(bytes);
            f64::from(if self.big_endian { f32::from_be_bytes(word) } else { f32::from_le_bytes(word) })
        }
    }
}

impl NpyArray {
    /// The array of a file.
    ///
    /// # Errors
    /// [`SnapshotError::Io`], [`SnapshotError::Format`], [`SnapshotError::DataType`], [`SnapshotError::Truncated`].
    pub fn open(path: impl AsRef<Path>, axis: SnapshotAxis) -> Result<Self, SnapshotError> {
        let path = path.as_ref();
        let io = |e| SnapshotError::io(path, &e);
        let mut file = File::open(path).map_err(io)?;
        let length = file.metadata().map_err(io)?.len();
        let (header, start) = Header::read(&mut file, path)?;
        Self::new(path, axis, header, Data::File(file, start), length.saturating_sub(start))
    }

    /// An array whose file begins at byte `start` of another one and is `length` bytes long.
    pub(super) fn within(
        path: &Path,
        axis: SnapshotAxis,
        mut file: File,
        start: u64,
        length: u64,
    ) -> Result<Self, SnapshotError> {
        file.seek(SeekFrom::Start(start)).map_err(|e| SnapshotError::io(path, &e))?;
        let (header, bytes) = Header::read(&mut file, path)?;
        Self::new(path, axis, header, Data::File(file, start + bytes), length.saturating_sub(bytes))
    }

    /// An array in memory.
    pub(super) fn of_bytes(
        path: &Path,
        axis: SnapshotAxis,
        mut file: Vec<u8>,
    ) -> Result<Self, SnapshotError> {
        let (header, start) = Header::read(&mut file.as_slice(), path)?;
        file.drain(..start as usize);
        let length = file.len() as u64;
        Self::new(path, axis, header, Data::Memory(file), length)
    }

    fn new(
        path: &Path,
        axis: SnapshotAxis,
        Header { kind, fortran, shape }: Header,
        data: Data,
        found: u64,
    ) -> Result<Self, SnapshotError> {
        let count = shape.iter().try_fold(kind.size() as u64, |a, &n| a.checked_mul(n as u64));
        let expected = count.ok_or_else(|| SnapshotError::format(path, format!("its shape is {shape:?}")))?;
        if found < expected {
            let what = format!("an array of {shape:?}");
            return Err(SnapshotError::Truncated { path: path.into(), what, expected, found });
        }
        Ok(Self { path: path.into(), data, shape, fortran, axis, kind })
    }

    /// As in the file.
    #[must_use]
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// Do the values of one snapshot lie one after the other?
    fn by_snapshots(&self) -> bool {
        self.fortran == (self.axis == SnapshotAxis::Last)
    }

    /// `bytes` become those from value number `first` on.
    fn fetch(&self, first: usize, bytes: &mut [u8]) -> Result<(), SnapshotError> {
        let at = first * self.kind.size();
        match &self.data {
            Data::Memory(all) => bytes.copy_from_slice(&all[at..at + bytes.len()]),
            Data::File(file, start) => {
                let mut file = file;
                file.seek(SeekFrom::Start(start + at as u64))
                    .and_then(|_| file.read_exact(bytes))
                    .map_err(|e| SnapshotError::io(&self.path, &e))?;
            }
        }
        Ok(())
    }
}

impl SnapshotSource for NpyArray {
    fn n_rows(&self) -> usize {
        let n = self.shape.len();
        match self.axis {
            SnapshotAxis::First => self.shape.get(1..).unwrap_or(&[]).iter().product(),
            // One axis is one snapshot.
            SnapshotAxis::Last => self.shape[..n.saturating_sub(1).max(n.min(1))].iter().product(),
        }
    }
    fn n_snapshots(&self) -> usize {
        match (self.axis, &self.shape[..]) {
            (SnapshotAxis::First, [first, ..]) => *first,
            (SnapshotAxis::Last, [_, .., last]) => *last,
            _ => 1,
        }
    }
    fn read(
        &self,
        first_row: usize,
        first_snapshot: usize,
        mut to: MatMut<'_, f64>,
    ) -> Result<(), SnapshotError> {
        let (n, m) = (self.n_rows(), self.n_snapshots());
        check_part([n, m], [first_row, first_snapshot], &to)?;
        let (rows, columns, size) = (to.nrows(), to.ncols(), self.kind.size());
        if rows == 0 || columns == 0 {
            return Ok(());
        }
        // Lines are what lies together; all of them at once if nothing is between.
        let by_snapshots = self.by_snapshots();
        let [lines, length] = if by_snapshots { [columns, rows] } else { [rows, columns] };
        let [first_line, first, pitch] =
            if by_snapshots { [first_snapshot, first_row, n] } else { [first_row, first_snapshot, m] };
        let together = if length == pitch { (LINES / (size * length)).clamp(1, lines) } else { 1 };
        let mut bytes = vec![0; together * length * size];
        for line in (0..lines).step_by(together) {
            let count = together.min(lines - line);
            let bytes = &mut bytes[..count * length * size];
            self.fetch((first_line + line) * pitch + first, bytes)?;
            for (l, values) in bytes.chunks_exact(length * size).enumerate() {
                for (i, value) in values.chunks_exact(size).enumerate() {
                    let [row, column] = if by_snapshots { [i, line + l] } else { [line + l, i] };
                    to[(row, column)] = self.kind.value(value);
                }
            }
        }
        Ok(())
    }
}

/// Bytes that are read at a time, about.
const LINES: usize = 1 << 20;

/// What the header tells.
pub(super) struct Header {
    pub(super) kind: Number,
    pub(super) fortran: bool,
    pub(super) shape: Vec<usize>,
}

impl Header {
    /// And how many bytes it takes.
    pub(super) fn read(from: &mut impl Read, path: &Path) -> Result<(Self, u64), SnapshotError> {
        let wrong = |why: &str| SnapshotError::format(path, why);
        let short = |_| wrong("the header of NumPy's format is not whole");
        let mut magic = [0; 8];
        from.read_exact(&mut magic).map_err(short)?;
        if magic[..6] != *b"\x93NUMPY" {
            return Err(wrong("this is no file of NumPy's: it does not begin with its mark"));
        }
        let mut word = [0; 4];
        let size = match magic[6] {
            1 => 2,
            2 | 3 => 4,
            version => return Err(wrong(&format!("version {version} of NumPy's format is not known"))),
        };
        from.read_exact(&mut word[..size]).map_err(short)?;
        let length = u32::from_le_bytes(word) as usize;
        if length > MOST {
            return Err(wrong(&format!("its header is {length} bytes long")));
        }
        let mut text = vec![0; length];
        from.read_exact(&mut text).map_err(short)?;
        let text = String::from_utf8_lossy(&text);
        let header = Self::parse(&text, path)?;
        Ok((header, (8 + size + length) as u64))
    }

    /// Of a dictionary as Python writes it.
    fn parse(text: &str, path: &Path) -> Result<Self, SnapshotError> {
        let wrong = || SnapshotError::format(path, format!("its header is not one of NumPy's: {text}"));
        let after = |key: &str| {
            let rest = text.split_once(&format!("'{key}'")).ok_or_else(wrong)?.1;
            Ok(rest.trim_start().strip_prefix(':').ok_or_else(wrong)?.trim_start())
        };
        let descr = after("descr")?;
        let name = descr.strip_prefix('\'').and_then(|d| d.split('\'').next()).unwrap_or_else(|| {
            // A list: several numbers per entry.
            descr.split_once(']').map_or(descr, |(list, _)| list)
        });
        let kind = match name {
            "<f8" | ">f8" | "<f4" | ">f4" => {
                Number { double: name.ends_with('8'), big_endian: name.starts_with('>') }
            }
            _ => {
                let (what, found) = ("the array".into(), name.into());
                return Err(SnapshotError::DataType { path: path.into(), what, found });
            }
        };
        let fortran = match after("fortran_order")? {
            t if t.starts_with("True") => true,
            f if f.starts_with("False") => false,
            _ => return Err(wrong()),
        };
        let shape = after("shape")?.strip_prefix('(').and_then(|s| s.split(')').next()).ok_or_else(wrong)?;
        let lengths = shape.split(',').map(str::trim).filter(|s| !s.is_empty());
        let shape = lengths
            .map(|s| s.trim_end_matches('L').parse().map_err(|_| wrong()))
            .collect::<Result<_, _>>()?;
        Ok(Self { kind, fortran, shape })
    }
}

/// Longer headers are damaged ones.
const MOST: usize = 1 << 20;
