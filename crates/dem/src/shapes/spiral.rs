//! Elements of equal area on a golden-angle spiral over a surface of revolution.
use interfaces::{Point, SurfaceElement, Vector};
use std::f64::consts::PI;

/// A place on the generator of a surface of revolution about z: distance from the axis and height \[m\], and the outward
/// unit normal's parts along both.
pub(crate) struct Profile {
    pub(crate) place: [f64; 2],
    pub(crate) normal: [f64; 2],
}

/// Elements of equal area, about `spacing` apart, on the surface of revolution of area `whole` \[m²\]; `profile` gives the
/// place above which a share of that area (0 … `whole`) lies. `None` without a positive area or spacing.
pub(crate) fn spiral(
    whole: f64,
    spacing: f64,
    profile: impl Fn(f64) -> Profile,
) -> Option<Vec<SurfaceElement>> {
    if !(whole > 0.0 && spacing > 0.0) {
        return None;
    }
    let n = (whole / (spacing * spacing)).round().max(6.0);
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    let element = |i: usize| {
        let Profile { place, normal } = profile(whole * (i as f64 + 0.5) / n);
        let (sin, cos) = (golden * i as f64).sin_cos();
        let point = Point::new(place[0] * cos, place[0] * sin, place[1]);
        SurfaceElement {
            point,
            normal: Vector::new(normal[0] * cos, normal[0] * sin, normal[1]),
            area: whole / n,
        }
    };
    Some((0..n as usize).map(element).collect())
}
