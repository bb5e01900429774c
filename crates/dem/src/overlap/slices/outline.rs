//! The outline of a convex region between straight lines and arcs.
use super::apart::Gap;
use super::slice::{Place, Side, Slice, Tag, cross};

/// A piece of an outline; it ends where the next one starts.
#[derive(Clone, Copy, Debug)]
struct Piece {
    start: Place,
    /// Height of the start above the line that is cut at.
    above: f64,
    /// Number of its curve.
    curve: usize,
}

/// A straight line or a circle.
#[derive(Clone, Copy, Debug)]
struct Curve {
    /// Of the circle; arcs span no more than half of it.
    centre: Place,
    /// Zero for straight lines.
    radius: f64,
    slope: f64,
    tag: Tag,
}

/// An outline, counter-clockwise; keeps the memory that this takes.
#[derive(Clone, Debug, Default)]
pub(super) struct Outline {
    pieces: Vec<Piece>,
    cut: Vec<Piece>,
    curves: Vec<Curve>,
}

/// Integrals over a region and along the pieces of its outline that belong to the first body.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Section {
    pub(super) area: f64,
    /// ∫ x dA.
    pub(super) first: Place,
    /// Change of the area with the height.
    pub(super) growth: f64,
    /// ∫ n ds of the part of the surface's normal in the plane.
    pub(super) normal: Place,
    /// ∫ t ds of the part t along the slices' normal.
    pub(super) upward: f64,
    /// ∫ x t ds.
    pub(super) arm: Place,
    /// ∫ x × n ds.
    pub(super) turn: f64,
    /// Distance by which a piece that may appear or vanish does not, with its change if this is known, else NaN.
    pub(super) margin: Gap,
    /// Tells apart which pieces were there.
    pub(super) mark: u64,
    /// Whether there were pieces of the first and the second body.
    pub(super) of: [bool; 2],
    /// The first of these pieces and their lengths.
    lengths: [(Tag, f64); LISTED],
    listed: usize,
}

/// Pieces of an outline whose lengths are known.
const LISTED: usize = 8;

impl Section {
    /// Registers a piece of the outline and its length.
    pub(super) fn add_piece(&mut self, tag: Tag, length: f64) {
        if let Some(of) = tag.body() {
            self.mark = self.mark.wrapping_add(tag.mark());
            self.of[of] = true;
            if self.listed < LISTED {
                self.lengths[self.listed] = (tag, length);
                self.listed += 1;
            }
        }
    }
    /// Length of all pieces with this tag.
    pub(super) fn length(&self, tag: Tag) -> f64 {
        self.lengths[..self.listed].iter().filter(|l| l.0 == tag).map(|l| l.1).sum()
    }
    /// A piece that the other has not.
    pub(super) fn more_than(&self, other: &Self) -> Option<Tag> {
        self.lengths[..self.listed].iter().map(|l| l.0).find(|t| other.length(*t) == 0.0)
    }
}

