//! Tells the program which compiler made it and for what: `result.json` names both.
use std::process::Command;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let compiler = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let told = Command::new(compiler).arg("--version").output();
    let version = told.map(|out| String::from_utf8_lossy(&out.stdout).trim().to_owned()).unwrap_or_default();
    println!("cargo:rustc-env=SCENE_RUSTC={version}");
    println!("cargo:rustc-env=SCENE_TARGET={}", std::env::var("TARGET").unwrap_or_default());
}
