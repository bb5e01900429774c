//! Many bodies at once.
use super::bodies::{BodySetup, Materials};
use super::motions::{Motion, freedom};
use super::shapes::PlacedShape;
use super::{Context, is_open, of_file, shapes};
use crate::problem::Problem;
use crate::reader::Reader;
use dem::placing::{
    CrystalLattice, LatticeKind, Orientations, RandomAddition, Region, SizeDistribution, read_bodies,
};
use dem::{Material, Shape};
use fv_mesh::{Fluid, Side};
use interfaces::{Aabb, Point, Pose, Twist, Vector};
use std::sync::Arc;

/// Where bodies may be.
pub(super) struct Place<'a> {
    pub(super) bounds: Aabb,
    pub(super) periodic: [bool; 3],
    pub(super) sides: &'a [[Side; 2]],
    pub(super) fluid: Option<Fluid>,
    pub(super) gravity: Vector,
}

/// Bodies that come in while a run is on its way.
#[derive(Clone)]
pub(crate) struct InflowSetup {
    /// The key that made it: `factories.0`.
    pub(crate) origin: String,
    pub(crate) region: Aabb,
    pub(crate) rate: f64,
    pub(crate) start: f64,
    pub(crate) number: Option<u64>,
    pub(crate) gap: f64,
    pub(crate) seed: u64,
    pub(crate) orientations: Orientations,
    pub(crate) material: Material,
    pub(crate) twist: Twist,
    /// Shapes that are handed out in turn: enough of them that a distribution of sizes is met.
    pub(crate) shapes: Vec<Arc<dyn Shape>>,
    /// Unit of length of the file, if they are meshes \[m\].
    pub(crate) unit: Option<f64>,
}

/// Share of a region that random addition may be asked to fill.
const MOST_FILLED: f64 = 0.6;
/// So many shapes stand for a distribution of sizes of an inflow.
const SIZES: usize = 200;

/// Adds the bodies of all factories to `list`; answers the inflows.
pub(super) fn read(
    root: &Reader<'_>,
    context: &Context<'_>,
    materials: &Materials,
    place: &Place<'_>,
    list: &mut Vec<BodySetup>,
) -> Result<Vec<InflowSetup>, Problem> {
    let mut inflows = Vec::new();
    for (number, (kind, t)) in root.choices("factories", "type").into_iter().enumerate() {
        let factory = Factory { t: &t, context, place, material: materials.of(&t)? };
        let (shapes, poses) = match kind {
            "lattice" => factory.lattice()?,
            "random" => factory.random(list)?,
            "table" => factory.table()?,
            _ => {
                inflows.push(factory.inflow(number)?);
                continue;
            }
        };
        let motion = match t.text("motion") {
            Some("fixed") => Motion::Fixed,
            _ => Motion::Free(freedom(context.dim)),
        };
        let twist =
            Twist { linear: t.vector_of("velocity", context.dim)?.unwrap_or_default(), ..Twist::default() };
        for (shape, (pose, own)) in shapes.into_iter().zip(poses) {
            list.push(BodySetup {
                name: list.len().to_string(),
                origin: format!("factories.{number}"),
                shape,
                unit: shapes::unit(&t),
                material: factory.material,
                pose,
                twist: own.unwrap_or(twist),
                motion: motion.clone(),
                tether: None,
                surface: None,
            });
        }
    }
    Ok(inflows)
}

struct Factory<'a> {
    t: &'a Reader<'a>,
    context: &'a Context<'a>,
    place: &'a Place<'a>,
    material: Material,
}

/// Shapes and, for each, where it is and how it moves if the factory tells.
type Made = (Vec<Arc<dyn Shape>>, Vec<(Pose, Option<Twist>)>);

