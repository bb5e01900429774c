//! B-splines along one input.
use crate::interpolation::{Record, RecordError};

/// The B-splines of degree p ≤ 5 on knots t₀ ≤ t₁ ≤ …, the first and the last p + 1 of which are equal.
#[derive(Clone, Debug)]
pub(in crate::interpolation) struct Axis {
    pub(in crate::interpolation) degree: usize,
    pub(in crate::interpolation) knots: Vec<f64>,
}

impl Axis {
    /// Of a record.
    ///
    /// # Errors
    /// [`RecordError`] if the entry is no list of knots for this degree.
    pub(in crate::interpolation) fn from_record(
        record: &Record,
        name: &str,
        degree: usize,
    ) -> Result<Self, RecordError> {
        let knots = record.numbers(name)?.to_vec();
        let odd = [1, 3, 5].contains(&degree);
        let ordered = odd && knots.len() >= 2 * (degree + 1) && knots.windows(2).all(|w| w[0] <= w[1]);
        if !(ordered && knots[degree] < knots[degree + 1]) {
            return Err(record.wrong(name, format!("are not ascending knots of splines of degree {degree}")));
        }
        Ok(Self { degree, knots })
    }
    /// Knots at the points, save the (p − 1)/2 next to each end.
    pub(in crate::interpolation) fn not_a_knot(points: &[f64], degree: usize) -> Self {
        let [first, last] = [points[0], points[points.len() - 1]];
        let inner = degree.div_ceil(2);
        let mut knots = vec![first; degree + 1];
        knots.extend(&points[inner..points.len() - inner]);
        knots.extend(vec![last; degree + 1]);
        Self { degree, knots }
    }
    /// How many B-splines there are.
    pub(in crate::interpolation) fn len(&self) -> usize {
        self.knots.len() - self.degree - 1
    }
    pub(in crate::interpolation) fn range(&self) -> [f64; 2] {
        [self.knots[0], self.knots[self.knots.len() - 1]]
    }
    /// The s with t_s ≤ x < t_{s+1}, or the nearest where the knots are not equal: B_{s−p} … B_s are not zero there.
    pub(in crate::interpolation) fn span(&self, x: f64) -> usize {
        let (p, n) = (self.degree, self.len());
        p + self.knots[p + 1..n].partition_point(|t| *t <= x)
    }
    /// B_{s−p} … B_s at x, by their recurrence.
    pub(in crate::interpolation) fn values(&self, span: usize, x: f64) -> [f64; 6] {
        self.values_of_degree(self.degree, span, x)
    }
    fn values_of_degree(&self, degree: usize, span: usize, x: f64) -> [f64; 6] {
        let mut b = [0.0; 6];
        b[0] = 1.0;
        for p in 1..=degree {
            let mut carried = 0.0;
            for j in 0..p {
                let [low, high] = [self.knots[span + 1 + j - p], self.knots[span + 1 + j]];
                let share = b[j] / (high - low);
                b[j] = carried + (high - x) * share;
                carried = (x - low) * share;
            }
            b[p] = carried;
        }
        b
    }
    /// Their derivatives: B′_{i,p} = p (B_{i,p−1}/(t_{i+p} − t_i) − B_{i+1,p−1}/(t_{i+p+1} − t_{i+1})).
    pub(in crate::interpolation) fn slopes(&self, span: usize, x: f64) -> [f64; 6] {
        let p = self.degree;
        let lower = self.values_of_degree(p - 1, span, x);
        let mut b = [0.0; 6];
        for j in 0..p {
            // Of B_{s−p+1+j, p−1}.
            let share = p as f64 * lower[j] / (self.knots[span + 1 + j] - self.knots[span + 1 + j - p]);
            b[j] -= share;
            b[j + 1] += share;
        }
        b
    }
}
