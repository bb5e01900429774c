//! `siltflow table`.
use crate::outcome::{Failure, print};
use crate::run::stop_on_interrupt;
use crate::shipped::{Shipped, names};
use clap::Args;
use scene::{Compared, Ending, Options, Scene};
use serde_json::{Value, json};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

#[derive(Args)]
pub(crate) struct TableArgs {
    /// Scene files, or names of scenes that come with the command; without any, those of the
    /// latter that have references.
    scenes: Vec<String>,
    /// Runs the scenes first; their results of earlier runs are replaced.
    #[arg(long)]
    run: bool,
    /// Folder in which each scene has a folder with its results.
    #[arg(long, default_value = "out")]
    out: PathBuf,
    /// Prints JSON: a list with an object for each reference.
    #[arg(long)]
    json: bool,
}

/// References of a scene beside its results.
struct Case {
    scene: String,
    title: String,
    /// CPU time of the run \[s\].
    cpu: Option<f64>,
    compared: Vec<Compared>,
}

impl TableArgs {
    /// Prints the table; returns the exit code: 1 if a deviation exceeds its tolerance.
    pub(crate) fn table(&self) -> Result<u8, Failure> {
        let shipped = Shipped::default();
        let all: Vec<String> = names().map(String::from).collect();
        let scenes = if self.scenes.is_empty() { &all } else { &self.scenes };
        let stop = if self.run { Some(stop_on_interrupt()?) } else { None };
        let case = |scene: &String| self.case(&shipped, scene, stop.as_deref());
        let cases = scenes.iter().map(case).collect::<Result<Vec<_>, _>>()?;
        let rows = || cases.iter().flat_map(|case| case.compared.iter().map(move |c| (case, c)));
        if self.json {
            let rows: Vec<Value> = rows().map(|(case, c)| object(case, c)).collect();
            print(&format!("{:#}\n", Value::from(rows)))?;
        } else {
            let rows: String = rows().map(|(case, c)| row(case, c)).collect();
            print(&format!("{HEAD}{rows}"))?;
        }
        Ok(u8::from(rows().any(|(_, c)| c.is_met() == Some(false))))
    }

    /// References of a scene beside its results, which are made first if there is a `stop` flag.
    fn case(&self, shipped: &Shipped, name: &str, stop: Option<&AtomicBool>) -> Result<Case, Failure> {
        let path = shipped.path(name)?;
        let scene = Scene::load(&path, &[]).map_err(Failure::of_input)?;
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let folder = self.out.join(&stem);
        if let Some(stop) = stop.filter(|_| !scene.compare(&Value::Null).is_empty()) {
            let options = Options { overwrite: true, out: Some(folder.clone()), ..Options::default() };
            let result = scene.run(&options, stop).map_err(Failure::of_run)?;
            if result.ending == Ending::Stopped {
                return Err(Failure::of_stop(format!(
                    "{stem} was stopped; `siltflow resume {name}` goes on"
                )));
            }
        }
        let read = |file: &str| -> Value {
            let text = std::fs::read_to_string(folder.join(file)).unwrap_or_default();
            serde_json::from_str(&text).unwrap_or(Value::Null)
        };
        Ok(Case {
            scene: stem,
            title: scene.title().into(),
            cpu: read("timings.json")["cpu"].as_f64(),
            compared: scene.compare(&read("result.json")),
        })
    }
}

const HEAD: &str = "\
| scene | quantity | result | reference | deviation | tolerance | source | CPU s |
|---|---|---|---|---|---|---|---|
";

fn object(case: &Case, c: &Compared) -> Value {
    json!({
        "scene": case.scene,
        "title": case.title,
        "quantity": c.name,
        "result": c.found,
        "reference": c.reference,
        "deviation": c.error(),
        "tolerance": c.tolerance,
        "met": c.is_met(),
        "source": c.source,
        "cpu": case.cpu,
    })
}

fn row(case: &Case, c: &Compared) -> String {
    // Deviations from 0 are no shares.
    let share = |x: f64| match c.reference == 0.0 {
        true => format!("{x:.2e}"),
        false => format!("{:.3} %", 100.0 * x),
    };
    let or_dash = |text: Option<String>| text.unwrap_or_else(|| "–".into());
    let missed = if c.is_met() == Some(false) { " **missed**" } else { "" };
    let cells = [
        case.scene.clone(),
        c.name.clone(),
        c.found.map_or_else(|| "not run".into(), |x| format!("{x:.6}")),
        c.reference.to_string(),
        or_dash(c.error().map(share)) + missed,
        or_dash(c.tolerance.map(share)),
        c.source.clone(),
        or_dash(case.cpu.map(|x| format!("{x:.1}"))),
    ];
    format!("| {} |\n", cells.map(|cell| cell.replace('|', "\\|")).join(" | "))
}
