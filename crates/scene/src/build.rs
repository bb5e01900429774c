//! From a setup to what the libraries run.
use crate::build_error::BuildError;
use crate::cast::{Cast, Script};
use crate::physics::{Physics, Segregated};
use crate::setup::{
    Algorithm, Bodies, ContactLawChoice, ForcingChoice, InflowSetup, Motion, Setup, StrategyChoice,
};
use crate::still::Still;
use coupling::WithScalars;
use dem::placing::{PlacingError, Region};
use dem::{Chen, ContactLaw, Entrant, Inflow, Lubricated, Population, Repulsive, RigidBodies, Rolling};
use fv_mesh::{
    CartesianGrid, Convection, Diffusion, FlowError, Piso, PisoParams, Projection, Side, TimeScheme,
};
use ibm::{Hfdib, IbmError, SmoothFilm, SmoothForcing, cut_walls};
use interfaces::{BodyId, Freedom, Kinematics, Periods, Point, Twist};

/// A number of which one digit counts.
fn about(x: f64) -> String {
    if x < 10.0 { format!("{x:.1}") } else { format!("{x:.0}") }
}

/// The image in the box of a place: bodies keep on counting beyond periodic sides.
fn within(x: Point, repeats: &[Option<[f64; 2]>; 3]) -> [f64; 3] {
    std::array::from_fn(|a| repeats[a].map_or(x[a], |[from, length]| from + (x[a] - from).rem_euclid(length)))
}

impl Setup {
    /// The convection scheme, and why it is the default one.
    fn convection(&self) -> String {
        match (self.flow.default_convection, self.flow.convection) {
            (Some(why), _) => why.into(),
            (None, Convection::Central) => "central".into(),
            (None, Convection::Upwind) => "upwind".into(),
            (None, Convection::LinearUpwind) => "linear-upwind".into(),
            (None, Convection::Quick) => "quick".into(),
            (None, Convection::Limited) => "limited".into(),
        }
    }

    pub(crate) fn grid<const D: usize>(&self) -> Result<CartesianGrid<D>, FlowError> {
        CartesianGrid::from_axes(std::array::from_fn(|a| self.axes[a].clone()))
    }
    pub(crate) fn all_sides<const D: usize>(&self) -> [[Side; 2]; D] {
        std::array::from_fn(|a| self.sides[a].clone())
    }

