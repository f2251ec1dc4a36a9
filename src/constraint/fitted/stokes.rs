//! Stokes flow on a fitted mesh by Taylor and Hood's elements: velocities of second order, pressures of first.
//!
//! A velocity on a surface is the rigid motion `V + w x r` of its disk, put in for it in rows and columns. The row of `V` is then
//! the sum of the forces at the nodes, so that force and torque balance exactly. Everything is per unit viscosity, and velocities and
//! forces may be those of a disturbance: the motion of surfaces is then the rigid one minus the background.

use nalgebra::{Matrix2, Vector2};

use super::{Mesh, Place, Sample, System, Triangle};

/// A rigid motion of a disk: velocity and spin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rigid {
    /// Velocity of the centre.
    pub velocity: Vector2<f64>,
    /// Counter-clockwise.
    pub spin: f64,
}

/// What decides the motion of a disk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DiskMotion {
    /// Force and torque on it, besides those of the fluid.
    Free {
        /// Force.
        force: Vector2<f64>,
        /// Torque about its centre.
        torque: f64,
    },
    /// The motion is given.
    Given(Rigid),
}

/// What is solved on a mesh, per unit viscosity.
pub struct StokesProblem<'a> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// How each disk moves.
    pub motions: &'a [DiskMotion],
    /// Gradient of a background velocity whose disturbance is solved for, zero without one; the background is zero at the origin.
    pub background: Matrix2<f64>,
    /// A given uniform force per area of fluid.
    pub on_fluid: Vector2<f64>,
    /// The same on disks.
    pub on_disks: Vector2<f64>,
    /// For each axis, the mean velocity over the whole box, disks included, if it is given: the uniform force that it takes is an unknown.
    pub mean_velocity: [Option<f64>; 2],
}

/// A velocity component of a node, as unknowns with factors and what is known.
#[derive(Clone, Copy)]
struct Component {
    terms: [(usize, f64); 2],
    count: usize,
    known: f64,
}

impl Component {
    fn known(known: f64) -> Component {
        Component { terms: [(0, 0.0); 2], count: 0, known }
    }

    fn terms(&self) -> &[(usize, f64)] {
        &self.terms[..self.count]
    }
}

/// The numbering of the unknowns: disks that move freely, forces of mean velocities, nodes of the fluid, pressures.
pub struct StokesNumbering {
    /// For each disk, its first unknown if it is free.
    disks: Vec<Option<usize>>,
    forces: [Option<usize>; 2],
    nodes: Vec<Option<usize>>,
    pressures: usize,
    unknowns: usize,
}

impl StokesNumbering {
    /// Numbers the unknowns of a problem.
    pub fn new(problem: &StokesProblem) -> StokesNumbering {
        let mut unknowns = 0;
        let mut take = |wanted: bool, count: usize| {
            let first = unknowns;
            unknowns += if wanted { count } else { 0 };
            wanted.then_some(first)
        };
        let disks = problem.motions.iter().map(|motion| take(matches!(motion, DiskMotion::Free { .. }), 3)).collect();
        let forces = problem.mean_velocity.map(|mean| take(mean.is_some(), 1));
        let nodes = problem.mesh.places.iter().map(|place| take(*place == Place::Fluid, 2)).collect();
        let pressures = unknowns;
        // the pressure at the first vertex is zero
        unknowns += problem.mesh.vertices - 1;
        StokesNumbering { disks, forces, nodes, pressures, unknowns }
    }

    /// How many there are.
    pub fn unknowns(&self) -> usize {
        self.unknowns
    }

    fn pressure(&self, vertex: usize) -> Option<usize> {
        vertex.checked_sub(1).map(|later| self.pressures + later)
    }

    /// The velocity components of a node at a point.
    fn velocity(&self, problem: &StokesProblem, node: usize) -> [Component; 2] {
        if let Some(first) = self.nodes[node] {
            return [0, 1].map(|axis| Component { terms: [(first + axis, 1.0), (0, 0.0)], count: 1, known: 0.0 });
        }
        let mesh = problem.mesh;
        let disk = match mesh.places[node] {
            Place::Surface(disk) => disk,
            Place::Wall(walls) => {
                let velocity = mesh.wall_velocity(walls) - problem.background * mesh.nodes[node];
                return [0, 1].map(|axis| Component::known(velocity[axis]));
            }
            Place::Fluid => unreachable!("nodes of the fluid are numbered"),
        };
        let arm = mesh.arm(disk, &mesh.nodes[node]);
        let background = problem.background * (mesh.disks[disk].center + arm);
        match (self.disks[disk], problem.motions[disk]) {
            (None, DiskMotion::Given(rigid)) => {
                let velocity = rigid.at(&arm) - background;
                [0, 1].map(|axis| Component::known(velocity[axis]))
            }
            (first, _) => {
                let first = first.unwrap_or_default();
                let turned = [-arm.y, arm.x];
                [0, 1].map(|axis| Component {
                    terms: [(first + axis, 1.0), (first + 2, turned[axis])],
                    count: 2,
                    known: -background[axis],
                })
            }
        }
    }

