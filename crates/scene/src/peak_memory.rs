//! Memory that a task takes.
use crate::available_memory::kilobytes;

/// Physical memory of the process while a task runs.
pub(crate) struct PeakMemory {
    before: f64,
}

impl PeakMemory {
    /// Starts anew the mark of the most memory held at once; `None` without `/proc`.
    pub(crate) fn start() -> Option<Self> {
        // A 5 resets VmHWM (proc_pid_clear_refs(5)).
        std::fs::write("/proc/self/clear_refs", "5").ok()?;
        Some(Self { before: status("VmRSS:")? })
    }

    /// Memory of the process before the task \[bytes\].
    pub(crate) fn before(&self) -> f64 {
        self.before
    }

    /// Memory beyond that at its peak \[bytes\].
    pub(crate) fn taken(&self) -> f64 {
        (status("VmHWM:").unwrap_or(0.0) - self.before).max(0.0)
    }
}

/// An entry of the process's status \[bytes\].
fn status(key: &str) -> Option<f64> {
    kilobytes(&std::fs::read_to_string("/proc/self/status").ok()?, key)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Other tests take memory meanwhile, and the system counts pages with some delay.
    #[test]
    fn an_array_is_seen_after_it_is_gone() {
        let Some(memory) = PeakMemory::start() else { return };
        drop(std::hint::black_box(vec![1u8; 200_000_000]));
        let taken = memory.taken();
        assert!(memory.before() > 1e6 && (1.9e8..1e9).contains(&taken), "{taken}");
    }
}
