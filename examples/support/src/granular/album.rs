//! Pictures and files for ParaView.
use super::law::Granulate;
use super::scene::Scene;
use crate::Outcome;
use crate::picture::solids::{Model, Portrait, Tint};
use interfaces::{BodyId, Kinematics, Point, Pose};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// How bright walls are.
const WALL: f64 = 0.78;

/// Draws the scene.
pub(super) fn picture(path: &Path, scene: &impl Scene, bodies: &Granulate, title: &str) -> Outcome<()> {
    let furniture = scene.furniture();
    let mut models: Vec<Model<'_>> = furniture
        .iter()
        .map(|(shape, pose)| Model { shape: &**shape, pose: *pose, tint: Tint::Grey(WALL) })
        .collect();
    let corner = corner(scene);
    for b in bodies.ids() {
        if scene.hidden(bodies, b) {
            continue;
        }
        let grain = b.0 >= scene.first_grain();
        let tint = if grain { Tint::Value(scene.value(bodies, b)) } else { Tint::Grey(WALL) };
        models.push(Model { shape: bodies.shape(b), pose: wrapped(bodies, b, corner, grain), tint });
    }
    let (label, range) = scene.scale();
    let portrait = Portrait { view: scene.view(), models: &models, range, label: Some(label), title };
    portrait.draw(path).map_err(|e| format!("drawing {}: {e}", path.display()))?;
    Ok(())
}

/// From where on a periodic box is drawn: where grains should be, or from 0 on.
fn corner(scene: &impl Scene) -> Point {
    scene.domain().min.map(|x| if x.is_finite() { x } else { 0.0 })
}

/// In a periodic scene, the image of a grain that is within the box; walls where they are.
fn wrapped(bodies: &Granulate, b: BodyId, corner: Point, grain: bool) -> Pose {
    let pose = bodies.pose(b);
    if grain { Pose { position: bodies.periods().wrap(pose.position, corner), ..pose } } else { pose }
}

/// `bodies.pvd` and the files it lists.
pub(super) struct Album {
    folder: PathBuf,
    series: Option<fv_mesh::TimeSeries>,
    pictures: bool,
    /// Seconds that it took.
    pub(super) seconds: f64,
}

impl Album {
    /// A new one; or the one of an earlier run, up to `time`.
    pub(super) fn new(folder: &Path, pictures: bool, vtk: bool, resumed: Option<f64>) -> Outcome<Self> {
        for (name, wanted) in [("frames", pictures), ("bodies", vtk)] {
            let folder = folder.join(name);
            if resumed.is_none() && folder.exists() {
                // What an earlier run left there is not this run's.
                for file in std::fs::read_dir(&folder)?.flatten() {
                    let path = file.path();
                    if path.extension().is_some_and(|e| e == "png" || e == "vtp") {
                        std::fs::remove_file(path)?;
                    }
                }
            }
            if wanted {
                std::fs::create_dir_all(folder)?;
            }
        }
        let path = folder.join("bodies.pvd");
        let series = match (vtk, resumed) {
            (false, _) => None,
            (true, None) => Some(fv_mesh::TimeSeries::new(path)),
            (true, Some(time)) => Some(fv_mesh::TimeSeries::resume(path, time)?),
        };
        Ok(Self { folder: folder.into(), series, pictures, seconds: 0.0 })
    }

    /// Adds a frame.
    pub(super) fn add(&mut self, index: usize, time: f64, scene: &impl Scene, bodies: &Granulate) -> Outcome<()> {
        let watch = crate::cpu::Stopwatch::start();
        if let Some(series) = &mut self.series {
            let name = format!("bodies/{index:05}.vtp");
            let mut file = BufWriter::new(File::create(self.folder.join(&name))?);
            bodies.write_vtp(&mut file, corner(scene))?;
            file.flush()?;
            series.push(time, name)?;
        }
        if self.pictures {
            let grains = bodies.n_bodies() - scene.first_grain();
            let title = format!("t = {time:.3} s, {grains} grains");
            picture(&self.folder.join(format!("frames/{index:05}.png")), scene, bodies, &title)?;
        }
        self.seconds += watch.elapsed().wall;
        Ok(())
    }
}
