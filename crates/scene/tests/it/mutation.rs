//! Scenes with one or two values, keys or lines mutated: what passes `--check` runs.
use crate::{coarse, folder, quiet, root, scenes};
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use render::cpu::Stopwatch;
use scene::{RunError, Scene};
use std::collections::BTreeMap;
use std::ops::Range;
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use toml::de::{DeTable, DeValue};

/// Values of any kind, many of the wrong one.
const OTHERS: [&str; 24] = [
    "0",
    "-1",
    "1",
    "2",
    "1e300",
    "1e-300",
    "nan",
    "inf",
    "-inf",
    "\"\"",
    "\"x\"",
    "[]",
    "[1, 2, 3, 4]",
    "{}",
    "true",
    "1979-05-27",
    "\"sin(\"",
    "\"1/t\"",
    "\"x\"",
    "\"1e3*t\"",
    "[[1]]",
    "\"periodic\"",
    "{ type = \"wall\" }",
    "99999999999999999999",
];
/// Factors of a slip in units or in digits.
const FACTORS: [f64; 14] = [-1.0, 0.0, 1e-9, 1e-6, 1e-3, 1e-2, 0.1, 0.5, 2.0, 10.0, 100.0, 1e3, 1e6, 1e9];
/// Formulas of place and time that may go where a number goes.
const FORMULAS: [&str; 10] =
    ["sin(t)", "1/t", "1/x", "log(y)", "sqrt(-x)", "exp(1e3*t)", "x*y", "1e6*sin(1e4*t)", "x/0", "0*t"];
/// Paths that lead nowhere, or to something else.
const PATHS: [&str; 5] = ["nowhere.stl", "/dev/null", "README.md", "../scenes", "cavity.toml"];

/// Place of a value in the text, and whether it is a number or a text.
struct Leaf {
    span: Range<usize>,
    number: Option<f64>,
    text: Option<String>,
}

fn leaves(value: &DeValue<'_>, span: Range<usize>, out: &mut Vec<Leaf>) {
    match value {
        DeValue::Table(table) => table.iter().for_each(|(_, v)| leaves(v.get_ref(), v.span(), out)),
        DeValue::Array(items) => items.iter().for_each(|v| leaves(v.get_ref(), v.span(), out)),
        DeValue::Float(x) => out.push(Leaf { span, number: x.as_str().parse().ok(), text: None }),
        DeValue::Integer(n) => out.push(Leaf { span, number: n.as_str().parse().ok(), text: None }),
        DeValue::String(s) => out.push(Leaf { span, number: None, text: Some(s.to_string()) }),
        _ => out.push(Leaf { span, number: None, text: None }),
    }
}

/// The text with one mutation, and what it is.
fn mutated(text: &str, rng: &mut Pcg64) -> (String, String) {
    let mut all = Vec::new();
    if let Ok(table) = DeTable::parse(text) {
        table.get_ref().iter().for_each(|(_, v)| leaves(v.get_ref(), v.span(), &mut all));
    }
    let keys: Vec<_> =
        text.lines().enumerate().filter(|(_, l)| l.contains('=') && !l.starts_with('#')).collect();
    let kind = rng.random_range(0..10);
    if kind >= 2
        && let Some(leaf) = all.choose(rng)
    {
        let new = match (kind, leaf.number, &leaf.text) {
            (2 | 3, ..) => (*OTHERS.choose(rng).unwrap_or(&"0")).to_owned(),
            (4, Some(_), _) => format!("\"{}\"", FORMULAS.choose(rng).unwrap_or(&"t")),
            (_, Some(x), _) => {
                let x = x * FACTORS.choose(rng).unwrap_or(&1.0);
                if x.fract() == 0.0 && x.abs() < 1e15 { format!("{x}") } else { format!("{x:?}") }
            }
            (4..7, _, Some(text)) if text.contains('.') => {
                format!("\"{}\"", PATHS.choose(rng).unwrap_or(&""))
            }
            (.., Some(_)) => match all.iter().filter_map(|l| l.text.as_ref()).collect::<Vec<_>>().choose(rng)
            {
                Some(other) => format!("{other:?}"),
                None => "\"\"".into(),
            },
            _ => "false".into(),
        };
        let line = text[..leaf.span.start].lines().count();
        let what = format!("line {line}: {} becomes {new}", &text[leaf.span.clone()]);
        return (format!("{}{new}{}", &text[..leaf.span.start], &text[leaf.span.end..]), what);
    }
    let Some(&(at, line)) = keys.choose(rng) else { return (text.into(), "nothing".into()) };
    let other = keys.choose(rng).map_or("", |k| k.1);
    let put = |new: &dyn Fn(&str) -> String| {
        let lines = text.lines().enumerate().map(|(i, l)| if i == at { new(l) } else { l.to_owned() });
        lines.collect::<Vec<_>>().join("\n")
    };
    match rng.random_range(0..3) {
        0 => (put(&|_| String::new()), format!("line {}: without {line}", at + 1)),
        1 => (put(&|l| format!("{l}\n{l}")), format!("line {}: twice {line}", at + 1)),
        _ => (put(&|l| format!("{l}\n{other}")), format!("line {}: followed by {other}", at + 1)),
    }
}

