//! Parts of loads, coefficients along surfaces, starts from fields and boxes that follow bodies.
use crate::{folder, problems, quiet, run};
use mor::snapshots::VtkFile;
use scene::{Options, Scene};
use serde_json::Value;
use std::f64::consts::{PI, TAU};
use std::path::Path;

fn number(result: &Value, pointer: &str) -> f64 {
    result.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer}: {result:#}"))
}

/// Rows of a CSV file below its header, without the columns that are names.
fn rows(path: &Path) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(path).unwrap();
    let lines = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    lines.map(|line| line.split(',').filter_map(|x| x.parse().ok()).collect()).collect()
}

/// The cylinder of Schäfer & Turek (1996) at Re 20, 16 cells wide.
const CYLINDER: &str = r#"
grid = { cells = [160, 66], size = [1.0, 0.41] }
sides = { x_min = { type = "inlet", peak = 0.3 }, x_max = "pressure", y = "wall" }
fluid = { density = 1.0, nu = 1e-3 }
flow = { convection = "quick" }
time = { end = 4.0 }
output = { snapshots = 1, images = false, fields = false, report = false }
forces = { velocity = 0.2, area = 0.1, start = 3.9, every = 0.5, parts = true, surfaces = true }
[[bodies]]
name = "cylinder"
shape = { type = "disc", radius = 0.05 }
position = [0.2, 0.2]
motion = "fixed"
"#;

/// Pressure and friction add up to the load; the difference of pressure from front to rear is
/// 0.1175 Pa.
#[test]
fn loads_have_pressure_and_friction() {
    for (algorithm, most) in [("projection", 0.015), ("simple", 1e-9)] {
        let out = folder("parts");
        let choice = format!("flow.algorithm=\"{algorithm}\"");
        let result = run(CYLINDER, &[&choice], &quiet(&out)).result;
        let of = |part: &str| number(&result, &format!("/forces/0/{part}/last/0"));
        let (load, pressure, friction) = (of("load"), of("pressure"), of("friction"));
        assert!(
            ((pressure + friction) / load - 1.0).abs() < most,
            "{algorithm}: {pressure} {friction} {load}"
        );
        // About 64 % of the drag is pressure.
        assert!((0.62..0.66).contains(&(pressure / load)), "{algorithm}: {}", pressure / load);
        let drag = number(&result, "/forces/0/coefficients/last/0");
        assert!((drag / 5.5795 - 1.0).abs() < 0.01, "{algorithm}: {drag}");
        let last = rows(&out.join("forces.csv")).pop().unwrap();
        assert_eq!(last.len(), 13, "{last:?}");
        assert!(((last[7] + last[10]) / last[1] - 1.0).abs() < most, "{last:?}");

        let surface = rows(&out.join("surfaces/cylinder.csv"));
        let end = surface.last().unwrap()[0];
        let surface: Vec<_> = surface.into_iter().filter(|row| row[0] == end).collect();
        let at = |angle: f64| {
            let far = |row: &&Vec<f64>| (row[1] - angle).sin().hypot((row[1] - angle).cos() - 1.0);
            surface.iter().min_by(|a, b| far(a).total_cmp(&far(b))).unwrap()
        };
        let (front, rear) = (at(PI), at(0.0));
        assert!(((front[4] - rear[4]) / 0.1175 - 1.0).abs() < 0.06, "{algorithm}: {front:?} {rear:?}");
        for row in &surface {
            let [_, angle, x, y, p, tau, cp, cf] = row[..] else { panic!("{row:?}") };
            assert!(((x - 0.2).hypot(y - 0.2) - 0.05).abs() < 1e-6);
            let direction = [(x - 0.2) / 0.05 - angle.cos(), (y - 0.2) / 0.05 - angle.sin()];
            assert!(direction.iter().all(|d| d.abs() < 1e-6), "{row:?}");
            assert!((cp - 50.0 * p).abs() < 1e-6 && (cf - 50.0 * tau).abs() < 1e-6, "{row:?}");
        }
        // The fluid passes from the front to the rear on both sides.
        assert!(at(0.75 * PI)[5] < 0.0 && at(-0.75 * PI)[5] > 0.0, "{algorithm}");
        std::fs::remove_dir_all(&out).unwrap();
    }
}

#[test]
fn parts_are_of_sharp_walls_alone() {
    let smooth = problems(CYLINDER, "coupling.forcing=\"smooth\"");
    assert!(smooth.contains("forces.parts") && smooth.contains("cut links"), "{smooth}");
    let no_speed = problems(CYLINDER, "forces={surfaces=true}");
    assert!(no_speed.contains("forces.surfaces") && no_speed.contains("give `velocity`"), "{no_speed}");
}

const VORTEX: &str = r#"
grid = { cells = [16, 16], size = ["2*PI", "2*PI"] }
sides = { x = "periodic", y = "periodic" }
fluid = { density = 1.0, nu = 0.1 }
initial = { velocity = ["sin(x)*cos(y)", "-cos(x)*sin(y)"] }
time = { steps = 2, dt = 0.01 }
output = { snapshots = 1, images = false, report = false }
"#;

