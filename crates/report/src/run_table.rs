//! Tables of a run: CSV files with a comment that has the units.
use std::collections::BTreeMap;
use std::io;
use std::path::Path;

/// Bodies of a table whose rows are kept; the others are counted.
pub(crate) const MOST_BODIES: usize = 8;

/// Rows of a table, or of one body in it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rows {
    /// One list per column; values that are no numbers are NaN.
    pub(crate) columns: Vec<Vec<f64>>,
}

/// A table as read.
#[derive(Clone, Debug, Default)]
pub(crate) struct RunTable {
    /// Names of the columns of numbers; the first is the time or the iteration.
    pub(crate) names: Vec<String>,
    /// Rows by body, in the order of the file; a table without bodies has one entry with an empty
    /// name.
    pub(crate) bodies: Vec<(String, Rows)>,
    /// Bodies beyond [`MOST_BODIES`].
    pub(crate) more_bodies: usize,
    /// Rows that are cut short or too long, and values that are no numbers or not finite.
    pub(crate) damaged: [usize; 2],
}

impl RunTable {
    /// Reads a table.
    ///
    /// # Errors
    /// That of the file, or a missing head.
    pub(crate) fn read(path: &Path) -> io::Result<Self> {
        let reader = csv::ReaderBuilder::new().comment(Some(b'#')).flexible(true).from_path(path);
        Self::from_reader(reader.map_err(io::Error::other)?)
    }

    fn from_reader<R: io::Read>(mut reader: csv::Reader<R>) -> io::Result<Self> {
        let head = reader.byte_headers().map_err(io::Error::other)?;
        let head: Vec<String> =
            head.iter().map(|name| String::from_utf8_lossy(name).trim().to_owned()).collect();
        if head.first().is_none_or(String::is_empty) {
            return Err(io::Error::new(
                io::ErrorKind::InvalidData,
                "there is no line with the names of columns",
            ));
        }
        let body_column = (head.get(1).is_some_and(|name| name == "body")).then_some(1);
        let numbers: Vec<usize> = (0..head.len()).filter(|i| Some(*i) != body_column).collect();
        let mut table = Self { names: numbers.iter().map(|i| head[*i].clone()).collect(), ..Self::default() };
        let (mut places, mut record) = (BTreeMap::<Vec<u8>, usize>::new(), csv::ByteRecord::new());
        loop {
            match reader.read_byte_record(&mut record) {
                Ok(true) => {}
                Ok(false) => break,
                Err(error) if error.is_io_error() => return Err(io::Error::other(error)),
                Err(_) => {
                    table.damaged[0] += 1;
                    continue;
                }
            }
            if record.len() != head.len() {
                table.damaged[0] += 1;
                continue;
            }
            let body = body_column.and_then(|i| record.get(i)).unwrap_or_default();
            let place = match places.get(body) {
                Some(place) => *place,
                None => {
                    let place = places.len();
                    places.insert(body.to_vec(), place);
                    if place < MOST_BODIES {
                        let rows = Rows { columns: vec![Vec::new(); numbers.len()] };
                        table.bodies.push((String::from_utf8_lossy(body).into_owned(), rows));
                    }
                    place
                }
            };
            let Some((_, rows)) = table.bodies.get_mut(place) else { continue };
            for (column, i) in rows.columns.iter_mut().zip(&numbers) {
                let text = record.get(*i).and_then(|text| std::str::from_utf8(text).ok());
                let value = text.and_then(|text| text.trim().parse().ok()).unwrap_or(f64::NAN);
                table.damaged[1] += usize::from(!value.is_finite());
                column.push(value);
            }
        }
        table.more_bodies = places.len().saturating_sub(MOST_BODIES);
        Ok(table)
    }

    /// Whether there is no row.
    pub(crate) fn is_empty(&self) -> bool {
        self.bodies.iter().all(|(_, rows)| rows.columns.first().is_none_or(Vec::is_empty))
    }

    /// Points (first column, column `name`) of the body with this number; none without such a
    /// column. Rows whose first column is not finite are left out.
    pub(crate) fn points(&self, body: usize, name: &str) -> Option<Vec<(f64, f64)>> {
        let column = self.names.iter().position(|n| n == name)?;
        let rows = &self.bodies.get(body)?.1;
        let pairs = rows.columns[0].iter().copied().zip(rows.columns[column].iter().copied());
        Some(pairs.filter(|p| p.0.is_finite()).collect())
    }

    /// Note on damage.
    pub(crate) fn note(&self, name: &str) -> Option<String> {
        let [rows, values] = self.damaged;
        let mut parts = Vec::new();
        if rows > 0 {
            parts.push(format!("{rows} rows have not as many values as its head and are left out"));
        }
        if values > 0 {
            parts.push(format!("{values} values are no finite numbers; curves are interrupted there"));
        }
        if self.more_bodies > 0 {
            parts.push(format!(
                "of {} bodies the first {MOST_BODIES} are shown",
                self.more_bodies + MOST_BODIES
            ));
        }
        (!parts.is_empty()).then(|| format!("{name}: {}", parts.join("; ")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> io::Result<RunTable> {
        RunTable::from_reader(
            csv::ReaderBuilder::new().comment(Some(b'#')).flexible(true).from_reader(text.as_bytes()),
        )
    }

    #[test]
    fn bodies_have_rows_of_their_own() {
        let t = table("# units\ntime,body,x\n0,a,1\n0,b,2\n1e0,a,3\n").unwrap();
        assert_eq!(t.names, ["time", "x"]);
        assert_eq!(t.points(0, "x").unwrap(), [(0.0, 1.0), (1.0, 3.0)]);
        assert_eq!(t.points(1, "x").unwrap(), [(0.0, 2.0)]);
        assert_eq!((t.points(0, "y"), t.points(2, "x"), t.note("t")), (None, None, None));
    }

    #[test]
    fn damage_is_counted() {
        let t = table("time,x,y\n0,1,2\n1,NaN,2\n2,inf,what\n3,4").unwrap();
        assert_eq!(t.damaged, [1, 3]);
        assert!(t.note("t.csv").unwrap().starts_with("t.csv: 1 rows have not"));
        assert_eq!(t.points(0, "x").unwrap().len(), 3);
        assert!(table("").is_err() && table("# units\n").is_err());
        assert!(table("time,x\n").unwrap().is_empty());
    }

    #[test]
    fn many_bodies_are_counted() {
        let rows: String = (0..20).map(|i| format!("0,b{i},{i}\n")).collect();
        let t = table(&format!("time,body,x\n{rows}")).unwrap();
        assert_eq!((t.bodies.len(), t.more_bodies), (MOST_BODIES, 12));
        assert!(t.note("t").unwrap().contains("of 20 bodies the first 8"));
    }
}
