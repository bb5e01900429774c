//! Files of all kinds and what becomes of them.
mod bodies;
mod texts;

use crate::solids::{Facet, cube};
use crate::writers::stl;

#[derive(Clone, Copy)]
pub(crate) enum Format {
    Stl,
    Obj,
}

/// A file and what becomes of it: the volume \[m³\] of a body, or part of the error's text.
#[derive(Clone)]
pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) format: Format,
    pub(crate) bytes: Vec<u8>,
    pub(crate) unit: f64,
    pub(crate) weld: Option<f64>,
    /// Relative tolerance of the volume.
    pub(crate) tolerance: f64,
    pub(crate) given: Result<f64, &'static str>,
    /// With everything that is repaired.
    pub(crate) repaired: Result<(f64, &'static str), &'static str>,
}

impl Case {
    fn new(name: &'static str, format: Format, bytes: Vec<u8>) -> Self {
        let (given, repaired) = (Ok(1.0), Ok((1.0, "")));
        Self { name, format, bytes, unit: 1.0, weld: None, tolerance: 1e-12, given, repaired }
    }
    fn stl(name: &'static str, bytes: impl Into<Vec<u8>>) -> Self {
        Self::new(name, Format::Stl, bytes.into())
    }
    fn obj(name: &'static str, bytes: impl Into<Vec<u8>>) -> Self {
        Self::new(name, Format::Obj, bytes.into())
    }
    fn facets(name: &'static str, facets: Vec<Facet>) -> Self {
        Self::stl(name, stl(&facets))
    }
    /// A body of this volume, as it is.
    fn of(self, volume: f64) -> Self {
        Self { given: Ok(volume), repaired: Ok((volume, "")), ..self }
    }
    fn in_units_of(self, unit: f64) -> Self {
        Self { unit, ..self }
    }
    fn welded(self, tolerance: f64) -> Self {
        Self { weld: Some(tolerance), ..self }
    }
    /// No body for this reason, unless repaired: then of this volume, by these changes.
    fn mended(self, given: &'static str, volume: f64, changes: &'static str) -> Self {
        Self { given: Err(given), repaired: Ok((volume, changes)), ..self }
    }
    /// No body, repaired or not.
    fn refused(self, given: &'static str, repaired: &'static str) -> Self {
        Self { given: Err(given), repaired: Err(repaired), ..self }
    }
    /// A body as it is, whose facets repair changes all the same.
    fn flipped(self, volume: f64, changes: &'static str) -> Self {
        Self { given: Ok(volume), repaired: Ok((volume, changes)), ..self }
    }
    /// Volumes within this share.
    fn within(self, tolerance: f64) -> Self {
        Self { tolerance, ..self }
    }
    /// A body as it is, but not with this tolerance.
    fn refused_repaired(self, repaired: &'static str) -> Self {
        Self { repaired: Err(repaired), ..self }
    }
    /// No file of this format.
    fn unread(self, error: &'static str) -> Self {
        self.refused(error, error)
    }
}

/// All of them.
pub(crate) fn all() -> Vec<Case> {
    [texts::all(), bodies::all()].concat()
}

/// A cube with edges of 1.
fn unit() -> Vec<Facet> {
    cube([0.0; 3], 1.0)
}
