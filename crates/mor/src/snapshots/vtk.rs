//! Fields in VTK's XML files.
use super::npy::Number;
use super::xml::tags;
use super::{SnapshotError, base64};
use crate::shifted::Grid;
use flate2::read::ZlibDecoder;
use std::borrow::Cow;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// A VTK XML file of one piece (`.vti`, `.vtr`, `.vtu`, `.vtp`): the data at its cells and points, appended raw (as `fv-mesh` writes them) or as base64, or within
/// the text as base64 or decimal numbers; packed by zlib or not.
pub struct VtkFile {
    path: PathBuf,
    arrays: Vec<VtkArray>,
    grid: Option<Grid>,
    big_endian: bool,
    /// Of lengths: 4 or 8 bytes.
    word: usize,
    packed: bool,
    /// Where appended data begin, and whether they are raw.
    appended: Option<(u64, bool)>,
    /// Numbers of points and cells, if the piece has them.
    sizes: [Option<usize>; 2],
}

/// What the file says of an array.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VtkArray {
    /// Unique at the cells or points.
    pub name: String,
    /// Numbers per cell or point.
    pub components: usize,
    /// Or at the points.
    pub at_cells: bool,
    kind: String,
    place: Place,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Place {
    /// From there on, counted from the first appended byte.
    Appended(u64),
    Text {
        base64: bool,
        text: String,
    },
}

/// The marks between header and data.
const APPENDED: &[u8] = b"<AppendedData";
/// Bytes at the end of a file among which its last tag is.
const TAIL: u64 = 256;
/// Last tag of a whole file.
const END: &str = "</VTKFile>";
/// Bytes that are looked through for it at a time.
const STEP: u64 = 1 << 16;

impl VtkFile {
    /// Reads the header.
    ///
    /// # Errors
    /// [`SnapshotError::Io`], [`SnapshotError::Format`].
    pub fn open(path: impl AsRef<Path>) -> Result<Self, SnapshotError> {
        let path = path.as_ref();
        let io = |e| SnapshotError::io(path, &e);
        let wrong = |why: String| SnapshotError::format(path, why);
        let mut file = File::open(path).map_err(io)?;
        let mut bytes = Vec::new();
        let mark = loop {
            let seen = bytes.len().saturating_sub(APPENDED.len());
            let new = Read::by_ref(&mut file).take(STEP).read_to_end(&mut bytes).map_err(io)?;
            let place = bytes[seen..].windows(APPENDED.len()).position(|w| w == APPENDED);
            match place {
                Some(at) if bytes[seen + at..].contains(&b'_') || new == 0 => break Some(seen + at),
                None if new == 0 => break None,
                _ => {}
            }
        };
        let header = String::from_utf8_lossy(&bytes[..mark.unwrap_or(bytes.len())]).into_owned();
        let appended = match mark {
            None => None,
            Some(at) => {
                let from = bytes[at..].iter().position(|&b| b == b'_');
                let from = from.ok_or_else(|| wrong("its appended data do not begin with `_`".into()))?;
                let raw = String::from_utf8_lossy(&bytes[at..at + from]).contains("raw");
                Some(((at + from + 1) as u64, raw))
            }
        };
        let mut of = Self {
            path: path.into(),
            arrays: vec![],
            grid: None,
            big_endian: false,
            word: 4,
            packed: false,
            appended,
            sizes: [None; 2],
        };
        of.parse(&header)?;
        let length = file.metadata().map_err(io)?.len();
        file.seek(SeekFrom::Start(length.saturating_sub(TAIL))).map_err(io)?;
        bytes.clear();
        file.take(TAIL).read_to_end(&mut bytes).map_err(io)?;
        if !String::from_utf8_lossy(&bytes).trim_end().ends_with(END) {
            return Err(wrong(format!("its end `{END}` is missing: the file was cut short; write it again")));
        }
        Ok(of)
    }

