//! Models of two transport equations: one for k, one for ω or ε.
mod damping;
mod k_epsilon;
mod law;
mod realizable;
mod solve;
mod sst;
#[cfg(test)]
mod tests;
mod wilcox;

pub use k_epsilon::StandardKEpsilon;
pub use law::{Invariants, Law, Local, Scale, Terms};
pub use realizable::Realizable;
pub use sst::Sst;
pub use wilcox::Wilcox;

use crate::error::positive;
use crate::wall::WallLayer;
use crate::{Inflow, TurbulenceError, WallFunctions, YPlus};
use damping::Damping;
use interfaces::{Checkpoint, Closure, RestartError, SolveError, SolveInfo, Transport, WallRow};
use std::ops::Range;

/// k–ω of Wilcox (1988).
pub type KOmega = TwoEquation<Wilcox>;
/// k–ε of Launder & Spalding (1974).
pub type KEpsilon = TwoEquation<StandardKEpsilon>;
/// Realizable k–ε of Shih et al. (1995).
pub type RealizableKEpsilon = TwoEquation<Realizable>;
/// k–ω SST of Menter, Kuntz & Langtry (2003).
pub type KOmegaSst = TwoEquation<Sst>;

/// How a [`TwoEquation`] model is iterated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controls {
    /// Under-relaxation of k in steady iterations, in (0, 1]: what the flow carries goes 1/(1 − α) cells in one. Default 0.95.
    pub relax_k: f64,
    /// Under-relaxation of ω or ε in steady iterations, in (0, 1]. Default 0.95.
    pub relax_scale: f64,
}

impl Default for Controls {
    fn default() -> Self {
        Self { relax_k: 0.95, relax_scale: 0.95 }
    }
}

/// A model of two equations,
///
/// ```text
/// ∂k/∂t + ∇·(uk) − ∇·((ν + σ_k ν_t)∇k) = P − sink_k k
/// ∂s/∂t + ∇·(us) − ∇·((ν + σ_s ν_t)∇s) = source_s − sink_s s,     s = ω or ε
/// ```
///
/// whose terms its [`Law`] says. What is produced is explicit and not negative, what is consumed implicit, so that k and s stay
/// positive by construction; [`floored`](Self::floored) counts the cells where round-off or a linear solver that stopped early
/// made it necessary to set a value. Beside walls [`WallFunctions`] give s, the production of k and the wall's friction.
#[derive(Clone, Debug)]
pub struct TwoEquation<L> {
    law: L,
    controls: Controls,
    inflow: Inflow,
    /// Cells whose k and s are given.
    given: [Vec<(usize, f64)>; 2],
    pins: Vec<(usize, f64)>,
    layer: WallLayer,
    k: Vec<f64>,
    scale: Vec<f64>,
    eddy: Vec<f64>,
    work: Work,
    /// Of k and s.
    damping: [Damping; 2],
    /// What the last solves of s and k did.
    solves: [SolveInfo; 2],
    floored: usize,
    limited: usize,
    y_plus: YPlus,
}

/// Lists of one entry per cell.
#[derive(Clone, Debug, Default)]
struct Work {
    strain: Vec<f64>,
    /// ∇k·∇s.
    cross: Vec<f64>,
    /// What the law wants to know again; not a number before the first time.
    auxiliary: Vec<f64>,
    gradient: Vec<[[f64; 3]; 3]>,
    terms: [Vec<f64>; 3],
    /// Cells of viscous sublayers, and how much they are that.
    sublayer: Vec<(usize, f64)>,
    /// Cells in which something happens.
    runs: Vec<Range<usize>>,
}

/// The least value of k \[m²/s²\] and of ω or ε.
const FLOOR: f64 = 1e-30;
/// So little that it is none, and enough not to be counted as set after a solve: k in solids, and where k, ω or ε die out.
pub(crate) const NOTHING: f64 = 2.0 * FLOOR;

impl<L: Law> TwoEquation<L> {
    /// The model `law` on `cells` cells, all as `inflow`, which is also what enters.
    ///
    /// # Errors
    /// [`TurbulenceError::Value`] for constants or an inflow that make no sense.
    pub fn new(law: L, cells: usize, inflow: Inflow) -> Result<Self, TurbulenceError> {
        law.check()?;
        inflow.check()?;
        let list = |wanted: bool, value: f64| vec![value; if wanted { cells } else { 0 }];
        let mut new = Self {
            controls: Controls::default(),
            inflow,
            given: [const { Vec::new() }; 2],
            pins: Vec::new(),
            layer: WallLayer::new(WallFunctions::default()),
            k: vec![0.0; cells],
            scale: vec![0.0; cells],
            eddy: vec![0.0; cells],
            work: Work {
                strain: list(true, 0.0),
                cross: list(L::CROSS_DIFFUSION, 0.0),
                auxiliary: list(L::AUXILIARY, f64::NAN),
                gradient: if L::GRADIENT { vec![[[0.0; 3]; 3]; cells] } else { Vec::new() },
                terms: std::array::from_fn(|_| list(true, 0.0)),
                sublayer: Vec::new(),
                runs: Vec::new(),
            },
            damping: Default::default(),
            solves: [SolveInfo::default(); 2],
            floored: 0,
            limited: 0,
            y_plus: YPlus::default(),
            law,
        };
        new.fill(inflow)?;
        Ok(new)
    }

