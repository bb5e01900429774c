//! Sums over a square.
use super::super::columns::Sums;
use super::ray::{Caster, Ray};
use interfaces::Vector;

/// Sums over a part of the plane, and of both bodies' surfaces ∫x n_x dA and ∫y n_y dA.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Integrals {
    pub(super) sums: Sums,
    across: [f64; 2],
}

impl Integrals {
    /// Do the surfaces of both bodies enclose the region? ∫n dA is zero to a `share` of either's, and ∮(x − c) n_x dA and
    /// ∮(y − c) n_y dA are the volume to `apart` of it.
    pub(super) fn is_closed(&self, share: f64, apart: f64) -> bool {
        let Sums { volume, first, flux: [a, b], .. } = self.sums;
        let c = first / volume;
        let across = |axis: usize| self.across[axis] - c[axis] * (a + b)[axis] - volume;
        volume > 0.0
            && (a + b).norm() <= share * a.norm().max(b.norm())
            && (0..2).all(|axis| across(axis).abs() <= apart * volume)
    }
    pub(super) fn add_share(&mut self, o: &Self, share: f64) {
        self.sums.add_share(&o.sums, share);
        for axis in 0..2 {
            self.across[axis] += share * o.across[axis];
        }
    }
    /// Per area of the plane at `x`, for a span of `length` around `middle`, with the surfaces of a ray.
    fn at(x: [f64; 2], length: f64, middle: f64, ray: &Ray) -> Self {
        let first = length * Vector::new(x[0], x[1], middle);
        let (flux, turn, area) = (ray.flux, ray.turn, ray.flux.map(|n| n.norm()));
        let across = [0, 1].map(|axis| x[axis] * (flux[0] + flux[1])[axis]);
        Self { sums: Sums { volume: length, first, flux, turn, area }, across }
    }
    /// A piece of the region's side along the rays, of outward normal and area `n`, around `x`.
    fn add_side(&mut self, body: usize, x: Vector, n: Vector) {
        self.sums.flux[body] += n;
        self.sums.turn[body] += x.cross(&n);
        self.sums.area[body] += n.norm();
        for axis in 0..2 {
            self.across[axis] += x[axis] * n[axis];
        }
    }
}

/// Squares between rays that miss the region are looked into this often.
const DOUBTED: u16 = 2;

/// A square of the plane, and what stands on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Square {
    pub(super) at: [u16; 2],
    pub(super) level: u16,
    /// Those of the corners, counter-clockwise from the lowest, and of the middle.
    pub(super) rays: [u32; 5],
    pub(super) integrals: Integrals,
    /// Do some rays miss the region?
    pub(super) is_rim: bool,
    /// May something be between rays that miss the region?
    pub(super) is_doubtful: bool,
    /// How far the middle is from the mean of the corners, times the area.
    pub(super) bend: f64,
    /// Of the volume.
    pub(super) error: f64,
}

impl Square {
    pub(super) fn new<'r>(
        caster: &Caster<'_>,
        at: [u16; 2],
        level: u16,
        rays: [u32; 5],
        ray: impl Fn(u32) -> &'r Ray,
    ) -> Self {
        let r = rays.map(ray);
        let [low, high] = caster.corners(at, level);
        let size = [high[0] - low[0], high[1] - low[1]];
        let area = size[0] * size[1];
        let mut this = Self {
            at,
            level,
            rays,
            integrals: Integrals::default(),
            is_rim: true,
            is_doubtful: false,
            bend: 0.0,
            error: 0.0,
        };
        let n = r.iter().filter(|r| r.meets()).count();
        if n == 0 {
            // Distances change by no more than the way gone.
            this.is_doubtful = level < DOUBTED && r[4].least < 0.5 * size[0].hypot(size[1]);
            return this;
        }
        let mean = 0.25 * r[..4].iter().map(|r| r.length()).sum::<f64>();
        this.bend = (r[4].length() - mean).abs() * area;
        let places = r.map(|r| caster.place(r.at));
        if n == 5 {
            this.is_rim = false;
            for i in 0..5 {
                let value = Integrals::at(places[i], r[i].length(), r[i].middle, r[i]);
                let weight = if i == 4 { 2.0 / 3.0 } else { 1.0 / 12.0 };
                this.integrals.add_share(&value, weight * area);
            }
        } else {
            this.bend = this.bend.max(0.1 * area * r.iter().map(|r| r.length()).fold(0.0, f64::max));
            for i in 0..4 {
                let j = (i + 1) % 4;
                triangle([r[i], r[j], r[4]], [places[i], places[j], places[4]], &mut this.integrals);
            }
        }
        this
    }
}

/// The part of a triangle, counter-clockwise, on which rays meet the region.
fn triangle(rays: [&Ray; 3], places: [[f64; 2]; 3], out: &mut Integrals) {
    // Corners of that part, of which rays that meet nothing have none.
    let mut corners = [([0.0; 2], Integrals::default()); 4];
    let mut n = 0;
    // Where it ends: place, length and middle there, and who ends.
    let mut ends = [([0.0; 2], 0.0, 0.0, 0); 2];
    let mut n_ends = 0;
    for i in 0..3 {
        let j = (i + 1) % 3;
        let (p, q) = (rays[i], rays[j]);
        if p.meets() {
            corners[n] = (places[i], Integrals::at(places[i], p.length(), p.middle, p));
            n += 1;
        }
        if p.meets() != q.meets() {
            let share = p.least / (p.least - q.least);
            let x = [0, 1].map(|a| places[i][a] + share * (places[j][a] - places[i][a]));
            let (met, from, off) = if p.meets() { (p, places[i], q) } else { (q, places[j], p) };
            let away = met.slope[0] * (x[0] - from[0]) + met.slope[1] * (x[1] - from[1]);
            let length = (met.length() + away).clamp(0.0, 2.0 * met.length());
            let part = length / met.length().max(f64::MIN_POSITIVE);
            let middle = part.min(1.0) * met.middle + (1.0 - part.min(1.0)) * off.middle;
            corners[n] = (x, Integrals::at(x, length, middle, met));
            n += 1;
            ends[n_ends] = (x, length, middle, off.absent);
            n_ends += 1;
        }
    }
    for i in 1..n.saturating_sub(1) {
        let [a, b, c] = [corners[0].0, corners[i].0, corners[i + 1].0];
        let area = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
        for k in [0, i, i + 1] {
            out.add_share(&corners[k].1, area / 3.0);
        }
    }
    if n_ends == 2 {
        let [(a, l, s, body), (b, m, t, _)] = ends;
        // Counter-clockwise around the part, it is on the left from where it is left to where it is entered again.
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let sense = if rays[0].meets() { 1.0 } else { -1.0 };
        let high = 0.5 * (l + m);
        let n = sense * high * Vector::new(dy, -dx, 0.0);
        let x = Vector::new(0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (s + t));
        out.add_side(body, x, n);
    }
}
