//! Where bodies come in.
use crate::placing::{Orientations, PlacingError, RandomAddition, Region};
use crate::{HalfSpace, Material, Shape};
use interfaces::{Aabb, Freedom, Periods, Point, Pose, Twist, Vector};
use std::sync::Arc;

/// A body that comes in, but for its place.
#[derive(Clone)]
pub struct Entrant {
    /// Its shape; give copies of one `Arc` where shapes are alike.
    pub shape: Arc<dyn Shape>,
    /// What it is made of.
    pub material: Material,
    /// How it moves when it comes in.
    pub twist: Twist,
    /// What it is free to do.
    pub freedom: Freedom,
}

/// A zone in which bodies come in, at a steady rate, at random places and without overlap.
///
/// The i-th of them, from 0, is due at start + i/rate. It is put in when [`Population`](crate::Population)'s `renew` is called next, if within a thousand
/// attempts a place is found where it keeps its gap to all bodies and walls; else it waits, and all that come after it do.
/// Rates are reached as long as bodies leave the zone fast enough.
///
/// What comes in depends on the `seed`, the serial number and the time only: a run that goes on from a saved state lets the same bodies in.
pub struct Inflow {
    pub(super) region: Region<'static>,
    pub(super) rate: f64,
    pub(super) start: f64,
    pub(super) number: u64,
    gap: f64,
    seed: u64,
    orientations: Orientations,
    pub(super) recipe: Box<dyn Fn(u64) -> Entrant + Send + Sync>,
}

/// How often a place is sought before a body waits.
const ATTEMPTS: usize = 1000;

