//! Materials, shapes, bodies and what moves them.
use super::{Key, Kind, LENGTH, METRES, POINT, Range, SPACE, SPACE_TIME, TIME, Table, optional, required};

const SPACE_POINT: Kind = Kind::List(&METRES, 3, 3);
const SHARE: Kind = Kind::Number(Range::Within(0.0, 1.0), "1");
const TURN: Kind = Kind::Number(Range::Any, "°");

pub(super) static MATERIAL: Table = Table {
    about: "A material.",
    keys: &[
        optional("density", Kind::Number(Range::Positive, "kg/m³"), "1000", "Density.", "2500.0"),
        optional(
            "youngs_modulus",
            Kind::Number(Range::Positive, "Pa"),
            "1e6",
            "Young's modulus; soft bodies take larger steps.",
            "1e7",
        ),
        optional(
            "poisson_ratio",
            Kind::Number(Range::Above(-1.0, 0.5), "1"),
            "0.3",
            "Poisson's ratio.",
            "0.25",
        ),
        optional(
            "damping",
            Kind::Number(Range::NotNegative, "1"),
            "0.5",
            "Damping of the law `chen`.",
            "1.0",
        ),
        optional(
            "restitution",
            SHARE,
            "0.9",
            "Restitution of the law `potential`: speed after over speed before. Below 0.002 it counts as 0.002, with a warning.",
            "0.6",
        ),
        optional("friction", Kind::Number(Range::NotNegative, "1"), "0.3", "Coefficient of friction.", "0.5"),
        optional(
            "rolling_friction",
            Kind::Number(Range::NotNegative, "1"),
            "0",
            "Coefficient of rolling friction, of the law `rolling`.",
            "0.01",
        ),
    ],
};

const RADIUS: Key = required("radius", LENGTH, "Radius.", "5e-4");
pub(super) static SHAPES: [(&str, &Table); 12] = [
    ("disc", &Table { about: "A disc, in plane scenes.", keys: &[RADIUS] }),
    (
        "ellipse",
        &Table {
            about: "An ellipse, in plane scenes: a polygon of 180 corners and the same area.",
            keys: &[required("semi_axes", Kind::List(&LENGTH, 2, 2), "Semi-axes.", "[1e-3, 5e-4]")],
        },
    ),
    (
        "polygon",
        &Table {
            about: "A polygon, in plane scenes, convex or not; its centre of mass is where the body is put.",
            keys: &[required(
                "corners",
                Kind::List(&Kind::List(&METRES, 2, 2), 3, 10_000),
                "Its corners, one after the other.",
                "[[0.0, 0.0], [1e-3, 0.0], [0.0, 1e-3]]",
            )],
        },
    ),
    ("sphere", &Table { about: "A sphere.", keys: &[RADIUS] }),
    (
        "ellipsoid",
        &Table {
            about: "An ellipsoid.",
            keys: &[required("semi_axes", Kind::List(&LENGTH, 3, 3), "Semi-axes.", "[1e-3, 1.5e-3, 2e-3]")],
        },
    ),
    (
        "capsule",
        &Table {
            about: "A cylinder along z with half-spheres at its ends.",
            keys: &[RADIUS, required("length", LENGTH, "Of the cylinder alone.", "4e-3")],
        },
    ),
    (
        "cylinder",
        &Table {
            about: "A cylinder along z with flat ends.",
            keys: &[RADIUS, required("length", LENGTH, "Length.", "0.1")],
        },
    ),
    (
        "box",
        &Table {
            about: "A box, in plane scenes a rectangle.",
            keys: &[required(
                "edges",
                Kind::List(&LENGTH, 2, 3),
                "Edges along x, y (and z).",
                "[2e-3, 1e-3, 1e-3]",
            )],
        },
    ),
    (
        "polyhedron",
        &Table {
            about: "A convex polyhedron: the hull of points, or vertices with their faces.",
            keys: &[
                required(
                    "vertices",
                    Kind::List(&SPACE_POINT, 4, 100_000),
                    "Points.",
                    "[[0.0, 0.0, 0.0], [1e-3, 0.0, 0.0], [0.0, 1e-3, 0.0], [0.0, 0.0, 1e-3]]",
                ),
                optional(
                    "faces",
                    Kind::List(&Kind::List(&Kind::Whole(0, 100_000), 3, 1000), 4, 100_000),
                    "those of the hull",
                    "Faces by numbers of vertices from 0, anticlockwise from outside.",
                    "[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]",
                ),
            ],
        },
    ),
    (
        "mesh",
        &Table {
            about: "A closed mesh of triangles from an STL or OBJ file.",
            keys: &[
                required("file", Kind::File, "The file, `.stl` or `.obj`.", "\"rock.stl\""),
                optional("unit", LENGTH, "1", "Length that one unit of the file stands for.", "1e-3"),
                optional(
                    "weld",
                    LENGTH,
                    "0; with `repair` round-off of single precision if the surface is open",
                    "Vertices no farther apart are joined.",
                    "1e-7",
                ),
                optional(
                    "repair",
                    Kind::Flag,
                    "false",
                    "Repair the file: join vertices, leave out copies of faces, divide faces at vertices on open edges, turn faces and closed parts outward (cavities inward), flip faces without area, unite parts that cross. A warning lists what was done; what is no body then is refused.",
                    "true",
                ),
                optional(
                    "placement",
                    Kind::Word(&[
                        ("centre of mass", "its centre of mass"),
                        ("box", "the centre of the box around it, as the file has it"),
                        ("file", "the origin of the file's coordinates"),
                    ]),
                    "centre of mass",
                    "The point of the mesh that `position`, a lattice or a table places, and about which `orientation` turns it. With \"file\" and a position of zero the body is where the file has it. Random places do not depend on it.",
                    "\"file\"",
                ),
            ],
        },
    ),
    (
        "union",
        &Table {
            about: "Several shapes that touch but do not overlap, as one body; its centre of mass is where the body is put.",
            keys: &[required(
                "parts",
                Kind::List(&Kind::Table(&PART), 1, 1000),
                "The parts.",
                "[{ shape = { type = \"sphere\", radius = 1e-3 } }, { shape = { type = \"sphere\", radius = 1e-3 }, position = [2e-3, 0.0, 0.0] }]",
            )],
        },
    ),
    (
        "formula",
        &Table {
            about: "Any solid, by a formula of the signed distance from its surface: negative inside, and near the surface the distance itself. In the plane z is 0.",
            keys: &[
                required(
                    "distance",
                    Kind::Formula(SPACE, "m"),
                    "The distance, in the shape's own frame.",
                    "\"sqrt(x^2 + y^2) - 0.05 - 0.01*cos(5*atan2(y, x))\"",
                ),
                required("lower", POINT, "Lower corner of a box that holds the solid.", "[-0.06, -0.06]"),
                required("upper", POINT, "Its upper corner.", "[0.06, 0.06]"),
            ],
        },
    ),
];

