//! Where columns change in kind.

/// Where columns change in kind along a line, its ends among them.
#[derive(Clone, Copy)]
pub(super) struct Breaks {
    pub(super) at: [f64; 32],
    pub(super) n: usize,
}

/// Breaks of lines (from −1 to 1) that are nearer count as one.
pub(super) const SAME: f64 = 1e-3;

impl Breaks {
    pub(super) fn new() -> Self {
        let mut at = [-1.0; 32];
        at[1] = 1.0;
        Self { at, n: 2 }
    }
    pub(super) fn push(&mut self, v: f64) {
        if v > -1.0 && v < 1.0 && self.n < self.at.len() {
            let mut i = self.n;
            while self.at[i - 1] > v {
                self.at[i] = self.at[i - 1];
                i -= 1;
            }
            self.at[i] = v;
            self.n += 1;
        }
    }
    /// The roots of a·v² + b·v + c.
    #[inline]
    pub(super) fn roots(&mut self, a: f64, b: f64, c: f64) {
        let square = b * b - 4.0 * a * c;
        if square > 0.0 {
            let far = -0.5 * (b + square.sqrt().copysign(b));
            self.push(far / a);
            self.push(c / far);
        }
    }
    /// Where a line of the other direction ceases to meet the curve on which a polynomial is zero, in the box.
    pub(super) fn tips(&mut self, c: &[f64; 6]) {
        let (a, b) = (c[5] * c[5] - 4.0 * c[3] * c[4], 2.0 * c[2] * c[5] - 4.0 * c[1] * c[4]);
        let mut tips = Self::new();
        tips.roots(a, b, c[2] * c[2] - 4.0 * c[0] * c[4]);
        for u in &tips.at[1..tips.n - 1] {
            // A little beyond the sides does not harm.
            if (c[2] + c[5] * u).abs() <= 1.05 * (2.0 * c[4]).abs() {
                self.push(*u);
            }
        }
    }
    /// Where that curve leaves the box at the ends of such lines.
    pub(super) fn exits(&mut self, c: &[f64; 6]) {
        for v in [-1.0, 1.0] {
            self.roots(c[3], c[1] + c[5] * v, c[0] + v * (c[2] + c[4] * v));
        }
    }
    /// What is between them, in so many pieces each. Of breaks that nearly coincide one counts: what grows from them is small.
    pub(super) fn pieces(&mut self, each: u32) -> impl Iterator<Item = [f64; 2]> + '_ {
        let mut kept = 1;
        for i in 1..self.n {
            if self.at[i] - self.at[kept - 1] > SAME {
                self.at[kept] = self.at[i];
                kept += 1;
            }
        }
        self.at[kept - 1] = 1.0;
        self.n = kept;
        self.at[..kept].windows(2).flat_map(move |ends| {
            let size = (ends[1] - ends[0]) / f64::from(each);
            (0..each).map(move |i| [ends[0] + size * f64::from(i), ends[0] + size * f64::from(i + 1)])
        })
    }
}
