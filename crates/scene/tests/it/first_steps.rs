//! Errors of the first steps, found by a check.
use crate::{folder, problems, quiet, root};
use scene::Scene;
use std::sync::atomic::AtomicBool;

pub(crate) const BOX: &str = r#"
[grid]
cells = [32, 32]
size = [1.0, 1.0]
[sides]
x = "wall"
y = "wall"
[fluid]
density = 1000.0
nu = 1e-3
[time]
end = 1.0
[output]
images = false
fields = false
"#;

/// Error of a check, which is that of the run.
fn refused(text: &str) -> String {
    let scene = Scene::parse("a.toml", text, &[]).unwrap_or_else(|e| panic!("{e}"));
    let out = folder("first-steps");
    let run = scene.run(&quiet(&out), &AtomicBool::new(false)).unwrap_err();
    assert!(matches!(run, scene::RunError::Build(_)), "{run}");
    let _ = std::fs::remove_dir_all(&out);
    let check = scene.plan().unwrap_err().to_string();
    assert_eq!(check, run.to_string());
    check
}

fn disc(position: &str, motion: &str) -> String {
    format!(
        "[[bodies]]\nname = \"disc\"\nshape = {{ type = \"disc\", radius = 0.1 }}\ndensity = 2000.0\nposition = {position}\nmotion = {motion}\n"
    )
}

#[test]
fn formulas_that_move_a_body_out_of_the_box_are_refused() {
    let shift = "{ type = \"prescribed\", shift = [\"t\", 0.0] }";
    let found = refused(&format!("{BOX}{}", disc("[0.5, 0.5]", shift)));
    assert!(found.contains("bodies.0: its formulas move body disc at t = 5.0"), "{found}");
    assert!(found.contains("beyond the box from 0.000000e0 to 1.000000e0 m"), "{found}");
}

#[test]
fn the_key_that_helps_on_a_stretched_grid_is_named() {
    let axis = "{ spacing = \"geometric\", cells = 40, to = 1.0, ratio = 1.02 }";
    let grid = format!("[grid]\nx = {axis}\ny = {axis}\n");
    let text = BOX.replace("[grid]\ncells = [32, 32]\nsize = [1.0, 1.0]\n", &grid);
    let still = "{ type = \"prescribed\", shift = [\"0.01*sin(t)\", 0.0] }";
    let message = problems(&format!("{text}{}", disc("[0.5, 0.5]", still)), "time.end=1.0");
    assert!(message.is_empty(), "{message}");
    let found = refused(&format!("{text}{}", disc("[0.5, 0.5]", still)));
    assert!(found.contains("coupling.forcing = \"hfdib\"") && !found.contains("`Hfdib`"), "{found}");
}

/// A body that starts where cells are equal and turns or moves to where they are not.
#[test]
fn formulas_that_move_a_body_to_unequal_cells_are_refused() {
    let faces: Vec<String> = (0..=40)
        .map(|i| f64::from(i) / 40.0)
        .chain((1..=10).map(|i| 1.0 + 0.05 * f64::from(i)))
        .map(|x| format!("{x}"))
        .collect();
    let axis = format!("{{ spacing = \"faces\", faces = [{}] }}", faces.join(", "));
    let grid = format!("[grid]\nx = {axis}\ny = {{ spacing = \"uniform\", cells = 40, to = 1.0 }}\n");
    let text = BOX.replace("[grid]\ncells = [32, 32]\nsize = [1.0, 1.0]\n", &grid);
    let moved =
        |shift: &str| disc("[0.5, 0.5]", &format!("{{ type = \"prescribed\", shift = [{shift}, 0.0] }}"));
    let found = refused(&format!("{text}{}", moved("\"0.4*t\"")));
    assert!(
        found.contains("bodies.0: its formulas move body disc at t = ") && found.contains("wide along x")
    );
    let plan = Scene::parse("a.toml", &format!("{text}{}", moved("\"0.2*t\"")), &[]).unwrap().plan();
    plan.unwrap_or_else(|e| panic!("{e}"));
}

