//! The deepest overlap of a run.
use crate::setup::Setup;
use crate::view::View;
use coupling::StepInfo;
use dem::{DEEP, Depth, Partner};
use interfaces::RestartError;
use serde_json::{Value, json};

/// Steps between looks at the overlaps, besides those with a snapshot: what rests is deep in all of them.
const LOOK_EVERY: u64 = 16;

/// The deepest overlap so far, as numbers for restarts; depth 0 before any.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Deepest {
    depth: f64,
    radius: f64,
    youngs_modulus: f64,
    time: f64,
    point: [f64; 3],
    /// Number of a body that stays when others are removed.
    body: f64,
    /// The same of its partner, or, of a wall, its number counted down from −1.
    partner: f64,
}

impl Deepest {
    pub(crate) fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        let Self { depth, radius, youngs_modulus, time, point: [x, y, z], body, partner } = *self;
        sink("deepest", &[depth, radius, youngs_modulus, time, x, y, z, body, partner]);
    }
    pub(crate) fn restore<'a>(source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<Self, RestartError> {
        let v = RestartError::take(source, "deepest", 9)?;
        let point = [v[4], v[5], v[6]];
        let [depth, radius, youngs_modulus, time] = [v[0], v[1], v[2], v[3]];
        Ok(Self { depth, radius, youngs_modulus, time, point, body: v[7], partner: v[8] })
    }

    fn ratio(&self) -> f64 {
        if self.radius > 0.0 { self.depth / self.radius } else { 0.0 }
    }
    fn is_deep(&self) -> bool {
        self.ratio() > DEEP
    }

    /// Looks at the overlaps of a step; whether one is the first of the run that is deep.
    pub(crate) fn look(&mut self, view: &dyn View, info: &StepInfo) -> bool {
        if info.snapshot.is_none() && !info.step.is_multiple_of(LOOK_EVERY) {
            return false;
        }
        let Some(Depth { body, partner, point, depth, radius, youngs_modulus }) = view.deepest() else {
            return false;
        };
        let was_deep = self.is_deep();
        if depth / radius > self.ratio() {
            let partner = match partner {
                Partner::Body(b, _) => view.serial(b) as f64,
                Partner::Wall(wall) => -1.0 - wall as f64,
            };
            let (body, point) = (view.serial(body) as f64, point.into());
            *self = Self { depth, radius, youngs_modulus, time: info.time, point, body, partner };
        }
        self.is_deep() && !was_deep
    }

    fn name(setup: &Setup, number: f64) -> String {
        if number < 0.0 {
            let wall = setup.bodies.walls.get((-1.0 - number) as usize);
            return wall.map_or_else(|| "a wall".into(), |w| w.name.clone());
        }
        let serial = number as usize;
        setup.bodies.list.get(serial).map_or_else(|| format!("body {serial}"), |b| format!("body {}", b.name))
    }

    /// Warning, if it is deep.
    pub(crate) fn warning(&self, setup: &Setup) -> Option<String> {
        let Self { depth, youngs_modulus, time, point: [x, y, z], body, partner, .. } = *self;
        self.is_deep().then(|| {
            format!(
                "{} and {} overlap by {depth:.3e} m, {:.0} % of the radius (of a body as large), at ({x:.4e}, {y:.4e}, {z:.4e}) m at t = {time:.4e} s; contact laws are made for up to {:.0} %: give the materials of both a youngs_modulus of {youngs_modulus:.2e} Pa or more, or less load or speed",
                Self::name(setup, body),
                Self::name(setup, partner),
                100.0 * self.ratio(),
                100.0 * DEEP,
            )
        })
    }

    /// For `result.json`, if it is deep.
    pub(crate) fn result(&self, setup: &Setup) -> Option<Value> {
        let warning = self.warning(setup)?;
        Some(json!({
            "depth": self.depth,
            "depth_over_radius": self.ratio(),
            "time": self.time,
            "point": self.point,
            "body": Self::name(setup, self.body),
            "partner": Self::name(setup, self.partner),
            "youngs_modulus": self.youngs_modulus,
            "warning": warning,
        }))
    }
}
