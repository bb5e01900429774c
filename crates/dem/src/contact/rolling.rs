//! Rolling resistance.
use super::gap::{FilmForce, Gap};
use super::law::{ContactLaw, Push, Touch};
use super::properties::{PairProperties, series};
use crate::{DemError, Material};
use interfaces::Vector;

/// A contact law with rolling resistance: an elastic–plastic spring and dashpot against the relative rolling, up to the torque μ_r R*|F_n|
/// (Ai et al. 2011, Powder Technology 206, 269, model C):
///
/// ```text
/// dT/dt = −k_r (ω − n(n·ω)),   k_r = k_t R*²,   |T| ≤ μ_r R* |F_n|,   R* = l_i l_j/(l_i + l_j)
/// ```
///
/// with the tangential stiffness k_t; the dashpot has the damping ratio 0.3 and acts only below the limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rolling<L>(
    /// The law of the other forces.
    pub L,
);

/// Damping ratio of the spring against rolling.
const DAMPING_RATIO: f64 = 0.3;

impl<L: ContactLaw> ContactLaw for Rolling<L> {
    type Memory = (L::Memory, Vector);
    const MOBILITY: bool = L::MOBILITY;
    const PIVOTS: bool = L::PIVOTS;
    const FILMS: bool = L::FILMS;
    const PLANE: bool = L::PLANE;

    fn reach(&self) -> f64 {
        self.0.reach()
    }
    fn across(&self, gap: &Gap) -> FilmForce {
        self.0.across(gap)
    }
    fn properties(&self, a: &Material, b: &Material) -> PairProperties {
        self.0.properties(a, b)
    }
    #[inline]
    fn push(&self, p: &PairProperties, t: &Touch<'_>, (memory, torque): &mut Self::Memory) -> Push {
        let mut push = self.0.push(p, t, memory);
        let n = t.overlap.normal;
        let radius = series(t.arms[0], t.arms[1]);
        let limit = p.rolling_friction * radius * push.force.dot(&n).abs();
        if limit <= 0.0 {
            *torque = Vector::zeros();
            return push;
        }
        let stiffness = p.tangential * push.stiffness * radius * radius;
        let rolling = t.spin - n * n.dot(&t.spin);
        *torque -= n * n.dot(torque) + rolling * (stiffness * t.dt);
        let moment = radius * radius / (t.inverse_masses[0] + t.inverse_masses[1]);
        let viscosity = 2.0 * DAMPING_RATIO * (stiffness * moment).sqrt();
        let size = torque.norm();
        if size >= limit {
            *torque *= limit / size;
            push.couple += *torque;
        } else {
            let whole = *torque - rolling * viscosity;
            let size = whole.norm();
            push.couple += if size > limit { whole * (limit / size) } else { whole };
        }
        push
    }

    fn check(&self) -> Result<(), DemError> {
        self.0.check()
    }
}
