//! Time, output, what is measured.
use super::{Key, Kind, METRES, POINT, Range, Table, optional, required};

const SECONDS: Kind = Kind::Number(Range::Positive, "s");

pub(super) static TIME_TABLE: Table = Table {
    about: "How long, in which steps: needed unless the flow is steady (`flow.algorithm = \"simple\"`), which is iterated, whatever is given here.",
    keys: &[
        optional("end", SECONDS, "`steps` tells", "End of the run.", "0.6"),
        optional(
            "steps",
            Kind::Whole(1, 1_000_000_000),
            "`end` tells",
            "So many steps of the length `dt` instead.",
            "1000",
        ),
        optional("dt", SECONDS, "the largest that is stable at the Courant number", "The step.", "1e-4"),
        optional(
            "courant",
            Kind::Number(Range::Above(0.0, 1.5), "1"),
            "0.1 with bodies that move, else 0.4",
            "Largest Courant number of an automatic step: one that exceeds it is repeated with a shorter one.",
            "0.25",
        ),
        optional(
            "ramp",
            Kind::Flag,
            "true with free bodies",
            "Do steps begin small and grow, as a start from rest wants it?",
            "false",
        ),
        optional(
            "stop",
            Kind::Table(&STOP),
            "at `end`",
            "Conditions of which the first to hold ends the run before its time; `ending` in the results tells which.",
            "{ steady = 1e-4 }",
        ),
    ],
};

static STOP: Table = Table {
    about: "The end of a run before its time, with a last snapshot. `siltflow resume` goes on from there with other conditions.",
    keys: &[
        optional(
            "steady",
            Kind::Number(Range::Positive, "1/s"),
            "none",
            "Rate of change of the flow: max|u − u of the step before| over all cells, over max|u| and the step. The run ends when it is below this (`ending` = \"steady\").",
            "1e-4",
        ),
        optional(
            "event",
            Kind::Formula(EVENT, "1"),
            "none",
            "The run ends when this formula is above 0 (`ending` = \"event\"): of the time t, the kinetic energy `energy` [J] of the flow (without `fluid` of the bodies), and place x, y, z [m] and velocity u, v, w [m/s] of `body`.",
            "\"0.01 - y\"",
        ),
        optional(
            "body",
            Kind::Text,
            "none",
            "Name of the body whose place and velocity `event` has.",
            "\"heavy\"",
        ),
    ],
};

/// Variables of an event.
pub(crate) const EVENT: &[&str] = &["t", "energy", "x", "y", "z", "u", "v", "w"];

const FIELD: Kind = Kind::Word(&[
    ("velocity", "velocity"),
    ("pressure", "pressure"),
    ("scalars", "scalars, and k and eddy viscosity of a turbulence model"),
    ("vorticity", "∇×u, in the plane its component along z"),
    ("q_criterion", "Q = (|Ω|² − |S|²)/2, positive in vortices"),
]);

