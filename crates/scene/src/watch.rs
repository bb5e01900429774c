//! Who looks on while a scene runs.
mod averages;
mod derivatives;
mod fields;
mod forces;
mod images;
mod lines;
mod models;
mod probes;
mod surfaces;
mod table;
mod trajectories;

use averages::AveragesWatch;
use fields::FieldsWatch;
use forces::ForcesWatch;
use images::ImagesWatch;
use lines::LinesWatch;
use models::ModelsWatch;
use probes::ProbesWatch;
use surfaces::SurfacesWatch;
pub(crate) use table::{Pace, Table};
use trajectories::TrajectoriesWatch;

use crate::setup::Setup;
use crate::view::View;
use coupling::{CouplingError, StepInfo};
use ibm::SolidFraction;
use interfaces::Checkpoint;
use serde_json::Value;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Someone who looks on. What it keeps from step to step is saved with the run's state.
pub(crate) trait Watch: Checkpoint {
    /// A word for states and results.
    fn name(&self) -> &'static str;
    /// After every step.
    fn step(&mut self, view: &mut dyn View, info: &StepInfo) -> Result<(), CouplingError> {
        let _ = (view, info);
        Ok(())
    }
    /// Of which cells does the snapshot with this index take λ?
    fn takes_lambda(&self, index: usize) -> Taken {
        let _ = index;
        Taken::None
    }
    /// At the start and the end of every interval.
    fn snapshot(
        &mut self,
        view: &mut dyn View,
        solids: &Solids,
        index: usize,
        info: &StepInfo,
    ) -> Result<(), CouplingError> {
        let _ = (view, solids, index, info);
        Ok(())
    }
    /// Before a state is saved, and at the end: nothing may wait in memory.
    fn flush(&mut self) -> Result<(), CouplingError> {
        Ok(())
    }
    /// The run is over: the last files, unless they take long and somebody asks to `stop`.
    fn finish(&mut self, view: &mut dyn View, stop: &AtomicBool) -> Result<(), CouplingError> {
        let _ = (view, stop);
        Ok(())
    }
    /// What goes into the results, if anything.
    fn results(&self) -> Option<Value> {
        None
    }
    /// Paths in the folder of the tables that it writes step by step.
    fn tables(&self) -> Vec<String> {
        vec![]
    }
}

/// Cells whose λ is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Taken {
    None,
    /// Of the layer with this number along this axis.
    Layer(usize, usize),
    All,
}

/// The solid fraction of the cells, as far as it is taken.
#[derive(Default)]
pub(crate) struct Solids {
    /// Body by body.
    pub(crate) fraction: SolidFraction,
    /// Of every cell, x fastest; 0 where nobody takes it.
    pub(crate) lambda: Vec<f64>,
}

impl Solids {
    /// As the bodies are now.
    fn update(&mut self, view: &dyn View, taken: Taken) -> Result<(), CouplingError> {
        let lattice = view.lattice();
        self.lambda.clear();
        self.lambda.resize(lattice.shape().iter().product(), 0.0);
        match taken {
            Taken::None => return Ok(()),
            Taken::Layer(axis, number) => self.fraction.set_layer(Some((axis, number))),
            Taken::All => self.fraction.set_layer(None),
        }
        self.fraction.update(&lattice, view.bodies())?;
        self.fraction.add_to_dense(&lattice, &mut self.lambda);
        Ok(())
    }
}

/// All who look on, and the solid fraction they share.
pub(crate) struct Audience {
    pub(crate) watches: Vec<Box<dyn Watch>>,
    solids: Solids,
    /// Wall seconds spent on looking.
    pub(crate) seconds: f64,
}

impl Audience {
    pub(crate) fn new(watches: Vec<Box<dyn Watch>>) -> Self {
        Self { watches, solids: Solids::default(), seconds: 0.0 }
    }

    pub(crate) fn step(&mut self, view: &mut dyn View, info: &StepInfo) -> Result<(), CouplingError> {
        self.watches.iter_mut().try_for_each(|watch| watch.step(view, info))
    }

