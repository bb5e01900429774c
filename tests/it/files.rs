//! What is on disk after a run, and after one that was cut short.
use crate::with_threads;
use siltflow::coupling::{self, CouplingError, FileOutput, Observer, Schedule, StepInfo};
use siltflow::ibm::SmoothForcing;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use validation::falling_discs::{FLUID, FallingDiscs};

fn folder(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("siltflow-files-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&path);
    path
}

/// Sets the flag after so many snapshots, as Ctrl-C does.
struct StopAfter<'a>(usize, &'a AtomicBool);

impl<S> Observer<S> for StopAfter<'_> {
    fn snapshot(&mut self, _: &mut S, index: usize, _: &StepInfo) -> Result<(), CouplingError> {
        self.1.fetch_or(index >= self.0, Ordering::Relaxed);
        Ok(())
    }
}

fn run(out: &Path, stop_after: usize, resume: bool) {
    with_threads(1, || {
        let mut fall = FallingDiscs { cells_per_diameter: 6, ..FallingDiscs::default() }
            .build(SmoothForcing::new(FLUID.density))
            .unwrap();
        let state = out.join("state.bin");
        let mut files = if resume {
            coupling::load(&state, &mut fall).unwrap();
            FileOutput::resume(out, fall.flow.time()).unwrap()
        } else {
            FileOutput::new(out).unwrap()
        };
        let schedule = Schedule { end: 0.02, intervals: 10, ..Schedule::default() };
        let stop = AtomicBool::new(false);
        coupling::run(&mut fall, &schedule, &mut (&mut files, StopAfter(stop_after, &stop)), &stop).unwrap();
        coupling::save(&state, &fall).unwrap();
    });
}

fn read(out: &Path, name: &str) -> String {
    std::fs::read_to_string(out.join(name)).unwrap()
}

#[test]
fn a_stopped_run_leaves_whole_files_and_its_rest_the_same_as_one_run() {
    let (whole, parts) = (folder("whole"), folder("parts"));
    run(&whole, usize::MAX, false);
    run(&parts, 4, false);
    assert_eq!(read(&parts, "trajectories.csv").lines().count(), 2 + 2 * 5);
    assert!(read(&parts, "fields.pvd").ends_with("</Collection>\n</VTKFile>\n"));
    run(&parts, usize::MAX, true);
    for name in ["trajectories.csv", "fields.pvd", "bodies.pvd"] {
        assert!(read(&whole, name) == read(&parts, name), "{name}");
    }
    // Stopped before the first step.
    let none = folder("none");
    run(&none, 0, false);
    run(&none, usize::MAX, true);
    for name in ["trajectories.csv", "fields.pvd", "bodies.pvd"] {
        assert!(read(&whole, name) == read(&none, name), "{name}");
    }
    for name in ["fields/00010.vti", "bodies/00010.vtp", "fields/00005.vti"] {
        assert!(
            std::fs::read(whole.join(name)).unwrap() == std::fs::read(parts.join(name)).unwrap(),
            "{name}"
        );
    }
}

#[test]
fn trajectories_have_the_promised_columns() {
    let out = folder("columns");
    run(&out, usize::MAX, false);
    let text = read(&out, "trajectories.csv");
    let mut lines = text.lines().skip_while(|l| l.starts_with('#'));
    assert!(text.starts_with("# units:"));
    let header = lines.next().unwrap();
    assert!(header.starts_with("time,body,x,y,z,vx,vy,vz,q"), "{header}");
    let columns = header.split(',').count();
    let rows: Vec<Vec<f64>> = lines.map(|l| l.split(',').map(|v| v.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len(), 11 * 2);
    assert!(rows.iter().all(|r| r.len() == columns && r.iter().all(|v: &f64| v.is_finite())));
    // The heavier disc starts where the scene says, and falls.
    assert_eq!(rows[0][..5], [0.0, 0.0, 5e-3, 16e-3, 0.0]);
    assert!(rows[20][3] < 16e-3 && rows[20][6] < 0.0);
}

#[test]
fn images_hold_the_solid_fraction() {
    let out = folder("lambda");
    run(&out, usize::MAX, false);
    let bytes = std::fs::read(out.join("fields/00000.vti")).unwrap();
    let at = |mark: &[u8]| bytes.windows(mark.len()).position(|w| w == mark).unwrap() + mark.len();
    let header = std::str::from_utf8(&bytes[..at(b"encoding=\"raw\">")]).unwrap();
    assert!(header.contains("WholeExtent=\"0 60 0 120 0 1\""), "{header}");
    // The first block: λ, one single-precision number per cell.
    let start = at(b"encoding=\"raw\">\n_");
    let size = u64::from_le_bytes(bytes[start..start + 8].try_into().unwrap()) as usize;
    assert_eq!(size, 60 * 120 * 4);
    let block = &bytes[start + 8..start + 8 + size];
    let sum: f32 = block.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).sum();
    let area = f64::from(sum) * (10e-3 / 60.0) * (20e-3 / 120.0);
    let exact = 2.0 * std::f64::consts::PI * 0.25e-6;
    assert!((area / exact - 1.0).abs() < 3e-3, "{area:e} {exact:e}");
}
