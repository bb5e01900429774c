//! Tables of bodies as text, separated by commas.
use csv::{ByteRecord, ReaderBuilder, Writer};
use interfaces::{Pose, Rotation, Twist, Vector};
use nalgebra::{Quaternion, Unit};
use std::io::{Read, Write};

/// One body of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyRow {
    /// Where it is.
    pub pose: Pose,
    /// How it moves, if the table tells.
    pub twist: Option<Twist>,
    /// Its size \[m\], if the table tells.
    pub size: Option<f64>,
    /// What it is; empty if the table does not tell.
    pub kind: String,
}

impl From<Pose> for BodyRow {
    fn from(pose: Pose) -> Self {
        Self { pose, twist: None, size: None, kind: String::new() }
    }
}

/// Why a table could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum BodyTableError {
    /// The file itself.
    #[error("the table of bodies could not be read or written: {0}")]
    Io(#[from] std::io::Error),
    /// There is nothing.
    #[error("the table of bodies is empty; its first line names the columns: {COLUMNS}")]
    NoHeader,
    /// A column that means nothing, or is there twice.
    #[error(
        "line {line}: column {number} is named \"{name}\", which is {problem}; the columns are {COLUMNS}"
    )]
    Column {
        /// Line of the file, from 1.
        line: u64,
        /// Number of the column, from 1.
        number: usize,
        /// Its name.
        name: String,
        /// What is wrong.
        problem: &'static str,
    },
    /// A column that must be there.
    #[error("line {line}: there is no column named \"{name}\"; the columns are {COLUMNS}")]
    Missing {
        /// Line of the file, from 1.
        line: u64,
        /// Its name.
        name: &'static str,
    },
    /// A line of another length.
    #[error("line {line} has {found} fields; the header has {expected}")]
    Width {
        /// Line of the file, from 1.
        line: u64,
        /// Fields of the header.
        expected: usize,
        /// Its own.
        found: usize,
    },
    /// A field that cannot be understood.
    #[error("line {line}, column \"{column}\": {expected} was expected, not \"{text}\"")]
    Field {
        /// Line of the file, from 1.
        line: u64,
        /// Name of the column.
        column: &'static str,
        /// What is there, its beginning if it is long.
        text: String,
        /// What should be.
        expected: &'static str,
    },
    /// A quaternion that is no rotation.
    #[error(
        "line {line}: the quaternion's length is {length}; it must be 1 (what is within 0.01 of it is brought to 1)"
    )]
    Quaternion {
        /// Line of the file, from 1.
        line: u64,
        /// Its length.
        length: f64,
    },
    /// A body that could not be read again.
    #[error("body {body} cannot be written: its {what} is {value}; {remedy}")]
    Row {
        /// Its number, from 0.
        body: usize,
        /// What of it.
        what: &'static str,
        /// The value.
        value: f64,
        /// What it should be.
        remedy: &'static str,
    },
}

/// Columns in the order in which they are written.
const NAMES: [&str; 15] =
    ["x", "y", "z", "qw", "qx", "qy", "qz", "vx", "vy", "vz", "wx", "wy", "wz", "size", "kind"];
const COLUMNS: &str =
    "x, y, z; all or none of qw, qx, qy, qz; all or none of vx, vy, vz, wx, wy, wz; size; kind";
const PLACE: usize = 0;
const TURN: usize = 3;
const TWIST: usize = 7;
const SIZE: usize = 13;
const KIND: usize = 14;
/// Quaternions so near to length one are left as they are, bit for bit.
const UNIT: f64 = 1e-9;
/// Quaternions so near to length one are rounded, not wrong.
const ROUNDED: f64 = 1e-2;

