//! Which vertices of one body lie in the other, and the sums over all edges.
use super::body::{Body, NONE};
use super::crossings::Crossings;
use super::groups::Groups;
use super::signs::{Side, ray_crosses};
use super::{Bodies, Sums};

impl Bodies<'_> {
    /// Marks the vertices of either body that lie in the other, with the groups they belong to.
    pub(super) fn find_inside(&mut self, crossings: &Crossings, groups: &mut Groups, stack: &mut Vec<[u32; 2]>) {
        for (number, c) in (0..).zip(&crossings.all) {
            let body = self.on(c.side);
            let crossed = body.crossed(c.edge);
            let edge = body.facets.edges[c.edge as usize];
            if crossed.net != 0 {
                body.marks.known[body.facets.shell_of[edge.from as usize] as usize] = true;
            }
            // Each edge once, from its first crossing on.
            if crossed.first != number {
                continue;
            }
            join_along(c.edge, body, crossings, groups);
            if crossed.net != 0 {
                let (v, last) = if crossed.net > 0 { (edge.to, true) } else { (edge.from, false) };
                let nearest = end_crossing(body, c.edge, crossings, last);
                body.spread(v, nearest, crossings, groups, stack);
            }
        }
        for side in [Side::First, Side::Second] {
            for shell in 0..self.on(side).facets.shells.len() {
                let body = self.on(side);
                let start = body.facets.shells[shell];
                if !body.marks.known[shell] && self.contains(side, start, stack) {
                    let group = groups.add();
                    self.on(side).spread(start, group, crossings, groups, stack);
                }
            }
        }
    }

    /// Does the other body contain a vertex of the body on this `side`?
    fn contains(&mut self, side: Side, v: u32, stack: &mut Vec<[u32; 2]>) -> bool {
        let p = self.on(side).place(v);
        let other = self.on(side.other());
        let (facets, moved) = (other.facets, other.moved);
        // The ray in the other body's own frame, for its boxes.
        let (start, along) = match &moved {
            None => (p, nalgebra::Vector3::x()),
            Some((turn, shift)) => (turn.tr_mul(&(p - shift)), turn.row(0).transpose()),
        };
        let slack = 1e-13 * (facets.radius + start.norm());
        let mut winding = 0;
        stack.clear();
        stack.push([0, 0]);
        while let Some([n, _]) = stack.pop() {
            let node = &facets.tree[n as usize];
            let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
            for i in 0..3 {
                let (gap, half) = (node.centre[i] - start[i], node.half[i] + slack);
                if along[i].abs() > 1e-12 {
                    let (s, t) = ((gap - half) / along[i], (gap + half) / along[i]);
                    // The slack covers what the ray drifts off over the body's length.
                    (enter, leave) = (enter.max(s.min(t)), leave.min(s.max(t)));
                } else if gap.abs() > half {
                    leave = -1.0;
                }
            }
            if enter > leave + slack {
                continue;
            }
            if node.count == 0 {
                stack.push([n + 1, 0]);
                stack.push([node.first, 0]);
            } else {
                let faces = node.first..node.first + node.count;
                winding += faces.map(|f| ray_crosses(side, p, other.corners(f))).sum::<i32>();
            }
        }
        winding > 0
    }

    /// Sums over all edges of the shared region, one for every connected part.
    pub(super) fn sum<'g>(&mut self, crossings: &Crossings, groups: &'g mut Groups) -> &'g [Sums] {
        groups.start_sums();
        for s in &crossings.segments {
            let [p, q] = s.ends.map(|c| crossings.all[c as usize].arm);
            let (left, right) = (self.first.plane(s.first).foot, self.second.plane(s.second).foot);
            let sums = groups.sums(s.ends[0]);
            sums.add_edge(p, q, left, right);
            sums.add_curve(p, q);
        }
        for (number, c) in (0..).zip(&crossings.all) {
            let body = self.on(c.side);
            let sign = if c.leaves { 1.0 } else { -1.0 };
            body.add_edge(c.edge, [sign * c.along, sign * c.along * c.along], [true; 2], groups.sums(number));
        }
        self.first.sum_inside(groups);
        self.second.sum_inside(groups);
        groups.patches(1e-14 * self.second.facets.radius.powi(3))
    }
}

