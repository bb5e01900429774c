//! Many bodies at once.
use super::bodies::{BODY_MATERIAL, DENSITY, SHAPES, VELOCITY};
use super::{Key, Kind, LENGTH, POINT, Range, Table, optional, required};

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
            about: "Bodies that come in while the run is on its way, at random free places of the region, which may reach beyond inlets, outlets and sides of given pressure if bodies move inwards from there.",
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
