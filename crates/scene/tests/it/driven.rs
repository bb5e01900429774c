//! Flows at a given flow rate, ends before the time, and what is written of fields.
use crate::{folder, problems, quiet, run};
use mor::snapshots::VtkFile;
use scene::{Ending, Options};
use serde_json::Value;
use std::path::Path;

fn number(result: &Value, pointer: &str) -> f64 {
    result.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer}: {result:#}"))
}

/// Rows of a CSV file below its header.
fn rows(path: &Path) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(path).unwrap();
    let lines = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    lines.map(|line| line.split(',').map(|x| x.parse().unwrap()).collect()).collect()
}

/// A channel 1 m high with a mean velocity of 0.5 m/s.
const CHANNEL: &str = r#"
grid = { cells = [4, 20], size = [0.2, 1.0] }
sides = { x = "periodic", y = "wall" }
fluid = { density = 2.0, nu = 0.1 }
flow_rate = { axis = "x", velocity = 0.5 }
time = { end = 20.0, dt = 0.01 }
output = { snapshots = 1, images = false, fields = false, report = false }
"#;

/// f = 12 ν U/H², less the share 1/(2N²) by which the mean over N cells exceeds the integral of the
/// parabola, which is exact at the nodes: with and without a force that is given besides, by either
/// treatment of diffusion and by PISO.
#[test]
fn the_force_of_a_flow_rate_is_that_of_the_channel() {
    let exact = 12.0 * 0.1 * 0.5 / (1.0 + 0.5 / 400.0);
    for (change, most) in [
        (&[][..], 1e-9),
        (&["flow.diffusion=\"implicit\"", "time.dt=0.05"], 1e-9),
        (&["force=[0.3, 0.0]"], 1e-9),
        (&["flow.algorithm=\"piso\"", "time.dt=0.05"], 1e-5),
    ] {
        let out = folder("channel");
        let result = run(CHANNEL, change, &quiet(&out)).result;
        let force = number(&result, "/body_force/0");
        assert!((force / exact - 1.0).abs() < most, "{change:?}: {force}, exact {exact}");
        let mean = number(&result, "/flow/mean_velocity/0");
        assert!((mean - 0.5).abs() < most, "{change:?}: {mean}");
        let last = rows(&out.join("history.csv")).pop().unwrap();
        let [mean, force] = last[last.len() - 2..] else { panic!("{last:?}") };
        assert!((mean - 0.5).abs() < most && (force / exact - 1.0).abs() < most, "{last:?}");
        std::fs::remove_dir_all(&out).unwrap();
    }
}

/// With a plug of no resistance the mean velocity follows a formula step by step.
#[test]
fn a_flow_rate_follows_a_formula() {
    let out = folder("formula");
    let change = [
        "sides.y=\"symmetry\"",
        "flow_rate.velocity=\"0.5*sin(t)\"",
        "time={end=2.0, dt=0.05}",
        "fluid.nu=0.0",
    ];
    let result = run(CHANNEL, &change, &quiet(&out)).result;
    assert!((number(&result, "/flow/mean_velocity/0") - 0.5 * 2.0_f64.sin()).abs() < 1e-13);
    let force = 0.5 * (2.0_f64.sin() - 1.95_f64.sin()) / 0.05;
    assert!((number(&result, "/body_force/0") - force).abs() < 1e-11);
    std::fs::remove_dir_all(&out).unwrap();
}

/// A row of discs across a periodic box.
const ARRAY: &str = r#"
grid = { cells = [32, 32], size = [1.0, 1.0] }
sides = { x = "periodic", y = "periodic" }
fluid = { density = 1.0, nu = 0.1 }
flow_rate = { axis = "x", velocity = 0.1 }
time = { end = 3.0 }
output = { snapshots = 2, images = false, fields = false, report = false }
coupling = { forcing = "smooth" }
forces = {}
[[bodies]]
shape = { type = "disc", radius = 0.2 }
position = [0.5, 0.5]
motion = "fixed"
"#;

