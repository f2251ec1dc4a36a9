//! Where cells and bodies are, and what of them falls to each of any number of ranks.

use nalgebra::SVector;

use crate::{
    body::Regions,
    error::Result,
    flow::{InverseMethod, Transposes},
    geometry::Domain,
    grid::{Block, Grid},
    motion::GranularSetup,
    output::Spread,
    scene::Scene,
    setup::Setup,
};

/// Exchanges of a multigrid cycle on each level: two relaxations, residual, restriction, interpolation.
const EXCHANGES: f64 = 5.0;

/// Bytes of a value.
const VALUE: f64 = 8.0;

/// The grid and the bodies of a scene.
#[derive(Debug, Clone)]
pub struct Workload<const D: usize> {
    /// The box of all copies.
    domain: Domain<D>,
    /// Where there is a fluid.
    fluid: Option<Fluid>,
    /// Of one copy.
    centers: Vec<SVector<f64, D>>,
    copies: [usize; D],
}

/// How a fluid is solved.
#[derive(Debug, Clone, Copy)]
struct Fluid {
    spacing: f64,
    inverse: InverseMethod,
}

/// What falls to the ranks.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct RankShares {
    /// Number of ranks.
    pub ranks: usize,
    /// Cells of each; zero of a dry scene.
    pub cells: Spread,
    /// Bodies of each.
    pub bodies: Spread,
    /// Most faces of cells between a rank and others; of a dry scene most bodies next to the faces of a block.
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

    /// Bodies among which the busiest rank looks for contacts: in a flow all of them, whose motions every rank knows.
    pub fn looked_at(&self) -> f64 {
        if self.dry() { self.bodies.most } else { self.all_bodies() }
    }

    /// What memory grows with.
    pub fn size(&self) -> f64 {
        if self.dry() { self.bodies.most } else { self.cells.most }
    }

    /// Whether there is no fluid.
    pub fn dry(&self) -> bool {
        self.cells.most == 0.0
    }
}

impl<const D: usize> Workload<D> {
    /// Of a scene of dimension `D`.
    ///
    /// # Errors
    /// Its bodies cannot be placed.
    pub fn of(scene: &Scene) -> Result<Workload<D>> {
        let copies = [1; D];
        if scene.dry() {
            let GranularSetup { domain, bodies, .. } = GranularSetup::<D>::of(scene)?;
            return Ok(Workload { domain, fluid: None, centers: bodies.iter().map(|body| body.center).collect(), copies });
        }
        let setup = Setup::<D>::of(scene)?;
        let centers = setup.bodies.iter().map(|suspended| suspended.body.ball.center).collect();
        Ok(Workload { domain: setup.domain, fluid: Some(Fluid { spacing: setup.spacing, inverse: setup.inverse }), centers, copies })
    }

    /// So many copies of it along each axis.
    pub fn repeated(&self, copies: [usize; D]) -> Workload<D> {
        let mut all = self.clone();
        all.domain.size.iter_mut().zip(copies).for_each(|(size, copies)| *size *= copies as f64);
        all.copies = copies;
        all
    }

    /// What falls to each of so many ranks.
    ///
    /// # Errors
    /// The grid cannot be cut into so many blocks, or numbered.
    pub fn shares(&self, ranks: usize) -> Result<RankShares> {
        match self.fluid {
            Some(fluid) => self.fluid_shares(fluid, ranks),
            None => Ok(self.dry_shares(ranks)),
        }
    }

    fn fluid_shares(&self, fluid: Fluid, ranks: usize) -> Result<RankShares> {
        let grid = Grid::new(&self.domain, fluid.spacing, ranks, 0)?;
        let partition = grid.partition();
        let blocks: Vec<Block<D>> = (0..ranks).map(|rank| partition.block(rank)).collect();
        let sides = |block: &Block<D>| SVector::from_fn(|axis, _| (block.end[axis] - block.start[axis]) as f64);
        let halo = blocks.iter().map(|block| self.surface(sides(block), partition.ranks())).fold(0.0, f64::max);
        let neighbours = neighbours(partition.ranks());
        let levels = (grid.unknowns(D) as f64).log2() / D as f64;
        let (finest, transposes) = match fluid.inverse {
            InverseMethod::Hypre => ((D + 1) as f64 * EXCHANGES, Transposes::default()),
            InverseMethod::Transform => (0.0, Transposes::of(&grid)),
        };
        Ok(RankShares {
            ranks,
            cells: Spread::of(blocks.iter().map(|block| block.len() as f64)),
            bodies: self.bodies(ranks, |center| grid.owner(&self.domain.wrap(center))),
            halo,
            neighbours,
            cycle_messages: finest * levels.ceil() * neighbours,
            // each level has half as many cells along each axis as the one before
            cycle_bytes: finest * VALUE * halo / (1.0 - 0.5_f64.powi(D as i32 - 1)),
            transposes,
        })
    }

