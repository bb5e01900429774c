//! A body of any shape on a Cartesian grid: figures 2 to 4 of Isoz et al. (2023), computed.
//!
//! A capsule, a shape of one's own, is held across a plane channel. The panels show
//! (a) its solid fraction λ in the cells, from the signed distance of their centres;
//! (b) cells inside (λ = 1), cut by the surface (0 < λ < 1), and in the fluid (λ = 0);
//! (c) a surface cell P of u, the point S on the surface, and the points P₁ and P₂ on the normal;
//! (d) u along that normal: the parabola through S, P₁ and P₂ gives P the value that the paper's
//! forcing ([`Hfdib`]) imposes, φ_P = Σ φ_i ℓ_i(s_P) with Lagrange's polynomials ℓ_i of s.
//!
//! `cargo run --release --example immersed_body [FOLDER]`, 1 s; `out/immersed_body/figure.png`.
use render::sketch::{Drawing, Paint, draw};
use siltflow::coupling::FlowSolver;
use siltflow::flow::{CartesianGrid, Fluid, Profile as Inflow, Projection, Side};
use siltflow::ibm::{Forcing, FractionRule, Given, Hfdib, Profile, Reconstruction};
use siltflow::ibm::{SolidFraction, StaticBodies};
use siltflow::interfaces::{Aabb, BodyId, Lattice, Point, Pose, Rotation, Solid, Vector, VelocityField};
use std::error::Error;

/// All points within the radius (second) of a line along x of a half-length (first) \[m\].
#[derive(Clone, Copy)]
struct Capsule(f64, f64);

impl Solid for Capsule {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        (x.x.abs() - self.0).max(0.0).hypot(x.y) - self.1
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::new(self.0 + self.1, self.1, 0.0))
    }
}

