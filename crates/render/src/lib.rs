//! What a run shows: pictures of fields and bodies as PNG files, plots, charts (SVG), the progress line of the terminal, time and memory of the
//! process.
//!
//! Bodies are known by [`interfaces::Solid`] alone. Lengths in metres and speeds in m/s come in; axes of [`Frames`] show millimetres and mm/s.
#![doc(html_root_url = "https://docs.rs/siltflow-render/latest")]

mod axes;
mod canvas;
pub mod chart;
mod chart_scale;
mod colour;
pub mod comparison;
pub mod cpu;
pub mod files;
mod frames;
pub mod gallery;
mod outlines;
pub mod plot;
pub mod profiles;
pub mod progress;
pub mod section;
pub mod sketch;
pub mod solids;
pub mod summary;
mod text;

pub use frames::{Disc, Domain, Frames, Scalar};
pub use interfaces::{Aabb, Point, Polyhedron, Pose, Solid, SurfaceElement, Vector};
pub use nalgebra;

/// The program of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
