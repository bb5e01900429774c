//! The runs.
use crate::Options;
use clap::ValueEnum;
use example_support::Outcome;
use example_support::files::make_folder;
use example_support::free_body::{FreeBody, Speeds};
use example_support::rock::{Rock, stl};
use render::cpu::Stopwatch;
use siltflow::coupling::{OneSolve, Schedule, run};
use siltflow::dem::{Shape, TriangleMesh};
use siltflow::flow::Diffusion;
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

/// How viscous terms are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Viscous {
    Auto,
    Explicit,
    Implicit,
}

impl Viscous {
    fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Explicit => "explicit",
            Self::Implicit => "implicit",
        }
    }
    fn diffusion(self) -> Diffusion {
        match self {
            Self::Auto => Diffusion::Auto,
            Self::Explicit => Diffusion::Explicit,
            Self::Implicit => Diffusion::Implicit,
        }
    }
}

/// What is run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Case {
    pub(crate) kind: Kind,
    pub(crate) ratio: f64,
    pub(crate) courant: f64,
    pub(crate) cells: usize,
    viscous: Viscous,
    galileo: f64,
    end: f64,
}

/// One run and what came of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Run {
    pub(crate) case: Case,
    /// Upward speeds at a third of the end time, and at the end; not finite if the run failed.
    pub(crate) speeds: [f64; 2],
    pub(crate) steps: u64,
    /// Largest Courant number of a step.
    pub(crate) reached: f64,
    pub(crate) cpu: f64,
}

const HEADER: &str = "shape,density_ratio,courant,cells_per_diameter,diffusion,galileo,end,speed_at_10,speed_at_30,steps,largest_courant,cpu_s";

impl Run {
    fn line(&self) -> String {
        let Self { case, speeds: [first, last], steps, reached, cpu } = self;
        let Case { kind, ratio, courant, cells, viscous, galileo, end } = case;
        let (kind, viscous) = (kind.name(), viscous.name());
        format!(
            "{kind},{ratio},{courant},{cells},{viscous},{galileo},{end},{first:.6},{last:.6},{steps},{reached:.4},{cpu:.2}"
        )
    }

    fn parse(line: &str) -> Option<Self> {
        let parts: Vec<&str> = line.split(',').collect();
        let [kind, ratio, courant, cells, viscous, galileo, end, first, last, steps, reached, cpu] =
            parts[..]
        else {
            return None;
        };
        let number = |text: &str| text.parse::<f64>().ok();
        let case = Case {
            kind: Kind::from_str(kind, false).ok()?,
            ratio: number(ratio)?,
            courant: number(courant)?,
            cells: cells.parse().ok()?,
            viscous: Viscous::from_str(viscous, false).ok()?,
            galileo: number(galileo)?,
            end: number(end)?,
        };
        let (speeds, steps) = ([number(first)?, number(last)?], steps.parse().ok()?);
        Some(Self { case, speeds, steps, reached: number(reached)?, cpu: number(cpu)? })
    }
}

/// All runs.
pub(crate) struct Map {
    pub(crate) runs: Vec<Run>,
}

/// Courant number of the finest runs.
pub(crate) const FINEST: f64 = 0.25;

impl Map {
    /// Makes those that are not in `map.csv` yet.
    pub(crate) fn run(options: &Options) -> Outcome<Self> {
        let Options { ratios, courants, shapes, cells, finest, out, .. } = options;
        make_folder(out)?;
        let path = out.join("map.csv");
        let mut runs = if options.anew || !path.exists() { Vec::new() } else { read(&path)? };
        if runs.is_empty() {
            fs::write(&path, format!("{HEADER}\n"))?;
        }
        if options.no_runs {
            return Ok(Self { runs });
        }
        let mut file = fs::OpenOptions::new().append(true).open(&path)?;
        for &kind in shapes {
            let shape = shape(kind, options)?;
            for &ratio in ratios {
                let coarse = courants.iter().map(|&courant| (courant, *cells));
                for (courant, cells) in coarse.chain((*finest > 0).then_some((FINEST, *finest))) {
                    let case = Case::new(options, kind, ratio, courant, cells);
                    if runs.iter().any(|r| r.case == case) {
                        continue;
                    }
                    let made = one(case, shape.clone())?;
                    eprintln!("{}", made.line());
                    // In one piece, so that a run that is killed leaves whole lines.
                    file.write_all(format!("{}\n", made.line()).as_bytes())?;
                    runs.push(made);
                }
            }
        }
        Ok(Self { runs })
    }

    pub(crate) fn find(&self, case: Case) -> Option<&Run> {
        self.runs.iter().find(|r| r.case == case)
    }
}

/// The runs of a `map.csv`, nothing of which is to be lost.
fn read(path: &Path) -> Outcome<Vec<Run>> {
    let text = fs::read_to_string(path)?;
    let (header, rows) = text.split_once('\n').unwrap_or_default();
    let runs: Option<Vec<Run>> = rows.lines().map(Run::parse).collect();
    match runs.filter(|_| header == HEADER) {
        Some(runs) => Ok(runs),
        None => {
            Err(format!("{} has other columns than these runs: another --out, or --anew", path.display())
                .into())
        }
    }
}

impl Case {
    pub(crate) fn new(options: &Options, kind: Kind, ratio: f64, courant: f64, cells: usize) -> Self {
        let Options { diffusion, galileo, end, .. } = *options;
        Self { kind, ratio, courant, cells, viscous: diffusion, galileo, end }
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

fn one(case: Case, shape: Arc<dyn Shape>) -> Outcome<Run> {
    let Case { kind, ratio, courant, cells, viscous, galileo, end } = case;
    let mut scene = FreeBody { shape, per_diameter: cells, galileo, ..FreeBody::new(ratio)? };
    scene.diffusion = viscous.diffusion();
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
    Ok(Run { case, speeds: [at(end / 3.0), at(end)], steps, reached, cpu })
}
