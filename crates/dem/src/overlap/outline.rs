//! Moments of the area that a closed curve bounds.
use interfaces::Vector;
use nalgebra::Matrix3;

/// Area of a patch and its moments about a reference point, by Stokes' theorem from the closed curve around it:
/// the curve's parts p → q and the reference point span triangles of area vector ½ p × q.
///
/// Projected along any direction they are exact, whatever surface the curve bounds.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Outline {
    /// ∫ dA.
    area: Vector,
    /// ∫ dA xᵀ, one row per component of dA.
    first: Matrix3<f64>,
    /// ∫ x xᵀ dA_k, one matrix per component k of dA.
    second: [Matrix3<f64>; 3],
}

impl Outline {
    /// A straight part p → q of the curve.
    pub(super) fn add(&mut self, p: Vector, q: Vector) {
        let (area, sum) = (0.5 * p.cross(&q), p + q);
        self.area += area;
        self.first += area * (sum / 3.0).transpose();
        let square = (p * p.transpose() + q * q.transpose() + sum * sum.transpose()) / 12.0;
        for (second, area) in self.second.iter_mut().zip(&area) {
            *second += square * *area;
        }
    }

    /// Both together.
    pub(super) fn join(&mut self, other: &Self) {
        self.area += other.area;
        self.first += other.first;
        for (second, other) in self.second.iter_mut().zip(&other.second) {
            *second += other;
        }
    }

    /// [`Overlap::pivot`](super::Overlap::pivot) of the area projected along its own mean normal.
    pub(super) fn pivot(&self) -> Matrix3<f64> {
        let area = self.area.norm();
        if area <= 0.0 {
            return Matrix3::zeros();
        }
        let normal = self.area / area;
        let first = self.first.tr_mul(&normal);
        let about_origin: Matrix3<f64> = self.second.iter().zip(&normal).map(|(s, n)| s * *n).sum();
        pivot(&(about_origin - first * first.transpose() / area), normal)
    }
}

/// [`Overlap::pivot`](super::Overlap::pivot) from the `spread` ∫ y yᵀ dA about the area's centroid.
pub(super) fn pivot(spread: &Matrix3<f64>, normal: Vector) -> Matrix3<f64> {
    let across = Matrix3::identity() - normal * normal.transpose();
    let spread = across * spread * across;
    across * spread.trace() - spread
}

/// [`Overlap::pivot`](super::Overlap::pivot) of a disc of this `area`.
pub(super) fn of_disc(area: f64, normal: Vector) -> Matrix3<f64> {
    let across = Matrix3::identity() - normal * normal.transpose();
    across * (area * area / (4.0 * std::f64::consts::PI))
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::Rotation;

    /// A rectangle a × b, anywhere and turned: a³b/12 and ab³/12 about its own axes, nothing about the normal.
    #[test]
    fn rectangle() {
        let (a, b) = (2.0, 0.3);
        let turn = Rotation::from_scaled_axis(Vector::new(0.3, -1.1, 0.7));
        let shift = Vector::new(0.5, 2.0, -1.0);
        let corners = [[-a, -b], [a, -b], [a, b], [-a, b]]
            .map(|[x, y]| shift + turn * Vector::new(0.5 * x, 0.5 * y, 0.0));
        let mut outline = Outline::default();
        for k in 0..4 {
            outline.add(corners[k], corners[(k + 1) % 4]);
        }
        let r = turn.to_rotation_matrix();
        let exact = Matrix3::from_diagonal(&Vector::new(a * b.powi(3), a.powi(3) * b, 0.0)) / 12.0;
        let exact = r.matrix() * exact * r.matrix().transpose();
        assert!((outline.pivot() - exact).amax() < 1e-13, "{} {exact}", outline.pivot());
    }
}
