//! The tree of boxes.
use super::columns::{Content, content, holds};
use super::cut::{Cut, Side, by_distance};
use super::quadric::{Quadric, STENCIL};
use super::seen::Seen;
use interfaces::Vector;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// No leaf, or no children.
pub(crate) const NONE: u32 = u32::MAX;
/// Boxes that a tree may hold at most.
const MOST: usize = 400_000;
/// Levels that a tree may have at most.
const DEEPEST: u8 = 24;

/// What is known of a body in a box.
#[derive(Clone, Copy, Debug)]
pub(crate) enum State {
    /// The box is within it.
    Inside,
    /// Its surface is in the box, or may be.
    Cut(Quadric),
}

impl State {
    pub(crate) fn quadric(&self) -> Option<&Quadric> {
        match self {
            Self::Inside => None,
            Self::Cut(q) => Some(q),
        }
    }
}

/// A box.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    /// In the root's frame.
    pub(crate) centre: Vector,
    pub(crate) level: u8,
    /// The first of eight, x fastest.
    pub(crate) children: u32,
    pub(crate) leaf: u32,
}

/// A box that is not divided and not outside.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leaf {
    pub(crate) node: u32,
    pub(crate) states: [State; 2],
    pub(crate) content: Content,
    /// Of its volume: what the models miss, and what the sums over them do.
    error: [f64; 2],
}

impl Leaf {
    /// Does what it holds come to its side along `axis`, the lower (−1) or the upper one (1)?
    pub(crate) fn reaches(&self, axis: usize, sign: f64) -> bool {
        let away =
            |q: &Quadric| q.c + sign * q.g[axis] - (q.g.abs().sum() - q.g[axis].abs()) - q.curved() > 0.0;
        if self.states.iter().any(|s| s.quadric().is_some_and(away)) {
            return false;
        }
        let surfaces = self.states.each_ref().map(State::quadric);
        [1, 2].into_iter().any(|k| holds(surfaces, axis, sign, (axis + k) % 3))
    }
}

/// A leaf by its error.
#[derive(Clone, Copy, Debug)]
struct Due(f64, u32);

impl Ord for Due {
    fn cmp(&self, o: &Self) -> Ordering {
        self.0.total_cmp(&o.0).then(o.1.cmp(&self.1))
    }
}
impl PartialOrd for Due {
    fn partial_cmp(&self, o: &Self) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}
impl PartialEq for Due {
    fn eq(&self, o: &Self) -> bool {
        self.cmp(o) == Ordering::Equal
    }
}
impl Eq for Due {}

/// A root and the boxes in it. The memory stays.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tree {
    pub(crate) nodes: Vec<Node>,
    pub(crate) leaves: Vec<Leaf>,
    free: Vec<u32>,
    due: BinaryHeap<Due>,
    /// Over the leaves: volume, error of the models, square of the error of the sums.
    sum: [f64; 3],
    /// Of all divisions: what their models were said to miss, and by how much the volume changed.
    said: f64,
    done: f64,
    pub(crate) half: Vector,
}

/// A tree may not grow farther.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exhausted {
    pub(crate) boxes: usize,
    /// Of the volume, relative.
    pub(crate) error: f64,
}

/// How a tree is refined.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Goal {
    /// Relative error of the volume.
    pub(crate) tolerance: f64,
    /// Are second moments asked for?
    pub(crate) moments: bool,
}

/// How much of what a model misses the volume does: the rest cancels.
const USUAL: f64 = 0.4;
/// How much of a box's volume the sums may miss where surfaces end in it, with one panel and with two.
const RAGGED: [f64; 2] = [1e-4, 2e-5];

impl Tree {
    /// Half-widths of boxes at a level.
    pub(crate) fn half_at(&self, level: u8) -> Vector {
        self.half * 0.5_f64.powi(level.into())
    }

    fn start(&mut self, half: Vector) {
        self.nodes.clear();
        self.leaves.clear();
        self.free.clear();
        self.due.clear();
        self.sum = [0.0; 3];
        (self.said, self.done) = (0.0, 0.0);
        self.half = half;
        self.nodes.push(Node { centre: Vector::zeros(), level: 0, children: NONE, leaf: NONE });
    }

    /// The children of a node, all of them outside so far.
    pub(crate) fn divide(&mut self, node: u32) -> u32 {
        let first = self.nodes.len() as u32;
        let Node { centre, level, .. } = self.nodes[node as usize];
        let quarter = 0.5 * self.half_at(level);
        for i in 0..8_u32 {
            let centre = centre + corner(i).component_mul(&quarter);
            self.nodes.push(Node { centre, level: level + 1, children: NONE, leaf: NONE });
        }
        self.nodes[node as usize].children = first;
        first
    }

