//! The velocity on a mesh that is nearest to a given one and has its momentum, with the divergence that a step leaves.
//!
//! ```text
//! smallest  int |u - u_given|^2,  where  int u = P,  int x × u = L,  int q (div u - s . (x - m)) = 0
//! ```
//!
//! for all pressures `q`; walls and disks have their own velocities, and `m` is the centroid of the fluid. Across walls, the momentum of a flow without
//! divergence follows from the velocities of the surfaces, up to what the areas of the disks on two meshes differ by: `s` makes up for that.
//! Angular momentum is kept in boxes with walls across both axes; elsewhere it is not defined.

use nalgebra::{DVector, Vector2};

use super::{Mesh, Sample, System, Triangle};
use crate::{error::Result, petsc::Session};

/// Momentum of the fluid on a mesh, over density.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Momentum {
    /// Momentum.
    pub linear: Vector2<f64>,
    /// Angular momentum about the origin.
    pub angular: f64,
}

impl Momentum {
    /// That of velocities at the nodes of a mesh.
    ///
    /// # Errors
    /// A triangle has collapsed.
    pub fn of(mesh: &Mesh, velocities: &[Vector2<f64>]) -> Result<Momentum> {
        let mut sum = Momentum::default();
        for triangle in &mesh.triangles {
            for sample in mesh.shape(triangle).samples()? {
                let momentum = sample.weight * sample.interpolate(&triangle.nodes, |node| velocities[node]);
                sum.linear += momentum;
                sum.angular += sample.point.perp(&momentum);
            }
        }
        Ok(sum)
    }
}

/// The projection onto the velocities of a mesh.
///
/// Unknowns are the velocities of nodes in the fluid, the multipliers of the momentum, `s`, and the multipliers of the divergence, that of the first
/// vertex being zero.
pub struct Projection<'a> {
    mesh: &'a Mesh,
    /// Velocities of nodes on disks and walls.
    given: Vec<Option<Vector2<f64>>>,
    /// For each node in the fluid, its first unknown.
    numbers: Vec<Option<usize>>,
    /// First multiplier of the momentum.
    momentum: usize,
    /// For each axis, whether walls stand across it.
    walled: [bool; 2],
    centroid: Vector2<f64>,
}

