//! Implicit transport of cell-centred quantities for turbulence models.
mod dry;
mod flow_transport;
mod kernels;
mod log_slopes;
mod near_solids;
mod params;
mod sides;
mod steep;
#[cfg(test)]
mod tests;
mod wall_faces;
mod walls;

pub(crate) use dry::Dry;
pub use flow_transport::FlowTransport;
pub(crate) use near_solids::NEAREST;
pub use params::{TransportMethod, TransportParams};
pub(crate) use wall_faces::WallFaces;

use crate::kernels::copy_dense;
use crate::linear::{
    BiCgStabParams, BiCgStabScratch, Dilu, GaussSeidelParams, GaussSeidelScratch, GaussSeidelSweep,
    LinearError, LinearOperator, StencilMatrix, Sweep, SweepOrder, bicgstab, gauss_seidel, vector,
};
use crate::operators::{Operators, fill_dense};
use crate::{CartesianGrid, Convection, Field, FlowError, Sides, Velocity};
use interfaces::{Equation, SolveError, SolveInfo};
use kernels::Neighbour;
use near_solids::NearSolids;
use sides::CellSides;
use std::ops::Range;

/// What it takes to solve transport equations at the cells of a grid: matrix, scratch, wall distance. It is made
/// once; [`on`](Self::on) joins it with a velocity to an [`interfaces::Transport`].
///
/// ```text
/// a_P φ_P + Σ_N a_N φ_N = b_P,   a_N = −(Γ_f A/d + max(inflow, 0)),   a_P = −Σ_N a_N + V (sink + 1/dt)
/// ```
///
/// over faces of area A between centres at distance d, Γ_f interpolated linearly. This is ∇·(uφ) − φ∇·u for convection, so
/// that the matrix is an M-matrix whatever ∇·u is: with upwind, and sources and boundary values that are not negative,
/// φ is not negative either. With [`Convection::Upwind`] of first order in space where the flow carries, with the other
/// schemes of second order. Solves allocate nothing.
#[derive(Clone, Debug)]
pub struct CellTransport<const D: usize> {
    ops: Operators<D>,
    sides: CellSides<D>,
    params: TransportParams,
    volume: Vec<f64>,
    wall_distance: Vec<f64>,
    matrix: StencilMatrix<D>,
    dilu: Dilu,
    b: Vec<f64>,
    /// 1/(a_P s), and how steep convection is.
    units: Vec<f64>,
    x: Vec<f64>,
    pinned: Vec<bool>,
    /// Cells without fluid at their centre, and those from which their values are taken.
    dry: Vec<Dry>,
    /// Runs of cells, if not all, in which something happens.
    runs: Option<Vec<Range<usize>>>,
    /// Axis and storage index of the faces of those cells, and the velocity without what it is on them.
    closed: Vec<(usize, usize)>,
    carrier: Option<Box<Velocity<D>>>,
    near: Option<NearSolids<D>>,
    /// Does a forcing make the velocity beside cells without fluid?
    forced: bool,
    bicgstab: BiCgStabScratch,
    gauss_seidel: GaussSeidelScratch,
    /// Γ or a, φ or b, and two terms.
    fields: [Field<D>; 4],
}

/// The share of Newton's method in steady iterations: so much of what a convection scheme lets out of a cell beyond the upwind value because φ is as
/// large as it is there is implicit. Where a limited scheme steepens what flows in, as behind inlets, that grows as fast as the upwind part: with none
/// of it such cells go to and fro between two states for ever.
const NEWTON: f64 = 0.5;

