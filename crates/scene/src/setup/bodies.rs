//! Bodies, their contacts and how they are coupled to the flow.
use super::factories::{self, InflowSetup};
use super::motions::{self, Motion};
use super::surfaces::{self, SurfaceVelocity};
use super::{Context, shapes};
use crate::problem::Problem;
use crate::reader::Reader;
use coupling::WeightBalance;
use dem::{HalfSpace, Material, PairProperties, Shape, Tether};
use fv_mesh::{Axis, Fluid, Side};
use ibm::Kernel;
use interfaces::{Aabb, Point, Pose, Twist, Vector};
use std::collections::HashMap;
use std::sync::Arc;

/// A body at the start.
#[derive(Clone)]
pub(crate) struct BodySetup {
    pub(crate) name: String,
    /// The key that made it: `bodies.2`, `factories.0`.
    pub(crate) origin: String,
    pub(crate) shape: Arc<dyn Shape>,
    /// Unit of length of the file, if it is a mesh \[m\].
    pub(crate) unit: Option<f64>,
    pub(crate) material: Material,
    pub(crate) pose: Pose,
    pub(crate) twist: Twist,
    pub(crate) motion: Motion,
    pub(crate) tether: Option<Tether>,
    /// Velocity of its surface besides its own.
    pub(crate) surface: Option<SurfaceVelocity>,
}

/// A plane that bodies touch.
#[derive(Clone, Debug)]
pub(crate) struct WallSetup {
    /// The key that made it: `sides.y_min`, `contact.planes.0`.
    pub(crate) name: String,
    pub(crate) plane: HalfSpace,
    /// A wall with the velocity of its surface.
    pub(crate) surface: Side,
}

