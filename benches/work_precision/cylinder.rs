//! The cylinder in a channel at Re 20 ([`channel_cylinder`]): the smooth forcing on equal cells, with the cylinder's centre on
//! the corner of a cell as the benchmark has it, and cut links on cells gathered round it. Beside them body-fitted simpleFoam on
//! a machine like this one (relative error of Cd).
use crate::{Point, Runs, Table};
use siltflow::flow::Convection;
use validation::Outcome;
use validation::channel_cylinder::{Cells, Way, run};

/// Error of Cd of all runs.
pub(crate) fn tables() -> Outcome<Vec<Table>> {
    let mut runs = Vec::new();
    for (label, way, kind) in [
        ("ours, smooth forcing", Way::Smooth, Cells::Equal),
        ("ours, cut links", Way::CutLinks(Convection::Quick), Cells::Gathered(1.05)),
    ] {
        let mut points = Vec::new();
        for per_diameter in [10, 20, 40] {
            let found = run(way, kind, per_diameter, [0.0; 2])?;
            points.push(Point::new(format!("{per_diameter}/D"), found.errors[0].abs(), found.cpu));
        }
        runs.push(Runs { label, ours: true, points });
    }
    let body_fitted = [(3.0e-3, 0.54), (7.5e-4, 4.5), (1.7e-4, 75.0)];
    runs.push(Runs {
        label: "simpleFoam, body-fitted",
        ours: false,
        points: body_fitted.map(|(error, cpu)| Point::new("", error, cpu)).into(),
    });
    Ok(vec![Table { title: "Cylinder in a channel, Re 20", error: "error of the drag coefficient", runs }])
}
