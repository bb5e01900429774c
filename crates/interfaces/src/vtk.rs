//! The container of VTK's XML files: a header of named arrays, then their bytes, raw and
//! appended. `fv-mesh` writes grids (`.vti`, `.vtr`, `.vtu`) with it, `dem` bodies (`.vtp`).
//! Format: *The VTK User's Guide*, "XML file formats".
use std::borrow::Cow;
use std::io::{self, Write};

/// How floating-point numbers are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// 32 bits: half the file, seven digits, enough for pictures.
    #[default]
    Single,
    /// 64 bits: what was computed.
    Double,
}

/// One array of an XML file: `components` numbers per tuple.
pub struct DataArray<'a> {
    name: &'a str,
    components: usize,
    kind: &'static str,
    bytes: Vec<u8>,
}

impl<'a> DataArray<'a> {
    /// Numbers of this precision from their bytes, little-endian, one after the other.
    pub fn of_bytes(name: &'a str, components: usize, precision: Precision, bytes: Vec<u8>) -> Self {
        let kind = match precision {
            Precision::Single => "Float32",
            Precision::Double => "Float64",
        };
        Self { name, components, kind, bytes }
    }
    /// Single-precision numbers: half the file, seven digits, enough for pictures.
    pub fn float32(name: &'a str, components: usize, values: impl IntoIterator<Item = f64>) -> Self {
        let bytes = bytes(values, |v: f64| (v as f32).to_le_bytes());
        Self { name, components, kind: "Float32", bytes }
    }
    /// Double-precision numbers.
    pub fn float64(name: &'a str, components: usize, values: impl IntoIterator<Item = f64>) -> Self {
        let bytes = bytes(values, f64::to_le_bytes);
        Self { name, components, kind: "Float64", bytes }
    }
    /// Connectivity and offsets, in 32 bits where these hold them.
    pub fn indices(name: &'a str, values: &[usize]) -> Self {
        match values.iter().max() {
            Some(&most) if most > i32::MAX as usize => Self::int64(name, values.iter().map(|&i| i as i64)),
            _ => {
                let bytes = bytes(values, |&i| (i as i32).to_le_bytes());
                Self { name, components: 1, kind: "Int32", bytes }
            }
        }
    }
    /// Whole numbers: ids.
    pub fn int64(name: &'a str, values: impl IntoIterator<Item = i64>) -> Self {
        let bytes = bytes(values, i64::to_le_bytes);
        Self { name, components: 1, kind: "Int64", bytes }
    }
    /// Bytes: types of cells, flags.
    pub fn uint8(name: &'a str, values: impl IntoIterator<Item = u8>) -> Self {
        Self { name, components: 1, kind: "UInt8", bytes: values.into_iter().collect() }
    }
}

fn bytes<T, const N: usize>(values: impl IntoIterator<Item = T>, of: impl Fn(T) -> [u8; N]) -> Vec<u8> {
    let values = values.into_iter();
    let mut bytes = Vec::with_capacity(N * values.size_hint().0);
    values.for_each(|v| bytes.extend_from_slice(&of(v)));
    bytes
}

/// A section of a piece: `("CellData", "Scalars=\"lambda\"", arrays)`.
pub type Section<'a> = (&'a str, &'a str, Vec<DataArray<'a>>);

/// Writes a file of VTK type `kind` (`ImageData`, `PolyData` …) with one piece: `grid` holds the
/// attributes of the grid element and `piece` those of its piece.
///
/// # Errors
/// What the writer answers.
pub fn write(
    out: &mut impl Write,
    kind: &str,
    grid: &str,
    piece: &str,
    sections: &[Section<'_>],
) -> io::Result<()> {
    writeln!(out, "<?xml version=\"1.0\"?>")?;
    writeln!(
        out,
        "<VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">"
    )?;
    writeln!(out, "<{kind} {grid}>\n<Piece {piece}>")?;
    let mut offset = 0;
    for (section, attributes, arrays) in sections {
        writeln!(out, "<{section} {attributes}>")?;
        for a in arrays {
            writeln!(
                out,
                "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{offset}\"/>",
                a.kind,
                escaped(a.name),
                a.components
            )?;
            offset += 8 + a.bytes.len();
        }
        writeln!(out, "</{section}>")?;
    }
    write!(out, "</Piece>\n</{kind}>\n<AppendedData encoding=\"raw\">\n_")?;
    for a in sections.iter().flat_map(|s| &s.2) {
        out.write_all(&(a.bytes.len() as u64).to_le_bytes())?;
        out.write_all(&a.bytes)?;
    }
    writeln!(out, "\n</AppendedData>\n</VTKFile>")
}

/// `text` as the value of an attribute.
pub fn escaped(text: &str) -> Cow<'_, str> {
    if !text.contains(['&', '<', '>', '"']) {
        return text.into();
    }
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;").into()
}
