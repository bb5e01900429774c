//! Steady scenes: what they refuse, and how they go on.
use crate::{folder, problems, quiet, run};
use scene::{Ending, Options, Scene};
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// A disc in a channel.
pub(crate) const CHANNEL: &str = r#"
[grid]
cells = [48, 24]
size = [2.0, 1.0]
[sides]
x_min = { type = "inlet", velocity = [1.0, 0.0] }
x_max = "outlet"
y = "wall"
[fluid]
density = 1.0
nu = 2e-2
[flow]
algorithm = "simple"
tolerance = 1e-8
[[bodies]]
shape = { type = "disc", radius = 0.15 }
position = [0.6, 0.45]
motion = "fixed"
[forces]
velocity = 1.0
area = 0.3
[[probes]]
name = "wake"
points = [[1.5, 0.5]]
[output]
images = false
"#;

/// The parts of a state: a model with walls by its law in the box and beside bodies, and heat that drives the flow.
const SST: &[&str] = &["turbulence={model=\"sst\",speed=1.0}", "fluid.nu=1e-4", "flow.convection=\"upwind\""];
const REALIZABLE: &[&str] =
    &["turbulence={model=\"realizable\",speed=1.0}", "fluid.nu=1e-5", "flow.convection=\"upwind\""];
const HEAT: &[&str] = &["gravity=[0.0,-9.81]", "scalars.heat={diffusivity=2e-2,bodies=1.0,expansion=0.01}"];

/// Cut at any iteration, a run goes on bit for bit: fields, loads, results, and every residual.
#[test]
fn a_steady_run_goes_on() {
    for (name, sets) in [
        ("laminar", &[][..]),
        ("sst", &[SST]),
        ("realizable", &[REALIZABLE]),
        ("heat", &[HEAT]),
        ("sst-heat", &[SST, HEAT]),
        ("pressure", &[&["sides.x_max={type=\"pressure\"}"][..]]),
    ] {
        let sets = sets.concat();
        let [whole, pieces] = [0, 1].map(|_| folder(name));
        let part = |out: &Path, iterations: &str, resume: bool| {
            let last = format!("flow.iterations={iterations}");
            run(CHANNEL, &[&sets, &[last.as_str()][..]].concat(), &Options { resume, ..quiet(out) })
        };
        let all = part(&whole, "37", false);
        assert_eq!(all.ending, Ending::NotConverged, "{name}");
        for (k, iterations) in ["1", "2", "20", "37"].into_iter().enumerate() {
            let piece = part(&pieces, iterations, k > 0);
            assert_eq!(piece.result["iterations"].to_string(), iterations, "{name}");
        }
        // With nothing left to do it tells the same again.
        assert_eq!(part(&pieces, "37", true).result, all.result, "{name}");
        for file in ["residuals.csv", "fields/00000.vti", "forces.csv", "probes/wake.csv", "result.json"] {
            let [a, b] = [&whole, &pieces].map(|out| std::fs::read(out.join(file)).unwrap());
            assert!(a == b, "{name}: {file} differs");
        }
        let residuals = std::fs::read_to_string(whole.join("residuals.csv")).unwrap();
        assert_eq!(residuals.lines().count(), 2 + 37, "{name}");
        [whole, pieces].iter().for_each(|out| std::fs::remove_dir_all(out).unwrap());
    }
}

/// A run that has converged does nothing and says so; with a smaller tolerance it goes on from there; another scene is refused.
#[test]
fn a_run_that_has_converged_has_nothing_left_to_do() {
    let out = folder("converged");
    let first = run(CHANNEL, &["flow.tolerance=1e-5"], &quiet(&out));
    assert_eq!(first.ending, Ending::Done);
    let resume = Options { resume: true, ..quiet(&out) };
    let again = run(CHANNEL, &["flow.tolerance=1e-5"], &resume);
    assert_eq!(again.result, first.result);
    let log = std::fs::read_to_string(out.join("run.log")).unwrap();
    assert!(log.contains("nothing is left to do"), "{log}");
    let finer = run(CHANNEL, &["flow.tolerance=1e-7"], &resume);
    let fresh = folder("fresh");
    let whole = run(CHANNEL, &["flow.tolerance=1e-7"], &quiet(&fresh));
    assert_eq!(finer.result, whole.result);
    let other = Scene::parse("scene.toml", CHANNEL, &["fluid.nu=3e-2".into()]).unwrap();
    let told = other.run(&resume, &AtomicBool::new(false)).err().unwrap().to_string();
    assert!(told.contains("saved by another scene"), "{told}");
    [out, fresh].iter().for_each(|out| std::fs::remove_dir_all(out).unwrap());
}