static PART: Table = Table {
    about: "A part of a union, in the union's frame.",
    keys: &[
        required(
            "shape",
            Kind::Choice("type", &SHAPES),
            "Its shape.",
            "{ type = \"sphere\", radius = 1e-3 }",
        ),
        POSITION_OR_ORIGIN,
        ORIENTATION,
    ],
};

const POSITION_OR_ORIGIN: Key = optional(
    "position",
    POINT,
    "the origin",
    "Where it is, by the same point as bodies.",
    "[1e-3, 0.0, 0.0]",
);
const ORIENTATION: Key = optional(
    "orientation",
    Kind::Either(&TURNS),
    "0",
    "How it is turned about the point at `position`: an angle about z in degrees, or an axis and an angle.",
    "{ axis = [1.0, 1.0, 0.0], angle = 30.0 }",
);

static TURNS: [Kind; 2] = [TURN, Kind::Table(&ROTATION)];

static ROTATION: Table = Table {
    about: "A rotation.",
    keys: &[
        required(
            "axis",
            Kind::List(&Kind::Number(Range::Any, "1"), 3, 3),
            "The axis, of any length.",
            "[0.0, 1.0, 0.0]",
        ),
        required("angle", TURN, "The angle.", "45.0"),
    ],
};

pub(super) const BODY_MATERIAL: Key = optional(
    "material",
    Kind::Text,
    "the material of the key's defaults",
    "Name of a material from `materials`.",
    "\"steel\"",
);
pub(super) const DENSITY: Key = optional(
    "density",
    Kind::Number(Range::Positive, "kg/m³"),
    "the material's",
    "Density, whatever the material's is.",
    "1060.0",
);
pub(super) const VELOCITY: Key = optional(
    "velocity",
    Kind::List(&Kind::Number(Range::Any, "m/s"), 2, 3),
    "0",
    "Velocity of the centre of mass at the start.",
    "[0.0, -0.01]",
);
const SPIN: Key = optional(
    "spin",
    Kind::Either(&[Kind::Number(Range::Any, "rad/s"), Kind::List(&Kind::Number(Range::Any, "rad/s"), 3, 3)]),
    "0",
    "Angular velocity at the start: about z, or a vector.",
    "[0.0, 0.0, 2.0]",
);

