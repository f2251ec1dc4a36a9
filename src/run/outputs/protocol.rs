//! A shear whose rate changes: the stress over the strain as a chart, and what an oscillation measures; one that a stress decides: the strain over time.

use std::path::PathBuf;

use super::context::{Context, Wanted};
use crate::{
    error::Result,
    geometry::{Oscillation, Protocol},
    output::{Columns, OscillationSummary, Summary, measured_stress},
    picture::{Chart, Scale, Series},
    run::{Output, View},
};

/// Draws `stress.svg` or `creep.svg`, and tells moduli.
pub struct ProtocolFiles {
    /// Where it goes, and where the series is.
    pub folder: PathBuf,
}

/// Of a shear whose rate changes, or follows from a stress.
pub fn wanted<const D: usize>(context: &Context<D>) -> Wanted<D> {
    let changes = context.scene.shear_protocol().is_some_and(|protocol| !protocol.steady());
    context.when(changes, |context| ProtocolFiles { folder: context.path() })
}

impl<const D: usize> Output<D> for ProtocolFiles {
    fn finish(&mut self, view: &View<D>, summary: &mut Summary) -> Result<Vec<String>> {
        // the first rank writes what it reads here
        let rows = std::fs::read_to_string(self.folder.join("series.csv")).unwrap_or_default();
        let series = Columns::parse(&rows);
        if let Some(&Protocol::Oscillation { amplitude, frequency }) = view.scene.changing_shear() {
            summary.oscillation = OscillationSummary::of(&series, Oscillation { amplitude, frequency }, view.scene.flow.viscosity);
        }
        if view.viscosity.is_none() {
            return Ok(Vec::new());
        }
        let (title, by_stress) = (&view.scene.title, view.scene.shear_protocol().is_some_and(|protocol| protocol.stresses().is_some()));
        let (name, chart) = if by_stress { ("creep.svg", creep(title, &series)) } else { ("stress.svg", chart(title, &series)) };
        Ok(vec![view.write_file(&self.folder, name, chart.svg().as_bytes())?])
    }
}

/// The stress of which moduli are made, over the strain.
fn chart(title: &str, series: &Columns) -> Chart {
    let measured = measured_stress(series);
    let name = if measured == "wall_stress" { "shear stress on the walls" } else { "shear stress" };
    let series = vec![Series { name: name.into(), points: series.curve("strain", measured) }];
    Chart { title: title.into(), x: "strain".into(), y: name.into(), scale: Scale::Linear, series }
}

/// The strain over time.
fn creep(title: &str, series: &Columns) -> Chart {
    let series = vec![Series { name: "strain".into(), points: series.curve("time", "strain") }];
    Chart { title: title.into(), x: "time".into(), y: "strain".into(), scale: Scale::Linear, series }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stress_on_walls_is_drawn_where_there_are_walls() {
        let head = "time,strain,shear_stress";
        let between_walls = chart("", &Columns::parse(&format!("{head},wall_stress\n0,0.5,1,2\n")));
        assert_eq!((between_walls.y.as_str(), &between_walls.series[0].points[..]), ("shear stress on the walls", &[(0.5, 2.0)][..]));
        let periodic = chart("one", &Columns::parse(&format!("{head}\n0,0.5,1\n")));
        assert_eq!(
            (periodic.y.as_str(), &periodic.series[0].points[..], periodic.title.as_str()),
            ("shear stress", &[(0.5, 1.0)][..], "one")
        );
    }
}
