//! A point of two ellipsoids, or the proof that there is none.
use super::Posed;
use interfaces::Vector;
use nalgebra::{Matrix3, SymmetricEigen, U3};

/// Newton steps at most.
const STEPS: usize = 60;
/// Difference of both functions at the point, as a share of their depth, that will do.
const EVEN: f64 = 0.05;
/// Depth of the functions below which rounding decides.
const TOUCH: f64 = 1e-15;

/// What was found.
pub(super) enum Meeting {
    /// No common point, or a touch only.
    Apart,
    /// Newton's method came to no end.
    Unclear,
    /// A common point.
    At(CommonPoint),
}

/// A point in both, and coordinates about it.
pub(super) struct CommonPoint {
    /// The point, as seen from the first body's centre.
    pub(super) point: Vector,
    /// From coordinates in which the curve lies on the unit sphere to lengths.
    pub(super) axes: Matrix3<f64>,
    /// β and C of f_A − f_B = 2βw₃ + wᵀCw on the unit sphere; β ≥ 0.
    pub(super) lean: f64,
    pub(super) quadric: Matrix3<f64>,
}

/// Maximises G(λ) = min over x of λf_A + (1 − λ)f_B, which is concave, until both functions are about as deep at x; the bodies
/// are apart where G > 0 for any λ.
pub(super) fn find(a: &Posed, b: &Posed) -> Meeting {
    let [form_a, form_b] = [a, b].map(|body| {
        let to_ball = body.to_ball();
        to_ball.tr_mul(&to_ball)
    });
    let apart = b.centre - a.centre;
    let (size_a, size_b) = (a.semi_axes.product().cbrt(), b.semi_axes.product().cbrt());
    let (mut low, mut high) = (0.0, 1.0);
    let mut lambda = size_a / (size_a + size_b);
    for _ in 0..STEPS {
        let sum = form_a * lambda + form_b * (1.0 - lambda);
        let Some(inverse) = sum.try_inverse() else { return Meeting::Unclear };
        let from_a = inverse * (form_b * apart) * (1.0 - lambda);
        let from_b = inverse * (form_a * apart) * -lambda;
        let (slope_a, slope_b) = (form_a * from_a, form_b * from_b);
        let (f_a, f_b) = (slope_a.dot(&from_a) - 1.0, slope_b.dot(&from_b) - 1.0);
        let deep = -(lambda * f_a + (1.0 - lambda) * f_b);
        if deep <= TOUCH {
            return Meeting::Apart;
        }
        let difference = f_a - f_b;
        if difference.abs() <= EVEN * deep && f_a.max(f_b) < 0.0 {
            let Some(cholesky) = sum.cholesky() else { return Meeting::Unclear };
            let Some(root) = cholesky.l().try_inverse() else { return Meeting::Unclear };
            let axes = root.transpose() * deep.sqrt();
            let slope = axes.tr_mul(&(slope_a - slope_b));
            let axes = axes * towards(slope);
            let mut quadric = axes.tr_mul(&((form_a - form_b) * axes));
            // On the unit sphere a constant is a multiple of |w|².
            for i in 0..3 {
                quadric[(i, i)] += difference;
            }
            return Meeting::At(CommonPoint { point: a.centre + from_a, axes, lean: slope.norm(), quadric });
        }
        if difference > 0.0 {
            low = lambda
        } else {
            high = lambda
        }
        let slope = slope_a - slope_b;
        let next = lambda + 0.5 * difference / slope.dot(&(inverse * slope));
        lambda = if next > low && next < high { next } else { 0.5 * (low + high) };
    }
    Meeting::Unclear
}

/// What D = 2βw₃ + wᵀCw does on the unit sphere.
pub(super) enum Nearer {
    /// It has one sign: this body is the nearer one everywhere, so within the other.
    Always(usize),
    /// It has both; axes from which the curve D = 0 may be seen best: where D is least and largest, and the eigenvectors
    /// of C.
    Either([Vector; 5]),
}

/// The least value of D is the largest one of ν − β²Σnᵢ²/(cᵢ − ν) for ν below all eigenvalues cᵢ of C (strong duality of the
/// trust-region problem), nᵢ the parts of the third axis along the eigenvectors; there wᵢ = −βnᵢ/(cᵢ − ν).
pub(super) fn nearer(lean: f64, eigen: &SymmetricEigen<f64, U3>) -> Nearer {
    let parts = eigen.eigenvectors.row(2).transpose() * lean;
    let (values, vectors) = (eigen.eigenvalues, &eigen.eigenvectors);
    let least = |c: Vector| {
        // Parts that are zero do not count, however near the pole.
        let over =
            |nu: f64| Vector::from_fn(|i, _| if parts[i] == 0.0 { 0.0 } else { -parts[i] / (c[i] - nu) });
        let (mut low, mut high) = (c.min() - lean, c.min());
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if over(middle).norm_squared() < 1.0 { low = middle } else { high = middle }
        }
        (low + over(low).dot(&parts), vectors * over(low))
    };
    let ((lowest, at_lowest), (highest, at_highest)) = (least(values), least(-values));
    if lowest >= 0.0 {
        Nearer::Always(0)
    } else if highest >= 0.0 {
        Nearer::Always(1)
    } else {
        let [x, y, z] = [0, 1, 2].map(|i| vectors.column(i).into_owned());
        Nearer::Either([at_lowest, at_highest, x, y, z])
    }
}

/// A rotation whose last column leads along `v`.
pub(super) fn towards(v: Vector) -> Matrix3<f64> {
    let Some(e) = v.try_normalize(0.0) else { return Matrix3::identity() };
    let mut other = Vector::zeros();
    other[e.iamin()] = 1.0;
    let t = other.cross(&e).normalize();
    Matrix3::from_columns(&[t, e.cross(&t), e])
}
