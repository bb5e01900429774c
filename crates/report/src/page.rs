//! The page.
use crate::pictures::{MOST_BYTES, Pictures};
use crate::run_folder::RunFolder;
use crate::series::series;
use crate::shared_charts::shared_charts;
use crate::{comparison, figures, run_page};
use maud::{DOCTYPE, Markup, PreEscaped, html};
use std::io::{self, Write};

/// Content security policy: a browser shows what is in the page and requests nothing.
const POLICY: &str =
    "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'";

/// Place of the pictures' data.
const PLACE: &str = "<!-- pictures -->";

/// Writes the page of `runs`, of which there is one at least.
pub(crate) fn write(runs: &[RunFolder], out: &mut impl Write) -> io::Result<()> {
    let room = MOST_BYTES / runs.len().max(1) as u64;
    let pictures: Vec<Pictures> = runs.iter().map(|run| Pictures::read(&run.pictures, room)).collect();
    let title = match runs {
        [run] => run.title().to_owned(),
        _ => {
            let mut titles: Vec<&str> = Vec::new();
            runs.iter().map(RunFolder::title).for_each(|title| {
                if !titles.contains(&title) {
                    titles.push(title)
                }
            });
            format!("{} runs: {}", runs.len(), titles.join("; "))
        }
    };
    let main = match runs {
        [run] => html! {
            h1 { (title) }
            (run_page::body(run, &series(run), pictures.first()))
        },
        _ => several(runs, &pictures, &title),
    };
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                meta name="viewport" content="width=device-width, initial-scale=1";
                link rel="icon" href="data:,";
                title { (title) }
                style { (PreEscaped(include_str!("style.css"))) }
            }
            body {
                (main)
                (PreEscaped(PLACE))
                script { (PreEscaped(include_str!("slider.js"))) }
            }
        }
    };
    let page = page.into_string();
    // Texts of runs hold no markup, so that the last such place is the page's own.
    let (before, after) = page.rsplit_once(PLACE).unwrap_or((&page, ""));
    out.write_all(before.as_bytes())?;
    for (number, pictures) in pictures.iter().enumerate() {
        pictures.write_data(number, out)?;
    }
    out.write_all(after.as_bytes())
}

fn several(runs: &[RunFolder], pictures: &[Pictures], title: &str) -> Markup {
    let all: Vec<_> = runs.iter().map(|run| (run.label.clone(), series(run))).collect();
    let labelled: Vec<(&str, &Pictures)> = runs.iter().map(|run| run.label.as_str()).zip(pictures).collect();
    html! {
        h1 { (title) }
        (comparison::table(runs))
        h2 { "Pictures" }
        @if pictures.iter().all(|p| p.shown.is_empty() && p.notes.is_empty()) {
            p.soft { "There are none in the folders." }
        } @else {
            (figures::pictures(&labelled))
        }
        (figures::charts(&shared_charts(&all)))
        h2 { "Each run" }
        @for (run, (_, series)) in runs.iter().zip(&all) {
            details.run {
                summary { (run.label) ": " (run.title()) }
                (run_page::body(run, series, None))
            }
        }
    }
}
