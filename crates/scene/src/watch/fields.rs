//! VTK files of the fields.
use super::{Solids, Taken, Watch, output};
use crate::view::View;
use coupling::{CouplingError, StepInfo};
use example_support::files::write_over;
use fv_mesh::TimeSeries;
use interfaces::{Checkpoint, RestartError};
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Writes `fields/NNNNN.vti` and `bodies/NNNNN.vtp` at snapshots, and the series that list them.
pub(crate) struct FieldsWatch {
    folder: PathBuf,
    fields: Option<TimeSeries>,
    bodies: Option<TimeSeries>,
    listed: Option<Instant>,
}

/// Series are written again at most this often, and at the end.
const LIST_EVERY: Duration = Duration::from_secs(1);

impl FieldsWatch {
    pub(crate) fn new(
        folder: &Path,
        [fields, bodies]: [bool; 2],
        resume: Option<f64>,
    ) -> Result<Self, CouplingError> {
        let series = |name: &str, wanted: bool| -> Result<Option<TimeSeries>, CouplingError> {
            if !wanted {
                return Ok(None);
            }
            let (sub, list) = (folder.join(name), folder.join(format!("{name}.pvd")));
            std::fs::create_dir_all(&sub).map_err(output("making", &sub))?;
            match resume {
                // Nothing but the start was shown before the first step, and that is shown again.
                Some(time) if time > 0.0 => TimeSeries::resume(&list, time)
                    .map(Some)
                    .map_err(|e| output("going on with", &list)(io::Error::other(e))),
                _ => Ok(Some(TimeSeries::new(list))),
            }
        };
        Ok(Self {
            fields: series("fields", fields)?,
            bodies: series("bodies", bodies)?,
            folder: folder.into(),
            listed: None,
        })
    }

    fn list(&mut self) -> Result<(), CouplingError> {
        for series in [&self.fields, &self.bodies].into_iter().flatten() {
            series
                .save()
                .map_err(|e| output("listing the snapshots in", series.path())(io::Error::other(e)))?;
        }
        self.listed = Some(Instant::now());
        Ok(())
    }
}

impl Checkpoint for FieldsWatch {
    fn save(&self, _: &mut dyn FnMut(&str, &[f64])) {}
    fn restore<'a>(&mut self, _: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        Ok(())
    }
}

impl Watch for FieldsWatch {
    fn name(&self) -> &'static str {
        "fields"
    }
    fn takes_lambda(&self, _: usize) -> Taken {
        if self.fields.is_some() { Taken::All } else { Taken::None }
    }
    fn snapshot(
        &mut self,
        view: &mut dyn View,
        solids: &Solids,
        index: usize,
        info: &StepInfo,
    ) -> Result<(), CouplingError> {
        if let Some(series) = &mut self.fields {
            let name = format!("fields/{index:05}.{}", view.extension());
            let path = self.folder.join(&name);
            write_over(&path, |out| Ok(view.write_fields(&solids.lambda, out)?))
                .map_err(output("writing", &path))?;
            series.add(info.time, name).map_err(|e| output("listing", &path)(io::Error::other(e)))?;
        }
        if let Some(series) = &mut self.bodies {
            let name = format!("bodies/{index:05}.vtp");
            let path = self.folder.join(&name);
            if write_over(&path, |out| view.write_bodies(out)).map_err(output("writing", &path))? {
                series.add(info.time, name).map_err(|e| output("listing", &path)(io::Error::other(e)))?;
            }
        }
        if self.listed.is_none_or(|t| t.elapsed() > LIST_EVERY) {
            self.list()?;
        }
        Ok(())
    }
    fn flush(&mut self) -> Result<(), CouplingError> {
        self.list()
    }
}
