//! What the models make of the fall, side by side.
use crate::fall::Fallen;
use crate::study::{Kind, Quantity, Study};
use example_support::Outcome;
use render::Scalar;
use render::gallery::{Gallery, Row, Tile};
use render::plot::{self, Panel, Series};
use std::path::Path;

/// Singular values, of the snapshots as they are and in the frames of the discs.
pub(crate) fn decay(studies: &[Study], path: &Path) -> Outcome<()> {
    let panel = |study: &Study| Panel {
        title: study.quantity.name().into(),
        x: "number".into(),
        y: "singular value / the first".into(),
        series: study
            .decay
            .iter()
            .map(|(label, values)| Series {
                label: label.clone(),
                points: values.iter().enumerate().map(|(k, v)| (k as f64 + 1.0, *v, String::new())).collect(),
                ours: true,
            })
            .collect(),
    };
    Ok(plot::draw(path, &studies.iter().map(panel).collect::<Vec<_>>())?)
}

/// One field between snapshots, by all models, and what they are off; the modes as files for ParaView, the best shifted model as a file.
pub(crate) fn fields(study: &Study, fallen: &Fallen, out: &Path) -> Outcome<()> {
    let [nx, ny] = fallen.cells;
    // λ as it is; of the velocity the component along gravity.
    let part = |column: &[f64]| match study.quantity {
        Quantity::Lambda => column[..nx * ny].to_vec(),
        Quantity::Velocity => column[nx * ny..].iter().map(|v| 1e3 * v).collect(),
    };
    let all = study.quantity.of(fallen);
    let truth = part(&(0..all.nrows()).map(|i| all[(i, study.shown)]).collect::<Vec<_>>());
    let mut titles = vec![format!("simulation, t = {:.4} s", fallen.times[study.shown])];
    let mut shown = vec![truth.clone()];
    for model in study.models.iter().filter(|m| m.method == "network") {
        let name = match model.kind {
            Kind::Pod => "POD",
            Kind::Shifted(_) => "sPOD",
        };
        titles.push(format!("{name}, {} modes", model.modes));
        shown.push(part(&model.shown));
    }
    let off: Vec<Vec<f64>> =
        shown.iter().map(|field| field.iter().zip(&truth).map(|(a, b)| a - b).collect()).collect();
    let most = truth.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    let (label, range) = match study.quantity {
        Quantity::Lambda => ("solid fraction λ", (0.0, 1.0)),
        Quantity::Velocity => ("vertical velocity in mm/s", (-most, most)),
    };
    let rows = vec![
        row(label, &titles, &shown, fallen.cells, range),
        row("error", &titles[1..], &off[1..], fallen.cells, (-0.5 * most, 0.5 * most)),
    ];
    let name = if study.quantity == Quantity::Lambda { "lambda" } else { "velocity" };
    Gallery { periodic: [true; 2], aspect: ny as f64 / nx as f64, rows }
        .draw(&out.join(format!("{name}.png")))?;
    if let Some(model) = study.shifted.last() {
        model.write_modes(&out.join(format!("{name}_modes.vti")))?;
        model.record().save(&out.join(format!("{name}.model")))?;
    }
    Ok(())
}

fn row<'a>(
    label: &str,
    titles: &[String],
    fields: &'a [Vec<f64>],
    [nx, ny]: [usize; 2],
    range: (f64, f64),
) -> Row<'a> {
    let titled = titles.iter().zip(fields);
    let tiles = titled.map(|(title, values)| Tile { title: title.clone(), field: Scalar { nx, ny, values } });
    Row { label: label.into(), range: Some(range), tiles: tiles.collect() }
}
