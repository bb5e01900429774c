//! Bodies that are taken away.
use super::RigidBodies;
use super::contacts::Chunk;
use super::near::Listed;
use crate::DemError;
use crate::broad_phase::NearPair;
use crate::contact::ContactLaw;
use interfaces::{BodyId, Renumbering};

impl<L: ContactLaw> RigidBodies<L> {
    /// Takes bodies away; those that are left close up in their order, as the answer tells. What they do to one another stays as it is, to the last bit. Who slept together with one
    /// that is gone wakes. Who else keeps something of each body has to be told: [`Renumbering`].
    ///
    /// # Errors
    /// [`DemError::NoSuchBody`]; nobody is gone then.
    pub fn remove(&mut self, gone: &[BodyId]) -> Result<Renumbering, DemError> {
        let n = self.bodies.len();
        if let Some(body) = gone.iter().copied().find(|b| b.0 >= n) {
            return Err(DemError::NoSuchBody { body, bodies: n });
        }
        let numbers = Renumbering::without(n, gone.iter().copied());
        if numbers.left() == n {
            return Ok(numbers);
        }
        self.wake_islands(gone.iter().map(|b| self.sleepers.island[b.0]).collect());
        self.forget_pairs(&numbers);
        numbers.apply(&mut self.bodies);
        numbers.apply(&mut self.constants);
        numbers.apply(&mut self.contact);
        numbers.apply(&mut self.impulse);
        numbers.apply(&mut self.tethers);
        self.tied = self.tethers.iter().flatten().count();
        self.surfaces.renumber(&numbers);
        self.loads.renumber(&numbers);
        self.sleepers.renumber(&numbers);
        self.listed.clear();
        self.listed.resize_with(self.bodies.len(), Listed::not_yet);
        self.all_round = self.constants.iter().all(super::Constants::is_round);
        self.stable_dt = self.least_stable_dt(self.stable_dt);
        Ok(numbers)
    }

    /// Keeps the patches of pairs that are still there, under their new numbers, for when pairs are listed anew.
    fn forget_pairs(&mut self, numbers: &Renumbering) {
        let after = |pair: &NearPair| {
            let a = numbers.of(BodyId(pair.a as usize))?;
            // Walls keep their numbers.
            let b = if (pair.b as usize) < numbers.before() {
                numbers.of(BodyId(pair.b as usize))?.0 as u32
            } else {
                pair.b
            };
            Some(NearPair { a: a.0 as u32, b, image: pair.image })
        };
        let awake = self.chunks.iter_mut().flat_map(|Chunk { patches, .. }| patches.drain(..));
        let mut kept: Vec<_> = awake
            .map(|patch| (self.near[patch.near as usize], patch))
            .chain(self.sleepers.woken.drain(..))
            .filter_map(|(pair, patch)| Some((after(&pair)?, patch)))
            .collect();
        self.sleepers.woken.append(&mut kept);
        self.sleepers.patches.retain_mut(|(pair, _)| {
            after(pair).is_some_and(|now| {
                *pair = now;
                true
            })
        });
        self.near.clear();
        self.last_near.clear();
        self.felt.clear();
    }
}
