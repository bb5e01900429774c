//! Plan of a run.
use crate::available_memory::AvailableMemory;
use crate::build_error::BuildError;
use crate::estimate::{Estimate, one_thread};
use crate::pace::Pace;
use crate::setup::{Algorithm, ForcingChoice, Setup};
use coupling::check_places;
use fv_mesh::Axis;
use serde_json::{Value, json};
use std::fmt;

/// What running a scene would mean: told before it is run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The scene's name.
    pub name: String,
    /// Cells along each axis.
    pub cells: Vec<usize>,
    /// Bodies at the start.
    pub bodies: usize,
    /// Most memory that the process holds at once \[bytes\]; none if it is not known.
    pub memory: Option<f64>,
    /// Mean length of a step \[s\]; none for steady flow.
    pub dt: Option<f64>,
    /// Steps to the end; of steady flow iterations, as on a coarse grid.
    pub steps: f64,
    /// Whether `steps` and `cpu` are those of all iterations that are allowed, as the flow did not
    /// converge on a coarse grid.
    pub at_most: bool,
    /// CPU time on this machine, without that of reduced models \[s\]; none if it is not known.
    pub cpu: Option<f64>,
    /// Parts of the libraries: name, whether it is at work, and what it does or why it is skipped.
    pub parts: Vec<(&'static str, bool, String)>,
    /// Whether the first steps were taken: a run may refuse others at its start.
    pub tried: bool,
    /// The pressure solver and why it was chosen.
    pub pressure: String,
    /// What looks doubtful.
    pub warnings: Vec<String>,
}

/// More steps than this are hardly meant.
const MANY_STEPS: f64 = 1e8;

impl Setup {
    /// Puts the scene together, without running it, and tells what a run would mean; with the cost
    /// of `files`, for which those of a snapshot are written and deleted.
    pub(crate) fn plan(&self, files: bool) -> Result<Plan, BuildError> {
        match self.dim() {
            2 => self.plan_in::<2>(files),
            _ => self.plan_in::<3>(files),
        }
    }

    fn plan_in<const D: usize>(&self, files: bool) -> Result<Plan, BuildError> {
        // Bodies are put together without a flow, which they do not need for that.
        if self.is_forced() {
            let (grid, periodic) = (self.grid::<D>()?, |a| self.periodic(a));
            check_places(&grid, periodic, &self.bodies()?)?;
            if self.flow.algorithm == Algorithm::Projection && self.bodies.forcing() == ForcingChoice::Smooth
            {
                self.check_sizes()?;
            }
        }
        self.check_paths::<D>()?;
        let available = AvailableMemory::now();
        let large = self.is_large(available.as_ref());
        let (tried, estimate) = if large {
            (self.untried::<D>()?, self.estimate_by_smaller(files, available.as_ref())?)
        } else {
            let (tried, estimate) = self.try_steps(files)?;
            (tried, Some(estimate))
        };
        let mut estimate = estimate.map(|estimate| self.with_later_memory(estimate));
        self.require_memory(estimate.and_then(|estimate| estimate.memory), available)?;
        let mut lacks_entrants = false;
        let pace = tried.limits.map(|[longest, rate]| {
            let pace = self.expected_steps(longest, rate, None);
            let Some(Estimate { cost, .. }) = estimate.as_mut().filter(|_| files) else { return pace };
            let Some(rehearsal) = self.rehearse(cost.step * pace.steps) else {
                cost.later = self.cost_of_piles();
                lacks_entrants = !self.bodies.inflows.is_empty();
                return pace;
            };
            let pace = self.expected_steps(longest, rate, Some(&rehearsal));
            cost.later = rehearsal.later(pace.steps);
            pace
        });
        let (dt, expected) = match pace {
            Some(Pace { dt, steps }) => (Some(dt), Some(steps)),
            None if files => (None, one_thread(|| self.expected_iterations::<D>())?),
            None => (None, None),
        };
        let steps = expected.unwrap_or(self.flow.iterations as f64);
        let cpu = estimate.filter(|_| files).map(|estimate| estimate.cost.of_run(steps, &self.output));
        let mut warnings = self.warnings();
        warnings.extend(self.thin_warnings(&tried.thin));
        if estimate.is_some_and(|estimate| estimate.unwritten) {
            warnings.push(format!(
                "files could not be written to the temporary folder {}: cost and memory are told without them",
                std::env::temp_dir().display()
            ));
        }
        if lacks_entrants {
            let message = "the cost lacks that of bodies that come in later, as a run on a coarse grid that resolves them takes too long for a check";
            warnings.push(message.into());
        }
        if steps > MANY_STEPS {
            warnings.push(format!(
                "{} steps to time.end{}: is everything in metres and seconds, and no cell far narrower than the others?",
                count(steps),
                cpu.map_or_else(String::new, |cpu| format!(", {} on one core", duration(cpu))),
            ));
        }
        Ok(Plan {
            name: self.name.clone(),
            cells: self.axes.iter().map(Axis::cells).collect(),
            bodies: self.bodies.list.len(),
            memory: estimate.and_then(|estimate| estimate.memory).map(|[before, taken]| before + taken),
            dt,
            steps,
            at_most: expected.is_none(),
            cpu,
            parts: self.parts(),
            tried: !large,
            pressure: tried.pressure,
            warnings,
        })
    }
}