/// Bodies take the force on the whole box; momentum and energy are accounted for; a resumed run has
/// the same bits.
#[test]
fn a_flow_rate_is_held_past_bodies() {
    let out = folder("array");
    let result = run(ARRAY, &[], &quiet(&out)).result;
    let (force, mean) = (number(&result, "/body_force/0"), number(&result, "/flow/mean_velocity/0"));
    assert!((mean / 0.1 - 1.0).abs() < 1e-6, "{mean}");
    // With the force of the mean pressure gradient on its own volume.
    let load = number(&result, "/forces/0/load/last/0");
    assert!((load / force - 1.0).abs() < 1e-6, "load {load}, force {force}");
    let l = &result["ledger"];
    assert!(l["momentum_whole_run"].as_f64().unwrap().abs() < 1e-9, "{l:#}");
    let (work, residual) = (l["work"].as_f64().unwrap(), l["energy_residual"].as_f64().unwrap());
    assert!(work > 0.0 && residual.abs() < 0.02 * work, "{l:#}");
    let resumed = folder("array-resumed");
    run(ARRAY, &["time.end=1.5", "output.snapshots=1"], &quiet(&resumed));
    let options = Options { resume: true, ..quiet(&resumed) };
    let again = run(ARRAY, &[], &options).result;
    assert_eq!(again["body_force"], result["body_force"]);
    assert_eq!(again["flow"], result["flow"]);
    for out in [out, resumed] {
        std::fs::remove_dir_all(&out).unwrap();
    }
}

/// Decay of a channel's flow at the rate ν(π/H)²: the run ends when the rate of change is below.
#[test]
fn a_steady_flow_ends_the_run() {
    let out = folder("steady");
    let stop = "time={end=50.0, dt=0.01, stop={steady=1e-4}}";
    let ran = run(CHANNEL, &[stop], &quiet(&out));
    assert_eq!((ran.ending, ran.result["ending"].as_str()), (Ending::Steady, Some("steady")));
    assert_eq!(ran.result["complete"], true);
    let time = number(&ran.result, "/time");
    assert!(time > 1.0 && time < 20.0, "{time}");
    // A tenth of the tolerance takes ln 10/(ν(2π/H)²) longer at the slowest mode of no flow rate.
    let options = Options { resume: true, ..quiet(&out) };
    let again = run(CHANNEL, &["time={end=50.0, dt=0.01, stop={steady=1e-5}}"], &options);
    let longer = number(&again.result, "/time") - time;
    assert_eq!(again.ending, Ending::Steady);
    assert!(longer > 0.1 && longer < 2.0, "{longer}");
    // Nothing is left to do.
    let third = run(CHANNEL, &["time={end=50.0, dt=0.01, stop={steady=1e-5}}"], &options);
    assert_eq!(third.result["steps"], again.result["steps"]);
    std::fs::remove_dir_all(&out).unwrap();
}

/// A ball that falls without a fluid.
const BALL: &str = r#"
gravity = [0.0, -9.81]
grid = { cells = [10, 40], size = [0.5, 2.0] }
sides = { x = "wall", y = "wall" }
time = { end = 1.0, dt = 1e-4, stop = { event = "1.0 - y", body = "ball" } }
output = { snapshots = 4, images = false }
[[bodies]]
name = "ball"
shape = { type = "disc", radius = 0.05 }
position = [0.25, 1.5]
"#;

#[test]
fn an_event_ends_the_run() {
    let out = folder("event");
    let ran = run(BALL, &[], &quiet(&out));
    assert_eq!((ran.ending, ran.result["ending"].as_str()), (Ending::Event, Some("event")));
    let fall = (2.0 * 0.5 / 9.81_f64).sqrt();
    let time = number(&ran.result, "/time");
    assert!(time >= fall - 1e-4 && time < fall + 2e-4, "{time}, exact {fall}");
    let energy =
        run(BALL, &["time.stop={event=\"energy - 20\"}"], &Options { overwrite: true, ..quiet(&out) });
    // m g h = 20 J with m = 1000 π r².
    let fall = (2.0 * 20.0 / (1000.0 * std::f64::consts::PI * 0.0025)).sqrt() / 9.81;
    let time = number(&energy.result, "/time");
    assert!((time - fall).abs() < 3e-4, "{time}, exact {fall}");
    std::fs::remove_dir_all(&out).unwrap();
}