impl Outline {
    pub(super) fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }
    fn clear(&mut self) {
        self.pieces.clear();
        self.curves.clear();
    }
    fn push(&mut self, start: Place, centre: Place, radius: f64, slope: f64, tag: Tag) {
        self.pieces.push(Piece { start, above: 0.0, curve: self.curves.len() });
        self.curves.push(Curve { centre, radius, slope, tag });
    }
    /// The whole outline of a slice.
    pub(super) fn start(&mut self, slice: &Slice) {
        self.clear();
        if slice.is_polygon() {
            for (corner, side) in slice.corners.iter().zip(&slice.sides) {
                self.push(corner.x, corner.x, 0.0, side.slope, side.tag);
            }
            return;
        }
        let Some([right, left, ..]) = slice.strip() else {
            self.start_disc(slice, 0);
            return;
        };
        let ([p, q], r) = (slice.ends(), slice.radius);
        self.push(p + right.normal * r, p, 0.0, slice.slope, right.tag);
        self.push(q + right.normal * r, q, r, slice.slope, slice.arc(1));
        self.push(q + left.normal * r, q, 0.0, slice.slope, left.tag);
        self.push(p + left.normal * r, p, r, slice.slope, slice.arc(0));
    }
    /// The disc around an end of a slice's core.
    pub(super) fn start_disc(&mut self, slice: &Slice, end: usize) {
        self.clear();
        let (centre, out) = (slice.ends()[end], Place::new(slice.radius, 0.0));
        for start in [centre - out, centre + out] {
            self.push(start, centre, slice.radius, slice.slope, slice.arc(end));
        }
    }
    /// What the discs around ends of two slices' cores share.
    pub(super) fn start_lens(&mut self, a: &Slice, end_a: usize, b: &Slice, end_b: usize, slack: f64) {
        let (c_a, c_b, r_a, r_b) = (a.ends()[end_a], b.ends()[end_b], a.radius, b.radius);
        let apart = c_b - c_a;
        let d = apart.norm();
        if d <= (r_a - r_b).abs() + slack {
            return if r_a <= r_b { self.start_disc(a, end_a) } else { self.start_disc(b, end_b) };
        }
        self.clear();
        // Heron's product.
        let product = (r_a + r_b - d) * (d - r_a + r_b) * (d + r_a - r_b) * (d + r_a + r_b);
        if product <= 0.0 {
            return;
        }
        let u = apart / d;
        let half = Place::new(-u.y, u.x) * (product.sqrt() / (2.0 * d));
        let x = 0.5 * (d + (r_a - r_b) * ((r_a + r_b) / d));
        let middle = c_a + u * x;
        self.push(middle - half, c_a, r_a, a.slope, a.arc(end_a));
        if x < 0.0 {
            self.push(c_a + u * r_a, c_a, r_a, a.slope, a.arc(end_a));
        }
        self.push(middle + half, c_b, r_b, b.slope, b.arc(end_b));
        if x > d {
            self.push(c_b - u * r_b, c_b, r_b, b.slope, b.arc(end_b));
        }
    }

    /// Cuts off what lies beyond a line by more than the `slack`. The outline stays closed however this is rounded.
    pub(super) fn cut(&mut self, side: &Side, slack: f64) {
        let Self { pieces, cut, curves } = self;
        let mut touched = false;
        for piece in pieces.iter_mut() {
            piece.above = side.normal.dot(&piece.start) - side.offset;
            let curve = &curves[piece.curve];
            let most = if curve.radius > 0.0 {
                side.normal.dot(&curve.centre) - side.offset + curve.radius
            } else {
                piece.above
            };
            touched |= most > slack || piece.above > slack;
        }
        if !touched {
            return;
        }
        cut.clear();
        let line = curves.len();
        curves.push(Curve { centre: side.normal, radius: 0.0, slope: side.slope, tag: side.tag });
        let line = |start| Piece { start, above: 0.0, curve: line };
        let Some(&(mut next)) = pieces.first() else { return };
        for i in 0..pieces.len() {
            let piece = next;
            next = pieces[if i + 1 == pieces.len() { 0 } else { i + 1 }];
            let curve = &curves[piece.curve];
            let back = |start| Piece { start, ..piece };
            match [piece.above > slack, next.above > slack] {
                [false, true] => cut.extend([piece, line(curve.crossings(&piece, &next, side)[0])]),
                [true, false] => cut.push(back(curve.crossings(&piece, &next, side)[1])),
                [false, false] => {
                    cut.push(piece);
                    if curve.rises(&piece, &next, side.normal, side.offset + slack) {
                        let [leaves, enters] = curve.crossings(&piece, &next, side);
                        cut.extend([line(leaves), back(enters)]);
                    }
                }
                [true, true] => {
                    if curve.rises(&piece, &next, -side.normal, slack - side.offset) {
                        let [leaves, enters] = curve.crossings(&piece, &next, side);
                        cut.extend([back(enters), line(leaves)]);
                    }
                }
            }
        }
        std::mem::swap(pieces, cut);
        // Two points enclose nothing unless an arc does.
        if pieces.len() < 3 && pieces.iter().all(|p| curves[p.curve].radius == 0.0) {
            pieces.clear();
        }
    }

    /// How far the outline stays behind a line; an arc's whole circle counts.
    pub(super) fn behind(&self, side: &Side) -> f64 {
        let reach = |piece: &Piece| {
            let curve = &self.curves[piece.curve];
            let arc = curve.radius + side.normal.dot(&curve.centre);
            side.normal.dot(&piece.start).max(if curve.radius > 0.0 { arc } else { f64::NEG_INFINITY })
        };
        side.offset - self.pieces.iter().map(reach).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Adds the integrals.
    pub(super) fn add_to(&self, section: &mut Section) {
        let Some(first) = self.pieces.first() else { return };
        let origin = first.start;
        let n = self.pieces.len();
        let (mut area, mut moment) = (0.0, Place::zeros());
        for i in 0..n {
            let piece = &self.pieces[i];
            let curve = &self.curves[piece.curve];
            let end = self.pieces[if i + 1 == n { 0 } else { i + 1 }].start;
            let (u, v) = (piece.start - origin, end - origin);
            let double = cross(u, v);
            area += 0.5 * double;
            moment += (u + v) * (double / 6.0);
            let chord = end - piece.start;
            let square = chord.norm_squared();
            if square == 0.0 {
                continue;
            }
            // Outward, as long as the chord.
            let normal = Place::new(chord.y, -chord.x);
            let middle = 0.5 * (piece.start + end);
            let width = square.sqrt();
            let (length, about, mean);
            let (r, rise) = (curve.radius, (middle - curve.centre).dot(&normal) / width);
            // No arc is longer than half a circle: a short one that seems so runs backwards by rounding.
            if r > 0.0 && (rise >= 0.0 || width >= r) {
                let angle = (0.5 * width).atan2(rise);
                let bulge = r * r * segment(angle);
                area += bulge;
                moment += (curve.centre - origin) * bulge + normal * (square / 12.0);
                length = 2.0 * r * angle;
                about = curve.centre;
                mean = curve.centre * length + normal * r;
            } else {
                length = width;
                about = middle;
                mean = middle * length;
            }
            section.growth -= curve.slope * length;
            if let Some(of) = curve.tag.body() {
                section.add_piece(curve.tag, length);
                if of == 0 {
                    section.normal += normal;
                    section.upward += curve.slope * length;
                    section.arm += mean * curve.slope;
                    section.turn += cross(about, normal);
                }
            }
        }
        section.area += area;
        section.first += moment + origin * area;
    }
}

