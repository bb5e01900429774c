//! A CSV file that grows with the run, and is cut back to a saved state when the run goes on.
use super::output;
use coupling::CouplingError;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// The file. The first column of every row is the time.
pub(crate) struct Table {
    path: PathBuf,
    file: BufWriter<File>,
}

impl Table {
    /// A new file under `header`, or, when a run goes on at `resume` \[s\], the rows up to then of the one that is there.
    pub(crate) fn open(path: &Path, header: &str, resume: Option<f64>) -> Result<Self, CouplingError> {
        let kept = match resume {
            None => String::new(),
            Some(time) => {
                let text = std::fs::read_to_string(path).map_err(output("reading", path))?;
                let past = |line: &str| {
                    line.split(',')
                        .next()
                        .is_some_and(|t| t.parse::<f64>().is_ok_and(|t| t > time * (1.0 + 1e-9)))
                };
                // A row that was cut off has no end of line.
                let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
                whole.lines().filter(|line| !past(line)).flat_map(|line| [line, "\n"]).collect()
            }
        };
        let mut table = Self {
            path: path.into(),
            file: BufWriter::new(File::create(path).map_err(output("making", path))?),
        };
        let text = if kept.is_empty() { format!("{header}\n") } else { kept };
        table.file.write_all(text.as_bytes()).map_err(output("writing", path))?;
        Ok(table)
    }

    /// One row.
    pub(crate) fn row(
        &mut self,
        time: f64,
        label: Option<&str>,
        values: impl IntoIterator<Item = f64>,
    ) -> Result<(), CouplingError> {
        let write = || {
            write!(self.file, "{time:.9e}")?;
            if let Some(label) = label {
                write!(self.file, ",{label}")?;
            }
            for value in values {
                if value == 0.0 {
                    self.file.write_all(b",0")?;
                } else {
                    write!(self.file, ",{value:.9e}")?;
                }
            }
            writeln!(self.file)
        };
        write().map_err(output("writing", &self.path))
    }

    pub(crate) fn flush(&mut self) -> Result<(), CouplingError> {
        self.file.flush().map_err(output("writing", &self.path))
    }
}

/// Times at which something is due: every step, or every so many seconds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pace {
    every: Option<f64>,
}

impl Pace {
    pub(crate) fn new(every: Option<f64>) -> Self {
        Self { every }
    }
    /// Has a multiple of the interval been reached in the step that ended at `time`?
    pub(crate) fn due(self, time: f64, dt: f64) -> bool {
        let slack = 1e-9 * dt;
        self.every
            .is_none_or(|every| ((time + slack) / every).floor() > ((time - dt + slack) / every).floor())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_behind_a_state_are_dropped() {
        let path = std::env::temp_dir().join(format!("siltflow-table-{}.csv", std::process::id()));
        let mut table = Table::open(&path, "time,x", None).unwrap();
        (1..=3).for_each(|i| table.row(f64::from(i), None, [0.5]).unwrap());
        table.flush().unwrap();
        std::fs::OpenOptions::new().append(true).open(&path).unwrap().write_all(b"4.0,0.").unwrap();
        let mut table = Table::open(&path, "time,x", Some(2.0)).unwrap();
        table.row(2.5, None, [1.0]).unwrap();
        table.flush().unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        assert_eq!(text.lines().count(), 4, "{text}");
        assert!(text.ends_with("2.500000000e0,1.000000000e0\n"));
    }

    #[test]
    fn every_interval_has_one_time() {
        let pace = Pace::new(Some(0.1));
        let due = (1..=1000).filter(|i| pace.due(f64::from(*i) * 0.003, 0.003)).count();
        assert_eq!(due, 30);
    }
}
