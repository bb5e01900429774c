//! Bodies that enter and leave through open sides of the box.
use crate::{folder, problems, quiet, run};
use scene::{Options, Scene};
use serde_json::Value;
use std::sync::atomic::AtomicBool;

/// A disc falls out of a box whose lower and upper sides are of given pressure.
const FALL: &str = r#"
gravity = [0.0, -9.81]
[grid]
cells = [32, 48]
size = [4e-3, 6e-3]
[sides]
x = "wall"
y_min = { type = "pressure" }
y_max = { type = "pressure" }
[fluid]
density = 1000.0
nu = 1e-6
[[bodies]]
name = "disc"
shape = { type = "disc", radius = 5e-4 }
density = 1200.0
position = [2e-3, 2e-3]
[[exits]]
point = [0.0, 0.0]
normal = [0.0, 1.0]
[time]
end = 0.12
[output]
snapshots = 60
images = false
fields = false
"#;

/// Bodies come in with the flow of a channel and leave with it.
const CHANNEL: &str = r#"
[grid]
cells = [60, 20]
size = [0.12, 0.04]
[sides]
x_min = { type = "inlet", peak = 0.1 }
x_max = "outlet"
y = "wall"
[fluid]
density = 1000.0
nu = 1e-5
[[factories]]
type = "inflow"
shape = { type = "disc", radius = 0.005 }
density = 1010.0
rate = 4.0
region = { lower = [0.0, 0.0], upper = [0.012, 0.04] }
velocity = [0.07, 0.0]
[[exits]]
point = [0.12, 0.0]
normal = [-1.0, 0.0]
[time]
end = 2.5
[output]
snapshots = 10
images = false
fields = false
"#;

fn number(result: &Value, pointer: &str) -> f64 {
    result.pointer(pointer).and_then(Value::as_f64).unwrap_or(f64::NAN)
}

fn result(text: &str, name: &str, more: &[&str]) -> Value {
    let out = folder(name);
    let result = run(text, more, &quiet(&out)).result;
    std::fs::remove_dir_all(&out).unwrap();
    result
}

fn warnings(text: &str, more: &[&str]) -> String {
    let more: Vec<String> = more.iter().map(|s| (*s).into()).collect();
    Scene::parse("scene.toml", text, &more).unwrap().plan().unwrap().warnings.join("\n")
}

/// Wherever the exit is, whatever the side and the shape: bodies go, and momentum is that of the impulses.
#[test]
fn an_exit_at_a_side_acts() {
    let square = "factories.0={type=\"inflow\",shape={type=\"box\",edges=[0.01,0.008]},density=1010.0,rate=4.0,velocity=[0.07,0.0],region={lower=[0.0,0.0],upper=[0.016,0.04]}}";
    let pressure = "sides.x_max={type=\"pressure\"}";
    for (name, text, more) in [
        ("fall", FALL, &[][..]),
        ("fall-beyond", FALL, &["exits.0.point=[0.0,-2e-4]"]),
        ("fall-inside", FALL, &["exits.0.point=[0.0,1e-4]"]),
        ("channel", CHANNEL, &[]),
        ("channel-pressure", CHANNEL, &[pressure]),
        ("channel-box", CHANNEL, &[square]),
        ("channel-beyond", CHANNEL, &["exits.0.point=[0.127,0.0]"]),
        ("channel-oblique", CHANNEL, &["exits.0={point=[0.12,0.02],normal=[-1.0,0.5]}"]),
        ("channel-partly", CHANNEL, &["factories.0.region={lower=[-0.008,0.0],upper=[0.008,0.04]}"]),
        ("channel-before", CHANNEL, &["factories.0.region={lower=[-0.014,0.0],upper=[-0.001,0.04]}"]),
        ("channel-hfdib", CHANNEL, &["coupling.forcing=\"hfdib\"", "factories.0.density=4000.0", pressure]),
        ("channel-hfdib-outlet", CHANNEL, &["coupling.forcing=\"hfdib\"", "factories.0.density=4000.0"]),
        ("channel-heat", CHANNEL, &["scalars.heat={diffusivity=1e-5,bodies=1.0}"]),
        ("channel-sst", CHANNEL, &["turbulence=\"sst\"", pressure]),
    ] {
        let found = result(text, name, more);
        let left = number(&found, "/turnover/left");
        assert!(left >= 1.0, "{name}: {left} left");
        let momentum = number(&found, "/ledger/momentum_whole_run");
        assert!(momentum < 1e-12, "{name}: {momentum}");
        let step = number(&found, "/ledger/momentum_worst_step");
        assert!(step < 1e-6, "{name}: {step}");
    }
}

