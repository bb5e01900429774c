//! What came out of a run.
use crate::look::Extremes;
use crate::record::versions;
use crate::setup::{Algorithm, Reference, Setup};
use crate::view::View;
use crate::watch::{Audience, output};
use coupling::{CouplingError, LedgerReport, Module};
use ibm::SolidFraction;
use interfaces::BodyId;
use render::cpu::Elapsed;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// It came to its end.
    Done,
    /// Its flow was steady before its time (`time.stop`).
    Steady,
    /// The event that ends it came before its time (`time.stop`).
    Event,
    /// It was stopped and can go on.
    Stopped,
    /// The iterations allowed were not enough for a steady flow.
    NotConverged,
}

impl Ending {
    /// Word of `result.json`.
    fn word(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Steady => "steady",
            Self::Event => "event",
            Self::Stopped => "stopped",
            Self::NotConverged => "not converged",
        }
    }
    /// Whether nothing is left to run.
    fn is_complete(self) -> bool {
        matches!(self, Self::Done | Self::Steady | Self::Event)
    }
}

/// Number of the results beside its reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Compared {
    /// Name of the quantity.
    pub name: String,
    /// Value of the results, if they have it.
    pub found: Option<f64>,
    /// Value of the reference.
    pub reference: f64,
    /// Source of the reference.
    pub source: String,
    /// Largest deviation allowed, as [`Self::error`].
    pub tolerance: Option<f64>,
}

impl Compared {
    /// found/reference − 1, or the difference where the reference is 0.
    pub fn error(&self) -> Option<f64> {
        self.found.map(|found| if self.reference == 0.0 { found } else { found / self.reference - 1.0 })
    }

    /// Whether the deviation is within the tolerance; none without either.
    pub fn is_met(&self) -> Option<bool> {
        Some(self.error()?.abs() <= self.tolerance?)
    }
}

/// What came out of a run.
#[derive(Clone, Debug)]
pub struct RunResult {
    /// How it ended.
    pub ending: Ending,
    /// The folder with its files.
    pub folder: PathBuf,
    /// What `result.json` holds: the same, bit for bit, whether or not the run was interrupted.
    pub result: Value,
    /// What `timings.json` holds.
    pub timings: Value,
    /// The page `report.html`, if it was made.
    pub report: Option<PathBuf>,
    /// Results beside the scene's references.
    pub compared: Vec<Compared>,
}

/// A number, or null for what is none.
pub(crate) fn number(x: f64) -> Value {
    if x.is_finite() { json!(x) } else { Value::Null }
}

/// Fields besides velocity and pressure: the mean over the box by volume, and, with bodies, over the fluid; the extremes of cells that bodies leave whole, as those that they cut hold values
/// beyond their surfaces.
fn fields(view: &dyn View) -> serde_json::Map<String, Value> {
    let others = view.others();
    if others.is_empty() {
        return serde_json::Map::new();
    }
    let lattice = view.lattice().dense();
    let mut solid = vec![0.0; lattice.shape().iter().product()];
    let bodies = view.bodies().n_bodies() > 0;
    let mut fraction = SolidFraction::new();
    // Extremes are unknown if λ cannot be computed.
    let known = !bodies || fraction.update(&lattice, view.bodies()).is_ok();
    fraction.add_to_dense(&lattice, &mut solid);
    let mut out = serde_json::Map::new();
    for other in others {
        let (mut whole, mut fluid) = ([0.0; 2], [0.0; 2]);
        let [mut least, mut most] = [f64::INFINITY, f64::NEG_INFINITY];
        for (cell, value) in other.values.enumerate() {
            let volume = lattice.volume(lattice.node(cell));
            for ([sum, weights], weight) in [(&mut whole, volume), (&mut fluid, volume * (1.0 - solid[cell]))]
            {
                *sum += weight * value;
                *weights += weight;
            }
            if known && solid[cell] == 0.0 {
                (least, most) = (least.min(value), most.max(value));
            }
        }
        let mut field = json!({ "mean": number(whole[0] / whole[1]), "least": number(least), "most": number(most), "unit": other.unit });
        if bodies {
            field["mean_in_fluid"] = if known { number(fluid[0] / fluid[1]) } else { Value::Null };
        }
        out.insert(other.name.to_owned(), field);
    }
    out
}

