//! How bright things are.
use super::raster::Buffer;
use super::{Camera, Model, Tint};
use crate::colour::Colour;
use interfaces::{Point, Vector};
use rayon::prelude::*;
use std::f32::consts::TAU;

/// Light as it adds up, from what a screen is sent.
pub(super) fn linear(colour: Colour) -> [f32; 3] {
    colour.map(|c| (f32::from(c) / 255.0).powf(GAMMA))
}
const GAMMA: f32 = 2.2;

/// Where the lamp is, from the middle: left, above, in front.
const LAMP: [f64; 3] = [-0.5, 0.75, 0.6];
const AMBIENT: f32 = 0.50;
const DIRECT: f32 = 0.72;
/// Neighbours that may stand in the way of light from around, and how far they are looked for, in widths of the picture.
const NEIGHBOURS: usize = 14;
const REACH: f64 = 0.035;
const CREVICE: f32 = 1.5;

/// The lamp and what it sees.
pub(super) struct Light {
    camera: Camera,
    lamp: Camera,
    seen: Buffer,
    towards: Vector,
}

impl Light {
    /// A lamp for what `camera` sees, with a map of shadows of about `size` pixels.
    pub(super) fn new(camera: &Camera, models: &[Model<'_>], size: usize) -> Self {
        let towards = Vector::from(LAMP).normalize();
        let world = camera.turn.transpose() * towards;
        let up = camera.turn.transpose() * Vector::y();
        let mut lamp = Camera::new(-world, up, camera.middle, 1.0, (0.0, 0.0));
        // Around all that is not much larger than the picture.
        let large = camera.centre.0.max(camera.centre.1) / camera.scale;
        let (mut low, mut high) = (Vector::repeat(f64::MAX), Vector::repeat(f64::MIN));
        let casts = |m: &&Model<'_>| matches!(m.tint, Tint::Value(_));
        for model in models.iter().filter(casts).filter(|m| m.shape.bounding_radius < large) {
            let (p, r) = (lamp.at(model.pose.position), model.shape.bounding_radius);
            low = low.inf(&p.add_scalar(-r));
            high = high.sup(&p.add_scalar(r));
        }
        let extent = (high - low).map(|e| e.max(0.0));
        let widest = extent.x.max(extent.y);
        if widest > 0.0 {
            lamp.scale = (size as f64 / widest).min(1.5 * camera.scale);
        }
        let (w, h) = ((extent.x * lamp.scale) as usize + 1, (extent.y * lamp.scale) as usize + 1);
        lamp.centre = (-low.x * lamp.scale, -low.y * lamp.scale);
        let mut seen = Buffer::new(w.min(2 * size), h.min(2 * size));
        for model in models.iter().filter(casts) {
            seen.add(&lamp, &model.shape, &model.pose, 0);
        }
        Self { camera: *camera, lamp, seen, towards }
    }

    /// The picture, `finer` rays per pixel along each axis put together.
    pub(super) fn paint(&self, buffer: &Buffer, colours: &[[f32; 3]], finer: usize) -> Vec<u8> {
        let (w, h) = (buffer.width / finer, buffer.height / finer);
        let mut rgb = vec![255; 3 * w * h];
        let share = 1.0 / (finer * finer) as f32;
        rgb.par_chunks_exact_mut(3 * w).enumerate().for_each(|(y, row)| {
            for (x, pixel) in row.chunks_exact_mut(3).enumerate() {
                let mut sum = [0.0; 3];
                for (i, j) in (0..finer).flat_map(|j| (0..finer).map(move |i| (i, j))) {
                    let one = self.ray(buffer, colours, finer * x + i, finer * y + j);
                    for k in 0..3 {
                        sum[k] += one[k] * share;
                    }
                }
                for k in 0..3 {
                    pixel[k] = (255.0 * sum[k].clamp(0.0, 1.0).powf(1.0 / GAMMA) + 0.5) as u8;
                }
            }
        });
        rgb
    }

    fn ray(&self, buffer: &Buffer, colours: &[[f32; 3]], x: usize, y: usize) -> [f32; 3] {
        let at = y * buffer.width + x;
        if buffer.owner[at] == u32::MAX {
            return [1.0; 3];
        }
        let (n, depth) = (buffer.normal[at], buffer.depth[at]);
        let open = self.openness(buffer, x, y, n, depth);
        let facing =
            n[0] * self.towards.x as f32 + n[1] * self.towards.y as f32 + n[2] * self.towards.z as f32;
        let lit = if facing > 0.0 { facing * self.lit(x, y, f64::from(depth), n) } else { 0.0 };
        let light = AMBIENT * open * (0.85 + 0.15 * n[1]) + DIRECT * lit * (0.5 + 0.5 * open);
        colours[buffer.owner[at] as usize].map(|c| c * light)
    }

    /// A number of its own for every pixel, from 0 to 1.
    fn dither(x: usize, y: usize) -> f32 {
        let mut k = (x as u32).wrapping_mul(0x9E37_79B1) ^ (y as u32).wrapping_mul(0x85EB_CA77);
        k ^= k >> 15;
        k = k.wrapping_mul(0x2C1B_3C6D);
        k ^= k >> 12;
        (k >> 8) as f32 / (1_u32 << 24) as f32
    }

    /// How much of the light from around comes in.
    fn openness(&self, buffer: &Buffer, x: usize, y: usize, n: [f32; 3], depth: f32) -> f32 {
        let reach = (REACH * buffer.width as f64) as f32;
        let start = Self::dither(x, y);
        let mut shut = 0.0;
        for k in 0..NEIGHBOURS {
            let away = reach * (k as f32 + 0.5 + 0.5 * start) / NEIGHBOURS as f32;
            let (sin, cos) = (TAU * (start + 0.618_034 * k as f32)).sin_cos();
            let (dx, dy) = ((away * cos).round(), (away * sin).round());
            let (i, j) = (x as f32 + dx, y as f32 - dy);
            if i < 0.0 || j < 0.0 || i >= buffer.width as f32 || j >= buffer.height as f32 {
                continue;
            }
            let dz = buffer.depth[j as usize * buffer.width + i as usize] - depth;
            if !dz.is_finite() {
                continue;
            }
            let length = dx * dx + dy * dy + dz * dz;
            let rise = (n[0] * dx + n[1] * dy + n[2] * dz) / length.sqrt().max(1e-3);
            // What is far in front does not touch.
            shut += (rise - 0.1).max(0.0) / (1.0 + length / (reach * reach));
        }
        (1.0 - CREVICE * shut / NEIGHBOURS as f32).max(0.0)
    }

    /// How much of the lamp is seen.
    fn lit(&self, x: usize, y: usize, depth: f64, n: [f32; 3]) -> f32 {
        let camera = &self.camera;
        let own = Vector::new(x as f64 + 0.5 - camera.centre.0, camera.centre.1 - (y as f64 + 0.5), depth);
        // A little outwards, so that nothing is in its own shadow.
        let off = Vector::new(f64::from(n[0]), f64::from(n[1]), f64::from(n[2]))
            * (1.5 + 2.0 * camera.scale / self.lamp.scale);
        let world = camera.turn.transpose() * (own + off) / camera.scale;
        let p = self.lamp.at(Point::from(camera.middle.coords + world));
        let start = Self::dither(y, x);
        let mut open = 0;
        const TAPS: usize = 6;
        for k in 0..TAPS {
            let away = 2.5 * ((k as f32 + start) / TAPS as f32).sqrt();
            let (sin, cos) = (TAU * (start + 0.618_034 * k as f32)).sin_cos();
            let (i, j) = (p.x + f64::from(away * cos), p.y + f64::from(away * sin));
            let out = i < 0.0 || j < 0.0 || i >= self.seen.width as f64 || j >= self.seen.height as f64;
            let clear =
                out || f64::from(self.seen.depth[j as usize * self.seen.width + i as usize]) <= p.z + 1.0;
            open += usize::from(clear);
        }
        open as f32 / TAPS as f32
    }
}
