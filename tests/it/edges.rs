//! The crates may depend on one another only as docs/architecture.md draws it.
use serde_json::Value;
use std::collections::BTreeSet;
use std::process::Command;

#[test]
fn crates_meet_only_through_interfaces() {
    let out = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--no-deps", "--offline"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo metadata runs");
    let metadata: Value = serde_json::from_slice(&out.stdout).expect("cargo metadata prints JSON");
    let packages = metadata["packages"].as_array().expect("packages");
    // Packages are named `siltflow-dem` and so on, their libraries `dem`.
    let name = |p: &Value| {
        let package = p["name"].as_str().expect("name");
        package.strip_prefix("siltflow-").unwrap_or(package).to_owned()
    };
    let all: BTreeSet<String> = packages.iter().map(name).collect();
    for crate_ in [
        "siltflow",
        "interfaces",
        "monomorphic",
        "fv-mesh",
        "ibm",
        "dem",
        "mor",
        "turb",
        "coupling",
        "render",
        "report",
        "scene",
        "validation",
    ] {
        assert!(all.contains(crate_), "{crate_} is gone");
    }
    for package in packages {
        let from = name(package);
        for dependency in package["dependencies"].as_array().expect("dependencies") {
            let to = name(dependency);
            // A crate may ask itself, for its tests, to take all its features.
            if all.contains(&to) && to != from {
                let allowed = match (from.as_str(), to.as_str()) {
                    // Cases of validation stay out of the libraries and of the command.
                    (_, "validation") => from == "siltflow" && dependency["kind"] == "dev",
                    // Pictures are for what shows runs; their tests draw shapes.
                    ("siltflow", "render") => dependency["kind"] == "dev" || dependency["optional"] == true,
                    ("validation" | "report" | "scene", "render") => true,
                    ("siltflow", "report") => dependency["optional"] == true,
                    ("scene", "report") => true,
                    (_, "render" | "report") | ("report", _) => false,
                    ("render", "dem") => dependency["kind"] == "dev",
                    ("siltflow", "scene") => dependency["optional"] == true,
                    ("siltflow", _) => true,
                    (_, "scene") => false,
                    ("coupling" | "validation" | "scene", _) => to != "siltflow",
                    ("interfaces" | "monomorphic", _) => false,
                    // Knows nobody, so nobody meets there.
                    (_, "monomorphic") => true,
                    _ => to == "interfaces",
                };
                assert!(allowed, "{from} must not depend on {to}");
            }
        }
    }
}
