//! Turbulence models in flows whose walls are sides of the box, or bodies that move in it: against body-fitted runs of others, direct numerical simulation, and
//! measurements; what they cost, and what they bear. On one thread: `cargo bench --bench turbulence`, or with the names of cases after `--`.
//! Pictures go to `out/turbulence`.
mod bends;
mod channel;
mod couette;
mod eddies_in_channel;
mod first_cells;
mod forced;
mod large_eddies;
mod places;
mod plate;
mod robust;
mod shaken;
mod step;
mod turned;
mod warm;

use validation::{Outcome, run_cases};

fn main() -> Outcome<()> {
    run_cases(&[
        ("bends", bends::bends),
        ("channel", channel::against_simple_foam),
        ("dns", channel::against_dns),
        ("first_cells", first_cells::first_cells),
        ("forced", forced::forced),
        ("plate", plate::flat_plate),
        ("step", step::backward_facing_step),
        ("cost", robust::cost),
        ("robust", robust::bad_starts),
        ("places", places::places),
        ("tgv", large_eddies::taylor_green),
        ("les", eddies_in_channel::channel),
        ("turned", turned::turned_ducts),
        ("warm", warm::warm_ducts),
        ("couette", couette::sliding_plate),
        ("shaken", shaken::swinging_cylinder),
    ])
}
