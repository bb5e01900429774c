//! Regions like a lens: between a piece of the one surface and a piece of the other that meet at a rim.
//!
//! Half-planes through an axis across the contact cut the region; in each of them the rim is found and the surfaces on a few
//! lines between the axis and the rim. Volume and centroid are sums over these lines. The gradient of the volume and the moment
//! follow from the rim alone, S = ½∮x × dx and −½∮|x|² dx (Feng 2021, Comput. Methods Appl. Mech. Eng. 373, 113495). The
//! half-planes are doubled until the sums stay: for smooth surfaces the error falls faster than any power of their number.
mod azimuth;
mod meridian;
mod rim;

use super::around::{Oriented, tangents};
use super::deepest::{Deepest, Search};
use crate::Overlap;
use azimuth::eighths;
use interfaces::{Point, Vector};
use meridian::{BENT, FEWEST, Lines, MOST, Meridian, Poles, Wedge};
use nalgebra::{Matrix2, Matrix3, SymmetricEigen};
use rim::{Rim, Sight};

/// Half-planes at first.
const FIRST: usize = 8;
/// Where a surface is farther out than this, as a share of where it was guessed, few lines may agree by chance.
const ODD: f64 = 1.3;
/// And at most.
const FINEST: usize = 128;

/// What was found of a region, in a frame around its centre.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lens {
    /// A box around it.
    pub(crate) root: Oriented,
    volume: f64,
    /// The middle of the axis.
    pub(crate) centre: Vector,
    /// From there, along the box's axes.
    centroid: Vector,
    /// S and the moment about the centroid, along the box's axes.
    gradient: Vector,
    moment: Vector,
    shape: Outline,
}

/// The rim and the poles.
#[derive(Clone, Copy, Debug)]
struct Outline {
    wide: [f64; 2],
    /// Roots of q, and z, of the first half-planes.
    rim: [[f64; 2]; FIRST],
    poles: [f64; 2],
    /// By so much a surface may be farther out than the paraboloid through pole and rim.
    beyond: f64,
}

impl Lens {
    /// How far a place is from it, negative within, about: the surfaces are taken for paraboloids.
    pub(crate) fn outside(&self, x: Vector) -> f64 {
        let x = self.root.axes.transpose() * (x - self.centre);
        let Outline { wide, rim, poles, beyond } = &self.shape;
        let (u, v) = (x.x / wide[0], x.y / wide[1]);
        let (k, share) = eighths(u, v);
        let [r, z] = [0, 1].map(|i| (1.0 - share) * rim[k][i] + share * rim[(k + 1) % FIRST][i]);
        let out = u.hypot(v) / r;
        let s = (out * out).min(1.0);
        let height = |pole: f64| pole * (1.0 - s) + z * s;
        let above = (x.z - height(poles[0])).max(height(poles[1]) - x.z) - beyond;
        if out > 1.0 { above.max(x.x.hypot(x.y) * (1.0 - 1.0 / out) - beyond) } else { above }
    }
    /// Do they share nothing, as far as the ends, the middles and the rims of both tell?
    pub(crate) fn is_apart_from(&self, o: &Self) -> bool {
        let clear = |a: &Self, b: &Self| a.places().all(|x| b.outside(x) > 0.0);
        clear(self, o) && clear(o, self)
    }
    /// Its middle, its poles and places of the rim, and between.
    pub(crate) fn places(&self) -> impl Iterator<Item = Vector> + '_ {
        let Outline { wide, rim, poles, .. } = &self.shape;
        let around = rim.iter().enumerate().map(move |(k, [r, z])| {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / FIRST as f64).sin_cos();
            Vector::new(r * wide[0] * cos, r * wide[1] * sin, *z)
        });
        let ends = poles.map(|z| Vector::new(0.0, 0.0, z));
        let all = around.chain(ends).flat_map(|x| [x, 0.5 * x]).chain([Vector::zeros()]);
        all.map(move |x| self.centre + self.root.axes * x)
    }
    /// As a frame sees it in which this one's axes are the columns of `axes`.
    pub(crate) fn turn(&mut self, axes: &Matrix3<f64>) {
        self.centre = axes * self.centre;
        self.root.turn(axes);
    }
    /// As the world sees it, whose place `origin` is that of the search's frame.
    pub(crate) fn overlap(&self, origin: Point, between: Vector) -> Overlap {
        let gradient = self.root.axes * self.gradient;
        Overlap {
            volume: self.volume,
            centroid: origin + (self.centre + self.root.axes * self.centroid),
            normal: (-gradient).try_normalize(0.0).unwrap_or(between),
            gradient,
            moment: self.root.axes * self.moment,
            pivot: nalgebra::Matrix3::zeros(),
        }
    }
}

