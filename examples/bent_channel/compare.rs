//! Profiles across the duct beside those of the body-fitted solution.
use crate::duct::Duct;
use example_support::Outcome;
use render::Domain;
use render::comparison::{Comparison, Curve, Panel};
use siltflow::flow::{CartesianGrid, Simple};
use siltflow::interfaces::WallPiece;
use std::path::Path;

/// The stations of the reference (`middle` has the name of its angle) and where they are: heights before the bend, parts of it, heights behind it and one.
const STATIONS: [(&str, f64); 6] =
    [("in1H", -1.0), ("in0", 0.0), ("middle", 0.5), ("exit", 1.0), ("exit1H", 2.0), ("exit5H", 6.0)];
const KAPPA: f64 = 0.41;
const E: f64 = 9.8;

/// Straight between the nodes in the fluid around `x`; nodes are on faces along the axes where `on_faces`.
fn between(
    grid: &CartesianGrid<2>,
    duct: Duct,
    on_faces: [bool; 2],
    x: [f64; 2],
    value: impl Fn(usize, usize) -> f64,
) -> f64 {
    let place =
        |a: usize, i: usize| if on_faces[a] { grid.axis(a).faces()[i] } else { grid.axis(a).centre(i) };
    let low = [0, 1].map(|a| {
        let n = grid.axis(a).cells();
        (1..n - 1).take_while(|&i| place(a, i) <= x[a]).last().unwrap_or(0)
    });
    let (mut sum, mut weights) = (0.0, 0.0);
    for k in 0..4 {
        let at = [low[0] + (k & 1), low[1] + (k >> 1)];
        if duct.distance([place(0, at[0]), place(1, at[1])]) <= 0.0 {
            continue;
        }
        let weight: f64 = (0..2)
            .map(|a| {
                let part =
                    ((x[a] - place(a, low[a])) / (place(a, low[a] + 1) - place(a, low[a]))).clamp(0.0, 1.0);
                if at[a] > low[a] { part } else { 1.0 - part }
            })
            .product();
        sum += weight * value(at[0], at[1]);
        weights += weight;
    }
    if weights > 0.0 { sum / weights } else { 0.0 }
}

/// What is asked of a computed flow.
struct Probe<'a> {
    flow: &'a Simple<2>,
    eddy: &'a [f64],
    walls: &'a [WallPiece],
    duct: Duct,
}

impl Probe<'_> {
    fn raw(&self, x: [f64; 2], t: [f64; 2]) -> f64 {
        let grid = self.flow.grid();
        let of = |c: usize| {
            let on_faces = [c == 0, c == 1];
            between(grid, self.duct, on_faces, x, |i, j| self.flow.velocity().field(c).row(j)[i])
        };
        of(0) * t[0] + of(1) * t[1]
    }

    /// Velocity along the duct at radius `r`; nearer to the wall than a cell and a half by the logarithmic law.
    fn velocity(&self, s: f64, r: f64) -> f64 {
        let (t, h) = (self.duct.along(s), 1.5 * self.flow.grid().axis(1).narrowest());
        let y = 0.5 - (r - 1.5).abs();
        if y >= h {
            return self.raw(self.duct.point(s, r), t);
        }
        let edge = if r < 1.5 { 1.0 + h } else { 2.0 - h };
        let (u, nu) = (self.raw(self.duct.point(s, edge), t), self.flow.fluid().viscosity);
        let mut plus = 20.0;
        for _ in 0..50 {
            plus = (E * u.abs() * h / (nu * plus)).max(E).ln() / KAPPA;
        }
        let friction = u / plus;
        friction * (E * friction.abs() * y / nu).max(1.0).ln() / KAPPA
    }

    fn eddy(&self, s: f64, r: f64) -> f64 {
        let (grid, n) = (self.flow.grid(), self.flow.grid().cells()[0]);
        between(grid, self.duct, [false; 2], self.duct.point(s, r), |i, j| self.eddy[i + n * j])
    }

    /// Is the duct there, and not beside the outlet?
    fn inside(&self, s: f64) -> bool {
        let (grid, x) = (self.flow.grid(), self.duct.point(s, 1.5));
        (0..2).all(|a| grid.axis(a).centre(0) < x[a] && x[a] < grid.axis(a).centre(grid.cells()[a] - 1))
    }

    /// What every piece of the inner or the outer wall takes along the duct: where it is \[m\], friction over the density \[m²/s²\], area.
    fn frictions(&self, outer: bool) -> impl Iterator<Item = [f64; 3]> {
        self.walls.iter().zip(self.flow.wall_tractions()).filter_map(move |(wall, traction)| {
            let [s, r] = self.duct.place([wall.foot.x, wall.foot.y]);
            let [t, n] = self.duct.along(s);
            let friction = (traction.x * t + traction.y * n) / self.flow.fluid().density;
            ((r > 1.5) == outer).then_some([s, friction, wall.area])
        })
    }

    /// The mean over a tenth of the height.
    fn friction(&self, s: f64, outer: bool) -> f64 {
        let near = self.frictions(outer).filter(|[at, ..]| (at - s).abs() < 0.05);
        let (sum, areas) =
            near.fold((0.0, 0.0), |(sum, areas), [_, friction, area]| (sum + area * friction, areas + area));
        sum / areas
    }

    /// Tables of the friction along the inner and the outer wall.
    fn write_friction(&self, out: &Path) -> Outcome<()> {
        for (outer, name) in [(false, "inner"), (true, "outer")] {
            let mut rows: Vec<_> = self.frictions(outer).collect();
            rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
            let mut text = String::from("s [m],friction over density [m2/s2],area [m2]\n");
            for [s, friction, area] in rows {
                text += &format!("{s:.6},{friction:.6e},{area:.4e}\n");
            }
            std::fs::write(out.join(format!("friction_{name}.csv")), text)?;
        }
        Ok(())
    }

    fn mean_pressure(&self, s: f64) -> f64 {
        let at = |k: usize| {
            let x = self.duct.point(s, 1.0 + (k as f64 + 0.5) / 100.0);
            between(self.flow.grid(), self.duct, [false; 2], x, |i, j| self.flow.pressure().row(j)[i])
        };
        (0..100).map(at).sum::<f64>() / 100.0
    }
}

