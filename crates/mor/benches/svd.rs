//! What a proper orthogonal decomposition costs: CPU seconds, memory, orthogonality of the modes.
//!
//! `cargo bench -p siltflow-mor --bench svd`: 45 000 × 601, two minutes with all methods; `-- large`: 1e6 × 600, which takes 11 GB; `-- small`: 4500 × 151; `-- file`: 1e6 × 600 from a
//! file of 4.8 GB beside the build, which is removed afterwards.
use cpu_time::ProcessTime;
use interfaces::SnapshotSink;
use mor::Mat;
use mor::pod::{Pod, PodParams, Rank, SvdMethod};
use mor::snapshots::{NpyArray, NpyWriter, SnapshotAxis};
use std::path::Path;

/// Peak resident memory of this process [bytes], where the system tells it.
fn peak() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    line.and_then(|l| l.trim().trim_end_matches(" kB").parse::<f64>().ok()).map_or(f64::NAN, |kb| 1024.0 * kb)
}

/// Two discs with soft edges that move past each other on a plane of nx × ny cells: row, snapshot of m.
fn discs([nx, ny]: [usize; 2], m: usize) -> impl Fn(usize, usize) -> f64 {
    let radius = 0.05 * ny as f64;
    let disc = move |x: f64, y: f64, c: [f64; 2]| 0.5 - 0.5 * ((x - c[0]).hypot(y - c[1]) - radius).tanh();
    move |row, j| {
        let (x, y, t) = ((row % nx) as f64, (row / nx) as f64, j as f64 / m as f64);
        let (w, h) = (nx as f64, ny as f64);
        disc(x, y, [0.3 * w, h * (0.1 + 0.8 * t * t)]) + disc(x, y, [0.7 * w, h * (0.9 - 0.5 * t)])
    }
}

/// Forty modes of a file that is never in memory as a whole.
fn of_file(cells: [usize; 2], m: usize) -> Result<(), Box<dyn std::error::Error>> {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("snapshots.npy");
    let (value, rows) = (discs(cells, m), cells[0] * cells[1]);
    let mut writer = NpyWriter::create(&path)?;
    for j in 0..m {
        let field: Vec<f64> = (0..rows).map(|row| value(row, j)).collect();
        writer.push(j as f64, &field).map_err(|why| why.to_string())?;
    }
    writer.flush()?;
    let before = peak();
    let watch = ProcessTime::now();
    let source = NpyArray::open(&path, SnapshotAxis::First)?;
    let pod = Pod::of(&source, &PodParams::of_rank(40));
    let cpu = watch.elapsed().as_secs_f64();
    let bytes = std::fs::metadata(&path)?.len() as f64;
    std::fs::remove_file(&path)?;
    let pod = pod?;
    println!(
        "file of {:.2} GB, {rows} x {m}: {} modes, {cpu:.2} CPU s, peak {:.3} GB ({:.3} before), modes {:.3} GB, skew {:.1e}, error {:.3e}",
        bytes / 1e9,
        pod.rank(),
        peak() / 1e9,
        before / 1e9,
        8.0 * (rows * pod.rank()) as f64 / 1e9,
        skew(&pod),
        pod.relative_error(pod.rank())
    );
    Ok(())
}

fn skew(pod: &Pod) -> f64 {
    let gram = pod.modes.transpose() * &pod.modes;
    let off = |i: usize, j: usize| (gram[(i, j)] - f64::from(u8::from(i == j))).abs();
    (0..pod.rank())
        .flat_map(|i| (0..pod.rank()).map(move |j| (i, j)))
        .map(|(i, j)| off(i, j))
        .fold(0.0, f64::max)
}

fn main() {
    let wanted = |name: &str| std::env::args().any(|a| a == name);
    if wanted("file") {
        of_file([1000, 1000], 600).expect("a file of 4.8 GB and modes of it");
        return;
    }
    let (cells, m) = match (wanted("large"), wanted("small")) {
        (true, _) => ([1000, 1000], 600),
        (_, true) => ([45, 100], 151),
        _ => ([150, 300], 601),
    };
    let x = Mat::from_fn(cells[0] * cells[1], m, discs(cells, m));
    let data = 8.0 * (x.nrows() * m) as f64;
    println!("{} x {m}, {:.2} GB", x.nrows(), data / 1e9);
    println!(
        "{:<38} {:>5} {:>9} {:>12} {:>10} {:>12}",
        "method", "modes", "CPU s", "memory/data", "skew", "error"
    );
    let random = SvdMethod::Randomised { oversampling: 10, power_iterations: 2, seed: 1 };
    let mut cases = vec![("snapshots, 40 modes", SvdMethod::Snapshots, Rank::Fixed(40))];
    if !wanted("large") {
        cases.extend([
            ("snapshots, all above 1e-5", SvdMethod::Snapshots, Rank::All),
            ("randomised, 40 modes", random, Rank::Fixed(40)),
            ("QR, all", SvdMethod::Qr, Rank::All),
        ]);
    }
    for (name, method, rank) in cases {
        let watch = ProcessTime::now();
        let pod =
            Pod::new(x.as_ref(), &PodParams { method, rank, ..PodParams::default() }).expect("decomposes");
        let cpu = watch.elapsed().as_secs_f64();
        let error = pod.relative_error(pod.rank());
        println!(
            "{name:<38} {:>5} {cpu:>9.3} {:>12.2} {:>10.1e} {error:>12.3e}",
            pod.rank(),
            peak() / data,
            skew(&pod)
        );
    }
}
