//! Pictures of the fields.
use super::derivatives::slope;
use super::{Solids, Table, Taken, Watch, output};
use crate::setup::{Algorithm, Images, Quantity, Setup};
use crate::view::View;
use coupling::{CouplingError, StepInfo};
use interfaces::{BodyId, Checkpoint, Pose, RestartError};
use render::section::{BodySection, Layer, Section, Sheet};
use std::path::{Path, PathBuf};

/// Table of the pictures.
const INDEX: &str = "images.csv";

/// Draws `images/NNNNN.png` at snapshots.
pub(crate) struct ImagesWatch {
    folder: PathBuf,
    title: String,
    steady: bool,
    images: Images,
    /// Is there no fluid?
    alone: bool,
    sheet: Sheet,
    /// Times of the pictures \[s\]; of steady flow iterations.
    index: Table,
    /// The cells that are shown, and all of the slice.
    cells: [Vec<usize>; 2],
    fields: [Vec<f64>; 3],
    values: Vec<f64>,
    solid: Vec<f64>,
}

impl ImagesWatch {
    pub(crate) fn new(
        folder: &Path,
        setup: &Setup,
        images: Images,
        resume: Option<f64>,
    ) -> Result<Self, CouplingError> {
        let index = folder.join(INDEX);
        let header = "# time s (steady flow: iterations); picture in images/\ntime,picture";
        // At time 0 the first picture is made again; states of versions without this table can be resumed.
        let resume = resume.filter(|time| *time > 0.0 && index.exists());
        let index = Table::open(&index, header, resume)?;
        let folder = folder.join("images");
        std::fs::create_dir_all(&folder).map_err(output("making", &folder))?;
        Ok(Self {
            folder,
            title: setup.title.clone(),
            steady: setup.flow.algorithm == Algorithm::Simple,
            images,
            alone: setup.fluid.is_none(),
            sheet: Sheet::default(),
            index,
            cells: Default::default(),
            fields: Default::default(),
            values: vec![],
            solid: vec![],
        })
    }

    /// Vorticity of the plane at the cells, from central differences of the centred velocity.
    fn vorticity(view: &dyn View, [a, b]: [usize; 2], u: &[f64], v: &[f64]) -> Vec<f64> {
        let (x, y) = (view.axis(a), view.axis(b));
        let (nx, ny) = (x.cells(), y.cells());
        let mut out = Vec::with_capacity(nx * ny);
        for j in 0..ny {
            for i in 0..nx {
                let dv = slope(x, i, nx, view.periodic(a), &|i| v[j * nx + i]);
                let du = slope(y, j, ny, view.periodic(b), &|j| u[j * nx + i]);
                out.push(dv - du);
            }
        }
        out
    }
}

/// The numbers of the cells of the slice that is drawn, across fastest.
pub(super) fn slice_of(view: &dyn View, images: &Images) -> Vec<usize> {
    let n: [usize; 3] = [0, 1, 2].map(|a| if a < view.dim() { view.axis(a).cells() } else { 1 });
    let [a, b] = images.axes;
    let stride = [1, n[0], n[0] * n[1]];
    let first = images.slice.map_or(0, |(normal, layer)| layer * stride[normal]);
    let mut cells = Vec::with_capacity(n[a] * n[b]);
    (0..n[b]).for_each(|j| cells.extend((0..n[a]).map(|i| first + i * stride[a] + j * stride[b])));
    cells
}

/// The part of it that is shown.
pub(super) fn section_of<'a>(view: &'a dyn View, images: &Images) -> Section<'a> {
    let faces = |i: usize| {
        let (axis, cells) = (view.axis(images.axes[i]), &images.region[i]);
        &axis.faces()[cells.start..=cells.end]
    };
    Section { across: faces(0), up: faces(1), names: images.axes.map(|a| ["x", "y", "z"][a]) }
}

/// The bodies, and their periodic images, that reach the plane of the slice.
fn bodies_in<'a>(view: &'a dyn View, images: &Images) -> Vec<BodySection<'a>> {
    let (bodies, dim) = (view.bodies(), view.dim());
    let mut plane = [0.0; 3];
    if let Some((normal, layer)) = images.slice {
        plane[normal] = view.axis(normal).centre(layer);
    }
    // The box on each axis: along the normal it is the plane alone.
    let room = |a: usize| match images.slice {
        Some((normal, _)) if normal == a => [plane[a]; 2],
        _ => [view.axis(a).lower(), view.axis(a).upper()],
    };
    let mut out = Vec::new();
    for b in (0..bodies.n_bodies()).map(BodyId) {
        let (solid, mut pose) = (bodies.solid(b), bodies.pose(b));
        let repeats = |a: usize| a < dim && view.periodic(a);
        let length = |a: usize| view.axis(a).length();
        for a in (0..dim).filter(|&a| repeats(a)) {
            let lower = view.axis(a).lower();
            pose.position[a] = lower + (pose.position[a] - lower).rem_euclid(length(a));
        }
        let bounds = solid.aabb().posed(&pose);
        let shifts = |a: usize| -> Vec<f64> {
            if a >= dim {
                return vec![0.0];
            }
            let [low, high] = room(a);
            let images: &[f64] = if repeats(a) { &[-1.0, 0.0, 1.0] } else { &[0.0] };
            let shifted = images.iter().map(|image| image * length(a));
            shifted.filter(|d| bounds.min[a] + d <= high && bounds.max[a] + d >= low).collect()
        };
        let [xs, ys, zs] = [0, 1, 2].map(shifts);
        for (&x, &y) in xs.iter().flat_map(|x| ys.iter().map(move |y| (x, y))) {
            let place = |&z: &f64| Pose {
                position: pose.position + interfaces::Vector::new(x, y, z),
                orientation: pose.orientation,
            };
            let section = |pose| BodySection { solid, pose, axes: images.axes, plane };
            out.extend(zs.iter().map(place).map(section));
        }
    }
    out
}

