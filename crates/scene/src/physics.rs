//! The flow of a scene and what acts on it.
use crate::build_error::BuildError;
use crate::expression::Expression;
use crate::setup::{ForcingChoice, ModelChoice, ScalarSetup, ScaleChoice, Setup};
use coupling::{Drive, Walled, WithScalars};
use fv_mesh::{
    BodyForce, Boussinesq, CartesianGrid, Diffusion, EddyStress, Field, FlowError, Hooked, Hooks, Modelled,
    Piso, Projection, Scalar, ScalarTransport, Settling, Sides, TransportParams, Velocity,
};
use ibm::{Given, IbmError, ImmersedScalar, StaticBodies, SurfaceFlux, WallDistance};
use interfaces::{
    Bodies, BodyId, Checkpoint, Closure, CutCells, Kinematics, Lattice, RestartError, SolveError,
};
use turb::{
    Inflow, KEpsilon, KOmega, KOmegaSst, Law, Realizable, RealizableKEpsilon, Smagorinsky,
    SmagorinskyConstants, Sst, StandardKEpsilon, TwoEquation, Wale, WaleConstants, Wilcox, YPlus,
};

/// The flow, whatever acts on it: what a scene does not ask for is `None` or empty.
pub(crate) type Physics<const D: usize> =
    Hooked<D, Option<Lift>, Option<Walled<D, Box<dyn SavedClosure>>>, Scalars<D>>;
/// The segregated algorithm and what it carries.
pub(crate) type Segregated<const D: usize> = WithScalars<Piso<D>, Scalars<D>, Option<Lift>>;
/// A turbulence model, chosen at run time.
pub(crate) type Model<const D: usize> = Modelled<D, Box<dyn SavedClosure>>;

/// A closure whose state is saved.
pub(crate) trait SavedClosure: Closure + Checkpoint {
    /// How far from walls the first cells are, where wall functions ask for it.
    fn y_plus(&self) -> Option<YPlus> {
        None
    }
}
impl SavedClosure for Smagorinsky {}
impl SavedClosure for Wale {}
impl<L: Law> SavedClosure for TwoEquation<L>
where
    Self: Closure,
{
    fn y_plus(&self) -> Option<YPlus> {
        Some(TwoEquation::y_plus(self))
    }
}

/// Buoyancy by one of the scalars.
pub(crate) struct Lift {
    scalar: usize,
    law: Boussinesq,
}

impl<const D: usize> BodyForce<D, Scalars<D>> for Lift {
    fn varies(&self) -> bool {
        true
    }
    fn add(&self, _: &Projection<D>, scalars: &Scalars<D>, source: &mut [Field<D>; D]) {
        if let Some(one) = scalars.list.get(self.scalar) {
            self.law.accelerate(&one.scalar, source);
        }
    }
}

impl<const D: usize> Drive<Piso<D>, Scalars<D>> for Lift {
    fn drive(&self, scalars: &Scalars<D>, flow: &mut Piso<D>) {
        self.put(scalars, flow.source_mut());
    }
}

impl Lift {
    /// Writes the accelerations at the velocity nodes.
    pub(crate) fn put<const D: usize>(&self, scalars: &Scalars<D>, source: &mut [Field<D>; D]) {
        source.iter_mut().for_each(|source| source.data_mut().fill(0.0));
        if let Some(one) = scalars.list.get(self.scalar) {
            self.law.accelerate(&one.scalar, source);
        }
    }
}

/// The scalars of a scene.
#[derive(Default)]
pub(crate) struct Scalars<const D: usize> {
    list: Vec<Carried<D>>,
    bodies: StaticBodies,
    surfaces: SurfaceFlux,
    /// Do bodies move? Then they are told, and hold the scalars when they have moved in the step.
    moving: bool,
    /// Time that the scalars have come to without being held yet \[s\].
    ahead: Option<f64>,
}

/// A scalar, and what bodies do to it.
struct Carried<const D: usize> {
    scalar: Scalar<D>,
    setup: ScalarSetup,
    held: Option<ImmersedScalar>,
    /// The source besides what bodies give off, if there is both.
    source: Option<Field<D>>,
}

