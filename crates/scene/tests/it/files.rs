//! Folders that cannot be written to, and states of other scenes.
use crate::physics::WARM;
use crate::{folder, quiet, root};
use scene::{Ending, Options, Scene};
use std::sync::atomic::AtomicBool;

#[test]
fn files_that_cannot_be_written_are_told() {
    let out = folder("file");
    std::fs::write(&out, "not a folder").unwrap();
    let scene = Scene::load(&root().join("scenes/cavity.toml"), &["grid.cells=[8, 8]".into()]).unwrap();
    let error = scene.run(&quiet(&out), &AtomicBool::new(false)).err().unwrap().to_string();
    std::fs::remove_file(&out).unwrap();
    assert!(error.contains("making the folder") && error.contains("siltflow-scene-file"), "{error}");
}

#[test]
fn states_of_other_scenes_are_refused() {
    let out = folder("other");
    let small = |set: &[&str]| {
        let mut all = vec!["grid.cells=[8, 8]", "time.end=1", "output.images=false", "output.snapshots=2"];
        all.extend(set);
        let all: Vec<String> = all.into_iter().map(String::from).collect();
        Scene::load(&root().join("scenes/cavity.toml"), &all).unwrap()
    };
    let stop = AtomicBool::new(false);
    assert_eq!(small(&[]).run(&quiet(&out), &stop).unwrap().ending, Ending::Done);
    let go_on = Options { resume: true, ..quiet(&out) };
    let error = small(&["fluid.nu=0.5"]).run(&go_on, &stop).err().unwrap().to_string();
    assert!(error.contains("saved by another scene"), "{error}");
    // A later end is no other scene.
    let longer = small(&["time.end=2"]).run(&go_on, &stop).unwrap();
    assert_eq!(longer.result["time"], 2.0);
    std::fs::remove_dir_all(&out).unwrap();
}

/// A disk that is full when the results are written: an error that says so, and a state from which the run goes on as if nothing had been.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told_and_costs_nothing() {
    let [whole, full] = ["disk-whole", "disk-full"].map(folder);
    let scene = Scene::parse("warm.toml", WARM, &["time.end=0.2".into()]).unwrap();
    let run = |options: &Options| scene.run(options, &AtomicBool::new(false));
    let all = run(&quiet(&whole)).unwrap().result;
    std::fs::create_dir_all(&full).unwrap();
    let part = full.join("result.json.part");
    std::os::unix::fs::symlink("/dev/full", &part).unwrap();
    let error = run(&quiet(&full)).unwrap_err().to_string();
    assert!(error.contains("is the disk full") && error.contains("result.json"), "{error}");
    std::fs::remove_file(&part).unwrap();
    let rest = run(&Options { resume: true, ..quiet(&full) }).unwrap().result;
    assert_eq!(all, rest);
    [whole, full].iter().for_each(|out| std::fs::remove_dir_all(out).unwrap());
}
