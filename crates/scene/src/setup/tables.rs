//! Files of values over time.
use super::{Context, of_file};
use crate::expression::Expression;
use crate::problem::Problem;
use crate::reader::Reader;
use crate::time_table::TimeTable;
use std::sync::Arc;

/// Columns of the CSV file at `key`, by the names `columns`, each as a function of the time, the
/// variable with this number; none where the file has no such column.
///
/// # Errors
/// A file that cannot be read, has other columns, or does not reach from 0 to the end of the run.
pub(super) fn read<const N: usize>(
    t: &Reader<'_>,
    key: &str,
    context: &Context<'_>,
    columns: [&str; N],
    variable: usize,
) -> Result<[Option<Expression>; N], Problem> {
    let Some(end) = context.end else {
        return Err(t.fail(key, "a steady flow has no time; leave this out"));
    };
    let path = context.path(t.text(key).unwrap_or_default());
    let fail = |e: &dyn std::fmt::Display| t.fail(key, of_file(&path, e));
    let text = std::fs::read_to_string(&path).map_err(|e| fail(&e))?;
    let table = TimeTable::parse(&text).map_err(|e| fail(&e))?;
    if let Some(other) = table.names().iter().find(|name| !columns.contains(&name.as_str())) {
        let known = columns.join(", ");
        return Err(fail(&format!("there is no column \"{other}\" here; known are time, {known}")));
    }
    if !table.covers(end) {
        let [first, last] = table.span();
        return Err(fail(&format!(
            "the times reach from {first} to {last} s; give values from 0 to the end of the run, {end} s"
        )));
    }
    let table = Arc::new(table);
    Ok(columns.map(|name| {
        let column = table.names().iter().position(|known| known == name)?;
        Some(Expression::column(&table, column, variable))
    }))
}
