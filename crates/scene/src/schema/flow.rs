//! Box, sides, fluid, flow.
use super::{Key, Kind, LENGTH, METRES, POINT, Range, SPACE, SPACE_TIME, TIME, Table, optional, required};

const SPEED: Kind = Kind::Number(Range::Any, "m/s");

pub(super) static GRID: Table = Table {
    about: "Give `cells` and `size` for equal cells, or every axis by itself. Two axes make a plane scene (per metre of depth), three one in space.",
    keys: &[
        optional(
            "cells",
            Kind::List(&Kind::Whole(1, 100_000), 2, 3),
            "the axes tell",
            "Cells along x, y (and z).",
            "[150, 300]",
        ),
        optional(
            "size",
            Kind::List(&LENGTH, 2, 3),
            "the axes tell",
            "Edge lengths of the box.",
            "[0.01, 0.02]",
        ),
        optional("origin", POINT, "0", "Lower corner of the box, with `cells` and `size`.", "[-0.5, -0.5]"),
        optional(
            "x",
            AXIS,
            "`cells` and `size`",
            "The axis x.",
            "{ spacing = \"uniform\", cells = 64, to = 1.0 }",
        ),
        optional(
            "y",
            AXIS,
            "`cells` and `size`",
            "The axis y.",
            "{ spacing = \"tanh\", cells = 64, to = 1.0, strength = 1.5 }",
        ),
        optional(
            "z",
            AXIS,
            "`cells` and `size`",
            "The axis z.",
            "{ spacing = \"geometric\", cells = 32, to = 1.0, ratio = 1.05 }",
        ),
    ],
};

const AXIS: Kind = Kind::Choice("spacing", &AXES);

const CELLS: Key = required("cells", Kind::Whole(1, 100_000), "How many.", "64");
const FROM: Key = optional("from", METRES, "0", "Where the axis begins.", "-1.0");
const TO: Key = required("to", METRES, "Where it ends.", "1.0");

static AXES: [(&str, &Table); 6] = [
    ("uniform", &Table { about: "Equal cells.", keys: &[CELLS, FROM, TO] }),
    (
        "geometric",
        &Table {
            about: "Each cell wider than the one before by the same factor.",
            keys: &[
                CELLS,
                FROM,
                TO,
                required("ratio", Kind::Number(Range::Within(0.5, 2.0), "1"), "That factor.", "1.05"),
            ],
        },
    ),
    (
        "tanh",
        &Table {
            about: "Cells gathered at the ends by a hyperbolic tangent.",
            keys: &[
                CELLS,
                FROM,
                TO,
                required("strength", Kind::Number(Range::Above(0.0, 10.0), "1"), "How much.", "1.8"),
                optional(
                    "cluster",
                    Kind::Word(&[
                        ("both", "at both ends"),
                        ("lower", "at the lower end"),
                        ("upper", "at the upper end"),
                    ]),
                    "both",
                    "Where.",
                    "\"lower\"",
                ),
            ],
        },
    ),
    (
        "gathered",
        &Table {
            about: "Equal cells in a part of the axis, which grow beyond it: for bodies, which want equal cells around them.",
            keys: &[
                required("fine", LENGTH, "Width of the equal cells.", "0.005"),
                required("between", Kind::List(&METRES, 2, 2), "Where they are.", "[0.1, 0.4]"),
                FROM,
                TO,
                optional(
                    "growth",
                    Kind::Number(Range::Above(1.0, 1.5), "1"),
                    "1.05",
                    "Factor from one cell to the next outside.",
                    "1.08",
                ),
            ],
        },
    ),
    (
        "faces",
        &Table {
            about: "Every face.",
            keys: &[required(
                "faces",
                Kind::List(&METRES, 2, 100_001),
                "Increasing.",
                "[0.0, 0.1, 0.3, 0.6]",
            )],
        },
    ),
    (
        "file",
        &Table {
            about: "Every face, from a file of numbers.",
            keys: &[required(
                "file",
                Kind::File,
                "Numbers separated by blanks, commas or line ends; # begins a comment.",
                "\"x_faces.txt\"",
            )],
        },
    ),
];