/// All about bodies.
#[derive(Clone)]
pub(crate) struct Bodies {
    /// Shared by copies of the scene, as there may be a million.
    pub(crate) list: Arc<[BodySetup]>,
    pub(crate) inflows: Vec<InflowSetup>,
    pub(crate) exits: Vec<HalfSpace>,
    pub(crate) law: ContactLawChoice,
    pub(crate) length_factor: f64,
    pub(crate) adhesion: bool,
    /// Strength \[N\] and range \[m\] of the repulsion.
    pub(crate) repulsion: Option<[f64; 2]>,
    /// May they overlap at the start?
    pub(crate) overlaps: bool,
    /// Walls that they touch: sides of the box, then planes of their own.
    pub(crate) walls: Vec<WallSetup>,
    /// Whether they touch walls of the box.
    pub(crate) touch_walls: bool,
    pub(crate) wall_material: Material,
    /// Roughness of the films.
    pub(crate) lubrication: Option<f64>,
    pub(crate) coupling: CouplingSetup,
    /// Keys of contacts and materials that the law does not use.
    pub(crate) unused: Vec<String>,
    /// Materials of less restitution than the law "potential" has.
    pub(crate) too_plastic: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ContactLawChoice {
    Chen,
    Potential,
    Rolling,
    None,
}

impl ContactLawChoice {
    fn read(word: Option<&str>) -> Self {
        match word {
            Some("potential") => Self::Potential,
            Some("rolling") => Self::Rolling,
            Some("none") => Self::None,
            _ => Self::Chen,
        }
    }
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Chen => "chen",
            Self::Potential => "potential",
            Self::Rolling => "rolling",
            Self::None => "none",
        }
    }
    /// Keys of a material, then those of `contact`, that it does not use.
    fn unused(self) -> [&'static [&'static str]; 2] {
        match self {
            Self::Chen => [&["restitution", "rolling_friction"], &[]],
            Self::Potential => [&["damping", "rolling_friction"], &["adhesion"]],
            Self::Rolling => [&["restitution"], &[]],
            Self::None => [
                &[
                    "youngs_modulus",
                    "poisson_ratio",
                    "damping",
                    "restitution",
                    "friction",
                    "rolling_friction",
                ],
                &["walls", "planes", "wall_material", "length_factor", "adhesion", "overlaps"],
            ],
        }
    }
    /// The keys of the file that it does not use.
    fn unused_in(self, root: &Reader<'_>) -> Vec<String> {
        let [of_material, of_contact] = self.unused();
        let given = |t: &Reader<'_>, path: &str, keys: &[&str]| -> Vec<String> {
            keys.iter().filter(|key| t.has(key)).map(|key| format!("{path}.{key}")).collect()
        };
        let materials = root.named("materials").into_iter();
        let contact = root.table("contact");
        materials
            .flat_map(|(name, t)| given(&t, &format!("materials.{name}"), of_material))
            .chain(contact.iter().flat_map(|t| given(t, "contact", of_contact)))
            .collect()
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StrategyChoice {
    OneSolve,
    Iterated,
    Explicit,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ForcingChoice {
    Auto,
    Smooth,
    Hfdib,
    CutLinks,
}

#[derive(Clone)]
pub(crate) struct CouplingSetup {
    pub(crate) strategy: StrategyChoice,
    forcing: ForcingChoice,
    pub(crate) balance: Option<WeightBalance>,
    pub(crate) virtual_mass: Option<f64>,
    pub(crate) passes: Option<usize>,
    pub(crate) kernel: Option<Kernel>,
}

impl Bodies {
    /// Is there a body that moves, or will be?
    pub(crate) fn any_moves(&self) -> bool {
        !self.inflows.is_empty() || self.list.iter().any(|b| !matches!(b.motion, Motion::Fixed))
    }
    /// Is there a body that the flow moves, or will be?
    pub(crate) fn any_free(&self) -> bool {
        !self.inflows.is_empty() || self.list.iter().any(|b| matches!(b.motion, Motion::Free(_)))
    }
    /// The first body whose surface moves by itself.
    pub(crate) fn moving_surface(&self) -> Option<&BodySetup> {
        self.list.iter().find(|b| b.surface.is_some())
    }
    /// How the fluid is made to follow them.
    pub(crate) fn forcing(&self) -> ForcingChoice {
        match self.coupling.forcing {
            ForcingChoice::Auto if self.any_moves() || self.moving_surface().is_some() => {
                ForcingChoice::Smooth
            }
            ForcingChoice::Auto => ForcingChoice::CutLinks,
            choice => choice,
        }
    }
}

pub(super) fn read(
    root: &Reader<'_>,
    context: &Context<'_>,
    axes: &[Axis],
    sides: &[[Side; 2]],
    (fluid, gravity): (Option<Fluid>, Vector),
) -> Result<Bodies, Problem> {
    let materials = Materials::read(root)?;
    let bounds = bounds(axes);
    let mut list = Vec::new();
    for (number, t) in root.tables("bodies").into_iter().enumerate() {
        list.push(body(&t, context, &materials, number)?);
    }
    let periodic = |a: usize| sides.get(a).is_some_and(|pair| matches!(pair[0], Side::Periodic));
    let place = factories::Place { bounds, periodic: [0, 1, 2].map(periodic), sides, fluid, gravity };
    let inflows = factories::read(root, context, &materials, &place, &mut list)?;
    let mut names: Vec<&str> = list.iter().map(|b| b.name.as_str()).collect();
    names.sort_unstable();
    if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(root
            .fail("bodies", format!("two bodies are called \"{}\"; give each a name of its own", pair[0])));
    }
    let half_space = |t: &Reader<'_>| {
        let point = t.point_of("point", context.dim)?.unwrap_or_default();
        let normal = t.vector_of("normal", context.dim)?.unwrap_or_default();
        HalfSpace::new(point, normal).map_err(|e| t.fail("normal", e))
    };
    let exits = root.tables("exits").iter().map(half_space).collect::<Result<_, _>>()?;
    let contact = root.table("contact");
    let planes = contact.as_ref().map(|t| t.tables("planes")).unwrap_or_default();
    let planes = planes
        .iter()
        .enumerate()
        .map(|(number, t)| {
            let (plane, surface) = (half_space(t)?, surfaces::wall(t, context.dim)?);
            Ok(WallSetup { name: format!("contact.planes.{number}"), plane, surface })
        })
        .collect::<Result<Vec<_>, _>>()?;
    let word = |key: &str| contact.as_ref().and_then(|t| t.text(key));
    let first = list.first().map_or(materials.default, |b| b.material);
    let wall_material = match word("wall_material") {
        Some(name) => materials.get(name, contact.as_ref().unwrap_or(root), "wall_material")?,
        None => first,
    };
    let touches = contact.as_ref().and_then(|t| t.flag("walls")).unwrap_or(true);
    let coupling = coupling(root);
    let law = ContactLawChoice::read(word("law"));
    let too_plastic = |(_, t): &(&str, Reader<'_>)| {
        t.number("restitution").is_some_and(|e| e < PairProperties::LEAST_RESTITUTION)
    };
    let materials = root.named("materials").into_iter().filter(too_plastic);
    let too_plastic = materials.map(|(name, _)| format!("materials.{name}.restitution")).collect();
    let bodies = Bodies {
        list: list.into(),
        inflows,
        exits,
        law,
        unused: law.unused_in(root),
        too_plastic,
        length_factor: contact.as_ref().and_then(|t| t.number("length_factor")).unwrap_or(4.0),
        adhesion: contact.as_ref().and_then(|t| t.flag("adhesion")).unwrap_or(false),
        repulsion: contact.as_ref().and_then(|t| t.table("repulsion")).and_then(|t| {
            let [strength, range] = ["strength", "range"].map(|key| t.number(key));
            Some([strength?, range?])
        }),
        overlaps: contact.as_ref().and_then(|t| t.flag("overlaps")).unwrap_or(false),
        walls: [
            if touches { walls(axes, sides).map_err(|e| root.fail("sides", e))? } else { vec![] },
            planes,
        ]
        .concat(),
        touch_walls: touches,
        wall_material,
        lubrication: root.table("lubrication").map(|t| t.number("roughness").unwrap_or(1e-3)),
        coupling,
    };
    agrees(root, &bodies, fluid)?;
    Ok(bodies)
}