/// Outcome of a mutated scene.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Fate {
    Refused,
    Passed,
    Ran,
    /// Passed the check, refused by the run.
    Broken,
    NotFinite,
    Slow,
    Died,
}

/// Checks mutated scene number `seed`, and runs it for some time if it has no more than so many
/// cells.
fn fate(all: &[(std::path::PathBuf, String)], seed: u64, run: Option<(Duration, usize)>) -> (Fate, String) {
    let mut rng = Pcg64::seed_from_u64(seed);
    let (path, text) = &all[rng.random_range(0..all.len())];
    let (mut text, mut what) = mutated(text, &mut rng);
    if rng.random_bool(0.3) {
        let (more, also) = mutated(&text, &mut rng);
        (text, what) = (more, format!("{what}; {also}"));
    }
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let told = |fate, why: &str| (fate, format!("{name}, {what}\n    {}", why.replace('\n', "\n    ")));
    println!("{name}, {what}");
    let start = Stopwatch::start();
    let name = path.display().to_string();
    let scene = match Scene::parse(&name, &text, &[]) {
        Ok(scene) => scene,
        Err(problems) => return told(Fate::Refused, &problems.to_string()),
    };
    let checked = scene.plan();
    let took = start.elapsed().cpu;
    if took > 10.0 {
        return told(Fate::Slow, &format!("{took} CPU s for the check"));
    }
    let plan = match checked {
        Ok(plan) => plan,
        Err(error) => return told(Fate::Refused, &error.to_string()),
    };
    let small = |&(_, most): &(Duration, usize)| plan.cells.iter().product::<usize>() <= most;
    let Some((longest, _)) = run.filter(small) else { return told(Fate::Passed, "") };
    let out = folder("mutated");
    let stop = Arc::new(AtomicBool::new(false));
    let flag = stop.clone();
    std::thread::spawn(move || {
        std::thread::sleep(longest);
        flag.store(true, Ordering::Relaxed);
    });
    let start = Instant::now();
    let ran = scene.run(&quiet(&out), &stop);
    let took = start.elapsed();
    let _ = std::fs::remove_dir_all(&out);
    match ran {
        // A folder that cannot be written to is no matter of the scene.
        Err(RunError::Build(error)) => told(Fate::Broken, &error.to_string()),
        Err(error) => told(Fate::Broken, &error.to_string()),
        Ok(result)
            if ["bodies", "flow"]
                .iter()
                .filter_map(|key| result.result.get(key))
                .any(|part| part.to_string().contains("null")) =>
        {
            told(Fate::NotFinite, &result.result.to_string())
        }
        Ok(_) if took > longest + Duration::from_secs(10) => told(Fate::Slow, &format!("{took:?} to stop")),
        Ok(_) => told(Fate::Ran, ""),
    }
}

fn inputs() -> Vec<(std::path::PathBuf, String)> {
    scenes().into_iter().map(|(path, text)| (path, coarse(&text))).collect()
}

fn number(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|n| n.parse().ok()).unwrap_or(default)
}

/// The scenes FIRST to LAST, each with its fate in a line; a process of its own, as it may be
/// killed.
#[test]
#[ignore = "part of `mutations_at_large`"]
fn mutations_of_a_range() {
    let all = inputs();
    let seconds = number("RUN", 0);
    for seed in number("FIRST", 0)..number("LAST", 0) {
        println!("\nbegin {seed}");
        let (fate, what) =
            fate(&all, seed, (seconds > 0).then(|| (Duration::from_secs(seconds), usize::MAX)));
        println!("\nend {seed} {fate:?} {what}");
    }
}

