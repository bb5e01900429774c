//! A range of heights as rules see it.
/// Heights between two ends as a function of u between −1 and 1: linear, but quadratic at an end that is round, where the
/// integrand may be one of the square root of the distance, and m + ½w(3u − u³) if both are.
#[derive(Clone, Copy, Default)]
pub(super) struct Piece {
    pub(super) ends: [f64; 2],
    pub(super) round: [bool; 2],
    pub(super) part: [f64; 2],
    /// Heights near the ends and which pieces of the outline were there, if this is known.
    pub(super) near: [Option<(f64, u64)>; 2],
}

impl Piece {
    /// All between two heights, which may be round.
    pub(super) fn between(low: (f64, bool), high: (f64, bool)) -> Self {
        Self { ends: [low.0, high.0], round: [low.1, high.1], part: [-1.0, 1.0], near: [None; 2] }
    }
    /// Both halves, knowing what was in the `middle`.
    pub(super) fn halves(self, middle: (f64, u64)) -> [Self; 2] {
        let [from, to] = self.part;
        let between = 0.5 * (from + to);
        let [low, high] = self.near;
        [
            Self { part: [from, between], near: [low, Some(middle)], ..self },
            Self { part: [between, to], near: [Some(middle), high], ..self },
        ]
    }
    /// The height at a place of a rule, and its change with that.
    #[inline]
    pub(super) fn height(&self, share: f64) -> [f64; 2] {
        let ([low, high], [from, to]) = (self.ends, self.part);
        let (middle, half, scale) = (0.5 * (low + high), 0.5 * (high - low), 0.5 * (to - from));
        let u = 0.5 * (from + to) + scale * share;
        match self.round {
            [false, false] => [middle + half * u, half * scale],
            [true, false] => [low + 0.5 * half * (1.0 + u) * (1.0 + u), half * (1.0 + u) * scale],
            [false, true] => [high - 0.5 * half * (1.0 - u) * (1.0 - u), half * (1.0 - u) * scale],
            [true, true] => {
                [middle + 0.5 * half * u * (3.0 - u * u), 1.5 * half * (1.0 - u) * (1.0 + u) * scale]
            }
        }
    }
    /// The place u of a height.
    pub(super) fn place(&self, h: f64) -> f64 {
        let [low, high] = self.ends;
        let half = 0.5 * (high - low);
        let u = match self.round {
            [false, false] => (h - 0.5 * (low + high)) / half,
            [true, false] => (2.0 * (h - low).max(0.0) / half).sqrt() - 1.0,
            [false, true] => 1.0 - (2.0 * (high - h).max(0.0) / half).sqrt(),
            // The cubic's root by three times the angle.
            [true, true] => 2.0 * (((h - 0.5 * (low + high)) / half).clamp(-1.0, 1.0).asin() / 3.0).sin(),
        };
        u.clamp(self.part[0], self.part[1])
    }
    /// Below and above a break, which is round itself where there are `arcs`; what was found next to it.
    pub(super) fn split(&self, at: f64, arcs: bool, [below, above]: [(f64, u64); 2]) -> [Self; 2] {
        let mut pieces = [*self; 2];
        if arcs {
            let [low, high] = self.limits();
            let kind = |i: usize| self.part[i].abs() == 1.0 && self.round[i];
            pieces = pieces.map(|piece| Self { part: [-1.0, 1.0], ..piece });
            (pieces[0].ends, pieces[0].round) = ([low, at], [kind(0), true]);
            (pieces[1].ends, pieces[1].round) = ([at, high], [true, kind(1)]);
        } else {
            let u = self.place(at);
            pieces[0].part[1] = u;
            pieces[1].part[0] = u;
        }
        pieces[0].near[1] = Some(below);
        pieces[1].near[0] = Some(above);
        pieces
    }
    pub(super) fn limits(&self) -> [f64; 2] {
        [-1.0, 1.0].map(|share| self.height(share)[0])
    }
}