impl RunResult {
    pub(crate) fn new(
        setup: &Setup,
        view: &mut dyn View,
        extremes: &Extremes,
        ledger: Option<&LedgerReport>,
        audience: &Audience,
        ending: Ending,
        folder: &Path,
    ) -> Self {
        let flow = view.statistics();
        let dim = view.dim();
        let [shortest, longest, courant] = extremes.steps;
        let mut result = json!({
            "scene": setup.name,
            "title": setup.title,
            "complete": ending.is_complete(),
            "ending": ending.word(),
            "versions": versions(),
            "dimension": dim,
            "cells": (0..dim).map(|a| view.axis(a).cells()).collect::<Vec<_>>(),
        });
        if setup.flow.algorithm == Algorithm::Simple {
            result["iterations"] = view.steps().into();
        } else {
            result["time"] = number(view.time());
            result["end"] = number(setup.end);
            result["steps"] = view.steps().into();
            result["step"] = json!({ "shortest": number(shortest), "longest": number(longest), "courant": number(courant) });
        }
        if let Some(flow) = flow {
            let volume: f64 = (0..dim).map(|a| view.axis(a).length()).product();
            result["flow"] = json!({
                "kinetic_energy": number(flow.kinetic_energy),
                "dissipation": number(flow.dissipation),
                "divergence": number(flow.divergence),
                "mean_velocity": (0..dim).map(|a| flow.volume_flow[a] / volume).collect::<Vec<f64>>(),
            });
        } else {
            result["kinetic_energy"] = number(view.kinetic_energy());
        }
        if setup.flow_rate.is_some() {
            let force = view.body_force();
            result["body_force"] = (0..dim).map(|a| number(force[a])).collect();
        }
        let fields = fields(view);
        if !fields.is_empty() {
            result["fields"] = Value::Object(fields);
        }
        if let Some(y) = view.y_plus().filter(|y| y.rows > 0) {
            result["y_plus"] = json!({
                "least": number(y.least),
                "mean": number(y.mean),
                "most": number(y.most),
                "range": y.range,
                "below_range": number(y.below),
                "above_range": number(y.beyond),
                "between_laws": number(y.between),
                "laminar": number(y.laminar),
                "warnings": y.warnings(),
            });
        }
        let names: Vec<&str> = setup.bodies.list.iter().map(|b| b.name.as_str()).collect();
        let bodies: Vec<Value> = (0..view.bodies().n_bodies())
            .map(BodyId)
            .map(|b| {
                let (pose, twist, serial) = (view.bodies().pose(b), view.bodies().twist(b), view.serial(b));
                let q = pose.orientation;
                let triple = |v: interfaces::Vector| [v.x, v.y, v.z];
                json!({
                    "body": names.get(serial as usize).map_or_else(|| serial.to_string(), |name| (*name).to_owned()),
                    "position": triple(pose.position.coords),
                    "orientation": [q.w, q.i, q.j, q.k],
                    "velocity": triple(twist.linear),
                    "spin": triple(twist.angular),
                })
            })
            .collect();
        if !(setup.bodies.list.is_empty() && setup.bodies.inflows.is_empty()) {
            let [entered, left] = view.turnover();
            result["bodies"] = json!(bodies);
            result["contacts"] = json!(view.contacts());
            result["turnover"] = json!({ "entered": entered, "left": left });
            if let Some(deep) = extremes.deepest.result(setup) {
                result["deepest_overlap"] = deep;
            }
        }
        for watch in &audience.watches {
            if let Some(value) = watch.results() {
                result[watch.name()] = value;
            }
        }
        if let Some(l) = ledger {
            result["ledger"] = json!({
                "momentum_worst_step": number(l.momentum_step),
                "momentum_whole_run": number(l.momentum_total),
                "impulses": number(l.impulses),
                "energy": l.energy,
                "work": number(l.work),
                "side_work": number(l.side_work),
                "driving_work": number(l.driving_work),
                "inner_work": number(l.inner_work),
                "dissipation": number(l.dissipation),
                "eddy_dissipation": number(l.eddy_dissipation),
                "forcing_loss": number(l.forcing_loss),
                "contact_work": number(l.contact_work),
                "brought": number(l.brought),
                "energy_residual": number(l.energy_residual),
                "divergence": number(l.divergence),
            });
        }
        let compared = setup.compare(&result);
        if !compared.is_empty() {
            let row = |c: &Compared| {
                json!({
                    "name": c.name,
                    "found": c.found,
                    "reference": c.reference,
                    "error": c.error(),
                    "tolerance": c.tolerance,
                    "source": c.source,
                })
            };
            result["references"] = compared.iter().map(row).collect();
        }
        Self { ending, folder: folder.into(), result, timings: Value::Null, report: None, compared }
    }

    pub(crate) fn set(&mut self, key: &str, value: Value) {
        self.result[key] = value;
    }

    pub(crate) fn with_timings(
        mut self,
        elapsed: Elapsed,
        threads: usize,
        [output, ledger]: [f64; 2],
        view: &dyn View,
    ) -> Self {
        let modules: serde_json::Map<String, Value> =
            Module::ALL.iter().map(|m| (m.name().into(), json!(view.timings().seconds(*m)))).collect();
        self.timings = json!({
            "wall": elapsed.wall,
            "cpu": elapsed.cpu,
            "threads": threads,
            "output": output,
            "ledger": ledger,
            "modules": modules,
        });
        self
    }

    /// Writes `result.json` and `timings.json`.
    pub(crate) fn write(self) -> Result<Self, CouplingError> {
        for (name, value) in [("result.json", &self.result), ("timings.json", &self.timings)] {
            let path = self.folder.join(name);
            let text = format!("{value:#}\n");
            // Beside it first: what is there is whole.
            let beside = self.folder.join(format!("{name}.part"));
            std::fs::write(&beside, text)
                .and_then(|()| std::fs::rename(&beside, &path))
                .map_err(output("writing", &path))?;
        }
        Ok(self)
    }
}

impl Setup {
    /// Numbers of `result` beside the references of the scene.
    pub(crate) fn compare(&self, result: &Value) -> Vec<Compared> {
        let compared = |r: &Reference| Compared {
            name: r.name.clone(),
            found: result.pointer(&r.pointer).and_then(Value::as_f64),
            reference: r.value,
            source: r.source.clone(),
            tolerance: r.tolerance,
        };
        self.references.iter().map(compared).collect()
    }
}
