//! Viscous terms along cut links.
use super::Step;
use crate::CartesianGrid;
use crate::grid::GHOSTS;
use crate::metrics::Metrics;
use interfaces::{CutComponent, Vector, Wrench};

/// The nodes of one component that walls touch.
///
/// With the wall at the distances h_a and h_b from a node (those of the neighbours where a link is whole) the second
/// difference of Shortley & Weller (1938) along an axis,
///
/// ```text
/// s − d u,   s = 2 (u_a/h_a + u_b/h_b)/(h_a + h_b),   d = 2/(h_a h_b)
/// ```
///
/// replaces the plain one: s of the old velocity, d of the new, however near the wall is.
#[derive(Clone, Debug)]
pub(super) struct Links<const D: usize> {
    /// The component.
    c: usize,
    nodes: Vec<Node>,
    /// Control volumes of the nodes inside.
    solid_volumes: Vec<f64>,
    /// ν times the plain second difference along cut axes in the last step, per node.
    pub(super) plain: Vec<f64>,
    stride: [usize; D],
}

/// What a node in the fluid needs.
#[derive(Clone, Debug)]
struct Node {
    volume: f64,
    /// The axes along which a link is cut.
    axes: Vec<AxisLinks>,
}

#[derive(Clone, Copy, Debug)]
struct AxisLinks {
    axis: usize,
    /// Coefficients of the values below and above in s.
    cut: [f64; 2],
    /// The same in the plain difference.
    plain: [f64; 2],
}

impl<const D: usize> Links<D> {
    pub(super) fn new(
        component: &CutComponent,
        grid: &CartesianGrid<D>,
        metrics: &Metrics<D>,
        c: usize,
    ) -> Self {
        let cell = |index: usize| grid.cell_at(index).unwrap_or([0; D]);
        let volume = |index: usize| -> f64 {
            let cell = cell(index);
            (0..D).map(|a| metrics.of(Some(c), a).volume[GHOSTS + cell[a]]).product()
        };
        let nodes = component.links.iter().map(|node| {
            let cell = cell(node.index);
            let cut_axes = (0..D).filter(|&a| node.links[a].iter().any(Option::is_some));
            let axes = cut_axes.map(|axis| {
                let (m, j) = (metrics.of(Some(c), axis), GHOSTS + cell[axis]);
                let gaps = [1.0 / m.inv_gap[j], 1.0 / m.inv_gap[j + 1]];
                let [a, b] =
                    [0, 1].map(|side| node.links[axis][side].map_or(gaps[side], |l| l.fraction * gaps[side]));
                let cut = [2.0 / (a * (a + b)), 2.0 / (b * (a + b))];
                AxisLinks { axis, cut, plain: [m.down[j], m.up[j]] }
            });
            Node { volume: volume(node.index), axes: axes.collect() }
        });
        Self {
            c,
            nodes: nodes.collect(),
            solid_volumes: component.solid.iter().map(|point| volume(point.index)).collect(),
            plain: vec![0.0; component.links.len()],
            stride: grid.stride(),
        }
    }

    /// See [`Walls::hold`](super::Walls::hold).
    pub(super) fn hold(
        &mut self,
        component: &CutComponent,
        step: Step,
        old: &[f64],
        next: &mut [f64],
        impulses: &mut [Wrench],
    ) {
        let Step { dt, weights, viscosity, density } = step;
        for ((node, own), last) in component.links.iter().zip(&self.nodes).zip(&mut self.plain) {
            let (o, u) = (node.index, old[node.index]);
            let (mut plain, mut s, mut d) = (0.0, 0.0, 0.0);
            for links in &own.axes {
                let neighbours = [old[o - self.stride[links.axis]], old[o + self.stride[links.axis]]];
                for side in 0..2 {
                    plain += links.plain[side] * (neighbours[side] - u);
                    let beyond = node.links[links.axis][side].map_or(neighbours[side], |link| link.velocity);
                    s += links.cut[side] * beyond;
                    d += links.cut[side];
                }
            }
            plain *= viscosity;
            let explicit = next[o] - dt * (weights[0] * plain + weights[1] * *last);
            *last = plain;
            let new = (explicit + dt * viscosity * s) / (1.0 + dt * viscosity * d);
            impulses[node.body] += along(self.c, density * own.volume * (next[o] - new), node.arm);
            next[o] = new;
        }
    }

    /// See [`Walls::hold_solid`](super::Walls::hold_solid).
    pub(super) fn hold_solid(
        &self,
        component: &CutComponent,
        density: f64,
        u: &mut [f64],
        impulses: &mut [Wrench],
    ) {
        for (point, volume) in component.solid.iter().zip(&self.solid_volumes) {
            let impulse = density * volume * (u[point.index] - point.velocity);
            impulses[point.body] += along(self.c, impulse, point.arm);
            u[point.index] = point.velocity;
        }
    }
}

/// An impulse along axis `c`.
fn along(c: usize, impulse: f64, arm: Vector) -> Wrench {
    let mut force = Vector::zeros();
    force[c] = impulse;
    Wrench::at(force, arm)
}
