//! The contact of two spheres: figure 7 of Isoz et al. (2023), from what the library computes.
//!
//! Two elastic spheres, d_p = 0.02 m (the paper does not say), start 1.5 d_p apart; one moves at 1 m/s towards the other, which is
//! free. |f_c| = Y V/L_c (equation 4 without damping), the overlap V by a formula, by the adaptive tree (VM) and on the cells of a
//! flow mesh of 20 per d_p, refined near both (AMR). The time loop is the same for all: velocity Verlet, and in every step both
//! spheres come into the flow mesh anew, as the paper's solver has them do.
//!
//! Sample run: `cargo run --release --example contact_of_spheres`, a minute or so; all goes to `out/contact_of_spheres`, or
//! where `--out FOLDER` says.
mod contact;
mod report;

use contact::{Contact, Way};
use example_support::files::make_folder;
use example_support::{Outcome, told};
use std::path::PathBuf;
use std::process::ExitCode;

fn main() -> ExitCode {
    told(run())
}

fn run() -> Outcome<()> {
    let out = folder()?;
    make_folder(&out)?;
    let mut runs = Vec::new();
    for way in
        [Way::Formula, Way::Tolerance].into_iter().chain((1..=6).map(Way::Tree)).chain((0..=3).map(Way::Mesh))
    {
        runs.push(Contact::run(way)?);
    }
    report::write(&out, &runs)
}

fn folder() -> Outcome<PathBuf> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    match args.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => Ok("out/contact_of_spheres".into()),
        ["--out", folder] => Ok(folder.into()),
        _ => Err(format!("{args:?}: give nothing or --out FOLDER").into()),
    }
}
