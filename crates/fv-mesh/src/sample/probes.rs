//! Values at points over time.
use super::line::csv_name;
use super::{Quantity, SampleError, Sampler};
use std::fmt::Write as _;
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;

/// Records quantities at fixed points over time: a CSV table with one row per time and per quantity and point one
/// column `name@i` (`name_x@i` … for a velocity), i the number of the point. Comments at its top tell the places.
#[derive(Debug)]
pub struct Probes<'s, const D: usize, W = File> {
    sampler: &'s Sampler<D>,
    points: Vec<[f64; D]>,
    out: W,
    /// Once written or read.
    header: Option<String>,
    /// The row at hand.
    row: String,
}

impl<'s, const D: usize, W: Write> Probes<'s, D, W> {
    /// Probes at `points` \[m\] that write a new table to `out`.
    ///
    /// # Errors
    /// [`SampleError::Points`] for no points, [`SampleError::Outside`] if one is beyond a bounded side.
    pub fn new(sampler: &'s Sampler<D>, points: &[[f64; D]], out: W) -> Result<Self, SampleError> {
        if points.is_empty() {
            return Err(SampleError::Points { found: 0, least: 1 });
        }
        points.iter().try_for_each(|&x| sampler.inside(x).map(|_| ()))?;
        Ok(Self { sampler, points: points.to_vec(), out, header: None, row: String::new() })
    }

    /// Adds the row of time `time` \[s\].
    ///
    /// # Errors
    /// [`SampleError::Columns`] for other quantities than in the rows before, [`SampleError::Grid`] for one on
    /// another grid, [`SampleError::Io`] if the row cannot be written.
    pub fn record(&mut self, time: f64, quantities: &[(&str, Quantity<'_, D>)]) -> Result<(), SampleError> {
        for (_, quantity) in quantities {
            self.sampler.check(quantity)?;
        }
        self.row.clear();
        self.write_header(quantities);
        match &self.header {
            Some(header) if *header != self.row => {
                return Err(SampleError::Columns { expected: header.clone(), found: self.row.clone() });
            }
            Some(_) => {}
            None => {
                let header = self.row.clone();
                for (i, x) in self.points.iter().enumerate() {
                    writeln!(self.out, "# {i}: {x:?} m")?;
                }
                writeln!(self.out, "{header}")?;
                self.header = Some(header);
            }
        }
        self.row.clear();
        // Writing to a string does not fail.
        let _ = write!(self.row, "{time:e}");
        for (_, quantity) in quantities {
            for c in 0..quantity.components() {
                for &x in &self.points {
                    let value = self.sampler.component(quantity, c, self.sampler.inside(x)?);
                    let _ = write!(self.row, ",{value:e}");
                }
            }
        }
        self.row.push('\n');
        self.out.write_all(self.row.as_bytes())?;
        self.out.flush()?;
        Ok(())
    }

    fn write_header(&mut self, quantities: &[(&str, Quantity<'_, D>)]) {
        self.row.push_str("time");
        for (name, quantity) in quantities {
            for column in quantity.columns(name) {
                for i in 0..self.points.len() {
                    let _ = write!(self.row, ",{}", csv_name(&format!("{column}@{i}")));
                }
            }
        }
    }
}

impl<'s, const D: usize> Probes<'s, D> {
    /// Probes that add to the table in the file at `path`, which is made if it is not there.
    ///
    /// # Errors
    /// Those of [`new`](Self::new); [`SampleError::Io`] if the file cannot be read or opened.
    pub fn append(
        sampler: &'s Sampler<D>,
        points: &[[f64; D]],
        path: impl AsRef<Path>,
    ) -> Result<Self, SampleError> {
        let path = path.as_ref();
        let out = OpenOptions::new().create(true).append(true).open(path)?;
        let mut probes = Self::new(sampler, points, out)?;
        for line in BufReader::new(File::open(path)?).lines() {
            let line = line?;
            if !line.starts_with('#') {
                probes.header = Some(line);
                break;
            }
        }
        Ok(probes)
    }
}
