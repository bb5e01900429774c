//! `siltflow check`.
use crate::outcome::{Failure, print};
use crate::shipped::Shipped;
use clap::Args;
use scene::{Plan, Scene};
use serde_json::Value;

#[derive(Args)]
pub(crate) struct CheckArgs {
    /// Scene files, or names of scenes that come with the command (`siltflow list`).
    #[arg(required = true)]
    scenes: Vec<String>,
    /// Sets a value, whatever the file says: --set fluid.nu=2e-6, --set bodies.0.density=1100.
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Prints JSON: a list with an object for each scene, SI units.
    #[arg(long)]
    json: bool,
}

impl CheckArgs {
    /// Checks the scenes, all of them even if one is wrong; returns the exit code.
    pub(crate) fn check(&self) -> Result<u8, Failure> {
        let shipped = Shipped::default();
        let (mut plans, mut worst) = (Vec::new(), 0);
        for scene in &self.scenes {
            match self.plan(&shipped, scene) {
                Ok(plan) if self.json => plans.push(plan.to_json()),
                Ok(plan) => print(&plan.to_string())?,
                Err(failure) => worst = worst.max(failure.report()),
            }
        }
        if self.json {
            print(&format!("{:#}\n", Value::from(plans)))?;
        }
        Ok(worst)
    }

    fn plan(&self, shipped: &Shipped, scene: &str) -> Result<Plan, Failure> {
        let scene = Scene::load(&shipped.path(scene)?, &self.set).map_err(Failure::of_input)?;
        scene.plan().map_err(Failure::of_input)
    }
}
