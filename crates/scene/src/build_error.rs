//! Why a scene cannot be put together, or ends before its time, and the key that has to do with it.
use crate::document::Document;
use crate::problem::Problems;
use crate::setup::{Algorithm, BodySetup, ForcingChoice, Motion, Setup};
use coupling::CouplingError;
use dem::placing::PlacingError;
use dem::{DemError, SubStepLimit};
use fv_mesh::FlowError;
use ibm::IbmError;
use interfaces::BodyId;

/// Why a scene cannot be put together.
#[derive(Debug, thiserror::Error)]
pub enum BuildError {
    /// Any of the others that a key of the file has to do with.
    #[error(transparent)]
    Scene(Box<Problems>),
    /// The flow.
    #[error(transparent)]
    Flow(#[from] FlowError),
    /// The bodies.
    #[error(transparent)]
    Bodies(#[from] DemError),
    /// Where bodies come in.
    #[error(transparent)]
    Placing(#[from] PlacingError),
    /// Bodies on the grid.
    #[error(transparent)]
    Immersed(#[from] IbmError),
    /// The turbulence model.
    #[error(transparent)]
    Turbulence(#[from] turb::TurbulenceError),
    /// Both together.
    #[error(transparent)]
    Coupling(#[from] CouplingError),
    /// Anything that is no matter of the scene.
    #[error(transparent)]
    Run(Box<crate::RunError>),
    /// The grid is too large for this machine.
    #[error("{cells:.2e} cells need about {:.1} GB of memory, and {:.1} GB are left of the {limit}; take fewer cells", needed / 1e9, free / 1e9)]
    Memory {
        /// Cells of the grid.
        cells: f64,
        /// What they need \[bytes\].
        needed: f64,
        /// What is there \[bytes\].
        free: f64,
        /// The limit that leaves the least.
        limit: &'static str,
    },
    /// A reference to what the results do not have.
    #[error("the results have no number at {pointer}: {found}; give the pointer of a number in result.json")]
    Reference {
        /// Number of the reference.
        number: usize,
        /// Its JSON pointer.
        pointer: String,
        /// Description of what the results have.
        found: String,
    },
    /// A body that its formulas move to where it cannot be.
    #[error("its formulas move body {body} at t = {time:.4e} s {}", place(*axis, *at, problem))]
    Path {
        /// Name of the body.
        body: String,
        /// Key of the body.
        key: String,
        /// When \[s\].
        time: f64,
        /// Axis, from 0.
        axis: usize,
        /// Place of its centre along the axis \[m\].
        at: f64,
        /// Reason why it cannot be there.
        problem: PathProblem,
    },
    /// A formula without a value.
    #[error("{what} is {value} at ({}); the formula needs a finite value all over the box", at.map(|x| format!("{x:.6}")).join(", "))]
    Formula {
        /// Of what.
        what: &'static str,
        /// The key it stands under.
        key: &'static str,
        /// Its value.
        value: f64,
        /// Where \[m\].
        at: [f64; 3],
    },
}

impl BuildError {
    /// The key that has to do with it, if it is known.
    fn key(&self, setup: &Setup) -> Option<String> {
        // Bodies that come in have the numbers behind those at the start.
        let body = |b: &BodyId| match setup.bodies.list.get(b.0) {
            Some(body) => Some(body.origin.clone()),
            None => Some(setup.bodies.inflows.first()?.origin.clone()),
        };
        let bodies = |error: &DemError| {
            let part = match error {
                DemError::SubSteps { limit: SubStepLimit::Tether(_), .. } => ".tether",
                DemError::SubSteps { limit: SubStepLimit::Material(_), .. } => ".material",
                _ => "",
            };
            body(&body_of(error)?).map(|key| key + part)
        };
        match self {
            Self::Bodies(error) | Self::Placing(PlacingError::Shape(error)) => bodies(error),
            Self::Immersed(error) | Self::Coupling(CouplingError::Immersed(error)) => match error {
                IbmError::TooCoarse { body: b, .. }
                | IbmError::TooLarge { body: b, .. }
                | IbmError::Outside { body: b, .. }
                | IbmError::Unseen { body: b, .. }
                | IbmError::NoSurface { body: b, .. } => body(b),
                IbmError::Stretched { .. } => Some("coupling.forcing".into()),
                IbmError::Thin { part } => body(&BodyId(part.body)),
                _ => None,
            },
            Self::Coupling(
                CouplingError::Motion { body: b, .. }
                | CouplingError::TooLarge { body: b, .. }
                | CouplingError::Outside { body: b, .. }
                | CouplingError::Escaped { body: b, .. },
            ) => body(b),
            Self::Coupling(CouplingError::Dynamics { source, .. }) => match source.downcast_ref() {
                Some(PlacingError::Shape(error)) => bodies(error),
                _ => None,
            },
            Self::Turbulence(_) => Some("turbulence".into()),
            Self::Memory { .. } => Some("grid".into()),
            Self::Reference { number, .. } => Some(format!("references.{number}.pointer")),
            Self::Path { key, .. } => Some(key.clone()),
            Self::Formula { key, .. } => Some((*key).into()),
            Self::Flow(error) | Self::Coupling(CouplingError::Flow(error)) => match error {
                FlowError::Boundary { .. } | FlowError::MassBalance { .. } => Some("sides".into()),
                FlowError::ScalarNotSteady { .. }
                | FlowError::ScalarDiverged { .. }
                | FlowError::Scalar { .. } => Some("scalars".into()),
                FlowError::Closure { .. } => Some("turbulence".into()),
                FlowError::Diverged { .. } => setup.given_pace().map(Into::into),
                _ => None,
            },
            Self::Coupling(CouplingError::Courant { .. }) => {
                Some(setup.given_pace().unwrap_or("time.courant").into())
            }
            Self::Coupling(CouplingError::Collapsed { .. }) => setup.light(),
            _ => None,
        }
    }

    /// Speed \[m/s\] of the flow when it had grown too much, on cells of width `h` \[m\].
    fn flow_speed(&self, h: f64) -> Option<f64> {
        match self {
            Self::Flow(FlowError::Diverged { courant, dt, .. })
            | Self::Coupling(
                CouplingError::Flow(FlowError::Diverged { courant, dt, .. })
                | CouplingError::Courant { courant, dt, .. }
                | CouplingError::Collapsed { courant, dt, .. },
            ) if *dt > 0.0 => Some(courant * h / dt),
            _ => None,
        }
    }

    /// When the velocity had grown too much, if that is it \[s\].
    fn too_fast_at(&self) -> Option<f64> {
        match self {
            Self::Flow(FlowError::Diverged { time, .. })
            | Self::Coupling(
                CouplingError::Flow(FlowError::Diverged { time, .. })
                | CouplingError::Courant { time, .. }
                | CouplingError::Collapsed { time, .. },
            ) => Some(*time),
            _ => None,
        }
    }

    /// The same with its place in the file, if a key has to do with it.
    pub(crate) fn placed(self, setup: &Setup, document: &Document) -> Self {
        let flow = self.flow_speed(setup.narrowest());
        // Momentum spreads, but does not grow: slower causes are none.
        let is_cause = |speed: f64| flow.is_none_or(|flow| speed > CAUSE * flow);
        if let Some(time) = self.too_fast_at() {
            if let Some((key, speed)) = setup.rush(time).filter(|rush| is_cause(rush.1)) {
                let message =
                    format!("{self}; what enters or moves here has come to {speed:.3e} m/s by then");
                return Self::Scene(Box::new(document.problem(&key, message)));
            }
            if let Some(force) = setup.grown_force(time).filter(|force| is_cause(force * time)) {
                let message = format!("{self}; the force has come to {force:.3e} m/s² by then");
                return Self::Scene(Box::new(document.problem("force", message)));
            }
        }
        if flow.is_some()
            && let Some((key, speed)) = setup.fastest_body().filter(|body| is_cause(body.1))
        {
            let message = format!("{self}; the surface of this body begins with {speed:.3e} m/s");
            return Self::Scene(Box::new(document.problem(&key, message)));
        }
        match self.key(setup) {
            Some(key) if key == VIRTUAL_MASS => {
                let message =
                    format!("{self}; bodies lighter than the fluid need a virtual mass, or a larger one");
                Self::Scene(Box::new(document.problem(&key, message)))
            }
            Some(key) => {
                let doubt = setup.unit_doubt(&key).map(|doubt| format!("; {doubt}")).unwrap_or_default();
                Self::Scene(Box::new(document.problem(&key, format!("{self}{doubt}"))))
            }
            None => self,
        }
    }
}

impl From<crate::RunError> for BuildError {
    fn from(error: crate::RunError) -> Self {
        match error {
            crate::RunError::Build(error) => error,
            crate::RunError::Coupling(error) => error.into(),
            other => Self::Run(Box::new(other)),
        }
    }
}

/// Why a body cannot be where its formulas move it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathProblem {
    /// Its centre is beyond a wall; the box reaches from and to \[m\].
    Outside([f64; 2]),
    /// Cells around it are of different widths: least and largest \[m\].
    Stretched([f64; 2]),
}

fn place(axis: usize, at: f64, problem: &PathProblem) -> String {
    let axis = ["x", "y", "z"][axis.min(2)];
    match problem {
        PathProblem::Outside([from, to]) => format!(
            "to {axis} = {at:.6e} m, beyond the box from {from:.6e} to {to:.6e} m; change the formulas, end the run earlier, or take a larger box"
        ),
        PathProblem::Stretched([least, most]) => format!(
            "to {axis} = {at:.6e} m, where cells are {least:.6e} to {most:.6e} m wide along {axis}, but the smooth forcing needs equal cells around a body; make the grid uniform wherever the body goes, or take coupling.forcing = \"hfdib\""
        ),
    }
}

/// Key of the virtual mass.
const VIRTUAL_MASS: &str = "coupling.virtual_mass";
/// Share of the flow's speed from which on another speed is its cause.
const CAUSE: f64 = 0.3;

/// The body that an error is about.
fn body_of(error: &DemError) -> Option<BodyId> {
    match error {
        DemError::InWall { body, .. }
        | DemError::Period { body, .. }
        | DemError::PassedThrough { body, .. }
        | DemError::Diverged { body, .. }
        | DemError::TooFast { body, .. }
        | DemError::SubSteps { limit: SubStepLimit::Tether(body) | SubStepLimit::Material(body), .. } => {
            Some(*body)
        }
        DemError::OverlappingStart { a, b, .. } => Some(*a.max(b)),
        _ => None,
    }
}

impl Setup {
    /// Key of the steps that are given; none where they are automatic.
    fn given_pace(&self) -> Option<&'static str> {
        match self.flow.algorithm {
            Algorithm::Simple => Some("flow"),
            Algorithm::Projection | Algorithm::Piso => self.dt.map(|_| "time.dt"),
        }
    }
    /// Key of the body whose surface is fastest at the start, and its speed \[m/s\].
    fn fastest_body(&self) -> Option<(String, f64)> {
        let speed = |b: &BodySetup| {
            let [linear, angular] =
                [b.twist.linear.norm(), b.twist.angular.norm() * b.shape.bounding_radius()];
            let key = if angular > linear { "spin" } else { "velocity" };
            (format!("{}.{key}", b.origin), linear + angular)
        };
        self.bodies.list.iter().map(speed).max_by(|a, b| a.1.total_cmp(&b.1))
    }
    /// The key of what holds bodies that the fluid moves and that are lighter than it, or not much heavier by the paper's forcing, if there are such bodies.
    fn light(&self) -> Option<String> {
        let least = if self.bodies.forcing() == ForcingChoice::Hfdib { 3.0 } else { 1.0 };
        let light = |b: &BodySetup| {
            matches!(b.motion, Motion::Free(_)) && b.material.density < least * self.fluid().density
        };
        self.bodies.list.iter().any(light).then(|| VIRTUAL_MASS.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scene;

    const BOX: &str = r#"
        grid = { cells = [8, 8], size = [1.0, 1.0] }
        sides = { x = "wall", y = "wall" }
        fluid = { density = 1.0, nu = 0.01 }
        time = { end = 1.0 }
        force = ["sin(t)", 0.0]
    "#;

    /// Places the error of a flow of `speed` \[m/s\] at 0.5 s.
    fn placed(more: &[&str], speed: f64) -> BuildError {
        let more: Vec<String> = more.iter().map(|s| (*s).into()).collect();
        let scene = Scene::parse("box.toml", BOX, &more).unwrap();
        let dt = 0.4 * scene.setup.narrowest() / speed;
        let error = BuildError::Coupling(CouplingError::Collapsed { dt, time: 0.5, courant: 0.4 });
        error.placed(&scene.setup, &scene.document)
    }

    /// A force of 0.48 m/s² makes 0.2 m/s in 0.5 s, and not 1e6.
    #[test]
    fn a_key_is_named_only_if_it_can_be_the_cause() {
        let told = placed(&[], 0.2).to_string();
        assert!(told.contains("force: ") && told.contains("the force has come to 4.794e-1"), "{told}");
        assert!(matches!(placed(&[], 1e6), BuildError::Coupling(_)));
    }
}
