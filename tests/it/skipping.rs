//! What a scene does not need costs nothing. Instructions are counted by docs/skipping.sh.
use siltflow::coupling::{Simulation, WeightBalance};
use siltflow::flow::Projection;
use siltflow::ibm::{Hfdib, SmoothForcing};
use siltflow::interfaces::Freedom;
use validation::falling_discs::{FLUID, FallingDiscs};

#[test]
fn a_static_body_is_projected_once() {
    let scene = FallingDiscs { cells_per_diameter: 8, freedom: Freedom::NONE, ..FallingDiscs::default() };
    let mut simulation = scene.build(SmoothForcing::new(FLUID.density)).unwrap();
    for _ in 0..10 {
        simulation.step(1e-4).unwrap();
    }
    // Two bodies, two velocity components.
    assert_eq!(simulation.particles.forcing.updates(), 4);
    let mut moving =
        FallingDiscs { freedom: Freedom::PLANAR, ..scene }.build(SmoothForcing::new(FLUID.density)).unwrap();
    for _ in 0..10 {
        moving.step(1e-4).unwrap();
    }
    // The first step, without loads yet, leaves them where they start.
    assert_eq!(moving.particles.forcing.updates(), 4 * 10);
}

#[test]
fn no_overlap_is_computed_while_boxes_are_apart() {
    let scene = FallingDiscs { cells_per_diameter: 8, ..FallingDiscs::default() };
    let mut simulation = scene.build(SmoothForcing::new(FLUID.density)).unwrap();
    for _ in 0..20 {
        simulation.step(1e-4).unwrap();
    }
    assert_eq!(simulation.particles.bodies.overlap_calls(), 0);
}

#[test]
fn nothing_immersed_is_the_plain_flow_loop() {
    let scene = FallingDiscs { cells_per_diameter: 8, ..FallingDiscs::default() };
    let swirl = |x: [f64; 2]| [(x[1] * 314.16).sin() * 1e-3, (x[0] * 628.32).cos() * 1e-3];
    let mut plain: Projection<2> = scene.flow().unwrap();
    plain.set_velocity(swirl);
    let mut coupled = Simulation::new(scene.flow().unwrap(), (), WeightBalance::NetWeight).unwrap();
    coupled.flow.set_velocity(swirl);
    for _ in 0..10 {
        plain.advance(1e-4, [0.0; 2]).unwrap();
        coupled.step(1e-4).unwrap();
    }
    assert_eq!(plain.velocity().field(0).data(), coupled.flow.velocity().field(0).data());
    assert_eq!(size_of_val(&coupled.particles), 0);
    // The paper's forcing projects static bodies once as well.
    let still = FallingDiscs { freedom: Freedom::NONE, ..scene };
    let mut simulation = still.build(Hfdib::new(FLUID.density)).unwrap();
    for _ in 0..3 {
        simulation.step(1e-4).unwrap();
    }
    assert_eq!(simulation.particles.forcing.updates(), 4);
}
