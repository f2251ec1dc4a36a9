//! `pairs.csv` and `pairs.json`: how bodies lie to each other.

use serde::Serialize;

use crate::observe::PairDistribution;

/// What a summary says of pairs.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct PairSummary {
    /// Mean number of neighbours of a body.
    pub coordination: f64,
    /// Configurations that were averaged.
    pub configurations: usize,
    /// Time of the first of them.
    pub from_time: f64,
}

/// The files by name.
pub fn pair_files(distribution: &PairDistribution) -> [(&'static str, Vec<u8>); 2] {
    let rows = distribution.radial.iter().map(|(separation, density)| format!("{separation:?},{density:?}\n"));
    let csv: String = std::iter::once("separation,distribution\n".to_owned()).chain(rows).collect();
    let json = serde_json::to_string_pretty(distribution).expect("a distribution is plain numbers");
    [("pairs.csv", csv.into_bytes()), ("pairs.json", (json + "\n").into_bytes())]
}
