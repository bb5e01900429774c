//! Scenes of flow and bodies from TOML files.
//!
//! A scene is read with every value's place kept, checked against one schema (unknown keys, kinds, ranges, formulas: all problems at once, each with its line), put
//! together from the libraries, and run with progress, pictures, files and saved states. Types are chosen once, before the time loop.
//!
//! ```
//! use scene::Scene;
//!
//! let text = r#"
//!     [grid]
//!     cells = [16, 16]
//!     size = [1.0, 1.0]
//!     [sides]
//!     x = "wall"
//!     y_min = "wall"
//!     y_max = { type = "wall", velocity = [1.0, 0.0] }
//!     [fluid]
//!     density = 1.0
//!     nu = 0.01
//!     [time]
//!     end = 1.0
//! "#;
//! let cavity = Scene::parse("cavity.toml", text, &["fluid.nu=0.02".into()])?;
//! let plan = cavity.plan()?;
//! assert_eq!(plan.cells, [16, 16]);
//!
//! let problems = Scene::parse("cavity.toml", &text.replace("nu =", "nue ="), &[]).err().unwrap();
//! assert!(problems.to_string().contains("did you mean \"nu\""));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![doc(html_root_url = "https://docs.rs/siltflow-scene/latest")]
#![deny(missing_docs)]

mod any_simulation;
mod assembly;
mod available_memory;
mod build;
mod build_error;
mod cast;
mod deepest;
mod document;
mod dry;
mod estimate;
mod expression;
mod folder_lock;
mod history;
mod identity;
mod log;
mod look;
mod options;
mod pace;
mod page;
mod peak_memory;
mod physics;
mod pile;
mod plan;
mod problem;
mod reader;
mod record;
mod rehearsal;
mod result;
mod run;
mod sanity;
mod schema;
mod setup;
mod stand_in;
mod start_field;
mod steady;
mod still;
mod stop;
mod summary;
mod time_table;
mod trial;
mod view;
mod wall_iterations;
mod watch;

pub use build_error::{BuildError, PathProblem};
pub use coupling;
pub use dem;
pub use fv_mesh;
pub use ibm;
pub use options::Options;
pub use plan::Plan;
pub use problem::Problems;
pub use result::{Compared, Ending, RunResult};
pub use run::RunError;
pub use schema::{json_schema, manual};
pub use summary::{TABLE_HEAD, empty_row};
pub use turb;

/// The program of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

use document::Document;
use identity::Identity;
use record::Record;
use setup::Setup;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// A scene, read and checked.
pub struct Scene {
    document: Document,
    setup: Setup,
    identity: Identity,
}

/// Why a scene could not be read.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file.
    #[error("{path}: {source}; give the path of a scene file, scenes/cavity.toml for instance")]
    Io {
        /// Its path.
        path: String,
        /// Why.
        source: std::io::Error,
    },
    /// What is in it.
    #[error(transparent)]
    Problems(#[from] Problems),
}

impl Scene {
    /// Reads the file at `path`, with the values that `overrides` set (`fluid.nu=2e-6`).
    ///
    /// # Errors
    /// [`SceneError`] with all that is wrong.
    pub fn load(path: &Path, overrides: &[String]) -> Result<Self, SceneError> {
        let name = path.display().to_string();
        let text =
            std::fs::read_to_string(path).map_err(|source| SceneError::Io { path: name.clone(), source })?;
        Ok(Self::parse(&name, &text, overrides)?)
    }

    /// The scene in `text`, as if it stood in a file called `name`: paths in it begin in that file's folder.
    ///
    /// # Errors
    /// [`Problems`]: all that is wrong.
    pub fn parse(name: &str, text: &str, overrides: &[String]) -> Result<Self, Problems> {
        let document = Document::parse(name, text, overrides)?;
        let setup = Setup::new(&document, Path::new(name))?;
        let folder = Path::new(name).parent().unwrap_or(Path::new(""));
        let identity = Identity::new(&document, &setup.files, folder)
            .map_err(|problem| document.problems(vec![problem]))?;
        Ok(Self { document, setup, identity })
    }

    /// What running it would mean. Puts it together, which finds what only the libraries know to be wrong.
    ///
    /// # Errors
    /// [`BuildError`] if it cannot be put together.
    pub fn plan(&self) -> Result<Plan, BuildError> {
        self.planned(true)
    }

    /// Plan, with the cost of `files` or without.
    fn planned(&self, files: bool) -> Result<Plan, BuildError> {
        self.setup.try_formulas();
        let plan = self.setup.plan(files);
        match self.unset_formula() {
            Some(problems) => Err(BuildError::Scene(Box::new(problems))),
            None => plan.map_err(|error| error.placed(&self.setup, &self.document)),
        }
    }

    /// Title, or the name of the file.
    pub fn title(&self) -> &str {
        &self.setup.title
    }

    /// References of the scene beside the numbers of `result`, which is the object in a
    /// `result.json`, or null before a run.
    pub fn compare(&self, result: &serde_json::Value) -> Vec<Compared> {
        self.setup.compare(result)
    }

    /// Runs it until its end, or until `stop` is set.
    ///
    /// # Errors
    /// [`RunError`]; states saved before it are whole.
    pub fn run(&self, options: &Options, stop: &AtomicBool) -> Result<RunResult, RunError> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(options.threads).build()?;
        // First steps and run on the same threads: the run uses their memory again.
        pool.install(|| {
            let plan = self.planned(false)?;
            let record = Record { document: &self.document, plan: &plan };
            let ran = self.setup.run(options, &self.identity, record, stop);
            self.setup.with_report(ran, options).map_err(|error| self.placed(error))
        })
    }

    /// The error with the key and the place in the file that it is about.
    fn placed(&self, error: RunError) -> RunError {
        if let Some(problems) = self.unset_formula() {
            return BuildError::Scene(Box::new(problems)).into();
        }
        let placed = |error: BuildError| error.placed(&self.setup, &self.document);
        match error {
            RunError::Build(error) => placed(error).into(),
            // What no key has to do with stays as it is.
            RunError::Coupling(error) => match placed(error.into()) {
                BuildError::Coupling(error) => error.into(),
                BuildError::Scene(problems) => RunError::Step(problems),
                told => told.into(),
            },
            error => error,
        }
    }

    /// The first formula that was needed where it has no finite value, with its place.
    fn unset_formula(&self) -> Option<Problems> {
        let problem = self.setup.formulas.iter().find_map(reader::Formula::problem)?;
        Some(self.document.problems(vec![problem]))
    }
}
