//! Where cells and bodies are, and what of them falls to each of any number of ranks.

use nalgebra::SVector;

use crate::{
    error::Result,
    flow::{InverseMethod, Transposes},
    geometry::Domain,
    grid::{Block, Grid},
    output::Spread,
    scene::Scene,
    simulation::Setup,
};

/// Exchanges of a multigrid cycle on each level: two relaxations, residual, restriction, interpolation.
const EXCHANGES: f64 = 5.0;

/// Bytes of a value.
const VALUE: f64 = 8.0;

/// The grid and the bodies of a scene.
#[derive(Debug, Clone)]
pub struct Workload<const D: usize> {
    domain: Domain<D>,
    spacing: f64,
    inverse: InverseMethod,
    centers: Vec<SVector<f64, D>>,
}

/// What falls to the ranks.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct RankShares {
    /// Number of ranks.
    pub ranks: usize,
    /// Cells of each.
    pub cells: Spread,
    /// Bodies of each.
    pub bodies: Spread,
    /// Most faces of cells between a rank and others.
    pub halo: f64,
    /// Most ranks that touch one.
    pub neighbours: f64,
    /// Messages of the multigrid cycles of an iteration, by rule of thumb; none where transforms invert the fluid.
    pub cycle_messages: f64,
    /// Bytes of the same.
    pub cycle_bytes: f64,
    /// What ranks exchange in the transforms of an iteration; nothing where multigrid inverts the fluid.
    pub transposes: Transposes,
}

impl RankShares {
    /// Bodies of all ranks.
    pub fn all_bodies(&self) -> f64 {
        self.bodies.mean * self.ranks as f64
    }
}

impl<const D: usize> Workload<D> {
    /// Of a scene of dimension `D`.
    ///
    /// # Errors
    /// Its bodies cannot be placed.
    pub fn of(scene: &Scene) -> Result<Workload<D>> {
        let setup = Setup::<D>::of(scene)?;
        let centers = setup.bodies.iter().map(|suspended| suspended.body.ball.center).collect();
        Ok(Workload { domain: setup.domain, spacing: setup.spacing, inverse: setup.inverse, centers })
    }

    /// So many copies of it along each axis.
    pub fn repeated(&self, copies: [usize; D]) -> Workload<D> {
        let mut domain = self.domain.clone();
        domain.size.iter_mut().zip(copies).for_each(|(size, copies)| *size *= copies as f64);
        let shift = |place: [usize; D]| SVector::from_fn(|axis, _| place[axis] as f64 * self.domain.size[axis]);
        let all = Block { start: [0; D], end: copies };
        let centers = all.indices().flat_map(|place| self.centers.iter().map(move |center| center + shift(place))).collect();
        Workload { domain, centers, spacing: self.spacing, inverse: self.inverse }
    }

    /// What falls to each of so many ranks.
    ///
    /// # Errors
    /// The grid cannot be cut into so many blocks, or numbered.
    pub fn shares(&self, ranks: usize) -> Result<RankShares> {
        let grid = Grid::new(&self.domain, self.spacing, ranks, 0)?;
        let partition = grid.partition();
        let mut bodies = vec![0.0; ranks];
        for center in &self.centers {
            bodies[grid.owner(&self.domain.wrap(*center))] += 1.0;
        }
        let blocks: Vec<Block<D>> = (0..ranks).map(|rank| partition.block(rank)).collect();
        let halo = blocks.iter().map(|block| self.halo(block, partition.ranks())).fold(0.0, f64::max);
        let neighbours = partition.ranks().iter().map(|&parts| parts.min(3)).product::<usize>() as f64 - 1.0;
        let levels = (grid.unknowns(D) as f64).log2() / D as f64;
        let (finest, transposes) = match self.inverse {
            InverseMethod::Hypre => ((D + 1) as f64 * EXCHANGES, Transposes::default()),
            InverseMethod::Transform => (0.0, Transposes::of(&grid)),
        };
        Ok(RankShares {
            ranks,
            cells: Spread::of(blocks.iter().map(|block| block.len() as f64)),
            bodies: Spread::of(bodies),
            halo,
            neighbours,
            cycle_messages: finest * levels.ceil() * neighbours,
            // each level has half as many cells along each axis as the one before
            cycle_bytes: finest * VALUE * halo / (1.0 - 0.5_f64.powi(D as i32 - 1)),
            transposes,
        })
    }

    /// Faces between a block and others, on axes that are cut into so many parts.
    fn halo(&self, block: &Block<D>, parts: [usize; D]) -> f64 {
        let side = |axis: usize| {
            let sides = if self.domain.periodic(axis) && parts[axis] > 1 { 2 } else { (parts[axis] - 1).min(2) };
            sides as f64 * block.len() as f64 / (block.end[axis] - block.start[axis]) as f64
        };
        (0..D).map(side).sum()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::geometry::Axis;

    fn workload() -> Workload<2> {
        let walls = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
        let domain = Domain { size: SVector::from([8.0, 4.0]), axes: [Axis::Periodic, walls] };
        let inverse = InverseMethod::Hypre;
        Workload {
            domain,
            spacing: 0.5,
            inverse,
            centers: vec![SVector::from([1.0, 1.0]), SVector::from([3.0, 1.0]), SVector::from([7.0, 3.0])],
        }
    }

    #[test]
    fn shares_are_those_of_the_real_blocks() {
        let one = workload().shares(1).unwrap();
        assert_eq!((one.cells.most, one.bodies.most, one.halo, one.neighbours, one.cycle_messages), (128.0, 3.0, 0.0, 0.0, 0.0));
        let two = workload().shares(2).unwrap();
        assert_eq!((two.cells.most, two.bodies.most, two.bodies.least, two.halo, two.neighbours), (64.0, 2.0, 1.0, 16.0, 1.0));
        let eight = workload().shares(8).unwrap();
        assert_eq!((eight.cells.most, eight.halo, eight.neighbours), (16.0, 12.0, 5.0));
        assert!(workload().shares(256).is_err());
    }

    #[test]
    fn multigrid_has_cycles_and_transforms_have_transposes() {
        let hypre = workload().shares(4).unwrap();
        assert!(hypre.cycle_messages > 0.0 && hypre.cycle_bytes > 0.0 && hypre.transposes == Transposes::default());
        let transform = Workload { inverse: InverseMethod::Transform, ..workload() }.shares(4).unwrap();
        assert!(transform.cycle_messages == 0.0 && transform.cycle_bytes == 0.0);
        assert!(transform.transposes.messages >= 2.0 && transform.transposes.bytes > 0.0);
        assert_eq!(Workload { inverse: InverseMethod::Transform, ..workload() }.shares(1).unwrap().transposes, Transposes::default());
    }

    #[test]
    fn copies_share_out_as_one_does() {
        let four = workload().repeated([4, 1]);
        assert_eq!(four.centers.len(), 12);
        let shares = four.shares(4).unwrap();
        assert_eq!((shares.cells.most, shares.bodies.most, shares.bodies.least), (128.0, 3.0, 3.0));
    }
}