    pub(crate) fn snapshot(
        &mut self,
        view: &mut dyn View,
        index: usize,
        info: &StepInfo,
    ) -> Result<(), CouplingError> {
        let start = std::time::Instant::now();
        let Self { watches, solids, .. } = self;
        // One layer is enough unless two are asked for.
        let most = |a: Taken, b: Taken| match (a.min(b), a.max(b)) {
            (Taken::Layer(..), Taken::Layer(..)) if a != b => Taken::All,
            (_, more) => more,
        };
        let taken = watches.iter().map(|watch| watch.takes_lambda(index)).fold(Taken::None, most);
        solids.update(view, if view.bodies().n_bodies() > 0 { taken } else { Taken::None })?;
        let seen = watches.iter_mut().try_for_each(|watch| watch.snapshot(view, solids, index, info));
        self.seconds += start.elapsed().as_secs_f64();
        seen
    }

    /// Paths in the folder of all tables, after that of the run itself.
    pub(crate) fn tables(&self, first: &str) -> Vec<String> {
        let own = self.watches.iter().flat_map(|watch| watch.tables());
        std::iter::once(first.to_owned()).chain(own).collect()
    }

    pub(crate) fn flush(&mut self) -> Result<(), CouplingError> {
        self.watches.iter_mut().try_for_each(|watch| watch.flush())
    }

    pub(crate) fn finish(&mut self, view: &mut dyn View, stop: &AtomicBool) -> Result<(), CouplingError> {
        self.watches.iter_mut().try_for_each(|watch| watch.finish(view, stop))?;
        self.flush()
    }
}

impl Setup {
    /// Those who look on, with files in `folder` that go on from time `resume` \[s\] if it is
    /// given.
    pub(crate) fn audience(
        &self,
        folder: &Path,
        resume: Option<f64>,
        quiet: bool,
    ) -> Result<Audience, CouplingError> {
        let names: Vec<String> = self.bodies.list.iter().map(|b| b.name.clone()).collect();
        let bodies = !names.is_empty() || !self.bodies.inflows.is_empty();
        let moves = self.bodies.any_moves();
        let out = &self.output;
        let fields = out.fields.filter(|_| self.fluid.is_some());
        let frames = out.bodies && moves;
        let mut watches: Vec<Box<dyn Watch>> =
            vec![Box::new(FieldsWatch::new(folder, fields, frames, resume)?)];
        if out.bodies && moves {
            watches.push(Box::new(TrajectoriesWatch::new(folder, names.clone(), resume)?));
        }
        if let Some(images) = out.images.clone() {
            watches.push(Box::new(ImagesWatch::new(folder, self, images, resume)?));
        }
        if !self.probes.is_empty() {
            watches.push(Box::new(ProbesWatch::new(folder, &self.probes, self.dim(), resume)?));
        }
        if !self.lines.is_empty() {
            watches.push(Box::new(LinesWatch::new(folder, &self.lines, self.dim(), resume)?));
        }
        if let Some(forces) = self.forces.filter(|_| bodies) {
            if let Some(reference) = forces.surfaces {
                let watch = SurfacesWatch::new(folder, names.clone(), self.fluid(), reference, resume)?;
                watches.push(Box::new(watch));
            }
            watches.push(Box::new(ForcesWatch::new(folder, forces, names, self.fluid(), resume)?));
        }
        if let Some(averages) = self.averages {
            watches.push(Box::new(AveragesWatch::new(folder, averages, self.dim(), self.cells())));
        }
        if !self.models.is_empty() {
            watches.push(Box::new(ModelsWatch::new(folder, &self.models, out.images.clone(), quiet)?));
        }
        Ok(Audience::new(watches))
    }
}

impl Checkpoint for Audience {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        for watch in &self.watches {
            watch.save(&mut |name, values| sink(&format!("{}.{name}", watch.name()), values));
        }
    }
    fn restore<'a>(
        &mut self,
        source: &dyn Fn(&str) -> Option<&'a [f64]>,
    ) -> Result<(), interfaces::RestartError> {
        for watch in &mut self.watches {
            let prefix = watch.name();
            watch.restore(&|name| source(&format!("{prefix}.{name}")))?;
        }
        Ok(())
    }
}

/// An error of a file.
pub(crate) fn output(what: impl Into<String>, path: &Path) -> impl FnOnce(std::io::Error) -> CouplingError {
    let what = format!("{} {}", what.into(), path.display());
    move |source| {
        // What cannot be written in that format is no fault of the disk.
        let hint = match source.kind() {
            std::io::ErrorKind::InvalidInput => "",
            _ => " (is the disk full, or the folder not yours to write to?)",
        };
        CouplingError::Output { what: what + hint, source }
    }
}
