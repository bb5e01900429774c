//! Surfaces of the shapes of bodies, each made once.
use super::polygon_surface::ScaledSurface;
use crate::Shape;
use std::collections::HashMap;
use std::sync::Arc;

/// Surfaces of shapes, by the address of the shape.
#[derive(Default)]
pub(super) struct ShapeSurfaces(HashMap<usize, ShapeSurface>);

pub(super) struct ShapeSurface {
    /// Holds the address.
    _shape: Arc<dyn Shape>,
    pub(super) surface: ScaledSurface,
    /// Number of its file, if it has one.
    pub(super) number: Option<usize>,
}

impl ShapeSurfaces {
    /// Drops the surfaces of other shapes than these, and makes those that are missing.
    pub(super) fn update<'a>(&mut self, shapes: impl Iterator<Item = &'a Arc<dyn Shape>>) {
        let mut last = std::mem::take(&mut self.0);
        for shape in shapes {
            if let Some(known) = last.remove(&address(shape)) {
                self.0.insert(address(shape), known);
            }
            self.entry(shape);
        }
    }

    /// PolygonSurface of a shape, one of those of the last update.
    pub(super) fn of(&self, shape: &Arc<dyn Shape>) -> &ScaledSurface {
        &self.0[&address(shape)].surface
    }

    /// PolygonSurface of a shape, made if it is missing.
    pub(super) fn entry(&mut self, shape: &Arc<dyn Shape>) -> &mut ShapeSurface {
        self.0.entry(address(shape)).or_insert_with(|| ShapeSurface {
            _shape: shape.clone(),
            surface: ScaledSurface::of(&**shape),
            number: None,
        })
    }
}

fn address(shape: &Arc<dyn Shape>) -> usize {
    Arc::as_ptr(shape).cast::<()>().addr()
}
