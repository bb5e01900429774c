//! What is kept of a run: a row of numbers every few steps, the books, portraits.
use super::bed::{Bed, profile};
use crate::Outcome;
use crate::coupled::{Diary as Kept, Fall};
use crate::granular::{Totals, totals};
use crate::portrait_shape::portrait_shape;
use coupling::{CouplingError, Ledger, LedgerReport, Observer, StepInfo};
use dem::{ContactLaw, Cuboid};
use interfaces::{Aabb, Bodies, BodyId, Checkpoint, Kinematics, Point, Pose, RestartError, Vector};
use render::solids::{Model, Portrait, Tint, View};
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Steps from one row to the next.
const EVERY: u64 = 10;
/// Slabs of a profile.
const SLABS: usize = 40;

const COLUMNS: [&str; 23] = [
    "time",
    "fastest",
    "centroid",
    "outside",
    "contacts",
    "films",
    "coordination",
    "overlap",
    "largest_overlap",
    "shared",
    "bed_height",
    "bed_fraction",
    "core_fraction",
    "bodies_kinetic",
    "energy",
    "work",
    "dissipation",
    "contact_work",
    "energy_residual",
    "momentum_step",
    "momentum_total",
    "divergence",
    "courant",
];

/// Rows of `motion.csv`, the books, and pictures of the bodies.
pub struct Diary {
    ledger: Ledger,
    rows: Vec<Vec<f64>>,
    portraits: Option<Portraits>,
    /// Solid fraction over the height \[m\], at the start and now.
    profiles: [Vec<[f64; 2]>; 2],
    /// Bodies keep so far from walls where the core is \[m\]; nothing without walls.
    margin: Option<f64>,
    /// When it was found that something is no number \[s\].
    lost: Option<f64>,
}

impl Diary {
    /// An empty one; `diameter` \[m\] of the bodies.
    pub fn new(diameter: f64, periodic: bool, portraits: Option<Portraits>) -> Self {
        Self {
            ledger: Ledger::new(),
            rows: Vec::new(),
            portraits,
            profiles: Default::default(),
            margin: (!periodic).then_some(diameter),
            lost: None,
        }
    }
    /// The books.
    pub fn ledger(&self) -> &LedgerReport {
        self.ledger.report()
    }
    /// All values of a column; none of one that there is not.
    pub fn column(&self, name: &str) -> Vec<f64> {
        let at = COLUMNS.iter().position(|c| *c == name);
        at.map_or_else(Vec::new, |at| self.rows.iter().map(|r| r[at]).collect())
    }
    /// Solid fraction over the height \[m\], at the start and at the end.
    pub fn profiles(&self) -> &[Vec<[f64; 2]>; 2] {
        &self.profiles
    }
    /// When it was found that a number of the bodies or of the flow is none \[s\].
    pub fn lost(&self) -> Option<f64> {
        self.lost
    }

    fn push<L: ContactLaw>(&mut self, fall: &Fall<3, L>, time: f64, courant: f64) -> Outcome<()> {
        let bodies = &fall.particles.bodies;
        let lengths = fall.flow.grid().lengths();
        let t: Totals = totals(bodies, 0, &Aabb { min: Point::origin(), max: lengths.into() });
        let height = |b| bodies.inertia(b).mass * bodies.pose(b).position.z;
        let volume: f64 = bodies.ids().map(|b| bodies.inertia(b).volume).sum();
        let mass: f64 = bodies.ids().map(|b| bodies.inertia(b).mass).sum();
        let bed = Bed::of(bodies, lengths[0], self.margin)?;
        let (l, centroid) = (self.ledger.report(), bodies.ids().map(height).sum::<f64>() / mass);
        if self.lost.is_none() && !(t.kinetic + centroid + l.energy[1] + l.dissipation).is_finite() {
            self.lost = Some(time);
        }
        self.rows.push(vec![
            time,
            t.fastest,
            centroid,
            t.outside as f64,
            t.contacts as f64,
            bodies.n_films() as f64,
            t.coordination,
            t.overlap[0],
            t.overlap[1],
            bodies.contacts().map(|c| c.volume).sum::<f64>() / volume,
            bed.height,
            bed.whole,
            bed.core.unwrap_or(f64::NAN),
            t.kinetic,
            l.energy[1],
            l.work,
            l.dissipation,
            l.contact_work,
            l.energy_residual,
            l.momentum_step,
            l.momentum_total,
            l.divergence,
            courant,
        ]);
        Ok(())
    }
}

fn told(what: &str) -> impl FnOnce(crate::Outcome<()>) -> Result<(), CouplingError> {
    let what = what.to_owned();
    move |outcome| outcome.map_err(|e| CouplingError::Output { what, source: io::Error::other(e) })
}

