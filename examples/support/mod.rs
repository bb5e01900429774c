//! What the examples share and what is no part of the library: pictures, progress, tables, time and memory
//! of the process, and the start-up theory the runs are held against. Plain numbers in, files and text out.

// Each example takes what it needs. Tests import what they test one by one: a bench without harness has the test modules but
// not the tests in them.
#![allow(dead_code)]

pub(crate) mod cpu;
pub(crate) mod picture;
pub(crate) mod progress;
pub(crate) mod startup_theory;
pub(crate) mod table;
