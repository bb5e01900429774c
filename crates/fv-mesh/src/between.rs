//! What is carried between two nodes beside walls.
use crate::Convection;
use crate::convection::KAPPA;
use crate::least_squares::dot;

/// The way from one node to another over the middle of the open part of the face between them, which need not be on the line through both.
#[derive(Clone, Debug)]
pub(crate) struct Between<const D: usize> {
    /// From this node, and from the other one, to the middle of the face; to the other one \[m\].
    pub(crate) to_face: [f64; D],
    from_other: [f64; D],
    pub(crate) step: [f64; D],
    /// Where between the nodes, as a share of the step along the face's normal.
    share: f64,
}

impl<const D: usize> Between<D> {
    /// Of nodes `x` and `y` and the `middle` of the face normal to axis `b` between them.
    pub(crate) fn new(x: [f64; D], y: [f64; D], middle: [f64; D], b: usize) -> Self {
        let difference = |p: [f64; D], q: [f64; D]| -> [f64; D] { std::array::from_fn(|a| p[a] - q[a]) };
        let (to_face, step) = (difference(middle, x), difference(y, x));
        // In narrow gaps nodes can be beside each other.
        let share = if step[b] == 0.0 { 0.5 } else { (to_face[b] / step[b]).clamp(0.0, 1.0) };
        Self { to_face, from_other: difference(middle, y), step, share }
    }

    /// What this node, and the other one, say of φ on the face by their gradients.
    fn ends(&self, phi: [f64; 2], g: [&[f64; D]; 2]) -> [f64; 2] {
        [phi[0] + dot(g[0], &self.to_face), phi[1] + dot(g[1], &self.from_other)]
    }

    /// What the node below says less what the one above does.
    pub(crate) fn jump(&self, b: usize, phi: [f64; 2], g: [&[f64; D]; 2]) -> f64 {
        let [own, other] = self.ends(phi, g);
        if self.step[b] > 0.0 { own - other } else { other - own }
    }

    /// φ that is carried over the face of axis `b` from the node `upwind` of both. `LinearUpwind` and `Quick` are
    ///
    /// ```text
    /// κ φ_line + (1 − κ) ½(φ_0 + φ_1) ± ½(J − J_across),   κ = 1/3
    /// ```
    ///
    /// φ_line on the line between the nodes, φ_0 and φ_1 what they say by their gradients, J = [`jump`](Self::jump), of which `across` is not damped.
    pub(crate) fn value(
        &self,
        scheme: Convection,
        b: usize,
        upwind: usize,
        phi: [f64; 2],
        g: [&[f64; D]; 2],
        across: f64,
    ) -> f64 {
        // From the line through the nodes to the middle of the face.
        let side: [f64; D] = std::array::from_fn(|a| self.to_face[a] - self.share * self.step[a]);
        let line = || phi[0] + self.share * (phi[1] - phi[0]) + 0.5 * (dot(g[0], &side) + dot(g[1], &side));
        match scheme {
            Convection::Upwind => phi[upwind],
            Convection::Central => line(),
            // Not QUICK's parabola: beside a law's logarithm it keeps layers on walls that they should leave.
            Convection::LinearUpwind | Convection::Quick => {
                let damped = self.jump(b, phi, g) - across;
                let from_below = (upwind == 0) == (self.step[b] > 0.0);
                let along = if from_below { 0.5 * damped } else { -0.5 * damped };
                let [own, other] = self.ends(phi, g);
                KAPPA * line() + (1.0 - KAPPA) * 0.5 * (own + other) + along
            }
            Convection::Limited => {
                let (sign, share) = if upwind == 0 { (1.0, self.share) } else { (-1.0, 1.0 - self.share) };
                let ahead = sign * (phi[1] - phi[0]);
                let behind = 2.0 * sign * dot(g[upwind], &self.step) - ahead;
                // ψ(r) (φ_D − φ_U) of van Leer.
                let change = if ahead * behind > 0.0 { 2.0 * ahead * behind / (ahead + behind) } else { 0.0 };
                phi[upwind] + share * change + dot(g[upwind], &side)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Between nodes one apart, the middle of the face half way and `aside` of their line.
    fn between(aside: f64) -> Between<2> {
        Between::new([0.0; 2], [1.0, 0.0], [0.5, aside], 0)
    }

    #[test]
    fn every_scheme_of_second_order_carries_what_is_linear() {
        let (gradient, aside) = ([0.7, -0.4], 0.2);
        let schemes = Convection::ALL.into_iter().filter(|scheme| *scheme != Convection::Upwind);
        for (scheme, upwind) in schemes.flat_map(|scheme| [(scheme, 0), (scheme, 1)]) {
            let value = between(aside).value(scheme, 0, upwind, [2.0, 2.7], [&gradient; 2], 0.0);
            assert!((value - (2.0 + 0.35 - 0.08)).abs() < 1e-14, "{scheme:?} {upwind}: {value}");
        }
    }

    #[test]
    fn nodes_beside_each_other_carry_what_is_linear() {
        let beside = Between::new([0.0; 2], [0.0, 2.0], [0.5, 1.0], 0);
        for (scheme, upwind) in [(Convection::Central, 0), (Convection::Quick, 0), (Convection::Quick, 1)] {
            let value = beside.value(scheme, 0, upwind, [2.0, 1.2], [&[0.7, -0.4]; 2], 0.0);
            assert!((value - (2.0 + 0.35 - 0.4)).abs() < 1e-14, "{scheme:?} {upwind}: {value}");
        }
    }

    /// φ before, at and behind the face; central gradients.
    #[test]
    fn the_limited_scheme_makes_nothing_new() {
        let value = |before: f64, here: f64, there: f64| {
            let [own, far] = [[0.5 * (there - before), 0.0], [0.0; 2]];
            between(0.0).value(Convection::Limited, 0, 0, [here, there], [&own, &far], 0.0)
        };
        // At the foot and at the head of a step, and at a maximum.
        assert_eq!(value(0.0, 0.0, 1.0), 0.0);
        assert_eq!(value(0.0, 1.0, 1.0), 1.0);
        assert_eq!(value(0.0, 1.0, 0.5), 1.0);
        // Slopes of 0.2 and 0.8: their harmonic mean.
        assert!((value(0.0, 0.2, 1.0) - (0.2 + 0.5 * 0.32)).abs() < 1e-14);
        for there in [0.3, 0.6, 5.0] {
            let found = value(0.0, 0.2, there);
            assert!((0.2..=there).contains(&found), "{found} {there}");
        }
    }
}