impl<const D: usize> CellTransport<D> {
    /// For flows on `grid` between `sides`.
    ///
    /// # Errors
    /// [`FlowError::Boundary`] for patches that leave out a face.
    pub fn new(
        grid: &CartesianGrid<D>,
        sides: &Sides<D>,
        params: TransportParams,
    ) -> Result<Self, FlowError> {
        let periodic = std::array::from_fn(|a| sides.periodic(a));
        let n = grid.n_cells();
        let too_large = |e: LinearError| FlowError::Grid { what: e.to_string() };
        let mut matrix = StencilMatrix::new(grid.cells(), periodic).map_err(too_large)?;
        matrix.parts_mut().0.fill(1.0);
        Ok(Self {
            ops: Operators::new(grid, periodic),
            sides: CellSides::new(grid, sides)?,
            volume: (0..n).map(|i| grid.cell_volume(grid.cell(i))).collect(),
            wall_distance: walls::wall_distance(grid, sides),
            dilu: Dilu::new(&matrix).map_err(too_large)?,
            matrix,
            b: vec![0.0; n],
            units: vec![0.0; n],
            x: vec![0.0; n],
            pinned: vec![false; n],
            dry: Vec::new(),
            runs: None,
            closed: Vec::new(),
            carrier: None,
            near: None,
            forced: false,
            bicgstab: BiCgStabScratch::new(n),
            gauss_seidel: GaussSeidelScratch::new(n),
            fields: std::array::from_fn(|_| Field::zeros(grid)),
            params,
        })
    }

    /// The transport by `velocity`.
    ///
    /// # Errors
    /// [`FlowError::OtherGrid`] for a velocity on another grid.
    pub fn on<'a>(&'a mut self, velocity: &'a Velocity<D>) -> Result<FlowTransport<'a, D>, FlowError> {
        velocity.components[0].check(self.ops.grid())?;
        Ok(FlowTransport { cells: self, velocity })
    }

    /// The grid.
    pub fn grid(&self) -> &CartesianGrid<D> {
        self.ops.grid()
    }
    /// `field` = `values` and zero gradient across the sides.
    pub(crate) fn spread(&self, values: &[f64], field: &mut Field<D>) {
        copy_dense(self.ops.grid(), values, field);
        self.sides.fill(field, None, None);
    }
    /// Fills the ghosts of periodic axes.
    pub(crate) fn wrap(&self, field: &mut Field<D>) {
        self.sides.wrap(field.data_mut());
    }

    /// The distance of every cell from the nearest wall \[m\].
    pub fn wall_distance(&self) -> &[f64] {
        &self.wall_distance
    }
    /// The distance of every cell from the nearest wall, to lower where bodies are nearer than the walls of the box.
    pub fn wall_distance_mut(&mut self) -> &mut [f64] {
        self.near.iter_mut().for_each(NearSolids::forget_distances);
        &mut self.wall_distance
    }

    fn check(&self, e: &Equation<'_>, phi: &[f64]) -> Result<(), SolveError> {
        let n = self.volume.len();
        let lists =
            [("the diffusivity", e.diffusivity), ("the source", e.source), ("the sink", e.sink), ("φ", phi)];
        for (k, (what, list)) in lists.into_iter().enumerate() {
            check_length(what, n, list.len())?;
            let signed = k % 2 == 1;
            let wrong = |v: f64| !v.is_finite() || !signed && v < 0.0;
            let found = self.ops.cells().find_map(|run| {
                let first = run.start;
                list[run].iter().position(|&v| wrong(v)).map(|i| first + i)
            });
            if let Some(cell) = found {
                let range = if signed { "finite" } else { "finite and not negative" };
                return Err(SolveError::Value { what, cell: Some(cell), value: list[cell], range });
            }
        }
        let value = |what, cell, value, range| Err(SolveError::Value { what, cell, value, range });
        for &(cell, weight, v) in e.blend {
            if !(0.0..=1.0).contains(&weight) {
                return value("the weight of a blend", Some(cell), weight, "in 0 … 1");
            }
            self.check_row(cell, v)?;
        }
        for &(cell, share) in e.steep {
            if !(0.0..=1.0).contains(&share) {
                return value("the share of a steep cell", Some(cell), share, "in 0 … 1");
            }
            self.check_row(cell, share)?;
        }
        e.pinned.iter().try_for_each(|&(cell, v)| self.check_row(cell, v))?;
        if !e.inlet.is_finite() {
            return value("the value on inlets", None, e.inlet, "finite");
        }
        match (e.wall, e.dt) {
            (Some(wall), _) if !wall.is_finite() => value("the value on walls", None, wall, "finite"),
            (_, Some(dt)) if !(dt.is_finite() && dt > 0.0) => {
                value("the time step", None, dt, "positive and finite")
            }
            _ if !(e.relax > 0.0 && e.relax <= 1.0) => {
                value("the relaxation factor", None, e.relax, "above 0 and at most 1")
            }
            _ => Ok(()),
        }
    }

