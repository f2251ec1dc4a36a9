//! The machine that a rank runs on.

use std::{fs, thread::available_parallelism};

use super::memory::field;

/// A machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Machine {
    /// Its name.
    pub name: String,
    /// Its processor, where the system tells.
    pub processor: Option<String>,
    /// Processors that this process may use, 0 where the system does not tell.
    pub cores: usize,
    /// Its memory in bytes, where the system tells.
    pub memory: Option<f64>,
}

impl Machine {
    /// That of this rank; needs MPI to be running.
    pub fn local() -> Machine {
        let processors = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let model = processors.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
        Machine {
            name: mpi::environment::processor_name().unwrap_or_else(|_| "unknown".into()),
            processor: model.map(|(_, name)| name.split_whitespace().collect::<Vec<_>>().join(" ")),
            cores: available_parallelism().map_or(0, usize::from),
            memory: field("/proc/meminfo", "MemTotal:").map(|kilobytes| kilobytes * 1024.0),
        }
    }
}
