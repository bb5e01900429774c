//! Costs of reading, checking and starting scenes of many bodies, and of files with many problems.
use crate::{folder, problems, quiet};
use render::cpu::Stopwatch;
use scene::{Ending, Scene};
use std::fmt::Write;
use std::sync::atomic::AtomicBool;

/// CPU seconds of what `work` does.
fn seconds<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let watch = Stopwatch::start();
    let done = work();
    (watch.elapsed().cpu, done)
}

/// `n` balls that fall from a lattice without a fluid, one step.
fn balls(n: usize) -> String {
    let edge = 2.2e-3 * (n as f64).cbrt().ceil();
    format!(
        r#"
gravity = [0.0, 0.0, -9.81]
grid = {{ cells = [16, 16, 16], size = [{edge}, {edge}, {}] }}
sides = {{ x = "wall", y = "wall", z = "wall" }}
time = {{ steps = 1, dt = 1e-4 }}
output = {{ snapshots = 1, images = false, bodies = false }}
[[factories]]
type = "lattice"
distance = 2.2e-3
number = {n}
shape = {{ type = "sphere", radius = 1e-3 }}
density = 2500.0
"#,
        edge + 2.2e-3
    )
}

/// Checks and runs `n` balls; CPU seconds of both.
fn start(n: usize) -> [f64; 2] {
    let (checked, scene) = seconds(|| {
        let scene = Scene::parse("balls.toml", &balls(n), &[]).unwrap();
        assert_eq!(scene.plan().unwrap().bodies, n);
        scene
    });
    let out = folder("balls");
    let (ran, result) = seconds(|| scene.run(&quiet(&out), &AtomicBool::new(false)).unwrap());
    assert_eq!(result.ending, Ending::Done);
    std::fs::remove_dir_all(&out).unwrap();
    println!("{n} balls: {checked:.2} s to check, {ran:.2} s to run a step");
    [checked, ran]
}

/// Sums over all bodies for each of them would take a minute and more.
#[test]
fn bodies_cost_the_same_however_many_there_are() {
    let [checked, ran] = start(30_000);
    assert!(checked < 8.0 && ran < 16.0, "{checked} {ran}");
}

/// Scenes too large for first steps have as many steps as those that are tried.
#[test]
fn steps_of_scenes_that_are_not_tried_are_estimated() {
    let plan = |n: usize| {
        let text = balls(n).replace("steps = 1, dt = 1e-4", "end = 0.1");
        Scene::parse("balls.toml", &text, &[]).unwrap_or_else(|e| panic!("{e}")).plan().unwrap()
    };
    let [tried, not_tried] = [99_000, 101_000].map(plan);
    assert!(tried.tried && !not_tried.tried);
    assert_eq!(tried.steps, not_tried.steps);
    assert!(not_tried.to_string().contains("not tried"), "{not_tried}");
}

#[test]
#[ignore = "a minute and 6 GB; cargo test --release -p siltflow-scene --test it -- --ignored a_million --nocapture"]
fn a_million_balls_start_within_a_minute() {
    let [checked, ran] = start(1_000_000);
    assert!(checked < 60.0 && ran < 60.0, "{checked} {ran}");
}

/// All problems are counted, some are shown, and each costs the same.
#[test]
fn many_problems_are_told_in_short() {
    let n = 30_000;
    let mut text = String::new();
    (0..n).for_each(|i| writeln!(text, "key_{i} = {i}").unwrap());
    let (taken, told) = seconds(|| {
        let problems = Scene::parse("many.toml", &text, &[]).err().unwrap();
        // The last two are that `grid` and `sides` are missing.
        assert_eq!(problems.count(), n + 2);
        assert_eq!(problems.iter().nth(n - 1).unwrap().0, n);
        problems.to_string()
    });
    assert!(taken < 5.0, "{taken}");
    assert!(told.contains("many.toml:1:1: there is no key \"key_0\"") && told.len() < 100_000);
    assert!(told.ends_with("29952 more problems are not shown; correct these and check the file again"));
}

/// A long list where a number is wanted is shown in part.
#[test]
fn long_values_are_shown_in_part() {
    let list = vec!["1.0"; 10_000].join(", ");
    let told = problems("", &format!("fluid.density=[{list}]"));
    let line = told.lines().find(|line| line.contains("stands here")).unwrap_or_default();
    let message = line.split("fluid.density: ").last().unwrap_or_default();
    assert!(message.starts_with("[1.0, 1.0") && message.len() < 300, "{message}");
}

/// A share of a region that takes more bodies than can be is refused before they are made.
#[test]
fn too_many_bodies_are_refused_at_once() {
    let text = balls(1)
        .replace("\"lattice\"\ndistance = 2.2e-3\nnumber = 1\n", "\"random\"\nfraction = 0.3\n")
        .replace("radius = 1e-3", "radius = 1e-6");
    let (taken, told) = seconds(|| problems(&text, "output.images=false"));
    assert!(
        told.contains("fraction: ") && told.contains("no more than 1.0e7 can be made") && taken < 5.0,
        "{taken} s: {told}"
    );
}
