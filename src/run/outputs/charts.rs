//! Charts of a run in time: `viscosity.svg` over the strain and `effort.svg` over the time.

use std::path::PathBuf;

use crate::{
    error::Result,
    output::{Chart, CurvePoint, Scale, Series, Summary, effort_chart},
    run::{Evaluated, Output},
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

impl<const D: usize> Output<D> for ViscosityChart {
    fn finish(&mut self, seen: &Evaluated<D>, _: &mut Summary) -> Result<Vec<String>> {
        // only the first rank knows the points, and all of them must agree on whether there is a file
        let points = seen.history.points();
        if seen.world.max(points.len() as f64) < 2.0 {
            return Ok(Vec::new());
        }
        let chart = viscosity_chart(seen.scene.shown_title(), points).svg();
        Ok(vec![seen.write_file(&self.folder, "viscosity.svg", chart.as_bytes())?])
    }
}

impl<const D: usize> Output<D> for EffortChart {
    fn finish(&mut self, seen: &Evaluated<D>, _: &mut Summary) -> Result<Vec<String>> {
        // the first rank writes what it reads here
        let rows = std::fs::read_to_string(self.folder.join("series.csv")).unwrap_or_default();
        let chart = effort_chart(seen.scene.shown_title(), &rows).svg();
        Ok(vec![seen.write_file(&self.folder, "effort.svg", chart.as_bytes())?])
    }
}

fn viscosity_chart(title: &str, curve: &[CurvePoint]) -> Chart {
    let series = |name: &str, value: fn(&CurvePoint) -> f64| Series {
        name: name.into(),
        points: curve.iter().map(|point| (point.strain, value(point))).collect(),
    };
    let mut all = vec![series("total", CurvePoint::relative)];
    let lubricated = curve.iter().any(|point| point.lubrication.is_some());
    if lubricated || curve.iter().any(|point| point.contact.is_some_and(|contact| contact != 0.0)) {
        all.push(series("flow", |point| point.hydrodynamic));
    }
    if lubricated {
        all.push(series("lubrication", |point| point.lubrication.unwrap_or(0.0)));
    }
    Chart { title: title.into(), x: "strain".into(), y: "relative viscosity".into(), scale: Scale::Linear, series: all }
}
