//! What a flow on a fitted mesh does to disks and walls: the forces at nodes, which are what is left of the rows that were not solved.

use nalgebra::{Matrix2, Vector2};

use super::{Mesh, Place, StokesFlow, StokesProblem, Triangle};
use crate::error::Result;

/// What the fluid does to a disk, per unit viscosity.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Load {
    /// Force, that of a uniform force on disks included.
    pub force: Vector2<f64>,
    /// Torque about its centre.
    pub torque: f64,
    /// Symmetric traceless first moment of the traction, that of the background included.
    pub stresslet: Matrix2<f64>,
}

/// What a flow does to all it meets, per unit viscosity.
#[derive(Debug, Clone, Default)]
pub struct Loads {
    /// Disks.
    pub disks: Vec<Load>,
    /// Forces on the lower and the upper wall across each axis; those at corners count for both walls.
    pub walls: [[Vector2<f64>; 2]; 2],
    /// Mean velocity over the box, disks included, without the background.
    pub mean_velocity: Vector2<f64>,
    /// Mean pressure over the fluid.
    pub mean_pressure: f64,
}

/// What a flow does to disks and walls, and its means.
///
/// # Errors
/// A triangle has collapsed.
pub fn loads(problem: &StokesProblem, flow: &StokesFlow) -> Result<Loads> {
    let mesh = problem.mesh;
    let mut forces = vec![Vector2::zeros(); mesh.nodes.len()];
    let mut sums = Sums::default();
    for triangle in &mesh.triangles {
        sums.add(mesh, flow, triangle)?;
        if triangle.nodes.iter().any(|&node| mesh.places[node] != Place::Fluid) {
            add_forces(problem, flow, triangle, &mut forces)?;
        }
    }
    let mut loads = of_forces(mesh, &forces);
    let strain = 0.5 * (problem.background + problem.background.transpose());
    for (disk, area) in mesh.disk_areas().into_iter().enumerate() {
        let load = &mut loads.disks[disk];
        load.force += (problem.on_disks + flow.force) * area;
        let moment = 0.5 * (load.stresslet + load.stresslet.transpose()) + 2.0 * area * strain;
        load.stresslet = moment - Matrix2::identity() * (0.5 * moment.trace());
        sums.velocity += area * (flow.motions[disk].velocity - problem.background * mesh.disks[disk].center);
    }
    loads.mean_velocity = sums.velocity / mesh.domain.volume();
    loads.mean_pressure = sums.pressure / sums.area;
    Ok(loads)
}

/// Sums of forces at nodes; in the place of stresslets, their moments.
fn of_forces(mesh: &Mesh, forces: &[Vector2<f64>]) -> Loads {
    let mut loads = Loads { disks: vec![Load::default(); mesh.disks.len()], ..Loads::default() };
    for (node, force) in forces.iter().enumerate() {
        match mesh.places[node] {
            Place::Fluid => {}
            Place::Surface(disk) => {
                let (arm, load) = (mesh.arm(disk, &mesh.nodes[node]), &mut loads.disks[disk]);
                load.force += force;
                load.torque += arm.perp(force);
                load.stresslet += arm * force.transpose();
            }
            Place::Wall(walls) => {
                let on = walls.iter().enumerate().filter_map(|(axis, upper)| Some((axis, (*upper)?)));
                on.for_each(|(axis, upper)| loads.walls[axis][usize::from(upper)] += force);
            }
        }
    }
    loads
}

/// Integrals over the fluid.
#[derive(Default)]
struct Sums {
    velocity: Vector2<f64>,
    pressure: f64,
    area: f64,
}

impl Sums {
    fn add(&mut self, mesh: &Mesh, flow: &StokesFlow, triangle: &Triangle) -> Result<()> {
        for sample in mesh.shape(triangle).samples()? {
            self.velocity += sample.weight * sample.interpolate(&triangle.nodes, |node| flow.velocities[node]);
            self.pressure += sample.weight * (0..3).map(|k| sample.linear[k] * flow.pressures[triangle.nodes[k]]).sum::<f64>();
            self.area += sample.weight;
        }
        Ok(())
    }
}

/// Adds the forces of the fluid of a triangle on what is at its nodes.
fn add_forces(problem: &StokesProblem, flow: &StokesFlow, triangle: &Triangle, forces: &mut [Vector2<f64>]) -> Result<()> {
    for sample in problem.mesh.shape(triangle).samples()? {
        let gradient: Matrix2<f64> =
            triangle.nodes.iter().zip(sample.gradients).map(|(&node, slope)| flow.velocities[node] * slope.transpose()).sum();
        let pressure: f64 = (0..3).map(|k| sample.linear[k] * flow.pressures[triangle.nodes[k]]).sum();
        let acceleration = problem.acceleration(triangle, &sample);
        let carried = triangle.nodes.iter().zip(acceleration.weights).map(|(&node, weight)| flow.velocities[node] * weight);
        let momentum = carried.sum::<Vector2<f64>>() + acceleration.known;
        let stress = gradient + gradient.transpose() - Matrix2::identity() * pressure;
        for (i, &node) in triangle.nodes.iter().enumerate() {
            let known = (problem.on_fluid + flow.force - momentum) * sample.values[i];
            forces[node] -= sample.weight * (stress * sample.gradients[i] - known);
        }
    }
    Ok(())
}