#[test]
fn references_point_to_numbers_of_the_results() {
    let reference = |pointer: &str| {
        format!("{BOX}[[references]]\nname = \"a\"\npointer = \"{pointer}\"\nvalue = 1.0\nsource = \"b\"\n")
    };
    for (pointer, part) in [
        ("/flow/kinetic", "at the top there are"),
        ("/flow", "there is no number but a list"),
        ("/probes/0/points/0/pressure", "at the top there are"),
    ] {
        let found = refused(&reference(pointer));
        assert!(found.contains("references.0.pointer: ") && found.contains(part), "{found}");
    }
    let probes = "[[probes]]\nname = \"p\"\npoints = [[0.5, 0.5]]\n";
    let found = refused(&format!("{}{probes}", reference("/probes/1/points/0/pressure")));
    assert!(found.contains("\"probes\" has 1 entries"), "{found}");
    for pointer in ["/flow/kinetic_energy", "/step/longest", "/probes/0/points/0/pressure"] {
        let text = format!("{}{probes}", reference(pointer));
        let plan = Scene::parse("a.toml", &text, &[]).unwrap_or_else(|e| panic!("{e}")).plan();
        plan.unwrap_or_else(|e| panic!("{e}"));
    }
}

/// The velocity is needed at faces, not at centres.
#[test]
fn an_initial_velocity_without_a_value_at_a_face_is_refused() {
    let found = refused(&format!("{BOX}[initial]\nvelocity = [\"0/(x - 0.5)\", 0.0]\n"));
    assert!(found.contains("initial.velocity"), "{found}");
}

/// A large scene is checked without its fields, and its steps are those of a grid with as narrow
/// cells.
#[test]
fn a_large_scene_is_not_tried() {
    let plan = |cells: usize, size: f64| {
        let text = BOX
            .replace("[32, 32]", &format!("[{cells}, 32]"))
            .replace("[1.0, 1.0]", &format!("[{size}, 1.0]"))
            .replace("end = 1.0", "end = 10.0");
        let more = [
            "sides.x=\"periodic\"",
            "initial.velocity=[0.1, 0.0]",
            "flow.diffusion=\"explicit\"",
            "output.snapshots=1",
        ];
        let more = more.map(String::from);
        Scene::parse("a.toml", &text, &more).unwrap_or_else(|e| panic!("{e}")).plan().unwrap()
    };
    let (large, small) = (plan(96_000, 3_000.0), plan(32, 1.0));
    assert!(!large.tried && small.tried, "{large}{small}");
    // Waves of the longer box decay more slowly.
    let ratio = large.steps / small.steps;
    assert!((1.0..1.25).contains(&ratio), "{} {}", large.steps, small.steps);
}

/// Estimated steps are within 1.5 of those made: decaying vortices, a lid, a cylinder that swings
/// and bodies that fall.
#[test]
fn as_many_steps_are_made_as_estimated() {
    for (name, end) in
        [("taylor_green", 5.0), ("cylinder", 1.0), ("oscillating_cylinder", 1.5), ("two_discs", 0.6)]
    {
        let path = root().join(format!("scenes/{name}.toml"));
        let more = [format!("time.end={end}"), "output.images=false".into(), "output.fields=false".into()];
        let scene = Scene::load(&path, &more).unwrap_or_else(|e| panic!("{e}"));
        let out = folder("steps-estimated");
        let made = scene.run(&quiet(&out), &AtomicBool::new(false)).unwrap().result["steps"].as_f64();
        let _ = std::fs::remove_dir_all(&out);
        let ratio = scene.plan().unwrap().steps / made.unwrap();
        assert!((1.0 / 1.5..=1.5).contains(&ratio), "{name}: {ratio}");
    }
}