impl<const D: usize> Scalars<D> {
    /// Name, unit and field of each.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (&str, &str, &Field<D>)> {
        self.list.iter().map(|s| (s.setup.name.as_str(), s.setup.unit.as_str(), s.scalar.field()))
    }
    fn any_flux(&self) -> bool {
        self.list.iter().any(|one| one.setup.flux.is_some())
    }
    /// Lets walls of cut cells, where each has the value that it has on bodies at `time`, give off what the law of the wall says, instead of holding cells.
    pub(crate) fn stand_beside(&mut self, cuts: &CutCells, time: f64) -> Result<(), FlowError> {
        for one in &mut self.list {
            let value = one.setup.bodies.as_ref().map_or(0.0, |formula| formula.needed(&[time]));
            one.scalar.set_walls(Some((cuts, value)))?;
            one.held = None;
        }
        Ok(())
    }
    /// What those walls give off of each, by name \[its unit m³/s; plane scenes m²/s\].
    pub(crate) fn given_off(&self) -> Vec<(String, f64)> {
        let of = |one: &Carried<D>| Some((one.setup.name.clone(), one.scalar.given_off()?));
        self.list.iter().filter_map(of).collect()
    }
    /// Tells those walls of the friction velocity at their pieces.
    pub(crate) fn rub(&mut self, friction_velocity: &[f64], viscosity: f64) -> Result<(), FlowError> {
        self.list.iter_mut().try_for_each(|one| one.scalar.rub(friction_velocity, viscosity))
    }
    /// Brings them to their steady state in a steady flow.
    pub(crate) fn settle(&mut self, velocity: &Velocity<D>, time: f64) -> Result<(), FlowError> {
        self.steadily(time, |scalar, cells, hold| {
            scalar.settle(velocity, time, Settling::default(), cells, hold).map(drop)
        })
    }
    /// Brings them nearer to it; answers the largest relative change of any.
    pub(crate) fn approach(&mut self, velocity: &Velocity<D>, time: f64) -> Result<f64, FlowError> {
        let mut largest = 0.0_f64;
        self.steadily(time, |scalar, cells, hold| {
            largest = largest.max(scalar.approach(velocity, time, cells, hold)?);
            Ok(())
        })?;
        Ok(largest)
    }
    /// Does something with each scalar, the cells that bodies hold, and how they do.
    fn steadily(
        &mut self,
        time: f64,
        mut act: impl FnMut(&mut Scalar<D>, &[usize], &mut dyn FnMut(&mut [f64])) -> Result<(), FlowError>,
    ) -> Result<(), FlowError> {
        let Self { list, bodies, .. } = self;
        for Carried { scalar, setup, held, .. } in list {
            let all = || (0..bodies.n_bodies()).map(BodyId);
            let cells: Vec<usize> = held.iter().flat_map(|held| all().flat_map(|b| held.held(b))).collect();
            let value = setup.bodies.as_ref().map_or(0.0, |formula| formula.needed(&[time]));
            act(scalar, &cells, &mut |field| {
                for (held, b) in held.iter().flat_map(|held| all().map(move |b| (held, b))) {
                    held.apply(b, field, |_, _| value, |_| value);
                }
            })?;
        }
        Ok(())
    }
}

impl<const D: usize> ScalarTransport<D> for Scalars<D> {
    fn advance(&mut self, velocity: &Velocity<D>, time: f64, dt: f64) -> Result<(), FlowError> {
        let Self { list, bodies, surfaces, moving, ahead } = self;
        *ahead = moving.then_some(time + dt);
        list.iter_mut().try_for_each(|one| {
            if let Some(flux) = &one.setup.flux {
                let source = one.scalar.source_mut().data_mut();
                match &one.source {
                    Some(own) => source.copy_from_slice(own.data()),
                    None => source.fill(0.0),
                }
                surfaces.add(flux.needed(&[time]), source);
            }
            one.scalar.advance(velocity, time, dt)?;
            if !*moving {
                one.hold(bodies, time + dt);
            }
            Ok(())
        })
    }
    fn follow(
        &mut self,
        grid: &CartesianGrid<D>,
        sides: &Sides<D>,
        time: f64,
        bodies: &dyn Bodies,
    ) -> Result<(), FlowError> {
        if !self.moving || self.list.is_empty() {
            return Ok(());
        }
        let (lattice, ahead) = (grid.lattice(None, sides), self.ahead.take());
        if self.any_flux() {
            self.surfaces.place(&lattice, bodies);
        }
        for one in &mut self.list {
            one.place(&lattice, bodies)
                .map_err(|e| FlowError::Scalar { time, source: SolveError::Solver(e.to_string()) })?;
            if let Some(time) = ahead {
                one.hold(bodies, time);
            }
        }
        Ok(())
    }
    fn longest_step(&self, eddy_rate: f64) -> f64 {
        self.list.iter().map(|s| s.scalar.longest_step(eddy_rate)).fold(f64::INFINITY, f64::min)
    }
    fn is_absent(&self) -> bool {
        self.list.is_empty()
    }
    fn mix(&mut self, eddy: &EddyStress<D>, viscosity: f64) {
        self.list.iter_mut().for_each(|one| one.scalar.mix(eddy, viscosity));
    }
}

