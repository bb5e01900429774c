//! Bodies that come into a flow and go out of it while it runs.
use crate::with_threads;
use siltflow::coupling::{self, Ledger, Particles, Schedule, Simulation};
use siltflow::dem::placing::Region;
use siltflow::dem::{Disc, Entrant, HalfSpace, Inflow, Material, Population};
use siltflow::ibm::SmoothForcing;
use siltflow::interfaces::{Aabb, Freedom, Kinematics, Point, Twist, Vector};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use validation::falling_discs::{FLUID, FallingDiscs};

pub(crate) type Rain = Simulation<2, Particles<SmoothForcing, Population>>;

/// Discs of 0.8 to 1 mm come in at the top of a closed box; one fell there before. Below 8 mm they are gone.
pub(crate) fn rain() -> Rain {
    let scene = FallingDiscs { cells_per_diameter: 8, floor: true, bodies: 1, ..FallingDiscs::default() };
    let at = Aabb { min: Point::new(1e-3, 17e-3, 0.0), max: Point::new(9e-3, 19e-3, 0.0) };
    let recipe = |serial: u64| Entrant {
        shape: Arc::new(Disc::new(1e-4 * (4.0 + (serial % 2) as f64)).unwrap()),
        material: Material { density: 3000.0, ..Material::default() },
        twist: Twist { linear: Vector::new(0.0, -0.02, 0.0), ..Twist::default() },
        freedom: Freedom::PLANAR,
    };
    let inflow = Inflow::new(Region::cuboid(at, [false; 3]).unwrap(), 25.0, recipe).unwrap();
    let exit = HalfSpace::new(Point::new(0.0, 13e-3, 0.0), Vector::y()).unwrap();
    let discs = Population::new(scene.discs().unwrap())
        .with_inflow(inflow.with_start(0.02).unwrap().with_gap(2e-4).unwrap())
        .with_exit(exit);
    let gravity = Vector::new(0.0, -9.81, 0.0);
    let particles = Particles::new(discs, SmoothForcing::new(FLUID.density), FLUID.density, gravity);
    Simulation::new(scene.flow().unwrap(), particles, coupling::WeightBalance::None).unwrap()
}

fn bits(rain: &Rain) -> Vec<u64> {
    let bodies = &rain.particles.bodies;
    let motion = bodies.ids().flat_map(|b| {
        let (pose, twist) = (bodies.pose(b), bodies.twist(b));
        [pose.position.x, pose.position.y, twist.linear.x, twist.linear.y, twist.angular.z]
    });
    motion.chain(rain.flow.velocity().field(1).values()).map(f64::to_bits).collect()
}

/// Who comes and goes leaves no hole in the books, and a run that is cut goes on as if it had not been.
#[test]
fn the_books_hold_and_restarts_do_not_notice() {
    with_threads(1, || {
        let stop = AtomicBool::new(false);
        let schedule = Schedule { end: 0.3, intervals: 6, ..Schedule::default() };
        let (mut whole, mut ledger) = (rain(), Ledger::new());
        coupling::run(&mut whole, &schedule, &mut ledger, &stop).unwrap();
        let bodies = &whole.particles.bodies;
        assert_eq!(bodies.entered(0), 7);
        assert!(bodies.left() >= 2, "{}", bodies.left());
        let serials: Vec<_> = bodies.ids().map(|b| whole.particles.serial(b).unwrap()).collect();
        assert_eq!(*serials.last().unwrap(), 7);
        assert_eq!(serials.len() as u64, 8 - bodies.left());
        let report = ledger.report();
        assert!(report.momentum_step < 1e-9 && report.momentum_total < 1e-10, "{report:?}");
        assert!(report.brought != 0.0);

        let half = Schedule { end: 0.15, intervals: 3, ..schedule };
        let (mut first, mut books) = (rain(), Ledger::new());
        coupling::run(&mut first, &half, &mut books, &stop).unwrap();
        let path = std::env::temp_dir().join(format!("siltflow-rain-{}", std::process::id()));
        coupling::save(&path, &first).unwrap();
        let mut second = rain();
        coupling::load(&path, &mut second).unwrap();
        std::fs::remove_file(&path).unwrap();
        coupling::run(&mut second, &schedule, &mut books, &stop).unwrap();
        assert!(bits(&whole) == bits(&second));
    });
}
