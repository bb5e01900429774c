//! Pictures of bodies of any shape in space, seen along parallel rays.
//!
//! Every ray finds the nearest surface (a depth buffer at twice the picture's resolution); light comes from a lamp above the left shoulder,
//! which casts shadows (a second depth buffer, seen from the lamp), and from all around, less in crevices (Mittring 2007, "Finding next
//! gen: CryEngine 2", SIGGRAPH courses: screen-space ambient occlusion).
mod light;
mod raster;

use crate::axes::{Look, colour_bar};
use crate::canvas::{Canvas, Rect};
use crate::colour::{INK, Map};
use crate::text::Type;
use interfaces::{Point, Pose, Solid, Vector};
use light::Light;
use nalgebra::{Matrix3, Rotation3};
use raster::Buffer;
use std::io;
use std::path::Path;

/// What something is painted with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tint {
    /// By the colour bar.
    Value(f64),
    /// Between black (0) and white (1): walls, floors. They cast no shadow, since one wants to see what is between them.
    Grey(f64),
}

/// Surface of a body.
#[derive(Clone)]
pub enum Form<'a> {
    /// Ellipsoid or sphere, by its semi-axes \[m\].
    Ellipsoid(Vector),
    /// Union of parts, each with its pose in the body's frame.
    Union(Vec<(Shape<'a>, Pose)>),
    /// Triangles if the solid has a polyhedron, otherwise its signed distance.
    Solid(&'a dyn Solid),
}

/// Shape of a body.
#[derive(Clone)]
pub struct Shape<'a> {
    /// Its surface.
    pub form: Form<'a>,
    /// Radius of a sphere about the origin of its frame that contains it \[m\].
    pub bounding_radius: f64,
}

/// A body of a picture.
#[derive(Clone)]
pub struct Model<'a> {
    /// Its shape.
    pub shape: Shape<'a>,
    /// Where it is.
    pub pose: Pose,
    /// Its paint.
    pub tint: Tint,
}

/// Where one looks from, along parallel rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The point in the middle of the picture.
    pub middle: Point,
    /// The direction in which one looks.
    pub along: Vector,
    /// What is upwards in the picture, roughly.
    pub up: Vector,
    /// What the picture shows \[m\].
    pub width: f64,
    /// What the picture shows \[m\].
    pub height: f64,
}

/// A picture.
pub struct Portrait<'a> {
    /// Where one looks from.
    pub view: View,
    /// What is there.
    pub models: &'a [Model<'a>],
    /// The values at the ends of the colour bar.
    pub range: (f64, f64),
    /// What the colour bar says; without it there is none.
    pub label: Option<&'a str>,
    /// Stands above.
    pub title: &'a str,
}

const LOOK: Look = Look { font: 16.0, line: 1.0 };
/// Largest width and height \[pixels\].
const SIZE: (f64, f64) = (1000.0, 800.0);
const MARGIN: f64 = 16.0;
const TITLE: f64 = 52.0;
const BAR_ROOM: f64 = 122.0;
/// Rays per pixel along each axis.
const FINER: usize = 2;

/// From the world to a buffer: x to the right and y downwards in pixels, z towards the eye in pixels.
#[derive(Clone, Copy)]
struct Camera {
    turn: Matrix3<f64>,
    middle: Point,
    scale: f64,
    centre: (f64, f64),
}

impl Camera {
    /// One that looks `along`, with `scale` pixels per metre and `middle` at a point of the buffer.
    fn new(along: Vector, up: Vector, middle: Point, scale: f64, centre: (f64, f64)) -> Self {
        // Rows: right, up, towards the eye.
        let turn = Rotation3::look_at_rh(&along, &up);
        Self { turn: *turn.matrix(), middle, scale, centre }
    }
    fn at(&self, p: Point) -> Vector {
        let q = self.turn * (p - self.middle) * self.scale;
        Vector::new(self.centre.0 + q.x, self.centre.1 - q.y, q.z)
    }
}

