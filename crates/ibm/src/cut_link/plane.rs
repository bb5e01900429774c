//! A face cut by a plane.

/// The distance over a rectangular face as a linear function.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    mean: f64,
    /// Rise from the middle to the edges along either axis, the larger first.
    half: [f64; 2],
}

impl Plane {
    /// With this `mean` and `rise` from edge to edge along the axes.
    pub(crate) fn new(mean: f64, rise: [f64; 2]) -> Self {
        let [p, q] = rise.map(|r| 0.5 * r.abs());
        Self { mean, half: [p.max(q), p.min(q)] }
    }

    /// The share of the face where the distance is positive.
    pub(crate) fn open(&self) -> f64 {
        self.moment(0.0, 0)
    }

    /// Mean over the face of max(d − level, 0).
    pub(crate) fn above(&self, level: f64) -> f64 {
        self.moment(level, 1)
    }

    /// Mean over the face of (d − level)^m where that is positive: differences of the repeated integrals x^n/n! of the step.
    fn moment(&self, level: f64, m: i32) -> f64 {
        let (d, [p, q]) = (self.mean - level, self.half);
        let integral = |x: f64, times: i32| {
            let n = m + times;
            if x > 0.0 { x.powi(n) / (m + 1..=n).product::<i32>() as f64 } else { 0.0 }
        };
        if p <= FLAT * d.abs() || p == 0.0 {
            integral(d, 0)
        } else if q < FLAT.sqrt() * p {
            (integral(d + p, 1) - integral(d - p, 1)) / (2.0 * p)
        } else {
            let ends = [p + q, p - q, q - p, -p - q].map(|x| integral(d + x, 2));
            (ends[0] - ends[1] - ends[2] + ends[3]) / (4.0 * p * q)
        }
    }
}

/// Smaller rises are none, as a share of the distance; where the face is cut, their square root.
const FLAT: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Against sums over points, and the share and its complement.
        #[test]
        fn moments_are_those_of_many_points(mean in -1.0..1.0_f64, a in -1.0..1.0_f64, b in -1.0..1.0_f64) {
            let plane = Plane::new(mean, [a, b]);
            let n = 200;
            let (mut open, mut above) = (0.0, 0.0);
            for i in 0..n * n {
                let [x, y] = [i % n, i / n].map(|i| (f64::from(i) + 0.5) / f64::from(n) - 0.5);
                let d = mean + a * x + b * y;
                open += f64::from(u8::from(d > 0.0));
                above += d.max(0.0);
            }
            let count = f64::from(n * n);
            prop_assert!((plane.open() - open / count).abs() < 0.02);
            prop_assert!((plane.above(0.0) - above / count).abs() < 1e-4);
            prop_assert!((plane.open() + Plane::new(-mean, [a, b]).open() - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn half_a_face() {
        for rise in [[1.0, 0.0], [1.0, 1e-7], [0.5, 0.5], [0.0, 2.0]] {
            assert!((Plane::new(0.0, rise).open() - 0.5).abs() < 1e-12);
        }
        assert!((Plane::new(0.25, [1.0, 0.0]).open() - 0.75).abs() < 1e-12);
        assert!((Plane::new(0.25, [1.0, 0.0]).above(0.0) - 0.75 * 0.375).abs() < 1e-12);
        assert_eq!(Plane::new(0.3, [0.0, 0.0]).above(0.1), 0.3 - 0.1);
    }
}
