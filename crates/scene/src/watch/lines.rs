//! The flow along straight lines.
use super::table::Table;
use super::{Solids, Watch, output};
use crate::setup::LineSetup;
use crate::view::View;
use coupling::{CouplingError, StepInfo};
use interfaces::{Checkpoint, RestartError};
use std::io;
use std::path::Path;

/// Writes velocity and pressure along lines to `lines/NAME.csv` at snapshots.
pub(crate) struct LinesWatch {
    lines: Vec<(LineSetup, Table)>,
}

impl LinesWatch {
    pub(crate) fn new(
        folder: &Path,
        setups: &[LineSetup],
        dim: usize,
        resume: Option<f64>,
    ) -> Result<Self, CouplingError> {
        let folder = folder.join("lines");
        std::fs::create_dir_all(&folder).map_err(output("making", &folder))?;
        let columns = if dim == 2 { "x,y,u,v,p" } else { "x,y,z,u,v,w,p" };
        // Nothing but the start is written before the first step, and it is written again.
        let resume = resume.filter(|time| *time > 0.0);
        let open = |setup: &LineSetup| {
            let header = format!(
                "# {}: time s; distance from the first point s m; x,y,z m; u,v,w m/s; p Pa\ntime,s,{columns}",
                setup.name
            );
            Ok((setup.clone(), Table::open(&folder.join(format!("{}.csv", setup.name)), &header, resume)?))
        };
        Ok(Self { lines: setups.iter().map(open).collect::<Result<_, CouplingError>>()? })
    }
}

impl Checkpoint for LinesWatch {
    fn save(&self, _: &mut dyn FnMut(&str, &[f64])) {}
    fn restore<'a>(&mut self, _: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        Ok(())
    }
}

impl Watch for LinesWatch {
    fn name(&self) -> &'static str {
        "lines"
    }
    fn tables(&self) -> Vec<String> {
        self.lines.iter().map(|(setup, _)| format!("lines/{}.csv", setup.name)).collect()
    }
    fn snapshot(
        &mut self,
        view: &mut dyn View,
        _: &Solids,
        _: usize,
        info: &StepInfo,
    ) -> Result<(), CouplingError> {
        let dim = view.dim();
        for (LineSetup { name, points }, table) in &mut self.lines {
            let mut values = vec![[0.0; 4]; points.len()];
            let mut take = |i: usize, [u, v, w]: [f64; 3], p: f64| values[i] = [u, v, w, p];
            view.sample(points, &mut take).map_err(|e| CouplingError::Output {
                what: format!("the line {name}"),
                source: io::Error::other(e),
            })?;
            for (x, value) in points.iter().zip(&values) {
                let s = x.iter().zip(&points[0]).map(|(x, from)| (x - from).powi(2)).sum::<f64>().sqrt();
                let row = std::iter::once(&s).chain(&x[..dim]).chain(&value[..dim]).chain(&value[3..]);
                table.row(info.time, None, row.copied())?;
            }
        }
        Ok(())
    }
    fn flush(&mut self) -> Result<(), CouplingError> {
        self.lines.iter_mut().try_for_each(|(_, table)| table.flush())
    }
}