    fn parse(&mut self, header: &str) -> Result<(), SnapshotError> {
        let path = self.path.clone();
        let wrong = |why: String| SnapshotError::format(&path, why);
        let mut at_cells = None;
        let (mut known, mut pieces) = (false, 0);
        for tag in tags(header) {
            let get = |key| tag.get(key).unwrap_or_default();
            match tag.name {
                "VTKFile" => {
                    known = true;
                    self.big_endian = get("byte_order") == "BigEndian";
                    self.word = if get("header_type") == "UInt64" { 8 } else { 4 };
                    self.packed = match &*get("compressor") {
                        "" => false,
                        "vtkZLibDataCompressor" => true,
                        other => {
                            return Err(wrong(format!("its data are packed by {other}; only zlib is read")));
                        }
                    };
                }
                "Piece" => {
                    pieces += 1;
                    let extent: Vec<i64> = tag.numbers("Extent").unwrap_or_default();
                    self.sizes = match extent[..] {
                        [a, b, c, d, e, f] => [1, 0].map(|more| {
                            let along = [b - a, d - c, f - e].map(|n| usize::try_from(n + more).ok());
                            along.into_iter().try_fold(1_usize, |all, n| all.checked_mul(n?))
                        }),
                        _ => ["NumberOfPoints", "NumberOfCells"].map(|key| get(key).parse().ok()),
                    };
                }
                "ImageData" => {
                    let origin = tag.numbers("Origin").unwrap_or_else(|| vec![0.0; 3]);
                    let spacing = tag.numbers("Spacing").unwrap_or_else(|| vec![1.0; 3]);
                    let extent: Vec<i64> = tag.numbers("WholeExtent").unwrap_or_default();
                    self.grid = grid_of(&extent, &origin, &spacing);
                }
                "CellData" => at_cells = Some(true),
                "PointData" => at_cells = Some(false),
                "/CellData" | "/PointData" => at_cells = None,
                "DataArray" => {
                    let Some(at_cells) = at_cells else { continue };
                    let number = |key: &str| tag.get(key).map(|n| n.parse::<u64>());
                    let place = match &*get("format") {
                        "appended" => match number("offset") {
                            Some(Ok(offset)) => Place::Appended(offset),
                            _ => return Err(wrong(format!("the array `{}` has no offset", get("Name")))),
                        },
                        format => Place::Text { base64: format == "binary", text: tag.text.trim().into() },
                    };
                    let components = number("NumberOfComponents").and_then(Result::ok).unwrap_or(1).max(1);
                    let (name, kind) = (get("Name").into_owned(), get("type").into_owned());
                    let components = components as usize;
                    self.arrays.push(VtkArray { name, components, at_cells, kind, place });
                }
                _ => {}
            }
        }
        match (known, pieces) {
            (false, _) => Err(wrong("this is no XML file of VTK's".into())),
            (true, 0 | 1) => Ok(()),
            (true, n) => Err(wrong(format!("it has {n} pieces; write it as one"))),
        }
    }

    /// At cells and points.
    #[must_use]
    pub fn arrays(&self) -> &[VtkArray] {
        &self.arrays
    }

    /// Of the cells of an image, periodic.
    #[must_use]
    pub fn grid(&self) -> Option<Grid> {
        self.grid
    }

    /// The array of this name, at cells rather than points.
    ///
    /// # Errors
    /// [`SnapshotError::NoArray`].
    pub fn array(&self, name: &str) -> Result<&VtkArray, SnapshotError> {
        let of_name = |at_cells| self.arrays.iter().find(move |a| a.name == name && a.at_cells == at_cells);
        of_name(true).or_else(|| of_name(false)).ok_or_else(|| SnapshotError::NoArray {
            path: self.path.clone(),
            name: name.into(),
            there: self.arrays.iter().map(|a| a.name.clone()).collect(),
        })
    }

    /// Its values: all of the first component, then all of the second, and so on.
    ///
    /// # Errors
    /// [`SnapshotError`].
    pub fn field(&self, name: &str) -> Result<Vec<f64>, SnapshotError> {
        let array = self.array(name)?;
        let values = match &array.place {
            Place::Text { base64: false, text } => {
                let numbers = text.split_whitespace().map(str::parse);
                numbers.collect::<Result<_, _>>().map_err(|e| self.broken(array, &format!("{e}")))?
            }
            _ => {
                let kind = self.number(array)?;
                let bytes = self.bytes(array)?;
                bytes.chunks_exact(kind.size()).map(|b| kind.value(b)).collect::<Vec<f64>>()
            }
        };
        let c = array.components;
        if let Some(expected) = self.sizes[usize::from(array.at_cells)].map(|n| n.saturating_mul(c))
            && values.len() != expected
        {
            let what = format!("the array `{}`", array.name);
            return Err(SnapshotError::Shape {
                path: self.path.clone(),
                what,
                expected,
                found: values.len(),
            });
        }
        if c == 1 {
            return Ok(values);
        }
        Ok((0..c).flat_map(|i| values[i.min(values.len())..].iter().step_by(c).copied()).collect())
    }

    fn broken(&self, array: &VtkArray, why: &str) -> SnapshotError {
        SnapshotError::format(&self.path, format!("the array `{}`: {why}", array.name))
    }

    fn number(&self, array: &VtkArray) -> Result<Number, SnapshotError> {
        match &*array.kind {
            "Float32" | "Float64" => {
                Ok(Number { double: array.kind == "Float64", big_endian: self.big_endian })
            }
            found => Err(SnapshotError::DataType {
                path: self.path.clone(),
                what: format!("the array `{}`", array.name),
                found: found.into(),
            }),
        }
    }

