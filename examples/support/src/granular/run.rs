//! The time loop.
use super::album::Album;
use super::law::Granulate;
use super::measures::{Totals, totals};
use super::options::RunOptions;
use super::record::History;
use super::scene::Scene;
use crate::{Outcome, told};
use coupling::CheckpointError;
use dem::placing::{BodyRow, write_bodies};
use interfaces::{Checkpoint, Dynamics, Kinematics, RestartError};
use render::progress::Progress;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Did the run come to its end?
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// Yes.
    Whole,
    /// It was stopped, and its state is saved.
    Stopped,
}

/// Stable steps in one advance.
const STEPS: f64 = 20.0;
/// Time between two saved states.
const SAVE_EVERY: Duration = Duration::from_secs(60);
/// What the shell is told after Ctrl-C.
const INTERRUPTED: u8 = 130;

/// The frame of an example's `main`: Ctrl-C sets the flag, a second one ends the program at once; errors are told.
pub fn main_of(threads: usize, run: impl FnOnce(&AtomicBool) -> Outcome<Ending> + Send) -> ExitCode {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = stop.clone();
    let handler = move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED.into());
        }
    };
    let result = || -> Outcome<Ending> {
        ctrlc::set_handler(handler)?;
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.clamp(1, 256)).build()?;
        pool.install(|| run(&stop))
    };
    match result() {
        Ok(Ending::Whole) => ExitCode::SUCCESS,
        Ok(Ending::Stopped) => ExitCode::from(INTERRUPTED),
        Err(error) => told(Err(error)),
    }
}

/// Where a run is: rows and parts of the next row done, into how many parts that one is divided, steps so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Clock {
    row: usize,
    part: usize,
    parts: usize,
    steps: u64,
    /// Bodies that are there, walls included.
    bodies: usize,
}

/// What is saved: the bodies, the clock, and a number for the set-up.
struct Whole<'a> {
    bodies: &'a mut Granulate,
    clock: Clock,
    setup: u64,
}

impl Whole<'_> {
    /// All bits of a number as numbers that a state can hold.
    fn setup(&self) -> [f64; 2] {
        [f64::from((self.setup >> 32) as u32), f64::from(self.setup as u32)]
    }
}

impl Checkpoint for Whole<'_> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        let Clock { row, part, parts, steps, .. } = self.clock;
        sink("setup", &self.setup());
        sink("clock", &[row as f64, part as f64, parts as f64, steps as f64, self.bodies.n_bodies() as f64]);
        self.bodies.save(&mut |name, values| sink(&format!("bodies.{name}"), values));
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        if RestartError::take(source, "setup", 2)? != self.setup() {
            return Err(RestartError::Differs("flags".into()));
        }
        self.bodies.restore(&|name| source(&format!("bodies.{name}")))
    }
}

/// Reads only the clock of a saved state.
struct ClockOnly(Clock);
impl Checkpoint for ClockOnly {
    fn save(&self, _: &mut dyn FnMut(&str, &[f64])) {}
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        let c = RestartError::take(source, "clock", 5)?;
        let [row, part, parts, steps, bodies] = [0, 1, 2, 3, 4].map(|i| c[i] as usize);
        self.0 = Clock { row, part, parts, steps: steps as u64, bodies };
        Ok(())
    }
}

/// FNV-1a of what the flags say.
pub(crate) fn fingerprint(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
}

