//! Whether fluid enters where it is said to.
use super::is_open;
use crate::problem::Problem;
use crate::reader::Reader;
use fv_mesh::{Axis, Profile, Side};

/// Instants of an unsteady run, and places along each axis of a side, at which inlets are evaluated at most.
const INSTANTS: usize = 17;
const PLACES: usize = 64;
/// Velocities out of the box below this part of the largest are round-off.
const ROUND_OFF: f64 = 1e-9;

/// A side of the box or a patch of it through which fluid enters.
struct Inlet<'a> {
    axis: usize,
    end: usize,
    profile: &'a Profile,
    lower: [f64; 3],
    upper: [f64; 3],
    /// Number of the patch.
    patch: Option<usize>,
}

/// Flow through an inlet.
#[derive(Default)]
struct Passage {
    /// The largest mean velocity into the box of any instant, and the largest speed through the side \[m/s\].
    mean: f64,
    largest: f64,
    /// Share of places and instants where fluid leaves, and the fastest of it: velocity \[m/s\], place \[m\], time \[s\].
    leaving: f64,
    fastest: (f64, [f64; 3], f64),
}

impl Inlet<'_> {
    fn name(&self) -> String {
        let side = format!("{}_{}", ["x", "y", "z"][self.axis], ["min", "max"][self.end]);
        self.patch.map_or(side.clone(), |k| format!("{side}, patch {k}"))
    }
    /// +1 where the box is above the side.
    fn inwards(&self) -> f64 {
        if self.end == 0 { 1.0 } else { -1.0 }
    }

    /// Velocity into the box at a place.
    fn velocity(&self, x: [f64; 3], time: f64) -> f64 {
        let along = |u: [f64; 3]| self.inwards() * u[self.axis];
        match self.profile {
            Profile::Uniform(u) => along(*u),
            Profile::Parabolic { peak } => *peak,
            Profile::Function(u) => along(u.at(x, time)),
        }
    }

    fn passage(&self, axes: &[Axis], times: &[f64]) -> Passage {
        let at = if self.end == 0 { axes[self.axis].lower() } else { axes[self.axis].upper() };
        // Centres of the faces, or as many of them.
        let places = |a: usize| -> Vec<f64> {
            if a == self.axis {
                return vec![at];
            }
            let Some(axis) = axes.get(a) else { return vec![0.0] };
            let inside = (0..axis.cells()).map(|i| axis.centre(i));
            let inside: Vec<f64> = inside.filter(|x| (self.lower[a]..=self.upper[a]).contains(x)).collect();
            let every = inside.len().div_ceil(PLACES).max(1);
            inside.into_iter().step_by(every).collect()
        };
        let [xs, ys, zs] = [0, 1, 2].map(places);
        let all = || xs.iter().flat_map(|x| ys.iter().flat_map(|y| zs.iter().map(|z| [*x, *y, *z])));
        let largest = |time: f64| all().map(|x| self.velocity(x, time).abs()).fold(0.0, f64::max);
        let largest = times.iter().map(|time| largest(*time)).fold(0.0, f64::max);
        let mut out = Passage { mean: f64::NEG_INFINITY, largest, ..Passage::default() };
        let (mut leaving, mut n) = (0.0, 0.0);
        for &time in times {
            let (mut sum, mut places) = (0.0, 0.0);
            for x in all() {
                let u = self.velocity(x, time);
                sum += u;
                places += 1.0;
                if u < out.fastest.0 {
                    out.fastest = (u, x, time);
                }
                leaving += f64::from(u8::from(u < -ROUND_OFF * largest));
            }
            n += places;
            if places > 0.0 {
                out.mean = out.mean.max(sum / places);
            }
        }
        out.leaving = if n > 0.0 { leaving / n } else { 0.0 };
        out
    }
}

/// All inlets of a box.
fn inlets(sides: &[[Side; 2]]) -> Vec<Inlet<'_>> {
    let mut out = Vec::new();
    for (axis, pair) in sides.iter().enumerate() {
        for (end, side) in pair.iter().enumerate() {
            let whole = ([f64::NEG_INFINITY; 3], [f64::INFINITY; 3]);
            match side {
                Side::Inlet(profile) => {
                    out.push(Inlet { axis, end, profile, lower: whole.0, upper: whole.1, patch: None });
                }
                Side::Patches(patches) => {
                    for (k, patch) in patches.iter().enumerate() {
                        if let Side::Inlet(profile) = &patch.side {
                            let (lower, upper) = (patch.lower, patch.upper);
                            out.push(Inlet { axis, end, profile, lower, upper, patch: Some(k) });
                        }
                    }
                }
                _ => {}
            }
        }
    }
    out
}

/// Whether every inlet lets fluid in; returns what looks doubtful about them. Where all velocities through the sides are given, with no outlet and no given pressure, they may point anywhere.
pub(super) fn agrees(
    root: &Reader<'_>,
    axes: &[Axis],
    sides: &[[Side; 2]],
    end: Option<f64>,
) -> Result<Vec<String>, Problem> {
    let gives_way = |side: &Side| match side {
        Side::Patches(patches) => {
            patches.iter().any(|p| is_open(&p.side) && !matches!(p.side, Side::Inlet(_)))
        }
        side => is_open(side) && !matches!(side, Side::Inlet(_)),
    };
    if !sides.iter().flatten().any(gives_way) {
        return Ok(Vec::new());
    }
    let times: Vec<f64> = match end {
        Some(end) => (0..INSTANTS).map(|i| end * i as f64 / (INSTANTS - 1) as f64).collect(),
        None => vec![0.0],
    };
    let mut doubts = Vec::new();
    for inlet in inlets(sides) {
        let Passage { mean, largest, leaving, fastest: (u, x, time) } = inlet.passage(axes, &times);
        if leaving == 0.0 {
            continue;
        }
        let (name, axis) = (inlet.name(), ["x", "y", "z"][inlet.axis]);
        if mean < -ROUND_OFF * largest {
            let sign = if inlet.end == 0 { "above" } else { "below" };
            let table = root.table("sides").unwrap_or_else(|| root.clone());
            let own = format!("{axis}_{}", ["min", "max"][inlet.end]);
            let key = if table.has(&own) { own.as_str() } else { axis };
            return Err(table.fail(key, format!(
                "fluid leaves the box through the inlet {name}, at {:.3e} m/s and more on average; give a velocity whose component along {axis} is {sign} 0 there, or make it an \"outlet\" or of given \"pressure\"",
                -mean
            )));
        }
        let at: Vec<String> = x[..axes.len()].iter().map(|x| format!("{x:.4e}")).collect();
        doubts.push(format!(
            "fluid leaves the box through {:.0} % of the inlet {name} and of the time, at up to {:.3e} m/s (at ({}) m, t = {time:.3e} s): outlets and given pressures have to let it in elsewhere, without knowing what it brings",
            (100.0 * leaving).max(1.0),
            -u,
            at.join(", ")
        ));
    }
    Ok(doubts)
}
