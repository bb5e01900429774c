//! Gradients beside walls.
use super::openings::Openings;
use crate::Field;
pub(super) use crate::least_squares::dot;
use crate::least_squares::{gradient_weights, norm2};
use interfaces::WallPiece;
use std::collections::HashMap;

/// Gradients of one velocity component at nodes beside walls, by least squares with weights 1/distance² over the nodes around
/// that are in the fluid, and the wall as far as it is to be heard.
#[derive(Default)]
pub(super) struct Gradients<const D: usize> {
    slots: HashMap<usize, u32>,
    nodes: Vec<Node<D>>,
    terms: Vec<Term<D>>,
    /// Places on walls: the piece of each.
    walls: Vec<usize>,
    at_walls: Vec<AtWall>,
    pub(super) values: Vec<[f64; D]>,
}

/// A node that has a gradient.
struct Node<const D: usize> {
    index: usize,
    /// Ends of its terms and walls.
    ends: [usize; 2],
    own: Weight<D>,
}

struct Term<const D: usize> {
    point: Point,
    weight: Weight<D>,
}

/// What a velocity adds to a gradient without the wall, and how much more with it.
#[derive(Clone, Copy)]
struct Weight<const D: usize> {
    free: [f64; D],
    more: [f64; D],
}

/// Where a velocity is known: a node, by its storage index, or one of the places on walls.
#[derive(Clone, Copy)]
enum Point {
    Node(usize),
    Wall(usize),
}

/// What a wall tells the gradients beside it: its velocity, and how much that counts, from 0 to 1.
pub(super) struct AtWall {
    pub(super) velocity: f64,
    pub(super) share: f64,
}

impl<const D: usize> Gradients<D> {
    /// The number of the gradient at a node of component `c`. `nearest`: the least distance of the wall, in extents of the cell
    /// along its normal; without it the wall is not there.
    pub(super) fn slot(
        &mut self,
        openings: &Openings<D>,
        c: usize,
        node: usize,
        nearest: Option<f64>,
    ) -> u32 {
        let node = openings.wrap(node);
        if let Some(&slot) = self.slots.get(&node) {
            return slot;
        }
        let slot = self.nodes.len() as u32;
        self.slots.insert(node, slot);
        let x = openings.node(c, node);
        let mut seen: Vec<(Point, [f64; D])> = Vec::new();
        for other in around(openings, node).filter(|&o| o != node && openings.alive(c, o)) {
            let y = openings.node(c, other);
            seen.push((Point::Node(other), std::array::from_fn(|a| y[a] - x[a])));
        }
        let fit =
            |seen: &[(Point, [f64; D])]| gradient_weights(&seen.iter().map(|s| s.1).collect::<Vec<_>>());
        let free = fit(&seen);
        let s = openings.grid.stride()[c];
        for (nearest, cell) in nearest.into_iter().flat_map(|nearest| [(nearest, node - s), (nearest, node)])
        {
            let Some((piece, wall)) = openings.piece(cell) else { continue };
            let y = norm2(&to_wall(&wall, x)).sqrt().max(nearest * openings.extent(cell, &wall));
            if y > 0.0 {
                seen.push((Point::Wall(self.walls.len()), std::array::from_fn(|a| -y * wall.normal[a])));
                self.walls.push(piece);
            }
        }
        let held = if seen.len() > free.len() { fit(&seen) } else { free.clone() };
        let mut own = Weight { free: [0.0; D], more: [0.0; D] };
        for (k, (point, _)) in seen.into_iter().enumerate() {
            let free = free.get(k).copied().unwrap_or([0.0; D]);
            let more = std::array::from_fn(|a| held[k][a] - free[a]);
            (0..D).for_each(|a| {
                own.free[a] -= free[a];
                own.more[a] -= more[a];
            });
            self.terms.push(Term { point, weight: Weight { free, more } });
        }
        self.nodes.push(Node { index: node, ends: [self.terms.len(), self.walls.len()], own });
        self.values.push([0.0; D]);
        slot
    }

    /// Looks at the flow; `at_wall`: what is so at a piece of wall.
    pub(super) fn update(&mut self, u: &Field<D>, at_wall: impl Fn(usize) -> AtWall) {
        let u = u.data();
        let Self { nodes, terms, walls, at_walls, values, .. } = self;
        at_walls.clear();
        at_walls.extend(walls.iter().map(|&piece| at_wall(piece)));
        let mut starts = [0; 2];
        for (node, value) in nodes.iter().zip(values) {
            let walls = &at_walls[starts[1]..node.ends[1]];
            let share = walls.iter().map(|w| w.share).sum::<f64>() / walls.len().max(1) as f64;
            *value = [0.0; D];
            let mut add = |weight: &Weight<D>, u: f64| {
                (0..D).for_each(|a| value[a] += (weight.free[a] + share * weight.more[a]) * u);
            };
            add(&node.own, u[node.index]);
            for term in &terms[starts[0]..node.ends[0]] {
                add(
                    &term.weight,
                    match term.point {
                        Point::Node(other) => u[other],
                        Point::Wall(wall) => at_walls[wall].velocity,
                    },
                );
            }
            starts = node.ends;
        }
    }
}

/// From `x` to the wall.
pub(super) fn to_wall<const D: usize>(wall: &WallPiece, x: [f64; D]) -> [f64; D] {
    let y = height(wall, x);
    std::array::from_fn(|a| -y.max(0.0) * wall.normal[a])
}

/// How far a place is before a wall \[m\].
pub(super) fn height<const D: usize>(wall: &WallPiece, x: [f64; D]) -> f64 {
    (0..D).map(|a| (x[a] - wall.foot[a]) * wall.normal[a]).sum()
}

/// The block of nodes around one, itself included.
pub(super) fn around<const D: usize>(
    openings: &Openings<D>,
    node: usize,
) -> impl Iterator<Item = usize> + use<D> {
    let s = openings.grid.stride();
    (0..3_usize.pow(D as u32)).map(move |k| {
        let mut offset = 0;
        let mut rest = k;
        for stride in s {
            offset += (rest % 3) as isize * stride as isize - stride as isize;
            rest /= 3;
        }
        (node as isize + offset) as usize
    })
}

/// The nodes around a place that are `seen`, and their weights; the one beside which it is if none is.
pub(super) fn corners<const D: usize>(
    openings: &Openings<D>,
    c: Option<usize>,
    x: [f64; D],
    near: usize,
    seen: impl Fn(usize) -> bool,
) -> Vec<(usize, f64)> {
    let s = openings.grid.stride();
    let (mut base, mut part) = (0, [0.0; D]);
    for a in 0..D {
        let places = &openings.metrics.of(c, a).x;
        let i = places.partition_point(|&p| p <= x[a]).clamp(1, places.len() - 1) - 1;
        part[a] = ((x[a] - places[i]) / (places[i + 1] - places[i])).clamp(0.0, 1.0);
        base += i * s[a];
    }
    let mut out = Vec::new();
    for k in 0..1_usize << D {
        let (mut node, mut weight) = (base, 1.0);
        for a in 0..D {
            let up = k >> a & 1;
            node += up * s[a];
            weight *= if up == 1 { part[a] } else { 1.0 - part[a] };
        }
        if weight > 1e-3 && seen(node) {
            out.push((node, weight));
        }
    }
    if out.is_empty() {
        out.extend(around(openings, near).find(|&o| seen(o)).map(|o| (o, 1.0)));
    }
    let sum: f64 = out.iter().map(|o| o.1).sum();
    out.iter_mut().for_each(|o| o.1 /= sum);
    out
}