/// Writes bodies as rows x, y, z \[m\], qw, qx, qy, qz, and what there is of vx, vy, vz \[m/s\], wx, wy, wz \[rad/s\], size \[m\], kind. Numbers
/// have as many digits as it takes to read the same ones again.
///
/// ```
/// use dem::placing::{BodyRow, read_bodies, write_bodies};
/// use dem::Pose;
///
/// let rows = [BodyRow { size: Some(0.01), kind: "gravel".into(), ..Pose::at([0.1, 0.2, 1.0 / 3.0]).into() }];
/// let mut file = Vec::new();
/// write_bodies(&mut file, &rows)?;
/// assert!(file.starts_with(b"x,y,z,qw,qx,qy,qz,size,kind\n0.1,0.2,0.3333333333333333,1.0,"));
/// assert_eq!(read_bodies(file.as_slice())?, rows);
/// # Ok::<(), dem::placing::BodyTableError>(())
/// ```
///
/// # Errors
/// [`BodyTableError::Row`] for numbers that are not finite, sizes that are not positive, quaternions that are not of length one;
/// [`BodyTableError::Io`].
pub fn write_bodies(to: impl Write, rows: &[BodyRow]) -> Result<(), BodyTableError> {
    let has = [
        true,
        true,
        rows.iter().any(|r| r.twist.is_some()),
        rows.iter().any(|r| r.size.is_some()),
        rows.iter().any(|r| !r.kind.is_empty()),
    ];
    let group = |column: usize| [TURN, TWIST, SIZE, KIND].iter().filter(|&&start| column >= start).count();
    let columns: Vec<usize> = (0..NAMES.len()).filter(|&c| has[group(c)]).collect();
    let mut out = Writer::from_writer(to);
    out.write_record(columns.iter().map(|&c| NAMES[c])).map_err(io)?;
    for (body, row) in rows.iter().enumerate() {
        let numbers = numbers(row);
        check(body, row, &numbers)?;
        for &column in &columns {
            let number = || numbers[column].map(|v| format!("{v:?}")).unwrap_or_default();
            let text = if column == KIND { row.kind.clone() } else { number() };
            out.write_field(text).map_err(io)?;
        }
        out.write_record(None::<&[u8]>).map_err(io)?;
    }
    Ok(out.flush()?)
}

/// Reads bodies from a table whose first line names its columns, in any order: x, y, z; all or none of qw, qx, qy, qz (not turned else); all
/// or none of vx, vy, vz, wx, wy, wz; size; kind. Empty fields of twist, size and kind tell nothing of that body.
///
/// ```
/// use dem::placing::{BodyTableError, read_bodies};
///
/// let rows = read_bodies("size, y, x, z\n2e-3, 0, 1, 0\n".as_bytes())?;
/// assert_eq!((rows[0].pose.position.x, rows[0].size), (1.0, Some(2e-3)));
/// let wrong = read_bodies("x,y,z\n0,0,0\n\n0,nan,0\n".as_bytes());
/// assert!(matches!(wrong, Err(BodyTableError::Field { line: 4, column: "y", .. })));
/// # Ok::<(), BodyTableError>(())
/// ```
///
/// # Errors
/// What is wrong, where, and what was expected: see [`BodyTableError`].
pub fn read_bodies(mut from: impl Read) -> Result<Vec<BodyRow>, BodyTableError> {
    let mut bytes = Vec::new();
    from.read_to_end(&mut bytes)?;
    let mut reader = ReaderBuilder::new().has_headers(false).flexible(true).from_reader(bytes.as_slice());
    let mut record = ByteRecord::new();
    if !reader.read_byte_record(&mut record).map_err(io)? {
        return Err(BodyTableError::NoHeader);
    }
    let header = Header::new(&record, line(&record, &bytes))?;
    let mut rows = Vec::new();
    while reader.read_byte_record(&mut record).map_err(io)? {
        rows.push(header.row(&record, line(&record, &bytes))?);
    }
    Ok(rows)
}

/// Which field holds which column.
struct Header {
    fields: [Option<usize>; NAMES.len()],
    width: usize,
}

impl Header {
    fn new(record: &ByteRecord, line: u64) -> Result<Self, BodyTableError> {
        let mut fields = [None; NAMES.len()];
        for (i, bytes) in record.iter().enumerate() {
            let name = bytes.trim_ascii();
            let wrong =
                |problem| Err(BodyTableError::Column { line, number: i + 1, name: shown(name), problem });
            match NAMES.iter().position(|n| n.as_bytes() == name) {
                None => return wrong("not known"),
                Some(c) if fields[c].is_some() => return wrong("there twice"),
                Some(c) => fields[c] = Some(i),
            }
        }
        for (group, needed) in [(PLACE..TURN, true), (TURN..TWIST, false), (TWIST..SIZE, false)] {
            let any = needed || group.clone().any(|c| fields[c].is_some());
            if let Some(c) = group.clone().find(|&c| any && fields[c].is_none()) {
                return Err(BodyTableError::Missing { line, name: NAMES[c] });
            }
        }
        Ok(Self { fields, width: record.len() })
    }

    fn row(&self, record: &ByteRecord, line: u64) -> Result<BodyRow, BodyTableError> {
        if record.len() != self.width {
            return Err(BodyTableError::Width { line, expected: self.width, found: record.len() });
        }
        let row = Row { header: self, record, line };
        let place = Vector::new(row.number(PLACE)?, row.number(PLACE + 1)?, row.number(PLACE + 2)?);
        Ok(BodyRow {
            pose: Pose { position: place.into(), orientation: row.orientation()? },
            twist: row.twist()?,
            size: row.size()?,
            kind: row.kind()?,
        })
    }
}

