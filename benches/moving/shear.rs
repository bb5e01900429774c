//! Free bodies in creeping shear against Jeffery (1922).
use render::cpu::Stopwatch;
use siltflow::ibm::Kernel;
use std::f64::consts::FRAC_PI_2;
use validation::reference_curve::passes;
use validation::sheared_body::{Shear, jeffery_angle, jeffery_period, orbit, settled_spin};
use validation::{Outcome, sheared_body};

const KERNELS: [(&str, Kernel); 3] =
    [("Yang", Kernel::Yang), ("quartic", Kernel::QuarticSpline), ("quintic", Kernel::QuinticSpline)];

/// Angular velocity of a sphere: half the shear rate.
pub(crate) fn sphere_in_shear() -> Outcome<()> {
    println!(
        "\nFree sphere in creeping shear, Re 0.1, box of 8 diameters: angular velocity over half the shear rate"
    );
    println!(
        "{:>10} {:>6} {:>5} {:>6} {:>9} {:>8} {:>8}",
        "kernel", "per D", "box", "step", "spin", "off", "CPU s"
    );
    let tell = |name: &str, shear: &Shear, dt_factor: f64| -> Outcome<()> {
        let watch = Stopwatch::start();
        let spin = settled_spin(shear, dt_factor, [1.0, 1.2])?;
        println!(
            "{name:>10} {:>6} {:>5} {dt_factor:>6} {spin:>9.5} {:>7.2}% {:>8.1}",
            shear.cells_per_diameter,
            shear.edge,
            100.0 * (spin - 1.0),
            watch.elapsed().cpu
        );
        Ok(())
    };
    for (name, kernel) in KERNELS {
        let kernel = Some(kernel);
        for cells_per_diameter in [8, 12, 16] {
            tell(name, &Shear { cells_per_diameter, kernel, ..Shear::default() }, 1.0)?;
        }
    }
    // What else might matter: the step, the box.
    tell("suited", &Shear::default(), 1.0)?;
    tell("suited", &Shear::default(), 0.5)?;
    tell("suited", &Shear { edge: 12.0, ..Shear::default() }, 1.0)
}

/// The orbit of a spheroid of aspect ratio 2.
pub(crate) fn jeffery_orbit() -> Outcome<()> {
    println!(
        "\nProlate spheroid of aspect ratio 2 in creeping shear, Re 0.1, box of 10 short diameters: a quarter of a turn"
    );
    println!(
        "{:>6} {:>10} {:>8} {:>12} {:>12} {:>8} {:>8}",
        "per D", "period", "off", "phi off deg", "rate off", "steps", "CPU s"
    );
    for cells_per_diameter in [8, 10, 12] {
        let watch = Stopwatch::start();
        let shear = Shear { aspect: 2.0, edge: 10.0, cells_per_diameter, ..Shear::default() };
        let series = orbit(&shear, 1.0)?;
        let Orbit { period, angle, rate } = Orbit::of(&series, 2.0)?;
        println!(
            "{cells_per_diameter:>6} {period:>10.4} {:>7.2}% {:>12.3} {:>11.2}% {:>8} {:>8.1}",
            100.0 * (period / jeffery_period(2.0) - 1.0),
            angle.to_degrees(),
            100.0 * rate,
            series.len() - 1,
            watch.elapsed().cpu
        );
    }
    Ok(())
}

/// An orbit beside Jeffery's.
struct Orbit {
    /// Four times the time from 0 to 90°, times the shear rate.
    period: f64,
    /// Largest difference of φ between 0 and 90°.
    angle: f64,
    /// Largest difference of φ̇, over γ̇/2, when φ̇ is taken over a twentieth of the quarter.
    rate: f64,
}

impl Orbit {
    fn of(series: &[(f64, f64)], aspect: f64) -> Outcome<Self> {
        let upright = passes(series, 0.0).ok_or("the axis never stood upright")?;
        let level = passes(series, FRAC_PI_2).ok_or("the axis never lay level")?;
        let quarter = series.iter().filter(|p| p.0 >= upright && p.0 <= level);
        let off = |p: &(f64, f64)| (p.1 - jeffery_angle(aspect, p.0 - upright)).abs();
        let angle = quarter.map(off).fold(0.0, f64::max);
        let span = (level - upright) / 20.0;
        let at = |t: f64| validation::reference_curve::at(series, t).unwrap_or(f64::NAN);
        let rate = (0..20)
            .map(|i| {
                let (from, to) = (upright + span * f64::from(i), upright + span * f64::from(i + 1));
                let (phi, next) = (at(from), at(to));
                let exact = sheared_body::jeffery_rate(aspect, 0.5 * (phi + next));
                ((next - phi) / span - exact).abs() / 0.5
            })
            .fold(0.0, f64::max);
        Ok(Self { period: 4.0 * (level - upright), angle, rate })
    }
}
