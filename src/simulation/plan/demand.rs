//! Memory that a scene takes, told before its bodies are placed: what is too much for the machine is refused before it is begun.

use nalgebra::SVector;

use super::{
    fitted,
    memory::{CONTACT_BYTES, bytes, multiplier_counts, scalar_bytes},
};
use crate::{
    body::{Body, Motion, Twist, read_centers},
    error::Result,
    geometry::{Ball, Domain},
    grid::Grid,
    parallel::free_memory_bytes,
    scene::{BodyGroup, ConstraintMethod, Placement, Scene, Spacing},
    simulation::{Setup, SuspendedBody, placement, setup::suspended_bodies},
};

/// Bytes for each cell that any solver takes at least.
const LEAST_CELL_BYTES: f64 = 100.0;

/// About as many bytes as a scene takes on all ranks together; infinite where already its cells are too many for this machine.
///
/// # Errors
/// A table of centres cannot be read.
pub fn demand<const D: usize>(scene: &Scene) -> Result<f64> {
    let domain = placement::domain::<D>(scene);
    let groups: Vec<(&BodyGroup, f64)> = scene.bodies.iter().map(|group| Ok((group, number(group, &domain)?))).collect::<Result<_>>()?;
    if scene.dry() {
        return Ok(CONTACT_BYTES * groups.iter().map(|(_, count)| count).sum::<f64>());
    }
    let Some(resolution) = &scene.resolution else { return Ok(0.0) };
    let smallest = scene.bodies.iter().map(|group| group.radius).fold(f64::INFINITY, f64::min);
    let spacing = match resolution.spacing {
        Spacing::Length(spacing) => spacing,
        Spacing::CellsPerRadius(cells) => smallest / cells,
    };
    let cells: f64 = domain.size.iter().map(|size| size / spacing).product();
    if cells * LEAST_CELL_BYTES > free_memory_bytes() {
        return Ok(f64::INFINITY);
    }
    if scene.method.constraint == ConstraintMethod::Fitted {
        return Ok(fitted::bytes_of_cells(cells));
    }
    // a grid that does not fit is refused, with its key, where the bodies are placed
    let Ok(grid) = Grid::new(&domain, spacing, 1, 0) else { return Ok(0.0) };
    Ok(if scene.scalar() { scalar_bytes(&grid, 0) } else { of_flow(scene, (&domain, &grid, spacing), &groups) })
}

/// Of the grid, and of as many bodies as each group has beside one like its first.
fn of_flow<const D: usize>(scene: &Scene, (domain, grid, spacing): (&Domain<D>, &Grid<D>, f64), groups: &[(&BodyGroup, f64)]) -> f64 {
    let with = |bodies: Vec<SuspendedBody<D>>| {
        let setup = Setup::with_bodies(scene, domain.clone(), spacing, bodies);
        bytes(&setup, (grid, &multiplier_counts(&setup, grid)), scene.time.is_some())
    };
    let empty = with(Vec::new());
    let mut all = empty;
    for (number, &(group, count)) in groups.iter().enumerate() {
        let ball = Ball { center: domain.size / 2.0, radius: group.radius };
        let one = (number, Body { ball, motion: Motion::Prescribed(Twist::zero()) });
        let Ok((_, bodies)) = suspended_bodies(scene, domain, vec![one]) else { continue };
        all += count * (with(bodies) - empty);
    }
    all
}

/// How many bodies a group has.
fn number<const D: usize>(group: &BodyGroup, domain: &Domain<D>) -> Result<f64> {
    Ok(match &group.placement {
        Placement::Count(count) => *count as f64,
        Placement::Fraction(fraction) => {
            fraction * domain.volume() / Ball { center: SVector::<f64, D>::zeros(), radius: group.radius }.volume()
        }
        Placement::Centers(centers) => centers.len() as f64,
        Placement::File(path) if path.is_file() => read_centers::<D>(path)?.len() as f64,
        Placement::File(_) => 0.0,
    })
}