/// u = sin x cos y, v = −cos x sin y, whose vorticity is 2 sin x sin y, and Q by the same
/// derivatives; lines sample the same flow.
const VORTEX: &str = r#"
grid = { cells = [32, 32], size = ["2*PI", "2*PI"] }
sides = { x = "periodic", y = "periodic" }
fluid = { density = 1.0, nu = 0.1 }
initial = { velocity = ["sin(x)*cos(y)", "-cos(x)*sin(y)"] }
time = { steps = 2, dt = 0.01 }
output = { snapshots = 1, images = false, fields = ["vorticity", "q_criterion"], report = false }
lines = [{ name = "middle", from = [0.0, "PI/2"], to = ["PI", "PI/2"], points = 5 }]
"#;

#[test]
fn vorticity_q_and_lines_are_those_of_the_flow() {
    let out = folder("vortex");
    run(VORTEX, &[], &quiet(&out));
    let file = VtkFile::open(out.join("fields/00000.vti")).unwrap();
    let names: Vec<&str> = file.arrays().iter().map(|a| a.name.as_str()).collect();
    assert_eq!(names, ["lambda", "vorticity", "q_criterion"]);
    let [vorticity, q] = ["vorticity", "q_criterion"].map(|name| file.field(name).unwrap());
    let h = std::f64::consts::TAU / 32.0;
    // Of the mean of two faces, and of central differences.
    let factor = (0.5 * h).cos() * h.sin() / h;
    for (cell, (w, q)) in vorticity.iter().zip(&q).enumerate() {
        let [x, y] = [cell % 32, cell / 32].map(|i| (i as f64 + 0.5) * h);
        let (ux, uy) = (factor * x.cos() * y.cos(), -factor * x.sin() * y.sin());
        assert!((w + 2.0 * uy).abs() < 1e-6, "{cell}: {w}");
        // −(u_x² + v_y² + 2 u_y v_x)/2 with v_y = −u_x, v_x = −u_y.
        assert!((q - (uy * uy - ux * ux)).abs() < 1e-6, "{cell}: {q}");
    }
    let line = rows(&out.join("lines/middle.csv"));
    assert_eq!(line.len(), 10);
    for (i, row) in line.iter().take(5).enumerate() {
        let s = std::f64::consts::PI * i as f64 / 4.0;
        let [time, along, x, y, u, v, _] = row[..] else { panic!("{row:?}") };
        assert!(time == 0.0 && (along - s).abs() < 1e-9 && (x - s).abs() < 1e-9 && y > 1.57);
        assert!(u.abs() < 1e-9 && (v + s.cos()).abs() < 0.01, "{row:?}");
    }
    std::fs::remove_dir_all(&out).unwrap();
}

#[test]
fn what_does_not_go_together_is_told() {
    for (text, change, parts) in [
        (CHANNEL, "flow_rate.axis=\"y\"", &["flow_rate.axis", "y is not periodic"][..]),
        (CHANNEL, "flow_rate.axis=\"z\"", &["no axis z"]),
        (CHANNEL, "flow.algorithm=\"simple\"", &["flow_rate", "give `force`"]),
        (CHANNEL, "coupling.balance=\"zero-flow\"", &["flow_rate", "leave out one of the two"]),
        (CHANNEL, "time.stop={}", &["time.stop", "Give `steady` or `event`"]),
        (CHANNEL, "time.stop={event=\"0.1-y\"}", &["time.stop.event", "y is that of a body"]),
        (BALL, "time.stop.body=\"bal\"", &["no body \"bal\"", "ball"]),
        (BALL, "time.stop={steady=1e-3}", &["time.stop.steady", "no `fluid`"]),
        (BALL, "output.fields=[\"vorticity\"]", &["without `fluid` there are no fields"]),
        (VORTEX, "output.fields=\"vorticity\"", &["true or false or a list"]),
        (VORTEX, "output.fields=[\"vortex\"]", &["known are: velocity, pressure, scalars"]),
        (VORTEX, "lines.0.to=[0.0, \"PI/2\"]", &["lines.0.to", "same point"]),
        (CHANNEL, "lines=[{name=\"up\", from=[0,0], to=[0,2]}]", &["lines.0.to", "2 m along y is outside"]),
    ] {
        let told = problems(text, change);
        assert!(parts.iter().all(|part| told.contains(part)), "{change}: {told}");
    }
}