impl Body<'_> {
    /// Marks a vertex that lies in the other body, and all that hang together with it by edges.
    fn spread(&mut self, v: u32, group: u32, crossings: &Crossings, groups: &mut Groups, stack: &mut Vec<[u32; 2]>) {
        stack.clear();
        stack.push([v, group]);
        while let Some([v, group]) = stack.pop() {
            if let Some(own) = self.group(v) {
                groups.join(own, group);
                continue;
            }
            self.set_group(v, group);
            for &e in self.facets.spokes_of(v) {
                let crossed = self.crossed(e);
                let edge = &self.facets.edges[e as usize];
                if crossed.first == NONE {
                    let other = edge.other(v);
                    if self.group(other).is_none() {
                        stack.push([other, group]);
                    }
                    continue;
                }
                let starts = edge.from == v;
                groups.join(group, end_crossing(self, e, crossings, !starts));
                // Out and in again.
                if crossed.net == 0 {
                    stack.push([edge.other(v), end_crossing(self, e, crossings, starts)]);
                }
            }
        }
    }

    /// Adds a part of an edge, given by [`Sums::add_line`]'s sums over its ends, to its faces on the left and right.
    #[inline]
    fn add_edge(&mut self, e: u32, ends: [f64; 2], [left, right]: [bool; 2], sums: &mut Sums) {
        let edge = self.facets.edges[e as usize];
        let (p, q) = (self.arm(edge.from), self.arm(edge.to));
        let mut foot = |wanted: bool, f: u32| if wanted { self.plane(f).foot } else { Default::default() };
        let (left, right) = (foot(left, edge.left), foot(right, edge.right));
        sums.add_line(p, q - p, ends, left, right);
    }

    /// Sums over the ends of edges at the vertices that lie in the other body; of whole faces at once.
    fn sum_inside(&mut self, groups: &mut Groups) {
        for i in 0..self.marks.found.len() {
            let v = self.marks.found[i];
            let Some(group) = self.group(v) else { continue };
            let sums = groups.sums(group);
            for &e in self.facets.spokes_of(v) {
                let edge = self.facets.edges[e as usize];
                let whole = [edge.left, edge.right].map(|f| self.is_whole(f));
                if edge.to == v && whole != [true; 2] {
                    self.add_edge(e, [1.0; 2], whole.map(|w| !w), sums);
                }
                for (f, whole) in [edge.left, edge.right].into_iter().zip(whole) {
                    let face = &self.facets.faces[f as usize];
                    if whole && face.corners[0] == v && face.edges[0] == e {
                        let [a, b, c] = face.corners.map(|v| self.arm(v));
                        sums.add_face(a, b, c);
                    }
                }
            }
        }
    }
}

/// The crossing of an edge nearest to its end (`last`) or its start.
fn end_crossing(body: &Body<'_>, e: u32, crossings: &Crossings, last: bool) -> u32 {
    let order = |a: f64, b: f64| if last { b.total_cmp(&a) } else { a.total_cmp(&b) };
    let nearest = crossings.of(body.crossed(e)).min_by(|(_, a), (_, b)| order(a.along, b.along));
    nearest.map_or(NONE, |(number, _)| number)
}

/// Joins crossings of an edge between which it lies in the other body.
fn join_along(e: u32, body: &Body<'_>, crossings: &Crossings, groups: &mut Groups) {
    let crossed = body.crossed(e);
    for (number, c) in crossings.of(crossed).filter(|(_, c)| !c.leaves) {
        // Where it leaves next.
        let ahead = crossings.of(crossed).filter(|(_, d)| d.leaves && d.along >= c.along);
        if let Some((next, _)) = ahead.min_by(|(_, a), (_, b)| a.along.total_cmp(&b.along)) {
            groups.join(number, next);
        }
    }
}
