//! Crowds with many films: known ones, and how iterations and seconds grow with number, fraction and gap.

use std::{fmt::Write, path::Path, time::Instant};

use super::solve::viscosity;
use crate::{error::Result, mechanics::Suspension, output::say, petsc::Session, scene::Scene, setup::Setup};

/// A crowd in a periodic box in shear, bodies of radius 1.
struct DenseSuspension {
    dimension: usize,
    side: f64,
    bodies: String,
    cells: f64,
    modes: usize,
    inverse: &'static str,
}

/// A crowd whose centres are given, with what is known of it.
struct KnownSuspension {
    name: &'static str,
    dimension: usize,
    centers: &'static str,
    side: f64,
    resolutions: &'static [(f64, usize)],
    known: &'static str,
}

/// What a solve gives and costs.
struct SolveCost {
    viscosity: f64,
    iterations: usize,
    assembly: f64,
    solve: f64,
}

const PLANE: &[(f64, usize)] = &[(5.0, 3), (6.0, 6), (8.0, 8)];
const SPACE: &[(f64, usize)] = &[(4.0, 3), (6.0, 5), (8.0, 6)];

/// A random crowd in a box, without a known viscosity.
const DISKS: KnownSuspension = KnownSuspension { name: "", dimension: 2, centers: "", side: 0.0, resolutions: PLANE, known: "" };
const SPHERES: KnownSuspension = KnownSuspension { dimension: 3, resolutions: SPACE, ..DISKS };

const KNOWN: [KnownSuspension; 5] = [
    KnownSuspension {
        name: "1,000 disks, 0.5, many gaps near 0.01",
        centers: include_str!("dense/disks1000_050.csv"),
        side: 79.2665459521,
        ..DISKS
    },
    KnownSuspension {
        name: "10,000 disks, 0.65, smallest gap 1.2e-3",
        centers: include_str!("dense/disks10000_065.csv"),
        side: 219.84584296863,
        resolutions: &[(5.0, 3)],
        known: "47 iterations on such suspensions (Broms, Tornberg, Barnett, arXiv 2606.11273)",
        ..DISKS
    },
    KnownSuspension {
        name: "125 spheres, 0.3, gap 0.1",
        centers: include_str!("dense/spheres125_030.csv"),
        side: 12.0399806569,
        known: "2.774 by fast Stokesian dynamics",
        ..SPHERES
    },
    KnownSuspension {
        name: "125 spheres, 0.45, gap 0.01",
        centers: include_str!("dense/spheres125_045.csv"),
        side: 10.5178918977,
        known: "7.773 by fast Stokesian dynamics",
        ..SPHERES
    },
    KnownSuspension {
        name: "1,000 spheres, 0.3, gap 0.1",
        centers: include_str!("dense/spheres1000_030.csv"),
        side: 24.0799613138,
        resolutions: &[(4.0, 3)],
        known: "2.791 by fast Stokesian dynamics",
        ..SPHERES
    },
];

/// Numbers at one fraction and gap, fractions and gaps at one number, by dimension.
struct IterationGrowth {
    dimension: usize,
    cells: f64,
    numbers: (&'static [usize], f64, f64),
    suspensions: (usize, &'static [(f64, &'static [f64])]),
}

const GROWTH: [IterationGrowth; 2] = [
    IterationGrowth {
        dimension: 2,
        cells: 5.0,
        numbers: (&[100, 300, 1_000, 3_000, 10_000], 0.5, 0.01),
        suspensions: (1_000, &[(0.3, &[0.1, 1e-3]), (0.5, &[0.1, 1e-2, 1e-3, 1e-4]), (0.7, &[1e-2, 1e-4]), (0.8, &[1e-2, 1e-4])]),
    },
    IterationGrowth {
        dimension: 3,
        cells: 4.0,
        numbers: (&[30, 100, 300, 1_000, 2_000], 0.4, 0.01),
        suspensions: (250, &[(0.3, &[0.1, 1e-2, 1e-3, 1e-4]), (0.5, &[1e-2, 1e-4]), (0.6, &[1e-3])]),
    },
];

/// Order of the modes in crowds of any number.
const MODES: usize = 3;

/// Largest number for which multigrid is measured beside the transform.
const MOST_BY_MULTIGRID: usize = 300;

