//! What looks doubtful about a scene.
mod blockage;
mod contacts;
mod exits;
mod paths;
mod references;
mod units;

use crate::setup::{Algorithm, BodySetup, Setup, SurfaceVelocity, is_open};
use blockage::Blockage;
use coupling::WeightBalance;
use fv_mesh::{Axis, Convection, Profile, Side, WallStress};
use interfaces::{Aabb, LENGTH_PRECISION, ThinPart};

/// Cells so much longer than wide are hardly meant.
const THIN: f64 = 1000.0;
/// Instants at which formulas of the time are looked at.
const INSTANTS: u32 = 256;
/// Friction velocity over the speed of the stream: a friction coefficient of 0.005, that of plates and pipes at Re 10⁴ to 10⁶ within a third.
const FRICTION: f64 = 0.05;
/// Steel in air is 6400 times denser.
const DENSEST: f64 = 3e4;
/// The net weight of a suspension of steel in water is 1.4 times that of the fluid.
const HEAVIEST: f64 = 10.0;

/// Gaps of fewer cells are not resolved: markers of either surface reach across
/// (`ibm::SmoothFilm`).
const UNRESOLVED: f64 = 3.0;

fn norm(u: [f64; 3]) -> f64 {
    u.iter().map(|u| u * u).sum::<f64>().sqrt()
}

/// What enters at `at` \[m\] by this side at `time` \[s\], or how fast its wall moves \[m/s\].
pub(crate) fn speed_at(side: &Side, at: [f64; 3], time: f64) -> f64 {
    match side {
        Side::Wall(u) | Side::Inlet(Profile::Uniform(u)) => norm(*u),
        Side::MovingWall(u) => norm(u.at(at, time)),
        Side::Inlet(Profile::Parabolic { peak }) => peak.abs(),
        Side::Inlet(Profile::Function(u)) => norm(u.at(at, time)),
        Side::Patches(patches) => {
            let of_patch = |p: &fv_mesh::Patch| {
                let middle = |a: usize| 0.5 * (p.lower[a] + p.upper[a]);
                let along = |a: usize| p.lower[a] != p.upper[a];
                speed_at(&p.side, std::array::from_fn(|a| if along(a) { middle(a) } else { at[a] }), time)
            };
            patches.iter().map(of_patch).fold(0.0, f64::max)
        }
        _ => 0.0,
    }
}

