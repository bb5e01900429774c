//! The flow at points.
use super::table::{Pace, Table};
use super::{Watch, output};
use crate::setup::ProbeSetup;
use crate::view::View;
use coupling::{CouplingError, StepInfo};
use interfaces::{Checkpoint, RestartError};
use serde_json::{Value, json};
use std::io;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Writes velocity and pressure at points to `probes/NAME.csv`.
pub(crate) struct ProbesWatch {
    probes: Vec<(ProbeSetup, Table, Pace)>,
    /// Of every point, the last values: u, v, w, p.
    last: Vec<f64>,
}

impl ProbesWatch {
    pub(crate) fn new(
        folder: &Path,
        setups: &[ProbeSetup],
        dim: usize,
        resume: Option<f64>,
    ) -> Result<Self, CouplingError> {
        let folder = folder.join("probes");
        std::fs::create_dir_all(&folder).map_err(output("making", &folder))?;
        let mut probes = Vec::new();
        for setup in setups {
            let mut header = format!("# {}: time s; u,v,w m/s; p Pa", setup.name);
            for (i, x) in setup.points.iter().enumerate() {
                header.push_str(&format!("; point {i} at {:?} m", &x[..dim]));
            }
            header.push_str("\ntime");
            let columns = if dim == 2 { &["u", "v", "p"][..] } else { &["u", "v", "w", "p"] };
            for i in 0..setup.points.len() {
                columns.iter().for_each(|c| header.push_str(&format!(",{c}{i}")));
            }
            let table = Table::open(&folder.join(format!("{}.csv", setup.name)), &header, resume)?;
            probes.push((setup.clone(), table, Pace::new(setup.every)));
        }
        let points: usize = setups.iter().map(|s| s.points.len()).sum();
        Ok(Self { probes, last: vec![0.0; 4 * points] })
    }
}

/// u, v, w, p of every point now.
fn sample(view: &dyn View, setup: &ProbeSetup, out: &mut [f64]) -> Result<(), CouplingError> {
    let mut take = |i: usize, u: [f64; 3], p: f64| {
        out[4 * i..4 * i + 4].copy_from_slice(&[u[0], u[1], u[2], p]);
    };
    view.sample(&setup.points, &mut take).map_err(|e| CouplingError::Output {
        what: format!("the probes {}", setup.name),
        source: io::Error::other(e),
    })
}

impl Checkpoint for ProbesWatch {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        sink("last", &self.last);
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.last = RestartError::take(source, "last", self.last.len())?.to_vec();
        Ok(())
    }
}

impl Watch for ProbesWatch {
    fn name(&self) -> &'static str {
        "probes"
    }
    fn tables(&self) -> Vec<String> {
        self.probes.iter().map(|(setup, ..)| format!("probes/{}.csv", setup.name)).collect()
    }
    fn step(&mut self, view: &mut dyn View, info: &StepInfo) -> Result<(), CouplingError> {
        let dim = view.dim();
        let mut offset = 0;
        for (setup, table, pace) in &mut self.probes {
            let last = &mut self.last[offset..offset + 4 * setup.points.len()];
            offset += last.len();
            if !pace.due(info.time, info.dt) {
                continue;
            }
            sample(view, setup, last)?;
            let values = last.chunks_exact(4).flat_map(|v| v[..dim].iter().chain(&v[3..]).copied());
            table.row(info.time, None, values)?;
        }
        Ok(())
    }
    /// The results are of the end, whenever the last row was written.
    fn finish(&mut self, view: &mut dyn View, _: &AtomicBool) -> Result<(), CouplingError> {
        let mut offset = 0;
        for (setup, ..) in &self.probes {
            let last = &mut self.last[offset..offset + 4 * setup.points.len()];
            offset += last.len();
            sample(view, setup, last)?;
        }
        Ok(())
    }
    fn flush(&mut self) -> Result<(), CouplingError> {
        self.probes.iter_mut().try_for_each(|(_, table, _)| table.flush())
    }
    fn results(&self) -> Option<Value> {
        let mut last = self.last.chunks_exact(4);
        let probes: Vec<Value> = self
            .probes
            .iter()
            .map(|(setup, ..)| {
                let points: Vec<Value> = setup
                    .points
                    .iter()
                    .zip(last.by_ref())
                    .map(|(x, v)| json!({ "at": x, "velocity": &v[..3], "pressure": v[3] }))
                    .collect();
                json!({ "name": setup.name, "points": points })
            })
            .collect();
        Some(json!(probes))
    }
}
