//! How long this process has run, and how long on a processor.

use std::fs;

/// Ticks of a second in which Linux tells times of processes.
const TICKS: f64 = 100.0;

/// Place of the start of a process among what `/proc/self/stat` tells behind its name.
const START: usize = 19;

/// Places of the time on a processor, in the program and for it in the system.
const ON_PROCESSOR: [usize; 2] = [11, 12];

/// Seconds since this process was started, before it came to its own first line (0 where the system does not tell).
pub fn process_seconds() -> f64 {
    let of_machine = fs::read_to_string("/proc/uptime").unwrap_or_default();
    let now = of_machine.split_whitespace().next().and_then(|text| text.parse::<f64>().ok());
    now.zip(process_time(START)).map_or(0.0, |(now, start)| (now - start).max(0.0))
}

/// Seconds that this process has had a processor, however many others wait for it too; nothing where the system does not tell.
pub fn processor_seconds() -> Option<f64> {
    ON_PROCESSOR.into_iter().map(process_time).sum()
}

/// A time that Linux tells of this process, in seconds.
fn process_time(place: usize) -> Option<f64> {
    let text = fs::read_to_string("/proc/self/stat").ok()?;
    let (_, rest) = text.rsplit_once(')')?;
    rest.split_whitespace().nth(place)?.parse::<f64>().ok().map(|ticks| ticks / TICKS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_on_a_processor_goes_on_and_never_back() {
        let begun = processor_seconds().unwrap();
        let mut sum = 0.0_f64;
        while processor_seconds().unwrap() < begun + 1.0 / TICKS {
            sum += (0..1000).map(f64::from).sum::<f64>().sqrt();
        }
        assert!(sum > 0.0);
    }
}
