//! Frames of a run's bodies.
use super::shape_surfaces::ShapeSurfaces;
use super::{vectors, write_polygons};
use crate::{ContactLaw, RigidBodies, Shape};
use interfaces::vtk::DataArray;
use interfaces::{BodyId, Point};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::fs::OpenOptions;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Most polygons of a frame of surfaces: 1.6 MB of triangles of meshes, 2 MB of quadrilaterals.
pub(super) const MOST_POLYGONS: usize = 32_768;

/// Python script that turns frames of points into surfaces.
const SCRIPT: &str = include_str!("body_frames.py");

/// Writes the bodies of a run to `FOLDER/NAME/NNNNN.vtp`, one file per frame.
///
/// A frame holds the surfaces of the bodies, as [`RigidBodies::write_vtp`] writes them, up to 32768
/// polygons (2 MB). A larger one holds a point per body, as [`RigidBodies::write_vtp_points`]
/// writes it, with the number of its shape (`shape`), whose surface is written once, to
/// `NAME/shapes/NNNNN.vtp`, and the factors along the axes of the body's frame by which this
/// surface is multiplied (`scale`): scaled copies of a shape share a surface. The script `NAME.py`
/// is then written, too: ParaView loads it as a state (File > Load State) and shows the surfaces of
/// all frames; `python3 NAME.py` writes them, if the package `vtk` is installed.
pub struct BodyFrames {
    folder: PathBuf,
    name: String,
    surfaces: ShapeSurfaces,
    /// Numbers of the files of shapes, by the hash of their bytes.
    numbers: HashMap<u64, usize>,
    /// Whether the script has been written.
    scripted: bool,
}

impl BodyFrames {
    /// Makes `folder/name`; files of shapes that are there are removed.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn new(folder: &Path, name: &str) -> io::Result<Self> {
        let frames = Self::empty(folder, name)?;
        for shape in frames.shapes() {
            std::fs::remove_file(shape)?;
        }
        Ok(frames)
    }

    /// Continues the frames of an interrupted run in `folder/name`, with its numbers of shapes.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn resume(folder: &Path, name: &str) -> io::Result<Self> {
        let mut frames = Self::empty(folder, name)?;
        for (number, shape) in frames.shapes().enumerate() {
            frames.numbers.entry(hash(&std::fs::read(shape)?)).or_insert(number);
        }
        Ok(frames)
    }

    fn empty(folder: &Path, name: &str) -> io::Result<Self> {
        std::fs::create_dir_all(folder.join(name))?;
        Ok(Self {
            folder: folder.into(),
            name: name.into(),
            surfaces: ShapeSurfaces::default(),
            numbers: HashMap::new(),
            scripted: false,
        })
    }

    /// Files of shapes that are there, in the order of their numbers.
    fn shapes(&self) -> impl Iterator<Item = PathBuf> + use<> {
        let folder = self.folder.join(&self.name);
        (0..).map(move |number| folder.join(shape_name(number))).take_while(|path| path.exists())
    }

    /// Writes frame `index` of some bodies, periodic ones at their image next after `corner`;
    /// returns its path from the folder.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn write<L: ContactLaw>(
        &mut self,
        bodies: &RigidBodies<L>,
        corner: Point,
        which: impl IntoIterator<Item = BodyId>,
        index: usize,
    ) -> io::Result<String> {
        let mut which: Vec<BodyId> = which.into_iter().collect();
        self.surfaces.update(which.iter().map(|&b| bodies.shared_shape(b)));
        which.retain(|&b| !self.surfaces.of(bodies.shared_shape(b)).surface.ends.is_empty());
        let surfaces = which.iter().map(|&b| (b, self.surfaces.of(bodies.shared_shape(b))));
        let polygons: usize = surfaces.clone().map(|(_, own)| own.surface.ends.len()).sum();
        let mut frame = Vec::new();
        if polygons <= MOST_POLYGONS {
            bodies.write_surfaces(&mut frame, corner, surfaces)?;
        } else {
            let scales = vectors("scale", surfaces.map(|(_, own)| own.scale));
            let numbers =
                which.iter().map(|&b| self.number(bodies.shared_shape(b))).collect::<io::Result<Vec<_>>>()?;
            let shapes = vec![DataArray::indices("shape", &numbers), scales];
            bodies.write_points(&mut frame, corner, &which, shapes)?;
            if !self.scripted {
                std::fs::write(self.folder.join(format!("{}.py", self.name)), SCRIPT)?;
                self.scripted = true;
            }
        }
        let path = format!("{}/{index:05}.vtp", self.name);
        write_over(&self.folder.join(&path), &frame)?;
        Ok(path)
    }

    /// Number of the file of a shape, which is written if there is none.
    fn number(&mut self, shape: &Arc<dyn Shape>) -> io::Result<usize> {
        let own = self.surfaces.entry(shape);
        if let Some(number) = own.number {
            return Ok(number);
        }
        let mut file = Vec::new();
        write_polygons(&mut file, &own.surface.surface.rounded(), Vec::new())?;
        let next = self.numbers.len();
        let number = match self.numbers.entry(hash(&file)) {
            Entry::Occupied(number) => *number.get(),
            Entry::Vacant(free) => {
                let path = self.folder.join(&self.name).join(shape_name(next));
                std::fs::create_dir_all(path.parent().unwrap_or(&self.folder))?;
                std::fs::write(path, &file)?;
                *free.insert(next)
            }
        };
        own.number = Some(number);
        Ok(number)
    }
}

fn shape_name(number: usize) -> String {
    format!("shapes/{number:05}.vtp")
}

fn hash(bytes: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    bytes.hash(&mut hasher);
    hasher.finish()
}

/// Writes over a file, which takes less time than to truncate it first.
fn write_over(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = OpenOptions::new().write(true).create(true).truncate(false).open(path)?;
    file.write_all(bytes)?;
    file.set_len(bytes.len() as u64)
}

#[cfg(test)]
mod tests;
