//! The page's part about one run.
use crate::figures;
use crate::pictures::Pictures;
use crate::run_folder::RunFolder;
use crate::run_results::{RunValue, values};
use crate::series::Series;
use crate::text::{count, number, percent};
use maud::{Markup, html};
use serde_json::Value;

/// Names of modules in `timings.json`, as a table shows them.
const MODULES: [(&str, &str); 6] = [
    ("advance", "prediction of the flow"),
    ("pressure", "pressure"),
    ("forcing", "immersed boundary"),
    ("lambda", "solid fraction λ"),
    ("contact", "contacts and motion of bodies"),
    ("finish", "end of the step"),
];

/// Share of the wall time below which a module has no row.
const LEAST_SHARE: f64 = 5e-4;

/// Everything about a run but its title, with its pictures if they are not elsewhere.
pub(crate) fn body(run: &RunFolder, series: &[Series], pictures: Option<&Pictures>) -> Markup {
    html! {
        (overview(run))
        (results(run, series))
        @if let Some(pictures) = pictures { (self::pictures(run, pictures)) }
        (models(run))
        (figures::charts(series))
        (cost(run))
        (versions(run))
        (scene(run))
    }
}

/// Section with the pictures of a run.
fn pictures(run: &RunFolder, pictures: &Pictures) -> Markup {
    let wanted = run.plan["images"].as_bool();
    html! {
        h2 { "Pictures" }
        @if pictures.shown.is_empty() && pictures.notes.is_empty() {
            p.soft {
                @if wanted == Some(false) { "The scene makes none (output.images = false)." }
                @else { "There are none in the folder." }
            }
        } @else {
            (figures::pictures(&[(run.title(), pictures)]))
        }
    }
}

/// Cells and box.
pub(crate) fn grid(run: &RunFolder) -> String {
    let cells = run.cells();
    let total: u64 = cells.iter().product();
    let list = |parts: Vec<String>| parts.join(" × ");
    let size = run.size();
    let of_box = if size.is_empty() {
        String::new()
    } else {
        format!(", box {} m", list(size.iter().map(|x| number(*x)).collect()))
    };
    format!("{} = {} cells{of_box}", list(cells.iter().map(u64::to_string).collect()), count(total))
}

