//! What is measured of many bodies.
use super::law::Granulate;
use dem::{ContactLaw, Form, Partner, RigidBodies};
use interfaces::{Aabb, Bodies, BodyId, Kinematics};
use std::f64::consts::PI;

/// Acceleration of free fall \[m/s²\].
pub const GRAVITY: f64 = 9.81;

/// Sums over all grains at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// How many there are.
    pub grains: usize,
    /// Σ ½mU² + ½ΩIΩ \[J\].
    pub kinetic: f64,
    /// Σ m g z \[J\].
    pub potential: f64,
    /// The fastest \[m/s\].
    pub fastest: f64,
    /// Patches that grains share with one another and with walls.
    pub contacts: usize,
    /// Contacts per grain, those with walls included.
    pub coordination: f64,
    /// Depth of overlaps by the radius of the smaller one: mean and largest. Spheres of the same volume stand for other bodies.
    pub overlap: [f64; 2],
    /// Grains whose centres are not where they should be.
    pub outside: usize,
}

impl Totals {
    pub(super) const COLUMNS: [&'static str; 9] = [
        "grains",
        "kinetic_energy",
        "potential_energy",
        "fastest",
        "contacts",
        "coordination",
        "overlap",
        "largest_overlap",
        "outside",
    ];
    pub(super) fn values(&self) -> [f64; 9] {
        [
            self.grains as f64,
            self.kinetic,
            self.potential,
            self.fastest,
            self.contacts as f64,
            self.coordination,
            self.overlap[0],
            self.overlap[1],
            self.outside as f64,
        ]
    }
}

/// The sums over the bodies from number `first` on; `domain` is where they should be.
pub fn totals<L: ContactLaw>(bodies: &RigidBodies<L>, first: usize, domain: &Aabb) -> Totals {
    let mut t = Totals { grains: bodies.n_bodies().saturating_sub(first), ..Totals::default() };
    for b in bodies.ids().skip(first) {
        let (inertia, pose, twist) = (bodies.inertia(b), bodies.pose(b), bodies.twist(b));
        let spin = pose.orientation.inverse_transform_vector(&twist.angular);
        t.kinetic +=
            0.5 * inertia.mass * twist.linear.norm_squared() + 0.5 * spin.dot(&(inertia.tensor * spin));
        t.potential += inertia.mass * GRAVITY * pose.position.z;
        t.fastest = t.fastest.max(twist.linear.norm());
        let p = pose.position;
        t.outside += usize::from((0..3).any(|a| !(p[a] >= domain.min[a] && p[a] <= domain.max[a])));
    }
    let (mut sides, mut depths) = (0, 0.0);
    for contact in bodies.contacts() {
        let (r, grain) = (radius(bodies, contact.body), contact.body.0 >= first);
        let (reduced, least, other) = match contact.partner {
            Partner::Body(b, _) if b.0 >= first && grain => {
                let s = radius(bodies, b);
                (r * s / (r + s), r.min(s), true)
            }
            Partner::Body(b, _) if !grain => (radius(bodies, b), radius(bodies, b), true),
            _ => (r, r, false),
        };
        sides += usize::from(grain) + usize::from(other);
        t.contacts += 1;
        // Of a cap: V = π δ² R*.
        let depth = (contact.volume / (PI * reduced)).sqrt() / least;
        depths += depth;
        t.overlap[1] = t.overlap[1].max(depth);
    }
    t.coordination = sides as f64 / t.grains.max(1) as f64;
    t.overlap[0] = depths / t.contacts.max(1) as f64;
    t
}

/// Of a sphere as large as the body.
fn radius<L: ContactLaw>(bodies: &RigidBodies<L>, b: BodyId) -> f64 {
    (0.75 * bodies.inertia(b).volume / PI).cbrt()
}

/// The share of a box that grains fill from `low` to `high`, `area` wide: exact for spheres; others count as spheres of their volume.
pub fn solid_fraction(bodies: &Granulate, first: usize, area: f64, low: f64, high: f64) -> f64 {
    let below = |r: f64, h: f64| {
        // What a plane at the height h over the centre cuts off below.
        let h = h.clamp(-r, r) + r;
        PI * h * h * (r - h / 3.0)
    };
    let of = |b: BodyId| {
        let r = match bodies.shape(b).form() {
            Form::Sphere(s) => s.radius(),
            _ => radius(bodies, b),
        };
        let z = bodies.pose(b).position.z;
        below(r, high - z) - below(r, low - z)
    };
    bodies.ids().skip(first).map(of).sum::<f64>() / (area * (high - low))
}

