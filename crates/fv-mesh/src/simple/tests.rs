//! The steady algorithm against exact solutions and a benchmark.
use super::*;

fn cavity(n: usize, reynolds: f64) -> Simple<2> {
    let grid = CartesianGrid::new([n, n], [1.0, 1.0]).unwrap();
    let sides = [Side::WALL.both(), [Side::WALL, Side::Wall([1.0, 0.0, 0.0])]];
    Simple::new(grid, sides, Fluid { density: 1.0, viscosity: 1.0 / reynolds }).unwrap()
}

#[test]
fn speed() {
    for re in [100.0, 400.0, 1000.0] {
        for alpha in [0.7, 0.8, 0.9, 0.95] {
            let params = SimpleParams { velocity_relaxation: alpha, ..SimpleParams::default() };
            let mut flow = cavity(64, re).with_params(params).unwrap();
            let start = std::time::Instant::now();
            let mut work = [0; 2];
            let mut info = SimpleInfo::default();
            for _ in 0..400 {
                info = flow.iterate().unwrap();
                work[0] += info.sweeps;
                work[1] += info.pressure_iterations;
                if info.largest() < 1e-6 {
                    break;
                }
            }
            let t = start.elapsed().as_secs_f64();
            println!(
                "Re {re} alpha {alpha}: {info:?} {work:?} {:.3} us per cell and iteration",
                1e6 * t / (4096.0 * info.iterations as f64)
            );
        }
    }
}
