//! The unknowns of Stokes flow on a mesh by Taylor and Hood's elements: velocities of second order, pressures of first.
//!
//! A velocity on a surface is the rigid motion `V + w x r` of its disk, put in for it in rows and columns. The row of `V` is then
//! the sum of the forces at the nodes, so that force and torque balance exactly. Velocities and forces may be those of a
//! disturbance: the motion of surfaces is then the rigid one minus the background.

use nalgebra::Vector2;

use super::{DiskMotion, Mesh, Place, PlaneTwist, StokesFlow, StokesProblem};

/// A velocity component of a node, as unknowns with factors and what is known.
#[derive(Clone, Copy)]
pub struct Component {
    terms: [(usize, f64); 2],
    count: usize,
    /// What is known of it.
    pub known: f64,
}

impl Component {
    fn known(known: f64) -> Component {
        Component { terms: [(0, 0.0); 2], count: 0, known }
    }

    /// The unknowns and their factors.
    pub fn terms(&self) -> &[(usize, f64)] {
        &self.terms[..self.count]
    }
}

/// The numbering of the unknowns: disks that move freely, forces of mean velocities, nodes of the fluid, pressures.
pub struct StokesNumbering {
    /// For each disk, its first unknown if it is free.
    pub(super) disks: Vec<Option<usize>>,
    /// For each axis, the force that a given mean velocity takes.
    pub(super) forces: [Option<usize>; 2],
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

    /// What one of each unknown stands for: powers of the length of a triangle, so that no unit of length makes rows large or small.
    pub fn units(&self, mesh: &Mesh) -> Vec<f64> {
        let length = (mesh.domain.volume() / mesh.triangles.len() as f64).sqrt();
        let mut units = vec![1.0; self.unknowns];
        units[self.pressures..].fill(1.0 / length);
        self.disks.iter().flatten().for_each(|first| units[first + 2] = 1.0 / length);
        self.forces.iter().flatten().for_each(|&force| units[force] = length.powi(-2));
        units
    }

    /// The unknown of the pressure at a vertex.
    pub(super) fn pressure(&self, vertex: usize) -> Option<usize> {
        vertex.checked_sub(1).map(|later| self.pressures + later)
    }

    /// The velocity components of a node at a point.
    pub(super) fn velocity(&self, problem: &StokesProblem, node: usize) -> [Component; 2] {
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
                [0, 1].map(|axis| Component { terms: [(first + axis, 1.0), (first + 2, turned[axis])], count: 2, known: -background[axis] })
            }
        }
    }

    /// What is found.
    pub fn flow(&self, problem: &StokesProblem, found: &[f64]) -> StokesFlow {
        let value = |component: &Component| {
            component.known + component.terms().iter().map(|(unknown, factor)| factor * found[*unknown]).sum::<f64>()
        };
        let velocity = |node: usize| Vector2::from(self.velocity(problem, node).each_ref().map(value));
        let rigid = |(disk, motion): (usize, &DiskMotion)| match (self.disks[disk], motion) {
            (Some(first), _) => PlaneTwist { velocity: Vector2::new(found[first], found[first + 1]), spin: found[first + 2] },
            (None, DiskMotion::Given(rigid)) => *rigid,
            (None, _) => PlaneTwist { velocity: Vector2::zeros(), spin: 0.0 },
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
