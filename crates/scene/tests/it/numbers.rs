//! Numbers of results, summaries and plans hold what their names say.
use crate::{folder, quiet, run};
use scene::{RunResult, Scene};

const STREAM: &str = r#"
[grid]
cells = [40, 20]
size = [2.0, 1.0]
[sides]
x_min = { type = "inlet", velocity = [1.0, 0.0] }
x_max = "outlet"
y = "symmetry"
[fluid]
density = 1.0
nu = 2e-2
[[bodies]]
shape = { type = "disc", radius = 0.23 }
position = [0.613, 0.487]
motion = "fixed"
[time]
end = 0.4
[output]
images = false
fields = false
snapshots = 2
"#;

fn ran(name: &str, text: &str, more: &[&str]) -> RunResult {
    let out = folder(name);
    let found = run(text, more, &quiet(&out));
    std::fs::remove_dir_all(&out).unwrap();
    found
}

/// Heat of a disc whose surface has 1 in fluid of 0: no cell that holds fluid is warmer, whatever surface cells hold; means are by volume, over the box and over the fluid.
#[test]
fn extremes_are_those_of_cells_that_hold_fluid() {
    let heat = "scalars.heat={diffusivity=2e-2,bodies=1.0}";
    for (name, more) in [
        ("links", &[heat][..]),
        ("smooth", &[heat, "coupling.forcing=\"smooth\""]),
        ("steady", &[heat, "flow={algorithm=\"simple\",tolerance=1e-5}"]),
        (
            "stretched",
            &[
                heat,
                "grid={x={spacing=\"uniform\",cells=40,to=2.0},y={spacing=\"tanh\",cells=20,to=1.0,strength=1.2}}",
            ],
        ),
    ] {
        let result = ran(name, STREAM, more).result;
        let of = |key: &str| result["fields"]["heat"][key].as_f64().unwrap();
        assert!(
            of("most") <= 1.0 + 1e-9 && of("most") > 0.5 && of("least") > -0.05,
            "{name}: {}",
            result["fields"]
        );
        // The disc has 1 all through.
        let solid = std::f64::consts::PI * 0.23 * 0.23 / 2.0;
        let expected = solid + (1.0 - solid) * of("mean_in_fluid");
        assert!((of("mean") - expected).abs() < 0.02, "{name}: {} {expected}", of("mean"));
    }
}

/// Loads have their deviation about the mean and their root mean square, which differ by the mean; a Strouhal number has a length.
#[test]
fn deviations_and_root_mean_squares_are_two() {
    let forces = "forces={velocity=1.0,area=0.46,start=0.1}";
    let load = &ran("rms", STREAM, &[forces]).result["forces"][0]["load"];
    let of = |key: &str| load[key][0].as_f64().unwrap();
    let [mean, deviation, rms] = ["mean", "deviation", "rms"].map(of);
    assert!(deviation > 0.0 && deviation < 0.5 * mean, "{load}");
    assert!((rms * rms - mean * mean - deviation * deviation).abs() < 1e-12 * rms * rms, "{load}");
    assert!(deviation <= of("highest") - of("lowest"));
}

/// Probes tell of the end, whenever their last line was due.
#[test]
fn probes_tell_of_the_end() {
    let probes = |every: &str| format!("probes=[{{name=\"a\",points=[[1.5,0.5]]{every}}}]");
    let [often, never] =
        ["", ",every=9.0"].map(|every| ran("probes", STREAM, &[&probes(every)]).result["probes"].clone());
    assert!(
        often == never && often[0]["points"][0]["velocity"][0].as_f64().unwrap() > 0.1,
        "{often} {never}"
    );
}

/// In space summaries have three components of loads and coefficients.
#[test]
fn summaries_have_all_axes() {
    let text = STREAM
        .replace("[40, 20]", "[16, 12, 12]")
        .replace("[2.0, 1.0]", "[1.2, 0.9, 0.9]")
        .replace("y = \"symmetry\"", "y = \"symmetry\"\nz = \"symmetry\"")
        .replace("[1.0, 0.0]", "[1.0, 0.0, 0.0]")
        .replace("\"disc\", radius = 0.23", "\"sphere\", radius = 0.25")
        .replace("[0.613, 0.487]", "[0.5, 0.45, 0.4]");
    let found = ran("axes", &text, &["forces={velocity=1.0,area=0.2,start=0.05}", "time.end=0.1"]);
    let summary = found.summary();
    let line = summary.lines().find(|line| line.contains("body 0")).unwrap().to_owned();
    let coefficients = line.split("mean coefficients").nth(1).unwrap().split(';').next().unwrap();
    assert_eq!(coefficients.split(',').count(), 3, "{line}");
    assert_eq!(found.result["forces"][0]["coefficients"]["mean"].as_array().unwrap().len(), 3);
}

/// A wall with a slot in it blocks what is solid of it, not its bounding box; several bodies in one plane block it together.
#[test]
fn blockage_is_that_of_planes() {
    let warned = |bodies: &str| {
        let scene = Scene::parse("s.toml", STREAM, &[format!("bodies=[{bodies}]")]).unwrap();
        scene.plan().unwrap().warnings.join("\n")
    };
    let slot = r#"{shape={type="formula",lower=[-0.1,-0.49],upper=[0.1,0.49],distance="max(max(abs(x)-0.08,abs(y)-0.48),0.2-abs(y))"},position=[1.0,0.5],motion="fixed"}"#;
    let found = warned(slot);
    assert!(found.contains("a body blocks 56 %"), "{found}");
    let disc = |x: &str, y: &str| {
        format!(r#"{{shape={{type="disc",radius=0.1}},position=[{x},{y}],motion="fixed"}}"#)
    };
    let found = warned(&format!("{},{}", disc("1.0", "0.3"), disc("1.0", "0.7")));
    assert!(found.contains("bodies block 40 %"), "{found}");
    let found = warned(&format!("{},{}", disc("0.8", "0.3"), disc("1.2", "0.7")));
    assert!(!found.contains("block"), "{found}");
}
