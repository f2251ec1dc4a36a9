//! Charts of a run in time: `viscosity.svg` over the strain and `effort.svg` over the time.

use std::path::PathBuf;

use super::context::{Context, Wanted};
use crate::{
    error::Result,
    observe::Part,
    output::{CurvePoint, MeanViscosity, Summary, bar, effort_chart},
    picture::{Band, Chart, Notes, Scale, Series},
    run::{Output, View},
};

/// Draws the viscosity, in a sheared suspension.
pub struct ViscosityChart {
    /// Where it goes.
    pub folder: PathBuf,
}

/// Draws what the steps cost.
pub struct EffortChart {
    /// Where it goes, and where the series is.
    pub folder: PathBuf,
}

/// The chart of the viscosity, of every run in time.
pub fn viscosity<const D: usize>(context: &Context<D>) -> Wanted<D> {
    context.when(true, |context| ViscosityChart { folder: context.path() })
}

/// The chart of costs, with `output.picture`.
pub fn effort<const D: usize>(context: &Context<D>) -> Wanted<D> {
    context.when(context.scene.output.picture, |context| EffortChart { folder: context.path() })
}

impl<const D: usize> Output<D> for ViscosityChart {
    fn finish(&mut self, view: &View<D>, _: &mut Summary) -> Result<Vec<String>> {
        // only the first rank knows the points, and all of them must agree on whether there is a file
        let points = view.history.points();
        if view.world.max(points.len() as f64) < 2.0 {
            return Ok(Vec::new());
        }
        let notes = Notes { band: view.history.mean().map(band), ..Notes::default() };
        let chart = viscosity_chart(view.scene.shown_title(), points).annotated(&notes);
        Ok(vec![view.write_file(&self.folder, "viscosity.svg", chart.as_bytes())?])
    }
}

impl<const D: usize> Output<D> for EffortChart {
    fn finish(&mut self, view: &View<D>, _: &mut Summary) -> Result<Vec<String>> {
        // the first rank writes what it reads here
        let rows = std::fs::read_to_string(self.folder.join("series.csv")).unwrap_or_default();
        let chart = effort_chart(view.scene.shown_title(), &rows).svg();
        Ok(vec![view.write_file(&self.folder, "effort.svg", chart.as_bytes())?])
    }
}

/// The mean over the steady part.
fn band(mean: &MeanViscosity) -> Band {
    Band {
        from_to: mean.strains,
        mean: mean.relative,
        interval: mean.interval,
        name: format!("mean {:.4} \u{b1} {} (95 %)", mean.relative, bar(mean.half_width())),
        left_out: "left out of the mean".into(),
    }
}

fn viscosity_chart(title: &str, curve: &[CurvePoint]) -> Chart {
    let series = |name: &str, value: &dyn Fn(&CurvePoint) -> f64| Series {
        name: name.into(),
        points: curve.iter().map(|point| (point.strain.abs(), value(point))).collect(),
    };
    let mut all = vec![series("total", &CurvePoint::relative)];
    let acts = |part: &Part| curve.iter().any(|point| point.parts.get(*part).is_some_and(|amount| amount != 0.0));
    let acting: Vec<Part> = Part::ALL.into_iter().filter(acts).collect();
    if acting != [Part::Hydrodynamic] {
        all.extend(acting.iter().map(|part| series(part.words(), &|point| point.parts.get(*part).unwrap_or(f64::NAN))));
    }
    Chart { title: title.into(), x: "strain".into(), y: "relative viscosity".into(), scale: Scale::Linear, series: all }
}
