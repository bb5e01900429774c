//! Cost of bodies that will lie on each other.
use crate::build_error::BuildError;
use crate::pace::equivalent_diameter;
use crate::setup::{Bodies, BodySetup, ContactLawChoice, Motion, Setup};
use coupling::{Evolving, Grains};
use cpu_time::ThreadTime;
use fv_mesh::{Axis, Side};
use interfaces::{Point, Twist};

/// Bodies along each axis of the pile that is timed.
const ROW: usize = 5;
/// Distance of its bodies over the diameter of a ball or disc of the same volume: they touch.
const CLOSE: f64 = 0.97;
/// Steps that are timed.
const STEPS: u32 = 3;

impl Setup {
    /// CPU time of contacts of bodies that settle on a floor during the run \[s\], by that of a
    /// periodic pile of some of them: in proportion to their number and their time on the floor.
    pub(crate) fn cost_of_piles(&self) -> f64 {
        let time: f64 = self.bodies.list.iter().filter_map(|b| self.time_on_floor(b)).sum();
        if time <= 0.0 {
            return 0.0;
        }
        let free: Vec<_> = self.bodies.list.iter().filter(|b| is_free(b)).collect();
        let sample = free.iter().cycle().take(ROW.pow(self.dim() as u32)).map(|&b| b.clone()).collect();
        // Bodies of very different sizes may not fit into the period.
        time * self.cost_of_pile(sample).unwrap_or(0.0)
    }

    /// Time of the run after which a free body has fallen or risen to a wall \[s\].
    fn time_on_floor(&self, body: &BodySetup) -> Option<f64> {
        if !is_free(body) || self.bodies.law == ContactLawChoice::None || self.gravity.norm() == 0.0 {
            return None;
        }
        let fluid = self.fluid().density;
        let down = self.gravity.normalize() * if body.material.density < fluid { -1.0 } else { 1.0 };
        let to_end = |a: usize| {
            let end = if down[a] < 0.0 { self.axes[a].lower() } else { self.axes[a].upper() };
            ((end - body.pose.position[a]) / down[a], a)
        };
        let (height, axis) =
            (0..self.dim()).filter(|&a| down[a] != 0.0).map(to_end).min_by(|a, b| a.0.total_cmp(&b.0))?;
        let wall = self.bodies.touch_walls && self.sides[axis][usize::from(down[axis] > 0.0)].is_wall();
        if !wall && self.bodies.walls.iter().all(|w| w.plane.normal().dot(&down) >= 0.0) {
            return None;
        }
        let speed = self.settling_speed(&*body.shape, body.material.density, self.end);
        let fall = match speed > 0.0 {
            true => height / speed,
            false => (2.0 * height / self.gravity.norm()).sqrt(),
        };
        Some((self.end - fall).max(0.0))
    }

    /// CPU time for each body and second of a pile of such bodies.
    fn cost_of_pile(&self, mut sample: Vec<BodySetup>) -> Result<f64, BuildError> {
        let n = sample.len() as f64;
        let dim = self.dim();
        let volume = sample.iter().map(|b| b.shape.inertia(1.0).volume).sum::<f64>() / n;
        let pitch = CLOSE * equivalent_diameter(volume, dim);
        for (i, body) in sample.iter_mut().enumerate() {
            let place = [i % ROW, i / ROW % ROW, i / (ROW * ROW)];
            body.pose.position = Point::from(place.map(|k| k as f64 * pitch));
            (body.twist, body.tether, body.surface) = (Twist::default(), None, None);
        }
        let axis = || Axis::uniform(ROW, -0.5 * pitch, (ROW as f64 - 0.5) * pitch);
        let bodies = Bodies {
            list: sample.into(),
            inflows: Vec::new(),
            exits: Vec::new(),
            walls: Vec::new(),
            overlaps: true,
            ..self.bodies.clone()
        };
        let pile = Self {
            axes: (0..dim).map(|_| axis()).collect::<Result<_, _>>()?,
            sides: vec![[Side::Periodic, Side::Periodic]; dim],
            fluid: None,
            gravity: self.gravity * 0.0,
            bodies,
            ..self.clone()
        };
        let mut grains = Grains::new(pile.bodies()?);
        let dt = grains.longest_dt();
        let start = ThreadTime::now();
        for _ in 0..STEPS {
            grains.begin()?;
            grains.step(dt)?;
        }
        Ok(start.elapsed().as_secs_f64() / (f64::from(STEPS) * dt * n))
    }
}

/// Whether nothing prescribes the motion of the body or ties it.
pub(crate) fn is_free(body: &BodySetup) -> bool {
    matches!(body.motion, Motion::Free(_)) && body.tether.is_none()
}
