//! The flags.
use clap::{Parser, ValueEnum};
use std::path::PathBuf;

/// Two discs of different weight fall through a fluid, draft, nearly kiss and tumble.
#[derive(Clone, Debug, Parser)]
#[command(version)]
pub(crate) struct Cli {
    /// End time [s]; 0.6, or 1.2 with --floor.
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) end: Option<f64>,
    /// Cells across a disc, at least 4.
    #[arg(long, default_value_t = 15)]
    pub(crate) cells_per_diameter: usize,
    /// Snapshots, evenly spaced from 0 to the end, both included.
    #[arg(long, default_value_t = 601)]
    pub(crate) snapshots: usize,
    /// How many discs: 1, 2 or more (further ones stand in rows below).
    #[arg(long, default_value_t = 2)]
    pub(crate) bodies: usize,
    /// Densities of the discs [kg/m³], separated by commas, repeated as needed.
    #[arg(long, value_delimiter = ',', default_values_t = [1060.0, 1030.0], allow_negative_numbers = true)]
    pub(crate) densities: Vec<f64>,
    /// Diameter of the discs [m]; the box is 0.01 m × 0.02 m whatever it is.
    #[arg(long, default_value_t = 1e-3, allow_negative_numbers = true)]
    pub(crate) diameter: f64,
    /// Walls below and above instead of a periodic box: the discs land.
    #[arg(long)]
    pub(crate) floor: bool,
    /// Time step [s] after the ramp of the first steps; without it the largest stable one.
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) dt: Option<f64>,
    /// How the fluid is made to follow the discs.
    #[arg(long, value_enum, default_value_t = ForcingChoice::Smooth)]
    pub(crate) forcing: ForcingChoice,
    /// What holds up the discs' net weight in the periodic box.
    #[arg(long, value_enum, default_value_t = BalanceChoice::NetWeight)]
    pub(crate) balance: BalanceChoice,
    /// Threads, 1 to 256; the numbers do not depend on it.
    #[arg(long, default_value_t = 1)]
    pub(crate) threads: usize,
    /// Folder for everything that is written.
    #[arg(long, default_value = "out/falling_discs")]
    pub(crate) out: PathBuf,
    /// Write no PNG files: neither frames (one in ten snapshots) nor the summary figure.
    #[arg(long)]
    pub(crate) no_images: bool,
    /// Go on from the state that an interrupted run of the same scene left in the folder.
    #[arg(long)]
    pub(crate) resume: bool,
}

/// How the fluid is made to follow the discs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ForcingChoice {
    /// Surface markers with a smooth kernel: no noise as the discs move through the grid.
    Smooth,
    /// The paper's: λ, surface cells, quadratic reconstruction.
    Hfdib,
}

/// What holds up the discs' net weight in the periodic box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum BalanceChoice {
    /// The uniform body force −Σ(ρ_s−ρ_f)Vg/V_Ω.
    NetWeight,
    /// The uniform body force that keeps ∫u dV at zero exactly.
    ZeroFlow,
    /// Nothing: fluid and discs fall together, ever faster.
    None,
}
