//! The virtual mesh of two rocks: figure 6 of Isoz et al. (2023), from what the library computes.
//!
//! Two rocks of one's own making (a distance each: a ball whose radius changes with the direction, so neither is convex) overlap a
//! little. (a) shows the boxes of the adaptive tree at ℓ = 5 in a slice, (b) the edge boxes, which both surfaces cut, from the side,
//! with the contact plane ρ_c through them and its normal n_c.
//!
//! Sample run: `cargo run --release --example virtual_mesh`, a second; the pictures go to `out/virtual_mesh`, or where
//! `--out FOLDER` says.

use example_support::files::make_folder;
use example_support::rock::Rock;
use example_support::{Outcome, told};
use render::sketch::{Drawing, Paint, draw};
use siltflow::dem::{BoxKind, Implicit, Normal, Overlap, OverlapSolver, Refinement, Route, SubBox};
use siltflow::interfaces::{Point, Pose, Rotation, Solid, Vector};
use std::path::PathBuf;
use std::process::ExitCode;

const INSIDE: Paint = Paint::Share(0.75);
const CUT: Paint = Paint::Kind(4, 0.45);
const EDGE: Paint = Paint::Kind(5, 0.1);
const PLANE: Paint = Paint::Kind(1, 0.0);
const ROCKS: [Paint; 2] = [Paint::Kind(2, 0.0), Paint::Kind(0, 0.0)];
const LEVELS: u8 = 5;

fn main() -> ExitCode {
    told(run())
}

fn run() -> Outcome<()> {
    let out = folder()?;
    make_folder(&out)?;
    let rocks = [Implicit::new("rock", Rock::new(3), 1e-3)?, Implicit::new("rock", Rock::new(8), 1e-3)?];
    let turn = Rotation::from_euler_angles(0.4, 0.2, 0.9);
    let poses = [
        Pose { position: Point::new(0.0, 0.0, 0.0), orientation: Rotation::identity() },
        Pose { position: Point::new(1.35, 0.95, 0.2), orientation: turn },
    ];
    let solve = |refinement, normal| -> Outcome<(Overlap, Vec<SubBox>)> {
        let solver = OverlapSolver::new().with_route(Some(Route::Tree));
        let mut solver = solver.with_refinement(refinement).with_normal(normal);
        let patches = solver.solve(&rocks[0], &poses[0], &rocks[1], &poses[1])?;
        let largest = patches.iter().max_by(|a, b| a.volume.total_cmp(&b.volume));
        let overlap = *largest.ok_or("the rocks do not touch")?;
        Ok((overlap, solver.boxes().collect()))
    };
    let (overlap, boxes) = solve(Refinement::Levels(LEVELS), Normal::PlaneFit)?;
    let (fine, _) = solve(Refinement::Tolerance(1e-4), Normal::Gradient)?;
    let view = View::new(&overlap);
    draw(&out.join("figure_6a.png"), 2, &figure_6a(&rocks, &poses, &boxes, &overlap))?;
    draw(&out.join("figure_6b.png"), 2, &figure_6b(&view, &rocks, &poses, &boxes, &overlap, &fine))?;
    let count = |kind| boxes.iter().filter(|b| b.kind == kind && b.volume > 0.0).count();
    println!(
        "boxes at ℓ = {LEVELS}: {} inside, {} cut, {} edge",
        count(BoxKind::Inside),
        count(BoxKind::Cut),
        count(BoxKind::Edge)
    );
    println!("volume {:.6e}, to a tolerance of 1e-4 {:.6e}", overlap.volume, fine.volume);
    let angle = overlap.normal.angle(&fine.normal).to_degrees();
    println!("n_c is {angle:.2}° off the gradient of the volume");
    println!("figure_6a.png, figure_6b.png: {}", out.display());
    Ok(())
}

