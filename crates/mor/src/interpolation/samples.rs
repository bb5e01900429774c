//! What is known of the function.
use super::InterpolationError;
use super::scaling::ranges;
use crate::{Mat, MatRef};

/// Points closer than this in every input, relative to the samples' extent, are the same.
const SAME: f64 = 1e-12;

/// Points xᵢ ∈ ℝᵈ and values yᵢ ∈ ℝᵏ, i = 1…m, as columns: finite, and no two points the same (within 1e-12 of the extent in every
/// input).
#[derive(Clone, Debug)]
pub struct Samples {
    points: Mat<f64>,
    values: Mat<f64>,
    domain: Vec<[f64; 2]>,
}

/// The points of [`Samples`] as a grid of d axes.
#[derive(Clone, Debug, PartialEq)]
pub struct SampleGrid {
    /// Ascending coordinates of every axis.
    pub axes: Vec<Vec<f64>>,
    /// Which sample is at each node; the first axis runs fastest.
    pub samples: Vec<usize>,
}

impl Samples {
    /// Of points (d × m) and values (k × m).
    ///
    /// # Errors
    /// [`InterpolationError`]: [`Empty`](InterpolationError::Empty), [`Shape`](InterpolationError::Shape),
    /// [`NotFinite`](InterpolationError::NotFinite), [`Doubled`](InterpolationError::Doubled).
    pub fn new(points: MatRef<'_, f64>, values: MatRef<'_, f64>) -> Result<Self, InterpolationError> {
        let (inputs, outputs, samples) = (points.nrows(), values.nrows(), points.ncols());
        InterpolationError::same("columns of values, one for each point", samples, values.ncols())?;
        if samples == 0 || inputs == 0 || outputs == 0 {
            return Err(InterpolationError::Empty { samples, inputs, outputs });
        }
        for (what, matrix) in [("input", points), ("output", values)] {
            for sample in 0..samples {
                if let Some(row) = (0..matrix.nrows()).find(|&row| !matrix[(row, sample)].is_finite()) {
                    return Err(InterpolationError::NotFinite {
                        what,
                        row,
                        sample,
                        value: matrix[(row, sample)],
                    });
                }
            }
        }
        let samples = Self { points: points.to_owned(), values: values.to_owned(), domain: ranges(points) };
        samples.check_distinct()?;
        Ok(samples)
    }
    /// Of one input, say times, and values (k × m).
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn of_one_input(x: &[f64], values: MatRef<'_, f64>) -> Result<Self, InterpolationError> {
        Self::new(MatRef::from_row_major_slice(x, 1, x.len()), values)
    }

    fn check_distinct(&self) -> Result<(), InterpolationError> {
        let extent: Vec<f64> = self.domain.iter().map(|[low, high]| high - low).collect();
        // Along the input with the largest number of values the fewest pairs are near each other.
        let along = (0..self.inputs()).max_by_key(|&i| self.distinct(i).len()).unwrap_or(0);
        let mut order: Vec<usize> = (0..self.len()).collect();
        order.sort_by(|&a, &b| self.points[(along, a)].total_cmp(&self.points[(along, b)]));
        let distance = |a: usize, b: usize| {
            let of = |i: usize| {
                let apart = (self.points[(i, a)] - self.points[(i, b)]).abs();
                if extent[i] > 0.0 { apart / extent[i] } else { apart }
            };
            (0..self.inputs()).map(of).fold(0.0, f64::max)
        };
        for (place, &a) in order.iter().enumerate() {
            for &b in &order[place + 1..] {
                if self.points[(along, b)] - self.points[(along, a)] > SAME * extent[along] {
                    break;
                }
                let distance = distance(a, b);
                if distance <= SAME {
                    return Err(InterpolationError::Doubled { first: a.min(b), second: a.max(b), distance });
                }
            }
        }
        Ok(())
    }