fn agrees(root: &Reader<'_>, bodies: &Bodies, fluid: Option<Fluid>) -> Result<(), Problem> {
    let coupling = root.table("coupling");
    let fail = |key: &str, message: String| {
        coupling.as_ref().map_or_else(|| root.fail("coupling", &message), |t| t.fail(key, &message))
    };
    let forcing = bodies.forcing();
    if forcing == ForcingChoice::CutLinks && bodies.any_moves() {
        return Err(fail(
            "forcing",
            "cut links are for bodies at rest; take \"smooth\", or make every body's motion \"fixed\"".into(),
        ));
    }
    if forcing == ForcingChoice::CutLinks
        && let Some(b) = bodies.moving_surface()
    {
        return Err(fail(
            "forcing",
            format!(
                "cut links are for walls at rest, and the surface of body {} moves; take \"smooth\" or \"hfdib\"",
                b.name
            ),
        ));
    }
    let any = !(bodies.list.is_empty() && bodies.inflows.is_empty());
    if any && forcing != ForcingChoice::Hfdib && fluid.is_some_and(|f| f.viscosity == 0.0) {
        let what = if forcing == ForcingChoice::CutLinks {
            "walls by cut links"
        } else {
            "bodies by smooth forcing"
        };
        return Err(root.fail("fluid", format!("{what} need a viscosity; give `nu` above 0")));
    }
    let chen = bodies.law == ContactLawChoice::Chen;
    let across = bodies.lubrication.is_some() || bodies.repulsion.is_some();
    if bodies.coupling.strategy != StrategyChoice::OneSolve && (!chen || across) {
        return Err(fail("strategy", "\"iterated\" and \"explicit\" go with the contact law \"chen\" without lubrication and repulsion only; take \"one-solve\"".into()));
    }
    if bodies.repulsion.is_some() && (!chen || bodies.lubrication.is_some()) {
        return Err(root.fail(
            "contact",
            "repulsion goes with the contact law \"chen\" without lubrication only; leave out contact.repulsion, or contact.law and lubrication",
        ));
    }
    if bodies.lubrication.is_some() && !chen {
        return Err(root.fail(
            "lubrication",
            "films go with the contact law \"chen\" only; leave out contact.law or lubrication",
        ));
    }
    Ok(())
}

fn coupling(root: &Reader<'_>) -> CouplingSetup {
    let t = root.table("coupling");
    let word = |key: &str| t.as_ref().and_then(|t| t.text(key));
    CouplingSetup {
        strategy: match word("strategy") {
            Some("iterated") => StrategyChoice::Iterated,
            Some("explicit") => StrategyChoice::Explicit,
            _ => StrategyChoice::OneSolve,
        },
        forcing: match word("forcing") {
            Some("smooth") => ForcingChoice::Smooth,
            Some("hfdib") => ForcingChoice::Hfdib,
            Some("cut-links") => ForcingChoice::CutLinks,
            _ => ForcingChoice::Auto,
        },
        balance: match word("balance") {
            Some("none") => Some(WeightBalance::None),
            Some("net-weight") => Some(WeightBalance::NetWeight),
            Some("zero-flow") => Some(WeightBalance::ZeroFlow),
            _ => None,
        },
        virtual_mass: t.as_ref().and_then(|t| t.number("virtual_mass")),
        passes: t.as_ref().and_then(|t| t.whole("passes")),
        kernel: match word("kernel") {
            Some("yang") => Some(Kernel::Yang),
            Some("quartic") => Some(Kernel::QuarticSpline),
            Some("quintic") => Some(Kernel::QuinticSpline),
            _ => None,
        },
    }
}

/// The box; flat in the plane.
fn bounds(axes: &[Axis]) -> Aabb {
    let end = |f: fn(&Axis) -> f64| Point::from([0, 1, 2].map(|a| axes.get(a).map_or(0.0, f)));
    Aabb { min: end(Axis::lower), max: end(Axis::upper) }
}

