//! Reports through the command, and in a browser if there is one.
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

fn siltflow(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_siltflow")).args(arguments).output().unwrap()
}

/// Runs the cavity with so many cells along each axis for a second; returns its folder.
fn cavity(parent: &Path, cells: u32, set: &[&str]) -> PathBuf {
    let folder = parent.join(format!("cavity_{cells}"));
    let grid = format!("grid.cells=[{cells}, {cells}]");
    let mut arguments = vec!["run", "cavity", "--quiet", "--out", folder.to_str().unwrap()];
    for set in [&["time.end=1", "output.snapshots=4", "output.image_every=1", &grid], set].concat() {
        arguments.extend(["--set", set]);
    }
    let ran = siltflow(&arguments);
    assert!(ran.status.success(), "{ran:?}");
    folder
}

#[test]
fn a_run_leaves_its_report_unless_the_scene_says_no() {
    let parent = TempDir::new().unwrap();
    let folder = cavity(parent.path(), 16, &[]);
    let page = std::fs::read_to_string(folder.join("report.html")).unwrap();
    for text in [
        "done at t = 1 s",
        "16 × 16 = 256 cells",
        "Ghia et al. 1982",
        "Courant number",
        "data:image/png;base64,",
    ] {
        assert!(page.contains(text), "{text}");
    }
    assert!(!page.contains("What this report lacks"), "{page}");
    let without = cavity(parent.path(), 8, &["output.report=false"]);
    assert!(without.join("result.json").exists() && !without.join("report.html").exists());
    let made = siltflow(&["report", without.to_str().unwrap(), "--json"]);
    let printed: Value = serde_json::from_slice(&made.stdout).unwrap();
    assert_eq!(printed["report"], without.join("report.html").to_str().unwrap());
    assert!(without.join("report.html").exists());
}

#[test]
fn three_grids_are_a_study() {
    let parent = TempDir::new().unwrap();
    let folders = [8, 16, 32].map(|cells| cavity(parent.path(), cells, &["output.report=false"]));
    let page = parent.path().join("study.html");
    let [a, b, c] = folders.each_ref().map(|folder| folder.to_str().unwrap());
    let made = siltflow(&["report", a, b, c, "--out", page.to_str().unwrap()]);
    assert!(made.status.success(), "{made:?}");
    let page = std::fs::read_to_string(&page).unwrap();
    assert!(
        page.contains("Grid study: Lid-driven cavity") && page.contains("cavity_32, cavity_16, cavity_8")
    );
    let none = siltflow(&["report", parent.path().to_str().unwrap()]);
    assert!(none.status.code() == Some(2), "{none:?}");
    assert!(String::from_utf8_lossy(&none.stderr).contains("not the folder of a run"), "{none:?}");
}

/// Program of a browser without windows, if one is installed.
fn browser() -> Option<&'static str> {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    names.into_iter().find(|name| Command::new(name).arg("--version").output().is_ok())
}

/// Collects errors of the page from its beginning.
const FAULTS: &str = "<script>window.faults = []; \
    addEventListener('error', e => faults.push(String(e.message)), true); \
    addEventListener('securitypolicyviolation', e => faults.push(e.blockedURI));</script>";

/// Moves the slider to the start; notes what the page then shows and what it has fetched, once the
/// picture is there: the browser's virtual time waits for what is loaded.
const SLIDE: &str = "<script>\
    const [img, slider] = ['img', 'input'].map(tag => document.querySelector('[data-pictures] ' + tag)); \
    const last = img.src; \
    img.onload = () => document.documentElement.setAttribute('data-seen', JSON.stringify({ \
        faults, changed: img.src !== last, width: img.naturalWidth, hidden: slider.hidden, \
        label: document.querySelector('[data-pictures] output').textContent, \
        fetched: performance.getEntriesByType('resource').map(e => e.name).filter(n => !n.startsWith('data:')), \
        wider: document.documentElement.scrollWidth - innerWidth })); \
    slider.value = 0; slider.dispatchEvent(new Event('input'));</script></body>";

/// No error, nothing fetched, a slider that changes the picture, nothing wider than a telephone.
#[test]
fn a_browser_shows_the_report() {
    let Some(browser) = browser() else {
        eprintln!("skipped: no browser (chromium) is installed");
        return;
    };
    let parent = TempDir::new().unwrap();
    let folder = cavity(parent.path(), 16, &[]);
    let page = std::fs::read_to_string(folder.join("report.html")).unwrap();
    let probed = page.replacen("<head>", &format!("<head>{FAULTS}"), 1).replacen("</body>", SLIDE, 1);
    let file = parent.path().join("probed.html");
    std::fs::write(&file, probed).unwrap();
    let shown = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"])
        .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
        .args([
            "--window-size=500,900",
            "--virtual-time-budget=5000",
            "--enable-logging=stderr",
            "--dump-dom",
        ])
        .arg(format!("--user-data-dir={}", parent.path().join("profile").display()))
        .arg(format!("file://{}", file.display()))
        .output()
        .unwrap();
    let (dom, log) = (String::from_utf8_lossy(&shown.stdout), String::from_utf8_lossy(&shown.stderr));
    assert!(!log.contains(":CONSOLE"), "{log}");
    let seen = dom.split_once("data-seen=\"").and_then(|(_, rest)| rest.split_once('"'));
    let (seen, _) = seen.unwrap_or_else(|| panic!("the page's script has not run: {log}"));
    let seen: Value = serde_json::from_str(&seen.replace("&quot;", "\"")).unwrap();
    assert_eq!(seen["faults"], Value::Array(vec![]), "{seen}");
    assert_eq!(seen["fetched"], Value::Array(vec![]), "{seen}");
    assert!(seen["changed"] == true && seen["hidden"] == false && seen["label"] == "t = 0 s", "{seen}");
    assert!(seen["width"].as_f64() > Some(10.0) && seen["wider"].as_f64() <= Some(0.0), "{seen}");
}
