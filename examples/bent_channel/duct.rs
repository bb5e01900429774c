//! The duct: straight, bent by any angle about the origin, straight again; all turned about the origin.
use siltflow::interfaces::{Aabb, Point, Solid, Vector};
use std::f64::consts::{FRAC_PI_2, PI};

/// Everything outside a duct of height 1 m. Before it is turned, it comes along +x at y = −2 … −1, and bends between the radii 1
/// and 2 about the origin.
#[derive(Clone, Copy)]
pub(crate) struct Duct {
    /// Angle of the bend, 0 to π.
    pub(crate) bend: f64,
    /// Angle by which everything is turned.
    pub(crate) turn: f64,
}

impl Duct {
    /// From the world into the frame in which the fluid enters along +x.
    fn own(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (s, c) = self.turn.sin_cos();
        [c * x + s * y, c * y - s * x]
    }
    /// Into the world.
    pub(crate) fn world(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (s, c) = self.turn.sin_cos();
        [c * x - s * y, s * x + c * y]
    }
    /// The end of the bend: where from the origin, and which way the fluid goes.
    fn end(&self) -> [[f64; 2]; 2] {
        let angle = self.bend - FRAC_PI_2;
        [[angle.cos(), angle.sin()], [-angle.sin(), angle.cos()]]
    }
    /// The point at `s` \[m\] along the centreline from the bend's start and at radius `r`.
    pub(crate) fn point(&self, s: f64, r: f64) -> [f64; 2] {
        let length = 1.5 * self.bend;
        self.world(if s < 0.0 {
            [s, -r]
        } else if s < length {
            let angle = s / 1.5 - FRAC_PI_2;
            [r * angle.cos(), r * angle.sin()]
        } else {
            let [e, t] = self.end();
            [0, 1].map(|a| r * e[a] + (s - length) * t[a])
        })
    }
    /// How far along the centreline a place in the duct or on its walls is, and at which radius.
    pub(crate) fn place(&self, x: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.own(x);
        let angle = (y.atan2(x) + FRAC_PI_2).rem_euclid(2.0 * PI);
        let [e, t] = self.end();
        if x < 0.0 && y < 0.0 {
            [x, -y]
        } else if angle < self.bend {
            [1.5 * angle, x.hypot(y)]
        } else {
            [1.5 * self.bend + x * t[0] + y * t[1], x * e[0] + y * e[1]]
        }
    }
    /// The way along the duct there.
    pub(crate) fn along(&self, s: f64) -> [f64; 2] {
        let angle = (s / 1.5).clamp(0.0, self.bend);
        self.world([angle.cos(), angle.sin()])
    }
    /// The way along the duct at a place in it.
    pub(crate) fn along_at(&self, x: [f64; 2]) -> [f64; 2] {
        self.along(self.place(x)[0])
    }
    /// Distance from the nearest wall, positive in the fluid.
    pub(crate) fn distance(&self, x: [f64; 2]) -> f64 {
        let [x, y] = self.own(x);
        let mut off = f64::INFINITY;
        if x <= 0.0 {
            off = off.min((y + 1.5).abs());
        }
        let angle = (y.atan2(x) + FRAC_PI_2).rem_euclid(2.0 * PI);
        if angle <= self.bend {
            off = off.min((x.hypot(y) - 1.5).abs());
        }
        let [e, t] = self.end();
        if x * t[0] + y * t[1] >= 0.0 {
            off = off.min((x * e[0] + y * e[1] - 1.5).abs());
        }
        0.5 - off.min(10.0)
    }
}

impl Solid for Duct {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        self.distance([x.x, x.y])
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::new(100.0, 100.0, 0.0))
    }
}
