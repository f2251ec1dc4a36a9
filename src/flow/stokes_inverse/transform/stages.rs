//! Where values and waves lie at each stage of a transform along all axes, and what ranks exchange between stages.

use super::{Axis, BlockLayout, Grid, Pencils};

/// The layouts of a transform along all axes.
pub struct Stages<const D: usize> {
    /// The blocks of the grid.
    pub own: BlockLayout<D>,
    /// Values where the first axis is whole.
    pub whole: BlockLayout<D>,
    /// Waves where each axis is whole, one after the other.
    pub waves: Vec<BlockLayout<D>>,
    /// The axes in that order.
    pub order: [usize; D],
}

impl<const D: usize> Stages<D> {
    /// Those that move least from the blocks of a grid.
    pub fn new(grid: &Grid<D>) -> Stages<D> {
        let own = BlockLayout((0..grid.partition().blocks()).map(|rank| grid.partition().block(rank)).collect());
        let special = (0..D).find(|&axis| grid.domain().axes[axis] != Axis::Periodic);
        let pencils = Pencils::new(&own, grid.cells(), special);
        let order = pencils.order();
        let mut waves = grid.cells();
        waves[order[0]] = waves[order[0]] / 2 + 1;
        Stages { whole: pencils.layout(0, grid.cells()), waves: pencils.layouts(waves), own, order }
    }
}

/// What ranks exchange, each with all others, in one solve by transforms: all values, there and back.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Transposes {
    /// Number of exchanges.
    pub count: f64,
    /// Bytes that the busiest rank hands over in all of them, its own share included.
    pub bytes: f64,
}

impl Transposes {
    /// Of a solve on a grid.
    pub fn of<const D: usize>(grid: &Grid<D>) -> Transposes {
        let Stages { own, whole, waves, .. } = Stages::new(grid);
        let turns = waves.windows(2).filter(|pair| pair[0] != pair[1]).count();
        let start = usize::from(own != whole);
        let largest = waves.iter().map(BlockLayout::largest).max().unwrap_or(0);
        let (value, wave) = (size_of::<f64>(), 2 * size_of::<f64>());
        let bytes = start * value * own.largest().max(whole.largest()) + turns * wave * largest;
        Transposes { count: 2.0 * (start + turns) as f64, bytes: 2.0 * ((D + 1) * bytes) as f64 }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use nalgebra::SVector;

    use super::*;
    use crate::geometry::Domain;

    #[test]
    fn one_rank_exchanges_nothing_and_many_hand_over_all_values() {
        let domain = Domain { size: SVector::from([8.0, 8.0]), axes: [Axis::Periodic; 2] };
        let of = |ranks| Transposes::of(&Grid::<2>::new(&domain, 0.125, ranks, 0).unwrap());
        assert_eq!(of(1), Transposes::default());
        let (four, sixteen) = (of(4), of(16));
        // values of three fields, 64^2 points shared by four: to whole lines and on to the other axis, there and back
        let values = 3.0 * 64.0 * 64.0 * 8.0 / 4.0;
        assert!(four.count == 4.0 && four.bytes > 2.0 * values && four.bytes < 5.0 * values, "{four:?}");
        assert!(sixteen.count == 4.0 && (four.bytes / sixteen.bytes - 4.0).abs() < 1.0, "{sixteen:?}");
    }
}
