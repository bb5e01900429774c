//! Spoilt scene files.
use crate::{coarse, folder, problems, quiet, root, scenes};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestCaseError, TestRunner};
use scene::Scene;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// One way to spoil a text.
#[derive(Clone, Debug)]
enum Spoil {
    /// The byte at a share of the text becomes another.
    Byte(f64, u8),
    /// A line goes.
    Drop(f64),
    /// A line comes twice.
    Twice(f64),
    /// What stands behind an equals sign becomes something else.
    Value(f64, &'static str),
    /// The name of a key loses its first letter.
    Key(f64),
    /// A digit is put into a number.
    Digit(f64, u8),
    /// The rest is cut off.
    Cut(f64),
}

const VALUES: [&str; 20] = [
    "0",
    "-1",
    "1e300",
    "nan",
    "inf",
    "\"\"",
    "\"x\"",
    "[]",
    "[1, 2, 3, 4]",
    "{}",
    "true",
    "1979-05-27",
    "\"sin(\"",
    "\"1/t\"",
    "[[1]]",
    "1e-300",
    "99999999999999999999",
    "\"periodic\"",
    "{ type = \"wall\" }",
    "'''\n'''",
];

fn spoil() -> impl Strategy<Value = Spoil> {
    let at = || 0.0..1.0;
    prop_oneof![
        (at(), any::<u8>()).prop_map(|(a, b)| Spoil::Byte(a, b)),
        at().prop_map(Spoil::Drop),
        at().prop_map(Spoil::Twice),
        (at(), proptest::sample::select(&VALUES[..])).prop_map(|(a, v)| Spoil::Value(a, v)),
        (at(), proptest::sample::select(&VALUES[..])).prop_map(|(a, v)| Spoil::Value(a, v)),
        at().prop_map(Spoil::Key),
        (at(), b'0'..=b'9').prop_map(|(a, d)| Spoil::Digit(a, d)),
        at().prop_map(Spoil::Cut),
    ]
}

fn spoilt(text: &str, how: &Spoil) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let pick = |share: f64, n: usize| ((share * n as f64) as usize).min(n.saturating_sub(1));
    let on = |share: f64, change: &dyn Fn(&str) -> String, which: &dyn Fn(&str) -> bool| {
        let fit: Vec<usize> = (0..lines.len()).filter(|&i| which(lines[i])).collect();
        let chosen = fit.get(pick(share, fit.len())).copied();
        let line =
            |(i, line): (usize, &&str)| if Some(i) == chosen { change(line) } else { (*line).to_owned() };
        lines.iter().enumerate().map(line).collect::<Vec<_>>().join("\n")
    };
    let is_key = |line: &str| line.contains('=') && !line.trim_start().starts_with('#');
    match *how {
        Spoil::Byte(share, byte) => {
            let mut bytes = text.as_bytes().to_vec();
            let at = pick(share, bytes.len());
            bytes[at] = byte;
            String::from_utf8_lossy(&bytes).into_owned()
        }
        Spoil::Drop(share) => on(share, &|_| String::new(), &|line| !line.trim().is_empty()),
        Spoil::Twice(share) => on(share, &|line| format!("{line}\n{line}"), &|line| !line.trim().is_empty()),
        Spoil::Value(share, value) => {
            on(share, &|line| format!("{} = {value}", line.split('=').next().unwrap_or("")), &is_key)
        }
        Spoil::Key(share) => on(share, &|line| line.chars().skip(1).collect(), &is_key),
        Spoil::Digit(share, digit) => on(
            share,
            &|line| match line.rfind(|c: char| c.is_ascii_digit()) {
                Some(at) => format!("{}{}{}", &line[..at], digit as char, &line[at..]),
                None => line.to_owned(),
            },
            &is_key,
        ),
        Spoil::Cut(share) => {
            let at = pick(share, text.len());
            String::from_utf8_lossy(&text.as_bytes()[..at]).into_owned()
        }
    }
}

