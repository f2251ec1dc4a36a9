//! Random beds with films: the drag of fixed bodies, the speed of bodies that a force drives, and the viscosity, which miss different modes.

use std::f64::consts::PI;

use super::{
    case::Case,
    dense::centers,
    solve::{solve, viscosity},
};
use crate::{error::Result, output::say, petsc::Session};

/// Cells per radius of the cases; their modes are automatic.
const CELLS: f64 = 5.0;

/// Cells per radius, and modes, of the table of beds: those of everyday runs, and those by which the references were found.
const SETTINGS: [&[(f64, &str)]; 2] = [
    &[(4.0, AUTO), (5.0, AUTO), (6.0, AUTO), (8.0, AUTO), (12.0, "12"), (16.0, "14"), (24.0, "20")],
    &[(3.0, AUTO), (4.0, AUTO), (5.0, AUTO), (6.0, AUTO), (8.0, "7"), (8.0, "8"), (10.0, "8"), (10.0, "10")],
];
const AUTO: &str = "\"auto\"";

/// What is measured of a bed.
#[derive(Debug, Clone, Copy)]
enum Measure {
    /// Mean force on fixed bodies in a mean flow along x; in 3D over that on a lone sphere, in 2D over viscosity and speed.
    Drag,
    /// Mean speed of bodies that a force drives along x while the whole is at rest; in 3D over that of a lone sphere, in 2D over force over viscosity.
    Settling,
    /// Relative viscosity of free bodies.
    Viscosity,
}

/// Bodies of radius 1 at random places of a periodic cube.
#[derive(Clone, Copy)]
struct Bed {
    dimension: usize,
    fraction: f64,
    centers: &'static str,
    known: &'static [Known],
}

