//! Results as people read them.
use crate::result::{Compared, Ending, RunResult};
use serde_json::Value;

/// The head of a table of runs.
pub const TABLE_HEAD: &str =
    "| scene | cells | steps | CPU s | for output | results |\n|---|---|---|---|---|---|\n";

/// The row of a run that came to nothing, and why.
pub fn empty_row(scene: &str, why: &str) -> String {
    format!("| {scene} | | | | | {} |\n", why.replace('\n', " ").replace('|', "\\|"))
}

/// A number in `text`'s format, or a dash for what is not there.
fn shown(value: &Value, text: impl Fn(f64) -> String) -> String {
    value.as_f64().filter(|x| x.is_finite()).map_or_else(|| "–".into(), text)
}

/// Loads of so many bodies are in a summary.
const MOST_BODIES: usize = 12;

/// Steps made, or iterations of a steady flow.
fn counted(r: &Value) -> String {
    match r.get("iterations") {
        Some(n) => format!("{n} iterations"),
        None => r["steps"].to_string(),
    }
}

impl Compared {
    /// With `digits` behind the point.
    fn line(&self, digits: usize) -> String {
        let Self { name, reference, source, .. } = self;
        let source = if source.is_empty() { String::new() } else { format!("{source}: ") };
        match (self.found, self.error()) {
            (Some(found), Some(error)) if *reference == 0.0 => {
                format!("{name} {found:.digits$} ({source}0, off by {error:.2e})")
            }
            (Some(found), Some(error)) => {
                format!("{name} {found:.digits$} ({source}{reference}, {:+.2} %)", 100.0 * error)
            }
            _ => format!("{name} is not in the results ({source}{reference})"),
        }
    }
}

/// Note of a run that ended before its time, and why.
fn ended(result: &Value, why: &str) -> String {
    format!("{why} at {}", shown(&result["time"], |x| format!("{x:.4} s")))
}

impl RunResult {
    /// Share of the wall time that went into files and pictures.
    fn output_share(&self) -> f64 {
        let seconds = |key: &str| self.timings[key].as_f64().unwrap_or(0.0);
        seconds("output") / seconds("wall").max(1e-9)
    }

    /// A row of a table of runs, under [`TABLE_HEAD`]: what it took, how it ended if not as it should, what came out beside what others found, and what the books
    /// leave: energy over work, momentum over impulses.
    pub fn row(&self) -> String {
        let r = &self.result;
        let cells: Vec<String> =
            r["cells"].as_array().into_iter().flatten().map(ToString::to_string).collect();
        let mut notes = Vec::new();
        let residual = shown(&r["residual"], |x| format!("residual {x:.1e}"));
        match self.ending {
            Ending::Stopped => {
                let end = shown(&r["end"], |x| format!(" of {x} s"));
                let time = shown(&r["time"], |x| format!("{x:.4} s"));
                notes.push(format!("**stopped** at {time}{end}, `siltflow resume` goes on"));
            }
            Ending::NotConverged => notes.push(format!("**not converged**, {residual}")),
            Ending::Done if r.get("residual").is_some() => notes.push(residual),
            Ending::Done => {}
            Ending::Steady => notes.push(ended(r, "steady")),
            Ending::Event => notes.push(ended(r, "event")),
        }
        if self.ending != Ending::Stopped {
            notes.extend(self.compared.iter().map(|c| c.line(5)));
            if let Some(l) = r.get("ledger") {
                let (work, residual) = (work(l), l["energy_residual"].as_f64());
                if let Some(residual) = residual.filter(|_| work > 0.0) {
                    notes.push(format!("energy {:+.3} %", 100.0 * residual / work));
                }
                notes.push(shown(&l["momentum_whole_run"], |x| format!("momentum {x:.0e}")));
            }
        }
        format!(
            "| {} | {} | {} | {} | {:.0} % | {} |\n",
            r["scene"].as_str().unwrap_or_default(),
            cells.join(" × "),
            counted(r),
            shown(&self.timings["cpu"], |x| format!("{x:.1}")),
            100.0 * self.output_share(),
            notes.join("; "),
        )
    }

