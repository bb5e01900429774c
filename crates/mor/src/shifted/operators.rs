//! Frames of reference on a grid.
use super::axis::Side;
use super::gather::Gatherer;
use super::turn::{Turner, angles};
use super::{FieldShift, FrameOperators, Grid, Interpolation, Motion, ShiftedError, Shifts};
use interfaces::{Point, Vector};
use monomorphic::MatMut;
use rayon::prelude::*;

/// Where frame k at snapshot j takes a point.
type Map = Box<dyn Fn(usize, usize, Point) -> Point + Send + Sync>;

/// Fields on a grid that frames of reference carry along: T^Δ q (x) = q(M⁻¹ x).
///
/// A frame that only moves shifts along the axes. One that turns does so about its centre and then moves; of all images of a point in
/// a periodic box the nearest to the centre is turned; what comes from more than half a period away is taken from there. With [`Interpolation::Spectral`] it turns by shears, whose transpose
/// is their inverse; any other interpolation takes values around M⁻¹ x.
///
/// Rows are one field after the other: the components of a vector are carried along, not turned.
pub struct GridFrames {
    grid: Grid,
    n_rows: usize,
    n_frames: usize,
    n_snapshots: usize,
    field_shift: FieldShift,
    gatherer: Gatherer,
    turner: Option<Turner>,
    ways: Ways,
}

enum Ways {
    Motions(Vec<Motion>),
    /// M⁻¹ and M.
    Maps([Map; 2]),
}

/// Which of the three operators.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Task {
    Lab,
    Frame,
    Transpose,
}

impl GridFrames {
    /// Frames that move and turn, for snapshots of so many rows.
    ///
    /// # Errors
    /// [`ShiftedError::Empty`], [`ShiftedError::Rows`], [`ShiftedError::Motion`]; [`ShiftedError::OffGrid`] if a frame leaves the
    /// plane or line; [`ShiftedError::NotPeriodic`] if a frame turns with
    /// [`Interpolation::Spectral`] in a plane with a bounded axis.
    pub fn new(
        grid: Grid,
        interpolation: Interpolation,
        shifts: &dyn Shifts,
        n_rows: usize,
    ) -> Result<Self, ShiftedError> {
        let (n_frames, n_snapshots) = (shifts.n_frames(), shifts.n_snapshots());
        let numbers = (0..n_frames).flat_map(|k| (0..n_snapshots).map(move |j| (k, j)));
        let motions: Vec<_> = numbers.clone().map(|(k, j)| shifts.motion(k, j)).collect();
        for ((frame, snapshot), motion) in numbers.zip(&motions) {
            check(&grid, interpolation, motion, frame, snapshot)?;
        }
        let turns = interpolation == Interpolation::Spectral && motions.iter().any(|m| !m.is_translation());
        let turner = turns.then(|| Turner::new(&grid));
        Self::of(grid, interpolation, [n_frames, n_snapshots, n_rows], turner, Ways::Motions(motions))
    }

    /// Frames that carry fields along in any way: `back` is M⁻¹ x and `forth` M x of frame k at snapshot j. Values come from
    /// polynomials or splines, from the quintic one in place of [`Interpolation::Spectral`]. M⁻¹ x may be beyond the ends of the grid.
    ///
    /// # Errors
    /// [`ShiftedError::Empty`], [`ShiftedError::Rows`]; [`ShiftedError::Motion`] if a map of a cell's centre is not finite.
    pub fn mapped(
        grid: Grid,
        interpolation: Interpolation,
        n_frames: usize,
        n_snapshots: usize,
        n_rows: usize,
        back: impl Fn(usize, usize, Point) -> Point + Send + Sync + 'static,
        forth: impl Fn(usize, usize, Point) -> Point + Send + Sync + 'static,
    ) -> Result<Self, ShiftedError> {
        for (frame, snapshot) in (0..n_frames).flat_map(|k| (0..n_snapshots).map(move |j| (k, j))) {
            let finite = |x: Point| x.iter().all(|x| x.is_finite());
            let mut centres = (0..grid.n_cells()).map(|cell| grid.centre(cell));
            if !centres.all(|x| finite(back(frame, snapshot, x)) && finite(forth(frame, snapshot, x))) {
                return Err(ShiftedError::Motion { frame, snapshot });
            }
        }
        let ways = Ways::Maps([Box::new(back), Box::new(forth)]);
        Self::of(grid, interpolation, [n_frames, n_snapshots, n_rows], None, ways)
    }

    fn of(
        grid: Grid,
        interpolation: Interpolation,
        [n_frames, n_snapshots, n_rows]: [usize; 3],
        turner: Option<Turner>,
        ways: Ways,
    ) -> Result<Self, ShiftedError> {
        if n_frames == 0 || n_snapshots == 0 {
            return Err(ShiftedError::Empty { snapshots: n_snapshots, frames: n_frames });
        }
        if n_rows == 0 || !n_rows.is_multiple_of(grid.n_cells()) {
            return Err(ShiftedError::Rows { rows: n_rows, cells: grid.n_cells() });
        }
        let field_shift = FieldShift::new(grid, interpolation);
        let gatherer = Gatherer::new(grid, interpolation);
        Ok(Self { grid, n_rows, n_frames, n_snapshots, field_shift, gatherer, turner, ways })
    }

