//! Estimates of plans against what runs take.
use crate::{folder, quiet, root};
use render::cpu::{Stopwatch, peak_memory};
use scene::Scene;
use std::process::Command;
use std::sync::atomic::AtomicBool;

/// Variable that tells a child process its task, `plan` or `run`, a scene file and values to set.
const CHILD: &str = "PLAN_OF";

/// CPU time \[s\], memory \[bytes\] and number of steps that a process of its own finds.
fn child(task: &str, scene: &str) -> [f64; 3] {
    let child = Command::new(std::env::current_exe().unwrap())
        .args(["--ignored", "--exact", "plan::figures", "--nocapture"])
        .env(CHILD, format!("{task} {scene}"))
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&child.stdout);
    let figure = |key: &str| -> f64 {
        let found = told.lines().find_map(|line| line.strip_prefix(key)?.trim().parse().ok());
        found.unwrap_or_else(|| panic!("{scene}: no {key}: {told}"))
    };
    ["cpu", "memory", "steps"].map(figure)
}

/// Steady and unsteady flow, walls by cut links in the plane and in space, a moved body, bodies
/// that fall near walls and behind each other, a pile: memory and steps within 1.3, CPU time within
/// 3, as other tests run at the same time (2 without them).
#[test]
fn runs_take_what_plans_tell() {
    for scene in [
        "taylor_green.toml",
        "bent_channel.toml",
        "oscillating_cylinder.toml time.end=3",
        "packed_bed.toml time.end=0.02",
        "two_discs.toml",
        "drafting_kissing_tumbling.toml time.end=0.15",
        // A disc that walls slow down to half its terminal speed.
        "../src/bin/siltflow/template.toml",
        // Bodies that come in.
        "raining_discs.toml time.end=0.7 output.snapshots=10",
        "hopper.toml time.end=1.0 output.snapshots=5",
    ] {
        let [told, used] = ["plan", "run"].map(|task| child(task, scene));
        let [cpu, memory, steps] = [0, 1, 2].map(|k| told[k] / used[k]);
        assert!((1.0 / 3.0..3.0).contains(&cpu), "{scene}: CPU time {cpu} of that used");
        assert!((1.0 / 1.3..1.3).contains(&memory), "{scene}: memory {memory} of that used");
        assert!((1.0 / 1.3..1.3).contains(&steps), "{scene}: {steps} of the steps made");
    }
}

#[test]
#[ignore = "part of `runs_take_what_plans_tell`"]
fn figures() {
    let child = std::env::var(CHILD).unwrap();
    let mut words = child.split(' ').map(String::from);
    let (task, name) = (words.next().unwrap(), words.next().unwrap());
    let scene = Scene::load(&root().join("scenes").join(name), &words.collect::<Vec<_>>()).unwrap();
    let (cpu, memory, steps) = if task == "plan" {
        let plan = scene.plan().unwrap();
        (plan.cpu.unwrap(), plan.memory.unwrap(), plan.steps)
    } else {
        let (out, watch) = (folder("plan"), Stopwatch::start());
        let result = scene.run(&quiet(&out), &AtomicBool::new(false)).unwrap();
        let cpu = watch.elapsed().cpu;
        std::fs::remove_dir_all(&out).unwrap();
        let made = ["/iterations", "/steps"].iter().find_map(|key| result.result.pointer(key)?.as_f64());
        (cpu, peak_memory().unwrap() as f64, made.unwrap())
    };
    println!("\ncpu {cpu}\nmemory {memory}\nsteps {steps}");
}