impl<'a> Projection<'a> {
    /// Onto the velocities that have these given values at nodes on disks and walls.
    ///
    /// # Errors
    /// A triangle has collapsed.
    pub fn new(mesh: &'a Mesh, given: Vec<Option<Vector2<f64>>>) -> Result<Projection<'a>> {
        let mut unknowns = 0;
        let number = |given: &Option<Vector2<f64>>| {
            let first = unknowns;
            unknowns += if given.is_none() { 2 } else { 0 };
            given.is_none().then_some(first)
        };
        let numbers = given.iter().map(number).collect();
        let walled = [0, 1].map(|axis| !mesh.domain.periodic(axis));
        Ok(Projection { mesh, given, numbers, momentum: unknowns, walled, centroid: centroid(mesh)? })
    }

    /// The velocities at all nodes that are nearest to those at points, with this momentum.
    ///
    /// # Errors
    /// A point has no velocity, or the matrix is singular.
    pub fn solve(
        &self,
        session: &Session,
        velocity: impl Fn(&Vector2<f64>) -> Result<Vector2<f64>>,
        momentum: &Momentum,
    ) -> Result<Vec<Vector2<f64>>> {
        let units = self.units();
        let mut system = System::new(session.world(), units.len()).in_units(units.as_slice().to_vec());
        for triangle in &self.mesh.triangles {
            let own =
                triangle.nodes.iter().filter_map(|&node| self.numbers[node]).any(|first| system.holds(first) || system.holds(first + 1));
            for sample in self.mesh.shape(triangle).samples()? {
                if own {
                    self.add_nearness(triangle, &sample, &velocity(&sample.point)?, &mut system);
                }
                self.add_conditions(triangle, &sample, &mut system);
                self.add_slope(triangle, &sample, &mut system);
            }
        }
        self.add_momentum(momentum, &mut system);
        let (found, _) = system.solve(session, &mut None)?;
        let found = |first: usize| Vector2::new(found[first], found[first + 1]);
        let node = |(number, given): (&Option<usize>, &Option<Vector2<f64>>)| number.map(found).or(*given).unwrap_or_default();
        Ok(self.numbers.iter().zip(&self.given).map(node).collect())
    }

    /// First component of `s`.
    fn slope(&self) -> usize {
        self.momentum + 3
    }

    /// The multiplier of the divergence at a vertex.
    fn divergence(&self, vertex: usize) -> Option<usize> {
        vertex.checked_sub(1).map(|later| self.slope() + 2 + later)
    }

    /// What one of each unknown stands for, so that all rows have one unit.
    fn units(&self) -> DVector<f64> {
        let length = (self.mesh.domain.volume() / self.mesh.triangles.len() as f64).sqrt();
        let mut units = DVector::from_element(self.slope() + 1 + self.mesh.vertices, 1.0);
        units.rows_mut(0, self.slope()).fill(1.0 / length);
        units[self.momentum + 2] = length.powi(-2);
        units.rows_mut(self.slope(), 2).fill(length.powi(-3));
        units
    }

    /// The rows of nodes but for conditions.
    fn add_nearness(&self, triangle: &Triangle, sample: &Sample, velocity: &Vector2<f64>, system: &mut System) {
        for (row, of_row) in triangle.nodes.iter().zip(sample.values) {
            let Some(row) = self.numbers[*row] else { continue };
            let weight = sample.weight * of_row;
            (0..2).for_each(|axis| system.load(row + axis, weight * velocity[axis]));
            for (node, of_column) in triangle.nodes.iter().zip(sample.values) {
                for axis in 0..2 {
                    match self.numbers[*node] {
                        Some(column) => system.add(row + axis, column + axis, weight * of_column),
                        None => system.load(row + axis, -weight * of_column * self.given(*node)[axis]),
                    }
                }
            }
        }
    }

    fn given(&self, node: usize) -> Vector2<f64> {
        self.given[node].unwrap_or_default()
    }

    /// The conditions on momentum and divergence.
    fn add_conditions(&self, triangle: &Triangle, sample: &Sample, system: &mut System) {
        let closed = self.walled == [true; 2];
        for (i, &node) in triangle.nodes.iter().enumerate() {
            for (axis, lever) in [-sample.point.y, sample.point.x].into_iter().enumerate() {
                let value = sample.weight * sample.values[i];
                self.add_condition(self.momentum + axis, node, axis, value, system);
                if closed {
                    self.add_condition(self.momentum + 2, node, axis, value * lever, system);
                }
                for k in 0..3 {
                    let Some(row) = self.divergence(triangle.nodes[k]) else { continue };
                    self.add_condition(row, node, axis, sample.weight * sample.linear[k] * sample.gradients[i][axis], system);
                }
            }
        }
    }

    /// The divergence that is left along walled axes.
    fn add_slope(&self, triangle: &Triangle, sample: &Sample, system: &mut System) {
        for axis in (0..2).filter(|&axis| self.walled[axis]) {
            for k in 0..3 {
                let Some(row) = self.divergence(triangle.nodes[k]) else { continue };
                let value = -sample.weight * sample.linear[k] * (sample.point - self.centroid)[axis];
                system.add(row, self.slope() + axis, value);
                system.add(self.slope() + axis, row, value);
            }
        }
    }

    /// The part of a node's velocity in a condition.
    fn add_condition(&self, row: usize, node: usize, axis: usize, value: f64, system: &mut System) {
        match self.numbers[node] {
            Some(first) => {
                system.add(row, first + axis, value);
                system.add(first + axis, row, value);
            }
            None => system.load(row, -value * self.given(node)[axis]),
        }
    }

    /// What the momentum must be. Multipliers of what is not kept are zero, as are components of `s` along periodic axes.
    fn add_momentum(&self, momentum: &Momentum, system: &mut System) {
        let [x, y] = self.walled;
        let kept = [(true, momentum.linear.x), (true, momentum.linear.y), (x && y, momentum.angular), (x, 0.0), (y, 0.0)];
        for (row, (kept, value)) in (self.momentum..).zip(kept) {
            // each row has a diagonal
            system.add(row, row, if kept { 0.0 } else { 1.0 });
            system.load(row, if kept { value } else { 0.0 });
        }
    }
}

/// The centroid of the fluid.
fn centroid(mesh: &Mesh) -> Result<Vector2<f64>> {
    let (mut area, mut moment) = (0.0, Vector2::zeros());
    for triangle in &mesh.triangles {
        for sample in mesh.shape(triangle).samples()? {
            area += sample.weight;
            moment += sample.weight * sample.point;
        }
    }
    Ok(moment / area)
}
