//! What upwind convection changes across a stream.
use crate::least_squares::{dot, norm2};
use interfaces::LawOfTheWall;

/// A smaller share of what is across the stream is damped as the rest.
pub(crate) const LEAST: f64 = 1e-3;

/// How much of what changes across the stream upwind parts spare, from 0 to 1, where half a cell has this y+: where cells resolve the sublayer on a wall.
pub(crate) fn spared(y_plus: f64) -> f64 {
    let share = 1.0 - LawOfTheWall::logarithmic(y_plus);
    // Nor where y+ is not a number, in a fluid at rest without viscosity.
    if share >= LEAST { share } else { 0.0 }
}

/// What a node sees of the stream and of what it carries.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stream<const D: usize> {
    /// Mean velocity there \[m/s\].
    velocity: [f64; D],
    /// How much of what changes across it is not to be damped, from 0 to 1.
    spared: f64,
    /// Per axis the mean of J/h³ over its edges.
    jumps: [f64; D],
    weights: [f64; D],
}

impl<const D: usize> Stream<D> {
    pub(crate) fn new(velocity: [f64; D], spared: f64) -> Self {
        Self { velocity, spared, jumps: [0.0; D], weights: [0.0; D] }
    }

    /// Adds an edge of length `h` between nodes along `axis`, through which J jumps.
    pub(crate) fn add(&mut self, axis: usize, jump: f64, h: f64, weight: f64) {
        self.jumps[axis] += weight * jump / h.powi(3);
        self.weights[axis] += weight;
    }

    fn jump(&self, axis: usize) -> f64 {
        if self.weights[axis] > 0.0 { self.jumps[axis] / self.weights[axis] } else { 0.0 }
    }
}

/// The part of the jump J on the edge of length `h` along `axis` between two nodes that comes from what changes across the stream.
///
/// Upwind values of second order are the mean of both sides' and ±½ J, J the difference of what both say, ∝ h³ ∂³φ/∂x³ along its axis: what damps
/// waves. It should act along the stream only (as streamline diffusion does: Brooks & Hughes 1982, *Comput. Methods Appl. Mech. Eng.* 32, 199–259): of a layer
/// along a wall that lies across the grid it carries momentum, or k, away from the wall as if it were friction. Where φ = f(s·x) + g(n·x), s along the stream and n across it,
///
/// ```text
/// J_a/h_a³ = f‴ s_a³ + g‴ n_a³,     f‴ = Σ_a s_a³ J_a/h_a³ / Σ_a s_a⁶
/// ```
///
/// in the plane (n = (−s₂, s₁): n³ is orthogonal to s³), so that the rest of J is that of g; in space some of that may count as f‴. J_a are means over the edges
/// around both nodes, and of J no more is taken than there is: waves from node to node, of which these means are 0, are damped whatever their direction.
#[inline]
pub(crate) fn across_stream<const D: usize>(
    axis: usize,
    jump: f64,
    h: f64,
    [low, high]: [&Stream<D>; 2],
) -> f64 {
    let spared = 0.5 * (low.spared + high.spared);
    if spared == 0.0 {
        return 0.0;
    }
    let stream: [f64; D] = std::array::from_fn(|a| low.velocity[a] + high.velocity[a]);
    let speed = norm2(&stream).sqrt();
    if speed == 0.0 {
        return 0.0;
    }
    // Sixth powers of a velocity could underflow.
    let cubes = stream.map(|u| (u / speed).powi(3));
    let jumps = std::array::from_fn(|a| 0.5 * (low.jump(a) + high.jump(a)));
    let across = h.powi(3) * (jumps[axis] - cubes[axis] * dot(&cubes, &jumps) / norm2(&cubes));
    if across * jump > 0.0 { spared * across.abs().min(jump.abs()).copysign(jump) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a jump on the edge between two nodes along x how much is across the stream, which makes the angle `angle` with x; φ(x, y), spacings h.
    fn part(angle: f64, h: [f64; 2], speed: f64, phi: impl Fn(f64, f64) -> f64) -> f64 {
        let gradient = |i: f64, j: f64, a: usize| {
            let [dx, dy] = if a == 0 { [1.0, 0.0] } else { [0.0, 1.0] };
            (phi((i + dx) * h[0], (j + dy) * h[1]) - phi((i - dx) * h[0], (j - dy) * h[1])) / (2.0 * h[a])
        };
        // Between (i, j) and the next node along a.
        let jump = |i: f64, j: f64, a: usize| {
            let [k, l] = if a == 0 { [i + 1.0, j] } else { [i, j + 1.0] };
            phi(i * h[0], j * h[1]) - phi(k * h[0], l * h[1])
                + 0.5 * h[a] * (gradient(i, j, a) + gradient(k, l, a))
        };
        let node = |i: f64| {
            let mut stream = Stream::new([speed * angle.cos(), speed * angle.sin()], 1.0);
            for back in [0.0, 1.0] {
                stream.add(0, jump(i - back, 0.0, 0), h[0], 1.0);
                stream.add(1, jump(i, -back, 1), h[1], 1.0);
            }
            stream
        };
        let here = jump(0.0, 0.0, 0);
        across_stream(0, here, h[0], [&node(0.0), &node(1.0)]) / here
    }

    #[test]
    fn what_changes_across_the_stream_is_all_and_what_changes_along_it_nothing() {
        for angle in [0.3_f64, 0.8, 1.2, 2.0] {
            let (c, s) = (angle.cos(), angle.sin());
            for (h, speed) in [([1.0, 1.0], 3.0), ([0.5, 1.3], 3.0), ([1.0, 1.0], 1e-80)] {
                let across = part(angle, h, speed, |x, y| (c * y - s * x).powi(3));
                let along = part(angle, h, speed, |x, y| (c * x + s * y).powi(3));
                assert!((across - 1.0).abs() < 1e-10 && along.abs() < 1e-10, "{angle}: {across} {along}");
            }
        }
    }

    #[test]
    fn waves_from_node_to_node_are_left_to_be_damped() {
        for angle in [0.0, 0.3, 0.8, 1.2] {
            let checks = part(angle, [1.0; 2], 1.0, |x, y| (std::f64::consts::PI * (x + y)).cos());
            let stripes = part(angle, [1.0; 2], 1.0, |x, _| (std::f64::consts::PI * x).cos());
            assert!(checks.abs() < 1e-10 && stripes.abs() < 1e-10, "{angle}: {checks} {stripes}");
        }
    }

    #[test]
    fn cells_that_resolve_a_sublayer_are_spared() {
        assert!(spared(0.0) == 1.0 && (spared(30.0) - (-1.0_f64).exp()).abs() < 1e-12);
        assert_eq!([60.0, f64::INFINITY, f64::NAN].map(spared), [0.0; 3]);
    }

    #[test]
    fn fluid_at_rest_has_no_stream() {
        let rest = Stream::<2>::new([0.0; 2], 1.0);
        assert_eq!(across_stream(0, 1.0, 1.0, [&rest, &rest]), 0.0);
    }
}
