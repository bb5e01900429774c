//! Bodies that lie still are left alone.
use super::RigidBodies;
use super::body::{Body, Constants};
use super::contacts::{CHUNK, Chunk, Patch, wall_of};
use super::near::Listed;
use crate::DemError;
use crate::broad_phase::NearPair;
use crate::contact::ContactLaw;
use interfaces::{BodyId, Renumbering, Twist, Wrench};

/// When bodies fall asleep: all that hang together by contacts, once each has been slower than `speed` for `time`.
///
/// Who sleeps is not moved, and what sleepers do to one another is not computed again. They wake, all that hang together, with the
/// contacts that they had, when something that moves touches one of them, or a load, the weight, a wall or a motion is given
/// that was not there before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sleep {
    /// Speed of a body's surface, |U| + |Ω| times the radius around it \[m/s\].
    pub speed: f64,
    /// For how long \[s\].
    pub time: f64,
}

impl Sleep {
    pub(super) fn check(self) -> Result<(), DemError> {
        let good = |x: f64| x.is_finite() && x > 0.0;
        if good(self.speed) && good(self.time) {
            Ok(())
        } else {
            Err(DemError::Sleep { speed: self.speed, time: self.time })
        }
    }
}

/// Steps between looks for who may sleep.
const LOOK_EVERY: u32 = 20;

/// Who sleeps.
#[derive(Clone, Debug)]
pub(super) struct Sleepers<M> {
    pub(super) threshold: Option<Sleep>,
    /// Of every body: with whom it sleeps, by number from 1; 0 who is awake.
    pub(super) island: Vec<u32>,
    /// For how long it has been slow \[s\].
    pub(super) slow: Vec<f64>,
    /// Patches that sleepers share, with one another and with what cannot be moved.
    pub(super) patches: Vec<(NearPair, Patch<M>)>,
    /// Those of who has just woken, on their way back.
    pub(super) woken: Vec<(NearPair, Patch<M>)>,
    /// How many sleep.
    pub(super) n: usize,
    /// Steps since the last look.
    pub(super) steps: u32,
    /// Scratch: who hangs together with whom, and may they sleep?
    root: Vec<u32>,
    may: Vec<bool>,
}

impl<M> Default for Sleepers<M> {
    fn default() -> Self {
        Self {
            threshold: None,
            island: Vec::new(),
            slow: Vec::new(),
            patches: Vec::new(),
            woken: Vec::new(),
            n: 0,
            steps: 0,
            root: Vec::new(),
            may: Vec::new(),
        }
    }
}

impl<M> Sleepers<M> {
    pub(super) fn add(&mut self) {
        self.island.push(0);
        self.slow.push(0.0);
    }
    /// Some are gone, all of them awake. An island has the number of one of its bodies and keeps to it.
    pub(super) fn renumber(&mut self, numbers: &Renumbering) {
        numbers.apply(&mut self.island);
        numbers.apply(&mut self.slow);
        for island in self.island.iter_mut().filter(|i| **i != 0) {
            let now = numbers.of(BodyId(*island as usize - 1));
            debug_assert!(now.is_some(), "an island is named after one of its own");
            *island = now.map_or(0, |b| b.0 as u32 + 1);
        }
    }
    /// Patches that are not in the list of near pairs.
    pub(super) fn kept(&self) -> impl Iterator<Item = (NearPair, &Patch<M>)> {
        self.patches.iter().chain(&self.woken).map(|(pair, p)| (*pair, p))
    }
    #[inline]
    pub(super) fn is_asleep(&self, b: usize) -> bool {
        self.island[b] != 0
    }
    /// Is `b` at rest until something moves it?
    #[inline]
    pub(super) fn lies(&self, b: usize, body: &Body, constants: &Constants) -> bool {
        self.is_asleep(b) || (!constants.movable() && body.twist == Twist::default())
    }
}

fn find(root: &mut [u32], mut b: u32) -> u32 {
    while root[b as usize] != b {
        root[b as usize] = root[root[b as usize] as usize];
        b = root[b as usize];
    }
    b
}

impl<L: ContactLaw> RigidBodies<L> {
    /// Lets bodies fall asleep that are slow for a while; `None`, as it is unless told, keeps (and makes) all awake.
    ///
    /// # Errors
    /// [`DemError::Sleep`].
    pub fn set_sleep(&mut self, sleep: Option<Sleep>) -> Result<(), DemError> {
        sleep.map_or(Ok(()), Sleep::check)?;
        self.sleepers.threshold = sleep;
        if sleep.is_none() {
            self.wake_all();
        }
        Ok(())
    }

    /// Does body `b` sleep?
    pub fn is_asleep(&self, b: interfaces::BodyId) -> bool {
        self.sleepers.is_asleep(b.0)
    }

    /// How many bodies sleep.
    pub fn n_asleep(&self) -> usize {
        self.sleepers.n
    }

    fn lies(&self, b: usize) -> bool {
        self.sleepers.lies(b, &self.bodies[b], &self.constants[b])
    }

    pub(super) fn wake_all(&mut self) {
        if self.sleepers.n > 0 {
            self.wake_where(|_| true);
        }
    }

    /// Wakes all that sleep in an island (0 is none); pairs have to be listed anew.
    pub(super) fn wake(&mut self, island: u32) {
        if island != 0 {
            self.wake_where(|i| i == island);
        }
    }