/// One line as it is read.
struct Row<'a> {
    header: &'a Header,
    record: &'a ByteRecord,
    line: u64,
}

impl Row<'_> {
    /// Nothing where there is no such column.
    fn field(&self, column: usize) -> &[u8] {
        self.header.fields[column].and_then(|i| self.record.get(i)).unwrap_or_default()
    }
    fn is_empty(&self, column: usize) -> bool {
        self.field(column).trim_ascii().is_empty()
    }
    fn wrong(&self, column: usize, expected: &'static str) -> BodyTableError {
        let text = shown(self.field(column));
        BodyTableError::Field { line: self.line, column: NAMES[column], text, expected }
    }
    fn number(&self, column: usize) -> Result<f64, BodyTableError> {
        let text = str::from_utf8(self.field(column)).ok();
        let value = text.and_then(|t| t.trim().parse::<f64>().ok()).filter(|v| v.is_finite());
        value.ok_or_else(|| self.wrong(column, "a finite number"))
    }
    fn orientation(&self) -> Result<Rotation, BodyTableError> {
        if self.header.fields[TURN].is_none() {
            return Ok(Rotation::identity());
        }
        let [w, x, y, z] = [0, 1, 2, 3].map(|i| self.number(TURN + i));
        let q = Quaternion::new(w?, x?, y?, z?);
        let length = q.norm();
        match (length - 1.0).abs() {
            off if off <= UNIT => Ok(Unit::new_unchecked(q)),
            off if off <= ROUNDED => Ok(Unit::new_normalize(q)),
            _ => Err(BodyTableError::Quaternion { line: self.line, length }),
        }
    }
    fn twist(&self) -> Result<Option<Twist>, BodyTableError> {
        let empty = (TWIST..SIZE).filter(|&c| self.is_empty(c)).count();
        if empty == SIZE - TWIST {
            return Ok(None);
        }
        let vector = |at: usize| -> Result<Vector, BodyTableError> {
            Ok(Vector::new(self.number(at)?, self.number(at + 1)?, self.number(at + 2)?))
        };
        Ok(Some(Twist { linear: vector(TWIST)?, angular: vector(TWIST + 3)? }))
    }
    fn size(&self) -> Result<Option<f64>, BodyTableError> {
        if self.is_empty(SIZE) {
            return Ok(None);
        }
        match self.number(SIZE) {
            Ok(size) if size > 0.0 => Ok(Some(size)),
            _ => Err(self.wrong(SIZE, "a positive, finite number")),
        }
    }
    fn kind(&self) -> Result<String, BodyTableError> {
        let text = str::from_utf8(self.field(KIND)).map_err(|_| self.wrong(KIND, "text in UTF-8"))?;
        Ok(text.to_owned())
    }
}

/// All numbers of a row, in the order of their columns.
fn numbers(row: &BodyRow) -> [Option<f64>; KIND] {
    let (p, q) = (row.pose.position, row.pose.orientation.quaternion());
    let mut out = [None; KIND];
    for (to, v) in out.iter_mut().zip([p.x, p.y, p.z, q.w, q.i, q.j, q.k]) {
        *to = Some(v);
    }
    if let Some(twist) = &row.twist {
        for (to, v) in out[TWIST..].iter_mut().zip(twist.linear.iter().chain(&twist.angular)) {
            *to = Some(*v);
        }
    }
    out[SIZE] = row.size;
    out
}
fn check(body: usize, row: &BodyRow, numbers: &[Option<f64>; KIND]) -> Result<(), BodyTableError> {
    let wrong = |what, value, remedy| Err(BodyTableError::Row { body, what, value, remedy });
    for (what, number) in NAMES.iter().zip(numbers) {
        if let Some(value) = number.filter(|v| !v.is_finite()) {
            return wrong(what, value, "give a finite number");
        }
    }
    let length = row.pose.orientation.quaternion().norm();
    if (length - 1.0).abs() > UNIT {
        return wrong("quaternion's length", length, "bring it to 1");
    }
    match row.size {
        Some(size) if size <= 0.0 => wrong("size", size, "give a positive number"),
        _ => Ok(()),
    }
}

/// The line on which a record begins: `csv` tells where the one before it ended, and skips empty lines after that.
fn line(record: &ByteRecord, bytes: &[u8]) -> u64 {
    let Some(position) = record.position() else { return 1 };
    let rest = bytes.get(position.byte() as usize..).unwrap_or_default();
    let skipped = rest.iter().take_while(|b| matches!(b, b'\r' | b'\n')).filter(|b| **b == b'\n').count();
    position.line() + skipped as u64
}
/// Text for a message.
fn shown(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).chars().take(40).collect()
}
fn io(error: csv::Error) -> BodyTableError {
    BodyTableError::Io(error.into())
}
