//! Bodies that fall, and a disk between sliding walls: known by a converged fitted mesh, or from experiments.

use nalgebra::SVector;

use super::follow::{ComparisonRow, follow, interpolated};
use crate::{error::Result, observe, petsc::Session};

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

/// The same in a channel without ends, as long as the box is high and without a mean flow: a mesh that fits the disk, four edges a radius, which misses
/// the number of the closed box by 0.004 %.
const CHANNEL_REYNOLDS: f64 = 17.452;

/// How a disk is resolved.
#[derive(Debug, Clone, Copy)]
pub enum Discretisation {
    /// So many cells a radius, and as many modes.
    Sharp(usize),
    /// A method of first order by its word, so many cells a radius.
    Adjoint(&'static str, usize),
    /// A mesh that fits the disk, so many edges a radius.
    Fitted(usize),
}

impl Discretisation {
    fn name(self) -> String {
        match self {
            Discretisation::Sharp(cells) => format!("{cells} cells a radius, {cells} modes"),
            Discretisation::Adjoint(word, cells) => format!("`{word}`, {cells} cells a radius"),
            Discretisation::Fitted(edges) => format!("fitted mesh, {edges} edges a radius"),
        }
    }

    /// The sections of a scene, where an inverse is chosen for grids.
    fn sections(self, inverse: &str) -> String {
        match self {
            Discretisation::Sharp(cells) => {
                format!("resolution = {{ cells_per_radius = {cells}, modes = {cells} }}\nmethod = {{ inverse = \"{inverse}\" }}\n")
            }
            Discretisation::Adjoint(word, cells) => {
                format!("resolution = {{ cells_per_radius = {cells} }}\nmethod = {{ constraint = \"{word}\", inverse = \"{inverse}\" }}\n")
            }
            Discretisation::Fitted(edges) => {
                format!("resolution = {{ cells_per_radius = {edges} }}\nmethod = {{ constraint = \"fitted\" }}\n")
            }
        }
    }
}

/// Steps, times and downward speeds of the settling disk in a box with this section of its long axis and this entry of its flow.
fn fall(session: &Session, discretisation: Discretisation, [axis, drive, inverse]: [&str; 3]) -> Result<(usize, Vec<(f64, f64)>)> {
    let step = match discretisation {
        Discretisation::Sharp(cells) | Discretisation::Adjoint(_, cells) => 0.4 / (8.0 * cells as f64) / 5.6,
        Discretisation::Fitted(_) => 0.0025,
    };
    let sections = discretisation.sections(inverse);
    let text = format!(
        "gravity = [0.0, -980.0]\ndomain = {{ size = [2.0, 6.0], x = \"walls\", y = \"{axis}\" }}\n\
         flow = {{ model = \"navier-stokes\", viscosity = 0.1, density = 1.0{drive} }}\n\
         {sections}\
         bodies = [{{ radius = 0.125, centers = [[1.0, 4.0]], density = 1.25 }}]\ntime = {{ end = 0.66, step = {step:.6} }}\n"
    );
    let mut curve = Vec::new();
    let steps = follow::<2>(session, &text, |simulation, observation| {
        curve.push((simulation.state().time, -observation.twists[0].velocity[1]));
        Ok(())
    })?;
    Ok((steps, curve))
}

/// The largest Reynolds number of the settling disk.
fn largest_reynolds(curve: &[(f64, f64)]) -> f64 {
    1.25 * 0.25 / 0.1 * curve.iter().map(|(_, speed)| *speed).fold(0.0, f64::max)
}

/// Without floor and lid, which transforms do not know: the disk falls as in the closed box but for a thousandth.
pub fn settling_in_a_channel(session: &Session, discretisation: Discretisation) -> Result<(usize, Vec<ComparisonRow>)> {
    let (steps, curve) = fall(session, discretisation, ["periodic", ", drive = { mean_velocity = [0.0, 0.0] }", "transform"])?;
    let row = ComparisonRow {
        case: "settling disk, channel without ends: largest Reynolds number".into(),
        resolution: discretisation.name(),
        reference: Some(CHANNEL_REYNOLDS),
        found: largest_reynolds(&curve),
        source: "mesh that fits the disk, four edges a radius",
    };
    Ok((steps, vec![row]))
}

pub fn settling(session: &Session, discretisation: Discretisation) -> Result<(usize, Vec<ComparisonRow>)> {
    let (steps, curve) = fall(session, discretisation, ["walls", "", "hypre"])?;
    let worst = SETTLING.iter().map(|&(time, speed)| (speed, interpolated(&curve, time)));
    let worst = worst.max_by(|one, other| (one.1 / one.0 - 1.0).abs().total_cmp(&(other.1 / other.0 - 1.0).abs()));
    let (reference, found) = worst.unwrap_or_default();
    let resolution = discretisation.name();
    let source = "mesh that fits the disk, converged; Glowinski et al. (2001) find 17.27";
    let row = |case: &str, reference, found| ComparisonRow {
        case: case.into(),
        resolution: resolution.clone(),
        reference: Some(reference),
        found,
        source,
    };
    Ok((
        steps,
        vec![
            row("settling disk: largest Reynolds number", LARGEST_REYNOLDS, largest_reynolds(&curve)),
            row("settling disk: the speed that is furthest off, of 13 times", reference, found),
        ],
    ))
}

pub fn couette(session: &Session, discretisation: Discretisation, reynolds: f64, known: [f64; 2]) -> Result<(usize, Vec<ComparisonRow>)> {
    let (viscosity, sections) = (0.125 * 0.125 / reynolds, discretisation.sections("transform"));
    let step = match discretisation {
        Discretisation::Sharp(cells) | Discretisation::Adjoint(_, cells) => 0.16 / cells as f64,
        Discretisation::Fitted(_) => 0.5,
    };
    let text = format!(
        "domain = {{ size = [1.0, 1.0], y = {{ lower = [-0.5, 0.0], upper = [0.5, 0.0] }} }}\n\
         flow = {{ model = \"navier-stokes\", viscosity = {viscosity}, density = 1.0 }}\n\
         {sections}\
         bodies = [{{ radius = 0.125, centers = [[0.5, 0.5]], density = 1.0 }}]\ntime = {{ end = 120.0, step = {step} }}\n"
    );
    let mut last = [0.0; 2];
    let steps = follow::<2>(session, &text, |simulation, observation| {
        if let (true, Some(flow), Some(solution)) = (simulation.over(), simulation.suspension(), &observation.solution) {
            let viscosity = observe::viscosity(flow.setup(), flow.grid(), solution, &[])?;
            last = [observation.twists[0].spin[(0, 1)], viscosity.and_then(|viscosity| viscosity.from_walls).unwrap_or(f64::NAN)];
        }
        Ok(())
    })?;
    let row = |(place, case): (usize, &str)| ComparisonRow {
        case: format!("free disk in a Couette cell, Re {reynolds}: {case}"),
        resolution: discretisation.name(),
        reference: Some(known[place]),
        found: last[place],
        source: "mesh that fits the disk, 7 digits",
    };
    Ok((steps, ["spin over rate", "stress of the walls"].into_iter().enumerate().map(row).collect()))
}

/// A sphere that falls in a closed box.
#[derive(Debug, Clone, Copy)]
pub struct FallingSphere {
    /// What the case is called.
    pub name: &'static str,
    /// Density of the fluid.
    pub density: f64,
    /// Viscosity of the fluid.
    pub viscosity: f64,
    /// The largest speed of the sphere.
    pub speed: f64,
    /// A time after it.
    pub end: f64,
}

pub fn sphere(session: &Session, case: FallingSphere) -> Result<(usize, Vec<ComparisonRow>)> {
    let FallingSphere { name, density, viscosity, speed, end } = case;
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
        vec![ComparisonRow {
            case: format!("settling sphere, {name}: largest speed"),
            resolution: "4 cells a radius, 3 modes".into(),
            reference: Some(speed),
            found: largest,
            source: "experiment, +- 1 %: ten Cate et al. (2002)",
        }],
    ))
}
