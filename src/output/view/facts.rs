//! What the page must know of a run besides its frames.

use std::{fs, path::Path};

use serde_json::{Value, json};

use crate::{
    observe::Plane,
    output::{
        picture::colour::{self, ColourMap},
        traces::SUMMARY,
    },
    scene::{AxisSection, Colour, Drive, Scene},
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
    if let Some(Drive::ShearRate(rate) | Drive::ShearedBox(rate)) = scene.flow.drive {
        return (rate != 0.0).then(|| json!({ "flow": 0, "gradient": 1, "rate": rate, "base": 0.0 }));
    }
    (0..scene.dimension()).find_map(|gradient| {
        let AxisSection::Walls { lower, upper } = &scene.domain.axes[gradient] else { return None };
        let others = (0..scene.dimension()).filter(|axis| *axis != gradient);
        let periodic = others.clone().all(|axis| scene.domain.axes[axis] == AxisSection::Periodic);
        let moving: Vec<usize> = others.filter(|&axis| upper[axis] != lower[axis]).collect();
        let [flow] = moving[..] else { return None };
        let rate = (upper[flow] - lower[flow]) / scene.domain.size[gradient];
        periodic.then(|| json!({ "flow": flow, "gradient": gradient, "rate": rate, "base": lower[flow] }))
    })
}

fn shades(map: &ColourMap) -> Vec<[u8; 3]> {
    (0..=SHADES).map(|k| map.shade(f64::from(k) / f64::from(SHADES))).collect()
}

/// Names and rows of a series, evenly thinned; cells that are no numbers are null. Nothing without a series, or from one that cannot be read.
fn series(path: &Path) -> Option<Value> {
    let text = fs::read_to_string(path).ok()?;
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next()?.split(',').map(str::trim).collect();
    // the last row of a run under way may be half written
    let rows: Vec<&str> = lines.filter(|line| line.split(',').count() == names.len()).collect();
    let stride = rows.len().div_ceil(MOST_ROWS).max(1);
    let numbers = |row: &&str| row.split(',').map(|cell| cell.trim().parse::<f64>().ok().filter(|x| x.is_finite())).collect::<Vec<_>>();
    Some(json!({ "names": names, "rows": rows.iter().step_by(stride).map(numbers).collect::<Vec<_>>(), "stride": stride }))
}
