//! Surfaces that move: walls by formulas, conveyors and rollers.
use crate::{folder, plan, problems, quiet, run};
use scene::Options;
use serde_json::Value;
use std::path::Path;

/// A parcel on a floor, `floor` being what is under it.
fn parcel(floor: &str) -> String {
    format!(
        r#"
gravity = [0.0, -9.81]
grid = {{ cells = [40, 10], size = [0.8, 0.2] }}
materials.m = {{ density = 1000.0, youngs_modulus = 1e7, friction = 0.3 }}
time = {{ end = 0.25 }}
output = {{ snapshots = 2, images = false, fields = false }}
[[bodies]]
name = "parcel"
shape = {{ type = "box", edges = [0.06, 0.04] }}
material = "m"
position = [0.1, 0.12]
{floor}
"#
    )
}
/// A conveyor 0.1 m thick, whose surface is yet to be given.
const CONVEYOR: &str = r#"
[[bodies]]
name = "belt"
shape = { type = "box", edges = [0.7, 0.09] }
material = "m"
position = [0.4, 0.055]
motion = "fixed"
"#;
const BOX: &str = "sides = { x = \"periodic\", y = \"wall\" }";
const AIR: [&str; 2] = ["fluid={density=1e-3, nu=1e-3}", "grid.cells=[80, 20]"];

fn velocity(result: &Value) -> [f64; 2] {
    [0, 1].map(|c| result["bodies"][0]["velocity"][c].as_f64().unwrap())
}

/// Velocity under Coulomb friction after 0.25 s on a surface of velocity `belt(t)`.
fn coulomb(belt: impl Fn(f64) -> f64) -> f64 {
    let (mut v, dt) = (0.0, 1e-6);
    for step in 1..=250_000 {
        v += (belt(f64::from(step) * dt) - v).clamp(-0.3 * 9.81 * dt, 0.3 * 9.81 * dt);
    }
    v
}

/// Sides, planes and surfaces of bodies whose velocity is a formula take a parcel along as Coulomb's law tells, dry and in thin air.
#[test]
fn surfaces_by_formulas_take_bodies_along() {
    let out = folder("formulas");
    let formula = "[\"0.5*cos(20*t)\", 0.0]";
    let exact = coulomb(|t| 0.5 * (20.0 * t).cos());
    let side = format!(
        "sides = {{ x = \"periodic\", y_min = {{ type = \"wall\", velocity = {formula} }}, y_max = \"wall\" }}"
    );
    let plane = format!(
        "contact.planes = [{{ point = [0.0, 0.1], normal = [0.0, 1.0], velocity = {formula} }}]\n{BOX}"
    );
    let low = [
        "bodies=[{name=\"parcel\", shape={type=\"box\", edges=[0.06, 0.04]}, material=\"m\", position=[0.1, 0.02]}]",
    ];
    let body = format!("{CONVEYOR}surface_velocity = {formula}");
    for air in [&[][..], &AIR] {
        for (name, text, more) in [
            ("side", format!("{side}\n{}", parcel("")), &low[..]),
            ("plane", format!("{plane}\n{}", parcel("")), &[]),
            ("body", format!("{BOX}\n{}", parcel(&body)), &[]),
        ] {
            let result = run(&text, &[air, more].concat(), &quiet(&out)).result;
            let u = velocity(&result);
            println!("{name}, air {}: {u:?} m/s for {exact:.4}, {}", !air.is_empty(), result["ledger"]);
            assert!((u[0] - exact).abs() < 0.01 * 0.5, "{name}: {u:?} for {exact}");
        }
    }
    std::fs::remove_dir_all(&out).unwrap();
}

