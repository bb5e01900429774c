//! References of a scene and the numbers that its results have.
use crate::build_error::BuildError;
use crate::setup::{Algorithm, Setup};
use serde_json::Value;

impl Setup {
    /// Names of results that only a run has, and the number of their entries if they are a list.
    fn results_of_run(&self) -> Vec<(&'static str, Option<usize>)> {
        let bodies = self.bodies.inflows.is_empty().then_some(self.bodies.list.len());
        let steady = self.flow.algorithm == Algorithm::Simple;
        let all = [
            ("forces", self.forces.is_some(), bodies),
            ("probes", !self.probes.is_empty(), Some(self.probes.len())),
            ("averages", self.averages.is_some(), None),
            ("models", !self.models.is_empty(), None),
            ("bodies", bodies.is_none(), None),
            ("trajectories", self.output.bodies && self.bodies.any_moves(), bodies),
            ("ledger", self.why_no_books().is_none(), None),
            ("residual", steady, None),
            ("given_off", steady && !self.scalars.is_empty(), None),
            ("deepest_overlap", self.bodies.any_moves(), None),
            ("y_plus", self.turbulence.is_some(), None),
        ];
        all.into_iter().filter(|(_, present, _)| *present).map(|(name, _, count)| (name, count)).collect()
    }

    /// Requires that every reference points to a number of the results; `result` is that of the
    /// first steps.
    pub(crate) fn check_references(&self, result: &Value) -> Result<(), BuildError> {
        let late = self.results_of_run();
        for (number, reference) in self.references.iter().enumerate() {
            let pointer = &reference.pointer;
            let mut steps = pointer.split('/').skip(1);
            let (root, entry) = (steps.next().unwrap_or_default(), steps.next());
            let fail = |found: String| Err(BuildError::Reference { number, pointer: pointer.clone(), found });
            if let Some((_, count)) = late.iter().find(|(name, _)| *name == root) {
                match (count, entry.map(str::parse::<usize>)) {
                    (Some(count), Some(Ok(entry))) if entry >= *count => {
                        return fail(format!("\"{root}\" has {count} entries, numbered from 0"));
                    }
                    (Some(_), Some(Err(_)) | None) => {
                        return fail(format!("\"{root}\" is a list; a number comes next, from 0"));
                    }
                    _ => continue,
                }
            }
            match result.pointer(pointer) {
                Some(Value::Number(_) | Value::Null) => {}
                Some(_) => return fail("there is no number but a list, a table or a text".into()),
                None => {
                    let keys = result.as_object().into_iter().flat_map(|o| o.keys().map(String::as_str));
                    let keys: Vec<_> = keys.chain(late.iter().map(|(name, _)| *name)).collect();
                    return fail(format!("at the top there are {}", keys.join(", ")));
                }
            }
        }
        Ok(())
    }
}
