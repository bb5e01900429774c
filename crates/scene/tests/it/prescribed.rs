//! Walls, inlets and bodies whose motion is given over time, by formulas or files.
use crate::{folder, quiet, run};
use scene::{Options, Scene};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

fn number(result: &Value, pointer: &str) -> f64 {
    result.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer}: {result:#}"))
}

/// Stokes' second problem with a penetration depth of 0.1 m.
const STOKES: &str = r#"
grid = { cells = [4, 100], size = [0.04, 1.0] }
sides = { x = "periodic", y_min = { type = "wall", velocity = ["cos(2*PI*t)", 0.0] }, y_max = "wall" }
fluid = { density = 1.0, nu = "0.01*PI" }
initial = { velocity = ["exp(-10*y)*cos(10*y)", 0.0] }
time = { end = 1.3 }
output = { snapshots = 1, images = false, fields = false, report = false }
probes = [{ name = "layer", points = [[0.02, 0.055], [0.02, 0.105], [0.02, 0.205], [0.02, 0.305]] }]
"#;

/// u = exp(−y/δ) cos(ωt − y/δ) for either treatment of diffusion and by PISO.
#[test]
fn an_oscillating_wall_drives_stokes_second_problem() {
    for (change, most) in [
        (&["flow.diffusion=\"explicit\""][..], 1e-3),
        (&["flow.diffusion=\"implicit\"", "time.dt=0.005"], 1e-3),
        (&["flow.algorithm=\"piso\"", "time.dt=0.001"], 3e-3),
    ] {
        let out = folder("stokes");
        let result = run(STOKES, change, &quiet(&out)).result;
        std::fs::remove_dir_all(&out).unwrap();
        for (i, y) in [0.055, 0.105, 0.205, 0.305_f64].into_iter().enumerate() {
            let exact = (-10.0 * y).exp() * (std::f64::consts::TAU * 1.3 - 10.0 * y).cos();
            let found = number(&result, &format!("/probes/0/points/{i}/velocity/0"));
            assert!((found - exact).abs() < most, "{change:?} at y = {y}: {found}, exact {exact}");
        }
    }
}

/// A scene in a folder of its own, next to `file`.
struct WithFile {
    folder: PathBuf,
    text: String,
}

impl WithFile {
    fn new(text: &str, file: &str, content: &str) -> Self {
        let folder = folder("with-file");
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join(file), content).unwrap();
        Self { folder, text: text.into() }
    }
    fn scene(&self, more: &[&str]) -> Result<Scene, scene::Problems> {
        let name = self.folder.join("scene.toml");
        let more: Vec<String> = more.iter().map(|s| (*s).into()).collect();
        Scene::parse(&name.to_string_lossy(), &self.text, &more)
    }
    fn run(&self, more: &[&str]) -> Value {
        let options = quiet(&self.folder.join("out"));
        self.scene(more).unwrap().run(&options, &AtomicBool::new(false)).unwrap().result
    }
    fn problem(&self, more: &[&str]) -> String {
        self.scene(more).err().map(|e| e.to_string()).unwrap_or_default()
    }
}

