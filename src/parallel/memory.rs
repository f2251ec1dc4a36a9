//! Memory of this process: what it has used, and what the machine, its container and its own limits leave it.

use std::{fs, path::Path};

/// Memory that this process may still take, in bytes; infinite where the system does not tell.
pub fn free_memory_bytes() -> f64 {
    let machine = field("/proc/meminfo", "MemAvailable:").map_or(f64::INFINITY, |kilobytes| kilobytes * 1024.0);
    machine.min(left_by_groups()).min(left_by_limit())
}

/// Most memory that this process has used so far, in bytes (0 where the system does not tell).
pub fn peak_memory_bytes() -> f64 {
    field("/proc/self/status", "VmHWM:").unwrap_or(0.0) * 1024.0
}

/// So many bytes in words, rounded up: `78 MB`, `2.4 GB`.
pub fn memory_in_words(bytes: f64) -> String {
    match bytes {
        few if few < 1e9 => format!("{:.0} MB", (few / 1e6).ceil()),
        many => format!("{:.1} GB", (many / 1e8).ceil() / 10.0),
    }
}

/// What the control groups leave in which this process is, from its own up.
fn left_by_groups() -> f64 {
    let text = fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let group = text.lines().find_map(|line| line.strip_prefix("0::/")).unwrap_or_default();
    let root = Path::new("/sys/fs/cgroup");
    let unified = root.join(group);
    let groups = unified.ancestors().take_while(|folder| folder.starts_with(root));
    let left = |folder: &Path, [limit, used]: [&str; 2]| {
        let number = |name: &str| fs::read_to_string(folder.join(name)).ok()?.trim().parse::<f64>().ok();
        number(limit).zip(number(used)).map_or(f64::INFINITY, |(limit, used)| (limit - used).max(0.0))
    };
    let older = left(&root.join("memory"), ["memory.limit_in_bytes", "memory.usage_in_bytes"]);
    groups.map(|folder| left(folder, ["memory.max", "memory.current"])).fold(older, f64::min)
}

/// What is left of the address space that this process may take (`ulimit -v`).
fn left_by_limit() -> f64 {
    let limit = field("/proc/self/limits", "Max address space");
    let used = field("/proc/self/status", "VmSize:").unwrap_or(0.0) * 1024.0;
    limit.map_or(f64::INFINITY, |limit| (limit - used).max(0.0))
}

/// The number that follows a name in a text of the system.
pub(super) fn field(path: &str, name: &str) -> Option<f64> {
    let text = fs::read_to_string(path).ok()?;
    text.lines().find_map(|line| line.strip_prefix(name))?.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_system_tells_what_is_free_and_what_was_used() {
        let (free, used) = (free_memory_bytes(), peak_memory_bytes());
        assert!(free > 1e6 && free < 1e15, "{free}");
        assert!(used > 1e5 && used < 1e13, "{used}");
    }
}