impl<const D: usize> Carried<D> {
    fn place(&mut self, lattice: &Lattice, bodies: &dyn Bodies) -> Result<(), IbmError> {
        let storage = self.scalar.field().data().len();
        self.held.as_mut().map_or(Ok(()), |held| held.place(lattice, storage, bodies))
    }
    fn hold(&mut self, bodies: &dyn Bodies, time: f64) {
        if let (Some(held), Some(formula)) = (&self.held, &self.setup.bodies) {
            let value = formula.needed(&[time]);
            self.scalar.impose(|field| {
                for b in (0..bodies.n_bodies()).map(BodyId) {
                    held.apply(b, field, |_, _| value, |_| value);
                }
            });
        }
    }
}

impl<const D: usize> Checkpoint for Scalars<D> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        for one in &self.list {
            one.scalar.save(&mut |name, values| sink(&format!("{}.{name}", one.setup.name), values));
        }
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.list.iter_mut().try_for_each(|one| {
            let prefix = &one.setup.name;
            one.scalar.restore(&|name| source(&format!("{prefix}.{name}")))
        })
    }
    fn save_start(&mut self, sink: &mut dyn FnMut(&str, &[f64])) {
        for one in &mut self.list {
            let prefix = &one.setup.name;
            one.scalar.save_start(&mut |name, values| sink(&format!("{prefix}.{name}"), values));
        }
    }
    fn take_back<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.list.iter_mut().try_for_each(|one| {
            let prefix = &one.setup.name;
            one.scalar.take_back(&|name| source(&format!("{prefix}.{name}")))
        })
    }
}

impl Setup {
    /// The scene's bodies as solids at rest.
    pub(crate) fn still(&self) -> StaticBodies {
        self.bodies.list.iter().fold(StaticBodies::new(), |all, b| all.with(b.shape.clone(), b.pose))
    }

    /// `flow` with all that acts on it.
    pub(crate) fn physics<const D: usize>(&self, flow: Projection<D>) -> Result<Physics<D>, BuildError> {
        let (scalars, lift) = (self.scalars(flow.grid(), flow.sides())?, self.lift());
        let mut model = self.model(flow.grid(), flow.sides(), TransportParams::default())?;
        // The others follow the bodies by themselves.
        if let Some(model) = model.as_mut().filter(|_| !self.walls_move()) {
            self.stand_beside(model, flow.sides())?;
        }
        let model = model.map(Walled::new);
        let hooks = Hooks { body_force: lift, forcing: (), closure: model, scalars };
        Ok(Hooked::new(flow, hooks))
    }

    /// What the buoyant scalar does, if one is.
    pub(crate) fn lift(&self) -> Option<Lift> {
        self.scalars.iter().enumerate().find_map(|(scalar, s)| {
            let (expansion, reference) = s.buoyancy?;
            Some(Lift { scalar, law: Boussinesq { expansion, reference, gravity: self.gravity } })
        })
    }

