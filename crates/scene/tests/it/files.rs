//! Folders that cannot be written to, and states of other scenes.
use crate::physics::WARM;
use crate::{folder, problems, quiet, root, run};
use scene::{Ending, Options, Scene, empty_row};
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

/// A part of the box in pictures fills them: eight cells across and four up. Parts that are not there are told.
#[test]
fn pictures_show_a_part() {
    let size = |name: &str, more: &[&str]| {
        let out = folder(name);
        let once = ["time.end=0.01", "output.images=true", "output.snapshots=1"];
        run(WARM, &[&once, more].concat(), &quiet(&out));
        let png = std::fs::read(out.join("images/00001.png")).unwrap();
        std::fs::remove_dir_all(&out).unwrap();
        // The header of the first chunk holds width and height.
        [16, 20].map(|at| f64::from(u32::from_be_bytes(png[at..at + 4].try_into().unwrap())))
    };
    let [whole, part] = [size("all", &[]), size("part", &["output.region=[[0.4, 1.2], [0.3, 0.7]]"])];
    // Plots are at most 1100 wide and 820 high; what is around them is the same.
    let around = [part[0] - 1100.0, whole[1] - 820.0];
    let [width, height] = [whole[0] - around[0], part[1] - around[1]];
    assert!(
        (width / 820.0 - 4.0 / 3.0).abs() < 2e-3 && (1100.0 / height - 2.0).abs() < 1e-3,
        "{whole:?} {part:?}"
    );
    for (region, told) in [
        ("[[0.5, 0.25], [0.0, 1.0]]", "from 0.5 to 0.25 m is nothing"),
        (
            "[[0.25, 0.75], [0.0, 1.5]]",
            "from 0 to 1.5 m is not inside the box: the box reaches from 0 to 1.2 m there",
        ),
        ("[[0.25, 0.75], [0.2501, 0.2502]]", "there is no cell's centre"),
        ("[[0.25, 0.75]]", "output.region"),
    ] {
        let error = problems(WARM, &format!("output.region={region}"));
        assert!(error.contains("output.region") && error.contains(told), "{region}: {error}");
    }
}

/// A table of runs tells how each ended, and never that something is not a number.
#[test]
fn a_run_that_was_stopped_is_told_in_the_table() {
    let out = folder("row");
    let set = ["grid.cells=[8, 8]", "time.end=1", "output.images=false", "output.snapshots=2"];
    let scene = Scene::load(&root().join("scenes/cavity.toml"), &set.map(String::from)).unwrap();
    let stopped = scene.run(&quiet(&out), &AtomicBool::new(true)).unwrap();
    let anew = Options { overwrite: true, ..quiet(&out) };
    let whole = scene.run(&anew, &AtomicBool::new(false)).unwrap();
    std::fs::remove_dir_all(&out).unwrap();
    assert_eq!(stopped.ending, Ending::Stopped);
    assert!(stopped.row().contains("**stopped** at 0.0000 s of 1 s"), "{}", stopped.row());
    assert!(whole.row().contains("Ghia") && !whole.row().contains("stopped"), "{}", whole.row());
    // What a run was to be compared by and does not have.
    let mut nothing = whole.clone();
    nothing.compared.iter_mut().for_each(|c| c.found = None);
    nothing.timings = serde_json::Value::Null;
    assert!(nothing.row().contains("is not in the results"), "{}", nothing.row());
    for text in [
        stopped.row(),
        stopped.summary(),
        whole.row(),
        nothing.row(),
        nothing.summary(),
        empty_row("a", "b|c"),
    ] {
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
        let cells = |line: &str| line.replace("\\|", "").matches('|').count();
        assert!(
            text.starts_with("Lid") || text.lines().all(|line| cells(line) == 7 || !line.starts_with('|')),
            "{text}"
        );
    }
}

/// Fields beyond single precision are written in double precision.
#[test]
fn large_values_are_written_in_double_precision() {
    let text = std::fs::read_to_string(root().join("scenes/cavity.toml")).unwrap();
    let out = folder("large");
    let more = ["fluid.density=1e45", "grid.cells=[8, 8]", "time.end=1.0", "output.images=false"];
    run(&text, &more, &quiet(&out));
    let file = std::fs::read(out.join("fields/00001.vti")).unwrap();
    assert!(String::from_utf8_lossy(&file).contains("Float64"));
    std::fs::remove_dir_all(&out).unwrap();
}
