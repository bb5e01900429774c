//! The table of motion: a row per instant.
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// `motion.csv` and what is in it.
pub struct History {
    file: BufWriter<File>,
    columns: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl History {
    /// An empty table with these columns.
    ///
    /// # Errors
    /// What the disk answers.
    pub fn new(path: &Path, columns: Vec<String>) -> io::Result<Self> {
        let mut file = BufWriter::new(File::create(path)?);
        writeln!(file, "{}", columns.join(","))?;
        Ok(Self { file, columns, rows: Vec::new() })
    }
    /// The first `rows` rows of the table that an earlier run wrote.
    ///
    /// # Errors
    /// What the disk answers; `InvalidData` if it is another table, or shorter.
    pub fn resume(path: &Path, columns: Vec<String>, rows: usize) -> io::Result<Self> {
        let text = std::fs::read_to_string(path)?;
        let wrong =
            |what: &str| io::Error::new(io::ErrorKind::InvalidData, format!("{}: {what}", path.display()));
        let mut lines = text.lines();
        if lines.next() != Some(columns.join(",").as_str()) {
            return Err(wrong("it has other columns"));
        }
        let kept: Vec<Vec<f64>> = lines
            .take(rows)
            .map(|l| {
                l.split(',')
                    .map(str::parse)
                    .collect::<Result<_, _>>()
                    .map_err(|_| wrong("a field is no number"))
            })
            .collect::<io::Result<_>>()?;
        if kept.len() < rows {
            return Err(wrong("it is shorter than the saved run"));
        }
        let mut table = Self::new(path, columns)?;
        for row in kept {
            table.push(row)?;
        }
        Ok(table)
    }
    /// Adds a row.
    ///
    /// # Errors
    /// What the disk answers.
    pub fn push(&mut self, row: Vec<f64>) -> io::Result<()> {
        let text: Vec<String> = row.iter().map(|v| format!("{v:?}")).collect();
        writeln!(self.file, "{}", text.join(","))?;
        self.file.flush()?;
        self.rows.push(row);
        Ok(())
    }
    /// All values of a column; none of one that there is not.
    pub fn column(&self, name: &str) -> Vec<f64> {
        let at = self.columns.iter().position(|c| c == name);
        at.map_or_else(Vec::new, |at| self.rows.iter().map(|r| r[at]).collect())
    }
    /// A column over time.
    pub fn over_time(&self, name: &str) -> Vec<(f64, f64)> {
        self.rows.iter().map(|r| r[0]).zip(self.column(name)).collect()
    }
    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.rows.len()
    }
    /// Is there no row?
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_taken_up_again() {
        let path = std::env::temp_dir().join(format!("siltflow-motion-{}.csv", std::process::id()));
        let columns = || vec!["time".to_owned(), "energy".to_owned()];
        let mut table = History::new(&path, columns()).unwrap();
        for i in 0..5 {
            table.push(vec![f64::from(i), 1.0 / f64::from(i + 3)]).unwrap();
        }
        drop(table);
        let table = History::resume(&path, columns(), 3).unwrap();
        assert_eq!(table.over_time("energy"), [(0.0, 1.0 / 3.0), (1.0, 0.25), (2.0, 0.2)]);
        assert!(table.column("speed").is_empty() && table.len() == 3);
        drop(table);
        assert!(History::resume(&path, columns(), 4).is_err());
        assert!(History::resume(&path, vec!["time".into()], 1).is_err());
        std::fs::remove_file(&path).unwrap();
    }
}
