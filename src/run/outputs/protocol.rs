//! A shear whose rate changes: the stress over the strain as a chart, and what an oscillation measures.

use std::path::PathBuf;

use super::context::{Context, Wanted};
use crate::{
    error::Result,
    geometry::{Oscillation, Protocol},
    output::{Columns, OscillationSummary, Summary},
    picture::{Chart, Scale, Series},
    run::{Output, View},
};

/// Draws `stress.svg`, and tells moduli.
pub struct ProtocolFiles {
    /// Where it goes, and where the series is.
    pub folder: PathBuf,
}

/// Of a shear whose rate changes.
pub fn wanted<const D: usize>(context: &Context<D>) -> Wanted<D> {
    context.when(context.scene.changing_shear().is_some(), |context| ProtocolFiles { folder: context.path() })
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
        let chart = chart(view.scene.shown_title(), series.curve("strain", "shear_stress"));
        Ok(vec![view.write_file(&self.folder, "stress.svg", chart.svg().as_bytes())?])
    }
}

fn chart(title: &str, points: Vec<(f64, f64)>) -> Chart {
    let series = vec![Series { name: "shear stress".into(), points }];
    Chart { title: title.into(), x: "strain".into(), y: "shear stress".into(), scale: Scale::Linear, series }
}
