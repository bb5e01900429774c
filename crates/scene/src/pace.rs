//! Steps of an unsteady run, estimated before it.
use crate::rehearsal::Rehearsal;
use crate::sanity::speed_at;
use crate::setup::{BodySetup, Motion, Setup};
use fv_mesh::Axis;

/// Parts that a run is cut into at least, whose speeds are found one by one.
const PARTS: usize = 64;
/// More output intervals than this are not looked at one by one.
const MOST_INTERVALS: usize = 20_000;
/// Free bodies that are looked at, at most.
const MOST_BODIES: usize = 256;
/// Steps that a start from rest takes beyond those of full length: Σ(1 − 0.05·1.15ⁿ).
const RAMP: f64 = 15.0;
/// Σ|u_a| of the components across the main flow, over its speed: next to bodies, and without any.
const ACROSS: [f64; 2] = [1.0, 0.5];

/// Diameter of the disc or ball with this area or volume \[m\].
pub(crate) fn equivalent_diameter(volume: f64, dim: usize) -> f64 {
    let pi = std::f64::consts::PI;
    if dim == 2 { (4.0 * volume / pi).sqrt() } else { (6.0 * volume / pi).cbrt() }
}

/// Mean length and number of steps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pace {
    /// \[s\].
    pub(crate) dt: f64,
    pub(crate) steps: f64,
}

impl Setup {
    /// Steps of at most `longest` \[s\] with the speeds of a rehearsal; without one with those that
    /// sides, forces and bodies are likely to make, `rate` being the initial field's Σ max|u_a|/h_a
    /// \[1/s\].
    pub(crate) fn expected_steps(&self, longest: f64, rate: f64, rehearsal: Option<&Rehearsal>) -> Pace {
        let intervals = self.output.snapshots.max(1);
        let parts = PARTS.div_ceil(intervals);
        let decay = self.decay();
        let full = |time: f64| match self.dt {
            Some(dt) => dt,
            None => {
                let likely = |time: f64| self.expected_rate(time).max(rate * (-decay * time).exp());
                let rate = match rehearsal {
                    Some(rehearsal) => rehearsal.rate(time, likely),
                    None => likely(time),
                };
                longest.min(self.courant / rate).min(self.end)
            }
        };
        let mut steps = 0.0;
        let looked_at = intervals.min(MOST_INTERVALS);
        for interval in 0..looked_at {
            let part = self.end / (looked_at * parts) as f64;
            let of = |k: usize| part / full(((interval * parts + k) as f64 + 0.5) * part);
            let of_interval = (0..parts).map(of).sum::<f64>();
            // Intervals are cut into equal steps.
            steps += if looked_at == intervals { (of_interval - 1e-6).ceil().max(1.0) } else { of_interval };
        }
        if self.ramp && self.dt.is_none() {
            steps += RAMP;
        }
        let steps = steps.ceil().max(intervals as f64);
        Pace { dt: self.dt.unwrap_or(self.end / steps), steps }
    }

    /// Σ|u_a|/h_a \[1/s\] that sides, forces and bodies are likely to make at `time` \[s\].
    fn expected_rate(&self, time: f64) -> f64 {
        let sides = self.faces().map(|(_, side, at)| speed_at(side, at, time)).fold(0.0, f64::max);
        let stride = self.bodies.list.len().div_ceil(MOST_BODIES).max(1);
        let looked_at = |(i, b): &(usize, &BodySetup)| {
            i.is_multiple_of(stride) || matches!(b.motion, Motion::Prescribed { .. })
        };
        let bodies = self.bodies.list.iter().enumerate().filter(looked_at);
        let bodies = bodies.map(|(_, b)| self.body_speed(b, time)).fold(0.0, f64::max);
        let entrants = self.bodies.inflows.iter().filter(|inflow| inflow.start <= time).flat_map(|inflow| {
            let density = inflow.material.density;
            inflow.shapes.iter().map(move |shape| self.settling_speed(&**shape, density, time - inflow.start))
        });
        let speed = sides.max(self.driven_speed(time)) + bodies.max(entrants.fold(0.0, f64::max));
        let any = !self.bodies.list.is_empty() || !self.bodies.inflows.is_empty();
        let across = match any {
            true => ACROSS[0] / (self.dim() - 1) as f64,
            false => ACROSS[1],
        };
        let widths = self.axes.iter().map(|axis| 1.0 / axis.narrowest());
        let narrowest = widths.clone().fold(0.0, f64::max);
        speed * (narrowest * (1.0 - across) + across * widths.sum::<f64>())
    }

    /// Speed of a body and its surface \[m/s\].
    fn body_speed(&self, b: &BodySetup, time: f64) -> f64 {
        let radius = b.shape.bounding_radius();
        let own = match &b.motion {
            Motion::Fixed => 0.0,
            Motion::Prescribed { .. } => self.prescribed_speed(b, time),
            Motion::Free(_) if b.tether.is_some() => 0.0,
            Motion::Free(_) => {
                let given = b.twist.linear.norm() + b.twist.angular.norm() * radius;
                self.settling_speed(&*b.shape, b.material.density, time).max(given)
            }
        };
        own + b.surface.as_ref().map_or(0.0, |surface| surface.speed(&b.shape, time))
    }

