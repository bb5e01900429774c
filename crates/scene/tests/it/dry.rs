//! Scenes without a fluid.
use crate::{folder, problems, quiet, root, run};
use scene::Options;
use std::path::Path;

/// Without a fluid: a block slides down an inclined plane as Coulomb's law has it, and goes on with the same bits.
#[test]
fn a_block_slides_without_a_fluid() {
    let text = std::fs::read_to_string(root().join("scenes/sliding_block.toml")).unwrap();
    let [whole, halves] = ["block-whole", "block-halves"].map(folder);
    let run = |out: &Path, more: &[&str], resume: bool| run(&text, more, &Options { resume, ..quiet(out) });
    let all = run(&whole, &[], false);
    assert!(all.compared[0].error().unwrap().abs() < 1e-4, "{:?}", all.compared);
    assert!(all.result.get("flow").is_none() && all.result["contacts"] == 1);
    run(&halves, &["time.end=0.2", "output.snapshots=20"], false);
    assert_eq!(all.result, run(&halves, &[], true).result);
    // An open side, by which bodies may leave.
    assert_eq!(problems(&text, "sides.x=\"outlet\""), "");
    assert!(!whole.join("fields").exists() && whole.join("bodies/00040.vtp").exists());
    for (more, told) in [
        ("coupling={}", "this needs a fluid"),
        ("probes=[]", "this needs a fluid"),
        ("output.quantity=\"pressure\"", "pictures show the bodies"),
        ("bodies.0.motion=\"fixed\"", "nothing happens"),
        ("output.fields=true", "no fields to write"),
        ("sides.x={type=\"inlet\", velocity=[1.0, 0.0]}", "along x: without `fluid` nothing enters"),
    ] {
        let found = problems(&text, more);
        assert!(found.contains(told), "{more}: {found}");
    }
    [whole, halves].iter().for_each(|out| std::fs::remove_dir_all(out).unwrap());
}

/// Frames of bodies with many polygons hold a point per body and the surface of all spheres once, and
/// those of a resumed run the same.
#[test]
fn frames_of_many_bodies_hold_points() {
    let text = r#"
gravity = [0.0, 0.0, -9.81]
grid = { cells = [10, 10, 10], size = [1.0, 1.0, 1.0] }
sides = { x = "wall", y = "wall", z = "wall" }
materials = { glass = { density = 2500.0, youngs_modulus = 1e6 } }
contact = { wall_material = "glass" }
time = { end = 0.1 }
output = { snapshots = 2, images = false }
[[factories]]
type = "random"
number = 70
shape = { type = "sphere", radius = 0.05 }
scale = { law = "uniform", low = 0.8, high = 1.2 }
material = "glass"
region = { lower = [0.0, 0.0, 0.0], upper = [1.0, 1.0, 1.0] }
"#;
    let [whole, halves] = ["points-whole", "points-halves"].map(folder);
    run(text, &[], &quiet(&whole));
    run(text, &["time.end=0.05", "output.snapshots=1"], &quiet(&halves));
    run(text, &[], &Options { resume: true, ..quiet(&halves) });
    for name in ["bodies.pvd", "bodies.py", "bodies/00002.vtp", "bodies/shapes/00000.vtp"] {
        let [a, b] = [&whole, &halves].map(|out| std::fs::read(out.join(name)).unwrap());
        assert!(a == b, "{name}");
    }
    let frame = std::fs::read(whole.join("bodies/00002.vtp")).unwrap();
    let header = String::from_utf8_lossy(&frame);
    assert!(header.contains("NumberOfPoints=\"70\"") && header.contains("Name=\"shape\""));
    assert_eq!(std::fs::read_dir(whole.join("bodies/shapes")).unwrap().count(), 1);
    [whole, halves].iter().for_each(|out| std::fs::remove_dir_all(out).unwrap());
}

/// Two balls that repel one another turn back before they touch, as fast as they came.
#[test]
fn balls_repel_one_another() {
    let text = r#"
grid = { cells = [10, 10, 10], size = [1.0, 1.0, 1.0] }
sides = { x = "periodic", y = "periodic", z = "periodic" }
contact = { repulsion = { strength = 1000.0, range = 0.1 } }
bodies = [
    { shape = { type = "sphere", radius = 0.1 }, density = 1000.0, position = [0.3, 0.5, 0.5], velocity = [0.5, 0.0, 0.0] },
    { shape = { type = "sphere", radius = 0.1 }, density = 1000.0, position = [0.7, 0.5, 0.5], velocity = [-0.5, 0.0, 0.0] },
]
time = { end = 0.4 }
output = { snapshots = 2, images = false }
"#;
    let out = folder("repel");
    let result = run(text, &[], &quiet(&out)).result;
    std::fs::remove_dir_all(&out).unwrap();
    let speed = result["bodies"][0]["velocity"][0].as_f64().unwrap();
    assert!((speed + 0.5).abs() < 1e-3, "{speed}");
    for (more, told) in [
        ("contact.law=\"potential\"", "repulsion goes with the contact law"),
        ("contact.repulsion.range=0.0", "above 0"),
        ("contact.repulsion={strength=1.0}", "range"),
    ] {
        let found = problems(text, more);
        assert!(found.contains(told), "{more}: {found}");
    }
}
