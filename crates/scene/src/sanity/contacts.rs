//! Warnings about contacts.
use crate::setup::{BodySetup, ContactLawChoice, Motion, Setup, WallSetup};
use dem::{ContactLaw, DEEP, PairProperties, RestingDepth, Rolling, resting_depth};
use fv_mesh::Side;
use interfaces::Vector;
use std::sync::Arc;

/// Share of the space that a pile of bodies fills: loose packings of spheres have 0.55 to 0.64.
const PACKING: f64 = 0.6;

/// A body that will rest on a wall.
struct Rest<'a> {
    body: &'a BodySetup,
    wall: &'a WallSetup,
    /// Layers of bodies on it, itself counted.
    layers: f64,
    depth: RestingDepth,
}

impl Setup {
    pub(super) fn doubt_contacts(&self, out: &mut Vec<String>) {
        let bodies = &self.bodies;
        if !bodies.unused.is_empty() {
            out.push(format!(
                "{} is not used by contact.law = \"{}\"; leave it out, or take a law that uses it",
                bodies.unused.join(", "),
                bodies.law.word()
            ));
        }
        if bodies.law == ContactLawChoice::Potential && !bodies.too_plastic.is_empty() {
            let least = PairProperties::LEAST_RESTITUTION;
            out.push(format!(
                "{} is below {least} and counts as {least} in contact.law = \"potential\", whose damping has no end as it goes to 0; give {least} or more",
                bodies.too_plastic.join(", ")
            ));
        }
        if bodies.law == ContactLawChoice::None {
            if bodies.any_free() && !bodies.walls.is_empty() {
                out.push(format!(
                    "contact.law = \"none\": bodies pass through one another and through {}, and leave the box{}; take \"chen\" or \"potential\" to hold them, or give `exits` where they may go",
                    bodies.walls.iter().map(|w| w.name.as_str()).collect::<Vec<_>>().join(", "),
                    if self.fluid.is_some() { ", which ends the run" } else { "" },
                ));
            }
            return;
        }
        for (a, pair) in self.sides.iter().enumerate().filter(|_| bodies.any_free()) {
            for (side, end) in pair.iter().zip(["min", "max"]) {
                if let Side::Patches(patches) = side
                    && patches.iter().any(|p| p.side.is_wall())
                {
                    let axis = ["x", "y", "z"][a];
                    out.push(format!("sides.{axis}_{end} has parts, whose walls bodies do not touch; give contact.planes where they should"));
                }
            }
        }
        if let Some(Rest { body, wall, layers, depth }) = self.deepest_rest() {
            let ratio = depth.depth / depth.radius;
            if ratio > DEEP {
                let pile = if layers > 1.0 {
                    format!(" and that of a pile about {layers:.0} bodies high")
                } else {
                    String::new()
                };
                out.push(format!(
                    "body {} will rest {} % of its radius (of a body as large) deep in {}, under its weight less buoyancy{pile}; contact laws are made for up to {:.0} %: give the materials of both a youngs_modulus of {:.2e} Pa or more",
                    body.name,
                    if ratio < 1.0 { format!("{:.0}", 100.0 * ratio) } else { "100 or more".into() },
                    wall.name,
                    100.0 * DEEP,
                    depth.youngs_modulus,
                ));
            }
        }
    }

    /// The body that weight or buoyancy presses into a wall deepest.
    fn deepest_rest(&self) -> Option<Rest<'_>> {
        match self.bodies.law {
            _ if self.bodies.repulsion.is_some() => None,
            ContactLawChoice::Chen => self.rest_by(&self.chen()),
            ContactLawChoice::Potential => self.rest_by(&self.potential()),
            ContactLawChoice::Rolling => self.rest_by(&Rolling(self.chen())),
            ContactLawChoice::None => None,
        }
    }

    fn rest_by<L: ContactLaw>(&self, law: &L) -> Option<Rest<'_>> {
        let heaps = self.heaps();
        let mut last = None;
        let rests = self.bodies.list.iter().filter_map(|body| self.rest_of(law, body, &heaps, &mut last));
        let ratio = |r: &Rest<'_>| r.depth.depth / r.depth.radius;
        rests.max_by(|a, b| ratio(a).total_cmp(&ratio(b)))
    }

    /// Depth at which `body` will rest, shared with `last`, the last body so computed, if both are
    /// alike.
    fn rest_of<'a, L: ContactLaw>(
        &'a self,
        law: &L,
        body: &'a BodySetup,
        heaps: &[f64; 2],
        last: &mut Option<(&'a BodySetup, f64, RestingDepth)>,
    ) -> Option<Rest<'a>> {
        let Motion::Free(freedom) = &body.motion else { return None };
        let net = self.net_weight(body);
        let free = |a: usize| freedom.linear[a] || net[a] == 0.0;
        if body.tether.is_some() || !(0..3).all(free) {
            return None;
        }
        // The wall that bears the most of it.
        let pressed = |w: &WallSetup| -w.plane.normal().dot(&net);
        let wall = self.bodies.walls.iter().max_by(|a, b| pressed(a).total_cmp(&pressed(b)))?;
        let load = pressed(wall);
        if load <= 1e-6 * net.norm() {
            return None;
        }
        let layers = self.layers(body, &net, heaps);
        let force = load * layers;
        let depth = match last {
            Some((other, same, depth))
                if Arc::ptr_eq(&other.shape, &body.shape)
                    && other.material == body.material
                    && *same == force =>
            {
                *depth
            }
            _ => {
                let material = &self.bodies.wall_material;
                let depth = resting_depth(law, body.shape.clone(), &body.material, material, force)?;
                *last = Some((body, force, depth));
                depth
            }
        };
        Some(Rest { body, wall, layers, depth })
    }

    /// Weight less buoyancy \[N\]; in a plane scene per metre of depth.
    fn net_weight(&self, body: &BodySetup) -> Vector {
        let inertia = body.shape.inertia(body.material.density);
        let displaced = self.fluid.map_or(0.0, |f| f.density * inertia.volume);
        self.gravity * (inertia.mass - displaced)
    }

    /// Volumes \[m³\] of all free bodies that sink and of those that rise.
    fn heaps(&self) -> [f64; 2] {
        let mut heaps = [0.0; 2];
        for body in self.bodies.list.iter().filter(|b| matches!(b.motion, Motion::Free(_))) {
            let along = self.net_weight(body).dot(&self.gravity);
            if along != 0.0 {
                heaps[usize::from(along < 0.0)] += body.shape.inertia(1.0).volume;
            }
        }
        heaps
    }

    /// Number of layers if all bodies that are pressed the same way lie in a heap over the whole box.
    fn layers(&self, body: &BodySetup, net: &Vector, heaps: &[f64; 2]) -> f64 {
        let down = net.iamax();
        let across: f64 =
            self.axes.iter().enumerate().filter(|(a, _)| *a != down).map(|(_, axis)| axis.length()).product();
        let volume = heaps[usize::from(net.dot(&self.gravity) < 0.0)];
        let own = body.shape.inertia(1.0).volume;
        let size = if self.dim() == 2 { own.sqrt() } else { own.cbrt() };
        (volume / (PACKING * across * size)).max(1.0)
    }
}
