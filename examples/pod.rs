//! POD of a flow and its Galerkin projection: a double shear layer that rolls up in a periodic box.
//!
//! ```text
//! u ≈ ū + Σ a_i φ_i,   ⟨φ_i, φ_j⟩ = δ_ij
//! da_i/dt = ⟨φ_i, R(ū + Σ a_j φ_j)⟩ = c_i + L_ij a_j + Q_ijk a_j a_k
//! ```
//!
//! R is the rate of the flow solver itself ([`Projection::rate`]), a polynomial of second degree of
//! the velocities, so that c, L and Q are exact. The modes are orthonormal in the inner product of
//! the kinetic energy. The projection error ‖u − Πu‖ is the best that the modes can do; the
//! Galerkin model knows the first snapshot alone.
//!
//! `cargo run --release --example pod [FOLDER]`, 1 s; `out/pod/vorticity.png`.
use mor::Mat;
use mor::galerkin::{Basis, DormandPrince, Ode, QuadraticModel};
use mor::pod::{Pod, PodParams, Rank};
use render::Scalar;
use render::gallery::{Gallery, Row, Tile};
use siltflow::flow::{CartesianGrid, Convection, Diffusion, Fluid, Projection, Side};
use std::cell::RefCell;
use std::error::Error;
use std::f64::consts::TAU;

const N: usize = 64;
const SNAPSHOTS: usize = 101;
const INTERVAL: f64 = 0.02; // s

/// The flow as y′ = R(y), y its velocities.
struct Rate<'a> {
    flow: RefCell<&'a mut Projection<2>>,
    unknowns: usize,
}

impl Ode for Rate<'_> {
    fn n(&self) -> usize {
        self.unknowns
    }
    fn rate(&self, _: f64, y: &[f64], out: &mut [f64]) {
        // NaN is what the caller reports.
        if self.flow.borrow_mut().rate(y, 1e-3, [0.0; 2], out).is_err() {
            out.fill(f64::NAN);
        }
    }
}

/// ∂v/∂x − ∂u/∂y at the corners of the cells \[1/s\].
fn vorticity(velocities: &[f64]) -> Vec<f64> {
    let (u, v) = velocities.split_at(N * N);
    let at = |i: usize, j: usize| i % N + N * (j % N);
    let curl = |i: usize, j: usize| v[at(i, j)] - v[at(i + N - 1, j)] - u[at(i, j)] + u[at(i, j + N - 1)];
    (0..N * N).map(|cell| N as f64 * curl(cell % N, cell / N)).collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args().nth(1).unwrap_or("out/pod".into());
    let grid = CartesianGrid::new([N; 2], [1.0; 2])?;
    let fluid = Fluid { density: 1.0, viscosity: 1e-3 };
    let mut flow = Projection::new(grid, Side::Periodic.everywhere(), fluid)?
        .with_diffusion(Diffusion::Explicit)
        .with_convection(Convection::Central);
    // Bell, Colella & Glaz (1989), J. Comput. Phys. 85, 257.
    let layer = |y: f64| if y < 0.5 { 20.0 * (y - 0.25) } else { 20.0 * (0.75 - y) };
    flow.set_velocity(|[x, y]| [layer(y).tanh(), 0.05 * (TAU * x).sin()]);
    // The first step makes the velocity free of divergence.
    flow.advance(1e-6, [0.0; 2])?;
    let mut columns = vec![flow.unknowns()];
    while columns.len() < SNAPSHOTS {
        for _ in 0..10 {
            flow.advance(0.1 * INTERVAL, [0.0; 2])?;
        }
        columns.push(flow.unknowns());
    }
    let snapshots = Mat::from_fn(columns[0].len(), SNAPSHOTS, |i, j| columns[j][i]);
    let weights = flow.unknown_volumes();
    let times: Vec<f64> = (0..SNAPSHOTS).map(|j| INTERVAL * j as f64).collect();
    let last = SNAPSHOTS - 1;

    let mut fields = vec![("flow".to_string(), vorticity(&columns[last]))];
    println!("modes  projection error  Galerkin error (largest, of the fluctuation)");
    for rank in [2, 4, 8, 12, 16] {
        let rank = Rank::Fixed(rank);
        let params =
            PodParams { rank, subtract_mean: true, weights: Some(weights.clone()), ..PodParams::default() };
        let pod = Pod::new(snapshots.as_ref(), &params)?;
        let basis = Basis::new(pod.modes.as_ref(), pod.mean.as_deref(), Some(&weights))?;
        let full = Rate { unknowns: basis.n(), flow: RefCell::new(&mut flow) };
        let model = QuadraticModel::project(&basis, &full, 1.0)?;
        let start = basis.coefficients(&columns[0])?;
        let states = DormandPrince::default().solve(&model, &start, &times)?;

        let fluctuation = (pod.energy / SNAPSHOTS as f64).sqrt();
        let (mut errors, mut field) = ([0.0_f64; 2], vec![0.0; basis.n()]);
        for (j, snapshot) in columns.iter().enumerate() {
            let best = basis.coefficients(snapshot)?;
            for (most, state) in errors.iter_mut().zip([&best[..], states.col_as_slice(j)]) {
                basis.field(state, &mut field)?;
                let squares = field.iter().zip(snapshot).zip(&weights);
                let off: f64 = squares.map(|((a, b), w)| w * (a - b).powi(2)).sum();
                *most = most.max(off.sqrt() / fluctuation);
            }
        }
        println!("{:5}  {:16.2e}  {:14.2e}", pod.rank(), errors[0], errors[1]);
        fields.push((format!("{} modes", pod.rank()), vorticity(&field)));
    }

    let tile = |field: &'_ (String, Vec<f64>)| field.0.clone();
    let tiles = fields.iter().map(|f| Tile { title: tile(f), field: Scalar { nx: N, ny: N, values: &f.1 } });
    let label = format!("vorticity at t = {} s", times[last]);
    let row = Row { label, range: Some((-20.0, 20.0)), tiles: tiles.collect() };
    std::fs::create_dir_all(&out)?;
    let gallery = Gallery { periodic: [true; 2], aspect: 1.0, rows: vec![row] };
    Ok(gallery.draw(format!("{out}/vorticity.png").as_ref())?)
}