    /// Adds the rows of this rank to a system.
    pub fn assemble(&self, problem: &StokesProblem, system: &mut System) {
        for triangle in &problem.mesh.triangles {
            let parts = Parts::of(self, problem, triangle);
            if parts.rows().any(|row| system.holds(row)) {
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

    /// What is found.
    pub fn flow(&self, problem: &StokesProblem, found: &[f64]) -> StokesFlow {
        let value = |component: &Component| component.known + component.terms().iter().map(|(unknown, factor)| factor * found[*unknown]).sum::<f64>();
        let velocity = |node: usize| Vector2::from(self.velocity(problem, node).each_ref().map(value));
        let rigid = |(disk, motion): (usize, &DiskMotion)| match (self.disks[disk], motion) {
            (Some(first), _) => Rigid { velocity: Vector2::new(found[first], found[first + 1]), spin: found[first + 2] },
            (None, DiskMotion::Given(rigid)) => *rigid,
            (None, _) => Rigid { velocity: Vector2::zeros(), spin: 0.0 },
        };
        let pressures = (0..problem.mesh.vertices).map(|vertex| self.pressure(vertex).map_or(0.0, |unknown| found[unknown]));
        StokesFlow {
            velocities: (0..problem.mesh.nodes.len()).map(velocity).collect(),
            pressures: pressures.collect(),
            motions: problem.motions.iter().enumerate().map(rigid).collect(),
            force: Vector2::from(self.forces.map(|force| force.map_or(0.0, |unknown| found[unknown]))),
        }
    }
}

/// Stokes flow on a mesh, per unit viscosity.
#[derive(Debug, Clone)]
pub struct StokesFlow {
    /// Velocities at all nodes, without the background.
    pub velocities: Vec<Vector2<f64>>,
    /// Pressures at vertices, zero at the first one.
    pub pressures: Vec<f64>,
    /// Motions of the disks.
    pub motions: Vec<Rigid>,
    /// The uniform force per area that mean velocities take.
    pub force: Vector2<f64>,
}

/// A triangle with the unknowns of its nodes.
struct Parts {
    velocities: [[Component; 2]; 6],
    pressures: [Option<usize>; 3],
    samples: Vec<Sample>,
}

impl Parts {
    fn of(numbering: &StokesNumbering, problem: &StokesProblem, triangle: &Triangle) -> Parts {
        Parts {
            velocities: triangle.nodes.map(|node| numbering.velocity(problem, node)),
            pressures: [0, 1, 2].map(|vertex| numbering.pressure(triangle.nodes[vertex])),
            samples: problem.mesh.shape(triangle).samples().to_vec(),
        }
    }

    fn rows(&self) -> impl Iterator<Item = usize> {
        let velocities = self.velocities.iter().flatten().flat_map(|component| component.terms().iter().map(|(row, _)| *row));
        velocities.chain(self.pressures.iter().flatten().copied())
    }

    fn assemble(&self, problem: &StokesProblem, forces: [Option<usize>; 2], system: &mut System) {
        for (i, row) in self.velocities.iter().enumerate() {
            for (a, row) in row.iter().enumerate() {
                let means = self.samples.iter().map(|sample| sample.weight * sample.values[i]).sum::<f64>();
                for (unknown, factor) in row.terms() {
                    system.load(*unknown, factor * problem.on_fluid[a] * means);
                    if let Some(force) = forces[a] {
                        system.add(*unknown, force, -factor * means);
                        system.add(force, *unknown, -factor * means);
                    }
                }
                if let Some(force) = forces[a] {
                    system.load(force, row.known * means);
                }
                self.assemble_viscous((i, a), row, system);
                self.assemble_pressure((i, a), row, system);
            }
        }
    }

    fn assemble_viscous(&self, (i, a): (usize, usize), row: &Component, system: &mut System) {
        if row.count == 0 {
            return;
        }
        for (j, column) in self.velocities.iter().enumerate() {
            for (b, column) in column.iter().enumerate() {
                let value: f64 = self.samples.iter().map(|sample| sample.weight * sample.friction((i, a), (j, b))).sum();
                for (unknown, factor) in row.terms() {
                    system.load(*unknown, -factor * value * column.known);
                    column.terms().iter().for_each(|(other, of_column)| system.add(*unknown, *other, factor * value * of_column));
                }
            }
        }
    }

    /// The pressure in momentum rows, and continuity.
    fn assemble_pressure(&self, (i, a): (usize, usize), velocity: &Component, system: &mut System) {
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
    pub fn friction(&self, (i, a): (usize, usize), (j, b): (usize, usize)) -> f64 {
        let (of_row, of_column) = (&self.gradients[i], &self.gradients[j]);
        of_row[b] * of_column[a] + if a == b { of_row.dot(of_column) } else { 0.0 }
    }
}

impl Rigid {
    /// The velocity at an arm from the centre.
    pub fn at(&self, arm: &Vector2<f64>) -> Vector2<f64> {
        self.velocity + self.spin * Vector2::new(-arm.y, arm.x)
    }
}
