//! Bad input is told which value, why, and what to do.
use siltflow::coupling::{self, CouplingError, FileOutput, Particles, Schedule, Simulation, WeightBalance};
use siltflow::dem::{DemError, Disc, Material, RigidBodies};
use siltflow::ibm::{IbmError, SmoothForcing};
use siltflow::interfaces::{BodyId, Freedom, Periods, Pose, Twist, Vector};
use std::sync::atomic::AtomicBool;
use validation::falling_discs::{FLUID, FallingDiscs, SetupError};

fn build(scene: FallingDiscs) -> SetupError {
    scene.build(SmoothForcing::new(FLUID.density)).err().expect("an error")
}

/// The message holds the value, and says what to do.
fn told(error: impl std::fmt::Display, parts: &[&str]) {
    let text = error.to_string();
    for part in parts {
        assert!(text.contains(part), "`{part}` is not in: {text}");
    }
}

#[test]
fn negative_density() {
    let error = build(FallingDiscs { densities: vec![-5.0], ..FallingDiscs::default() });
    assert!(matches!(error, SetupError::Bodies(DemError::Material { property: "density", .. })), "{error}");
    told(error, &["density", "-5", "give"]);
}

#[test]
fn body_larger_than_the_box() {
    let error = build(FallingDiscs { diameter: 12e-3, bodies: 1, ..FallingDiscs::default() });
    assert!(matches!(error, SetupError::Bodies(DemError::Period { .. })), "{error}");
    told(error, &["1.200e-2", "1.000e-2", "smaller"]);
    // In a box with walls all round it is the coupling that sees it.
    let mut bodies = RigidBodies::new(Periods::default());
    let (disc, pose) = (Disc::new(6e-3).unwrap(), Pose::at([5e-3, 10e-3, 0.0]));
    bodies.add(disc, Material::default(), pose, Twist::default(), Freedom::PLANAR).unwrap();
    let flow = FallingDiscs { floor: true, ..FallingDiscs::default() }.flow().unwrap();
    let particles = Particles::new(bodies, SmoothForcing::new(1000.0), 1000.0, Vector::zeros());
    let error = Simulation::new(flow, particles, WeightBalance::None).err().unwrap();
    assert!(matches!(error, CouplingError::TooLarge { axis: 0, .. }), "{error}");
    told(error, &["1.200e-2", "1.000e-2", "box larger"]);
}

#[test]
fn overlapping_start() {
    // Diameters for which the two centres, 2.5 mm apart, are too near.
    let error = build(FallingDiscs { diameter: 2.6e-3, ..FallingDiscs::default() });
    assert!(
        matches!(error, SetupError::Bodies(DemError::OverlappingStart { a: BodyId(0), b: BodyId(1), .. })),
        "{error}"
    );
    told(error, &["bodies 0 and 1", "apart"]);
    let error =
        build(FallingDiscs { floor: true, bodies: 1, shift: [0.0, -15.6e-3], ..FallingDiscs::default() });
    assert!(matches!(error, SetupError::Bodies(DemError::InWall { .. })), "{error}");
}

#[test]
fn too_few_cells_per_diameter() {
    let error = build(FallingDiscs { cells_per_diameter: 3, ..FallingDiscs::default() });
    assert!(matches!(error, SetupError::TooCoarse { found: 3 }), "{error}");
    told(error, &["3 cells", "4 are needed", "raise"]);
    // The library says so itself when the scene does not.
    let coarse = FallingDiscs { cells_per_diameter: 4, ..FallingDiscs::default() };
    let mut bodies = RigidBodies::new(Periods::new([Some(10e-3), Some(20e-3), None]));
    let (disc, pose) = (Disc::new(0.2e-3).unwrap(), Pose::at([5e-3, 10e-3, 0.0]));
    bodies.add(disc, Material::default(), pose, Twist::default(), Freedom::PLANAR).unwrap();
    let particles = Particles::new(bodies, SmoothForcing::new(1000.0), 1000.0, Vector::zeros());
    let mut simulation =
        Simulation::new(coarse.flow().unwrap(), particles, WeightBalance::NetWeight).unwrap();
    let error = simulation.step(1e-4).unwrap_err();
    assert!(matches!(error, CouplingError::Immersed(IbmError::TooCoarse { .. })), "{error}");
    told(error, &["body 0", "refine"]);
}

#[test]
fn unwritable_folder() {
    // A file where the folder should be: fails for every user, root too.
    let path = std::env::temp_dir().join(format!("siltflow-file-{}", std::process::id()));
    std::fs::write(&path, "").unwrap();
    let error = FileOutput::new(&path.join("sub")).err().unwrap();
    assert!(matches!(error, CouplingError::Output { .. }), "{error}");
    told(error, &["siltflow-file", "choose a folder"]);
}

#[test]
fn senseless_numbers() {
    assert!(matches!(build(FallingDiscs { bodies: 0, ..FallingDiscs::default() }), SetupError::Count { .. }));
    assert!(matches!(
        build(FallingDiscs { bodies: 1_000_000, ..FallingDiscs::default() }),
        SetupError::Count { .. }
    ));
    assert!(matches!(
        build(FallingDiscs { densities: vec![], ..FallingDiscs::default() }),
        SetupError::NoDensity
    ));
    for diameter in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = build(FallingDiscs { diameter, ..FallingDiscs::default() });
        assert!(matches!(error, SetupError::Diameter { .. }), "{diameter}: {error}");
    }
    let good = Schedule { end: 1e-3, intervals: 1, ..Schedule::default() };
    let schedules = [
        Schedule { end: -1.0, ..good },
        Schedule { end: f64::NAN, ..good },
        Schedule { intervals: 0, ..good },
        Schedule { dt: Some(0.0), ..good },
        Schedule { dt: Some(f64::NAN), ..good },
        Schedule { courant: -0.1, ..good },
        Schedule { ramp: [0.0, 1.1], ..good },
        Schedule { ramp: [0.1, 1.0], ..good },
    ];
    let scene = FallingDiscs { cells_per_diameter: 5, ..FallingDiscs::default() };
    let mut simulation = scene.build(SmoothForcing::new(FLUID.density)).unwrap();
    for schedule in schedules {
        let error = coupling::run(&mut simulation, &schedule, &mut (), &AtomicBool::new(false)).unwrap_err();
        assert!(matches!(error, CouplingError::Schedule { .. }), "{schedule:?}: {error}");
    }
    let too_long = Schedule { dt: Some(0.1), ramp: [1.0, 2.0], end: 1.0, ..good };
    let error = coupling::run(&mut simulation, &too_long, &mut (), &AtomicBool::new(false)).unwrap_err();
    told(error, &["stability limit", "1.000e-1"]);
}
