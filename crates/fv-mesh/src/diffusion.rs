//! Which axes diffuse implicitly.
use crate::FlowError;
use crate::metrics::{AxisMetrics, NodeMetrics};

/// How viscous terms are advanced in time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Diffusion {
    /// Explicit along the axes where the step allows it, implicit along the others.
    #[default]
    Auto,
    /// Explicit along all axes: the step has to stay within the viscous limit.
    Explicit,
    /// Implicit along all axes.
    Implicit,
}

/// Implicit steps are at most so many times the explicit limit, for the sake of accuracy.
const IMPLICIT_GAIN: f64 = 10.0;

/// A step is kept so much shorter than the limit of what is explicit.
const MARGIN: f64 = 0.9;

/// Diffusion by Adams–Bashforth along the axes where a step is within its stability limit, by Crank–Nicolson along the
/// others.
#[derive(Clone, Debug)]
pub(crate) struct SplitDiffusion<const D: usize> {
    pub(crate) mode: Diffusion,
    /// Must it be explicit, as beside immersed walls, whose cut links would couple the lines of an implicit axis?
    pub(crate) walled: bool,
    /// Γ or ν \[m²/s\].
    diffusivity: f64,
    /// Half the largest sum of coefficients of the second difference along each axis \[1/m²\].
    stiffness: [f64; D],
    /// The axes that were implicit in the last step.
    pub(crate) last: [bool; D],
}

impl<const D: usize> SplitDiffusion<D> {
    pub(crate) fn new(diffusivity: f64, stiffness: [f64; D]) -> Self {
        Self { mode: Diffusion::Auto, walled: false, diffusivity, stiffness, last: [false; D] }
    }

    /// The mode that is in force.
    ///
    /// # Errors
    /// [`FlowError::Parameter`] for implicit diffusion beside immersed walls.
    pub(crate) fn mode(&self) -> Result<Diffusion, FlowError> {
        match self.mode {
            Diffusion::Implicit if self.walled => {
                let range = "Explicit or Auto in a flow with immersed walls";
                Err(FlowError::Parameter { name: "Diffusion::Implicit", value: 1.0, range })
            }
            Diffusion::Auto if self.walled => Ok(Diffusion::Explicit),
            mode => Ok(mode),
        }
    }

    /// The longest step \[s\] for which Adams–Bashforth is stable if the axes of `implicit` are taken out of it; `extra` \[1/s\],
    /// the largest Σ ν/h² of what else diffuses, is explicit along all axes.
    pub(crate) fn limit(&self, extra: f64, implicit: &[bool; D]) -> f64 {
        let explicit = (0..D).filter(|&a| !implicit[a]);
        0.25 / (extra + explicit.map(|a| self.diffusivity * self.stiffness[a]).sum::<f64>())
    }

    /// The axes that have to be implicit in a step of `dt`.
    ///
    /// # Errors
    /// [`FlowError::Unstable`] if what is explicit does not allow it, and those of [`mode`](Self::mode).
    pub(crate) fn choose(&self, dt: f64, extra: f64) -> Result<[bool; D], FlowError> {
        let chosen = match self.mode()? {
            Diffusion::Implicit => [self.diffusivity > 0.0; D],
            Diffusion::Explicit => [false; D],
            Diffusion::Auto => {
                // Not to and fro with small changes of the step.
                let (needed, soon) = (self.stiff_axes(dt, extra), self.stiff_axes(2.0 * dt, extra));
                let keep = (0..D).all(|a| (self.last[a] || !needed[a]) && (soon[a] || !self.last[a]));
                if keep { self.last } else { needed }
            }
        };
        let limit = self.limit(extra, &chosen);
        if dt > limit { Err(FlowError::Unstable { dt, limit }) } else { Ok(chosen) }
    }

    /// The fewest axes that have to be implicit for the others to be stable with a step of `dt`.
    fn stiff_axes(&self, dt: f64, extra: f64) -> [bool; D] {
        let mut implicit = [false; D];
        while dt > self.limit(extra, &implicit) {
            let stiffness = |a: &usize| self.stiffness[*a];
            let rest = (0..D).filter(|&a| !implicit[a]);
            let Some(a) = rest.max_by(|a, b| stiffness(a).total_cmp(&stiffness(b))) else { break };
            implicit[a] = true;
        }
        implicit
    }

    /// The diffusivities along the axes where a step is explicit, and along those where it is implicit; else zero.
    pub(crate) fn parts(&self, implicit: [bool; D]) -> [[f64; D]; 2] {
        [false, true].map(|which| implicit.map(|i| if i == which { self.diffusivity } else { 0.0 }))
    }

    /// The longest step \[s\] to take: a tenth inside the limit of what is explicit, at most ten times the limit of explicit
    /// diffusion.
    pub(crate) fn longest_step(&self, extra: f64) -> f64 {
        let explicit = self.limit(extra, &[false; D]);
        match self.mode() {
            Ok(Diffusion::Explicit) => MARGIN * explicit,
            _ => (IMPLICIT_GAIN * explicit).min(MARGIN * self.limit(extra, &[true; D])),
        }
    }
}

/// The largest coefficient of a second difference that a change of each of the first `n` cells' diffusivity enters, 1/h² on uniform
/// axes.
pub(crate) fn stiffness_of_cells(axis: &AxisMetrics, n: usize) -> Vec<f64> {
    let g = crate::grid::GHOSTS;
    let around = |nodes: &NodeMetrics, i: usize| {
        (i - 1..=i + 1).map(|i| nodes.up[i].max(nodes.down[i])).fold(0.0, f64::max)
    };
    (g..g + n).map(|i| around(&axis.centres, i).max(around(&axis.faces, i))).collect()
}

/// Half the largest sum of coefficients of the second difference of the first `n` nodes inside the box, 1/h² on uniform
/// axes. The eigenvalues of the difference reach four times that.
pub(crate) fn stiffness(nodes: &NodeMetrics, n: usize) -> f64 {
    let g = crate::grid::GHOSTS;
    (g..g + n).map(|i| 0.5 * (nodes.up[i] + nodes.down[i])).fold(0.0, f64::max)
}
