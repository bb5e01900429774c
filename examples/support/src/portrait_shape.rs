//! Shapes of `dem` as pictures take them.
use dem::Shape;
use interfaces::Vector;
use render::solids;

/// Shape of a picture: its surface with the parts of unions.
pub fn portrait_shape(shape: &dyn Shape) -> solids::Shape<'_> {
    let form = match shape.form() {
        dem::Form::Union(parts) => {
            solids::Form::Union(parts.iter().map(|part| (portrait_shape(&*part.shape), part.pose)).collect())
        }
        dem::Form::Sphere(sphere) => solids::Form::Ellipsoid(Vector::repeat(sphere.radius())),
        dem::Form::Ellipsoid(ellipsoid) => solids::Form::Ellipsoid(ellipsoid.semi_axes()),
        _ => solids::Form::Solid(shape),
    };
    solids::Shape { form, bounding_radius: shape.bounding_radius() }
}
