//! Places at random, without overlap.
use super::apart::Apart;
use super::error::{Jammed, PlacingError, not_negative};
use super::grid::{Ball, Grid, images, nearest};
use super::{Orientations, Region, source::Source};
use crate::{Form, OverlapSolver, Shape};
use interfaces::{Aabb, Point, Pose, Solid, Vector};

/// Random sequential addition: bodies are put one after the other at random places, the largest ones first, wherever they keep off
/// those that are there already and off the walls.
///
/// The spheres around bodies keep apart; [`tight`](Self::tight) lets them interpenetrate as long as the bodies do not. Spheres of
/// one size jam near a volume fraction of 0.38, discs near 0.547 (Torquato & Stillinger 2010, Rev. Mod. Phys. 82, 2633); bodies come
/// close to that only after very many attempts.
///
/// ```
/// use dem::placing::{PlacingError, RandomAddition, Region};
/// use dem::{HalfSpace, Shape, Sphere};
/// use dem::{Point, Pose, Vector};
///
/// let ball = Sphere::new(0.01)?;
/// let floor = HalfSpace::new(Point::origin(), Vector::z())?;
/// let drum = Region::cylinder(0.05, 0.2, Pose::at([0.0; 3]))?;
/// let adding = RandomAddition::new(drum).with_gap(1e-3)?.with_obstacle(&floor, Pose::at([0.0; 3]));
/// let poses = adding.place(&[&ball as &dyn Shape; 20], 7)?;
/// assert!(poses.iter().all(|at| at.position.z >= 0.011));
///
/// // There is no room for a thousand; what has a place is not lost.
/// let Err(PlacingError::Jammed(jammed)) = adding.with_attempts(1000).place(&[&ball as &dyn Shape; 1000], 7) else { panic!() };
/// assert!(jammed.placed.len() > 20 && jammed.fraction < 0.38);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct RandomAddition<'a> {
    region: Region<'a>,
    gap: f64,
    attempts: usize,
    tight: bool,
    orientations: Orientations,
    obstacles: Vec<(&'a dyn Solid, Pose)>,
}

/// Attempts per body unless told: spheres of one size come to 0.36 with it.
const ATTEMPTS: usize = 100_000;
/// Tight placing tells distances apart down to this part of the radius of the sphere that a body holds.
const FINEST: f64 = 1e-3;
/// Obstacles that reach farther than this many times the region are everywhere.
const EVERYWHERE: f64 = 1e3;

/// A shape with what is asked of it again and again.
#[derive(Clone, Copy)]
struct Candidate<'s> {
    shape: &'s dyn Shape,
    /// Of the sphere around it \[m\].
    outer: f64,
    /// Of the sphere around its centre that it holds; zero if its centre is outside \[m\].
    inner: f64,
}

impl<'a> RandomAddition<'a> {
    /// Bodies turned at random, no gap, no obstacles.
    pub fn new(region: Region<'a>) -> Self {
        let orientations = Orientations::Random;
        Self { region, gap: 0.0, attempts: ATTEMPTS, tight: false, orientations, obstacles: Vec::new() }
    }
    /// Bodies keep this `gap` \[m\] between one another, to obstacles and to walls.
    ///
    /// # Errors
    /// [`PlacingError::Parameter`] if it is negative or not finite.
    pub fn with_gap(mut self, gap: f64) -> Result<Self, PlacingError> {
        self.gap = not_negative("gap", gap)?;
        Ok(self)
    }
    /// How often a place for one body is sought before the region counts as full; 100 000 unless told.
    #[must_use]
    pub fn with_attempts(mut self, attempts: usize) -> Self {
        self.attempts = attempts;
        self
    }
    /// How bodies are turned. In plane regions random ones are turned about z.
    #[must_use]
    pub fn with_orientations(mut self, orientations: Orientations) -> Self {
        self.orientations = orientations;
        self
    }
    /// Something that is already there. In periodic regions its images are, too, but not those of what is without end (half spaces).
    #[must_use]
    pub fn with_obstacle(mut self, solid: &'a dyn Solid, at: Pose) -> Self {
        self.obstacles.push((solid, at));
        self
    }
    /// Lets bodies come as near as their surfaces allow, where the spheres around them keep apart otherwise. It takes longer, and pays for
    /// bodies that are not round. Without gap, pairs are decided by [`OverlapSolver`]; with one, those with a signed distance only, walls and
    /// obstacles by dividing space until signed distances are certain, which keeps up to 1e-3 of the inner radius more than was asked for.
    #[must_use]
    pub fn tight(mut self) -> Self {
        self.tight = true;
        self
    }

