//! Charts of several runs in one.
use crate::series::Series;
use render::chart::{Chart, ChartLevel, ChartLine};

/// Lines of a run's chart that have a chart of their own with those of the other runs.
const MOST_SPLIT: usize = 6;

/// Charts of the same title, one for each of their lines, with a colour per run. Further lines are
/// in the charts of each run.
pub(crate) fn shared_charts(runs: &[(String, Vec<Series>)]) -> Vec<Series> {
    let mut out: Vec<Series> = Vec::new();
    for (number, (label, list)) in runs.iter().enumerate() {
        for one in list {
            let all = one.chart.lines.len();
            for i in 0..all.min(MOST_SPLIT) {
                let mut split = split(one, i, label, number);
                if all > MOST_SPLIT && i + 1 == MOST_SPLIT {
                    split.notes.push(format!("Further curves are in the charts of each run ({label})."));
                }
                add(&mut out, split);
            }
        }
    }
    // Runs of different bodies or equations follow one another; sections stay together.
    let mut sections: Vec<&str> = Vec::new();
    for series in &out {
        if !sections.contains(&series.section) {
            sections.push(series.section);
        }
    }
    out.sort_by_key(|series| sections.iter().position(|s| *s == series.section));
    out
}

/// The chart of line `i` alone, with the label and colour of its run.
fn split(series: &Series, i: usize, label: &str, colour: usize) -> Series {
    let (chart, line) = (&series.chart, &series.chart.lines[i]);
    let title =
        if chart.lines.len() > 1 { format!("{}: {}", chart.title, line.name) } else { chart.title.clone() };
    let own = chart.levels.iter().filter(|level| level.colour.is_none_or(|colour| colour == i));
    Series {
        section: series.section,
        chart: Chart {
            title,
            lines: vec![ChartLine { name: label.to_owned(), points: line.points.clone(), colour }],
            levels: own.map(|level| ChartLevel { colour: None, ..level.clone() }).collect(),
            ..chart.clone()
        },
        zero: line.points.iter().all(|p| p.1 == 0.0),
        notes: series.notes.clone(),
        drawn: Vec::new(),
    }
}

/// Adds the lines and levels of a chart to that of the same title and unit, if there is one.
fn add(out: &mut Vec<Series>, one: Series) {
    let same = |s: &&mut Series| s.chart.title == one.chart.title && s.chart.y.unit == one.chart.y.unit;
    let Some(series) = out.iter_mut().find(same) else {
        out.push(one);
        return;
    };
    series.zero &= one.zero;
    let new = one.notes.into_iter().filter(|note| !series.notes.contains(note)).collect::<Vec<_>>();
    series.notes.extend(new);
    series.chart.lines.extend(one.chart.lines);
    for level in one.chart.levels {
        let known = |l: &ChartLevel| l.name == level.name && l.value == level.value;
        if !series.chart.levels.iter().any(known) {
            series.chart.levels.push(level);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use render::chart::ChartAxis;

    #[test]
    fn every_line_has_a_chart_with_a_colour_per_run() {
        let line = |name: &str, y: f64| ChartLine { name: name.into(), points: vec![(0.0, y)], colour: 0 };
        let run = |label: &str, y: f64| {
            let levels = vec![ChartLevel { name: "r".into(), value: 2.0, colour: Some(1) }];
            let chart = Chart {
                title: "Speed".into(),
                x: ChartAxis::linear("time", "s"),
                y: ChartAxis::linear("speed", "m/s"),
                lines: vec![line("a", 0.0), line("b", y)],
                levels,
            };
            (
                label.to_owned(),
                vec![Series { section: "Bodies", chart, zero: false, notes: Vec::new(), drawn: Vec::new() }],
            )
        };
        let charts = shared_charts(&[run("one", 1.0), run("two", 2.0)]);
        assert_eq!(charts.len(), 2);
        assert!(charts[0].chart.title == "Speed: a" && charts[0].zero && charts[0].chart.levels.is_empty());
        assert!(charts[1].chart.title == "Speed: b" && !charts[1].zero && charts[1].chart.levels.len() == 1);
        assert_eq!(charts[1].chart.lines.iter().map(|l| l.colour).collect::<Vec<_>>(), [0, 1]);
    }
}
