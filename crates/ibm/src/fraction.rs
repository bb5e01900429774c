//! How much of a cell is solid.
use interfaces::Vector;

/// The share of a box with edges `h` \[m\] (h.z = 0 in the plane) that lies behind a plane:
/// {x : d + n·x < 0}, x from the box's centre, `d` the signed distance of the centre \[m\] and `n`
/// the outward unit normal. Exact (Scardovelli & Zaleski 2000, J. Comput. Phys. 164, 228).
pub fn plane_fraction(d: f64, n: Vector, h: Vector) -> f64 {
    let mut m = [n.x.abs() * h.x, n.y.abs() * h.y, n.z.abs() * h.z];
    let sum = m[0] + m[1] + m[2];
    if d.abs() >= 0.5 * sum {
        return if d < 0.0 { 1.0 } else { 0.0 };
    }
    // Scaled so that the cube's corners lie between 0 and 1 along the normal; the smaller part.
    let scale = 1.0 / sum;
    m = m.map(|m| m * scale);
    let (low, high) = (m[0].min(m[1]), m[0].max(m[1]));
    let [m1, m2, m3] = [low.min(m[2]), low.max(m[2].min(high)), high.max(m[2])];
    let alpha = 0.5 - d.abs() * scale;
    let m12 = m1 + m2;
    let cubic = |m: f64| m * m * (m - 3.0 * alpha);
    let small = if alpha < m1 {
        alpha * alpha * alpha / (6.0 * m1 * m2 * m3)
    } else if alpha < m2 {
        (alpha * (alpha - m1) + m1 * m1 / 3.0) / (2.0 * m2 * m3)
    } else if alpha < m12.min(m3) {
        (alpha * alpha * (3.0 * m12 - alpha) + cubic(m1) + cubic(m2)) / (6.0 * m1 * m2 * m3)
    } else if m3 < m12 {
        (alpha * alpha * (3.0 - 2.0 * alpha) + cubic(m1) + cubic(m2) + cubic(m3)) / (6.0 * m1 * m2 * m3)
    } else {
        (alpha - 0.5 * m12) / m3
    };
    if d < 0.0 { 1.0 - small } else { small }
}

/// The solid fraction λ of a cell with edges `h` whose centre has signed distance `d`, outward
/// normal `n` and sum of principal curvatures `curvature` \[1/m\].
///
/// A surface that bulges leaves its tangent plane by ½κs² at distance s from the foot point, κ the mean
/// curvature; over the cuts of all cells s² is h²/12 per tangential direction on average, so the plane is
/// moved inward by κh²/24 per direction. A plane alone would make a disc's λ sum to too much by
/// h²/12R², a sphere's by h²/4R²; one so moved still by up to h²/80R² (sphere) where the average is missed because
/// the body is centred on the grid.
///
/// So where κh is more than ⅛, or in the plane, the cell is first cut into halves along each axis;
/// distance and normal at their centres follow from d(x) = d + n·x + ½κ|x_t|² with x_t the part of x along the
/// surface.
pub fn cell_fraction(d: f64, n: Vector, curvature: f64, h: Vector) -> f64 {
    let depth = if h.z == 0.0 { 1 } else { 2 };
    let bend = curvature / f64::from(depth);
    let spread: f64 = (0..3).map(|a| h[a] * h[a] * (1.0 - n[a] * n[a])).sum();
    if depth == 2 && (bend * h.max()).abs() < BENT {
        return plane_fraction(d + bend * spread / 24.0, n, h);
    }
    let (half, quarter) = (0.5 * h, 0.25 * h);
    // |x|² is the same at the centres of all halves, and |x_t|² = |x|² − (n·x)².
    let moved = d + bend * (spread / 96.0 + 0.5 * quarter.norm_squared());
    let mut sum = 0.0;
    for part in 0..4 * depth {
        let sign = |bit: i32| if part >> bit & 1 == 1 { 1.0 } else { -1.0 };
        let x = Vector::new(sign(0) * quarter.x, sign(1) * quarter.y, sign(2) * quarter.z);
        let t = n.dot(&x);
        // Longer than one by ½(κ|x_t|)² only: not worth a root.
        let normal = n * (1.0 - bend * t) + x * bend;
        sum += plane_fraction(moved + t - 0.5 * bend * t * t, normal, half);
    }
    sum / f64::from(4 * depth)
}

/// Above this κh one plane is not enough: a sphere 16 cells wide.
const BENT: f64 = 0.125;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Counts sub-cells: slow and without any formula.
    fn counted(d: f64, n: Vector, h: Vector) -> f64 {
        const M: usize = 60;
        let depth = if h.z == 0.0 { 1 } else { M };
        let mut inside = 0;
        for k in 0..depth {
            for j in 0..M {
                for i in 0..M {
                    let at = |i: usize, h: f64| ((i as f64 + 0.5) / M as f64 - 0.5) * h;
                    let x = Vector::new(at(i, h.x), at(j, h.y), if depth == 1 { 0.0 } else { at(k, h.z) });
                    inside += usize::from(d + n.dot(&x) < 0.0);
                }
            }
        }
        inside as f64 / (M * M * depth) as f64
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]
        #[test]
        fn plane_cut_agrees_with_counting(
            nx in -1.0..1.0_f64, ny in -1.0..1.0_f64, nz in -1.0..1.0_f64, d in -0.9..0.9_f64, flat: bool,
        ) {
            let n = Vector::new(nx, ny, if flat { 0.0 } else { nz });
            prop_assume!(n.norm() > 0.1);
            let n = n.normalize();
            let h = Vector::new(1.0, 0.8, if flat { 0.0 } else { 1.3 });
            prop_assert!((plane_fraction(d, n, h) - counted(d, n, h)).abs() < 0.02);
        }

        #[test]
        fn the_two_sides_add_up(nx in -1.0..1.0_f64, ny in -1.0..1.0_f64, nz in -1.0..1.0_f64, d in -0.9..0.9_f64) {
            let n = Vector::new(nx, ny, nz);
            prop_assume!(n.norm() > 0.1);
            let n = n.normalize();
            let h = Vector::new(1.0, 1.0, 1.0);
            let both = plane_fraction(d, n, h) + plane_fraction(-d, -n, h);
            prop_assert!((both - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn axis_aligned_cuts_are_linear() {
        let h = Vector::new(0.5, 0.5, 0.0);
        for n in [Vector::x(), -Vector::x(), Vector::y(), -Vector::y()] {
            assert!((plane_fraction(0.1, n, h) - 0.3).abs() < 1e-15);
            assert!((plane_fraction(-0.1, n, h) - 0.7).abs() < 1e-15);
        }
    }
}
