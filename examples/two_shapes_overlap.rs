//! What two non-convex bodies share, by the virtual mesh: figures 6 and 7 of Isoz et al. (2023).
//!
//! An adaptive tree of boxes divides the intersection of both bounding boxes. Boxes inside of both
//! bodies count whole, those that a surface cuts are halved up to a level, and the edge boxes,
//! cut by both surfaces, give the contact plane ρ_c and its normal n_c by least squares. Two lobes
//! of the dumbbells meet, so that the exact values are those of two balls at the distance d,
//!
//! ```text
//! V = π (4R + d)(2R − d)²/12,   n = (x_a − x_b)/d.
//! ```
//!
//! The picture has (a) both bodies with the boxes to level 5 in the plane of their centres, (b) the
//! boxes, ρ_c and n_c, (c) the error of the volume over the level.
//!
//! `cargo run --release --example two_shapes_overlap [FOLDER]`, 1 s;
//! `out/two_shapes_overlap/virtual_mesh.png`.
use render::sketch::{Drawing, Paint, draw};
use siltflow::dem::{BoxKind, Implicit, Normal, Overlap, OverlapSolver, Refinement, Route, SubBox};
use siltflow::interfaces::{Aabb, Point, Pose, Rotation, Solid, Vector};
use std::error::Error;
use std::f64::consts::PI;

const R: f64 = 1.0; // radius of a lobe, m
const HALF: f64 = 0.8; // half the distance of the lobes, m

/// Two balls that overlap, on the axis x.
struct Dumbbell;

impl Solid for Dumbbell {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        Vector::new(x.x.abs() - HALF, x.y, x.z).norm() - R
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::new(HALF + R, R, R))
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args().nth(1).unwrap_or("out/two_shapes_overlap".into());
    let body = Implicit::new("dumbbell", Dumbbell, 1e-3)?;
    let turn = Rotation::from_axis_angle(&Vector::z_axis(), 1.1);
    let poses = [Pose::at([0.0; 3]), Pose { position: Point::new(2.0, 2.1, 0.0), orientation: turn }];
    // The lobes that meet.
    let [a, b] =
        [poses[0].to_world(Point::new(HALF, 0.0, 0.0)), poses[1].to_world(Point::new(-HALF, 0.0, 0.0))];
    let d = (a - b).norm();
    let (volume, normal) = (PI * (4.0 * R + d) * (2.0 * R - d).powi(2) / 12.0, (a - b) / d);

    let solve = |level| -> Result<(Overlap, Vec<SubBox>), Box<dyn Error>> {
        let mut solver = OverlapSolver::new()
            .with_route(Some(Route::Tree))
            .with_refinement(Refinement::Levels(level))
            .with_normal(Normal::PlaneFit);
        let patches = solver.solve(&body, &poses[0], &body, &poses[1])?;
        let overlap = *patches.first().ok_or("the bodies do not touch")?;
        Ok((overlap, solver.boxes().collect()))
    };
    println!("level  boxes  volume (exact {volume:.6})  error    angle of n_c to the exact normal");
    let mut errors = Vec::new();
    for level in 1..=6 {
        let (overlap, boxes) = solve(level)?;
        let error = (overlap.volume / volume - 1.0).abs();
        let angle = overlap.normal.angle(&normal).to_degrees();
        println!("{level:5}  {:5}  {:.6}  {error:.1e}  {angle:.2}°", boxes.len(), overlap.volume);
        errors.push([f64::from(level), error.log10()]);
    }

    let (overlap, boxes) = solve(5)?;
    let slice: Vec<&SubBox> = boxes.iter().filter(|b| b.centre.z.abs() <= b.half.z).collect();
    let paint = |b: &SubBox| match b.kind {
        BoxKind::Edge => Paint::Kind(5, 0.1),
        _ if b.volume <= 0.0 => Paint::Share(0.06),
        BoxKind::Inside => Paint::Share(0.75),
        BoxKind::Cut => Paint::Kind(4, 0.45),
    };
    let view = |title: &str, range: [(f64, f64); 2]| {
        let mut view = Drawing { title: title.into(), range, ..Drawing::default() };
        for b in &slice {
            let (low, high) = (b.centre - b.half, b.centre + b.half);
            view.cells.push(([low.x, low.y], [high.x, high.y], paint(b)));
            let corners = [[low.x, low.y], [high.x, low.y], [high.x, high.y], [low.x, high.y]];
            view.lines.push(([&corners[..], &corners[..1]].concat(), 1.0, Paint::Share(0.45)));
        }
        for (pose, kind) in poses.iter().zip([2, 0]) {
            let distance = |[x, y]: [f64; 2]| body.signed_distance(pose.to_body(Point::new(x, y, 0.0)), 10.0);
            view.add_zero_level(distance, 200, 3.0, Paint::Kind(kind, 0.0));
        }
        view
    };
    let whole = view("(a) Two dumbbells and the virtual mesh", [(-2.0, 4.2), (-1.2, 4.0)]);
    let c = overlap.centroid;
    let mut close = view(
        "(b) Boxes to level 5, contact plane and normal",
        [(c.x - 0.9, c.x + 0.9), (c.y - 0.7, c.y + 0.7)],
    );
    let at = |s: f64, along: Vector| [c.x + s * along.x, c.y + s * along.y];
    let plane = overlap.normal.cross(&Vector::z());
    close.lines.push((vec![at(-2.0, plane), at(2.0, plane)], 3.5, Paint::Kind(1, 0.0)));
    close.lines.push((vec![at(0.0, overlap.normal), at(0.4, overlap.normal)], 3.5, Paint::Ink));
    close.legend = vec![
        (Paint::Share(0.75), "inside both".into()),
        (Paint::Kind(4, 0.45), "cut by one surface".into()),
        (Paint::Kind(5, 0.1), "edge: cut by both".into()),
        (Paint::Kind(1, 0.0), "contact plane".into()),
        (Paint::Ink, "normal n_c".into()),
    ];
    let labels = ["level", "log₁₀ |V/V_exact − 1|"];
    let error = Drawing::curves("(c) Error of the volume", labels, &[("virtual mesh", errors)]);
    std::fs::create_dir_all(&out)?;
    Ok(draw(format!("{out}/virtual_mesh.png").as_ref(), 3, &[whole, close, error])?)
}
