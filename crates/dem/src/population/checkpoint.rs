//! What a restart needs of those who come and go.
use super::{Origin, Population};
use crate::contact::ContactLaw;
use interfaces::{BodyId, Checkpoint, Kinematics, Pose, RestartError};

/// Besides what [`RigidBodies`](crate::RigidBodies) keep: who is there, how many came in and left. The run that restores has to begin with the
/// same bodies, inflows and exits.
impl<L: ContactLaw> Checkpoint for Population<L> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        let origin = |o: &Origin| match *o {
            Origin::Start(b) => [-1.0, b as f64],
            Origin::Inflow { inflow, serial } => [inflow as f64, serial as f64],
        };
        sink("origins", &self.origins.iter().flat_map(origin).collect::<Vec<_>>());
        sink("entered", &self.entered.iter().map(|n| *n as f64).collect::<Vec<_>>());
        sink("dismissed", &self.dismissed.iter().map(|b| b.0 as f64).collect::<Vec<_>>());
        sink("left", &[self.left as f64]);
        self.bodies.save(sink);
    }

    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        let list = |name: &str| source(name).ok_or_else(|| RestartError::Missing(name.into()));
        let entered = RestartError::take(source, "entered", self.inflows.len())?;
        let left = RestartError::take(source, "left", 1)?[0] as u64;
        let (saved, rest) = list("origins")?.as_chunks::<2>();
        let origin = |o: &[f64; 2]| match o[0] {
            -1.0 => Some(Origin::Start(o[1] as usize)),
            inflow if (inflow as usize) < self.inflows.len() => {
                Some(Origin::Inflow { inflow: inflow as usize, serial: o[1] as u64 })
            }
            _ => None,
        };
        let saved: Option<Vec<Origin>> = saved.iter().map(origin).collect();
        let differs = || RestartError::Differs("bodies at the start, or inflows".into());
        let saved = saved.filter(|_| rest.is_empty()).ok_or_else(differs)?;
        self.be(&saved).ok_or_else(differs)?;
        self.entered = entered.iter().map(|n| *n as u64).collect();
        self.left = left;
        self.dismissed = list("dismissed")?.iter().map(|b| BodyId(*b as usize)).collect();
        if self.dismissed.iter().any(|b| b.0 >= saved.len()) {
            return Err(differs());
        }
        self.bodies.restore(source)
    }
}

impl<L: ContactLaw> Population<L> {
    /// Makes the bodies those of the list, wherever they are; `None` if that cannot be.
    fn be(&mut self, wanted: &[Origin]) -> Option<()> {
        // Those of the start that stay are there already, with all that was set of them.
        let start = wanted.iter().take_while(|o| matches!(o, Origin::Start(_))).count();
        let stays = |o: &Origin| wanted[..start].binary_search(o).is_ok();
        let gone: Vec<BodyId> = self.bodies.ids().filter(|b| !stays(&self.origins[b.0])).collect();
        let numbers = self.bodies.remove(&gone).ok()?;
        numbers.apply(&mut self.origins);
        if self.origins != wanted[..start] {
            return None;
        }
        for origin in &wanted[start..] {
            let Origin::Inflow { inflow, serial } = *origin else { return None };
            let entrant = (self.inflows[inflow].recipe)(serial);
            // Somewhere; the saved state knows where.
            self.add(entrant, Pose::at([0.0; 3]), *origin).ok()?;
        }
        Some(())
    }
}
