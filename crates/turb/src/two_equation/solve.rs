//! One correction: both equations, and ν_t of what comes out.
use super::damping::Damping;
use super::law::Local;
use super::{FLOOR, Law, Scale, TwoEquation, Work};
use crate::{Invariants, Sublayer};
use interfaces::{Equation, LawOfTheWall, SolveError, SolveInfo, Transport};
use std::ops::Range;

/// The layer is logarithmic as far down as differences reach where y* is this many y+_lam.
const LOGARITHMIC: f64 = 3.0;

impl<L: Law> TwoEquation<L> {
    /// Solves both equations, and makes ν_t of what comes out.
    pub(super) fn solve_all(
        &mut self,
        flow: &mut dyn Transport,
        runs: &[Range<usize>],
        nu: f64,
        dt: Option<f64>,
    ) -> Result<(), SolveError> {
        self.prepare(flow, runs, nu, dt)?;
        self.solves[0] = self.solve_scale(flow, runs, nu, dt)?;
        self.solves[1] = self.solve_k(flow, runs, nu, dt)?;
        let distance = flow.wall_distance();
        let widest = distance.iter().copied().fold(0.0, f64::max);
        // Where k and ε are far from each other ν_t would run away before they are not.
        let length = if dt.is_none() && widest > 0.0 { widest } else { f64::INFINITY };
        self.limited = 0;
        for i in runs.iter().cloned().flatten() {
            let eddy = self.law.eddy_viscosity(&self.local(i, distance[i], nu));
            let most = length * LawOfTheWall::friction_velocity(self.k[i]);
            self.limited += usize::from(eddy > most);
            self.eddy[i] = if eddy > most { most } else { eddy };
        }
        Ok(())
    }

    /// What the law sees of cell `i`.
    #[inline(always)]
    fn local(&self, i: usize, distance: f64, nu: f64) -> Local {
        let Work { strain, cross, auxiliary, .. } = &self.work;
        Local {
            k: self.k[i],
            scale: self.scale[i],
            eddy: self.eddy[i],
            strain: strain[i],
            cross: if L::CROSS_DIFFUSION { cross[i] } else { 0.0 },
            // Of cells in solids.
            distance: distance.max(1e-100),
            nu,
            auxiliary: if L::AUXILIARY { auxiliary[i] } else { 0.0 },
        }
    }

    /// Strain rate, cross diffusion, and what the law makes of them.
    fn prepare(
        &mut self,
        flow: &mut dyn Transport,
        runs: &[Range<usize>],
        nu: f64,
        dt: Option<f64>,
    ) -> Result<(), SolveError> {
        if L::GRADIENT {
            flow.velocity_gradient(&mut self.work.gradient)?;
            let Work { strain, gradient, .. } = &mut self.work;
            for run in runs {
                let strain = strain[run.clone()].iter_mut();
                strain.zip(&gradient[run.clone()]).for_each(|(s, g)| *s = Invariants::of(g).strain);
            }
        } else {
            flow.strain_rate(&mut self.work.strain)?;
        }
        let layer = &self.layer;
        for slope in flow.log_slopes() {
            let y_star = layer.functions.y_star(slope.distance, self.k[slope.cell], nu);
            let share = layer.turbulent_share(y_star / LOGARITHMIC);
            let part = 1.0 + share * (slope.part - 1.0);
            self.work.strain[slope.cell] *= part;
            if L::GRADIENT {
                self.work.gradient[slope.cell].iter_mut().flatten().for_each(|g| *g *= part);
            }
        }
        if L::CROSS_DIFFUSION {
            flow.dot_gradients(&self.k, &self.scale, &mut self.work.cross)?;
        }
        for w in &self.layer.cells {
            if let Some(shear) = w.shear {
                let strain = &mut self.work.strain[w.cell];
                *strain = mix(w.free, shear, *strain);
            }
        }
        if L::AUXILIARY {
            // Steady iterations of SST may else go round in circles where F₁ changes abruptly.
            let distance = flow.wall_distance();
            for i in runs.iter().cloned().flatten() {
                let local = self.local(i, distance[i], nu);
                let invariants = self.work.gradient.get(i).map(Invariants::of).unwrap_or_default();
                let new = self.law.auxiliary(&local, invariants);
                let old = &mut self.work.auxiliary[i];
                // In time there is no memory of it, to the last bit; nor at first.
                *old = if dt.is_some() || old.is_nan() { new } else { 0.5 * (*old + new) };
            }
            for w in self.layer.cells.iter().filter(|_| L::GRADIENT) {
                if let Some(shear) = w.shear {
                    let local = self.local(w.cell, distance[w.cell], nu);
                    let beside = self.law.auxiliary(&local, Invariants::shear(shear));
                    let auxiliary = &mut self.work.auxiliary[w.cell];
                    *auxiliary = mix(w.free, beside, *auxiliary);
                }
            }
        }
        Ok(())
    }