/// The angle \[rad\] of a cone's flank, from the highest tops of grains in rings `width` wide around the vertical axis between the radii `from` and
/// `to`: a line through them by least squares. `None` with fewer than three rings.
pub fn cone_slope(tops: impl Iterator<Item = [f64; 3]>, from: f64, to: f64, width: f64) -> Option<f64> {
    let n = ((to - from) / width).floor().max(0.0) as usize;
    let mut highest = vec![None; n];
    for [x, y, z] in tops {
        let ring = (x.hypot(y) - from) / width;
        if ring >= 0.0
            && let Some(top) = highest.get_mut(ring as usize)
        {
            *top =
                Some(top.map_or((z, x.hypot(y)), |t: (f64, f64)| if z > t.0 { (z, x.hypot(y)) } else { t }));
        }
    }
    let points: Vec<(f64, f64)> = highest.into_iter().flatten().map(|(z, r)| (r, z)).collect();
    (points.len() >= 3).then(|| -line(&points).1.atan())
}

/// Intercept and slope of the line through points, by least squares.
pub fn line(points: &[(f64, f64)]) -> (f64, f64) {
    let n = points.len() as f64;
    let (mx, my) = points.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x / n, b + y / n));
    let (xx, xy) =
        points.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + (x - mx) * (x - mx), b + (x - mx) * (y - my)));
    let slope = if xx > 0.0 { xy / xx } else { 0.0 };
    (my - slope * mx, slope)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::granular::{Law, Ways};
    use dem::{HalfSpace, Material, Rolling, Sphere};
    use interfaces::{Dynamics, Freedom, Periods, Point, Pose, Twist, Vector};

    fn two() -> Granulate {
        let law = Rolling(Law::from(Ways::Potential));
        let mut bodies = RigidBodies::with_law(Periods::default(), law);
        let m = Material { density: 3.0 / (4.0 * PI), ..Material::default() };
        bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z()).unwrap(), m).unwrap();
        for z in [0.99, 2.96] {
            let twist = Twist { linear: Vector::new(0.0, z, 0.0), ..Twist::default() };
            bodies.add(Sphere::new(1.0).unwrap(), m, Pose::at([0.0, 0.0, z]), twist, Freedom::FREE).unwrap();
        }
        bodies
    }

    #[test]
    fn sums() {
        let mut bodies = two();
        bodies.advance(1e-9).unwrap();
        let all = Aabb::around(Point::origin(), Vector::repeat(2.0));
        let t = totals(&bodies, 0, &all);
        assert!((t.kinetic - 0.5 * (0.99_f64.powi(2) + 2.96_f64.powi(2))).abs() < 1e-6);
        assert!((t.potential - GRAVITY * 3.95).abs() < 1e-6 && (t.fastest - 2.96).abs() < 1e-6);
        assert_eq!((t.grains, t.contacts, t.coordination, t.outside), (2, 2, 1.5, 1));
        // 0.03 and 0.01 deep; the cap's formula is right to first order.
        assert!((t.overlap[0] - 0.02).abs() < 5e-4 && (t.overlap[1] - 0.03).abs() < 5e-4, "{t:?}");
    }

    #[test]
    fn fraction_between_planes() {
        let bodies = two();
        let ball = 4.0 / 3.0 * PI;
        assert!((solid_fraction(&bodies, 0, 4.0, -1.0, 5.0) - 2.0 * ball / 24.0).abs() < 1e-12);
        assert!((solid_fraction(&bodies, 1, 4.0, 2.96, 5.0) - 0.5 * ball / (4.0 * 2.04)).abs() < 1e-12);
    }

    #[test]
    fn slope_of_a_cone() {
        let tops = (0..2000).map(|i| {
            let (r, a) = (0.1 * f64::from(i % 100), f64::from(i));
            [r * a.cos(), r * a.sin(), 4.0 - 0.5 * r]
        });
        assert!((cone_slope(tops, 1.0, 7.0, 0.5).unwrap().tan() - 0.5).abs() < 1e-9);
        assert_eq!(cone_slope(std::iter::empty(), 1.0, 7.0, 0.5), None);
    }
}
