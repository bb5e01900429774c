//! How far a run has come: a bar on a terminal, about ten plain lines elsewhere. Both go to stderr.

use std::fmt;
use std::io::{IsTerminal, Write, stderr};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::cpu::readable;

/// Steps between two looks at the clock.
const STRIDE: u64 = 4;
/// Least time between two updates of the bar.
const PAUSE: Duration = Duration::from_millis(100);
/// Plain lines in a run without a terminal.
const LINES: f64 = 10.0;
/// Resolution of the bar.
const TICKS: f64 = 10_000.0;

/// What one update shows.
#[derive(Clone, Copy, Debug, Default)]
pub struct Status {
    /// Simulated time in seconds.
    pub time: f64,
    /// Time step in seconds.
    pub dt: f64,
    /// Courant number.
    pub courant: f64,
    /// What is left of the divergence.
    pub divergence: f64,
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { dt, courant, divergence, .. } = self;
        write!(f, "dt {dt:.2e} s  Co {courant:.2}  div {divergence:.1e}")
    }
}

/// Count of a run's progress.
#[derive(Clone, Copy)]
enum Kind {
    /// Steps in time \[s\].
    Unsteady,
    /// Iterations towards a steady state, measured by the logarithm of the residual.
    Steady,
}

impl Kind {
    fn unit(self) -> &'static str {
        match self {
            Self::Unsteady => "steps",
            Self::Steady => "iterations",
        }
    }
}

/// The progress of a run from its first instant to its last.
pub struct Progress {
    kind: Kind,
    bar: Option<ProgressBar>,
    begin: f64,
    end: f64,
    started: Instant,
    shown: Instant,
    /// Unknown until the first step: a run may be the continuation of another.
    shown_step: Option<u64>,
    shown_time: f64,
    steps_per_second: f64,
    simulated_per_second: f64,
    next_line: f64,
}

impl Progress {
    /// Begins at simulated time `begin`; the run is over at `end`.
    pub fn new(begin: f64, end: f64) -> Self {
        Self::of(Kind::Unsteady, begin, end)
    }

    /// Iterations to a steady state, over where −log₁₀ of the residual is that of the `tolerance`.
    pub fn steady(tolerance: f64) -> Self {
        Self::of(Kind::Steady, 0.0, -tolerance.log10())
    }

    fn of(kind: Kind, begin: f64, end: f64) -> Self {
        let bar = stderr().is_terminal().then(|| {
            let bar =
                ProgressBar::with_draw_target(Some(TICKS as u64), ProgressDrawTarget::stderr_with_hz(60));
            let style = ProgressStyle::with_template("{prefix} {wide_bar:.cyan/black.bright} {msg}");
            bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("━╸━"))
        });
        let now = Instant::now();
        Self {
            kind,
            bar,
            begin,
            end,
            started: now,
            shown: now,
            shown_step: None,
            shown_time: begin,
            steps_per_second: 0.0,
            simulated_per_second: 0.0,
            next_line: 1.0 / LINES,
        }
    }

    /// To be called after every step with the count of steps done; `status` is asked only when something is
    /// shown, at most ten times a second.
    #[inline]
    pub fn step(&mut self, step: u64, status: impl FnOnce() -> Status) {
        if step.is_multiple_of(STRIDE) {
            let now = Instant::now();
            if now.duration_since(self.shown) >= PAUSE {
                let status = status();
                self.show(step, status.time, &status.to_string(), now);
            }
        }
    }

    /// The same with another `text`, at the simulated `time` or at −log₁₀ of a steady run's residual.
    #[inline]
    pub fn tell(&mut self, step: u64, time: f64, text: impl FnOnce() -> String) {
        let now = Instant::now();
        if now.duration_since(self.shown) >= PAUSE {
            self.show(step, time, &text(), now);
        }
    }

    fn show(&mut self, step: u64, time: f64, text: &str, now: Instant) {
        let seconds = now.duration_since(self.shown).as_secs_f64();
        if let Some(before) = self.shown_step {
            // Rates forget with a time of two seconds; the first one takes what it sees.
            let keep = if self.steps_per_second == 0.0 { 0.0 } else { (-seconds / 2.0).exp() };
            let blend = |old: f64, new: f64| keep * old + (1.0 - keep) * new / seconds;
            self.steps_per_second = blend(self.steps_per_second, step.saturating_sub(before) as f64);
            self.simulated_per_second = blend(self.simulated_per_second, time - self.shown_time);
        }
        (self.shown, self.shown_step, self.shown_time) = (now, Some(step), time);

        let done = ((time - self.begin) / (self.end - self.begin)).clamp(0.0, 1.0);
        let line = self.bar.is_none() && done >= self.next_line;
        if line {
            self.next_line = ((done * LINES).floor() + 1.0) / LINES;
        }
        if self.bar.is_none() && !line {
            return;
        }
        let position = match self.kind {
            Kind::Unsteady => format!("t = {time:.4} of {:.4} s  step {step}", self.end),
            Kind::Steady => format!("iteration {step}"),
        };
        let left = (self.end - time) / self.simulated_per_second;
        let left = Duration::try_from_secs_f64(left).map_or_else(|_| "?".into(), readable);
        let message = format!("{text}  {:.0} {}/s  {left} left", self.steps_per_second, self.kind.unit());
        match &self.bar {
            Some(bar) => {
                bar.set_prefix(position);
                bar.set_position((done * TICKS) as u64);
                bar.set_message(message);
            }
            None => {
                let _ = writeln!(stderr(), "{:3.0} %  {position}  {message}", 100.0 * done);
            }
        }
    }

    /// Takes the bar away and leaves one line behind: how many steps, how long, and `message`.
    pub fn finish(self, steps: u64, message: &str) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        let wall = self.started.elapsed();
        let rate = steps as f64 / wall.as_secs_f64().max(1e-9);
        let unit = self.kind.unit();
        // Nobody may be reading any more.
        let _ = writeln!(stderr(), "{message}: {steps} {unit} in {} ({rate:.0} {unit}/s)", readable(wall));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn status_is_asked_seldom() {
        let mut progress = Progress::new(0.0, 1.0);
        let mut asked = 0;
        let started = Instant::now();
        for step in 1..=100_000u64 {
            progress.step(step, || {
                asked += 1;
                Status { time: step as f64 * 1e-5, ..Status::default() }
            });
        }
        assert!(f64::from(asked) <= 1.0 + started.elapsed().as_secs_f64() / PAUSE.as_secs_f64());
        progress.finish(100_000, "done");
    }
}
