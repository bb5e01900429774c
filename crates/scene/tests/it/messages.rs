//! Messages that name the key at fault.
use crate::first_steps::BOX;
use crate::{folder, problems, quiet};
use scene::Scene;
use std::sync::atomic::AtomicBool;

/// Two discs in a box.
fn two() -> String {
    let disc = |x: f64| {
        format!(
            "[[bodies]]\nshape = {{ type = \"disc\", radius = 0.1 }}\ndensity = 2000.0\nposition = [{x}, 0.5]\n"
        )
    };
    format!("{}{}{}", BOX.replace("end = 1.0", "end = 0.1"), disc(0.3), disc(0.7))
}

/// Error of a run.
fn error(text: &str, more: &[&str]) -> String {
    let more: Vec<String> = more.iter().map(|s| (*s).into()).collect();
    let out = folder("messages");
    let scene = Scene::parse("a.toml", text, &more).unwrap_or_else(|e| panic!("{e}"));
    let error = scene.run(&quiet(&out), &AtomicBool::new(false)).unwrap_err().to_string();
    let _ = std::fs::remove_dir_all(&out);
    error
}

#[test]
fn the_key_at_fault_is_named() {
    let spin = error(&two(), &["bodies.0.spin=1e6"]);
    assert!(spin.contains("bodies.0.spin: ") && spin.contains("begins with 1.000e5 m/s"), "{spin}");
    let tether = "bodies.1.tether={ anchor = [0.7, 0.5], stiffness = 1.0, damping = 1e300 }";
    let found = error(&two(), &[tether]);
    assert!(found.contains("bodies.1.tether: ") && found.contains("less stiffness or damping"), "{found}");
    let hard = "materials={ hard = { youngs_modulus = 1e300 } }";
    let found = error(&two(), &[hard, "bodies.1.material=\"hard\"", "bodies.0.position=[0.498, 0.5]"]);
    assert!(found.contains("bodies.1.material: ") && found.contains("smaller Young's modulus"), "{found}");
    let found = problems(&two(), "materials={ odd = { poisson_ratio = -1.0 } }");
    assert!(found.contains("a number above -1, at most 0.5"), "{found}");
}

#[test]
fn inlets_that_do_not_balance_are_told_with_the_direction() {
    let sides = |right: &str| {
        two().replace(
            "x = \"wall\"\n",
            &format!("x_min = {{ type = \"inlet\", velocity = [1.0, 0.0] }}\nx_max = {right}\n"),
        )
    };
    let found = error(&sides("\"wall\""), &[]);
    assert!(found.contains("let 1.000000e0 m³/s more in than out"), "{found}");
    let found = error(&sides("{ type = \"inlet\", velocity = [3.0, 0.0] }"), &[]);
    assert!(found.contains("let 2.000000e0 m³/s more out than in"), "{found}");
}

#[test]
fn files_and_axes_are_named_once_and_by_their_names() {
    let shape = "bodies.0.shape={ type = \"mesh\", file = \"nowhere.stl\" }";
    let text = two()
        .replace("cells = [32, 32]", "cells = [8, 8, 8]")
        .replace("size = [1.0, 1.0]", "size = [1.0, 1.0, 1.0]")
        .replace("y = \"wall\"", "y = \"wall\"\nz = \"wall\"")
        .replace("\"disc\"", "\"sphere\"")
        .replace(", 0.5]", ", 0.5, 0.5]");
    let found = problems(&text, shape);
    assert_eq!(found.matches("nowhere.stl:").count(), 1, "{found}");
    let found = error(&text, &["bodies.0.position=[0.3, 0.5, 3.0]"]);
    assert!(!found.contains("axis 2"), "{found}");
}
