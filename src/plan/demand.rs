//! Memory that a scene takes, told before its bodies are placed: what is too much for the machine is refused before it is begun.

use nalgebra::Vector2;

use super::{
    fitted,
    memory::{CONTACT_BYTES, bytes, multiplier_counts, scalar_bytes},
    resolve::{fixed_in_plane, grid_spacing, suspended},
};
use crate::{
    body::{Body, Motion, Trajectories, Twist},
    error::Result,
    fitted::EdgeLengths,
    geometry::{Ball, Domain},
    grid::Grid,
    scene::{BodyGroup, ConstraintMethod, FlowModel, Placement, Scene},
    setup::{
        Setup, SuspendedBody,
        placement::{self, Asked},
        room,
    },
};

/// Most cells along all axes together for which a grid is made to count its unknowns.
const MOST_ALONG: f64 = 1e7;

/// About as many bytes as a scene takes on all ranks together; infinite where already its grid has too many layers to be planned.
///
/// # Errors
/// What the scene asks for cannot be: bodies overlap or do not fit, the grid does not, or unknowns cannot be numbered.
pub fn demand<const D: usize>(scene: &Scene, ranks: usize) -> Result<f64> {
    let stream = |group: &BodyGroup| matches!(&group.placement, Placement::File(path) if !path.is_file());
    if scene.bodies.iter().any(stream) {
        // what is no file can be read but once
        return Ok(0.0);
    }
    let domain = placement::domain::<D>(scene);
    let Asked { given, counts: mut numbers } = placement::asked(scene, &domain)?;
    given.iter().for_each(|&(group, _)| numbers[group] += 1.0);
    if scene.dry() {
        return Ok(CONTACT_BYTES * numbers.iter().sum::<f64>());
    }
    let Some(resolution) = &scene.resolution else { return Ok(0.0) };
    let other = scene.bodies.iter().zip(&numbers).filter(|(group, _)| !matches!(group.placement, Placement::File(_)));
    let smallest = other
        .map(|(group, number)| group.smallest_of(D, *number as usize))
        .chain(given.iter().map(|(_, ball)| ball.radius))
        .fold(f64::INFINITY, f64::min);
    let spacing = resolution.spacing.length(smallest);
    if domain.size.sum() / spacing > MOST_ALONG {
        return Ok(f64::INFINITY);
    }
    if scene.method.constraint == ConstraintMethod::Fitted {
        return Ok(fitted::bytes_of_cells(squares(scene, &domain, spacing, &numbers)));
    }
    let grid = Grid::new(&domain, grid_spacing(scene, &domain, spacing), ranks, 0)?;
    if scene.scalar() {
        return Ok(scalar_bytes(&grid, 0));
    }
    let [bytes, unknowns] = of_flow(scene, &domain, &grid, spacing, &numbers);
    room::check_unknowns(scene, unknowns)?;
    Ok(bytes)
}

/// About how many squares on the edges of a fitted mesh cover the box.
fn squares<const D: usize>(scene: &Scene, domain: &Domain<D>, spacing: f64, numbers: &[f64]) -> f64 {
    let growing = scene.flow.model == FlowModel::NavierStokes && !scene.bodies.is_empty();
    let size = Vector2::new(domain.size[0], domain.size[1]);
    let lengths = if growing { EdgeLengths::growing(spacing, &size) } else { spacing.into() };
    lengths.squares(size.product(), scene.bodies.iter().map(|group| group.radius).zip(numbers.iter().copied()))
}

/// Bytes and unknowns: of the grid, and of as many bodies as each group has beside one like its first.
fn of_flow<const D: usize>(scene: &Scene, domain: &Domain<D>, grid: &Grid<D>, spacing: f64, numbers: &[f64]) -> [f64; 2] {
    let with = |bodies: Vec<SuspendedBody<D>>| {
        let setup = Setup::with_bodies(scene, domain.clone(), spacing, bodies, Trajectories::default());
        let counts = multiplier_counts(&setup, grid);
        let unknowns = (grid.fluid_unknowns() + counts.iter().sum::<usize>()) as f64;
        [bytes(&setup, grid, &counts, scene.time.is_some()), unknowns]
    };
    let empty = with(Vec::new());
    let mut all = empty;
    for (group, count) in scene.bodies.iter().zip(numbers) {
        let ball = Ball { center: domain.size / 2.0, radius: group.radius * group.mean_volume(D).powf(1.0 / D as f64) };
        // one that the grid is too coarse for is refused where the bodies are placed
        let Ok(one) = suspended(scene, Body { ball, motion: Motion::Prescribed(Twist::zero()) }, fixed_in_plane::<D>(group), spacing)
        else {
            continue;
        };
        let one = with(vec![one]);
        (0..2).for_each(|part| all[part] += count * (one[part] - empty[part]));
    }
    all
}