/// Keys that have no meaning in a steady flow are refused by name.
#[test]
fn what_changes_in_time_is_refused() {
    let inlet = "sides.x_min={type=\"inlet\",velocity=[\"1+0.1*sin(t)\",0.0]}";
    let heat = |rest: &str| format!("scalars.heat={{diffusivity=1e-2,{rest}}}");
    let patch = "sides.x_min={type=\"patches\",list=[{lower=[0.0,0.0],upper=[0.0,1.0],side={type=\"inlet\",velocity=[\"1-t\",0.0]}}]}";
    for (set, key, told) in [
        (inlet, "sides.x_min", "changes with t"),
        (patch, "sides.x_min", "changes with t"),
        ("force=[\"min(t,1)\",0.0]", "force", "changes with t"),
        (&heat("bodies=\"t\""), "scalars.heat.bodies", "changes with t"),
        (
            &heat("bodies=1.0,sides={x_min={type=\"value\",value=\"t\"}}"),
            "scalars.heat.sides",
            "changes with t",
        ),
        (
            &heat("bodies=1.0,sides={y={type=\"gradient\",gradient=\"x+t\"}}"),
            "scalars.heat.sides",
            "changes with t",
        ),
        ("averages={start=0.1}", "flow.algorithm", "no history"),
        ("exits=[{point=[2.0,0.0],normal=[-1.0,0.0]}]", "exits", "none moves"),
        ("bodies.0.motion=\"free\"", "flow.algorithm", "no bodies that move"),
        ("bodies.0.motion={type=\"prescribed\",angle=\"t\"}", "flow.algorithm", "no bodies that move"),
        (
            "factories=[{type=\"inflow\",shape={type=\"disc\",radius=0.1},rate=1.0}]",
            "factories",
            "come in as time goes on",
        ),
        ("coupling.forcing=\"smooth\"", "coupling.forcing", "cut cells"),
        ("coupling.forcing=\"hfdib\"", "coupling.forcing", "cut cells"),
        ("fluid.nu=0.0", "fluid", "give `nu` above 0"),
        ("fluid.nu=1e-310", "fluid.nu", "m²/s at least"),
        ("fluid.nu=1e-200", "fluid.nu", "m²/s at least"),
        ("fluid.density=0.0", "fluid.density", ""),
    ] {
        let found = problems(CHANNEL, set);
        assert!(found.contains(told) && found.contains(key), "{set}: {found}");
    }
    for set in ["fluid.nu=0.0", "fluid={density=1.0,mu=0.0}"] {
        let found = problems(CHANNEL.split("[[bodies]]").next().unwrap(), set);
        assert!(found.contains("fluid") && found.contains("give a viscosity above 0"), "{set}: {found}");
    }
    // The same formulas without t are fine, and so is a scene without `time`.
    let scene = Scene::parse(
        "s.toml",
        CHANNEL,
        &["sides.x_min={type=\"inlet\",velocity=[\"6*y*(1-y)\",0.0]}".into()],
    );
    assert!(scene.is_ok_and(|scene| !scene.plan().unwrap().warnings.join(" ").contains("used by")));
}

/// Keys that only steer a run in time are not used; the plan says so. Results hold no time.
#[test]
fn keys_of_time_are_told_to_be_of_no_use() {
    let set = [
        "time={end=3.0,dt=0.1,courant=0.3}",
        "forces.start=50.0",
        "forces.every=0.5",
        "probes.0.every=0.7",
        "flow.iterations=5",
    ];
    let more: Vec<String> = set.map(String::from).into();
    let scene = Scene::parse("scene.toml", CHANNEL, &more).unwrap();
    let told = scene.plan().unwrap().warnings.join("\n");
    for key in ["time.dt", "time.courant", "forces.start", "forces.every", "probes.0.every"] {
        assert!(told.contains(key), "{key}: {told}");
    }
    let out = folder("timeless");
    let run = scene.run(&quiet(&out), &AtomicBool::new(false)).unwrap();
    let probes = std::fs::read_to_string(out.join("probes/wake.csv")).unwrap();
    std::fs::remove_dir_all(&out).unwrap();
    assert_eq!(probes.lines().count(), 3, "{probes}");
    assert!(run.result["probes"][0]["points"][0]["velocity"][0].as_f64().unwrap() > 0.1);
    assert_eq!(run.result["iterations"], 5);
    assert!(["time", "end", "steps", "step"].iter().all(|key| run.result.get(key).is_none()));
    let load = &run.result["forces"][0]["load"];
    assert!(load["last"] == load["mean"] && load.get("rms").is_none(), "{load}");
    assert!(
        !run.summary().contains(" s,") && run.summary().contains("not converged after 5 iterations"),
        "{}",
        run.summary()
    );
    let unsteady = ["flow.algorithm=\"projection\"", "time.end=1.0"].map(String::from);
    let plan = Scene::parse("s.toml", CHANNEL, &unsteady).unwrap().plan().unwrap();
    assert!(
        plan.warnings.join("\n").contains("flow.tolerance is not used by flow.algorithm = \"projection\"")
    );
}

