//! What acts on the flow besides pressure and viscosity: turbulence models, scalars.
use super::{Key, Kind, Range, SPACE, SPACE_TIME, Table, optional, required};

const INTENSITY: Key = optional(
    "intensity",
    Kind::Number(Range::Above(0.0, 1.0), "1"),
    "0.05",
    "Turbulence intensity I of what enters and of the flow at the start: k = 3/2 (I U)².",
    "0.02",
);
const LENGTH_SCALE: Key = optional(
    "length",
    Kind::Number(Range::Positive, "m"),
    "`viscosity_ratio` tells",
    "Length scale L of that turbulence: ω = √k/(C_μ^¼ L).",
    "0.07",
);
const RATIO: Key = optional(
    "viscosity_ratio",
    Kind::Number(Range::Positive, "1"),
    "`length` tells, or 10",
    "Its ν_t over ν, instead of a length: ω = k/ν_t.",
    "5.0",
);
const SPEED: Key = optional(
    "speed",
    Kind::Number(Range::Positive, "m/s"),
    "the fastest inlet, wall or initial flow",
    "The speed U that the intensity is of.",
    "1.0",
);
const WALLS: Key = optional(
    "walls",
    Kind::Word(&[
        ("log-law", "the friction of the law of the wall, at any y+"),
        ("no-slip", "viscous friction: cells down to y+ of about 1"),
        ("slip", "none"),
    ]),
    "log-law",
    "What bodies at rest do to a steady flow.",
    "\"no-slip\"",
);

pub(super) static TURBULENCE: [(&str, &Table); 6] = [
    (
        "sst",
        &Table {
            about: "k–ω SST (Menter, Kuntz & Langtry 2003) with wall functions.",
            keys: &[INTENSITY, LENGTH_SCALE, RATIO, SPEED, WALLS],
        },
    ),
    (
        "k-omega",
        &Table {
            about: "k–ω (Wilcox 1988) with wall functions.",
            keys: &[
                INTENSITY,
                LENGTH_SCALE,
                RATIO,
                SPEED,
                WALLS,
                optional("beta", Kind::Number(Range::Positive, "1"), "0.075", "β.", "0.072"),
                optional("gamma", Kind::Number(Range::Positive, "1"), "0.5556", "γ.", "0.52"),
            ],
        },
    ),
    (
        "k-epsilon",
        &Table {
            about: "k–ε (Launder & Spalding 1974) with wall functions.",
            keys: &[INTENSITY, LENGTH_SCALE, RATIO, SPEED, WALLS],
        },
    ),
    (
        "realizable",
        &Table {
            about: "Realizable k–ε (Shih et al. 1995) with wall functions.",
            keys: &[INTENSITY, LENGTH_SCALE, RATIO, SPEED, WALLS],
        },
    ),
    (
        "smagorinsky",
        &Table {
            about: "Large eddies by Smagorinsky's model (1963), damped beside the walls of the box; in space.",
            keys: &[optional(
                "constant",
                Kind::Number(Range::Positive, "1"),
                "0.065",
                "C_s: 0.1 to 0.17 without walls.",
                "0.1",
            )],
        },
    ),
    (
        "wale",
        &Table {
            about: "Large eddies by the wall-adapting model of Nicoud & Ducros (1999); in space.",
            keys: &[optional("constant", Kind::Number(Range::Positive, "1"), "0.325", "C_w.", "0.5")],
        },
    ),
];

