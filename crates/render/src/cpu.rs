//! What a run costs: processor time, wall time, memory.

use std::time::{Duration, Instant};

use cpu_time::ProcessTime;

/// A stopwatch on both clocks. Processor time is user plus system time of every thread of this process,
/// finished ones included, so it grows faster than wall time when threads work side by side.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch {
    wall: Instant,
    cpu: ProcessTime,
}

/// Seconds on both clocks.
#[derive(Clone, Copy, Debug, Default)]
pub struct Elapsed {
    /// By the clock on the wall.
    pub wall: f64,
    /// By the processors.
    pub cpu: f64,
}

impl Stopwatch {
    /// Starts both clocks.
    pub fn start() -> Self {
        Self { wall: Instant::now(), cpu: ProcessTime::now() }
    }

    /// Seconds since the start.
    pub fn elapsed(&self) -> Elapsed {
        Elapsed { wall: self.wall.elapsed().as_secs_f64(), cpu: self.cpu.elapsed().as_secs_f64() }
    }
}

/// The most memory this process has held at once, in bytes; `None` where the system has no `/proc` (not Linux).
pub fn peak_memory() -> Option<u64> {
    high_water_mark(&std::fs::read_to_string("/proc/self/status").ok()?)
}

fn high_water_mark(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1024)
}

/// A duration as a person writes it: `4.2 s`, `3 min 05 s`, `2 h 07 min`.
pub fn readable(duration: Duration) -> String {
    let seconds = duration.as_secs_f64();
    let whole = seconds.round() as u64;
    match whole {
        0..10 => format!("{seconds:.1} s"),
        10..60 => format!("{whole} s"),
        60..3600 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole % 3600 / 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_takes_processor_time() {
        let watch = Stopwatch::start();
        let mut x = 1.0f64;
        while watch.elapsed().wall < 0.05 {
            x = (x + 1.0).sqrt();
        }
        let Elapsed { wall, cpu } = watch.elapsed();
        assert!(x > 1.0 && wall >= 0.05 && cpu > 0.0);
    }

    #[test]
    fn the_high_water_mark_is_read_in_bytes() {
        assert_eq!(high_water_mark("VmPeak:\t 9 kB\nVmHWM:\t    2048 kB\n"), Some(2048 * 1024));
        assert_eq!(high_water_mark("Name:\tx\n"), None);
    }

    #[test]
    fn durations_read_well() {
        let text = |s: f64| readable(Duration::from_secs_f64(s));
        assert_eq!(text(4.21), "4.2 s");
        assert_eq!(text(59.4), "59 s");
        assert_eq!(text(185.0), "3 min 05 s");
        assert_eq!(text(7620.0), "2 h 07 min");
    }
}