/// A sphere and a hull in space.
#[test]
fn an_exit_at_a_side_acts_in_space() {
    let text = CHANNEL
        .replace("[60, 20]", "[40, 15, 15]")
        .replace("[0.12, 0.04]", "[0.08, 0.03, 0.03]")
        .replace("y = \"wall\"", "y = \"wall\"\nz = \"symmetry\"")
        .replace("\"disc\"", "\"sphere\"")
        .replace("0.012, 0.04]", "0.012, 0.03, 0.03]")
        .replace("lower = [0.0, 0.0]", "lower = [-0.004, 0.0, 0.0]")
        .replace("velocity = [0.07, 0.0]", "velocity = [0.07, 0.0, 0.0]")
        .replace("point = [0.12, 0.0]", "point = [0.08, 0.0, 0.0]")
        .replace("normal = [-1.0, 0.0]", "normal = [-1.0, 0.0, 0.0]")
        .replace("end = 2.5", "end = 0.5");
    let early = |shape: &str| {
        format!(
            "bodies=[{{shape={shape},density=1010.0,position=[0.06,0.015,0.015],velocity=[0.07,0.0,0.0]}}]"
        )
    };
    let sphere = early("{type=\"sphere\",radius=0.005}");
    let hull = early("{type=\"box\",edges=[0.01,0.012,0.0105]}");
    for (name, more) in
        [("sphere", &[sphere.as_str()][..]), ("hull", &[&hull, "sides.x_max={type=\"pressure\"}"])]
    {
        let found = result(&text, name, more);
        assert!(number(&found, "/turnover/left") >= 1.0, "{name}: {}", found["turnover"]);
        assert!(number(&found, "/ledger/momentum_whole_run") < 1e-12, "{name}: {}", found["ledger"]);
    }
}

/// Fluid inside a body that passes the side with it does not act on it: it passes with the speed that it had. (With the whole momentum inside in its load it lost 22 % on its way to an exit at the
/// side, and 32 % to one beyond it.)
#[test]
fn a_body_passes_an_open_side_at_its_speed() {
    let body = "bodies=[{shape={type=\"disc\",radius=0.005},density=1010.0,position=[0.08,0.02],velocity=[0.08,0.0]}]";
    for (name, side) in
        [("pass-pressure", "sides.x_max={type=\"pressure\"}"), ("pass-outlet", "sides.x_max=\"outlet\"")]
    {
        let out = folder(name);
        let set =
            [body, side, "factories=[]", "exits.0.point=[0.127,0.0]", "time.end=0.7", "output.snapshots=140"];
        run(CHANNEL, &set, &quiet(&out));
        let table = std::fs::read_to_string(out.join("trajectories.csv")).unwrap();
        std::fs::remove_dir_all(&out).unwrap();
        let rows = table
            .lines()
            .skip(2)
            .map(|row| row.split(',').map(|x| x.parse().unwrap_or(0.0)).collect::<Vec<f64>>());
        let speeds: Vec<[f64; 2]> = rows.map(|row| [row[2], row[5]]).collect();
        let before = speeds.iter().rfind(|[x, _]| *x < 0.112).unwrap()[1];
        let [last, after] = *speeds.last().unwrap();
        assert!(last > 0.124, "{name}: {last}");
        assert!((after / before - 1.0).abs() < 0.03, "{name}: {before} {after}");
    }
}

