//! Curves of a run.
use crate::run_folder::RunFolder;
use crate::run_table::RunTable;
use render::chart::{Chart, ChartAxis, ChartLevel, ChartLine};
use serde_json::Value;

/// Lines of a chart.
const MOST_LINES: usize = 8;
/// Names of the axes.
const AXES: [&str; 3] = ["x", "y", "z"];

/// A value that a chart shows over time: a key that the charts of several runs share, and its chart.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    /// Heading of its section.
    pub(crate) section: &'static str,
    pub(crate) chart: Chart,
    /// Whether all values are 0, and no chart is needed.
    pub(crate) zero: bool,
    /// Notes on values that curves leave out.
    pub(crate) notes: Vec<String>,
    /// Pointers of references that are drawn.
    pub(crate) drawn: Vec<String>,
}

/// Published values of a run, with their pointers into the results.
pub(crate) fn references(run: &RunFolder) -> Vec<(String, String, f64)> {
    let list = run.plan["references"].as_array().into_iter().flatten();
    let one = |r: &Value| {
        let text = |key: &str| r[key].as_str().unwrap_or_default();
        let name = match text("source") {
            "" => text("name").to_owned(),
            source => format!("{} ({source})", text("name")),
        };
        Some((text("pointer").to_owned(), name, r["value"].as_f64()?))
    };
    list.filter_map(one).collect()
}

/// Statistics of a load that are values of its curve.
const LEVELS: [&str; 5] = ["last", "mean", "rms", "lowest", "highest"];

/// Names of the bodies in a list of the results.
fn names_of(list: &Value) -> Vec<String> {
    let list = list.as_array().into_iter().flatten();
    list.map(|one| one["body"].as_str().unwrap_or_default().to_owned()).collect()
}

/// Collects charts of a run.
struct Charts<'a> {
    run: &'a RunFolder,
    section: &'static str,
    references: Vec<(String, String, f64)>,
    out: Vec<Series>,
}