const CELLS: [usize; 2] = [16, 12];
const H: f64 = 1.0 / 12.0; // m

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args().nth(1).unwrap_or("out/immersed_body".into());
    let inlet = Side::Inlet(Inflow::Parabolic { peak: 1.0 });
    let sides = [[inlet, Side::PressureOutlet(0.0)], Side::WALL.both()];
    let grid = CartesianGrid::new(CELLS, CELLS.map(|n| n as f64 * H))?;
    let mut flow = Projection::new(grid, sides, Fluid { density: 1.0, viscosity: 0.05 })?;
    let orientation = Rotation::from_axis_angle(&Vector::z_axis(), 0.5);
    let pose = Pose { position: Point::new(0.64, 0.51, 0.0), orientation };
    let capsule = Capsule(0.16, 0.15);
    let body = StaticBodies::new().with(capsule, pose);

    // A step of the forcing: predict, force, project.
    let mut forcing = Hfdib::new(1.0);
    while flow.time() < 2.0 {
        let dt = flow.stable_dt(0.3);
        flow.predict(dt, [0.0; 2])?;
        forcing.begin(flow.viscous_step(dt));
        forcing.place(flow.velocity(), &body)?;
        for _ in 0..forcing.rounds() {
            forcing.force(flow.velocity_mut(), &body);
            flow.project(dt)?;
        }
        flow.finish(dt)?;
    }

    let distance = |[x, y]: [f64; 2]| capsule.signed_distance(pose.to_body(Point::new(x, y, 0.0)), 1.0);
    // Cells of a lattice, shaded, with the outline of the body.
    let cells = |title: &str, lattice: &Lattice, paint: &dyn Fn(usize) -> Paint| {
        let (first, shape) = (lattice.position([0; 3]), lattice.shape());
        let face = |a: usize, i: usize| first[a] + (i as f64 - 0.5) * H;
        let faces = [0, 1].map(|a| (0..=shape[a]).map(|i| face(a, i)).collect::<Vec<_>>());
        let mut drawing = Drawing::lattice(title, [&faces[0], &faces[1]], paint);
        drawing.add_zero_level(distance, 150, 3.0, Paint::Kind(1, 0.0));
        drawing
    };
    let solid_fraction = |lattice: &Lattice| -> Result<_, Box<dyn Error>> {
        let mut fraction = SolidFraction::new().with_rule(FractionRule::Centroid);
        let mut lambda = vec![0.0; lattice.shape().iter().product()];
        fraction.update(lattice, &body)?;
        fraction.add_to_dense(lattice, &mut lambda);
        Ok((fraction, lambda))
    };
    let kind = |lambda: f64| match lambda {
        l if l >= 1.0 => Paint::Share(0.8),
        l if l > 0.0 => Paint::Kind(4, 0.35),
        _ => Paint::Share(0.0),
    };
    let lattice = flow.grid().lattice(None, flow.sides());
    let (_, lambda) = solid_fraction(&lattice)?;
    let shares = cells("(a) λ", &lattice, &|at| Paint::Share(lambda[at]));
    let mut kinds = cells("(b) Cells by λ", &lattice, &|at| kind(lambda[at]));
    kinds.legend = vec![(kind(1.0), "inside".into()), (kind(0.5), "cut by the surface".into())];

    // The cut cell of u with its centre in the fluid whose normal is the steepest.
    let (lattice, u) = (flow.velocity().lattice(0), flow.velocity().component(0));
    let (fraction, lambda) = solid_fraction(lattice)?;
    let mut surface = Reconstruction::new(Profile::Quadratic, Given::Value);
    surface.place(lattice, u.len(), &body, &fraction);
    let cut = surface.cells(BodyId(0)).iter().filter(|c| c.distance > 0.15 * H && c.points[1].is_some());
    let cell = cut.max_by(|a, b| a.normal.y.total_cmp(&b.normal.y)).ok_or("no cut cell")?;
    let [Some(s1), Some(s2)] = cell.points else { return Err("no points on the normal".into()) };
    let seen = |point: usize| {
        let weights = &cell.fluid[8 * point..8 * point + 8];
        weights.iter().map(|&(i, w)| w * u[i]).sum::<f64>() / weights.iter().map(|(_, w)| w).sum::<f64>()
    };
    let (u1, u2) = (seen(0), seen(1));
    let values = [(0.0, 0.0), (cell.distance, cell.value(0.0, u)), (s1, u1), (s2, u2)];
    let normal = |s: f64| (pose.position + cell.foot + cell.normal * s).coords;
    let mut points = cells("(c) Points of a surface cell of u", lattice, &|at| kind(lambda[at]));
    let line = [-0.6 * H, s2 + H].map(|s| [normal(s).x, normal(s).y]);
    points.lines.push((line.to_vec(), 2.0, Paint::Ink));
    let middle = normal(0.5 * s2);
    points.range = [(middle.x - 3.2 * H, middle.x + 3.2 * H), (middle.y - 2.4 * H, middle.y + 2.4 * H)];
    let parabola = |s: f64| s * (s - s2) / (s1 * (s1 - s2)) * u1 + s * (s - s1) / (s2 * (s2 - s1)) * u2;
    let curve = (0..=100).map(|i| 0.0115 * f64::from(i) * s2).map(|s| [s / H, parabola(s)]);
    let labels = ["distance from the surface, cells", "u, m/s"];
    let mut profile = Drawing::curves("(d) u on the normal", labels, &[("parabola", curve.collect())]);
    for (&(s, u), name) in values.iter().zip(["S", "P", "P₁", "P₂"]) {
        points.points.push(([normal(s).x, normal(s).y], Paint::Kind(1, 0.0), name.into()));
        profile.points.push(([s / H, u], Paint::Kind(1, 0.0), name.into()));
        println!("{name:3} {:5.2} cells from the surface, u = {u:7.4} m/s", s / H);
    }
    std::fs::create_dir_all(&out)?;
    Ok(draw(format!("{out}/figure.png").as_ref(), 2, &[shares, kinds, points, profile])?)
}
