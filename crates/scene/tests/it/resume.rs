//! States from which runs go on: the scenes that they belong to, and the flags that give them up.
use crate::{folder, quiet, root, run};
use scene::{Ending, Options, RunError, RunResult, Scene};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

fn small(set: &[&str]) -> Scene {
    let common = ["grid.cells=[8, 8]", "time.end=1", "output.images=false", "output.snapshots=2"];
    let set: Vec<String> = common.iter().chain(set).map(|s| (*s).into()).collect();
    Scene::load(&root().join("scenes/cavity.toml"), &set).unwrap()
}

fn go(scene: &Scene, options: &Options, stopped: bool) -> Result<RunResult, RunError> {
    scene.run(options, &AtomicBool::new(stopped))
}

/// A cube of this edge \[mm\] as STL.
fn cube(path: &Path, edge: f64) {
    let corner = |i: usize| [0, 1, 2].map(|a| if i >> a & 1 == 1 { edge } else { 0.0 });
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut text = String::from("solid cube\n");
    for [a, b, c, d] in quads {
        for triangle in [[a, b, c], [a, c, d]] {
            text += "facet normal 0 0 0\nouter loop\n";
            for [x, y, z] in triangle.map(corner) {
                text += &format!("vertex {x} {y} {z}\n");
            }
            text += "endloop\nendfacet\n";
        }
    }
    fs::write(path, text + "endsolid cube\n").unwrap();
}

/// A scene in `folder` with a mesh, a table of bodies and an axis from files.
fn with_files(folder: &Path) -> PathBuf {
    fs::create_dir_all(folder).unwrap();
    cube(&folder.join("cube.stl"), 1.0);
    fs::write(folder.join("balls.csv"), "x,y,z\n2e-3,2e-3,2e-3\n").unwrap();
    fs::write(folder.join("x.txt"), "0.0\n5e-3\n1e-2\n").unwrap();
    let text = r#"
gravity = [0.0, 0.0, -9.81]
sides = { x = "wall", y = "wall", z = "wall" }
time = { end = 1e-3 }
output = { snapshots = 1, images = false, fields = false }
[grid]
x = { spacing = "file", file = "x.txt" }
y = { spacing = "uniform", cells = 8, from = 0.0, to = 1e-2 }
z = { spacing = "uniform", cells = 8, from = 0.0, to = 1e-2 }
[[bodies]]
name = "cube"
shape = { type = "mesh", file = "cube.stl", unit = 1e-3 }
position = [5e-3, 5e-3, 5e-3]
[[factories]]
type = "table"
file = "balls.csv"
shape = { type = "sphere", radius = 1e-3 }
density = 2500.0
"#;
    let path = folder.join("scene.toml");
    fs::write(&path, text).unwrap();
    path
}

