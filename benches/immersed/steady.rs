//! Steady flows past bodies of exact or published drag: eccentric cylinders, a cylinder across a duct, a sphere in a stream.
use crate::STEADY;
use render::cpu::Stopwatch;
use validation::Outcome;
use validation::duct_cylinder::{self, DRAG, DROP, LIFT};
use validation::eccentric_cylinders::EccentricCylinders;
use validation::sphere_stream::{self, REFERENCES};
use validation::walled_flows::{settle, surface_loads, velocity_errors};

pub(crate) fn eccentric() -> Outcome<()> {
    println!(
        "\nCreeping flow between eccentric cylinders (Wannier 1950), the inner one turns: largest and rms error of the velocity over the \
         speed of its surface, errors of the torque on it and of the force across the line of centres; force along it over that; by the \
         stress on its surface"
    );
    println!(
        "{:>6} {:>6} {:>10} {:>6} {:>10} {:>6} {:>9} {:>9} {:>10} {:>9} {:>9} {:>7} {:>7}",
        "cells",
        "moved",
        "max",
        "order",
        "rms",
        "order",
        "torque",
        "force",
        "along",
        "torque",
        "force",
        "steps",
        "CPU s"
    );
    for shift in [0.0, 0.3] {
        let mut last = [f64::NAN; 2];
        for cells in [32, 64, 128] {
            let watch = Stopwatch::start();
            let mut case = EccentricCylinders::new(cells, [shift, 0.7 * shift])?;
            settle(&mut case.flow, [0.0; 2], [5e-3, STEADY], |flow| {
                flow.wall_impulses()[0].torque.z / flow.last_dt()
            })?;
            let load = case.flow.wall_impulses()[0] * (1.0 / case.flow.last_dt());
            let errors =
                velocity_errors(&case.flow, |x| case.exact(x)).map(|e| e * EccentricCylinders::SCALE);
            let order = [0, 1].map(|i| (last[i] / errors[i]).log2());
            last = errors;
            let [force, torque] = case.exact_load();
            let surface = surface_loads(&case.flow, &case.bodies, 0, 0.0)?.total();
            let [there, _] = case.parts([surface.force.x, surface.force.y]);
            let [across, along] = case.parts([load.force.x, load.force.y]);
            println!(
                "{cells:>6} {shift:>6} {:>10.2e} {:>6.2} {:>10.2e} {:>6.2} {:>8.3}% {:>8.3}% {:>10.1e} {:>8.2}% {:>8.2}% {:>7} {:>7.2}",
                errors[0],
                order[0],
                errors[1],
                order[1],
                100.0 * (load.torque.z / torque - 1.0),
                100.0 * (across / force - 1.0),
                along / force,
                100.0 * (surface.torque.z / torque - 1.0),
                100.0 * (there / force - 1.0),
                case.flow.steps(),
                watch.elapsed().cpu
            );
        }
    }
    Ok(())
}

pub(crate) fn duct() -> Outcome<()> {
    println!(
        "\nCylinder across a duct, Re 20, cut links with QUICK on gathered cells: Cd {DRAG} and Cl {LIFT} wanted, Δp in {DROP:?}"
    );
    println!(
        "{:>6} {:>8} {:>11} {:>9} {:>8} {:>9} {:>10} {:>8} {:>8} {:>9} {:>7} {:>8}",
        "per D", "cells", "moved", "Cd", "error", "surface", "Cl", "error", "surface", "Δp", "steps", "CPU s"
    );
    for shift in [[0.0, 0.0], [0.37, 0.3]] {
        let mut coarser = None;
        // What is fine takes half an hour.
        for per_diameter in if shift[0] > 0.0 { vec![10, 14, 20] } else { vec![10] } {
            let found = duct_cylinder::run(per_diameter, shift, coarser.as_ref())?;
            let ([drag, lift], [drag_there, lift_there]) = (found.coefficients, found.surface);
            println!(
                "{per_diameter:>6} {:>8} {:>5.2} {:>5.2} {drag:>9.5} {:>7.3}% {:>8.2}% {lift:>10.6} {:>7.1}% {:>7.1}% {:>9.5} {:>7} {:>8.1}",
                found.cells,
                shift[0],
                shift[1],
                100.0 * (drag / DRAG - 1.0),
                100.0 * (drag_there / DRAG - 1.0),
                100.0 * (lift / LIFT - 1.0),
                100.0 * (lift_there / LIFT - 1.0),
                found.drop,
                found.steps,
                found.cpu
            );
            coarser = Some(found.flow);
        }
    }
    Ok(())
}

pub(crate) fn sphere() -> Outcome<()> {
    spheres_in_streams(&REFERENCES, &[10, 14, 20])
}

/// The wake at Re 25, 0.07 D long, needs finer cells.
pub(crate) fn bubble() -> Outcome<()> {
    spheres_in_streams(&REFERENCES[..1], &[10, 14, 20, 40])
}

fn spheres_in_streams(references: &[[f64; 4]], resolutions: &[usize]) -> Outcome<()> {
    println!(
        "\nSphere in a free stream, cut links with QUICK on gathered cells, a quarter of it: errors of the drag against Johnson & Patel \
         and against axisymmetric solutions, as that of the wake; the drag by the stress on its surface, and by \
         the momentum that enters a box around it"
    );
    println!(
        "{:>4} {:>6} {:>8} {:>8} {:>8} {:>8} {:>9} {:>9} {:>8} {:>8} {:>6} {:>7} {:>8}",
        "Re",
        "per D",
        "cells",
        "Cd",
        "J & P",
        "axisymm",
        "surface",
        "around",
        "wake/D",
        "axisymm",
        "time",
        "steps",
        "CPU s"
    );
    for &[reynolds, published, drag, wake] in references {
        let mut coarser = None;
        for &per_diameter in resolutions {
            let found = sphere_stream::run(reynolds, per_diameter, 0.37, coarser.as_ref())?;
            println!(
                "{reynolds:>4} {per_diameter:>6} {:>8} {:>8.4} {:>7.2}% {:>7.2}% {:>8.2}% {:>8.2}% {:>8.3} {:>7.1}% {:>6.0} {:>7} {:>8.1}",
                found.cells,
                found.drag,
                100.0 * (found.drag / published - 1.0),
                100.0 * (found.drag / drag - 1.0),
                100.0 * (found.surface / found.drag - 1.0),
                100.0 * (found.around / found.drag - 1.0),
                found.wake,
                100.0 * (found.wake / wake - 1.0),
                found.time,
                found.steps,
                found.cpu
            );
            coarser = Some(found.flow);
        }
    }
    Ok(())
}
