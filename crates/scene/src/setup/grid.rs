//! The box and its cells.
use crate::problem::Problem;
use crate::reader::Reader;
use fv_mesh::{Axis, Cluster, FlowError};
use std::path::Path;

/// More cells than any machine of today has memory for.
const MOST_CELLS: f64 = 1e11;

/// The axes: two or three.
pub(super) fn read(root: &Reader<'_>, folder: &Path) -> Result<Vec<Axis>, Problem> {
    let Some(grid) = root.table("grid") else { return Err(root.fail("grid", "the grid is missing")) };
    let names = ["x", "y", "z"];
    let single = |name: &&str| grid.has(name);
    let axes = match (grid.wholes("cells"), grid.numbers("size")) {
        (Some(cells), Some(size)) => {
            if let Some(name) = names.iter().find(|name| single(name)) {
                return Err(
                    grid.fail(name, "give either `cells` and `size` or every axis by itself, not both")
                );
            }
            if size.len() != cells.len() {
                let message =
                    format!("{} lengths for {} numbers of cells; give as many", size.len(), cells.len());
                return Err(grid.fail("size", message));
            }
            grid.has_dim("origin", cells.len())?;
            let origin = grid.numbers("origin").unwrap_or(vec![0.0; cells.len()]);
            let axis = |a: usize| Axis::uniform(cells[a], origin[a], origin[a] + size[a]);
            (0..cells.len())
                .map(|a| axis(a).map_err(|e| grid.fail("size", e)))
                .collect::<Result<Vec<_>, _>>()?
        }
        (None, None) => {
            if !(grid.has("x") && grid.has("y")) {
                let message = "give `cells` and `size`, or the axes `x` and `y` (and `z`)";
                return Err(grid.fail_here(message));
            }
            let given = names.iter().filter(|name| single(name));
            given.map(|name| axis(&grid, name, folder)).collect::<Result<Vec<_>, _>>()?
        }
        (Some(_), None) => {
            return Err(grid.fail("cells", "`cells` needs `size`, the edge lengths of the box"));
        }
        (None, Some(_)) => {
            return Err(grid.fail("size", "`size` needs `cells`, their numbers along the axes"));
        }
    };
    let cells: f64 = axes.iter().map(|axis| axis.cells() as f64).product();
    if cells > MOST_CELLS {
        return Err(
            grid.fail("cells", format!("{cells:.1e} cells; no memory holds more than {MOST_CELLS:.0e}"))
        );
    }
    Ok(axes)
}

fn axis(grid: &Reader<'_>, name: &str, folder: &Path) -> Result<Axis, Problem> {
    let Some((spacing, t)) = grid.choice(name, "spacing") else {
        return Err(grid.fail(name, "how is the axis divided? Give `spacing`"));
    };
    let number = |key: &str| t.number(key).unwrap_or(0.0);
    let (cells, from, to) = (t.whole("cells").unwrap_or(1), number("from"), number("to"));
    let axis = match spacing {
        "uniform" => Axis::uniform(cells, from, to),
        "geometric" => Axis::geometric(cells, from, to, number("ratio")),
        "tanh" => {
            let cluster = match t.text("cluster") {
                Some("lower") => Cluster::Lower,
                Some("upper") => Cluster::Upper,
                _ => Cluster::Both,
            };
            Axis::tanh(cells, from, to, number("strength"), cluster)
        }
        "gathered" => {
            let between = t.numbers("between").unwrap_or_default();
            let (Some(&low), Some(&high)) = (between.first(), between.get(1)) else {
                return Err(t.fail("between", "give both ends"));
            };
            let fine = number("fine");
            if !(from <= low && low < high && high <= to) {
                let message = format!("from {low} to {high} is no part of the axis from {from} to {to}");
                return Err(t.fail("between", message));
            }
            if (to - from) / fine > 1e6 {
                return Err(t.fail(
                    "fine",
                    format!("{:.1e} such cells fit on the axis; give a larger width", (to - from) / fine),
                ));
            }
            gathered([from, to], [low, high], fine, t.number("growth").unwrap_or(1.05))
        }
        "faces" => Axis::from_faces(t.numbers("faces").unwrap_or_default()),
        _ => Axis::from_file(folder.join(t.text("file").unwrap_or_default())),
    };
    axis.map_err(|e| grid.fail(name, e))
}

/// Cells of width `fine` from `low` to `high` (whose distance is rounded to whole cells, about the middle), each wider by `growth` than the
/// one before it outside.
fn gathered([from, to]: [f64; 2], [low, high]: [f64; 2], fine: f64, growth: f64) -> Result<Axis, FlowError> {
    let n = ((high - low) / fine).round().max(1.0);
    let start = (0.5 * (low + high) - 0.5 * n * fine).max(from);
    let end = (start + n * fine).min(to);
    // The room outside is shared in proportion to powers of the growth.
    let grown = |room: f64| -> Vec<f64> {
        if room < 0.5 * fine {
            return Vec::new();
        }
        let n = ((1.0 + room / fine * (growth - 1.0) / growth).ln() / growth.ln()).round().max(1.0);
        let widths: Vec<f64> = (1..=n as i32).map(|i| growth.powi(i)).collect();
        let sum: f64 = widths.iter().sum();
        widths.into_iter().map(|w| w * room / sum).collect()
    };
    let (below, above) = (grown(start - from), grown(to - end));
    // What is too narrow for a cell of its own goes to the equal ones.
    let (start, end) = (if below.is_empty() { from } else { start }, if above.is_empty() { to } else { end });
    let mut faces = vec![from];
    let mut x = from;
    for width in below.iter().rev() {
        x += width;
        faces.push(x);
    }
    if let Some(last) = faces.last_mut() {
        *last = start;
    }
    faces.extend((1..=n as usize).map(|i| start + (end - start) * i as f64 / n));
    x = end;
    for width in &above {
        x += width;
        faces.push(x);
    }
    if let Some(last) = faces.last_mut() {
        *last = to;
    }
    Axis::from_faces(faces)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_gathered() {
        let axis = gathered([-1.0, 3.0], [0.0, 0.5], 0.01, 1.05).unwrap();
        assert_eq!((axis.lower(), axis.upper()), (-1.0, 3.0));
        assert!(axis.largest_ratio() < 1.08, "{}", axis.largest_ratio());
        let (first, last) = (axis.locate(0.0051).unwrap(), axis.locate(0.4949).unwrap());
        assert!(last - first == 49, "{first} {last}");
        assert!((first..=last).all(|i| (axis.width(i) - 0.01).abs() < 1e-12));
        // All of it.
        let axis = gathered([0.0, 1.0], [0.0, 1.0], 0.1, 1.05).unwrap();
        assert_eq!(axis.cells(), 10);
    }
}
