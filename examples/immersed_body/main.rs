//! How a body comes into the grid: figures 2, 3 and 4 of Isoz et al. (2023), from what the library computes.
//!
//! A capsule (a shape of one's own: eight lines below) stands across a plane channel. λ is the paper's; the velocities of figure 3 are
//! those of a flow that the paper's forcing ([`Hfdib`]) has made.
//!
//! Sample run: `cargo run --release --example immersed_body -- --out pictures`, a second or two; without `--out` the pictures
//! go to `target/immersed_body`.
use example_support::files::make_folder;
use example_support::prescribed_bodies::{PrescribedBodies, forced_step};
use example_support::{Outcome, told};
use render::sketch::{Drawing, Paint, draw};
use siltflow::flow::{CartesianGrid, Fluid, Profile, Projection, Side};
use siltflow::ibm::{
    FractionRule, Given, Hfdib, Profile as Along, Reconstruction, SolidFraction, SurfaceCell,
    surface_elements,
};
use siltflow::interfaces::{Aabb, Bodies, BodyId, Kinematics, Lattice, Point, Solid, Vector, VelocityField};
use std::path::PathBuf;
use std::process::ExitCode;

/// All points within `radius` of a line of length 2 `half` along x \[m\].
struct Capsule {
    half: f64,
    radius: f64,
}

impl Solid for Capsule {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        (x.x.abs() - self.half).max(0.0).hypot(x.y) - self.radius
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::new(self.half + self.radius, self.radius, 0.0))
    }
}

const CELLS: [usize; 2] = [16, 12];
const H: f64 = 1.0 / 12.0;
const BODY: BodyId = BodyId(0);
// Colours of solid and surface cells and of points.
const SOLID: Paint = Paint::Share(0.8);
const SURFACE: Paint = Paint::Kind(4, 0.35);
const MARK: Paint = Paint::Kind(1, 0.0);

fn main() -> ExitCode {
    told(run())
}

fn run() -> Outcome<()> {
    let out = folder()?;
    make_folder(&out)?;
    let grid = CartesianGrid::new(CELLS, [CELLS[0] as f64 * H, CELLS[1] as f64 * H])?;
    let inlet = Side::Inlet(Profile::Parabolic { peak: 1.0 });
    let sides = [[inlet, Side::PressureOutlet(0.0)], Side::WALL.both()];
    let mut flow = Projection::new(grid, sides, Fluid { density: 1.0, viscosity: 0.05 })?;
    let capsule = Capsule { half: 0.16, radius: 0.15 };
    let body = PrescribedBodies::default().with(capsule, [0.64, 0.51, 0.0], 0.0).turned(0.5);

    let lattice = flow.grid().lattice(None, flow.sides());
    let mut fraction = SolidFraction::new().with_rule(FractionRule::Centroid);
    fraction.update(&lattice, &body)?;
    let mut lambda = vec![0.0; CELLS[0] * CELLS[1]];
    fraction.add_to_dense(&lattice, &mut lambda);
    let outline = outline(&body);
    draw(&out.join("figure_2.png"), 2, &figure_2(&lattice, &lambda, &outline))?;
    draw(&out.join("figure_4.png"), 2, &figure_4(&lattice, &lambda, &outline))?;

    march(&mut flow, &body)?;
    draw(&out.join("figure_3.png"), 2, &figure_3(&flow, &body, &outline)?)?;
    println!("figure_2.png, figure_3.png, figure_4.png: {}", out.display());
    Ok(())
}

fn folder() -> Outcome<PathBuf> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    match args.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => Ok("target/immersed_body".into()),
        ["--out", folder] => Ok(folder.into()),
        _ => Err(format!("{args:?}: give nothing or --out FOLDER").into()),
    }
}

/// Two units of time under the paper's forcing.
fn march(flow: &mut Projection<2>, body: &PrescribedBodies) -> Outcome<()> {
    let mut forcing = Hfdib::new(1.0);
    while flow.time() < 2.0 {
        let dt = flow.stable_dt(0.3);
        forced_step(flow, &mut forcing, body, dt)?;
    }
    Ok(())
}

