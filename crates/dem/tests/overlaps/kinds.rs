//! Fifteen kinds of bodies, drawn at random, each with a description that references integrate.
use crate::draw::Draw;
use dem::{Capsule, ConvexPolyhedron, Cuboid, Cylinder, Ellipsoid, Shape, Sphere, TriangleMesh};
use interfaces::Vector;

/// Names of the kinds, in the order of the documented table.
pub(crate) const KINDS: [&str; 15] = [
    "box",
    "slab",
    "rod",
    "needle",
    "flat tetrahedron",
    "hull",
    "ball of 80 triangles",
    "stretched ball of 80 triangles",
    "sphere",
    "ellipsoid",
    "capsule",
    "cylinder",
    "L mesh",
    "U mesh",
    "ring mesh",
];

/// A convex part of a polyhedron: {x: normal·x ≤ offset for all planes}, in the frame of the body.
#[derive(Clone, Debug)]
pub(crate) struct ConvexPart {
    pub(crate) planes: Vec<(Vector, f64)>,
    pub(crate) vertices: Vec<Vector>,
}

/// Exact geometry of a body, independent of the code under test.
#[derive(Clone, Debug)]
pub(crate) enum Geometry {
    /// Disjoint convex parts.
    Parts(Vec<ConvexPart>),
    /// Semi-axes \[m\].
    Ellipsoid(Vector),
    /// Radius and half the length of the straight part \[m\].
    Capsule(f64, f64),
    /// Radius and half the length \[m\].
    Cylinder(f64, f64),
}

/// A body under test.
pub(crate) struct Body {
    pub(crate) shape: Box<dyn Shape>,
    pub(crate) geometry: Geometry,
}

impl Body {
    pub(crate) fn volume(&self) -> f64 {
        self.shape.inertia(1.0).volume
    }
}

/// A body of the kind with this number, of about the size `scale`.
pub(crate) fn draw(kind: usize, scale: f64, draw: &mut Draw) -> Body {
    let size = scale * draw.between(0.3, 1.5);
    match kind {
        0 => cuboid([0; 3].map(|_| size * draw.between(0.5, 2.0))),
        1 => cuboid([size, size * draw.between(0.5, 2.0), 1e-3 * size]),
        2 => cuboid([size, 1e-3 * size, 1e-3 * size]),
        3 => {
            let [u, v, w, x] = [0; 4].map(|_| 0.03 * size * draw.between(0.1, 1.0));
            hull(&[[0.0; 3], [0.2 * size, u, 0.0], [0.6 * size, 0.0, v], [1.3 * size, -w, -x]])
        }
        4 => {
            let mut corner = |x: f64, y: f64, z: f64| [x * size, y * size, z * size * draw.between(0.1, 1.0)];
            hull(&[
                corner(0.0, 0.0, 1e-3),
                corner(1.0, 0.1, -1e-3),
                corner(0.2, 1.1, -1e-3),
                corner(1.2, 0.9, 1e-3),
            ])
        }
        5 => {
            let points: Vec<[f64; 3]> =
                (0..12).map(|_| (draw.direction() * size * draw.between(0.5, 1.0)).into()).collect();
            hull(&points)
        }
        6 => ball(Vector::repeat(0.7 * size)),
        7 => ball(Vector::from_fn(|_, _| size * draw.between(0.2, 1.5))),
        8 => {
            let r = 0.7 * size;
            Body {
                shape: Box::new(Sphere::new(r).expect("a radius")),
                geometry: Geometry::Ellipsoid(Vector::repeat(r)),
            }
        }
        9 => {
            let axes = [0; 3].map(|_| size * draw.between(0.2, 1.5));
            Body {
                shape: Box::new(Ellipsoid::new(axes).expect("semi-axes")),
                geometry: Geometry::Ellipsoid(Vector::from(axes)),
            }
        }
        10 => {
            let (r, l) = (size * draw.between(0.05, 0.8), size * draw.between(0.3, 1.5));
            Body {
                shape: Box::new(Capsule::new(r, l).expect("lengths")),
                geometry: Geometry::Capsule(r, 0.5 * l),
            }
        }
        11 => {
            let (r, l) = (size * draw.between(0.1, 0.9), size * draw.between(0.05, 1.5));
            Body {
                shape: Box::new(Cylinder::new(r, l).expect("lengths")),
                geometry: Geometry::Cylinder(r, 0.5 * l),
            }
        }
        12 => prism(
            size,
            &[[-0.4, -0.4], [0.6, -0.4], [0.6, 0.0], [0.0, 0.0], [0.0, 0.6], [-0.4, 0.6]],
            &[[0, 1, 2, 3], [0, 3, 4, 5]],
        ),
        13 => prism(
            size,
            &[
                [-0.6, -0.5],
                [0.6, -0.5],
                [0.6, 0.5],
                [0.3, 0.5],
                [0.3, -0.2],
                [-0.3, -0.2],
                [-0.3, 0.5],
                [-0.6, 0.5],
            ],
            &[[0, 1, 4, 5], [1, 2, 3, 4], [0, 5, 6, 7]],
        ),
        _ => ring(size),
    }
}

fn cuboid(edges: [f64; 3]) -> Body {
    let half = Vector::from(edges) * 0.5;
    let corner = |i: usize| Vector::from_fn(|a, _| if i >> a & 1 == 0 { -half[a] } else { half[a] });
    let planes = (0..6).map(|i| {
        let sign = if i < 3 { 1.0 } else { -1.0 };
        (Vector::ith(i % 3, sign), half[i % 3])
    });
    let part = ConvexPart { planes: planes.collect(), vertices: (0..8).map(corner).collect() };
    Body { shape: Box::new(Cuboid::new(edges).expect("edges")), geometry: Geometry::Parts(vec![part]) }
}

