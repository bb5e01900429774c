//! The page's part about several runs: results of all against references, grid studies.
use crate::grid_convergence::{GridConvergence, GridValue};
use crate::run_folder::RunFolder;
use crate::run_page::grid;
use crate::run_results::{RunValue, values};
use crate::text::{number, percent};
use maud::{Markup, html};

/// A result that several runs have.
struct Row {
    name: String,
    unit: &'static str,
    pointer: String,
    /// One per run.
    values: Vec<Option<RunValue>>,
}

fn rows(runs: &[RunFolder]) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    for (i, run) in runs.iter().enumerate() {
        for value in values(run) {
            let same = |row: &&mut Row| row.name == value.name && row.pointer == value.pointer;
            let row = match rows.iter_mut().find(same) {
                Some(row) => row,
                None => {
                    let (name, pointer) = (value.name.clone(), value.pointer.clone());
                    rows.push(Row { name, unit: value.unit, pointer, values: vec![None; runs.len()] });
                    let last = rows.len() - 1;
                    &mut rows[last]
                }
            };
            row.values[i] = Some(value);
        }
    }
    rows
}

/// Tables of all runs.
pub(crate) fn table(runs: &[RunFolder]) -> Markup {
    let rows = rows(runs);
    html! {
        h2 { "Runs" }
        div.scroll { table {
            thead { tr { th { "run" } th { "scene" } th { "grid" } th { "status" } th.n { "CPU s" } th.n { "warnings" } } }
            tbody { @for run in runs {
                @let (well, ending) = run.ending();
                tr {
                    th { (run.label) }
                    td { (run.title()) }
                    td { (grid(run)) }
                    td { span.good[well].bad[!well] { (ending) } }
                    td.n { (run.timings["cpu"].as_f64().map_or_else(|| "unknown".into(), |s| format!("{s:.1}"))) }
                    td.n { (run.warnings().len()) }
                }
            } }
        } }
        h2 { "Results" }
        @if rows.is_empty() { p.soft { "No run has results." } } @else {
            div.scroll { table {
                thead { tr { th { "quantity" } th { "unit" } th.n { "reference" } @for run in runs { th.n { (run.label) } } } }
                tbody { @for row in &rows {
                    @let reference = row.values.iter().flatten().find_map(|v| v.reference.clone());
                    tr {
                        th { (row.name) }
                        td { (row.unit) }
                        td.n { @if let Some((value, source)) = &reference { (number(*value)) @if !source.is_empty() { br; span.soft { (source) } } } @else { "–" } }
                        @for value in &row.values {
                            td.n {
                                @match value {
                                    Some(v) => {
                                        (v.value.map_or_else(|| "not in the results".into(), number))
                                        @if let Some(error) = v.error() { br; span.soft { (if v.reference.as_ref().is_some_and(|r| r.0 == 0.0) { number(error) } else { percent(error) }) } }
                                    },
                                    None => "–",
                                }
                            }
                        }
                    }
                } }
            } }
        }
        (grid_studies(runs, &rows))
    }
}

/// h = (V/N)^(1/D) of a run \[m\].
fn cell_size(run: &RunFolder) -> Option<f64> {
    let (cells, size) = (run.cells(), run.size());
    let dim = cells.len();
    if dim == 0 || size.len() != dim {
        return None;
    }
    let (volume, number) = (size.iter().product::<f64>(), cells.iter().product::<u64>() as f64);
    Some((volume / number).powf(1.0 / dim as f64))
}

/// Whether two runs differ in their grid alone.
fn same_case(a: &RunFolder, b: &RunFolder) -> bool {
    let case = |run: &RunFolder| run.plan["case"].as_str().map(str::to_owned);
    let close = |x: &f64, y: &f64| (x - y).abs() <= 1e-9 * x.abs().max(y.abs());
    let boxes = a.size().len() == b.size().len() && a.size().iter().zip(&b.size()).all(|(x, y)| close(x, y));
    case(a).is_some() && case(a) == case(b) && boxes
}