impl Charts<'_> {
    /// Adds a chart with the references for which `line` has the name of their line, by their
    /// pointer.
    fn add(
        &mut self,
        title: &str,
        x: ChartAxis,
        y: ChartAxis,
        lines: Vec<(String, Vec<(f64, f64)>)>,
        line: &dyn Fn(&str) -> Option<String>,
    ) {
        let lines: Vec<ChartLine> = lines
            .into_iter()
            .filter(|(_, points)| !points.is_empty())
            .take(MOST_LINES)
            .enumerate()
            .map(|(colour, (name, points))| ChartLine { name, points, colour })
            .collect();
        if lines.is_empty() {
            return;
        }
        let (mut levels, mut drawn) = (Vec::new(), Vec::new());
        for (pointer, name, value) in &self.references {
            let Some(owner) = line(pointer) else { continue };
            let Some(number) = lines.iter().position(|line| line.name == owner) else { continue };
            // A single line needs no colour.
            let colour = (lines.len() > 1).then_some(number);
            levels.push(ChartLevel { name: format!("reference: {name}"), value: *value, colour });
            drawn.push(pointer.clone());
        }
        let chart = Chart { title: title.into(), x, y, lines, levels };
        let zero = chart.lines.iter().flat_map(|line| &line.points).all(|p| p.1 == 0.0);
        self.out.push(Series { section: self.section, chart, zero, notes: Vec::new(), drawn });
    }

    /// One line per body for column `column` of a table, scaled.
    fn by_body(
        &self,
        table: &RunTable,
        column: &str,
        scale: impl Fn(&str) -> Option<f64>,
    ) -> Vec<(String, Vec<(f64, f64)>)> {
        let lines = table.bodies.iter().enumerate().filter_map(|(i, (name, _))| {
            let scale = scale(name)?;
            let points = table.points(i, column)?;
            Some((name.clone(), points.into_iter().map(|p| (p.0, scale * p.1)).collect()))
        });
        lines.collect()
    }

    /// Adds a note to the last chart.
    fn note(&mut self, note: String) {
        if let Some(series) = self.out.last_mut() {
            series.notes.push(note);
        }
    }

    fn time(&self) -> ChartAxis {
        ChartAxis::linear("time", "s")
    }

    fn loads(&mut self) {
        let run = self.run;
        let Some(table) = &run.forces else { return };
        self.section = "Loads on bodies";
        let unit = if run.dim() == 2 { "N/m" } else { "N" };
        let bodies: Vec<String> = names_of(&run.result["forces"]);
        for (a, axis) in AXES.iter().enumerate().take(run.dim()) {
            let column = format!("f{axis}");
            let with = self.by_body(table, &column, |body| run.coefficient(body));
            let line = |kind: &str, pointer: &str| {
                let parts: Vec<&str> = pointer.split('/').collect();
                match parts[..] {
                    ["", "forces", body, k, stat, c]
                        if k == kind && LEVELS.contains(&stat) && c == a.to_string() =>
                    {
                        bodies.get(body.parse::<usize>().ok()?).cloned()
                    }
                    _ => None,
                }
            };
            if !with.is_empty() {
                let y = ChartAxis::linear(format!("force coefficient C{axis}"), "");
                self.add(&format!("Force coefficient along {axis}"), self.time(), y, with, &|pointer| {
                    line("coefficients", pointer)
                });
            } else {
                let lines = self.by_body(table, &column, |_| Some(1.0));
                let y = ChartAxis::linear(format!("force F{axis}"), unit);
                self.add(&format!("Force along {axis}"), self.time(), y, lines, &|pointer| {
                    line("load", pointer)
                });
            }
        }
    }

    fn bodies(&mut self) {
        let run = self.run;
        let Some(table) = &run.trajectories else { return };
        self.section = "Bodies";
        let plane = run.dim() == 2;
        let axes = &AXES[..run.dim().clamp(2, 3)];
        let turns = if plane { &AXES[2..] } else { &AXES[..] };
        let [newton, newton_metre] = if plane { ["N/m", "N m/m"] } else { ["N", "N m"] };
        self.components(table, "", ["Position", "position "], "m", axes);
        self.components(table, "v", ["Velocity along", "velocity v"], "m/s", axes);
        let names = names_of(&run.result["trajectories"]);
        let speed = |i: usize| -> Option<Vec<(f64, f64)>> {
            let [x, y, z] = [table.points(i, "vx")?, table.points(i, "vy")?, table.points(i, "vz")?];
            Some(
                x.iter()
                    .zip(&y)
                    .zip(&z)
                    .map(|((x, y), z)| (x.0, (x.1 * x.1 + y.1 * y.1 + z.1 * z.1).sqrt()))
                    .collect(),
            )
        };
        let lines = table
            .bodies
            .iter()
            .enumerate()
            .filter_map(|(i, (name, _))| Some((name.clone(), speed(i)?)))
            .collect();
        self.add("Speed of bodies", self.time(), ChartAxis::linear("speed |v|", "m/s"), lines, &|pointer| {
            let body = pointer.strip_prefix("/trajectories/")?.strip_suffix("/largest_speed")?;
            names.get(body.parse::<usize>().ok()?).cloned()
        });
        self.components(table, "w", ["Angular velocity about", "angular velocity ω"], "rad/s", turns);
        if run.forces.is_none() {
            self.components(table, "f", ["Load of the fluid along", "force F"], newton, axes);
        }
        self.components(table, "t", ["Torque of the fluid about", "torque T"], newton_metre, turns);
        // Without contacts there are no charts of them.
        let shown = self.out.len();
        self.components(table, "fc", ["Contact force along", "force F"], newton, axes);
        self.components(table, "tc", ["Contact torque about", "torque T"], newton_metre, turns);
        let mut number = 0;
        self.out.retain(|series| {
            number += 1;
            number <= shown || !series.zero
        });
    }

    /// Adds a chart for each of the `axes`: columns `prefix` and axis, with the beginnings of title
    /// and label.
    fn components(
        &mut self,
        table: &RunTable,
        prefix: &str,
        [title, label]: [&str; 2],
        unit: &'static str,
        axes: &[&str],
    ) {
        for axis in axes {
            let lines = self.by_body(table, &format!("{prefix}{axis}"), |_| Some(1.0));
            let y = ChartAxis::linear(format!("{label}{axis}"), unit);
            self.add(&format!("{title} {axis}"), self.time(), y, lines, &|_| None);
        }
    }

    /// Means over time and two axes, along the third.
    fn averages(&mut self) {
        let Some(table) = &self.run.profile else { return };
        self.section = "Averages";
        let axis = table.names.first().cloned().unwrap_or_default();
        let x = ChartAxis::linear(axis.clone(), "m");
        let groups: [(&str, &str, &'static str, &[&str]); 3] = [
            ("Mean velocity", "velocity", "m/s", &["u", "v", "w"]),
            ("Mean pressure", "pressure", "Pa", &["p"]),
            ("Reynolds stresses", "Reynolds stress", "m²/s²", &["uu", "vv", "ww", "uv", "uw", "vw"]),
        ];
        for (title, label, unit, columns) in groups {
            let line = |column: &&str| Some(((*column).to_owned(), table.points(0, column)?));
            let lines = columns.iter().filter_map(line).collect();
            let title = format!("{title} along {axis}");
            self.add(&title, x.clone(), ChartAxis::linear(label, unit), lines, &|_| None);
        }
    }

    fn probes(&mut self) {
        let run = self.run;
        self.section = "Probes";
        for (number, (name, table)) in run.probes.iter().enumerate() {
            let results = run.result["probes"].as_array();
            let number = results
                .and_then(|list| list.iter().position(|p| p["name"] == name.as_str()))
                .unwrap_or(number);
            let label = |i: usize| match run.result["probes"][number]["points"][i]["at"].as_array() {
                Some(at) => {
                    let at = at.iter().take(run.dim()).filter_map(Value::as_f64).map(crate::text::number);
                    format!("point {i} at ({}) m", at.collect::<Vec<_>>().join(", "))
                }
                None => format!("point {i}"),
            };
            let all = table.names.iter().filter(|name| name.starts_with('p')).count();
            for (a, quantity) in ["u", "v", "w", "p"].into_iter().enumerate() {
                let points: Vec<(String, Vec<(f64, f64)>)> = (0..MOST_LINES)
                    .filter_map(|i| Some((label(i), table.points(0, &format!("{quantity}{i}"))?)))
                    .collect();
                let unit = if quantity == "p" { "Pa" } else { "m/s" };
                let value = if quantity == "p" { "pressure".to_owned() } else { format!("velocity/{a}") };
                let prefix = format!("/probes/{number}/points/");
                self.add(
                    &format!("Probes {name}: {quantity}"),
                    self.time(),
                    ChartAxis::linear(quantity, unit),
                    points,
                    &|pointer| {
                        let (point, of) = pointer.strip_prefix(&prefix)?.split_once('/')?;
                        (of == value).then(|| label(point.parse().unwrap_or(usize::MAX)))
                    },
                );
                if all > MOST_LINES {
                    self.note(format!("Of {all} points the first {MOST_LINES} are shown."));
                }
            }
        }
    }

    fn residuals(&mut self) {
        let Some(table) = &self.run.residuals else { return };
        self.section = "Residuals";
        let names = [
            ("x", "momentum x"),
            ("y", "momentum y"),
            ("z", "momentum z"),
            ("continuity", "continuity"),
            ("closure", "turbulence model"),
            ("scalars", "scalars (change)"),
        ];
        let lines = names
            .into_iter()
            .filter_map(|(column, name)| Some((name.to_owned(), table.points(0, column)?)))
            // A residual that is 0 throughout is that of an equation that is not solved.
            .filter(|(_, points)| points.iter().any(|p| p.1 != 0.0))
            .collect();
        let y = ChartAxis { logarithmic: true, ..ChartAxis::linear("relative residual", "") };
        self.add("Residuals", ChartAxis::linear("iteration", ""), y, lines, &|_| None);
        if let (Some(series), Some(value)) = (self.out.last_mut(), self.run.plan["tolerance"].as_f64()) {
            series.chart.levels.push(ChartLevel { name: "tolerance".into(), value, colour: None });
        }
    }

    fn budgets(&mut self) {
        let run = self.run;
        let Some(table) = &run.history else { return };
        self.section = "Steps and budgets";
        let joule = if run.dim() == 2 { "J/m" } else { "J" };
        let named = |columns: &[(&str, &str)]| -> Vec<(String, Vec<(f64, f64)>)> {
            let one = |(column, name): &(&str, &str)| Some(((*name).to_owned(), table.points(0, column)?));
            columns.iter().filter_map(one).filter(|(_, points)| points.iter().any(|p| p.1 != 0.0)).collect()
        };
        let time = self.time();
        self.add(
            "Time step",
            time.clone(),
            ChartAxis::linear("time step Δt", "s"),
            named(&[("dt", "Δt")]),
            &|_| None,
        );
        self.add(
            "Courant number",
            time.clone(),
            ChartAxis::linear("Courant number", ""),
            named(&[("courant", "Courant number")]),
            &|_| None,
        );
        self.add(
            "Kinetic energy",
            time.clone(),
            ChartAxis::linear("kinetic energy", joule),
            named(&[("kinetic_energy", "kinetic energy")]),
            &|_| None,
        );
        let terms = [
            ("energy_gained", "energy gained"),
            ("work", "work of weight and forces"),
            ("side_work", "work of the sides"),
            ("driving_work", "work of what holds or drives bodies"),
            ("inner_work", "work inside bodies"),
            ("dissipation", "viscous dissipation"),
            ("eddy_dissipation", "dissipation by eddy viscosity"),
            ("forcing_loss", "loss of the forcing"),
            ("contact_work", "work of contacts"),
            ("brought", "brought by bodies that enter"),
        ];
        let mut terms = named(&terms);
        // The largest first, so that terms that are left out are the smallest.
        let size = |points: &[(f64, f64)]| {
            points.iter().map(|p| p.1.abs()).filter(|y| y.is_finite()).fold(0.0, f64::max)
        };
        terms.sort_by(|a, b| size(&b.1).total_cmp(&size(&a.1)));
        let largest = terms.first().map_or(0.0, |t| size(&t.1));
        let all = terms.len();
        terms.retain(|t| size(&t.1) > 1e-6 * largest);
        terms.truncate(MOST_LINES);
        let left_out = all - terms.len();
        self.add(
            "Energy budget: its terms since the start",
            time.clone(),
            ChartAxis::linear("energy", joule),
            terms,
            &|_| None,
        );
        if left_out > 0 {
            self.note(format!("The smallest {left_out} terms are left out."));
        }
        self.add(
            "Energy budget: what its terms leave",
            time.clone(),
            ChartAxis::linear("energy residual", joule),
            named(&[("energy_residual", "energy gained less works, plus losses")]),
            &|_| None,
        );
        let logarithmic = |label: &str| ChartAxis { logarithmic: true, ..ChartAxis::linear(label, "") };
        self.add(
            "Momentum budget",
            time.clone(),
            logarithmic("residual/impulses"),
            named(&[("momentum_residual", "momentum gained less impulses, over impulses")]),
            &|_| None,
        );
        self.add(
            "Mass budget",
            time,
            logarithmic("largest |∇·u| Δt so far"),
            named(&[("divergence", "largest |∇·u| Δt of a step so far")]),
            &|_| None,
        );
    }
}

/// All charts of a run.
pub(crate) fn series(run: &RunFolder) -> Vec<Series> {
    let mut charts = Charts { run, section: "", references: references(run), out: Vec::new() };
    charts.residuals();
    charts.loads();
    charts.bodies();
    charts.probes();
    charts.averages();
    charts.budgets();
    charts.out
}