/// Runs the scene from 0 to `end` \[s\] and writes, to `out`: `motion.csv`, `grains.pvd` and `walls.pvd` with their `.vtp` files, `frames/*.png`, `state.bin`, and in
/// the end `bodies.csv`. `setup` tells all that a run that goes on must have in common with the one before.
///
/// # Errors
/// Those of the bodies, with the time at which they came up, and of the disk.
pub fn run(
    scene: &mut impl Scene,
    bodies: &mut Granulate,
    options: &RunOptions,
    (end, out, setup): (f64, &Path, &str),
    stop: &AtomicBool,
) -> Outcome<(Ending, History)> {
    options.check(end)?;
    std::fs::create_dir_all(out).map_err(|e| format!("{}: {e}", out.display()))?;
    let frames = options.frames.min(options.rows);
    let every = options.rows.div_ceil(frames);
    let rows = every * frames;
    let setup = fingerprint(&format!("{setup} {end:?} {rows}"));
    let state = out.join("state.bin");
    let time_of = |row: usize| end * row as f64 / rows as f64;
    let columns: Vec<String> =
        std::iter::once("time").chain(Totals::COLUMNS).chain(scene.columns()).map(str::to_owned).collect();

    let mut clock = Clock::default();
    let motion = out.join("motion.csv");
    let (mut history, mut album);
    let vtk = !options.no_vtk;
    let walls = scene.first_grain() > 0;
    if options.resume {
        clock = load(&state, scene, bodies, setup, &time_of)?;
        history = History::resume(&motion, columns, clock.row + 1)?;
        album = Album::new(out, !options.no_images, vtk, walls, Some(time_of(clock.row)))?;
    } else {
        for old in ["state.bin", "state.bin.previous", "bodies.csv", "summary.png", "result.json"] {
            let _ = std::fs::remove_file(out.join(old));
        }
        history = History::new(&motion, columns)?;
        album = Album::new(out, !options.no_images, vtk, walls, None)?;
        scene.feed(bodies, 0.0)?;
        if scene.may_touch() {
            check_depth(scene, bodies)?;
        } else {
            bodies.check_overlaps()?;
        }
        history.push(row_of(scene, bodies, 0.0))?;
        album.add(0, 0.0, scene, bodies)?;
    }

    let mut progress = Progress::new(time_of(clock.row), end);
    let (mut ending, mut saved) = (Ending::Whole, Instant::now());
    'rows: while clock.row < rows {
        let (begin, until) = (time_of(clock.row), time_of(clock.row + 1));
        if clock.parts == 0 {
            if clock.row > 0 {
                scene.feed(bodies, begin)?;
            }
            clock.parts = ((until - begin) / (STEPS * bodies.stable_dt())).ceil().max(1.0) as usize;
        }
        let dt = (until - begin) / clock.parts as f64;
        while clock.part < clock.parts {
            let time = begin + dt * clock.part as f64;
            scene.steer(bodies, time);
            bodies.advance(dt).map_err(|e| format!("at t = {time:.6} s: {e}"))?;
            clock.part += 1;
            clock.steps += (dt / bodies.stable_dt()).ceil().max(1.0) as u64;
            progress.tell(clock.steps, time + dt, || {
                let (n, contacts) = (bodies.n_bodies() - scene.first_grain(), bodies.n_contacts());
                let energy = totals(bodies, scene.first_grain(), &scene.domain()).kinetic;
                format!("dt {:.1e} s  {n} grains  {contacts} contacts  E {energy:.2e} J", bodies.stable_dt())
            });
            let stopped = stop.load(Ordering::Relaxed);
            if stopped || saved.elapsed() > SAVE_EVERY {
                coupling::save(&state, &Whole { bodies, clock, setup })?;
                saved = Instant::now();
            }
            if stopped {
                ending = Ending::Stopped;
                break 'rows;
            }
        }
        clock = Clock { row: clock.row + 1, part: 0, parts: 0, ..clock };
        history.push(row_of(scene, bodies, until))?;
        if clock.row.is_multiple_of(every) {
            album.add(clock.row / every, until, scene, bodies)?;
        }
    }
    progress.finish(clock.steps, if ending == Ending::Whole { "done" } else { "stopped" });
    if ending == Ending::Whole {
        coupling::save(&state, &Whole { bodies, clock, setup })?;
        table(&out.join("bodies.csv"), scene, bodies)?;
    } else {
        eprintln!("the state is saved; give the same flags with --resume to go on");
    }
    Ok((ending, history))
}

/// Depth of overlaps at the start by the smaller radius beyond which bodies do not touch but are in one another.
const DEEPEST: f64 = 0.5;

/// Grains may touch at the start, but no more than that.
fn check_depth(scene: &impl Scene, bodies: &Granulate) -> Outcome<()> {
    let mut soon = bodies.clone();
    soon.advance(1e-6 * bodies.stable_dt())?;
    let deepest = totals(&soon, scene.first_grain(), &scene.domain()).overlap[1];
    if deepest > DEEPEST {
        return Err(format!(
            "grains overlap one another or walls at the start, by up to {:.0} % of a radius; move them apart",
            100.0 * deepest
        )
        .into());
    }
    Ok(())
}

fn row_of(scene: &mut impl Scene, bodies: &Granulate, time: f64) -> Vec<f64> {
    let sums = totals(bodies, scene.first_grain(), &scene.domain()).values();
    std::iter::once(time).chain(sums).chain(scene.measure(bodies, time)).collect()
}

/// Brings in what had come in, then takes up the saved state.
fn load(
    state: &Path,
    scene: &mut impl Scene,
    bodies: &mut Granulate,
    setup: u64,
    time_of: &dyn Fn(usize) -> f64,
) -> Outcome<Clock> {
    let hint = |e: CheckpointError| {
        format!("{e}; without an interrupted run of this scene there, leave out --resume")
    };
    let mut only = ClockOnly(Clock::default());
    coupling::load(state, &mut only).map_err(hint)?;
    let clock = only.0;
    // Those of the row that had just been done come with the next one.
    let fed = if clock.parts > 0 || clock.row == 0 { clock.row } else { clock.row - 1 };
    scene.refill(bodies, clock.bodies, time_of(fed))?;
    if bodies.n_bodies() != clock.bodies {
        let (n, saved) = (bodies.n_bodies(), clock.bodies);
        return Err(format!(
            "{}: {saved} bodies were saved, this scene has {n}; give the same flags",
            state.display()
        )
        .into());
    }
    coupling::load(state, &mut Whole { bodies, clock, setup }).map_err(hint)?;
    Ok(clock)
}

