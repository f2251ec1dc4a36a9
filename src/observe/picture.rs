//! The picture of a solution: the flow in the plane of the first two axes, through the middle of the box.

use nalgebra::SVector;

use super::{Bond, Disk, Picture, plane::CutPlane, velocities, vorticity_at};
use crate::{
    error::Result,
    geometry::Ball,
    scene::Colour,
    simulation::{FlowSolver, Solution},
};

/// Cuts a solution; collective, and the same on every rank.
///
/// # Errors
/// PETSc fails.
pub fn picture<const D: usize>(title: &str, suspension: &dyn FlowSolver<D>, solution: &Solution<D>, colour: Colour) -> Result<Picture> {
    let setup = suspension.setup();
    let plane = CutPlane::of(&setup.domain, suspension.grid());
    let points = plane.points();
    let disturbance = velocities(suspension.grid(), &solution.fluid, &points)?;
    let total: Vec<SVector<f64, D>> =
        points.iter().zip(disturbance).map(|(point, velocity)| velocity + setup.drive.background(point)).collect();
    let (quantity, coloured) = match colour {
        Colour::Speed | Colour::Chain => ("speed", total.iter().map(|velocity| velocity.norm()).collect()),
        Colour::Vorticity => ("vorticity", vorticity_at(suspension.grid(), &solution.fluid, &setup.drive, &points, (1, 0))?),
    };
    Ok(Picture {
        title: title.to_owned(),
        size: plane.size,
        periodic: plane.periodic,
        shift: plane.shift,
        bodies: disks(&plane, suspension, solution, colour),
        bonds: bonds(&plane, suspension, solution),
        samples: plane.samples,
        velocity: total.iter().map(|velocity| [velocity[0], velocity[1]]).collect(),
        quantity,
        coloured,
        signed: colour == Colour::Vorticity,
    })
}

/// Width of a bond in radii of the thinner cut.
const BOND: f64 = 0.7;

/// The bonds between bodies that the plane cuts.
fn bonds<const D: usize>(plane: &CutPlane<D>, suspension: &dyn FlowSolver<D>, solution: &Solution<D>) -> Vec<Bond> {
    let setup = suspension.setup();
    let ball = |body: usize| Ball { center: solution.bodies[body].center, ..setup.bodies[body].body.ball };
    let cut = |[one, two]: [usize; 2]| {
        let ((from, radius), (_, other)) = (plane.cut(&ball(one))?, plane.cut(&ball(two))?);
        let way = setup.domain.nearest_image(ball(two).center - ball(one).center);
        Some(Bond { from, way: [way[0], way[1]], width: BOND * radius.min(other) })
    };
    setup.interactions.bonds().into_iter().filter_map(cut).collect()
}

/// The cuts of the bodies through the plane.
fn disks<const D: usize>(plane: &CutPlane<D>, suspension: &dyn FlowSolver<D>, solution: &Solution<D>, colour: Colour) -> Vec<Disk> {
    let setup = suspension.setup();
    let chains = if colour == Colour::Chain { setup.interactions.group_of() } else { Vec::new() };
    let bodies = setup.bodies.iter().zip(&solution.bodies).zip(chains.into_iter().chain(std::iter::repeat(None)));
    let cut = bodies.filter_map(|((suspended, state), chain)| {
        let (center, radius) = plane.cut(&Ball { center: state.center, ..suspended.body.ball })?;
        Some(Disk { center, radius, velocity: [state.twist.velocity[0], state.twist.velocity[1]], chain })
    });
    cut.collect()
}