/// Fates of a range of scenes; one that ends the process is [`Fate::Died`].
fn fates(first: u64, last: u64, run: u64, longest: Duration) -> Vec<(u64, Fate, String)> {
    let mut out = Vec::new();
    let mut next = first;
    while next < last {
        let file = std::env::temp_dir().join(format!("siltflow-mutation-{}-{next}", std::process::id()));
        let log = std::fs::File::create(&file).expect("a file for the output");
        let mut child = Command::new(std::env::current_exe().expect("this test's path"))
            .args(["--ignored", "--exact", "mutation::mutations_of_a_range", "--nocapture"])
            .env("FIRST", next.to_string())
            .env("LAST", last.to_string())
            .env("RUN", run.to_string())
            .current_dir(root())
            .stdout(log.try_clone().expect("the same file"))
            .stderr(log)
            .spawn()
            .expect("this test again");
        let mut began = (next, Instant::now());
        let killed = loop {
            std::thread::sleep(Duration::from_millis(50));
            let text = std::fs::read_to_string(&file).unwrap_or_default();
            let now = text.rsplit("\nbegin ").next().and_then(|t| t.split_whitespace().next()?.parse().ok());
            if now.is_some_and(|now| now != began.0) {
                began = (now.unwrap_or(next), Instant::now());
            }
            if child.try_wait().expect("a child").is_some() {
                break false;
            }
            if began.1.elapsed() > longest {
                let _ = child.kill();
                let _ = child.wait();
                break true;
            }
        };
        let text = std::fs::read_to_string(&file).unwrap_or_default();
        let _ = std::fs::remove_file(&file);
        let mut seen = next;
        for part in text.split("\nend ").skip(1) {
            let part = part.split("\nbegin ").next().unwrap_or("");
            let (number, rest) = part.split_once(' ').unwrap_or((part, ""));
            let Ok(number) = number.parse::<u64>() else { continue };
            let (fate, what) = rest.split_once(' ').unwrap_or((rest, ""));
            let fate = match fate {
                "Refused" => Fate::Refused,
                "Passed" => Fate::Passed,
                "Ran" => Fate::Ran,
                "Broken" => Fate::Broken,
                "NotFinite" => Fate::NotFinite,
                _ => Fate::Slow,
            };
            out.push((number, fate, what.trim_end().to_owned()));
            seen = number + 1;
        }
        if seen < last {
            let end: String = text.lines().rev().take(12).collect::<Vec<_>>().join("\n    ");
            out.push((seen, if killed { Fate::Slow } else { Fate::Died }, end));
            seen += 1;
        }
        next = seen;
    }
    out
}

fn report(fates: &[(u64, Fate, String)]) -> BTreeMap<Fate, usize> {
    let mut table = BTreeMap::new();
    for (seed, fate, what) in fates {
        *table.entry(fate.clone()).or_default() += 1;
        if !matches!(fate, Fate::Refused | Fate::Passed | Fate::Ran) {
            println!("{seed} {fate:?}: {what}");
        }
    }
    println!("{table:?}");
    table
}

/// A sample of [`mutations_at_large`]: nothing panics, and what passes runs. Times are those of all
/// tests of the process and tell nothing.
#[test]
fn mutated_scenes_that_pass_run() {
    let all = inputs();
    let (mut passed, mut broken) = (0, vec![]);
    for seed in 0..150 {
        let run = (passed < 12).then_some((Duration::from_millis(200), 20_000));
        let (fate, what) = fate(&all, seed, run);
        match fate {
            Fate::Refused => {}
            Fate::Passed | Fate::Ran | Fate::Slow => passed += 1,
            Fate::Broken => broken.push(what),
            other => panic!("{seed} {other:?}: {what}"),
        }
    }
    assert!(passed >= 20 && broken.len() <= 1, "{passed} passed: {broken:?}");
}

/// CHECKS scenes are checked, RUNS that pass are run for SECONDS:
/// `cargo test -p siltflow-scene --release --test it mutations_at_large -- --ignored --nocapture`.
#[test]
#[ignore = "minutes"]
fn mutations_at_large() {
    let (first, checks, runs) = (number("SEED", 0), number("CHECKS", 5000), number("RUNS", 400));
    let checked = fates(first, first + checks, 0, Duration::from_secs(20));
    let table = report(&checked);
    let bad = |table: &BTreeMap<Fate, usize>, fate| table.get(&fate).copied().unwrap_or(0);
    let mut wrong = bad(&table, Fate::Died) + bad(&table, Fate::Slow);
    let passed = checked.iter().filter(|(_, fate, _)| *fate == Fate::Passed).take(runs as usize);
    let seconds = number("SECONDS", 3);
    let ran: Vec<_> = passed
        .flat_map(|&(seed, ..)| fates(seed, seed + 1, seconds, Duration::from_secs(seconds + 30)))
        .collect();
    let table = report(&ran);
    wrong += bad(&table, Fate::Died) + bad(&table, Fate::Slow) + bad(&table, Fate::NotFinite);
    assert_eq!(wrong, 0);
    assert!(bad(&table, Fate::Broken) <= (runs as usize * 3).div_ceil(400), "{table:?}");
}
