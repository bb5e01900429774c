//! Conditions that end a run before its time.
use super::Bodies;
use crate::expression::Expression;
use crate::problem::Problem;
use crate::reader::Reader;
use crate::schema::EVENT;

/// Conditions of which the first to hold ends the run.
#[derive(Clone, Debug)]
pub(crate) struct StopSetup {
    /// Rate of change below which the flow is steady \[1/s\].
    pub(crate) steady: Option<f64>,
    /// Formula of the variables [`EVENT`] whose value above 0 ends the run.
    pub(crate) event: Option<Expression>,
    /// Number of the body that the event is about.
    pub(crate) body: Option<usize>,
}

/// The conditions in the table `time`; `fluid` if there is one, `steady` if the flow has no time.
pub(super) fn read(
    time: &Reader<'_>,
    bodies: &Bodies,
    (dim, fluid, steady): (usize, bool, bool),
) -> Result<Option<StopSetup>, Problem> {
    let Some(t) = time.table("stop").filter(|_| !steady) else { return Ok(None) };
    if !(t.has("steady") || t.has("event")) {
        return Err(t.fail_here("when does the run end? Give `steady` or `event`"));
    }
    if t.has("steady") && !fluid {
        return Err(t.fail("steady", "this is the change of a flow, and there is no `fluid`; give `event`"));
    }
    let event = t.formula("event", EVENT)?;
    let body = match t.text("body") {
        None => None,
        Some(name) => Some(bodies.list.iter().position(|b| b.name == name).ok_or_else(|| {
            let known: Vec<&str> = bodies.list.iter().take(10).map(|b| b.name.as_str()).collect();
            let known = if known.is_empty() { "there are none".into() } else { known.join(", ") };
            t.fail("body", format!("there is no body \"{name}\" at the start; bodies: {known}"))
        })?),
    };
    let of_body = (2..EVENT.len()).find(|v| event.as_ref().is_some_and(|event| event.uses(*v)));
    match (of_body, body) {
        (Some(v), None) => {
            let message = format!("{} is that of a body; give its name as `body`", EVENT[v]);
            return Err(t.fail("event", message));
        }
        (Some(4 | 7), _) if dim == 2 => {
            return Err(t.fail("event", "a plane scene has no axis z; leave out z and w"));
        }
        (None, Some(_)) => {
            return Err(t.fail("body", "`event` has no place or velocity of a body; leave this out"));
        }
        _ => {}
    }
    Ok(Some(StopSetup { steady: t.number("steady"), event, body }))
}
