//! Error against cost of spheres that settle in a periodic box, 1.5 times as heavy as the fluid, Galileo number 50.
//!
//! 1. One sphere in 4 × 4 × 8 d, by several strategies, 8 to 32 cells per diameter: its speed over ten √(d/g) against the finest run's.
//! 2. 64 spheres in 8 × 8 × 8 d: their mean speed, and what a body costs.
use super::{Point, Runs, Table};
use render::cpu::Stopwatch;
use render::plot;
use siltflow::coupling::{Exchange, Explicit, Iterated, Module, OneSolve, Schedule, Timings, run as run_to};
use siltflow::flow::Projection;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use validation::Outcome;
use validation::free_body::{FreeBody, Speeds};

/// End time \[√(d/g)\].
const END: f64 = 10.0;

/// A run: mean speeds at a hundred times, CPU seconds, steps, and where the time went.
struct Course {
    speeds: Vec<f64>,
    cpu: f64,
    steps: u64,
    timings: Timings,
}

fn course<S: Exchange<3, Projection<3>>>(scene: &FreeBody, strategy: S) -> Outcome<Course> {
    let watch = Stopwatch::start();
    let mut simulation = scene.build(strategy)?;
    let (mut speeds, stop) = (Speeds::default(), AtomicBool::new(false));
    let schedule = Schedule { end: END, intervals: 100, courant: 0.3, ..Schedule::default() };
    let summary = run_to(&mut simulation, &schedule, &mut speeds, &stop)?;
    let (cpu, n) = (watch.elapsed().cpu, scene.per_diameter);
    let speeds: Vec<f64> = speeds.0.iter().map(|(_, v)| -v.z).collect();
    let last = speeds.last().copied().unwrap_or_default();
    eprintln!(
        "{} × {n} cells per d: {} steps, {cpu:.1} CPU s, {last:.5} m/s at the end",
        scene.bodies, summary.steps
    );
    Ok(Course { speeds, cpu, steps: summary.steps, timings: *simulation.timings() })
}

/// Root mean square of the difference over the largest speed.
fn off(course: &Course, finest: &Course) -> f64 {
    let squares = course.speeds.iter().zip(&finest.speeds).map(|(a, b)| (a - b).powi(2));
    let most = finest.speeds.iter().fold(0.0, |most: f64, v| most.max(*v));
    (squares.sum::<f64>() / finest.speeds.len() as f64).sqrt() / most
}

pub(crate) fn run() -> Outcome<()> {
    let tables = [one()?, many()?];
    tables.iter().for_each(Table::print);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/images/settling_work_precision.png");
    plot::draw(&path, &tables.each_ref().map(Table::panel))?;
    println!("\ndrawn to {}", path.display());
    Ok(())
}

fn one() -> Outcome<Table> {
    let scene = |per_diameter| -> Outcome<FreeBody> { Ok(FreeBody { per_diameter, ..FreeBody::new(1.5)? }) };
    let finest = course(&scene(32)?, OneSolve::default())?;
    let grids = [8, 12, 16, 24];
    let points = |course_of: &dyn Fn(&FreeBody) -> Outcome<Course>| -> Outcome<Vec<Point>> {
        let point = |n: usize| {
            let course = course_of(&scene(n)?)?;
            Ok(Point::new(n.to_string(), off(&course, &finest), course.cpu))
        };
        grids.into_iter().map(point).collect()
    };
    let runs = vec![
        Runs { label: "one solve", ours: true, points: points(&|s| course(s, OneSolve::default()))? },
        Runs { label: "iterated", ours: true, points: points(&|s| course(s, Iterated::default()))? },
        Runs { label: "explicit", ours: false, points: points(&|s| course(s, Explicit))? },
    ];
    Ok(Table {
        title: "A sphere settles",
        error: "rms error of the speed over its peak, against 32 per d",
        runs,
    })
}

fn many() -> Outcome<Table> {
    let scene = |per_diameter| -> Outcome<FreeBody> {
        Ok(FreeBody { per_diameter, bodies: 64, box_: [8, 8, 8], ..FreeBody::new(1.5)? })
    };
    let courses = [8, 12, 16].map(|n| Ok((n, course(&scene(n)?, OneSolve::default())?)));
    let courses = courses.into_iter().collect::<Outcome<Vec<(usize, Course)>>>()?;
    println!("\n64 spheres: CPU µs per body and step besides the flow's own, and shares of wall time");
    for (n, course) in &courses {
        let seconds = |m: Module| course.timings.seconds(m);
        let bodies: f64 = [Module::Contact, Module::SolidFraction, Module::Forcing].map(seconds).iter().sum();
        let all: f64 = Module::ALL.map(seconds).iter().sum();
        print!("{n:>4} per d: {:8.1} µs", 1e6 * bodies / (64.0 * course.steps as f64));
        Module::ALL.iter().for_each(|m| print!("  {} {:.0} %", m.name(), 100.0 * seconds(*m) / all));
        println!();
    }
    let (_, finest) = &courses[courses.len() - 1];
    let point = |(n, course): &(usize, Course)| Point::new(n.to_string(), off(course, finest), course.cpu);
    let points = courses[..courses.len() - 1].iter().map(point).collect();
    let runs = vec![Runs { label: "one solve", ours: true, points }];
    Ok(Table {
        title: "64 spheres settle",
        error: "rms error of the mean speed over its peak, against 16 per d",
        runs,
    })
}
