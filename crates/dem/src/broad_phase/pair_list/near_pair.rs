//! Two bodies that may touch soon.

/// Two bodies that may touch soon; the second's image `image` periods away: its place is `position_b + image * periods`.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct NearPair {
    /// Number of the first body.
    pub a: u32,
    /// Number of the second one, or the first one's again.
    pub b: u32,
    /// How many periods the second one's image is away from it.
    pub image: [i32; 3],
}

/// A partner and its image among the wrapped boxes, in one number that sorts like both.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Default)]
pub(super) struct Key(pub(super) u64);

impl Key {
    /// `k` within ±511.
    #[inline]
    pub(super) fn new(b: u32, k: [i32; 3]) -> Self {
        let [x, y, z] = k.map(|k| (k + 512) as u64);
        Self(u64::from(b) << 32 | x << 20 | y << 10 | z)
    }
    #[inline]
    pub(super) fn partner(self) -> u32 {
        (self.0 >> 32) as u32
    }
    #[inline]
    pub(super) fn image(self) -> [i32; 3] {
        [20, 10, 0].map(|s| (self.0 >> s & 1023) as i32 - 512)
    }
}
