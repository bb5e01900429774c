//! Scenes as their users have them: every file in `scenes/`, spoilt files, interrupted runs, folders that cannot be written to.
use proptest::prelude::*;
use proptest::test_runner::{Config, TestCaseError, TestRunner};
use scene::{Ending, Options, RunResult, Scene, json_schema, manual};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
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

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("siltflow-scene-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    folder
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

/// What is told of that scene with `more` set; nothing if it is right.
fn problems(text: &str, more: &str) -> String {
    Scene::parse("scene.toml", text, &[more.into()]).err().map(|e| e.to_string()).unwrap_or_default()
}

#[test]
fn the_manual_and_the_schema_are_those_of_the_code() {
    let told = "run `cargo run --release --example scene -- --manual > docs/scene.md` and `-- --schema > scenes/schema.json`";
    assert!(std::fs::read_to_string(root().join("docs/scene.md")).unwrap_or_default() == manual(), "{told}");
    assert!(
        std::fs::read_to_string(root().join("scenes/schema.json")).unwrap_or_default() == json_schema(),
        "{told}"
    );
}

#[test]
fn every_scene_is_checked_in_a_second() {
    let all = scenes();
    assert!(all.len() >= 3);
    for (path, _) in all {
        let start = Instant::now();
        let scene = Scene::load(&path, &[]).unwrap_or_else(|e| panic!("{e}"));
        let plan = scene.plan().unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        // Ten seconds where other tests run beside it; a second is what it takes alone.
        assert!(start.elapsed() < Duration::from_secs(10), "{}: {:?}", path.display(), start.elapsed());
        assert!(plan.steps > 0.0 && plan.cpu > 0.0, "{plan}");
    }
}

/// One way to spoil a text.
#[derive(Clone, Debug)]
enum Spoil {
    /// The byte at a share of the text becomes another.
    Byte(f64, u8),
    /// A line goes.
    Drop(f64),
    /// A line comes twice.
    Twice(f64),
    /// What stands behind an equals sign becomes something else.
    Value(f64, &'static str),
    /// The name of a key loses its first letter.
    Key(f64),
    /// A digit is put into a number.
    Digit(f64, u8),
    /// The rest is cut off.
    Cut(f64),
}

const VALUES: [&str; 20] = [
    "0",
    "-1",
    "1e300",
    "nan",
    "inf",
    "\"\"",
    "\"x\"",
    "[]",
    "[1, 2, 3, 4]",
    "{}",
    "true",
    "1979-05-27",
    "\"sin(\"",
    "\"1/t\"",
    "[[1]]",
    "1e-300",
    "99999999999999999999",
    "\"periodic\"",
    "{ type = \"wall\" }",
    "'''\n'''",
];

fn spoil() -> impl Strategy<Value = Spoil> {
    let at = || 0.0..1.0;
    prop_oneof![
        (at(), any::<u8>()).prop_map(|(a, b)| Spoil::Byte(a, b)),
        at().prop_map(Spoil::Drop),
        at().prop_map(Spoil::Twice),
        (at(), proptest::sample::select(&VALUES[..])).prop_map(|(a, v)| Spoil::Value(a, v)),
        (at(), proptest::sample::select(&VALUES[..])).prop_map(|(a, v)| Spoil::Value(a, v)),
        at().prop_map(Spoil::Key),
        (at(), b'0'..=b'9').prop_map(|(a, d)| Spoil::Digit(a, d)),
        at().prop_map(Spoil::Cut),
    ]
}

fn spoilt(text: &str, how: &Spoil) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let pick = |share: f64, n: usize| ((share * n as f64) as usize).min(n.saturating_sub(1));
    let on = |share: f64, change: &dyn Fn(&str) -> String, which: &dyn Fn(&str) -> bool| {
        let fit: Vec<usize> = (0..lines.len()).filter(|&i| which(lines[i])).collect();
        let chosen = fit.get(pick(share, fit.len())).copied();
        let line =
            |(i, line): (usize, &&str)| if Some(i) == chosen { change(line) } else { (*line).to_owned() };
        lines.iter().enumerate().map(line).collect::<Vec<_>>().join("\n")
    };
    let is_key = |line: &str| line.contains('=') && !line.trim_start().starts_with('#');
    match *how {
        Spoil::Byte(share, byte) => {
            let mut bytes = text.as_bytes().to_vec();
            let at = pick(share, bytes.len());
            bytes[at] = byte;
            String::from_utf8_lossy(&bytes).into_owned()
        }
        Spoil::Drop(share) => on(share, &|_| String::new(), &|line| !line.trim().is_empty()),
        Spoil::Twice(share) => on(share, &|line| format!("{line}\n{line}"), &|line| !line.trim().is_empty()),
        Spoil::Value(share, value) => {
            on(share, &|line| format!("{} = {value}", line.split('=').next().unwrap_or("")), &is_key)
        }
        Spoil::Key(share) => on(share, &|line| line.chars().skip(1).collect(), &is_key),
        Spoil::Digit(share, digit) => on(
            share,
            &|line| match line.rfind(|c: char| c.is_ascii_digit()) {
                Some(at) => format!("{}{}{}", &line[..at], digit as char, &line[at..]),
                None => line.to_owned(),
            },
            &is_key,
        ),
        Spoil::Cut(share) => {
            let at = pick(share, text.len());
            String::from_utf8_lossy(&text.as_bytes()[..at]).into_owned()
        }
    }
}

/// A thousand spoilt files: whatever is wrong is told with its key or line; what is right after all can be planned, and, if it is small,
/// makes a step. Nothing panics, nothing takes ten seconds.
#[test]
fn spoilt_scenes_are_told_about() {
    let all: Vec<_> = scenes().into_iter().map(|(path, text)| (path, coarse(&text))).collect();
    for (path, text) in &all {
        Scene::parse(&path.display().to_string(), text, &[]).unwrap_or_else(|e| panic!("{e}"));
    }
    let strategy = (0..all.len(), proptest::collection::vec(spoil(), 1..3));
    let mut runner = TestRunner::new(Config { cases: 1000, failure_persistence: None, ..Config::default() });
    let out = folder("spoilt");
    let stop = AtomicBool::new(false);
    let result = runner.run(&strategy, |(which, spoils)| {
        let (path, text) = &all[which];
        let text = spoils.iter().fold(text.clone(), |text, how| spoilt(&text, how));
        let start = Instant::now();
        match Scene::parse(&path.display().to_string(), &text, &[]) {
            Err(problems) => {
                prop_assert!(problems.count() > 0);
                for (line, _, message) in problems.iter() {
                    prop_assert!(line >= 1 && line <= text.lines().count() + 1, "line {line}: {problems}");
                    prop_assert!(message.len() > 10, "{message}");
                }
                prop_assert!(problems.to_string().contains(".toml:"));
            }
            Ok(scene) => match scene.plan() {
                Err(error) => prop_assert!(error.to_string().len() > 10),
                Ok(plan) if plan.cells.iter().product::<usize>() < 5000 && plan.bodies < 100 => {
                    let short = [
                        "time.end=1e-9",
                        "output.snapshots=0",
                        "output.images=false",
                        "output.fields=false",
                        "flow.iterations=2",
                    ];
                    let short = short.map(String::from);
                    if let Ok(scene) = Scene::parse(&path.display().to_string(), &text, &short)
                        && let Err(error) = scene.run(&quiet(&out), &stop)
                    {
                        prop_assert!(error.to_string().len() > 10);
                    }
                }
                Ok(_) => {}
            },
        }
        let took = start.elapsed();
        if took > Duration::from_secs(10) {
            return Err(TestCaseError::fail(format!("{took:?}")));
        }
        Ok(())
    });
    let _ = std::fs::remove_dir_all(&out);
    result.unwrap();
}

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

/// Bodies that move by formulas have the formula's velocity, too: the force on a cylinder that swings goes to and fro, as measured (3.3 at the most).
#[test]
fn a_cylinder_swings() {
    let out = folder("swings");
    let coarse = [
        "grid.x.fine=0.1",
        "grid.y.fine=0.1",
        "time.dt=0.02",
        "time.end=10",
        "forces.start=5",
        "output.snapshots=0",
        "output.images=false",
    ];
    let scene =
        Scene::load(&root().join("scenes/oscillating_cylinder.toml"), &coarse.map(String::from)).unwrap();
    let result = scene.run(&quiet(&out), &AtomicBool::new(false)).unwrap().result;
    std::fs::remove_dir_all(&out).unwrap();
    let of = |what: &str| result["forces"][0]["coefficients"][what][0].as_f64().unwrap();
    assert!(
        of("mean").abs() < 0.03 && (of("highest") / 3.3 - 1.0).abs() < 0.1,
        "{} {} {}",
        of("mean"),
        of("highest"),
        of("lowest")
    );
    // x = −5/(2π) sin(2πt/5), so u = −cos(2πt/5).
    let velocity = result["bodies"][0]["velocity"][0].as_f64().unwrap();
    assert!((velocity + 1.0).abs() < 1e-4, "{velocity}");
}

/// A warm sphere in a stream, large eddies modelled: `\n`-separated tables.
const WARM: &str = r#"
gravity = [0.0, -9.81, 0.0]
turbulence = { model = "smagorinsky", constant = 0.1 }
[grid]
cells = [16, 12, 12]
size = [1.6, 1.2, 1.2]
[sides]
x_min = { type = "inlet", velocity = [1.0, 0.0, 0.0] }
x_max = "outlet"
y = "symmetry"
z = "wall"
[fluid]
density = 1.0
nu = 1e-3
[scalars.temperature]
diffusivity = 1e-3
bodies = 1.0
expansion = 0.05
[[bodies]]
shape = { type = "sphere", radius = 0.25 }
position = [0.6, 0.6, 0.6]
motion = "fixed"
[time]
end = 0.6
[output]
snapshots = 2
field = "temperature"
"#;

/// Half a run, and the rest of it: the same bits as the whole.
#[test]
fn a_warm_sphere_with_large_eddies_goes_on_as_if_it_had_not_stopped() {
    let [whole, halves] = ["warm-whole", "warm-halves"].map(folder);
    let run =
        |out: &Path, more: &[&str], resume: bool| run(WARM, more, &Options { resume, ..quiet(out) }).result;
    let all = run(&whole, &[], false);
    run(&halves, &["time.end=0.3", "output.snapshots=1"], false);
    let rest = run(&halves, &[], true);
    assert_eq!(all, rest);
    let temperature = &all["fields"]["temperature"];
    // Cells at the surface whose centre is inside have what the profile has there, beyond the 1 of the surface.
    let [mean, most] = ["mean", "most"].map(|what| temperature[what].as_f64().unwrap());
    assert!((0.01..0.3).contains(&mean) && (0.999..1.6).contains(&most), "{temperature}");
    assert!(all["fields"]["eddy_viscosity"]["most"].as_f64().unwrap() > 1e-4);
    assert!(whole.join("images/00002.png").exists());
    [whole, halves].iter().for_each(|out| std::fs::remove_dir_all(out).unwrap());
}

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

/// Without a fluid: a block slides down an inclined plane as Coulomb's law has it, and goes on with the same bits.
#[test]
fn a_block_slides_without_a_fluid() {
    let text = std::fs::read_to_string(root().join("scenes/sliding_block.toml")).unwrap();
    let [whole, halves] = ["block-whole", "block-halves"].map(folder);
    let run = |out: &Path, more: &[&str], resume: bool| run(&text, more, &Options { resume, ..quiet(out) });
    let all = run(&whole, &[], false);
    assert!(all.compared[0].error().abs() < 1e-4, "{:?}", all.compared);
    assert!(all.result.get("flow").is_none() && all.result["contacts"] == 1);
    run(&halves, &["time.end=0.2", "output.snapshots=20"], false);
    assert_eq!(all.result, run(&halves, &[], true).result);
    // An open side, by which bodies may leave.
    assert_eq!(problems(&text, "sides.x=\"outlet\""), "");
    assert!(!whole.join("fields").exists() && whole.join("bodies/00040.vtp").exists());
    for (more, told) in [
        ("coupling={}", "this needs a fluid"),
        ("probes=[]", "this needs a fluid"),
        ("output.quantity=\"pressure\"", "pictures show the bodies"),
        ("bodies.0.motion=\"fixed\"", "nothing happens"),
        ("output.fields=true", "no fields to write"),
        ("sides.x={type=\"inlet\", velocity=[1.0, 0.0]}", "along x: without `fluid` nothing enters"),
        ("sides.y={type=\"wall\", velocity=[1.0, 0.0]}", "along y: without `fluid` nothing enters or drives"),
    ] {
        let found = problems(&text, more);
        assert!(found.contains(told), "{more}: {found}");
    }
    [whole, halves].iter().for_each(|out| std::fs::remove_dir_all(out).unwrap());
}

/// What cannot be together is told, by its key.
#[test]
fn physics_that_does_not_go_together_is_told() {
    for (more, told) in [
        ("turbulence=\"sst\"", None),
        ("flow.algorithm=\"simple\"", Some("large eddies are not steady")),
        ("output.field=\"salt\"", Some("there are: temperature, eddy_viscosity")),
        ("bodies.0.motion=\"free\"", Some("for bodies at rest")),
        ("turbulence.length=0.1", Some("no key \"length\"")),
        ("scalars.temperature.sides.x_min={type=\"value\"}", Some("value")),
    ] {
        let told_here = Scene::parse("warm.toml", WARM, &[more.into()]).err().map(|e| e.to_string());
        match told {
            None => assert!(told_here.is_none(), "{more}: {told_here:?}"),
            Some(part) => {
                assert!(told_here.as_ref().is_some_and(|t| t.contains(part)), "{more}: {told_here:?}")
            }
        }
    }
}

/// A steady channel with a wall inside, by k–ω SST: it slows the fluid down, and its drag is told.
#[test]
fn a_wall_in_a_steady_channel_has_friction() {
    let text = r#"
        turbulence = { model = "sst", intensity = 0.05, length = 0.07 }
        [grid]
        cells = [40, 20]
        size = [4.0, 1.1]
        [sides]
        x_min = { type = "inlet", velocity = [1.0, 0.0] }
        x_max = { type = "pressure" }
        y = "symmetry"
        [fluid]
        density = 1.0
        nu = 1e-5
        [flow]
        algorithm = "simple"
        convection = "upwind"
        tolerance = 1e-4
        iterations = 400
        [[bodies]]
        name = "floor"
        shape = { type = "formula", distance = "y - 0.12", lower = [-1.0, -1.0], upper = [5.0, 0.2] }
        position = [0.0, 0.0]
        motion = "fixed"
        [forces]
        velocity = 1.0
        area = 4.0
        [time]
        end = 1.0
        [output]
        field = "k"
    "#;
    let out = folder("steady");
    let scene = Scene::parse("channel.toml", text, &[]).unwrap();
    let run = scene.run(&quiet(&out), &AtomicBool::new(false)).unwrap();
    std::fs::remove_dir_all(&out).unwrap();
    assert_eq!(run.ending, Ending::Done, "{}", run.result["residual"]);
    let drag = run.result["forces"][0]["coefficients"]["last"][0].as_f64().unwrap();
    // Between those of a smooth plate at Re 4e5 with and without a fully turbulent layer, twice as wide for the coarse cells.
    assert!((2e-3..1.2e-2).contains(&drag), "{drag}");
    assert!(run.result["y_plus"]["mean"].as_f64().unwrap() > 10.0);
}

/// A disc that swings across a turbulent stream: models of two equations see it, by the unsteady algorithm only.
#[test]
fn a_model_of_two_equations_sees_a_body_that_moves() {
    let text = r#"
        turbulence = { model = "sst", intensity = 0.05, viscosity_ratio = 10.0 }
        [grid]
        cells = [60, 40]
        size = [6.0, 4.0]
        [sides]
        x_min = { type = "inlet", velocity = [1.0, 0.0] }
        x_max = { type = "pressure" }
        y = "symmetry"
        [fluid]
        density = 1.0
        nu = 1e-4
        [initial]
        velocity = [1.0, 0.0]
        [[bodies]]
        name = "cylinder"
        shape = { type = "disc", radius = 0.5 }
        position = [2.0, 2.0]
        motion = { type = "prescribed", shift = [0.0, "0.3*sin(3*t)"] }
        [forces]
        velocity = 1.0
        area = 1.0
        [time]
        end = 0.5
        [output]
        field = "k"
    "#;
    let out = folder("swings");
    let scene = Scene::parse("swings.toml", text, &[]).unwrap();
    let plan = scene.plan().unwrap().to_string();
    assert!(plan.contains("beside bodies wherever they are"), "{plan}");
    let run = scene.run(&quiet(&out), &AtomicBool::new(false)).unwrap();
    std::fs::remove_dir_all(&out).unwrap();
    assert_eq!(run.ending, Ending::Done);
    assert!(run.result["y_plus"]["mean"].as_f64().unwrap() > 5.0, "{}", run.result["y_plus"]);
    for (more, told) in [
        ("flow.algorithm=\"simple\"", "a steady flow has no bodies that move"),
        ("flow.algorithm=\"piso\"", "turbulence models go with \"projection\""),
    ] {
        let found = problems(text, more);
        assert!(found.contains(told), "{more}: {found}");
    }
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