    /// A pose for each of the `shapes`, in their order. The same `seed` has the same poses.
    ///
    /// # Errors
    /// [`PlacingError::Jammed`] with all that was placed if there is no more room, [`PlacingError::TooLarge`] for a body that does not fit
    /// into the region alone, [`PlacingError::Dimension`] if a plane body is to be in space or a solid one in a plane,
    /// [`PlacingError::Obstacle`] and [`PlacingError::Orientation`] for what is not finite, [`PlacingError::TooMany`] from 2³¹ bodies on.
    pub fn place(&self, shapes: &[&dyn Shape], seed: u64) -> Result<Vec<Pose>, PlacingError> {
        let bodies = self.candidates(shapes)?;
        let orientations = self.orientations()?;
        let mut order: Vec<usize> = (0..bodies.len()).collect();
        // Stable: bodies of one size stay in their order.
        order.sort_by(|&a, &b| bodies[b].outer.total_cmp(&bodies[a].outer));

        let mut source = Source::new(seed);
        let mut scene = Scene::new(self, &bodies)?;
        let mut placed = Vec::with_capacity(bodies.len());
        for &body in &order {
            let found =
                (0..self.attempts).find_map(|_| scene.attempt(&bodies[body], &orientations, &mut source));
            let Some(pose) = found else {
                let volume: f64 = placed
                    .iter()
                    .map(|&(i, _): &(usize, Pose)| bodies[i].shape.inertia(1.0).volume)
                    .fold(0.0, |sum, v| sum + v);
                let (asked, attempts) = (bodies.len(), self.attempts);
                return Err(Jammed {
                    placed,
                    asked,
                    body,
                    attempts,
                    fraction: volume / self.region.volume(),
                }
                .into());
            };
            scene.add(&bodies[body], pose);
            placed.push((body, pose));
        }
        placed.sort_unstable_by_key(|&(body, _)| body);
        Ok(placed.into_iter().map(|(_, pose)| pose).collect())
    }

    fn candidates<'s>(&self, shapes: &[&'s dyn Shape]) -> Result<Vec<Candidate<'s>>, PlacingError> {
        let most = f64::from(i32::MAX);
        let number = shapes.len() as f64 + self.obstacles.len() as f64;
        if number > most {
            return Err(PlacingError::TooMany { what: "bodies and obstacles", number, most });
        }
        let plane = self.region.is_plane();
        let (extent, periodic) = (self.region.bounds().extent(), self.region.periodic());
        let mut out = Vec::with_capacity(shapes.len());
        for (body, &shape) in shapes.iter().enumerate() {
            let flat = shape.aabb().extent().z == 0.0;
            if flat != plane {
                return Err(PlacingError::Dimension { body, flat });
            }
            let outer = shape.bounding_radius();
            let inner = (-shape.signed_distance(Point::origin(), 2.0 * outer)).clamp(0.0, outer);
            for axis in 0..if plane { 2 } else { 3 } {
                let size = match (periodic[axis], self.tight) {
                    (true, _) => 2.0 * outer + self.gap,
                    (false, true) => 2.0 * (inner + self.gap),
                    (false, false) => 2.0 * (outer + self.gap),
                };
                let room = extent[axis];
                let fits = size <= room * (1.0 + 1e-14);
                // Not a number is too large as well.
                if !fits {
                    return Err(PlacingError::TooLarge { body, axis, size, room });
                }
            }
            out.push(Candidate { shape, outer, inner });
        }
        Ok(out)
    }
    fn orientations(&self) -> Result<Orientations, PlacingError> {
        let plane = self.region.is_plane();
        match self.orientations {
            Orientations::Random if plane => Ok(Orientations::AboutZ),
            Orientations::Fixed(turn) => {
                let q = turn.quaternion();
                let quaternion = [q.w, q.i, q.j, q.k];
                let tilted = plane && (q.i != 0.0 || q.j != 0.0);
                if tilted || !quaternion.iter().all(|c| c.is_finite()) {
                    return Err(PlacingError::Orientation { quaternion });
                }
                Ok(self.orientations)
            }
            any => Ok(any),
        }
    }
}

