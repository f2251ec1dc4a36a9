//! The few unknowns that belong to no point: mean pressure gradients and mean velocities that a drive leaves open.

use std::ops::Range;

use crate::{
    error::Result,
    flow::{Drive, FluidSystem, OpenEnds, Stokes, StokesInverse},
    geometry::Domain,
    grid::{Grid, operators},
    parallel::World,
    petsc::Vector,
};

/// Tolerance of the flows that a mean-flow constraint is built from, so far below any other that they count as exact.
const EXACT: f64 = 1e-11;

/// Iterations allowed for them.
const MOST_ITERATIONS: usize = 200;

/// What a drive leaves to be found besides the flow and the bodies' motions.
pub enum MeanFlowConstraint {
    /// Nothing.
    Closed,
    /// Mean velocities along periodic axes of a walled box are given: the forces per volume along them are unknown.
    Forces(Vec<UniformForce>),
    /// A uniform force on a fully periodic box is given: its mean velocity (one unknown an axis) is unknown.
    MeanVelocity,
}

/// A uniform force per volume along one axis of a walled box, and the flow without bodies that a unit of it drives.
pub struct UniformForce {
    /// The axis.
    pub axis: usize,
    /// This rank's faces of the axis in a fluid vector, and their number on all ranks.
    pub faces: (Range<usize>, usize),
    /// What a unit of it is in the momentum rows of these faces.
    load: Vec<f64>,
    /// The flow.
    pub response: Vector,
    /// Mean velocity of that flow along the axis.
    pub mean: f64,
}

impl MeanFlowConstraint {
    /// The mean-flow constraint that a drive needs in a box.
    pub fn new<const D: usize>(
        drive: &Drive<D>,
        grid: &Grid<D>,
        stokes: &Stokes<D>,
        inverse: &mut dyn StokesInverse<D>,
    ) -> Result<MeanFlowConstraint> {
        let domain = grid.domain();
        if drive.leaves_force_open(domain) {
            let forces = periodic_axes(domain).map(|axis| UniformForce::new(axis, grid, stokes, inverse));
            Ok(MeanFlowConstraint::Forces(forces.collect::<Result<_>>()?))
        } else if drive.leaves_mean_velocity_open(domain) {
            Ok(MeanFlowConstraint::MeanVelocity)
        } else {
            Ok(MeanFlowConstraint::Closed)
        }
    }

    /// Number of unknowns that the mean-flow constraint of a drive in a box adds.
    pub fn count<const D: usize>(drive: &Drive<D>, domain: &Domain<D>) -> usize {
        if drive.leaves_force_open(domain) || drive.leaves_mean_velocity_open(domain) { periodic_axes(domain).count() } else { 0 }
    }

    /// Number of unknowns it adds; rank 0 holds them.
    pub fn unknowns<const D: usize>(&self) -> usize {
        match self {
            MeanFlowConstraint::Closed => 0,
            MeanFlowConstraint::Forces(forces) => forces.len(),
            MeanFlowConstraint::MeanVelocity => D,
        }
    }

    /// The forces that are to be found.
    pub fn forces(&self) -> &[UniformForce] {
        match self {
            MeanFlowConstraint::Forces(forces) => forces,
            _ => &[],
        }
    }

    /// The mean velocities that a drive wants along the axes of the forces.
    pub fn wanted<const D: usize>(&self, drive: &Drive<D>) -> Vec<f64> {
        match drive {
            Drive::MeanVelocity(velocity) => self.forces().iter().map(|force| velocity[force.axis]).collect(),
            _ => Vec::new(),
        }
    }

    /// Adds forces of the given amounts, times `factor`, to momentum rows that are not balanced.
    pub fn add_forces(&self, factor: f64, amounts: &[f64], rows: &mut Vector) -> Result<()> {
        let mut rows = rows.local_mut()?;
        for (force, amount) in self.forces().iter().zip(amounts) {
            rows[force.faces.0.clone()].iter_mut().zip(&force.load).for_each(|(row, load)| *row += factor * amount * load);
        }
        Ok(())
    }

    /// Mean velocities of a fluid along the axes of the forces.
    pub fn mean_velocities(&self, world: &World, fluid: &Vector) -> Result<Vec<f64>> {
        self.forces().iter().map(|force| force.mean_velocity(world, fluid)).collect()
    }

    /// Adds the uniformly forced flows that give a fluid the wanted mean velocities; returns the forces.
    pub fn correct_mean_velocities(&self, world: &World, wanted: &[f64], fluid: &mut Vector) -> Result<Vec<f64>> {
        let mut amounts = Vec::new();
        for (force, wanted) in self.forces().iter().zip(wanted) {
            let amount = (wanted - force.mean_velocity(world, fluid)?) / force.mean;
            fluid.add(amount, &force.response)?;
            amounts.push(amount);
        }
        Ok(amounts)
    }
}

