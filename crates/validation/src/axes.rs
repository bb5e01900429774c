//! Axes whose cells are moved against bodies, or gathered round them.
use fv_mesh::{Axis, FlowError};

/// An axis from 0 to `length` of cells of size `h` but for the first and last, moved by `shift` cells.
///
/// # Errors
/// [`FlowError::Grid`] for faces that do not increase.
pub fn moved(length: f64, h: f64, shift: f64) -> Result<Axis, FlowError> {
    let n = (length / h).round() as usize;
    let mut faces: Vec<f64> = (0..=n).map(|i| (i as f64 + shift) * h).collect();
    (faces[0], faces[n]) = (0.0, length);
    Axis::from_faces(faces)
}

/// An axis from 0 to `length` of cells of size `h` within `patch`, moved by `shift` cells, that grow by about `ratio` from cell
/// to cell outside.
///
/// # Errors
/// [`FlowError::Grid`] for faces that do not increase.
pub fn gathered(length: f64, h: f64, patch: [f64; 2], ratio: f64, shift: f64) -> Result<Axis, FlowError> {
    let [from, to] = patch.map(|x| ((x / h).round() + shift) * h);
    // So many cells, and the room shared among them in proportion.
    let grown = |room: f64| {
        let n = ((1.0 + room / h * (ratio - 1.0) / ratio).ln() / ratio.ln()).round();
        let widths: Vec<f64> = (1..=n as i32).map(|i| ratio.powi(i)).collect();
        let sum: f64 = widths.iter().sum();
        widths.into_iter().map(move |w| w * room / sum).collect::<Vec<f64>>()
    };
    let inner = std::iter::repeat_n(h, ((to - from) / h).round() as usize);
    let widths = grown(from).into_iter().rev().chain(inner).chain(grown(length - to));
    let mut faces = vec![0.0];
    faces.extend(widths.scan(0.0, |x, w| {
        *x += w;
        Some(*x)
    }));
    if let Some(last) = faces.last_mut() {
        *last = length;
    }
    Axis::from_faces(faces)
}

/// Distances beyond even cells of size `h` at which cells end that are each `ratio` larger than the one before, but at most `most`; the last
/// is `length`.
pub fn widening(length: f64, h: f64, ratio: f64, most: f64) -> Vec<f64> {
    let mut ends = Vec::new();
    let (mut end, mut width) = (0.0, h);
    while end < length {
        width = (ratio * width).min(most);
        end += width;
        ends.push(end);
    }
    ends.iter().map(|e| e * length / end).collect()
}

/// Faces from `from` to `to`, all about as far apart as `h`.
pub fn even(from: f64, to: f64, h: f64) -> Vec<f64> {
    let n = ((to - from) / h).round();
    (0..=n as usize).map(|i| from + (to - from) * i as f64 / n).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_equal_where_they_should_be() {
        let axis = gathered(2.0, 0.1, [0.6, 1.2], 1.1, 0.3).unwrap();
        assert_eq!((axis.lower(), axis.upper()), (0.0, 2.0));
        let first = axis.locate(0.64).unwrap();
        assert!((axis.faces()[first] - 0.63).abs() < 1e-12);
        for i in first..first + 6 {
            assert!((axis.width(i) - 0.1).abs() < 1e-12);
        }
        assert!(axis.largest_ratio() < 1.2 && axis.width(0) > 0.12);
        let axis = moved(1.0, 0.1, 0.4).unwrap();
        assert!((axis.width(0) - 0.14).abs() < 1e-12 && (axis.width(9) - 0.06).abs() < 1e-12);
    }
}
