//! The model against fields that are known.
use super::*;
use crate::interpolation::InterpolationError;
use crate::shifted::{Frame, Motions, Progress, StopReason};
use interfaces::Vector;

const CELLS: [usize; 2] = [48, 30];

fn grid() -> Grid {
    Grid::new(CELLS, [1.0, 1.0]).unwrap()
}

/// Displacements of two frames along x at time t.
fn displacements(t: f64) -> [f64; 2] {
    [30.0 * t + 25.0 * t * t, -20.0 * t]
}

fn motions(times: &[f64]) -> Motions {
    Motions::by(2, times.len(), |k, j| Motion::translation(Vector::new(displacements(times[j])[k], 0.0, 0.0)))
}

/// A smooth spot of frame k.
fn spot(k: usize, x: [f64; 2]) -> f64 {
    let [cx, cy] = [[10.0, 8.0], [30.0, 21.0]][k];
    let period = |d: f64, n: usize| (d + 0.5 * n as f64).rem_euclid(n as f64) - 0.5 * n as f64;
    (-(period(x[0] - cx, CELLS[0]).powi(2) + period(x[1] - cy, CELLS[1]).powi(2)) / 12.0).exp()
}

fn amplitude(k: usize, t: f64) -> f64 {
    if k == 0 { 1.0 + 0.3 * (3.0 * t).sin() } else { 0.8 + 0.2 * t * t }
}

fn exact(t: f64) -> Vec<f64> {
    let d = displacements(t);
    let at = |row: usize| {
        let x = grid().centre(row);
        (0..2).map(|k| amplitude(k, t) * spot(k, [x.x - d[k], x.y])).sum()
    };
    (0..CELLS[0] * CELLS[1]).map(at).collect()
}

/// As an exact decomposition would be.
fn decomposition(times: &[f64]) -> Decomposition {
    let frame = |k: usize| {
        let at = |row: usize| spot(k, [grid().centre(row).x, grid().centre(row).y]);
        let mode = Mat::from_fn(CELLS[0] * CELLS[1], 1, |row, _| at(row));
        let size = mode.norm_l2();
        let c = Mat::from_fn(1, times.len(), |_, j| amplitude(k, times[j]));
        let long = c.norm_l2();
        Frame {
            modes: Mat::from_fn(mode.nrows(), 1, |row, _| mode[(row, 0)] / size),
            singular_values: vec![size * long],
            coefficients: Mat::from_fn(1, times.len(), |_, j| c[(0, j)] / long),
        }
    };
    Decomposition {
        frames: (0..2).map(frame).collect(),
        offsets: vec![Vector::zeros(); 2],
        noise: None,
        history: vec![Progress { step: 0, error: 1e-6, rank: 2 }],
        stopped: StopReason::Tolerance,
        attempts: 0,
    }
}

fn times(m: usize) -> Vec<f64> {
    (0..m).map(|j| j as f64 / (m - 1) as f64).collect()
}

fn row(values: &[f64]) -> Mat<f64> {
    Mat::from_fn(1, values.len(), |_, j| values[j])
}

fn model() -> Spodiann {
    let times = times(41);
    let how = (grid(), Interpolation::Spectral);
    let params = SpodiannParams::default();
    Spodiann::new(row(&times).as_ref(), &decomposition(&times), how, &motions(&times), params).unwrap()
}

/// Between snapshots, where the spots have moved by up to a cell.
#[test]
fn predictions_between_snapshots() {
    let model = model();
    let between: Vec<f64> = (0..37).map(|j| (f64::from(j) + 0.4) / 38.0).collect();
    let fields: Vec<Vec<f64>> = between.iter().map(|t| exact(*t)).collect();
    let snapshots = Mat::from_fn(fields[0].len(), fields.len(), |i, j| fields[j][i]);
    let found = model.assess(row(&between).as_ref(), snapshots.as_ref(), &motions(&between)).unwrap();
    assert!(found.total < 2e-6 && found.projection < 2e-6, "{found:?}");
    assert!(found.total <= found.projection + found.interpolation);
}

#[test]
fn the_indicator_tells_where_not_to_trust() {
    let model = model();
    assert!(model.covers(&[0.512]) && !model.covers(&[1.5]) && !model.covers(&[0.1, 0.2]));
    let within = model.error_indicator(&[0.512]).unwrap();
    let beyond = model.error_indicator(&[1.5]).unwrap();
    assert!(within < 1e-4 && beyond > 1e-3, "{within:e} {beyond:e}");
}

