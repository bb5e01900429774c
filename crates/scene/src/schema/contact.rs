//! Contact, lubrication, coupling, exits.
use super::{Key, Kind, POINT, Range, SPACE_TIME, Table, optional, required};

const PLANE_POINT: Key = required("point", POINT, "A point of its plane.", "[0.0, 1e-3]");
const PLANE_NORMAL: Key = required(
    "normal",
    Kind::List(&Kind::Number(Range::Any, "1"), 2, 3),
    "Points out of it, of any length.",
    "[0.0, 1.0]",
);

pub(super) static EXIT: Table = Table { about: "A half-space.", keys: &[PLANE_POINT, PLANE_NORMAL] };

static PLANE: Table = Table {
    about: "All behind a plane, solid.",
    keys: &[
        PLANE_POINT,
        PLANE_NORMAL,
        optional(
            "velocity",
            Kind::List(&Kind::Formula(SPACE_TIME, "m/s"), 2, 3),
            "at rest",
            "Velocity of its surface in the plane: a belt.",
            "[\"0.5*sin(20*t)\", 0.0]",
        ),
    ],
};

static REPULSION: Table = Table {
    about: "A force F₀(1 − δ/ζ)² between bodies whose closest places are δ < ζ apart, and from walls (Glowinski et al. 1999).",
    keys: &[
        required(
            "strength",
            Kind::Number(Range::Positive, "N; plane N/m"),
            "F₀, where surfaces touch: some times what presses them together.",
            "1.0",
        ),
        required("range", Kind::Number(Range::Positive, "m"), "ζ, one or two cells.", "3e-4"),
    ],
};

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
        optional(
            "repulsion",
            Kind::Table(&REPULSION),
            "none",
            "Pushes bodies apart before they touch (law chen, one-solve).",
            "{ strength = 1.0, range = 3e-4 }",
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