/// Plane through three points, its normal to the right-hand side.
fn plane([p, q, r]: [Vector; 3]) -> (Vector, f64) {
    let normal = (q - p).cross(&(r - p)).normalize();
    (normal, normal.dot(&p))
}

fn hull(points: &[[f64; 3]]) -> Body {
    let shape = ConvexPolyhedron::from_points(points).expect("a hull");
    let vertices: Vec<Vector> = shape.vertices().iter().map(|v| v.coords).collect();
    let planes = shape.loops().map(|l| plane([0, 1, 2].map(|i| vertices[l[i] as usize])));
    let part = ConvexPart { planes: planes.collect(), vertices: vertices.clone() };
    Body { shape: Box::new(shape), geometry: Geometry::Parts(vec![part]) }
}

fn ball(axes: Vector) -> Body {
    let unit = TriangleMesh::sphere(1.0, 1).expect("a closed surface");
    let corners: Vec<[f64; 3]> =
        unit.vertices().iter().map(|v| v.coords.component_mul(&axes).into()).collect();
    let shape = TriangleMesh::new(&corners, unit.faces()).expect("a closed surface");
    let vertices: Vec<Vector> = shape.vertices().iter().map(|v| v.coords).collect();
    let planes = shape.faces().iter().map(|f| plane(f.map(|v| vertices[v as usize])));
    let part = ConvexPart { planes: planes.collect(), vertices: vertices.clone() };
    Body { shape: Box::new(shape), geometry: Geometry::Parts(vec![part]) }
}

/// A prism 0.4 high over a polygon that is parted into convex ones.
fn prism(size: f64, corners: &[[f64; 2]], parts: &[[usize; 4]]) -> Body {
    let n = corners.len();
    let place = |i: usize, z: f64| [corners[i][0] * size, corners[i][1] * size, z * size];
    let vertices: Vec<[f64; 3]> = [-0.2, 0.2].iter().flat_map(|z| (0..n).map(|i| place(i, *z))).collect();
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for i in 0..n as u32 {
        let (j, m) = ((i + 1) % n as u32, n as u32);
        faces.extend([[i, j, m + j], [i, m + j, m + i]]);
    }
    for part in parts {
        let quad = part.map(|i| i as u32);
        for [p, q, r] in [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|i: usize| quad[i])) {
            faces.extend([[p, r, q], [p + n as u32, q + n as u32, r + n as u32]]);
        }
    }
    let shape = TriangleMesh::new(&vertices, &faces).expect("a closed surface");
    let origin = shape.origin().coords;
    let geometry = parts.iter().map(|part| {
        let flat = part.map(|i| Vector::from(place(i, 0.0)) - origin);
        let sides = (0..4).map(|i| {
            let along = flat[(i + 1) % 4] - flat[i];
            let normal = Vector::new(along.y, -along.x, 0.0).normalize();
            (normal, normal.dot(&flat[i]))
        });
        let caps = [1.0, -1.0].map(|sign| (Vector::z() * sign, 0.2 * size - sign * origin.z));
        let vertices = flat.iter().flat_map(|p| [-0.2, 0.2].map(|z| p + Vector::z() * (z * size)));
        ConvexPart { planes: sides.chain(caps).collect(), vertices: vertices.collect() }
    });
    let geometry = Geometry::Parts(geometry.collect());
    Body { shape: Box::new(shape), geometry }
}

/// A ring of eight straight pieces of rectangular section.
fn ring(size: f64) -> Body {
    const N: usize = 8;
    let rim = |i: usize, k: usize| {
        let angle = std::f64::consts::TAU * i as f64 / N as f64;
        let (r, z) = [(0.4, -0.1), (0.7, -0.1), (0.7, 0.1), (0.4, 0.1)][k];
        Vector::new(r * angle.cos(), r * angle.sin(), z) * size
    };
    let vertices: Vec<[f64; 3]> = (0..4 * N).map(|i| rim(i / 4, i % 4).into()).collect();
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for i in 0..N {
        for k in 0..4 {
            let number = |i: usize, k: usize| (4 * (i % N) + k % 4) as u32;
            let [p, q, r, s] = [number(i, k), number(i + 1, k), number(i + 1, k + 1), number(i, k + 1)];
            faces.extend([[p, q, r], [p, r, s]]);
        }
    }
    let shape = TriangleMesh::new(&vertices, &faces).expect("a closed surface");
    let origin = shape.origin().coords;
    let parts = (0..N).map(|i| {
        let corners: Vec<Vector> =
            (0..8).map(|c| rim(if c < 4 { i } else { (i + 1) % N }, c % 4) - origin).collect();
        let middle = corners.iter().sum::<Vector>() / 8.0;
        let mut planes: Vec<(Vector, f64)> = (0..4)
            .map(|k| plane([corners[k], corners[4 + k], corners[4 + (k + 1) % 4]]))
            .chain([plane([corners[0], corners[1], corners[2]]), plane([corners[4], corners[5], corners[6]])])
            .collect();
        for (normal, offset) in &mut planes {
            if normal.dot(&middle) > *offset {
                (*normal, *offset) = (-*normal, -*offset);
            }
        }
        ConvexPart { planes, vertices: corners }
    });
    Body { shape: Box::new(shape), geometry: Geometry::Parts(parts.collect()) }
}
