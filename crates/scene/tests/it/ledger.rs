//! The books of a scene: momentum to round-off.
use crate::{folder, quiet, run};

/// A disc that is driven to and fro and turned in a box whose lid moves, in a fluid that a scalar makes buoyant.
const DRIVEN: &str = r#"
gravity = [0.0, -9.81]
[grid]
cells = [40, 40]
size = [1.0, 1.0]
[sides]
x = "wall"
y_min = "wall"
y_max = { type = "wall", velocity = [0.3, 0.0] }
[fluid]
density = 1.2
nu = 5e-3
[scalars.warmth]
diffusivity = 5e-3
initial = "exp(-20*((x-0.3)^2+(y-0.2)^2))"
expansion = 0.1
[[bodies]]
name = "disc"
shape = { type = "disc", radius = 0.15 }
density = 2.0
position = [0.5, 0.55]
motion = { type = "prescribed", shift = ["0.1*sin(4*t)", 0.0], angle = "0.5*sin(3*t)" }
[time]
end = 1.0
[output]
snapshots = 1
fields = false
images = false
bodies = false
"#;

/// The ledger of that scene with `more` set.
fn books(name: &str, more: &[&str]) -> impl Fn(&str) -> f64 {
    let out = folder(name);
    let result = run(DRIVEN, more, &quiet(&out)).result;
    std::fs::remove_dir_all(&out).unwrap();
    move |key| result["ledger"][key].as_f64().unwrap()
}

#[test]
fn momentum_of_a_driven_body_with_buoyancy_is_in_the_books() {
    let of = books("driven", &[]);
    let terms =
        ["work", "side_work", "driving_work", "dissipation", "energy_residual", "momentum_worst_step"];
    let told: Vec<String> = terms.iter().map(|key| format!("{key} {:.3e}", of(key))).collect();
    assert!(of("momentum_worst_step") < 1e-10, "{told:?}");
}
