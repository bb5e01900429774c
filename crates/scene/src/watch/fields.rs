//! VTK files of the fields.
use super::derivatives::VortexFields;
use super::{Solids, Taken, Watch, output};
use crate::setup::FieldChoice;
use crate::view::View;
use coupling::{CouplingError, StepInfo};
use dem::BodyFrames;
use fv_mesh::TimeSeries;
use interfaces::{Checkpoint, RestartError};
use render::files::write_over;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Writes `fields/NNNNN.vti` and `bodies/NNNNN.vtp` at snapshots, and the series that list them.
pub(crate) struct FieldsWatch {
    folder: PathBuf,
    fields: Option<(FieldChoice, TimeSeries)>,
    vortices: VortexFields,
    bodies: Option<(BodyFrames, TimeSeries)>,
    listed: Option<Instant>,
}

/// Series are written again at most this often, and at the end.
const LIST_EVERY: Duration = Duration::from_secs(1);

impl FieldsWatch {
    pub(crate) fn new(
        folder: &Path,
        fields: Option<FieldChoice>,
        bodies: bool,
        resume: Option<f64>,
    ) -> Result<Self, CouplingError> {
        // Nothing but the start is written before the first step, and it is written again.
        let resume = resume.filter(|time| *time > 0.0);
        let series = |name: &str| -> Result<TimeSeries, CouplingError> {
            let list = folder.join(format!("{name}.pvd"));
            match resume {
                Some(time) => TimeSeries::resume(&list, time)
                    .map_err(|e| output("going on with", &list)(io::Error::other(e))),
                None => Ok(TimeSeries::new(list)),
            }
        };
        let frames = || {
            let open = if resume.is_some() { BodyFrames::resume } else { BodyFrames::new };
            open(folder, "bodies").map_err(output("making", &folder.join("bodies")))
        };
        let sub = folder.join("fields");
        if fields.is_some() {
            std::fs::create_dir_all(&sub).map_err(output("making", &sub))?;
        }
        Ok(Self {
            fields: match fields {
                Some(choice) => Some((choice, series("fields")?)),
                None => None,
            },
            vortices: VortexFields::default(),
            bodies: if bodies { Some((frames()?, series("bodies")?)) } else { None },
            folder: folder.into(),
            listed: None,
        })
    }

    fn list(&mut self) -> Result<(), CouplingError> {
        let fields = self.fields.iter().map(|(_, series)| series);
        for series in fields.chain(self.bodies.iter().map(|(_, series)| series)) {
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
        if let Some((choice, series)) = &mut self.fields {
            let name = format!("fields/{index:05}.{}", view.extension());
            let path = self.folder.join(&name);
            let mut derived: Vec<(&str, Vec<&[f64]>)> = Vec::new();
            if choice.vorticity || choice.q_criterion {
                self.vortices.update(view);
                let VortexFields { vorticity, q, .. } = &self.vortices;
                if choice.vorticity {
                    derived.push(("vorticity", vorticity.iter().map(Vec::as_slice).collect()));
                }
                if choice.q_criterion {
                    derived.push(("q_criterion", vec![q]));
                }
            }
            write_over(&path, |out| Ok(view.write_fields(*choice, &solids.lambda, &derived, out)?))
                .map_err(output("writing", &path))?;
            series.add(info.time, name).map_err(|e| output("listing", &path)(io::Error::other(e)))?;
        }
        if let Some((frames, series)) = &mut self.bodies {
            let path = self.folder.join("bodies");
            if let Some(name) = view.write_bodies(frames, index).map_err(output("writing to", &path))? {
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