impl Portrait<'_> {
    /// Writes the picture.
    ///
    /// # Errors
    /// What the disk answers, and `InvalidInput` for a view without extent or direction.
    pub fn draw(&self, path: &Path) -> io::Result<()> {
        let View { middle, along, up, width, height } = self.view;
        let sound = width > 0.0 && height > 0.0 && (width * height).is_finite();
        if !(sound && along.cross(&up).norm() > 0.0) {
            let what = format!("a picture of {width} m × {height} m along {along:?} with {up:?} upwards");
            return Err(io::Error::new(io::ErrorKind::InvalidInput, what));
        }
        let scale = (SIZE.0 / width).min(SIZE.1 / height);
        let (w, h) = ((scale * width).round() as usize, (scale * height).round() as usize);
        let (fine_w, fine_h) = (w * FINER, h * FINER);
        let centre = (0.5 * fine_w as f64, 0.5 * fine_h as f64);
        let camera = Camera::new(along, up, middle, scale * FINER as f64, centre);
        let mut buffer = Buffer::new(fine_w, fine_h);
        for (i, model) in self.models.iter().enumerate() {
            buffer.add(&camera, &model.shape, &model.pose, i as u32);
        }
        let light = Light::new(&camera, self.models, fine_w.max(fine_h));
        let map = Map::viridis();
        let span = self.range.1 - self.range.0;
        let colours: Vec<[f32; 3]> = self
            .models
            .iter()
            .map(|m| match m.tint {
                Tint::Value(v) => {
                    light::linear(map.at(if span > 0.0 { (v - self.range.0) / span } else { 0.0 }))
                }
                Tint::Grey(share) => light::linear([(255.0 * share.clamp(0.0, 1.0)) as u8; 3]),
            })
            .collect();
        let rgb = light.paint(&buffer, &colours, FINER);

        let bar = if self.label.is_some() { BAR_ROOM } else { MARGIN };
        let rect = Rect::new(MARGIN, TITLE, w as f64, h as f64);
        let mut canvas = Canvas::new((rect.right() + bar) as usize, (rect.bottom() + MARGIN) as usize);
        for (y, row) in rgb.chunks_exact(3 * w).enumerate() {
            canvas
                .row(rect.top as usize + y, rect.left as usize, rect.left as usize + w)
                .copy_from_slice(row);
        }
        if let Some(label) = self.label {
            let range = if span > 0.0 { self.range } else { (self.range.0, self.range.0 + 1.0) };
            let place = Rect::new(rect.right() + 18.0, rect.top + 8.0, 18.0, rect.height - 16.0);
            colour_bar(&mut canvas, place, &map, range, label, LOOK);
        }
        canvas.text((rect.left, rect.top - 18.0), Type::new(1.2 * LOOK.font, (0.0, 0.0)), self.title);
        self.ruler(&mut canvas, rect, scale);
        canvas.save(path)
    }

    /// A length to compare with, in the lower left corner.
    fn ruler(&self, canvas: &mut Canvas, rect: Rect, scale: f64) {
        let longest = 0.22 * self.view.width;
        let power = 10_f64.powf(longest.log10().floor());
        let length = [5.0, 2.0, 1.0].map(|k| k * power).into_iter().find(|l| *l <= longest).unwrap_or(power);
        let (x, y) = (rect.left + 14.0, rect.bottom() - 16.0);
        let end = x + scale * length;
        for (from, to) in [((x, y), (end, y)), ((x, y - 5.0), (x, y + 5.0)), ((end, y - 5.0), (end, y + 5.0))]
        {
            canvas.line(&[from, to], 2.0, INK);
        }
        let (number, unit) = match length {
            l if l >= 1.0 => (l, "m"),
            l if l >= 0.01 => (100.0 * l, "cm"),
            l if l >= 1e-3 => (1e3 * l, "mm"),
            l => (1e6 * l, "µm"),
        };
        let text = format!("{} {unit}", (number * 1e6).round() / 1e6);
        canvas.text((0.5 * (x + end), y - 8.0), Type::new(LOOK.font, (0.5, 0.0)), &text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dem::{Capsule, Cuboid};

    fn solid(solid: &dyn dem::Shape) -> Shape<'_> {
        Shape { form: Form::Solid(solid), bounding_radius: solid.bounding_radius() }
    }

    fn ellipsoid(semi_axes: [f64; 3]) -> Shape<'static> {
        let semi_axes = Vector::from(semi_axes);
        Shape { form: Form::Ellipsoid(semi_axes), bounding_radius: semi_axes.max() }
    }

    /// The depth that a buffer has where the ray through `at` meets a shape.
    fn depth(shape: &Shape<'_>, pose: &Pose, at: Point) -> f64 {
        let camera = Camera::new(Vector::y(), Vector::z(), Point::origin(), 100.0, (200.0, 200.0));
        let mut buffer = Buffer::new(400, 400);
        buffer.add(&camera, shape, pose, 0);
        let p = camera.at(at);
        f64::from(buffer.depth_at(p.x as usize, p.y as usize)) / 100.0
    }

    /// One looks along y: what is nearer has the smaller y, x is to the right, z upwards.
    #[test]
    fn surfaces_are_where_they_are() {
        let turned = interfaces::Rotation::from_euler_angles(0.0, 0.0, 0.5 * std::f64::consts::PI);
        let pose = Pose { position: Point::new(0.3, -0.5, 0.2), orientation: turned };
        let near = |shape: Shape<'_>, expected: f64| {
            let found = depth(&shape, &pose, pose.position);
            assert!((found - expected).abs() < 0.02, "{found} not {expected}");
            assert_eq!(depth(&shape, &pose, Point::new(1.9, 0.0, 1.9)), f64::NEG_INFINITY);
        };
        near(ellipsoid([0.4; 3]), 0.5 + 0.4);
        // The axis along x has been turned into that along y.
        near(ellipsoid([0.6, 0.2, 0.3]), 0.5 + 0.6);
        near(solid(&Cuboid::new([1.0, 0.2, 0.3]).unwrap()), 0.5 + 0.5);
        near(solid(&Capsule::new(0.2, 0.5).unwrap()), 0.5 + 0.2);
    }

    #[test]
    fn a_portrait_is_a_picture() {
        let ball = ellipsoid([0.01; 3]);
        let floor = Cuboid::new([0.1, 0.1, 0.001]).unwrap();
        let models = [
            Model { shape: ball, pose: Pose::at([0.0, 0.0, 0.01]), tint: Tint::Value(0.5) },
            Model { shape: solid(&floor), pose: Pose::at([0.0; 3]), tint: Tint::Grey(0.8) },
        ];
        let view = View {
            middle: Point::origin(),
            along: Vector::new(0.2, 1.0, -0.4),
            up: Vector::z(),
            width: 0.1,
            height: 0.05,
        };
        let mut portrait =
            Portrait { view, models: &models, range: (0.0, 1.0), label: Some("m/s"), title: "t" };
        let path = std::env::temp_dir().join(format!("siltflow-portrait-{}.png", std::process::id()));
        portrait.draw(&path).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        assert_eq!(u32::from_be_bytes(bytes[16..20].try_into().unwrap()), 1138);
        portrait.view.along = Vector::z();
        assert_eq!(portrait.draw(&path).unwrap_err().kind(), io::ErrorKind::InvalidInput);
    }
}
