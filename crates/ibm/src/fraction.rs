//! How much of a cell is solid.
use interfaces::Vector;

/// The share of a box with edges `h` \[m\] (h.z = 0 in the plane) that lies behind a plane:
/// {x : d + n·x < 0}, x from the box's centre, `d` the signed distance of the centre \[m\] and `n`
/// the outward unit normal. Exact (Scardovelli & Zaleski 2000, J. Comput. Phys. 164, 228).
#[inline(always)]
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
/// A surface that bulges leaves its tangent plane by ½κ|x_t|² at x_t from the foot point of the centre, κ the mean
/// curvature there. To first order in κ the cell then loses as much as if the plane were moved inward by the mean of that
/// over its own cut through the cell (`spread`). A plane alone would make a disc's λ sum to too much by h²/12R², a sphere's
/// by h²/4R².
#[inline(always)]
pub fn cell_fraction(d: f64, n: Vector, curvature: f64, h: Vector) -> f64 {
    let depth = if h.z == 0.0 { 1.0 } else { 2.0 };
    // From the level surface through the centre to the surface itself.
    let bend = curvature / (depth - curvature * d).max(0.5 * depth);
    // No corner bulges farther.
    if d.abs() >= 0.5 * n.component_mul(&h).abs().sum() + 0.125 * bend.abs() * h.norm_squared() {
        return if d < 0.0 { 1.0 } else { 0.0 };
    }
    if depth == 2.0 {
        let flat = (bend * h.max()).abs() < BENT;
        let mean =
            if flat { h.component_mul(&h).dot(&n.map(|n| 1.0 - n * n)) / 12.0 } else { spread(d, n, h) };
        return plane_fraction(d + 0.5 * bend * mean, n, h);
    }
    // In the plane better in two halves; the normal is longer than one by ½(κ|x_t|)² only.
    let along = usize::from(n.x.abs() > n.y.abs());
    let mut half = h;
    half[along] *= 0.5;
    let share = |side: f64| {
        let mut x = Vector::zeros();
        x[along] = 0.5 * side * half[along];
        let t = n.dot(&x);
        let normal = n * (1.0 - bend * t) + x * bend;
        let moved = d + t + 0.5 * bend * (x.norm_squared() - t * t);
        plane_fraction(moved + 0.5 * bend * spread(moved, normal, half), normal, half)
    };
    0.5 * (share(-1.0) + share(1.0))
}

/// Below this κh the mean of the spread over all cuts of all cells, h²/12 per direction along the surface, does for every
/// cell: a sphere 32 cells wide, of which λ sums to h²/80R² too much where it is centred on the grid.
const BENT: f64 = 0.0625;

/// The mean of |x_t|² over the cut of a box with edges `h` by the plane d + n·x = 0, x_t the part of x along the plane,
/// x from the box's centre \[m²\]; of one that passes the box, at the nearest corner.
///
/// In space, with u the coordinates from the corner on the smaller side in edges, m the rise along them and α = m·u on
/// the plane, the integrals of 1, u_i and u_i² over the plane's cut through all of u ≥ 0 are α²/2, α³/6m_i and α⁴/12m_i²
/// over m_x m_y m_z; those through the box are sums over its corners with alternating signs.
#[inline(always)]
fn spread(d: f64, n: Vector, h: Vector) -> f64 {
    let m = n.component_mul(&h).abs();
    // A plane along an axis as good as.
    let least = LEVEL * m.sum();
    let m = m.zip_map(&h, |m, h| if h > 0.0 { m.max(least) } else { 0.0 });
    let sum = m.sum();
    let start = (0.5 * sum - d.abs()).max(2.0 * least);
    let offset = 0.5 * sum - start;
    if h.z == 0.0 {
        // Where the line leaves the cell.
        let (x, y) = ((start / m.x).min(1.0), (start / m.y).min(1.0));
        let ends = [(x, (start - m.x * x) / m.y), ((start - m.y * y) / m.x, y)];
        let [p, q] = ends.map(|(x, y)| Vector::new((x - 0.5) * h.x, (y - 0.5) * h.y, 0.0));
        return (p.norm_squared() + p.dot(&q) + q.norm_squared()) / 3.0 - offset * offset;
    }
    let h2 = h.component_mul(&h);
    let inverse = m.map(|m| 1.0 / m);
    let first = h2.component_mul(&inverse) / 6.0;
    let second = 0.5 * first.dot(&inverse);
    // The corners of the lower side along z, then those above them.
    let left = [start, start - m.x, start - m.y, start - m.x - m.y];
    let slope = [-first.x - first.y, first.x - first.y, first.y - first.x, first.x + first.y];
    let sign = [1.0, -1.0, -1.0, 1.0];
    let (mut area, mut moment) = (0.0, 0.0);
    for c in 0..4 {
        let (low, high) = (left[c].max(0.0), (left[c] - m.z).max(0.0));
        let (low2, high2) = (sign[c] * low * low, sign[c] * high * high);
        area += low2 - high2;
        moment += low2 * low * (slope[c] - first.z + low * second);
        moment -= high2 * high * (slope[c] + first.z + high * second);
    }
    0.25 * h2.sum() + 2.0 * moment / area - offset * offset
}

/// Smaller rises along an edge are taken for this much, as a share of all: without, the sums over corners lose their digits.
const LEVEL: f64 = 1e-3;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Counts sub-cells behind d + n·x + ½κ|x_t|² = 0: slow and without any formula.
    fn counted(d: f64, n: Vector, bend: f64, h: Vector) -> f64 {
        const M: usize = 60;
        let depth = if h.z == 0.0 { 1 } else { M };
        let mut inside = 0;
        for k in 0..depth {
            for j in 0..M {
                for i in 0..M {
                    let at = |i: usize, h: f64| ((i as f64 + 0.5) / M as f64 - 0.5) * h;
                    let x = Vector::new(at(i, h.x), at(j, h.y), if depth == 1 { 0.0 } else { at(k, h.z) });
                    let t = n.dot(&x);
                    inside += usize::from(d + t + 0.5 * bend * (x.norm_squared() - t * t) < 0.0);
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
            prop_assert!((plane_fraction(d, n, h) - counted(d, n, 0.0, h)).abs() < 0.02);
        }

        /// The bend's share, which is up to 0.1, within a tenth.
        #[test]
        fn bent_cuts_agree_with_counting(
            nx in -1.0..1.0_f64, ny in -1.0..1.0_f64, nz in -1.0..1.0_f64, d in -0.9..0.9_f64, bend in -0.3..0.3_f64, flat: bool,
        ) {
            let n = Vector::new(nx, ny, if flat { 0.0 } else { nz });
            prop_assume!(n.norm() > 0.1);
            let n = n.normalize();
            let h = Vector::new(1.0, 0.8, if flat { 0.0 } else { 1.3 });
            // Of the level surface through the centre.
            let there = bend / (1.0 + bend * d) * if flat { 1.0 } else { 2.0 };
            let [bent, plane] = [bend, 0.0].map(|bend| counted(d, n, bend, h));
            let found = cell_fraction(d, n, there, h) - plane_fraction(d, n, h);
            prop_assert!((found - (bent - plane)).abs() < 0.012, "{found} {}", bent - plane);
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