/// Velocities of bodies' surfaces are in the bodies' frame: that of a conveyor at 10° points up along it, and what it carries
/// goes along with it where friction bears the slope.
#[test]
fn conveyors_carry_bodies_uphill() {
    let out = folder("uphill");
    let belt = format!("{CONVEYOR}orientation = 10.0\nsurface_velocity = [0.3, 0.0]");
    let text = format!("{BOX}\n{}", parcel(&belt));
    let angle = 10.0_f64.to_radians();
    // On the belt's upper side, 0.1 m left of its middle.
    let (along, up) = (-0.1, 0.045 + 0.02);
    let place =
        [0.4 + along * angle.cos() - up * angle.sin(), 0.055 + along * angle.sin() + up * angle.cos()];
    let parcel = format!("bodies.0.position=[{}, {}]", place[0], place[1]);
    let more = [parcel.as_str(), "bodies.0.orientation=10.0", "time.end=0.4", "grid.size=[0.8, 0.4]"];
    let u = velocity(&run(&text, &more, &quiet(&out)).result);
    println!("{u:?}");
    assert!((u[0] - 0.3 * angle.cos()).abs() < 3e-3 && (u[1] - 0.3 * angle.sin()).abs() < 3e-3, "{u:?}");
    std::fs::remove_dir_all(&out).unwrap();
}

/// A roller in a closed box of fluid: its surface turns, by every way to immerse it, or all of it.
const ROLLER: &str = r#"
grid = { cells = [48, 48], size = [1.2, 1.2] }
sides = { x = "wall", y = "wall" }
fluid = { density = 1.0, nu = 0.1 }
time = { end = 1.0 }
forces = { start = 0.9 }
output = { snapshots = 1, images = false }
[[bodies]]
name = "roller"
shape = { type = "disc", radius = 0.3 }
position = [0.6, 0.6]
"#;

/// A roller whose surface turns has the torque of one that turns as a whole, as every way to immerse it takes surfaces.
#[test]
fn rollers_turn_the_fluid() {
    let out = folder("roller");
    let torque = |text: &str, more: &[&str]| {
        let result = run(text, more, &quiet(&out)).result;
        let load = &result["forces"][0]["load"];
        println!("{more:?}: {:?}", load["mean"][5]);
        load["mean"][5].as_f64().unwrap()
    };
    let whole = format!("{ROLLER}motion = {{ type = \"prescribed\", angle = \"2*t\" }}\n");
    let surface = format!("{ROLLER}motion = \"fixed\"\nsurface_spin = 2.0\n");
    for forcing in ["smooth", "hfdib"] {
        let forcing = format!("coupling.forcing=\"{forcing}\"");
        let [body, own] = [&whole, &surface].map(|text| torque(text, &[&forcing]));
        assert!((own / body - 1.0).abs() < 0.02, "{forcing}: {own} for {body}");
    }
    // Left to itself it is forced smoothly; so are formulas.
    let formula = torque(&surface, &["bodies.0.surface_spin=\"2+0*t\""]);
    assert_eq!(torque(&surface, &[]), torque(&surface, &["coupling.forcing=\"smooth\""]));
    assert!((formula / torque(&whole, &[]) - 1.0).abs() < 1e-5);
    // Velocities through the surface have no effect.
    let blown = surface.replace("surface_spin = 2.0", "surface_velocity = [\"x-2*y\", \"y+2*x\"]");
    assert!((torque(&blown, &[]) / formula - 1.0).abs() < 1e-9);
    std::fs::remove_dir_all(&out).unwrap();
}

/// A run on surfaces that move by formulas is resumed bit for bit, dry and in a fluid.
#[test]
fn moving_surfaces_are_resumed() {
    let belt = format!("{CONVEYOR}surface_velocity = [\"0.5*cos(20*t)\", 0.0]");
    let side = "sides = { x = \"periodic\", y_min = \"wall\", y_max = { type = \"wall\", velocity = [\"0.2*sin(9*t)*(1+x)\", 0.0] } }";
    let text = format!("{side}\n{}", parcel(&belt));
    for air in [&[][..], &AIR] {
        let (whole, halves) = (folder("whole"), folder("halves"));
        let part = |out: &Path, last: &[&str], resume: bool| {
            run(&text, &[air, last].concat(), &Options { resume, ..quiet(out) }).result
        };
        let all = part(&whole, &["time.end=0.1", "output.snapshots=2"], false);
        part(&halves, &["time.end=0.05", "output.snapshots=1"], false);
        let rest = part(&halves, &["time.end=0.1", "output.snapshots=2"], true);
        assert_eq!(all["bodies"], rest["bodies"]);
        assert_eq!(all["ledger"], rest["ledger"]);
        [whole, halves].iter().for_each(|out| std::fs::remove_dir_all(out).unwrap());
    }
}

