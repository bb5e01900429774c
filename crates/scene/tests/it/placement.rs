//! Meshes placed by a point of theirs, turns about a pivot, units of length that do not go with the
//! box.
use crate::{folder, problems, quiet, run};
use scene::Scene;
use std::path::Path;

/// A tetrahedron with legs of 1 at (1, 1, 1) in the file: its centre of mass is at (1.25, 1.25,
/// 1.25), that of its box at (1.5, 1.5, 1.5).
const TETRAHEDRON: &str = "v 1 1 1\nv 2 1 1\nv 1 2 1\nv 1 1 2\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

/// Bodies without a fluid in a box of 1 m.
fn text(bodies: &str) -> String {
    format!(
        "grid = {{ cells = [10, 10, 10], size = [1.0, 1.0, 1.0] }}\n\
         sides = {{ x = \"periodic\", y = \"periodic\", z = \"periodic\" }}\n\
         contact = {{ law = \"none\" }}\n{bodies}\n\
         time = {{ end = 0.5, dt = 0.05 }}\noutput = {{ snapshots = 1, images = false }}\n"
    )
}

/// Gives `use_it` the scene `text` with the paths of a tetrahedron and a table, and a folder for
/// results.
fn with_files<T>(text: &str, use_it: impl FnOnce(&str, &Path) -> T) -> T {
    let out = folder("placement");
    std::fs::create_dir_all(&out).unwrap();
    std::fs::write(out.join("tetrahedron.obj"), TETRAHEDRON).unwrap();
    std::fs::write(out.join("table.csv"), "x,y,z\n0.2,0.2,0.2\n0.6,0.2,0.5\n").unwrap();
    let used = use_it(&text.replace("FOLDER", &out.display().to_string()), &out.join("out"));
    std::fs::remove_dir_all(&out).unwrap();
    used
}

/// Bodies at the end of the scene `text`.
fn bodies_at_end(text: &str) -> serde_json::Value {
    with_files(text, |text, out| run(text, &[], &quiet(out)).result["bodies"].clone())
}

fn vector(value: &serde_json::Value) -> [f64; 3] {
    [0, 1, 2].map(|a| value[a].as_f64().unwrap())
}

fn is_near(value: &serde_json::Value, expected: [f64; 3], tolerance: f64) {
    let found = vector(value);
    assert!((0..3).all(|a| (found[a] - expected[a]).abs() < tolerance), "{found:?} {expected:?}");
}

fn mesh(placement: &str) -> String {
    format!("{{ type = \"mesh\", file = \"FOLDER/tetrahedron.obj\", unit = 0.1{placement} }}")
}

/// The point that `placement` chooses is at `position`, and the body is turned about it.
#[test]
fn meshes_are_placed_by_a_point_of_theirs() {
    let placements =
        ["", ", placement = \"centre of mass\"", ", placement = \"box\"", ", placement = \"file\""];
    let places = [0.15, 0.35, 0.55, 0.75];
    let body = |(placement, x): (&str, f64)| {
        format!("    {{ shape = {}, position = [{x}, 0.4, 0.5], orientation = 90.0 }},\n", mesh(placement))
    };
    let all: String = placements.into_iter().zip(places).map(body).collect();
    let bodies = &bodies_at_end(&text(&format!("bodies = [\n{all}]")));
    // The centre of mass from the point, turned by 90° about z.
    for (number, (c, x)) in [0.0, 0.0, -0.025, 0.125].into_iter().zip(places).enumerate() {
        is_near(&bodies[number]["position"], [x - c, 0.4 + c, 0.5 + c], 1e-15);
    }
}

/// The same in tables, and in unions: a cube below the corner of the tetrahedron touches it only by
/// its place in the file.
#[test]
fn tables_and_unions_place_meshes_by_that_point() {
    let file = mesh(", placement = \"file\"");
    let table = format!("factories = [{{ type = \"table\", file = \"FOLDER/table.csv\", shape = {file} }}]");
    let bodies = &bodies_at_end(&text(&table));
    is_near(&bodies[0]["position"], [0.325; 3], 1e-15);
    is_near(&bodies[1]["position"], [0.725, 0.325, 0.625], 1e-15);
    let union = |mesh: &str| {
        let cube = "{ shape = { type = \"box\", edges = [0.1, 0.1, 0.1] }, position = [0.05, 0.05, 0.05] }";
        text(&format!(
            "bodies = [{{ position = [0.5, 0.5, 0.5], shape = {{ type = \"union\", parts = [{{ shape = {mesh} }}, {cube}] }} }}]"
        ))
    };
    is_near(&bodies_at_end(&union(&file))[0]["position"], [0.5; 3], 1e-15);
    let found = with_files(&union(&mesh("")), |text, _| problems(text, "title=\"two\""));
    assert!(found.contains("overlap"), "{found}");
}