    fn dry_shares(&self, ranks: usize) -> RankShares {
        let regions = Regions::new(&self.domain, ranks);
        let bodies = self.bodies(ranks, |center| regions.owner(&self.domain, &center));
        // lengths in mean distances between bodies
        let distance = (self.domain.volume() / (bodies.mean * ranks as f64)).powf(1.0 / D as f64);
        let block = SVector::from_fn(|axis, _| self.domain.size[axis] / (regions.counts()[axis] as f64 * distance));
        let halo = if bodies.mean > 0.0 { self.surface(block, regions.counts()) } else { 0.0 };
        RankShares { ranks, bodies, halo, neighbours: neighbours(regions.counts()), ..RankShares::default() }
    }

    /// Bodies of all copies by their owners.
    fn bodies(&self, ranks: usize, owner: impl Fn(SVector<f64, D>) -> usize) -> Spread {
        let mut bodies = vec![0.0; ranks];
        for place in (Block { start: [0; D], end: self.copies }).indices() {
            let shift = SVector::from_fn(|axis, _| (place[axis] as f64 * self.domain.size[axis]) / self.copies[axis] as f64);
            self.centers.iter().for_each(|center| bodies[owner(center + shift)] += 1.0);
        }
        Spread::of(bodies)
    }

    /// Faces between a block with these sides and others, on axes that are cut into so many parts.
    fn surface(&self, block: SVector<f64, D>, parts: [usize; D]) -> f64 {
        let side = |axis: usize| {
            let sides = if self.domain.periodic(axis) && parts[axis] > 1 { 2 } else { (parts[axis] - 1).min(2) };
            sides as f64 * block.product() / block[axis]
        };
        (0..D).map(side).sum()
    }
}

/// Most blocks that touch one, on axes that are cut into so many parts.
fn neighbours<const D: usize>(parts: [usize; D]) -> f64 {
    parts.iter().map(|&parts| parts.min(3)).product::<usize>() as f64 - 1.0
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::geometry::Axis;

    fn workload() -> Workload<2> {
        let walls = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
        let domain = Domain { size: SVector::from([8.0, 4.0]), axes: [Axis::Periodic, walls] };
        let fluid = Some(Fluid { spacing: 0.5, inverse: InverseMethod::Hypre });
        let centers = [[1.0, 1.0], [3.0, 1.0], [7.0, 3.0]].map(SVector::from).to_vec();
        Workload { domain, fluid, centers, copies: [1; 2] }
    }

    fn transformed() -> Workload<2> {
        Workload { fluid: Some(Fluid { spacing: 0.5, inverse: InverseMethod::Transform }), ..workload() }
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
        let transform = transformed().shares(4).unwrap();
        assert!(transform.cycle_messages == 0.0 && transform.cycle_bytes == 0.0);
        assert!(transform.transposes.messages >= 2.0 && transform.transposes.bytes > 0.0);
        assert_eq!(transformed().shares(1).unwrap().transposes, Transposes::default());
    }

    #[test]
    fn copies_share_out_as_one_does() {
        let four = workload().repeated([4, 1]);
        let shares = four.shares(4).unwrap();
        assert_eq!((shares.all_bodies(), shares.cells.most, shares.bodies.most, shares.bodies.least), (12.0, 128.0, 3.0, 3.0));
    }

    #[test]
    fn dry_bodies_are_shared_out_in_equal_blocks() {
        let dry = Workload { fluid: None, ..workload() };
        let one = dry.shares(1).unwrap();
        assert_eq!((one.cells.most, one.bodies.most, one.halo, one.neighbours, one.looked_at()), (0.0, 3.0, 0.0, 0.0, 3.0));
        // two faces of four, in bodies of 32 / 3 each
        let two = dry.shares(2).unwrap();
        assert_eq!((two.bodies.most, two.neighbours, two.looked_at()), (2.0, 1.0, 2.0));
        assert!((two.halo - 8.0 * (3.0_f64 / 32.0).sqrt()).abs() < 1e-14, "{}", two.halo);
        assert_eq!(workload().shares(2).unwrap().looked_at(), 3.0);
    }
}