    fn keep(&mut self, leaf: Leaf) -> u32 {
        let at = match self.free.pop() {
            Some(at) => {
                self.leaves[at as usize] = leaf;
                at
            }
            None => {
                self.leaves.push(leaf);
                self.leaves.len() as u32 - 1
            }
        };
        self.nodes[leaf.node as usize].leaf = at;
        at
    }

    /// A root alone, whose error is not known; false if it is outside.
    pub(crate) fn plant(&mut self, bodies: &[Seen<'_>], half: Vector, goal: Goal) -> bool {
        self.start(half);
        let Some(first) = Close::new(bodies, goal).root(half) else { return false };
        let first = self.keep(first);
        self.due.push(Due(f64::INFINITY, first));
        true
    }

    /// Divides the boxes with the largest errors until the volume is as exact as `tolerance` says.
    ///
    /// # Errors
    /// If the boxes do not suffice.
    pub(crate) fn refine(
        &mut self,
        bodies: &[Seen<'_>],
        goal: Goal,
        tolerance: f64,
    ) -> Result<(), Exhausted> {
        let close = Close::new(bodies, goal);
        while let Some(Due(error, at)) = self.due.pop() {
            let [volume, models, squares] = self.sum;
            let level = self.nodes[self.leaves[at as usize].node as usize].level;
            // What was said is held against what came of it.
            let scale = (USUAL * models + self.done) / (models + self.said).max(f64::MIN_POSITIVE);
            let left = scale.max(USUAL) * models + squares.max(0.0).sqrt();
            let enough = error.is_finite() && left <= tolerance * volume;
            if enough {
                self.due.push(Due(error, at));
                break;
            }
            if level >= DEEPEST || self.nodes.len() > MOST {
                return Err(Exhausted { boxes: self.nodes.len(), error: left / volume });
            }
            self.refine_leaf(&close, at, level);
        }
        Ok(())
    }

    fn refine_leaf(&mut self, close: &Close<'_>, at: u32, level: u8) {
        let parent = self.leaves[at as usize];
        self.count(&parent, -1.0);
        let before = self.sum[0];
        self.nodes[parent.node as usize].leaf = NONE;
        self.free.push(at);
        let children = self.divide(parent.node);
        let half = self.half_at(level + 1);
        let centres: [Vector; 8] = std::array::from_fn(|i| self.nodes[children as usize + i].centre);
        let distances = close.distances(&parent.states, &centres, half);
        for i in 0..8 {
            let (node, own) = (children + i as u32, distances.map(|d| d[i]));
            let Some(leaf) = close.child(node, &parent.states, centres[i], half, own) else {
                continue;
            };
            self.count(&leaf, 1.0);
            let error = leaf.error[0] + leaf.error[1];
            let at = self.keep(leaf);
            if error > 0.0 {
                self.due.push(Due(error, at));
            }
        }
        if parent.error[0].is_finite() {
            self.said += parent.error[0];
            self.done += (self.sum[0] - before - parent.content.sums.volume).abs();
        }
    }

    /// Adds a leaf to the sums, or takes it away.
    fn count(&mut self, leaf: &Leaf, sign: f64) {
        if leaf.error[0].is_finite() {
            self.sum[0] += sign * leaf.content.sums.volume;
            self.sum[1] += sign * leaf.error[0];
            self.sum[2] += sign * leaf.error[1].powi(2);
        }
    }

    /// Divides all boxes that a surface cuts down to a level.
    pub(crate) fn grow_levels(&mut self, bodies: &[Seen<'_>], half: Vector, levels: u8, cut: &impl Cut) {
        self.start(half);
        let close = Close { bodies, panels: 1, moments: false };
        let states = [0, 1].map(|i| if i < bodies.len() { UNKNOWN } else { State::Inside });
        self.level(0, &states, &close, levels, cut);
    }

    fn level(&mut self, node: u32, known: &[State; 2], close: &Close<'_>, levels: u8, cut: &impl Cut) {
        let Node { centre, level, .. } = self.nodes[node as usize];
        let half = self.half_at(level);
        let mut states = *known;
        for (i, state) in states.iter_mut().enumerate() {
            if let (State::Cut(_), Some(body)) = (*state, close.bodies.get(i)) {
                match cut.side(i, body, centre, half) {
                    Side::Outside => return,
                    Side::Inside => *state = State::Inside,
                    Side::Cut => {}
                }
            }
        }
        let whole = states.iter().all(|s| matches!(s, State::Inside));
        if whole || level == levels {
            if !whole {
                close.fit(&mut states, centre, half);
            }
            let content = close.content(&states, centre, half);
            self.keep(Leaf { node, states, content, error: [0.0; 2] });
            return;
        }
        let children = self.divide(node);
        for i in 0..8 {
            self.level(children + i, &states, close, levels, cut);
        }
    }
}

const UNKNOWN: State = State::Cut(Quadric::ZERO);

/// Child `i` of eight, as signs.
fn corner(i: u32) -> Vector {
    Vector::from_fn(|a, _| if i >> a & 1 == 1 { 1.0 } else { -1.0 })
}

/// Closes boxes at the bodies' surfaces.
struct Close<'a> {
    bodies: &'a [Seen<'a>],
    /// Of the lines of columns.
    panels: u32,
    moments: bool,
}

impl<'a> Close<'a> {
    fn new(bodies: &'a [Seen<'a>], goal: Goal) -> Self {
        Self { bodies, panels: if goal.tolerance > 3e-5 { 1 } else { 2 }, moments: goal.moments }
    }