    /// The velocity at time 0, if one is given.
    pub(crate) fn initial<const D: usize>(
        &self,
        grid: &CartesianGrid<D>,
    ) -> Result<Option<impl Fn([f64; D]) -> [f64; D] + '_>, BuildError> {
        if self.initial.is_none() && self.start.is_none() {
            return Ok(None);
        }
        let value = move |x: [f64; D]| {
            let x: [f64; 3] = std::array::from_fn(|a| x.get(a).copied().unwrap_or(0.0));
            let u = match (&self.start, &self.initial) {
                (Some(field), _) => field.at(x),
                (None, Some(u)) => u.each_ref().map(|u| u.at(&x)),
                (None, None) => [0.0; 3],
            };
            std::array::from_fn(|c| u[c])
        };
        for index in 0..grid.n_cells() {
            let cell = grid.cell(index);
            let centre = grid.centre(cell);
            // Components are needed at the faces across their axes.
            for c in 0..D {
                let axis = grid.axis(c);
                for &face in &axis.faces()[cell[c]..=cell[c] + 1] {
                    let mut x = centre;
                    x[c] = face;
                    let value: f64 = value(x)[c];
                    if !value.is_finite() {
                        let at = std::array::from_fn(|a| x.get(a).copied().unwrap_or(0.0));
                        let (what, key) = ("the initial velocity", "initial.velocity");
                        return Err(BuildError::Formula { what, key, value, at });
                    }
                }
            }
        }
        Ok(Some(value))
    }

    /// Whether bodies act on the flow by a forcing, not as walls.
    pub(crate) fn is_forced(&self) -> bool {
        let any = !self.bodies.list.is_empty() || !self.bodies.inflows.is_empty();
        self.fluid.is_some()
            && any
            && match self.flow.algorithm {
                Algorithm::Simple => false,
                Algorithm::Piso => true,
                Algorithm::Projection => self.bodies.forcing() != ForcingChoice::CutLinks,
            }
    }

    /// Bodies that the smooth forcing cannot resolve, whatever the cells around them are.
    pub(crate) fn check_sizes(&self) -> Result<(), BuildError> {
        let (least, spacing) = (SmoothForcing::LEAST_CELLS, self.narrowest());
        match self.sizes().enumerate().find(|(_, size)| *size < least * spacing) {
            Some((number, size)) => {
                Err(IbmError::TooCoarse { body: BodyId(number), size, spacing, least }.into())
            }
            None => Ok(()),
        }
    }

    /// Least extents of the bodies' bounding boxes, then of the entrants' \[m\].
    pub(crate) fn sizes(&self) -> impl Iterator<Item = f64> {
        let later = self.bodies.inflows.iter().flat_map(|inflow| &inflow.shapes);
        let shapes = self.bodies.list.iter().map(|body| &body.shape).chain(later);
        shapes.map(|shape| {
            let extent = shape.aabb().extent();
            (0..self.dim()).map(|a| extent[a]).fold(f64::INFINITY, f64::min)
        })
    }

    /// Treatment of the viscous terms: explicit with bodies, unless given.
    pub(crate) fn diffusion(&self) -> Diffusion {
        let bodies = !self.bodies.list.is_empty() || !self.bodies.inflows.is_empty();
        self.flow.diffusion.unwrap_or(if bodies { Diffusion::Explicit } else { Diffusion::Auto })
    }

    /// The projection algorithm, without bodies or anything that acts on it.
    pub(crate) fn projection<const D: usize>(&self) -> Result<Projection<D>, BuildError> {
        let grid = self.grid()?;
        let mut flow = Projection::new(grid.clone(), self.all_sides(), self.fluid())?
            .with_convection(self.flow.convection)
            .with_diffusion(self.diffusion())
            .with_pressure_solver(self.flow.pressure)?;
        if let Some(u) = self.initial(&grid)? {
            flow.set_velocity(u);
        }
        Ok(flow)
    }

    /// The projection algorithm with bodies at rest as walls.
    pub(crate) fn walled<const D: usize>(&self) -> Result<(Physics<D>, Still), BuildError> {
        let mut flow = self.projection()?;
        let mut still = Still { bodies: self.still(), thin: Vec::new() };
        if still.bodies.n_bodies() > 0 {
            let walls = cut_walls(flow.velocity(), &still.bodies)?;
            still.thin.clone_from(&walls.thin);
            flow.set_walls(Some(walls))?;
        }
        Ok((self.physics(flow)?, still))
    }

    /// PISO by Euler's scheme in time, as the paper has it.
    pub(crate) fn piso<const D: usize>(&self) -> Result<Segregated<D>, BuildError> {
        let grid = self.grid()?;
        let params = PisoParams { time_scheme: TimeScheme::Euler, ..PisoParams::default() };
        let mut flow = Piso::new(grid.clone(), self.all_sides(), self.fluid())?
            .with_convection(self.flow.convection)
            .with_params(params)?;
        if let Some(u) = self.initial(&grid)? {
            flow.set_velocity(u);
        }
        let scalars = self.scalars(flow.grid(), flow.sides())?;
        Ok(WithScalars { flow, scalars, drive: self.lift() })
    }

    /// Why no books are kept; nothing if they are.
    pub(crate) fn why_no_books(&self) -> Option<&'static str> {
        match self.flow.algorithm {
            _ if self.fluid.is_none() => Some("no fluid"),
            Algorithm::Simple => Some("a steady flow has none"),
            _ if self.bodies.list.is_empty() && self.bodies.inflows.is_empty() => Some("no bodies"),
            _ if self.bodies.forcing() == ForcingChoice::CutLinks => {
                Some("what walls by cut links do is not in them")
            }
            Algorithm::Piso if self.lift().is_some() => Some("what buoyancy does by PISO is not in them"),
            _ if self.window.is_some() => Some("the box leaves fluid behind and takes in other"),
            _ if !self.output.ledger => Some("switched off by output.ledger"),
            _ => None,
        }
    }

    /// Lower end and length of the axes along which the box repeats \[m\].
    fn repeats(&self) -> [Option<[f64; 2]>; 3] {
        [0, 1, 2].map(|a| self.periodic(a).then(|| [self.axes[a].lower(), self.axes[a].length()]))
    }

    /// Bodies under the law of contact of the scene.
    pub(crate) fn bodies(&self) -> Result<Cast, BuildError> {
        if let Some(repulsion) = self.bodies.repulsion {
            return self.cast(self.repulsive(repulsion)?);
        }
        match (self.bodies.law, self.film()) {
            (ContactLawChoice::Chen, Some(roughness)) => self.cast(self.lubricated(roughness)?),
            (ContactLawChoice::Chen, None) => self.cast(self.chen()),
            (ContactLawChoice::Potential, _) => self.cast(self.potential()),
            (ContactLawChoice::Rolling, _) => self.cast(Rolling(self.chen())),
            (ContactLawChoice::None, _) => self.cast(()),
        }
    }

    /// Roughness of bodies between which films of fluid are computed.
    fn film(&self) -> Option<f64> {
        let one_solve = self.bodies.coupling.strategy == StrategyChoice::OneSolve;
        let resolved = self.fluid.is_some() && self.flow.algorithm == Algorithm::Projection;
        self.bodies.lubrication.filter(|_| one_solve && resolved)
    }

    /// Bodies under a law of contact.
    fn cast<L: ContactLaw + 'static>(&self, law: L) -> Result<Cast, BuildError> {
        let period = |a: usize| self.periodic(a).then(|| self.axes[a].length());
        let mut bodies = RigidBodies::with_law(Periods::new([0, 1, 2].map(period)), law);
        if self.fluid.is_none() {
            bodies.set_gravity(self.gravity);
        }
        let Bodies { list, inflows, exits, walls, wall_material, overlaps, .. } = &self.bodies;
        for (number, wall) in walls.iter().enumerate() {
            bodies.add_wall(wall.plane, *wall_material)?;
            match &wall.surface {
                Side::MovingWall(u) => {
                    let (u, periods) = (u.clone(), self.repeats());
                    bodies.set_wall_motion(number, move |x, t| u.at(within(x, &periods), t).into())?;
                }
                side => {
                    let velocity = side.wall_velocity([0.0; 3], 0.0).unwrap_or_default();
                    bodies.set_wall_velocity(number, velocity.into())?;
                }
            }
        }
        let mut scripts = Vec::new();
        for (number, body) in list.iter().enumerate() {
            let (freedom, twist) = match &body.motion {
                Motion::Free(freedom) => (*freedom, body.twist),
                Motion::Fixed => (Freedom::NONE, Twist::default()),
                formulas @ Motion::Prescribed { .. } => {
                    let motion = formulas.prescribed(body.pose.position).unwrap_or_default();
                    // Over a millionth of the run.
                    let twist = motion.velocity(0.0, 1e-6 * self.end);
                    scripts.push(Script { number, formulas: formulas.clone(), motion });
                    (Freedom::NONE, twist)
                }
            };
            let b = bodies.add(body.shape.clone(), body.material, body.pose, twist, freedom)?;
            bodies.set_tether(b, body.tether)?;
            if let Some(surface) = &body.surface {
                bodies.set_surface_motion(b, surface.along(body.shape.clone()))?;
            }
        }
        if !overlaps && L::TOUCHES {
            bodies.check_overlaps()?;
        }
        let mut population = Population::new(bodies);
        for exit in exits {
            population = population.with_exit(*exit);
        }
        for inflow in inflows {
            population = population.with_inflow(self.inflow(inflow)?);
        }
        Ok(Cast::new(population, inflows.len(), scripts))
    }

    fn inflow(&self, setup: &InflowSetup) -> Result<Inflow, PlacingError> {
        let spans = |a: usize| {
            self.periodic(a)
                && setup.region.min[a] == self.axes[a].lower()
                && setup.region.max[a] == self.axes[a].upper()
        };
        let region = Region::cuboid(setup.region, [0, 1, 2].map(spans))?;
        let freedom = if self.dim() == 2 { Freedom::PLANAR } else { Freedom::FREE };
        let (shapes, material, twist) = (setup.shapes.clone(), setup.material, setup.twist);
        let inflow = Inflow::new(region, setup.rate, move |serial| Entrant {
            shape: shapes[serial as usize % shapes.len()].clone(),
            material,
            twist,
            freedom,
        })?;
        let inflow = inflow.with_start(setup.start)?.with_gap(setup.gap)?.with_seed(setup.seed);
        let inflow = inflow.with_orientations(setup.orientations);
        Ok(match setup.number {
            Some(number) => inflow.with_number(number),
            None => inflow,
        })
    }

    /// The paper's law as the scene wants it.
    pub(crate) fn chen(&self) -> Chen {
        Chen::default().with_length_factor(self.bodies.length_factor).with_adhesion(self.bodies.adhesion)
    }
    /// The same with films of this roughness.
    pub(crate) fn lubricated(&self, roughness: f64) -> Result<Lubricated<Chen>, BuildError> {
        // Cells around bodies are equal: the narrowest of all.
        let spacing = self.axes.iter().map(fv_mesh::Axis::narrowest).fold(f64::INFINITY, f64::min);
        let viscosity = self.fluid().viscosity * self.fluid().density;
        Ok(Lubricated::new(self.chen(), viscosity, SmoothFilm::new(spacing)?)?.with_roughness(roughness)?)
    }
    /// The paper's law with a repulsion of this strength \[N\] and range \[m\].
    pub(crate) fn repulsive(&self, [strength, range]: [f64; 2]) -> Result<Repulsive<Chen>, BuildError> {
        Ok(Repulsive::new(self.chen(), strength, range)?)
    }
    /// The law that keeps energy.
    pub(crate) fn potential(&self) -> dem::Potential {
        dem::Potential::default().with_length_factor(self.bodies.length_factor)
    }
    pub(crate) fn smooth(&self) -> SmoothForcing {
        let coupling = &self.bodies.coupling;
        let mut forcing = SmoothForcing::new(self.fluid().density);
        if let Some(kernel) = coupling.kernel {
            forcing = forcing.with_kernel(kernel);
        }
        if let Some(passes) = coupling.passes {
            forcing = forcing.with_passes(passes);
        }
        forcing
    }
    pub(crate) fn hfdib(&self) -> Hfdib {
        Hfdib::new(self.fluid().density)
    }

    /// What the scene is made of: which parts are at work, and which are not.
    pub(crate) fn parts(&self) -> Vec<(&'static str, bool, String)> {
        let bodies = &self.bodies;
        let any = !bodies.list.is_empty() || !bodies.inflows.is_empty();
        let law = match bodies.law {
            ContactLawChoice::Chen if bodies.repulsion.is_some() => "chen with repulsion",
            law => law.word(),
        };
        let moves = bodies.any_moves();
        let fluid = self.fluid.is_some();
        let forcing = match bodies.forcing() {
            _ if !any => "no bodies",
            _ if !fluid => "no fluid",
            _ if self.flow.algorithm == Algorithm::Simple => "walls at rest by cut cells",
            ForcingChoice::CutLinks => "walls at rest by cut links",
            ForcingChoice::Hfdib => "hybrid fictitious domain–immersed boundary",
            _ => "smooth direct forcing",
        };
        let algorithm = match self.flow.algorithm {
            Algorithm::Projection => "projection",
            Algorithm::Piso => "PISO, Euler's scheme",
            Algorithm::Simple => "SIMPLEC, steady",
        };
        let contact = moves && bodies.law != ContactLawChoice::None && bodies.any_free();
        let why_no_contact = if !any {
            "no bodies"
        } else if !bodies.any_free() {
            "no body is free"
        } else {
            "switched off"
        };
        let turbulence = match &self.turbulence {
            Some(t) if any && self.walls_move() => {
                format!("{}, beside bodies wherever they are", t.model.name())
            }
            Some(t) => match self.y_plus() {
                Some(y) => {
                    format!("{}; first cells beside walls at y+ of about {}", t.model.name(), about(y))
                }
                None => t.model.name().to_owned(),
            },
            None if !fluid => "no fluid".into(),
            None => "no `turbulence`: the flow is resolved, or laminar".into(),
        };
        let names: Vec<&str> = self.scalars.iter().map(|s| s.name.as_str()).collect();
        vec![
            ("flow", fluid, if fluid { algorithm } else { "no `fluid`: bodies alone" }.into()),
            ("convection", fluid, if fluid { self.convection() } else { "no fluid".into() }),
            ("turbulence model", self.turbulence.is_some(), turbulence),
            ("scalars", !names.is_empty(), if names.is_empty() { "none".into() } else { names.join(", ") }),
            ("immersed boundary", any && fluid, forcing.into()),
            (
                "rigid bodies",
                moves,
                if moves { format!("{} at the start", bodies.list.len()) } else { "nothing moves".into() },
            ),
            (
                "contact",
                contact,
                if contact {
                    format!("law {law}, {} walls", bodies.walls.len())
                } else {
                    why_no_contact.into()
                },
            ),
            (
                "ledger",
                self.why_no_books().is_none(),
                match (self.why_no_books(), self.flow.algorithm) {
                    (Some(why), _) => why.into(),
                    (None, Algorithm::Piso) => {
                        "momentum, to the tolerances of PISO's solvers, and energy, but for what Euler's scheme takes".into()
                    }
                    (None, _) => "momentum and energy, step by step".into(),
                },
            ),
            (
                "reduced models",
                !self.models.is_empty(),
                if self.models.is_empty() {
                    "none".into()
                } else {
                    self.models.iter().map(|m| m.name.as_str()).collect::<Vec<_>>().join(", ")
                },
            ),
            (
                "lubrication",
                bodies.lubrication.is_some(),
                if bodies.lubrication.is_some() {
                    "films below two cells".into()
                } else {
                    "not asked for".into()
                },
            ),
        ]
    }
}
