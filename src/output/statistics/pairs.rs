//! `pairs.csv` and `pairs.json`: how bodies lie to each other.

use std::fmt::Write;

use serde::Serialize;

use crate::observe::{PairDistribution, PartialDistribution};
use crate::picture::{Chart, Level, Notes, PolarMap, Scale, Series};

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
    let of_two =
        |two: &PartialDistribution| Series { name: format!("radii {} and {}", two.radii[0], two.radii[1]), points: two.radial.clone() };
    let all = Series { name: if distribution.partial.is_empty() { "g(r)" } else { "all" }.into(), points: distribution.radial.clone() };
    let series = std::iter::once(all).chain(distribution.partial.iter().map(of_two)).collect();
    let (x, y) = ("separation of centres over the sum of the radii, r", "pair distribution g(r)");
    let levels = vec![Level { y: 1.0, name: "at random".into() }];
    Chart { title: title.into(), x: x.into(), y: y.into(), scale: Scale::Linear, series }.annotated(&Notes { levels, ..Notes::default() })
}

/// Names of the files, the numbers first.
pub const PAIR_FILES: [&str; 4] = ["pairs.csv", "pairs.json", "pairs.svg", "pairs-map.svg"];

/// The files by name.
pub fn pair_files(title: &str, distribution: &PairDistribution) -> [(&'static str, Vec<u8>); 4] {
    let json = serde_json::to_string_pretty(distribution).expect("a distribution is plain numbers") + "\n";
    let [csv_name, json_name, chart_name, map_name] = PAIR_FILES;
    let texts = [
        (csv_name, table(distribution)),
        (json_name, json),
        (chart_name, chart(title, distribution)),
        (map_name, map(title, distribution)),
    ];
    texts.map(|(name, text)| (name, text.into_bytes()))
}

/// A row for each separation; columns of two sizes are numbered from the smallest size on.
fn table(distribution: &PairDistribution) -> String {
    let mut radii: Vec<f64> = distribution.partial.iter().flat_map(|two| two.radii).collect();
    radii.sort_by(f64::total_cmp);
    radii.dedup();
    let number = |radius: f64| 1 + radii.iter().position(|other| *other == radius).unwrap_or_default();
    let columns = distribution.partial.iter().map(|two| format!(",distribution_{}_{}", number(two.radii[0]), number(two.radii[1])));
    let mut text = format!("separation,distribution{}\n", columns.collect::<String>());
    for (bin, (separation, density)) in distribution.radial.iter().enumerate() {
        let partial = distribution.partial.iter().map(|two| format!(",{:?}", two.radial[bin].1));
        writeln!(text, "{separation:?},{density:?}{}", partial.collect::<String>()).expect("memory can be written");
    }
    text
}

/// By direction in the plane of the shear, over half a turn and the opposite one alike.
fn map(title: &str, distribution: &PairDistribution) -> String {
    let found = &distribution.map;
    let excess = found.distribution.iter().map(|ring| ring.iter().map(|density| density - 1.0).collect()).collect();
    PolarMap {
        title: format!("{title}: pairs in the plane of the shear"),
        axes: ["flow", "gradient"].map(str::to_owned),
        radii: found.separations.clone(),
        values: excess,
        name: "g(r, \u{3b8}) \u{2212} 1".into(),
    }
    .svg()
}