    fn check_row(&self, cell: usize, value: f64) -> Result<(), SolveError> {
        let n = self.volume.len();
        if cell >= n {
            return Err(SolveError::Value {
                what: "a pinned, blended or steep cell",
                cell: Some(cell),
                value,
                range: "a cell of the flow",
            });
        }
        if value.is_finite() {
            return Ok(());
        }
        Err(SolveError::Value { what: "the given value", cell: Some(cell), value, range: "finite" })
    }

    /// Matrix and right-hand side without relaxation, pins and blends.
    fn assemble(&mut self, velocity: &Velocity<D>, e: &Equation<'_>, phi: &[f64]) -> Result<(), FlowError> {
        let Self { ops, sides, matrix, fields: [gamma, ..], .. } = self;
        let (grid, metrics) = (ops.grid(), ops.metrics());
        copy_dense(grid, e.diffusivity, gamma);
        sides.fill(gamma, None, None);
        let (centre, lower, upper) = matrix.parts_mut();
        for axis in 0..D {
            let (gamma, velocity) = (&*gamma, &velocity.components[axis]);
            let kernel = Neighbour::<false, D> { grid, metrics, axis, gamma, velocity };
            fill_dense(grid, ops.spans(), &kernel, lower[axis]);
            let kernel = Neighbour::<true, D> { grid, metrics, axis, gamma, velocity };
            fill_dense(grid, ops.spans(), &kernel, upper[axis]);
        }
        for run in ops.cells() {
            centre[run].fill(0.0);
        }
        self.shut();
        self.steepen(e, phi);
        let second_order = self.params.scheme != Convection::Upwind;
        if second_order {
            self.carry(velocity);
        }
        let Self {
            ops,
            sides,
            params,
            volume,
            wall_distance,
            matrix,
            b,
            units,
            x,
            fields,
            carrier,
            near,
            ..
        } = self;
        let whole = velocity;
        // Else a difference could be taken from what the matrix does not bring.
        let velocity = carrier.as_deref().unwrap_or(velocity);
        let grid = ops.grid();
        let [_, carried, high, low] = fields;
        let (centre, mut lower, mut upper) = matrix.parts_mut();
        for run in ops.cells() {
            for ((b, source), v) in b[run.clone()].iter_mut().zip(&e.source[run.clone()]).zip(&volume[run]) {
                *b = source * v;
            }
        }
        sides.close(ops, e, [&mut *centre, b], [&mut lower, &mut upper]);
        let rate = e.dt.map_or(0.0, f64::recip);
        for i in ops.cells().flatten() {
            let mut sum = centre[i] + volume[i] * (e.sink[i] + rate);
            for axis in 0..D {
                sum -= lower[axis][i] + upper[axis][i];
            }
            centre[i] = sum;
            b[i] += volume[i] * rate * phi[i];
        }
        if second_order {
            copy_dense(grid, phi, carried);
            sides.fill(carried, Some(e.inlet), e.wall);
            ops.convection(velocity, carried, params.scheme, high)?;
            ops.convection(velocity, carried, Convection::Upwind, low)?;
            for run in ops.cells() {
                let (o, cells) = (grid.place(grid.cell(run.start)), run.len());
                let values = high.data()[o..][..cells].iter().zip(&low.data()[o..][..cells]);
                for ((x, v), (high, low)) in x[run.clone()].iter_mut().zip(&volume[run]).zip(values) {
                    *x = v * (high - low);
                }
            }
            if e.dt.is_none() && params.scheme == Convection::Limited {
                ops.steepness(velocity, carried, units);
                for run in ops.cells() {
                    let given = volume[run.clone()].iter().zip(&units[run.clone()]).zip(&phi[run.clone()]);
                    let rows = centre[run.clone()].iter_mut().zip(&mut b[run]);
                    for ((centre, b), ((v, steepness), phi)) in rows.zip(given) {
                        let newton = NEWTON * v * steepness;
                        *centre += newton;
                        *b += newton * phi;
                    }
                }
            }
            if let Some(near) = near {
                let distance = e.inverse.then_some(&wall_distance[..]);
                near.add(whole, phi, distance, x);
            }
            for i in ops.cells().flatten() {
                let rest = x[i];
                if rest < 0.0 && phi[i] > 0.0 {
                    centre[i] -= rest / phi[i];
                } else {
                    b[i] += rest;
                }
            }
        }
        Ok(())
    }