/// A thousand spoilt files: whatever is wrong is told with its key or line; what is right after all can be planned, and, if it is small,
/// makes a step. Nothing panics, nothing takes ten seconds.
#[test]
fn spoilt_scenes_are_told_about() {
    let all: Vec<_> = scenes().into_iter().map(|(path, text)| (path, coarse(&text))).collect();
    for (path, text) in &all {
        Scene::parse(&path.display().to_string(), text, &[]).unwrap_or_else(|e| panic!("{e}"));
    }
    let strategy = (0..all.len(), proptest::collection::vec(spoil(), 1..3));
    let mut runner = TestRunner::new(Config { cases: 1000, failure_persistence: None, ..Config::default() });
    let out = folder("spoilt");
    let stop = AtomicBool::new(false);
    let result = runner.run(&strategy, |(which, spoils)| {
        let (path, text) = &all[which];
        let text = spoils.iter().fold(text.clone(), |text, how| spoilt(&text, how));
        let start = Instant::now();
        match Scene::parse(&path.display().to_string(), &text, &[]) {
            Err(problems) => {
                prop_assert!(problems.count() > 0);
                for (line, _, message) in problems.iter() {
                    prop_assert!(line >= 1 && line <= text.lines().count() + 1, "line {line}: {problems}");
                    prop_assert!(message.len() > 10, "{message}");
                }
                prop_assert!(problems.to_string().contains(".toml:"));
            }
            Ok(scene) => match scene.plan() {
                Err(error) => prop_assert!(error.to_string().len() > 10),
                Ok(plan) if plan.cells.iter().product::<usize>() < 5000 && plan.bodies < 100 => {
                    let short = [
                        "time.end=1e-9",
                        "output.snapshots=0",
                        "output.images=false",
                        "output.fields=false",
                        "flow.iterations=2",
                    ];
                    let short = short.map(String::from);
                    if let Ok(scene) = Scene::parse(&path.display().to_string(), &text, &short)
                        && let Err(error) = scene.run(&quiet(&out), &stop)
                    {
                        prop_assert!(error.to_string().len() > 10);
                    }
                }
                Ok(_) => {}
            },
        }
        let took = start.elapsed();
        if took > Duration::from_secs(10) {
            return Err(TestCaseError::fail(format!("{took:?}")));
        }
        Ok(())
    });
    let _ = std::fs::remove_dir_all(&out);
    result.unwrap();
}

/// What only the libraries know to be wrong has its line, too, in a plan and in a run.
#[test]
fn what_cannot_be_built_has_its_line() {
    let text = r#"
[grid]
cells = [16, 16]
size = [1.0, 1.0]
[sides]
x = "periodic"
y = "wall"
[fluid]
density = 1000.0
nu = 1e-3
[time]
end = 0.1
"#;
    let disc = |radius: f64, x: f64, y: f64| {
        format!(
            "[[bodies]]\nshape = {{ type = \"disc\", radius = {radius} }}\ndensity = 2000.0\nposition = [{x}, {y}]\n"
        )
    };
    let inlet =
        text.replace("x = \"periodic\"", "x_min = { type = \"inlet\", velocity = [V, 0.0] }\nx_max = \"E\"");
    let cases = [
        (disc(0.2, 0.5, 3.0), 13, "bodies.0: body 0 stands 2.200e0 m deep in wall 1"),
        (disc(0.2, 0.5, 0.5) + &disc(0.2, 0.6, 0.5), 17, "bodies.1: bodies 0 and 1 overlap by 3.000e-1 m"),
        (disc(0.8, 0.5, 0.5), 13, "bodies.0: body 0 is 1.600e0 m long along axis x"),
        (disc(0.1, 0.5, 0.5), 13, "bodies.0: body 0 is 2.000e-1 m across, 3.2 cells"),
        (
            "[[factories]]\ntype = \"lattice\"\ndistance = 0.5\nshape = { type = \"disc\", radius = 0.01 }\ndensity = 2000.0\n".into(),
            13,
            "factories.0: body 0 is 2.000e-2 m across",
        ),
        ("[initial]\nvelocity = [0.0, \"log(x - 0.5)\"]\n".into(), 14, "initial.velocity: the initial velocity is NaN at"),
    ];
    let told = |text: &str| {
        let scene = Scene::parse("bad.toml", text, &[]).unwrap_or_else(|e| panic!("{e}"));
        let out = folder("unbuilt");
        let run = scene.run(&quiet(&out), &AtomicBool::new(false)).unwrap_err().to_string();
        let _ = std::fs::remove_dir_all(&out);
        [scene.plan().unwrap_err().to_string(), run]
    };
    for (more, line, message) in cases {
        for found in told(&format!("{text}{more}")) {
            assert!(found.starts_with(&format!("bad.toml:{line}:")) && found.contains(message), "{found}");
        }
    }
    for (speed, end, line, message) in [
        ("1.0", "wall", 5, "m³/s more in than out"),
        ("\"sqrt(-y)\"", "outlet", 6, "sides.x_min.velocity: the formula \"sqrt(-y)\" is NaN at x = 0"),
    ] {
        for found in told(&inlet.replace('V', speed).replace('E', end)) {
            assert!(found.starts_with(&format!("bad.toml:{line}:")) && found.contains(message), "{found}");
        }
    }
}

