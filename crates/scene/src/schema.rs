//! What a scene file may hold. These tables are the only place where keys are listed: files are checked against them, and the manual
//! (docs/scene.md) and the JSON schema (scenes/schema.json) are made of them.
mod bodies;
mod check;
mod contact;
mod factories;
mod flow;
mod json;
mod manual;
mod models;
mod physics;
mod run;

pub(crate) use check::{FileKey, check, number, whole};
pub use json::json_schema;
pub use manual::manual;
pub(crate) use run::EVENT;

/// A table of a scene file.
#[derive(Debug)]
pub(crate) struct Table {
    pub(crate) about: &'static str,
    pub(crate) keys: &'static [Key],
}

/// A key of a table.
#[derive(Debug)]
pub(crate) struct Key {
    pub(crate) name: &'static str,
    pub(crate) kind: Kind,
    pub(crate) need: Need,
    pub(crate) about: &'static str,
    /// As it may stand behind the equals sign.
    pub(crate) example: &'static str,
}

/// May a key be left out?
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Need {
    Required,
    /// Yes; this is what holds then.
    Default(&'static str),
}

/// What a key takes.
#[derive(Debug)]
pub(crate) enum Kind {
    /// `true` or `false`.
    Flag,
    /// A number with its unit.
    Number(Range, &'static str),
    /// A whole number between two bounds.
    Whole(i64, i64),
    /// Any text.
    Text,
    /// The path of a file, from the folder of the scene.
    File,
    /// A number, or a text with a formula of these variables, and the unit of what it gives.
    Formula(&'static [&'static str], &'static str),
    /// One of these words, each with what it means.
    Word(&'static [(&'static str, &'static str)]),
    /// So many of the same.
    List(&'static Kind, usize, usize),
    /// A table.
    Table(&'static Table),
    /// Any number of tables under names of one's own.
    Named(&'static Table),
    /// A table whose key with this name tells which of these tables it is. The word alone stands for a table that says nothing else.
    Choice(&'static str, &'static [(&'static str, &'static Table)]),
    /// One of several kinds.
    Either(&'static [Kind]),
}

/// Numbers that make sense.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Range {
    Any,
    Positive,
    NotNegative,
    /// Bounds included.
    Within(f64, f64),
    /// The first bound excluded.
    Above(f64, f64),
}

impl Range {
    pub(crate) fn holds(self, x: f64) -> bool {
        x.is_finite()
            && match self {
                Self::Any => true,
                Self::Positive => x > 0.0,
                Self::NotNegative => x >= 0.0,
                Self::Within(a, b) => (a..=b).contains(&x),
                Self::Above(a, b) => x > a && x <= b,
            }
    }
    /// What to give, as a phrase.
    pub(crate) fn phrase(self) -> String {
        match self {
            Self::Any => "a finite number".into(),
            Self::Positive => "a number above 0".into(),
            Self::NotNegative => "0 or a number above".into(),
            Self::Within(a, b) => format!("a number from {a} to {b}"),
            Self::Above(a, b) => format!("a number above {a}, at most {b}"),
        }
    }
}

/// A key that must be given.
const fn required(name: &'static str, kind: Kind, about: &'static str, example: &'static str) -> Key {
    Key { name, kind, need: Need::Required, about, example }
}

/// A key that may be left out, and what holds then.
const fn optional(
    name: &'static str,
    kind: Kind,
    default: &'static str,
    about: &'static str,
    example: &'static str,
) -> Key {
    Key { name, kind, need: Need::Default(default), about, example }
}

/// Variables of formulas in space and time.
const SPACE_TIME: &[&str] = &["x", "y", "z", "t"];
const SPACE: &[&str] = &["x", "y", "z"];
const TIME: &[&str] = &["t"];

const METRES: Kind = Kind::Number(Range::Any, "m");
const LENGTH: Kind = Kind::Number(Range::Positive, "m");
const POINT: Kind = Kind::List(&METRES, 2, 3);

/// The whole file.
pub(crate) static SCENE: Table = Table {
    about: "A scene. Numbers are in SI units. Any number may be given as a formula without variables in quotes, \"2*PI/3\", which is evaluated once. Formulas may use + - * / ^, sin, cos, tan, asin, acos, atan, atan2(y, x), sinh, cosh, tanh, exp, \
            log, ln, log10, sqrt, cbrt, abs, sign, floor, ceil, round, step (0 before 0, then 1), min(a, b), max(a, b), mod(a, b), PI and E. A formula −x^2 is −(x²).",
    keys: &[
        optional(
            "title",
            Kind::Text,
            "the file's name",
            "What stands above pictures and results.",
            "\"Cavity\"",
        ),
        optional(
            "about",
            Kind::Text,
            "nothing",
            "What the scene is for, with its source.",
            "\"After Ghia (1982).\"",
        ),
        required(
            "grid",
            Kind::Table(&flow::GRID),
            "The box and its cells.",
            "{ cells = [64, 64], size = [1.0, 1.0] }",
        ),
        required(
            "sides",
            Kind::Table(&flow::SIDES),
            "What happens at the sides of the box.",
            "{ x = \"periodic\", y = \"wall\" }",
        ),
        optional(
            "fluid",
            Kind::Table(&flow::FLUID),
            "no fluid: bodies alone, under gravity and contacts; the cells are those of pictures",
            "The fluid.",
            "{ density = 1000.0, nu = 1e-6 }",
        ),
        optional(
            "gravity",
            Kind::List(&Kind::Number(Range::Any, "m/s²"), 2, 3),
            "none",
            "Gravity; bodies feel it less their buoyancy.",
            "[0.0, -9.81]",
        ),
        optional(
            "force",
            Kind::List(&Kind::Formula(TIME, "m/s²"), 2, 3),
            "none",
            "Body force per mass of fluid, the same everywhere.",
            "[\"0.1*min(t, 1)\", 0.0]",
        ),
        optional(
            "flow_rate",
            Kind::Table(&flow::FLOW_RATE),
            "none",
            "Mean velocity that a further body force holds.",
            "{ axis = \"x\", velocity = 0.1 }",
        ),
        optional(
            "initial",
            Kind::Table(&flow::INITIAL),
            "fluid at rest",
            "The flow at time 0.",
            "{ velocity = [\"sin(y)\", 0.0] }",
        ),
        optional(
            "flow",
            Kind::Table(&flow::FLOW),
            "all its defaults",
            "How the flow is computed.",
            "{ convection = \"quick\" }",
        ),
        optional(
            "turbulence",
            Kind::Choice("model", &physics::TURBULENCE),
            "none",
            "A turbulence model.",
            "{ model = \"sst\", intensity = 0.05, length = 0.07 }",
        ),
        optional(
            "scalars",
            Kind::Named(&physics::SCALAR),
            "none",
            "Scalars by name.",
            "{ temperature = { diffusivity = 2e-5 } }",
        ),
        optional(
            "materials",
            Kind::Named(&bodies::MATERIAL),
            "none",
            "Materials of bodies by name.",
            "{ steel = { density = 7800.0 } }",
        ),
        optional(
            "bodies",
            Kind::List(&Kind::Table(&bodies::BODY), 0, 100_000),
            "none",
            "Bodies, one by one.",
            "[{ shape = { type = \"disc\", radius = 5e-4 }, density = 1060.0, position = [5e-3, 1.6e-2] }]",
        ),
        optional(
            "factories",
            Kind::List(&Kind::Choice("type", &factories::FACTORIES), 0, 1000),
            "none",
            "Many bodies at once: on lattices, at random, from tables, or flowing in while the run is on its way.",
            "[{ type = \"random\", number = 50, shape = { type = \"sphere\", radius = 1e-3 }, density = 2500.0, seed = 1 }]",
        ),
        optional(
            "exits",
            Kind::List(&Kind::Table(&contact::EXIT), 0, 100),
            "none",
            "Half-spaces, their normals pointing out of them: a body whose centre is in one is removed at the next step. They may be at, inside or beyond open sides of the box, which bodies pass as far as an exit is ahead of them; a body partly outside is forced where there is fluid.",
            "[{ point = [0.0, 1e-3], normal = [0.0, 1.0] }]",
        ),
        optional(
            "contact",
            Kind::Table(&contact::CONTACT),
            "all its defaults",
            "Contacts of bodies.",
            "{ law = \"potential\" }",
        ),
        optional(
            "lubrication",
            Kind::Table(&contact::LUBRICATION),
            "none",
            "Films between bodies that are closer than two cells (in space).",
            "{ roughness = 1e-6 }",
        ),
        optional(
            "coupling",
            Kind::Table(&contact::COUPLING),
            "all its defaults",
            "How flow and bodies act on one another.",
            "{ balance = \"net-weight\" }",
        ),
        optional(
            "window",
            Kind::Table(&run::WINDOW),
            "the box stays",
            "A box that follows a body.",
            "{ body = \"heavy\", axis = \"y\" }",
        ),
        optional(
            "time",
            Kind::Table(&run::TIME_TABLE),
            "none, for a steady flow",
            "How long, in which steps.",
            "{ end = 0.6 }",
        ),
        optional(
            "output",
            Kind::Table(&run::OUTPUT),
            "all its defaults",
            "What is written, and how often.",
            "{ snapshots = 100, images = true }",
        ),
        optional(
            "probes",
            Kind::List(&Kind::Table(&run::PROBES), 0, 100),
            "none",
            "Points where the flow is written down.",
            "[{ name = \"wake\", points = [[0.3, 0.2]] }]",
        ),
        optional(
            "lines",
            Kind::List(&Kind::Table(&run::LINES), 0, 100),
            "none",
            "Straight lines along which the flow is written down.",
            "[{ name = \"centre\", from = [0.5, 0.0], to = [0.5, 1.0] }]",
        ),
        optional(
            "forces",
            Kind::Table(&run::FORCES),
            "none",
            "Loads on bodies, step by step, with means and amplitudes.",
            "{ velocity = 0.2, area = 0.1, start = 5.0 }",
        ),
        optional(
            "averages",
            Kind::Table(&run::AVERAGES),
            "none",
            "Means in time of velocity and pressure, and the Reynolds stresses.",
            "{ start = 10.0 }",
        ),
        optional(
            "models",
            Kind::List(&Kind::Table(&models::MODEL), 0, 100),
            "none",
            "Reduced models of the run's snapshots, made at its end.",
            "[{ name = \"solid\", field = \"lambda\", frames = [\"upper\", \"lower\"] }]",
        ),
        optional(
            "references",
            Kind::List(&Kind::Table(&run::REFERENCE), 0, 100),
            "none",
            "Numbers that results are set beside.",
            "[{ name = \"drag\", pointer = \"/forces/0/coefficients/mean/0\", value = 5.5795 }]",
        ),
        optional(
            "checkpoint",
            Kind::Table(&run::CHECKPOINT),
            "all its defaults",
            "Saved states, from which `siltflow resume` goes on.",
            "{ every = 60.0 }",
        ),
    ],
};

#[cfg(test)]
mod tests {
    use super::*;

    /// Every example stands for itself: the manual is right.
    #[test]
    fn examples_are_what_the_keys_take() {
        let mut seen = 0;
        walk(&SCENE, "", &mut Vec::new(), &mut |path, key| {
            let text = format!("value = {}", key.example);
            let document = crate::document::Document::parse(path, &text, &[]);
            let document = document.unwrap_or_else(|e| panic!("{path}: {e}"));
            let item = document.root.get("value").unwrap();
            let mut found = check::Findings::default();
            check::check_item(item, &key.kind, path, &mut found);
            assert!(found.problems.is_empty(), "{path}: {}", document.problems(found.problems));
            seen += 1;
        });
        assert!(seen > 150, "{seen}");
    }

    fn walk(
        table: &'static Table,
        path: &str,
        on_way: &mut Vec<*const Table>,
        f: &mut impl FnMut(&str, &Key),
    ) {
        if on_way.contains(&std::ptr::from_ref(table)) {
            return;
        }
        on_way.push(table);
        for key in table.keys {
            let path = if path.is_empty() { key.name.into() } else { format!("{path}.{}", key.name) };
            f(&path, key);
            inner(&key.kind, &path, on_way, f);
        }
        on_way.pop();
    }

    fn inner(
        kind: &'static Kind,
        path: &str,
        on_way: &mut Vec<*const Table>,
        f: &mut impl FnMut(&str, &Key),
    ) {
        match kind {
            Kind::Table(table) | Kind::Named(table) => walk(table, path, on_way, f),
            Kind::List(of, ..) => inner(of, path, on_way, f),
            Kind::Either(kinds) => kinds.iter().for_each(|kind| inner(kind, path, on_way, f)),
            Kind::Choice(_, of) => {
                of.iter().for_each(|(name, table)| walk(table, &format!("{path}({name})"), on_way, f));
            }
            _ => {}
        }
    }
}