/// Contents of the files that a scene names are part of what a state belongs to.
#[test]
fn changed_files_are_refused() {
    let base = folder("changed-files");
    let path = with_files(&base);
    let out = base.join("out");
    let load =
        |set: &[&str]| Scene::load(&path, &set.iter().map(|s| (*s).into()).collect::<Vec<_>>()).unwrap();
    assert_eq!(go(&load(&[]), &quiet(&out), false).unwrap().ending, Ending::Done);
    let resume = Options { resume: true, ..quiet(&out) };
    let longer = ["time.end=2e-3"];
    type Change<'a> = &'a dyn Fn(&Path);
    let changes: [(&str, &str, Change<'_>); 3] = [
        ("cube.stl", "bodies.0.shape.file", &|path| cube(path, 1.2)),
        ("balls.csv", "factories.0.file", &|path| fs::write(path, "x,y,z\n2e-3,2e-3,2.5e-3\n").unwrap()),
        ("x.txt", "grid.x.file", &|path| fs::write(path, "0.0\n6e-3\n1e-2\n").unwrap()),
    ];
    for (name, key, change) in changes {
        let file = base.join(name);
        let kept = fs::read(&file).unwrap();
        change(&file);
        let error = go(&load(&longer), &resume, false).err().unwrap();
        assert!(matches!(&error, RunError::ChangedFile { file: f, key: k, .. } if *f == file && k == key));
        let told = error.to_string();
        assert!(told.contains(name) && told.contains(key) && told.contains("--overwrite"), "{told}");
        fs::write(&file, kept).unwrap();
    }
    // The run goes on with the files as they were; one that is written anew with the same contents
    // is the same.
    assert_eq!(go(&load(&longer), &resume, false).unwrap().result["time"], 2e-3);
    fs::remove_dir_all(&base).unwrap();
}

/// Two runs do not share a folder; it is free as soon as the first has ended.
#[test]
fn a_folder_has_one_run() {
    let out = folder("shared");
    let stop = AtomicBool::new(false);
    let long = small(&["grid.cells=[32, 32]", "time.end=1e9", "output.snapshots=0"]);
    std::thread::scope(|scope| {
        let first = scope.spawn(|| long.run(&quiet(&out), &stop));
        while fs::read_to_string(out.join("run.lock")).is_ok_and(|text| text.is_empty())
            || !out.join("run.log").exists()
        {
            std::thread::sleep(Duration::from_millis(5));
        }
        for options in
            [quiet(&out), Options { resume: true, ..quiet(&out) }, Options { overwrite: true, ..quiet(&out) }]
        {
            let error = go(&small(&[]), &options, false).err().unwrap();
            assert!(matches!(&error, RunError::InUse { folder, .. } if *folder == out), "{error}");
            let told = error.to_string();
            assert!(told.contains(&std::process::id().to_string()) && told.contains("--out"), "{told}");
        }
        stop.store(true, Ordering::Relaxed);
        assert_eq!(first.join().unwrap().unwrap().ending, Ending::Stopped);
    });
    let free = Options { overwrite: true, ..quiet(&out) };
    assert_eq!(go(&small(&[]), &free, false).unwrap().ending, Ending::Done);
    fs::remove_dir_all(&out).unwrap();
}

/// A lock file that a killed run left is no lock.
#[test]
fn the_lock_of_a_dead_process_is_free() {
    let out = folder("stale");
    fs::create_dir_all(&out).unwrap();
    fs::write(out.join("run.lock"), "1\n").unwrap();
    assert_eq!(go(&small(&[]), &quiet(&out), false).unwrap().ending, Ending::Done);
    fs::remove_dir_all(&out).unwrap();
}

/// The state of a run that is not at its end is lost with `overwrite` only; that of a finished run
/// at once.
#[test]
fn unfinished_states_are_kept() {
    let out = folder("unfinished");
    let state = out.join("state.bin");
    let refused = || {
        let before = fs::read(&state).unwrap();
        let error = go(&small(&[]), &quiet(&out), false).err().unwrap();
        assert!(matches!(&error, RunError::Unfinished(folder) if *folder == out), "{error}");
        let told = error.to_string();
        assert!(["siltflow resume", "--overwrite", "--out"].iter().all(|flag| told.contains(flag)), "{told}");
        assert!(fs::read(&state).unwrap() == before);
    };
    assert_eq!(go(&small(&[]), &quiet(&out), true).unwrap().ending, Ending::Stopped);
    refused();
    let resume = Options { resume: true, ..quiet(&out) };
    assert_eq!(go(&small(&[]), &resume, false).unwrap().ending, Ending::Done);
    // The run is done and the folder free.
    let all = go(&small(&[]), &quiet(&out), false).unwrap();
    // A longer run from there that is stopped is unfinished again, whatever results were there.
    assert_eq!(go(&small(&["time.end=2"]), &resume, true).unwrap().ending, Ending::Stopped);
    refused();
    // A run that is killed has no results at all.
    fs::remove_file(out.join("result.json")).unwrap();
    refused();
    let anew = go(&small(&[]), &Options { overwrite: true, ..quiet(&out) }, false).unwrap();
    assert_eq!(anew.result, all.result);
    fs::remove_dir_all(&out).unwrap();
}

/// The error of a damaged state names the flag that goes on from the one before it, with the same
/// results.
#[test]
fn a_run_goes_on_from_the_state_before_the_last() {
    let [out, whole] = ["previous", "previous-whole"].map(folder);
    let resume = Options { resume: true, ..quiet(&out) };
    for out in [&out, &whole] {
        go(&small(&[]), &quiet(out), false).unwrap();
    }
    let all = go(&small(&["time.end=3"]), &Options { resume: true, ..quiet(&whole) }, false).unwrap().result;
    go(&small(&["time.end=2"]), &resume, false).unwrap();
    let [last, previous] = ["state.bin", "state.bin.previous"].map(|name| out.join(name));
    let older = fs::read(&previous).unwrap();
    fs::write(&last, "not a state").unwrap();
    let told = go(&small(&["time.end=3"]), &resume, false).err().unwrap().to_string();
    assert!(told.contains("siltflow resume --previous"), "{told}");
    let from_previous = Options { resume_previous: true, ..quiet(&out) };
    let stopped = go(&small(&["time.end=3"]), &from_previous, true).unwrap();
    assert_eq!((stopped.ending, &stopped.result["time"]), (Ending::Stopped, &1.0.into()));
    // The older state has taken the place of the damaged one.
    assert!(fs::read(&previous).unwrap() == older);
    let rest = go(&small(&["time.end=3"]), &resume, false).unwrap().result;
    assert_eq!(rest, all);
    for out in [out, whole] {
        fs::remove_dir_all(out).unwrap();
    }
}

/// A steady run saves states while it iterates, from which it goes on bit for bit after it was
/// killed.
#[test]
fn a_steady_run_that_is_killed_goes_on() {
    let [whole, first, pieces] = ["steady-whole", "steady-first", "steady-pieces"].map(folder);
    let set = ["checkpoint.every=1e-3", "checkpoint.at_end=false"];
    let all = run(crate::steady::CHANNEL, &set, &quiet(&whole));
    assert_eq!(all.ending, Ending::Done);
    // The state of some iteration, and the table so far, as a kill leaves them.
    std::thread::scope(|scope| {
        scope.spawn(|| run(crate::steady::CHANNEL, &set, &quiet(&first)));
        let state = first.join("state.bin");
        while !first.join("state.bin.previous").exists() {
            std::thread::sleep(Duration::from_millis(1));
        }
        fs::create_dir_all(&pieces).unwrap();
        fs::copy(state, pieces.join("state.bin")).unwrap();
    });
    fs::copy(first.join("residuals.csv"), pieces.join("residuals.csv")).unwrap();
    let rest = run(crate::steady::CHANNEL, &set, &Options { resume: true, ..quiet(&pieces) });
    assert_eq!(rest.result, all.result);
    let [a, b] = [&whole, &pieces].map(|out| fs::read(out.join("residuals.csv")).unwrap());
    assert!(a == b);
    let log = fs::read_to_string(pieces.join("run.log")).unwrap();
    assert!(log.contains("going on with"), "{log}");
    for out in [whole, first, pieces] {
        fs::remove_dir_all(out).unwrap();
    }
}