    fn content(&self, states: &[State; 2], centre: Vector, half: Vector) -> Content {
        let [a, b] = states.each_ref().map(State::quadric);
        content([a, b], centre, half, self.panels, self.moments)
    }

    /// Distances of the centres of eight boxes of these half-widths from the surfaces that may be near.
    fn distances(&self, parent: &[State; 2], centres: &[Vector; 8], half: Vector) -> [[f64; 8]; 2] {
        [0, 1].map(|i| match (self.bodies.get(i), &parent[i]) {
            (Some(body), State::Cut(_)) => body.distances(centres, 2.0 * half.norm()),
            _ => [0.0; 8],
        })
    }

    /// Second-order models of all surfaces in a box.
    fn fit(&self, states: &mut [State; 2], centre: Vector, half: Vector) {
        for (state, body) in states.iter_mut().zip(self.bodies) {
            if let State::Cut(_) = state {
                let c = body.distance(centre, 2.0 * half.norm());
                *state = State::Cut(fit(body, c, centre, half).0);
            }
        }
    }

    fn root(&self, half: Vector) -> Option<Leaf> {
        let mut states = [0, 1].map(|i| if i < self.bodies.len() { UNKNOWN } else { State::Inside });
        for (state, body) in states.iter_mut().zip(self.bodies) {
            match by_distance(body, Vector::zeros(), half) {
                Side::Outside => return None,
                Side::Inside => *state = State::Inside,
                Side::Cut => {}
            }
        }
        self.fit(&mut states, Vector::zeros(), half);
        Some(Leaf { node: 0, states, content: Content::default(), error: [f64::INFINITY, 0.0] })
    }

    /// Child `i` of a box with these `states`; `None` if a body is elsewhere.
    fn child(
        &self,
        node: u32,
        parent: &[State; 2],
        centre: Vector,
        half: Vector,
        distances: [f64; 2],
    ) -> Option<Leaf> {
        let diagonal = half.norm();
        let mut states = [State::Inside; 2];
        let mut off = [0.0; 2];
        for (b, (state, known)) in states.iter_mut().zip(parent).enumerate() {
            let State::Cut(_) = known else { continue };
            let d = distances[b];
            if d >= diagonal {
                return None;
            }
            if d <= -diagonal {
                continue;
            }
            let (q, miss) = fit(&self.bodies[b], d, centre, half);
            // Where the surface has an edge, what it bends there is of the first order.
            let edge = miss > 0.2 * q.curved();
            off[b] = if edge { miss / USUAL } else { 0.25 * miss };
            if q.c - q.reach() > 4.0 * miss {
                return None;
            }
            *state = State::Cut(q);
        }
        let content = self.content(&states, centre, half);
        let mut error = [0.0; 2];
        let product = half.product();
        for b in 0..2 {
            let State::Cut(q) = &states[b] else { continue };
            // f changes by this much per metre.
            let slope = q.g.component_div(&half).norm().max(f64::MIN_POSITIVE);
            let mut area = content.sums.area[b];
            if area == 0.0 && q.c.abs() - q.reach() < 2.0 * off[b] {
                // The surface may come in unseen.
                area = 4.0 * product / half[q.g.iamax()];
            }
            error[0] += off[b] * area / slope;
        }
        // No more than all of it.
        error[0] = error[0].min(8.0 * product / USUAL);
        error[1] = content.ragged * RAGGED[self.panels as usize - 1] * 8.0 * product;
        Some(Leaf { node, states, content, error })
    }
}

/// The model of a body's surface in a box, and what it misses.
#[inline]
fn fit(body: &Seen<'_>, c: f64, centre: Vector, half: Vector) -> (Quadric, f64) {
    let points = STENCIL.map(|x| centre + x.component_mul(&half));
    Quadric::fit(c, &body.distances(&points, 2.0 * half.norm()))
}
