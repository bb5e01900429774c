//! Who looks on while the discs fall.
use example_support::scene::{BOX, FLUID, GRAVITY, Scene};
use example_support::startup_theory;
use render::progress::{Progress, Status};
use render::summary::{Moment, Summary, Track};
use render::{Disc, Domain, Frames, Scalar};
use siltflow::coupling::{
    self, CouplingError, Observer, Particles, Schedule, Simulation, StepInfo, WeightBalance,
};
use siltflow::dem::RigidBodies;
use siltflow::flow::Projection;
use siltflow::ibm::{Forcing, SolidFraction};
use siltflow::interfaces::{Bodies, BodyId, Checkpoint, Kinematics, RestartError};
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

pub(crate) type Fall<F> = Simulation<2, Particles<F, RigidBodies>>;

/// The progress bar.
pub(crate) struct Show(Option<Progress>);

impl Show {
    pub(crate) fn new(begin: f64, end: f64) -> Self {
        Self(Some(Progress::new(begin, end)))
    }
    pub(crate) fn finish(&mut self, steps: u64, message: &str) {
        if let Some(progress) = self.0.take() {
            progress.finish(steps, message);
        }
    }
}

impl<F: Forcing> Observer<Fall<F>> for Show {
    fn step(&mut self, fall: &mut Fall<F>, info: &StepInfo) -> Result<(), CouplingError> {
        if let Some(progress) = &mut self.0 {
            progress.step(info.step, || Status {
                time: info.time,
                dt: info.dt,
                courant: info.courant,
                divergence: fall.flow.statistics().divergence * info.dt,
            });
        }
        Ok(())
    }
}

/// What is kept of every snapshot (centres, speeds) and of every step (gaps, slip).
pub(crate) struct History {
    pub(crate) times: Vec<f64>,
    /// x, y, speed of each body at each time.
    pub(crate) tracks: Vec<[Vec<f64>; 3]>,
    pub(crate) theory: Vec<Vec<(f64, f64)>>,
    /// Smallest gap between surfaces \[m\] and when.
    pub(crate) smallest_gap: (f64, f64),
    /// Seconds in which any two bodies, or a body and a wall, touched.
    pub(crate) contact_seconds: f64,
    /// Largest slip at the surfaces relative to the speed of the fastest body at that time.
    pub(crate) slip: f64,
    /// Largest body force \[m/s²\].
    pub(crate) body_force: f64,
    /// Largest |∫u dV|/V_Ω relative to the speed of the fastest body.
    pub(crate) mean_flow: f64,
}

impl History {
    pub(crate) fn new(scene: &Scene, schedule: &Schedule) -> Self {
        Self {
            times: Vec::new(),
            tracks: vec![Default::default(); scene.bodies],
            theory: startup_points(scene, schedule.end),
            smallest_gap: (f64::INFINITY, 0.0),
            contact_seconds: 0.0,
            slip: 0.0,
            body_force: 0.0,
            mean_flow: 0.0,
        }
    }

    /// Takes over what an interrupted run wrote to its `trajectories.csv`.
    pub(crate) fn read(&mut self, csv: &Path) -> io::Result<()> {
        for line in std::fs::read_to_string(csv)?.lines() {
            let values: Vec<f64> = line.split(',').map_while(|v| v.parse().ok()).collect();
            let [time, body, x, y, _, vx, vy, ..] = values[..] else { continue };
            if let Some(track) = self.tracks.get_mut(body as usize) {
                track[0].push(x);
                track[1].push(y);
                track[2].push(vx.hypot(vy));
                if body == 0.0 {
                    self.times.push(time);
                }
            }
        }
        Ok(())
    }
}

/// Speeds of the discs by the theory of the start from rest, which holds until their wakes reach one another.
fn startup_points(scene: &Scene, end: f64) -> Vec<Vec<(f64, f64)>> {
    let Ok(centres) = scene.centres() else { return Vec::new() };
    if scene.floor || scene.bodies > 2 || scene.balance == WeightBalance::None {
        return Vec::new();
    }
    let fluid =
        startup_theory::Fluid { density: FLUID.density, viscosity: FLUID.viscosity, gravity: GRAVITY };
    let discs: Vec<_> = centres
        .into_iter()
        .zip(scene.densities.iter().cycle())
        .map(|(centre, &density)| startup_theory::Released { centre, radius: 0.5 * scene.diameter, density })
        .collect();
    let times = (1..=6).map(|k| 0.005 * f64::from(k)).filter(|&t| t <= end);
    let speeds: Vec<_> =
        times.map(|t| (t, startup_theory::startup_speed(t, &discs, &fluid, Some(BOX)))).collect();
    (0..discs.len()).map(|b| speeds.iter().map(|(t, v)| (*t, v[b])).collect()).collect()
}

