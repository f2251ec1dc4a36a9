//! Flows with inertia whose answers are known: by a converged fitted mesh, or from experiments.

use std::time::Instant;

use super::{
    channel::{cylinder, vortices},
    falling::{Discretisation, FallingSphere, couette, settling, settling_in_a_channel, sphere},
    follow::ComparisonRow,
    kissing::kissing,
    oscillation::{Oscillation, oscillating},
    places::{ARRAY, array, settling_drag},
    strokes::strokes,
};
use crate::{error::Result, output::say, petsc::Session};

/// Reynolds number, spin over rate and stress of the walls of a free disk of radius 0.125 in a Couette cell of side 1.
const COUETTE: [(f64, f64, f64); 3] = [(1.0, 0.4632696, 1.1076296), (2.0, 0.4322244, 1.1133937), (5.0, 0.3787468, 1.1252957)];

/// The sphere of ten Cate et al. (2002), Physics of Fluids 14.
const SPHERE: [FallingSphere; 4] = [
    FallingSphere { name: "E1", density: 970.0, viscosity: 0.373, speed: 0.0363, end: 2.0 },
    FallingSphere { name: "E2", density: 965.0, viscosity: 0.212, speed: 0.0571, end: 1.5 },
    FallingSphere { name: "E3", density: 962.0, viscosity: 0.113, speed: 0.0869, end: 1.25 },
    FallingSphere { name: "E4", density: 960.0, viscosity: 0.058, speed: 0.1226, end: 1.05 },
];

/// Cases that are alike.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Family {
    /// A disk that settles in a closed box.
    Settling,
    /// A disk that settles in a channel, and one between sliding walls, by methods of first order.
    Adjoint,
    /// A free disk between sliding walls.
    Couette,
    /// Disks that move or turn to and fro.
    OscillatingDisk,
    /// The same of spheres.
    OscillatingSphere,
    /// A fixed disk in a channel with inflow and outflow, Re 20.
    Cylinder,
    /// The same at Re 100, which sheds vortices.
    Vortices,
    /// The same on a grid twice as fine.
    VorticesFine,
    /// A sphere that settles in a closed box.
    Spheres,
    /// A fixed disk in a square array, at twelve places between the points of the grid.
    Array,
    /// A disk that settles in a channel, from four places.
    SettlingDrag,
    /// A disk that moves far to and fro at Re 100.
    Strokes,
    /// Two disks that draft and kiss.
    Kissing,
}

/// The names of all of them.
pub const NAMES: [&str; 13] = [
    "settling",
    "adjoint",
    "couette",
    "oscillating-disk",
    "oscillating-sphere",
    "cylinder",
    "vortices",
    "vortices-fine",
    "spheres",
    "array",
    "settling-drag",
    "strokes",
    "kissing",
];

/// A case: its steps, and what it is compared with.
type Run = Box<dyn Fn(&Session) -> Result<(usize, Vec<ComparisonRow>)>>;

fn run(run: impl Fn(&Session) -> Result<(usize, Vec<ComparisonRow>)> + 'static) -> Run {
    Box::new(run)
}

fn oscillations<const D: usize>() -> Vec<Run> {
    let of_kind = |kind| [4, 6, 8].map(|cells| run(move |session| oscillating::<D>(session, cells, kind)));
    [Oscillation::Translation, Oscillation::Rotation].into_iter().flat_map(of_kind).collect()
}

fn of_first_order(word: &'static str) -> Vec<Run> {
    let (reynolds, spin, stress) = COUETTE[0];
    let falls = [6, 8, 12].map(|cells| run(move |session| settling_in_a_channel(session, Discretisation::Adjoint(word, cells))));
    let sheared = [6, 8].map(|cells| run(move |session| couette(session, Discretisation::Adjoint(word, cells), reynolds, [spin, stress])));
    falls.into_iter().chain(sheared).collect()
}

fn arrays() -> Vec<Run> {
    let grids = ["sharp", "penalty"].into_iter().flat_map(|word| [(word, 4, 2), (word, 6, 3), (word, 8, 3)]);
    let of_grid = |(word, cells, numbers): (&'static str, usize, usize)| {
        ARRAY[..numbers].iter().map(move |&(reynolds, reference)| run(move |session| array(session, word, cells, reynolds, reference)))
    };
    grids.flat_map(of_grid).collect()
}

impl Family {
    fn runs(self) -> Vec<Run> {
        match self {
            Family::Settling => {
                let discretisations =
                    [Discretisation::Sharp(4), Discretisation::Sharp(6), Discretisation::Sharp(8), Discretisation::Fitted(4)];
                discretisations.map(|discretisation| run(move |session| settling(session, discretisation))).into()
            }
            Family::Adjoint => ["mean-value", "distributed", "penalty"].into_iter().flat_map(of_first_order).collect(),
            Family::Couette => COUETTE
                .iter()
                .flat_map(|&(reynolds, spin, stress)| {
                    let discretisations =
                        [Discretisation::Sharp(4), Discretisation::Sharp(6), Discretisation::Sharp(8), Discretisation::Fitted(6)];
                    discretisations.map(|discretisation| run(move |session| couette(session, discretisation, reynolds, [spin, stress])))
                })
                .collect(),
            Family::OscillatingDisk => oscillations::<2>(),
            Family::OscillatingSphere => oscillations::<3>(),
            Family::Cylinder => [6, 8, 12].map(|cells| run(move |session| cylinder(session, cells))).into(),
            Family::Vortices => vec![run(|session| vortices(session, 8))],
            Family::VorticesFine => vec![run(|session| vortices(session, 16))],
            Family::Spheres => SPHERE.map(|case| run(move |session| sphere(session, case))).into(),
            Family::Array => arrays(),
            Family::SettlingDrag => [4, 6].map(|cells| run(move |session| settling_drag(session, cells))).into(),
            Family::Strokes => vec![run(strokes)],
            Family::Kissing => [4, 6, 8].map(|cells| run(move |session| kissing(session, cells))).into(),
        }
    }
}

/// Runs cases and prints a table in Markdown. Collective.
///
/// # Errors
/// A run fails.
pub fn inertia(session: &Session, families: &[Family]) -> Result<()> {
    let say = |text: &str| session.world().on_first_rank(|| say(text));
    say("| case | resolution | reference | turbid | error | steps | seconds | source |\n|-|-|-|-|-|-|-|-|")?;
    for run in families.iter().flat_map(|family| family.runs()) {
        let start = Instant::now();
        let (steps, rows) = run(session)?;
        let seconds = session.world().max(start.elapsed().as_secs_f64());
        for ComparisonRow { case, resolution, reference, found, source } in rows {
            let known = reference.map_or("- | ".into(), |reference| format!("{reference:.6} | "));
            let error = reference.map_or("-".into(), |reference| format!("{:+.3} %", 100.0 * (found / reference - 1.0)));
            say(&format!("| {case} | {resolution} | {known}{found:.6} | {error} | {steps} | {seconds:.1} | {source} |"))?;
        }
    }
    Ok(())
}
