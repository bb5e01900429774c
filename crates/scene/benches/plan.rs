//! Estimates of a check against what runs take: steps, CPU time and memory. Every check and every
//! run has a process of its own.
//!
//! ```text
//! cargo bench -p siltflow-scene --bench plan                           # every file in scenes/
//! cargo bench -p siltflow-scene --bench plan -- cavity hopper          # some of them
//! ```
use render::cpu::{Stopwatch, peak_memory};
use scene::{Options, Scene};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::AtomicBool;

/// Variable that names the task of a child process, `plan` or `run`, and its scene file.
const CHILD: &str = "CHILD";

/// Steps, CPU time \[s\] and memory \[MB\].
type Figures = [Option<f64>; 3];

fn main() -> Result<(), Box<dyn Error>> {
    if let Ok(child) = std::env::var(CHILD) {
        let (task, path) = child.split_once(' ').ok_or("no scene")?;
        let figures = if task == "plan" { plan(Path::new(path))? } else { run(Path::new(path))? };
        println!("{}", figures.map(|figure| figure.unwrap_or(f64::NAN).to_string()).join(" "));
        return Ok(());
    }
    println!("| scene | steps, told / made | CPU s, told / used | MB, told / used |\n|---|---|---|---|");
    for path in scenes()? {
        let [told, used] = [child("plan", &path)?, child("run", &path)?];
        let ratio = |k: usize, digits: usize| {
            format!("{:.digits$} / {:.digits$} = {:.2}", told[k], used[k], told[k] / used[k])
        };
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        println!("| {name} | {} | {} | {} |", ratio(0, 0), ratio(1, 1), ratio(2, 0));
    }
    Ok(())
}

/// Figures that a process of its own finds.
fn child(task: &str, path: &Path) -> Result<Vec<f64>, Box<dyn Error>> {
    let task = format!("{task} {}", path.display());
    let output = Command::new(std::env::current_exe()?).env(CHILD, &task).output()?;
    if !output.status.success() {
        return Err(format!("{task}: {}", String::from_utf8_lossy(&output.stderr)).into());
    }
    let text = String::from_utf8(output.stdout)?;
    Ok(text.split_whitespace().map(str::parse).collect::<Result<_, _>>()?)
}

/// The scenes that are named on the command line, or all.
fn scenes() -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let names: Vec<String> = std::env::args().skip(1).filter(|name| !name.starts_with("--")).collect();
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if path.extension().is_some_and(|e| e == "toml") && (names.is_empty() || names.contains(&stem)) {
            all.push(path);
        }
    }
    all.sort();
    Ok(all)
}

fn plan(path: &Path) -> Result<Figures, Box<dyn Error>> {
    let plan = Scene::load(path, &[])?.plan()?;
    Ok([Some(plan.steps), plan.cpu, plan.memory.map(|bytes| bytes / 1e6)])
}

fn run(path: &Path) -> Result<Figures, Box<dyn Error>> {
    let out = std::env::temp_dir().join(format!("siltflow-plan-{}", std::process::id()));
    let options = Options { quiet: true, out: Some(out.clone()), ..Options::default() };
    let watch = Stopwatch::start();
    let result = Scene::load(path, &[])?.run(&options, &AtomicBool::new(false));
    let cpu = watch.elapsed().cpu;
    let _ = std::fs::remove_dir_all(&out);
    let result = result?.result;
    let made = ["/iterations", "/steps"].iter().find_map(|key| result.pointer(key)?.as_f64());
    Ok([made, Some(cpu), peak_memory().map(|bytes| bytes as f64 / 1e6)])
}
