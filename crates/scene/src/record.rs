//! Record of a run before its first step: `plan.json` and `scene.toml`.
use crate::document::{Document, Value as Item};
use crate::plan::Plan;
use crate::setup::{Algorithm, Setup};
use crate::watch::output;
use coupling::CouplingError;
use fv_mesh::Axis;
use serde_json::{Value, json};
use std::path::Path;

/// Keys that runs of a grid study may differ in.
const GRID_STUDY: [&str; 8] =
    ["grid", "title", "about", "output", "checkpoint", "references", "time.dt", "time.steps"];

/// A scene's text and plan.
#[derive(Clone, Copy)]
pub(crate) struct Record<'a> {
    pub(crate) document: &'a Document,
    pub(crate) plan: &'a Plan,
}

/// Versions of the program and of its compiler, and what it was compiled for.
pub(crate) fn versions() -> Value {
    json!({
        "siltflow": env!("CARGO_PKG_VERSION"),
        "rustc": env!("SCENE_RUSTC"),
        "target": env!("SCENE_TARGET"),
    })
}

impl Record<'_> {
    /// Writes both files to `folder`; `tables` are the paths in it of those that the run writes.
    pub(crate) fn write(
        &self,
        setup: &Setup,
        folder: &Path,
        tables: Vec<String>,
    ) -> Result<(), CouplingError> {
        let about = match self.document.root.get("about").map(|item| &item.value) {
            Some(Item::Text(text)) => text.as_str(),
            _ => "",
        };
        let reference = |r: &crate::setup::Reference| {
            json!({
                "name": r.name,
                "pointer": r.pointer,
                "value": r.value,
                "source": r.source,
                "tolerance": r.tolerance,
            })
        };
        let mut record = self.plan.to_json();
        let more = json!({
            "title": setup.title,
            "about": about,
            "file": self.document.name,
            "overrides": self.document.overrides(),
            "size": setup.axes.iter().map(Axis::length).collect::<Vec<f64>>(),
            "steady": setup.flow.algorithm == Algorithm::Simple,
            "end": setup.end,
            "tolerance": setup.flow.tolerance,
            "references": setup.references.iter().map(reference).collect::<Vec<Value>>(),
            "tables": tables,
            "images": setup.output.images.is_some(),
            // The same for runs that differ in their grids alone.
            "case": format!("{:016x}", self.document.fingerprint(&GRID_STUDY)),
            "versions": versions(),
        });
        if let (Value::Object(record), Value::Object(more)) = (&mut record, more) {
            record.extend(more);
        }
        for (name, text) in
            [("plan.json", format!("{record:#}\n")), ("scene.toml", self.document.source().to_owned())]
        {
            let path = folder.join(name);
            std::fs::write(&path, text).map_err(output("writing", &path))?;
        }
        Ok(())
    }
}
