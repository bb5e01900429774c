//! Shifted POD with interpolated coefficients and paths.
use super::assessment::Sums;
use super::coefficients::Coefficients;
use super::modes::write_modes;
use super::moving_modes::{CoefficientFit, MovingModes};
use super::paths::Paths;
use super::{Assessment, Extrapolation, ModelError};
use crate::interpolation::{FitObserver, FitProgress, FitStage, Method, Record, RecordError, unobserved};
use crate::pod::combine;
use crate::shifted::{
    Decomposition, FieldShift, FrameOperators, Grid, GridFrames, Interpolation, Motion, Motions,
    ShiftedError, Shifts, Superposition, Workspace,
};
use crate::{Mat, MatRef};
use interfaces::{Point, Vector};
use monomorphic::Qr;
use std::io;
use std::path::Path;

/// How a [`Spodiann`] interpolates; `None`: the way that predicts samples best which are held out.
#[derive(Clone, Copy, Default)]
pub struct SpodiannParams<'a> {
    /// The coefficients, as functions of time and parameters, and of phases if that lowers the error of samples left out.
    pub coefficients: Option<&'a dyn Method>,
    /// The frames' paths.
    pub paths: Option<&'a dyn Method>,
}

/// Q(x, t, μ) ≈ Σ_k T^{Δ_k(t, μ)} Σ_i c_i^k(t, μ) φ_i^k(x): modes in frames of reference that move, with interpolated coefficients c and motions Δ
/// (sPODIANN; Isoz et al. 2023, equation (9) and figure 8).
///
/// Inputs are time and then parameters. Where a frame moves along an axis by more than half a cell, the phase θ = 2πs/h of its displacement s may be an input of its
/// coefficients, too, as cos θ, sin θ: a sharp edge on a grid of spacing h is aliased, and what its spectral shift leaves is periodic in θ. The method given then interpolates the amplitudes of
/// the harmonics of θ ([`Harmonics`](crate::interpolation::Harmonics)); the default is least squares ([`Varying`](crate::interpolation::Varying)). With parameters it may take cos θ, sin θ as further inputs instead, by the error of runs left out. Phases are inputs if that lowers the error of
/// samples left out: [`coefficient_fits`](Self::coefficient_fits) returns the method of every frame, its phases, and the error with and without them.
///
/// Beyond the samples' times and parameters ([`covers`](Self::covers)) coefficients and paths are extrapolated linearly ([`Extrapolation`]).
pub struct Spodiann {
    interpolation: Interpolation,
    field_shift: FieldShift,
    frames: Vec<MovingModes>,
    /// If all frames only move along periodic axes, by [`Interpolation::Spectral`].
    superposition: Option<Superposition>,
    /// Of the decomposition; in the paths already.
    offsets: Vec<Vector>,
    paths: Paths,
    inputs: usize,
    rows: usize,
    /// ‖Q − Σ T^k Q_k‖/‖Q‖ of the decomposition.
    projection_error: f64,
    /// Root mean square norm of a snapshot.
    typical: f64,
}

impl Spodiann {
    const KIND: &str = "sPODIANN";