/// Solves known crowds, and such as show how the cost grows, each once and from zero, and prints tables in Markdown. Collective.
///
/// # Errors
/// A crowd cannot be solved.
pub fn dense_suspensions(session: &Session) -> Result<()> {
    let say = |text: &str| session.world().on_first_rank(|| say(text));
    say("| suspension | cells, modes | viscosity | iterations | seconds: assembly + solve | known |\n|-|-|-|-|-|-|")?;
    for known in &KNOWN {
        for &(cells, modes) in known.resolutions {
            let KnownSuspension { dimension, side, .. } = *known;
            let suspension = DenseSuspension { dimension, side, bodies: centers(known.centers), cells, modes, inverse: "transform" };
            let SolveCost { viscosity, iterations, assembly, solve } = suspension.solve(session)?;
            say(&format!(
                "| {} | {cells}, {modes} | {viscosity:.4} | {iterations} | {assembly:.2} + {solve:.2} | {} |",
                known.name, known.known
            ))?;
        }
    }
    say(
        "\n| dimension | bodies | fraction | least gap | iterations: transform / hypre | seconds: assembly + solve | ms a body |\n|-|-|-|-|-|-|-|",
    )?;
    for growth in &GROWTH {
        let (numbers, fraction, gap) = growth.numbers;
        for &count in numbers {
            say(&growth.row(session, count, fraction, gap)?)?;
        }
        let (count, fractions) = growth.suspensions;
        for (fraction, gaps) in fractions {
            for gap in *gaps {
                say(&growth.row(session, count, *fraction, *gap)?)?;
            }
        }
    }
    Ok(())
}

/// The line of a scene that places bodies at the centres of a table.
pub(super) fn centers(table: &str) -> String {
    let mut text = String::from("centers = [");
    table.lines().filter(|line| !line.trim().is_empty()).for_each(|line| _ = write!(text, "[{line}],"));
    text + "]"
}

impl IterationGrowth {
    fn row(&self, session: &Session, count: usize, fraction: f64, gap: f64) -> Result<String> {
        let volume = if self.dimension == 2 { std::f64::consts::PI } else { 4.0 / 3.0 * std::f64::consts::PI };
        let side = (count as f64 * volume / fraction).powf(1.0 / self.dimension as f64);
        let suspension = |inverse| {
            let bodies = format!("count = {count}\ngap = {gap}");
            DenseSuspension { dimension: self.dimension, side, bodies, cells: self.cells, modes: MODES, inverse }
        };
        let SolveCost { iterations, assembly, solve, .. } = suspension("transform").solve(session)?;
        let by_multigrid = match count <= MOST_BY_MULTIGRID {
            true => suspension("hypre").solve(session)?.iterations.to_string(),
            false => "-".to_owned(),
        };
        let each = 1e3 * (assembly + solve) / count as f64;
        Ok(format!(
            "| {} | {count} | {fraction} | {gap:e} | {iterations} / {by_multigrid} | {assembly:.2} + {solve:.2} | {each:.2} |",
            self.dimension
        ))
    }
}

impl DenseSuspension {
    fn solve(&self, session: &Session) -> Result<SolveCost> {
        let scene = Scene::parse("crowd", Path::new("."), &self.text(), &[])?;
        match self.dimension {
            2 => cost::<2>(session, &scene),
            _ => cost::<3>(session, &scene),
        }
    }

    fn text(&self) -> String {
        let DenseSuspension { dimension, side, bodies, cells, modes, inverse } = self;
        let size = vec![side.to_string(); *dimension].join(", ");
        format!(
            "seed = 1\n[domain]\nsize = [{size}]\n[flow]\ndrive = {{ shear_rate = 1.0 }}\n[resolution]\ncells_per_radius = {cells}\nmodes = {modes}\n\
             [method]\ninverse = \"{inverse}\"\ntolerance = 1e-6\n[[bodies]]\nradius = 1.0\n{bodies}\n[lubrication]\nmodel = \"pairwise\"\n"
        )
    }
}

fn cost<const D: usize>(session: &Session, scene: &Scene) -> Result<SolveCost> {
    let setup = session.world().agree(Setup::<D>::of(scene))?;
    let mut suspension = Suspension::new(session, setup)?;
    let start = Instant::now();
    let solution = suspension.solve(&mut |_, _| ())?;
    let seconds = session.world().max(start.elapsed().as_secs_f64());
    let viscosity = viscosity(&suspension, &solution)?.relative();
    let cost = suspension.cost();
    let assembly = session.world().max(cost.assembly);
    Ok(SolveCost { viscosity, iterations: cost.krylov.iterations, assembly, solve: seconds - assembly })
}