pub(super) static OUTPUT: Table = Table {
    about: "What is written to the folder.",
    keys: &[
        optional(
            "folder",
            Kind::File,
            "out/NAME",
            "The folder, from where the program is started.",
            "\"out/cavity\"",
        ),
        optional(
            "snapshots",
            Kind::Whole(0, 1_000_000),
            "50",
            "Equal intervals of the run with a snapshot at each end; 0 writes the end alone.",
            "100",
        ),
        optional(
            "fields",
            Kind::Either(&[Kind::Flag, Kind::List(&FIELD, 0, 10)]),
            "true",
            "VTK files at the snapshots, for ParaView: λ, velocity, pressure, scalars and those of a turbulence model; or λ and the fields of a list. Vorticity and Q are of central differences of the velocity at the cells' centres, one-sided at bounded sides.",
            "[\"velocity\", \"pressure\", \"vorticity\", \"q_criterion\"]",
        ),
        optional(
            "bodies",
            Kind::Flag,
            "true",
            "VTK files of the bodies' surfaces and `trajectories.csv`.",
            "false",
        ),
        optional(
            "ledger",
            Kind::Flag,
            "true",
            "The books of momentum and energy in `result.json`, for bodies by \"projection\" or \"piso\" (not walls by cut links): 7 to 9 % of the time of a run.",
            "false",
        ),
        optional(
            "report",
            Kind::Flag,
            "true",
            "`report.html` at the end of the run, also of a stopped one: the run on one page that needs no other file; `siltflow report` makes it anew, also of several runs.",
            "false",
        ),
        optional("images", Kind::Flag, "true", "PNG pictures of plane scenes, or of a slice.", "false"),
        optional(
            "image_every",
            Kind::Whole(1, 1_000_000),
            "a twentieth of the snapshots",
            "A picture at every so many snapshots.",
            "10",
        ),
        optional(
            "quantity",
            Kind::Word(&[
                ("speed", "|u|"),
                ("u", "velocity along x"),
                ("v", "along y"),
                ("w", "along z"),
                ("pressure", "pressure"),
                ("vorticity", "of the plane"),
            ]),
            "speed",
            "What pictures show.",
            "\"vorticity\"",
        ),
        optional(
            "field",
            Kind::Text,
            "`quantity` tells",
            "What pictures show instead: a scalar by its name, or a turbulence model's k or eddy_viscosity.",
            "\"temperature\"",
        ),
        optional(
            "limits",
            Kind::List(&Kind::Number(Range::Any, ""), 2, 2),
            "those of each picture",
            "Ends of the colour bar, in the quantity's unit.",
            "[0.0, 0.03]",
        ),
        optional(
            "slice",
            Kind::Table(&SLICE),
            "normal to z, through the middle",
            "The slice that pictures of scenes in space show.",
            "{ normal = \"y\", at = 0.05 }",
        ),
        optional(
            "region",
            Kind::List(&Kind::List(&METRES, 2, 2), 2, 2),
            "all of it",
            "The part of the plane or slice that pictures show, from and to, across and up: the cells whose centres are in it.",
            "[[0.1, 0.4], [0.0, 0.2]]",
        ),
    ],
};

static SLICE: Table = Table {
    about: "A slice of a scene in space.",
    keys: &[
        optional(
            "normal",
            Kind::Word(&[("x", "x"), ("y", "y"), ("z", "z")]),
            "z",
            "The axis it is normal to.",
            "\"y\"",
        ),
        optional("at", METRES, "the middle of the box", "Where on that axis.", "0.05"),
    ],
};

pub(super) static WINDOW: Table = Table {
    about: "The box moves by whole cells along an axis, so that a body that moves (smooth forcing or hfdib, projection) keeps its place in it, for bodies that sink or rise for longer than a box can be. Places that are written are those in the laboratory. Fluid that comes in is as the last cells before it: ahead it has to be at rest or stream uniformly, behind it has to be able to flow out; the axis is not periodic and its cells are equal. Walls along the axis move with the box; bodies do not touch them. Other bodies must not be left behind; there are no scalars and no turbulence model.",
    keys: &[
        required("body", Kind::Text, "Name of the body.", "\"heavy\""),
        required("axis", Kind::Word(&[("x", "x"), ("y", "y"), ("z", "z")]), "The axis.", "\"y\""),
        optional(
            "place",
            Kind::Number(Range::Within(0.05, 0.95), "1"),
            "0.5",
            "Where it stays, as a share of the box's length from the lower end.",
            "0.75",
        ),
    ],
};

const NAME: Key = required("name", Kind::Text, "Name of the file.", "\"wake\"");

pub(super) static LINES: Table = Table {
    about: "A straight line along which velocity and pressure at equally spaced points go to `lines/NAME.csv` at every snapshot; sampled as at probes.",
    keys: &[
        NAME,
        required("from", POINT, "One end.", "[0.5, 0.0]"),
        required("to", POINT, "The other end.", "[0.5, 1.0]"),
        optional("points", Kind::Whole(2, 100_000), "101", "Points, with both ends.", "65"),
    ],
};

pub(super) static PROBES: Table = Table {
    about: "Points whose velocity and pressure go to `probes/NAME.csv`; on and near walls at rest (cut links, steady flow) from the fluid on their side.",
    keys: &[
        NAME,
        required("points", Kind::List(&POINT, 1, 10_000), "The points.", "[[0.15, 0.2], [0.25, 0.2]]"),
        optional("every", SECONDS, "every step", "How often.", "0.01"),
    ],
};

