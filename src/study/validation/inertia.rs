//! Flows with inertia whose answers are known: by a converged fitted mesh, or from experiments.

use std::{path::Path, time::Instant};

use nalgebra::SVector;

use super::oscillation::{Oscillation, oscillating};
use crate::{
    error::Result,
    observe,
    output::say,
    petsc::Session,
    scene::Scene,
    simulation::{FlowSolver, Observation, Simulation},
    surface::Shape,
};

/// Times and downward speeds of the settling disk of Glowinski et al. (2001), by a mesh that fits it, converged to 1e-5 from t = 0.2 on.
const SETTLING: [(f64, f64); 13] = [
    (0.05, 2.679),
    (0.1, 4.0547),
    (0.15, 4.7963),
    (0.2, 5.16745),
    (0.25, 5.35376),
    (0.3, 5.45223),
    (0.35, 5.50722),
    (0.4, 5.53923),
    (0.45, 5.55838),
    (0.5, 5.57000),
    (0.55, 5.57692),
    (0.6, 5.57966),
    (0.65, 5.57094),
];

/// Its largest Reynolds number, by the density of the disk.
const LARGEST_REYNOLDS: f64 = 17.436;

/// Reynolds number, spin over rate and stress of the walls of a free disk of radius 0.125 in a Couette cell of side 1.
const COUETTE: [(f64, f64, f64); 3] = [(1.0, 0.4632696, 1.1076296), (2.0, 0.4322244, 1.1133937), (5.0, 0.3787468, 1.1252957)];

/// Case, density, viscosity and largest speed of the sphere of ten Cate et al. (2002), Physics of Fluids 14, and an end after it.
const SPHERE: [(&str, f64, f64, f64, f64); 4] = [
    ("E1", 970.0, 0.373, 0.0363, 2.0),
    ("E2", 965.0, 0.212, 0.0571, 1.5),
    ("E3", 962.0, 0.113, 0.0869, 1.25),
    ("E4", 960.0, 0.058, 0.1226, 1.05),
];

/// Cases that are alike.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Family {
    /// A disk that settles in a closed box.
    Settling,
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
    /// A sphere that settles in a closed box.
    Spheres,
}

/// The names of all of them.
pub const NAMES: [&str; 7] = ["settling", "couette", "oscillating-disk", "oscillating-sphere", "cylinder", "vortices", "spheres"];

/// A comparison with a known value.
pub struct Row {
    /// What is compared.
    pub case: String,
    /// Cells and modes.
    pub resolution: String,
    /// The known value.
    pub reference: f64,
    /// What comes out.
    pub found: f64,
    /// Where the known value is from.
    pub source: &'static str,
}

/// A case: its steps, and what it is compared with.
type Run = Box<dyn Fn(&Session) -> Result<(usize, Vec<Row>)>>;

fn run(run: impl Fn(&Session) -> Result<(usize, Vec<Row>)> + 'static) -> Run {
    Box::new(run)
}

fn oscillations<const D: usize>() -> Vec<Run> {
    let of_kind = |kind| [4, 6, 8].map(|cells| run(move |session| oscillating::<D>(session, cells, kind)));
    [Oscillation::Translation, Oscillation::Rotation].into_iter().flat_map(of_kind).collect()
}

