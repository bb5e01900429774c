//! What goes wrong while a scene runs, and what looks doubtful before: told with the key.
use crate::{folder, problems, quiet};
use scene::Scene;
use std::sync::atomic::AtomicBool;

const STREAM: &str = r#"
[grid]
cells = [16, 16]
size = [1.0, 1.0]
[sides]
x_min = { type = "inlet", velocity = [1.0, 0.0] }
x_max = "outlet"
y = "wall"
[fluid]
density = 1.0
nu = 0.01
[time]
end = 1.0
[output]
images = false
fields = false
snapshots = 1
"#;
const FALL: &str = r#"
gravity = [0.0, -9.81]
grid = { cells = [48, 48], size = [0.01, 0.01] }
sides = { x = "periodic", y = "wall" }
fluid = { density = 1000.0, nu = 1e-6 }
bodies = [{ shape = { type = "disc", radius = 1e-3 }, density = 1e8, position = [0.005, 0.005] }]
time = { end = 0.2 }
output = { images = false, fields = false, snapshots = 1 }
"#;

fn scene(text: &str, more: &[&str]) -> Scene {
    let more: Vec<String> = more.iter().map(|s| (*s).into()).collect();
    Scene::parse("scene.toml", text, &more).unwrap()
}

/// What a run of that scene ends with.
fn ends_with(text: &str, more: &[&str]) -> String {
    let out = folder("told");
    let error = scene(text, more).run(&quiet(&out), &AtomicBool::new(false)).unwrap_err().to_string();
    let _ = std::fs::remove_dir_all(&out);
    error
}

