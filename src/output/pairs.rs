//! `pairs.csv` and `pairs.json`: how bodies lie to each other.

use serde::Serialize;

use crate::observe::PairDistribution;
use crate::picture::{Chart, Level, Notes, Scale, Series};

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

/// The pair distribution over the separation, with the level of bodies that do not know of each other.
fn chart(title: &str, distribution: &PairDistribution) -> String {
    let series = vec![Series { name: "g(r)".into(), points: distribution.radial.clone() }];
    let (x, y) = ("separation of centers over the sum of the radii, r", "pair distribution g(r)");
    let levels = vec![Level { y: 1.0, name: "at random".into() }];
    Chart { title: title.into(), x: x.into(), y: y.into(), scale: Scale::Linear, series }.annotated(&Notes { levels, ..Notes::default() })
}

/// The files by name.
pub fn pair_files(title: &str, distribution: &PairDistribution) -> [(&'static str, Vec<u8>); 3] {
    let rows = distribution.radial.iter().map(|(separation, density)| format!("{separation:?},{density:?}\n"));
    let csv: String = std::iter::once("separation,distribution\n".to_owned()).chain(rows).collect();
    let json = serde_json::to_string_pretty(distribution).expect("a distribution is plain numbers");
    [("pairs.csv", csv.into_bytes()), ("pairs.json", (json + "\n").into_bytes()), ("pairs.svg", chart(title, distribution).into_bytes())]
}
