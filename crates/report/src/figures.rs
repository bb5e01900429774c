//! Charts and pictures as HTML.
use crate::pictures::Pictures;
use crate::series::Series;
use maud::{Markup, PreEscaped, html};

/// Sections of charts, in the order of the series.
pub(crate) fn charts(series: &[Series]) -> Markup {
    let mut sections: Vec<&str> = Vec::new();
    for one in series {
        if !sections.contains(&one.section) {
            sections.push(one.section);
        }
    }
    html! {
        @for section in sections {
            h2 { (section) }
            div.charts {
                @for one in series.iter().filter(|s| s.section == section) { (chart(one)) }
            }
        }
    }
}

fn chart(series: &Series) -> Markup {
    let chart = &series.chart;
    if series.zero {
        return html! { figure { h3 { (chart.title) } p.note { "Zero throughout." } } };
    }
    match chart.draw() {
        Ok(drawn) => html! {
            figure {
                h3 { (chart.title) }
                (PreEscaped(&drawn.svg))
                @if drawn.legend.len() > 1 || drawn.legend.iter().any(|entry| entry.name != chart.y.label) {
                    ul.legend {
                        @for entry in &drawn.legend {
                            li {
                                i.dashed[entry.dashed] style={ "border-color:" (entry.colour) } {}
                                (entry.name)
                            }
                        }
                    }
                }
                @for note in drawn.notes.iter().chain(&series.notes) { p.note { (note) } }
            }
        },
        Err(error) => html! { figure { h3 { (chart.title) } p.note { (error) } } },
    }
}

/// The last picture of each of the runs, under a slider for the others, which are in elements of
/// their own ([`Pictures::write_data`]).
pub(crate) fn pictures(runs: &[(&str, &Pictures)]) -> Markup {
    let most = runs.iter().map(|(_, p)| p.shown.len()).max().unwrap_or(0);
    html! {
        section data-pictures="" {
            @if most > 1 {
                div.slider {
                    label for="time" { "run" }
                    input #time type="range" min="0" max=(most - 1) value=(most - 1) step="1" hidden
                        aria-label="picture, from the start of the run to its end";
                }
                noscript { p.note { "The last picture is shown; the slider for the others needs JavaScript." } }
            }
            div.pictures {
                @for (number, (label, pictures)) in runs.iter().enumerate() {
                    @if let Some(last) = pictures.shown.last() {
                        figure data-list={ "pictures-" (number) } {
                            img src=(last.url()) alt={ "field of " (label) };
                            figcaption {
                                @if runs.len() > 1 { (label) ": " }
                                output { (last.label) }
                            }
                        }
                    }
                }
            }
            @for (label, pictures) in runs {
                @for note in &pictures.notes {
                    p.note { @if runs.len() > 1 { (label) ": " } (note) }
                }
            }
        }
    }
}