/// Measures lenses and keeps the memory of it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lenses {
    /// By azimuth, in steps of 2π/[`FINEST`].
    meridians: Vec<Meridian>,
    /// Cosine and sine of these, and ½ cot of half of them.
    azimuths: Vec<[f64; 2]>,
    cot: Vec<f64>,
}

/// The frame in which a lens is measured.
struct Frame<'a> {
    centre: Vector,
    axes: Matrix3<f64>,
    sight: Sight<'a>,
}

/// Sums over half-planes.
#[derive(Clone, Copy, Default)]
struct Totals {
    volume: f64,
    first: Vector,
}

impl Totals {
    fn add(&mut self, wedge: &Wedge, azimuth: [f64; 2]) {
        let [out, up] = wedge.first;
        self.volume += wedge.volume;
        self.first += Vector::new(out * azimuth[0], out * azimuth[1], up);
    }
}

impl Lenses {
    fn prepare(&mut self) {
        if self.azimuths.is_empty() {
            let angle = |i: usize| std::f64::consts::TAU * i as f64 / FINEST as f64;
            self.azimuths.extend((0..FINEST).map(|i| [angle(i).cos(), angle(i).sin()]));
            self.cot.extend((0..FINEST).map(|i| if i == 0 { 0.0 } else { 0.5 / (0.5 * angle(i)).tan() }));
            self.meridians.resize(FINEST, Meridian::default());
        }
    }

    /// The region around a deepest place, if it is a lens, to a relative error of its volume of about `tolerance`; its gradient's
    /// error is held to a few times this.
    pub(crate) fn measure(&mut self, search: &Search<'_>, deepest: &Deepest, tolerance: f64) -> Option<Lens> {
        self.prepare();
        let rough = self.rough(search, deepest)?;
        let (frame, mut poles, guesses) = self.framed(search, &rough, tolerance)?;
        let found = self.doubled(&frame, &poles, &guesses, tolerance);
        if found.is_some() || poles.lines == Lines::Columns {
            return found;
        }
        poles.lines = Lines::Columns;
        self.doubled(&frame, &poles, &guesses, tolerance)
    }

    /// The rim in eight half-planes, roughly, as places in the search's frame.
    fn rough(&mut self, search: &Search<'_>, deepest: &Deepest) -> Option<[Vector; FIRST]> {
        let axes = across(deepest.across);
        let wide = (search.size() * -deepest.level).sqrt().min(search.size());
        let bodies = search.bodies.map(|b| b.within(&axes, deepest.at));
        let mut sight = Sight { bodies, wide: [wide; 2], thick: -deepest.level };
        let d = deepest.distances;
        let poles = [sight.pole(0, d[0], 0.05)?, sight.pole(1, d[1], 0.05)?];
        if poles[0][0] <= 0.0 || poles[1][0] >= 0.0 {
            return None;
        }
        sight.thick = 0.5 * (poles[0][0] - poles[1][0]);
        let mut rim = first_rim(&sight, d, poles)?;
        let steep = poles.map(|pole| pole[1]);
        let mut out = [Vector::zeros(); FIRST];
        for (k, out) in out.iter_mut().enumerate() {
            let azimuth = self.azimuths[k * (FINEST / FIRST)];
            rim = sight.rim(azimuth, rim, 0.1, steep)?;
            *out = deepest.at + axes * sight.place(azimuth, rim.q.sqrt(), rim.z);
        }
        Some(out)
    }