pub(super) static SCALAR: Table = Table {
    about: "A scalar (temperature, concentration) that the flow carries. In a steady flow it is found at the end, from the flow; with `expansion` along with it.",
    keys: &[
        required("diffusivity", Kind::Number(Range::NotNegative, "m²/s"), "Its diffusivity.", "2e-5"),
        optional(
            "turbulent_prandtl",
            Kind::Number(Range::Positive, "1"),
            "0.85",
            "Turbulent Prandtl (or Schmidt) number Pr_t: a turbulence model's eddies mix it by ν_t/Pr_t; beside walls with wall functions and a value given (sides; bodies in steady flow), by the law of the wall.",
            "0.9",
        ),
        optional(
            "source",
            Kind::Formula(SPACE, "its unit/s"),
            "none",
            "What adds to it per time.",
            "\"0.1*exp(-x)\"",
        ),
        optional("unit", Kind::Text, "none", "Its unit, for tables and pictures.", "\"K\""),
        optional(
            "initial",
            Kind::Formula(SPACE, "its unit"),
            "0",
            "Its field at time 0.",
            "\"step(x - 0.5)\"",
        ),
        optional(
            "convection",
            Kind::Word(&[
                ("limited", "van Leer's limiter: bounded"),
                ("central", "second order"),
                ("upwind", "first order, bounded"),
                ("quick", "third-order interpolation"),
            ]),
            "limited",
            "Its convection scheme.",
            "\"central\"",
        ),
        optional(
            "sides",
            Kind::Table(&SCALAR_SIDES),
            "inlets bring 0, the others let nothing through",
            "What holds for it at the sides that are not periodic.",
            "{ x_min = { type = \"value\", value = 1.0 } }",
        ),
        optional(
            "bodies",
            Kind::Formula(&["t"], "its unit"),
            "bodies have no part in it",
            "Its value on and in all bodies; those that move leave it behind in the cells they come from. Steady flows with bodies need it.",
            "1.0",
        ),
        optional(
            "bodies_flux",
            Kind::Formula(&["t"], "its unit m/s"),
            "none",
            "What the surfaces of all bodies give off to it per area and time (of heat: W/m² over ρc). Bodies then conduct and store it as the fluid does. Not with bodies that come and go.",
            "\"2e-4*min(t, 1)\"",
        ),
        optional(
            "expansion",
            Kind::Number(Range::Any, "1/its unit"),
            "not buoyant",
            "Expansion coefficient β: −β(φ − φ₀)g drives the fluid (Boussinesq). One scalar may have it.",
            "3.4e-3",
        ),
        optional(
            "reference",
            Kind::Number(Range::Any, "its unit"),
            "0",
            "φ₀, at which nothing is buoyant.",
            "0.5",
        ),
    ],
};

const NATURAL: &str = "0 where fluid enters, else nothing passes";
const SIDE: Kind = Kind::Choice("type", &SCALAR_SIDE_TYPES);

static SCALAR_SIDES: Table = Table {
    about: "By the names of the sides of the box.",
    keys: &[
        optional("x", SIDE, NATURAL, "Both sides of the axis x.", "{ type = \"value\", value = 0.0 }"),
        optional("y", SIDE, NATURAL, "Both sides of the axis y.", "{ type = \"value\", value = 0.0 }"),
        optional("z", SIDE, NATURAL, "Both sides of the axis z.", "{ type = \"value\", value = 0.0 }"),
        optional("x_min", SIDE, NATURAL, "The lower side of x.", "{ type = \"value\", value = 1.0 }"),
        optional("x_max", SIDE, NATURAL, "The upper side of x.", "\"insulated\""),
        optional("y_min", SIDE, NATURAL, "The lower side of y.", "{ type = \"gradient\", gradient = -10.0 }"),
        optional("y_max", SIDE, NATURAL, "The upper side of y.", "\"insulated\""),
        optional("z_min", SIDE, NATURAL, "The lower side of z.", "\"insulated\""),
        optional("z_max", SIDE, NATURAL, "The upper side of z.", "\"insulated\""),
    ],
};

static SCALAR_SIDE_TYPES: [(&str, &Table); 3] = [
    (
        "value",
        &Table {
            about: "It is given.",
            keys: &[required(
                "value",
                Kind::Formula(SPACE_TIME, "its unit"),
                "Its value there.",
                "\"1 + 0.1*sin(6*y)\"",
            )],
        },
    ),
    (
        "gradient",
        &Table {
            about: "Its derivative along the normal out of the box is given.",
            keys: &[required(
                "gradient",
                Kind::Formula(SPACE_TIME, "its unit/m"),
                "That derivative.",
                "-10.0",
            )],
        },
    ),
    ("insulated", &Table { about: "Nothing passes by diffusion.", keys: &[] }),
];
