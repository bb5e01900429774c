//! Flags that the examples share.
use super::grains::Kind;
use super::law::Ways;
use crate::Outcome;
use clap::Args;
use dem::Material;
use std::path::PathBuf;

/// What the grains are.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Grains")]
pub struct GrainOptions {
    /// Shape of the grains.
    #[arg(long, value_enum, default_value_t = Kind::Sphere)]
    pub shape: Kind,
    /// A closed triangle mesh instead (STL); it is scaled to the diameter.
    #[arg(long, value_name = "FILE", conflicts_with = "shape")]
    pub stl: Option<PathBuf>,
    /// Diameter of a sphere of the same volume, in m; the median, if sizes differ.
    #[arg(long, default_value_t = 6e-3, allow_negative_numbers = true)]
    pub diameter: f64,
    /// Geometric standard deviation of the sizes (log-normal, cut off at a half and at twice the diameter); 1: all alike.
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    pub spread: f64,
    /// Density in kg/m³.
    #[arg(long, default_value_t = 2500.0, allow_negative_numbers = true)]
    pub density: f64,
    /// Young's modulus in Pa. Steps get shorter with its root; a soft one makes grains sink into one another (column `overlap`).
    #[arg(long, default_value_t = 1e7, allow_negative_numbers = true)]
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    #[arg(long, default_value_t = 0.3, allow_negative_numbers = true)]
    pub poisson_ratio: f64,
    /// Coefficient of friction.
    #[arg(long, default_value_t = 0.5, allow_negative_numbers = true)]
    pub friction: f64,
    /// Coefficient of friction at walls; that of the grains unless told.
    #[arg(long, allow_negative_numbers = true)]
    pub wall_friction: Option<f64>,
    /// Coefficient of rolling friction.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    pub rolling_friction: f64,
    /// Coefficient of restitution (law `potential`).
    #[arg(long, default_value_t = 0.5, allow_negative_numbers = true)]
    pub restitution: f64,
    /// Damping coefficient (law `chen`); flat faces need little, and a large one makes steps short.
    #[arg(long, default_value_t = 0.5, allow_negative_numbers = true)]
    pub damping: f64,
    /// Contact law; without it `potential` for spheres and ellipsoids, `chen` for others.
    #[arg(long, value_enum)]
    pub law: Option<Ways>,
    /// Seed of all that is drawn at random.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

impl GrainOptions {
    /// What grains are made of.
    ///
    /// # Errors
    /// For properties that are not physical.
    pub fn material(&self) -> Outcome<Material> {
        let material = Material {
            density: self.density,
            youngs_modulus: self.youngs_modulus,
            poisson_ratio: self.poisson_ratio,
            damping: self.damping,
            restitution: self.restitution,
            friction: self.friction,
            rolling_friction: self.rolling_friction,
        };
        material.check()?;
        Ok(material)
    }
    /// What walls are made of. The friction of a pair is the mean of both: a wall's is such that the mean is what was asked for.
    ///
    /// # Errors
    /// For a friction that no such mean has.
    pub fn wall(&self) -> Outcome<Material> {
        let wanted = self.wall_friction.unwrap_or(self.friction);
        let friction = 2.0 * wanted - self.friction;
        if !(friction >= 0.0 && friction.is_finite()) {
            let least = 0.5 * self.friction;
            return Err(format!(
                "--wall-friction {wanted} with --friction {}: the friction of two is the mean of theirs; give at least {least}",
                self.friction
            )
            .into());
        }
        Ok(Material { friction, ..self.material()? })
    }
    /// The contact law.
    pub fn law(&self) -> Ways {
        let round = self.stl.is_none() && matches!(self.shape, Kind::Sphere | Kind::Ellipsoid);
        self.law.unwrap_or(if round { Ways::Potential } else { Ways::Chen })
    }
}

/// How long to run, and what to write.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Run and files")]
pub struct RunOptions {
    /// End time in s.
    #[arg(long, allow_negative_numbers = true)]
    pub end: Option<f64>,
    /// Rows of motion.csv, evenly spaced from 0 to the end, besides the first.
    #[arg(long, default_value_t = 200)]
    pub rows: usize,
    /// Pictures and .vtp files from 0 to the end, besides the first; rows are a multiple of them, or more are written.
    #[arg(long, default_value_t = 20)]
    pub frames: usize,
    /// Folder for everything that is written.
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Write no pictures.
    #[arg(long)]
    pub no_images: bool,
    /// Write no files for ParaView.
    #[arg(long)]
    pub no_vtk: bool,
    /// Go on from the state that an interrupted run of the same scene left in the folder.
    #[arg(long)]
    pub resume: bool,
    /// Threads, 1 to 256; the numbers do not depend on it.
    #[arg(long, default_value_t = 1)]
    pub threads: usize,
}

impl RunOptions {
    /// Is it a run at all?
    ///
    /// # Errors
    /// For numbers that make none.
    pub fn check(&self, end: f64) -> Outcome<()> {
        if !(end.is_finite() && end > 0.0) {
            return Err(format!("--end {end}: give a positive, finite time in seconds").into());
        }
        if self.rows == 0 || self.frames == 0 {
            return Err("--rows and --frames: give at least 1".into());
        }
        if !(1..=256).contains(&self.threads) {
            return Err(format!("--threads {}: give 1 to 256", self.threads).into());
        }
        Ok(())
    }
}