impl Plan {
    /// The plan as an object, SI units.
    pub fn to_json(&self) -> Value {
        let parts: Vec<Value> = self
            .parts
            .iter()
            .map(|(name, active, about)| json!({ "name": name, "active": active, "about": about }))
            .collect();
        json!({
            "scene": self.name,
            "cells": self.cells,
            "bodies": self.bodies,
            "memory": self.memory,
            "dt": self.dt,
            "steps": self.steps,
            "at_most": self.at_most,
            "cpu": self.cpu,
            "tried": self.tried,
            "pressure": self.pressure,
            "parts": parts,
            "warnings": self.warnings,
        })
    }
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let cells: Vec<String> = self.cells.iter().map(usize::to_string).collect();
        let total: usize = self.cells.iter().product();
        writeln!(f, "{}", self.name)?;
        writeln!(f, "  cells     {} = {total}", cells.join(" × "))?;
        writeln!(f, "  bodies    {}", self.bodies)?;
        let unknown = || "not known: neither this scene nor a smaller one could be tried".into();
        match self.memory {
            Some(memory) => writeln!(f, "  memory    about {}", bytes(memory))?,
            None if self.cpu.is_some() => writeln!(f, "  memory    not known: this system does not tell it")?,
            None => writeln!(f, "  memory    {}", unknown())?,
        }
        let about = if self.at_most { "up to" } else { "about" };
        match self.dt {
            Some(dt) => writeln!(f, "  step      {dt:.3e} s, about {} of them", count(self.steps))?,
            None => writeln!(f, "  steady    {about} {} iterations", count(self.steps))?,
        }
        let on_core = |cpu: f64| format!("{about} {} on one core", duration(cpu));
        let cost = self.cpu.map_or_else(unknown, on_core);
        let models = self.parts.iter().any(|(name, active, _)| *active && *name == "reduced models");
        writeln!(f, "  cost      {cost}{}", if models { ", and that of reduced models" } else { "" })?;
        writeln!(f, "  pressure  {}", self.pressure)?;
        if !self.tried {
            writeln!(
                f,
                "  not tried: too large for first steps; a run may refuse at its start what passes here"
            )?;
        }
        for (name, active, about) in &self.parts {
            writeln!(f, "  {} {name:<18} {about}", if *active { "on  " } else { "skip" })?;
        }
        for warning in &self.warnings {
            writeln!(f, "  warning: {warning}")?;
        }
        Ok(())
    }
}

fn bytes(n: f64) -> String {
    if n < 1e9 { format!("{:.0} MB", (n / 1e6).max(1.0)) } else { format!("{:.1} GB", n / 1e9) }
}

/// A number that people can read.
fn count(n: f64) -> String {
    if n < 1e9 { format!("{n:.0}") } else { format!("{n:.1e}") }
}

/// Seconds of a year.
const YEAR: f64 = 365.25 * 86400.0;

fn duration(seconds: f64) -> String {
    if seconds > YEAR {
        return format!("{} years", count(seconds / YEAR));
    }
    let duration = std::time::Duration::try_from_secs_f64(seconds).unwrap_or(std::time::Duration::MAX);
    render::cpu::readable(duration)
}
