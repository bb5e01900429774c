//! `mor` alone: a travelling wave, by POD and by shifted POD, between its snapshots.
use mor::models::{Podiann, Spodiann, SpodiannParams};
use mor::pod::{Pod, PodParams};
use mor::shifted::fourier::Als;
use mor::shifted::{Grid, Interpolation, Motions};
use mor::{Mat, MatRef};

/// A pulse at place x of a period of length 1 that moves at speed 0.8.
fn pulse(x: f64, t: f64) -> f64 {
    let from = (x - 0.8 * t + 0.5).rem_euclid(1.0) - 0.5;
    (-(from / 0.02).powi(2)).exp()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (nx, nt) = (200, 101);
    let times: Vec<f64> = (0..nt).map(|j| j as f64 / (nt - 1) as f64).collect();
    let points = MatRef::from_row_major_slice(&times, 1, nt);
    let snapshots = Mat::from_fn(nx, nt, |i, j| pulse(i as f64 / nx as f64, times[j]));

    let pod = Podiann::new(points, &Pod::new(snapshots.as_ref(), &PodParams::of_rank(10))?, None)?;
    let grid = Grid::new([nx], [1.0 / nx as f64])?;
    let shifts = Motions::along_x(&[times.iter().map(|t| 0.8 * t).collect()])?;
    let modes = Als::new([1]).solve(&grid, &shifts, snapshots.as_ref(), None, None, &mut |_| true)?;
    let spod =
        Spodiann::new(points, &modes, (grid, Interpolation::Spectral), &shifts, SpodiannParams::default())?;

    let (t, mut field) = (0.3173, vec![0.0; nx]);
    let mut error = |predict: &dyn Fn(&mut [f64]) -> Result<(), mor::models::ModelError>| {
        predict(&mut field)?;
        let off = |(i, f): (usize, &f64)| (f - pulse(i as f64 / nx as f64, t)).powi(2);
        Ok::<f64, mor::models::ModelError>(
            (field.iter().enumerate().map(off).sum::<f64>() / nx as f64).sqrt(),
        )
    };
    let errors = [error(&|out| pod.predict(&[t], out))?, error(&|out| spod.predict(&[t], out))?];
    println!("mor: 10 modes of POD are {:.1e} off, one shifted mode {:.1e}", errors[0], errors[1]);
    assert!(errors[1] < 1e-6 && errors[0] > 1e-2);
    Ok(())
}
