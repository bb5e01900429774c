//! Integrals over the part of a face within a tube, and their sums.
use super::UnitTube;
use super::mantle::Mantle;
use super::section::Beyond;
use crate::overlap::ball_faces::face::Face;
use interfaces::Vector;

/// Sums over faces, about the middle of the tube.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sums {
    /// Volume and ∫ x dV but for what the centres of the ends add if they are inside.
    pub(super) volume: f64,
    pub(super) first: Vector,
    pub(super) gradient: Vector,
    /// Σ ∫ x dA × n.
    pub(super) torque: Vector,
    /// A₋ − A₊.
    pub(super) flux: f64,
    /// Integrals beyond the segments of the sections, of the lower end first.
    pub(super) sections: [Beyond; 2],
    /// Squared distance of the nearest edge within a half ball from its centre.
    pub(super) nearest2: f64,
}

impl Default for Sums {
    fn default() -> Self {
        let (zero, none) = (Vector::zeros(), Beyond::default());
        Self {
            volume: 0.0,
            first: zero,
            gradient: zero,
            torque: zero,
            flux: 0.0,
            sections: [none; 2],
            nearest2: f64::INFINITY,
        }
    }
}

impl Sums {
    /// Squared distance of the nearest edge or segment from the centre of an end.
    pub(super) fn nearest2(&self) -> f64 {
        self.sections.iter().fold(self.nearest2, |least, s| least.min(s.nearest2))
    }
    pub(super) fn add(&mut self, o: &Self) {
        self.volume += o.volume;
        self.first += o.first;
        self.gradient += o.gradient;
        self.torque += o.torque;
        self.flux += o.flux;
        self.sections[0].add(&o.sections[0]);
        self.sections[1].add(&o.sections[1]);
        self.nearest2 = self.nearest2.min(o.nearest2);
    }
    /// Adds a part of a face by its normal, ∫ dA and ∫ x dA.
    pub(super) fn add_area(&mut self, normal: Vector, area: f64, moment: Vector) {
        self.gradient -= normal * area;
        self.torque += moment.cross(&normal);
    }
}

/// Integrals over the part of one face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub(super) normal: Vector,
    pub(super) area: f64,
    pub(super) moment: Vector,
    pub(super) sums: Sums,
}

impl Part {
    /// Adds a segment of the section at an end.
    pub(super) fn add_section(&mut self, a: &UnitTube<'_>, end: usize, p: Vector, q: Vector) {
        let (beyond, sign) = (Beyond::new(p, q), [-1.0, 1.0][end]);
        self.sums.volume -= a.half * beyond.area;
        self.sums.first.z -= sign * 0.5 * a.half * a.half * beyond.area;
        if a.round {
            self.sums.first.z -= sign * beyond.second;
        }
        self.sums.sections[end].add(&beyond);
    }
    pub(super) fn add_mantle(&mut self, m: &Mantle) {
        let n = self.normal;
        self.area += m.area;
        self.moment += m.moment;
        self.sums.add_area(n, m.area, m.moment);
        self.sums.flux += n.z * m.area;
        self.sums.volume += n.z * m.moment.z;
        self.sums.first += Vector::new(-n.x * m.second, -n.y * m.second, 0.5 * n.z * m.z2);
    }
    /// Adds the part within the half ball at an end, of a polygon seen from its centre.
    pub(super) fn add_ball(
        &mut self,
        a: &UnitTube<'_>,
        end: usize,
        polygon: &[Vector],
        places: &mut Vec<[f64; 2]>,
    ) {
        let centre = Vector::z() * [-a.half, a.half][end];
        places.resize(polygon.len(), [0.0; 2]);
        let Some(part) = Face::new(polygon).and_then(|f| f.part(places, |_, _| {})) else { return };
        let moment = part.moment + centre * part.area;
        self.area += part.area;
        self.moment += moment;
        self.sums.add_area(part.normal, part.area, moment);
        self.sums.volume -= part.beyond;
        self.sums.first -= centre * part.beyond + part.normal * part.second;
        self.sums.nearest2 = self.sums.nearest2.min(part.nearest2);
    }
}