/// Inlets that let fluid out are refused, whatever gives their velocity, in time as well; those that do so in part are told of.
#[test]
fn inlets_let_fluid_in() {
    let x_min = |velocity: &str| format!("sides.x_min={{type=\"inlet\",velocity=[{velocity},0.1]}}");
    let patch = "sides.x_min={type=\"patches\",list=[{lower=[0.0,0.0],upper=[0.0,0.5],side=\"wall\"},{lower=[0.0,0.5],upper=[0.0,1.0],side={type=\"inlet\",velocity=[\"-y\",0.0]}}]}";
    let upper = ["sides.x_max={type=\"inlet\",velocity=[1.0,0.0]}", "sides.x_min={type=\"pressure\"}"];
    let unsteady = ["flow={algorithm=\"projection\"}", "time.end=1.0"];
    let empty = CHANNEL.split("[[bodies]]").next().unwrap();
    for more in [&[][..], &unsteady] {
        for set in [
            &[x_min("-1.0").as_str()][..],
            &[&x_min("\"y*(y-1)\"")],
            &["sides.x_min={type=\"inlet\",peak=-1.0}"],
            &[patch],
            &upper,
            &[&x_min("\"0.1-y\"")],
        ] {
            let all: Vec<String> = more.iter().chain(set).map(|s| (*s).into()).collect();
            let found = Scene::parse("s.toml", empty, &all).err().map(|e| e.to_string()).unwrap_or_default();
            assert!(found.contains("fluid leaves the box through the inlet"), "{set:?}: {found}");
        }
    }
    let warned = |more: &[&str]| {
        let more: Vec<String> = more.iter().map(|s| (*s).into()).collect();
        Scene::parse("s.toml", empty, &more).unwrap().plan().unwrap().warnings.join("\n")
    };
    let found = warned(&[&x_min("\"y-0.1\"")]);
    assert!(found.contains("fluid leaves the box through") && found.contains("x_min"), "{found}");
    let found = warned(&[&unsteady[..], &[x_min("\"sin(6*t)\"").as_str()]].concat());
    assert!(found.contains("fluid leaves the box through"), "{found}");
    // Given all round, as by an exact solution, it may.
    let around = "sides={x={type=\"inlet\",velocity=[1.0,0.0]},y=\"wall\"}";
    assert!(!warned(&[around]).contains("leaves"));
}

/// An inlet that lets some fluid out converges before a side of given pressure, with a model as well, whose k stays below the kinetic energy of the flow.
#[test]
fn an_inlet_that_lets_some_fluid_out_converges() {
    let empty = CHANNEL.split("[[bodies]]").next().unwrap();
    let part = "sides.x_min={type=\"inlet\",velocity=[\"2*y-0.4\",0.0]}";
    for (name, more) in [("part", &[][..]), ("part-sst", SST)] {
        let out = folder(name);
        let pressure = "sides.x_max={type=\"pressure\"}";
        let set = [part, pressure, "flow.tolerance=1e-4", "flow.iterations=1000", "output.images=false"];
        let found = run(empty, &[more, &set].concat(), &quiet(&out));
        std::fs::remove_dir_all(&out).unwrap();
        assert_eq!(found.ending, Ending::Done, "{name}: {}", found.result["residual"]);
        if !more.is_empty() {
            let k = found.result["fields"]["k"]["most"].as_f64().unwrap();
            assert!(k < 1.0, "{k}");
        }
    }
}

/// Without a viscosity fluid between slipping sides gains what the force gives.
#[test]
fn an_inviscid_fluid_goes_on_in_time() {
    let text = r#"
force = [1.0, 0.0]
grid = { cells = [16, 16], size = [1.0, 1.0] }
sides = { x = "periodic", y = "symmetry" }
fluid = { density = 1.0, nu = 0.0 }
time = { end = 0.5 }
output = { images = false, fields = false, snapshots = 2 }
"#;
    let out = folder("inviscid");
    let found = run(text, &[], &quiet(&out)).result;
    let u = found["flow"]["mean_velocity"][0].as_f64().unwrap();
    assert!((u - 0.5).abs() < 1e-12, "{u}");
    // Limits of automatic steps: the Courant number alone.
    let courant = found["step"]["courant"].as_f64().unwrap();
    assert!(courant < 0.401 && found["steps"].as_u64().unwrap() > 7, "{courant} {}", found["steps"]);
    let disc = "bodies=[{shape={type=\"disc\",radius=0.2},density=2.0,position=[0.5,0.5]}]";
    let smooth = problems(text, disc);
    assert!(smooth.contains("bodies by smooth forcing need a viscosity"), "{smooth}");
    let sst = problems(text, "turbulence=\"sst\"");
    assert!(sst.contains("give one above 0"), "{sst}");
    std::fs::remove_dir_all(&out).unwrap();
}
