//! Scenes as their users have them: every file in `scenes/`, spoilt files, interrupted runs, folders that cannot be written to.
mod contacts;
mod driven;
mod dry;
mod exits;
mod expressions;
mod files;
mod first_steps;
mod heat;
mod ledger;
mod many;
mod measured;
mod mesh_files;
mod messages;
mod models;
mod mutation;
mod numbers;
mod physics;
mod placement;
mod plan;
mod prescribed;
mod resume;
mod spoilt;
mod steady;
mod surfaces;
mod told;

use scene::{Options, RunResult, Scene, json_schema, manual};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Every scene file: path and text.
fn scenes() -> Vec<(PathBuf, String)> {
    let mut found: Vec<_> = std::fs::read_dir(root().join("scenes"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .map(|path| (path.clone(), std::fs::read_to_string(path).unwrap()))
        .collect();
    found.sort();
    found
}

/// The same scene with about a quarter of the cells along each axis: spoilt files are many.
fn coarse(text: &str) -> String {
    let shrink = |word: &str| match (word.trim().parse::<usize>(), word.trim().parse::<f64>()) {
        (Ok(cells), _) => (cells / 4).max(4).to_string(),
        (_, Ok(width)) => (4.0 * width).to_string(),
        _ => word.to_owned(),
    };
    let mut out = String::new();
    let mut rest = text;
    while let Some(at) =
        ["cells = ", "fine = "].iter().filter_map(|key| rest.find(key).map(|i| i + key.len())).min()
    {
        let end = rest[at..].find([']', '}', '\n']).map_or(rest.len(), |i| at + i);
        // Of a single number, only that.
        let end =
            if rest[at..].starts_with('[') { end } else { rest[at..end].find(',').map_or(end, |i| at + i) };
        out += &rest[..at];
        let list = rest[at..end].strip_prefix('[');
        let numbers: Vec<String> = list.unwrap_or(&rest[at..end]).split(',').map(shrink).collect();
        out += &format!("{}{}", if list.is_some() { "[" } else { "" }, numbers.join(", "));
        rest = &rest[end..];
    }
    out + rest
}

/// A folder that no other test has, whatever its name: tests run beside one another and remove theirs.
fn folder(name: &str) -> PathBuf {
    static MADE: AtomicUsize = AtomicUsize::new(0);
    let number = MADE.fetch_add(1, Ordering::Relaxed);
    let folder = std::env::temp_dir().join(format!("siltflow-scene-{name}-{}-{number}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    folder
}

#[test]
fn folders_of_one_name_are_two() {
    assert_ne!(folder("same"), folder("same"));
}

fn quiet(out: &Path) -> Options {
    Options { quiet: true, out: Some(out.into()), ..Options::default() }
}

/// Runs the scene in `text` with `more` set.
fn run(text: &str, more: &[&str], options: &Options) -> RunResult {
    let more: Vec<String> = more.iter().map(|s| (*s).into()).collect();
    let scene = Scene::parse("scene.toml", text, &more).unwrap();
    scene.run(options, &AtomicBool::new(false)).unwrap()
}

/// The plan of the scene in `text` with `more` set.
fn plan(text: &str, more: &[&str]) -> scene::Plan {
    let more: Vec<String> = more.iter().map(|s| (*s).into()).collect();
    Scene::parse("scene.toml", text, &more).unwrap().plan().unwrap()
}

/// What is told of that scene with `more` set; nothing if it is right.
fn problems(text: &str, more: &str) -> String {
    Scene::parse("scene.toml", text, &[more.into()]).err().map(|e| e.to_string()).unwrap_or_default()
}

#[test]
fn the_manual_and_the_schema_are_those_of_the_code() {
    let told = "run `cargo run --release -- manual > docs/scene.md` and `cargo run --release -- schema > scenes/schema.json`";
    assert!(std::fs::read_to_string(root().join("docs/scene.md")).unwrap_or_default() == manual(), "{told}");
    assert!(
        std::fs::read_to_string(root().join("scenes/schema.json")).unwrap_or_default() == json_schema(),
        "{told}"
    );
}

#[test]
fn every_scene_is_checked_in_seconds() {
    let all = scenes();
    assert!(all.len() >= 3);
    for (path, _) in all {
        let start = Instant::now();
        let scene = Scene::load(&path, &[]).unwrap_or_else(|e| panic!("{e}"));
        let plan = scene.plan().unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        // 3.5 s alone, the first pressure solution of `sphere_les`; other tests run at the same
        // time.
        assert!(start.elapsed() < Duration::from_secs(40), "{}: {:?}", path.display(), start.elapsed());
        assert!(plan.steps > 0.0 && plan.cpu.is_some_and(|cpu| cpu > 0.0), "{plan}");
    }
}

/// Every scene has its line, its picture and its time in the folder's README.
#[test]
fn every_scene_is_shown() {
    let text = std::fs::read_to_string(root().join("scenes/README.md")).unwrap();
    for (path, _) in scenes() {
        let name = path.file_stem().unwrap().to_str().unwrap();
        let line = text.lines().find(|line| line.contains(&format!("[{name}]({name}.toml)")));
        let seconds = line.and_then(|line| line.rsplit('|').nth(1)?.trim().parse::<f64>().ok());
        assert!(seconds.is_some(), "{name}: {line:?}");
        assert!(root().join(format!("docs/images/scenes/{name}.png")).exists(), "{name}");
    }
}