/// Cut while a body is half outside, a run goes on bit for bit.
#[test]
fn a_run_goes_on_while_a_body_is_half_outside() {
    let more = ["exits.0.point=[0.0,-4e-4]", "output.snapshots=8", "time.end=0.125"];
    let [whole, halves] = [0, 1].map(|_| folder("half-outside"));
    let part = |out: &std::path::Path, last: &[&str], resume: bool| {
        run(FALL, &[&more, last].concat(), &Options { resume, ..quiet(out) }).result
    };
    let all = part(&whole, &[], false);
    let first = part(&halves, &["time.end=0.09375", "output.snapshots=6"], false);
    let y = number(&first, "/bodies/0/position/1");
    assert!(y.abs() < 5e-4, "{y}");
    assert_eq!(all, part(&halves, &[], true));
    assert_eq!(number(&all, "/turnover/left"), 1.0);
    [whole, halves].iter().for_each(|out| std::fs::remove_dir_all(out).unwrap());
}

/// The plan says which exits never act, and where an exit is missing.
#[test]
fn the_plan_tells_of_exits() {
    let walls = "sides.y_min=\"wall\"";
    for (text, more, expected) in [
        (FALL, &[walls][..], "exits.0 never acts: y_min is a wall"),
        (
            FALL,
            &["sides.y_min=\"symmetry\"", "exits.0.point=[0.0,-1e-3]"],
            "exits.0 never acts: y_min is a wall",
        ),
        (FALL, &["exits.0.point=[0.0,-1e-2]"], "1.000e-2 m beyond the side y_min"),
        (FALL, &["exits.0.normal=[0.0,-1.0]"], "holds the centres of 1 bodies at the start"),
        (
            FALL,
            &["exits.0={point=[3.9e-3,0.0],normal=[-1.0,0.0]}", "sides.x=\"periodic\""],
            "periodic axis x",
        ),
        (CHANNEL, &["exits=[]"], "no exit is ahead of the open side x_max"),
        (
            CHANNEL,
            &["exits.0.point=[0.2,0.0]", "exits.0.normal=[1.0,0.0]"],
            "factories.0 is all inside exits.0",
        ),
    ] {
        let found = warnings(text, more);
        assert!(found.contains(expected), "{more:?}: {found}");
    }
    // No warning of exits that act; without contact a body comes to the wall.
    for (text, more) in [(FALL, &[][..]), (CHANNEL, &[]), (FALL, &[walls, "contact.law=\"none\""])] {
        let found = warnings(text, more);
        assert!(!found.contains("exits.") && !found.contains("exit is ahead"), "{more:?}: {found}");
    }
}

/// Regions beyond sides that bodies cannot pass, or from where they do not come in, are refused; so are those without room.
#[test]
fn regions_from_where_nothing_comes_in_are_refused() {
    let region = |x: &str, y: &str| format!("factories.0.region={{lower=[{x},{y}],upper=[0.012,0.04]}}");
    let found = problems(CHANNEL, &region("0.0", "-0.01"));
    assert!(found.contains("beyond the side y_min, which bodies cannot pass"), "{found}");
    let back = CHANNEL.replace("velocity = [0.07", "velocity = [0.0");
    let found = problems(&back, &region("-0.01", "0.0"));
    assert!(found.contains("give a velocity above 0 inwards"), "{found}");
    let found = problems(CHANNEL, "factories.0.region={lower=[0.0,0.0],upper=[0.008,0.04]}");
    assert!(found.contains("take a smaller body or a larger region"), "{found}");
}

/// With no exit ahead the run ends once all of the body is outside, and says what is missing.
#[test]
fn a_body_with_no_exit_ahead_is_told() {
    let out = folder("no-exit");
    let exit = "exits=[{point=[0.0,-1.0],normal=[0.0,1.0]}]";
    let scene = Scene::parse("scene.toml", CHANNEL, &[exit.into()]).unwrap();
    let told = scene.run(&quiet(&out), &AtomicBool::new(false)).err().unwrap().to_string();
    let _ = std::fs::remove_dir_all(&out);
    assert!(told.contains("no exit is ahead of the body") && told.contains("factories.0: body "), "{told}");
}
