//! How bodies moved, step by step.
use super::run::Fall;
use coupling::{CouplingError, Observer, StepInfo};
use dem::{Chen, ContactLaw};
use interfaces::{BodyId, Checkpoint, Kinematics, RestartError};
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Where a body is and how it moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Time \[s\].
    pub time: f64,
    /// Centre \[m\].
    pub position: [f64; 3],
    /// Velocity \[m/s\].
    pub velocity: [f64; 3],
    /// Angular velocity \[rad/s\].
    pub spin: [f64; 3],
}

/// The states of every body at the start and after every step, kept and written to `motion.csv`.
#[derive(Clone, Debug, Default)]
pub struct Motion {
    /// Body by body.
    pub bodies: Vec<Vec<State>>,
    /// Seconds in which bodies touched one another or a wall.
    pub contact_seconds: f64,
    /// Seconds in which a film that the grid does not resolve kept bodies apart, or one from a wall.
    pub film_seconds: f64,
}

/// What a run keeps of its motion, step by step, in memory and in `motion.csv`; what it cannot read there is in its saved state.
pub trait Diary<const D: usize, L: ContactLaw = Chen>: Observer<Fall<D, L>> + Checkpoint {
    /// Takes over what an interrupted run wrote up to `time` \[s\].
    ///
    /// # Errors
    /// When the file cannot be read.
    fn read(&mut self, path: &Path, time: f64) -> io::Result<()>;
    /// Writes all of it, numbers with all digits.
    ///
    /// # Errors
    /// When the file cannot be written.
    fn write(&self, path: &Path) -> io::Result<()>;
}

const HEADER: &str = "# time s; x, y, z m; v m/s; w rad/s\ntime,body,x,y,z,vx,vy,vz,wx,wy,wz";

impl<const D: usize, L: ContactLaw> Diary<D, L> for Motion {
    fn read(&mut self, path: &Path, time: f64) -> io::Result<()> {
        for line in std::fs::read_to_string(path)?.lines() {
            let values: Vec<f64> = line.split(',').map_while(|v| v.parse().ok()).collect();
            let &[t, body, x, y, z, u, v, w, a, b, c] = &values[..] else { continue };
            if t <= time {
                let body = body as usize;
                self.bodies.resize_with(self.bodies.len().max(body + 1), Vec::new);
                self.bodies[body].push(State {
                    time: t,
                    position: [x, y, z],
                    velocity: [u, v, w],
                    spin: [a, b, c],
                });
            }
        }
        Ok(())
    }

    fn write(&self, path: &Path) -> io::Result<()> {
        let mut out = BufWriter::new(File::create(path)?);
        writeln!(out, "{HEADER}")?;
        for row in 0..self.bodies.first().map_or(0, Vec::len) {
            for (b, states) in self.bodies.iter().enumerate() {
                let s = &states[row];
                write!(out, "{:e},{b}", s.time)?;
                for v in s.position.iter().chain(&s.velocity).chain(&s.spin) {
                    write!(out, ",{v:e}")?;
                }
                writeln!(out)?;
            }
        }
        out.flush()
    }
}

/// What is not in `motion.csv`.
impl Checkpoint for Motion {
    fn save(&self, to: &mut dyn FnMut(&str, &[f64])) {
        to("film_seconds", &[self.film_seconds]);
    }
    fn restore<'a>(&mut self, from: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.film_seconds = RestartError::take(from, "film_seconds", 1)?[0];
        Ok(())
    }
}

impl Motion {
    /// One quantity of body `b` over time.
    pub fn over_time(&self, b: usize, quantity: impl Fn(&State) -> f64) -> Vec<(f64, f64)> {
        self.bodies.get(b).map_or_else(Vec::new, |s| s.iter().map(|s| (s.time, quantity(s))).collect())
    }

    fn push<const D: usize, L: ContactLaw>(&mut self, fall: &Fall<D, L>, time: f64) {
        let bodies = &fall.particles.bodies;
        self.bodies.resize_with(bodies.n_bodies(), Vec::new);
        for (b, states) in self.bodies.iter_mut().enumerate() {
            let (pose, twist) = (bodies.pose(BodyId(b)), bodies.twist(BodyId(b)));
            states.push(State {
                time,
                position: pose.position.coords.into(),
                velocity: twist.linear.into(),
                spin: twist.angular.into(),
            });
        }
        self.contact_seconds = bodies.contact_time();
    }
}

impl<const D: usize, L: ContactLaw> Observer<Fall<D, L>> for Motion {
    fn begin(&mut self, fall: &mut Fall<D, L>) {
        if self.bodies.is_empty() {
            self.push(fall, fall.flow.time());
        }
    }
    fn step(&mut self, fall: &mut Fall<D, L>, info: &StepInfo) -> Result<(), CouplingError> {
        self.push(fall, info.time);
        if fall.particles.bodies.n_films() > 0 {
            self.film_seconds += info.dt;
        }
        Ok(())
    }
}
