//! What lies behind one or two curved surfaces in a box.
mod breaks;
mod sums;
mod surface;

pub(crate) use sums::{Content, Sums};
pub(crate) use surface::holds;

use super::quadric::Quadric;
use breaks::{Breaks, SAME};
use interfaces::Vector;
use surface::{Surface, WHOLE, behind};

/// Gauss points and their weights: few where all is smooth.
const TWO: [[f64; 2]; 2] = [[-0.577_350_269_189_625_8, 1.0], [0.577_350_269_189_625_8, 1.0]];
const THREE: [[f64; 2]; 3] =
    [[0.0, 8.0 / 9.0], [-0.774_596_669_241_483_4, 5.0 / 9.0], [0.774_596_669_241_483_4, 5.0 / 9.0]];
const FOUR: [[f64; 2]; 4] = [
    [-0.861_136_311_594_052_6, 0.347_854_845_137_453_9],
    [-0.339_981_043_584_856_3, 0.652_145_154_862_546_1],
    [0.339_981_043_584_856_3, 0.652_145_154_862_546_1],
    [0.861_136_311_594_052_6, 0.347_854_845_137_453_9],
];

/// What columns sum to, in u, v and t.
#[derive(Clone, Copy, Default)]
struct Raw {
    volume: f64,
    first: [f64; 3],
    /// uu, vv, tt, vt, ut, uv.
    second: [f64; 6],
    /// ∇f/|∂f/∂t|.
    flux: [[f64; 3]; 2],
    /// x × it, in six parts: y n_z, z n_y, z n_x, x n_z, x n_y, y n_x.
    turn: [[f64; 6]; 2],
}

/// A box with surfaces in it.
struct Box {
    surfaces: [Surface; 2],
    present: [bool; 2],
    monotone: bool,
    /// What changes its sign where columns change in kind: the first of them, in number.
    kinks: [[f64; 6]; 7],
    n: usize,
    axes: [usize; 3],
    moments: bool,
}

/// The part of a box, of half-widths `half` around `centre`, that is behind all `surfaces`. Columns along one axis, from
/// surface to surface, are summed over Gauss points of lines that are broken where the columns change in kind: `panels` times
/// four lines, if they do.
pub(crate) fn content(
    surfaces: [Option<&Quadric>; 2],
    centre: Vector,
    half: Vector,
    panels: u32,
    moments: bool,
) -> Content {
    // Those that the whole box is behind do not matter.
    let surfaces = surfaces.map(|q| q.filter(|q| q.c + q.reach() > 0.0));
    // Columns that all surfaces cross steeply and without a bend.
    let mut steepness = Vector::repeat(f64::INFINITY);
    for q in surfaces.iter().flatten() {
        let norm = q.g.norm().max(f64::MIN_POSITIVE);
        for a in 0..3 {
            let bend = q.h[a].abs() + q.m[(a + 1) % 3].abs() + q.m[(a + 2) % 3].abs();
            steepness[a] = steepness[a].min((q.g[a].abs() - bend) / norm);
        }
    }
    let k = steepness.imax();
    let (p, q) = ((k + 1) % 3, (k + 2) % 3);
    // Lines along the steeper of the other two meet the breaks less askew.
    let axes = if steepness[p] > steepness[q] { [q, p, k] } else { [p, q, k] };
    let seen = surfaces.map(|q| q.map_or_else(Surface::default, |q| Surface::new(q, axes)));
    let present = surfaces.map(|q| q.is_some());
    let monotone = (0..2).all(|i| !present[i] || seen[i].is_monotone());
    let mut this = Box { surfaces: seen, present, monotone, kinks: [[0.0; 6]; 7], n: 0, axes, moments };
    for i in (0..2).filter(|i| present[*i]) {
        let faces = [seen[i].face(-1.0), seen[i].face(1.0), seen[i].discriminant()];
        for kink in &faces[..if monotone { 2 } else { 3 }] {
            this.note(kink);
        }
    }
    let mut raw = Raw::default();
    let ragged = this.n > 0 || (present[0] && present[1]) || !monotone;
    if ragged {
        let (mut tips, mut breaks) = (Breaks::new(), Breaks::new());
        if monotone && present[0] && present[1] {
            let meet = this.meet();
            this.note(&meet);
        }
        for kink in &this.kinks[..this.n] {
            tips.tips(kink);
            breaks.exits(kink);
        }
        for u in &tips.at[1..tips.n - 1] {
            breaks.push(*u);
        }
        let panels = if monotone { panels } else { 2 * panels };
        for [low, high] in breaks.pieces(panels) {
            let is_tip = |end: f64| tips.at[1..tips.n - 1].iter().any(|u| (u - end).abs() <= SAME);
            let ends = [is_tip(low), is_tip(high)];
            let points: &[[f64; 2]] = if high - low > 1.5 { &FOUR } else { &THREE };
            for [s, weight] in points {
                // Towards tips what is on the lines grows like the root of the distance.
                let (share, rate) = match ends {
                    [false, false] => (0.5 * (1.0 + s), 0.5),
                    [true, false] => (0.25 * (1.0 + s) * (1.0 + s), 0.5 * (1.0 + s)),
                    [false, true] => (1.0 - 0.25 * (1.0 - s) * (1.0 - s), 0.5 * (1.0 - s)),
                    [true, true] => (0.5 + 0.25 * s * (3.0 - s * s), 0.75 * (1.0 - s * s)),
                };
                this.line(low + (high - low) * share, (high - low) * rate * weight, &mut raw);
            }
        }
    } else {
        for [u, weight] in TWO {
            for [v, w] in TWO {
                this.simple(u, v, weight * w, &mut raw);
            }
        }
    }
    let ragged = match (ragged, monotone) {
        (false, _) => 0.0,
        (true, true) => 1.0,
        (true, false) => 10.0,
    };
    this.finish(&raw, centre, half, ragged)
}

