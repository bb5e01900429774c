//! The command: scenes by name, checks, templates, exit codes.
use serde_json::Value;
use std::path::PathBuf;
use std::process::{Command, Output};

fn siltflow(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_siltflow")).args(arguments).output().unwrap()
}

fn printed(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Path for a file or folder of this process.
fn fresh(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("siltflow-command-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&path);
    let _ = std::fs::remove_file(&path);
    path
}

/// `rock_in_channel` names a mesh that comes with it.
#[test]
fn scenes_that_come_with_the_command_are_checked_by_name() {
    let names: Vec<Value> = serde_json::from_slice(&siltflow(&["list", "--json"]).stdout).unwrap();
    assert!(names.iter().any(|scene| scene["name"] == "two_discs" && scene["title"] != ""));
    let rock = ["check", "rock_in_channel", "taylor_green", "--json", "--set", "output.images=false"];
    let plans: Vec<Value> = serde_json::from_slice(&siltflow(&rock).stdout).unwrap();
    assert_eq!(plans.len(), 2);
    assert!(plans[1]["scene"] == "taylor_green" && plans[1]["steps"].as_f64().unwrap() > 10.0, "{plans:?}");
}

#[test]
fn a_new_scene_passes_its_check_and_is_not_overwritten() {
    let path = fresh("first.toml");
    let name = path.to_str().unwrap();
    let [first, second] = [siltflow(&["new", name]), siltflow(&["new", name])];
    assert!(first.status.success() && second.status.code() == Some(1), "{second:?}");
    let checked = siltflow(&["check", name]);
    std::fs::remove_file(&path).unwrap();
    assert!(checked.status.success() && !printed(&checked).contains("warning"), "{}", printed(&checked));
}

/// Exit codes 0, 2, 3; the worst of several scenes counts.
#[test]
fn exit_codes_are_those_of_the_help() {
    let help = printed(&siltflow(&["--help"]));
    assert!(help.contains("Exit codes: 0 done; 1 an error of a run"), "{help}");
    let out = fresh("codes");
    let folder = out.to_str().unwrap();
    let run = |scene: &str, more: &[&str]| {
        let common = ["run", scene, "--quiet", "--out", folder, "--overwrite"];
        siltflow(&[&common[..], more].concat()).status.code()
    };
    assert_eq!(run("taylor_green", &["--set", "time.end=0.05"]), Some(0));
    assert_eq!(run("backward_step", &["--set", "flow.iterations=3"]), Some(3));
    assert_eq!(run("no_such_scene", &[]), Some(2));
    assert_eq!(run("taylor_green", &["--set", "fluid.nu=-1"]), Some(2));
    let both = siltflow(&["check", "taylor_green", "no_such_scene"]);
    assert!(both.status.code() == Some(2) && printed(&both).starts_with("taylor_green"), "{both:?}");
    std::fs::remove_dir_all(&out).unwrap();
}

/// Ctrl-C ends a run with exit code 130 and a state from which another process goes on, with the
/// scene from a folder of its own.
#[cfg(unix)]
#[test]
fn a_run_that_is_stopped_is_resumed() {
    let out = fresh("stopped");
    let common = ["rock_in_channel", "--quiet", "--out", out.to_str().unwrap()];
    let coarse = ["--set", "grid.cells=[20, 10, 10]", "--set", "output.images=false"];
    let arguments = |task| [&[task][..], &common, &coarse].concat();
    let before = siltflow(&arguments("resume"));
    assert_eq!(before.status.code(), Some(1), "{before:?}");
    let mut run = Command::new(env!("CARGO_BIN_EXE_siltflow")).args(arguments("run")).spawn().unwrap();
    while !out.join("run.log").exists() {
        assert!(run.try_wait().unwrap().is_none());
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    assert!(Command::new("kill").args(["-INT", &run.id().to_string()]).status().unwrap().success());
    assert_eq!(run.wait().unwrap().code(), Some(130));
    let resumed = siltflow(&arguments("resume"));
    assert!(resumed.status.success(), "{resumed:?}");
    std::fs::remove_dir_all(&out).unwrap();
}

/// A body, a surface with a hole, and one whose faces do not agree, as it is and repaired.
#[test]
fn meshes_are_admitted_repaired_and_drawn() {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let rock = root.join("scenes/rock.stl");
    let [picture, copy, bad] = ["rock.png", "rock.obj", "bad.obj"].map(fresh);
    let [rock, picture, copy, bad_file] = [&rock, &picture, &copy, &bad].map(|path| path.to_str().unwrap());
    let told = siltflow(&["mesh", rock, "--picture", picture, "--out", copy, "--json"]);
    let first: Value = serde_json::from_slice(&told.stdout).unwrap();
    let again = siltflow(&["mesh", copy, "--json"]);
    let second: Value = serde_json::from_slice(&again.stdout).unwrap();
    assert_eq!(first["body"], second["body"]);
    let volume = first["body"]["volume"].as_f64().unwrap();
    let mass = first["body"]["mass"].as_f64().unwrap();
    assert!(volume > 0.0 && (mass / volume / 1000.0 - 1.0).abs() < 1e-12, "{first}");
    assert_eq!(std::fs::read(picture).unwrap()[1..4], *b"PNG");
    // A tetrahedron with a face turned, then without it.
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n";
    std::fs::write(&bad, format!("{vertices}f 2 4 3\n")).unwrap();
    let refused = siltflow(&["mesh", bad_file]);
    let error = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(2) && error.contains("--repair mends some such faults"), "{error}");
    let repaired = siltflow(&["mesh", bad_file, "--repair", "--density", "2", "--unit", "2"]);
    let text = printed(&repaired);
    assert!(repaired.status.success() && text.contains("1 faces turned"), "{text}");
    assert!(text.contains("mass at 2 kg/m³: 2.6667e0 kg"), "{text}");
    std::fs::write(&bad, vertices).unwrap();
    let open = siltflow(&["mesh", bad_file, "--repair"]);
    assert_eq!(open.status.code(), Some(2), "{open:?}");
    assert_eq!(siltflow(&["mesh", "rock.ply"]).status.code(), Some(2));
    assert_eq!(siltflow(&["mesh", rock, "--cell=-1"]).status.code(), Some(2));
    for file in [picture, copy, bad_file] {
        std::fs::remove_file(file).unwrap();
    }
}

/// Of two scenes one is run; a tolerance that is not met is exit code 1.
#[test]
fn results_stand_beside_references() {
    let out = fresh("table");
    let folder = out.to_str().unwrap();
    let table = |more: &[&str]| siltflow(&[&["table", "--out", folder, "--json"], more].concat());
    let rows = |output: &Output| -> Vec<Value> { serde_json::from_slice(&output.stdout).unwrap() };
    let run = table(&["--run", "taylor_green"]);
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    let both = table(&["taylor_green", "cylinder"]);
    let both = rows(&both);
    assert_eq!(both.len(), 3);
    let deviation = both[0]["deviation"].as_f64().unwrap();
    assert!(both[0]["met"] == true && both[0]["source"] == "exact" && deviation.abs() < 0.005, "{both:?}");
    assert!(both[1]["result"].is_null() && both[1]["tolerance"] == 0.005, "{both:?}");

    let scene = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/taylor_green.toml"));
    let strict = out.join("taylor_green.toml");
    std::fs::write(&strict, scene.unwrap().replace("tolerance = 0.005", "tolerance = 1e-9")).unwrap();
    let missed = table(&[strict.to_str().unwrap()]);
    assert_eq!(missed.status.code(), Some(1));
    assert_eq!(rows(&missed)[0]["met"], false);
    std::fs::remove_dir_all(&out).unwrap();
}

/// Numbers in the files against those in the snapshots that the model is made of.
#[test]
fn saved_models_predict() {
    let out = fresh("predict");
    let folder = out.to_str().unwrap();
    let mut run = vec!["run", "reduced_discs", "--quiet", "--out", folder];
    let short = ["time.end=0.02", "output.snapshots=20", "grid.cells=[40,80]", "output.report=false"];
    short.iter().for_each(|value| run.extend(["--set", value]));
    assert!(siltflow(&run).status.success());
    let model = out.join("models/velocity.model");
    let predict = |more: &[&str]| {
        let common = ["predict", model.to_str().unwrap(), "--at", "0.01", "--out", folder, "--json"];
        siltflow(&[&common[..], more].concat())
    };
    let done = predict(&["--cells", "40,80", "--spacing", "2.5e-4,2.5e-4", "--write", "npy,csv,vti,png"]);
    assert!(done.status.success(), "{done:?}");
    let printed: Value = serde_json::from_slice(&done.stdout).unwrap();
    assert!(printed["fields"][0]["covered"] == true && printed["fields"][0]["relative_error"].is_number());
    let table = std::fs::read_to_string(out.join("fields.csv")).unwrap();
    let numbers = |line: &str| line.split(',').map(|x| x.parse::<f64>().unwrap()).collect::<Vec<_>>();
    let rows: Vec<Vec<f64>> = table.lines().skip(1).map(numbers).collect();
    assert_eq!(rows.len(), 2 * 40 * 80);
    assert_eq!(rows[41][..3], [0.0, 3.75e-4, 3.75e-4]);
    // Snapshot 10 of 21 is at 0.01 s; the rows of the array are the last numbers of the file.
    let bytes = std::fs::read(out.join("models/velocity.npy")).unwrap();
    let array = &bytes[bytes.len() - 8 * 21 * rows.len()..];
    let at = |k: usize| {
        let at = 8 * (10 * rows.len() + k);
        f64::from_le_bytes(array[at..at + 8].try_into().unwrap())
    };
    let norm = |x: &dyn Fn(usize) -> f64| (0..rows.len()).map(|k| x(k) * x(k)).sum::<f64>().sqrt();
    let off = norm(&|k| rows[k][4] - at(k)) / norm(&at);
    assert!(off < 0.02, "{off}");
    assert!(["fields.npy", "field_0000.vti", "fields.png"].iter().all(|file| out.join(file).exists()));

    let gridless = predict(&["--write", "png"]);
    assert!(gridless.status.code() == Some(2));
    assert!(String::from_utf8_lossy(&gridless.stderr).contains("--cells NX,NY"), "{gridless:?}");
    std::fs::remove_dir_all(&out).unwrap();
}