impl Curve {
    /// Where a piece leaves the side of a line and where it comes back; of a straight one the same.
    fn crossings(&self, piece: &Piece, next: &Piece, side: &Side) -> [Place; 2] {
        if self.radius == 0.0 {
            let x = piece.start + (next.start - piece.start) * (piece.above / (piece.above - next.above));
            return [x, x];
        }
        let above = side.normal.dot(&self.centre) - side.offset;
        let half = ((self.radius - above) * (self.radius + above)).max(0.0).sqrt();
        let foot = self.centre - side.normal * above;
        let along = Place::new(-side.normal.y, side.normal.x) * half;
        [foot - along, foot + along]
    }
    /// Whether an arc rises above a line between its ends.
    fn rises(&self, piece: &Piece, next: &Piece, normal: Place, offset: f64) -> bool {
        self.radius > 0.0
            && normal.dot(&self.centre) + self.radius > offset
            && cross(next.start - piece.start, normal) < 0.0
            && cross(piece.start - self.centre, normal) >= 0.0
            && cross(normal, next.start - self.centre) >= 0.0
    }
}

/// α − sin α cos α, the area of the segment that spans 2α of the unit circle.
pub(in crate::overlap) fn segment(angle: f64) -> f64 {
    if angle > 0.25 {
        return angle - angle.sin() * angle.cos();
    }
    let x = 4.0 * angle * angle;
    let series = 1.0 - x / 20.0 * (1.0 - x / 42.0 * (1.0 - x / 72.0 * (1.0 - x / 110.0 * (1.0 - x / 156.0))));
    2.0 / 3.0 * angle * angle * angle * series
}
