//! POD of snapshots in a `.npy` file.
use mor::pod::{Pod, PodParams};
use mor::snapshots::{NpyArray, NpyWriter, SnapshotAxis, SnapshotSource};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A travelling wave on 64 × 32 cells: an array of shape (time, y, x).
    let (nx, ny) = (64, 32);
    let path = std::env::temp_dir().join(format!("consumer-wave-{}.npy", std::process::id()));
    let mut writer = NpyWriter::create(&path)?;
    for k in 0..50 {
        let at = |c: usize| (0.2 * (c % nx) as f64 - 0.1 * f64::from(k), 0.1 * (c / nx) as f64);
        let field: Vec<f64> = (0..nx * ny).map(at).map(|(x, y)| x.sin() * y.cos()).collect();
        writer.add(&field)?;
    }
    writer.flush()?;

    let file = NpyArray::open(&path, SnapshotAxis::First)?;
    println!("mor: {} snapshots of {} cells", file.n_snapshots(), file.n_rows());
    let pod = Pod::of(&file, &PodParams::of_rank(2))?;
    let snapshots = file.to_mat()?;
    std::fs::remove_file(path)?;
    let coefficients = pod.project(snapshots.col_as_slice(10))?;
    let mut back = vec![0.0; pod.rows()];
    pod.reconstruct(&coefficients, &mut back)?;
    let error = pod.relative_projection_error(snapshots.as_ref())?;
    println!("mor: two modes are {error:.1e} off, σ {:?}", pod.singular_values);
    assert!(error < 1e-6 && (back[5] - snapshots[(5, 10)]).abs() < 1e-6);
    Ok(())
}
