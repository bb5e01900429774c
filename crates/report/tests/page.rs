//! Pages of folders as runs leave them, and of damaged ones.
use report::{Report, ReportError};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// A PNG file of one pixel.
const PIXEL: &[u8] = &[
    0x89, b'P', b'N', b'G', 0x0d, 0x0a, 0x1a, 0x0a, 0, 0, 0, 0x0d, b'I', b'H', b'D', b'R', 0, 0, 0, 1, 0, 0,
    0, 1, 8, 6, 0, 0, 0, 0x1f, 0x15, 0xc4, 0x89,
];

fn plan(cells: u64) -> Value {
    json!({
        "scene": "s", "title": "A <script>alert(1)</script> & \"b\"", "about": "<img src=x onerror=alert(2)>",
        "cells": [cells, cells], "size": [1.0, 1.0], "steady": false, "end": 1.0, "case": "0123",
        "warnings": ["<b>narrow</b> cells"], "overrides": ["fluid.nu=<i>"],
        "parts": [{ "name": "flow", "active": true, "about": "projection" }],
        "references": [{ "name": "drag", "pointer": "/forces/0/coefficients/mean/0", "value": 1.1, "source": "Someone 1999" }],
        "tables": ["history.csv", "forces.csv", "images.csv"],
    })
}

fn result(cells: u64, drag: f64) -> Value {
    json!({
        "scene": "s", "title": "A <script>alert(1)</script> & \"b\"", "complete": true, "ending": "done",
        "dimension": 2, "cells": [cells, cells], "time": 1.0, "end": 1.0, "steps": 3,
        "step": { "shortest": 0.3, "longest": 0.4, "courant": 0.2 },
        "forces": [{ "body": "</script><b>", "coefficient_per_newton": 2.0,
            "coefficients": { "mean": [drag, 0.0, 0.0] }, "load": { "mean": [drag / 2.0, 0.0, 0.0] } }],
        "references": [{ "name": "drag", "found": drag, "reference": 1.1, "error": drag / 1.1 - 1.0, "source": "Someone 1999" }],
    })
}

/// Folder of a whole run.
fn run(parent: &Path, name: &str, cells: u64, drag: f64) -> std::path::PathBuf {
    let folder = parent.join(name);
    fs::create_dir_all(folder.join("images")).unwrap();
    let write = |name: &str, text: String| fs::write(folder.join(name), text).unwrap();
    write("plan.json", plan(cells).to_string());
    write("result.json", result(cells, drag).to_string());
    write("timings.json", json!({ "wall": 2.0, "cpu": 1.9, "threads": 1, "output": 0.1, "ledger": 0.0, "modules": { "pressure": 1.0 } }).to_string());
    write("scene.toml", "title = \"</pre><script>alert(3)</script>\"\n".into());
    write("run.log", "      0.00 running s\n      1.00 warning: deep <overlap>\n      2.00 done\n".into());
    write(
        "history.csv",
        "# units\ntime,step,dt,courant,kinetic_energy\n0.3,1,0.3,0.2,1\n0.6,2,0.3,0.2,2\n".into(),
    );
    write("forces.csv", "# units\ntime,body,fx,fy,fz,tx,ty,tz\n0.3,</script><b>,0.5,0,0,0,0,0\n0.6,</script><b>,0.6,0,0,0,0,0\n".into());
    write("images.csv", "# units\ntime,picture\n0,00000.png\n1,00001.png\n".into());
    for i in 0..2 {
        fs::write(folder.join(format!("images/{i:05}.png")), PIXEL).unwrap();
    }
    folder
}

fn page<P: AsRef<Path>>(folders: &[P]) -> String {
    Report::read(folders).unwrap().html()
}

#[test]
fn texts_of_a_scene_are_no_markup() {
    let parent = TempDir::new().unwrap();
    let html = page(&[run(parent.path(), "a", 8, 1.0)]);
    for text in
        ["<script>alert", "<img src=x", "<b>narrow", "<overlap>", "nu=<i>", "</script><b>", "</pre><script>"]
    {
        assert!(!html.contains(text), "{text}");
    }
    assert!(
        html.contains("A &lt;script&gt;alert(1)&lt;/script&gt; &amp; &quot;b&quot;</h1>"),
        "{}",
        &html[..3000]
    );
    assert!(html.contains("deep &lt;overlap&gt;"));
}

#[test]
fn a_whole_run_lacks_nothing() {
    let parent = TempDir::new().unwrap();
    let html = page(&[run(parent.path(), "a", 8, 1.0)]);
    assert!(!html.contains("What this report lacks"), "{html}");
    for text in [
        "done at t = 1 s after 3 steps",
        "reference: drag (Someone 1999)",
        "dashed line",
        "−9.09 %",
        "projection",
        "t = 1 s",
        "Courant number",
    ] {
        assert!(html.contains(text), "{text}");
    }
    // Nothing is fetched.
    for text in ["http://", "https://", "url(", "@import", "src=\"/"] {
        assert!(!html.replace("http://www.w3.org/2000/svg", "").contains(text), "{text}");
    }
}