impl Checkpoint for ImagesWatch {
    fn save(&self, _: &mut dyn FnMut(&str, &[f64])) {}
    fn restore<'a>(&mut self, _: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        Ok(())
    }
}

impl Watch for ImagesWatch {
    fn name(&self) -> &'static str {
        "images"
    }
    fn tables(&self) -> Vec<String> {
        vec![INDEX.into()]
    }
    fn takes_lambda(&self, index: usize) -> Taken {
        match self.images.slice {
            _ if !index.is_multiple_of(self.images.every) => Taken::None,
            Some((axis, number)) => Taken::Layer(axis, number),
            None => Taken::All,
        }
    }
    fn flush(&mut self) -> Result<(), CouplingError> {
        self.index.flush()
    }
    fn snapshot(
        &mut self,
        view: &mut dyn View,
        solids: &Solids,
        index: usize,
        info: &StepInfo,
    ) -> Result<(), CouplingError> {
        if !index.is_multiple_of(self.images.every) {
            return Ok(());
        }
        let ([a, b], dim) = (self.images.axes, view.dim());
        let across = view.axis(a).cells();
        if self.cells[0].is_empty() {
            let slice = slice_of(view, &self.images);
            self.cells = [self.images.part(&slice, across), slice];
        }
        let [cells, slice] = &self.cells;
        let of = |field: &[f64], cells: &[usize]| -> Vec<f64> { cells.iter().map(|&c| field[c]).collect() };
        let quantity = &self.images.quantity;
        if !matches!(quantity, Quantity::Field(_) | Quantity::Pressure) {
            view.shown(solids, &mut self.fields[..dim]);
        }
        let mut unit = String::new();
        self.values = match quantity {
            Quantity::Field(name) => {
                if let Some(other) = view.others().into_iter().find(|o| o.name == name) {
                    self.fields[0].clear();
                    self.fields[0].extend(other.values);
                    unit = other.unit.into();
                }
                of(&self.fields[0], cells)
            }
            Quantity::Speed => {
                let squares = |c: usize| self.fields[..dim].iter().map(|u| u[c] * u[c]).sum::<f64>();
                cells.iter().map(|&c| squares(c).sqrt()).collect()
            }
            Quantity::Component(c) => of(&self.fields[*c], cells),
            Quantity::Pressure => {
                view.pressure(&mut self.fields[0]);
                of(&self.fields[0], cells)
            }
            Quantity::Vorticity => {
                let [u, v] = [a, b].map(|a| of(&self.fields[a], slice));
                self.images.part(&Self::vorticity(view, [a, b], &u, &v), across)
            }
        };
        self.solid = of(&solids.lambda, cells);
        let signed = match quantity {
            Quantity::Speed => false,
            Quantity::Field(_) => self.values.iter().any(|v| *v < 0.0),
            _ => true,
        };
        let limits =
            self.images.limits.unwrap_or_else(|| limits(&self.values, &self.solid, signed, self.alone));
        let of_field;
        let label = match quantity {
            Quantity::Field(name) => {
                of_field =
                    format!("{} in {}", name.replace('_', " "), if unit.is_empty() { "1" } else { &unit });
                of_field.as_str()
            }
            Quantity::Speed => "speed |u| in m/s",
            Quantity::Component(0) => "u in m/s",
            Quantity::Component(1) => "v in m/s",
            Quantity::Component(_) => "w in m/s",
            Quantity::Pressure => "pressure in Pa",
            Quantity::Vorticity => "vorticity in 1/s",
        };
        let section = section_of(view, &self.images);
        let sections = bodies_in(view, &self.images);
        let layer = Layer {
            values: &self.values,
            solid: None,
            bodies: &sections,
            solids_alone: self.alone,
            limits,
            label,
            signed,
        };
        let path = self.folder.join(format!("{index:05}.png"));
        let state = match self.steady {
            true => format!("after {} iterations", info.step),
            false => format!("t = {:.4} s", info.time),
        };
        section
            .draw(&mut self.sheet, &path, &layer, [&self.title, &state])
            .map_err(output("drawing", &path))?;
        let time = if self.steady { info.step as f64 } else { info.time };
        self.index.row(time, Some(&format!("{index:05}.png")), [])
    }
}

/// From 0 or symmetric about it, to the largest value in the fluid, or in the solids where there is none.
fn limits(values: &[f64], solid: &[f64], signed: bool, alone: bool) -> [f64; 2] {
    let counts = |(v, s): &(&f64, &f64)| (**s < 0.5) != alone && v.is_finite();
    let most = values.iter().zip(solid).filter(counts).map(|(v, _)| v.abs()).fold(0.0, f64::max);
    let most = if most > 0.0 { most } else { 1.0 };
    [if signed { -most } else { 0.0 }, most]
}