#[test]
fn steps_and_formulas_without_end_are_told() {
    let cavity = std::fs::read_to_string(root().join("scenes/cavity.toml")).unwrap();
    let found = problems(&cavity, "time.dt=1e-300");
    assert!(found.contains("time.dt: ") && found.contains("steps to time.end; give"), "{found}");
    let late = Scene::parse("cavity.toml", &cavity, &["averages={ start = 1e6 }".into()]).unwrap();
    let warnings = late.plan().unwrap().warnings;
    assert!(warnings.iter().any(|w| w.contains("averages.start = 1000000 s is not before")), "{warnings:?}");
    let found = problems(&cavity, "forces={ start = 1.0 }");
    assert!(found.contains("forces: loads are those on bodies"), "{found}");
    // Whatever is in an override stands in it, not in the file.
    let found = problems(&cavity, "initial.velocity=[\"q\", 0.0]");
    assert!(found.starts_with("--set initial.velocity="), "{found}");
    let long = format!("initial.velocity=[\"x{}\", 0.0]", "+q".repeat(500));
    let found = problems(&cavity, &long);
    assert!(
        found.contains("… asks for \"q\"") && found.split("the formula").nth(1).unwrap().len() < 600,
        "{found}"
    );
}

#[test]
fn so_many_steps_are_made() {
    let cavity = std::fs::read_to_string(root().join("scenes/cavity.toml")).unwrap();
    let text: String = cavity
        .lines()
        .filter(|l| !l.starts_with("end =") && !l.starts_with("snapshots ="))
        .map(|l| format!("{l}\n"))
        .collect();
    let out = folder("steps");
    let small = ["grid.cells=[8, 8]", "output.fields=false", "output.images=false"];
    for (snapshots, steps) in [(None, 77), (Some(11), 77), (Some(0), 13)] {
        let mut more = small.map(String::from).to_vec();
        more.extend([format!("time.steps={steps}"), "time.dt=1e-3".into()]);
        more.extend(snapshots.map(|n| format!("output.snapshots={n}")));
        let scene = Scene::parse("cavity.toml", &text, &more).unwrap_or_else(|e| panic!("{e}"));
        let result = scene.run(&quiet(&out), &AtomicBool::new(false)).unwrap().result;
        assert_eq!(result["steps"], steps);
        assert!((result["time"].as_f64().unwrap() - f64::from(steps) * 1e-3).abs() < 1e-12);
    }
    std::fs::remove_dir_all(&out).unwrap();
    let told = |set: &[&str]| {
        let set: Vec<String> = set.iter().map(|s| (*s).into()).collect();
        Scene::parse("cavity.toml", &text, &set).err().map(|e| e.to_string()).unwrap_or_default()
    };
    assert!(told(&[]).contains("time: how long is the run?"));
    assert!(told(&["time.steps=10"]).contains("time.steps: of which length?"));
    assert!(told(&["time.steps=10", "time.dt=0.1", "time.end=1"]).contains("leave out one of the two"));
    let uneven = told(&["time.steps=77", "time.dt=0.1", "output.snapshots=10"]);
    assert!(
        uneven.contains("output.snapshots: 10 equal intervals of 77 steps") && uneven.contains("7 for"),
        "{uneven}"
    );
}