pub(super) static BODY: Table = Table {
    about: "A body.",
    keys: &[
        optional("name", Kind::Text, "its number", "What files and results call it.", "\"heavy\""),
        required("shape", Kind::Choice("type", &SHAPES), "Its shape.", "{ type = \"disc\", radius = 5e-4 }"),
        BODY_MATERIAL,
        DENSITY,
        required(
            "position",
            POINT,
            "Where its centre of mass is; of a formula, where the origin of its coordinates is; of a mesh, where the point is that its `placement` chooses.",
            "[5e-3, 1.6e-2]",
        ),
        ORIENTATION,
        VELOCITY,
        SPIN,
        optional("motion", Kind::Choice("type", &MOTIONS), "free", "What moves it.", "\"fixed\""),
        optional(
            "surface_velocity",
            Kind::List(&Kind::Formula(SPACE_TIME, "m/s"), 2, 3),
            "0",
            "Velocity of the surface of a body that is fixed or prescribed, besides the body's own: a conveyor. In the body's frame, x, y, z from its centre of mass; its part along the surface counts, for contacts and the fluid (smooth forcing or hfdib; no cut links, no steady flow).",
            "[\"0.5*sign(y)\", 0.0]",
        ),
        optional(
            "surface_spin",
            Kind::Either(&SPINS),
            "0",
            "The same by a turn of the surface about the centre of mass: a roller. About z, or a vector in the body's frame.",
            "\"10*sin(t)\"",
        ),
        optional(
            "tether",
            Kind::Table(&TETHER),
            "none",
            "A spring that holds it.",
            "{ anchor = [0.0, 0.0, 0.0], stiffness = 0.1 }",
        ),
    ],
};

const MOVING: Kind = Kind::Formula(TIME, "m");
static SPINS: [Kind; 2] = [Kind::Formula(TIME, "rad/s"), Kind::List(&Kind::Formula(TIME, "rad/s"), 3, 3)];

const AXIS: Key = optional(
    "axis",
    Kind::List(&Kind::Number(Range::Any, "1"), 3, 3),
    "z",
    "About which axis.",
    "[0.0, 0.0, 1.0]",
);
const PIVOT: Key = optional(
    "pivot",
    POINT,
    "its centre of mass",
    "A point of the axis, a hinge, by its place in the scene at t = 0. A shift or velocity moves it, too.",
    "[0.0, 0.0]",
);

static MOTIONS: [(&str, &Table); 6] = [
    ("free", &Table { about: "The flow, gravity and other bodies.", keys: &[] }),
    (
        "axes",
        &Table {
            about: "The same, but only along and about some axes.",
            keys: &[
                optional(
                    "linear",
                    Kind::List(&Kind::Flag, 3, 3),
                    "none",
                    "Along x, y, z.",
                    "[true, true, false]",
                ),
                optional(
                    "angular",
                    Kind::List(&Kind::Flag, 3, 3),
                    "none",
                    "About x, y, z.",
                    "[false, false, true]",
                ),
            ],
        },
    ),
    (
        "planar",
        &Table { about: "The same, in the plane of x and y only: along both, and about z.", keys: &[] },
    ),
    (
        "fixed",
        &Table {
            about: "Nothing: it stays where it is. A scene without other bodies than these has them as sharp walls (cut links).",
            keys: &[],
        },
    ),
    (
        "prescribed",
        &Table {
            about: "Formulas of the time t: `shift` from its position, or `velocity`, and the `angle` about an axis, or `spin`. Velocity and spin are integrated from position and orientation at t = 0, with an error of sixth order in the step.",
            keys: &[
                optional(
                    "shift",
                    Kind::List(&MOVING, 2, 3),
                    "none",
                    "How far it has come.",
                    "[\"-0.79577*sin(2*PI*t/5)\", 0.0]",
                ),
                optional(
                    "velocity",
                    Kind::List(&Kind::Formula(TIME, "m/s"), 2, 3),
                    "`shift` tells",
                    "Velocity of its centre of mass, or of the pivot.",
                    "[\"-cos(2*PI*t/5)\", 0.0]",
                ),
                optional("angle", Kind::Formula(TIME, "rad"), "none", "How far it has turned.", "\"2*t\""),
                optional(
                    "spin",
                    Kind::Either(&SPINS),
                    "`angle` tells",
                    "Angular velocity about its centre of mass: about z, or a vector.",
                    "\"2*cos(t)\"",
                ),
                AXIS,
                PIVOT,
            ],
        },
    ),
    (
        "table",
        &Table {
            about: "Position and angle over time from a file. Values between rows are interpolated linearly, so that velocities are constant between two rows.",
            keys: &[
                required(
                    "file",
                    Kind::File,
                    "CSV file: a header with `time` [s] and any of `x`, `y`, `z` [m] and `angle` [rad], rows in order of time, from 0 to the end of the run. Only differences from the values at t = 0 count.",
                    "\"wing.csv\"",
                ),
                AXIS,
                PIVOT,
            ],
        },
    ),
];

static TETHER: Table = Table {
    about: "A spring of no length from a place on the body to an anchor.",
    keys: &[
        required("anchor", POINT, "Where it is held.", "[0.0, 0.0, 0.0]"),
        required(
            "stiffness",
            Kind::Number(Range::Positive, "N/m"),
            "Stiffness (plane scenes: per metre of depth).",
            "0.1",
        ),
        optional("damping", Kind::Number(Range::NotNegative, "N s/m"), "0", "Damping.", "1e-3"),
        optional(
            "on_body",
            SPACE_POINT,
            "its centre",
            "Where on the body, in the body's frame.",
            "[0.0, 0.0, 0.0]",
        ),
    ],
};