/// The surface as a closed line.
fn outline(body: &PrescribedBodies) -> Vec<[f64; 2]> {
    let pose = body.pose(BODY);
    let mut points: Vec<[f64; 2]> = surface_elements(body.solid(BODY), 0.2 * H, 0.0)
        .iter()
        .map(|e| pose.to_world(e.point))
        .map(|x| [x.x, x.y])
        .collect();
    let angle = |p: &[f64; 2]| (p[1] - pose.position.y).atan2(p[0] - pose.position.x);
    points.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    points.extend(points.first().copied());
    points
}

/// The cells, painted by what is given of each, with the lines between them and the body's outline.
fn cells(title: &str, lattice: &Lattice, outline: &[[f64; 2]], paint: impl Fn(usize) -> Paint) -> Drawing {
    let [nx, ny, _] = lattice.shape();
    let corner = |i: usize, j: usize| [i as f64 * H, j as f64 * H];
    let cell = |at: usize| {
        let (i, j) = (at % nx, at / nx);
        (corner(i, j), corner(i + 1, j + 1), paint(at))
    };
    let across = (0..=nx).map(|i| vec![corner(i, 0), corner(i, ny)]);
    let along = (0..=ny).map(|j| vec![corner(0, j), corner(nx, j)]);
    let mut lines: Vec<_> = across.chain(along).map(|line| (line, 1.0, Paint::Share(0.45))).collect();
    lines.push((outline.to_vec(), 3.0, MARK));
    Drawing {
        title: title.into(),
        range: [(0.0, nx as f64 * H), (0.0, ny as f64 * H)],
        cells: (0..nx * ny).map(cell).collect(),
        lines,
        ..Drawing::default()
    }
}

/// Solid, cut and fluid cells.
fn kind(lambda: f64) -> Paint {
    match lambda {
        l if l >= 1.0 => SOLID,
        l if l > 0.0 => SURFACE,
        _ => Paint::Share(0.0),
    }
}

fn figure_2(lattice: &Lattice, lambda: &[f64], outline: &[[f64; 2]]) -> Vec<Drawing> {
    let mut projected = cells("(b) The body on it", lattice, outline, |at| kind(lambda[at]));
    projected.legend = vec![(SOLID, "solid cells".into()), (SURFACE, "surface cells".into())];
    let mut shares = cells("(c) λ", lattice, outline, |at| Paint::Share(lambda[at]));
    shares.legend = vec![(Paint::Share(0.0), "λ = 0".into()), (Paint::Share(1.0), "λ = 1".into())];
    vec![
        cells("(a) The mesh", lattice, outline, |_| Paint::Share(0.0)),
        projected,
        shares,
        cells("(d) ceil(λ): where the forcing acts", lattice, outline, |at| Paint::Share(lambda[at].ceil())),
    ]
}

fn figure_4(lattice: &Lattice, lambda: &[f64], outline: &[[f64; 2]]) -> Vec<Drawing> {
    let mut shares = cells("(a) λ", lattice, outline, |at| Paint::Share(lambda[at]));
    shares.legend = vec![(Paint::Share(0.0), "λ = 0".into()), (Paint::Share(1.0), "λ = 1".into())];
    let mut division = cells("(b) Cells by λ", lattice, outline, |at| kind(lambda[at]));
    division.legend = vec![
        (SOLID, "in-solid cells, λ = 1: α = 1".into()),
        (SURFACE, "boundary cells, 0 < λ < 1: α = 1, but 0 for u at high y⁺".into()),
        (Paint::Share(0.0), "fluid cells, λ = 0: α = 0".into()),
    ];
    vec![shares, division]
}