fn folder() -> Outcome<PathBuf> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    match args.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => Ok("out/virtual_mesh".into()),
        ["--out", folder] => Ok(folder.into()),
        _ => Err(format!("{args:?}: give nothing or --out FOLDER").into()),
    }
}

/// Where a plane through `origin` along `along` and `up` cuts a rock, as a closed line in these two.
fn outline(rock: &impl Solid, pose: &Pose, origin: Point, along: Vector, up: Vector) -> Vec<[f64; 2]> {
    let distance = |p: [f64; 2]| rock.signed_distance(pose.to_body(origin + p[0] * along + p[1] * up), 10.0);
    let middle = pose.position - origin;
    let centre = [middle.dot(&along), middle.dot(&up)];
    if distance(centre) >= 0.0 {
        return Vec::new();
    }
    let ray = |i: usize| {
        let (sin, cos) = (std::f64::consts::TAU * i as f64 / 360.0).sin_cos();
        let at = |s: f64| [centre[0] + s * cos, centre[1] + s * sin];
        let (mut low, mut high) = (0.0, 3.0);
        for _ in 0..40 {
            let s = 0.5 * (low + high);
            *(if distance(at(s)) < 0.0 { &mut low } else { &mut high }) = s;
        }
        at(low)
    };
    (0..=360).map(ray).collect()
}

/// Boxes in a slice of constant z through the middle of the overlap.
fn figure_6a(
    rocks: &[Implicit<Rock>; 2],
    poses: &[Pose; 2],
    boxes: &[SubBox],
    overlap: &Overlap,
) -> Vec<Drawing> {
    let z = overlap.centroid.z;
    let origin = Point::new(0.0, 0.0, z);
    let outlines =
        || (0..2).map(|i| (outline(&rocks[i], &poses[i], origin, Vector::x(), Vector::y()), 3.0, ROCKS[i]));
    let slice: Vec<&SubBox> = boxes.iter().filter(|b| (b.centre.z - z).abs() <= b.half.z).collect();
    let mut cells = Vec::new();
    let mut lines = Vec::new();
    for b in &slice {
        let (low, high) = (b.centre - b.half, b.centre + b.half);
        let paint = match b.kind {
            _ if b.volume <= 0.0 => Paint::Share(0.06),
            BoxKind::Inside => INSIDE,
            BoxKind::Cut => CUT,
            BoxKind::Edge => EDGE,
        };
        cells.push(([low.x, low.y], [high.x, high.y], paint));
        let corners =
            vec![[low.x, low.y], [high.x, low.y], [high.x, high.y], [low.x, high.y], [low.x, low.y]];
        lines.push((corners, 1.0, Paint::Share(0.45)));
    }
    let bounds = cells.iter().fold([[f64::MAX; 2], [f64::MIN; 2]], |[l, h], (low, high, _)| {
        [[l[0].min(low[0]), l[1].min(low[1])], [h[0].max(high[0]), h[1].max(high[1])]]
    });
    lines.extend(outlines());
    let whole: Vec<_> = outlines().collect();
    let reach = whole.iter().flat_map(|l| &l.0).fold([(0.0_f64, 0.0_f64); 2], |[x, y], p| {
        [(x.0.min(p[0]), x.1.max(p[0])), (y.0.min(p[1]), y.1.max(p[1]))]
    });
    let grown = |(low, high): (f64, f64), by: f64| (low - by * (high - low), high + by * (high - low));
    let [[x0, y0], [x1, y1]] = bounds;
    let frame = vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]];
    let rocks_only = Drawing {
        title: "(a) Two rocks; the boxes of the tree hold what is in both".into(),
        range: reach.map(|r| grown(r, 0.05)),
        cells: cells.clone(),
        lines: whole.into_iter().chain([(frame, 2.0, Paint::Ink)]).collect(),
        legend: vec![(ROCKS[0], "first rock".into()), (ROCKS[1], "second rock".into())],
        ..Drawing::default()
    };
    let close = Drawing {
        title: format!("Sub-boxes, at most level {LEVELS}, cut at z = {z:.2}"),
        range: [grown((x0, x1), 0.06), grown((y0, y1), 0.06)],
        cells,
        lines,
        legend: vec![
            (INSIDE, "inside both".into()),
            (CUT, "cut by one surface".into()),
            (EDGE, "edge: cut by both".into()),
            (Paint::Share(0.06), "cut, but nothing shared in it".into()),
        ],
        ..Drawing::default()
    };
    vec![rocks_only, close]
}