pub(super) static FORCES: Table = Table {
    about: "Loads of the fluid on bodies go to `forces.csv` at every step, and their means, deviations, amplitudes and frequencies to the results. \
            With a speed and an area there are coefficients C = 2F/(ρU²A), too.",
    keys: &[
        optional(
            "velocity",
            Kind::Number(Range::Positive, "m/s"),
            "no coefficients",
            "Reference speed U.",
            "0.2",
        ),
        optional(
            "area",
            LENGTH_OR_AREA,
            "no coefficients",
            "Reference area A (plane scenes: a length).",
            "0.1",
        ),
        optional(
            "length",
            Kind::Number(Range::Positive, "m"),
            "the area of a plane scene; none in space",
            "Reference length D of Strouhal numbers fD/U.",
            "0.1",
        ),
        optional(
            "start",
            Kind::Number(Range::NotNegative, "s"),
            "half of the run",
            "Means and amplitudes are taken from here on.",
            "5.0",
        ),
        optional(
            "every",
            SECONDS,
            "every step",
            "How often a line is written; means are of every step.",
            "0.01",
        ),
        optional(
            "parts",
            Kind::Flag,
            "false",
            "Pressure and friction of each load, as `px`, …, `vx`, … in `forces.csv` and as `pressure` and `friction` in the results: of walls by cut links integrals of the stress along the surface (polynomials of third degree through nodes in the fluid), whose sum differs from the load by their error; of a steady flow the sums over cut cells that are the load. Bodies by smooth forcing or hfdib have none: the force there is one distributed over cells on both sides of the surface, next to which velocity and pressure are smeared.",
            "true",
        ),
        optional(
            "surfaces",
            Kind::Flag,
            "false",
            "In plane scenes `surfaces/BODY.csv` at every snapshot: pressure, wall shear stress, c_p = 2(p − p₀)/(ρU²) and c_f = 2τ/(ρU²) along the surface by the angle about the centre of mass, of the same bodies as `parts`. τ is positive anticlockwise. It needs `velocity`.",
            "true",
        ),
        optional("pressure", Kind::Number(Range::Any, "Pa"), "0", "Reference pressure p₀ of c_p.", "0.0"),
    ],
};

const LENGTH_OR_AREA: Kind = Kind::Number(Range::Positive, "m²; m");

pub(super) static AVERAGES: Table = Table {
    about: "Means in time, written at the end of the run (`averages.vti`).",
    keys: &[
        optional("start", Kind::Number(Range::NotNegative, "s"), "half of the run", "When to begin.", "10.0"),
        optional(
            "profile",
            Kind::Word(&[("x", "along x"), ("y", "along y"), ("z", "along z"), ("none", "none")]),
            "none",
            "Means over the other axes as well, as a table along this one (`profile.csv`).",
            "\"y\"",
        ),
    ],
};

pub(super) static CHECKPOINT: Table = Table {
    about: "Saved states. The one before is kept, too.",
    keys: &[
        optional("every", SECONDS, "10", "Seconds of the wall clock between two of them.", "60.0"),
        optional(
            "at_end",
            Kind::Flag,
            "true",
            "One at the end, so that a longer run may go on from there?",
            "false",
        ),
    ],
};

pub(super) static REFERENCE: Table = Table {
    about: "A number of the results that others have measured or computed.",
    keys: &[
        required("name", Kind::Text, "What it is.", "\"drag coefficient\""),
        required(
            "pointer",
            Kind::Text,
            "Where it stands in `result.json`: a JSON pointer.",
            "\"/forces/0/coefficients/mean/0\"",
        ),
        required("value", Kind::Number(Range::Any, ""), "What it is there, in SI units.", "5.57953523384"),
        optional("source", Kind::Text, "none", "Its source.", "\"Schäfer & Turek 1996\""),
        optional(
            "tolerance",
            Kind::Number(Range::Positive, ""),
            "none",
            "Largest deviation that `siltflow table` allows, over the value unless that is 0.",
            "0.01",
        ),
    ],
};