/// A body that touches another has charts of its contacts; one without contacts has none.
#[test]
fn averages_loads_and_models_are_shown() {
    let parent = TempDir::new().unwrap();
    let folder = run(parent.path(), "a", 8, 1.0);
    let (mut plan, mut result) = (plan(8), result(8, 1.0));
    plan["tables"] = json!(["history.csv", "forces.csv", "images.csv", "trajectories.csv", "profile.csv"]);
    result["models"] = json!([{ "model": "wake", "kind": "spodiann", "field": "lambda", "ranks": [5, 3],
        "snapshots": 201, "training": { "total": 0.0104 }, "held_out": { "total": 0.0123 } }]);
    let write = |name: &str, text: String| fs::write(folder.join(name), text).unwrap();
    write("plan.json", plan.to_string());
    write("result.json", result.to_string());
    let head = "time,body,x,y,z,vx,vy,vz,wz,tz,fcx,fcy,tcz";
    write(
        "trajectories.csv",
        format!("{head}\n0,d,0,0,0,0,0,0,0,0.1,0,0.5,0\n1,d,0,0,0,0,0,0,0,0.2,0,0.6,0\n"),
    );
    write("profile.csv", "# units\ny,u,v,p,uu,vv,uv\n0.25,1,0,3,1,2,0.1\n0.75,2,0,3,1,2,0.2\n".into());
    let html = page(&[&folder]);
    assert!(!html.contains("What this report lacks"), "{html}");
    for text in [
        "Torque of the fluid about z",
        "Contact force along y",
        "Mean velocity along y",
        "Reynolds stresses along y",
        "Reduced models",
        "5 + 3",
        "1.04 %",
        "1.23 %",
    ] {
        assert!(html.contains(text), "{text}");
    }
    assert!(!html.contains("Contact force along x") && !html.contains("Contact torque"));
}

#[test]
fn what_is_missing_or_damaged_is_named() {
    let parent = TempDir::new().unwrap();
    let folder = run(parent.path(), "a", 8, 1.0);
    fs::remove_file(folder.join("forces.csv")).unwrap();
    fs::remove_file(folder.join("scene.toml")).unwrap();
    fs::write(folder.join("timings.json"), "{\"wall\": ").unwrap();
    fs::write(
        folder.join("history.csv"),
        "time,step,dt,courant,kinetic_energy\n0.1,1,0.1,0.2,NaN\n0.2,2,0.1",
    )
    .unwrap();
    fs::write(folder.join("trajectories.csv"), "time,body,x\n0,old,1\n").unwrap();
    let html = page(&[&folder]);
    for text in [
        "forces.csv is not there, although the run writes it",
        "scene.toml is not there",
        "timings.json is damaged",
        "history.csv: 1 rows have not as many values as its head and are left out; 1 values are no finite numbers",
        "trajectories.csv is not a table of this run",
        "no value of Kinetic energy can be drawn",
    ] {
        assert!(html.contains(text), "{text}");
    }
}

#[test]
fn a_run_without_results_is_shown() {
    let parent = TempDir::new().unwrap();
    let folder = run(parent.path(), "a", 8, 1.0);
    fs::remove_file(folder.join("result.json")).unwrap();
    fs::write(folder.join("run.log"), "      2.00 ended by an error: it diverged\n").unwrap();
    let html = page(&[&folder]);
    assert!(html.contains("ended by an error: it diverged") && html.contains("not in the results"));
    assert!(html.contains("result.json is not there"));
}

#[test]
fn other_folders_are_errors() {
    let parent = TempDir::new().unwrap();
    assert!(matches!(Report::read::<&Path>(&[]), Err(ReportError::NoRun)));
    assert!(matches!(Report::read(&[parent.path()]), Err(ReportError::NotARun(_))));
    assert!(matches!(Report::read(&[parent.path().join("none")]), Err(ReportError::Folder { .. })));
    let report = Report::read(&[run(parent.path(), "a", 8, 1.0)]).unwrap();
    assert!(matches!(report.write(&parent.path().join("no/folder.html")), Err(ReportError::Write { .. })));
}

/// 1 + h² on 8, 16 and 32 cells: second order, extrapolated to 1.
#[test]
fn runs_that_differ_in_their_grid_are_a_study() {
    let parent = TempDir::new().unwrap();
    let study = |values: [f64; 3]| -> String {
        let cells = [32, 8, 16];
        let folders: Vec<_> = cells
            .iter()
            .zip(values)
            .map(|(n, value)| run(parent.path(), &format!("n{n}"), *n, value))
            .collect();
        page(&folders)
    };
    let value = |n: f64| 1.0 + 1.0 / (n * n);
    let html = study([value(32.0), value(8.0), value(16.0)]);
    assert!(html.contains("Grid study: A &lt;script&gt;") && html.contains("n32, n16, n8"));
    assert!(
        html.contains("<td class=\"n\">2.00</td><td class=\"n\">1<br>"),
        "{}",
        &html[html.find("Grid study").unwrap()..][..4000]
    );
    let html = study([1.0, 1.2, 1.3]);
    assert!(html.contains("not monotone"));
    let two = page(&[parent.path().join("n32"), parent.path().join("n16")]);
    assert!(two.contains("Three grids are needed for an observed order; there are 2."));
    let mut other = plan(8);
    other["case"] = "4567".into();
    fs::write(parent.path().join("n8/plan.json"), other.to_string()).unwrap();
    let html = page(&[parent.path().join("n32"), parent.path().join("n8")]);
    assert!(html.contains("No grid study: no two runs differ in their grid alone"));
}
