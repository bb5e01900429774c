//! The books of a scene: momentum to round-off, energy to the step's second order.
use crate::{folder, quiet, root, run};
use scene::Options;

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

/// Lets the disc begin at rest.
const GENTLY: [&str; 2] =
    ["bodies.0.motion.shift=['0.1*(1-cos(4*t))', 0.0]", "bodies.0.motion.angle='0.5*(1-cos(3*t))'"];

/// The ledger of that scene with `more` set.
fn books(name: &str, more: &[&str]) -> impl Fn(&str) -> f64 + use<> {
    let out = folder(name);
    let result = run(DRIVEN, more, &quiet(&out)).result;
    std::fs::remove_dir_all(&out).unwrap();
    move |key| result["ledger"][key].as_f64().unwrap()
}

/// What is left of the energy over all the work.
fn left(of: &impl Fn(&str) -> f64) -> f64 {
    of("energy_residual") / (of("work") + of("side_work") + of("driving_work"))
}

/// All at once: the disc starts with 0.4 m/s in a fluid at rest, and so does the lid.
#[test]
fn books_of_a_driven_body_with_buoyancy_balance() {
    let of = books("driven", &[]);
    let terms = ["work", "side_work", "driving_work", "inner_work", "dissipation", "forcing_loss"];
    let told: Vec<String> = terms.iter().map(|key| format!("{key} {:.3e}", of(key))).collect();
    assert!(of("momentum_worst_step") < 1e-13, "{told:?}");
    assert!(left(&of).abs() < 1e-3, "{:.2e} {told:?}", left(&of));
    // None of them is small beside what may be left.
    assert!(terms.iter().all(|key| of(key).abs() > 4e-3), "{told:?}");
    // The fluid that is set moving at once takes half of what the disc gives: ½ρ(V + V) U², a little more between walls.
    let shock = 1.2 * std::f64::consts::PI * 0.15_f64.powi(2) * 0.4 * 0.4;
    assert!((0.9..1.4).contains(&(of("forcing_loss") / shock)), "{told:?}");
}

/// From rest, half the step leaves a quarter of the energy's error, and the forcing loses at most half as much.
#[test]
fn what_is_left_of_the_energy_vanishes_with_the_step() {
    let run = |dt: f64| {
        let dt = format!("time.dt={dt}");
        let of = books(&dt, &[GENTLY[0], GENTLY[1], &dt]);
        [left(&of).abs(), of("forcing_loss") / of("driving_work")]
    };
    let [coarse, fine] = [4e-3, 2e-3].map(run);
    assert!(fine[0] < 2e-5 && coarse[0] / fine[0] > 3.5, "{coarse:?} {fine:?}");
    assert!(coarse[1] / fine[1] > 2.0, "{coarse:?} {fine:?}");
}

/// A disc that turns drags the fluid inside along late: without that in the books a tenth of the work is missing.
#[test]
fn fluid_inside_a_turning_disc_is_in_the_books() {
    let still =
        ["bodies.0.motion.shift=[0.0, 0.0]", GENTLY[1], "sides.y_max.velocity=[0.0, 0.0]", "time.dt=4e-3"];
    let of = books("turning", &still);
    assert!(of("inner_work") > 0.1 * of("driving_work"), "{:e}", of("inner_work"));
    assert!(left(&of).abs() < 3e-5, "{:.2e}", left(&of));
}

/// Books that are closed and opened again are the same, bit for bit.
#[test]
fn books_go_on_after_an_interruption() {
    let [whole, halves] = ["books-whole", "books-halves"].map(folder);
    // A start whose velocity, a difference over a part of the run, is 0 whatever its end.
    let ledger = |more: &[&str], options: &Options| {
        run(DRIVEN, &[&GENTLY, more].concat(), options).result["ledger"].clone()
    };
    let all = ledger(&["output.snapshots=2"], &quiet(&whole));
    let half = ledger(&["time.end=0.5"], &quiet(&halves));
    let rest = ledger(&["output.snapshots=2"], &Options { resume: true, ..quiet(&halves) });
    [whole, halves].iter().for_each(|out| std::fs::remove_dir_all(out).unwrap());
    assert_eq!(all, rest);
    assert_ne!(half, rest);
}

/// Twelve polyhedra settle in a closed box onto one another: none leaves it, momentum is kept to
/// round-off, and energy but for what 6 cells per body do not resolve.
#[test]
fn books_of_settling_polyhedra_balance() {
    let out = folder("settling");
    let text = std::fs::read_to_string(root().join("scenes/sedimenting_polyhedra.toml")).unwrap();
    let more = [
        "sides.x='wall'",
        "sides.y='wall'",
        "grid.cells=[30, 30, 60]",
        "factories.0.number=12",
        "factories.0.region.lower=[0, 0, 0]",
        "factories.0.region.upper=[0.01, 0.01, 0.008]",
        "time.end=0.12",
        "output.snapshots=2",
        "output.fields=false",
        "output.images=false",
    ];
    let result = run(&text, &more, &quiet(&out)).result;
    let paths = std::fs::read_to_string(out.join("trajectories.csv")).unwrap();
    std::fs::remove_dir_all(&out).unwrap();
    let of = |key: &str| result["ledger"][key].as_f64().unwrap();
    assert!(of("momentum_worst_step") < 1e-12 && of("momentum_whole_run") < 1e-12, "{}", result["ledger"]);
    assert!(of("divergence") < 1e-12 && of("work") > 0.0, "{}", result["ledger"]);
    assert!(left(&of).abs() < 0.05, "{}", left(&of));
    assert!(result["contacts"].as_u64().unwrap() >= 10, "{result}");
    let rows: Vec<&str> = paths.lines().collect();
    for row in &rows[rows.len() - 12..] {
        let x: Vec<f64> = row.split(',').skip(2).take(3).map(|x| x.parse().unwrap()).collect();
        assert!(x.iter().zip([0.01, 0.01, 0.02]).all(|(x, end)| (0.0..end).contains(x)), "{row}");
    }
}