    /// The same with these wall functions.
    ///
    /// # Errors
    /// [`TurbulenceError::Value`].
    pub fn with_wall_functions(mut self, functions: WallFunctions) -> Result<Self, TurbulenceError> {
        functions.check()?;
        self.layer = WallLayer::new(functions);
        Ok(self)
    }

    /// The same with these controls.
    ///
    /// # Errors
    /// [`TurbulenceError::Value`].
    pub fn with_controls(mut self, controls: Controls) -> Result<Self, TurbulenceError> {
        for (name, value) in
            [("the relaxation factor of k", controls.relax_k), ("that of ω or ε", controls.relax_scale)]
        {
            if !(value > 0.0 && value <= 1.0) {
                return Err(TurbulenceError::Value { name, value, range: "above 0 and at most 1" });
            }
        }
        self.controls = controls;
        Ok(self)
    }

    /// Sets every cell to `state`; what enters stays.
    ///
    /// # Errors
    /// [`TurbulenceError::Value`].
    pub fn fill(&mut self, state: Inflow) -> Result<(), TurbulenceError> {
        state.check()?;
        self.k.fill(state.k);
        self.scale.fill(L::SCALE.of(&state));
        self.eddy.fill(state.k / state.omega);
        Ok(())
    }

    /// Sets k \[m²/s²\] and ω \[1/s\] or ε \[m²/s³\] of every cell.
    ///
    /// # Errors
    /// [`TurbulenceError`] for lists of the wrong length or with values that are not positive.
    pub fn set(&mut self, k: &[f64], scale: &[f64]) -> Result<(), TurbulenceError> {
        for (what, from, to) in [("k", k, &mut self.k), ("ω or ε", scale, &mut self.scale)] {
            if from.len() != to.len() {
                return Err(TurbulenceError::Length { what, expected: to.len(), found: from.len() });
            }
            from.iter().try_for_each(|&v| positive(what, v))?;
            to.copy_from_slice(from);
        }
        for (eddy, (k, s)) in self.eddy.iter_mut().zip(k.iter().zip(scale)) {
            *eddy = match L::SCALE {
                Scale::Omega => k / s,
                Scale::Epsilon => 0.09 * k * k / s,
            };
        }
        Ok(())
    }

    /// Gives k and the scale of some cells, such as those behind an inlet whose turbulence is not the same everywhere. What was
    /// given before is free again.
    ///
    /// # Errors
    /// [`TurbulenceError::Value`] for a state that makes no sense.
    pub fn give(&mut self, cells: impl IntoIterator<Item = (usize, Inflow)>) -> Result<(), TurbulenceError> {
        self.given.iter_mut().for_each(Vec::clear);
        for (cell, state) in cells {
            state.check()?;
            self.given[0].push((cell, state.k));
            self.given[1].push((cell, L::SCALE.of(&state)));
        }
        Ok(())
    }

    /// k of every cell \[m²/s²\].
    pub fn k(&self) -> &[f64] {
        &self.k
    }
    /// ω \[1/s\] or ε \[m²/s³\] of every cell.
    pub fn scale(&self) -> &[f64] {
        &self.scale
    }
    /// ν_t of every cell \[m²/s\].
    pub fn nu_t(&self) -> &[f64] {
        &self.eddy
    }
    /// The model's constants.
    pub fn law(&self) -> &L {
        &self.law
    }
    /// y+ of the cells beside walls, as of the last call.
    pub fn y_plus(&self) -> YPlus {
        self.y_plus
    }
    /// Values that had to be set to the least one in the last call.
    pub fn floored(&self) -> usize {
        self.floored
    }
    /// Cells whose ν_t was limited in the last call: in steady iterations the mixing length C_μ^¾ k^(3/2)/ε is at most the largest
    /// distance from a wall.
    pub fn limited(&self) -> usize {
        self.limited
    }
    /// What the last solves of ω or ε, and of k, did.
    pub fn solves(&self) -> [SolveInfo; 2] {
        self.solves
    }
}

