//! Which rank owns which part of the box: equal blocks, cut so that little surface lies between them.

use nalgebra::SVector;

use crate::{geometry::Domain, grid::factorisations};

/// The blocks of the box, one a rank. A body belongs to the rank in whose block its centre lies.
#[derive(Debug, Clone, PartialEq)]
pub struct Regions<const D: usize> {
    size: SVector<f64, D>,
    /// Blocks along each axis.
    counts: [usize; D],
}

impl<const D: usize> Regions<D> {
    /// The blocks of so many ranks.
    pub fn new(domain: &Domain<D>, ranks: usize) -> Regions<D> {
        let surface = |counts: &[usize; D]| {
            let cuts = |axis: usize| if domain.periodic(axis) && counts[axis] > 1 { counts[axis] } else { counts[axis] - 1 };
            (0..D).map(|axis| cuts(axis) as f64 / domain.size[axis]).sum::<f64>()
        };
        // of equals the one with the stoutest blocks, and of these that which is cut across x: bodies pile up along other axes
        let order = |one: &[usize; D], two: &[usize; D]| {
            let thinnest = one.iter().max().cmp(&two.iter().max());
            f64::total_cmp(&surface(one), &surface(two)).then(thinnest).then_with(|| two.cmp(one))
        };
        let counts = factorisations::<D>(ranks).into_iter().min_by(order).expect("a number has factors");
        Regions { size: domain.size, counts }
    }

    /// How many blocks there are along each axis.
    pub fn counts(&self) -> [usize; D] {
        self.counts
    }

    /// The rank that owns a centre, which need not lie in the box.
    pub fn owner(&self, domain: &Domain<D>, center: &SVector<f64, D>) -> usize {
        let inside = domain.wrap(*center);
        (0..D).fold(0, |rank, axis| {
            let block = (inside[axis] / self.size[axis] * self.counts[axis] as f64).max(0.0) as usize;
            rank * self.counts[axis] + block.min(self.counts[axis] - 1)
        })
    }

    /// The middle of the block of a rank.
    pub fn middle(&self, mut rank: usize) -> SVector<f64, D> {
        let mut middle = SVector::zeros();
        for axis in (0..D).rev() {
            let block = rank % self.counts[axis];
            rank /= self.counts[axis];
            middle[axis] = (block as f64 + 0.5) / self.counts[axis] as f64 * self.size[axis];
        }
        middle
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Axis;

    #[test]
    fn blocks_are_cut_across_the_longest_edges_and_own_their_middles() {
        let domain = Domain { size: SVector::from([8.0, 4.0]), axes: [Axis::Periodic; 2] };
        assert_eq!(Regions::new(&domain, 2).counts, [2, 1]);
        assert_eq!(Regions::new(&domain, 8).counts, [4, 2]);
        assert_eq!(Regions::new(&domain, 1).counts, [1, 1]);
        let square = Domain { size: SVector::from([4.0, 4.0]), ..domain };
        assert_eq!(Regions::new(&square, 2).counts, [2, 1]);
        let cube = Domain { size: SVector::from([3.0; 3]), axes: [Axis::Periodic; 3] };
        for ranks in [1, 2, 3, 4, 6, 7, 8, 12] {
            let regions = Regions::new(&cube, ranks);
            assert_eq!(regions.counts.iter().product::<usize>(), ranks);
            assert!((0..ranks).all(|rank| regions.owner(&cube, &regions.middle(rank)) == rank), "{ranks} ranks");
        }
        assert_eq!(Regions::new(&cube, 8).counts, [2; 3]);
    }

    #[test]
    fn images_and_places_beyond_walls_have_owners() {
        let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
        let domain = Domain { size: SVector::from([8.0, 4.0]), axes: [Axis::Periodic, wall] };
        let regions = Regions::new(&domain, 4);
        assert_eq!(regions.owner(&domain, &SVector::from([-0.1, -3.0])), regions.owner(&domain, &SVector::from([7.9, 0.0])));
        assert_eq!(regions.owner(&domain, &SVector::from([8.1, 9.0])), regions.owner(&domain, &SVector::from([0.1, 3.9])));
    }
}