    /// A frame along that rim, the poles in it and guesses of the rim.
    fn framed<'a>(
        &self,
        search: &Search<'a>,
        rough: &[Vector; FIRST],
        tolerance: f64,
    ) -> Option<(Frame<'a>, Poles, [Rim; FIRST])> {
        let middle = rough.iter().sum::<Vector>() / FIRST as f64;
        let area: Vector =
            (0..FIRST).map(|k| 0.5 * (rough[k] - middle).cross(&(rough[(k + 1) % FIRST] - middle))).sum();
        let axes = across(area.try_normalize(0.0)?);
        let local = |x: &Vector| axes.transpose() * (x - middle);
        let mut q = Matrix2::zeros();
        for x in rough {
            let x = local(x);
            q += x.xy() * x.xy().transpose() * (2.0 / FIRST as f64);
        }
        let eigen = SymmetricEigen::new(q);
        let wide = [0, 1].map(|i| eigen.eigenvalues[i].max(0.0).sqrt());
        let u = axes * eigen.eigenvectors.column(0).push(0.0);
        let n = axes.column(2).into_owned();
        let axes = Matrix3::from_columns(&[u, n.cross(&u), n]);
        let seen = |centre: Vector| search.bodies.map(|b| b.within(&axes, centre));
        let mut sight = Sight { bodies: seen(middle), wide, thick: wide[0].min(wide[1]) };
        let accuracy = 0.3 * tolerance;
        let mut poles = Poles { lines: Lines::Rays, z: [0.0; 2], slope: [0.0; 2], accuracy };
        let d = [0, 1].map(|i| sight.distance(i, Vector::zeros()));
        for i in 0..2 {
            [poles.z[i], _] = sight.pole(i, d[i], accuracy)?;
        }
        let centre = middle + n * poles.middle();
        sight.bodies = seen(centre);
        sight.thick = 0.5 * (poles.z[0] - poles.z[1]);
        if sight.thick <= 0.0 || wide.iter().any(|w| *w <= 0.0) {
            return None;
        }
        poles.z = [sight.thick, -sight.thick];
        let d = [0, 1].map(|i| sight.distance(i, Vector::zeros()));
        poles.slope = [0, 1].map(|i| -d[i] / poles.z[i]);
        if d[0] >= 0.0 || d[1] >= 0.0 {
            return None;
        }
        // What is nearest in angle tells where the rim is about.
        let mut bent = 0.0_f64;
        let places = rough.map(|x| axes.transpose() * (x - centre));
        let guesses = std::array::from_fn(|k| {
            let [cos, sin] = self.azimuths[k * (FINEST / FIRST)];
            let along = |x: &Vector| {
                let (u, v) = (x.x / wide[0], x.y / wide[1]);
                (u * cos + v * sin) / u.hypot(v)
            };
            let by_angle = |a: &&Vector, b: &&Vector| along(a).total_cmp(&along(b));
            let x = places.iter().max_by(by_angle).copied().unwrap_or_default();
            bent = bent.max(x.z.abs());
            let q = (x.x / wide[0]).powi(2) + (x.y / wide[1]).powi(2);
            let slope = [0, 1].map(|i| [-(d[i] + poles.slope[i] * x.z) / q, poles.slope[i]]);
            Rim { q, z: x.z, slope }
        });
        if bent > BENT * sight.thick {
            poles.lines = Lines::Columns;
        }
        Some((Frame { centre, axes, sight }, poles, guesses))
    }

    /// Doubles the half-planes until the sums stay.
    fn doubled(
        &mut self,
        frame: &Frame<'_>,
        poles: &Poles,
        guesses: &[Rim; FIRST],
        tolerance: f64,
    ) -> Option<Lens> {
        let sight = &frame.sight;
        // More lines in every other half-plane, so that what few of them miss shows.
        let few = FEWEST + usize::from(tolerance < 3e-4) + usize::from(tolerance < 3e-5);
        let mut totals = [Totals::default(); 2];
        let step = FINEST / FIRST;
        for k in 0..FIRST {
            let (at, odd) = (k * step, k % 2);
            let near = [k.checked_sub(1).map(|k| &self.meridians[k * step]), None];
            let azimuth = self.azimuths[at];
            let new = Meridian::new(sight, poles, azimuth, guesses[k], few + odd, near)?;
            totals[odd].add(&new.wedge(poles), azimuth);
            self.meridians[at] = new;
        }
        let mut n = FIRST;
        let [mut coarse, fine] = totals;
        let mut sums = Totals { volume: coarse.volume + fine.volume, first: coarse.first + fine.first };
        let mut rims = [self.around(frame, FIRST / 2), self.around(frame, FIRST)];
        // The last change, and by how much it was less than the one before.
        let (mut last, mut last_rate) = (None, 1.0);
        // Of the half-planes that came last, and of those before.
        let mut newest = [f64::NAN, 2.0 * fine.volume / FIRST as f64];
        let odd = (0..FIRST).any(|k| self.meridians[k * step].beyond() > ODD);
        loop {
            let per = std::f64::consts::TAU / n as f64 * sight.wide[0] * sight.wide[1];
            let volume = per * sums.volume;
            let change = [
                (2.0 * coarse.volume / sums.volume - 1.0).abs() / (0.5 * tolerance),
                (rims[0].0 - rims[1].0).norm() / rims[1].0.norm() / (5.0 * tolerance),
            ];
            let mut change = change[0].max(change[1]);
            if odd {
                // Each time with more lines.
                change = change.max((newest[0] / newest[1] - 1.0).abs() / (0.5 * tolerance));
            }
            let odd_at_first = odd && n == FIRST;
            // Errors fall by this much at every doubling; slowly where so many are needed, unless they have fallen fast twice.
            let fell = last.map_or(0.5, |last: f64| change / last);
            let least = if n <= 2 * FIRST {
                (3.0 * fell).clamp(0.15, 0.3)
            } else if fell.max(last_rate) < 0.3 {
                0.3
            } else {
                0.6
            };
            let rate = fell.clamp(least, 0.9);
            if !((change.is_finite() || odd_at_first) && volume > 0.0) {
                return None;
            }
            // Sums over few half-planes may agree by chance; smooth ones are far below the tolerance by then.
            let margin = if n == FIRST { 10.0 } else { 4.0 };
            if !odd_at_first && margin * change * rate / (1.0 - rate) <= 1.0 {
                let first = (per / volume) * sums.first;
                let centroid = Vector::new(first.x * sight.wide[0], first.y * sight.wide[1], first.z);
                return Some(self.lens(frame, poles, n, volume, centroid, rims[1]));
            }
            // As many again would not do.
            if n == FINEST || (2 * n == FINEST && change * fell > 0.5) {
                return None;
            }
            (last, last_rate) = (Some(change).filter(|c| c.is_finite()), fell);
            let stage = (n / FIRST).ilog2() as usize;
            let lines = (few + 1 + stage).min(MOST);
            coarse = sums;
            let step = FINEST / n;
            for k in 0..n {
                let at = k * step + step / 2;
                let near = [k * step, (k + 1) % n * step].map(|k| &self.meridians[k]);
                let (azimuth, rim) = (self.azimuths[at], near[0].rim.between(&near[1].rim));
                let new = Meridian::new(sight, poles, azimuth, rim, lines, near.map(Some))?;
                sums.add(&new.wedge(poles), azimuth);
                self.meridians[at] = new;
            }
            newest = [newest[1], (sums.volume - coarse.volume) / n as f64];
            n *= 2;
            rims = [rims[1], self.around(frame, n)];
        }
    }

    /// S = ½∮x × dx and −½∮|x|² dx of the rim through `n` half-planes, as if a trigonometric polynomial ran through them.
    fn around(&self, frame: &Frame<'_>, n: usize) -> (Vector, Vector) {
        let step = FINEST / n;
        let place = |k: usize| {
            let rim = &self.meridians[k * step].rim;
            frame.sight.place(self.azimuths[k * step], rim.q.sqrt(), rim.z)
        };
        let (mut area, mut moment) = (Vector::zeros(), Vector::zeros());
        let per = std::f64::consts::TAU / n as f64;
        let mut x = [Vector::zeros(); FINEST];
        x[..n].iter_mut().enumerate().for_each(|(k, x)| *x = place(k));
        for k in 0..n {
            // Weights of places as far ahead as behind differ by their sign; that of the opposite one is zero.
            let mut along = Vector::zeros();
            for other in 1..n / 2 {
                let sign = if other % 2 == 0 { -per } else { per };
                along += (sign * self.cot[other * step]) * (x[(k + other) % n] - x[(k + n - other) % n]);
            }
            area += 0.5 * x[k].cross(&along);
            moment -= 0.5 * x[k].norm_squared() * along;
        }
        (area, moment)
    }

    fn lens(
        &self,
        frame: &Frame<'_>,
        poles: &Poles,
        n: usize,
        volume: f64,
        centroid: Vector,
        (gradient, moment): (Vector, Vector),
    ) -> Lens {
        let (mut low, mut high) = (Vector::zeros(), Vector::zeros());
        let mut beyond = 1.0_f64;
        let mut rim = [[0.0; 2]; FIRST];
        for (k, meridian) in self.meridians.iter().step_by(FINEST / n).enumerate() {
            let (r, z) = (meridian.rim.q.sqrt(), meridian.rim.z);
            let x = frame.sight.place(self.azimuths[k * (FINEST / n)], r, z);
            (low, high) = (low.inf(&x), high.sup(&x));
            beyond = beyond.max(meridian.beyond());
            if k % (n / FIRST) == 0 {
                rim[k / (n / FIRST)] = [r, z];
            }
        }
        (low.z, high.z) = (low.z.min(poles.z[1]), high.z.max(poles.z[0]));
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low) * (1.05 * beyond));
        let root = Oriented { centre: frame.centre + frame.axes * middle, axes: frame.axes, half };
        let wide = frame.sight.wide;
        let out = (beyond - 1.0)
            * frame.sight.thick.max(if poles.lines == Lines::Rays { wide[0].max(wide[1]) } else { 0.0 });
        let shape = Outline { wide, rim, poles: poles.z, beyond: out };
        let moment = moment - centroid.cross(&gradient);
        Lens { root, centre: frame.centre, volume, centroid, gradient, moment, shape }
    }
}

/// A frame whose third axis is `n`.
fn across(n: Vector) -> Matrix3<f64> {
    let [u, v] = tangents(n);
    Matrix3::from_columns(&[u, v, n])
}

/// A guess of the rim in the first half-plane: where both distances vanish if they grow with the square of the distance from
/// the axis, from places farther out or in until they tell.
fn first_rim(sight: &Sight<'_>, d: [f64; 2], poles: [[f64; 2]; 2]) -> Option<Rim> {
    let mut q = 1.0;
    for _ in 0..12 {
        let f = sight.both([1.0, 0.0], q, 0.0);
        let slope = [0, 1].map(|i| [(f[i] - d[i]) / q, poles[i][1]]);
        let mut rim = Rim { q: 0.0, z: 0.0, slope };
        let found = rim.step(d).filter(|[at, _]| *at > 0.0 && *at < 6.0 * q);
        match found {
            Some([at, z]) if 6.0 * at > q => {
                (rim.q, rim.z) = (at, z);
                return Some(rim);
            }
            Some([at, _]) => q = at.max(q / 64.0),
            None => q *= 4.0,
        }
    }
    None
}
