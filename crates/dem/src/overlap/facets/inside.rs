//! Which vertices of one body lie in the other, and the sums over all edges.
use super::body::{Body, Crossed, NONE};
use super::crossings::Crossings;
use super::groups::{Groups, Region};
use super::signs::{Side, ray_crosses};
use super::{Bodies, Sums};
use crate::shapes::{Facets, WIDTH};
use interfaces::Vector;
use nalgebra::Matrix3;

impl Bodies<'_> {
    /// Marks the vertices of either body that lie in the other, with the groups they belong to.
    pub(super) fn find_inside(&mut self, crossings: &Crossings, groups: &mut Groups) {
        for (number, c) in (0..).zip(&crossings.all) {
            let body = if c.of_first { &mut self.first } else { &mut self.second };
            let crossed = body.crossed(c.edge);
            // Each edge once, from its first crossing on.
            if crossed.first != number {
                continue;
            }
            let edge = body.facets.edges[c.edge as usize];
            if c.next != NONE {
                join_along(crossed, crossings, groups);
            }
            if crossed.net != 0 {
                body.marks.known[body.facets.shell_of[edge.from as usize] as usize] = true;
                let (v, last) = if crossed.net > 0 { (edge.to, true) } else { (edge.from, false) };
                let group = groups.root(end_crossing(crossed, crossings, last));
                body.find(v, group, groups);
            }
        }
        for side in [Side::First, Side::Second] {
            self.on(side).spread(0, crossings, groups);
            for shell in 0..self.on(side).facets.shells.len() {
                let body = self.on(side);
                let start = body.facets.shells[shell];
                if !body.marks.known[shell] && self.contains(side, start) {
                    let (group, body) = (groups.add(), self.on(side));
                    let before = body.marks.found.len();
                    body.find(start, group, groups);
                    body.spread(before, crossings, groups);
                }
            }
        }
    }

    /// Does the other body contain a vertex of the body on this `side`?
    fn contains(&mut self, side: Side, v: u32) -> bool {
        let p = self.on(side).place(v);
        let other = self.on(side.other());
        let (facets, moved) = (other.facets, other.moved);
        // The ray in the other body's own frame, for its boxes.
        let (start, along) = match &moved {
            None => (p, Vector::x()),
            Some((turn, shift)) => (turn.tr_mul(&(p - shift)), turn.row(0).transpose()),
        };
        let ray = Ray { start, along, slack: 1e-13 * (facets.radius + start.norm()) };
        ray.winding(facets, &|f| ray_crosses(side, p, other.corners(f))) > 0
    }

    /// Sums over all edges of the shared region, one for every connected part.
    pub(super) fn sum<'g>(&mut self, crossings: &Crossings, groups: &'g mut Groups) -> &'g [Region] {
        groups.start_sums();
        for s in &crossings.segments {
            let [p, q] = s.ends.map(|c| crossings.all[c as usize].arm);
            let (left, right) =
                (&self.first.marks.cut[s.first as usize], &self.second.marks.cut[s.second as usize]);
            groups.sums(s.ends[0]).add_edge(p, q, left.foot, right.foot);
            groups.add_curve(s.ends[0], p, q);
        }
        for (number, c) in (0..).zip(&crossings.all) {
            let body = if c.of_first { &self.first } else { &self.second };
            body.sum_crossed(number, crossings, groups);
        }
        for body in [&self.first, &self.second] {
            body.sum_cut(groups);
            body.sum_whole(groups);
        }
        groups.patches(1e-14 * self.second.facets.radius.powi(3))
    }
}

