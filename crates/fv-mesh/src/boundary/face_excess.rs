//! Excess of the velocity through faces of given pressure over that inside, and its equation along the side.
use super::Lines;
use crate::grid::GHOSTS;

/// Excess d = u_b − u_i of the velocity u_b through the faces of a side over the velocity u_i one cell inside, and the terms of its
/// equation. All lists have one entry per line of the side's axis.
#[derive(Clone, Debug, Default)]
pub(super) struct FaceExcess {
    /// d \[m/s\].
    pub(super) value: Vec<f64>,
    /// Coefficients along either lateral axis.
    pub(super) lateral: [Lateral; 2],
    /// 1/Δt, or what the relaxation of a steady iteration adds \[1/s\].
    pub(super) inertia: Vec<f64>,
    /// Rate at which d decays along the axis \[1/s\].
    pub(super) decay: Vec<f64>,
    /// Right-hand side, then the change of d; memory of the elimination.
    pub(super) change: Vec<f64>,
    upper: Vec<f64>,
    corner: Vec<f64>,
}

/// Coefficients along one lateral axis \[1/s\].
#[derive(Clone, Debug, Default)]
pub(super) struct Lateral {
    /// Viscous ones of the neighbours below and above, and of a lateral side at which the velocity is given, so that d = 0 there.
    pub(super) viscous: [Vec<f64>; 3],
    /// The same with upwind convection.
    pub(super) total: [Vec<f64>; 3],
}

impl Lateral {
    fn new(n: usize) -> Self {
        let lists = || std::array::from_fn(|_| vec![0.0; n]);
        Self { viscous: lists(), total: lists() }
    }
}

impl FaceExcess {
    /// No excess on `n` lines.
    pub(super) fn new(n: usize) -> Self {
        let list = || vec![0.0; n];
        Self {
            value: list(),
            lateral: std::array::from_fn(|_| Lateral::new(n)),
            inertia: list(),
            decay: list(),
            change: list(),
            upper: list(),
            corner: list(),
        }
    }

    /// Rate at which d of the face at the end of line `l` responds to a pressure there, neighbours alike \[1/s\].
    pub(super) fn rate(&self, l: usize) -> f64 {
        self.inertia[l] + self.decay[l]
    }

    /// Acceleration of line `l` by its neighbours \[m/s²\].
    pub(super) fn acceleration(&self, lines: &Lines, l: usize, periods: [usize; 2]) -> f64 {
        let mut sum = 0.0;
        for (t, Lateral { total: [low, up, held], .. }) in self.lateral.iter().enumerate() {
            for (k, list) in [low, up].into_iter().enumerate().filter(|(_, list)| list[l] > 0.0) {
                sum += list[l] * (self.value[neighbour(lines, [t, k], l, periods[t])] - self.value[l]);
            }
            sum -= held[l] * self.value[l];
        }
        sum
    }

    /// Solves (rate + coefficients along lateral axis `t`) x = `change` for every row of lines, into `change`: by elimination, with
    /// the formula of Sherman and Morrison across a period. Lines that are not `free` keep zero.
    pub(super) fn solve_along(
        &mut self,
        lines: &Lines,
        t: usize,
        period: usize,
        free: &impl Fn(usize) -> bool,
    ) {
        let (step, n) = if t == 0 { (1, lines.count[0]) } else { (lines.count[0], lines.count[1]) };
        let (from, to) = if period > 1 { (GHOSTS, GHOSTS + period) } else { (0, n) };
        for row in (0..lines.len()).filter(|&l| lines.place(l)[t] == 0) {
            let line = |j: usize| row + j * step;
            // Neighbour below, above, and the diagonal term.
            let terms = |this: &Self, l: usize| {
                let [low, up, held] = this.lateral[t].total.each_ref().map(|list| list[l]);
                let (low, up) = if period == 1 { (0.0, 0.0) } else { (low, up) };
                let centre = this.rate(l) + low + up + held;
                if free(l) && centre > 0.0 { [low, up, centre] } else { [0.0, 0.0, 1.0] }
            };
            let (first, last) = (line(from), line(to - 1));
            let cyclic = period > 1;
            let ([low, _, first_centre], [_, up, _]) = (terms(self, first), terms(self, last));
            for j in from..to {
                let l = line(j);
                let [low_l, up_l, mut centre] = terms(self, l);
                if !free(l) {
                    self.change[l] = 0.0;
                }
                let mut corner = 0.0;
                if cyclic && j == from {
                    centre += first_centre;
                    corner = -first_centre;
                }
                if cyclic && j + 1 == to {
                    centre += low * up / first_centre;
                    corner -= up;
                }
                let before = (j > from).then(|| line(j - 1));
                let [upper, change, last_corner] =
                    before.map_or([0.0; 3], |b| [self.upper[b], self.change[b], self.corner[b]]);
                let pivot = centre - low_l * upper;
                self.upper[l] = up_l / pivot;
                self.change[l] = (self.change[l] + low_l * change) / pivot;
                self.corner[l] = (corner + low_l * last_corner) / pivot;
            }
            for j in (from..to - 1).rev() {
                let (l, next) = (line(j), line(j + 1));
                self.change[l] += self.upper[l] * self.change[next];
                self.corner[l] += self.upper[l] * self.corner[next];
            }
            if cyclic {
                let weight = low / first_centre;
                let part = (self.change[first] + weight * self.change[last])
                    / (1.0 + self.corner[first] + weight * self.corner[last]);
                for l in (from..to).map(line) {
                    self.change[l] -= part * self.corner[l];
                }
            }
        }
    }
}

/// Number of the neighbour of line `l` below (k = 0) or above (k = 1) along lateral axis `t`.
fn neighbour(lines: &Lines, [t, k]: [usize; 2], l: usize, period: usize) -> usize {
    let step = if t == 0 { 1 } else { lines.count[0] };
    let at = lines.place(l)[t];
    match (k, period) {
        (0, n) if n > 0 && at == GHOSTS => l + (n - 1) * step,
        (1, n) if n > 0 && at + 1 == GHOSTS + n => l - (n - 1) * step,
        (0, _) => l - step,
        _ => l + step,
    }
}
