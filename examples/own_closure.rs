//! A turbulence closure of one's own: Prandtl's mixing length, next to the library's k–ω SST, in a
//! channel at Re_τ 587.
//!
//! ```text
//! ν_t = ℓ² |S|,   ℓ = δ [0.14 − 0.08 η² − 0.06 η⁴] (1 − e^(−y⁺/26)),   η = 1 − y/δ
//! ```
//!
//! (Nikuradse 1932, with the damping of van Driest 1956; δ: half the height.) The flow is periodic
//! and driven by a force of 1, so that u_τ = 1. The profiles are compared with the DNS of Moser,
//! Kim & Mansour (1999).
//!
//! `cargo run --release --example own_closure [FOLDER]`, 2 s; `out/own_closure/profiles.png`.
use render::profiles::{Curve, Panel, draw};
use siltflow::flow::TransportParams;
use siltflow::flow::{Axis, CartesianGrid, Cluster, Fluid, Modelled, Side, Simple};
use siltflow::interfaces::{Closure, SolveError, Transport, WallRow};
use std::error::Error;
use turb::{Inflow, KOmegaSst, Sst};

const RE_TAU: f64 = 587.19;
/// Mean velocity of the DNS.
const BULK: f64 = 18.654;

/// Prandtl's mixing length in a channel of height 2δ.
struct MixingLength {
    delta: f64,
    eddy: Vec<f64>,
}

impl Closure for MixingLength {
    fn eddy_viscosity(&self) -> Option<&[f64]> {
        Some(&self.eddy)
    }

    fn correct(
        &mut self,
        flow: &mut dyn Transport,
        walls: &[WallRow],
        nu: f64,
        _: Option<f64>,
    ) -> Result<(), SolveError> {
        flow.strain_rate(&mut self.eddy)?;
        // u_τ from the mean friction of the walls.
        let friction: f64 = walls.iter().map(|w| w.area * nu * w.u_t / w.y).sum();
        let u_tau = (friction / walls.iter().map(|w| w.area).sum::<f64>()).sqrt();
        for (eddy, y) in self.eddy.iter_mut().zip(flow.wall_distance()) {
            let eta = 1.0 - y / self.delta;
            let damping = 1.0 - (-y * u_tau / (26.0 * nu)).exp();
            let length = self.delta * (0.14 - 0.08 * eta.powi(2) - 0.06 * eta.powi(4)) * damping;
            *eddy *= length * length;
        }
        Ok(())
    }
}

/// y⁺ and u⁺ of the lower half.
type Profile = Vec<(f64, f64)>;

/// Profile of the developed channel, and the mean velocity.
fn channel<C: Closure>(
    closure: impl FnOnce(usize) -> Result<C, Box<dyn Error>>,
) -> Result<(Profile, f64), Box<dyn Error>> {
    // 96 cells across, the first at y⁺ < 1.
    let y = Axis::tanh(96, 0.0, 2.0, 2.4, Cluster::Both)?;
    let grid = CartesianGrid::from_axes([Axis::uniform(2, 0.0, 0.2)?, y])?;
    let sides = [Side::Periodic.both(), Side::WALL.both()];
    let fluid = Fluid { density: 1.0, viscosity: 1.0 / RE_TAU };
    let mut flow = Simple::new(grid.clone(), sides, fluid)?;
    flow.set_force([1.0, 0.0]);
    flow.set_velocity(|_| [18.0, 0.0]);
    let closure = closure(grid.n_cells())?;
    let mut model = Modelled::new(closure, &grid, flow.sides(), TransportParams::steady())?;
    let info = flow.solve_with(&mut model, 20_000, 1e-7)?;
    println!("{} iterations, residual {:.0e}", info.iterations, info.largest());
    let u = flow.velocity().field(0);
    let at = |j: usize| (RE_TAU * grid.axis(1).centre(j), u.row(j)[0]);
    Ok(((0..48).map(at).collect(), flow.statistics().volume_flow.x / 0.4))
}

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args().nth(1).unwrap_or("out/own_closure".into());
    let (mixing, u_mixing) = channel(|n| Ok(MixingLength { delta: 1.0, eddy: vec![0.0; n] }))?;
    let start = Inflow { k: 1.0, omega: 10.0 };
    let (sst, u_sst) = channel(|n| Ok(KOmegaSst::new(Sst::default(), n, start)?))?;
    for (name, u) in [("mixing length", u_mixing), ("k–ω SST", u_sst)] {
        // c_f = 2/U² with u_τ = 1.
        let friction = 100.0 * ((BULK / u).powi(2) - 1.0);
        println!("{name}: mean velocity {u:.3}, friction {friction:+.1} % of the DNS");
    }
    let row = |line: &str| {
        let (y, u) = line.split_once(',')?;
        Some((y.parse().ok()?, u.parse().ok()?))
    };
    let dns = include_str!("../tests/data/turbulence/dns_590.csv").lines().filter_map(row);
    let curve = |label: &str, points: Profile, line| Curve { label: label.into(), points, line };
    let panel = Panel {
        title: "Channel at Re_τ 587".into(),
        x: "y⁺".into(),
        y: "u⁺".into(),
        curves: vec![
            curve("mixing length (own)", mixing, true),
            curve("k–ω SST", sst, true),
            curve("DNS", dns.filter(|(y, _)| *y > 0.3).collect(), false),
        ],
    };
    std::fs::create_dir_all(&out)?;
    Ok(draw(format!("{out}/profiles.png").as_ref(), &[panel])?)
}