fn fastest<F: Forcing>(fall: &Fall<F>) -> f64 {
    let bodies = &fall.particles.bodies;
    (0..bodies.n_bodies()).map(|b| bodies.twist(BodyId(b)).linear.norm()).fold(0.0, f64::max)
}

impl<F: Forcing> Observer<Fall<F>> for History {
    fn step(&mut self, fall: &mut Fall<F>, info: &StepInfo) -> Result<(), CouplingError> {
        let bodies = &fall.particles.bodies;
        if let Some(gap) = bodies.smallest_gap()
            && gap < self.smallest_gap.0
        {
            self.smallest_gap = (gap, info.time);
        }
        self.contact_seconds = bodies.contact_time();
        self.body_force = self.body_force.max(fall.body_force().norm());
        Ok(())
    }
    fn snapshot(&mut self, fall: &mut Fall<F>, _: usize, info: &StepInfo) -> Result<(), CouplingError> {
        let bodies = &fall.particles.bodies;
        self.times.push(info.time);
        for (b, [x, y, speed]) in self.tracks.iter_mut().enumerate() {
            let (pose, twist) = (bodies.pose(BodyId(b)), bodies.twist(BodyId(b)));
            x.push(pose.position.x);
            y.push(pose.position.y);
            speed.push(twist.linear.norm());
        }
        let speed = fastest(fall);
        if info.step > 0 && speed > 0.0 {
            let slip = fall.particles.forcing.slip(fall.flow.velocity(), &fall.particles.bodies);
            self.slip = self.slip.max(slip / speed);
            let mean = fall.flow.statistics().volume_flow.norm() / fall.flow.grid().volume();
            self.mean_flow = self.mean_flow.max(mean / speed);
        }
        Ok(())
    }
}

/// Time, λ, speed and discs of a moment.
type Kept = (f64, Vec<f64>, Vec<f64>, Vec<Disc>);

/// PNG frames, and the fields of a few moments for the summary figure.
pub(crate) struct Pictures {
    folder: PathBuf,
    frames: Frames,
    domain: Domain,
    fraction: SolidFraction,
    lambda: Vec<f64>,
    speed: Vec<f64>,
    moments: Vec<Kept>,
    /// Snapshots of which a moment is kept.
    keep: [usize; 3],
    seconds: f64,
}

/// A frame every so many snapshots, and the moments of the summary figure as shares of the run.
const FRAME_EVERY: usize = 10;
const MOMENTS: [f64; 3] = [1.0 / 3.0, 0.5, 0.75];
/// Top of the colour scale \[m/s\].
const MAX_SPEED: f64 = 0.03;

impl Pictures {
    pub(crate) fn new(out: &Path, scene: &Scene, schedule: &Schedule) -> Result<Self, CouplingError> {
        let folder = out.join("frames");
        std::fs::create_dir_all(&folder).map_err(|source| CouplingError::Output {
            what: format!("making {}", folder.display()),
            source,
        })?;
        let domain = Domain { width: BOX[0], height: BOX[1], periodic: [true, !scene.floor] };
        Ok(Self {
            folder,
            frames: Frames::new(domain, MAX_SPEED),
            domain,
            fraction: SolidFraction::new(),
            lambda: Vec::new(),
            speed: Vec::new(),
            moments: Vec::new(),
            keep: MOMENTS.map(|share| (share * schedule.intervals as f64).round() as usize),
            seconds: 0.0,
        })
    }
    pub(crate) fn seconds(&self) -> f64 {
        self.seconds
    }

    /// The figure of the whole run.
    pub(crate) fn summary(&self, path: &Path, scene: &Scene, history: &History) -> io::Result<()> {
        let [nx, ny] = scene.cells();
        let field = |values| Scalar { nx, ny, values };
        let moments: Vec<_> = self
            .moments
            .iter()
            .map(|(time, lambda, speed, discs)| Moment {
                time: *time,
                lambda: field(lambda),
                speed: field(speed),
                discs,
            })
            .collect();
        let labels: Vec<_> = (0..scene.bodies)
            .map(|b| format!("ρ = {} kg/m³", scene.densities[b % scene.densities.len()]))
            .collect();
        let tracks: Vec<_> = history
            .tracks
            .iter()
            .zip(&labels)
            .enumerate()
            .map(|(b, ([x, y, speed], label))| Track {
                label,
                radius: 0.5 * scene.diameter,
                times: &history.times,
                x,
                y,
                speed,
                theory: history.theory.get(b).map_or(&[], Vec::as_slice),
            })
            .collect();
        Summary { domain: self.domain, moments: &moments, tracks: &tracks, theory: "unsteady Stokes" }
            .draw(path)
    }