impl Box {
    /// Adds a kink, if it is one: a polynomial that may change its sign.
    fn note(&mut self, kink: &[f64; 6]) {
        if kink[0].abs() < kink[1..].iter().map(|c| c.abs()).sum() {
            self.kinks[self.n] = *kink;
            self.n += 1;
        }
    }

    /// One surface's f on the other one, which monotone columns cross more steeply, as a polynomial.
    fn meet(&self) -> [f64; 6] {
        const FAR: f64 = 0.8;
        let [p, q] = &self.surfaces;
        let (p, q) = if p.flatness() > q.flatness() { (q, p) } else { (p, q) };
        let gap = |u: f64, v: f64| {
            let (u, v) = (FAR * u, FAR * v);
            let t = q.root(u, v).clamp(-2.0, 2.0);
            let [b, c] = p.at(u, v);
            (p.a * t + b) * t + c
        };
        let here = gap(0.0, 0.0);
        let [e, w, n, s] = [gap(1.0, 0.0), gap(-1.0, 0.0), gap(0.0, 1.0), gap(0.0, -1.0)];
        let mixed = gap(1.0, 1.0) + gap(-1.0, -1.0) - gap(1.0, -1.0) - gap(-1.0, 1.0);
        let square = FAR * FAR;
        [
            here,
            0.5 * (e - w) / FAR,
            0.5 * (n - s) / FAR,
            (0.5 * (e + w) - here) / square,
            (0.5 * (n + s) - here) / square,
            0.25 * mixed / square,
        ]
    }

    /// Adds the columns along one line.
    fn line(&self, u: f64, weight: f64, out: &mut Raw) {
        let mut breaks = Breaks::new();
        for c in &self.kinks[..self.n] {
            breaks.roots(c[4], c[2] + c[5] * u, c[0] + u * (c[1] + c[3] * u));
        }
        for [low, high] in breaks.pieces(1) {
            let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
            // Nothing on one column, nothing on all of the piece.
            if self.monotone {
                TWO.iter().all(|[v, w]| self.simple(u, middle + half * v, weight * half * w, out));
            } else {
                THREE.iter().all(|[v, w]| self.column(u, middle + half * v, weight * half * w, out));
            }
        }
    }

    /// Adds one column along which every surface is met at most once; is anything on it?
    #[inline(always)]
    fn simple(&self, u: f64, v: f64, weight: f64, out: &mut Raw) -> bool {
        let (mut span, mut owner) = ([-1.0, 1.0], [0, 0]);
        if self.present[0] {
            span = self.surfaces[0].span(u, v);
            owner = [u32::from(span[0] > -1.0), u32::from(span[1] < 1.0)];
        }
        if self.present[1] {
            let [low, high] = self.surfaces[1].span(u, v);
            if low > span[0] {
                (span[0], owner[0]) = (low, 2);
            }
            if high < span[1] {
                (span[1], owner[1]) = (high, 2);
            }
        }
        let some = span[0] < span[1];
        if some {
            self.add(u, v, weight, span, owner, out);
        }
        some
    }

