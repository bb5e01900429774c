//! The runs.
use crate::Options;
use example_support::Outcome;
use example_support::cpu::Stopwatch;
use example_support::free_body::{FreeBody, Speeds};
use example_support::rock::{Rock, stl};
use siltflow::coupling::{OneSolve, Schedule, run};
use siltflow::dem::{Shape, TriangleMesh};
use std::fs;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Shapes of bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Kind {
    Sphere,
    Ellipsoid,
    Rock,
}

impl Kind {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Sphere => "sphere",
            Self::Ellipsoid => "ellipsoid",
            Self::Rock => "rock",
        }
    }
}

/// One run and what came of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Run {
    pub(crate) kind: Kind,
    pub(crate) ratio: f64,
    pub(crate) courant: f64,
    pub(crate) cells: usize,
    /// Upward speeds at a third of the end time, and at the end; not finite if the run failed.
    pub(crate) speeds: [f64; 2],
    pub(crate) steps: u64,
    /// Largest Courant number of a step.
    pub(crate) reached: f64,
    pub(crate) cpu: f64,
}

const HEADER: &str =
    "shape,density_ratio,courant,cells_per_diameter,speed_at_10,speed_at_30,steps,largest_courant,cpu_s";

impl Run {
    fn line(&self) -> String {
        let Self { kind, ratio, courant, cells, speeds: [first, last], steps, reached, cpu } = self;
        format!(
            "{},{ratio},{courant},{cells},{first:.6},{last:.6},{steps},{reached:.4},{cpu:.2}",
            kind.name()
        )
    }

    fn parse(line: &str) -> Option<Self> {
        let mut parts = line.split(',');
        let name = parts.next()?;
        let kind = [Kind::Sphere, Kind::Ellipsoid, Kind::Rock].into_iter().find(|k| k.name() == name)?;
        let values: Vec<f64> = parts.map(str::parse).collect::<Result<_, _>>().ok()?;
        let [ratio, courant, cells, first, last, steps, reached, cpu] = values[..] else { return None };
        let (cells, steps) = (cells as usize, steps as u64);
        Some(Self { kind, ratio, courant, cells, speeds: [first, last], steps, reached, cpu })
    }

    fn is_same(&self, kind: Kind, ratio: f64, courant: f64, cells: usize) -> bool {
        (self.kind, self.ratio, self.courant, self.cells) == (kind, ratio, courant, cells)
    }
}

/// All runs.
pub(crate) struct Map {
    pub(crate) runs: Vec<Run>,
}

/// Courant number of the finest runs.
pub(crate) const FINEST: f64 = 0.25;

impl Map {
    /// Makes those that are not there yet.
    pub(crate) fn run(options: &Options) -> Outcome<Self> {
        let Options { ratios, courants, shapes, cells, finest, out, .. } = options;
        fs::create_dir_all(out)?;
        let path = out.join("map.csv");
        let mut runs = Vec::new();
        if options.resume && path.exists() {
            runs.extend(fs::read_to_string(&path)?.lines().filter_map(Run::parse));
        }
        let mut file = fs::File::create(&path)?;
        writeln!(file, "{HEADER}")?;
        for run in &runs {
            writeln!(file, "{}", run.line())?;
        }
        for &kind in shapes {
            let shape = shape(kind, options)?;
            for &ratio in ratios {
                let coarse = courants.iter().map(|&courant| (courant, *cells));
                for (courant, cells) in coarse.chain((*finest > 0).then_some((FINEST, *finest))) {
                    if runs.iter().any(|r| r.is_same(kind, ratio, courant, cells)) {
                        continue;
                    }
                    let made = one(options, shape.clone(), (kind, ratio, courant, cells))?;
                    eprintln!("{}", made.line());
                    writeln!(file, "{}", made.line())?;
                    runs.push(made);
                }
            }
        }
        Ok(Self { runs })
    }

    pub(crate) fn find(&self, kind: Kind, ratio: f64, courant: f64, cells: usize) -> Option<&Run> {
        self.runs.iter().find(|r| r.is_same(kind, ratio, courant, cells))
    }
}

fn shape(kind: Kind, options: &Options) -> Outcome<Arc<dyn Shape>> {
    match kind {
        Kind::Sphere => FreeBody::sphere(),
        Kind::Ellipsoid => FreeBody::ellipsoid(),
        Kind::Rock => match &options.stl {
            Some(file) => FreeBody::rock(&TriangleMesh::from_stl(file, 1.0)?),
            None => FreeBody::rock(&own_rock(&options.out)?),
        },
    }
}

/// Our own rock, by way of a file as anybody's would come.
fn own_rock(out: &Path) -> Outcome<TriangleMesh> {
    let path = out.join("rock.stl");
    fs::write(&path, stl(&Rock::new(3).mesh(3)?, 1.0))?;
    Ok(TriangleMesh::from_stl(&path, 1.0)?)
}

fn one(
    options: &Options,
    shape: Arc<dyn Shape>,
    (kind, ratio, courant, cells): (Kind, f64, f64, usize),
) -> Outcome<Run> {
    let Options { galileo, end, .. } = *options;
    let scene = FreeBody { shape, per_diameter: cells, galileo, ..FreeBody::new(ratio)? };
    let mut simulation = scene.build(OneSolve::default())?;
    let (mut speeds, watch) = (Speeds::default(), Stopwatch::start());
    let schedule = Schedule { end, intervals: 60, courant, ..Schedule::default() };
    let ended = run(&mut simulation, &schedule, &mut speeds, &AtomicBool::new(false));
    if let Err(error) = &ended {
        eprintln!("{} of {ratio} at Courant number {courant}: {error}", kind.name());
    }
    let summary = ended.unwrap_or_default();
    let at = |time: f64| speeds.at(time).filter(|_| summary.steps > 0).map_or(f64::NAN, |v| v.z);
    let (steps, reached, cpu) = (summary.steps, summary.courant, watch.elapsed().cpu);
    Ok(Run { kind, ratio, courant, cells, speeds: [at(end / 3.0), at(end)], steps, reached, cpu })
}