/// Two directions to look at the contact along: across the normal.
struct View {
    normal: Vector,
    sides: [Vector; 2],
}

impl View {
    fn new(overlap: &Overlap) -> Self {
        let normal = overlap.normal;
        let u = normal.cross(&Vector::z()).normalize();
        Self { normal, sides: [u, normal.cross(&u)] }
    }
}

/// Edge boxes seen along the contact plane from two sides.
fn figure_6b(
    view: &View,
    rocks: &[Implicit<Rock>; 2],
    poses: &[Pose; 2],
    boxes: &[SubBox],
    overlap: &Overlap,
    fine: &Overlap,
) -> Vec<Drawing> {
    let edges: Vec<&SubBox> = boxes.iter().filter(|b| b.kind == BoxKind::Edge && b.volume > 0.0).collect();
    let middle = edges.iter().map(|b| b.centre.coords).sum::<Vector>() / edges.len().max(1) as f64;
    let middle = Point::from(middle);
    let drawing = |side: usize| {
        let (along, up) = (view.sides[side], view.normal);
        let place = |x: Point| [(x - middle).dot(&along), (x - middle).dot(&up)];
        let widest = edges.iter().map(|b| place(b.centre)[0].abs()).fold(0.0, f64::max) * 1.25;
        let mut lines = Vec::new();
        for b in &edges {
            for (from, to) in wires() {
                let corner = |s: Vector| place(b.centre + b.half.component_mul(&s));
                lines.push((vec![corner(from), corner(to)], 1.0, EDGE));
            }
        }
        for i in 0..2 {
            lines.push((outline(&rocks[i], &poses[i], middle, along, up), 3.0, ROCKS[i]));
        }
        lines.push((vec![[-widest, 0.0], [widest, 0.0]], 3.5, PLANE));
        let arrow = |way: Vector, length: f64, paint: Paint, out: &mut Vec<_>| {
            let [x, y] = [way.dot(&along) * length, way.dot(&up) * length];
            out.push((vec![[0.0, 0.0], [x, y]], 3.5, paint));
            let back = |s: f64| [x - 0.16 * (x + s * 0.5 * y), y - 0.16 * (y - s * 0.5 * x)];
            out.push((vec![back(1.0), [x, y], back(-1.0)], 3.5, paint));
        };
        arrow(overlap.normal, 0.5 * widest, PLANE, &mut lines);
        arrow(fine.normal, 0.36 * widest, Paint::Ink, &mut lines);
        Drawing {
            title: ["(b) Edge boxes, seen along the contact plane", "The same from a side at right angles"]
                [side]
                .into(),
            range: [(-1.15 * widest, 1.15 * widest), (-0.86 * widest, 0.86 * widest)],
            lines,
            legend: vec![
                (EDGE, "edge boxes".into()),
                (PLANE, "ρ_c and n_c by least squares".into()),
                (Paint::Ink, "gradient of the volume".into()),
            ],
            ..Drawing::default()
        }
    };
    vec![drawing(0), drawing(1)]
}

/// The twelve edges of a box, as signs.
fn wires() -> impl Iterator<Item = (Vector, Vector)> {
    (0..3).flat_map(|a| {
        [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)].into_iter().map(move |(p, q)| {
            let mut from = Vector::zeros();
            (from[a], from[(a + 1) % 3], from[(a + 2) % 3]) = (-1.0, p, q);
            let mut to = from;
            to[a] = 1.0;
            (from, to)
        })
    })
}
