//! Immersed walls against exact and published values: plane Poiseuille flow turned against the grid (`channel`; `forced-channel` with
//! `SmoothForcing`), flow between cylinders (`couette`; `eccentric`), simple-cubic arrays of `spheres`, the cylinders of Schäfer & Turek in
//! the plane (`cylinder`) and in a `duct`, a cylinder in a `stream`, a `sphere` in one (`bubble`: its smallest wake, 40 CPU minutes); and what walls and forcings `cost`. On one
//! thread: `cargo bench --bench immersed`, or with the names of cases after `--`.
mod cost;
mod steady;

use render::cpu::Stopwatch;
use siltflow::flow::Convection;
use siltflow::ibm::{Kernel, SmoothForcing};
use validation::channel_cylinder::{self, Cells, DRAG, Found, LIFT, Way};
use validation::free_stream;
use validation::walled_flows::{
    COUETTE_TORQUE, ForcedChannel, SphereArray, TurnedChannel, couette, couette_velocity, settle,
    surface_loads, velocity_errors,
};
use validation::{Outcome, run_cases};

/// Flows are steady when they change by less than this part.
const STEADY: f64 = 1e-6;

fn main() -> Outcome<()> {
    run_cases(&[
        ("channel", channel),
        ("forced-channel", forced_channel),
        ("couette", cylinders),
        ("eccentric", steady::eccentric),
        ("spheres", spheres),
        ("cylinder", cylinder),
        ("duct", steady::duct),
        ("stream", stream),
        ("sphere", steady::sphere),
        ("bubble", steady::bubble),
        ("cost", cost::table),
    ])
}

fn channel() -> Outcome<()> {
    println!(
        "\nPlane Poiseuille flow turned against the grid: error of the flow rate, largest of the velocity over its maximum"
    );
    println!("{:>6} {:>6} {:>9} {:>9} {:>8} {:>7}", "angle", "cells", "flow", "velocity", "faces", "CPU s");
    for degrees in [10.0, 20.0, 30.0, 40.0] {
        for cells in [10, 20, 40] {
            let watch = Stopwatch::start();
            let mut channel = TurnedChannel::new(degrees, cells)?;
            let mean = channel.mean(STEADY)?;
            let [worst, _] = velocity_errors(&channel.flow, |x| channel.exact(x));
            println!(
                "{degrees:>6} {cells:>6} {:>8.3}% {:>8.3}% {:>8} {:>7.2}",
                100.0 * (mean - 1.0),
                100.0 * worst / 1.5,
                channel.faces,
                watch.elapsed().cpu
            );
        }
    }
    Ok(())
}

fn forced_channel() -> Outcome<()> {
    println!(
        "\nThe same by smooth forcing: error of the flow rate of the channel; what flows in the banks, too, over it"
    );
    println!(
        "{:>14} {:>6} {:>6} {:>9} {:>9} {:>7}",
        "kernel", "angle", "cells", "channel", "with banks", "CPU s"
    );
    for kernel in [Kernel::Yang, Kernel::QuarticSpline, Kernel::QuinticSpline] {
        for degrees in [10.0, 20.0, 30.0, 40.0] {
            for cells in [10, 20, 40] {
                let watch = Stopwatch::start();
                let forcing = SmoothForcing::new(1.0).with_kernel(kernel);
                let [rate, all] = ForcedChannel::new(degrees, cells, forcing)?.rates(STEADY)?;
                println!(
                    "{:>14} {degrees:>6} {cells:>6} {:>8.3}% {:>8.3}% {:>7.2}",
                    format!("{kernel:?}"),
                    100.0 * (rate - 1.0),
                    100.0 * (all - 1.0),
                    watch.elapsed().cpu
                );
            }
        }
    }
    Ok(())
}

fn cylinders() -> Outcome<()> {
    println!(
        "\nTaylor–Couette flow: largest and rms error of the velocity, error of the torques on inner and outer wall, by momentum \
         and by the stress on their surfaces"
    );
    println!(
        "{:>6} {:>6} {:>10} {:>10} {:>9} {:>9} {:>9} {:>9} {:>7}",
        "cells", "moved", "max", "rms", "inner", "outer", "inner", "outer", "CPU s"
    );
    for shift in [0.0, 0.3] {
        for cells in [32, 64, 128] {
            let watch = Stopwatch::start();
            let (mut flow, bodies) = couette(cells, [shift, 0.7 * shift])?;
            let inner = settle(&mut flow, [0.0; 2], [0.05, STEADY], |flow| {
                flow.wall_impulses()[0].torque.z / flow.last_dt()
            })?;
            let outer = flow.wall_impulses()[1].torque.z / flow.last_dt();
            let [worst, rms] = velocity_errors(&flow, couette_velocity);
            let surface = |b| -> Outcome<f64> { Ok(surface_loads(&flow, &bodies, b, 0.0)?.total().torque.z) };
            let error = |torque: f64| 100.0 * (torque / COUETTE_TORQUE - 1.0);
            println!(
                "{cells:>6} {shift:>6} {worst:>10.2e} {rms:>10.2e} {:>8.3}% {:>8.3}% {:>8.3}% {:>8.3}% {:>7.2}",
                error(-inner),
                error(outer),
                error(-surface(0)?),
                error(surface(1)?),
                watch.elapsed().cpu
            );
        }
    }
    Ok(())
}