impl Drop for WithFile {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// Plug flow between planes of symmetry: the velocity is that of the inlet everywhere.
const PLUG: &str = r#"
grid = { cells = [16, 4], size = [0.4, 0.1] }
sides = { x_min = { type = "inlet", table = "inflow.csv" }, x_max = "outlet", y = "symmetry" }
fluid = { density = 1.0, nu = 1e-3 }
initial = { velocity = [0.5, 0.0] }
time = { end = 0.3, dt = 0.01 }
output = { snapshots = 1, images = false, fields = false, report = false }
"#;

#[test]
fn an_inlet_follows_a_table() {
    let scene = WithFile::new(PLUG, "inflow.csv", "# from a pump\ntime, u\n0.0, 0.5\n0.2, 1.5\n0.4, 0.5\n");
    let result = scene.run(&[]);
    assert!((number(&result, "/flow/mean_velocity/0") - 1.0).abs() < 1e-12, "{result:#}");
    let short = scene.problem(&["time.end=0.5"]);
    let parts = ["sides.x_min.table", "inflow.csv", "from 0 to 0.4 s", "to the end of the run, 0.5 s"];
    assert!(parts.iter().all(|part| short.contains(part)), "{short}");
    let twice = scene.problem(&["sides.x_min.peak=1.0"]);
    assert!(twice.contains("`peak` is given already"), "{twice}");
    let steady = scene.problem(&["flow.algorithm=\"simple\""]);
    assert!(steady.contains("a steady flow has no time"), "{steady}");
    std::fs::write(scene.folder.join("inflow.csv"), "time,u,speed\n0,1,1\n1,1,1\n").unwrap();
    let unknown = scene.problem(&[]);
    assert!(unknown.contains("no column \"speed\"") && unknown.contains("time, u, v, w"), "{unknown}");
}

/// A run goes on with the table that it began with only.
#[test]
fn a_changed_table_is_refused() {
    let scene = WithFile::new(PLUG, "inflow.csv", "time,u\n0,0.5\n1,1.5\n");
    scene.run(&[]);
    std::fs::write(scene.folder.join("inflow.csv"), "time,u\n0,0.5\n1,1.6\n").unwrap();
    let options = Options { resume: true, ..quiet(&scene.folder.join("out")) };
    let error = scene.scene(&["time.end=0.4"]).unwrap().run(&options, &AtomicBool::new(false)).unwrap_err();
    let text = error.to_string();
    assert!(text.contains("inflow.csv") && text.contains("has changed"), "{text}");
}

/// A plate that swings about its end.
fn plate(motion: &str, dry: bool) -> String {
    let fluid = if dry { "" } else { "fluid = { density = 1.0, nu = 0.01 }" };
    format!(
        r#"
grid = {{ cells = [32, 32], size = [0.4, 0.4] }}
sides = {{ x = "wall", y = "wall" }}
{fluid}
time = {{ end = 0.3, dt = 0.0015 }}
output = {{ snapshots = 1, images = false, fields = false, report = false }}
[[bodies]]
name = "plate"
shape = {{ type = "box", edges = [0.05, 0.08] }}
position = [0.2, 0.2]
motion = {motion}
"#
    )
}

/// x, y and the angle about z.
fn placed(result: &Value) -> [f64; 3] {
    let at = |a: usize| number(result, &format!("/bodies/0/position/{a}"));
    let [w, z] = [0, 3].map(|i| number(result, &format!("/bodies/0/orientation/{i}")));
    [at(0), at(1), 2.0 * z.atan2(w)]
}

fn near(found: [f64; 3], expected: [f64; 3], most: f64) {
    let far = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(far < most, "{found:?}, expected {expected:?}");
}

#[test]
fn a_body_follows_a_table() {
    let motion = r#"{ type = "table", file = "path.csv" }"#;
    let path = "time,x,y,angle\n0,5.0,0,0.2\n0.2,5.04,0.01,0.6\n0.4,5.02,0.03,0.6\n";
    for dry in [true, false] {
        let scene = WithFile::new(&plate(motion, dry), "path.csv", path);
        let result = scene.run(&[]);
        near(placed(&result), [0.23, 0.22, 0.4], 1e-12);
        near([0, 1, 2].map(|a| number(&result, &format!("/bodies/0/velocity/{a}"))), [-0.1, 0.1, 0.0], 1e-9);
        let short = scene.problem(&["time.end=0.5"]);
        assert!(short.contains("bodies.0.motion.file") && short.contains("0.5 s"), "{short}");
    }
}

/// Velocity and spin by formulas give the path that they are derivatives of; a run that is resumed
/// gives the same bits.
#[test]
fn velocities_of_bodies_are_integrated() {
    let motion = r#"{ type = "prescribed", velocity = ["0.2*cos(10*t)", "0.1*t"], spin = "3*t^2" }"#;
    let path = r#"{ type = "prescribed", shift = ["0.02*sin(10*t)", "0.05*t^2"], angle = "t^3" }"#;
    let exact = [0.2 + 0.02 * 3.0_f64.sin(), 0.2 + 0.05 * 0.09, 0.027];
    for dry in [true, false] {
        let out = folder("velocity");
        let text = plate(motion, dry);
        let result = run(&text, &["output.snapshots=2"], &quiet(&out)).result;
        near(placed(&result), exact, 1e-12);
        let velocity = [0.2 * 3.0_f64.cos(), 0.03, 0.0];
        near([0, 1, 2].map(|a| number(&result, &format!("/bodies/0/velocity/{a}"))), velocity, 1e-15);
        let by_path = run(&plate(path, dry), &[], &quiet(&out)).result;
        near(placed(&by_path), exact, 1e-12);
        let first = run(&text, &["time.end=0.15"], &quiet(&out)).result;
        assert!(number(&first, "/time") < 0.2);
        let options = Options { resume: true, ..quiet(&out) };
        let resumed = run(&text, &["output.snapshots=2"], &options).result;
        assert_eq!(resumed["bodies"], result["bodies"]);
        std::fs::remove_dir_all(&out).unwrap();
    }
}

#[test]
fn motions_that_do_not_go_together_are_told() {
    for (motion, parts) in [
        (
            r#"{ type = "prescribed", shift = [0, "t"], velocity = [0, 1] }"#,
            &["velocity", "`shift` is given"][..],
        ),
        (r#"{ type = "prescribed", angle = "t", spin = 1.0 }"#, &["spin", "`angle` is given"]),
        (r#"{ type = "prescribed", spin = [1.0, 0.0, 0.0] }"#, &["spin", "about z only"]),
        (r#"{ type = "prescribed", spin = 1.0, pivot = [0.2, 0.1] }"#, &["pivot", "give `angle`"]),
        (r#"{ type = "prescribed" }"#, &["`shift`, `velocity`, `angle` or `spin`"]),
    ] {
        let told = Scene::parse("scene.toml", &plate(motion, true), &[]).err().unwrap().to_string();
        assert!(parts.iter().all(|part| told.contains(part)), "{motion}: {told}");
    }
    let lost = Scene::parse(
        &Path::new("nowhere").join("scene.toml").to_string_lossy(),
        &plate(r#"{ type = "table", file = "path.csv" }"#, true),
        &[],
    );
    assert!(lost.err().unwrap().to_string().contains("path.csv"));
}
