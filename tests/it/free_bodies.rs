//! Bodies that the flow moves, coarsely, beside what was measured, computed or derived by others. The examples `settling_sphere` and
//! `drafting_kissing_tumbling` and `cargo bench --bench moving -- shear jeffery` do the same on finer grids.
use crate::with_threads;
use example_support::coupled::{Fall, Motion};
use example_support::reference_curve::{Distance, read};
use example_support::settling_sphere::{Case, SettlingSphere};
use example_support::sheared_body::{Shear, settled_spin};
use example_support::sinking_discs::{BOX, DIAMETER, FLUID_DENSITY, SinkingDiscs};
use siltflow::coupling::{self, Schedule};
use siltflow::ibm::SmoothForcing;
use std::sync::atomic::AtomicBool;

/// How the bodies moved up to `end` \[s\].
fn motion<const D: usize>(fall: &mut Fall<D>, end: f64, courant: f64) -> Motion {
    let schedule = Schedule { end, intervals: 1, courant, ..Schedule::default() };
    let mut motion = Motion::default();
    coupling::run(fall, &schedule, &mut motion, &AtomicBool::new(false)).unwrap();
    motion
}

/// ten Cate et al. (2002), 8 cells per diameter: the largest speed, and the whole curve over it up to then. Measured: see the assertions' margins.
#[test]
fn a_sphere_settles_as_measured() {
    for (case, end) in [(Case::E4, 1.0)] {
        with_threads(1, || {
            let scene = SettlingSphere { case, cells_per_diameter: 8 };
            let mut fall = scene.build(SmoothForcing::new(case.fluid().density)).unwrap();
            let velocity = motion(&mut fall, end, 0.2).over_time(0, |s| s.velocity[2]);
            let peak = velocity.iter().fold(0.0, |most: f64, v| most.max(-v.1));
            let measured = case.peak().unwrap();
            let off = Distance::between(&velocity, &case.velocity(), |_| true);
            println!("{case:?} {} {:?}", peak / measured - 1.0, off);
            assert!((peak / measured - 1.0).abs() < 0.05, "{peak} {measured}");
            assert!(off.rms < 0.05 * measured && off.points > 10, "{off:?}");
        });
    }
}

/// Uhlmann (2005), 16 cells per diameter, until wakes have begun to pull the trailing disc on.
#[test]
fn two_discs_draft() {
    with_threads(1, || {
        let mut fall = SinkingDiscs::drafting(16).build(SmoothForcing::new(FLUID_DENSITY)).unwrap();
        let motion = motion(&mut fall, 0.15, 0.2);
        let published = [
            include_str!("../data/uhlmann_2005_trailing_streamwise_position.csv"),
            include_str!("../data/uhlmann_2005_leading_streamwise_position.csv"),
        ];
        for (b, text) in published.into_iter().enumerate() {
            let sunk = motion.over_time(b, |s| 100.0 * (BOX[1] - s.position[1]));
            let off = Distance::between(&sunk, &read(text), |_| true);
            println!("{off:?}");
            // In cm, of 2.4 and 2.8.
            assert!(off.largest < 0.05 && off.points > 20, "{off:?}");
        }
        let speed = |b: usize| -motion.bodies[b].last().unwrap().velocity[1];
        println!("{} {}", speed(0), speed(1));
        assert!(speed(0) > 1.2 * speed(1), "the trailing disc is drawn on: {} {}", speed(0), speed(1));
    });
}

/// Glowinski et al. (2001), Wan & Turek (2006): largest Reynolds number ρ_s U d/μ of 17.15 to 17.42, by the grid.
#[test]
fn a_disc_sinks_as_others_computed() {
    with_threads(1, || {
        let scene = SinkingDiscs::single(16);
        let mut fall = scene.build(SmoothForcing::new(FLUID_DENSITY)).unwrap();
        let speeds = motion(&mut fall, 0.5, 0.2).over_time(0, |s| -s.velocity[1]);
        let fastest = speeds.iter().fold(0.0, |most: f64, v| most.max(v.1));
        let reynolds = scene.density_ratio * fastest * DIAMETER / scene.viscosity;
        println!("{reynolds}");
        assert!((16.8..17.8).contains(&reynolds), "{reynolds}");
    });
}

/// A free sphere in creeping shear turns at half the shear rate, a spheroid as Jeffery (1922) has it, upright and level.
#[test]
fn free_bodies_turn_with_the_shear() {
    with_threads(1, || {
        let sphere = settled_spin(&Shear::default(), 1.0, [0.5, 0.6]).unwrap();
        println!("{sphere}");
        assert!((sphere - 1.0).abs() < 0.005, "{sphere}");
        for angle in [0.0, 1.5] {
            let shear = Shear { aspect: 2.0, edge: 10.0, cells_per_diameter: 8, angle, turning: true, ..Shear::default() };
            let spin = settled_spin(&shear, 1.0, [0.2, 0.25]).unwrap();
            println!("{angle} {spin}");
            assert!((spin - 1.0).abs() < 0.03, "{angle}: {spin}");
        }
    });
}