pub(super) static SIDES: Table = Table {
    about: "Every side of the box has to be given, by its own name or with the opposite one as `x`, `y` or `z`.",
    keys: &[
        optional(
            "x",
            Kind::Choice("type", &SIDE_TYPES),
            "`x_min` and `x_max` tell",
            "Both sides of the axis x.",
            "\"periodic\"",
        ),
        optional(
            "y",
            Kind::Choice("type", &SIDE_TYPES),
            "`y_min` and `y_max` tell",
            "Both sides of the axis y.",
            "\"wall\"",
        ),
        optional(
            "z",
            Kind::Choice("type", &SIDE_TYPES),
            "`z_min` and `z_max` tell",
            "Both sides of the axis z.",
            "\"symmetry\"",
        ),
        optional(
            "x_min",
            Kind::Choice("type", &SIDE_TYPES),
            "`x` tells",
            "The lower side of the axis x.",
            "{ type = \"inlet\", velocity = [1.0, 0.0] }",
        ),
        optional(
            "x_max",
            Kind::Choice("type", &SIDE_TYPES),
            "`x` tells",
            "The upper side of the axis x.",
            "\"outlet\"",
        ),
        optional(
            "y_min",
            Kind::Choice("type", &SIDE_TYPES),
            "`y` tells",
            "The lower side of the axis y.",
            "\"wall\"",
        ),
        optional(
            "y_max",
            Kind::Choice("type", &SIDE_TYPES),
            "`y` tells",
            "The upper side of the axis y.",
            "{ type = \"wall\", velocity = [1.0, 0.0] }",
        ),
        optional(
            "z_min",
            Kind::Choice("type", &SIDE_TYPES),
            "`z` tells",
            "The lower side of the axis z.",
            "\"wall\"",
        ),
        optional(
            "z_max",
            Kind::Choice("type", &SIDE_TYPES),
            "`z` tells",
            "The upper side of the axis z.",
            "{ type = \"pressure\", value = 0.0 }",
        ),
    ],
};

static SIDE_TYPES: [(&str, &Table); 7] = [
    ("periodic", &Table { about: "What leaves here enters at the opposite side.", keys: &[] }),
    (
        "wall",
        &Table {
            about: "The fluid sticks to it; bodies touch it.",
            keys: &[optional(
                "velocity",
                Kind::List(&Kind::Formula(SPACE_TIME, "m/s"), 2, 3),
                "at rest",
                "It moves along itself; bodies that touch it are taken along by friction.",
                "[\"0.5*sin(20*t)\", 0.0]",
            )],
        },
    ),
    ("symmetry", &Table { about: "A frictionless wall, or a plane of symmetry.", keys: &[] }),
    (
        "inlet",
        &Table {
            about: "Fluid enters: `velocity`, a parabola with this `peak`, or a `table` over time.",
            keys: &[
                optional(
                    "velocity",
                    Kind::List(&Kind::Formula(SPACE_TIME, "m/s"), 2, 3),
                    "`peak` or `table` tells",
                    "What enters.",
                    "[\"1.5*4*y*(0.41-y)/0.41^2\", 0.0]",
                ),
                optional(
                    "peak",
                    SPEED,
                    "`velocity` or `table` tells",
                    "Speed in the middle of a developed flow into the box (a product of parabolas in a duct).",
                    "0.3",
                ),
                optional(
                    "table",
                    Kind::File,
                    "`velocity` or `peak` tells",
                    "CSV file of the velocity [m/s] over time [s], the same all over the side: a header with `time` and `u`, `v`, `w` (0 where absent), rows in order of time, from 0 to the end of the run. Values between rows are interpolated linearly.",
                    "\"inflow.csv\"",
                ),
            ],
        },
    ),
    ("outlet", &Table { about: "Fluid leaves, carried out by the speed there.", keys: &[] }),
    (
        "pressure",
        &Table {
            about: "Fluid leaves, or enters, through a side of given pressure.",
            keys: &[optional("value", Kind::Number(Range::Any, "Pa"), "0", "That pressure.", "100.0")],
        },
    ),
    (
        "patches",
        &Table {
            about: "Different things on parts of the side: the first rectangle that holds a face counts. They have to cover the side.",
            keys: &[required(
                "list",
                Kind::List(&Kind::Table(&PATCH), 1, 100),
                "The rectangles.",
                "[{ lower = [0.0, 0.0], upper = [0.0, 1.0], side = \"wall\" }]",
            )],
        },
    ),
];

static PATCH: Table = Table {
    about: "A rectangle of a side; the coordinate normal to the side does not matter.",
    keys: &[
        required("lower", POINT, "Lower corner.", "[0.0, -2.0]"),
        required("upper", POINT, "Upper corner.", "[0.0, -1.0]"),
        required(
            "side",
            Kind::Choice("type", &SIDE_TYPES),
            "What happens there; neither periodic nor patches again.",
            "\"outlet\"",
        ),
    ],
};