/// The walls of the box, as bodies touch them: sides that are walls or planes of symmetry.
fn walls(axes: &[Axis], sides: &[[Side; 2]]) -> Result<Vec<WallSetup>, dem::DemError> {
    let mut out = Vec::new();
    for (a, (axis, pair)) in axes.iter().zip(sides).enumerate() {
        let ends = [(axis.lower(), 1.0, "min"), (axis.upper(), -1.0, "max")];
        for (side, (at, sign, end)) in pair.iter().zip(ends) {
            let surface = if matches!(side, Side::FreeSlip) { &Side::WALL } else { side };
            if surface.is_wall() {
                let (mut point, mut normal) = (Point::origin(), Vector::zeros());
                (point[a], normal[a]) = (at, sign);
                let name = format!("sides.{}_{end}", ["x", "y", "z"][a]);
                out.push(WallSetup { name, plane: HalfSpace::new(point, normal)?, surface: surface.clone() });
            }
        }
    }
    Ok(out)
}

/// Materials by name.
pub(super) struct Materials {
    named: HashMap<String, Material>,
    default: Material,
}

impl Materials {
    fn read(root: &Reader<'_>) -> Result<Self, Problem> {
        let mut named = HashMap::new();
        for (name, t) in root.named("materials") {
            let default = Material::default();
            let number = |key: &str, default: f64| t.number(key).unwrap_or(default);
            let material = Material {
                density: number("density", default.density),
                youngs_modulus: number("youngs_modulus", default.youngs_modulus),
                poisson_ratio: number("poisson_ratio", default.poisson_ratio),
                damping: number("damping", default.damping),
                restitution: number("restitution", default.restitution),
                friction: number("friction", default.friction),
                rolling_friction: number("rolling_friction", default.rolling_friction),
            };
            material.check().map_err(|e| t.fail_here(e))?;
            named.insert(name.to_owned(), material);
        }
        Ok(Self { named, default: Material::default() })
    }

    fn get(&self, name: &str, t: &Reader<'_>, key: &str) -> Result<Material, Problem> {
        self.named.get(name).copied().ok_or_else(|| {
            let mut known: Vec<_> = self.named.keys().map(String::as_str).collect();
            known.sort_unstable();
            let known = if known.is_empty() {
                "there are none".into()
            } else {
                format!("there are {}", known.join(", "))
            };
            t.fail(key, format!("there is no material \"{name}\" in `materials`; {known}"))
        })
    }

    /// The material of the body in `t`.
    pub(super) fn of(&self, t: &Reader<'_>) -> Result<Material, Problem> {
        let mut material = match t.text("material") {
            Some(name) => self.get(name, t, "material")?,
            None => self.default,
        };
        if let Some(density) = t.number("density") {
            material.density = density;
        }
        Ok(material)
    }
}

fn body(
    t: &Reader<'_>,
    context: &Context<'_>,
    materials: &Materials,
    number: usize,
) -> Result<BodySetup, Problem> {
    let dim = context.dim;
    let spin = match (t.number("spin"), t.vector("spin")) {
        (Some(about_z), _) => Vector::new(0.0, 0.0, about_z),
        (None, vector) => vector.unwrap_or_default(),
    };
    if dim == 2 && (spin.x != 0.0 || spin.y != 0.0) {
        return Err(t.fail("spin", "bodies of a plane scene turn about z only; give a number"));
    }
    let motion = motions::read(t, context)?;
    let twist = Twist { linear: t.vector_of("velocity", dim)?.unwrap_or_default(), angular: spin };
    if matches!(motion, Motion::Fixed) && twist != Twist::default() {
        return Err(t.fail("motion", "a body that is fixed has no velocity; give motion \"prescribed\", or leave out velocity and spin"));
    }
    let tether = match t.table("tether") {
        None => None,
        Some(spring) => Some(Tether {
            on_body: spring.vector("on_body").unwrap_or_default().into(),
            anchor: spring.point_of("anchor", dim)?.unwrap_or_default(),
            stiffness: spring.number("stiffness").unwrap_or(0.0),
            damping: spring.number("damping").unwrap_or(0.0),
        }),
    };
    let surface = SurfaceVelocity::read(t, &motion, dim)?;
    let placed = shapes::shape(t, "shape", context, 1.0)?;
    let orientation = shapes::orientation(t)?;
    let position = t.point_of("position", dim)?.unwrap_or_default();
    let pose = placed.pose(Pose { position, orientation });
    Ok(BodySetup {
        name: t.text("name").map_or_else(|| number.to_string(), Into::into),
        origin: format!("bodies.{number}"),
        unit: shapes::unit(t),
        shape: placed.shape,
        material: materials.of(t)?,
        pose,
        twist,
        motion,
        tether,
        surface,
    })
}