impl Inflow {
    /// Bodies come into `region` at `rate` \[1/s\] from time 0 on; the i-th, from 0, is what `recipe` makes of i. It has to make the same of it
    /// whenever it is asked: draw sizes with i as the seed.
    ///
    /// # Errors
    /// [`PlacingError::Parameter`] unless the rate is positive and finite.
    pub fn new(
        region: Region<'static>,
        rate: f64,
        recipe: impl Fn(u64) -> Entrant + Send + Sync + 'static,
    ) -> Result<Self, PlacingError> {
        if !(rate.is_finite() && rate > 0.0) {
            let remedy = "give a positive, finite number of bodies per second";
            return Err(PlacingError::Parameter { what: "rate of the inflow", value: rate, remedy });
        }
        Ok(Self {
            region,
            rate,
            start: 0.0,
            number: u64::MAX,
            gap: 0.0,
            seed: 0,
            orientations: Orientations::Random,
            recipe: Box::new(recipe),
        })
    }
    /// The first comes at `start` \[s\].
    ///
    /// # Errors
    /// [`PlacingError::Parameter`] unless it is finite.
    pub fn with_start(mut self, start: f64) -> Result<Self, PlacingError> {
        if !start.is_finite() {
            let remedy = "give a finite number of seconds";
            return Err(PlacingError::Parameter { what: "start of the inflow", value: start, remedy });
        }
        self.start = start;
        Ok(self)
    }
    /// So many come, and no more; without end unless told.
    #[must_use]
    pub fn with_number(mut self, number: u64) -> Self {
        self.number = number;
        self
    }
    /// Who comes in keeps this `gap` \[m\] to bodies, to walls and to the sides of the zone; none unless told.
    ///
    /// # Errors
    /// [`PlacingError::Parameter`] if it is negative or not finite.
    pub fn with_gap(mut self, gap: f64) -> Result<Self, PlacingError> {
        self.gap = crate::placing::not_negative("gap", gap)?;
        Ok(self)
    }
    /// Another row of places and turns; 0 unless told.
    #[must_use]
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }
    /// How bodies are turned; at random unless told.
    #[must_use]
    pub fn with_orientations(mut self, orientations: Orientations) -> Self {
        self.orientations = orientations;
        self
    }

    /// How many are due until `time`.
    pub(super) fn due(&self, time: f64) -> u64 {
        let since = (time - self.start) * self.rate;
        // Up to round-off of a time that was added up.
        let whole = (since + 1e-9 * since.abs().max(1.0)).floor();
        // As floats are cast: none before the start, no more than there are.
        ((whole + 1.0) as u64).min(self.number)
    }

    /// Distance from the zone within which other bodies matter to an entrant \[m\].
    pub(super) fn reach(&self, shape: &dyn Shape) -> f64 {
        2.0 * shape.bounding_radius() + self.gap
    }

    /// The box in which the centre of `other` is within `reach` of the zone, and more.
    fn near(&self, other: &dyn Shape, reach: f64) -> Aabb {
        self.region.bounds().grown(reach + other.bounding_radius())
    }

    /// Whether a body at `centre`, or an image of it, is within `reach` of the zone.
    pub(super) fn is_near(&self, other: &dyn Shape, centre: Point, reach: f64, periods: &Periods) -> bool {
        let near = self.near(other, reach);
        let axes = if self.region.is_plane() { 2 } else { 3 };
        (0..axes).all(|axis| {
            let (low, high) = (near.min[axis] - centre[axis], near.max[axis] - centre[axis]);
            match periods.along(axis) {
                Some(_) if self.region.periodic()[axis] => true,
                Some(period) => (low / period).ceil() <= (high / period).floor(),
                None => low <= 0.0 && high >= 0.0,
            }
        })
    }

    /// A place for the body with the number `serial` among `bodies` and `walls`, if there is one at this `time`.
    pub(super) fn place<'b>(
        &self,
        shape: &dyn Shape,
        (serial, time): (u64, f64),
        bodies: impl Iterator<Item = (&'b dyn Shape, Pose)>,
        walls: impl Iterator<Item = &'b HalfSpace>,
        periods: &Periods,
    ) -> Result<Option<Pose>, PlacingError> {
        let reach = self.reach(shape);
        let mut adding = RandomAddition::new(self.region.clone())
            .with_gap(self.gap)?
            .with_attempts(ATTEMPTS)
            .with_orientations(self.orientations);
        for (other, at) in bodies {
            let near = self.near(other, reach);
            for away in self.images(&near, at.position, periods) {
                adding = adding.with_obstacle(other, Pose { position: at.position + away, ..at });
            }
        }
        for wall in walls {
            adding = adding.with_obstacle(wall, Pose::at([0.0; 3]));
        }
        let seed = mixed(mixed(self.seed, serial), time.to_bits());
        match adding.place(&[shape], seed) {
            Ok(poses) => Ok(poses.first().copied()),
            Err(PlacingError::Jammed(_)) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// By how much `centre` has to be moved to be one of its images within `near`; along axes along which the zone itself repeats, one is enough.
    fn images(&self, near: &Aabb, centre: Point, periods: &Periods) -> Vec<Vector> {
        let mut out = vec![Vector::zeros()];
        for axis in 0..if self.region.is_plane() { 2 } else { 3 } {
            let (low, high) = (near.min[axis] - centre[axis], near.max[axis] - centre[axis]);
            let ways: Vec<f64> = match periods.along(axis) {
                Some(_) if self.region.periodic()[axis] => vec![0.0],
                Some(period) => {
                    let (first, last) = ((low / period).ceil() as i64, (high / period).floor() as i64);
                    (first..=last).map(|i| i as f64 * period).collect()
                }
                None if low <= 0.0 && high >= 0.0 => vec![0.0],
                None => Vec::new(),
            };
            let along = |way: f64| Vector::from_fn(|a, _| if a == axis { way } else { 0.0 });
            out = out.iter().flat_map(|v| ways.iter().map(move |way| v + along(*way))).collect();
        }
        out
    }
}

/// A seed from a seed and a number (finaliser of SplitMix64, Steele et al. 2014).
fn mixed(seed: u64, number: u64) -> u64 {
    let mut z = seed.wrapping_add(number.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
