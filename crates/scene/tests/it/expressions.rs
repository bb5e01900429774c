//! Formulas without variables wherever a number is needed.
use crate::{folder, plan, problems, quiet, run};

const SCENE: &str = r#"
grid = { cells = [16, "2*4"], size = ["2*PI", "PI"] }
sides = { x = "periodic", y = "wall" }
fluid = { density = "1e3/2", nu = "1.2*5e-4" }
initial = { velocity = ["sin(x)", 0.0] }
time = { steps = "2^2", dt = "1/8" }
output = { snapshots = 0, images = false, fields = false, ledger = false, report = false }
"#;

/// A scene with formulas is the scene with their values, to the bit.
#[test]
fn formulas_are_numbers() {
    let tau = format!("grid.size=[{:?}, {:?}]", std::f64::consts::TAU, std::f64::consts::PI);
    let plain = ["grid.cells=[16, 8]", &tau, "fluid={density=500.0, nu=0.0006}", "time={steps=4, dt=0.125}"];
    assert_eq!(plan(SCENE, &[]).cells, [16, 8]);
    let (one, other) = (folder("formulas"), folder("numbers"));
    let by_formulas = run(SCENE, &[], &quiet(&one)).result;
    let by_numbers = run(SCENE, &plain, &quiet(&other)).result;
    assert_eq!(by_formulas, by_numbers);
    for out in [one, other] {
        std::fs::remove_dir_all(&out).unwrap();
    }
}

#[test]
fn what_is_no_number_is_told_with_its_value() {
    for (change, parts) in [
        ("fluid.nu=\"0.5-1\"", &["fluid.nu", "0 or a number above", "the formula is -0.5"][..]),
        ("fluid.nu=\"2*t\"", &["fluid.nu", "formula without variables", "\"t\", which is neither PI"]),
        ("time.steps=\"5/2\"", &["time.steps", "a whole number", "the formula is 2.5"]),
        ("grid.size=[\"PI\", \"1/0\"]", &["grid.size.1", "finite"]),
    ] {
        let told = problems(SCENE, change);
        assert!(parts.iter().all(|part| told.contains(part)), "{change}: {told}");
    }
}
