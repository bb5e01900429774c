//! Pictures of the flow.
use super::run::Fall;
use coupling::{CouplingError, Observer, StepInfo};
use dem::{Chen, ContactLaw};
use render::comparison::Field;
use render::{Disc, Domain, Frames, Scalar};
use std::path::{Path, PathBuf};

/// Speeds on a rectangle at one time, and the bodies in it.
#[derive(Clone, Debug, Default)]
pub struct Slice {
    /// Time \[s\].
    pub time: f64,
    /// Cells along the picture's axes.
    pub cells: [usize; 2],
    /// |u| in these cells \[m/s\].
    pub speed: Vec<f64>,
    /// How much of them is solid, 0 to 1; empty where bodies are outlined, not shaded.
    pub solid: Vec<f64>,
    /// What is outlined.
    pub discs: Vec<Disc>,
}

impl Slice {
    /// For a figure.
    pub fn field(&self) -> Field<'_> {
        let [nx, ny] = self.cells;
        Field { time: self.time, speed: Scalar { nx, ny, values: &self.speed }, discs: &self.discs }
    }
}

/// What pictures show.
pub struct View<const D: usize, L: ContactLaw = Chen> {
    /// The rectangle.
    pub domain: Domain,
    /// Top of the colour scale \[m/s\].
    pub max_speed: f64,
    /// The flow on it now.
    pub slice: fn(&Fall<D, L>) -> Slice,
}

/// A PNG at every snapshot; all of them stay at hand for the figure of the run.
pub struct Album<const D: usize, L: ContactLaw = Chen> {
    folder: PathBuf,
    frames: Frames,
    look: fn(&Fall<D, L>) -> Slice,
    /// In the order of time.
    pub slices: Vec<Slice>,
}

impl<const D: usize, L: ContactLaw> Album<D, L> {
    pub(super) fn new(out: &Path, view: &View<D, L>) -> std::io::Result<Self> {
        let folder = out.join("frames");
        std::fs::create_dir_all(&folder)?;
        let frames = Frames::new(view.domain, view.max_speed);
        Ok(Self { folder, frames, look: view.slice, slices: Vec::new() })
    }
}

impl<const D: usize, L: ContactLaw> Observer<Fall<D, L>> for Album<D, L> {
    fn snapshot(&mut self, fall: &mut Fall<D, L>, index: usize, _: &StepInfo) -> Result<(), CouplingError> {
        let slice = (self.look)(fall);
        let [nx, ny] = slice.cells;
        let field = |values| Scalar { nx, ny, values };
        let mut solid = slice.solid.clone();
        solid.resize(slice.speed.len(), 0.0);
        let path = self.folder.join(format!("{index:05}.png"));
        let title = format!("t = {:.3} s", slice.time);
        self.frames.draw(&path, &field(&slice.speed), &field(&solid), &slice.discs, &title).map_err(
            |source| CouplingError::Output { what: format!("drawing {}", path.display()), source },
        )?;
        self.slices.push(slice);
        Ok(())
    }
}
