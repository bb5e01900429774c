//! Bodies that move as told, turbulence, scalars.
use crate::{folder, problems, quiet, root, run};
use scene::{Ending, Options, Scene};
use std::path::Path;
use std::sync::atomic::AtomicBool;

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
pub(crate) const WARM: &str = r#"
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
    // Cells that the surface cuts hold what the profile has at their centre, beyond the 1 of the surface: they do not count.
    let [mean, most] = ["mean", "most"].map(|what| temperature[what].as_f64().unwrap());
    assert!((0.01..0.3).contains(&mean) && (0.8..=1.0).contains(&most), "{temperature}");
    assert!(all["fields"]["eddy_viscosity"]["most"].as_f64().unwrap() > 1e-4);
    assert!(whole.join("images/00002.png").exists());
    [whole, halves].iter().for_each(|out| std::fs::remove_dir_all(out).unwrap());
}

/// What cannot be together is told, by its key.
#[test]
fn physics_that_does_not_go_together_is_told() {
    for (more, told) in [
        ("turbulence=\"sst\"", None),
        ("flow.algorithm=\"simple\"", Some("large eddies are not steady")),
        ("output.field=\"salt\"", Some("there are: temperature, eddy_viscosity")),
        ("bodies.0.motion=\"free\"", None),
        ("bodies=[]", Some("there are none")),
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

/// A warm disc that moves through fluid at rest gives off what one at rest gives to a stream.
#[test]
fn a_warm_disc_that_moves_warms_as_one_in_a_stream() {
    let text = r#"
        [grid]
        cells = [64, 32]
        size = [2.0, 1.0]
        [sides]
        x = "periodic"
        y = "periodic"
        [fluid]
        density = 1.0
        nu = 1e-2
        [scalars.warmth]
        diffusivity = 1e-2
        bodies = "1+0.2*t"
        [[bodies]]
        shape = { type = "disc", radius = 0.15 }
        position = [0.8, 0.5]
        motion = "fixed"
        [time]
        end = 1.0
        dt = 5e-3
        [output]
        snapshots = 1
        images = false
        fields = false
    "#;
    let heat = |name: &str, more: &[&str]| {
        let out = folder(name);
        let all = run(text, more, &quiet(&out)).result;
        std::fs::remove_dir_all(&out).unwrap();
        let warmth = &all["fields"]["warmth"];
        let [mean, most] = ["mean", "most"].map(|what| warmth[what].as_f64().unwrap());
        // Less what is in the disc.
        (2.0 * mean - 1.2 * std::f64::consts::PI * 0.15_f64.powi(2), most)
    };
    let [to_left, to_right] =
        ["bodies.0.motion={type='prescribed', shift=['-0.5*t', 0.0]}", "initial.velocity=[0.5, 0.0]"];
    let (still, _) = heat("still", &[]);
    // The finer steps are near the limit of explicit diffusion, which does not bear what holds the surface.
    for (fine, off) in [
        (["time.dt=5e-3", "grid.cells=[64, 32]"], 0.015),
        (["time.dt=2.5e-3", "grid.cells=[128, 64]"], 0.007),
    ] {
        let [(moving, most), (stream, other)] = [("moves", to_left), ("stream", to_right)]
            .map(|(name, how)| heat(name, &[&fine[..], &[how]].concat()));
        assert!((moving / stream - 1.0).abs() < off, "{fine:?}: {moving} {stream} {still}");
        // Nothing is warmer than the disc but for the profile's end inside.
        assert!(most.max(other) < 1.5, "{fine:?}: {most} {other}");
        // Conduction alone does not tell the two from each other.
        assert!((moving - stream).abs() < 0.25 * (moving - still), "{fine:?}: {moving} {stream} {still}");
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
    let y_plus = &run.result["y_plus"];
    assert!(y_plus["mean"].as_f64().unwrap() > 10.0);
    for part in ["laminar", "below_range", "above_range", "between_laws"] {
        let part = y_plus[part].as_f64().unwrap();
        assert!((0.0..=1.0).contains(&part), "{y_plus}");
    }
    assert_eq!(y_plus["range"][1].as_f64(), Some(300.0));
    assert!(run.summary().contains("of the walls"), "{}", run.summary());
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
    let plan = scene.plan().unwrap();
    assert!(plan.to_string().contains("beside bodies wherever they are"), "{plan}");
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
    // By cut links the body is no wall to the model, and there is no other: no y+.
    let fixed = text.replace("{ type = \"prescribed\", shift = [0.0, \"0.3*sin(3*t)\"] }", "\"fixed\"");
    let run =
        Scene::parse("fixed.toml", &fixed, &[]).unwrap().run(&quiet(&out), &AtomicBool::new(false)).unwrap();
    std::fs::remove_dir_all(&out).unwrap();
    assert!(run.result["y_plus"].is_null(), "{}", run.result["y_plus"]);
}

/// A warm disc that swings in a closed box, by the paper's forcing.
const SWINGING: &str = r#"
    [grid]
    cells = [40, 40]
    size = [1.0, 1.0]
    [sides]
    x = "periodic"
    y = "wall"
    [fluid]
    density = 1.0
    nu = 1e-2
    [scalars.warmth]
    diffusivity = 1e-2
    [coupling]
    forcing = "hfdib"
    [[bodies]]
    shape = { type = "disc", radius = 0.15 }
    position = [0.5, 0.45]
    motion = { type = "prescribed", shift = ["0.2*(1-cos(3*t))", 0.0] }
    [time]
    end = 1.0
    dt = 5e-3
    [output]
    snapshots = 1
    images = false
    fields = false
    bodies = false
"#;

/// The results of that scene with `more` set.
fn swing(name: &str, more: &[&str]) -> serde_json::Value {
    let out = folder(name);
    let all = run(SWINGING, more, &quiet(&out)).result;
    std::fs::remove_dir_all(&out).unwrap();
    all
}

/// PISO carries scalars as the projection does, and its books are kept, too.
#[test]
fn a_scalar_by_piso_is_that_of_the_projection() {
    let [piso, projection] = ["piso", "projection"].map(|algorithm| {
        swing(algorithm, &[&format!("flow.algorithm='{algorithm}'"), "scalars.warmth.bodies=1.0"])
    });
    let mean = |all: &serde_json::Value| all["fields"]["warmth"]["mean"].as_f64().unwrap();
    assert!(
        mean(&piso) > 0.15 && (mean(&piso) / mean(&projection) - 1.0).abs() < 0.01,
        "{} {}",
        mean(&piso),
        mean(&projection)
    );
    let of = |key: &str| piso["ledger"][key].as_f64().unwrap();
    assert!(of("momentum_worst_step") < 1e-3 && of("momentum_whole_run") < 1e-6, "{}", piso["ledger"]);
    let work = of("work") + of("driving_work");
    assert!(of("energy_residual").abs() < 0.02 * work && work > 0.0, "{}", piso["ledger"]);
    // None where they are switched off.
    let off = ["output.ledger=false", "time.end=0.05"];
    assert!(swing("off", &off)["ledger"].is_null());
    let scene = Scene::parse("swing.toml", SWINGING, &off.map(String::from)).unwrap();
    let plan = scene.plan().unwrap().to_string();
    assert!(plan.contains("switched off by output.ledger"), "{plan}");
}

/// What a disc gives off arrives, all of it, wherever it goes.
#[test]
fn a_flux_from_a_body_that_moves_is_all_there() {
    let heat = |name: &str, more: &[&str]| {
        let flux = ["scalars.warmth.bodies_flux='0.2*t'", "coupling.forcing='smooth'"];
        swing(name, &[&flux, more].concat())["fields"]["warmth"]["mean"].as_f64().unwrap()
    };
    // ½ 0.2 t² over the rim, but for Euler's first step (2.5e-5).
    let given = 0.1 * 0.3 * std::f64::consts::PI;
    let moves = heat("flux", &[]);
    assert!((moves / given - 1.0).abs() < 1e-4, "{moves} {given}");
    let still = heat("still-flux", &["bodies.0.motion='fixed'"]);
    assert!((moves / still - 1.0).abs() < 1e-12, "{moves} {still}");
    let both = problems(SWINGING, "scalars.warmth={diffusivity=1e-2, bodies=1.0, bodies_flux=1.0}");
    assert!(both.contains("leave out one of the two"), "{both}");
    let leaving = ["scalars.warmth.bodies_flux=1.0", "exits=[{point=[0.0, 0.0], normal=[0.0, 1.0]}]"];
    let told = Scene::parse("s.toml", SWINGING, &leaving.map(String::from)).err().map(|e| e.to_string());
    assert!(told.as_ref().is_some_and(|t| t.contains("bodies that stay")), "{told:?}");
}

/// A warm disc in a channel: what the steady algorithm finds is what the other comes to.
#[test]
fn a_steady_scalar_is_what_an_unsteady_one_comes_to() {
    let text = r#"
        [grid]
        cells = [60, 20]
        size = [3.0, 1.0]
        [sides]
        x_min = { type = "inlet", velocity = ["6*y*(1-y)", 0.0] }
        x_max = { type = "pressure" }
        y = "wall"
        [fluid]
        density = 1.0
        nu = 5e-2
        [scalars.warmth]
        diffusivity = 2e-2
        bodies = 1.0
        [[bodies]]
        shape = { type = "disc", radius = 0.2 }
        position = [1.0, 0.5]
        motion = "fixed"
        [time]
        end = 12.0
        [output]
        snapshots = 1
        images = false
        fields = false
    "#;
    let means = |name: &str, more: &[&str]| {
        let out = folder(name);
        let all = run(text, more, &quiet(&out)).result;
        std::fs::remove_dir_all(&out).unwrap();
        assert_eq!(all["complete"], true, "{name}: {}", all["residual"]);
        let warmth = all["fields"]["warmth"]["mean"].as_f64().unwrap();
        [warmth, all["flow"]["mean_velocity"][1].as_f64().unwrap()]
    };
    let steady = ["flow.algorithm='simple'", "flow.tolerance=1e-7"];
    // Buoyant, too: the warm fluid behind the disc rises.
    for buoyant in [&[][..], &["gravity=[0.0, -9.81]", "scalars.warmth.expansion=0.3"]] {
        let [found, exact] = [means("settled", &[&steady, buoyant].concat()), means("unsettled", buoyant)];
        assert!(found[0] > 0.1 && (found[0] / exact[0] - 1.0).abs() < 0.02, "{found:?} {exact:?}");
        if buoyant.is_empty() {
            assert!(found[1].abs() < 1e-4 && exact[1].abs() < 1e-4, "{found:?} {exact:?}");
        } else {
            // By the steady algorithm on 240 × 80 cells; 0.0143 and 0.0146 on 120 × 40.
            let off = [found[1], exact[1]].map(|rises| rises - 0.0143);
            assert!(off[0].abs() < 1.2e-3 && off[1].abs() < 1.2e-3, "{found:?} {exact:?}");
            // Their outlets are the same.
            assert!((found[1] / exact[1] - 1.0).abs() < 0.01, "{found:?} {exact:?}");
        }
    }
    let more = ["flow.algorithm='simple'", "scalars.warmth={diffusivity=1e-2}"].map(String::from);
    let told = Scene::parse("s.toml", text, &more).err().map(|e| e.to_string()).unwrap_or_default();
    assert!(told.contains("give scalars.NAME.bodies"), "{told}");
}

/// The first step of a turbulent flow is as short as explicit diffusion by the eddies of the start
/// needs.
#[test]
fn the_first_step_is_stable_with_the_eddies_of_the_start() {
    let text = r#"
        turbulence = "sst"
        [grid]
        cells = [4, 32]
        size = [0.125, 1.0]
        [sides]
        x = "periodic"
        y_min = { type = "wall", velocity = [1.0, 0.0] }
        y_max = "wall"
        [fluid]
        density = 1.0
        nu = 0.02
        [time]
        end = 0.5
        [output]
        snapshots = 1
    "#;
    let out = folder("first");
    let run =
        Scene::parse("first.toml", text, &[]).unwrap().run(&quiet(&out), &AtomicBool::new(false)).unwrap();
    std::fs::remove_dir_all(&out).unwrap();
    assert_eq!(run.ending, Ending::Done);
}
