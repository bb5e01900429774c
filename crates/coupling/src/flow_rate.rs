//! Body force that holds a flow rate.
use interfaces::{Checkpoint, RestartError};
use std::fmt;

/// Uniform body force f per mass along an axis that gives the mean velocity over the box, bodies
/// included, a target Ū(t): with the mean velocity U and steps n,
///
/// fⁿ⁺¹ = fⁿ − (Uⁿ⁺¹ − Uⁿ)/Δtⁿ + (Ū(tⁿ⁺¹ + Δt) − Uⁿ⁺¹)/Δt.
///
/// The first two terms are the deceleration by walls and bodies in the last step, the third what is
/// missing. Deviations decay whatever the step: those of a mode that friction damps at the rate k by
/// the factor kΔt/(1 + kΔt), and a constant target is met without error in a steady flow. The first
/// force is (Ū − U⁰)/Δt.
///
/// ```
/// use coupling::{FlowRate, Simulation, WeightBalance};
/// use fv_mesh::{CartesianGrid, Fluid, Projection, Side};
///
/// let grid = CartesianGrid::new([4, 10], [0.4, 1.0])?;
/// let sides = [[Side::Periodic, Side::Periodic], [Side::WALL, Side::WALL]];
/// let flow = Projection::new(grid, sides, Fluid { density: 1.0, viscosity: 0.1 })?;
/// let mut channel = Simulation::new(flow, (), WeightBalance::None)?
///     .with_flow_rate(FlowRate::new(0, |_| 0.5));
/// for _ in 0..400 {
///     channel.step(0.02)?;
/// }
/// // 12 ν U/H², less 1/(2N²), by which the mean over N cells exceeds the integral.
/// let exact = 12.0 * 0.1 * 0.5 / (1.0 + 0.5 / 100.0);
/// assert!((channel.body_force().x / exact - 1.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct FlowRate {
    pub(crate) axis: usize,
    target: Box<dyn Fn(f64) -> f64 + Send + Sync>,
    last: Option<Last>,
}

/// The last step.
#[derive(Clone, Copy, Debug)]
struct Last {
    /// Force \[m/s²\], mean velocity at the start \[m/s\], length \[s\].
    force: f64,
    mean: f64,
    dt: f64,
}

impl FlowRate {
    /// Mean velocity \[m/s\] along the periodic `axis` as a function of time \[s\].
    pub fn new(axis: usize, target: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Self {
        Self { axis, target: Box::new(target), last: None }
    }

    /// Force \[m/s²\] of the step from `time` of length `dt` \[s\], at whose start the mean velocity
    /// is `mean` \[m/s\].
    pub(crate) fn force(&mut self, mean: f64, time: f64, dt: f64) -> f64 {
        let missing = ((self.target)(time + dt) - mean) / dt;
        let resistance = self.last.map_or(0.0, |last| last.force - (mean - last.mean) / last.dt);
        let force = resistance + missing;
        self.last = Some(Last { force, mean, dt });
        force
    }
}

impl fmt::Debug for FlowRate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("FlowRate").field("axis", &self.axis).field("last", &self.last).finish_non_exhaustive()
    }
}

impl Checkpoint for FlowRate {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        sink("last", &self.last.map_or([0.0; 3], |Last { force, mean, dt }| [force, mean, dt]));
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        let mut last = [0.0; 3];
        RestartError::fill(source, "last", &mut last)?;
        let [force, mean, dt] = last;
        // A step has a length.
        self.last = (dt > 0.0).then_some(Last { force, mean, dt });
        Ok(())
    }
}