fn overview(run: &RunFolder) -> Markup {
    let (well, ending) = run.ending();
    let warnings = run.warnings();
    let about = run.plan["about"].as_str().unwrap_or_default();
    let overrides: Vec<&str> =
        run.plan["overrides"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    let step = &run.result["step"];
    let steps = match (step["shortest"].as_f64(), step["longest"].as_f64(), step["courant"].as_f64()) {
        (Some(low), Some(high), Some(courant)) => Some(format!(
            "{} steps of {} to {} s, Courant number up to {}",
            run.result["steps"].as_u64().map_or_else(|| "–".into(), count),
            number(low),
            number(high),
            number(courant)
        )),
        _ => None,
    };
    let parts = run.plan["parts"].as_array();
    html! {
        @if !about.is_empty() { p { (about) } }
        div.scroll { table { tbody {
            tr { th { "status" } td { span.good[well].bad[!well] { (ending) } } }
            tr { th { "grid" } td { (grid(run)) } }
            @if let Some(end) = run.value("end").as_f64().filter(|_| !run.is_steady()) { tr { th { "time" } td { "0 to " (number(end)) " s" } } }
            @if let Some(steps) = steps { tr { th { "steps" } td { (steps) } } }
            @for part in parts.into_iter().flatten().filter(|part| part["active"] == true) {
                tr { th { (part["name"].as_str().unwrap_or_default()) } td { (part["about"].as_str().unwrap_or_default()) } }
            }
            @if let Some(pressure) = run.plan["pressure"].as_str() { tr { th { "pressure solver" } td { (pressure) } } }
            @if !overrides.is_empty() { tr { th { "set on the command line" } td { @for one in overrides { code { (one) } " " } } } }
            tr { th { "folder" } td { code { (run.folder.display()) } } }
        } } }
        @if warnings.is_empty() {
            p.soft { @if run.log.is_empty() && run.plan.is_null() { "Warnings are unknown." } @else { "No warnings." } }
        } @else {
            h3 { "Warnings" }
            ul.notes { @for warning in warnings { li { (warning) } } }
        }
        @if !run.notes.is_empty() {
            h3 { "What this report lacks" }
            ul.notes.soft { @for note in &run.notes { li { (note) } } }
        }
    }
}

fn results(run: &RunFolder, series: &[Series]) -> Markup {
    let values = values(run);
    let (with, without): (Vec<&RunValue>, Vec<&RunValue>) =
        values.iter().partition(|v| v.reference.is_some());
    // Notes name references that no curve shows.
    let drawn: Vec<&String> = series.iter().flat_map(|s| &s.drawn).collect();
    let shown = |v: &f64| number(*v);
    html! {
        h2 { "Results" }
        @if values.is_empty() { p.soft { "There are none: the run has not come to its end." } }
        @if !with.is_empty() {
            div.scroll { table {
                thead { tr { th { "quantity" } th.n { "here" } th.n { "reference" } th.n { "difference" } th { "source" } th { "in a chart" } } }
                tbody { @for v in &with {
                    @let (reference, source) = v.reference.clone().unwrap_or_default();
                    tr {
                        th { (v.name) }
                        td.n { (v.value.as_ref().map_or_else(|| "not in the results".into(), shown)) }
                        td.n { (number(reference)) }
                        td.n { (v.error().map_or_else(|| "–".into(), |e| if reference == 0.0 { number(e) } else { percent(e) })) }
                        td { (source) }
                        td.soft { @if drawn.contains(&&v.pointer) { "dashed line" } @else { "no: has no curve" } }
                    }
                } }
            } }
        } @else { p.soft { "The scene has no references." } }
        @if !without.is_empty() {
            div.scroll { table {
                thead { tr { th { "quantity" } th.n { "value" } th { "unit" } } }
                tbody { @for v in &without {
                    tr { th { (v.name) } td.n { (v.value.as_ref().map_or_else(|| "–".into(), shown)) } td { (if v.unit.is_empty() { "1" } else { v.unit }) } }
                } }
            } }
        }
    }
}

/// Reduced models of the run with their relative errors.
fn models(run: &RunFolder) -> Markup {
    let Some(models) = run.result["models"].as_array() else { return html! {} };
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let ranks = |model: &Value| {
        let ranks = model["ranks"].as_array().into_iter().flatten();
        ranks.map(Value::to_string).collect::<Vec<_>>().join(" + ")
    };
    let share = |x: f64| format!("{:.2} %", 100.0 * x);
    let error = |value: &Value| value["total"].as_f64().map_or_else(|| "–".into(), share);
    html! {
        h2 { "Reduced models" }
        div.scroll { table {
            thead { tr {
                th { "model" } th { "kind" } th { "field" } th.n { "modes" } th.n { "snapshots" }
                th.n { "error, snapshots of the fit" } th.n { "error, snapshots held out" }
            } }
            tbody { @for model in models { tr {
                th { (text(&model["model"])) }
                td { (text(&model["kind"])) }
                td { (text(&model["field"])) }
                td.n { (ranks(model)) }
                td.n { (model["snapshots"]) }
                td.n { (error(&model["training"])) }
                td.n { (error(&model["held_out"])) }
            } } }
        } }
    }
}

fn cost(run: &RunFolder) -> Markup {
    let t = &run.timings;
    let (Some(wall), Some(cpu)) = (t["wall"].as_f64(), t["cpu"].as_f64()) else {
        return html! { h2 { "Cost" } p.soft { "Unknown: there is no timings.json of a run that came to its end." } };
    };
    let seconds = |value: &Value| value.as_f64().filter(|s| *s > 0.0);
    let mut rows: Vec<(String, f64)> = t["modules"]
        .as_object()
        .into_iter()
        .flatten()
        .filter_map(|(key, value)| {
            let name = MODULES.iter().find(|(known, _)| known == key).map_or(key.as_str(), |(_, name)| *name);
            Some((name.to_owned(), seconds(value)?))
        })
        .collect();
    rows.extend(seconds(&t["ledger"]).map(|s| ("budgets (ledger)".to_owned(), s)));
    rows.extend(seconds(&t["output"]).map(|s| ("files, pictures, saved states".to_owned(), s)));
    // Modules that take no time worth a row are in the rest.
    rows.retain(|(_, seconds)| *seconds >= LEAST_SHARE * wall);
    let rest = wall - rows.iter().map(|r| r.1).sum::<f64>();
    let whole = if run.is_steady() { "iterations" } else { "rest" };
    rows.push((whole.to_owned(), rest.max(0.0)));
    rows.sort_by(|a, b| b.1.total_cmp(&a.1));
    let total: u64 = run.cells().iter().product();
    let turns = run.result["steps"].as_u64().or(run.result["iterations"].as_u64());
    let per_cell = turns.filter(|n| *n > 0 && total > 0).map(|n| 1e6 * cpu / (n * total) as f64);
    html! {
        h2 { "Cost" }
        p {
            (number(cpu)) " CPU s, " (number(wall)) " s of wall time, " (t["threads"].as_u64().unwrap_or(1)) " thread(s)"
            @if let Some(per_cell) = per_cell { "; " (number((per_cell * 1e4).round() / 1e4)) " CPU µs per cell and " (if run.is_steady() { "iteration" } else { "step" }) }
        }
        @if run.log.iter().any(|line| line.contains("going on with")) {
            p.note { "The run was interrupted: times are those since it went on for the last time." }
        }
        div.scroll { table {
            thead { tr { th { "module" } th.n { "wall s" } th.n { "share" } th {} } }
            tbody { @for (name, seconds) in &rows {
                @let share = seconds / wall.max(1e-12);
                tr { th { (name) } td.n { (format!("{seconds:.3}")) } td.n { (format!("{:.1} %", 100.0 * share)) }
                    td { span.bar style={ "width:" (format!("{:.1}", 10.0 * share)) "rem" } {} } }
            } }
        } }
    }
}

fn versions(run: &RunFolder) -> Markup {
    let v = run.value("versions");
    let text = |key: &str| v[key].as_str().unwrap_or("unknown");
    html! {
        h2 { "Versions" }
        p { "siltflow " (text("siltflow")) ", " (text("rustc")) ", " (text("target")) "; this page by siltflow " (env!("CARGO_PKG_VERSION")) "." }
    }
}

fn scene(run: &RunFolder) -> Markup {
    // Scenes that come with the command are read from a temporary folder.
    let file = run.plan["file"]
        .as_str()
        .map_or("scene.toml", |path| path.rsplit(['/', '\\']).next().unwrap_or(path));
    html! {
        h2 { "Scene" }
        @match &run.scene {
            Some(text) => details { summary { (file) } pre { (text) } },
            None => p.soft { "Its text is not in the folder." },
        }
        @if !run.log.is_empty() {
            @let most = 400;
            details { summary { "run.log" }
                @if run.log.len() > most { p.note { "The last " (most) " of " (run.log.len()) " lines." } }
                pre { (run.log[run.log.len().saturating_sub(most)..].join("\n")) }
            }
        }
    }
}
