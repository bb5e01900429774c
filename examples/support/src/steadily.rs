//! Steady flows, and how far they are.
use fv_mesh::{FlowError, Modelled, Simple, SimpleInfo};
use interfaces::Closure;

/// Lines of a run that takes all its iterations.
const LINES: usize = 20;

/// Iterates until all residuals are at most `tolerance`, `most` times at most, and prints a line of them now and then, with the numbers that
/// `more` finds under these `names`. What the last iteration told.
///
/// # Errors
/// Those of [`Simple::iterate_with`].
pub fn steadily<const D: usize, C: Closure>(
    flow: &mut Simple<D>,
    model: &mut Modelled<D, C>,
    (most, tolerance): (usize, f64),
    names: &[&str],
    more: impl Fn(&Simple<D>) -> Vec<f64>,
) -> Result<SimpleInfo, FlowError> {
    let titles: String = names.iter().map(|name| format!(" {name:>9}")).collect();
    println!("{:>6} {:>9} {:>9} {:>9}{titles}", "its", "momentum", "mass", "model");
    let mut info = SimpleInfo { continuity: f64::INFINITY, ..SimpleInfo::default() };
    for k in 1..=most {
        info = flow.iterate_with(model)?;
        let done = info.largest() <= tolerance;
        if done || k == most || k % most.div_ceil(LINES) == 0 {
            let momentum = info.momentum.into_iter().fold(0.0, f64::max);
            let numbers: String = more(flow).into_iter().map(|number| format!(" {number:>9.4}")).collect();
            let SimpleInfo { iterations, continuity, closure, .. } = info;
            println!("{iterations:>6} {momentum:>9.1e} {continuity:>9.1e} {closure:>9.1e}{numbers}");
        }
        if done {
            break;
        }
    }
    Ok(info)
}
