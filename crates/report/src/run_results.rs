//! Results of a run as numbers with names, pointers into `result.json` and units.
use crate::run_folder::RunFolder;
use serde_json::Value;

/// Bodies whose results are listed.
const MOST_BODIES: usize = 4;

/// A result.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RunValue {
    pub(crate) name: String,
    /// JSON pointer into `result.json`.
    pub(crate) pointer: String,
    pub(crate) unit: &'static str,
    /// The number; none if the results do not have it.
    pub(crate) value: Option<f64>,
    /// Published value and its source.
    pub(crate) reference: Option<(f64, String)>,
}

impl RunValue {
    /// value/reference − 1, or the difference where the reference is 0.
    pub(crate) fn error(&self) -> Option<f64> {
        let (value, reference) = (self.value?, self.reference.as_ref()?.0);
        Some(if reference == 0.0 { value } else { value / reference - 1.0 })
    }
}

/// Those with references first, then those that most runs have.
pub(crate) fn values(run: &RunFolder) -> Vec<RunValue> {
    let mut out = referenced(run);
    let r = &run.result;
    let plane = run.dim() == 2;
    let mut add = |name: String, pointer: String, unit: &'static str| {
        let value = r.pointer(&pointer).and_then(Value::as_f64);
        if value.is_some() && out.iter().all(|known| known.pointer != pointer) {
            out.push(RunValue { name, pointer, unit, value, reference: None });
        }
    };
    let bodies = |key: &str| {
        let list = r[key].as_array().map(Vec::as_slice).unwrap_or_default();
        let name = |b: &Value| b["body"].as_str().unwrap_or_default().to_owned();
        list.iter().take(MOST_BODIES).map(name).enumerate().collect::<Vec<_>>()
    };
    let stat = if run.is_steady() { "last" } else { "mean" };
    for (i, body) in bodies("forces") {
        for (a, axis) in ["x", "y", "z"].into_iter().enumerate().take(run.dim()) {
            let mean = if run.is_steady() { "" } else { "mean " };
            if r["forces"][i].get("coefficients").is_some() {
                add(
                    format!("{body}: {mean}force coefficient C{axis}"),
                    format!("/forces/{i}/coefficients/{stat}/{a}"),
                    "",
                );
            } else {
                let unit = if plane { "N/m" } else { "N" };
                add(format!("{body}: {mean}force F{axis}"), format!("/forces/{i}/load/{stat}/{a}"), unit);
            }
        }
        add(format!("{body}: Strouhal number"), format!("/forces/{i}/strouhal"), "");
    }
    for (i, body) in bodies("trajectories") {
        add(format!("{body}: largest speed"), format!("/trajectories/{i}/largest_speed"), "m/s");
    }
    let joule = if plane { "J/m" } else { "J" };
    add("kinetic energy at the end".into(), "/flow/kinetic_energy".into(), joule);
    add("kinetic energy at the end".into(), "/kinetic_energy".into(), joule);
    add("dissipation at the end".into(), "/flow/dissipation".into(), if plane { "W/m" } else { "W" });
    out
}

fn referenced(run: &RunFolder) -> Vec<RunValue> {
    let planned = run.plan["references"].as_array();
    let found = run.result["references"].as_array();
    // Results of versions without pointers have the numbers only.
    let list = planned.or(found).into_iter().flatten().enumerate();
    list.filter_map(|(i, r)| {
        let text = |key: &str| r[key].as_str().unwrap_or_default().to_owned();
        let value = found.and_then(|list| list.get(i)?["found"].as_f64());
        let reference = r["value"].as_f64().or(r["reference"].as_f64())?;
        Some(RunValue {
            name: text("name"),
            pointer: text("pointer"),
            unit: "",
            value,
            reference: Some((reference, text("source"))),
        })
    })
    .collect()
}