    /// A few lines.
    pub fn summary(&self) -> String {
        let (r, t) = (&self.result, &self.timings);
        let word = match self.ending {
            Ending::Done | Ending::Steady | Ending::Event => "converged after",
            Ending::Stopped => "stopped after",
            Ending::NotConverged => "not converged after",
        };
        let way = match r.get("iterations") {
            Some(_) => format!("{word} {}", counted(r)),
            None => {
                let early = match self.ending {
                    Ending::Steady => ", where the flow is steady",
                    Ending::Event => ", where the event of time.stop came",
                    _ => "",
                };
                format!("{} steps to t = {} s{early}", counted(r), shown(&r["time"], |x| format!("{x:.6}")))
            }
        };
        let mut out = format!(
            "{}: {way}, {} CPU s ({:.0} % of the wall time for files and pictures)\n",
            r["title"].as_str().unwrap_or_default(),
            shown(&t["cpu"], |x| format!("{x:.1}")),
            100.0 * self.output_share(),
        );
        let loads = r["forces"].as_array().map(Vec::as_slice).unwrap_or_default();
        let dim = r["dimension"].as_u64().unwrap_or(3) as usize;
        for body in loads.iter().take(MOST_BODIES) {
            let (name, load) = (body["body"].as_str().unwrap_or_default(), &body["load"]);
            let force: Vec<String> =
                (0..dim).map(|a| shown(&load["last"][a], |x| format!("{x:.6e}"))).collect();
            out +=
                &format!("  body {name}: force {} N{}", force.join(", "), if dim == 2 { "/m" } else { "" });
            if let Some(c) = body["coefficients"]["mean"].as_array() {
                let mean: Vec<String> = c.iter().take(dim).map(|c| shown(c, |x| format!("{x:.5}"))).collect();
                let word = if r.get("iterations").is_some() { "coefficients" } else { "mean coefficients" };
                out += &format!("; {word} {}", mean.join(", "));
            }
            if let Some(strouhal) = body["strouhal"].as_f64() {
                out += &format!("; Strouhal {strouhal:.4}");
            }
            out.push('\n');
        }
        if loads.len() > MOST_BODIES {
            out += &format!("  and {} bodies more in result.json\n", loads.len() - MOST_BODIES);
        }
        if let Some(y) = r.get("y_plus") {
            let of = |key: &str| shown(&y[key], |x| format!("{x:.1}"));
            out += &format!(
                "  y+ of first cells {} to {}, {} on average\n",
                of("least"),
                of("most"),
                of("mean")
            );
            let part = |key: &str| shown(&y[key], |x| format!("{:.0} %", 100.0 * x));
            out += &format!(
                "  of the walls {} laminar, {} below and {} above the model's y+\n",
                part("laminar"),
                part("below_range"),
                part("above_range")
            );
            for warning in y["warnings"].as_array().into_iter().flatten().filter_map(Value::as_str) {
                out += &format!("  warning: {warning}\n");
            }
        }
        if let Some(warning) = r["deepest_overlap"]["warning"].as_str() {
            out += &format!("  warning: {warning}\n");
        }
        if let Some(l) = r.get("ledger") {
            let of = |key: &str| shown(&l[key], |x| format!("{x:.2e}"));
            out += &format!(
                "  books: momentum {} of the impulses, energy residual {} J of {:.2e} J of work\n",
                of("momentum_whole_run"),
                of("energy_residual"),
                work(l),
            );
        }
        for c in &self.compared {
            out += &format!("  {}\n", c.line(6));
        }
        if let Some(residual) = r["residual"].as_f64() {
            out += &format!("  residual {residual:.2e}\n");
        }
        if let Some(page) = &self.report {
            out += &format!("  report in {}\n", page.display());
        }
        out + &format!("  files in {}\n", self.folder.display())
    }
}

/// Largest of the works of gravity, driving force and sides in a ledger, to which the residual of its energy is compared \[J\].
fn work(ledger: &Value) -> f64 {
    let works = ["work", "driving_work", "side_work"].map(|key| ledger[key].as_f64().unwrap_or(0.0).abs());
    works.into_iter().fold(0.0, f64::max)
}