    /// Norm over the cells that are not pinned of the larger of b and a_P φ.
    fn scale(&self, phi: &[f64]) -> f64 {
        let (mut given, mut carried) = (0.0, 0.0);
        for i in self.ops.cells().flatten().filter(|&i| !self.pinned[i]) {
            let (b, term) = (self.b[i], self.matrix.diagonal(i) * phi[i]);
            given += b * b;
            carried += term * term;
        }
        f64::max(given, carried).sqrt()
    }

    /// Solves A x = b until ‖b − A x‖ ≤ `absolute`; gives the iterations and the residuals before and after.
    fn linear(&mut self, x: &mut [f64], absolute: f64) -> Result<(usize, f64, f64), LinearError> {
        let TransportParams { method, max_iterations, .. } = self.params;
        let Self { matrix, dilu, b, bicgstab: scratch, gauss_seidel: sweeps, .. } = self;
        // The solvers tell residuals relative to b.
        let all = vector::norm(b);
        let result = match method {
            TransportMethod::BiCgStab => {
                dilu.refactor(matrix)?;
                let params = BiCgStabParams { relative: 0.0, absolute, max_iterations };
                let solved = bicgstab(&*matrix, &mut dilu.with(matrix)?, b, x, scratch, &params);
                solved.map(|i| (i.iterations, all * i.initial_residual, all * i.residual))
            }
            TransportMethod::GaussSeidel => {
                let params = GaussSeidelParams {
                    relative: 0.0,
                    absolute,
                    max_iterations,
                    order: SweepOrder::Symmetric,
                    ..GaussSeidelParams::default()
                };
                let solved = gauss_seidel(&*matrix, b, x, sweeps, &params);
                solved.map(|i| (i.iterations, all * i.initial_residual, all * i.residual))
            }
        };
        result.map_err(|error| match error {
            LinearError::NotConverged { iterations, residual, tolerance } => {
                LinearError::NotConverged { iterations, residual: all * residual, tolerance }
            }
            other => other,
        })
    }

    fn iterate(&mut self, phi: &mut [f64]) -> Result<SolveInfo, LinearError> {
        if phi.iter().chain(&self.b).all(|v| *v >= 0.0) {
            return self.iterate_positive(phi);
        }
        let scale = self.scale(phi);
        let TransportParams { tolerance, reduction, .. } = self.params;
        let mut absolute = tolerance * scale;
        if reduction > 0.0 {
            let work = &mut self.fields[2].data_mut()[..phi.len()];
            self.matrix.residual(&self.b, phi, work);
            absolute = absolute.max(reduction * vector::norm(work));
        }
        relative(self.linear(phi, absolute), scale, tolerance)
    }

