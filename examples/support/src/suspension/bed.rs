//! How the bodies lie.
use crate::Outcome;
use dem::{ContactLaw, Cuboid, OverlapSolver, RigidBodies};
use interfaces::{Aabb, Bodies, Kinematics, Point, Pose};

/// Solid fractions at one instant, exact up to what bodies that touch share: every body is cut with a box.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bed {
    /// Below it are 19 of 20 centres \[m\].
    pub height: f64,
    /// From a quarter to seven tenths of the height, over the whole width of the box.
    pub whole: f64,
    /// The same without what is less than a diameter from the walls; `None` if nothing is left, or there are no walls.
    pub core: Option<f64>,
}

impl Bed {
    /// Between a floor at z = 0 and the surface, in a box `width` wide along x and y; `margin` is kept from the walls unless it is periodic.
    ///
    /// # Errors
    /// Those of the overlaps.
    pub fn of<L: ContactLaw>(bodies: &RigidBodies<L>, width: f64, margin: Option<f64>) -> Outcome<Self> {
        let mut heights: Vec<f64> = bodies.ids().map(|b| bodies.pose(b).position.z).collect();
        heights.sort_unstable_by(f64::total_cmp);
        let Some(&height) = heights.get(heights.len() * 19 / 20) else { return Ok(Self::default()) };
        let (low, high) = (0.25 * height, 0.7 * height);
        let whole = slab(bodies, low, high)? / (width * width * (high - low));
        let core = match margin {
            Some(m) if width > 2.0 * m => {
                let (near, far) = (m, width - m);
                let region = Aabb { min: [near, near, low].into(), max: [far, far, high].into() };
                Some(within(bodies, region)? / ((far - near) * (far - near) * (high - low)))
            }
            _ => None,
        };
        Ok(Self { height, whole, core })
    }
}

/// Solid fraction of `n` slabs from z = 0 to `top`, with their middle heights.
///
/// # Errors
/// Those of the overlaps.
pub(super) fn profile<L: ContactLaw>(
    bodies: &RigidBodies<L>,
    area: f64,
    top: f64,
    n: usize,
) -> Outcome<Vec<[f64; 2]>> {
    let thick = top / n as f64;
    let one = |i: usize| {
        let low = thick * i as f64;
        Ok([low + 0.5 * thick, slab(bodies, low, low + thick)? / (area * thick)])
    };
    (0..n).map(one).collect()
}

/// What bodies have between two heights \[m³\]. Where they are sideways does not matter.
fn slab<L: ContactLaw>(bodies: &RigidBodies<L>, low: f64, high: f64) -> Outcome<f64> {
    let wide = bodies.ids().map(|b| bodies.shape(b).bounding_radius()).fold(0.0, f64::max);
    let region = Aabb { min: [-wide, -wide, low].into(), max: [wide, wide, high].into() };
    volume(bodies, region, |pose| Pose { position: Point::new(0.0, 0.0, pose.position.z), ..pose })
}

/// What bodies have in a region \[m³\]; not for periodic boxes.
fn within<L: ContactLaw>(bodies: &RigidBodies<L>, region: Aabb) -> Outcome<f64> {
    volume(bodies, region, |pose| pose)
}

fn volume<L: ContactLaw>(
    bodies: &RigidBodies<L>,
    region: Aabb,
    place: impl Fn(Pose) -> Pose,
) -> Outcome<f64> {
    let region_shape = Cuboid::new(region.extent().into())?;
    let middle = Pose::at((0.5 * (region.min.coords + region.max.coords)).into());
    let (mut solver, mut sum) = (OverlapSolver::new(), 0.0);
    for b in bodies.ids() {
        let pose = place(bodies.pose(b));
        let bounds = bodies.shape(b).aabb().posed(&pose);
        let along = |f: fn(f64, f64) -> bool, a: &Point, b: &Point| (0..3).all(|i| f(a[i], b[i]));
        let less = |a: f64, b: f64| a <= b;
        if along(less, &region.min, &bounds.min) && along(less, &bounds.max, &region.max) {
            sum += bodies.inertia(b).volume;
        } else if along(less, &region.min, &bounds.max) && along(less, &bounds.min, &region.max) {
            let shared = solver.solve(bodies.shape(b), &pose, &region_shape, &middle)?;
            sum += shared.iter().map(|o| o.volume).sum::<f64>();
        }
    }
    Ok(sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use dem::{Material, RigidBodies};
    use interfaces::{Freedom, Periods, Rotation, Twist};

    /// Twenty plates of 1 × 1 × 0.5, one above the other, an eighth of the box; and turned about the upright axis.
    #[test]
    fn fractions_of_plates() {
        let mut bodies = RigidBodies::new(Periods::default());
        for i in 0..20 {
            let turn = Rotation::from_euler_angles(0.0, 0.0, 0.1 * f64::from(i));
            let position = Point::new(1.0, 1.0, f64::from(i) + 0.25);
            let pose = Pose { position, orientation: turn };
            let plate = Cuboid::new([1.0, 1.0, 0.5]).unwrap();
            bodies.add(plate, Material::default(), pose, Twist::default(), Freedom::FREE).unwrap();
        }
        let bed = Bed::of(&bodies, 2.0, Some(0.8)).unwrap();
        assert_eq!(bed.height, 19.25);
        // From 4.8125 to 13.475 there are 8 whole plates and 0.475 of one.
        let high = 0.45 * 19.25;
        assert!((bed.whole - (8.0 * 0.5 + 0.475) / (4.0 * high)).abs() < 1e-12, "{bed:?}");
        // Whatever the turn, the plates fill the middle 0.4 × 0.4.
        assert!((bed.core.unwrap() - 4.475 / high).abs() < 1e-12, "{bed:?}");
        assert_eq!(Bed::of(&bodies, 2.0, None).unwrap().core, None);
        let profile = profile(&bodies, 4.0, 20.0, 40).unwrap();
        assert!(profile.iter().enumerate().all(|(i, p)| (p[1] - [0.25, 0.0][i % 2]).abs() < 1e-12));
    }
}