/// The points on the normal through a surface cell, and u_x there.
fn figure_3(flow: &Projection<2>, body: &PrescribedBodies, outline: &[[f64; 2]]) -> Outcome<Vec<Drawing>> {
    let (lattice, u) = (flow.velocity().lattice(0), flow.velocity().component(0));
    let mut fraction = SolidFraction::new().with_rule(FractionRule::Centroid);
    fraction.update(lattice, body)?;
    let mut surface = Reconstruction::new(Along::Quadratic, Given::Value);
    surface.place(lattice, u.len(), body, &fraction);
    // Of the cells above the body whose centre is in the fluid, the one that is nearest to its end.
    let usable =
        |cell: &&SurfaceCell| cell.normal.y > 0.5 && cell.distance > 0.15 * H && cell.points[1].is_some();
    let upper = surface.cells(BODY).iter().filter(usable);
    let cell = upper.max_by(|a, b| a.node.arm.x.total_cmp(&b.node.arm.x)).ok_or("no surface cell is free")?;
    let at = |distance: f64| {
        let x = body.pose(BODY).position + cell.foot + cell.normal * distance;
        [x.x, x.y]
    };
    let [Some(first), Some(second)] = cell.points else { return Err("no points".into()) };
    let value = |point: usize| -> f64 {
        let weights = &cell.fluid[8 * point..8 * point + 8];
        let sum: f64 = weights.iter().map(|w| w.1).sum();
        weights.iter().map(|&(i, w)| w * u[i]).sum::<f64>() / sum
    };
    let [u1, u2] = [value(0), value(1)];
    let distances = [0.0, cell.distance, first, second];
    let values = [0.0, cell.value(0.0, u), u1, u2];
    let names = ["S", "P", "P₁", "P₂"].map(String::from);

    let shares = |index: usize| {
        let known = fraction.nodes(BODY).iter().find(|node| node.index == index);
        known.map_or(0.0, |node| node.fraction)
    };
    let [nx, ny, _] = lattice.shape();
    let mut sketch = Drawing { title: "(a) Points of a surface cell of u".into(), ..Drawing::default() };
    for (i, j) in (0..ny).flat_map(|j| (0..nx).map(move |i| (i, j))) {
        let node = [i as isize, j as isize, 0];
        let (Some(index), [x, y, _]) = (lattice.index(node), lattice.position(node)) else { continue };
        let corner = |sign: f64| [x + 0.5 * sign * H, y + 0.5 * sign * H];
        let paint = if index == cell.node.index { Paint::Kind(5, 0.3) } else { kind(shares(index)) };
        sketch.cells.push((corner(-1.0), corner(1.0), paint));
        let [[x0, y0], [x1, y1]] = [corner(-1.0), corner(1.0)];
        sketch.lines.push((vec![[x0, y1], [x0, y0], [x1, y0]], 1.0, Paint::Share(0.45)));
    }
    sketch.lines.push((outline.to_vec(), 3.0, MARK));
    sketch.lines.push((vec![at(-0.6 * H), at(second + 0.8 * H)], 2.0, Paint::Ink));
    sketch.points = distances.iter().zip(&names).map(|(&d, name)| (at(d), MARK, name.clone())).collect();
    let middle = at(0.5 * second);
    sketch.range = [(middle[0] - 3.2 * H, middle[0] + 3.2 * H), (middle[1] - 2.4 * H, middle[1] + 2.4 * H)];

    // The parabola through S, P₁ and P₂.
    let parabola = |s: f64| {
        s * (s - second) / (first * (first - second)) * u1
            + s * (s - first) / (second * (second - first)) * u2
    };
    let curve =
        (0..=100).map(|i| 0.01 * f64::from(i) * 1.15 * second).map(|s| [s / H, parabola(s)]).collect();
    let most = values.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    let profile = Drawing {
        title: "(b) The parabola through S, P₁ and P₂ gives P its value".into(),
        range: [(-0.1, 1.2 * second / H), (-0.15 * most, 1.3 * most)],
        labels: Some(["distance from the surface along the normal, cells".into(), "u".into()]),
        lines: vec![(curve, 2.5, Paint::Kind(0, 0.0))],
        points: distances
            .iter()
            .zip(values)
            .zip(names)
            .map(|((&d, u), name)| ([d / H, u], MARK, name))
            .collect(),
        ..Drawing::default()
    };
    Ok(vec![sketch, profile])
}
