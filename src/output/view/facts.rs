//! What the page must know of a run besides its frames.

use std::{fs, path::Path};

use serde_json::{Value, json};

use crate::{
    observe::Plane,
    output::{column_names, row_numbers, traces::SUMMARY},
    picture::colour::{self, ColourMap},
    scene::{AffineFlow, AxisSection, Colour, Scene},
};

/// Rows of the series that the page holds at most.
const MOST_ROWS: usize = 2000;
const SHADES: i32 = 32;

/// The facts of a run's scene and of its folder.
pub fn facts(scene: &Scene, folder: &Path) -> Value {
    let bound = |axis: &AxisSection| match axis {
        AxisSection::Periodic => "periodic",
        AxisSection::Walls { .. } => "walls",
        AxisSection::Open { .. } => "open",
    };
    let ties = |section: &str| scene.bodies.iter().any(|group| group.together() && group.section() == section);
    let tied: Vec<&str> = [("chains", "chain"), ("cells", "cell"), ("clusters", "cluster")]
        .iter()
        .filter(|(section, _)| ties(section))
        .map(|(_, word)| *word)
        .collect();
    let coloured = match scene.output.colour {
        Colour::Speed => "speed",
        Colour::NonAffine => "nonaffine",
        Colour::Vorticity => "vorticity",
        Colour::Chain => "chain",
        Colour::Species => "species",
    };
    json!({
        "title": scene.shown_title(),
        "dimension": scene.dimension(),
        "size": scene.domain.size,
        "bounds": scene.domain.axes.iter().map(bound).collect::<Vec<_>>(),
        "plane": Plane::of(scene).axes(),
        "gravity": scene.gravity,
        "dry": scene.dry(),
        "viscosity": scene.flow.viscosity,
        "shear": shear(scene),
        "tied": tied,
        "coloured": coloured,
        "finished": folder.join(SUMMARY).exists(),
        "series": series(&folder.join("series.csv")),
        "maps": {
            "sequential": shades(&colour::SEQUENTIAL),
            "diverging": shades(&colour::DIVERGING),
            "distinct": colour::DISTINCT,
        },
    })
}

/// The shear that walls or the box impose: the velocity is `base + rate x[gradient]` along axis `flow`, where that is the motion of all.
fn shear(scene: &Scene) -> Option<Value> {
    let AffineFlow { flow, gradient, rate, base } = AffineFlow::of(scene)?;
    Some(json!({ "flow": flow, "gradient": gradient, "rate": rate, "base": base }))
}

fn shades(map: &ColourMap) -> Vec<[u8; 3]> {
    (0..=SHADES).map(|k| map.shade(f64::from(k) / f64::from(SHADES))).collect()
}

/// Names and rows of a series, evenly thinned; cells that are no numbers are null. Nothing without a series, or from one that cannot be read.
fn series(path: &Path) -> Option<Value> {
    let text = fs::read_to_string(path).ok()?;
    let mut lines = text.lines();
    let names = column_names(lines.next()?);
    // the last row of a run under way may be half written
    let rows: Vec<&str> = lines.filter(|line| line.split(',').count() == names.len()).collect();
    let stride = rows.len().div_ceil(MOST_ROWS).max(1);
    let numbers = |row: &&str| row_numbers(row).map(|number| Some(number).filter(|number| number.is_finite())).collect::<Vec<_>>();
    Some(json!({ "names": names, "rows": rows.iter().step_by(stride).map(numbers).collect::<Vec<_>>(), "stride": stride }))
}
