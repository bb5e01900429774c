//! Scalars that drive the flow, and eddies that mix them.
use crate::{folder, quiet, root, run};
use scene::{Ending, Options, Scene};
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// The warm cavity at Ra 1e5 on 40 × 40 cells by SIMPLE and by PISO: the velocities of de Vahl Davis (1983) within a hundredth, and those of the projection within 0.3 %.
#[test]
fn a_warm_cavity_by_all_algorithms() {
    let cavity = |name: &str, more: &[&str]| {
        let common = ["grid.x.cells=40", "grid.y.cells=40", "output.images=false", "output.fields=false"];
        let set: Vec<String> = common.iter().chain(more).map(|s| (*s).into()).collect();
        let scene = Scene::load(&root().join("scenes/warm_cavity.toml"), &set).unwrap();
        let out = folder(name);
        let run = scene.run(&quiet(&out), &AtomicBool::new(false)).unwrap();
        std::fs::remove_dir_all(&out).unwrap();
        assert_eq!(run.ending, Ending::Done, "{name}: {}", run.result["residual"]);
        [0, 1].map(|i| run.compared[i].found.unwrap())
    };
    let projection = cavity("projection", &["time.end=0.3"]);
    let simple =
        cavity("simple", &["flow.algorithm=\"simple\"", "flow.iterations=3000", "flow.tolerance=1e-6"]);
    let piso = cavity("piso", &["flow.algorithm=\"piso\"", "time.dt=2e-4", "time.end=0.3"]);
    for (name, found) in [("projection", projection), ("simple", simple), ("piso", piso)] {
        for (i, exact) in [34.73, 68.59].into_iter().enumerate() {
            let (off, other) = (found[i] / exact - 1.0, found[i] / projection[i] - 1.0);
            assert!(off.abs() < 0.01 && other.abs() < 3e-3, "{name} {i}: {} {off} {other}", found[i]);
        }
    }
}

/// From rest, a channel whose walls the first cells do not resolve, and a scalar that gains per time what the flow does, with the same boundary values.
const CHANNEL: &str = r#"
turbulence = { model = "sst", intensity = 0.05, length = 0.1, speed = 20.0 }
force = [1.0, 0.0]
[grid]
cells = [4, 24]
size = [0.2, 2.0]
[sides]
x = "periodic"
y = "wall"
[fluid]
density = 1.0
nu = 1e-3
[flow]
convection = "central"
[scalars.momentum]
diffusivity = 1e-3
turbulent_prandtl = 1.0
source = 1.0
convection = "central"
sides = { y = { type = "value", value = 0.0 } }
[time]
end = 4.0
[output]
images = false
fields = false
snapshots = 1
"#;

/// Reynolds' analogy: with Pr = Pr_t = 1 that scalar is the velocity, while the flow develops and when it has.
#[test]
fn a_scalar_in_modelled_turbulence_is_the_velocity() {
    let off = |name: &str, more: &[&str]| {
        let out = folder(name);
        let run = run(CHANNEL, more, &quiet(&out));
        std::fs::remove_dir_all(&out).unwrap();
        assert_eq!(run.ending, Ending::Done, "{name}: {}", run.result["residual"]);
        let (u, phi) = (&run.result["flow"]["mean_velocity"][0], &run.result["fields"]["momentum"]["mean"]);
        let (u, phi) = (u.as_f64().unwrap(), phi.as_f64().unwrap());
        assert!(u > 3.5, "{name}: {u}");
        phi / u - 1.0
    };
    for (name, diffusion) in
        [("explicit", "flow.diffusion=\"explicit\""), ("auto", "flow.diffusion=\"auto\"")]
    {
        let found = off(name, &[diffusion]);
        assert!(found.abs() < 1e-12, "{name}: {found}");
    }
    let steady = ["flow.algorithm=\"simple\"", "flow.tolerance=1e-8", "flow.iterations=30000"];
    let found = off("analogy-steady", &steady);
    assert!(found.abs() < 1e-6, "{found}");
    // Without what eddies bring it would be another one altogether.
    let other =
        off("analogy-other", &["flow.diffusion=\"explicit\"", "scalars.momentum.turbulent_prandtl=0.5"]);
    assert!(other.abs() > 1e-3, "{other}");
}

