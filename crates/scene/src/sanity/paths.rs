//! Paths of bodies that move by formulas.
use crate::build_error::{BuildError, PathProblem};
use crate::setup::{Algorithm, BodySetup, ForcingChoice, Setup, is_open};
use fv_mesh::Sides;
use interfaces::{Lattice, Pose};

impl Setup {
    /// Requires that formulas keep bodies within walls and, with the smooth forcing, where cells
    /// are equal, at instants over the whole run.
    pub(crate) fn check_paths<const D: usize>(&self) -> Result<(), BuildError> {
        let smooth = self.is_forced()
            && self.flow.algorithm == Algorithm::Projection
            && self.bodies.forcing() == ForcingChoice::Smooth;
        let (grid, sides) = (self.grid::<D>()?, Sides::new(self.all_sides::<D>())?);
        let lattices: Vec<Lattice> =
            if smooth { (0..D).map(|c| grid.lattice(Some(c), &sides)).collect() } else { Vec::new() };
        for body in self.bodies.list.iter() {
            let Some(motion) = body.motion.prescribed(body.pose.position) else { continue };
            for time in self.instants() {
                self.check_place(body, time, &motion.pose(&body.pose, time), &lattices)?;
            }
        }
        Ok(())
    }

    /// `lattices` are those of the velocity's components, or none if cells need not be equal.
    fn check_place(
        &self,
        body: &BodySetup,
        time: f64,
        pose: &Pose,
        lattices: &[Lattice],
    ) -> Result<(), BuildError> {
        let bounds = body.shape.aabb().posed(pose);
        for axis in 0..self.dim() {
            let at = pose.position[axis];
            let fail = |problem| {
                let (body, key) = (body.name.clone(), body.origin.clone());
                Err(BuildError::Path { body, key, time, axis, at, problem })
            };
            let ends = [self.axes[axis].lower(), self.axes[axis].upper()];
            let side = &self.sides[axis][usize::from(at > ends[1])];
            if !self.periodic(axis) && !(ends[0]..=ends[1]).contains(&at) && !is_open(side) {
                return fail(PathProblem::Outside(ends));
            }
            if !lattices.is_empty() {
                let (widths, equal) = self.smooth().spacings(lattices.iter(), axis, &bounds);
                if !equal {
                    return fail(PathProblem::Stretched(widths));
                }
            }
        }
        Ok(())
    }
}