/// A measure, the name of its row, the converged value, and the error that is promised with [`CELLS`], if that is enough for one.
type Known = (Measure, &'static str, f64, Option<f64>);

/// References are those of the finest settings of [`SETTINGS`]; digits that still change are left out.
const BEDS: [Bed; 5] = [
    Bed {
        dimension: 2,
        fraction: 0.3,
        centers: include_str!("beds/disks40_030.csv"),
        known: &[
            (Measure::Drag, "drag, bed of disks 0.3", 80.90, Some(1e-2)),
            (Measure::Settling, "settling, bed of disks 0.3", 0.04392, Some(5e-3)),
            (Measure::Viscosity, "viscosity, bed of disks 0.3", 2.2989, Some(5e-3)),
        ],
    },
    Bed {
        dimension: 2,
        fraction: 0.5,
        centers: include_str!("beds/disks40_050.csv"),
        known: &[
            (Measure::Drag, "drag, bed of disks 0.5", 2495.0, None),
            (Measure::Settling, "settling, bed of disks 0.5", 0.00916, Some(1.5e-2)),
            (Measure::Viscosity, "viscosity, bed of disks 0.5", 5.3053, Some(1e-2)),
        ],
    },
    Bed {
        dimension: 3,
        fraction: 0.1,
        centers: include_str!("beds/spheres27_010.csv"),
        known: &[
            (Measure::Drag, "drag, bed of spheres 0.1", 2.6224, Some(5e-3)),
            (Measure::Settling, "settling, bed of spheres 0.1", 0.4881, Some(5e-3)),
            (Measure::Viscosity, "viscosity, bed of spheres 0.1", 1.3439, Some(5e-3)),
        ],
    },
    Bed {
        dimension: 3,
        fraction: 0.3,
        centers: include_str!("beds/spheres27_030.csv"),
        known: &[
            (Measure::Drag, "drag, bed of spheres 0.3", 9.310, Some(6e-3)),
            (Measure::Settling, "settling, bed of spheres 0.3", 0.1531, Some(5e-3)),
            (Measure::Viscosity, "viscosity, bed of spheres 0.3", 2.819, Some(5e-3)),
        ],
    },
    Bed {
        dimension: 3,
        fraction: 0.5,
        centers: include_str!("beds/spheres27_050.csv"),
        known: &[
            (Measure::Drag, "drag, bed of spheres 0.5", 46.1, Some(6e-2)),
            (Measure::Settling, "settling, bed of spheres 0.5", 0.0281, Some(4e-2)),
            (Measure::Viscosity, "viscosity, bed of spheres 0.5", 8.56, Some(1.5e-2)),
        ],
    },
];

/// The rows of the table of known answers.
pub fn cases() -> Vec<Case> {
    BEDS.iter().flat_map(|bed| bed.known.iter().filter_map(|known| bed.case(*known))).collect()
}

/// Measures all beds with coarse and fine settings and prints a table in Markdown; collective.
///
/// # Errors
/// A bed cannot be solved.
pub fn beds(session: &Session) -> Result<()> {
    let say = |text: &str| session.world().on_first_rank(|| say(text));
    say("| bed | cells, modes | value | from the reference |\n|-|-|-|-|")?;
    for bed in &BEDS {
        for &(measure, name, reference, _) in bed.known {
            for &(cells, modes) in SETTINGS[bed.dimension - 2] {
                let value = bed.measured(session, measure, cells, modes)?;
                say(&format!("| {name} | {cells}, {modes} | {value:.5} | {:+.2} % |", 100.0 * (value / reference - 1.0)))?;
            }
        }
    }
    Ok(())
}

impl Bed {
    fn case(self, (measure, name, reference, tolerance): Known) -> Option<Case> {
        Some(Case {
            name,
            source: "finer grids and more modes",
            resolution: format!("{} bodies, a/h = {CELLS}, modes auto", self.centers.lines().count()),
            reference,
            tolerance: tolerance?,
            solve: Box::new(move |session| self.measured(session, measure, CELLS, AUTO)),
        })
    }

    fn measured(&self, session: &Session, measure: Measure, cells: f64, modes: &str) -> Result<f64> {
        let (text, overrides) =
            (self.scene(measure), [format!("resolution.cells_per_radius={cells:?}"), format!("resolution.modes={modes}")]);
        if self.dimension == 2 { mean::<2>(session, measure, &text, &overrides) } else { mean::<3>(session, measure, &text, &overrides) }
    }

    fn scene(&self, measure: Measure) -> String {
        let vector = |first: f64| format!("[{first:?}{}]", ", 0.0".repeat(self.dimension - 1));
        let volume = if self.dimension == 2 { PI } else { 4.0 * PI / 3.0 };
        let side = (self.centers.lines().count() as f64 * volume / self.fraction).powf(1.0 / self.dimension as f64);
        let size = vec![format!("{side:?}"); self.dimension].join(", ");
        let (drive, motion) = match measure {
            Measure::Drag => (format!("mean_velocity = {}", vector(1.0)), "motion = \"fixed\"".to_owned()),
            Measure::Settling => (format!("mean_velocity = {}", vector(0.0)), format!("force = {}", vector(1.0))),
            Measure::Viscosity => ("shear_rate = 1.0".to_owned(), String::new()),
        };
        format!(
            "[domain]\nsize = [{size}]\n[flow]\ndrive = {{ {drive} }}\n[method]\ninverse = \"transform\"\ntolerance = 1e-6\n\
             [lubrication]\nmodel = \"pairwise\"\n[[bodies]]\nradius = 1.0\n{}\n{motion}\n",
            centers(self.centers)
        )
    }
}

fn mean<const D: usize>(session: &Session, measure: Measure, text: &str, overrides: &[String]) -> Result<f64> {
    let (suspension, solution) = solve::<D>(session, text, overrides)?;
    let lone = if D == 2 { 1.0 } else { 6.0 * PI };
    let sum = |of: &dyn Fn(usize) -> f64| (0..solution.bodies.len()).map(of).sum::<f64>() / solution.bodies.len() as f64;
    match measure {
        Measure::Drag => Ok(sum(&|body| solution.bodies[body].force[0]) / lone),
        Measure::Settling => Ok(sum(&|body| solution.bodies[body].twist.velocity[0]) * lone),
        Measure::Viscosity => Ok(viscosity(&suspension, &solution)?.relative()),
    }
}
