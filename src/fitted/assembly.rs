//! The linear system of Stokes flow on a mesh, or of a step of a flow with inertia.

use super::{
    Acceleration, DiskMotion, MeshInertia, PlaneTwist, Sample, StokesNumbering, StokesProblem, System, Triangle, numbering::Component,
};
use crate::error::Result;

impl StokesNumbering {
    /// Adds the rows of this rank to a system.
    ///
    /// # Errors
    /// A triangle has collapsed.
    pub fn assemble(&self, problem: &StokesProblem, system: &mut System) -> Result<()> {
        for triangle in &problem.mesh.triangles {
            let parts = ElementBlocks::of(self, problem, triangle)?;
            // every triangle has a part in mean velocities
            if parts.rows().chain(self.forces.into_iter().flatten()).any(|row| system.holds(row)) {
                parts.assemble(problem, self.forces, system);
            }
        }
        let areas = problem.mesh.disk_areas();
        for (disk, motion) in problem.motions.iter().enumerate() {
            let DiskMotion::Free { force, torque } = motion else { continue };
            let (Some(first), area) = (self.disks[disk], areas[disk]) else { continue };
            let force = force + problem.on_disks * area;
            [force.x, force.y, *torque].into_iter().enumerate().for_each(|(row, load)| system.load(first + row, load));
        }
        self.assemble_means(problem, &areas, system);
        if let Some(inertia) = problem.inertia {
            self.assemble_momentum(inertia, system);
        }
        Ok(())
    }

    /// The momentum of free disks.
    fn assemble_momentum(&self, inertia: &MeshInertia, system: &mut System) {
        for (first, disk) in self.disks.iter().zip(&inertia.disks) {
            let (Some(first), PlaneTwist { velocity, spin }) = (*first, disk.history) else { continue };
            let masses = [disk.mass, disk.mass, disk.moment];
            for (row, (mass, known)) in (first..).zip(masses.into_iter().zip([velocity.x, velocity.y, spin])) {
                system.add(row, row, mass * inertia.rate);
                system.load(row, -mass * known);
            }
        }
    }

    /// What disks have to do with mean velocities and the forces that they take.
    fn assemble_means(&self, problem: &StokesProblem, areas: &[f64], system: &mut System) {
        let mesh = problem.mesh;
        for axis in 0..2 {
            let (Some(row), Some(mean)) = (self.forces[axis], problem.mean_velocity[axis]) else { continue };
            system.load(row, -mean * mesh.domain.volume());
            // so that each row has a diagonal
            system.add(row, row, 0.0);
            for (disk, motion) in problem.motions.iter().enumerate() {
                let background = (problem.background * mesh.disks[disk].center)[axis];
                match (self.disks[disk], motion) {
                    (Some(first), _) => {
                        system.add(row, first + axis, -areas[disk]);
                        system.add(first + axis, row, -areas[disk]);
                        system.load(row, -background * areas[disk]);
                    }
                    (None, DiskMotion::Given(rigid)) => system.load(row, (rigid.velocity[axis] - background) * areas[disk]),
                    (None, _) => {}
                }
            }
        }
    }
}

/// A triangle with the unknowns of its nodes.
struct ElementBlocks {
    velocities: [[Component; 2]; 6],
    pressures: [Option<usize>; 3],
    samples: Vec<Sample>,
    /// At the samples.
    accelerations: Vec<Acceleration>,
}

impl ElementBlocks {
    fn of(numbering: &StokesNumbering, problem: &StokesProblem, triangle: &Triangle) -> Result<ElementBlocks> {
        let samples = problem.mesh.shape(triangle).samples()?;
        Ok(ElementBlocks {
            velocities: triangle.nodes.map(|node| numbering.velocity(problem, node)),
            pressures: [0, 1, 2].map(|vertex| numbering.pressure(triangle.nodes[vertex])),
            accelerations: samples.iter().map(|sample| problem.acceleration(triangle, sample)).collect(),
            samples,
        })
    }

    fn rows(&self) -> impl Iterator<Item = usize> {
        let velocities = self.velocities.iter().flatten().flat_map(|component| component.terms().iter().map(|(row, _)| *row));
        velocities.chain(self.pressures.iter().flatten().copied())
    }

    /// A sum over the quadrature points.
    fn integral(&self, value: impl Fn(&Sample, &Acceleration) -> f64) -> f64 {
        self.samples.iter().zip(&self.accelerations).map(|(sample, acceleration)| sample.weight * value(sample, acceleration)).sum()
    }

    fn assemble(&self, problem: &StokesProblem, forces: [Option<usize>; 2], system: &mut System) {
        for (i, row) in self.velocities.iter().enumerate() {
            for (a, row) in row.iter().enumerate() {
                let means = self.integral(|sample, _| sample.values[i]);
                let history = self.integral(|sample, acceleration| sample.values[i] * acceleration.known[a]);
                for (unknown, factor) in row.terms() {
                    system.load(*unknown, factor * (problem.on_fluid[a] * means - history));
                    if let Some(force) = forces[a] {
                        system.add(*unknown, force, -factor * means);
                        system.add(force, *unknown, -factor * means);
                    }
                }
                if let Some(force) = forces[a] {
                    system.load(force, row.known * means);
                }
                self.assemble_momentum(i, a, row, system);
                self.assemble_pressure(i, a, row, system);
            }
        }
    }

    /// Friction and rates of change of momentum.
    fn assemble_momentum(&self, i: usize, a: usize, row: &Component, system: &mut System) {
        if row.terms().is_empty() {
            return;
        }
        for (j, column) in self.velocities.iter().enumerate() {
            for (b, column) in column.iter().enumerate() {
                let along = if a == b { 1.0 } else { 0.0 };
                let value =
                    self.integral(|sample, acceleration| sample.friction(i, a, j, b) + along * sample.values[i] * acceleration.weights[j]);
                for (unknown, factor) in row.terms() {
                    system.load(*unknown, -factor * value * column.known);
                    column.terms().iter().for_each(|(other, of_column)| system.add(*unknown, *other, factor * value * of_column));
                }
            }
        }
    }

    /// The pressure in momentum rows, and continuity.
    fn assemble_pressure(&self, i: usize, a: usize, velocity: &Component, system: &mut System) {
        for (k, pressure) in self.pressures.iter().enumerate() {
            let Some(pressure) = *pressure else { continue };
            let value: f64 = self.samples.iter().map(|sample| -sample.weight * sample.linear[k] * sample.gradients[i][a]).sum();
            system.load(pressure, -value * velocity.known);
            for (unknown, factor) in velocity.terms() {
                system.add(*unknown, pressure, factor * value);
                system.add(pressure, *unknown, factor * value);
            }
        }
    }
}

impl Sample {
    /// `2 D(u) : D(v)` of two shape functions along two axes.
    pub fn friction(&self, i: usize, a: usize, j: usize, b: usize) -> f64 {
        let (of_row, of_column) = (&self.gradients[i], &self.gradients[j]);
        of_row[b] * of_column[a] + if a == b { of_row.dot(of_column) } else { 0.0 }
    }
}
