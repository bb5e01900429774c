//! Air in a channel that bends by 90° at Re 10⁶, with walls that cut the cells of a Cartesian grid:
//! figure 5 of Isoz et al. (2023). SIMPLE solves the steady Reynolds-averaged equations
//!
//! ```text
//! ∇·(uu) = −∇p + ∇·[(ν + ν_t)(∇u + ∇uᵀ)],   ∇·u = 0,   ν_t from the k–ω SST model,
//! ```
//!
//! and the law of the wall gives the friction in the cut cells. Profiles of the velocity along the
//! channel and of ν_t are compared with those of simpleFoam on a body-fitted grid
//! (`tests/data/bends`). The scene `bent_channel` is the same without Rust.
//!
//! `cargo run --release --example bent_channel [FOLDER]`, 3 s; `out/bent_channel/profiles.png`.
use render::sketch::{Drawing, Paint, draw};
use siltflow::flow::{Axis, CartesianGrid, Convection, Fluid, Modelled, Profile, Side, Simple};
use siltflow::flow::{SimpleParams, TransportParams, WallStress};
use siltflow::ibm::{StaticBodies, cut_cells};
use siltflow::interfaces::{Aabb, Closure, Point, Pose, Solid, Vector};
use std::error::Error;
use turb::{Inflow, KOmegaSst, Sst};

/// Everything but the channel of height 1: along x for x < 0, between the radii 1 and 2 about the
/// origin, along y for y > 0.
struct Walls;

impl Solid for Walls {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        0.5 - (radius([x.x, x.y]) - 1.5).abs()
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::new(100.0, 100.0, 0.0))
    }
}

/// Distance from the inner wall, plus 1 \[m\].
fn radius([x, y]: [f64; 2]) -> f64 {
    match (x < 0.0, y > 0.0) {
        (true, true) => f64::INFINITY,
        (true, false) => -y,
        (false, true) => x,
        (false, false) => x.hypot(y),
    }
}

const PER_HEIGHT: usize = 48;

/// Equal cells between −2 and 0, the same on the other side of 0 up to `to`, wider by 5 % each.
fn axis(to: f64) -> Result<Axis, Box<dyn Error>> {
    let h = 1.0 / PER_HEIGHT as f64;
    let mut faces: Vec<f64> = (0..=2 * PER_HEIGHT + 2).map(|i| -2.0 - 2.0 * h + i as f64 * h).collect();
    let (mut x, mut width) = (0.0, h);
    while x < to {
        width = (1.05 * width).min(0.1);
        x += width;
        faces.push(x);
    }
    Ok(Axis::from_faces(faces)?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args().nth(1).unwrap_or("out/bent_channel".into());
    let mirrored: Vec<f64> = axis(5.0)?.faces().iter().rev().map(|x| -x).collect();
    let grid = CartesianGrid::from_axes([Axis::from_faces(mirrored)?, axis(10.0)?])?;
    let inlet = Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0]));
    let sides = [[inlet, Side::FreeSlip], [Side::FreeSlip, Side::PressureOutlet(0.0)]];
    let mut flow = Simple::new(grid.clone(), sides, Fluid { density: 1.0, viscosity: 1e-6 })?
        .with_convection(Convection::Quick)
        .with_params(SimpleParams::turbulent())?;
    let walls = StaticBodies::new().with(Walls, Pose::at([0.0; 3]));
    let cuts = cut_cells(flow.velocity(), &walls)?;
    flow.set_walls(Some((&cuts, WallStress::LAW_OF_THE_WALL)))?;
    // 5 % turbulence of length scale 0.07 m enters.
    let sst = KOmegaSst::new(Sst::default(), grid.n_cells(), Inflow::from_length(1.0, 0.05, 0.07)?)?;
    let mut model = Modelled::new(sst, &grid, flow.sides(), TransportParams::steady())?;
    let centre = |cell: usize| grid.centre(grid.cell(cell));
    for (cell, distance) in model.transport_mut().wall_distance_mut().iter_mut().enumerate() {
        *distance = (0.5 - (radius(centre(cell)) - 1.5).abs()).max(0.0);
    }
    let info = flow.solve_with(&mut model, 1000, 1e-5)?;
    let y_plus = model.closure.y_plus();
    println!("{} iterations, residual {:.0e}, y+ {:.0}", info.iterations, info.largest(), y_plus.mean);

    let [u, v] = [0, 1].map(|c| flow.centred_velocity(c).collect::<Vec<_>>());
    let eddy = model.closure.eddy_viscosity().ok_or("no eddy viscosity")?;
    let inside = |cell: usize| (1.0..2.0).contains(&radius(centre(cell)));
    let share = |cell: usize| if inside(cell) { u[cell].hypot(v[cell]) / 1.6 } else { 0.0 };
    let faces = [grid.axis(0).faces(), grid.axis(1).faces()];
    let mut plan = Drawing::lattice("(a) Speed, white 0, dark 1.6 m/s", faces, |c| Paint::Share(share(c)));
    plan.lines.clear();
    plan.range = [(-2.5, 2.1), (-2.1, 2.5)];
    let mut panels = vec![plan];
    let [near, far] = [
        include_str!("../tests/data/bends/bend90_kOmegaSST_c_exit1H.csv"),
        include_str!("../tests/data/bends/bend90_kOmegaSST_c_exit5H.csv"),
    ];
    // Rows of cells across the outlet channel at y = 1 and 5; columns of the reference.
    for (label, y, values, text, column, scale) in [
        ("v, m/s, 1 m after the bend", 1.0, &v[..], near, 3, 1.0),
        ("v, m/s, 5 m after the bend", 5.0, &v[..], far, 3, 1.0),
        ("1000 ν_t, m²/s, 5 m after the bend", 5.0, eddy, far, 7, 1e3),
    ] {
        let row = grid.axis(1).locate(y).ok_or("outside the grid")?;
        let cells = (0..grid.cells()[0]).map(|i| grid.index([i, row])).filter(|&c| inside(c));
        let ours = cells.map(|c| [centre(c)[0] - 1.0, scale * values[c]]).collect::<Vec<_>>();
        let number = |line: &str, k: usize| line.split(',').nth(k).and_then(|n| n.parse().ok());
        let pair = |line: &str| Some([number(line, 2)?, scale * number(line, column)?]);
        let fitted: Vec<[f64; 2]> = text.lines().skip(1).filter_map(pair).collect();
        let between = |x: f64| {
            let w = ours.windows(2).find(|w| w[0][0] <= x && x <= w[1][0])?;
            Some(w[0][1] + (x - w[0][0]) * (w[1][1] - w[0][1]) / (w[1][0] - w[0][0]))
        };
        let off: Vec<f64> = fitted.iter().filter_map(|p| Some((between(p[0])? - p[1]).powi(2))).collect();
        println!("{label}: rms difference {:.4}", (off.iter().sum::<f64>() / off.len() as f64).sqrt());
        let labels = ["distance from the inner wall, m", label];
        panels.push(Drawing::curves("", labels, &[("immersed", ours), ("body-fitted", fitted)]));
    }
    std::fs::create_dir_all(&out)?;
    Ok(draw(format!("{out}/profiles.png").as_ref(), 2, &panels)?)
}