pub(super) static FLUID: Table = Table {
    about: "Density, and one of both viscosities.",
    keys: &[
        required("density", Kind::Number(Range::Positive, "kg/m³"), "Density.", "1000.0"),
        optional(
            "nu",
            Kind::Number(Range::NotNegative, "m²/s"),
            "`mu` tells",
            "Kinematic viscosity.",
            "1e-6",
        ),
        optional("mu", Kind::Number(Range::NotNegative, "Pa s"), "`nu` tells", "Dynamic viscosity.", "1e-3"),
    ],
};

pub(super) static FLOW_RATE: Table = Table {
    about: "A uniform body force along a periodic axis that gives the flow this mean velocity over the box, bodies included (the superficial velocity). Results have it as `body_force`, `history.csv` as `force`. A first velocity other than the initial one is an impulsive start.",
    keys: &[
        required("axis", Kind::Word(&[("x", "x"), ("y", "y"), ("z", "z")]), "The axis.", "\"x\""),
        required("velocity", Kind::Formula(TIME, "m/s"), "Mean velocity along it.", "\"0.1*min(t, 1)\""),
    ],
};

pub(super) static INITIAL: Table = Table {
    about: "The flow at time 0, by formulas or from a file; it is made free of divergence by the first step.",
    keys: &[
        optional(
            "velocity",
            Kind::List(&Kind::Formula(SPACE, "m/s"), 2, 3),
            "at rest",
            "Velocity.",
            "[\"-cos(x)*sin(y)\", \"sin(x)*cos(y)\"]",
        ),
        optional(
            "file",
            Kind::File,
            "`velocity` tells",
            "Velocity from a snapshot of another run, `fields/NNNNN.vti` of a scene with equal cells: interpolated linearly between the centres of its cells, on any grid whose box is inside of its box. Along axes that are periodic and as long as in the file it goes on periodically; at other ends it is the nearest cell's.",
            "\"../coarse/fields/00050.vti\"",
        ),
    ],
};

pub(super) static FLOW: Table = Table {
    about: "How the flow is computed.",
    keys: &[
        optional(
            "algorithm",
            Kind::Word(&[
                (
                    "projection",
                    "incremental pressure correction, explicit convection: the fastest, and the one for bodies",
                ),
                (
                    "piso",
                    "implicit, several pressure corrections per step: larger steps, no bodies but the paper's forcing",
                ),
                ("simple", "steady flow by SIMPLEC; bodies at rest are left to the projection"),
            ]),
            "projection",
            "The algorithm.",
            "\"simple\"",
        ),
        optional(
            "convection",
            Kind::Word(&[
                ("central", "second order, keeps kinetic energy"),
                ("upwind", "first order, bounded"),
                ("linear-upwind", "second order, damped"),
                ("quick", "third-order interpolation"),
                ("limited", "van Leer's limiter"),
            ]),
            "central; with a RANS model limited, or quick with simple",
            "The convection scheme. Flows with a RANS model (SST, k–ω, k–ε, realizable) need one that is upwind-biased: a square cylinder at Re 22 000 has Cd 1.36 with central and 1.85 with limited (measured: 2.05 to 2.23).",
            "\"quick\"",
        ),
        optional(
            "diffusion",
            Kind::Word(&[
                ("auto", "explicit where stable at the step at hand, else implicit; explicit with bodies"),
                ("explicit", "explicit along all axes"),
                ("implicit", "implicit along all axes"),
            ]),
            "auto",
            "Viscous terms (projection).",
            "\"explicit\"",
        ),
        optional(
            "pressure",
            Kind::Word(&[
                ("auto", "the fastest that serves the sides"),
                ("direct", "transforms and sweeps, to round-off"),
                ("multigrid", "conjugate gradients with multigrid"),
            ]),
            "auto",
            "The pressure solver (projection).",
            "\"multigrid\"",
        ),
        optional(
            "tolerance",
            Kind::Number(Range::Within(1e-12, 1e-2), "1"),
            "1e-6",
            "Residual at which a steady flow is done (simple).",
            "1e-8",
        ),
        optional(
            "iterations",
            Kind::Whole(1, 1_000_000),
            "5000",
            "Iterations allowed for a steady flow (simple).",
            "2000",
        ),
    ],
};