impl<L: Law> Closure for TwoEquation<L> {
    fn eddy_viscosity(&self) -> Option<&[f64]> {
        Some(&self.eddy)
    }
    fn kinetic_energy(&self) -> Option<&[f64]> {
        Some(&self.k)
    }
    fn wall_viscosity(&self) -> &[f64] {
        &self.layer.viscosity
    }
    fn wants_walls(&self) -> bool {
        true
    }
    /// In solids k is the least one and ω or ε the largest of any cell (Isoz et al. 2023, section 3); what has come out of one is the mean
    /// of the cells around.
    fn immerse(&mut self, solid: &[usize], fresh: &[(usize, Vec<usize>)]) {
        for list in [&mut self.k, &mut self.scale, &mut self.eddy] {
            for (cell, from) in fresh.iter().filter(|(_, from)| !from.is_empty()) {
                list[*cell] = from.iter().map(|&c| list[c]).sum::<f64>() / from.len() as f64;
            }
        }
        solid.iter().for_each(|&cell| self.scale[cell] = FLOOR);
        let most = self.scale.iter().copied().fold(FLOOR, f64::max);
        for &cell in solid {
            (self.k[cell], self.scale[cell], self.eddy[cell]) = (NOTHING, most, 0.0);
        }
    }
    fn see_walls(&mut self, walls: &[WallRow], nu: f64) -> Result<(), SolveError> {
        self.layer.see(walls, &self.k, nu)
    }
    fn cell_state(&self) -> Vec<&[f64]> {
        vec![&self.k, &self.scale, &self.eddy]
    }
    fn set_cell_state(&mut self, state: &[Vec<f64>]) -> Result<(), SolveError> {
        let [k, scale, eddy] = state else {
            let found = state.len();
            return Err(SolveError::Solver(format!(
                "{found} lists for a model of k, ω or ε, and ν_t: give three"
            )));
        };
        self.set(k, scale).map_err(|error| SolveError::Solver(error.to_string()))?;
        if eddy.len() != self.eddy.len() {
            return Err(SolveError::Length { what: "ν_t", expected: self.eddy.len(), found: eddy.len() });
        }
        // That of the law, which may be less than k and the scale alone say.
        self.eddy.copy_from_slice(eddy);
        Ok(())
    }
    fn residual(&self) -> f64 {
        f64::max(self.solves[0].initial_residual, self.solves[1].initial_residual)
    }

    fn correct(
        &mut self,
        flow: &mut dyn Transport,
        walls: &[WallRow],
        nu: f64,
        dt: Option<f64>,
    ) -> Result<(), SolveError> {
        let (expected, found) = (flow.n_cells(), self.k.len());
        if expected != found {
            return Err(SolveError::Length { what: "the turbulence model", expected, found });
        }
        self.floored = 0;
        self.layer.update(walls, &self.k, nu, L::SCALE)?;
        let mut runs = std::mem::take(&mut self.work.runs);
        runs.clear();
        match flow.runs() {
            Some(some) => runs.extend_from_slice(some),
            None => runs.push(0..expected),
        }
        let solved = self.solve_all(flow, &runs, nu, dt);
        self.work.runs = runs;
        solved?;
        self.layer.refresh(walls, &self.k, nu);
        self.y_plus = self.layer.y_plus(walls, nu, L::SCALE.least_y_plus());
        Ok(())
    }
}

impl<L> Checkpoint for TwoEquation<L> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        sink("k", &self.k);
        sink("scale", &self.scale);
        sink("eddy", &self.eddy);
        sink("walls", &self.layer.viscosity);
        sink("y_plus", &self.y_plus.numbers());
        let damping = self.damping.each_ref().map(Damping::numbers);
        // Memory of steady iterations alone.
        if damping.iter().any(|numbers| !numbers.is_empty()) {
            sink("damping_k", &damping[0]);
            sink("damping_scale", &damping[1]);
            sink("auxiliary", &self.work.auxiliary);
        }
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        for (name, list) in [("k", &mut self.k), ("scale", &mut self.scale), ("eddy", &mut self.eddy)] {
            RestartError::fill(source, name, list)?;
        }
        self.layer.restore(source("walls").ok_or_else(|| RestartError::Missing("walls".into()))?);
        self.y_plus = source("y_plus").and_then(YPlus::from_numbers).unwrap_or_default();
        for (name, damping) in ["damping_k", "damping_scale"].into_iter().zip(&mut self.damping) {
            let numbers = source(name).unwrap_or_default();
            let expected = 2 * self.k.len();
            if !(numbers.is_empty() || numbers.len() == expected) {
                return Err(RestartError::Length { name: name.into(), expected, found: numbers.len() });
            }
            damping.set_numbers(numbers);
        }
        if source("auxiliary").is_some() {
            RestartError::fill(source, "auxiliary", &mut self.work.auxiliary)?;
        }
        Ok(())
    }
}
