//! Bent ducts with immersed walls against simpleFoam on body-fitted grids (`tests/data/bends`).
use siltflow::flow::{CartesianGrid, Simple};
use siltflow::interfaces::{Closure, WallPiece};
use std::f64::consts::PI;
use turb::{
    Inflow, KEpsilon, KOmega, KOmegaSst, Realizable, RealizableKEpsilon, Sst, StandardKEpsilon, Wilcox,
};
use validation::Outcome;
use validation::bent_duct::{BentDuct, Duct};

/// Iterations at most, and the residual at which a flow is steady.
const ITERATIONS: usize = 2000;
const STEADY: f64 = 1e-5;

/// Bends by 90° and 180° at Re 10⁶ with 160 cells across, four models: root mean square deviations of the
/// velocity along the duct and of the eddy viscosity, friction of both walls, pressure drop.
pub(crate) fn bends() -> Outcome<()> {
    let inflow = Inflow::from_length(1.0, 0.05, 0.07)?;
    // Constants of the reference runs: Wilcox 1998 without its corrections.
    let wilcox = Wilcox { beta: 0.072, gamma: 0.52, ..Wilcox::default() };
    for bend in [0.5 * PI, PI] {
        let case = BentDuct { duct: Duct { bend, turn: 0.0 }, cells: 160, reynolds: 1e6 };
        run(&case, "kOmegaSST", |n| Ok(KOmegaSst::new(Sst::default(), n, inflow)?))?;
        run(&case, "kOmega", |n| Ok(KOmega::new(wilcox, n, inflow)?))?;
        run(&case, "kEpsilon", |n| Ok(KEpsilon::new(StandardKEpsilon::default(), n, inflow)?))?;
        run(&case, "realizableKE", |n| Ok(RealizableKEpsilon::new(Realizable::default(), n, inflow)?))?;
    }
    Ok(())
}

fn run<C: Closure>(case: &BentDuct, name: &str, closure: impl FnOnce(usize) -> Outcome<C>) -> Outcome<()> {
    let start = std::time::Instant::now();
    let (mut flow, mut model, cuts) = case.start(closure)?;
    let mut residual = f64::INFINITY;
    for _ in 0..ITERATIONS {
        residual = flow.iterate_with(&mut model)?.largest();
        if residual <= STEADY {
            break;
        }
    }
    let (degrees, seconds) = (case.duct.bend.to_degrees(), start.elapsed().as_secs_f64());
    println!(
        "{degrees:.0}°, {name}: {} iterations, residual {residual:.1e}, {seconds:.1} s",
        flow.iterations()
    );
    let eddy = model.closure.eddy_viscosity().unwrap_or_default();
    report(&Probe { flow: &flow, eddy, walls: &cuts.walls, duct: case.duct }, name)
}

/// Stations of the reference and their places: heights before the bend, shares of it, one more than
/// the heights behind it. `middle` has the name of its angle in the files.
const STATIONS: [(&str, f64); 6] =
    [("in1H", -1.0), ("in0", 0.0), ("middle", 0.5), ("exit", 1.0), ("exit1H", 2.0), ("exit5H", 6.0)];
const KAPPA: f64 = 0.41;
const E: f64 = 9.8;

/// Linear interpolation between the nodes in the fluid around `x`; nodes lie on faces along the axes
/// `on_faces`.
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

/// Computed flow.
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

    /// Whether the grid holds the duct at `s`.
    fn inside(&self, s: f64) -> bool {
        let (grid, x) = (self.flow.grid(), self.duct.point(s, 1.5));
        (0..2).all(|a| grid.axis(a).centre(0) < x[a] && x[a] < grid.axis(a).centre(grid.cells()[a] - 1))
    }

    /// Pieces of the inner or the outer wall: place along the duct \[m\], friction over the density
    /// \[m²/s²\], area \[m²\].
    fn frictions(&self, outer: bool) -> impl Iterator<Item = [f64; 3]> {
        self.walls.iter().zip(self.flow.wall_tractions()).filter_map(move |(wall, traction)| {
            let [s, r] = self.duct.place([wall.foot.x, wall.foot.y]);
            let [t, n] = self.duct.along(s);
            let friction = (traction.x * t + traction.y * n) / self.flow.fluid().density;
            ((r > 1.5) == outer).then_some([s, friction, wall.area])
        })
    }

    /// Mean friction over a tenth of the height.
    fn friction(&self, s: f64, outer: bool) -> f64 {
        let near = self.frictions(outer).filter(|[at, ..]| (at - s).abs() < 0.05);
        let (sum, areas) =
            near.fold((0.0, 0.0), |(sum, areas), [_, friction, area]| (sum + area * friction, areas + area));
        sum / areas
    }

    fn mean_pressure(&self, s: f64) -> f64 {
        let at = |k: usize| {
            let x = self.duct.point(s, 1.0 + (k as f64 + 0.5) / 100.0);
            between(self.flow.grid(), self.duct, [false; 2], x, |i, j| self.flow.pressure().row(j)[i])
        };
        (0..100).map(at).sum::<f64>() / 100.0
    }
}

/// Table of the reference at a station.
fn read(duct: Duct, model: &str, station: &str) -> Outcome<Vec<Vec<f64>>> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/bends");
    let degrees = duct.bend.to_degrees().round();
    let middle = format!("bend{}", 0.5 * degrees);
    let station = if station == "middle" { &middle } else { station };
    let text = std::fs::read_to_string(format!("{folder}/bend{degrees}_{model}_c_{station}.csv"))?;
    let row = |line: &str| line.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>();
    Ok(text.lines().skip(1).map(row).collect::<Result<_, _>>()?)
}

/// Friction over the density of a wall of the reference, from its cell next to it:
/// C_μ^¼ √k u κ/ln(E y*) \[m²/s²\].
fn given_friction(row: &[f64], y: f64, nu: f64) -> f64 {
    let speed = 0.09_f64.powf(0.25) * row[5].sqrt();
    speed * row[3] * KAPPA / (E * speed * y / nu).ln()
}

/// Prints the deviations.
fn report(probe: &Probe<'_>, model: &str) -> Outcome<()> {
    let duct = probe.duct;
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
            let given = given_friction(row, row[2].min(1.0 - row[2]), probe.flow.fluid().viscosity);
            print!("  {:+.1}", 100.0 * (probe.friction(s, outer) / given - 1.0));
        }
        println!();
    }
    // The duct may be shorter behind the bend than that of the reference.
    let rows: Vec<_> = read(duct, model, "pmean")?.into_iter().filter(|row| probe.inside(row[0])).collect();
    let drop = |f: &dyn Fn(usize) -> f64| f(0) - f(rows.len() - 1);
    let (ours, given) = (drop(&|k| probe.mean_pressure(rows[k][0])), drop(&|k| rows[k][1]));
    let to = rows.last().map_or(0.0, |row| row[0]);
    println!(
        "pressure drop to {to:.1}: {ours:.5}, reference {given:.5}: {:+.1} %",
        100.0 * (ours / given - 1.0)
    );
    Ok(())
}
