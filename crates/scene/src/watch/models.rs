//! Reduced models of the run's snapshots.
mod fitted;

use super::images::{section_of, slice_of};
use super::{Solids, Taken, Watch, output};
use crate::setup::{Images, ModelSetup};
use crate::view::View;
use coupling::{CouplingError, StepInfo};
use fitted::{Fitted, Story};
use interfaces::{BodyId, Checkpoint, Pose, RestartError, SnapshotSink};
use mor::snapshots::{NpyArray, NpyWriter, SnapshotAxis, SnapshotSource};
use nalgebra::{Quaternion, UnitQuaternion};
use render::section::{Layer, Sheet};
use serde_json::Value;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// Writes the snapshots of each field that has models to `models/FIELD.npy`, and makes the models of them when the run is over.
pub(crate) struct ModelsWatch {
    folder: PathBuf,
    /// The slice that pictures show, of scenes with pictures.
    images: Option<Images>,
    quiet: bool,
    times: Vec<f64>,
    fields: Vec<Recorded>,
    models: Vec<Followed>,
    field: Vec<f64>,
    components: [Vec<f64>; 3],
    results: Vec<Value>,
}

/// The snapshots of a field.
struct Recorded {
    name: String,
    path: PathBuf,
    file: Option<NpyWriter>,
}

/// A model to be, and where its frames have been.
struct Followed {
    setup: ModelSetup,
    /// Of each frame, at each snapshot.
    paths: Vec<Vec<Pose>>,
}

/// Numbers of a pose.
const POSE: usize = 7;

fn failed<E: std::error::Error + Send + Sync + 'static>(path: &Path) -> impl FnOnce(E) -> CouplingError {
    let error = output("models:", path);
    move |e| error(io::Error::other(e))
}

impl ModelsWatch {
    pub(crate) fn new(
        folder: &Path,
        models: &[ModelSetup],
        images: Option<Images>,
        quiet: bool,
    ) -> Result<Self, CouplingError> {
        let folder = folder.join("models");
        std::fs::create_dir_all(&folder).map_err(output("making", &folder))?;
        let mut fields: Vec<Recorded> = Vec::new();
        for model in models {
            let name = &model.field;
            if fields.iter().all(|field| field.name != *name) {
                let path = folder.join(format!("{name}.npy"));
                fields.push(Recorded { name: name.clone(), path, file: None });
            }
        }
        let follow = |setup: &ModelSetup| Followed {
            setup: setup.clone(),
            paths: vec![Vec::new(); setup.frames.len()],
        };
        let models = models.iter().map(follow).collect();
        let (times, results) = (Vec::new(), Vec::new());
        Ok(Self {
            folder,
            images,
            quiet,
            times,
            fields,
            models,
            field: vec![],
            components: Default::default(),
            results,
        })
    }

    /// The picture: the field between two snapshots that made the model, as it is and as the model has it, and their difference.
    fn draw(&self, view: &dyn View, model: &Followed, story: &Story) -> Result<(), CouplingError> {
        let Some(images) = &self.images else { return Ok(()) };
        let cells = images.part(&slice_of(view, images), view.axis(images.axes[0]).cells());
        let n = view.lattice().shape().iter().product::<usize>();
        // Of vectors their length.
        let slice = |field: &[f64]| -> Vec<f64> {
            let components = field.len() / n;
            let value = |&c: &usize| match components {
                1 => field[c],
                _ => (0..components).map(|k| field[c + k * n].powi(2)).sum::<f64>().sqrt(),
            };
            cells.iter().map(value).collect()
        };
        let off: Vec<f64> = story.predicted.iter().zip(&story.field).map(|(p, f)| p - f).collect();
        let section = section_of(view, images);
        let truth = slice(&story.field);
        let ends = |values: &[f64]| {
            let least = values.iter().copied().fold(0.0, f64::min);
            [least, values.iter().copied().fold(f64::MIN_POSITIVE, f64::max)]
        };
        let (predicted, off) = (slice(&story.predicted), slice(&off));
        let label = match model.setup.field.as_str() {
            "lambda" => "solid fraction",
            "velocity" => "|u| in m/s",
            "pressure" => "pressure in Pa",
            name => name,
        };
        let mut sheet = Sheet::default();
        for (what, values, of) in
            [("run", &truth, &truth), ("model", &predicted, &truth), ("off", &off, &off)]
        {
            let limits = ends(of);
            let layer =
                Layer { values, solid: None, bodies: &[], solids_alone: false, limits, label, signed: false };
            let path = self.folder.join(format!("{}_{what}.png", model.setup.name));
            let title = [format!("{}, {what}", model.setup.name), format!("t = {:.4} s", story.time)];
            let title = title.each_ref().map(String::as_str);
            section.draw(&mut sheet, &path, &layer, title).map_err(output("drawing", &path))?;
        }
        Ok(())
    }
}

