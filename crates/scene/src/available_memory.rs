//! Memory that the process may still use.
use std::path::{Path, PathBuf};

/// The smallest of the limits on what may still be used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AvailableMemory {
    /// \[bytes\].
    pub(crate) bytes: f64,
    /// Name of the limit.
    pub(crate) limit: &'static str,
}

impl AvailableMemory {
    /// The smallest of what the system has free, the address space and data of the process
    /// (`ulimit -v`, `ulimit -d`) and its control groups, version 1 or 2, leave; `None` without
    /// `/proc`.
    pub(crate) fn now() -> Option<Self> {
        Self::in_root(Path::new("/"))
    }

    /// The same with the files of the system in this folder.
    fn in_root(root: &Path) -> Option<Self> {
        let read = |path: &str| std::fs::read_to_string(root.join(path)).unwrap_or_default();
        let (limits, status) = (read("proc/self/limits"), read("proc/self/status"));
        let of_process = |limit: &str, used: &str| {
            Some(soft_limit(&limits, limit)? - kilobytes(&status, used).unwrap_or(0.0))
        };
        let group = groups(root, &read("proc/self/cgroup")).into_iter().min_by(f64::total_cmp);
        [
            (kilobytes(&read("proc/meminfo"), "MemAvailable:"), "free memory of the system"),
            (of_process("Max address space", "VmSize:"), "address space of the process (ulimit -v)"),
            (of_process("Max data size", "VmData:"), "data of the process (ulimit -d)"),
            (group, "memory of the control group"),
        ]
        .into_iter()
        .filter_map(|(bytes, limit)| bytes.map(|bytes| Self { bytes: bytes.max(0.0), limit }))
        .min_by(|a, b| a.bytes.total_cmp(&b.bytes))
    }
}

/// An entry in kB of a file of `/proc` \[bytes\].
pub(crate) fn kilobytes(text: &str, key: &str) -> Option<f64> {
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    let number: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024.0 * number)
}

/// The soft limit in a line of `/proc/self/limits` \[bytes\]; `None` if unlimited.
fn soft_limit(text: &str, key: &str) -> Option<f64> {
    text.lines().find_map(|line| line.strip_prefix(key))?.split_whitespace().next()?.parse().ok()
}

/// Memory that each control group of the process with a limit, up to the root, leaves \[bytes\].
/// Cached files are given back when memory is short and do not count as used.
fn groups(root: &Path, memberships: &str) -> Vec<f64> {
    let mut left = Vec::new();
    for line in memberships.lines() {
        let mut parts = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(group)) = (parts.next(), parts.next()) else { continue };
        let version = match controllers {
            "" => ["sys/fs/cgroup", "memory.max", "memory.current", "inactive_file "],
            list if list.split(',').any(|name| name == "memory") => [
                "sys/fs/cgroup/memory",
                "memory.limit_in_bytes",
                "memory.usage_in_bytes",
                "total_inactive_file ",
            ],
            _ => continue,
        };
        let [mount, limit, usage, cached] = version;
        // In a container the group's own path may not be mounted; its limits are then at the mount.
        let mut folder: PathBuf = root.join(mount).join(group.trim_start_matches('/'));
        while folder.starts_with(root.join(mount)) {
            let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap_or_default();
            let number = |text: &str| text.trim().parse::<f64>().ok();
            if let Some(limit) = number(&read(limit)) {
                let statistics = read("memory.stat");
                let cached = statistics.lines().find_map(|line| number(line.strip_prefix(cached)?));
                let used = number(&read(usage)).unwrap_or(0.0) - cached.unwrap_or(0.0);
                left.push(limit - used.max(0.0));
            }
            if !folder.pop() {
                break;
            }
        }
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;

    const STATUS: &str = "VmSize:\t  2000 kB\nVmData:\t 1000 kB\n";
    const UNLIMITED: &str = "Max data size   unlimited   unlimited   bytes\n";

    /// A folder with these files of `/proc` and `/sys`.
    fn root(name: &str, files: &[(&str, &str)]) -> PathBuf {
        let root = std::env::temp_dir().join(format!("siltflow-memory-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&root);
        for (path, text) in files {
            let path = root.join(path);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        root
    }

    #[test]
    fn the_smallest_limit_counts() {
        let free = ("proc/meminfo", "MemTotal: 9000000 kB\nMemAvailable:    8000000 kB\n");
        let status = ("proc/self/status", STATUS);
        let v2 = [
            ("proc/self/cgroup", "0::/job/step\n"),
            ("sys/fs/cgroup/job/memory.max", "3000000000\n"),
            ("sys/fs/cgroup/job/memory.current", "1000000000\n"),
            ("sys/fs/cgroup/job/memory.stat", "anon 1\ninactive_file 500000000\n"),
            ("sys/fs/cgroup/job/step/memory.max", "max\n"),
        ];
        let v1 = [
            ("proc/self/cgroup", "5:cpu,cpuacct:/\n4:memory:/docker/abc\n"),
            ("sys/fs/cgroup/memory/memory.limit_in_bytes", "2000000000\n"),
            ("sys/fs/cgroup/memory/memory.usage_in_bytes", "500000000\n"),
        ];
        type Files<'a> = &'a [(&'a str, &'a str)];
        let cases: [(&str, Files<'_>, f64, &str); 5] = [
            ("free", &[("proc/self/limits", UNLIMITED)], 8.192e9, "system"),
            ("address", &[("proc/self/limits", "Max address space  102048000 unlimited bytes\n")], 1e8, "-v"),
            ("data", &[("proc/self/limits", "Max data size  101024000 unlimited bytes\n")], 1e8, "-d"),
            ("v2", &v2, 2.5e9, "control group"),
            ("v1", &v1, 1.5e9, "control group"),
        ];
        for (name, files, bytes, limit) in cases {
            let root = root(name, &[&[free, status], files].concat());
            let found = AvailableMemory::in_root(&root).unwrap();
            assert!(found.limit.contains(limit) && (found.bytes - bytes).abs() < 1.0, "{name}: {found:?}");
            std::fs::remove_dir_all(&root).unwrap();
        }
        assert_eq!(AvailableMemory::in_root(Path::new("/nowhere")), None);
    }
}