    /// The bytes of its numbers.
    fn bytes(&self, array: &VtkArray) -> Result<Vec<u8>, SnapshotError> {
        let io = |e| SnapshotError::io(&self.path, &e);
        let text = |text: &[u8]| {
            base64::decode(text).ok_or_else(|| self.broken(array, "its text is not base64, or cut short"))
        };
        let offset = match &array.place {
            Place::Text { text: t, .. } => return self.unpacked(array, &text(t.as_bytes())?),
            Place::Appended(offset) => *offset,
        };
        let Some((start, raw)) = self.appended else {
            return Err(self.broken(array, "there are no appended data"));
        };
        let mut file = File::open(&self.path).map_err(io)?;
        let total = file.metadata().map_err(io)?.len();
        file.seek(SeekFrom::Start(start.saturating_add(offset))).map_err(io)?;
        let mut bytes = Vec::new();
        if raw && !self.packed {
            // No more than there is, whatever the length says.
            file.by_ref().take(self.word as u64).read_to_end(&mut bytes).map_err(io)?;
            let length = self.length(array, &bytes, 0)?;
            let left = total.saturating_sub(start.saturating_add(offset) + self.word as u64);
            if length > left {
                return Err(self.short(array, length, left));
            }
            bytes.clear();
            file.take(length).read_to_end(&mut bytes).map_err(io)?;
            return Ok(bytes);
        }
        let others = self.arrays.iter().filter_map(|a| match a.place {
            Place::Appended(o) if o > offset => Some(o - offset),
            _ => None,
        });
        // Raw lengths are told; text ends where the next array begins.
        file.take(if raw { u64::MAX } else { others.min().unwrap_or(u64::MAX) })
            .read_to_end(&mut bytes)
            .map_err(io)?;
        if raw {
            return self.unpacked(array, &bytes);
        }
        let end = bytes.iter().position(|&b| b == b'<').unwrap_or(bytes.len());
        self.unpacked(array, &text(&bytes[..end])?)
    }

    fn short(&self, array: &VtkArray, expected: u64, found: u64) -> SnapshotError {
        let what = format!("the array `{}`", array.name);
        SnapshotError::Truncated { path: self.path.clone(), what, expected, found }
    }

    /// The number of a length in a header.
    fn length(&self, array: &VtkArray, bytes: &[u8], number: usize) -> Result<u64, SnapshotError> {
        let at = number * self.word;
        let word = bytes.get(at..at + self.word);
        let word = word.ok_or_else(|| self.short(array, (at + self.word) as u64, bytes.len() as u64))?;
        let fold = |sum: u64, b: &u8| sum << 8 | u64::from(*b);
        Ok(if self.big_endian { word.iter().fold(0, fold) } else { word.iter().rev().fold(0, fold) })
    }

    /// The data after their lengths.
    fn unpacked(&self, array: &VtkArray, bytes: &[u8]) -> Result<Vec<u8>, SnapshotError> {
        let length = |number| self.length(array, bytes, number);
        let piece = |at: usize, n: u64| {
            let all = bytes.len() as u64;
            let end = (at as u64).checked_add(n).filter(|&end| end <= all);
            let end = end.ok_or_else(|| self.short(array, (at as u64).saturating_add(n), all))?;
            Ok(&bytes[at..end as usize])
        };
        if !self.packed {
            return Ok(piece(self.word, length(0)?)?.to_vec());
        }
        // Number of blocks, their length, that of the last one if it is shorter, and what each takes.
        let blocks = length(0)? as usize;
        let mut at = blocks.saturating_add(3).saturating_mul(self.word);
        let mut out = Vec::new();
        for block in 0..blocks {
            let size = length(3 + block)?;
            ZlibDecoder::new(piece(at, size)?)
                .read_to_end(&mut out)
                .map_err(|e| self.broken(array, &format!("block {block} cannot be unpacked: {e}")))?;
            at += size as usize;
        }
        let (size, last) = (length(1)?, length(2)?);
        let full = if last == 0 { blocks as u64 } else { (blocks as u64).saturating_sub(1) };
        let expected = full.saturating_mul(size).saturating_add(last);
        if blocks > 0 && out.len() as u64 != expected {
            return Err(self.short(array, expected, out.len() as u64));
        }
        Ok(out)
    }

    pub(super) fn path(&self) -> Cow<'_, Path> {
        self.path.as_path().into()
    }
}

/// The cells of an image, as a grid.
fn grid_of(extent: &[i64], origin: &[f64], spacing: &[f64]) -> Option<Grid> {
    let (&[a, b, c, d, e, f], &[x, y, z], &[h, k, l]) = (extent, origin, spacing) else { return None };
    let cells = [b - a, d - c, f - e].map(|n| usize::try_from(n).unwrap_or(0));
    let first = [x + (a as f64 + 0.5) * h, y + (c as f64 + 0.5) * k, z + (e as f64 + 0.5) * l];
    Some(Grid::new(cells, [h, k, l]).ok()?.starting_at(first.into()))
}