impl Checkpoint for ModelsWatch {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        sink("times", &self.times);
        for model in &self.models {
            let pose = |p: &Pose| {
                let (x, q) = (p.position, p.orientation);
                [x.x, x.y, x.z, q.w, q.i, q.j, q.k]
            };
            let paths: Vec<f64> = model.paths.iter().flatten().flat_map(pose).collect();
            sink(&format!("paths.{}", model.setup.name), &paths);
        }
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        let missing = |name: &str| RestartError::Missing(name.into());
        self.times = source("times").ok_or_else(|| missing("times"))?.to_vec();
        let m = self.times.len();
        for field in &mut self.fields {
            let file = NpyWriter::resume(&field.path, m);
            field.file = Some(file.map_err(|e| RestartError::Differs(e.to_string()))?);
        }
        for model in &mut self.models {
            let all = RestartError::take(
                source,
                &format!("paths.{}", model.setup.name),
                POSE * m * model.paths.len(),
            )?;
            let mut poses = all.as_chunks::<POSE>().0.iter().map(|&[x, y, z, w, i, j, k]| Pose {
                position: [x, y, z].into(),
                orientation: UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k)),
            });
            model.paths.iter_mut().for_each(|path| *path = poses.by_ref().take(m).collect());
        }
        Ok(())
    }
}

impl Watch for ModelsWatch {
    fn name(&self) -> &'static str {
        "models"
    }
    fn takes_lambda(&self, _: usize) -> Taken {
        if self.fields.iter().any(|field| field.name == "lambda") { Taken::All } else { Taken::None }
    }
    fn snapshot(
        &mut self,
        view: &mut dyn View,
        solids: &Solids,
        _: usize,
        info: &StepInfo,
    ) -> Result<(), CouplingError> {
        for recorded in &mut self.fields {
            self.field.clear();
            match recorded.name.as_str() {
                "lambda" => self.field.extend(&solids.lambda),
                "pressure" => view.pressure(&mut self.field),
                "velocity" => {
                    let components = &mut self.components[..view.dim()];
                    view.centred(components);
                    components.iter().for_each(|u| self.field.extend(u));
                }
                name => {
                    let others = view.others();
                    self.field.extend(others.into_iter().filter(|o| o.name == name).flat_map(|o| o.values));
                }
            }
            let path = &recorded.path;
            let file = match &mut recorded.file {
                Some(file) => file,
                None => recorded.file.insert(NpyWriter::create(path).map_err(failed(path))?),
            };
            file.push(info.time, &self.field).map_err(|e| output("writing", path)(io::Error::other(e)))?;
        }
        for model in &mut self.models {
            for (frame, body) in model.paths.iter_mut().zip(&model.setup.frames) {
                let mut ids = (0..view.bodies().n_bodies()).map(BodyId);
                let Some(b) = ids.find(|b| view.serial(*b) == *body as u64) else {
                    let what = format!(
                        "a frame of model \"{}\" at t = {} s: its body has left; end the run before that, or leave it out of `frames`",
                        model.setup.name, info.time
                    );
                    return Err(CouplingError::Output { what, source: io::ErrorKind::NotFound.into() });
                };
                frame.push(view.bodies().pose(b));
            }
        }
        self.times.push(info.time);
        Ok(())
    }
    fn flush(&mut self) -> Result<(), CouplingError> {
        for field in &mut self.fields {
            if let Some(file) = &mut field.file {
                file.flush().map_err(failed(&field.path))?;
            }
        }
        Ok(())
    }
    fn finish(&mut self, view: &mut dyn View, stop: &AtomicBool) -> Result<(), CouplingError> {
        self.flush()?;
        self.results.clear();
        for model in &self.models {
            let name = &model.setup.name;
            if !self.quiet {
                // Nobody may be reading.
                let _ = writeln!(io::stderr(), "model \"{name}\" of {} snapshots", self.times.len());
            }
            let Some(recorded) = self.fields.iter().find(|field| field.name == model.setup.field) else {
                continue;
            };
            let all = NpyArray::open(&recorded.path, SnapshotAxis::First).and_then(|file| file.to_mat());
            let all = all.map_err(failed(&recorded.path))?;
            let refused = |e| CouplingError::Output {
                what: format!("making the model \"{name}\""),
                source: io::Error::other(e),
            };
            let snapshots = (self.times.as_slice(), all.as_ref());
            let made = Fitted::new(&model.setup, view, snapshots, &model.paths, stop).map_err(refused)?;
            let Some((fitted, story)) = made else { break };
            let file = self.folder.join(format!("{name}.model"));
            fitted.record().save(&file).map_err(failed(&file))?;
            let path = self.folder.join(format!("{name}_modes.{}", view.extension()));
            let write = || -> io::Result<()> {
                let modes = fitted.modes();
                let n = view.lattice().shape().iter().product::<usize>();
                let fields: Vec<_> =
                    modes.iter().map(|(name, mode)| (name.as_str(), mode.chunks(n).collect())).collect();
                let mut file = BufWriter::new(File::create(&path)?);
                view.write_named(&fields, &mut file).map_err(io::Error::other)?;
                file.flush()
            };
            write().map_err(output("writing", &path))?;
            self.draw(view, model, &story)?;
            self.results.push(story.result);
        }
        Ok(())
    }
    fn results(&self) -> Option<Value> {
        Some(Value::Array(self.results.clone()))
    }
}