    /// Where no term is negative the solution is not: x = φ/s solves the equations in units of their own diagonal terms a_P s, s the φ
    /// given after a sweep in either direction. So the residual is a relative one in every cell, however many orders of magnitude φ
    /// spans, and what the iteration may leave below zero is set to zero and swept over, which keeps signs.
    fn iterate_positive(&mut self, phi: &mut [f64]) -> Result<SolveInfo, LinearError> {
        let n = phi.len();
        let (mut units, mut x) = (std::mem::take(&mut self.units), std::mem::take(&mut self.x));
        let work = &mut self.fields[2].data_mut()[..n];
        self.matrix.residual(&self.b, phi, work);
        x.copy_from_slice(work);
        self.sweep(phi);
        let mut initial = 0.0;
        for i in self.ops.cells().flatten() {
            if phi[i] <= 0.0 {
                phi[i] = 1.0;
            }
            units[i] = 1.0 / (self.matrix.diagonal(i) * phi[i]);
            if !self.pinned[i] {
                initial += (x[i] * units[i]).powi(2);
            }
            self.b[i] *= units[i];
        }
        let scaled = self.matrix.scale(&units, phi);
        let (scale, TransportParams { tolerance, reduction, .. }) = ((n as f64).sqrt(), self.params);
        let initial = initial.sqrt();
        x.fill(1.0);
        let solved = scaled.and_then(|()| self.linear(&mut x, (tolerance * scale).max(reduction * initial)));
        if x.iter().any(|x| *x < 0.0) {
            x.iter_mut().for_each(|x| *x = x.max(0.0));
            self.sweep(&mut x);
        }
        for run in self.ops.cells() {
            phi[run.clone()].iter_mut().zip(&x[run]).for_each(|(phi, x)| *phi *= x);
        }
        (self.units, self.x) = (units, x);
        relative(solved.map(|(iterations, _, after)| (iterations, initial, after)), scale, tolerance)
    }

    /// One sweep in either direction.
    fn sweep(&mut self, phi: &mut [f64]) {
        let work = &mut self.fields[2].data_mut()[..phi.len()];
        self.matrix.sweep(Sweep::Forward, &self.b, phi, work);
        self.matrix.sweep(Sweep::Backward, &self.b, phi, work);
    }

    fn solve(
        &mut self,
        velocity: &Velocity<D>,
        e: &Equation<'_>,
        phi: &mut [f64],
    ) -> Result<SolveInfo, SolveError> {
        self.check(e, phi)?;
        self.assemble(velocity, e, phi).map_err(|e| SolveError::Solver(e.to_string()))?;
        self.pinned.fill(false);
        let rows = self.matrix.under_relax(e.relax, phi, &mut self.b).and_then(|()| {
            for &(cell, weight, value) in e.blend {
                self.matrix.blend(cell, weight, value, &mut self.b)?;
            }
            for &(cell, value) in e.pinned {
                self.matrix.pin(cell, value, &mut self.b)?;
                (phi[cell], self.pinned[cell]) = (value, true);
            }
            for &(cell, _) in &self.dry {
                self.matrix.pin(cell, phi[cell], &mut self.b)?;
                self.pinned[cell] = true;
            }
            Ok(())
        });
        let solved = rows.and_then(|()| self.iterate(phi));
        e.pinned.iter().for_each(|&(cell, value)| phi[cell] = value);
        self.extend(phi);
        solved.map_err(|error| match error {
            LinearError::NotConverged { iterations, residual, tolerance } => {
                SolveError::NotConverged { iterations, residual, tolerance }
            }
            other => SolveError::Solver(other.to_string()),
        })
    }
}

/// Residuals relative to `scale`.
fn relative(
    solved: Result<(usize, f64, f64), LinearError>,
    scale: f64,
    tolerance: f64,
) -> Result<SolveInfo, LinearError> {
    let ratio = if scale > 0.0 { 1.0 / scale } else { 0.0 };
    match solved {
        Ok((iterations, before, after)) => {
            Ok(SolveInfo { iterations, initial_residual: ratio * before, residual: ratio * after })
        }
        Err(LinearError::NotConverged { iterations, residual, .. }) => {
            Err(LinearError::NotConverged { iterations, residual: ratio * residual, tolerance })
        }
        Err(other) => Err(other),
    }
}

fn check_length(what: &'static str, expected: usize, found: usize) -> Result<(), SolveError> {
    if expected == found { Ok(()) } else { Err(SolveError::Length { what, expected, found }) }
}
