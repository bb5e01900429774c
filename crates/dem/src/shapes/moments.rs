//! Mass properties by the divergence theorem.
use interfaces::Vector;
use nalgebra::Matrix3;

/// Moments of a body of density one: the sums over the tetrahedra between the origin and every face,
/// counted negative where the face looks towards the origin.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Moments {
    /// ∫ dV.
    pub(crate) volume: f64,
    /// ∫ x dV.
    pub(crate) first: Vector,
    /// ∫ x xᵀ dV.
    pub(crate) second: Matrix3<f64>,
}

impl Moments {
    /// Of a tetrahedron with the corners 0, a, b, c and the volume V = a·(b × c)/6:
    /// ∫ x dV = V s/4 and ∫ x xᵀ dV = V (a aᵀ + b bᵀ + c cᵀ + s sᵀ)/20 with s = a + b + c.
    pub(crate) fn of(points: &[Vector], faces: impl IntoIterator<Item = [u32; 3]>) -> Self {
        let mut sum = Self::default();
        for face in faces {
            let [a, b, c] = face.map(|v| points[v as usize]);
            let (v, s) = (a.dot(&b.cross(&c)) / 6.0, a + b + c);
            sum.volume += v;
            sum.first += s * (v / 4.0);
            let squares = a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose();
            sum.second += squares * (v / 20.0);
        }
        sum
    }
    /// ∫ (|x|² 1 − x xᵀ) dV.
    pub(crate) fn inertia(&self) -> Matrix3<f64> {
        Matrix3::from_diagonal_element(self.second.trace()) - self.second
    }
}
