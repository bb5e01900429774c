//! Where frames of reference are, as a function of time and parameters.
use super::coefficients::Coefficients;
use super::{Extrapolation, ModelError};
use crate::interpolation::{FitObserver, FitProgress, FitStage, Method, Record, RecordError, Samples};
use crate::shifted::{Motion, Shifts};
use crate::{Mat, MatRef};
use interfaces::{Point, Rotation, Vector};

/// Displacement and rotation vector of every frame.
const PER_FRAME: usize = 6;

/// The motions of all frames. What does not move is not interpolated.
pub(super) struct Paths {
    centres: Vec<Point>,
    /// Which of the six numbers of which frame moves.
    moving: Vec<usize>,
    function: Option<Coefficients>,
}

impl Paths {
    /// Through the motions at points given as columns, the first input being time.
    pub(super) fn fit(
        points: MatRef<'_, f64>,
        shifts: &dyn Shifts,
        method: Option<&dyn Method>,
        observer: FitObserver<'_>,
    ) -> Result<Self, ModelError> {
        let (frames, m) = (shifts.n_frames(), shifts.n_snapshots());
        ModelError::same("motions of every frame, one for each snapshot", points.ncols(), m)?;
        let mut numbers = Mat::zeros(PER_FRAME * frames, m);
        for k in 0..frames {
            for (j, before) in in_order(points) {
                let motion = shifts.motion(k, j);
                let last = before.map(|b| Vector::from_fn(|a, _| numbers[(PER_FRAME * k + 3 + a, b)]));
                let turned = unwrapped(motion.rotation, last.unwrap_or_default());
                for a in 0..3 {
                    numbers[(PER_FRAME * k + a, j)] = motion.displacement[a];
                    numbers[(PER_FRAME * k + 3 + a, j)] = turned[a];
                }
            }
        }
        let moving: Vec<usize> =
            (0..PER_FRAME * frames).filter(|&row| (0..m).any(|j| numbers[(row, j)] != 0.0)).collect();
        let values = Mat::from_fn(moving.len(), m, |i, j| numbers[(moving[i], j)]);
        let function = if moving.is_empty() {
            None
        } else {
            let samples = Samples::new(points, values.as_ref())?;
            let stage = FitProgress::new(FitStage::Paths, 1, 1);
            Some(stage.run(observer, |observer| Coefficients::fit(&samples, method, observer))?)
        };
        Ok(Self { centres: (0..frames).map(|k| shifts.motion(k, 0).centre).collect(), moving, function })
    }

    /// Name of the method of the paths; none if no frame moves.
    pub(super) fn method(&self) -> Option<&str> {
        self.function.as_ref().map(Coefficients::method)
    }
    pub(super) fn domain(&self) -> Option<&[[f64; 2]]> {
        self.function.as_ref().map(Coefficients::domain)
    }
    pub(super) fn extrapolate(&mut self, how: Extrapolation) {
        self.function.iter_mut().for_each(|function| function.extrapolate(how));
    }
    /// The motion of every frame at x.
    pub(super) fn motions(&self, x: &[f64]) -> Result<Vec<Motion>, ModelError> {
        let mut numbers = vec![0.0; PER_FRAME * self.centres.len()];
        if let Some(function) = &self.function {
            let mut values = vec![0.0; self.moving.len()];
            function.predict(x, &mut values)?;
            self.moving.iter().zip(&values).for_each(|(&row, value)| numbers[row] = *value);
        }
        let of = |(n, centre): (&[f64], &Point)| Motion {
            displacement: Vector::new(n[0], n[1], n[2]),
            rotation: Rotation::from_scaled_axis(Vector::new(n[3], n[4], n[5])),
            centre: *centre,
        };
        Ok(numbers.chunks_exact(PER_FRAME).zip(&self.centres).map(of).collect())
    }

    /// The axes along which a frame moves; None if one turns.
    pub(super) fn axes(&self) -> Option<Vec<usize>> {
        let numbers = || self.moving.iter().map(|row| row % PER_FRAME);
        numbers().all(|n| n < 3).then(|| (0..3).filter(|axis| numbers().any(|n| n == *axis)).collect())
    }

    pub(super) fn record(&self) -> Record {
        let record = Record::new("paths")
            .with("centres", self.centres.iter().flat_map(|c| [c.x, c.y, c.z]))
            .with("moving", self.moving.iter().map(|&row| row as f64));
        match &self.function {
            Some(function) => record.with_record("function", &function.record()),
            None => record,
        }
    }
    pub(super) fn from_record(record: &Record) -> Result<Self, RecordError> {
        record.expect("paths")?;
        let centres: Vec<Point> =
            record.numbers("centres")?.as_chunks::<3>().0.iter().map(|c| Point::from(*c)).collect();
        let moving = record.counts("moving")?;
        let function = if moving.is_empty() {
            None
        } else {
            Some(Coefficients::from_record(&record.record("function")?)?)
        };
        let fits = function.as_ref().is_none_or(|f| f.outputs() == moving.len());
        if !fits || moving.iter().any(|&row| row >= PER_FRAME * centres.len()) {
            return Err(record.wrong("moving", "does not fit the frames".into()));
        }
        Ok(Self { centres, moving, function })
    }
}

/// The snapshots in the order of parameters, then times, each with the one before of the same parameters.
fn in_order(points: MatRef<'_, f64>) -> Vec<(usize, Option<usize>)> {
    let compare = |row: usize, a: usize, b: usize| points[(row, a)].total_cmp(&points[(row, b)]);
    let mut order: Vec<usize> = (0..points.ncols()).collect();
    let rows = (1..points.nrows()).chain([0]).filter(|&row| row < points.nrows()).collect::<Vec<_>>();
    order.sort_by(|&a, &b| {
        rows.iter().map(|&row| compare(row, a, b)).find(|o| o.is_ne()).unwrap_or(std::cmp::Ordering::Equal)
    });
    let same = |a: usize, b: usize| (1..points.nrows()).all(|row| points[(row, a)] == points[(row, b)]);
    let before = |place: usize| place.checked_sub(1).map(|p| order[p]).filter(|&b| same(order[place], b));
    (0..order.len()).map(|place| (order[place], before(place))).collect()
}

/// The rotation vector nearest to another one.
fn unwrapped(rotation: Rotation, near: Vector) -> Vector {
    let vector = rotation.scaled_axis();
    let angle = vector.norm();
    // The axis of no rotation may be any.
    let axis = if angle > 0.0 { vector / angle } else { near.try_normalize(0.0).unwrap_or_default() };
    let turns = ((near.dot(&axis) - angle) / std::f64::consts::TAU).round();
    vector + axis * (turns * std::f64::consts::TAU)
}
