//! Flags.
use crate::Outcome;
use clap::Args;
use ibm::Kernel;
use std::path::PathBuf;

/// How to run, and what to write.
#[derive(Clone, Debug, Args)]
pub struct RunOptions {
    /// End time, in s.
    #[arg(long, allow_negative_numbers = true)]
    pub end: Option<f64>,
    /// Time step, in s, after the ramp of the first steps; without it the largest that stability and --courant allow.
    #[arg(long, allow_negative_numbers = true)]
    pub dt: Option<f64>,
    /// Courant number up to which the time step may go.
    #[arg(long, default_value_t = 0.1, allow_negative_numbers = true)]
    pub courant: f64,
    /// Kernel of the markers: yang, quartic or quintic; without it the one that suits the dimension.
    #[arg(long, value_parser = kernel)]
    pub kernel: Option<Kernel>,
    /// How often fields are written and drawn, evenly from 0 to the end, both included.
    #[arg(long, default_value_t = 13)]
    pub frames: usize,
    /// Threads, 1 to 256; the numbers do not depend on it.
    #[arg(long, default_value_t = 1)]
    pub threads: usize,
    /// Folder for everything that is written.
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Write no fields and outlines for ParaView.
    #[arg(long)]
    pub no_vtk: bool,
    /// Write no PNG files.
    #[arg(long)]
    pub no_images: bool,
    /// Go on from the state that an interrupted run with the same flags left in the folder.
    #[arg(long)]
    pub resume: bool,
}

impl RunOptions {
    /// Do the numbers make sense? Those of the schedule are looked at by the run.
    pub(super) fn check(&self) -> Outcome<()> {
        if self.frames < 2 {
            return Err(format!("{} frames; give at least 2, one at each end", self.frames).into());
        }
        Ok(())
    }
    /// What a run that goes on must have in common with the one before.
    pub(super) fn setup(&self) -> String {
        format!("{:?}", (self.dt, self.courant, self.kernel, self.frames))
    }
}

fn kernel(name: &str) -> Result<Kernel, String> {
    match name {
        "yang" => Ok(Kernel::Yang),
        "quartic" => Ok(Kernel::QuarticSpline),
        "quintic" => Ok(Kernel::QuinticSpline),
        _ => Err("give yang, quartic or quintic".into()),
    }
}