/// Formulas without a value on the way: at an inlet, of a scalar, of a motion, of a force, before the run and in it.
#[test]
fn formulas_without_a_value_are_told_with_their_key_and_time() {
    let moved = |shift: &str| {
        format!(
            "bodies=[{{ shape = {{ type = \"disc\", radius = 0.2 }}, position = [0.5, 0.5], motion = {{ type = \"prescribed\", shift = ['{shift}', 0.0] }} }}]"
        )
    };
    let scalar =
        r#"scalars.c={ diffusivity = 0.01, sides = { x_min = { type = "value", value = "sqrt(0.5-t)" } } }"#;
    for (more, key, time) in [
        (r#"sides.x_min.velocity=["1/(0.5-t)", 0.0]"#, "sides.x_min.velocity: ", "t = 0.5"),
        (r#"sides.x_min.velocity=["sqrt(0.5-t)", 0.0]"#, "sides.x_min.velocity: ", "t = 0.5"),
        (r#"force=["log(0.5-t)", 0.0]"#, "force: ", "t = 0.5"),
        (scalar, "scalars.c.sides.x_min.value: ", "t = 0.5"),
        (&moved("0.1*sqrt(0.5-t)"), "bodies.0.motion.shift: ", "t = 0.5"),
    ] {
        let told = ends_with(STREAM, &[more]);
        assert!(told.contains(key) && told.contains(time) && told.contains("the formula"), "{more}: {told}");
    }
    // A pole between the instants that are looked at: the run ends there, at the inlet.
    let pole = STREAM.replace("[1.0, 0.0]", "[\"1/(0.5003-t)\", 0.0]");
    let told = ends_with(&pole, &[]);
    assert!(told.contains("scene.toml:6:") && told.contains("m/s by then"), "{told}");
    // A motion whose velocity has a value on one side of the start only is none of that.
    let out = folder("told");
    let shift = moved("0.1*t^1.5");
    let run = scene(STREAM, &[&shift, "time.end=0.1"]).run(&quiet(&out), &AtomicBool::new(false));
    std::fs::remove_dir_all(&out).unwrap();
    let velocity = run.unwrap().result["bodies"][0]["velocity"][0].as_f64().unwrap();
    assert!((velocity - 0.15 * 0.1_f64.sqrt()).abs() < 1e-6, "{velocity}");
}

/// Bodies far too heavy for what is to hold them, or too light for how they are coupled.
#[test]
fn bodies_that_cannot_be_held_are_told() {
    let told = ends_with(FALL, &[]);
    assert!(told.contains("bodies.0: ") && told.contains("Young's modulus"), "{told}");
    let light = ["bodies.0.density=1.0", "coupling.virtual_mass=0.0", "gravity=[0.0, -1.0]"];
    let told = ends_with(FALL, &light);
    assert!(told.contains("coupling.virtual_mass: "), "{told}");
    let warnings = |more: &[&str]| scene(FALL, more).plan().unwrap().warnings.join("\n");
    let told = warnings(&["sides.y=\"periodic\""]);
    assert!(told.contains("1e5 times denser") || told.contains("1.0e5 times denser"), "{told}");
    assert!(told.contains("net weight"), "{told}");
    assert_eq!(warnings(&["bodies.0.density=1100.0"]), "");
}

#[test]
fn what_looks_doubtful_is_told() {
    let warnings = |more: &[&str]| scene(STREAM, more).plan().unwrap().warnings.join("\n");
    assert_eq!(warnings(&[]), "");
    let disc = |radius: f64, x: f64| {
        format!(
            "bodies=[{{ shape = {{ type = \"disc\", radius = {radius} }}, position = [{x}, 0.5], motion = \"fixed\" }}]"
        )
    };
    let fine = "grid.cells=[160, 160]";
    for (more, part) in [
        (&["time.end=1e30"][..], "years on one core"),
        (&["time.dt=0.05"], "Courant number"),
        (&["fluid.nu=1e-6"], "Reynolds number of a cell"),
        (&[fine, &disc(0.2, 0.5)], "a body blocks 40 %"),
        (&[fine, &disc(0.05, 0.1)], "the inlet at x_min is 0.5 sizes"),
        (&[fine, &disc(0.05, 0.9)], "the outlet at x_max is 0.5 sizes"),
        (&[&disc(0.1, 0.5)], "cells across"),
        (&["turbulence=\"sst\"", "fluid.nu=1e-3", "flow.convection=\"limited\""], "at y+ of about 1.6"),
        (
            &["turbulence=\"sst\"", "fluid.nu=1e-3", &disc(0.1, 0.5)],
            "at y+ of about 1.6: laws of the wall want 30 to 300; take wider cells there",
        ),
        (
            &["turbulence=\"sst\"", &disc(0.1, 0.5)],
            "bodies by cut links are no walls to k–ω SST in unsteady flow",
        ),
        (
            &["turbulence={ model = \"sst\", walls = \"slip\" }"],
            "turbulence.walls is not used by flow.algorithm = \"projection\"",
        ),
        (
            &["turbulence=\"sst\"", &disc(0.1, 0.5), "scalars.c={ diffusivity = 0.01, bodies = 1.0 }"],
            "without a law of the wall",
        ),
    ] {
        let told = warnings(more);
        assert!(told.contains(part), "{more:?}: {told}");
    }
    // The plan refuses as the first step does.
    let told = scene(STREAM, &["time.dt=0.1"]).plan().unwrap_err().to_string();
    assert!(told.contains("time.dt: the flow moved 1.687e0 cells in a step"), "{told}");
    let periodic = ["sides.y=\"periodic\"", fine, &disc(0.2, 0.5)];
    assert!(warnings(&periodic).contains("along y the period is 2.5 times"), "{}", warnings(&periodic));
    assert!(problems(STREAM, "sides.x_min.velocity=[1.0]").contains("sides.x_min.velocity"));
}

/// Bodies outside the box, by every forcing and motion, in the plan as in a run; along a periodic axis there is no outside.
#[test]
fn bodies_outside_the_box_are_errors_of_the_plan() {
    let body = |x: f64, y: f64, motion: &str| {
        format!(
            "bodies=[{{ shape = {{ type = \"disc\", radius = 0.3 }}, position = [{x}, {y}], density = 2.0, motion = {motion} }}]"
        )
    };
    let swing = "{ type = \"prescribed\", shift = [\"0.01*sin(t)\", 0.0] }";
    let simple = ["flow.algorithm=\"simple\""];
    for (x, y) in [(-1.0, 0.5), (1.4, 0.5), (0.5, -0.31), (0.5, 9.0), (-0.25, -0.25)] {
        for (motion, more) in [
            ("\"fixed\"", &[][..]),
            ("\"fixed\"", &["coupling.forcing=\"cut-links\""]),
            ("\"fixed\"", &["coupling.forcing=\"smooth\""]),
            ("\"fixed\"", &["coupling.forcing=\"hfdib\""]),
            ("\"fixed\"", &["flow.algorithm=\"piso\"", "time.dt=1e-3", "coupling.forcing=\"hfdib\""]),
            ("\"fixed\"", &simple),
            (swing, &[]),
            (swing, &["coupling.forcing=\"hfdib\""]),
            ("\"free\"", &["sides.y=\"periodic\""]),
        ] {
            if motion == "\"free\"" && (0.0..=1.0).contains(&x) {
                continue;
            }
            let body = body(x, y, motion);
            let more: Vec<&str> = more.iter().copied().chain([body.as_str()]).collect();
            let planned = scene(STREAM, &more).plan().unwrap_err().to_string();
            assert!(
                planned.contains("bodies.0: ") && planned.contains("the box from 0.0"),
                "{more:?}: {planned}"
            );
            assert_eq!(planned, ends_with(STREAM, &more));
        }
    }
    let around = ["sides.y=\"periodic\"", "time.end=0.01", &body(0.5, -7.3, "\"fixed\"")];
    for forcing in ["cut-links", "smooth", "hfdib"] {
        let forcing = format!("coupling.forcing=\"{forcing}\"");
        scene(STREAM, &[&around[..], &[forcing.as_str()]].concat()).plan().unwrap();
    }
}

/// Plates thinner than a cell at any angle, by cut links and cut cells; thin parts of thick bodies are warnings.
#[test]
fn thin_walls_are_found_by_the_plan() {
    let plate = |angle: f64| {
        format!(
            "bodies=[{{ shape = {{ type = \"box\", edges = [0.006, 0.3] }}, position = [0.5, 0.5], orientation = {angle}, motion = \"fixed\" }}]"
        )
    };
    let simple = ["flow.algorithm=\"simple\""];
    for angle in [0.0, 10.0, 30.0, 45.0, 60.0, 90.0] {
        for more in [&[][..], &simple] {
            let plate = plate(angle);
            let more: Vec<&str> = more.iter().copied().chain([plate.as_str()]).collect();
            let planned = scene(STREAM, &more).plan().unwrap_err().to_string();
            assert!(planned.contains("bodies.0: ") && planned.contains("thin"), "{angle}: {planned}");
        }
    }
    let slender = "bodies=[{ name = \"blade\", shape = { type = \"ellipse\", semi_axes = [0.35, 0.04] }, position = [0.5, 0.5], orientation = 20.0, motion = \"fixed\" }]";
    for more in [&[][..], &simple] {
        let more: Vec<&str> = more.iter().copied().chain([slender]).collect();
        let warnings = scene(STREAM, &more).plan().unwrap().warnings.join("\n");
        assert!(warnings.contains("body blade is thin at ("), "{warnings}");
    }
}

/// Mean flows are convected by an upwind-biased scheme unless the scene says otherwise; large eddies and resolved flows keep the central one. The plan tells
/// which, and why.
#[test]
fn rans_models_take_an_upwind_biased_scheme_by_default() {
    let plan = |more: &[&str]| scene(STREAM, more).plan().unwrap().to_string();
    let because = "upwind-biased, as the model resolves no eddies";
    for model in ["sst", "k-omega", "k-epsilon", "realizable"] {
        let turbulence = format!("turbulence=\"{model}\"");
        assert!(plan(&[&turbulence]).contains(&format!("limited, {because}")), "{}", plan(&[&turbulence]));
        let steady = plan(&[&turbulence, "flow.algorithm=\"simple\""]);
        assert!(steady.contains(&format!("quick, {because}")), "{steady}");
        let given = plan(&[&turbulence, "flow.convection=\"central\""]);
        assert!(!given.contains(because) && given.contains("central"), "{given}");
    }
    assert!(plan(&[]).contains("central, which keeps kinetic energy"), "{}", plan(&[]));
}

/// Models with ε beside first cells in the buffer layer or the viscous sublayer are warned of before the run.
#[test]
fn models_without_a_sublayer_want_wide_first_cells() {
    let warnings = |model: &str, nu: &str| {
        let turbulence = format!("turbulence=\"{model}\"");
        scene(STREAM, &[&turbulence, nu, "sides.y=\"wall\""]).plan().unwrap().warnings.join("\n")
    };
    for model in ["k-epsilon", "realizable"] {
        for nu in ["fluid.nu=1e-2", "fluid.nu=1e-3", "fluid.nu=1e-4"] {
            let told = warnings(model, nu);
            assert!(told.contains("no terms for the viscous sublayer"), "{model} {nu}: {told}");
        }
    }
    assert!(!warnings("sst", "fluid.nu=1e-3").contains("no terms for the viscous sublayer"));
}

#[test]
fn a_force_that_grows_without_end_is_named() {
    let free = STREAM
        .replace(
            "x_min = { type = \"inlet\", velocity = [1.0, 0.0] }\nx_max = \"outlet\"",
            "x = \"periodic\"",
        )
        .replace("y = \"wall\"", "y = \"symmetry\"");
    let told = ends_with(&free, &["force=[\"exp(60*t)\", 0.0]"]);
    assert!(told.contains("force: ") && told.contains("m/s² by then"), "{told}");
}
