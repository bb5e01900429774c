//! Grains of all kinds and sizes.
use super::options::GrainOptions;
use crate::Outcome;
use clap::ValueEnum;
use dem::placing::{BodyRow, Orientations, SizeDistribution};
use dem::{ConvexPolyhedron, Cuboid, Ellipsoid, Shape, Sphere, TriangleMesh, TriangleSoup};
use interfaces::{Rotation, Vector};
use std::f64::consts::PI;
use std::sync::Arc;

/// What grains look like.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    /// Spheres.
    Sphere,
    /// Cubes.
    Cube,
    /// Irregular convex polyhedra of 26 vertices, twenty different ones.
    Polyhedron,
    /// Ellipsoids with axes 1 : 0.75 : 0.55.
    Ellipsoid,
    /// All of these in turn.
    Mixed,
}

/// A grain before it has a place.
#[derive(Clone)]
pub struct Grain {
    /// Its shape.
    pub shape: Arc<dyn Shape>,
    /// Diameter of a sphere of the same volume \[m\].
    pub size: f64,
    /// What it is, for tables.
    pub kind: &'static str,
}

/// Vertices of a polyhedron, and how many different ones there are.
const VERTICES: usize = 26;
const DIFFERENT: usize = 20;

impl Kind {
    /// The kind of this name.
    fn named(name: &str) -> Option<Self> {
        Self::from_str(name.trim(), true).ok()
    }
    /// Of one of its shapes.
    fn word(self) -> &'static str {
        match self {
            Self::Sphere => "sphere",
            Self::Cube => "cube",
            Self::Polyhedron => "polyhedron",
            Self::Ellipsoid => "ellipsoid",
            Self::Mixed => "mixed",
        }
    }
    /// What number `i` of a mixture is.
    fn of(self, i: usize) -> Self {
        const ALL: [Kind; 4] = [Kind::Sphere, Kind::Cube, Kind::Ellipsoid, Kind::Polyhedron];
        if self == Self::Mixed { ALL[i % 4] } else { self }
    }
    /// Grains of these sizes.
    ///
    /// # Errors
    /// For sizes that no shape has.
    pub fn grains(self, sizes: &[f64]) -> Outcome<Vec<Grain>> {
        let different = if self == Self::Mixed { 4 * DIFFERENT } else { DIFFERENT };
        let mut grains = shared(sizes, |i| i % different, "", |i, size| self.shape(i, size))?;
        grains.iter_mut().enumerate().for_each(|(i, g)| g.kind = self.of(i).word());
        Ok(grains)
    }
    fn shape(self, i: usize, size: f64) -> Outcome<Arc<dyn Shape>> {
        Ok(match self.of(i) {
            Self::Sphere | Self::Mixed => Arc::new(Sphere::new(0.5 * size)?),
            Self::Cube => Arc::new(Cuboid::new([size * (PI / 6.0).cbrt(); 3])?),
            Self::Ellipsoid => {
                let axes = [1.0, 0.75, 0.55];
                let scale = 0.5 * size / axes.iter().product::<f64>().cbrt();
                Arc::new(Ellipsoid::new(axes.map(|a| a * scale))?)
            }
            Self::Polyhedron => Arc::new(polyhedron(i % DIFFERENT, size)?),
        })
    }
}

/// Points on an ellipsoid along a spiral, moved about at random; their hull is brought to the volume of a sphere of diameter `size`.
fn polyhedron(number: usize, size: f64) -> Outcome<ConvexPolyhedron> {
    let turns: Vec<Rotation> = Orientations::Random.of(number as u64).take(VERTICES).collect();
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    let place = |i: usize| {
        let z = 1.0 - (2 * i + 1) as f64 / VERTICES as f64;
        let rho = (1.0 - z * z).sqrt();
        let (sin, cos) = (golden * i as f64).sin_cos();
        let moved = Vector::new(rho * cos, rho * sin, z) + 0.35 * (turns[i] * Vector::x());
        moved.normalize().component_mul(&Vector::new(1.0, 0.85, 0.72))
    };
    let scaled = |by: f64| (0..VERTICES).map(|i| (by * place(i)).into()).collect::<Vec<[f64; 3]>>();
    let volume = ConvexPolyhedron::from_points(&scaled(1.0))?.volume();
    Ok(ConvexPolyhedron::from_points(&scaled(size * (PI / 6.0 / volume).cbrt()))?)
}