/// All grains with their motion, as a table that `settling --table` reads.
fn table(path: &Path, scene: &impl Scene, bodies: &Granulate) -> Outcome<()> {
    let row = |b: interfaces::BodyId| {
        let (size, kind) = scene.tells(b);
        BodyRow { pose: bodies.pose(b), twist: Some(bodies.twist(b)), size, kind: kind.into() }
    };
    let rows: Vec<BodyRow> = bodies.ids().skip(scene.first_grain()).map(row).collect();
    write_bodies(BufWriter::new(File::create(path)?), &rows)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::granular::{Law, Ways};
    use clap::Parser;
    use dem::{HalfSpace, Material, RigidBodies, Rolling, Sphere};
    use interfaces::{Aabb, BodyId, Freedom, Periods, Point, Pose, Twist, Vector};
    use render::solids::View;

    /// One ball after the other falls onto a floor; Ctrl-C comes at a given time.
    struct Balls<'a> {
        stop: &'a AtomicBool,
        at: f64,
    }

    fn add(bodies: &mut Granulate) -> Outcome<()> {
        let n = bodies.n_bodies() as f64;
        let pose = Pose::at([0.004 * n, 0.0, 0.05]);
        let twist = Twist { angular: Vector::new(1.0, 2.0, 3.0), ..Twist::default() };
        bodies.add(Sphere::new(0.005)?, Material::default(), pose, twist, Freedom::FREE)?;
        Ok(())
    }

    impl Scene for Balls<'_> {
        fn domain(&self) -> Aabb {
            Aabb::around(Point::origin(), Vector::repeat(1.0))
        }
        fn feed(&mut self, bodies: &mut Granulate, time: f64) -> Outcome<()> {
            if time < 0.1 { add(bodies) } else { Ok(()) }
        }
        fn refill(&mut self, bodies: &mut Granulate, number: usize, _: f64) -> Outcome<()> {
            (bodies.n_bodies()..number).try_for_each(|_| add(bodies))
        }
        fn steer(&mut self, _: &mut Granulate, time: f64) {
            if time >= self.at {
                self.stop.store(true, Ordering::Relaxed);
            }
        }
        fn view(&self) -> View {
            View { middle: Point::origin(), along: Vector::y(), up: Vector::z(), width: 0.1, height: 0.1 }
        }
        fn value(&self, _: &Granulate, _: BodyId) -> f64 {
            0.0
        }
        fn scale(&self) -> (&'static str, (f64, f64)) {
            ("", (0.0, 1.0))
        }
        fn tells(&self, _: BodyId) -> (Option<f64>, &'static str) {
            (Some(0.01), "sphere")
        }
    }

    #[derive(Parser)]
    struct Cli {
        #[command(flatten)]
        run: RunOptions,
    }

    fn go(out: &Path, setup: &str, at: f64, flags: &[&str]) -> Outcome<Ending> {
        let law = Rolling(Law::from(Ways::Potential));
        let mut bodies = RigidBodies::with_law(Periods::default(), law);
        bodies.set_gravity(Vector::new(0.0, 0.0, -9.81));
        bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z())?, Material::default())?;
        let stop = AtomicBool::new(false);
        let mut scene = Balls { stop: &stop, at };
        let cli = Cli::parse_from([&["", "--rows", "20", "--frames", "4", "--no-images"], flags].concat());
        Ok(run(&mut scene, &mut bodies, &cli.run, (0.2, out, setup), &stop)?.0)
    }

    /// Stopped amid a row while bodies come in, and again later: what is written is, bit for bit, what a run that was not stopped writes.
    #[test]
    fn a_stopped_run_goes_on() {
        let folder = std::env::temp_dir().join(format!("siltflow-granular-{}", std::process::id()));
        let (whole, parts) = (folder.join("whole"), folder.join("parts"));
        assert_eq!(go(&whole, "a", 9.0, &[]).unwrap(), Ending::Whole);
        assert_eq!(go(&parts, "a", 0.0613, &[]).unwrap(), Ending::Stopped);
        assert!(go(&parts, "b", 9.0, &["--resume"]).unwrap_err().to_string().contains("flags"));
        assert_eq!(go(&parts, "a", 0.15, &["--resume"]).unwrap(), Ending::Stopped);
        assert_eq!(go(&parts, "a", 9.0, &["--resume"]).unwrap(), Ending::Whole);
        for file in ["motion.csv", "bodies.csv", "grains.pvd", "grains/00003.vtp"] {
            let [a, b] = [&whole, &parts].map(|f| std::fs::read(f.join(file)).unwrap());
            assert!(a == b, "{file} differs");
        }
        let table = dem::placing::read_bodies(File::open(parts.join("bodies.csv")).unwrap()).unwrap();
        assert_eq!((table.len(), table[0].size), (10, Some(0.01)));
        assert!(go(&folder.join("empty"), "a", 9.0, &["--resume"]).is_err());
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
