//! Reduced models of a run.
use crate::{folder, problems, quiet, run};
use scene::{Ending, Options, Scene};
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Reduced models of half a run that goes on are those of the whole one; modes that move show a disc's edge that as many modes at rest do not.
#[test]
fn reduced_models_go_on_and_moving_modes_pay() {
    let text = r#"
gravity = [0.0, -9.81]
grid = { cells = [32, 64], size = [4e-3, 8e-3] }
sides = { x = "periodic", y = "periodic" }
fluid = { density = 1000.0, nu = 1e-6 }
bodies = [{ name = "disc", shape = { type = "disc", radius = 5e-4 }, density = 1100.0, position = [2e-3, 6e-3] }]
models = [
    { name = "moving", field = "lambda", frames = ["disc"], ranks = [3] },
    { name = "still", field = "lambda", ranks = [3], coefficients = "spline" },
    { name = "wake", field = "velocity", tolerance = 0.02, hidden = [6] },
]
time = { end = 0.24 }
output = { snapshots = 32, fields = false, image_every = 32 }
"#;
    let [whole, halves] = ["models-whole", "models-halves"].map(folder);
    let run =
        |out: &Path, more: &[&str], resume: bool| run(text, more, &Options { resume, ..quiet(out) }).result;
    let all = run(&whole, &[], false);
    run(&halves, &["time.end=0.12", "output.snapshots=16"], false);
    assert_eq!(all["models"], run(&halves, &[], true)["models"]);
    let same =
        |name: &str| std::fs::read(whole.join(name)).unwrap() == std::fs::read(halves.join(name)).unwrap();
    assert!(same("models/lambda.npy") && same("models/moving.model") && same("models/wake.model"));
    // Stopped while models are made: they are made when the run goes on.
    let scene = Scene::parse("scene.toml", text, &[]).unwrap();
    let stopped = scene.run(&Options { resume: true, ..quiet(&whole) }, &AtomicBool::new(true)).unwrap();
    assert!(stopped.ending == Ending::Stopped && stopped.result["models"].as_array().unwrap().is_empty());
    assert_eq!(all["models"], run(&whole, &[], true)["models"]);
    let error = |k: usize| all["models"][k]["held_out"]["total"].as_f64().unwrap();
    assert!(error(0) < 0.2 * error(1), "{} {}", error(0), error(1));
    // The tolerance of the modes, and what the network adds.
    let wake = &all["models"][2]["training"]["projection"];
    assert!(wake.as_f64().unwrap() <= 0.02, "{wake}");
    for file in ["models/moving_modes.vti", "models/still_off.png", "models/velocity.npy"] {
        assert!(whole.join(file).exists(), "{file}");
    }
    for (more, told) in [
        ("models.0.field=\"salt\"", "there are: lambda, velocity, pressure"),
        ("models.0.frames=[\"disk\"]", "no body \"disk\""),
        ("models.0.ranks=[3, 3]", "2 numbers; give 1"),
        ("models.1.turning=true", "modes stay where they are"),
        ("output.snapshots=10", "output.snapshots of 16"),
        ("models.1.name=\"moving\"", "already"),
    ] {
        let found = problems(text, more);
        assert!(found.contains(told), "{more}: {found}");
    }
    [whole, halves].iter().for_each(|out| std::fs::remove_dir_all(out).unwrap());
}
