//! What a restart needs of the bodies.
use super::RigidBodies;
use super::contacts::{CHUNK, Patch};
use super::near::Listed;
use super::sleep::Sleepers;
use crate::broad_phase::NearPair;
use crate::contact::{ContactLaw, Memory};
use interfaces::{Checkpoint, Load, Point, RestartError, Rotation, Vector, Wrench};

/// Saved numbers per body, and per touching patch besides what the law keeps.
const BODY: usize = 38;
const PATCH: usize = 19;

/// Poses, twists, loads, contact impulses and what the contact law keeps of touching patches. Shapes, materials, walls and gravity are not saved:
/// the run that restores has to set up the same ones.
impl<L: ContactLaw> Checkpoint for RigidBodies<L> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        let mut values = Vec::with_capacity(self.bodies.len() * BODY);
        for (b, body) in self.bodies.iter().enumerate() {
            let q = body.pose.orientation;
            values.extend([q.w, q.i, q.j, q.k]);
            let Load { wrench, added_mass, added_moment } = *self.loads.of(b);
            let impulse = &self.impulse[b];
            for v in [
                body.pose.position.coords,
                body.twist.linear,
                body.twist.angular,
                wrench.force,
                wrench.torque,
                impulse.force,
                impulse.torque,
            ] {
                values.extend_from_slice(v.as_slice());
            }
            values.extend([added_mass, added_moment]);
            // So that pairs are listed anew when they would have been.
            let Listed { centre, orientation: q, margin } = self.listed[b];
            values.extend([centre.x, centre.y, centre.z, q.w, q.i, q.j, q.k, margin]);
            values.extend_from_slice(self.contact[b].force.as_slice());
        }
        sink("bodies", &values);
        values.clear();
        let awake = self.chunks.iter().flat_map(|c| &c.patches).map(|p| (self.near[p.near as usize], p));
        for (pair, patch) in awake.chain(self.sleepers.kept()) {
            values.extend([f64::from(pair.a), f64::from(pair.b)]);
            values.extend(pair.image.map(f64::from));
            values.extend([patch.volume, patch.area]);
            for v in [patch.point.coords, patch.normal, patch.force, patch.couple] {
                values.extend_from_slice(v.as_slice());
            }
            patch.memory.save(&mut values);
        }
        sink("n_patches", &[(values.len() / (PATCH + L::Memory::N)) as f64]);
        sink("patches", &values);
        values.clear();
        let Sleepers { island, slow, steps, .. } = &self.sleepers;
        values.extend(island.iter().zip(slow).flat_map(|(i, s)| [f64::from(*i), *s]));
        values.push(f64::from(*steps));
        sink("sleep", &values);
        let counters = [
            self.contact_time,
            self.overlap_calls as f64,
            self.stiffest,
            self.fastest,
            self.listed_for,
            self.last_step,
            self.time,
        ];
        sink("contact_time", &counters);
    }

    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        let values = RestartError::take(source, "bodies", self.bodies.len() * BODY)?;
        for (b, v) in values.chunks_exact(BODY).enumerate() {
            let vector = |i: usize| Vector::new(v[4 + 3 * i], v[5 + 3 * i], v[6 + 3 * i]);
            let body = &mut self.bodies[b];
            // As it was saved, to the last bit: no normalisation.
            body.pose.orientation =
                Rotation::new_unchecked(nalgebra::Quaternion::new(v[0], v[1], v[2], v[3]));
            body.pose.position = Point::from(vector(0));
            (body.twist.linear, body.twist.angular) = (vector(1), vector(2));
            let wrench = Wrench { force: vector(3), torque: vector(4) };
            self.loads.set(b, Load { wrench, added_mass: v[25], added_moment: v[26] });
            self.impulse[b] = Wrench { force: vector(5), torque: vector(6) };
            let orientation = Rotation::new_unchecked(nalgebra::Quaternion::new(v[30], v[31], v[32], v[33]));
            self.listed[b] = Listed { centre: Point::new(v[27], v[28], v[29]), orientation, margin: v[34] };
            self.contact[b].force = Vector::new(v[35], v[36], v[37]);
        }
        let n = RestartError::take(source, "n_patches", 1)?[0] as usize;
        let size = PATCH + L::Memory::N;
        let patches = RestartError::take(source, "patches", size * n)?;
        let counters = RestartError::take(source, "contact_time", 7)?;
        (self.contact_time, self.overlap_calls) = (counters[0], counters[1] as u64);
        (self.last_step, self.time) = (counters[5], counters[6]);
        let sleep = RestartError::take(source, "sleep", 2 * self.bodies.len() + 1)?;
        for (b, v) in sleep.chunks_exact(2).enumerate() {
            (self.sleepers.island[b], self.sleepers.slow[b]) = (v[0] as u32, v[1]);
        }
        self.sleepers.steps = sleep[sleep.len() - 1] as u32;
        self.sleepers.n = self.sleepers.island.iter().filter(|i| **i != 0).count();
        self.sleepers.patches.clear();
        self.sleepers.woken.clear();
        // Listed once with nothing remembered; then each patch goes to its pair.
        self.chunks.iter_mut().for_each(|c| c.patches.clear());
        self.near.clear();
        // Unless they are to be listed at the next step anyway.
        if self.listed.iter().all(|l| l.margin >= 0.0) {
            self.list_again().map_err(|_| RestartError::Differs("bodies".into()))?;
        }
        (self.stiffest, self.fastest, self.listed_for) = (counters[2], counters[3], counters[4]);
        let n = self.bodies.len();
        let key = |a: u32, b: u32, image: [i32; 3]| (b as usize >= n, a, b, image);
        for v in patches.chunks_exact(size) {
            let wanted = key(v[0] as u32, v[1] as u32, [v[2] as i32, v[3] as i32, v[4] as i32]);
            let at = self.near.binary_search_by_key(&wanted, |p| key(p.a, p.b, p.image));
            let vector = |i: usize| Vector::new(v[7 + 3 * i], v[8 + 3 * i], v[9 + 3 * i]);
            let patch = Patch {
                near: at.unwrap_or_default() as u32,
                volume: v[5],
                area: v[6],
                point: Point::from(vector(0)),
                normal: vector(1),
                force: vector(2),
                couple: vector(3),
                memory: L::Memory::load(&v[PATCH..]),
            };
            match at {
                Ok(at) => self.chunks[at / CHUNK].patches.push(patch),
                Err(_) => {
                    let (_, a, b, image) = wanted;
                    let asleep =
                        [a, b].iter().any(|b| self.sleepers.island.get(*b as usize).is_some_and(|i| *i != 0));
                    let to = if asleep { &mut self.sleepers.patches } else { &mut self.sleepers.woken };
                    to.push((NearPair { a, b, image }, patch));
                }
            }
        }
        Ok(())
    }
}
