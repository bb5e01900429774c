//! What is summed over a part of space.
use interfaces::Vector;

/// Sums over a part of space, and over the pieces of surface that bound it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sums {
    /// ∫dV.
    pub(crate) volume: f64,
    /// ∫x dV.
    pub(crate) first: Vector,
    /// Of each body, ∫n dA and ∫x × n dA over its surface, and ∫dA, or a little less.
    pub(crate) flux: [Vector; 2],
    pub(crate) turn: [Vector; 2],
    pub(crate) area: [f64; 2],
}

impl Sums {
    /// The same somewhere else, and only a share of it.
    pub(crate) fn moved(&self, by: Vector, share: f64) -> Self {
        let flux = self.flux.map(|f| share * f);
        Self {
            volume: share * self.volume,
            first: share * (self.first + self.volume * by),
            flux,
            turn: [0, 1].map(|i| share * self.turn[i] + by.cross(&flux[i])),
            area: self.area.map(|a| share * a),
        }
    }
    pub(crate) fn add(&mut self, o: &Self) {
        self.add_share(o, 1.0);
    }
    pub(crate) fn add_share(&mut self, o: &Self, share: f64) {
        self.volume += share * o.volume;
        self.first += share * o.first;
        for i in 0..2 {
            self.flux[i] += share * o.flux[i];
            self.turn[i] += share * o.turn[i];
            self.area[i] += share * o.area[i];
        }
    }
}

/// What is in a box.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Content {
    pub(crate) sums: Sums,
    /// ∫xᵢxⱼ dV: xx, yy, zz, yz, xz, xy; only of one body alone.
    pub(crate) second: [f64; 6],
    /// How well it is summed: 0 where all is smooth, 1 where it may have edges within the box, more where columns may meet a
    /// surface twice.
    pub(crate) ragged: f64,
}