impl<L: ContactLaw> Observer<Fall<3, L>> for Diary {
    fn begin(&mut self, fall: &mut Fall<3, L>) {
        self.ledger.begin(fall);
    }
    fn step(&mut self, fall: &mut Fall<3, L>, info: &StepInfo) -> Result<(), CouplingError> {
        self.ledger.step(fall, info)?;
        if info.step.is_multiple_of(EVERY) {
            told("measuring the bed")(self.push(fall, info.time, info.courant))?;
        }
        Ok(())
    }
    fn snapshot(
        &mut self,
        fall: &mut Fall<3, L>,
        index: usize,
        info: &StepInfo,
    ) -> Result<(), CouplingError> {
        let [width, _, height] = fall.flow.grid().lengths();
        let bodies = &fall.particles.bodies;
        let now = profile(bodies, width * width, height, SLABS).map_err(|e| CouplingError::Output {
            what: "measuring the bed".into(),
            source: io::Error::other(e),
        })?;
        if index == 0 {
            told("measuring the bed")(self.push(fall, 0.0, 0.0))?;
            self.profiles[0] = now.clone();
        }
        self.profiles[1] = now;
        match &self.portraits {
            Some(p) => told("drawing the bodies")(p.draw(fall, index, info.time).map_err(Into::into)),
            None => Ok(()),
        }
    }
}

impl Checkpoint for Diary {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.ledger.save(&mut |name, values| sink(&format!("ledger.{name}"), values));
        sink("profile", self.profiles[0].as_flattened());
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.ledger.restore(&|name| source(&format!("ledger.{name}")))?;
        let profile = RestartError::take(source, "profile", 2 * SLABS)?;
        self.profiles = [profile.as_chunks::<2>().0.to_vec(), Vec::new()];
        Ok(())
    }
}

impl<L: ContactLaw> Kept<3, L> for Diary {
    fn read(&mut self, path: &Path, time: f64) -> io::Result<()> {
        self.rows.clear();
        for line in std::fs::read_to_string(path)?.lines().skip(1) {
            let row: Vec<f64> = line.split(',').map_while(|v| v.parse().ok()).collect();
            // What there is before the first step comes again.
            if row.len() == COLUMNS.len() && row[0] <= time && time > 0.0 {
                self.rows.push(row);
            }
        }
        Ok(())
    }
    fn write(&self, path: &Path) -> io::Result<()> {
        let mut out = BufWriter::new(File::create(path)?);
        writeln!(out, "{}", COLUMNS.join(","))?;
        for row in &self.rows {
            let text: Vec<String> = row.iter().map(|v| format!("{v:?}")).collect();
            writeln!(out, "{}", text.join(","))?;
        }
        out.flush()
    }
}

/// Pictures of all bodies, coloured by how high they were at the start.
pub struct Portraits {
    folder: PathBuf,
    heights: Vec<f64>,
    periodic: bool,
}

impl Portraits {
    /// Into `solids` in a folder; the bodies of `fall` are where they start.
    ///
    /// # Errors
    /// What the disk answers.
    pub fn new<L: ContactLaw>(out: &Path, fall: &Fall<3, L>, periodic: bool) -> io::Result<Self> {
        let folder = out.join("solids");
        std::fs::create_dir_all(&folder)?;
        let bodies = &fall.particles.bodies;
        let heights = bodies.ids().map(|b| bodies.pose(b).position.z).collect();
        Ok(Self { folder, heights, periodic })
    }

    fn draw<L: ContactLaw>(&self, fall: &Fall<3, L>, index: usize, time: f64) -> io::Result<()> {
        let bodies = &fall.particles.bodies;
        let [w, _, high] = fall.flow.grid().lengths();
        let t = 0.03 * w;
        let plate = |edges: [f64; 3], at: [f64; 3]| {
            Cuboid::new(edges).map(|c| (c, Pose::at(at))).map_err(io::Error::other)
        };
        let mut plates = vec![plate([w, w, t], [0.5 * w, 0.5 * w, -0.5 * t])?];
        if !self.periodic {
            plates.push(plate([w + t, t, high + t], [0.5 * (w - t), w + 0.5 * t, 0.5 * (high - t)])?);
            plates.push(plate([t, w, high + t], [-0.5 * t, 0.5 * w, 0.5 * (high - t)])?);
        }
        let mut models: Vec<Model<'_>> = plates
            .iter()
            .map(|(s, pose)| Model { shape: portrait_shape(s), pose: *pose, tint: Tint::Grey(0.78) })
            .collect();
        models.extend(bodies.ids().map(|b: BodyId| {
            let pose = bodies.pose(b);
            let position = bodies.periods().wrap(pose.position, Point::origin());
            let tint = Tint::Value(1e3 * self.heights[b.0]);
            Model { shape: portrait_shape(bodies.shape(b)), pose: Pose { position, ..pose }, tint }
        }));
        let view = View {
            middle: Point::new(0.5 * w, 0.5 * w, 0.46 * high),
            along: Vector::new(-0.55, 1.0, -0.42),
            up: Vector::z(),
            width: 1.75 * w,
            height: 0.95 * high + 0.85 * w,
        };
        let title = format!("t = {time:.3} s, {} bodies", bodies.n_bodies());
        let range = (0.0, 1e3 * high);
        let portrait =
            Portrait { view, models: &models, range, label: Some("height at the start, mm"), title: &title };
        portrait.draw(&self.folder.join(format!("{index:05}.png")))
    }
}
