//! Rotation of a rigid body.
use interfaces::{Rotation, Vector};
use nalgebra::{Matrix3, Quaternion, SymmetricEigen};

/// How a body may turn.
#[derive(Clone, Debug)]
pub(super) enum Turning {
    /// The spin is prescribed.
    Held,
    /// The moment of inertia is the same about every axis: spins only change by torques.
    Alike { moment: f64 },
    /// Principal moments \[kg m²\], and the turn from the principal axes to the body's frame.
    Free { moments: Vector, axes: Rotation },
    /// Only about some axes of the world. (In a box, so that the others are small.)
    Bound { tensor: Box<Matrix3<f64>>, free: [bool; 3] },
}

impl Turning {
    pub(super) fn new(tensor: &Matrix3<f64>, free: [bool; 3]) -> Self {
        let mean = tensor.trace() / 3.0;
        if free == [false; 3] {
            Self::Held
        } else if free != [true; 3] {
            Self::Bound { tensor: Box::new(*tensor), free }
        } else if (tensor - Matrix3::from_diagonal_element(mean)).amax() <= 1e-12 * mean {
            Self::Alike { moment: mean }
        } else {
            let eigen = SymmetricEigen::new(*tensor);
            let mut axes = eigen.eigenvectors;
            if axes.determinant() < 0.0 {
                axes.column_mut(2).neg_mut();
            }
            let axes = Rotation::from_matrix(&axes);
            Self::Free { moments: eigen.eigenvalues, axes }
        }
    }

    /// Turns freely for `dt`. `added` is the moment of inertia that the surroundings add, the same about every axis.
    ///
    /// Unequal moments: the symmetric splitting of Dullweber, Leimkuhler and McLachlan (1997, J. Chem. Phys. 107, 5840) into turns about the principal axes, symplectic, of second order;
    /// each turns the body and leaves the angular momentum where it is in space.
    #[inline]
    pub(super) fn drift(&self, q: &mut Rotation, spin: &mut Vector, added: f64, dt: f64) {
        match self {
            Self::Free { moments, axes } if *spin != Vector::zeros() => {
                let moments = moments.add_scalar(added);
                let mut p = *q * *axes;
                let mut momentum = p.inverse_transform_vector(spin).component_mul(&moments);
                for (axis, part) in [(0, 0.5), (1, 0.5), (2, 1.0), (1, 0.5), (0, 0.5)] {
                    let angle = part * dt * momentum[axis] / moments[axis];
                    let mut about = Vector::zeros();
                    about[axis] = angle;
                    p *= turn(about);
                    // In the body's frame the angular momentum turns back.
                    let (sin, cos) = angle.sin_cos();
                    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
                    let (x, y) = (momentum[i], momentum[j]);
                    (momentum[i], momentum[j]) = (cos * x + sin * y, cos * y - sin * x);
                }
                p.renormalize_fast();
                *spin = p * momentum.component_div(&moments);
                *q = p * axes.inverse();
            }
            _ if *spin != Vector::zeros() => {
                *q = turn(*spin * dt) * *q;
                q.renormalize_fast();
            }
            _ => {}
        }
    }

    /// Changes the spin by `torque` over `dt`.
    #[inline]
    pub(super) fn kick(&self, q: &Rotation, spin: &mut Vector, torque: &Vector, added: f64, dt: f64) {
        match self {
            Self::Held => {}
            Self::Alike { moment } => *spin += *torque * (dt / (moment + added)),
            Self::Free { moments, axes } => {
                let p = q * axes;
                let change = p.inverse_transform_vector(torque).component_div(&moments.add_scalar(added));
                *spin += p * (change * dt);
            }
            Self::Bound { tensor, free } => {
                let world = in_world(tensor, q) + Matrix3::from_diagonal_element(added);
                let torque = torque - spin.cross(&(world * *spin));
                *spin += within(&world, &torque, free) * dt;
            }
        }
    }

    /// j·I⁻¹j for a generalised force j in the world \[1/(kg m²)\] times j²: how easily a torque along j turns the body.
    #[inline]
    pub(super) fn mobility(&self, q: &Rotation, j: &Vector) -> f64 {
        match self {
            Self::Held => 0.0,
            Self::Alike { moment } => j.norm_squared() / moment,
            Self::Free { moments, axes } => {
                let inner = (q * axes).inverse_transform_vector(j);
                inner.component_div(moments).dot(&inner)
            }
            Self::Bound { tensor, free } => within(&in_world(tensor, q), j, free).dot(j),
        }
    }
}

fn in_world(tensor: &Matrix3<f64>, q: &Rotation) -> Matrix3<f64> {
    let r = q.to_rotation_matrix();
    r.matrix() * tensor * r.matrix().transpose()
}

/// I⁻¹ torque about the free axes, where other constraints hold the rest.
fn within(world: &Matrix3<f64>, torque: &Vector, free: &[bool; 3]) -> Vector {
    let (mut matrix, mut right) = (*world, *torque);
    for i in (0..3).filter(|i| !free[*i]) {
        right[i] = 0.0;
        for j in 0..3 {
            matrix[(i, j)] = 0.0;
            matrix[(j, i)] = 0.0;
        }
        matrix[(i, i)] = 1.0;
    }
    matrix.try_inverse().map_or(Vector::zeros(), |inverse| inverse * right)
}

/// The turn by a rotation vector; small ones by series, to the last bit as good.
#[inline]
pub(super) fn turn(by: Vector) -> Rotation {
    let h2 = 0.25 * by.norm_squared();
    if h2 > 0.01 {
        return Rotation::from_scaled_axis(by);
    }
    let cos = 1.0 - h2 * (1.0 / 2.0 - h2 * (1.0 / 24.0 - h2 * (1.0 / 720.0 - h2 * (1.0 / 40320.0))));
    let sinc = 1.0 - h2 * (1.0 / 6.0 - h2 * (1.0 / 120.0 - h2 * (1.0 / 5040.0 - h2 * (1.0 / 362_880.0))));
    let v = by * (0.5 * sinc);
    Rotation::new_unchecked(Quaternion::new(cos, v.x, v.y, v.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_turns_are_as_good_as_large_ones() {
        for size in [1e-9, 1e-3, 0.05, 0.19, 0.21, 2.0] {
            let by = Vector::new(0.3, -0.8, 0.5).normalize() * size;
            let (series, exact) = (turn(by), Rotation::from_scaled_axis(by));
            assert!((series.coords - exact.coords).amax() < 3e-16, "{size}");
        }
    }
}