    /// m.
    #[must_use]
    pub fn len(&self) -> usize {
        self.points.ncols()
    }
    /// Never: there is at least one.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.points.ncols() == 0
    }
    /// d.
    #[must_use]
    pub fn inputs(&self) -> usize {
        self.points.nrows()
    }
    /// k.
    #[must_use]
    pub fn outputs(&self) -> usize {
        self.values.nrows()
    }
    /// The points as columns, d × m.
    #[must_use]
    pub fn points(&self) -> MatRef<'_, f64> {
        self.points.as_ref()
    }
    /// The values as columns, k × m.
    #[must_use]
    pub fn values(&self) -> MatRef<'_, f64> {
        self.values.as_ref()
    }
    /// Point `i`.
    #[must_use]
    pub fn point(&self, i: usize) -> &[f64] {
        self.points.col_as_slice(i)
    }
    /// Values of sample `i`.
    #[must_use]
    pub fn value(&self, i: usize) -> &[f64] {
        self.values.col_as_slice(i)
    }
    /// Smallest and largest value of every input.
    #[must_use]
    pub fn domain(&self) -> &[[f64; 2]] {
        &self.domain
    }
    /// Is x within the [`domain`](Self::domain)?
    #[must_use]
    pub fn covers(&self, x: &[f64]) -> bool {
        x.len() == self.inputs()
            && x.iter().zip(&self.domain).all(|(x, [low, high])| (low..=high).contains(&x))
    }
    /// Points and values of those samples, in that order, as columns.
    pub(super) fn pick(&self, which: &[usize]) -> [Mat<f64>; 2] {
        let pick = |of: &Mat<f64>| Mat::from_fn(of.nrows(), which.len(), |i, j| of[(i, which[j])]);
        [pick(&self.points), pick(&self.values)]
    }
    /// Those samples alone, in that order; none if `which` is empty.
    #[must_use]
    pub fn subset(&self, which: &[usize]) -> Option<Self> {
        let [points, values] = self.pick(which);
        (!which.is_empty()).then(|| Self { domain: ranges(points.as_ref()), values, points })
    }
    /// Those samples alone, without their first input; none if there is no other one.
    pub(super) fn without_first_input(&self, which: &[usize]) -> Option<Self> {
        let [points, values] = self.pick(which);
        let points = points.get(1.., ..).to_owned();
        (points.nrows() > 0 && !which.is_empty()).then(|| Self {
            domain: ranges(points.as_ref()),
            values,
            points,
        })
    }
    /// All samples with their first `n` inputs alone, which must tell them apart.
    pub(crate) fn first_inputs(&self, n: usize) -> Self {
        let points = self.points.get(..n, ..).to_owned();
        Self { domain: self.domain[..n].to_vec(), points, values: self.values.clone() }
    }
    /// All but those.
    ///
    /// # Errors
    /// [`InterpolationError::Empty`] if none are left.
    pub fn without(&self, which: &[usize]) -> Result<Self, InterpolationError> {
        let mut kept = vec![true; self.len()];
        which.iter().for_each(|&i| kept[i] = false);
        let rest: Vec<usize> = (0..self.len()).filter(|&i| kept[i]).collect();
        let none = InterpolationError::Empty { samples: 0, inputs: self.inputs(), outputs: self.outputs() };
        self.subset(&rest).ok_or(none)
    }
    /// The points as a full grid.
    ///
    /// # Errors
    /// [`InterpolationError::NotAGrid`].
    pub fn grid(&self) -> Result<SampleGrid, InterpolationError> {
        let axes: Vec<Vec<f64>> = (0..self.inputs()).map(|i| self.distinct(i)).collect();
        let values: Vec<usize> = axes.iter().map(Vec::len).collect();
        let nodes = values.iter().fold(1usize, |a, &b| a.saturating_mul(b));
        let not = || InterpolationError::NotAGrid { samples: self.len(), values: values.clone(), nodes };
        if nodes != self.len() {
            return Err(not());
        }
        let mut samples = vec![usize::MAX; nodes];
        for sample in 0..self.len() {
            let mut node = 0;
            for i in (0..self.inputs()).rev() {
                node = node * values[i] + nearest(&axes[i], self.points[(i, sample)]);
            }
            if samples[node] != usize::MAX {
                return Err(not());
            }
            samples[node] = sample;
        }
        Ok(SampleGrid { axes, samples })
    }
    /// Ascending values of input `i` that are not the same within 1e-12 of its extent.
    #[must_use]
    pub fn distinct(&self, i: usize) -> Vec<f64> {
        let mut values: Vec<f64> = (0..self.len()).map(|j| self.points[(i, j)]).collect();
        values.sort_by(f64::total_cmp);
        let same = SAME * (self.domain[i][1] - self.domain[i][0]);
        values.dedup_by(|b, a| *b - *a <= same);
        values
    }
}

/// Where the value nearest to x is among ascending ones.
pub(super) fn nearest(ascending: &[f64], x: f64) -> usize {
    let after = ascending.partition_point(|v| *v < x).min(ascending.len() - 1);
    let before = after.saturating_sub(1);
    if (x - ascending[before]).abs() < (ascending[after] - x).abs() { before } else { after }
}

#[cfg(test)]
mod tests;