#[test]
fn files_give_the_model_back() {
    let model = model();
    let again = Spodiann::from_record(&Record::from_bytes(&model.record().to_bytes()).unwrap()).unwrap();
    let (mut a, mut b) = (vec![0.0; model.rows()], vec![0.0; model.rows()]);
    model.predict(&[0.123], &mut a).unwrap();
    again.predict(&[0.123], &mut b).unwrap();
    assert_eq!(a, b);
    assert_eq!(again.error_indicator(&[0.3]).unwrap(), model.error_indicator(&[0.3]).unwrap());
    let path = std::env::temp_dir().join(format!("siltflow-modes-{}.vti", std::process::id()));
    model.write_modes(&path).unwrap();
    let text = String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned();
    assert!(text.contains("Name=\"frame 1 mode 0\"") && text.contains("WholeExtent=\"0 48 0 30 0 1\""));
    std::fs::remove_file(path).unwrap();
    assert!(Spodiann::from_record(&Record::new("spline")).is_err());
}

#[test]
fn what_does_not_fit_is_told() {
    let times = times(41);
    let make = |points: &[f64], cells: [usize; 2]| {
        let how = (Grid::new(cells, [1.0, 1.0]).unwrap(), Interpolation::Spectral);
        let params = SpodiannParams::default();
        Spodiann::new(row(points).as_ref(), &decomposition(&times), how, &motions(&times), params)
    };
    assert!(matches!(make(&times[1..], CELLS), Err(ModelError::Shape { expected: 40, found: 41, .. })));
    assert!(matches!(make(&times, [7, 11]), Err(ModelError::Shifted(ShiftedError::Rows { .. }))));
    let model = model();
    let mut out = vec![0.0; model.rows()];
    assert!(matches!(model.predict(&[0.1, 0.2], &mut out), Err(ModelError::Shape { expected: 1, .. })));
    assert!(matches!(
        model.predict(&[f64::NAN], &mut out),
        Err(ModelError::Interpolation(InterpolationError::Point { .. }))
    ));
}

/// A body that turns and moves: its path's rotation is interpolated, too, beyond half a turn.
#[test]
fn frames_that_turn() {
    let times = times(41);
    let turning = |times: &[f64]| {
        let motion = |t: f64| Motion {
            displacement: Vector::new(3.0 * t, -2.0 * t, 0.0),
            rotation: interfaces::Rotation::from_scaled_axis(Vector::new(0.0, 0.0, 5.0 * t * t)),
            centre: Point::new(24.0, 15.0, 0.0),
        };
        let all: Vec<Motion> = times.iter().map(|t| motion(*t)).collect();
        Motions::by(1, all.len(), move |_, j| all[j])
    };
    // A long spot.
    let spot = |x: f64, y: f64| (-((x - 24.0) / 3.8).powi(2) - ((y - 15.0) / 2.5).powi(2)).exp();
    let rows = CELLS[0] * CELLS[1];
    let mode = Mat::from_fn(rows, 1, |row, _| spot(grid().centre(row).x, grid().centre(row).y));
    let size = mode.norm_l2();
    let root = (times.len() as f64).sqrt();
    let frame = Frame {
        modes: Mat::from_fn(rows, 1, |row, _| mode[(row, 0)] / size),
        singular_values: vec![size * root],
        coefficients: Mat::from_fn(1, times.len(), |_, _| 1.0 / root),
    };
    let decomposition = Decomposition {
        frames: vec![frame],
        offsets: vec![Vector::zeros()],
        noise: None,
        history: Vec::new(),
        stopped: StopReason::Tolerance,
        attempts: 0,
    };
    let how = (grid(), Interpolation::Spectral);
    let params = SpodiannParams::default();
    let model = Spodiann::new(row(&times).as_ref(), &decomposition, how, &turning(&times), params).unwrap();
    let t = 0.913;
    let inverse = turning(&[t]).motion(0, 0).inverse();
    let mut out = vec![0.0; rows];
    model.predict(&[t], &mut out).unwrap();
    let mut worst = 0.0_f64;
    for (i, found) in out.iter().enumerate() {
        let (x, c) = (grid().centre(i), inverse.centre);
        let back = c + inverse.displacement + inverse.rotation * (x - c);
        worst = worst.max((found - spot(back.x, back.y)).abs());
    }
    assert!(worst < 1e-4, "{worst:e}");
}