    /// Of a decomposition of snapshots at points (inputs × snapshots) that were carried along by `shifts` on a grid.
    ///
    /// # Errors
    /// [`ModelError`]: sizes that do not fit, and those of the interpolation.
    pub fn new(
        points: MatRef<'_, f64>,
        decomposition: &Decomposition,
        (grid, interpolation): (Grid, Interpolation),
        shifts: &dyn Shifts,
        params: SpodiannParams<'_>,
    ) -> Result<Self, ModelError> {
        Self::new_observed(points, decomposition, (grid, interpolation), shifts, params, &mut unobserved)
    }
    /// The same with an observer: [`FitStage::Paths`], then [`FitStage::Frame`] for each.
    ///
    /// # Errors
    /// As [`new`](Self::new);
    /// [`InterpolationError::Stopped`](crate::interpolation::InterpolationError::Stopped) by the
    /// observer.
    pub fn new_observed(
        points: MatRef<'_, f64>,
        decomposition: &Decomposition,
        (grid, interpolation): (Grid, Interpolation),
        shifts: &dyn Shifts,
        params: SpodiannParams<'_>,
        observer: FitObserver<'_>,
    ) -> Result<Self, ModelError> {
        let (frames, m) = (&decomposition.frames, points.ncols());
        ModelError::same("frames of the shifts", frames.len(), shifts.n_frames())?;
        ModelError::same("motions of every frame, one for each point", m, shifts.n_snapshots())?;
        let shifts: &dyn Shifts = &Motions::beside(shifts, &decomposition.offsets);
        let rows = frames.first().map_or(0, |f| f.modes.nrows());
        if rows == 0 || !rows.is_multiple_of(grid.n_cells()) {
            return Err(ShiftedError::Rows { rows, cells: grid.n_cells() }.into());
        }
        let paths = Paths::fit(points, shifts, params.paths, &mut *observer)?;
        let mut squares = 0.0;
        let mut moving = Vec::new();
        for (k, frame) in frames.iter().enumerate() {
            ModelError::same("rows of a frame's modes", rows, frame.modes.nrows())?;
            ModelError::same("coefficients of a frame, one for each point", m, frame.coefficients.ncols())?;
            squares += frame.singular_values.iter().map(|s| s * s).sum::<f64>();
            let motions = |j: usize| shifts.motion(k, j);
            let fit = |observer: FitObserver<'_>| {
                MovingModes::fit(points, frame, &grid, &motions, params.coefficients, observer)
            };
            moving.push(FitProgress::new(FitStage::Frame, k + 1, frames.len()).run(&mut *observer, fit)?);
        }
        Ok(Self {
            interpolation,
            field_shift: FieldShift::new(grid, interpolation),
            superposition: superposition(&grid, interpolation, &paths, &moving),
            frames: moving,
            offsets: decomposition.offsets.clone(),
            paths,
            inputs: points.nrows(),
            rows,
            projection_error: decomposition.history.last().map_or(0.0, |p| p.error),
            typical: (squares / m as f64).sqrt(),
        })
    }

    /// Time and parameters.
    #[must_use]
    pub fn inputs(&self) -> usize {
        self.inputs
    }
    /// Method of the coefficients of every frame; None where it has no modes.
    #[must_use]
    pub fn coefficient_fits(&self) -> Vec<Option<CoefficientFit>> {
        self.frames.iter().map(MovingModes::coefficient_fit).collect()
    }
    /// Name of the method of the frames' paths; None if no frame moves.
    #[must_use]
    pub fn path_method(&self) -> Option<&str> {
        self.paths.method()
    }
    /// The same with another continuation of coefficients and paths beyond the samples ([`covers`](Self::covers)); it is linear unless given.
    #[must_use]
    pub fn extrapolated(mut self, how: Extrapolation) -> Self {
        self.frames.iter_mut().for_each(|frame| frame.extrapolate(how));
        self.paths.extrapolate(how);
        self
    }
    /// Is x within the samples' times and parameters? Predictions elsewhere are extrapolations ([`Extrapolation`]).
    #[must_use]
    pub fn covers(&self, x: &[f64]) -> bool {
        let of_modes = self.frames.iter().find_map(|f| f.coefficients.as_ref()).map(Coefficients::domain);
        let domain = of_modes.or(self.paths.domain()).unwrap_or_default();
        x.len() == self.inputs && x.iter().zip(domain).all(|(x, [low, high])| (low..=high).contains(&x))
    }
    /// Unknowns of a field.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }
    /// Modes of each frame.
    #[must_use]
    pub fn ranks(&self) -> Vec<usize> {
        self.frames.iter().map(|f| f.modes.ncols()).collect()
    }
    /// Where its fields are.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        self.field_shift.grid()
    }
    /// φ^k, rows × r_k.
    #[must_use]
    pub fn modes(&self, frame: usize) -> MatRef<'_, f64> {
        self.frames[frame].modes.as_ref()
    }
    /// The motion of every frame at x.
    ///
    /// # Errors
    /// [`ModelError::Shape`], [`ModelError::Interpolation`].
    pub fn motions(&self, x: &[f64]) -> Result<Vec<Motion>, ModelError> {
        ModelError::same("inputs", self.inputs, x.len())?;
        self.paths.motions(x)
    }

    /// The displacement of every frame at x, as the shifts were given: without the [`offsets`](Decomposition::offsets) of the decomposition.
    ///
    /// # Errors
    /// As [`motions`](Self::motions).
    pub fn places(&self, x: &[f64]) -> Result<Vec<Vector>, ModelError> {
        let motions = self.motions(x)?;
        Ok(motions.iter().zip(&self.offsets).map(|(motion, offset)| motion.displacement - offset).collect())
    }

    /// The field at time and parameters x into `out`.
    ///
    /// # Errors
    /// [`ModelError::Shape`], [`ModelError::Interpolation`]; [`ModelError::Shifted`] if a frame leaves the grid's plane.
    pub fn predict(&self, x: &[f64], out: &mut [f64]) -> Result<(), ModelError> {
        self.predict_many(MatRef::from_column_major_slice(x, x.len(), 1), out)
    }

    /// The fields at points that are columns (inputs × n), one after the other. Each is the same bit for bit as by [`predict`](Self::predict).
    ///
    /// # Errors
    /// As [`predict`](Self::predict).
    pub fn predict_many(&self, points: MatRef<'_, f64>, fields: &mut [f64]) -> Result<(), ModelError> {
        ModelError::same("inputs", self.inputs, points.nrows())?;
        ModelError::same("rows of all fields", self.rows * points.ncols(), fields.len())?;
        let mut work = Workspace::default();
        for (j, out) in fields.chunks_exact_mut(self.rows).enumerate() {
            let x: Vec<f64> = points.col(j).iter().copied().collect();
            let motions = self.motions(&x)?;
            let mut carried = Vec::with_capacity(motions.len());
            for (frame, motion) in self.frames.iter().zip(&motions) {
                let mut c = vec![0.0; frame.modes.ncols()];
                if let Some(function) = &frame.coefficients {
                    function.predict(&frame.inputs(&x, motion, self.field_shift.grid()), &mut c)?;
                }
                carried.push((motion.displacement.into(), c));
            }
            match &self.superposition {
                Some(sum) => sum.field(&carried, &mut work, out),
                None => self.one_by_one(&motions, &carried, out)?,
            }
        }
        Ok(())
    }

    /// The sum of what frames carry, each of them carried along on its own.
    fn one_by_one(
        &self,
        motions: &[Motion],
        carried: &[([f64; 3], Vec<f64>)],
        out: &mut [f64],
    ) -> Result<(), ModelError> {
        out.fill(0.0);
        let mut field = vec![0.0; self.rows];
        for ((frame, motion), (_, c)) in self.frames.iter().zip(motions).zip(carried) {
            combine(&frame.columns(), None, MatRef::from_column_major_slice(c, c.len(), 1), &mut field);
            let moved = self.carry(motion, &field)?;
            out.iter_mut().zip(moved).for_each(|(out, f)| *out += f);
        }
        Ok(())
    }

    /// Estimate of the relative error at x without that of the paths: ‖Q − Σ T^k Q_k‖/‖Q‖ of the decomposition, and the error
    /// of the coefficients from functions that leave out values of time and of the parameters, relative to the root mean
    /// square of the snapshots.
    ///
    /// # Errors
    /// As [`predict`](Self::predict).
    pub fn error_indicator(&self, x: &[f64]) -> Result<f64, ModelError> {
        let mut squares = self.projection_error.powi(2);
        for (frame, motion) in self.frames.iter().zip(self.motions(x)?) {
            let Some(function) = &frame.coefficients else { continue };
            let doubt = function.doubt(&frame.inputs(x, &motion, self.field_shift.grid()))?;
            squares += (doubt / self.typical.max(f64::MIN_POSITIVE)).powi(2);
        }
        Ok(squares.sqrt())
    }

    /// Errors of the predictions at points of snapshots (rows × m) whose motions are known.
    ///
    /// # Errors
    /// As [`predict`](Self::predict).
    pub fn assess(
        &self,
        points: MatRef<'_, f64>,
        snapshots: MatRef<'_, f64>,
        shifts: &dyn Shifts,
    ) -> Result<Assessment, ModelError> {
        self.sums(points, snapshots, shifts).map(Sums::assessment)
    }
    pub(super) fn sums(
        &self,
        points: MatRef<'_, f64>,
        snapshots: MatRef<'_, f64>,
        shifts: &dyn Shifts,
    ) -> Result<Sums, ModelError> {
        ModelError::same("snapshots, one for each point", points.ncols(), snapshots.ncols())?;
        ModelError::same("rows of the snapshots", self.rows, snapshots.nrows())?;
        ModelError::same("frames of the shifts", self.frames.len(), shifts.n_frames())?;
        ModelError::same("motions of every frame, one for each point", points.ncols(), shifts.n_snapshots())?;
        let shifts = Motions::beside(shifts, &self.offsets);
        let mut sums = Sums::default();
        let (mut predicted, mut x) = (vec![0.0; self.rows], vec![0.0; self.inputs]);
        for j in 0..points.ncols() {
            x.iter_mut().enumerate().for_each(|(i, x)| *x = points[(i, j)]);
            self.predict(&x, &mut predicted)?;
            let snapshot: Vec<f64> = (0..self.rows).map(|row| snapshots[(row, j)]).collect();
            let nearest = self.nearest(&snapshot, |k| shifts.motion(k, j))?;
            sums.add(&snapshot, &nearest, &predicted);
        }
        Ok(sums)
    }

    /// The field nearest to a snapshot that the modes have in frames at these places.
    fn nearest(&self, snapshot: &[f64], motion: impl Fn(usize) -> Motion) -> Result<Vec<f64>, ModelError> {
        let mut columns = Vec::new();
        for (k, frame) in self.frames.iter().enumerate() {
            for i in 0..frame.modes.ncols() {
                columns.push(self.carry(&motion(k), frame.modes.col_as_slice(i))?);
            }
        }
        let r = columns.len();
        // A little of each mode's norm, so that modes which cannot be told apart do no harm.
        let mut a =
            Mat::from_fn(self.rows + r, r, |row, i| if row < self.rows { columns[i][row] } else { 0.0 });
        (0..r).for_each(|i| a[(self.rows + i, i)] = 1e-9);
        let mut c =
            Mat::from_fn(self.rows + r, 1, |row, _| if row < self.rows { snapshot[row] } else { 0.0 });
        Qr::new(a).solve(c.as_mut());
        let mut nearest = vec![0.0; self.rows];
        for (i, column) in columns.iter().enumerate() {
            nearest.iter_mut().zip(column).for_each(|(n, f)| *n += c[(i, 0)] * f);
        }
        Ok(nearest)
    }

    fn carry(&self, motion: &Motion, field: &[f64]) -> Result<Vec<f64>, ModelError> {
        if motion.is_translation() {
            return Ok(self.field_shift.shift(motion.displacement, field));
        }
        let one = Motions::by(1, 1, |_, _| *motion);
        let frame = GridFrames::new(*self.field_shift.grid(), self.interpolation, &one, self.rows)?;
        let mut column = Mat::from_fn(self.rows, 1, |row, _| field[row]);
        frame.to_lab(0, column.as_mut());
        Ok(column.col_as_slice(0).to_vec())
    }

    /// All of it, for a file.
    #[must_use]
    pub fn record(&self) -> Record {
        let grid = self.field_shift.grid();
        let numbers = |v: [usize; 3]| v.map(|n| n as f64);
        let mut record = Record::new(Self::KIND)
            .with("cells", numbers(grid.cells()))
            .with("spacing", grid.spacing())
            .with("periodic", grid.periodic().map(|p| f64::from(u8::from(p))))
            .with("first", [grid.first().x, grid.first().y, grid.first().z])
            .with_word("interpolation", self.interpolation.name())
            .with("sizes", [self.inputs as f64, self.rows as f64, self.frames.len() as f64])
            .with("errors", [self.projection_error, self.typical])
            .with("offsets", self.offsets.iter().flat_map(|c| [c.x, c.y, c.z]))
            .with_record("paths", &self.paths.record());
        for (k, frame) in self.frames.iter().enumerate() {
            record = record.with_record(&format!("frame {k}"), &frame.record());
        }
        record
    }

    /// What [`record`](Self::record) recorded.
    ///
    /// # Errors
    /// [`RecordError`] if it is no such model, or not whole.
    pub fn from_record(record: &Record) -> Result<Self, RecordError> {
        record.expect(Self::KIND)?;
        let of_three = |name: &str| -> Result<[f64; 3], RecordError> {
            let n = record.numbers_of(name, 3)?;
            Ok([n[0], n[1], n[2]])
        };
        record.numbers_of("cells", 3)?;
        let cells = record.counts("cells")?;
        let (spacing, periodic, first) = (of_three("spacing")?, of_three("periodic")?, of_three("first")?);
        let grid = Grid::new([cells[0], cells[1], cells[2]], spacing)
            .map_err(|why| record.wrong("cells", format!("are no grid: {why}")))?
            .bounded((0..3).filter(|&a| periodic[a] == 0.0))
            .starting_at(Point::from(first));
        let name = record.word("interpolation")?;
        let interpolation = Interpolation::ALL
            .into_iter()
            .find(|i| i.name() == name)
            .ok_or_else(|| record.wrong("interpolation", format!("is `{name}`")))?;
        let [inputs, rows, frames] = record.counts("sizes")?[..] else {
            return Err(record.wrong("sizes", "are not three".into()));
        };
        let [projection_error, typical] = record.numbers("errors")?[..] else {
            return Err(record.wrong("errors", "are not two".into()));
        };
        if rows == 0 || !rows.is_multiple_of(grid.n_cells()) {
            return Err(record.wrong("sizes", format!("have {rows} rows on {} cells", grid.n_cells())));
        }
        let offsets = record.numbers_of("offsets", 3 * frames)?;
        let frame = |k: usize| MovingModes::from_record(&record.record(&format!("frame {k}"))?, rows, inputs);
        let frames = (0..frames).map(frame).collect::<Result<Vec<_>, _>>()?;
        let paths = Paths::from_record(&record.record("paths")?)?;
        Ok(Self {
            superposition: superposition(&grid, interpolation, &paths, &frames),
            interpolation,
            field_shift: FieldShift::new(grid, interpolation),
            frames,
            offsets: offsets.as_chunks::<3>().0.iter().map(|c| Vector::from(*c)).collect(),
            paths,
            inputs,
            rows,
            projection_error,
            typical,
        })
    }

    /// Writes all modes, in their frames, as cell data of an image for ParaView (`.vti`): `frame k mode i`, with the component if there are several.
    ///
    /// # Errors
    /// Of the file system.
    pub fn write_modes(&self, path: &Path) -> io::Result<()> {
        let named = self.frames.iter().enumerate().flat_map(|(k, frame)| {
            (0..frame.modes.ncols())
                .map(move |i| (format!("frame {k} mode {i}"), frame.modes.col_as_slice(i)))
        });
        write_modes(path, self.field_shift.grid(), named)
    }
}

/// Where one inverse transform does for all frames.
fn superposition(
    grid: &Grid,
    interpolation: Interpolation,
    paths: &Paths,
    frames: &[MovingModes],
) -> Option<Superposition> {
    let axes = paths.axes().filter(|_| interpolation == Interpolation::Spectral)?;
    let rows = frames.first()?.modes.nrows();
    Superposition::new(grid, axes, rows, frames.iter().map(MovingModes::columns))
}

#[cfg(test)]
mod tests;