/// Bodies of a lattice are wholly in the region, by whichever point they are placed.
#[test]
fn lattices_hold_meshes_whole() {
    let lattice = format!(
        "factories = [{{ type = \"lattice\", distance = 0.3, turned = \"no\", shape = {} }}]",
        mesh(", placement = \"file\"")
    );
    let bodies = &bodies_at_end(&text(&lattice));
    for body in bodies.as_array().unwrap() {
        assert!(vector(&body["position"]).iter().all(|x| (0.025..=1.0 - 0.075).contains(x)), "{body}");
    }
    assert!(bodies[0].is_object());
}

/// A flap about a hinge at its end: the centre of mass is on a circle around it, its velocity ω ×
/// r.
#[test]
fn flaps_turn_about_their_hinge() {
    let flap = "bodies = [{ shape = { type = \"box\", edges = [0.02, 0.2, 0.1] }, position = [0.5, 0.6, 0.5], \
                motion = { type = \"prescribed\", angle = \"0.3 + sin(2*t)\", pivot = [0.5, 0.5, 0.5], shift = [\"0.1*t\", 0.0, 0.0] } }]";
    let bodies = &bodies_at_end(&text(flap));
    let (sin, cos) = 1_f64.sin().sin_cos();
    let rate = 2.0 * 1_f64.cos();
    is_near(&bodies[0]["position"], [0.55 - 0.1 * sin, 0.5 + 0.1 * cos, 0.5], 1e-12);
    is_near(&bodies[0]["velocity"], [0.1 - 0.1 * rate * cos, -0.1 * rate * sin, 0.0], 1e-6);
    is_near(&bodies[0]["spin"], [0.0, 0.0, rate], 1e-6);
    let found = problems(
        &text(flap),
        "bodies.0.motion={type=\"prescribed\", shift=[\"t\", 0.0, 0.0], pivot=[0.0, 0.0, 0.0]}",
    );
    assert!(found.contains("pivot") && found.contains("nothing turns about it"), "{found}");
}

/// A unit of length by which a mesh is larger than the box, or smaller than a cell, is reported
/// with the likely one, whether the scene can be put together or not.
#[test]
fn units_that_do_not_go_with_the_box_are_told() {
    let told = |unit: &str, size: f64, fluid: &str, motion: &str| {
        let shape = mesh("").replace("0.1", unit);
        let text = format!(
            "grid = {{ cells = [16, 16, 16], size = [{size}, {size}, {size}] }}\n{fluid}\n\
             sides = {{ x = \"periodic\", y = \"wall\", z = \"wall\" }}\nforce = [\"1\", 0.0, 0.0]\n\
             bodies = [{{ shape = {shape}, position = [{c}, {c}, {c}], motion = \"{motion}\" }}]\n\
             time = {{ end = 0.5 }}\n",
            c = 0.5 * size
        );
        with_files(&text, |text, _| {
            let plan = Scene::parse("scene.toml", text, &[]).unwrap().plan();
            plan.map_or_else(|error| error.to_string(), |plan| plan.warnings.join("\n"))
        })
    };
    let fluid = "fluid = { nu = 1e-3, density = 1000.0 }";
    for (unit, size, likely) in [("1.0", 2e-3, "1e-3"), ("1.0", 0.05, "0.0254"), ("1e-3", 2.0, "1")] {
        for motion in ["fixed", "free"] {
            let found = told(unit, size, fluid, motion);
            assert!(found.contains(&format!("did you mean unit = {likely}?")), "{unit} {motion}: {found}");
        }
    }
    for size in [1.1, 4.0] {
        assert!(!told("1.0", size, fluid, "fixed").contains("did you mean"));
    }
}
