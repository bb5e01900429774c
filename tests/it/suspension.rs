//! Polyhedra that settle in a fluid: a small, coarse run of what the example `dense_suspension` does.
use crate::with_threads;
use example_support::coupled::{Diary as Keeps, Fall};
use example_support::suspension::{Diary, Suspension};
use siltflow::coupling::{self, Schedule};
use siltflow::dem::{Chen, HalfSpace, overlap};
use siltflow::ibm::SmoothForcing;
use siltflow::interfaces::{Bodies, Kinematics, Point, Pose, Vector};
use std::sync::atomic::AtomicBool;

const END: f64 = 0.15;

fn scene() -> Suspension {
    Suspension { number: 12, cells_per_diameter: 6, ..Suspension::default() }
}

fn build(scene: &Suspension) -> Fall<3> {
    scene.build(SmoothForcing::new(scene.fluid().density), Chen::default()).unwrap()
}

fn go(fall: &mut Fall<3>, diary: &mut Diary, end: f64, intervals: usize) {
    let schedule = Schedule { end, intervals, courant: 0.3, ..Schedule::default() };
    coupling::run(fall, &schedule, diary, &AtomicBool::new(false)).unwrap();
}

/// From a solid fraction of 0.4 to a bed: all stay in the box, the books of momentum are kept to round-off, those of energy but for what the
/// grid does not resolve, and what is lost in height is the weight's work.
#[test]
fn a_dozen_polyhedra_settle() {
    with_threads(1, || {
        let scene = scene();
        let mut fall = build(&scene);
        let bodies = &fall.particles.bodies;
        let volume: f64 = bodies.ids().map(|b| bodies.inertia(b).volume).sum();
        let fraction = volume / fall.flow.grid().volume();
        assert!((fraction - 0.4).abs() < 0.03, "{fraction}");
        let mut diary = Diary::new(scene.diameter, false, None);
        go(&mut fall, &mut diary, END, 2);

        let bodies = &fall.particles.bodies;
        let far = Point::from(fall.flow.grid().lengths());
        for b in bodies.ids() {
            let own = bodies.inertia(b).volume;
            for axis in 0..3 {
                for (corner, side) in [(Point::origin(), 1.0), (far, -1.0)] {
                    let wall = HalfSpace::new(corner, side * Vector::ith(axis, 1.0)).unwrap();
                    let here = bodies.pose(b);
                    let beyond = overlap(bodies.shape(b), &here, &wall, &Pose::at([0.0; 3])).unwrap();
                    let beyond: f64 = beyond.iter().map(|o| o.volume).sum();
                    // Measured: 1.0e-03 of it at most.
                    assert!(beyond < 0.01 * own, "body {}: {beyond:e} of {own:e}", b.0);
                }
            }
        }
        assert!(diary.column("outside").iter().all(|n| *n == 0.0) && diary.lost().is_none());
        assert!(bodies.n_contacts() > 10, "they lie on one another: {}", bodies.n_contacts());

        let books = diary.ledger();
        // Measured: 5e-16, 4e-18.
        assert!(books.momentum_step < 1e-12 && books.momentum_total < 1e-13, "{books:?}");
        assert!(books.divergence < 1e-12, "{books:?}");
        let (fallen, work) = (diary.column("centroid"), diary.column("work"));
        let weight = (scene.density_ratio - 1.0) * 1000.0 * volume * 9.81;
        let (last, sunk) = (work.last().unwrap(), fallen[0] - fallen.last().unwrap());
        // Measured: 0.2 %.
        assert!(
            (last / (weight * sunk) - 1.0).abs() < 0.01 && sunk > 0.2 * scene.diameter,
            "{last:e} {sunk:e}"
        );
        let unexplained = diary.column("energy_residual").into_iter().map(f64::abs).fold(0.0, f64::max);
        // Measured: 2.4 %.
        assert!(unexplained < 0.05 * books.work, "{unexplained:e} of {:e}", books.work);
    });
}

/// Books, rows and profiles of a run that is interrupted are those of one that is not.
#[test]
fn the_books_go_on_after_an_interruption() {
    with_threads(1, || {
        let scene = scene();
        let new = || Diary::new(scene.diameter, false, None);
        let (mut whole, mut of_whole) = (build(&scene), new());
        go(&mut whole, &mut of_whole, 0.02, 2);

        let (mut first, mut of_first) = (build(&scene), new());
        go(&mut first, &mut of_first, 0.01, 1);
        let folder = std::env::temp_dir().join(format!("siltflow-suspension-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let [state, books, rows] = ["state.bin", "books.bin", "motion.csv"].map(|f| folder.join(f));
        coupling::save(&state, &first).unwrap();
        coupling::save(&books, &of_first).unwrap();
        Keeps::<3>::write(&of_first, &rows).unwrap();

        let (mut second, mut of_second) = (build(&scene), new());
        coupling::load(&state, &mut second).unwrap();
        coupling::load(&books, &mut of_second).unwrap();
        Keeps::<3>::read(&mut of_second, &rows, second.flow.time()).unwrap();
        assert_eq!(of_second.ledger(), of_first.ledger());
        go(&mut second, &mut of_second, 0.02, 2);
        assert_eq!(of_second.ledger(), of_whole.ledger());
        assert_eq!(of_second.column("work"), of_whole.column("work"));
        assert_eq!(of_second.profiles(), of_whole.profiles());
        // The books of a run of their own begin anew.
        let mut anew = new();
        go(&mut second, &mut anew, 0.03, 3);
        assert!(anew.ledger().work < 0.7 * of_whole.ledger().work);
        std::fs::remove_dir_all(&folder).unwrap();
    });
}