/// Scalars held on a disc that falls and one that is moved as told, mixed by SST or not: half a run and the rest are the whole, bit for bit.
#[test]
fn scalars_held_on_bodies_that_move_go_on() {
    let text = r#"
gravity = [0.0, -9.81]
grid = { cells = [32, 48], size = [1.0, 1.5] }
sides = { x = "periodic", y = "wall" }
fluid = { density = 1.0, nu = 2e-3 }
[scalars.warmth]
diffusivity = 3e-3
bodies = "1 + 0.5*sin(3*t)"
expansion = 0.02
[scalars.salt]
diffusivity = 2e-3
bodies_flux = "1e-2*t"
initial = "y"
[[bodies]]
shape = { type = "disc", radius = 0.15 }
density = 1.3
position = [0.3, 1.1]
[[bodies]]
shape = { type = "disc", radius = 0.15 }
position = [0.7, 0.5]
motion = { type = "prescribed", shift = ["0.1*(1-cos(6*t))", 0.0] }
[time]
end = 0.4
[output]
snapshots = 4
images = false
"#;
    for (name, more) in [
        ("held", &[][..]),
        ("held-sst", &["turbulence={model=\"sst\", speed=1.0}"]),
        ("held-hfdib", &["coupling.forcing=\"hfdib\"", "bodies.0.density=4.0"]),
        (
            "held-piso",
            &[
                "flow.algorithm=\"piso\"",
                "coupling.forcing=\"hfdib\"",
                "time.dt=2e-3",
                "time.ramp=false",
                "bodies.0.density=4.0",
            ],
        ),
    ] {
        let [whole, halves] = [0, 1].map(|_| folder(name));
        let part = |out: &Path, last: &[&str], resume: bool| {
            run(text, &[more, last].concat(), &Options { resume, ..quiet(out) }).result
        };
        let all = part(&whole, &[], false);
        part(&halves, &["time.end=0.2", "output.snapshots=2"], false);
        assert_eq!(all, part(&halves, &[], true), "{name}");
        let [a, b] = [&whole, &halves].map(|out| std::fs::read(out.join("fields/00004.vti")).unwrap());
        assert!(a == b, "{name}: the fields differ");
        let warmth = all["fields"]["warmth"]["mean"].as_f64().unwrap();
        let salt = all["fields"]["salt"]["mean"].as_f64().unwrap();
        assert!(warmth > 0.1 && salt > 0.75, "{name}: {warmth} {salt}");
        [whole, halves].iter().for_each(|out| std::fs::remove_dir_all(out).unwrap());
    }
}

/// A duct at Re 10⁵ with warm walls, k–ε: with bodies as walls it takes up what it does between sides of the box. (Walls across the grid: `heat_in_ducts_across_the_grid_is_the_velocity`.)
#[test]
fn warm_walls_that_are_bodies_warm_as_sides_do() {
    let text = r#"
turbulence = { model = "k-epsilon", intensity = 0.05, length = 0.1, speed = 1.0 }
grid = { cells = [120, 20], size = [6.0, 1.0] }
fluid = { density = 1.0, nu = 1e-5 }
[sides]
x_min = { type = "inlet", velocity = [1.0, 0.0] }
x_max = "outlet"
y = "wall"
[initial]
velocity = [1.0, 0.0]
[scalars.heat]
diffusivity = 1.4e-5
sides = { y = { type = "value", value = 1.0 } }
[flow]
algorithm = "simple"
convection = "quick"
[time]
end = 1.0
[output]
images = false
fields = false
"#;
    let duct = |name: &str, more: &[&str]| {
        let out = folder(name);
        let result = run(text, more, &quiet(&out));
        std::fs::remove_dir_all(&out).unwrap();
        assert_eq!(result.ending, Ending::Done, "{name}");
        let of = |value: &serde_json::Value| value.as_f64();
        [of(&result.result["fields"]["heat"]["mean"]), of(&result.result["given_off"]["heat"])]
    };
    let sides = duct("duct-sides", &["grid.cells=[120, 80]"])[0].unwrap();
    let body = |y: &str| {
        format!(
            r#"{{ shape = {{ type = "box", edges = [40.0, 4.0] }}, position = [3.0, {y}], motion = "fixed" }}"#
        )
    };
    let bodies = format!("bodies=[{}, {}]", body("-1.75"), body("3.25"));
    let set = ["grid.cells=[120, 120]", "grid.size=[6.0, 1.5]", &bodies];
    let [mean, given_off] =
        duct("duct-along", &[&set[..], &["scalars.heat.bodies=1.0", "scalars.heat.sides={}"]].concat())
            .map(Option::unwrap);
    // A third of the box is warm wall.
    let fluid = 1.5 * (mean - 1.0 / 3.0);
    assert!((fluid / sides - 1.0).abs() < 0.015, "{fluid} {sides}");
    // What they give off, Q, leaves through the end. It grows like x^n, n 0.8 to 0.9, and the layer goes along at 0.8 to 0.85 of the mean velocity: the scalar's mean is Q/0.8/(1 + n).
    assert!((0.6..0.75).contains(&(fluid / given_off)), "{fluid} {given_off}");
}