impl Body<'_> {
    /// Marks a vertex that lies in the other body.
    #[inline]
    fn find(&mut self, v: u32, group: u32, groups: &mut Groups) {
        match self.group(v) {
            Some(own) => groups.join(own, group),
            None => self.set_group(v, group),
        }
    }

    /// Marks the vertices that hang together by edges with those found, from number `next` of these on.
    fn spread(&mut self, mut next: usize, crossings: &Crossings, groups: &mut Groups) {
        let facets = self.facets;
        while let Some(&v) = self.marks.found.get(next) {
            next += 1;
            let Some(group) = self.group(v) else { continue };
            if !self.has_crossed(v) {
                for &[_, other] in facets.spokes_of(v) {
                    match self.group(other) {
                        Some(own) if own != group => groups.join(own, group),
                        Some(_) => {}
                        None => self.set_group(other, group),
                    }
                }
                continue;
            }
            for &[e, other] in facets.spokes_of(v) {
                let crossed = self.crossed(e);
                if crossed.first == NONE {
                    self.find(other, group, groups);
                    continue;
                }
                let starts = facets.edges[e as usize].from == v;
                groups.join(group, end_crossing(crossed, crossings, !starts));
                // Out and in again.
                if crossed.net == 0 {
                    let group = groups.root(end_crossing(crossed, crossings, starts));
                    self.find(other, group, groups);
                }
            }
        }
    }

    /// Sums over an edge that is crossed, the first time at crossing `number`: the parts that lie in the other body.
    fn sum_crossed(&self, number: u32, crossings: &Crossings, groups: &mut Groups) {
        let c = &crossings.all[number as usize];
        let (crossed, edge) = (self.crossed(c.edge), self.facets.edges[c.edge as usize]);
        if crossed.first != number {
            return;
        }
        let [left, right] = [edge.left, edge.right].map(|f| self.foot(f));
        if c.next == NONE {
            // In or out once: all between here and an end.
            if c.leaves {
                groups.sums(number).add_edge(self.arm(edge.from), c.arm, left, right);
            } else {
                groups.sums(number).add_edge(c.arm, self.arm(edge.to), left, right);
            }
            return;
        }
        let p = self.arm(edge.from);
        let u = self.arm(edge.to) - p;
        for (number, c) in crossings.of(crossed) {
            let end = if c.leaves { c.along } else { -c.along };
            groups.sums(number).add_line(p, u, [end, end * c.along], left, right);
        }
        if let Some(group) = self.group(edge.to) {
            groups.sums(group).add_line(p, u, [1.0; 2], left, right);
        }
    }

    /// Sums over the other edges of the faces that are cut, where they lie in the other body.
    fn sum_cut(&self, groups: &mut Groups) {
        for cut in &self.marks.cut {
            let face = &self.facets.faces[cut.face as usize];
            for i in 0..3 {
                let Some(group) = self.group(face.corners[i]) else { continue };
                if self.crossed(face.edges[i]).first == NONE {
                    let (p, q) = (self.arm(face.corners[i]), self.arm(face.corners[(i + 1) % 3]));
                    groups.sums(group).add_edge(p, q, cut.foot, Vector::zeros());
                }
            }
        }
    }

    /// Sums over the faces that lie whole in the other body, in this body's own frame.
    fn sum_whole(&self, groups: &mut Groups) {
        let (reference, turn) = match &self.moved {
            None => (self.reference, Matrix3::identity()),
            Some((turn, shift)) => (turn.tr_mul(&(self.reference - shift)), *turn),
        };
        let (mut own, mut last) = (Sums::default(), NONE);
        for &v in &self.marks.found {
            let Some(group) = self.group(v) else { continue };
            let group = groups.root(group);
            if group != last {
                groups.add_turned(last, &own, &turn);
                (own, last) = (Sums::default(), group);
            }
            for &f in self.facets.fan(v) {
                let [_, b, c] = self.facets.faces[f as usize].corners;
                if self.group(b).is_some() && self.group(c).is_some() && !self.is_cut(f) {
                    let [a, b, c] = [v, b, c].map(|v| self.facets.vertices[v as usize] - reference);
                    own.add_face(a, b, c);
                }
            }
        }
        groups.add_turned(last, &own, &turn);
    }
}

/// Does a body contain the point `x` of its own frame? On the surface, either.
pub(crate) fn holds(facets: &Facets, x: Vector) -> bool {
    let ray = Ray { start: x, along: Vector::x(), slack: 1e-13 * (facets.radius + x.norm()) };
    let corners = |f: u32| facets.faces[f as usize].corners.map(|v| facets.vertices[v as usize]);
    ray.winding(facets, &|f| ray_crosses(Side::First, x, corners(f))) > 0
}

/// A ray in the frame of a body.
struct Ray {
    start: Vector,
    along: Vector,
    /// What it may drift off by rounding.
    slack: f64,
}

impl Ray {
    /// The sum of what `crosses` says of all faces that the ray may meet.
    fn winding(&self, facets: &Facets, crosses: &impl Fn(u32) -> i32) -> i32 {
        // A vertex on the other surface may be off its box by rounding.
        let [low, high] = [facets.bounds[0].add_scalar(-self.slack), facets.bounds[1].add_scalar(self.slack)];
        let within = low <= self.start && self.start <= high;
        if within { self.winding_below(0, facets, crosses) } else { 0 }
    }
    fn winding_below(&self, n: u32, facets: &Facets, crosses: &impl Fn(u32) -> i32) -> i32 {
        let node = &facets.tree[n as usize];
        let mut winding = 0;
        for slot in (0..WIDTH).filter(|&i| node.low[0][i] <= node.high[0][i]) {
            let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
            for i in 0..3 {
                let low = f64::from(node.low[i][slot]) - self.slack - self.start[i];
                let high = f64::from(node.high[i][slot]) + self.slack - self.start[i];
                if self.along[i].abs() > 1e-12 {
                    let (s, t) = (low / self.along[i], high / self.along[i]);
                    (enter, leave) = (enter.max(s.min(t)), leave.min(s.max(t)));
                } else if low > 0.0 || high < 0.0 {
                    leave = -1.0;
                }
            }
            if enter <= leave + self.slack {
                let child = node.children[slot];
                winding += if node.is_leaf {
                    crosses(child + slot as u32)
                } else {
                    self.winding_below(child, facets, crosses)
                };
            }
        }
        winding
    }
}

/// The crossing of an edge nearest to its end (`last`) or its start.
#[inline]
fn end_crossing(crossed: Crossed, crossings: &Crossings, last: bool) -> u32 {
    let order = |a: f64, b: f64| if last { b.total_cmp(&a) } else { a.total_cmp(&b) };
    let nearest = crossings.of(crossed).min_by(|(_, a), (_, b)| order(a.along, b.along));
    nearest.map_or(NONE, |(number, _)| number)
}

/// Joins crossings of an edge between which it lies in the other body.
fn join_along(crossed: Crossed, crossings: &Crossings, groups: &mut Groups) {
    for (number, c) in crossings.of(crossed).filter(|(_, c)| !c.leaves) {
        // Where it leaves next.
        let ahead = crossings.of(crossed).filter(|(_, d)| d.leaves && d.along >= c.along);
        if let Some((next, _)) = ahead.min_by(|(_, a), (_, b)| a.along.total_cmp(&b.along)) {
            groups.join(number, next);
        }
    }
}
