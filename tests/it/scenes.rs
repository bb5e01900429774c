//! Scenes that are killed and go on.
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const PROGRAM: &str = env!("CARGO_BIN_EXE_siltflow");

/// `task` of the command, `run` or `resume`, for a scene.
fn command(task: &str, scene: &str, set: &[&str], out: &Path) -> Command {
    let mut command = Command::new(PROGRAM);
    command
        .arg(task)
        .arg(format!("{}/scenes/{scene}.toml", env!("CARGO_MANIFEST_DIR")))
        .args(["--quiet", "--out"])
        .arg(out);
    // States as often as can be.
    let common = ["output.snapshots=6", "output.image_every=6", "checkpoint.every=1e-3"];
    for set in set.iter().chain(&common) {
        command.args(["--set", set]);
    }
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

/// Runs `scene` as a whole, then kills it again and again while it runs and lets it go on: the results are the same, bit for bit, and so are the tables.
fn killed(scene: &str, set: &[&str]) {
    let folder = |name: &str| {
        std::env::temp_dir().join(format!("siltflow-{name}-{scene}-{}-{}", set.len(), std::process::id()))
    };
    let (whole, pieces) = (folder("whole"), folder("pieces"));
    for folder in [&whole, &pieces] {
        let _ = std::fs::remove_dir_all(folder);
    }
    let start = Instant::now();
    let run = command("run", scene, set, &whole).output().unwrap();
    // An eighth of a whole run at first, however quick the machine is; less if it held this test up so long that the run came to its end.
    let mut first = start.elapsed() / 8;
    assert!(run.status.success(), "{scene}: {}", String::from_utf8_lossy(&run.stderr));
    let mut kills = 0;
    let mut wait = first;
    loop {
        // Killed before it had saved anything, it begins anew.
        let task = if pieces.join("state.bin").exists() { "resume" } else { "run" };
        let mut command = command(task, scene, set, &pieces);
        let mut child = command.spawn().unwrap();
        // Longer each time, so that it comes to its end on slow machines, too.
        std::thread::sleep(wait);
        wait += wait / 3;
        if child.try_wait().unwrap().is_none() {
            child.kill().unwrap();
            kills += 1;
        }
        let ended = child.wait_with_output().unwrap();
        if ended.status.success() {
            if kills > 0 || first < Duration::from_millis(1) {
                break;
            }
            first /= 2;
            wait = first;
            std::fs::remove_dir_all(&pieces).unwrap();
            continue;
        }
        assert!(ended.status.code().is_none(), "{scene}: {}", String::from_utf8_lossy(&ended.stderr));
        assert!(kills < 60, "{scene} does not come to its end");
    }
    assert!(kills > 0, "{scene} was too quick to be killed");
    // Killed between its last step and its results, a run has nothing left to do but to tell them.
    let told = command("resume", scene, set, &pieces).output().unwrap();
    assert!(told.status.success(), "{scene}: {}", String::from_utf8_lossy(&told.stderr));
    let mut compared = 0;
    for name in [
        "result.json",
        "history.csv",
        "images.csv",
        "trajectories.csv",
        "forces.csv",
        "probes/wake.csv",
        "profile.csv",
        "averages.vti",
        "fields/00006.vti",
        "fields/00002.vti",
        "images/00006.png",
    ] {
        if whole.join(name).exists() {
            let [a, b] = [&whole, &pieces].map(|folder| std::fs::read(folder.join(name)).unwrap_or_default());
            assert!(a == b, "{scene}: {name} differs after {kills} kills");
            compared += 1;
        }
    }
    assert!(compared >= 3, "{scene}");
    for folder in [&whole, &pieces] {
        std::fs::remove_dir_all(folder).unwrap();
    }
}

#[test]
fn two_discs_that_are_killed_go_on() {
    killed("two_discs", &["grid.cells=[60, 120]", "time.end=0.05", "forces.start=0.01"]);
}

#[test]
fn vortices_that_are_killed_go_on() {
    killed("taylor_green", &["time.end=5", "averages.profile=y", "averages.start=1"]);
}

#[test]
fn bodies_that_come_and_go_and_are_killed_go_on() {
    killed("raining_discs", &["grid.cells=[72, 144]", "time.end=0.3", "factories.0.rate=60"]);
}

#[test]
fn a_cylinder_that_swings_and_is_killed_goes_on() {
    killed(
        "oscillating_cylinder",
        &["grid.x.fine=0.1", "grid.y.fine=0.1", "time.dt=0.025", "time.end=10", "forces.start=5"],
    );
}

#[test]
fn a_turbulent_cylinder_that_swings_and_is_killed_goes_on() {
    killed(
        "oscillating_cylinder",
        &[
            "grid.x.fine=0.1",
            "grid.y.fine=0.1",
            "fluid.nu=1e-4",
            "turbulence=\"sst\"",
            "output.field=\"k\"",
            "time.dt=0.02",
            "time.end=4",
            "forces.start=2",
        ],
    );
}

#[test]
fn polyhedra_that_are_killed_go_on() {
    killed("sedimenting_polyhedra", &["grid.cells=[32, 32, 64]", "time.end=0.01"]);
}

#[test]
fn grains_without_a_fluid_that_are_killed_go_on() {
    killed("hopper", &["time.end=0.2"]);
}

/// A reader of the plan or the results that leaves is no error, and what had to be done is done.
#[test]
fn nobody_has_to_read() {
    let out = std::env::temp_dir().join(format!("siltflow-unread-{}", std::process::id()));
    let folder = out.display().to_string();
    let run = ["run", "taylor_green", "--json", "--set", "time.end=0.05", "--out", &folder];
    for (arguments, done) in [(&["check", "taylor_green"][..], None), (&run, Some("result.json"))] {
        let mut command = Command::new(PROGRAM);
        command.args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        drop(child.stdout.take());
        let ended = child.wait_with_output().unwrap();
        let told = String::from_utf8_lossy(&ended.stderr);
        assert!(ended.status.success() && !told.contains("panicked"), "{arguments:?}: {told}");
        assert!(done.is_none_or(|file| out.join(file).exists()));
    }
    std::fs::remove_dir_all(&out).unwrap();
}

/// A disk that is full where results are printed to is told.
#[cfg(target_os = "linux")]
#[test]
fn results_that_cannot_be_printed_are_told() {
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let ended = Command::new(PROGRAM).args(["check", "taylor_green"]).stdout(full).output().unwrap();
    let told = String::from_utf8_lossy(&ended.stderr);
    assert!(ended.status.code() == Some(1) && told.contains("could not be: "), "{told}");
}
