//! Whether bodies can reach the exits, and where they leave without one.
use crate::setup::{ContactLawChoice, Motion, Setup, is_open};
use dem::{HalfSpace, Shape};
use fv_mesh::Side;
use interfaces::{Point, Vector};

/// A side of the box.
#[derive(Clone, Copy)]
struct Place {
    axis: usize,
    end: usize,
}

impl Place {
    fn name(self) -> String {
        format!("{}_{}", ["x", "y", "z"][self.axis], ["min", "max"][self.end])
    }
    fn outwards(self) -> Vector {
        let sign = if self.end == 0 { -1.0 } else { 1.0 };
        Vector::from_fn(|a, _| if a == self.axis { sign } else { 0.0 })
    }
}

impl Setup {
    fn places(&self) -> impl Iterator<Item = (Place, &Side)> {
        let pairs = self.sides.iter().enumerate();
        pairs.flat_map(|(axis, pair)| {
            pair.iter().enumerate().map(move |(end, side)| (Place { axis, end }, side))
        })
    }
    fn coordinate(&self, place: Place) -> f64 {
        let axis = &self.axes[place.axis];
        if place.end == 0 { axis.lower() } else { axis.upper() }
    }
    /// Shapes of bodies that the flow moves, or will.
    fn movable(&self) -> impl Iterator<Item = &dyn Shape> {
        let list = self.bodies.list.iter().filter(|b| matches!(b.motion, Motion::Free(_)));
        list.map(|b| &*b.shape).chain(self.bodies.inflows.iter().flat_map(|i| i.shapes.iter().map(|s| &**s)))
    }

    pub(super) fn doubt_exits(&self, out: &mut Vec<String>) {
        for (k, exit) in self.bodies.exits.iter().enumerate() {
            self.doubt_exit(k, exit, out);
        }
        self.doubt_openings(out);
    }

    fn doubt_exit(&self, k: usize, exit: &HalfSpace, out: &mut Vec<String>) {
        let inside: Vec<&str> = self
            .bodies
            .list
            .iter()
            .filter(|b| exit.signed_distance(b.pose.position) < 0.0)
            .map(|b| b.name.as_str())
            .collect();
        if let Some(first) = inside.first() {
            out.push(format!(
                "exits.{k} holds the centres of {} bodies at the start (\"{first}\" is the first), which are removed at once; its normal has to point away from the half-space in which bodies leave",
                inside.len()
            ));
        }
        for inflow in &self.bodies.inflows {
            let (min, max) = (inflow.region.min, inflow.region.max);
            let nearest =
                Point::from([0, 1, 2].map(|a| if exit.normal()[a] > 0.0 { max[a] } else { min[a] }));
            if exit.signed_distance(nearest) < 0.0 {
                out.push(format!(
                    "{} is all inside exits.{k}: its bodies are removed as soon as they are there",
                    inflow.origin
                ));
            }
        }
        let normal = exit.normal();
        for a in (0..self.dim()).filter(|&a| normal[a] != 0.0 && self.periodic(a)) {
            out.push(format!(
                "exits.{k} has a normal along the periodic axis {}: it acts on places as they are in trajectories.csv, not on their periodic images",
                ["x", "y", "z"][a]
            ));
        }
        // The farthest place towards the exit that a centre can have.
        let touches = self.bodies.touch_walls && self.bodies.law != ContactLawChoice::None;
        let inner =
            |shape: &dyn Shape| (-shape.signed_distance(Point::origin(), shape.bounding_radius())).max(0.0);
        let Some(clearance) = self.movable().map(inner).min_by(f64::total_cmp) else { return };
        let clearance = if touches { clearance } else { 0.0 };
        let mut farthest = Point::origin();
        let mut walls = Vec::new();
        for (place, side) in self.places() {
            let (a, towards) = (place.axis, -normal.dot(&place.outwards()));
            if towards <= 0.0 {
                continue;
            }
            if !side.is_wall() && !matches!(side, Side::FreeSlip) {
                return self.doubt_distance(k, exit, place, out);
            }
            farthest[a] = self.coordinate(place) - clearance * place.outwards()[a];
            walls.push(place.name());
        }
        let short = exit.signed_distance(farthest);
        if short > 0.0 || (short == 0.0 && clearance > 0.0) {
            out.push(format!(
                "exits.{k} never acts: {} is a wall, which keeps centres of bodies {clearance:.3e} m and more inside, {short:.3e} m in front of the exit; move the exit at least so far into the box, or make the side one that bodies can pass",
                walls.join(", ")
            ));
        }
    }

    /// An exit at or beyond an open side.
    fn doubt_distance(&self, k: usize, exit: &HalfSpace, place: Place, out: &mut Vec<String>) {
        let (n, o) = (exit.normal(), place.outwards());
        if n.dot(&o) > -1.0 + 1e-12 {
            return;
        }
        let at =
            Point::from(Vector::from_fn(|a, _| if a == place.axis { self.coordinate(place) } else { 0.0 }));
        let beyond = exit.signed_distance(at);
        let largest = self.movable().map(Shape::bounding_radius).fold(0.0, f64::max);
        if self.fluid.is_some() && beyond > largest {
            out.push(format!(
                "exits.{k} is {beyond:.3e} m beyond the side {}: bodies are without fluid between the two, where only their weight less buoyancy moves them",
                place.name()
            ));
        }
    }

    /// Open sides through which bodies are carried with no exit ahead, and walls of patches.
    fn doubt_openings(&self, out: &mut Vec<String>) {
        if !self.bodies.any_free() {
            return;
        }
        for (place, side) in self.places() {
            let leaves = |exit: &HalfSpace| exit.normal().dot(&place.outwards()) < 0.0;
            let outlet = matches!(side, Side::ConvectiveOutlet | Side::PressureOutlet(_));
            if self.fluid.is_some()
                && outlet
                && !self.bodies.inflows.is_empty()
                && !self.bodies.exits.iter().any(leaves)
            {
                out.push(format!(
                    "bodies come in, and no exit is ahead of the open side {}: the run ends with an error when one has passed it; give `exits` there",
                    place.name()
                ));
            }
            let walled = |p: &fv_mesh::Patch| p.side.is_wall() || matches!(p.side, Side::FreeSlip);
            if let Side::Patches(patches) = side
                && self.bodies.law != ContactLawChoice::None
                && patches.iter().any(walled)
            {
                let open = if is_open(side) { ", which is open in part" } else { "" };
                out.push(format!(
                    "bodies touch no walls of the side {}, whose type is \"patches\"{open}: they pass through them; give contact.planes where there is a wall",
                    place.name()
                ));
            }
        }
    }
}
