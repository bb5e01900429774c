//! Pictures and files for ParaView.
use super::law::Granulate;
use super::scene::Scene;
use crate::Outcome;
use crate::portrait_shape::portrait_shape;
use interfaces::{BodyId, Kinematics, Point, Pose};
use render::solids::{Model, Portrait, Tint};
use std::path::{Path, PathBuf};

/// How bright walls are.
const WALL: f64 = 0.78;

/// Draws the scene.
pub(super) fn picture(path: &Path, scene: &impl Scene, bodies: &Granulate, title: &str) -> Outcome<()> {
    let furniture = scene.furniture();
    let mut models: Vec<Model<'_>> = furniture
        .iter()
        .map(|(shape, pose)| Model { shape: portrait_shape(&**shape), pose: *pose, tint: Tint::Grey(WALL) })
        .collect();
    let corner = corner(scene);
    for b in bodies.ids() {
        if scene.hidden(bodies, b) {
            continue;
        }
        let grain = b.0 >= scene.first_grain();
        let tint = if grain { Tint::Value(scene.value(bodies, b)) } else { Tint::Grey(WALL) };
        models.push(Model {
            shape: portrait_shape(bodies.shape(b)),
            pose: wrapped(bodies, b, corner, grain),
            tint,
        });
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

/// Series of the grains and of the walls for ParaView.
const SERIES: [&str; 2] = ["grains", "walls"];

/// `grains.pvd`, `walls.pvd` and the files that they list; pictures.
pub(super) struct Album {
    folder: PathBuf,
    series: Vec<(&'static str, dem::BodyFrames, fv_mesh::TimeSeries)>,
    pictures: bool,
}

impl Album {
    /// Album of a new run, or of an interrupted one up to `resumed`. `walls`: whether there are any.
    pub(super) fn new(
        folder: &Path,
        pictures: bool,
        vtk: bool,
        walls: bool,
        resumed: Option<f64>,
    ) -> Outcome<Self> {
        let mut series = Vec::new();
        for name in SERIES {
            let path = folder.join(format!("{name}.pvd"));
            if resumed.is_none() {
                let _ = std::fs::remove_file(&path);
                clear(&folder.join(name))?;
            }
            if vtk && (name == "grains" || walls) {
                series.push(match resumed {
                    None => (name, dem::BodyFrames::new(folder, name)?, fv_mesh::TimeSeries::new(path)),
                    Some(time) => {
                        let frames = dem::BodyFrames::resume(folder, name)?;
                        (name, frames, fv_mesh::TimeSeries::resume(path, time)?)
                    }
                });
            }
        }
        if resumed.is_none() {
            clear(&folder.join("frames"))?;
        }
        if pictures {
            std::fs::create_dir_all(folder.join("frames"))?;
        }
        Ok(Self { folder: folder.into(), series, pictures })
    }

    /// Adds a frame.
    pub(super) fn add(
        &mut self,
        index: usize,
        time: f64,
        scene: &impl Scene,
        bodies: &Granulate,
    ) -> Outcome<()> {
        let first = scene.first_grain();
        for (name, frames, series) in &mut self.series {
            let grains = *name == "grains";
            let which = bodies.ids().filter(|b| (b.0 >= first) == grains);
            series.push(time, frames.write(bodies, corner(scene), which, index)?)?;
        }
        if self.pictures {
            let title = format!("t = {time:.3} s, {} grains", bodies.n_bodies() - first);
            picture(&self.folder.join(format!("frames/{index:05}.png")), scene, bodies, &title)?;
        }
        Ok(())
    }
}

/// Removes what an earlier run left there.
fn clear(folder: &Path) -> Outcome<()> {
    for file in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = file.path();
        if path.extension().is_some_and(|e| e == "png" || e == "vtp") {
            std::fs::remove_file(path)?;
        }
    }
    Ok(())
}