    /// Column by column; they do not know of one another.
    fn apply(&self, frame: usize, offset: Vector, fields: MatMut<'_, f64>, task: Task) {
        assert_eq!(
            (fields.nrows(), fields.ncols()),
            (self.n_rows, self.n_snapshots),
            "not one column per snapshot"
        );
        let carry =
            |(snapshot, column): (usize, &mut [f64])| self.carry(frame, snapshot, offset, column, task);
        let columns: Option<Vec<_>> =
            fields.col_iter_mut().map(|c| c.try_as_col_major_mut().map(|c| c.as_slice_mut())).collect();
        let columns = columns.expect("columns of a matrix are contiguous");
        columns.into_par_iter().enumerate().for_each(carry);
    }

    fn carry(&self, frame: usize, snapshot: usize, offset: Vector, column: &mut [f64], task: Task) {
        let side = if task == Task::Transpose { Side::Transpose } else { Side::Operator };
        match &self.ways {
            Ways::Maps([back, forth]) => {
                let map = if task == Task::Frame { forth } else { back };
                self.gatherer.gather(&|x| map(frame, snapshot, x), side, column);
            }
            Ways::Motions(motions) => {
                let mut motion = motions[frame * self.n_snapshots + snapshot];
                motion.displacement += offset;
                match &self.turner {
                    _ if motion.is_translation() => self.shift(motion.displacement, column, task),
                    // Shears have their inverse for their transpose.
                    Some(turner) => {
                        let to_centre = motion.centre - self.grid.first();
                        let centre = [0, 1, 2].map(|a| to_centre[a] / self.grid.spacing()[a]);
                        if task == Task::Lab {
                            turner.turn(&motion.rotation, centre, Side::Operator, column);
                            self.shift(motion.displacement, column, task);
                        } else {
                            self.shift(motion.displacement, column, task);
                            turner.turn(&motion.rotation, centre, Side::Transpose, column);
                        }
                    }
                    None => {
                        let inverse = if task == Task::Frame { motion } else { motion.inverse() };
                        self.gatherer.gather(&|x| self.nearest_image(&inverse, x), side, column);
                    }
                }
            }
        }
    }

    fn shift(&self, s: Vector, column: &mut [f64], task: Task) {
        let shifted = match task {
            Task::Lab => self.field_shift.shift(s, column),
            Task::Frame => self.field_shift.shift(-s, column),
            Task::Transpose => self.field_shift.shift_transposed(s, column),
        };
        column.copy_from_slice(&shifted);
    }

    /// c + s + R (x − c), x − c on the shortest way, and R (x − c) no longer than half a period.
    fn nearest_image(&self, motion: &Motion, x: Point) -> Point {
        let mut way = x - motion.centre;
        for a in 0..3 {
            let n = self.grid.cells()[a];
            if n == 1 {
                way[a] = 0.0;
            } else if self.grid.periodic()[a] {
                let period = n as f64 * self.grid.spacing()[a];
                way[a] -= period * (way[a] / period).round();
            }
        }
        let mut turned = motion.rotation * way;
        for a in (0..3).filter(|&a| self.grid.periodic()[a]) {
            // Beyond half a period would be what is seen on the other side already.
            let half = 0.5 * self.grid.cells()[a] as f64 * self.grid.spacing()[a];
            turned[a] = turned[a].clamp(-half, half);
        }
        motion.centre + motion.displacement + turned
    }
}

/// Can this interpolation carry fields of this grid along like that?
fn check(
    grid: &Grid,
    interpolation: Interpolation,
    motion: &Motion,
    frame: usize,
    snapshot: usize,
) -> Result<(), ShiftedError> {
    let numbers = motion.displacement.iter().chain(motion.rotation.coords.iter()).chain(motion.centre.iter());
    if !numbers.clone().all(|x| x.is_finite()) {
        return Err(ShiftedError::Motion { frame, snapshot });
    }
    let angles = if motion.is_translation() { [0.0; 3] } else { angles(&motion.rotation) };
    for axis in 0..3 {
        let (n, h) = (grid.cells()[axis], grid.spacing()[axis]);
        // What moves along this axis.
        let turn = angles[(axis + 1) % 3].abs().max(angles[(axis + 2) % 3].abs());
        let distance = motion.displacement[axis];
        ShiftedError::check_distance([frame, snapshot, axis], distance, h)?;
        if n == 1 && (distance != 0.0 || turn > 1e-12) {
            return Err(ShiftedError::OffGrid { frame, snapshot, axis });
        }
        if interpolation == Interpolation::Spectral && !grid.periodic()[axis] && turn != 0.0 {
            let distance = turn * n as f64 * h / 2.0;
            return Err(ShiftedError::NotPeriodic { frame, snapshot, axis, distance });
        }
    }
    Ok(())
}

impl FrameOperators for GridFrames {
    fn n_rows(&self) -> usize {
        self.n_rows
    }
    fn n_snapshots(&self) -> usize {
        self.n_snapshots
    }
    fn n_frames(&self) -> usize {
        self.n_frames
    }
    fn to_lab(&self, frame: usize, fields: MatMut<'_, f64>) {
        self.apply(frame, Vector::zeros(), fields, Task::Lab);
    }
    fn to_frame(&self, frame: usize, fields: MatMut<'_, f64>) {
        self.apply(frame, Vector::zeros(), fields, Task::Frame);
    }
    fn to_lab_transposed(&self, frame: usize, fields: MatMut<'_, f64>) {
        self.apply(frame, Vector::zeros(), fields, Task::Transpose);
    }
    fn to_lab_beside(&self, frame: usize, offset: Vector, fields: MatMut<'_, f64>) {
        self.apply(frame, offset, fields, Task::Lab);
    }
}