/// The reference of a bend; a straight duct has that of the one by 90°.
fn read(duct: Duct, model: &str, station: &str) -> Outcome<Vec<Vec<f64>>> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/bends");
    let degrees = if duct.bend == 0.0 { 90.0 } else { duct.bend.to_degrees().round() };
    let middle = format!("bend{}", 0.5 * degrees);
    let station = if station == "middle" { &middle } else { station };
    let text = std::fs::read_to_string(format!("{folder}/bend{degrees}_{model}_c_{station}.csv"))?;
    let row = |line: &str| line.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>();
    Ok(text.lines().skip(1).map(row).collect::<Result<_, _>>()?)
}

/// What the wall of a reference takes over the density \[m²/s²\], of the cell beside it: C_μ^¼ √k u κ/ln(E y*).
fn given_friction(row: &[f64], y: f64, nu: f64) -> f64 {
    let speed = 0.09_f64.powf(0.25) * row[5].sqrt();
    speed * row[3] * KAPPA / (E * speed * y / nu).ln()
}

/// Prints the differences and draws the profiles.
pub(crate) fn report(
    flow: &Simple<2>,
    eddy: &[f64],
    walls: &[WallPiece],
    duct: Duct,
    model: &str,
    out: &Path,
) -> Outcome<()> {
    let probe = Probe { flow, eddy, walls, duct };
    let mut panels = Vec::new();
    println!(
        "station   U_t off by [% of U_in], ν_t [% of its rms], friction of the inner and the outer wall [%]"
    );
    for (station, turns) in STATIONS {
        // `in` and `exit` are counted in heights from the ends of the bend.
        let length = 1.5 * duct.bend;
        let s = match turns {
            t if t <= 0.0 => t,
            t if t <= 1.0 => t * length,
            t => length + t - 1.0,
        };
        if duct.bend == 0.0 && turns > -1.0 {
            break;
        }
        let rows = read(duct, model, station)?;
        let (mut du, mut de, mut scale) = (0.0, 0.0, 0.0);
        for (k, row) in rows.iter().enumerate() {
            let edge = |k: usize| 0.5 * (rows[k - 1][2] + rows[k][2]);
            let low = if k == 0 { 0.0 } else { edge(k) };
            let width = if k + 1 == rows.len() { 1.0 } else { edge(k + 1) } - low;
            du += width * (probe.velocity(s, 1.0 + row[2]) - row[3]).powi(2);
            de += width * (probe.eddy(s, 1.0 + row[2]) - row[7]).powi(2);
            scale += width * row[7] * row[7];
        }
        print!("{station:8}  {:.2}  {:.1}", 100.0 * du.sqrt(), 100.0 * (de / scale).sqrt());
        for outer in [false, true].into_iter().filter(|_| probe.inside(s + 0.05)) {
            let row = &rows[if outer { rows.len() - 1 } else { 0 }];
            let given = given_friction(row, row[2].min(1.0 - row[2]), flow.fluid().viscosity);
            print!("  {:+.1}", 100.0 * (probe.friction(s, outer) / given - 1.0));
        }
        println!();
        let line = |f: &dyn Fn(f64) -> f64| {
            (0..=200).map(|k| (f64::from(k) / 200.0, f(1.0 + f64::from(k) / 200.0))).collect()
        };
        let points =
            |column: usize, scale: f64| rows.iter().map(|row| (row[2], scale * row[column])).collect();
        let label = String::new();
        panels.push(Panel {
            x: format!("{station}: distance from the inner wall in H"),
            y: "U_t in U".into(),
            curves: vec![Curve {
                label: label.clone(),
                line: line(&|r| probe.velocity(s, r.clamp(1.0005, 1.9995))),
                points: points(3, 1.0),
            }],
        });
        panels.push(Panel {
            x: format!("{station}: distance from the inner wall in H"),
            y: "ν_t in 1e-3 U H".into(),
            curves: vec![Curve { label, line: line(&|r| 1e3 * probe.eddy(s, r)), points: points(7, 1e3) }],
        });
    }
    if duct.bend > 0.0 {
        // The duct may be shorter behind the bend than that of the reference.
        let rows: Vec<_> =
            read(duct, model, "pmean")?.into_iter().filter(|row| probe.inside(row[0])).collect();
        let drop = |f: &dyn Fn(usize) -> f64| f(0) - f(rows.len() - 1);
        let (ours, given) = (drop(&|k| probe.mean_pressure(rows[k][0])), drop(&|k| rows[k][1]));
        let to = rows.last().map_or(0.0, |row| row[0]);
        println!(
            "pressure drop to {to:.1}: {ours:.5}, reference {given:.5}: {:+.1} %",
            100.0 * (ours / given - 1.0)
        );
    }
    let domain = Domain { width: 1.0, height: 1.0, periodic: [false; 2] };
    let names = ["immersed walls", "body-fitted"];
    Comparison { domain, fields: &[], panels: &panels, columns: 4, names }.draw(&out.join("profiles.png"))?;
    println!("{}", out.join("profiles.png").display());
    probe.write_friction(out)
}