fn grid_studies(runs: &[RunFolder], rows: &[Row]) -> Markup {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (i, run) in runs.iter().enumerate() {
        match groups.iter_mut().find(|group| same_case(&runs[group[0]], run)) {
            Some(group) => group.push(i),
            None => groups.push(vec![i]),
        }
    }
    groups.retain(|group| group.len() > 1);
    html! {
        @for group in &groups { (grid_study(runs, rows, group)) }
        @if groups.is_empty() {
            @let unknown = runs.iter().any(|run| run.plan["case"].is_null());
            p.note {
                "No grid study: no two runs differ in their grid alone (keys grid, time.dt, time.steps; box of the same size)"
                @if unknown { ", as far as is known: runs without a plan.json cannot be compared" }
                "."
            }
        }
    }
}

fn grid_study(runs: &[RunFolder], rows: &[Row], group: &[usize]) -> Markup {
    let mut grids: Vec<(usize, f64)> =
        group.iter().filter_map(|i| Some((*i, cell_size(&runs[*i])?))).collect();
    grids.sort_by(|a, b| a.1.total_cmp(&b.1));
    // The first of runs with the same cells counts.
    let before = grids.len();
    grids.dedup_by(|b, a| (b.1 / a.1 - 1.0).abs() < 1e-9);
    let doubles = before - grids.len();
    let unfinished: Vec<&str> =
        grids.iter().filter(|(i, _)| !runs[*i].ending().0).map(|(i, _)| runs[*i].label.as_str()).collect();
    html! {
        h2 { "Grid study: " (runs[group[0]].title()) }
        @if doubles > 0 { p.note { (doubles) " run(s) with the same number of cells as another are left out." } }
        @if !unfinished.is_empty() { p.bad { "Not at their end, so that values are not those of a finished run: " (unfinished.join(", ")) } }
        @if grids.len() < 3 {
            p.note { "Three grids are needed for an observed order; there are " (grids.len()) "." }
        } @else {
            p.soft {
                "Representative cell size h = (V/N)" sup { "1/D" } "; with h₁ < h₂ < h₃ and r₂₁ = h₂/h₁, r₃₂ = h₃/h₂ the order p solves (φ₃ − φ₂)/(φ₂ − φ₁) = r₂₁" sup { "p" } "(r₃₂" sup { "p" } " − 1)/(r₂₁" sup { "p" } " − 1); "
                "φ" sub { "ext" } " = φ₁ + (φ₁ − φ₂)/(r₂₁" sup { "p" } " − 1); GCI = 1.25 |φ₁ − φ₂|/|φ₁|/(r₂₁" sup { "p" } " − 1). "
                "Roache 1994, J. Fluids Eng. 116, 405; Celik et al. 2008, J. Fluids Eng. 130, 078001."
            }
            div.scroll { table {
                thead { tr { th { "quantity" } th { "grids" } th.n { "values, finest first" } th.n { "order p" } th.n { "extrapolated" } th.n { "GCI of the finest" } th { "remarks" } } }
                tbody {
                    @for row in rows {
                        @for three in grids.windows(3) { (study_row(runs, row, three)) }
                    }
                }
            } }
        }
    }
}

fn study_row(runs: &[RunFolder], row: &Row, three: &[(usize, f64)]) -> Markup {
    let value = |i: usize| row.values[i].as_ref().and_then(|v| v.value).unwrap_or(f64::NAN);
    let found: [GridValue; 3] =
        std::array::from_fn(|k| GridValue { h: three[k].1, value: value(three[k].0) });
    let labels: Vec<&str> = three.iter().map(|(i, _)| runs[*i].label.as_str()).collect();
    let reference =
        row.values.iter().flatten().find_map(|v| Some(v.reference.as_ref()?.0)).filter(|r| *r != 0.0);
    let head = html! {
        th { (row.name) }
        td { (labels.join(", ")) }
        td.n { @for v in found { (number(v.value)) br; } }
    };
    match GridConvergence::of(found) {
        GridConvergence::Monotone { order, extrapolated, index, doubts } => html! {
            tr {
                (head)
                td.n { (format!("{order:.2}")) }
                td.n { (number(extrapolated)) @if let Some(r) = reference { br; span.soft { (percent(extrapolated / r - 1.0)) } } }
                td.n { (index.map_or_else(|| "–".into(), |i| format!("{:.3} %", 100.0 * i))) }
                td { @for doubt in doubts { p.note { (doubt) } } }
            }
        },
        GridConvergence::None { reason } => html! {
            tr { (head) td.n { "–" } td.n { "–" } td.n { "–" } td { p.note { (reason) } } }
        },
    }
}