/// What is there already.
struct Scene<'r, 's> {
    rules: &'r RandomAddition<'r>,
    periods: Vector,
    grid: Grid,
    placed: Vec<(Candidate<'s>, Pose)>,
    /// Those in the grid; their numbers follow those of the bodies.
    obstacles: Vec<(&'r dyn Solid, Pose)>,
    /// Those that are everywhere.
    endless: Vec<(&'r dyn Solid, Pose)>,
    most_bodies: usize,
    solver: OverlapSolver,
    apart: Apart,
}

impl<'r, 's> Scene<'r, 's> {
    fn new(rules: &'r RandomAddition<'r>, bodies: &[Candidate<'s>]) -> Result<Self, PlacingError> {
        let (bounds, periods) = (rules.region.bounds(), rules.region.periods());
        let (mut obstacles, mut endless, mut spheres) = (Vec::new(), Vec::new(), Vec::new());
        for (obstacle, &(solid, at)) in rules.obstacles.iter().enumerate() {
            let turned = at.orientation.coords.iter().all(|c| c.is_finite());
            if !(turned && at.position.iter().all(|c| c.is_finite())) {
                return Err(PlacingError::Obstacle { obstacle, position: at.position.into() });
            }
            let around = solid.aabb();
            let radius = 0.5 * around.extent().norm();
            let local = radius <= EVERYWHERE * bounds.extent().norm();
            if !local {
                endless.push((solid, at));
                continue;
            }
            // Into the box, as bodies are.
            let centre = at.to_world(nalgebra::center(&around.min, &around.max));
            let away = (centre - bounds.min)
                .zip_map(&periods, |x, l| if l > 0.0 { l * (x / l).floor() } else { 0.0 });
            obstacles.push((solid, Pose { position: at.position - away, ..at }));
            spheres.push((centre - away, radius));
        }
        let radii: Vec<f64> = bodies.iter().map(|b| b.outer).chain(spheres.iter().map(|s| s.1)).collect();
        let mut grid = Grid::new(&bounds, rules.region.periodic(), &radii, rules.gap);
        for (i, &(centre, radius)) in spheres.iter().enumerate() {
            grid.add(Ball { centre, radius, id: (bodies.len() + i) as u32 });
        }
        Ok(Self {
            rules,
            periods,
            grid,
            placed: Vec::with_capacity(bodies.len()),
            obstacles,
            endless,
            most_bodies: bodies.len(),
            solver: OverlapSolver::new(),
            apart: Apart::default(),
        })
    }
    fn add(&mut self, body: &Candidate<'s>, pose: Pose) {
        self.grid.add(Ball { centre: pose.position, radius: body.outer, id: self.placed.len() as u32 });
        self.placed.push((*body, pose));
    }

    /// A random pose, if the body may have it.
    fn attempt(&mut self, body: &Candidate<'_>, turns: &Orientations, source: &mut Source) -> Option<Pose> {
        let Self { rules, periods, grid, placed, obstacles, endless, most_bodies, solver, apart } = self;
        let (region, gap, tight) = (&rules.region, rules.gap, rules.tight);
        let keeps = if tight { body.inner } else { body.outer } + gap;
        let room = region.shrunk(keeps);
        let position = source.in_box(room.min, room.extent().sup(&Vector::zeros()));
        // Whether places suit the body is decided before its orientation is drawn, where that does not matter.
        let mut pose = Pose { position, orientation: interfaces::Rotation::identity() };
        if tight {
            pose.orientation = turns.draw(source);
        }
        if (tight || !region.is_box()) && region.signed_distance(position, body.outer + gap) > -keeps {
            return None;
        }
        let reach = body.outer + gap;
        // What is easily told comes first for all neighbours: in a crowd, most attempts end there.
        let mut blocked = |thorough: bool, apart: &mut Apart| {
            let near = |solid: &dyn Solid, at: &Pose, pose: &Pose, apart: &mut Apart| {
                let told = sphere_near(body, pose, solid, at, gap, tight);
                told.unwrap_or_else(|| thorough && !separate(apart, body, pose, solid, at, gap))
            };
            if endless.iter().any(|(solid, at)| near(*solid, at, &pose, apart)) {
                return true;
            }
            grid.any(position, reach, |ball| {
                let distance = reach + ball.radius;
                let away = nearest(position - ball.centre, periods);
                if away.norm_squared() >= distance * distance {
                    return false;
                }
                let id = ball.id as usize;
                if id < *most_bodies && !tight {
                    return true;
                }
                images(away, periods, distance, |away| {
                    // The image of the body that is near this ball.
                    let pose = Pose { position: ball.centre + away, ..pose };
                    match id.checked_sub(*most_bodies) {
                        Some(i) => near(obstacles[i].0, &obstacles[i].1, &pose, apart),
                        None => {
                            let (other, at) = &placed[id];
                            match spheres_near(body, &pose, other, at, gap) {
                                Some(near) => near,
                                None => thorough && touch(solver, apart, (body, &pose), (other, at), gap),
                            }
                        }
                    }
                })
            })
        };
        if blocked(false, apart)
            || (tight && (!contained(apart, region, body, &pose, gap) || blocked(true, apart)))
        {
            return None;
        }
        if !tight {
            pose.orientation = turns.draw(source);
        }
        Some(pose)
    }
}

/// How exactly distances to a body have to be known \[m\].
fn finest(body: &Candidate<'_>) -> f64 {
    FINEST * body.inner.max(0.01 * body.outer)
}
/// The box around a body that stands there, and `margin`; plane ones stay plane.
fn around(solid: &dyn Solid, at: &Pose, margin: f64) -> Aabb {
    let bounds = solid.aabb();
    let mut out = bounds.posed(at).grown(margin);
    if bounds.extent().z == 0.0 {
        (out.min.z, out.max.z) = (0.0, 0.0);
    }
    out
}
/// Whether all of a body is inside the region, `gap` off its walls.
fn contained(apart: &mut Apart, region: &Region<'_>, body: &Candidate<'_>, pose: &Pose, gap: f64) -> bool {
    apart.nowhere_below(&around(body.shape, pose, 0.0), finest(body), |x, band| {
        let wall = -region.signed_distance(x, band + gap) - gap;
        body.shape.signed_distance(pose.to_body(x), band).max(wall)
    })
}
/// Whether a body is nearer than `gap` to something, if the spheres in and around it tell; the sphere around it does unless all is to be
/// `tight`.
fn sphere_near(
    body: &Candidate<'_>,
    pose: &Pose,
    other: &dyn Solid,
    at: &Pose,
    gap: f64,
    tight: bool,
) -> Option<bool> {
    let reach = body.outer + gap;
    let d = other.signed_distance(at.to_body(pose.position), reach);
    if d >= reach {
        Some(false)
    } else if !tight || d < body.inner + gap {
        Some(true)
    } else {
        None
    }
}
/// The same of two bodies, of each the spheres against the other.
fn spheres_near(a: &Candidate<'_>, at_a: &Pose, b: &Candidate<'_>, at_b: &Pose, gap: f64) -> Option<bool> {
    sphere_near(a, at_a, b.shape, at_b, gap, true).or_else(|| sphere_near(b, at_b, a.shape, at_a, gap, true))
}
/// Whether signed distances show that two bodies are `gap` apart.
fn separate(
    apart: &mut Apart,
    body: &Candidate<'_>,
    pose: &Pose,
    other: &dyn Solid,
    at: &Pose,
    gap: f64,
) -> bool {
    let half = 0.5 * gap;
    let (a, b) = (around(body.shape, pose, half), around(other, at, half));
    let shared = Aabb { min: a.min.sup(&b.min), max: a.max.inf(&b.max) };
    apart.nowhere_below(&shared, finest(body), |x, band| {
        let d = body.shape.signed_distance(pose.to_body(x), band + half);
        d.max(other.signed_distance(at.to_body(x), band + half)) - half
    })
}
/// Whether two bodies are nearer than `gap`.
fn touch(
    solver: &mut OverlapSolver,
    apart: &mut Apart,
    (a, at_a): (&Candidate<'_>, &Pose),
    (b, at_b): (&Candidate<'_>, &Pose),
    gap: f64,
) -> bool {
    let by_distance = |c: &Candidate<'_>| matches!(c.shape.form(), Form::Distance);
    if gap == 0.0
        && !(by_distance(a) || by_distance(b))
        && let Ok(patches) = solver.solve(a.shape, at_a, b.shape, at_b)
    {
        return !patches.is_empty();
    }
    !separate(apart, a, at_a, b.shape, at_b, gap)
}