impl UniformForce {
    fn new<const D: usize>(axis: usize, grid: &Grid<D>, stokes: &Stokes<D>, inverse: &mut dyn StokesInverse<D>) -> Result<UniformForce> {
        let mut rhs = stokes.vector()?;
        let mut load = vec![0.0; grid.local_unknowns(axis)];
        operators::add_uniform_force(grid, axis, 1.0, &mut load);
        rhs.local_mut()?[grid.local_range(axis)].copy_from_slice(&load);
        stokes.balance(&mut rhs)?;
        let mut response = stokes.vector()?;
        FluidSystem { stokes, inverse: Some(inverse) }.solve(&rhs, &mut response, EXACT, MOST_ITERATIONS)?;
        let mut force = UniformForce { axis, faces: (grid.local_range(axis), grid.unknowns(axis)), load, response, mean: 0.0 };
        force.mean = force.mean_velocity(stokes.session().world(), &force.response)?;
        Ok(force)
    }

    /// Mean of a fluid vector's velocity along the axis.
    pub fn mean_velocity(&self, world: &World, fluid: &Vector) -> Result<f64> {
        let (range, unknowns) = &self.faces;
        let mut sum = [fluid.local()?[range.clone()].iter().sum::<f64>() / *unknowns as f64];
        world.sum(&mut sum);
        Ok(sum[0])
    }
}

/// The flow that walls across one axis drag along, if no others stand in its way: from the velocity of the one to that of the other in
/// proportion to the way. A solver would find it but for its tolerance, and fluid between walls that move alike would not go with them.
fn dragged_by_walls<const D: usize>(grid: &Grid<D>, stokes: &Stokes<D>) -> Result<Option<Vector>> {
    let domain = grid.domain();
    if domain.open().is_some() {
        return Ok(None);
    }
    let mut walled = (0..D).filter_map(|axis| Some((axis, domain.axes[axis].walls()?)));
    let (Some((across, [lower, upper])), None) = (walled.next(), walled.next()) else { return Ok(None) };
    let mut flow = stokes.vector()?;
    let mut values = flow.local_mut()?;
    for field in (0..D).filter(|&field| field != across) {
        for (value, index) in values[grid.local_range(field)].iter_mut().zip(grid.block(field).indices()) {
            let way = grid.position(field, operators::signed(index))[across] / domain.size[across];
            *value = lower[field] + (upper[field] - lower[field]) * way;
        }
    }
    drop(values);
    Ok(Some(flow))
}

fn periodic_axes<const D: usize>(domain: &Domain<D>) -> impl Iterator<Item = usize> {
    (0..D).filter(|&axis| domain.periodic(axis))
}

/// Solves the flow of walls and drive without bodies, if there is any.
///
/// Returns the flow, nothing where it is only what the drive imposes on a fully periodic box, and, for each force of the mean-flow constraint, the force per volume over the viscosity that gives it the wanted mean velocity.
pub fn flow_without_bodies<const D: usize>(
    drive: &Drive<D>,
    viscosity: f64,
    grid: &Grid<D>,
    stokes: &Stokes<D>,
    inverse: &mut dyn StokesInverse<D>,
    mean_flow: &MeanFlowConstraint,
) -> Result<(Option<Vector>, Vec<f64>)> {
    if grid.domain().fully_periodic() {
        return Ok((None, Vec::new()));
    }
    let (mut flow, mut rhs, dragged) = (stokes.vector()?, stokes.vector()?, dragged_by_walls(grid, stokes)?);
    add_drive(grid, drive, viscosity, &mut rhs)?;
    if dragged.is_none() {
        add_walls(grid, &mut rhs)?;
    }
    if let Some(ends) = OpenEnds::undisturbed(grid) {
        ends.add_rows(grid, &mut rhs)?;
    }
    stokes.balance(&mut rhs)?;
    if rhs.norm()? > 0.0 {
        FluidSystem { stokes, inverse: Some(inverse) }.solve(&rhs, &mut flow, EXACT, MOST_ITERATIONS)?;
    }
    if let Some(dragged) = dragged {
        flow.add(1.0, &dragged)?;
    }
    let forces = mean_flow.correct_mean_velocities(stokes.session().world(), &mean_flow.wanted(drive), &mut flow)?;
    Ok((Some(flow), forces))
}

/// Adds the uniform force of a drive to momentum rows that are not balanced.
pub fn add_drive<const D: usize>(grid: &Grid<D>, drive: &Drive<D>, viscosity: f64, rows: &mut Vector) -> Result<()> {
    let (force, mut rows) = (drive.uniform_force() / viscosity, rows.local_mut()?);
    (0..D).for_each(|axis| operators::add_uniform_force(grid, axis, force[axis], &mut rows[grid.local_range(axis)]));
    Ok(())
}

/// Adds what walls drag along to momentum rows that are not balanced.
pub fn add_walls<const D: usize>(grid: &Grid<D>, rows: &mut Vector) -> Result<()> {
    let mut rows = rows.local_mut()?;
    (0..D).for_each(|axis| operators::add_wall_laplacian(grid, axis, &mut rows[grid.local_range(axis)]));
    Ok(())
}
