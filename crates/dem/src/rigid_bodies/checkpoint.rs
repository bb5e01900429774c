//! What a restart needs of the bodies.
use super::{Pair, RigidBodies, Spring};
use interfaces::{Checkpoint, Load, Point, RestartError, Rotation, Vector, Wrench};

/// Saved numbers per body and per touching pair.
const BODY: usize = 27;
const SPRING: usize = 5;

/// Poses, twists, loads, contact impulses and the elastic tangential forces of touching pairs. Shapes, materials
/// and walls are not saved: the run that restores has to set up the same ones.
impl Checkpoint for RigidBodies {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        let mut values = Vec::with_capacity(self.bodies.len() * BODY);
        for b in &self.bodies {
            let q = b.pose.orientation;
            values.extend([q.w, q.i, q.j, q.k]);
            let Load { wrench, added_mass, added_moment } = b.load;
            for v in [
                b.pose.position.coords,
                b.twist.linear,
                b.twist.angular,
                wrench.force,
                wrench.torque,
                b.impulse.force,
                b.impulse.torque,
            ] {
                values.extend_from_slice(v.as_slice());
            }
            values.extend([added_mass, added_moment]);
        }
        sink("bodies", &values);
        values.clear();
        for s in &self.springs {
            values.extend([s.pair.0 as f64, s.pair.1 as f64, s.force.x, s.force.y, s.force.z]);
        }
        sink("n_springs", &[self.springs.len() as f64]);
        sink("springs", &values);
        sink("contact_time", &[self.contact_time, self.overlap_calls as f64]);
    }

    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        let values = RestartError::take(source, "bodies", self.bodies.len() * BODY)?;
        for (b, v) in self.bodies.iter_mut().zip(values.chunks_exact(BODY)) {
            let vector = |i: usize| Vector::new(v[4 + 3 * i], v[5 + 3 * i], v[6 + 3 * i]);
            // As it was saved, to the last bit: no normalisation.
            b.pose.orientation = Rotation::new_unchecked(nalgebra::Quaternion::new(v[0], v[1], v[2], v[3]));
            b.pose.position = Point::from(vector(0));
            (b.twist.linear, b.twist.angular) = (vector(1), vector(2));
            let wrench = Wrench { force: vector(3), torque: vector(4) };
            b.load = Load { wrench, added_mass: v[25], added_moment: v[26] };
            b.impulse = Wrench { force: vector(5), torque: vector(6) };
        }
        let n = RestartError::take(source, "n_springs", 1)?[0] as usize;
        let springs = RestartError::take(source, "springs", SPRING * n)?;
        self.springs.clear();
        self.springs.extend(springs.chunks_exact(SPRING).map(|v| Spring {
            pair: Pair(v[0] as usize, v[1] as usize),
            force: Vector::new(v[2], v[3], v[4]),
        }));
        let counters = RestartError::take(source, "contact_time", 2)?;
        (self.contact_time, self.overlap_calls) = (counters[0], counters[1] as u64);
        Ok(())
    }
}