    /// The same for any surfaces.
    fn column(&self, u: f64, v: f64, weight: f64, out: &mut Raw) -> bool {
        let mut some = false;
        let spans = [0, 1].map(|i| {
            let [b, c] = self.surfaces[i].at(u, v);
            if self.present[i] { behind(self.surfaces[i].a, b, c) } else { WHOLE }
        });
        for p in &spans[0].span[..spans[0].n] {
            for q in &spans[1].span[..spans[1].n] {
                let span = [p[0].max(q[0]), p[1].min(q[1])];
                if span[0] >= span[1] {
                    continue;
                }
                let end = |at: f64, first: f64| match () {
                    _ if at.abs() >= 1.0 => 0,
                    _ if first == at => 1,
                    _ => 2,
                };
                let owner = [end(span[0], p[0]), end(span[1], p[1])];
                self.add(u, v, weight, span, owner, out);
                some = true;
            }
        }
        some
    }

    /// Adds a span of a column; an end's `owner` is 0 for a side of the box, else the number of the surface and one.
    #[inline(always)]
    fn add(&self, u: f64, v: f64, weight: f64, span: [f64; 2], owner: [u32; 2], out: &mut Raw) {
        let length = weight * (span[1] - span[0]);
        let middle = 0.5 * (span[0] + span[1]);
        out.volume += length;
        out.first[0] += length * u;
        out.first[1] += length * v;
        out.first[2] += length * middle;
        if self.moments {
            let tt = middle * middle + (span[1] - span[0]).powi(2) / 12.0;
            let products = [u * u, v * v, tt, v * middle, u * middle, u * v];
            for (sum, product) in out.second.iter_mut().zip(products) {
                *sum += length * product;
            }
        }
        for end in 0..2 {
            if owner[end] == 0 {
                continue;
            }
            let (body, t) = (owner[end] as usize - 1, span[end]);
            let [su, sv, st] = self.surfaces[body].slope(u, v, t);
            // Surfaces along the columns are met by few of them, with large weights.
            let along = st.abs().max(1e-3 * (su.abs() + sv.abs())).max(f64::MIN_POSITIVE);
            let scale = weight / along;
            let [nu, nv, nt] = [scale * su, scale * sv, weight.copysign(st)];
            let flux = &mut out.flux[body];
            flux[0] += nu;
            flux[1] += nv;
            flux[2] += nt;
            let turn = &mut out.turn[body];
            turn[0] += v * nt;
            turn[1] += t * nv;
            turn[2] += t * nu;
            turn[3] += u * nt;
            turn[4] += u * nv;
            turn[5] += v * nu;
        }
    }

    /// The sums in the frame of the box.
    fn finish(&self, raw: &Raw, centre: Vector, half: Vector, ragged: f64) -> Content {
        let product = half.product();
        let [u, v, t] = self.axes;
        let h = [half[u], half[v], half[t]];
        let place = |x: [f64; 3]| {
            let mut out = Vector::zeros();
            (out[u], out[v], out[t]) = (x[0], x[1], x[2]);
            out
        };
        let mut out = Content { ragged, ..Content::default() };
        out.sums.volume = product * raw.volume;
        let first = place([0, 1, 2].map(|a| product * h[a] * raw.first[a]));
        out.sums.first = out.sums.volume * centre + first;
        for i in 0..2 {
            // n dA = ∇f/|∂f/∂t| dA' with dA' the area of the cross-section, in lengths.
            let per = [0, 1, 2].map(|a| product / h[a]);
            let flux = place([0, 1, 2].map(|a| per[a] * raw.flux[i][a]));
            let w = &raw.turn[i];
            // In odd orders of the axes, products turn the other way.
            let sense = if (u + 1) % 3 == v { 1.0 } else { -1.0 };
            let turn = sense
                * place([
                    h[1] * per[2] * w[0] - h[2] * per[1] * w[1],
                    h[2] * per[0] * w[2] - h[0] * per[2] * w[3],
                    h[0] * per[1] * w[4] - h[1] * per[0] * w[5],
                ]);
            out.sums.flux[i] = flux;
            out.sums.turn[i] = turn + centre.cross(&flux);
            out.sums.area[i] = flux.norm();
        }
        if self.moments {
            let w = &raw.second;
            let squares = place([0, 1, 2].map(|a| h[a] * h[a] * w[a]));
            let products = place([h[1] * h[2] * w[3], h[0] * h[2] * w[4], h[0] * h[1] * w[5]]);
            // About the origin: ∫(c + x)(c + x)ᵀ.
            let (c, f, all) = (centre, first, out.sums.volume);
            for a in 0..3 {
                let (p, q) = ((a + 1) % 3, (a + 2) % 3);
                out.second[a] = product * squares[a] + 2.0 * c[a] * f[a] + all * c[a] * c[a];
                out.second[3 + a] = product * products[a] + c[p] * f[q] + c[q] * f[p] + all * c[p] * c[q];
            }
        }
        out
    }
}