    fn solve_scale(
        &mut self,
        flow: &mut dyn Transport,
        runs: &[Range<usize>],
        nu: f64,
        dt: Option<f64>,
    ) -> Result<SolveInfo, SolveError> {
        let mut terms = std::mem::take(&mut self.work.terms);
        let distance = flow.wall_distance();
        for i in runs.iter().cloned().flatten() {
            self.law.scale_terms(&self.local(i, distance[i], nu)).put(&mut terms, i);
        }
        self.find_sublayer(distance, runs, nu);
        let inlet = L::SCALE.of(&self.inflow);
        let relax = if dt.is_some() { 1.0 } else { self.controls.relax_scale };
        self.pins.clear();
        self.pins.extend_from_slice(&self.layer.pins);
        self.pins.extend_from_slice(&self.given[1]);
        let blend = &self.layer.blends;
        let given = Equation { pinned: &self.pins, blend, ..equation(&terms, inlet, relax, dt) };
        let equation = Equation { inverse: true, steep: &self.work.sublayer, ..given };
        // ε follows k at once, beside walls and in ν_t.
        let damping = (L::SCALE == Scale::Omega).then_some(&mut self.damping[1]);
        let solved = solve(flow, &equation, &mut self.scale, damping, runs);
        self.work.terms = terms;
        self.floored += floor(&mut self.scale);
        solved
    }

    /// Finds the cells in which ω goes like 1/y².
    fn find_sublayer(&mut self, distance: &[f64], runs: &[Range<usize>], nu: f64) {
        let (layer, sublayer) = (&self.layer, &mut self.work.sublayer);
        sublayer.clear();
        if L::SCALE == Scale::Epsilon || layer.functions.sublayer == Sublayer::Linear {
            return;
        }
        // Beyond this y* the share is below 1e-3.
        let most = (1.62 * layer.laminar * nu / layer.functions.y_star(1.0, 1.0, 1.0)).powi(2);
        for i in runs.iter().cloned().flatten().filter(|&i| distance[i] > 0.0) {
            if self.k[i] * distance[i] * distance[i] < most {
                let y_star = layer.functions.y_star(distance[i], self.k[i], nu);
                sublayer.push((i, 1.0 - layer.turbulent_share(y_star)));
            }
        }
    }

    fn solve_k(
        &mut self,
        flow: &mut dyn Transport,
        runs: &[Range<usize>],
        nu: f64,
        dt: Option<f64>,
    ) -> Result<SolveInfo, SolveError> {
        let mut terms = std::mem::take(&mut self.work.terms);
        let distance = flow.wall_distance();
        for i in runs.iter().cloned().flatten() {
            let local = self.local(i, distance[i], nu);
            self.law.k_terms(&local, local.eddy * local.strain * local.strain).put(&mut terms, i);
        }
        for w in &self.layer.cells {
            let mut local = self.local(w.cell, distance[w.cell], nu);
            let resolved = local.eddy * local.strain * local.strain;
            local.k = mix(w.free, w.k, local.k);
            let produced = w.production + (1.0 - w.share) * resolved;
            let mut of_cell = self.law.k_terms(&local, mix(w.free, produced, resolved));
            of_cell.sink += w.conductance / flow.cell_volume(w.cell);
            of_cell.put(&mut terms, w.cell);
        }
        let relax = if dt.is_some() { 1.0 } else { self.controls.relax_k };
        let equation = Equation { pinned: &self.given[0], ..equation(&terms, self.inflow.k, relax, dt) };
        let solved = solve(flow, &equation, &mut self.k, Some(&mut self.damping[0]), runs);
        self.work.terms = terms;
        self.floored += floor(&mut self.k);
        solved
    }
}

fn equation(terms: &[Vec<f64>; 3], inlet: f64, relax: f64, dt: Option<f64>) -> Equation<'_> {
    let [diffusivity, source, sink] = terms;
    Equation { inlet, dt, relax, ..Equation::new(diffusivity, source, sink) }
}

/// `beside` a wall, `own` of the model: (1 − free) of the first and the rest of the second.
fn mix(free: f64, beside: f64, own: f64) -> f64 {
    if free > 0.0 { beside + free.min(1.0) * (own - beside) } else { beside }
}

/// Solves `equation` for `list`. A steady iteration need not be exact, and is damped.
fn solve(
    flow: &mut dyn Transport,
    equation: &Equation<'_>,
    list: &mut [f64],
    damping: Option<&mut Damping>,
    runs: &[Range<usize>],
) -> Result<SolveInfo, SolveError> {
    let Some(damping) = damping.filter(|_| equation.dt.is_none()) else {
        return tolerant(flow.solve(equation, list), equation.dt);
    };
    damping.remember(list);
    let solved = tolerant(flow.solve(equation, list), None);
    damping.damp(list, runs);
    equation.pinned.iter().for_each(|&(cell, value)| list[cell] = value);
    solved
}

/// A steady iteration may end before the solver has what was asked.
fn tolerant(solved: Result<SolveInfo, SolveError>, dt: Option<f64>) -> Result<SolveInfo, SolveError> {
    match solved {
        Err(SolveError::NotConverged { iterations, residual, .. })
            if dt.is_none() && residual.is_finite() =>
        {
            Ok(SolveInfo { iterations, residual, initial_residual: residual })
        }
        other => other,
    }
}

/// Sets what is below the least value to it, and counts.
fn floor(list: &mut [f64]) -> usize {
    let mut count = 0;
    for v in list.iter_mut().filter(|v| **v < FLOOR) {
        *v = FLOOR;
        count += 1;
    }
    count
}
