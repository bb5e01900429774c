//! The open part of one face.
use interfaces::Vector;

/// The open part of a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Open {
    /// As a share of the whole.
    pub(super) share: f64,
    /// Its centroid from the lower corner of the face \[m\].
    pub(super) centre: Vector,
    /// Distance of that from the wall \[m\].
    pub(super) distance: f64,
}

impl Open {
    /// Turns a centroid in the plane of the face, given along x and y, to where it is in space.
    pub(super) fn placed(mut self, along: [usize; 2]) -> Self {
        let flat = self.centre;
        self.centre = Vector::zeros();
        (self.centre[along[0]], self.centre[along[1]]) = (flat.x, flat.y);
        self
    }
}

/// Faces with no more than this share closed are open: a wall that they touch in a corner does not count.
const TOUCHED: f64 = 1e-12;

fn rounded(share: f64) -> f64 {
    if share > 1.0 - TOUCHED { 1.0 } else { share }
}

/// Steps of a search for a root.
const STEPS: usize = 30;

/// Of an edge from 0 to `end` with distances `d` at its ends and middle: in each half the surface crosses once at most.
pub(super) fn edge(end: Vector, d: [f64; 3], distance: impl Fn(Vector) -> f64) -> Open {
    let (mut share, mut moment) = (0.0, 0.0);
    for half in 0..2 {
        let (from, to) = (0.5 * half as f64, 0.5 * (half + 1) as f64);
        let [low, high] = match (d[half] > 0.0, d[half + 1] > 0.0) {
            (true, true) => [from, to],
            (false, false) => continue,
            (inside, _) => {
                let t = crossing(|t| distance(end * t), [from, to], [d[half], d[half + 1]]);
                if inside { [from, t] } else { [t, to] }
            }
        };
        share += high - low;
        moment += 0.5 * (high * high - low * low);
    }
    let centre = if share > 0.0 { moment / share } else { 0.5 };
    Open { share: rounded(share), centre: end * centre, distance: 0.0 }
}

/// Where a function changes its sign between two places: false position, then Illinois' halving (Dowell & Jarratt 1971).
fn crossing(f: impl Fn(f64) -> f64, [mut a, mut b]: [f64; 2], [mut fa, mut fb]: [f64; 2]) -> f64 {
    let mut t = a - fa * (b - a) / (fb - fa);
    for _ in 0..STEPS {
        let ft = f(t);
        if ft.abs() <= 1e-13 * (fb - fa).abs() {
            break;
        }
        if (ft > 0.0) == (fb > 0.0) {
            (b, fb) = (t, ft);
            fa *= 0.5;
        } else {
            (a, fa) = (t, ft);
            fb *= 0.5;
        }
        t = a - fa * (b - a) / (fb - fa);
    }
    t
}

/// Of a rectangle with these sides and distances at its corners (the first side varies fastest) and centre: linear on the
/// triangles between them.
pub(super) fn rectangle(sides: [f64; 2], d: [f64; 4], middle: f64) -> Open {
    let corner = |k: usize| [(k & 1) as f64, (k >> 1) as f64];
    let (mut share, mut moment) = (0.0, [0.0; 2]);
    for [p, q] in [[0, 1], [1, 3], [3, 2], [2, 0]] {
        let triangle = [(corner(p), d[p]), (corner(q), d[q]), ([0.5; 2], middle)];
        let (area, first) = triangle_part(triangle);
        share += area;
        (0..2).for_each(|a| moment[a] += first[a]);
    }
    let centre = if share > 0.0 { moment.map(|m| m / share) } else { [0.5; 2] };
    Open {
        share: rounded(share),
        centre: Vector::new(centre[0] * sides[0], centre[1] * sides[1], 0.0),
        distance: 0.0,
    }
}

/// Area of the part of a triangle where a linear function is positive, and its first moments.
fn triangle_part(triangle: [([f64; 2], f64); 3]) -> (f64, [f64; 2]) {
    let mut polygon: [[f64; 2]; 4] = [[0.0; 2]; 4];
    let mut n = 0;
    for k in 0..3 {
        let ((x, f), (y, g)) = (triangle[k], triangle[(k + 1) % 3]);
        if f > 0.0 {
            polygon[n] = x;
            n += 1;
        }
        if (f > 0.0) != (g > 0.0) {
            let t = f / (f - g);
            polygon[n] = [x[0] + t * (y[0] - x[0]), x[1] + t * (y[1] - x[1])];
            n += 1;
        }
    }
    let (mut area, mut moment) = (0.0, [0.0; 2]);
    for k in 1..n.max(2) - 1 {
        let [o, p, q] = [polygon[0], polygon[k], polygon[k + 1]];
        let part = 0.5 * ((p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0])).abs();
        area += part;
        (0..2).for_each(|a| moment[a] += part * (o[a] + p[a] + q[a]) / 3.0);
    }
    (area, moment)
}
