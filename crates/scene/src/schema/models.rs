//! Reduced models of a run.
use super::{Kind, Range, Table, optional, required};

pub(super) static MODEL: Table = Table {
    about: "A reduced model of one field: modes of its snapshots (`output.snapshots`) and functions of time for their coefficients. With `frames` the modes move along with bodies \
            (sPODIANN, shifted POD), else they stay where they are (PODIANN, POD). Files are in `models`: `FIELD.npy` with the snapshots, `NAME.model` to predict with (`mor::models`), \
            its modes for ParaView and a picture beside the run.",
    keys: &[
        required("name", Kind::Text, "What its files are called.", "\"solid\""),
        required(
            "field",
            Kind::Text,
            "lambda, velocity, pressure, a scalar by its name, or a turbulence model's k or eddy_viscosity.",
            "\"velocity\"",
        ),
        optional(
            "frames",
            Kind::List(&Kind::Text, 0, 20),
            "modes that stay where they are",
            "Names of the bodies that modes move along with; every axis needs equal cells then.",
            "[\"upper\", \"lower\"]",
        ),
        optional("turning", Kind::Flag, "false", "Do the modes turn with these bodies, too?", "true"),
        optional(
            "ranks",
            Kind::List(&Kind::Whole(1, 1000), 1, 20),
            "as many as the tolerance asks for",
            "Modes: one number, or one for each frame.",
            "[5, 5]",
        ),
        optional(
            "tolerance",
            Kind::Number(Range::Above(0.0, 0.5), "1"),
            "1e-3",
            "Relative error of the modes, where ranks are not given; at most 100 modes, or 20 for each frame.",
            "1e-2",
        ),
        optional(
            "interpolation",
            Kind::Word(&[
                ("spectral", "as if the box were periodic"),
                ("linear", "first order"),
                ("cubic", "third order"),
                ("quintic", "fifth order"),
            ]),
            "spectral",
            "How modes are shifted between cells.",
            "\"cubic\"",
        ),
        optional(
            "coefficients",
            Kind::Word(&[
                ("best", "what predicts held-out samples best"),
                ("network", "a multilayer perceptron"),
                ("spline", "splines"),
            ]),
            "best",
            "The functions of time.",
            "\"network\"",
        ),
        optional(
            "hidden",
            Kind::List(&Kind::Whole(1, 1000), 1, 10),
            "two of 24",
            "Neurons of the network's hidden layers.",
            "[24, 24]",
        ),
        optional(
            "every",
            Kind::Whole(1, 1000),
            "2",
            "One of so many snapshots makes the model; it is tested on the others.",
            "4",
        ),
    ],
};