impl Setup {
    /// Looks at all formulas of the time alone over the whole run: those without a finite value remember it.
    pub(crate) fn try_formulas(&self) {
        for formula in self.formulas.iter().filter(|f| f.variables == ["t"]) {
            for t in self.instants() {
                formula.expression.needed(&[t]);
            }
        }
    }
    /// Instants from the start to the end \[s\].
    pub(crate) fn instants(&self) -> impl Iterator<Item = f64> + '_ {
        (0..=INSTANTS).map(|i| self.end * f64::from(i) / f64::from(INSTANTS))
    }
    /// Every side of the box: key, what happens there, its middle \[m\].
    pub(crate) fn faces(&self) -> impl Iterator<Item = (String, &Side, [f64; 3])> {
        let middle = |a: usize| self.axes.get(a).map_or(0.0, |axis| 0.5 * (axis.lower() + axis.upper()));
        self.sides.iter().enumerate().flat_map(move |(a, pair)| {
            let ends = [self.axes[a].lower(), self.axes[a].upper()];
            pair.iter().zip(ends).zip(["min", "max"]).map(move |((side, end), name)| {
                let mut at = [0, 1, 2].map(middle);
                at[a] = end;
                (format!("sides.{}_{name}", ["x", "y", "z"][a]), side, at)
            })
        })
    }
    /// Where at `time` \[s\] more than thrice as much enters as at the start: the side's key, and how fast \[m/s\].
    pub(crate) fn rush(&self, time: f64) -> Option<(String, f64)> {
        let grown = |(key, side, at): (String, &Side, [f64; 3])| {
            let [start, now] = [0.0, time].map(|t| speed_at(side, at, t));
            (now > 3.0 * start).then_some((key, now))
        };
        self.faces().filter_map(grown).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Body force per mass \[m/s²\] at `time` \[s\], if it has grown to several times that at the
    /// start.
    pub(crate) fn grown_force(&self, time: f64) -> Option<f64> {
        let force = self.force.as_ref()?;
        let [start, now] = [0.0, time].map(|t| norm(force.each_ref().map(|f| f.at(&[t]))));
        (now > 3.0 * start).then_some(now)
    }

    /// A speed \[m/s\] that the scene is likely to see: of inlets and walls at any time, of bodies, of what falls or is driven.
    pub(crate) fn speed(&self) -> f64 {
        let of_side = |(_, side, at): (String, &Side, [f64; 3])| {
            self.instants().map(|t| speed_at(side, at, t)).fold(0.0, f64::max)
        };
        let sides = self.faces().map(of_side).fold(0.0, f64::max);
        let initial = self.initial_speed();
        let bodies = self.bodies.list.iter().map(|b| {
            let radius = b.shape.bounding_radius();
            let ratio = (b.material.density / self.fluid().density - 1.0).abs();
            let fall = if self.bodies.any_free() {
                (2.0 * radius * ratio * self.gravity.norm()).sqrt()
            } else {
                0.0
            };
            let slides = |surface: &SurfaceVelocity| {
                self.instants().map(|t| surface.speed(&b.shape, t)).fold(0.0, f64::max)
            };
            let slides = b.surface.as_ref().map_or(0.0, slides);
            let prescribed = self.instants().map(|t| self.prescribed_speed(b, t)).fold(0.0, f64::max);
            fall.max(slides).max(prescribed).max(b.twist.linear.norm() + b.twist.angular.norm() * radius)
        });
        let rate = self.flow_rate.as_ref().map_or(0.0, |(_, velocity)| {
            self.instants().map(|t| velocity.at(&[t]).abs()).fold(0.0, f64::max)
        });
        sides.max(initial).max(rate).max(bodies.fold(0.0, f64::max))
    }

    /// Speed \[m/s\] at the start in the middle of the box.
    pub(crate) fn initial_speed(&self) -> f64 {
        let middle =
            [0, 1, 2].map(|a| self.axes.get(a).map_or(0.0, |axis| 0.5 * (axis.lower() + axis.upper())));
        match (&self.start, &self.initial) {
            (Some(field), _) => field.speed(),
            (None, Some(u)) => norm(u.each_ref().map(|u| u.at(&middle))),
            (None, None) => 0.0,
        }
    }

    /// Net weight of the bodies over the weight of all fluid, where the fluid has to bear it.
    fn borne(&self) -> f64 {
        if self.balance != WeightBalance::NetWeight || !self.bodies.any_free() {
            return 0.0;
        }
        let density = self.fluid().density;
        let excess = |b: &BodySetup| (b.material.density / density - 1.0) * b.shape.inertia(1.0).volume;
        let box_: f64 = self.axes.iter().map(Axis::length).product();
        (self.bodies.list.iter().map(excess).sum::<f64>() / box_).abs()
    }

    /// The longest first step \[s\] in which what drives the scene from rest makes no more than the Courant number asked for.
    pub(crate) fn first_step(&self) -> f64 {
        if self.fluid.is_none() {
            return f64::INFINITY;
        }
        let force = self.force.as_ref().map_or(0.0, |f| norm(f.each_ref().map(|f| f.at(&[0.0]))));
        let fall = if self.bodies.any_free() { self.gravity.norm() } else { 0.0 };
        let drive = fall.max(self.borne() * self.gravity.norm()).max(force);
        (self.courant * self.narrowest() / drive).sqrt()
    }

    /// The narrowest cell's width \[m\].
    pub(crate) fn narrowest(&self) -> f64 {
        self.axes.iter().map(Axis::narrowest).fold(f64::INFINITY, f64::min)
    }

    /// y+ of the first cells beside walls, roughly: of a stream with the likely speed, or of a channel that a force drives.
    pub(crate) fn y_plus(&self) -> Option<f64> {
        let fluid = self.fluid.filter(|f| f.viscosity > 0.0)?;
        let mut first = f64::INFINITY;
        let mut friction = FRICTION * self.turbulence.as_ref().and_then(|t| t.speed).unwrap_or(self.speed());
        for (a, axis) in self.axes.iter().enumerate() {
            let faces = axis.faces();
            let ends = [faces[1] - faces[0], faces[faces.len() - 1] - faces[faces.len() - 2]];
            for (width, side) in ends.into_iter().zip(&self.sides[a]) {
                if side.is_wall() {
                    first = first.min(0.5 * width);
                    let force =
                        self.force.as_ref().map_or(0.0, |f| norm(f.each_ref().map(|f| f.at(&[self.end]))));
                    friction = friction.max((0.5 * axis.length() * force).sqrt());
                }
            }
        }
        if !self.bodies.list.is_empty() && !self.bodies_lack_wall_functions() {
            first = first.min(0.5 * self.narrowest());
        }
        (first.is_finite() && friction > 0.0).then(|| first * friction / fluid.viscosity)
    }

    /// Whether a model of two equations meets bodies that give it their distance alone.
    fn bodies_lack_wall_functions(&self) -> bool {
        self.turbulence.as_ref().is_some_and(|t| t.model.averages())
            && self.flow.algorithm != Algorithm::Simple
            && !self.bodies.list.is_empty()
            && !self.walls_move()
    }

    /// Warnings of parts of bodies that are too thin for the grid.
    pub(crate) fn thin_warnings(&self, parts: &[ThinPart]) -> Vec<String> {
        let warning = |part: &ThinPart| {
            format!(
                "body {} is thin at ({}): {:.3e} m thick, where the grid needs {:.3e} m; through parts that thin, {:.0} % of its surface, fluid leaks, and about that share of its loads is lost: take more cells there",
                self.bodies.list[part.body].name,
                part.place_text(),
                part.thickness,
                part.needed,
                (100.0 * part.share).max(1.0)
            )
        };
        parts.iter().map(warning).collect()
    }

    /// Warnings of what looks doubtful.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let mut out = Vec::new();
        if !self.unused.is_empty() {
            out.push(format!(
                "{} is not used by flow.algorithm = \"{}\"; leave it out",
                self.unused.join(", "),
                self.flow.algorithm.word()
            ));
        }
        out.extend_from_slice(&self.doubtful_inlets);
        out.extend_from_slice(&self.mended);
        self.doubt_units(&mut out);
        self.doubt_measures(&mut out);
        self.doubt_contacts(&mut out);
        if self.fluid.is_some() {
            self.doubt_cells(&mut out);
            self.doubt_speeds(&mut out);
            self.doubt_bodies(&mut out);
            self.doubt_box(&mut out);
        }
        self.doubt_exits(&mut out);
        out
    }

    fn doubt_measures(&self, out: &mut Vec<String>) {
        let starts = [
            ("forces", self.forces.filter(|f| !f.steady).map(|f| f.start)),
            ("averages", self.averages.map(|a| a.start)),
        ];
        for (key, start) in starts {
            if let Some(start) = start.filter(|start| *start >= self.end) {
                let end = self.end;
                out.push(format!(
                    "{key}.start = {start} s is not before the end at {end} s: there will be no means"
                ));
            }
        }
    }

    fn doubt_cells(&self, out: &mut Vec<String>) {
        let widths = self.axes.iter().map(|axis| axis.length() / axis.cells() as f64);
        let thin = widths.clone().fold(0.0, f64::max) / widths.fold(f64::INFINITY, f64::min);
        if thin > THIN {
            out.push(format!(
                "cells are {thin:.0} times longer than wide: is the box in metres along all axes?"
            ));
        }
        for (a, axis) in self.axes.iter().enumerate().filter(|(_, axis)| axis.largest_ratio() > 1.3) {
            out.push(format!(
                "cells along {} grow by a factor of {:.2} from one to the next; above 1.2 errors grow with it",
                ["x", "y", "z"][a],
                axis.largest_ratio()
            ));
        }
        if let Some(model) = self.turbulence.as_ref().filter(|_| self.bodies_lack_wall_functions()) {
            out.push(format!(
                "bodies by cut links are no walls to {} in unsteady flow: they have viscous friction, and k is not damped beside them; \
                 take coupling.forcing = \"smooth\" or \"hfdib\", or flow.algorithm = \"simple\"",
                model.model.name()
            ));
        }
        if let (Some(model), Some(y)) = (&self.turbulence, self.y_plus()) {
            let steady = self.flow.algorithm == Algorithm::Simple;
            let by_law = model.model.averages() && (!steady || matches!(model.walls, WallStress::Law { .. }));
            let told = match (by_law, y) {
                (_, ..30.0) if model.model.needs_log_layer() => Some(
                    "models with ε have no terms for the viscous sublayer and want 30 to 300; take wider cells there, or \"sst\" or \"k-omega\"",
                ),
                (true, 12.0..=1000.0) => None,
                (true, ..12.0) if !steady => Some("laws of the wall want 30 to 300; take wider cells there"),
                (true, ..12.0) => Some(
                    "laws of the wall want 30 to 300; take wider cells there, or walls = \"no-slip\" and y+ of 1 for bodies at rest",
                ),
                (true, _) => Some("laws of the wall want 30 to 300; take narrower cells there"),
                (false, ..=4.0) => None,
                _ if model.model.averages() => Some(
                    "\"no-slip\" and \"slip\" ask for a layer that is resolved, to y+ of about 1; take narrower cells there, or the \"log-law\"",
                ),
                _ => Some(
                    "large eddies beside walls want about 1, as they have no law of the wall; take narrower cells there",
                ),
            };
            if let Some(told) = told {
                out.push(format!("the first cells beside walls are at y+ of about {y:.1}: {told}"));
            }
        }
    }

    fn doubt_speeds(&self, out: &mut Vec<String>) {
        let (speed, viscosity) = (self.speed(), self.fluid().viscosity);
        if speed <= 0.0 {
            return;
        }
        let cell = speed * self.narrowest() / viscosity;
        if viscosity > 0.0 && cell > 50.0 && self.flow.convection == Convection::Central {
            out.push(format!(
                "the Reynolds number of a cell is {cell:.0}: central convection may oscillate; take more cells, or convection = \"quick\" or \"limited\""
            ));
        }
        if let Some(dt) = self.dt {
            let rate: f64 = self.axes.iter().map(|axis| speed / axis.narrowest()).sum();
            if rate * dt > 0.5 && self.flow.algorithm == Algorithm::Projection {
                out.push(format!(
                    "time.dt gives a Courant number of about {:.2}; above 0.5 runs may diverge",
                    rate * dt
                ));
            }
        }
    }

    fn doubt_bodies(&self, out: &mut Vec<String>) {
        let list = &self.bodies.list;
        let extent = |b: &BodySetup| {
            let size = b.shape.aabb().posed(&b.pose).extent();
            (0..self.dim()).map(|a| size[a]).fold(f64::INFINITY, f64::min)
        };
        if let Some(least) = list.iter().map(extent).min_by(f64::total_cmp) {
            let cells = least / self.narrowest();
            if cells < 8.0 {
                out.push(format!("the smallest body is {cells:.1} cells across; below 8 its drag is off by 5 % and more: take more cells"));
            }
        }
        let fluid = self.fluid().density;
        let densest = list.iter().filter(|b| matches!(b.motion, crate::setup::Motion::Free(_)));
        if let Some(b) = densest.max_by(|a, b| a.material.density.total_cmp(&b.material.density))
            && b.material.density > DENSEST * fluid
        {
            out.push(format!(
                "body {} is {:.1e} times denser than the fluid, which hardly holds it: it falls as in a vacuum; are both densities in kg/m³?",
                b.name,
                b.material.density / fluid
            ));
        }
        let by_law = self.flow.algorithm == Algorithm::Simple;
        let modelled = self.turbulence.as_ref().is_some_and(|t| t.model.averages());
        if let Some(s) = self.scalars.iter().find(|s| modelled && !by_law && s.bodies.is_some()) {
            out.push(format!(
                "scalars.{}: what modelled eddies bring to bodies is that of the cells beside them, without a law of the wall; that acts on sides of the box, and on bodies in steady flow (flow.algorithm = \"simple\")",
                s.name
            ));
        }
        let borne = self.borne();
        if borne > HEAVIEST {
            out.push(format!(
                "the bodies' net weight, which the fluid has to bear in this periodic box, is {borne:.0} times the fluid's own: it is driven upwards at {borne:.0} g; take walls, a larger box, or coupling.balance = \"none\""
            ));
        }
        let volume: f64 = self.axes.iter().map(Axis::length).product();
        let inside = list.iter().filter(|b| self.holds(b)).map(|b| b.shape.inertia(1.0).volume).sum::<f64>();
        if inside > 0.6 * volume {
            out.push(format!("bodies fill {:.0} % of the box", 100.0 * inside / volume));
        }
    }

    /// Is this body all inside the box? Those that reach beyond it are its walls.
    pub(crate) fn holds(&self, b: &BodySetup) -> bool {
        let bounds = b.shape.aabb().posed(&b.pose);
        let inside =
            |(a, axis): (usize, &Axis)| bounds.min[a] >= axis.lower() && bounds.max[a] <= axis.upper();
        self.axes.iter().enumerate().all(inside)
    }

    /// The size of the box beside that of the bodies: blockage, and how far open sides and periodic images are.
    fn doubt_box(&self, out: &mut Vec<String>) {
        let bounds: Vec<Aabb> = self
            .bodies
            .list
            .iter()
            .filter(|b| self.holds(b))
            .map(|b| b.shape.aabb().posed(&b.pose))
            .collect();
        let dim = self.dim();
        for (a, axis) in self.axes.iter().enumerate() {
            let (name, pair) = (["x", "y", "z"][a], &self.sides[a]);
            let across = |b: &Aabb| (0..dim).filter(|&c| c != a).map(|c| b.extent()[c]).fold(0.0, f64::max);
            let widest = bounds.iter().map(|b| b.extent()[a]).fold(0.0, f64::max);
            if matches!(pair[0], Side::Periodic) && widest > axis.length() / 3.0 {
                out.push(format!(
                    "along {name} the period is {:.1} times the largest body's size: it feels its own images; from 3 on less so",
                    axis.length() / widest
                ));
            }
            let (gap, cell) = (axis.length() - widest, axis.length() / axis.cells() as f64);
            let closed = gap <= LENGTH_PRECISION * axis.length();
            if matches!(pair[0], Side::Periodic) && !closed && gap < UNRESOLVED * cell {
                out.push(format!(
                    "along {name} the largest body is {:.2} cells shorter than the period: flow through the gap to its own image is not resolved; make the body as long as the period, which closes it, or the gap wider than {UNRESOLVED:.0} cells",
                    gap / cell
                ));
            }
            let open = |side: &Side| is_open(side);
            if !pair.iter().any(open) {
                continue;
            }
            // The flow is along this axis.
            let Blockage { share, at, bodies } = self.blockage(a);
            if share > [0.3, 0.1][dim - 2] {
                out.push(format!(
                    "{} {:.0} % of the section normal to {name} at {name} = {at:.4e} m: drag there is that in a channel, not in an unbounded stream",
                    if bodies == 1 { "a body blocks" } else { "bodies block" },
                    100.0 * share
                ));
            }
            for (end, side) in pair.iter().enumerate().filter(|(_, side)| open(side)) {
                let entering = matches!(side, Side::Inlet(_));
                let (least, word) = if entering { (1.0, "inlet") } else { (3.0, "outlet") };
                let room = |b: &Aabb| {
                    let gap = if end == 0 { b.min[a] - axis.lower() } else { axis.upper() - b.max[a] };
                    gap / across(b)
                };
                let nearest = bounds.iter().map(room).fold(f64::INFINITY, f64::min);
                if nearest < least && !self.bodies.any_free() {
                    out.push(format!(
                        "the {word} at {name}_{} is {nearest:.1} sizes of a body away from it; below {least:.0} it acts on the flow around the body: take a longer box",
                        ["min", "max"][end]
                    ));
                }
            }
        }
    }
}
