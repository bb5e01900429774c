//! Series of files over time.
use super::OutputError;
use interfaces::vtk::escaped;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Time \[s\] and file.
type Entry = (f64, String);

/// A `.pvd` collection: the files of a run and their times, which ParaView plays as one.
#[derive(Clone, Debug)]
pub struct TimeSeries {
    path: PathBuf,
    entries: Vec<Entry>,
}

impl TimeSeries {
    /// An empty series, to be written to `path`.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into(), entries: Vec::new() }
    }

    /// The series that an earlier run wrote to `path`, up to `time` \[s\]; what it lists later is dropped.
    ///
    /// # Errors
    /// [`OutputError::Io`] if there is none or it cannot be read.
    pub fn resume(path: impl Into<PathBuf>, time: f64) -> Result<Self, OutputError> {
        let path = path.into();
        let mut entries = read(&std::fs::read_to_string(&path)?);
        // Times are written with ten digits.
        entries.retain(|(t, _)| *t <= time * (1.0 + 1e-9));
        Ok(Self { path, entries })
    }

    /// Adds the file `name`, as seen from the folder of the series, at time `time` \[s\]; [`save`](Self::save) writes it.
    ///
    /// # Errors
    /// [`OutputError::Time`] for a time that is not finite or before the last.
    pub fn add(&mut self, time: f64, name: impl Into<String>) -> Result<(), OutputError> {
        let last = self.entries.last().map_or(f64::NEG_INFINITY, |e| e.0);
        if !(time.is_finite() && time >= last) {
            return Err(OutputError::Time { time, last });
        }
        self.entries.push((time, name.into()));
        Ok(())
    }

    /// [`add`](Self::add) and [`save`](Self::save).
    ///
    /// # Errors
    /// Those of both; the entry is not kept then.
    pub fn push(&mut self, time: f64, name: impl Into<String>) -> Result<(), OutputError> {
        self.add(time, name)?;
        self.save().inspect_err(|_| {
            self.entries.pop();
        })
    }

    /// Writes the series beside its old version and then in its place, so that what is there can always be opened.
    ///
    /// # Errors
    /// [`OutputError::Io`] if it cannot be written.
    pub fn save(&self) -> Result<(), OutputError> {
        let mut part = self.path.clone().into_os_string();
        part.push(".part");
        let mut file = BufWriter::new(File::create(&part)?);
        write(&mut file, &self.entries)?;
        file.flush()?;
        std::fs::rename(&part, &self.path)?;
        Ok(())
    }

    /// Where it is written.
    pub fn path(&self) -> &Path {
        &self.path
    }
    /// Time \[s\] and file of each entry.
    pub fn entries(&self) -> impl Iterator<Item = (f64, &str)> {
        self.entries.iter().map(|(time, name)| (*time, name.as_str()))
    }
}

/// Writes the collection with one part per entry.
fn write(out: &mut impl Write, entries: &[Entry]) -> io::Result<()> {
    writeln!(out, "<?xml version=\"1.0\"?>")?;
    writeln!(out, "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>")?;
    for (time, file) in entries {
        writeln!(out, "<DataSet timestep=\"{time:.9e}\" part=\"0\" file=\"{}\"/>", escaped(file))?;
    }
    writeln!(out, "</Collection>\n</VTKFile>")
}

/// The entries that [`write`] wrote; lines that are none are skipped.
fn read(text: &str) -> Vec<Entry> {
    let entry = |line: &str| {
        let value = |key: &str| line.split_once(key)?.1.split('"').nth(1);
        let file = value("file=")?.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"");
        Some((value("timestep=")?.parse().ok()?, file.replace("&amp;", "&")))
    };
    text.lines().filter_map(entry).collect()
}