    fn look<F: Forcing>(&mut self, fall: &Fall<F>) -> Result<Vec<Disc>, CouplingError> {
        let flow: &Projection<2> = &fall.flow;
        let lattice = flow.grid().lattice(None, flow.sides());
        self.fraction.update(&lattice, &fall.particles.bodies)?;
        self.lambda.clear();
        self.lambda.resize(flow.grid().n_cells(), 0.0);
        self.fraction.add_to_dense(&lattice, &mut self.lambda);
        self.speed.clear();
        self.speed.extend(flow.centred_velocity(0).zip(flow.centred_velocity(1)).map(|(u, v)| u.hypot(v)));
        let bodies = &fall.particles.bodies;
        Ok((0..bodies.n_bodies())
            .map(|b| {
                let pose = bodies.pose(BodyId(b));
                let radius = 0.5 * bodies.solid(BodyId(b)).aabb().extent().x;
                let angle = pose.orientation.scaled_axis().z;
                Disc { x: pose.position.x, y: pose.position.y, radius, angle }
            })
            .collect())
    }
}

impl<F: Forcing> Observer<Fall<F>> for Pictures {
    fn snapshot(&mut self, fall: &mut Fall<F>, index: usize, info: &StepInfo) -> Result<(), CouplingError> {
        let pictures = self;
        let (frame, moment) = (index.is_multiple_of(FRAME_EVERY), pictures.keep.contains(&index));
        if !(frame || moment) {
            return Ok(());
        }
        let start = Instant::now();
        let discs = pictures.look(fall)?;
        if frame {
            let [nx, ny] = fall.flow.grid().cells();
            let field = |values| Scalar { nx, ny, values };
            let path = pictures.folder.join(format!("{index:05}.png"));
            pictures
                .frames
                .draw(
                    &path,
                    &field(&pictures.speed),
                    &field(&pictures.lambda),
                    &discs,
                    &format!("t = {:.3} s", info.time),
                )
                .map_err(|source| CouplingError::Output {
                    what: format!("drawing {}", path.display()),
                    source,
                })?;
        }
        if moment {
            pictures.moments.push((info.time, pictures.lambda.clone(), pictures.speed.clone(), discs));
        }
        pictures.seconds += start.elapsed().as_secs_f64();
        Ok(())
    }
}

/// A run together with the numbers of its set-up, which must be the same when it goes on.
pub(crate) struct Resumable<'a, F> {
    pub(crate) fall: &'a mut Fall<F>,
    pub(crate) setup: &'a [f64],
}

impl<F: Forcing> Checkpoint for Resumable<'_, F> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        sink("setup", self.setup);
        self.fall.save(sink);
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        if RestartError::take(source, "setup", self.setup.len())? != self.setup {
            return Err(RestartError::Differs(
                "cells, bodies, diameter, floor, balance, forcing, end, snapshots, dt or densities".into(),
            ));
        }
        self.fall.restore(source)
    }
}

/// The state, saved every ten seconds of wall time and at the end.
pub(crate) struct Save {
    path: PathBuf,
    setup: Vec<f64>,
    last: Instant,
    seconds: f64,
}

const SAVE_EVERY: Duration = Duration::from_secs(10);

impl Save {
    pub(crate) fn new(path: PathBuf, setup: Vec<f64>) -> Self {
        Self { path, setup, last: Instant::now(), seconds: 0.0 }
    }
    pub(crate) fn seconds(&self) -> f64 {
        self.seconds
    }
    pub(crate) fn now<F: Forcing>(&mut self, fall: &mut Fall<F>) -> Result<(), coupling::CheckpointError> {
        let start = Instant::now();
        coupling::save(&self.path, &Resumable { fall, setup: &self.setup })?;
        self.last = Instant::now();
        self.seconds += start.elapsed().as_secs_f64();
        Ok(())
    }
}

impl<F: Forcing> Observer<Fall<F>> for Save {
    fn step(&mut self, fall: &mut Fall<F>, info: &StepInfo) -> Result<(), CouplingError> {
        if self.last.elapsed() >= SAVE_EVERY && info.snapshot.is_none() {
            self.now(fall).map_err(|e| CouplingError::Output {
                what: "saving the state".into(),
                source: io::Error::other(e),
            })?;
        }
        Ok(())
    }
}