/// Keys that do not go together are refused by name, by the plan as by the run.
#[test]
fn surfaces_that_cannot_move_are_told() {
    let dry = format!("{BOX}\n{}", parcel(CONVEYOR));
    for (more, told) in [
        ("bodies.0.surface_velocity=[1.0, 0.0]", "bodies.0.surface_velocity"),
        ("bodies.0.surface_spin=1.0", "\"fixed\" or \"prescribed\""),
        ("bodies.1.surface_spin=[1.0, 0.0, 0.0]", "about z only"),
        (
            "contact.planes=[{point=[0.0, 0.0], normal=[0.0, 1.0], velocity=[0.5, 0.1]}]",
            "at a right angle to `normal`",
        ),
        (
            "contact.planes=[{point=[0.0, 0.0], normal=[0.0, 1.0], velocity=[0.0, \"sin(t)\"]}]",
            "at a right angle to `normal`",
        ),
        ("sides.y={type=\"wall\", velocity=[0.0, \"t\"]}", "slides only"),
    ] {
        let found = problems(&dry, more);
        assert!(found.contains(told), "{more}: {found}");
    }
    let still = format!("{ROLLER}motion = \"fixed\"\nsurface_spin = \"sin(t)\"\n");
    let found = problems(&still, "coupling.forcing=\"cut-links\"");
    assert!(found.contains("the surface of body roller moves"), "{found}");
    let steady = format!("{ROLLER}motion = \"fixed\"\n").replace("forces = { start = 0.9 }\n", "");
    for (more, told) in [
        ("bodies.0.surface_spin=2.0", "no surfaces of bodies that move, as that of body roller does"),
        ("sides.y={type=\"wall\", velocity=[\"sin(t)\", 0.0]}", "a steady flow has no time"),
    ] {
        let simple = steady.replace("time = { end = 1.0 }", "flow.algorithm = \"simple\"");
        assert!(problems(&simple, more).contains(told), "{}", problems(&simple, more));
    }
}

/// Keys that the law of contact does not use are warnings of the plan and of the run.
#[test]
fn keys_that_a_law_ignores_are_told() {
    let text = format!("{BOX}\n{}", parcel(CONVEYOR));
    let cases = [
        (
            vec!["materials.m.restitution=0.5"],
            "materials.m.restitution is not used by contact.law = \"chen\"",
        ),
        (
            vec!["contact.law=\"potential\"", "materials.m.damping=0.5", "contact.adhesion=true"],
            "materials.m.damping, contact.adhesion is not used by contact.law = \"potential\"",
        ),
        (
            vec!["contact.law=\"potential\"", "materials.m.rolling_friction=0.5"],
            "materials.m.rolling_friction is not used",
        ),
        (vec!["contact.law=\"rolling\"", "materials.m.restitution=0.5"], "restitution is not used"),
        (vec!["contact.law=\"none\""], "materials.m.youngs_modulus, materials.m.friction is not used"),
        (
            vec!["contact.law=\"potential\"", "materials.m.restitution=0.0"],
            "materials.m.restitution is below 0.002 and counts as 0.002",
        ),
    ];
    for (more, told) in &cases {
        let warnings = plan(&text, more).warnings;
        assert!(warnings.iter().any(|w| w.contains(told)), "{more:?}: {warnings:?}");
    }
    let out = folder("ignored");
    run(&text, &["materials.m.restitution=0.5", "time.end=0.01"], &quiet(&out));
    let log = std::fs::read_to_string(out.join("run.log")).unwrap();
    assert!(log.contains(cases[0].1), "{log}");
    for more in ["contact.law=\"potential\"", "materials.m.friction=0.4"] {
        let all = plan(&text, &[more]).warnings;
        assert!(!all.iter().any(|w| w.contains("is not used")), "{all:?}");
    }
    std::fs::remove_dir_all(&out).unwrap();
}
