//! Shapes, bodies, contact, coupling.
use super::{Key, Kind, LENGTH, METRES, POINT, Range, TIME, Table, optional, required};

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
            Kind::Number(Range::Within(-1.0, 0.5), "1"),
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
            "Restitution of the law `potential`: speed after over speed before.",
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
static SHAPES: [(&str, &Table); 9] = [
    ("disc", &Table { about: "A disc, in plane scenes.", keys: &[RADIUS] }),
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
            about: "A box (in plane scenes a rectangle, for bodies that are not moved by the flow).",
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

const POSITION_OR_ORIGIN: Key =
    optional("position", POINT, "the origin", "Where its centre is.", "[1e-3, 0.0, 0.0]");
const ORIENTATION: Key = optional(
    "orientation",
    Kind::Either(&TURNS),
    "0",
    "How it is turned: an angle about z in degrees, or an axis and an angle.",
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

const BODY_MATERIAL: Key = optional(
    "material",
    Kind::Text,
    "the material of the key's defaults",
    "Name of a material from `materials`.",
    "\"steel\"",
);
const DENSITY: Key = optional(
    "density",
    Kind::Number(Range::Positive, "kg/m³"),
    "the material's",
    "Density, whatever the material's is.",
    "1060.0",
);
const VELOCITY: Key = optional(
    "velocity",
    Kind::List(&Kind::Number(Range::Any, "m/s"), 2, 3),
    "0",
    "Velocity at the start.",
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
        required("position", POINT, "Where its centre is.", "[5e-3, 1.6e-2]"),
        ORIENTATION,
        VELOCITY,
        SPIN,
        optional("motion", Kind::Choice("type", &MOTIONS), "free", "What moves it.", "\"fixed\""),
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

static MOTIONS: [(&str, &Table); 4] = [
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
        "fixed",
        &Table {
            about: "Nothing: it stays where it is. A scene without other bodies than these has them as sharp walls (cut links).",
            keys: &[],
        },
    ),
    (
        "prescribed",
        &Table {
            about: "Formulas of the time t, added to where it stands: `shift`, and the `angle` about an axis.",
            keys: &[
                optional(
                    "shift",
                    Kind::List(&MOVING, 2, 3),
                    "none",
                    "How far it has come.",
                    "[\"-0.79577*sin(2*PI*t/5)\", 0.0]",
                ),
                optional("angle", Kind::Formula(TIME, "rad"), "none", "How far it has turned.", "\"2*t\""),
                optional(
                    "axis",
                    Kind::List(&Kind::Number(Range::Any, "1"), 3, 3),
                    "z",
                    "About which axis.",
                    "[0.0, 0.0, 1.0]",
                ),
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

const REGION: Key = optional(
    "region",
    Kind::Table(&REGION_TABLE),
    "the whole box",
    "Where.",
    "{ lower = [0.0, 0.0], upper = [0.01, 0.005] }",
);
const GAP: Key =
    optional("gap", Kind::Number(Range::NotNegative, "m"), "0", "Least distance of surfaces.", "1e-4");
const SEED: Key = optional("seed", Kind::Whole(0, i64::MAX), "0", "What is drawn depends on it alone.", "7");
const TURNED: Key = optional(
    "turned",
    Kind::Word(&[("random", "any way"), ("about-z", "about z only"), ("no", "all alike")]),
    "random; about-z in plane scenes",
    "How bodies are turned.",
    "\"no\"",
);
const TEMPLATE: Key = required(
    "shape",
    Kind::Choice("type", &SHAPES),
    "The shape of all of them, enlarged by `scale`.",
    "{ type = \"sphere\", radius = 1e-3 }",
);
const SCALE: Key = optional(
    "scale",
    Kind::Choice("law", &SCALES),
    "1",
    "Factors by which bodies are enlarged.",
    "{ law = \"uniform\", low = 0.85, high = 1.15 }",
);

static REGION_TABLE: Table = Table {
    about: "A box.",
    keys: &[
        required("lower", POINT, "Lower corner.", "[0.0, 0.0]"),
        required("upper", POINT, "Upper corner.", "[0.01, 0.005]"),
    ],
};

const FACTOR: Kind = Kind::Number(Range::Positive, "1");

static SCALES: [(&str, &Table); 3] = [
    (
        "uniform",
        &Table {
            about: "Equally many in equal intervals.",
            keys: &[
                required("low", FACTOR, "Least factor.", "0.85"),
                required("high", FACTOR, "Largest factor.", "1.15"),
            ],
        },
    ),
    (
        "normal",
        &Table {
            about: "The normal distribution between two bounds.",
            keys: &[
                required("mean", FACTOR, "Mean.", "1.0"),
                required("deviation", FACTOR, "Standard deviation.", "0.1"),
                required("bounds", Kind::List(&FACTOR, 2, 2), "Nothing outside.", "[0.7, 1.3]"),
            ],
        },
    ),
    (
        "log-normal",
        &Table {
            about: "The log-normal distribution between two bounds.",
            keys: &[
                required("median", FACTOR, "Median.", "1.0"),
                required(
                    "deviation",
                    Kind::Number(Range::Above(1.0, 100.0), "1"),
                    "Geometric standard deviation.",
                    "1.2",
                ),
                required("bounds", Kind::List(&FACTOR, 2, 2), "Nothing outside.", "[0.5, 2.0]"),
            ],
        },
    ),
];

pub(super) static FACTORIES: [(&str, &Table); 4] = [
    (
        "lattice",
        &Table {
            about: "Bodies on a lattice.",
            keys: &[
                TEMPLATE,
                SCALE,
                required("distance", LENGTH, "Of neighbours.", "3e-3"),
                optional(
                    "kind",
                    Kind::Word(&[
                        ("square", "corners of squares, in the plane"),
                        ("hexagonal", "triangles, in the plane"),
                        ("cubic", "corners of cubes"),
                        ("body-centred", "corners and centres of cubes"),
                        ("face-centred", "corners and centres of faces of cubes"),
                        ("close-packed", "hexagonal close packing"),
                    ]),
                    "square; cubic in space",
                    "The lattice.",
                    "\"hexagonal\"",
                ),
                optional(
                    "jitter",
                    Kind::Number(Range::NotNegative, "m"),
                    "0",
                    "Bodies stray so far from their places at most.",
                    "2e-4",
                ),
                optional("number", Kind::Whole(1, 10_000_000), "all that fit", "So many, from below.", "100"),
                REGION,
                GAP,
                SEED,
                TURNED,
                BODY_MATERIAL,
                DENSITY,
                VELOCITY,
                MOTION_OF_MANY,
            ],
        },
    ),
    (
        "random",
        &Table {
            about: "Bodies at random places without overlap: a `number` of them, or as many as fill a `fraction` of the region.",
            keys: &[
                TEMPLATE,
                SCALE,
                optional("number", Kind::Whole(1, 10_000_000), "`fraction` tells", "How many.", "50"),
                optional(
                    "fraction",
                    Kind::Number(Range::Above(0.0, 0.7), "1"),
                    "`number` tells",
                    "Share of the region that bodies fill.",
                    "0.2",
                ),
                REGION,
                GAP,
                SEED,
                TURNED,
                BODY_MATERIAL,
                DENSITY,
                VELOCITY,
                MOTION_OF_MANY,
            ],
        },
    ),
    (
        "table",
        &Table {
            about: "Bodies from a CSV table with columns x, y, z (and qw, qx, qy, qz, vx, …, size).",
            keys: &[
                TEMPLATE,
                required("file", Kind::File, "The table; `size` enlarges the shape.", "\"bodies.csv\""),
                BODY_MATERIAL,
                DENSITY,
                MOTION_OF_MANY,
            ],
        },
    ),
    (
        "inflow",
        &Table {
            about: "Bodies that come in while the run is on its way, at random free places of the region.",
            keys: &[
                TEMPLATE,
                SCALE,
                required("rate", Kind::Number(Range::Positive, "1/s"), "How many per second.", "50.0"),
                optional("start", Kind::Number(Range::NotNegative, "s"), "0", "When the first comes.", "0.1"),
                optional("number", Kind::Whole(1, 10_000_000), "no end", "How many come.", "200"),
                REGION,
                GAP,
                SEED,
                TURNED,
                BODY_MATERIAL,
                DENSITY,
                VELOCITY,
            ],
        },
    ),
];

const MOTION_OF_MANY: Key = optional(
    "motion",
    Kind::Word(&[
        ("free", "the flow, gravity and other bodies move them"),
        ("fixed", "they stay where they are"),
    ]),
    "free",
    "What moves them.",
    "\"fixed\"",
);

const PLANE_POINT: Key = required("point", POINT, "A point of its plane.", "[0.0, 1e-3]");
const PLANE_NORMAL: Key = required(
    "normal",
    Kind::List(&Kind::Number(Range::Any, "1"), 2, 3),
    "Points out of it, of any length.",
    "[0.0, 1.0]",
);

pub(super) static EXIT: Table = Table { about: "A half-space.", keys: &[PLANE_POINT, PLANE_NORMAL] };

static PLANE: Table = Table { about: "All behind a plane, solid.", keys: &[PLANE_POINT, PLANE_NORMAL] };

pub(super) static CONTACT: Table = Table {
    about: "Contacts of bodies with one another and with walls.",
    keys: &[
        optional(
            "law",
            Kind::Word(&[
                ("chen", "the paper's: force in proportion to the overlap volume (Chen 2012; equation 4)"),
                ("potential", "force with a potential, exact restitution"),
                ("rolling", "chen's with rolling friction"),
                ("none", "bodies pass through one another"),
            ]),
            "chen",
            "The law.",
            "\"potential\"",
        ),
        optional("walls", Kind::Flag, "true", "Do bodies touch the walls of the box?", "false"),
        optional(
            "planes",
            Kind::List(&Kind::Table(&PLANE), 0, 100),
            "none",
            "Planes that bodies touch besides, and the fluid does not know: a distributor plate, say.",
            "[{ point = [0.0, 1e-3], normal = [0.0, 1.0] }]",
        ),
        optional(
            "wall_material",
            Kind::Text,
            "that of the first body",
            "Material of those walls.",
            "\"steel\"",
        ),
        optional(
            "length_factor",
            Kind::Number(Range::Positive, "1"),
            "4",
            "Of the contact length L_c.",
            "4.0",
        ),
        optional("adhesion", Kind::Flag, "false", "May damping pull (law chen)?", "true"),
        optional("overlaps", Kind::Flag, "false", "May bodies overlap at the start?", "true"),
    ],
};

pub(super) static LUBRICATION: Table = Table {
    about: "Lubrication.",
    keys: &[optional(
        "roughness",
        Kind::Number(Range::Above(0.0, 1.0), "1"),
        "1e-3",
        "Films get no thinner than this share of the radius.",
        "1e-4",
    )],
};

pub(super) static COUPLING: Table = Table {
    about: "How flow and bodies act on one another.",
    keys: &[
        optional(
            "strategy",
            Kind::Word(&[
                ("one-solve", "one pressure solution per step, stable for any density"),
                ("iterated", "until flow and bodies agree"),
                ("explicit", "a step late; for heavy bodies"),
            ]),
            "one-solve",
            "How they learn of each other.",
            "\"iterated\"",
        ),
        optional(
            "forcing",
            Kind::Word(&[
                ("auto", "cut links if nothing moves, else smooth"),
                ("smooth", "markers and a smooth kernel"),
                ("hfdib", "the paper's hybrid fictitious domain–immersed boundary"),
                ("cut-links", "sharp walls, for bodies at rest"),
            ]),
            "auto",
            "How the fluid is made to follow the bodies.",
            "\"hfdib\"",
        ),
        optional(
            "balance",
            Kind::Word(&[
                ("auto", "net-weight if the box is periodic along gravity, else none"),
                ("none", "none"),
                ("net-weight", "a uniform force that bears the net weight"),
                ("zero-flow", "a uniform force that keeps the mean flow at zero"),
            ]),
            "auto",
            "What bears the bodies' net weight in a periodic box.",
            "\"zero-flow\"",
        ),
        optional(
            "virtual_mass",
            Kind::Number(Range::NotNegative, "1"),
            "what the density asks for",
            "Virtual mass by the displaced mass (one-solve).",
            "0.3",
        ),
        optional("passes", Kind::Whole(1, 20), "3", "Passes of the smooth forcing.", "5"),
        optional(
            "kernel",
            Kind::Word(&[
                ("auto", "quartic in the plane, yang in space"),
                ("yang", "support ±2"),
                ("quartic", "support ±2½"),
                ("quintic", "support ±3, the quietest"),
            ]),
            "auto",
            "Kernel of the smooth forcing.",
            "\"quintic\"",
        ),
    ],
};