    /// The scalars in a flow on `grid` between `sides`.
    pub(crate) fn scalars<const D: usize>(
        &self,
        grid: &CartesianGrid<D>,
        sides: &Sides<D>,
    ) -> Result<Scalars<D>, BuildError> {
        let (bodies, moving) = (self.still(), self.bodies.any_moves());
        let mut all = Scalars { bodies, moving, ..Scalars::default() };
        let lattice = grid.lattice(None, sides);
        for setup in &self.scalars {
            let sides = std::array::from_fn(|a| setup.sides[a].clone());
            let mut scalar = Scalar::new(grid, sides, setup.diffusivity)?
                .with_convection(setup.convection)
                .with_turbulent_prandtl(setup.turbulent_prandtl)?;
            let place =
                |x: [f64; D]| -> [f64; 3] { std::array::from_fn(|a| x.get(a).copied().unwrap_or(0.0)) };
            let check = |formula: &Expression, what: &'static str| {
                let places = (0..grid.n_cells()).map(|c| place(grid.centre(grid.cell(c))));
                let (value, at) = places.map(|at| (formula.at(&at), at)).find(|(v, _)| !v.is_finite())?;
                Some(BuildError::Formula { what, key: "scalars", value, at })
            };
            let source = setup.source.as_ref();
            if let Some(error) = check(&setup.initial, "the initial field of a scalar")
                .or_else(|| source.and_then(|source| check(source, "the source of a scalar")))
            {
                return Err(error);
            }
            scalar.set(|x| setup.initial.at(&place(x)));
            if let Some(source) = source {
                scalar.source_mut().set(|x| source.at(&place(x)));
            }
            let source = source.filter(|_| setup.flux.is_some()).map(|_| scalar.source_mut().clone());
            let held = setup.bodies.as_ref().map(|_| ImmersedScalar::new(Given::Value));
            if held.is_some() {
                // Surface cells get values beyond the surface's: near its limit, explicit diffusion is unstable with them.
                scalar = scalar.with_diffusion(Diffusion::Implicit);
            }
            let mut one = Carried { scalar, setup: setup.clone(), held, source };
            one.place(&lattice, &all.bodies)?;
            one.hold(&all.bodies, 0.0);
            all.list.push(one);
        }
        if all.any_flux() {
            all.surfaces.place(&lattice, &all.bodies);
        }
        Ok(all)
    }

    /// The turbulence model on the cells of `grid`, if the scene has one.
    pub(crate) fn model<const D: usize>(
        &self,
        grid: &CartesianGrid<D>,
        sides: &Sides<D>,
        params: TransportParams,
    ) -> Result<Option<Model<D>>, BuildError> {
        let Some(turbulence) = &self.turbulence else { return Ok(None) };
        let n = grid.n_cells();
        let inflow = || -> Result<Inflow, turb::TurbulenceError> {
            let (speed, intensity) = (turbulence.speed.unwrap_or(self.flow_speed()), turbulence.intensity);
            match turbulence.scale {
                ScaleChoice::Length(length) => Inflow::from_length(speed, intensity, length),
                ScaleChoice::ViscosityRatio(ratio) => {
                    Inflow::from_viscosity_ratio(speed, intensity, ratio, self.fluid().viscosity)
                }
            }
        };
        let closure: Box<dyn SavedClosure> = match turbulence.model {
            ModelChoice::Sst => Box::new(KOmegaSst::new(Sst::default(), n, inflow()?)?),
            ModelChoice::KOmega(beta, gamma) => {
                let law = Wilcox::default();
                let law = Wilcox { beta: beta.unwrap_or(law.beta), gamma: gamma.unwrap_or(law.gamma), ..law };
                Box::new(KOmega::new(law, n, inflow()?)?)
            }
            ModelChoice::KEpsilon => Box::new(KEpsilon::new(StandardKEpsilon::default(), n, inflow()?)?),
            ModelChoice::Realizable => {
                Box::new(RealizableKEpsilon::new(Realizable::default(), n, inflow()?)?)
            }
            ModelChoice::Smagorinsky(c) => {
                let usual = SmagorinskyConstants::default();
                let constants = SmagorinskyConstants { c_s: c.unwrap_or(usual.c_s), ..usual };
                Box::new(Smagorinsky::new(constants, n)?)
            }
            ModelChoice::Wale(c) => {
                let usual = WaleConstants::default();
                Box::new(Wale::new(WaleConstants { c_w: c.unwrap_or(usual.c_w) }, n)?)
            }
        };
        Ok(Some(Modelled::new(closure, grid, sides, params)?))
    }

    /// Does the turbulence model see the bodies as walls wherever they are?
    pub(crate) fn walls_move(&self) -> bool {
        self.turbulence.as_ref().is_some_and(|t| t.model.averages())
            && self.bodies.forcing() != ForcingChoice::CutLinks
    }

    /// Tells the model how far from the bodies, as they are at the start, the cells are.
    pub(crate) fn stand_beside<const D: usize>(
        &self,
        model: &mut Model<D>,
        sides: &Sides<D>,
    ) -> Result<(), BuildError> {
        let bodies = self.still();
        if bodies.n_bodies() > 0 {
            let mut distance = WallDistance::new();
            distance.update(&model.transport().grid().lattice(None, sides), &bodies)?;
            let ours = model.transport_mut().wall_distance_mut();
            ours.iter_mut().zip(distance.values()).for_each(|(d, b)| *d = d.min(*b));
        }
        Ok(())
    }

    /// The fastest of what sides, initial flow and bodies bring \[m/s\]; 1 without any.
    fn flow_speed(&self) -> f64 {
        let speed = self.speed();
        if speed > 0.0 { speed } else { 1.0 }
    }
}