    /// Speed of the surface of a body that moves by formulas \[m/s\]; 0 for others.
    pub(crate) fn prescribed_speed(&self, b: &BodySetup, time: f64) -> f64 {
        let Some(motion) = b.motion.prescribed(b.pose.position) else { return 0.0 };
        let twist = motion.velocity(time, 1e-3 * self.end);
        let speed = twist.linear.norm() + twist.angular.norm() * b.shape.bounding_radius();
        if speed.is_finite() { speed } else { 0.0 }
    }

    /// Speed of a body that falls or rises from rest for `time` \[s\], at most the terminal one of
    /// a sphere (Schiller & Naumann 1935) or a cylinder (c_d = 1 + 10 Re^(−2/3), White 2006) of the
    /// same volume \[m/s\].
    pub(crate) fn settling_speed(&self, shape: &dyn dem::Shape, density: f64, time: f64) -> f64 {
        let (fluid, dim) = (self.fluid(), self.dim());
        let gravity = self.gravity.norm();
        if gravity == 0.0 || fluid.density <= 0.0 {
            return 0.0;
        }
        let ratio = density / fluid.density;
        let volume = shape.inertia(1.0).volume;
        let size = equivalent_diameter(volume, dim);
        let area = if dim == 2 { size } else { 0.25 * std::f64::consts::PI * size * size };
        let pull = (ratio - 1.0).abs() * gravity;
        let mut speed = (size * pull).sqrt();
        if speed == 0.0 {
            return 0.0;
        }
        for _ in 0..40 {
            let re = speed * size / fluid.viscosity.max(1e-12 * speed * size);
            let drag = match dim {
                2 => 1.0 + 10.0 * re.powf(-2.0 / 3.0),
                _ => 24.0 / re * (1.0 + 0.15 * re.powf(0.687)) + 0.42 / (1.0 + 42_500.0 * re.powf(-1.16)),
            };
            let new = (2.0 * volume * pull / (area * drag)).sqrt();
            speed = (speed * new).sqrt();
        }
        // Added mass of half the displaced fluid.
        speed.min(pull / (ratio + 0.5) * time)
    }

    /// Mean speed that the body force has made at `time` \[s\]: at most that of laminar flow in a
    /// pipe of the hydraulic diameter 4 V/S, and that of smooth friction (Blasius), twice over for
    /// its peak \[m/s\].
    fn driven_speed(&self, time: f64) -> f64 {
        let Some(force) = &self.force else { return 0.0 };
        let at = force.each_ref().map(|f| f.at(&[time]));
        let force = at.iter().map(|f| f * f).sum::<f64>().sqrt();
        let sizes: Vec<f64> = self.axes.iter().map(Axis::length).collect();
        let box_: f64 = sizes.iter().product();
        let mut solid = 0.0;
        let mut surface: f64 = (0..self.dim())
            .flat_map(|a| self.sides[a].iter().map(move |side| (a, side)))
            .filter(|(_, side)| side.is_wall())
            .map(|(a, _)| box_ / sizes[a])
            .sum();
        for b in self.bodies.list.iter().filter(|b| self.holds(b)) {
            let (volume, r) = (b.shape.inertia(1.0).volume, b.shape.bounding_radius());
            solid += volume;
            // Exact for balls.
            surface += self.dim() as f64 * volume / r;
        }
        let free = force * time;
        if surface <= 0.0 {
            return free;
        }
        let width = 4.0 * (box_ - solid).max(0.0) / surface;
        let nu = self.fluid().viscosity;
        if nu <= 0.0 {
            return free;
        }
        let laminar = force * width * width / (32.0 * nu);
        let turbulent = (2.0 * force * width / 0.02).sqrt();
        free.min(2.0 * laminar.min(turbulent))
    }

    /// Rate at which the initial speeds decay at least \[1/s\], where nothing drives the flow: that
    /// of the box's gravest viscous mode.
    fn decay(&self) -> f64 {
        let driven = self.expected_rate(self.end) > 0.0 || self.scalars.iter().any(|s| s.buoyancy.is_some());
        if driven {
            return 0.0;
        }
        let pi = std::f64::consts::PI;
        let wave = |(a, axis): (usize, &Axis)| {
            let pair = &self.sides[a];
            let number = match pair {
                _ if self.periodic(a) => 2.0 * pi / axis.length(),
                [low, high] if low.is_wall() && high.is_wall() => pi / axis.length(),
                _ => 0.0,
            };
            number * number
        };
        self.fluid().viscosity * self.axes.iter().enumerate().map(wave).sum::<f64>()
    }
}