    /// Wakes all that sleep in these islands, in one pass.
    pub(super) fn wake_islands(&mut self, mut islands: Vec<u32>) {
        islands.retain(|island| *island != 0);
        islands.sort_unstable();
        islands.dedup();
        if !islands.is_empty() {
            self.wake_where(|island| islands.binary_search(&island).is_ok());
        }
    }

    /// Wakes all that sleep in islands for which `wakes` holds.
    fn wake_where(&mut self, wakes: impl Fn(u32) -> bool) {
        let s = &mut self.sleepers;
        let (woken, all) = (&mut s.woken, &s.island);
        s.patches.retain(|(pair, patch)| {
            let island = |b: u32| all.get(b as usize).copied().unwrap_or(0);
            let own = [pair.a, pair.b].map(island).into_iter().any(|i| i != 0 && wakes(i));
            if own {
                woken.push((*pair, *patch));
            }
            !own
        });
        for b in 0..s.island.len() {
            if s.island[b] != 0 && wakes(s.island[b]) {
                (s.island[b], s.slow[b]) = (0, 0.0);
                s.n -= 1;
                self.listed[b] = Listed::not_yet();
            }
        }
    }

    /// Wakes who is touched by something that moves; answers whether anyone was. The last forces are then taken back.
    pub(super) fn wake_touched(&mut self) -> bool {
        if self.sleepers.n == 0 {
            return false;
        }
        let mut touched = Vec::new();
        for patch in self.chunks.iter().flat_map(|c| &c.patches) {
            let pair = self.near[patch.near as usize];
            let asleep = |b: u32| self.sleepers.island.get(b as usize).copied().unwrap_or(0);
            touched.extend([asleep(pair.a), asleep(pair.b)].into_iter().filter(|i| *i != 0));
        }
        if touched.is_empty() {
            return false;
        }
        let used = self.near.len().div_ceil(CHUNK);
        self.chunks[..used].iter_mut().for_each(Chunk::undo);
        self.wake_islands(touched);
        true
    }

    /// After a step of `dt`: who has been slow for long enough falls asleep.
    pub(super) fn fall_asleep(&mut self, dt: f64) {
        let Some(Sleep { speed, time }) = self.sleepers.threshold else { return };
        for (b, body) in self.bodies.iter().enumerate() {
            let slow = body.twist.linear.norm() + body.twist.angular.norm() * body.radius < speed;
            let s = &mut self.sleepers.slow[b];
            *s = if slow { *s + dt } else { 0.0 };
        }
        self.sleepers.steps += 1;
        if self.sleepers.steps < LOOK_EVERY {
            return;
        }
        self.sleepers.steps = 0;
        let n = self.bodies.len();
        let (mut root, mut may) =
            (std::mem::take(&mut self.sleepers.root), std::mem::take(&mut self.sleepers.may));
        root.clear();
        root.extend(0..n as u32);
        may.clear();
        may.extend((0..n).map(|b| self.constants[b].movable() && self.sleepers.slow[b] >= time));
        for patch in self.chunks.iter().flat_map(|c| &c.patches) {
            let NearPair { a, b, .. } = self.near[patch.near as usize];
            let (i, j) = (a as usize, b as usize);
            // On a belt friction goes on.
            let wall = (j >= n).then(|| wall_of(b));
            if self.any_slides && self.surfaces.slides(i, j, wall) {
                may[i] = false;
                if j < n {
                    may[j] = false;
                }
            }
            // Who cannot be moved holds nobody together, but keeps awake while it moves.
            for (one, other) in [(i, j), (j, i)] {
                if other < n && one < n && !self.constants[other].movable() && !self.lies(other) {
                    may[one] = false;
                }
            }
            if j < n && self.constants[i].movable() && self.constants[j].movable() {
                let (p, q) = (find(&mut root, a), find(&mut root, b));
                root[p as usize] = q;
            }
        }
        for b in 0..n {
            if !may[b] {
                let r = find(&mut root, b as u32) as usize;
                may[r] = false;
            }
        }
        let mut fell = false;
        for b in 0..n {
            let r = find(&mut root, b as u32);
            if may[r as usize] && may[b] && !self.sleepers.is_asleep(b) {
                self.sleepers.island[b] = r + 1;
                self.sleepers.n += 1;
                self.bodies[b].twist = Twist::default();
                self.contact[b] = Wrench::default();
                fell = true;
            }
        }
        (self.sleepers.root, self.sleepers.may) = (root, may);
        if fell {
            self.put_to_bed();
        }
    }

    /// Takes the pairs of those that lie out of the list, and keeps their patches.
    fn put_to_bed(&mut self) {
        let mut chunks = std::mem::take(&mut self.chunks);
        let mut patches = std::mem::take(&mut self.sleepers.patches);
        for chunk in &mut chunks {
            chunk.patches.retain(|patch| {
                let pair = self.near[patch.near as usize];
                let b = pair.b as usize;
                let lie = self.lies(pair.a as usize) && (b >= self.bodies.len() || self.lies(b));
                if lie {
                    patches.push((pair, *patch));
                }
                !lie
            });
        }
        (self.chunks, self.sleepers.patches) = (chunks, patches);
        self.sleepers.patches.sort_by_key(|(pair, _)| *pair);
        // Listed anew at the next step.
        self.listed.iter_mut().for_each(|l| *l = Listed::not_yet());
    }
}