/// Values between centres are means: the velocity at the centres is that of the file by cos²(h/2),
/// also across periodic sides; on a grid twice as fine by cos(h/2) cos²(h/4) within round-off of
/// single precision at places that are not between the same cells.
#[test]
fn a_run_starts_from_the_field_of_another() {
    let out = folder("start");
    run(VORTEX, &[], &quiet(&out.join("first")));
    let first = VtkFile::open(out.join("first/fields/00000.vti")).unwrap().field("velocity").unwrap();
    let text = VORTEX
        .replace("velocity = [\"sin(x)*cos(y)\", \"-cos(x)*sin(y)\"]", "file = \"first/fields/00000.vti\"");
    let scene = |more: &str| {
        let name = out.join("scene.toml");
        Scene::parse(&name.to_string_lossy(), &text, &[more.to_owned()])
    };
    let stop = std::sync::atomic::AtomicBool::new(false);
    scene("title=\"same\"").unwrap().run(&quiet(&out.join("second")), &stop).unwrap();
    let second = VtkFile::open(out.join("second/fields/00000.vti")).unwrap().field("velocity").unwrap();
    let factor = (PI / 16.0).cos().powi(2);
    let worst = first.iter().zip(&second).map(|(a, b)| (b - factor * a).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-6, "{worst}");
    scene("grid.cells=[32, 32]").unwrap().run(&quiet(&out.join("fine")), &stop).unwrap();
    let fine = VtkFile::open(out.join("fine/fields/00000.vti")).unwrap().field("velocity").unwrap();
    let h = TAU / 32.0;
    for cell in 0..1024 {
        let [x, y] = [cell % 32, cell / 32].map(|i| (f64::from(i) + 0.5) * h);
        let exact = x.sin() * y.cos();
        // Linear interpolation is off by (2h)²/8 of the second derivative along each axis.
        assert!((fine[cell as usize] - exact).abs() < 2.5 * h * h, "{x} {y}");
    }
    let told = |more: &str| scene(more).err().map(|e| e.to_string()).unwrap_or_default();
    for (change, parts) in [
        ("grid.size=[7.0, 6.0]", &["initial.file", "00000.vti", "along x", "covers the box"][..]),
        ("initial.velocity=[0.0, 0.0]", &["initial.file", "leave out one of the two"]),
        ("initial.file=\"nowhere.vti\"", &["nowhere.vti"]),
    ] {
        let told = told(change);
        assert!(parts.iter().all(|part| told.contains(part)), "{change}: {told}");
    }
    let spatial =
        text.replace("cells = [16, 16], size = [\"2*PI\", \"2*PI\"]", "cells = [8, 8, 8], size = [1, 1, 1]");
    let spatial = spatial.replace("y = \"periodic\"", "y = \"periodic\", z = \"periodic\"");
    let told =
        Scene::parse(&out.join("scene.toml").to_string_lossy(), &spatial, &[]).err().unwrap().to_string();
    assert!(told.contains("do not go together"), "{told}");
    std::fs::remove_dir_all(&out).unwrap();
}

/// A disc that sinks in water, in a box 12 diameters tall that follows it.
const SINKING: &str = r#"
gravity = [0.0, -9.81]
grid = { cells = [48, 96], size = [6e-3, 12e-3] }
sides = { x = "periodic", y_min = "wall", y_max = "outlet" }
fluid = { density = 1000.0, nu = 1e-6 }
window = { body = "disc", axis = "y", place = 0.4 }
time = { end = 0.15 }
output = { snapshots = 2, images = false, report = false }
[[bodies]]
name = "disc"
shape = { type = "disc", radius = 5e-4 }
density = 1300.0
position = [3.1e-3, 4.8e-3]
"#;

#[test]
fn the_box_follows_a_body() {
    let out = folder("window");
    let result = run(SINKING, &[], &quiet(&out)).result;
    let y = number(&result, "/bodies/0/position/1");
    // Below the place where the box began.
    assert!(y < 1e-3, "{y}");
    assert!(result.get("ledger").is_none());
    let (h, start) = (1.25e-4, 0.5 * 1.25e-4);
    let grid = VtkFile::open(out.join("fields/00002.vti")).unwrap().grid().unwrap();
    let moved = ((grid.first().y - start) / h).round();
    assert!((grid.first().y - start - moved * h).abs() < 1e-9 && moved <= -30.0, "{moved}");
    assert!(((y - 4.8e-3) / h - moved).abs() <= 1.0, "{y} {moved}");
    let resumed = folder("window-resumed");
    run(SINKING, &["time.end=0.075", "output.snapshots=1"], &quiet(&resumed));
    let options = Options { resume: true, ..quiet(&resumed) };
    let again = run(SINKING, &[], &options).result;
    assert_eq!((&again["bodies"], &again["flow"]), (&result["bodies"], &result["flow"]));
    for out in [out, resumed] {
        std::fs::remove_dir_all(&out).unwrap();
    }
    for (change, part) in [
        ("window.axis=\"x\"", "x is periodic"),
        ("window.body=\"ball\"", "no body \"ball\" moves"),
        ("flow.algorithm=\"simple\"", "leave this out"),
        ("lines=[{name=\"l\", from=[0,0], to=[1e-3,0]}]", "`lines` cannot follow the box"),
    ] {
        let told = problems(SINKING, change);
        assert!(told.contains("window") && told.contains(part), "{change}: {told}");
    }
}
