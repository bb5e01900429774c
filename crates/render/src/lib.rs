//! What a run shows: pictures of fields and bodies as PNG files, plots, charts (SVG), the progress line of the terminal, time and memory of the
//! process.
//!
//! Bodies are known by [`interfaces::Solid`] alone.
#![doc(html_root_url = "https://docs.rs/siltflow-render/latest")]

mod axes;
mod canvas;
pub mod chart;
mod chart_scale;
mod colour;
pub mod cpu;
pub mod files;
pub mod gallery;
mod outlines;
pub mod plot;
pub mod profiles;
pub mod progress;
mod scalar;
pub mod section;
pub mod sketch;
pub mod solids;
mod text;

pub use interfaces::{Aabb, Point, Polyhedron, Pose, Solid, SurfaceElement, Vector};
pub use nalgebra;
pub use scalar::Scalar;

/// The program of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