impl Factory<'_> {
    fn region(&self) -> Result<Aabb, Problem> {
        let Some(region) = self.t.table("region") else { return Ok(self.place.bounds) };
        let corner = |key: &str| region.point_of(key, self.context.dim).map(Option::unwrap_or_default);
        let (min, max): (Point, Point) = (corner("lower")?, corner("upper")?);
        let inside = (0..self.context.dim).all(|a| {
            min[a] < max[a] && min[a] >= self.place.bounds.min[a] && max[a] <= self.place.bounds.max[a]
        });
        if !inside {
            let message =
                "the upper corner has to be above the lower one, and both inside the box of the grid";
            return Err(region.fail_here(message));
        }
        Ok(Aabb { min, max })
    }
    /// The region of an inflow. It may reach beyond sides that bodies can pass, if they move inwards from there.
    fn inflow_region(&self, velocity: Vector) -> Result<Aabb, Problem> {
        let Some(region) = self.t.table("region") else { return Ok(self.place.bounds) };
        let corner = |key: &str| region.point_of(key, self.context.dim).map(Option::unwrap_or_default);
        let (min, max): (Point, Point) = (corner("lower")?, corner("upper")?);
        let Place { bounds, sides, fluid, gravity, .. } = self.place;
        let net = 1.0 - fluid.map_or(0.0, |f| f.density) / self.material.density;
        for a in 0..self.context.dim {
            if min[a] >= max[a] {
                return Err(region.fail_here("the upper corner has to be above the lower one"));
            }
            for (end, beyond) in [bounds.min[a] - min[a], max[a] - bounds.max[a]].into_iter().enumerate() {
                if beyond <= 0.0 {
                    continue;
                }
                let inwards = if end == 0 { 1.0 } else { -1.0 };
                let (axis, name) = (["x", "y", "z"][a], ["min", "max"][end]);
                if !is_open(&sides[a][end]) {
                    return Err(region.fail_here(format!(
                        "{beyond:.3e} m of the region are beyond the side {axis}_{name}, which bodies cannot pass; keep it inside the box, or make the side an inlet, an outlet or of given pressure"
                    )));
                }
                let speed = inwards * velocity[a];
                if speed < 0.0 || (speed == 0.0 && inwards * net * gravity[a] <= 0.0) {
                    return Err(self.t.fail("velocity", format!(
                        "{beyond:.3e} m of the region are beyond the side {axis}_{name}, and bodies move at {speed} m/s from there into the box; give a velocity above 0 inwards, or keep the region inside"
                    )));
                }
            }
        }
        Ok(Aabb { min, max })
    }
    /// Whether the largest of these shapes has room in the region of an inflow while nothing else is there.
    fn check_room(&self, region: Aabb, shapes: &[Arc<dyn Shape>]) -> Result<(), Problem> {
        let largest = shapes.iter().max_by(|a, b| a.bounding_radius().total_cmp(&b.bounding_radius()));
        let Some(shape) = largest else { return Ok(()) };
        let fail = |e| self.t.fail("region", e);
        let region = Region::cuboid(region, self.repeats(&region)).map_err(fail)?;
        let placing = RandomAddition::new(region).with_gap(self.gap()).map_err(fail)?;
        match placing.with_orientations(self.orientations()).place(&[&**shape], self.seed()) {
            Ok(_) => Ok(()),
            Err(error) => Err(fail(error)),
        }
    }
    /// Periodic only where it spans the whole box.
    fn placing_region(&self) -> Result<Region<'static>, Problem> {
        let box_ = self.region()?;
        Region::cuboid(box_, self.repeats(&box_)).map_err(|e| self.t.fail("region", e))
    }
    /// Axes along which `box_` repeats.
    fn repeats(&self, box_: &Aabb) -> [bool; 3] {
        let all = &self.place.bounds;
        let spans = |a: usize| box_.min[a] == all.min[a] && box_.max[a] == all.max[a];
        [0, 1, 2].map(|a| self.place.periodic[a] && spans(a))
    }
    fn gap(&self) -> f64 {
        self.t.number("gap").unwrap_or(0.0)
    }
    fn seed(&self) -> u64 {
        self.t.whole("seed").unwrap_or(0) as u64
    }
    fn orientations(&self) -> Orientations {
        match self.t.text("turned") {
            Some("no") => Orientations::Fixed(interfaces::Rotation::identity()),
            Some("about-z") => Orientations::AboutZ,
            _ if self.context.dim == 2 => Orientations::AboutZ,
            _ => Orientations::Random,
        }
    }
    fn scale(&self) -> Result<SizeDistribution, Problem> {
        let Some((law, t)) = self.t.choice("scale", "law") else {
            return SizeDistribution::constant(1.0).map_err(|e| self.t.fail_here(e));
        };
        let number = |key: &str| t.number(key).unwrap_or(1.0);
        let bounds = t.numbers("bounds").unwrap_or_default();
        let bounds = [bounds.first().copied().unwrap_or(0.5), bounds.get(1).copied().unwrap_or(2.0)];
        let scale = match law {
            "uniform" => SizeDistribution::uniform(number("low"), number("high")),
            "normal" => SizeDistribution::normal(number("mean"), number("deviation"), bounds),
            _ => SizeDistribution::log_normal(number("median"), number("deviation"), bounds),
        };
        scale.map_err(|e| self.t.fail("scale", e))
    }
    /// One shape per factor; equal factors share one.
    fn shapes(&self, factors: &[f64]) -> Result<Vec<PlacedShape>, Problem> {
        let mut made: Option<(f64, PlacedShape)> = None;
        factors
            .iter()
            .map(|&factor| match &made {
                Some((last, shape)) if *last == factor => Ok(shape.clone()),
                _ => {
                    let shape = shapes::shape(self.t, "shape", self.context, factor)?;
                    made = Some((factor, shape.clone()));
                    Ok(shape)
                }
            })
            .collect()
    }

    fn lattice(&self) -> Result<Made, Problem> {
        let t = self.t;
        let (kind, plane) = match t.text("kind") {
            Some("square") => (LatticeKind::PlaneSquare, true),
            Some("hexagonal") => (LatticeKind::PlaneHexagonal, true),
            Some("cubic") => (LatticeKind::SimpleCubic, false),
            Some("body-centred") => (LatticeKind::BodyCentredCubic, false),
            Some("face-centred") => (LatticeKind::FaceCentredCubic, false),
            Some("close-packed") => (LatticeKind::HexagonalClosePacked, false),
            _ if self.context.dim == 2 => (LatticeKind::PlaneSquare, true),
            _ => (LatticeKind::SimpleCubic, false),
        };
        if plane != (self.context.dim == 2) {
            return Err(
                t.fail("kind", "square and hexagonal are for plane scenes, the others for scenes in space")
            );
        }
        let distance = t.number("distance").unwrap_or(1.0);
        let lattice = CrystalLattice::new(kind, distance).map_err(|e| t.fail("distance", e))?;
        let jitter = t.number("jitter").unwrap_or(0.0);
        let factors = self.scale()?;
        let reach = self.shapes(&[1.0])?[0].reach();
        let margin = reach + jitter + self.gap();
        let mut points = lattice.in_box(&self.region()?, margin).map_err(|e| t.fail_here(e))?;
        if let Some(number) = t.whole("number") {
            if number > points.len() {
                let message = format!(
                    "{number} bodies, of which {} fit into the region; give fewer, or a smaller distance",
                    points.len()
                );
                return Err(t.fail("number", message));
            }
            // From below, along the last axis.
            let up = self.context.dim - 1;
            points.sort_by(|a, b| {
                a[up].total_cmp(&b[up]).then(a[0].total_cmp(&b[0])).then(a[1].total_cmp(&b[1]))
            });
            points.truncate(number);
        }
        if points.is_empty() {
            return Err(t.fail_here("no body fits into the region; make it larger, or the bodies smaller"));
        }
        if jitter > 0.0 {
            lattice.jitter(&mut points, jitter, self.seed()).map_err(|e| t.fail("jitter", e))?;
        }
        let shapes = self.shapes(&factors.sample(points.len(), self.seed()))?;
        let turns = self.orientations().of(self.seed());
        let references = points.into_iter().zip(turns);
        let references = references.map(|(position, orientation)| (Pose { position, orientation }, None));
        Ok(placed(shapes, references))
    }

    fn random(&self, there: &[BodySetup]) -> Result<Made, Problem> {
        let t = self.t;
        let region = self.placing_region()?;
        let scale = self.scale()?;
        let factors = match (t.whole("number"), t.number("fraction")) {
            (Some(number), None) => scale.sample(number, self.seed()),
            (None, Some(fraction)) => {
                let volume = self.shapes(&[1.0])?[0].shape.inertia(1.0).volume;
                let dim = self.context.dim as i32;
                scale
                    .until(fraction * region.volume(), |factor| volume * factor.powi(dim), self.seed())
                    .map_err(|e| t.fail("fraction", e))?
            }
            (Some(_), Some(_)) => {
                return Err(t.fail("fraction", "`number` is given already; leave out one of the two"));
            }
            (None, None) => return Err(t.fail_here("how many? Give `number` or `fraction`")),
        };
        if factors.is_empty() {
            return Err(t.fail("fraction", "not even one body makes up this share; give a larger one"));
        }
        // Random addition jams far below that; to find out takes long.
        let volume = self.shapes(&[1.0])?[0].shape.inertia(1.0).volume;
        let filled: f64 = factors.iter().map(|f| volume * f.powi(self.context.dim as i32)).sum();
        if filled > MOST_FILLED * region.volume() {
            let message = format!(
                "{} bodies fill {:.2} of the region, and random places without overlap are found up to about {MOST_FILLED}; give fewer or smaller ones",
                factors.len(),
                filled / region.volume()
            );
            return Err(t.fail_here(message));
        }
        let shapes = self.shapes(&factors)?;
        let mut placing = RandomAddition::new(region)
            .with_gap(self.gap())
            .map_err(|e| t.fail("gap", e))?
            .with_orientations(self.orientations());
        for other in there {
            placing = placing.with_obstacle(&*other.shape, other.pose);
        }
        let borrowed: Vec<&dyn Shape> = shapes.iter().map(|placed| &*placed.shape).collect();
        let poses = placing.place(&borrowed, self.seed()).map_err(|e| t.fail_here(e))?;
        drop(borrowed);
        let shapes = shapes.into_iter().map(|placed| placed.shape).collect();
        Ok((shapes, poses.into_iter().map(|pose| (pose, None)).collect()))
    }

    fn table(&self) -> Result<Made, Problem> {
        let t = self.t;
        let path = self.context.path(t.text("file").unwrap_or_default());
        let told = |e: &dyn std::fmt::Display| t.fail("file", of_file(&path, e));
        let file = std::fs::File::open(&path).map_err(|e| told(&e))?;
        let rows = read_bodies(std::io::BufReader::new(file)).map_err(|e| told(&e))?;
        let factors: Vec<f64> = rows.iter().map(|row| row.size.unwrap_or(1.0)).collect();
        let shapes = self.shapes(&factors)?;
        Ok(placed(shapes, rows.into_iter().map(|row| (row.pose, row.twist))))
    }

    fn inflow(&self, origin: usize) -> Result<InflowSetup, Problem> {
        let t = self.t;
        let scale = self.scale()?;
        let number = if t.has("scale") { SIZES } else { 1 };
        let velocity = t.vector_of("velocity", self.context.dim)?.unwrap_or_default();
        let region = self.inflow_region(velocity)?;
        let shapes = self.shapes(&scale.sample(number, self.seed()))?;
        let shapes: Vec<_> = shapes.into_iter().map(|placed| placed.shape).collect();
        self.check_room(region, &shapes)?;
        Ok(InflowSetup {
            origin: format!("factories.{origin}"),
            region,
            rate: t.number("rate").unwrap_or(1.0),
            start: t.number("start").unwrap_or(0.0),
            number: t.whole("number").map(|n| n as u64),
            gap: self.gap(),
            seed: self.seed(),
            orientations: self.orientations(),
            material: self.material,
            twist: Twist { linear: velocity, ..Twist::default() },
            shapes,
            unit: shapes::unit(t),
        })
    }
}

/// Shapes whose reference points are at these poses.
fn placed(shapes: Vec<PlacedShape>, references: impl Iterator<Item = (Pose, Option<Twist>)>) -> Made {
    let poses =
        shapes.iter().zip(references).map(|(placed, (pose, twist))| (placed.pose(pose), twist)).collect();
    (shapes.into_iter().map(|placed| placed.shape).collect(), poses)
}