fn spheres() -> Outcome<()> {
    println!(
        "\nSimple-cubic arrays of spheres in Stokes flow: K = F/(6πμaU), against Zick & Homsy (1982); by the stress on the surface"
    );
    println!(
        "{:>7} {:>8} {:>6} {:>8} {:>8} {:>9} {:>9} {:>8} {:>7}",
        "φ", "cells/D", "cells", "K", "theirs", "error", "surface", "faces", "CPU s"
    );
    for (fraction, theirs) in [(0.125, 4.292), (0.343, 15.4)] {
        for per_diameter in [12.0, 24.0] {
            let watch = Stopwatch::start();
            let cells = (per_diameter / (2.0 * SphereArray::radius(fraction))).round() as usize;
            let mut array = SphereArray::new(fraction, cells)?;
            let k = array.drag_factor(STEADY)?;
            let drag = surface_loads(&array.flow, &array.bodies, 0, 0.0)?.total().force.x;
            println!(
                "{fraction:>7} {:>8.1} {cells:>6} {k:>8.3} {theirs:>8} {:>8.2}% {:>8.2}% {:>8} {:>7.1}",
                2.0 * array.radius * cells as f64,
                100.0 * (k / theirs - 1.0),
                // What of the force is spread over the sphere's volume does not pass its surface.
                100.0 * (k * (drag / SphereArray::FORCE + fraction) / theirs - 1.0),
                array.faces,
                watch.elapsed().cpu
            );
        }
    }
    Ok(())
}

fn cylinder() -> Outcome<()> {
    println!("\nCylinder in a channel, Re 20: Cd {DRAG:.6} and Cl {LIFT:.6} wanted");
    println!(
        "{:>22} {:>15} {:>6} {:>7} {:>11} {:>9} {:>9} {:>9} {:>9} {:>10} {:>9} {:>9} {:>9} {:>9} {:>7} {:>8}",
        "way",
        "cells",
        "per D",
        "number",
        "moved",
        "Cd",
        "error",
        "surface",
        "around",
        "Cl",
        "error",
        "surface",
        "around",
        "Δp",
        "steps",
        "CPU s"
    );
    let shifts = [[0.0, 0.0], [0.37, 0.3], [0.5, 0.5]];
    let [central, quick] = [Convection::Central, Convection::Quick].map(Way::CutLinks);
    let gathered = Cells::Gathered(1.05);
    for (way, kind) in [
        (central, gathered),
        (quick, gathered),
        (central, Cells::Equal),
        (quick, Cells::Equal),
        (Way::Smooth, Cells::Equal),
        (Way::Hfdib, Cells::Equal),
    ] {
        for per_diameter in [10, 20, 40] {
            // Fine grids of equal cells take minutes.
            let few = per_diameter == 40 && matches!(kind, Cells::Equal);
            for shift in &shifts[..if few { 1 } else { 3 }] {
                let found = channel_cylinder::run(way, kind, per_diameter, *shift)?;
                let Found { cells, errors, coefficients: [drag, lift], surface, around, steps, cpu } = found;
                let [drag_around, lift_around] = around.map(|e| 100.0 * e);
                let [drag_there, lift_there] = surface.map(|e| 100.0 * e);
                let [drag_error, lift_error, drop_error] = errors.map(|e| 100.0 * e);
                println!(
                    "{:>22} {:>15} {per_diameter:>6} {cells:>7} {:>5.2} {:>5.2} {drag:>9.5} {drag_error:>8.3}% \
                     {drag_there:>8.2}% {drag_around:>8.2}% {lift:>10.6} {lift_error:>8.1}% {lift_there:>8.1}% {lift_around:>8.1}% {drop_error:>8.2}% {steps:>7} {cpu:>8.2}",
                    way.to_string(),
                    format!("{kind:?}"),
                    shift[0],
                    shift[1]
                );
            }
        }
    }
    Ok(())
}

fn stream() -> Outcome<()> {
    println!(
        "\nCylinder in a free stream, cut links with QUICK on gathered cells; the drag by the stress on its surface at the end"
    );
    println!(
        "{:>4} {:>6} {:>7} {:>8} {:>9} {:>8} {:>8} {:>9} {:>7} {:>7}",
        "Re", "per D", "cells", "Cd", "surface", "wake/D", "Cl", "St", "steps", "CPU s"
    );
    for (reynolds, end) in [(20.0, 60.0), (40.0, 80.0), (100.0, 200.0)] {
        for per_diameter in [10, 20] {
            let found = free_stream::run(reynolds, per_diameter, end)?;
            println!(
                "{reynolds:>4} {per_diameter:>6} {:>7} {:>8.4} {:>8.2}% {:>8.3} {:>8.4} {:>9.4} {:>7} {:>7.1}",
                found.cells,
                found.drag,
                100.0 * (found.surface / found.drag_at_end - 1.0),
                found.wake,
                found.lift,
                found.strouhal,
                found.steps,
                found.cpu
            );
        }
    }
    Ok(())
}
