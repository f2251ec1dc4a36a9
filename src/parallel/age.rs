//! How long this process has run.

use std::fs;

/// Ticks of a second in which Linux tells times of processes.
const TICKS: f64 = 100.0;

/// Place of the start of a process among what `/proc/self/stat` tells behind its name.
const START: usize = 19;

/// Seconds since this process was started, before it came to its own first line (0 where the system does not tell).
pub fn process_seconds() -> f64 {
    let number = |text: Option<&str>| text?.parse::<f64>().ok();
    let read = |path: &str| fs::read_to_string(path).unwrap_or_default();
    let (of_machine, of_process) = (read("/proc/uptime"), read("/proc/self/stat"));
    let start = of_process.rsplit_once(')').and_then(|(_, rest)| number(rest.split_whitespace().nth(START)));
    let now = number(of_machine.split_whitespace().next());
    now.zip(start).map_or(0.0, |(now, start)| (now - start / TICKS).max(0.0))
}
