//! Contacts of scenes: belts, deep overlaps, bodies without contacts.
use crate::{folder, quiet, run};
use serde_json::Value;

/// A parcel on the lower side, whose `wall` and surroundings are to be filled in.
fn parcel(more: &str) -> String {
    format!(
        r#"
gravity = [0.0, -9.81]
grid = {{ cells = [40, 10], size = [0.8, 0.2] }}
materials.m = {{ density = 1000.0, youngs_modulus = 1e7, friction = 0.3 }}
contact = {{ wall_material = "m"{more} }}
time = {{ end = 0.25 }}
output = {{ snapshots = 2, images = false, fields = false }}
[[bodies]]
name = "parcel"
shape = {{ type = "box", edges = [0.06, 0.04] }}
material = "m"
position = [0.1, 0.02]
"#
    )
}
const BELT: &str =
    "sides = { x = \"periodic\", y_min = { type = \"wall\", velocity = [0.5, 0.0] }, y_max = \"wall\" }\n";
const FLOOR: &str = "sides = { x = \"periodic\", y = \"wall\" }\n";

fn velocity(result: &Value) -> f64 {
    result["bodies"][0]["velocity"][0].as_f64().unwrap()
}

/// A side that moves takes bodies along, without and with a fluid, by both laws; so does a plane of `contact.planes`.
#[test]
fn moving_sides_take_bodies_along() {
    let plane =
        ", walls = false, planes = [{ point = [0.0, 0.0], normal = [0.0, 1.0], velocity = [0.5, 0.0] }]";
    let out = folder("belt");
    for (text, more) in [
        (format!("{BELT}{}", parcel("")), &[][..]),
        (format!("{BELT}{}", parcel("")), &["contact.law=\"potential\""]),
        (format!("{FLOOR}{}", parcel(plane)), &[]),
        (format!("{BELT}{}", parcel("")), &["fluid={density=1e-3, nu=1e-3}", "grid.cells=[80, 20]"]),
    ] {
        let result = run(&text, more, &quiet(&out)).result;
        let u = velocity(&result);
        println!("{more:?}: {u:.5} m/s, {}", result["ledger"]);
        assert!((u / 0.5 - 1.0).abs() < 0.01, "{more:?}: {u}");
        if let Some(ledger) = result.get("ledger") {
            // Contacts have given the parcel its energy, in J per metre of depth.
            let work = ledger["contact_work"].as_f64().unwrap();
            assert!((work / (0.5 * 2.4 * 0.25) - 1.0).abs() < 0.05, "{work}");
            assert!(ledger["energy_residual"].as_f64().unwrap().abs() < 0.02 * work);
        }
    }
    std::fs::remove_dir_all(&out).unwrap();
}

/// A velocity out of the plane is an error.
#[test]
fn planes_slide_only() {
    let plane = ", planes = [{ point = [0.0, 0.0], normal = [0.0, 1.0], velocity = [0.5, 0.1] }]";
    let found = crate::problems(&format!("{FLOOR}{}", parcel(plane)), "time.end=0.1");
    assert!(found.contains("at a right angle to `normal`"), "{found}");
}

/// An overlap that is deep is a warning of the plan, of the log and of the results, with the stiffness that avoids it, and that stiffness
/// does avoid it.
#[test]
fn deep_overlaps_are_told() {
    let text = format!("{FLOOR}{}", parcel(""));
    let out = folder("deep");
    let soft = ["materials.m.youngs_modulus=8e3", "materials.m.damping=4.0", "time.end=1.0"];
    let plan = crate::plan(&text, &soft);
    let told = plan.warnings.iter().find(|w| w.contains("will rest")).expect("a warning of the plan");
    println!("{told}");
    assert!(told.contains("body parcel") && told.contains("sides.y_min") && told.contains("youngs_modulus"));
    let result = run(&text, &soft, &quiet(&out)).result;
    let deep = &result["deepest_overlap"];
    println!("{}", deep["warning"]);
    assert_eq!((&deep["body"], &deep["partner"]), (&"body parcel".into(), &"sides.y_min".into()));
    assert!(deep["depth_over_radius"].as_f64().unwrap() > 0.1);
    let log = std::fs::read_to_string(out.join("run.log")).unwrap();
    assert_eq!(log.matches("overlap by").count(), 1, "{log}");
    let stiff = format!("materials.m.youngs_modulus={}", deep["youngs_modulus"]);
    let stiffer = [stiff.as_str(), "materials.m.damping=4.0", "time.end=1.0"];
    assert!(run(&text, &stiffer, &quiet(&out)).result.get("deepest_overlap").is_none());
    assert!(!crate::plan(&text, &stiffer).warnings.iter().any(|w| w.contains("will rest")));
    // Buoyancy bears nearly all of the weight.
    let wet = crate::plan(
        &text,
        &["materials.m.youngs_modulus=8e3", "fluid={density=990.0, nu=1e-6}", "grid.cells=[80, 20]"],
    );
    assert!(!wet.warnings.iter().any(|w| w.contains("will rest")), "{:?}", wet.warnings);
    std::fs::remove_dir_all(&out).unwrap();
}

/// Without a law of contact bodies leave the box, and the plan says so.
#[test]
fn without_a_law_bodies_leave() {
    let text = format!("{FLOOR}{}", parcel(""));
    let none = crate::plan(&text, &["contact.law=\"none\""]);
    assert!(none.warnings.iter().any(|w| w.contains("leave the box")), "{:?}", none.warnings);
    assert!(!crate::plan(&text, &[]).warnings.iter().any(|w| w.contains("leave the box")));
}