impl GrainOptions {
    /// So many grains.
    ///
    /// # Errors
    /// For sizes and files that make none.
    pub fn grains(&self, number: usize) -> Outcome<Vec<Grain>> {
        if number == 0 {
            return Err("--number 0: give at least one".into());
        }
        let sizes = self.sizes(number)?;
        if let Some(path) = &self.stl {
            let file = |e| format!("{}: {e}", path.display());
            let soup = TriangleSoup::from_stl(path, 1.0).map_err(file)?;
            let volume = TriangleMesh::try_from(soup.clone()).map_err(file)?.volume();
            return shared(
                &sizes,
                |_| 0,
                "stl",
                |_, size| {
                    let unit = size * (PI / 6.0 / volume).cbrt();
                    Ok(Arc::new(TriangleMesh::from_stl(path, unit).map_err(file)?))
                },
            );
        }
        self.shape.grains(&sizes)
    }

    fn sizes(&self, number: usize) -> Outcome<Vec<f64>> {
        let d = self.diameter;
        let law = if self.spread == 1.0 {
            SizeDistribution::constant(d)?
        } else {
            SizeDistribution::log_normal(d, self.spread, [0.5 * d, 2.0 * d])?
        };
        Ok(law.sample(number, self.seed))
    }

    /// The grains of a table: its sizes (the diameter where there is none) and kinds (names of shapes; the shape where there is none).
    ///
    /// # Errors
    /// For a kind that is not known.
    pub fn grains_of(&self, rows: &[BodyRow]) -> Outcome<Vec<Grain>> {
        let one = |(i, row): (usize, &BodyRow)| -> Outcome<Grain> {
            let size = row.size.unwrap_or(self.diameter);
            let kind = match row.kind.as_str() {
                "" => self.shape,
                name => Kind::named(name).ok_or_else(|| {
                    format!(
                        "body {i} of the table is a \"{name}\"; give sphere, cube, polyhedron or ellipsoid"
                    )
                })?,
            };
            Ok(Grain { shape: kind.shape(i, size)?, size, kind: kind.of(i).word() })
        };
        rows.iter().enumerate().map(one).collect()
    }
}

/// Grains of the same size and number share their shape.
fn shared(
    sizes: &[f64],
    number: impl Fn(usize) -> usize,
    kind: &'static str,
    make: impl Fn(usize, f64) -> Outcome<Arc<dyn Shape>>,
) -> Outcome<Vec<Grain>> {
    let mut known: Vec<Option<(f64, Arc<dyn Shape>)>> = Vec::new();
    let one = |(i, &size): (usize, &f64)| {
        let at = number(i);
        if known.len() <= at {
            known.resize(at + 1, None);
        }
        let shape = match &known[at] {
            Some((s, shape)) if *s == size => shape.clone(),
            _ => make(i, size)?,
        };
        known[at] = Some((size, shape.clone()));
        Ok(Grain { shape, size, kind })
    };
    sizes.iter().enumerate().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Cli {
        #[command(flatten)]
        grains: GrainOptions,
    }

    /// Whatever the shape, a grain is as large as a sphere of its size.
    #[test]
    fn sizes_are_by_volume() {
        for spread in ["1", "1.3"] {
            let cli = Cli::parse_from(["", "--shape", "mixed", "--diameter", "0.01", "--spread", spread]);
            let grains = cli.grains.grains(100).unwrap();
            for g in &grains {
                let volume = g.shape.inertia(1.0).volume;
                assert!((volume / (PI / 6.0 * g.size.powi(3)) - 1.0).abs() < 1e-9, "{}", g.kind);
            }
            assert_eq!(grains.iter().all(|g| g.size == 0.01), spread == "1");
        }
    }

    #[test]
    fn bad_flags_are_told() {
        let grains = |args: &[&str]| Cli::parse_from([&[""], args].concat()).grains;
        assert!(grains(&[]).grains(0).is_err());
        assert!(grains(&["--diameter", "-1"]).grains(1).is_err());
        assert!(grains(&["--spread", "0.5"]).grains(1).is_err());
        assert!(grains(&["--density", "nan"]).material().is_err());
        assert!(grains(&["--stl", "/no/such.stl"]).grains(1).is_err());
        let error = grains(&["--friction", "0.5", "--wall-friction", "0.2"]).wall().unwrap_err();
        assert!(error.to_string().contains("at least 0.25"), "{error}");
        let pair = grains(&["--friction", "0.5", "--wall-friction", "0.8"]);
        assert_eq!(0.5 * (pair.wall().unwrap().friction + pair.material().unwrap().friction), 0.8);
    }
}