impl Family {
    fn runs(self) -> Vec<Run> {
        match self {
            Family::Settling => [4, 6, 8].map(|cells| run(move |session| settling(session, cells))).into(),
            Family::Couette => COUETTE
                .iter()
                .flat_map(|&(reynolds, spin, stress)| {
                    [4, 6, 8].map(|cells| run(move |session| couette(session, cells, reynolds, [spin, stress])))
                })
                .collect(),
            Family::OscillatingDisk => oscillations::<2>(),
            Family::OscillatingSphere => oscillations::<3>(),
            Family::Cylinder => [6, 8, 12].map(|cells| run(move |session| cylinder(session, cells))).into(),
            Family::Vortices => vec![run(|session| vortices(session, 8))],
            Family::Spheres => SPHERE.map(|case| run(move |session| sphere(session, case))).into(),
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
        for Row { case, resolution, reference, found, source } in rows {
            let error = 100.0 * (found / reference - 1.0);
            say(&format!("| {case} | {resolution} | {reference:.6} | {found:.6} | {error:+.3} % | {steps} | {seconds:.1} | {source} |"))?;
        }
    }
    Ok(())
}

/// Runs a scene to its end and shows each instant.
pub fn follow<const D: usize>(
    session: &Session,
    text: &str,
    mut see: impl FnMut(&Simulation<D>, &Observation<D>) -> Result<()>,
) -> Result<usize> {
    let scene = session.world().agree(Scene::parse("validation", Path::new("."), text, &[]))?;
    let mut simulation = Simulation::<D>::new(session, &scene)?;
    loop {
        let observation = simulation.evaluate(&mut |_, _| {})?;
        see(&simulation, &observation)?;
        if simulation.over() {
            return Ok(simulation.state().steps);
        }
        simulation.step(&observation, &mut |_, _| {})?;
    }
}

fn settling(session: &Session, cells: usize) -> Result<(usize, Vec<Row>)> {
    let step = 0.4 / (8.0 * cells as f64) / 5.6;
    let text = format!(
        "gravity = [0.0, -980.0]\ndomain = {{ size = [2.0, 6.0], x = \"walls\", y = \"walls\" }}\n\
         flow = {{ model = \"navier-stokes\", viscosity = 0.1, density = 1.0 }}\n\
         resolution = {{ cells_per_radius = {cells}, modes = {cells} }}\n\
         bodies = [{{ radius = 0.125, centers = [[1.0, 4.0]], density = 1.25 }}]\ntime = {{ end = 0.66, step = {step:.6} }}\n"
    );
    let mut curve = Vec::new();
    let steps = follow::<2>(session, &text, |simulation, observation| {
        curve.push((simulation.state().time, -observation.twists[0].velocity[1]));
        Ok(())
    })?;
    let largest = curve.iter().map(|(_, speed)| *speed).fold(0.0, f64::max);
    let worst = SETTLING.iter().map(|&(time, speed)| (speed, interpolated(&curve, time)));
    let worst = worst.max_by(|one, other| (one.1 / one.0 - 1.0).abs().total_cmp(&(other.1 / other.0 - 1.0).abs()));
    let (reference, found) = worst.unwrap_or_default();
    let resolution = format!("{cells} cells a radius, {cells} modes");
    let source = "mesh that fits the disk, converged; Glowinski et al. (2001) find 17.27";
    let row = |case: &str, reference, found| Row { case: case.into(), resolution: resolution.clone(), reference, found, source };
    Ok((
        steps,
        vec![
            row("settling disk: largest Reynolds number", LARGEST_REYNOLDS, 1.25 * 0.25 / 0.1 * largest),
            row("settling disk: the speed that is furthest off, of 13 times", reference, found),
        ],
    ))
}

/// The cubic through the four points around a time.
fn interpolated(curve: &[(f64, f64)], time: f64) -> f64 {
    let after = curve.partition_point(|(at, _)| *at < time);
    let first = after.saturating_sub(2).min(curve.len() - 4);
    let points = &curve[first..first + 4];
    let weights = crate::linalg::lagrange(&[points[0].0, points[1].0, points[2].0, points[3].0], time);
    weights.iter().zip(points).map(|(weight, (_, value))| weight * value).sum()
}

fn couette(session: &Session, cells: usize, reynolds: f64, known: [f64; 2]) -> Result<(usize, Vec<Row>)> {
    let viscosity = 0.125 * 0.125 / reynolds;
    let text = format!(
        "domain = {{ size = [1.0, 1.0], y = {{ lower = [-0.5, 0.0], upper = [0.5, 0.0] }} }}\n\
         flow = {{ model = \"navier-stokes\", viscosity = {viscosity}, density = 1.0 }}\n\
         resolution = {{ cells_per_radius = {cells}, modes = {cells} }}\nmethod = {{ inverse = \"transform\" }}\n\
         bodies = [{{ radius = 0.125, centers = [[0.5, 0.5]], density = 1.0 }}]\ntime = {{ end = 120.0, step = {} }}\n",
        0.16 / cells as f64
    );
    let mut last = [0.0; 2];
    let steps = follow::<2>(session, &text, |simulation, observation| {
        if let (true, Some(flow), Some(solution)) = (simulation.over(), simulation.suspension(), &observation.solution) {
            let viscosity = observe::viscosity(flow.setup(), flow.grid(), solution, &[])?;
            last = [observation.twists[0].spin[(0, 1)], viscosity.and_then(|viscosity| viscosity.from_walls).unwrap_or(f64::NAN)];
        }
        Ok(())
    })?;
    let row = |(place, case): (usize, &str)| Row {
        case: format!("free disk in a Couette cell, Re {reynolds}: {case}"),
        resolution: format!("{cells} cells a radius, {cells} modes"),
        reference: known[place],
        found: last[place],
        source: "mesh that fits the disk, 7 digits",
    };
    Ok((steps, ["spin over rate", "stress of the walls"].into_iter().enumerate().map(row).collect()))
}

fn sphere(session: &Session, (name, density, viscosity, speed, end): (&str, f64, f64, f64, f64)) -> Result<(usize, Vec<Row>)> {
    let text = format!(
        "gravity = [0.0, 0.0, -9.81]\ndomain = {{ size = [0.1, 0.1, 0.16], x = \"walls\", y = \"walls\", z = \"walls\" }}\n\
         flow = {{ model = \"navier-stokes\", viscosity = {viscosity}, density = {density} }}\n\
         resolution = {{ cells_per_radius = 4, modes = 3 }}\n\
         bodies = [{{ radius = 0.0075, centers = [[0.05, 0.05, 0.1275]], density = 1120.0 }}]\ntime = {{ end = {end} }}\n"
    );
    let mut largest = 0.0_f64;
    let steps = follow::<3>(session, &text, |_, observation| {
        largest = largest.max(SVector::norm(&observation.twists[0].velocity));
        Ok(())
    })?;
    Ok((
        steps,
        vec![Row {
            case: format!("settling sphere, {name}: largest speed"),
            resolution: "4 cells a radius, 3 modes".into(),
            reference: speed,
            found: largest,
            source: "experiment, +- 1 %: ten Cate et al. (2002)",
        }],
    ))
}

/// The channel of Schaefer and Turek (1996) with its disk.
fn channel(cells: usize, speed: f64, time: &str) -> String {
    format!(
        "domain = {{ size = [2.2, 0.41], x = {{ inflow = {speed} }}, y = \"walls\" }}\n\
         flow = {{ model = \"navier-stokes\", viscosity = 1e-3, density = 1.0 }}\n\
         resolution = {{ cells_per_radius = {cells}, modes = {cells} }}\n\
         bodies = [{{ radius = 0.05, centers = [[0.2, 0.2]], motion = \"fixed\" }}]\ntime = {{ {time} }}\n"
    )
}

const CHANNEL: &str = "spectral elements: DFG benchmark, Schaefer and Turek (1996)";

fn cylinder(session: &Session, cells: usize) -> Result<(usize, Vec<Row>)> {
    let text = channel(cells, 0.3, &format!("end = 10.0, step = {}", 0.06 / cells as f64));
    let mut last = [0.0; 2];
    let steps = follow::<2>(session, &text, |simulation, observation| {
        if let (true, Some(flow), Some(solution)) = (simulation.over(), simulation.suspension(), &observation.solution) {
            last = [solution.bodies[0].force[0] / (0.5 * 0.2 * 0.2 * 0.1), pressure_drop(flow)];
        }
        Ok(())
    })?;
    let row = |case: &str, reference, found| Row {
        case: format!("fixed disk in a channel, Re 20: {case}"),
        resolution: format!("{cells} cells a radius, {cells} modes"),
        reference,
        found,
        source: CHANNEL,
    };
    Ok((steps, vec![row("drag coefficient", 5.579_535, last[0]), row("pressure drop", 0.117_520_2, last[1])]))
}

/// From the front of the first body to its back: inside the pressure is uniform, and jumps by the normal traction.
fn pressure_drop(flow: &dyn FlowSolver<2>) -> f64 {
    let body = &flow.setup().bodies[0];
    let modes = body.body.ball.modes(body.order);
    let multipliers = &flow.levels()[0].multipliers[0];
    let outside = |normal: [f64; 2]| {
        let mut tractions = vec![0.0; modes.count() * 2];
        modes.traction(&normal, &mut tractions);
        let along = tractions.chunks(2).map(|traction| traction[0] * normal[0] + traction[1] * normal[1]);
        along.zip(multipliers).map(|(traction, multiplier)| traction * multiplier).sum::<f64>()
    };
    flow.setup().viscosity * (outside([-1.0, 0.0]) - outside([1.0, 0.0]))
}

/// Vortices: largest drag and lift and the Strouhal number over the last periods.
fn vortices(session: &Session, cells: usize) -> Result<(usize, Vec<Row>)> {
    let text = channel(cells, 1.5, &format!("end = 6.0, step = {}", 0.0096 / cells as f64));
    let mut series: Vec<[f64; 3]> = Vec::new();
    let steps = follow::<2>(session, &text, |simulation, observation| {
        if let (true, Some(solution)) = (simulation.state().time > 4.5, &observation.solution) {
            let force = solution.bodies[0].force / (0.5 * 0.1);
            series.push([simulation.state().time, force[0], force[1]]);
        }
        Ok(())
    })?;
    let largest = |place: usize| series.iter().map(|row| row[place]).fold(f64::NEG_INFINITY, f64::max);
    let rises = series.windows(2).filter(|pair| pair[0][2] < 0.0 && pair[1][2] >= 0.0);
    let crossings: Vec<f64> = rises.map(|pair| pair[0][0] - pair[0][2] * (pair[1][0] - pair[0][0]) / (pair[1][2] - pair[0][2])).collect();
    let periods = crossings.len().saturating_sub(1) as f64;
    let frequency = crossings.first().zip(crossings.last()).map_or(f64::NAN, |(first, last)| periods / (last - first));
    let row = |case: &str, reference, found| Row {
        case: format!("fixed disk in a channel, Re 100: {case}"),
        resolution: format!("{cells} cells a radius, {cells} modes"),
        reference,
        found,
        source: CHANNEL,
    };
    Ok((
        steps,
        vec![
            row("Strouhal number", 0.3019, frequency * 0.1),
            row("largest drag coefficient", 3.2275, largest(1)),
            row("largest lift coefficient", 0.9864, largest(2)),
        ],
    ))
}
